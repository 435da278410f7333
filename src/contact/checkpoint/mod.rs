//! Checkpoint and resume: the state of a contact in a file, and on from there.

pub(in crate::contact) mod built;
mod fields;
pub(crate) mod format;
mod saved;
mod scene_fingerprint;

use std::borrow::Cow;
use std::io;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::contact::{Computation, State, ViscoelasticContact};
use crate::equilibrium::{Held, Indenter};
use crate::error::{CheckpointError, Error, Result};
use crate::geometry::Gap;
use crate::parallel::Rows;
use built::Built;
use fields::{FieldWriter, read_state};
use format::{Input, Output};
pub(crate) use saved::check_clocks;
use saved::{Saved, check_fields, malformed, moved_indenter};
use scene_fingerprint::difference;

/// How far a run has come, as a file keeps it. Runs use contacts, so their type is a parameter here.
pub(crate) trait SavedRun: Clone + Serialize + DeserializeOwned {
    /// Whether a run can continue from these values; a damaged file may hold any.
    fn fits(&self) -> bool;
}

impl ViscoelasticContact {
    /// [`ViscoelasticContact::save`] with how far a run along a history has come.
    pub(crate) fn save_with<P: SavedRun>(&self, path: &Path, progress: Option<&P>) -> Result<()> {
        let Held { region, indenter, .. } = &self.computation.state.held;
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
            let (gap, n2) = (saved.gap_region(self), self.scene.ground.grid.cells()[1]);
            let place = |k| if gap.is_shared() { k } else { gap.cell(k)[0] * n2 + gap.cell(k)[1] };
            fields.rows(&gap.rows(), |cells| cells.map(|k| above[place(k)]));
            fields.finish()
        })
    }

    /// Puts a saved state in the place of this one, and returns the run that saved it.
    pub(crate) fn resume_with<P: SavedRun>(&mut self, path: &Path) -> Result<Option<P>> {
        let rows = self.computation.state.held.region.rows();
        rows.unless_lost(|| {
            let (mut state, progress) = self.read(path, &rows)?;
            state.sum_up();
            if state.indenter_is_new {
                // the indenter of the last step is not saved
                state.history.forget_start();
            }
            let computation = Computation::new(&self.scene, state);
            rows.intact()?;
            self.computation = computation;
            self.view.refresh(&self.computation.state.held);
            Ok(progress)
        })
    }

    /// The state in a file on the rows of this contact, and how far a run had come. A call of all ranks.
    fn read<P: SavedRun>(&self, path: &Path, rows: &Rows) -> Result<(State, Option<P>)> {
        let all = Agreement { path, rows };
        let mut file = all.of(Input::open(path))?;
        // not one save on one rank and the next on another
        rows.same([f64::from(file.stated_checksum())])?;
        let own = all.of(if rows.rank() == 0 { file.checksum() } else { Ok(0) })?;
        all.of(file.require_checksum(rows.greatest(f64::from(own)) as u32))?;
        let saved = file.contents::<Saved<'_, P>>().and_then(|saved| {
            saved.check(self)?;
            if file.has_values(saved.values(self)) { Ok(saved) } else { malformed("fields that do not fit its region") }
        });
        let saved = all.of(saved)?;

        let own = &self.computation.state;
        let (region, gap_region) =
            (saved.state.held.region.clone().shared_like(&own.held.region), saved.gap_region(self));
        let read = read_state(&mut file, &saved.state, &region).and_then(|state| {
            let Gap { datum, owner, .. } = saved.state.held.indenter.gap().clone();
            let gap = Gap { datum, owner, above: file.rows(&gap_region.rows())? };
            check_fields(&state, &gap).map(|()| (state, gap))
        });
        let (state, mut gap) = all.of(read)?;
        let indenter = if region.is_shared() {
            let moved = difference(&Built::new(&gap, &region).shape, &self.scene.built.shape).is_some();
            all.of(if moved { Err(moved_indenter()) } else { Ok(()) })?;
            own.held.indenter.with_gap_on(&region, gap)
        } else {
            let mut whole = vec![0.0; self.scene.ground.grid.len()];
            gap_region.show(&gap.above, &mut whole);
            gap.above = whole;
            Indenter::new(gap, self.scene.ground.bodies)
        };
        let held = Held { indenter: Arc::new(indenter), ..state.held };
        Ok((State { held, ..state }, saved.progress.map(Cow::into_owned)))
    }
}

/// Makes an error of one rank that reads a file an error of all.
struct Agreement<'a> {
    path: &'a Path,
    rows: &'a Rows,
}

impl Agreement<'_> {
    fn of<T>(&self, own: Result<T, CheckpointError>) -> Result<T> {
        self.rows.agree(own.map_err(|cause| Error::Checkpoint { path: self.path.to_owned(), cause }))
    }
}
