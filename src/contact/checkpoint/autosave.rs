//! Runs along a load history that are saved on their way.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::contact::Run;
use crate::contact::run::progress::Autosave;
use crate::error::Result;

impl Run<'_> {
    /// Saves the run to `path` whenever `every` has passed, after the step under way then, and at its end. An interruption loses
    /// no more than that. A contact that is built alike resumes from the file ([`ViscoelasticContact::resume`]): the next run of
    /// the same stepping takes the same steps, bitwise. Where [ranks](crate::parallel) share out the
    /// contact, all of them save when the time has passed on one.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// ```
    /// use std::time::Duration;
    /// use viscocontact::prelude::*;
    ///
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-autosave-{}", std::process::id()));
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// if path.exists() {
    ///     contact.resume(&path)?; // where the run was when it was cut off
    /// }
    /// let load = StepLoad::new(Load::force(0.5))?;
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 1.0).autosave_to(&path, Duration::from_secs(60));
    /// while run.next_step()?.is_some() {}
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// [`ViscoelasticContact::resume`]: crate::ViscoelasticContact::resume
    pub fn autosave_to(mut self, path: impl Into<PathBuf>, every: Duration) -> Self {
        self.autosave = Some(Autosave::new(path.into(), every));
        self
    }

    /// Saves the run to a file now.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.progress.now = self.contact.time();
        self.contact.save_with(path.as_ref(), Some(&self.progress))
    }

    /// Saves the run if that is due, or the run is `over`.
    pub(in crate::contact) fn autosave(&mut self, over: bool) -> Result<()> {
        let Some(autosave) = &self.autosave else { return Ok(()) };
        let (due, rows) = (over || autosave.is_due(), self.contact.computation.state.region.rows());
        // clocks differ: where it is due on one rank, it is on all
        if !rows.together(|| Ok(rows.any(due)))? {
            return Ok(());
        }
        let path = autosave.path.clone();
        self.save(path)?;
        self.autosave.iter_mut().for_each(Autosave::done);
        Ok(())
    }
}
