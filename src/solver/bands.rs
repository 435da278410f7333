//! The fields of a contact cut into bands, which threads may share.

use std::ops::Range;

use crate::parallel::{Rows, cut, fork, lanes};

/// Sums and maxima of a pass over the cells in contact under one body, with the modes B of its motion. Each pass computes some
/// of them.
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
    /// The greatest r.
    pub(crate) peak: f64,
    /// The deepest penetration of cells outside the contact.
    pub(crate) penetration: f64,
}

impl BandSums {
    const NOTHING: BandSums = BandSums {
        residual_modes: [0.0; 3],
        direction_modes: [0.0; 3],
        image_modes: [0.0; 3],
        residual_square: 0.0,
        displacement_square: 0.0,
        negative_square: 0.0,
        residual_direction: 0.0,
        residual_image: 0.0,
        direction_image: 0.0,
        peak: f64::NEG_INFINITY,
        penetration: f64::NEG_INFINITY,
    };
    const SUMS: usize = 15;
    const MAXIMA: usize = 2;
    const NUMBERS: usize = BandSums::SUMS + BandSums::MAXIMA;

    /// All numbers, the maxima last.
    fn numbers_mut(&mut self) -> [&mut f64; BandSums::NUMBERS] {
        let [r0, r1, r2] = &mut self.residual_modes;
        let [d0, d1, d2] = &mut self.direction_modes;
        let [i0, i1, i2] = &mut self.image_modes;
        let squares = [&mut self.residual_square, &mut self.displacement_square, &mut self.negative_square];
        let products = [&mut self.residual_direction, &mut self.residual_image, &mut self.direction_image];
        let ([rr, vv, pp], [rd, zi, di]) = (squares, products);
        [r0, r1, r2, d0, d1, d2, i0, i1, i2, rr, vv, pp, rd, zi, di, &mut self.peak, &mut self.penetration]
    }

    fn numbers(mut self) -> [f64; BandSums::NUMBERS] {
        self.numbers_mut().map(|number| *number)
    }

    /// Adds the sums of the next band, and takes the greater of the maxima.
    fn join(&mut self, next: [f64; BandSums::NUMBERS]) {
        for (n, (number, next)) in self.numbers_mut().into_iter().zip(next).enumerate() {
            *number = if n < BandSums::SUMS { *number + next } else { number.max(next) };
        }
    }
}

/// The bands of the local rows, and the sums of a pass over each of them for each body.
#[derive(Debug, Clone)]
pub(crate) struct Bands {
    rows: Rows,
    bodies: usize,
    found: Vec<BandSums>,
}

impl Bands {
    pub(crate) fn new(rows: &Rows, bodies: usize) -> Bands {
        let found = vec![BandSums::NOTHING; rows.bands().max(1) * bodies];
        Bands { rows: rows.clone(), bodies, found }
    }

    /// Bytes of the sums.
    pub(crate) fn bytes(rows: &Rows, bodies: usize) -> usize {
        rows.bands().saturating_mul(bodies).saturating_mul(size_of::<BandSums>())
    }

    /// Calls `job` with each local band, its part of the outputs and its sums for each body.
    pub(crate) fn over<'f, T: Send, const M: usize>(
        &'f mut self,
        outputs: [&'f mut [T]; M],
        job: impl Fn(Range<usize>, [&mut [T]; M], &mut [BandSums]) + Sync,
    ) {
        let Bands { ref rows, bodies, ref mut found } = *self;
        let cut_at = |(outputs, sums): ([&'f mut [T]; M], &'f mut [BandSums]), band: usize| {
            let ([before, after], (sums, others)) =
                (cut(outputs, band * rows.band_cells()), sums.split_at_mut(band * bodies));
            [(before, sums), (after, others)]
        };
        let in_threads = lanes(rows.own().len() * rows.cells()[1]) > 1;
        fork(0..rows.bands(), in_threads, (outputs, &mut found[..]), &cut_at, &|band, (outputs, sums)| {
            sums.fill(BandSums::NOTHING);
            job(rows.band(band), outputs, sums);
        });
    }

    /// The sums of each body over the bands of all ranks, after [`Bands::over`].
    pub(crate) fn joined(&mut self) -> &[BandSums] {
        let Bands { ref rows, bodies, ref mut found } = *self;
        if rows.are_shared() {
            found[0] = join_ranks(rows, &found[..rows.bands()]);
            return &found[..1];
        }
        let (all, others) = found.split_at_mut(bodies);
        for band in others.chunks(bodies) {
            all.iter_mut().zip(band).for_each(|(all, sums)| all.join(sums.numbers()));
        }
        all
    }
}

/// Joins the sums of the bands of all ranks, in their order. Contacts on several ranks have one body.
#[cold]
fn join_ranks(rows: &Rows, found: &[BandSums]) -> BandSums {
    let own = found.iter().flat_map(|sums| sums.numbers());
    let mut joined = BandSums::NOTHING;
    let join = |all: &[f64]| all.as_chunks().0.iter().for_each(|sums| joined.join(*sums));
    rows.gather(own, |rank| BandSums::NUMBERS * rows.bands_of(rank), join);
    joined
}
