//! The state of a contact with friction in a file: that of the normal contact, and what friction adds.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::ViscoelasticContact;
use crate::contact::checkpoint::fingerprint::require_same_scene;
use crate::contact::checkpoint::{Attached, Check, NO_RUN, malformed};
use crate::error::Result;
use crate::friction::contact::FrictionContact;
use crate::friction::state::State;
use crate::run::doubled::SavedRun;
use crate::run::doubled::plain::Plain;

/// Decimal exponents of the pressures at which limits are compared \[Pa\].
const PRESSURES: std::ops::Range<i32> = -3..10;

/// What a file has besides the normal contact.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Saved<'a> {
    /// What tells limit and bodies from others.
    friction: Vec<f64>,
    state: Cow<'a, State>,
    run: Option<SavedRun<Plain>>,
}

impl Attached for Saved<'_> {
    const KIND: &'static str = "with friction in space";
}

impl FrictionContact {
    /// Saves the whole state to a file, from which a contact that is built like this one continues
    /// ([`FrictionContact::resume`]) by the same steps, bitwise. As [`ViscoelasticContact::save`].
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::save`].
    ///
    /// [`ViscoelasticContact::save`]: crate::ViscoelasticContact::save
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_with(path.as_ref(), None)
    }

    /// [`FrictionContact::save`] with a run that continues from there.
    pub(super) fn save_with(&self, path: &Path, run: Option<SavedRun<Plain>>) -> Result<()> {
        self.normal().save_with(path, Some(&self.saved(run)))
    }

    /// What [`FrictionContact::save`] writes, in memory.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the numbers cannot be written.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        self.normal().bytes_with(Some(&self.saved(None)))
    }

    /// Puts a saved state in the place of this one, as [`ViscoelasticContact::resume`] does; limit and Poisson's ratio
    /// must be the same, too. A run that saved it goes on with the next
    /// [`Contact::follow`](crate::run::Contact::follow) of the same stepping, along the same histories.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::resume`].
    ///
    /// [`ViscoelasticContact::resume`]: crate::ViscoelasticContact::resume
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.resume_by(|normal, check| normal.resume_with(path.as_ref(), check))
    }

    /// [`FrictionContact::resume`] from the bytes of [`FrictionContact::to_bytes`], or of a file.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// As [`FrictionContact::resume`].
    pub fn resume_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.resume_by(|normal, check| normal.resume_bytes_with(bytes, check))
    }

    fn resume_by(
        &mut self,
        read: impl FnOnce(&mut ViscoelasticContact, Check<'_, Saved<'static>>) -> Result<Option<Saved<'static>>>,
    ) -> Result<()> {
        let (own, friction, cells) = (&self.state, [("friction", self.friction())], self.normal.grid().cells());
        let saved = read(&mut self.normal, &|saved: Option<&Saved<'static>>| {
            let Some(Saved { friction: found, state, run }) = saved else { return Err(malformed("no friction")) };
            require_same_scene(std::slice::from_ref(found), &friction)?;
            if !state.fits(own, cells) {
                return Err(malformed("tractions that no contact has"));
            }
            match run {
                Some((progress, record)) if !progress.fits() || !record.fits() => Err(malformed(NO_RUN)),
                _ => Ok(()),
            }
        })?;
        if let Some(Saved { state, run, .. }) = saved {
            (self.state, self.saved_run) = (state.into_owned(), run.map(Arc::new));
            self.fit_to_region();
        }
        Ok(())
    }

    fn saved(&self, run: Option<SavedRun<Plain>>) -> Saved<'_> {
        Saved { friction: self.friction(), state: Cow::Borrowed(&self.state), run }
    }

    /// What tells limit and bodies from others.
    fn friction(&self) -> Vec<f64> {
        let limits = PRESSURES.map(|exponent| self.limit.limit(10f64.powi(exponent)));
        limits.chain([self.response.poisson]).collect()
    }
}
