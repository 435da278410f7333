//! Checkpoint and resume: the state of a contact in a file, and on from there.

pub(in crate::contact) mod autosave;
mod distributed;
mod format;
mod redistribution;
mod saved;
pub(in crate::contact) mod scene_fingerprint;

use std::path::Path;

use crate::contact::computation::Computation;
use crate::contact::run::progress::Progress;
use crate::contact::state::State;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{CheckpointError, Error, Result};
use crate::file::replace;
use distributed::Common;
use format::{Kind, Whole};
use saved::Saved;

impl ViscoelasticContact {
    /// Saves the whole state to a file: a contact that is built like this one and continues from it
    /// ([`ViscoelasticContact::resume`]) takes the same steps, bitwise, on any number of threads.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// The file is complete and on the medium when this returns; until then, what was there before is not touched. It carries the version
    /// of its format, its length and a checksum. About 50 bytes per computed cell, 8 more for each relaxation time, and 8 per cell of the
    /// whole grid.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let build = || {
    ///     ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
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
    /// Where [ranks](crate::parallel) share out the contact, it is a call of all of them. Each writes its rows to a file of its own
    /// beside `path`, whose name continues with a mark of the save and a number; the folder must be common to all. Then the file at `path`,
    /// which names them, is replaced, and the files of the previous save are removed. Whenever ranks are lost, it leads to all
    /// files of one save. What they had begun to write is left, and removed with the save after the next; so only one group may
    /// save to a path at a time. Any number of ranks can resume from it, one process too, and any number of ranks from the file
    /// of one process.
    ///
    /// # Errors
    /// If the file cannot be written, or there is something other than a file at `path` ([`Error::NotAFile`]).
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_with(path.as_ref(), None)
    }

    /// [`ViscoelasticContact::save`] with how far a run along a history has come.
    pub(super) fn save_with(&self, path: &Path, progress: Option<&Progress>) -> Result<()> {
        let rows = self.computation.state.region.rows();
        if let Some(group) = rows.group() {
            return rows.together(|| distributed::save(self, path, progress, (&rows, &**group)));
        }
        let old = distributed::mark_at(path);
        replace(path, |out| format::write(out, Kind::Whole, &Saved::of(self, progress)).map(drop))?;
        old.into_iter().for_each(|old| distributed::remove_until(path, old));
        Ok(())
    }

    /// Puts a saved state in the place of this one. The contact must be built as the one was that was saved: same grid, bodies,
    /// kernel, geometry and material. Settings may differ in how steps are solved (solver, tolerance, iterations, edge,
    /// memory), not in the rest. Where an indenter has moved, it is where it was.
    ///
    /// Scenes are compared by sums over gap and influence, the rigid body that each cell belongs to, and materials by their series, or by their compliance at eight times a decade
    /// where they have none: closures that agree there cannot be told apart. A run along a history that saved it
    /// ([`Follow::autosave_to`](crate::contact::Follow::autosave_to)) goes on where it was with the next
    /// [`ViscoelasticContact::follow`].
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be read, is no checkpoint, is of a newer or older format, cut short, damaged, or of another scene
    /// ([`Error::Checkpoint`]); the contact is then as it was. If ranks saved it, and one of their files is missing, damaged or of
    /// another save ([`CheckpointError::Rows`]).
    ///
    /// Where [ranks](crate::parallel) share out the contact, each reads what holds its rows, one file at a time; all must be
    /// able to go on ([`RanksError::Failed`](crate::parallel::RanksError::Failed)). They can not from a window of the grid
    /// ([`Settings::window`](crate::contact::Settings::window)), nor from where an indenter has moved
    /// ([`CheckpointError::OtherScene`]).
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let (path, rows) = (path.as_ref(), self.computation.state.region.rows());
        rows.together(|| {
            let read = self.read(path).map_err(|source| Error::Checkpoint { path: path.to_owned(), source });
            let (mut state, progress, checksum) = rows.agree(read)?;
            // not one save on one rank and the next on another
            rows.same([f64::from(checksum)])?;
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

    /// The state in a file on the rows of this contact, how far a run had come, and the checksum of the file.
    fn read(&self, path: &Path) -> Result<(State, Option<Progress>, u32), CheckpointError> {
        let file = Whole::open(path)?;
        let checksum = file.checksum;
        let (state, progress) = match file.kind {
            Kind::Whole => file.contents::<Saved<'_>>()?.state_for(self)?,
            Kind::Ranks => file.contents::<Common<'_>>()?.state_for(self, path)?,
            Kind::Rows => return Err(CheckpointError::RowsAlone),
        };
        Ok((state, progress, checksum))
    }
}
