//! Checkpoint and resume: the state of a contact in a file, and on from there.
//!
//! The public `save`, `to_bytes` and `resume` are in `run/saving.rs`, since a file may hold a run; those with friction
//! and on elastic states are in `friction/saved.rs` and `states/saved.rs`. What is saved is [`State`] by `serde`, and
//! its fields by [`State::map`].

mod check;
pub(crate) mod fingerprint;
pub(crate) mod format;

use std::borrow::Cow;
use std::io::{self, Cursor, Read, Seek, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::contact::{Computation, State, ViscoelasticContact};
use crate::equilibrium::{Held, Indenter, Region};
use crate::error::{Error, Refusal, Result};
use crate::file::in_memory;
use crate::geometry::{Gap, Missed};
use crate::hereditary::{Role, interleaved, runs};
use crate::parallel::Rows;
use check::check_fields;
pub(crate) use check::{check_clocks, malformed};
use fingerprint::Fingerprint;
use format::{CheckpointReader, CheckpointWriter, PIECE, damaged};

/// Why a run in a file is rejected.
pub(crate) const NO_RUN: &str = "a run that no contact can continue";

/// What a file holds beside the contact: a run, or what friction has done. `run` and `friction` stand on `contact`, so
/// that their types are a parameter here.
pub(crate) trait Attached: Clone + Serialize + DeserializeOwned {
    /// What tells its contacts from others.
    const KIND: &'static str;
}

/// Rejects what no contact can continue from: a damaged file may hold anything.
pub(crate) type Check<'a, P> = &'a dyn Fn(Option<&P>) -> Result<(), Refusal>;

/// What the fields of a file follow.
#[derive(Serialize, Deserialize)]
#[serde(bound(deserialize = "P: Attached"))]
struct Saved<'a, P: Attached> {
    /// On the region of all ranks, without fields.
    state: State,
    /// The gap, where it is no longer the one built, and what the grid misses of its waves.
    gap: Option<(Cow<'a, Gap>, Missed)>,
    attached: Option<Cow<'a, P>>,
}

impl ViscoelasticContact {
    /// [`ViscoelasticContact::save`] with more.
    pub(crate) fn save_with<P: Attached>(&self, path: &Path, attached: Option<&P>) -> Result<()> {
        self.computation.state.held.region.rows().replace_file(path, |out| self.write(out, attached))
    }

    /// What [`ViscoelasticContact::save_with`] writes, in memory.
    pub(crate) fn bytes_with<P: Attached>(&self, attached: Option<&P>) -> Result<Vec<u8>> {
        in_memory(|out| self.write(Some(out), attached))
    }

    /// Writes on the first rank the state of all.
    fn write<P: Attached>(&self, out: Option<&mut (impl Write + Seek)>, attached: Option<&P>) -> io::Result<()> {
        let state = &self.computation.state;
        let Held { region, indenter, .. } = &state.held;
        let rows = region.rows();
        let all = if region.is_shared() { Region::whole(&region.whole, region.folded()) } else { region.clone() };
        let saved = Saved {
            state: state.map(&all, &mut |_| Vec::new()),
            gap: (!Arc::ptr_eq(indenter, &self.built)).then(|| (Cow::Borrowed(indenter.gap()), indenter.missed)),
            attached: attached.map(Cow::Borrowed),
        };
        let scene = self.parts(P::KIND);
        let mut out = out.map(|out| CheckpointWriter::begin(out, &scene, &saved)).transpose();
        state.each(&mut |field| {
            let kept = if let Role::Work = field.role { 0 } else { field.per_cell };
            for which in 0..kept {
                let own = |cells: Range<usize>| {
                    let own = runs([field.per_cell, which], region.len(), cells);
                    own.flat_map(|run| &field.values[run]).copied().collect()
                };
                rows.in_pieces(own, |values| {
                    // after an error, too: the other ranks send their rows
                    if let Ok(Some(file)) = &mut out
                        && let Err(error) = file.values(&values)
                    {
                        out = Err(error);
                    }
                });
            }
        });
        out?.map_or(Ok(()), CheckpointWriter::finish)
    }

    /// Puts a saved state in the place of this one, and returns what was saved with it.
    pub(crate) fn resume_with<P: Attached>(&mut self, path: &Path, check: Check<'_, P>) -> Result<Option<P>> {
        self.resume_from(path, || CheckpointReader::open(path), check)
    }

    /// The same from the bytes of such a file.
    pub(crate) fn resume_bytes_with<P: Attached>(&mut self, bytes: &[u8], check: Check<'_, P>) -> Result<Option<P>> {
        self.resume_from(Path::new("bytes in memory"), || CheckpointReader::begin(Cursor::new(bytes)), check)
    }

    fn resume_from<P: Attached, R: Read + Seek>(
        &mut self,
        path: &Path,
        open: impl FnOnce() -> Result<CheckpointReader<R>, Refusal>,
        check: Check<'_, P>,
    ) -> Result<Option<P>> {
        let rows = self.computation.state.held.region.rows();
        rows.or_loss(|| {
            let failed = |cause| Error::Checkpoint { path: path.to_owned(), cause };
            let scene = self.parts(P::KIND);
            let mut file = rows.agree(open().map_err(failed))?;
            // not one save on one rank and the next on another
            rows.same([f64::from(file.stated_checksum)])?;
            let is_damaged = rows.any(rows.rank() == 0 && !file.is_intact());
            let read = if is_damaged { Err(damaged()) } else { self.read(&mut file, &scene, check) };
            let (mut state, attached) = rows.agree(read.map_err(failed))?;
            state.sum_up();
            if state.indenter_is_new {
                // the indenter of the last step is not saved
                state.history.forget_start();
            }
            let computation = Computation::new(&self.scene, state);
            rows.intact()?;
            self.computation = computation;
            self.view.refresh(&self.computation.state.held);
            Ok(attached)
        })
    }

    /// The state in a file on the local rows, and what else there is.
    fn read<P: Attached>(
        &self,
        file: &mut CheckpointReader<impl Read + Seek>,
        scene: &Fingerprint,
        check: Check<'_, P>,
    ) -> Result<(State, Option<P>), Refusal> {
        let Saved { mut state, gap, attached }: Saved<'_, P> = file.contents(scene)?;
        self.check(&state, gap.as_ref().map(|(gap, _)| &**gap))?;
        check(attached.as_deref())?;
        let bodies = self.scene.ground.bodies;
        let indenter = gap.map(|(gap, missed)| Arc::new(Indenter::new(gap.into_owned(), bodies).missing(missed)));
        state.held.indenter = indenter.unwrap_or_else(|| Arc::clone(&self.built));
        let region = state.held.region.clone().shared_like(&self.computation.state.held.region);
        let (rows, cells, mut sound) = (region.rows(), region.len(), Ok(()));
        let state = state.map(&region, &mut |field| match field.role {
            Role::Work => vec![0.0; field.per_cell * cells],
            _ => interleaved(field.per_cell, cells, |_| {
                file.field(&rows).unwrap_or_else(|error| {
                    sound = Err(error);
                    Vec::new()
                })
            }),
        });
        sound?;
        check_fields(&state)?;
        Ok((state, attached.map(Cow::into_owned)))
    }
}

impl Rows {
    /// Gives a field on all rows, some of them at a time, from what `own` gives of local cells; nothing on ranks but the
    /// first. A call of all ranks.
    fn in_pieces(&self, own: impl Fn(Range<usize>) -> Vec<f64>, mut take: impl FnMut(Vec<f64>)) {
        let [all, columns] = self.cells();
        let most = (PIECE / columns).max(1);
        for start in (0..all).step_by(most) {
            let count = |rows: &Range<usize>| rows.end.min(start + most).saturating_sub(rows.start.max(start));
            let local = self.own();
            let first = columns * (local.start.max(start) - local.start);
            let values = own(if count(&local) > 0 { first..first + columns * count(&local) } else { 0..0 });
            if !self.are_shared() {
                take(values);
                continue;
            }
            let mut pieces = vec![Vec::new(); self.ranks()];
            pieces[0] = values;
            take(self.exchange(pieces, |rank| if self.rank() == 0 { columns * count(&self.of(rank)) } else { 0 }));
        }
    }
}
