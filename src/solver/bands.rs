//! The fields of a contact cut into bands, which threads may share.

use std::ops::Range;

use crate::parallel::Rows;
use crate::parallel::{join, lanes};

/// Lanes in which maxima are taken.
pub(crate) const LANES: usize = 8;

/// Rigid bodies of a contact that ranks share out.
const MOST_SHARED_BODIES: usize = 1;

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

    /// Numbers that it consists of, once the lanes are joined.
    const NUMBERS: usize = 12;

    fn numbers(&self) -> [f64; Found::NUMBERS] {
        let mut numbers = [self.peak; Found::NUMBERS];
        numbers[..10].copy_from_slice(&self.sums);
        numbers[10] = self.greatest();
        numbers
    }

    fn of(numbers: &[f64; Found::NUMBERS]) -> Found {
        let mut found = Found { peak: numbers[11], ..Found::NOTHING };
        found.sums.copy_from_slice(&numbers[..10]);
        found.greatest[0] = numbers[10];
        found
    }

    /// Adds what is found in the next band.
    fn join(&mut self, next: &Found) {
        self.sums.iter_mut().zip(next.sums).for_each(|(sum, part)| *sum += part);
        self.peak = self.peak.max(next.peak);
        self.greatest.iter_mut().zip(next.greatest).for_each(|(most, found)| *most = most.max(found));
    }

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
    rows: Rows,
    bodies: usize,
    found: Vec<Found>,
    shared: bool,
}

impl Bands {
    pub(crate) fn new(rows: &Rows, bodies: usize) -> Bands {
        let found = vec![Found::NOTHING; rows.bands().max(1) * bodies];
        Bands { rows: rows.clone(), bodies, found, shared: lanes(rows.own().len() * rows.cells()[1]) > 1 }
    }

    /// Bytes that the findings take.
    pub(crate) fn bytes(rows: &Rows, bodies: usize) -> usize {
        rows.bands().saturating_mul(bodies).saturating_mul(size_of::<Found>())
    }

    /// Calls `job` with each own band, its part of `outputs`, and what it is to find for each body; returns what is found for
    /// each body in the bands of all ranks.
    pub(crate) fn over<const M: usize>(
        &mut self,
        outputs: [&mut [f64]; M],
        job: impl Fn(Range<usize>, [&mut [f64]; M], &mut [Found]) + Sync,
    ) -> &[Found] {
        let Bands { ref rows, bodies, ref mut found, shared } = *self;
        let cells = rows.own().len() * rows.cells()[1];
        halve(0..cells, outputs, found, (bodies, rows.band_cells()), shared, &|band, outputs, found: &mut [Found]| {
            found.fill(Found::NOTHING);
            job(band, outputs, found);
        });
        if rows.are_shared() {
            join_ranks(rows, bodies, found);
            return &found[..bodies];
        }
        let (all, others) = found.split_at_mut(bodies);
        for band in others.chunks(bodies) {
            all.iter_mut().zip(band).for_each(|(all, found)| all.join(found));
        }
        all
    }
}

/// Joins what was found in the bands of all ranks, in their order, to what comes first.
#[cold]
fn join_ranks(rows: &Rows, bodies: usize, found: &mut [Found]) {
    let own = found[..rows.bands() * bodies].iter().flat_map(Found::numbers);
    let count = |rank: usize| Found::NUMBERS * bodies * rows.bands_of(rank);
    let all = rows.gather(own, count, |all| {
        let mut all = all.as_chunks().0.iter().map(Found::of);
        let mut sums = [Found::NOTHING; MOST_SHARED_BODIES];
        sums[..bodies].fill_with(|| all.next().unwrap_or(Found::NOTHING));
        all.enumerate().for_each(|(k, found)| sums[k % bodies].join(&found));
        sums
    });
    if let Some(all) = all {
        found[..bodies].copy_from_slice(&all[..bodies]);
    }
}

/// What is done to a band: its cells, its parts of the outputs, and what is found in it.
type Job<'a, const M: usize> = dyn Fn(Range<usize>, [&mut [f64]; M], &mut [Found]) + Sync + 'a;

/// Halves the cells down to single bands, and calls `job` with each.
fn halve<const M: usize>(
    cells: Range<usize>,
    outputs: [&mut [f64]; M],
    found: &mut [Found],
    (bodies, band): (usize, usize),
    shared: bool,
    job: &Job<'_, M>,
) {
    if found.len() == bodies {
        return job(cells, outputs, found);
    }
    let bands = found.len() / bodies / 2;
    let middle = bands * band;
    let mut halves = outputs.map(|output| output.split_at_mut(middle));
    let first = halves.each_mut().map(|(first, _)| std::mem::take(first));
    let second = halves.map(|(_, second)| second);
    let (found, others) = found.split_at_mut(bands * bodies);
    let (before, after) = (cells.start..cells.start + middle, cells.start + middle..cells.end);
    join(
        shared,
        || halve(before, first, found, (bodies, band), shared, job),
        || halve(after, second, others, (bodies, band), shared, job),
    );
}
