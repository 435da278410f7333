//! Checkpoint and resume: the state of a contact in a file, and on from there.

mod fields;
pub(crate) mod format;
mod saved;
pub(in crate::contact) mod scene_fingerprint;

use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crate::contact::run::progress::Autosave;
use crate::contact::{Computation, Indenter, Progress, Run, State, ViscoelasticContact};
use crate::error::{CheckpointError, Error, Result};
use crate::geometry::Gap;
use crate::parallel::Rows;
use fields::{FieldWriter, read_state};
use format::{Input, Output};
pub(crate) use saved::check_clocks;
use saved::{Saved, check_fields, malformed, moved_indenter};
use scene_fingerprint::{Built, difference};

impl ViscoelasticContact {
    /// Saves the whole state to a file: a contact that is built like this one and continues from it
    /// ([`ViscoelasticContact::resume`]) takes the same steps, bitwise, on any number of threads.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// The file is complete and on the medium when this returns; until then, what was there before is not touched. It carries the version
    /// of its format, its length and a checksum. About 50 bytes per computed cell, 8 more for each relaxation time, and 8 per cell of the
    /// whole grid, or of its computed part where the gap is symmetric.
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
    /// Contacts may save to one path at once: the file always belongs to one of them, in the end to the last to finish. Where the path
    /// is a link, the file that it leads to is replaced.
    ///
    /// Where [ranks](crate::parallel) share out the contact, it is a call of all of them: rank 0 writes the file, and the others
    /// send it their rows, some at a time. Any number of ranks can resume from it, one process too, and any number of ranks from
    /// the file of one process.
    ///
    /// # Errors
    /// If the file cannot be written, or there is something other than a file at `path` ([`FileError::NotAFile`](crate::FileError::NotAFile)).
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_with(path.as_ref(), None)
    }

    /// [`ViscoelasticContact::save`] with how far a run along a history has come.
    pub(super) fn save_with(&self, path: &Path, progress: Option<&Progress>) -> Result<()> {
        let State { region, indenter, .. } = &self.computation.state;
        let above = &indenter.gap().above;
        region.rows().replace_file(path, |out| {
            let saved = Saved::of(self, progress);
            let begun = out.map(|out| {
                let mut out = Output::begin(out)?;
                postcard::to_io(&saved, &mut out).map_err(io::Error::other)?;
                Ok(out)
            });
            let mut fields = FieldWriter::new(begun);
            fields.state(&self.computation.state);
            let (gap, n2) = (saved.gap_region(self), self.scene.grid.cells()[1]);
            let place = |k| if gap.is_shared() { k } else { gap.cell(k)[0] * n2 + gap.cell(k)[1] };
            fields.rows(&gap.rows(), |cells| cells.map(|k| above[place(k)]));
            fields.finish()
        })
    }

    /// Puts a saved state in the place of this one. The contact must be built as the one was that was saved: same grid, bodies,
    /// kernel, geometry and material. Settings may differ in how steps are solved (solver, tolerance, iterations, edge,
    /// memory), not in the rest. Where an indenter has moved, it is where it was.
    ///
    /// Scenes are compared by sums over gap and influence and by the rigid body of each cell. Materials are compared by their
    /// series, or, without a series, by their compliance at eight times a decade; closures with equal values there count as
    /// equal. A run along a history that saved the contact ([`Run::autosave_to`](crate::contact::Run::autosave_to)) resumes with
    /// the next [`ViscoelasticContact::follow`].
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be read, is no checkpoint, is of a newer or older format, cut short, damaged, or of another scene
    /// ([`Error::Checkpoint`]); the contact is then as it was.
    ///
    /// Where [ranks](crate::parallel) share out the contact, it is a call of all of them, which must all see the file. Each rank
    /// reads its rows and checks its part of the file. An error of one rank is an error on all
    /// ([`RanksError::Failed`](crate::parallel::RanksError::Failed)). Ranks cannot resume from a window of the grid
    /// ([`Settings::window`](crate::contact::Settings::window)), nor after an indenter has moved
    /// ([`CheckpointError::OtherScene`]).
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let (path, rows) = (path.as_ref(), self.computation.state.region.rows());
        rows.together(|| {
            let (mut state, progress) = self.read(path, &rows)?;
            state.sum_up();
            if state.indenter_is_new {
                // the indenter of the last step is not saved
                state.history.forget_start();
            }
            let computation = Computation::new(&self.scene, state);
            rows.intact()?;
            self.computation = computation;
            self.view.refresh(&self.computation.state);
            self.progress = progress.map(Box::new);
            Ok(())
        })
    }

    /// The state in a file on the rows of this contact, and how far a run had come. A call of all ranks.
    fn read(&self, path: &Path, rows: &Rows) -> Result<(State, Option<Progress>)> {
        let all = Agreement { path, rows };
        let mut file = all.of(Input::open(path))?;
        // not one save on one rank and the next on another
        rows.same([f64::from(file.stated_checksum())])?;
        let of_part = all.of(file.checksum_of_part(rows))?;
        all.of(file.require_checksum(rows, of_part))?;
        let saved = file.contents::<Saved<'_>>().and_then(|saved| {
            saved.check(self)?;
            if file.has_values(saved.values(self)) { Ok(saved) } else { malformed("fields that do not fit its region") }
        });
        let saved = all.of(saved)?;

        let own = &self.computation.state;
        let (region, gap_region) = (saved.state.region.clone().shared_like(&own.region), saved.gap_region(self));
        let read = read_state(&mut file, &saved.state, &region).and_then(|state| {
            let Gap { datum, owner, .. } = saved.state.indenter.gap().clone();
            let gap = Gap { datum, owner, above: file.rows(&gap_region.rows())? };
            check_fields(&state, &gap).map(|()| (state, gap))
        });
        let (state, mut gap) = all.of(read)?;
        let indenter = if region.is_shared() {
            let moved = difference(&Built::new(&gap, &region).shape, &self.scene.built.shape).is_some();
            all.of(if moved { Err(moved_indenter()) } else { Ok(()) })?;
            own.indenter.with_gap_on(&region, gap)
        } else {
            let mut whole = vec![0.0; self.scene.grid.len()];
            gap_region.show(&gap.above, &mut whole);
            gap.above = whole;
            Indenter::new(gap, self.scene.bodies)
        };
        Ok((State { indenter: Arc::new(indenter), ..state }, saved.progress.map(Cow::into_owned)))
    }
}

/// Makes an error of one rank that reads a file an error of all.
struct Agreement<'a> {
    path: &'a Path,
    rows: &'a Rows,
}

impl Agreement<'_> {
    fn of<T>(&self, own: Result<T, CheckpointError>) -> Result<T> {
        self.rows.agree(own.map_err(|source| Error::Checkpoint { path: self.path.to_owned(), source }))
    }
}

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
