//! The fields of a contact cut into bands, which threads may share.

use std::ops::Range;

use crate::parallel::{Rows, cut, fork, lanes};
use crate::sum::named_sums;

named_sums! {
    /// Sums and maxima of a pass over the cells in contact under one body, with the modes B of its motion. Each pass
    /// computes some of them.
    BandSums {
        /// Σ B r, of the residual r or of the preconditioned residual z.
        residual_modes: modes,
        /// Σ B d.
        direction_modes: modes,
        /// Σ B K d.
        image_modes: modes,
        /// Σ r².
        residual_square: +,
        /// Σ (c v)².
        displacement_square: +,
        /// Σ p² of negative pressures.
        negative_square: +,
        /// Σ r d.
        residual_direction: +,
        /// Σ z K d.
        residual_image: +,
        /// Σ d K d.
        direction_image: +,
        /// The largest r.
        peak: most,
        /// The deepest penetration of cells outside the contact.
        penetration: most,
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
            all.iter_mut().zip(band).for_each(|(all, sums)| *all = all.joined(*sums));
        }
        all
    }
}

/// Joins the sums of the bands of all ranks, in their order. Contacts on several ranks have one body.
#[cold]
fn join_ranks(rows: &Rows, found: &[BandSums]) -> BandSums {
    let own = found.iter().flat_map(|sums| sums.numbers());
    let sums = |all: &[f64]| {
        all.as_chunks().0.iter().map(|numbers| BandSums::of(*numbers)).fold(BandSums::NOTHING, BandSums::joined)
    };
    rows.gather(own, |rank| BandSums::NUMBERS * rows.bands_of(rank), sums)
}
