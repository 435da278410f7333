//! The fields of a state in a file: one after the other, each by the rows of the whole region. Rank 0 writes them,
//! and the others bring their rows, some at a time; each rank reads its rows.

use std::io::{self, Write};
use std::ops::Range;

use super::{Input, Output};
use crate::contact::State;
use crate::equilibrium::Region;
use crate::error::CheckpointError;
use crate::hereditary::{Role, interleaved, runs};
use crate::parallel::Rows;

/// Values that ranks bring at a time, or one row where that is more.
const PIECE: usize = 1 << 16;

/// Writes fields to the file of rank 0. A rank continues after writing has failed, since the others wait for its rows.
pub(super) struct FieldWriter<'a> {
    out: Option<Output<'a>>,
    written: io::Result<()>,
    bytes: Vec<u8>,
}

impl<'a> FieldWriter<'a> {
    /// Continues a file, if this rank has begun one.
    pub(super) fn new(begun: Option<io::Result<Output<'a>>>) -> FieldWriter<'a> {
        let (out, written) = match begun.transpose() {
            Ok(out) => (out, Ok(())),
            Err(error) => (None, Err(error)),
        };
        FieldWriter { out, written, bytes: Vec::new() }
    }

    /// Writes all fields of a state.
    pub(super) fn state(&mut self, state: &State) {
        let rows = state.held.region.rows();
        state.each(&mut |field| {
            if let Role::Work = field.role {
                return;
            }
            for which in 0..field.per_cell {
                let own = |cells: Range<usize>| {
                    runs([field.per_cell, which], state.held.region.len(), cells)
                        .flat_map(|run| &field.values[run])
                        .copied()
                };
                self.rows(&rows, own);
            }
        });
    }

    /// Writes one value of each cell of all rows; `own` gives the values of some local cells.
    pub(super) fn rows<V: Iterator<Item = f64>>(&mut self, rows: &Rows, own: impl Fn(Range<usize>) -> V) {
        let [all, columns] = rows.cells();
        let most = (PIECE / columns).max(1);
        for piece in (0..all).step_by(most).map(|start| start..(start + most).min(all)) {
            let common = |rows: Range<usize>| rows.start.max(piece.start)..rows.end.min(piece.end);
            let (local, first) = (common(rows.own()), rows.own().start);
            let cells = |row: usize| (row - first) * columns;
            let values = own(if local.is_empty() { 0..0 } else { cells(local.start)..cells(local.end) });
            if rows.are_shared() {
                let mut pieces = vec![Vec::new(); rows.ranks()];
                pieces[0] = values.collect();
                let count = |rank| if rows.rank() == 0 { common(rows.of(rank)).len() * columns } else { 0 };
                self.write(rows.exchange(pieces, count).into_iter());
            } else {
                self.write(values);
            }
        }
    }

    fn write(&mut self, values: impl Iterator<Item = f64>) {
        if let (Some(out), Ok(())) = (&mut self.out, &self.written) {
            self.bytes.clear();
            values.for_each(|value| self.bytes.extend_from_slice(&value.to_le_bytes()));
            self.written = out.write_all(&self.bytes);
        }
    }

    /// Completes the file.
    pub(super) fn finish(self) -> io::Result<()> {
        self.written?;
        self.out.map_or(Ok(()), Output::finish)
    }
}

/// Reads all fields of a state, on the local rows of a region.
pub(super) fn read_state(file: &mut Input, layout: &State, region: &Region) -> Result<State, CheckpointError> {
    let (rows, cells) = (region.rows(), region.len());
    let mut sound = Ok(());
    let state = layout.map(region, &mut |field| match field.role {
        Role::Work => vec![0.0; field.per_cell * cells],
        _ => interleaved(field.per_cell, cells, |_| {
            file.rows(&rows).unwrap_or_else(|error| {
                sound = Err(error);
                Vec::new()
            })
        }),
    });
    sound.map(|()| state)
}
