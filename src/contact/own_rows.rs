//! What a rank has of a contact that ranks share out.

use std::ops::Range;

use num_complex::Complex64;

use crate::contact::state::State;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{RanksError, Result, count_within, exact_length};
use crate::ranks::{caught, depart};

impl ViscoelasticContact {
    /// The rows (indices along x1) that [`pressure`](ViscoelasticContact::pressure) and all other fields hold: all of the
    /// grid, unless [`Builder::ranks`](crate::contact::Builder::ranks) share them out. Then they are own ones, from the upper
    /// half where the contact is symmetric about x1 = 0, whose other half nobody computes; there may be none.
    pub fn rows(&self) -> Range<usize> {
        self.computation.state.region.shown_rows()
    }

    /// Brings a field of own rows, such as [`pressure`](ViscoelasticContact::pressure), to the rank `to`: one value per cell
    /// of the whole grid there, `None` on all others. A call of all [ranks](crate::ranks). Without ranks there is only
    /// rank 0, and the field is the whole.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::ranks::Threads;
    ///
    /// let peaks = Threads::run(2, |ranks| {
    ///     let mut contact = ViscoelasticContact::builder(Grid::square(256, 4.0e-3)?)
    ///         .ranks(ranks)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
    ///         .build()?;
    ///     contact.step(0.0, Load::force(1.0))?;
    ///     let whole = contact.gathered(contact.pressure(), 0)?;
    ///     Ok::<_, Error>(whole.map(|pressure| pressure.len()))
    /// })?;
    /// assert_eq!(peaks, [Ok(Some(256 * 256)), Ok(None)]);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the field does not hold one value per own cell, there is no such rank, or one has left.
    pub fn gathered(&self, field: &[f64], to: usize) -> Result<Option<Vec<f64>>> {
        let State { region, .. } = &self.computation.state;
        let rows = region.rows();
        count_within("rank", to, to < rows.ranks(), "less than the number of ranks")?;
        let checked = exact_length("field", field.len(), region.shown_len());
        let Some(group) = rows.group() else { return checked.map(|()| Some(field.to_vec())) };
        caught(&rows, || {
            rows.agree(checked)?;
            let columns = self.grid().cells()[1];
            // two numbers of a field are sent as a complex one
            let length = |rank: usize| (rows.of(rank).len() * columns).div_ceil(2);
            let pairs = field.chunks(2).map(|pair| Complex64::new(pair[0], pair.get(1).copied().unwrap_or(0.0)));
            let send: Vec<Complex64> = pairs.collect();
            let ranks = || 0..rows.ranks();
            let sent: Vec<usize> = ranks().map(|rank| if rank == to { send.len() } else { 0 }).collect();
            let own = group.rank() == to;
            let counts: Vec<usize> = ranks().map(|rank| if own { length(rank) } else { 0 }).collect();
            let mut received = vec![Complex64::default(); counts.iter().sum()];
            group.exchange(&send, &sent, &mut received, &counts).unwrap_or_else(|error| depart(error));
            if !own {
                return Ok(None);
            }
            let (mut whole, mut start) = (vec![0.0; self.grid().len()], 0);
            let (first, n1) = (self.grid().cells()[0] - rows.cells()[0], self.grid().cells()[0]);
            for rank in ranks() {
                let numbers = received[start..start + counts[rank]].iter().flat_map(|z| [z.re, z.im]);
                start += counts[rank];
                let part = rows.of(rank).len() * columns;
                let place = (first + rows.of(rank).start) * columns;
                whole[place..place + part].iter_mut().zip(numbers).for_each(|(out, value)| *out = value);
            }
            // of a symmetric contact the lower half is the image of the upper one
            for row in 0..first {
                let image = (n1 - 1 - row) * columns;
                whole.copy_within(image..image + columns, row * columns);
            }
            Ok(Some(whole))
        })
    }

    /// Rejects what needs the whole of a contact where ranks share it out.
    pub(crate) fn not_shared(&self, what: &'static str) -> Result<()> {
        if self.computation.state.region.is_shared() { Err(RanksError::NotShared { what }.into()) } else { Ok(()) }
    }
}
