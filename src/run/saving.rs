//! Runs in files: saved now and then, and resumed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::contact::checkpoint::{Attached, NO_RUN, malformed};
use crate::contact::{StepReport, ViscoelasticContact};
use crate::error::{Refusal, Result};
use crate::run::Contact;
use crate::run::autosave::Autosave;
use crate::run::follow::Run;
use crate::run::progress::Progress;
use crate::run::step_control::StepControl;

impl ViscoelasticContact {
    /// Saves the whole state to a file: a contact that is built like this one and continues from it
    /// ([`ViscoelasticContact::resume`]) takes the same steps, bitwise, on any number of threads.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// The file is complete and on the medium when this returns; until then, what was there before is not touched. It
    /// carries the version of its format, a checksum and a fingerprint of the scene. About 50 bytes per computed cell, 8
    /// more for each relaxation time, and, once the indenter has moved or changed, 8 per cell of the whole grid.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let build = || {
    ///     ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///         .build()
    /// };
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-checkpoint-{}", std::process::id()));
    /// let mut contact = build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// contact.save(&path)?;
    /// contact.step(0.1, Load::force(0.5))?;
    ///
    /// let mut again = build()?; // after a power cut
    /// again.resume(&path)?;
    /// again.step(0.1, Load::force(0.5))?;
    /// assert_eq!(contact.pressure(), again.pressure());
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// Contacts may save to one path at once: the file always belongs to one of them, in the end to the last to
    /// finish. Where the path is a link, the file that it leads to is replaced.
    ///
    /// Where [ranks](crate::parallel) share out the contact, it is a call of all of them: rank 0 writes the file, and
    /// the others send it their rows, some at a time. Any number of ranks can resume from it, and one process too.
    /// Ranks can resume from the file of one process that computed the whole grid, as with
    /// [`Settings::window`](crate::contact::Settings::window) set to false.
    ///
    /// # Errors
    /// If the file cannot be written, or there is something other than a file at `path`.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_with::<(Progress, StepControl)>(path.as_ref(), None)
    }

    /// What [`ViscoelasticContact::save`] writes, in memory: for pickles, and for messages between processes. On ranks
    /// the first one has it.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If a rank is lost.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        self.bytes_with::<(Progress, StepControl)>(None)
    }

    /// [`ViscoelasticContact::resume`] from the bytes of [`ViscoelasticContact::to_bytes`], or of a file.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::resume`].
    pub fn resume_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        let run = self.resume_bytes_with(bytes, &check)?;
        self.saved_run = run.map(|run| Arc::new(run) as _);
        Ok(())
    }

    /// Puts a saved state in the place of this one. The contact must be built as the one was that was saved: same
    /// grid, bodies, kernel, geometry and material. Settings may differ in how steps are solved (solver, tolerance,
    /// iterations, edge, memory), not in the rest. Where an indenter has moved, it is where it was.
    ///
    /// Scenes are compared part by part, by numbers: the series of the material, sums over the gap and over the
    /// coefficients of a kernel of one's own, the values of an attraction at some gaps. A run along a history that
    /// saved the contact ([`Run::autosave_to`](crate::run::Run::autosave_to)) resumes with the next
    /// [`Contact::follow`].
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be read, is no checkpoint, is of another format, damaged or truncated, or of another
    /// scene ([`Error::Checkpoint`](crate::Error::Checkpoint)); the contact is then as it was.
    ///
    /// Where [ranks](crate::parallel) share out the contact, it is a call of all of them, which must all see the
    /// file. Each rank reads its rows and checks its part of the file. An error of one rank is an error on all
    /// ([`RanksError::Failed`](crate::parallel::RanksError::Failed)). Ranks cannot resume from a window of the grid
    /// ([`Settings::window`](crate::contact::Settings::window)), nor after an indenter has moved or a load has broken
    /// the symmetry of the scene.
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let run = self.resume_with(path.as_ref(), &check)?;
        self.saved_run = run.map(|run| Arc::new(run) as _);
        Ok(())
    }
}

impl<C: Contact> Run<'_, C> {
    /// Saves the run to `path` whenever `every` has passed, after the step under way then, and at its end. An
    /// interruption loses no more than that. A contact that is built alike resumes from the file
    /// ([`ViscoelasticContact::resume`]): the next run of the same stepping takes the same steps, bitwise. Where
    /// [ranks](crate::parallel) share out the contact, all of them save when the time has passed on one.
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
        self.autosave = Some(Autosave { path: path.into(), every, last: Instant::now(), unreported: None });
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
        self.control.save_run(&self.contact, &self.progress, path.as_ref())
    }

    /// Takes the next step, and saves the run if that is due or the run is over.
    pub(super) fn take_and_save(&mut self) -> Result<Option<StepReport>> {
        let report = match self.autosave.as_mut().and_then(|autosave| autosave.unreported.take()) {
            Some(report) => report,
            None => self.take_next()?,
        };
        let Some(autosave) = &self.autosave else { return Ok(report) };
        let (due, path) = (report.is_none() || autosave.last.elapsed() >= autosave.every, autosave.path.clone());
        let saved = self
            .control
            .is_due(&self.contact, due)
            .and_then(|due| if due { self.save(path).map(|()| true) } else { Ok(false) });
        if let Some(autosave) = &mut self.autosave {
            match saved {
                Ok(true) => autosave.last = Instant::now(),
                Ok(false) => {}
                Err(_) => autosave.unreported = Some(report),
            }
        }
        saved.map(|_| report)
    }
}

impl Attached for (Progress, StepControl) {
    const KIND: &'static str = "in space";
}

fn check(run: Option<&(Progress, StepControl)>) -> Result<(), Refusal> {
    match run {
        Some((progress, control)) if !progress.fits() || !control.fits() => Err(malformed(NO_RUN)),
        _ => Ok(()),
    }
}
