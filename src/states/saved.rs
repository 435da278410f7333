//! The state of a contact on elastic states in a file.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::contact::checkpoint::format::{Input, Output};
use crate::error::{CheckpointError, Error, Result};
use crate::file::replace;
use crate::parallel::Rows;
use crate::states::contact::StatesContact;
use crate::states::levels::Levels;

/// The contents of a file.
#[derive(Serialize, Deserialize)]
struct Saved<'a> {
    /// Distinguishes it from the state of a [`ViscoelasticContact`](crate::ViscoelasticContact).
    kind: Cow<'a, str>,
    /// Number of states, the last level and the last depth.
    states: (u64, f64, f64),
    times: [f64; 2],
    levels: Cow<'a, Levels>,
}

const KIND: &str = "elastic states";

impl StatesContact {
    /// Saves the whole state to a file, from which a contact of the same states and material continues
    /// ([`StatesContact::resume`]) by the same steps, bitwise. The file is complete when this returns; until then,
    /// what was there before is not touched.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be written, or there is something other than a file at `path`.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let (kind, states) = (Cow::Borrowed(KIND), self.fingerprint());
        let saved = Saved { kind, states, times: [self.time, self.reduced_time], levels: Cow::Borrowed(&self.levels) };
        replace(path.as_ref(), |out| {
            let mut out = Output::begin(out)?;
            postcard::to_io(&saved, &mut out).map_err(io::Error::other)?;
            out.finish()
        })
    }

    /// Puts a saved state in the place of this one. The contact must be made of the same states and material.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, of another format or of another contact ([`Error::Checkpoint`]); the
    /// contact is then as it was.
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let saved = self.read(path).map_err(|source| Error::Checkpoint { path: path.to_owned(), source })?;
        [self.time, self.reduced_time] = saved.times;
        self.levels = saved.levels.into_owned();
        Ok(())
    }

    fn read(&self, path: &Path) -> Result<Saved<'static>, CheckpointError> {
        let (mut file, rows) = (Input::open(path)?, Rows::all([1, 1]));
        let of_part = file.checksum_of_part(&rows)?;
        file.require_checksum(&rows, of_part)?;
        let saved: Saved<'static> = file.contents()?;
        let malformed = |what: &str| Err(CheckpointError::Malformed { what: what.into() });
        let other = |what, saved, built| Err(CheckpointError::OtherScene { what, saved, built });
        if saved.kind != KIND {
            return malformed("no contact on elastic states");
        }
        if saved.states != self.fingerprint() {
            let [saved, built] = [saved.states, self.fingerprint()].map(|states| format!("{states:?}"));
            return other("elastic states", saved, built);
        }
        if !saved.levels.is_of_the_material_of(&self.levels) {
            return other("material", "another".into(), "its own".into());
        }
        if !saved.levels.fits(&self.levels) || !saved.times.iter().all(|time| time.is_finite() && *time >= 0.0) {
            return malformed("levels that no contact has");
        }
        Ok(saved)
    }

    fn fingerprint(&self) -> (u64, f64, f64) {
        let states = self.states();
        (states.states().len() as u64, states.last_level(), states.last_depth())
    }
}
