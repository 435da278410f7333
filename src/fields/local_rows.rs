//! Local rows of a contact that ranks share out, and calls of all ranks.

use std::ops::Range;

use crate::equilibrium::Held;
use crate::error::{Result, count_within, exact_length};
use crate::fields::Fields;
use crate::sum;

impl Fields<'_> {
    /// The rows (indices along x1) that [`pressure`](Fields::pressure) and all other fields hold: all of the grid,
    /// unless [`Builder::ranks`](crate::contact::Builder::ranks) share them out. Then they are the rows of this rank,
    /// from the upper half where the contact is symmetric about x1 = 0, since the other half is not computed; a rank
    /// may have no rows.
    pub fn rows(&self) -> Range<usize> {
        self.held.region.shown_rows()
    }

    /// Brings a field of own rows, such as [`pressure`](Fields::pressure), to the rank `to`: one value per cell of
    /// the whole grid there, `None` on all others. A call of all [ranks](crate::parallel). Without ranks there is
    /// only rank 0, and the field is the whole.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::parallel::Threads;
    ///
    /// let peaks = Threads::run(2, |ranks| {
    ///     let mut contact = ViscoelasticContact::builder(Grid::square(256, 4.0e-3)?)
    ///         .ranks(ranks)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///         .build()?;
    ///     contact.step(0.0, Load::force(1.0))?;
    ///     let whole = contact.fields().gathered(contact.pressure(), 0)?;
    ///     Ok::<_, Error>(whole.map(|pressure| pressure.len()))
    /// })?;
    /// assert_eq!(peaks, [Ok(Some(256 * 256)), Ok(None)]);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the field does not hold one value per own cell, there is no such rank, or one has left.
    pub fn gathered(&self, field: &[f64], to: usize) -> Result<Option<Vec<f64>>> {
        let Held { region, .. } = self.held;
        let rows = region.rows();
        count_within("rank", to, to < rows.ranks(), "less than the number of ranks")?;
        rows.or_loss(|| {
            rows.agree(exact_length("field", field.len(), region.shown_len()))?;
            let [n1, n2] = self.grid().cells();
            let brought = self.bring(field, Some(to), 0..n1, 0..n2)?;
            Ok(brought.map(|whole| (0..n1).flat_map(|row| whole.row(row)).copied().collect()))
        })
    }

    /// The rows of the whole grid that fields of a rank hold.
    pub(super) fn rows_of(&self, rank: usize) -> Range<usize> {
        let region = &self.held.region;
        let rows = region.rows();
        if !region.is_shared() {
            return region.shown_rows();
        }
        let (first, of) = (region.computed_rows().start - rows.own().start, rows.of(rank));
        first + of.start..first + of.end
    }

    /// Some shared rows, and their images where rows are folded.
    pub(super) fn with_images(&self, rows: Range<usize>) -> [Range<usize>; 2] {
        let (region, n1) = (&self.held.region, self.grid().cells()[0]);
        let images = if region.is_shared() && region.folded()[0] { n1 - rows.end..n1 - rows.start } else { 0..0 };
        [rows, images]
    }

    /// Σ of the values `found` by all ranks in the rows at their `places`, in the order of the rows. A call of all
    /// ranks.
    pub(super) fn sum_in_order<const K: usize>(
        &self,
        found: impl Iterator<Item = [f64; K]>,
        places: impl Fn(usize) -> [Range<usize>; 2],
    ) -> [f64; K] {
        let (rows, n1) = (self.held.region.rows(), self.grid().cells()[0]);
        if !rows.are_shared() {
            // in a step along a path, which allocates nothing
            return found.fold([0.0; K], sum::add);
        }
        let count = |rank: usize| K * places(rank).iter().map(ExactSizeIterator::len).sum::<usize>();
        rows.gather(found.flatten(), count, |all| {
            let (mut in_order, mut rest) = (vec![[0.0; K]; n1 + 1], all.as_chunks::<K>().0);
            for place in (0..rows.ranks()).flat_map(&places) {
                let (own, others) = rest.split_at(place.len());
                in_order[place].copy_from_slice(own);
                rest = others;
            }
            in_order.into_iter().fold([0.0; K], sum::add)
        })
    }

    /// Σ over all rows of the whole grid, in their order, of what `of_row` finds in the pressure of a row, given its
    /// number. A call of all ranks.
    pub(crate) fn sum_of_rows<const K: usize>(&self, of_row: impl Fn(usize, &[f64]) -> [f64; K]) -> [f64; K] {
        let ([n1, n2], own, pressure) = (self.grid().cells(), self.rows(), self.pressure());
        let row = |i: usize| &pressure[(i - own.start) * n2..][..n2];
        let computed = |i: usize| if own.contains(&i) { i } else { n1 - 1 - i };
        let found = self.with_images(own.clone()).into_iter().flatten().map(|i| of_row(i, row(computed(i))));
        self.sum_in_order(found, |rank| self.with_images(self.rows_of(rank)))
    }
}
