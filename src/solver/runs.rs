//! Runs: cells in contact that follow each other in memory, as pieces of rows do.

use std::ops::Range;

use crate::sum::{greatest, sum};

/// Cells checked together in the search for runs.
const SEARCH_BLOCK: usize = 32;

/// Cells passed over together: their fields remain in the fastest cache.
const PIECE_CELLS: usize = 256;

/// The runs, each as its first cell and the one after its last.
#[derive(Debug, Clone, Default)]
pub(crate) struct Runs {
    runs: Vec<[u32; 2]>,
    cells: usize,
}

impl Runs {
    pub(crate) fn with_capacity(cells: usize) -> Runs {
        Runs { runs: Vec::with_capacity(cells.div_ceil(2)), cells: 0 }
    }

    /// Finds the runs of members of a set.
    pub(crate) fn find(&mut self, member: &[bool]) {
        self.runs.clear();
        let mut start = None;
        for (block, values) in member.chunks(SEARCH_BLOCK).enumerate() {
            // most blocks are all inside or all outside, as the cell before them
            let inside = start.is_some();
            if values.iter().fold(true, |same, &m| same & (m == inside)) {
                continue;
            }
            for (k, &m) in values.iter().enumerate() {
                let k = (block * SEARCH_BLOCK + k) as u32;
                match start {
                    None if m => start = Some(k),
                    Some(first) if !m => {
                        self.runs.push([first, k]);
                        start = None;
                    }
                    _ => {}
                }
            }
        }
        self.runs.extend(start.map(|first| [first, member.len() as u32]));
        self.cells = self.ranges().map(|run| run.len()).sum();
    }

    /// Number of cells in all runs.
    pub(crate) fn count(&self) -> usize {
        self.cells
    }

    /// Σ values over the runs.
    pub(crate) fn sum(&self, values: &[f64]) -> f64 {
        self.ranges().map(|run| sum(&values[run])).sum()
    }

    /// The greatest |value| over the runs.
    pub(crate) fn greatest(&self, values: &[f64]) -> f64 {
        self.ranges().map(|run| greatest(&values[run])).fold(0.0, f64::max)
    }

    /// The parts of runs that lie in a band.
    pub(crate) fn within(&self, band: &Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let (start, end) = (band.start, band.end);
        let first = self.runs.partition_point(|run| run[1] as usize <= start);
        let runs = self.runs[first..].iter().map(|run| run.map(|k| k as usize)).take_while(move |run| run[0] < end);
        runs.map(move |run| run[0].max(start)..run[1].min(end))
    }

    /// Calls `visit` with pieces of a band, counted from its beginning, and whether they are in contact.
    pub(crate) fn walk(&self, band: &Range<usize>, mut visit: impl FnMut(Range<usize>, bool)) {
        let mut outside = 0;
        for run in self.within(band).map(|run| run.start - band.start..run.end - band.start) {
            pieces(outside..run.start).for_each(|piece| visit(piece, false));
            outside = run.end;
            pieces(run).for_each(|piece| visit(piece, true));
        }
        pieces(outside..band.len()).for_each(|piece| visit(piece, false));
    }

    pub(crate) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.runs.iter().map(|[start, end]| *start as usize..*end as usize)
    }
}

fn pieces(run: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    run.clone().step_by(PIECE_CELLS).map(move |start| start..(start + PIECE_CELLS).min(run.end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_the_members() {
        for (cells, period, length) in [(1, 1, 1), (100, 7, 3), (96, 48, 40), (97, 97, 97), (64, 33, 32), (200, 1, 0)] {
            let member: Vec<bool> = (0..cells).map(|k| k % period < length).collect();
            let mut runs = Runs::with_capacity(cells);
            runs.find(&member);
            let mut found = vec![false; cells];
            runs.ranges().for_each(|run| found[run].fill(true));
            assert_eq!(found, member);
            assert!(runs.runs.windows(2).all(|pair| pair[0][1] < pair[1][0]), "runs do not touch");
        }
    }
}
