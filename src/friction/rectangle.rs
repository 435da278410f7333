//! The rectangle of cells on which tractions along the surface have acted.

use std::ops::Range;

use crate::Grid;
use crate::kernel::fast_length;

/// A rectangle of cells of a grid: the first along each axis, and their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rectangle {
    pub(super) start: [usize; 2],
    pub(super) cells: [usize; 2],
}

impl Rectangle {
    pub(super) fn len(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Indices on a grid of its cells, row by row.
    pub(super) fn on_grid(&self, columns: usize) -> impl Iterator<Item = usize> + use<> {
        let Rectangle { start, cells } = *self;
        (0..cells[0]).flat_map(move |i| {
            let first = (start[0] + i) * columns + start[1];
            first..first + cells[1]
        })
    }

    /// Where a cell of the grid is in it.
    fn place(&self, cell: [usize; 2]) -> Option<usize> {
        let at = [0, 1].map(|axis| cell[axis].checked_sub(self.start[axis]).filter(|&k| k < self.cells[axis]));
        Some(at[0]? * self.cells[1] + at[1]?)
    }

    /// Where each cell of another one is in it.
    pub(super) fn places_of<'a>(&'a self, other: &'a Rectangle) -> impl Iterator<Item = Option<usize>> + 'a {
        let Rectangle { start, cells } = *other;
        (0..other.len()).map(move |k| self.place([start[0] + k / cells[1], start[1] + k % cells[1]]))
    }

    /// The least one with all of it and cells that touch, with room up to the next fast transform; all of a periodic
    /// axis.
    pub(super) fn grown_to(&self, touching: [Range<usize>; 2], grid: &Grid, periodic: [bool; 2]) -> Rectangle {
        let axis = |axis: usize| {
            let (all, touching) = (grid.cells()[axis], &touching[axis]);
            if periodic[axis] {
                return (0, all);
            }
            let (start, cells) = (self.start[axis], self.cells[axis]);
            let (first, end) = if cells == 0 {
                (touching.start, touching.end)
            } else {
                (start.min(touching.start), (start + cells).max(touching.end))
            };
            if (first, end) == (start, start + cells) {
                return (start, cells);
            }
            // padded to twice its length less one
            let room = fast_length(2 * (end - first) - 1).div_ceil(2).min(all);
            (first.saturating_sub((room - (end - first)) / 2).min(all - room), room)
        };
        let ((first, rows), (second, columns)) = (axis(0), axis(1));
        Rectangle { start: [first, second], cells: [rows, columns] }
    }
}

/// The rows and columns between which a field is positive.
pub(super) fn extent(field: &[f64], columns: usize) -> Option<[Range<usize>; 2]> {
    let mut found: Option<[Range<usize>; 2]> = None;
    for (i, row) in field.chunks_exact(columns).enumerate() {
        let Some(first) = row.iter().position(|p| *p > 0.0) else { continue };
        let last = row.iter().rposition(|p| *p > 0.0).unwrap_or(first);
        let [rows, all] = found.get_or_insert([i..i + 1, first..last + 1]);
        (rows.end, *all) = (i + 1, all.start.min(first)..all.end.max(last + 1));
    }
    found
}
