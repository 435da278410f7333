//! The fields of a contact cut into bands, which threads may share.

use std::ops::Range;

use crate::parallel::{Rows, join, lanes};
use crate::sum;

/// Lanes in which maxima are taken.
pub(crate) const LANES: usize = 8;

/// Rigid bodies of a contact that ranks share out.
const MOST_SHARED_BODIES: usize = 1;

/// Sums of a pass over the cells in contact under one body, with the modes B of its motion; a pass finds some of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BandSums {
    /// Σ B r, of the residual r or of the preconditioned residual z.
    pub(crate) residual_modes: [f64; 3],
    /// Σ B d.
    pub(crate) direction_modes: [f64; 3],
    /// Σ B K d.
    pub(crate) image_modes: [f64; 3],
    /// Σ r².
    pub(crate) residual_square: f64,
    /// Σ (c v)².
    pub(crate) displacement_square: f64,
    /// Σ p² of negative pressures.
    pub(crate) negative_square: f64,
    /// Σ r d.
    pub(crate) residual_direction: f64,
    /// Σ z K d.
    pub(crate) residual_image: f64,
    /// Σ d K d.
    pub(crate) direction_image: f64,
}

impl BandSums {
    const COUNT: usize = 15;
    const ZERO: BandSums = BandSums::of([0.0; BandSums::COUNT]);

    const fn of(numbers: [f64; BandSums::COUNT]) -> BandSums {
        let [r0, r1, r2, d0, d1, d2, i0, i1, i2, rr, vv, pp, rd, zi, di] = numbers;
        BandSums {
            residual_modes: [r0, r1, r2],
            direction_modes: [d0, d1, d2],
            image_modes: [i0, i1, i2],
            residual_square: rr,
            displacement_square: vv,
            negative_square: pp,
            residual_direction: rd,
            residual_image: zi,
            direction_image: di,
        }
    }

    fn numbers(&self) -> [f64; BandSums::COUNT] {
        let ([r0, r1, r2], [d0, d1, d2], [i0, i1, i2]) = (self.residual_modes, self.direction_modes, self.image_modes);
        let [rr, vv, pp] = [self.residual_square, self.displacement_square, self.negative_square];
        let [rd, zi, di] = [self.residual_direction, self.residual_image, self.direction_image];
        [r0, r1, r2, d0, d1, d2, i0, i1, i2, rr, vv, pp, rd, zi, di]
    }
}

/// Sums and maxima of a pass over the cells of one body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) sums: BandSums,
    /// The deepest penetration of cells outside the contact, in lanes.
    greatest: [f64; LANES],
    /// The greatest residual of cells in contact.
    pub(crate) peak: f64,
}

impl Found {
    const NOTHING: Found =
        Found { sums: BandSums::ZERO, greatest: [f64::NEG_INFINITY; LANES], peak: f64::NEG_INFINITY };

    /// Count of the numbers that ranks exchange: the sums and both maxima.
    const NUMBERS: usize = BandSums::COUNT + 2;

    fn numbers(&self) -> [f64; Found::NUMBERS] {
        let mut numbers = [self.peak; Found::NUMBERS];
        numbers[..BandSums::COUNT].copy_from_slice(&self.sums.numbers());
        numbers[BandSums::COUNT] = self.greatest();
        numbers
    }

    fn of(numbers: &[f64; Found::NUMBERS]) -> Found {
        let sums = BandSums::of(std::array::from_fn(|n| numbers[n]));
        let mut found = Found { sums, peak: numbers[BandSums::COUNT + 1], ..Found::NOTHING };
        found.greatest[0] = numbers[BandSums::COUNT];
        found
    }

    /// Adds the findings of the next band.
    fn join(&mut self, next: &Found) {
        self.sums = BandSums::of(sum::add(self.sums.numbers(), next.sums.numbers()));
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
    found[..bodies].copy_from_slice(&all[..bodies]);
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
