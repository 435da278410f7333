//! Row segments: cells in contact that follow each other in memory, and the pieces of rows in which passes visit them.

use std::ops::Range;

/// Cells that the search for runs checks together.
const SEARCH_BLOCK: usize = 32;

/// Cells visited together: their fields remain in the fastest cache.
pub(crate) const PIECE_CELLS: usize = 256;

/// Cells that follow each other and belong to one body. Where bodies tilt, they lie in one row, along which the
/// motion of the body is affine.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    pub(crate) cells: Range<usize>,
    pub(crate) body: usize,
}

/// Where the cells of a grid are cut into pieces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cut<'a> {
    /// Cells of a row; `usize::MAX` where no body tilts, and pieces may reach over the end of a row.
    pub(crate) columns: usize,
    /// The body that each cell belongs to; `None` where there is one.
    pub(crate) owner: Option<&'a [u16]>,
}

/// The runs of cells in contact, each as its first cell and the cell after its last.
#[derive(Debug, Clone, Default)]
pub(crate) struct RowSegments {
    runs: Vec<[u32; 2]>,
}

impl RowSegments {
    pub(crate) fn with_capacity(cells: usize) -> RowSegments {
        RowSegments { runs: Vec::with_capacity(cells.div_ceil(2)) }
    }

    /// Finds the runs of members of a set.
    pub(crate) fn find(&mut self, member: &[bool]) {
        self.runs.clear();
        let mut inside = false;
        for (block, values) in member.chunks(SEARCH_BLOCK).enumerate() {
            // most blocks are all inside or all outside, as the cell before them
            if values.iter().fold(true, |same, &m| same & (m == inside)) {
                continue;
            }
            for (k, &m) in (block * SEARCH_BLOCK..).zip(values) {
                match self.runs.last_mut() {
                    _ if m == inside => continue,
                    Some(last) if inside => last[1] = k as u32,
                    _ => self.runs.push([k as u32, member.len() as u32]),
                }
                inside = m;
            }
        }
    }

    /// The cells of all runs.
    pub(crate) fn cells(&self) -> impl Iterator<Item = usize> {
        self.runs.iter().flat_map(|&[start, end]| start as usize..end as usize)
    }

    /// The cells outside the runs.
    pub(crate) fn outside(&self, cells: usize) -> impl Iterator<Item = Range<usize>> {
        let starts = std::iter::once(0).chain(self.runs.iter().map(|run| run[1] as usize));
        starts.zip(self.runs.iter().map(|run| run[0] as usize).chain([cells])).map(|(start, end)| start..end)
    }

    /// The parts of runs that lie in a band.
    #[inline]
    fn within<'a>(&'a self, band: &Range<usize>) -> impl Iterator<Item = Range<usize>> + Clone + use<'a> {
        let (start, end) = (band.start, band.end);
        let first = self.runs.partition_point(|run| run[1] as usize <= start);
        let runs = self.runs[first..].iter().map(|run| run.map(|k| k as usize)).take_while(move |run| run[0] < end);
        runs.map(move |run| run[0].max(start)..run[1].min(end))
    }

    /// The pieces in contact that lie in a band.
    #[inline]
    pub(crate) fn inside<'a, 'c>(
        &'a self,
        band: &Range<usize>,
        cut: Cut<'c>,
    ) -> impl Iterator<Item = Piece> + Clone + use<'a, 'c> {
        self.within(band).flat_map(move |run| cut.pieces(run))
    }

    /// Calls `visit` with the pieces of a band, and whether they are in contact.
    #[inline]
    pub(crate) fn walk(&self, band: &Range<usize>, cut: Cut<'_>, mut visit: impl FnMut(Piece, bool)) {
        let mut outside = band.start;
        for run in self.within(band) {
            cut.pieces(outside..run.start).for_each(|piece| visit(piece, false));
            outside = run.end;
            cut.pieces(run).for_each(|piece| visit(piece, true));
        }
        cut.pieces(outside..band.end).for_each(|piece| visit(piece, false));
    }
}

impl<'a> Cut<'a> {
    /// Cuts cells that follow each other.
    #[inline]
    pub(crate) fn pieces(self, cells: Range<usize>) -> Pieces<'a> {
        let row_end = (cells.start / self.columns + 1).saturating_mul(self.columns);
        Pieces { cut: self, start: cells.start, end: cells.end, row_end }
    }
}

/// The pieces of cells that follow each other.
#[derive(Clone)]
pub(crate) struct Pieces<'a> {
    cut: Cut<'a>,
    start: usize,
    end: usize,
    row_end: usize,
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    // in every loop over cells: a call would cost a hundredth of a step
    #[inline(always)]
    fn next(&mut self) -> Option<Piece> {
        let Pieces { cut, start, end, row_end } = self;
        if *start == *end {
            return None;
        }
        let mut piece = *start..(*start + PIECE_CELLS).min(*end).min(*row_end);
        let mut body = 0;
        if let Some(owner) = cut.owner {
            body = owner[*start].into();
            piece.end = *start + same(&owner[piece.clone()]);
        }
        *start = piece.end;
        if *start == *row_end {
            *row_end += cut.columns;
        }
        Some(Piece { cells: piece, body })
    }
}

/// Number of the first values that are equal.
fn same(values: &[u16]) -> usize {
    let mut count = 0;
    for block in values.chunks(SEARCH_BLOCK) {
        // most blocks belong to one body
        if !block.iter().fold(true, |same, &value| same & (value == values[0])) {
            return count + block.iter().take_while(|&&value| value == values[0]).count();
        }
        count += block.len();
    }
    count
}
