//! The fields of a contact cut into bands, which threads may share.

use std::ops::Range;

use crate::kernel::{BAND_CELLS, join, lanes, middle};

/// Lanes in which maxima are taken.
pub(crate) const LANES: usize = 8;

/// Sums and maximum of a pass over the cells of one body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) sums: [f64; 10],
    greatest: [f64; LANES],
    /// The greatest of other values, taken one piece at a time.
    pub(crate) peak: f64,
}

impl Found {
    const NOTHING: Found = Found { sums: [0.0; 10], greatest: [f64::NEG_INFINITY; LANES], peak: f64::NEG_INFINITY };

    pub(crate) fn greatest(&self) -> f64 {
        self.greatest.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Takes the values of `f` for every pair of values, and its number, into the maximum.
    #[inline(always)]
    pub(crate) fn raise(&mut self, [x, y]: [&[f64]; 2], f: impl Fn(f64, f64, f64) -> f64) {
        let mut lanes = self.greatest;
        let larger = |a: f64, b: f64| if b > a { b } else { a };
        let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
        let mut numbers = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        for (x, y) in x.iter().zip(y) {
            for lane in 0..LANES {
                lanes[lane] = larger(lanes[lane], f(x[lane], y[lane], numbers[lane]));
            }
            numbers.iter_mut().for_each(|number| *number += LANES as f64);
        }
        for ((lane, number), (&x, &y)) in lanes.iter_mut().zip(numbers).zip(x_rest.iter().zip(y_rest)) {
            *lane = larger(*lane, f(x, y, number));
        }
        self.greatest = lanes;
    }
}

/// The bands, and what a pass has found in each of them for each body.
#[derive(Debug, Clone)]
pub(crate) struct Bands {
    cells: usize,
    bodies: usize,
    found: Vec<Found>,
    shared: bool,
}

impl Bands {
    pub(crate) fn new(cells: usize, bodies: usize) -> Bands {
        let found = vec![Found::NOTHING; cells.div_ceil(BAND_CELLS) * bodies];
        Bands { cells, bodies, found, shared: lanes(cells) > 1 }
    }

    /// Bytes that the findings take.
    pub(crate) fn bytes(cells: usize, bodies: usize) -> usize {
        cells.div_ceil(BAND_CELLS).saturating_mul(bodies).saturating_mul(size_of::<Found>())
    }

    /// Calls `job` with each band, its part of `outputs`, and what it is to find for each body; returns what is found for
    /// each body in all bands.
    pub(crate) fn over<const M: usize>(
        &mut self,
        outputs: [&mut [f64]; M],
        job: impl Fn(Range<usize>, [&mut [f64]; M], &mut [Found]) + Sync,
    ) -> &[Found] {
        let Bands { cells, bodies, ref mut found, shared } = *self;
        halve(0..cells, outputs, found, bodies, shared, &|band, outputs, found: &mut [Found]| {
            found.fill(Found::NOTHING);
            job(band, outputs, found);
        });
        let (all, others) = found.split_at_mut(bodies);
        for band in others.chunks(bodies) {
            for (all, found) in all.iter_mut().zip(band) {
                all.sums.iter_mut().zip(found.sums).for_each(|(sum, part)| *sum += part);
                all.peak = all.peak.max(found.peak);
                all.greatest.iter_mut().zip(found.greatest).for_each(|(most, found)| *most = most.max(found));
            }
        }
        all
    }
}

/// Halves the cells down to single bands, and calls `job` with each.
fn halve<const M: usize>(
    cells: Range<usize>,
    outputs: [&mut [f64]; M],
    found: &mut [Found],
    bodies: usize,
    shared: bool,
    job: &(impl Fn(Range<usize>, [&mut [f64]; M], &mut [Found]) + Sync),
) {
    if found.len() == bodies {
        return job(cells, outputs, found);
    }
    let middle = middle(cells.len());
    let bands = middle / BAND_CELLS;
    let mut halves = outputs.map(|output| output.split_at_mut(middle));
    let first = halves.each_mut().map(|(first, _)| std::mem::take(first));
    let second = halves.map(|(_, second)| second);
    let (found, others) = found.split_at_mut(bands * bodies);
    let (before, after) = (cells.start..cells.start + middle, cells.start + middle..cells.end);
    join(
        shared,
        || halve(before, first, found, bodies, shared, job),
        || halve(after, second, others, bodies, shared, job),
    );
}
