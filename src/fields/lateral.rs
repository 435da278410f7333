//! The force that moves an indenter over a contact.

use crate::fields::Fields;
use crate::geometry::Geometry;

impl Fields<'_> {
    /// The force \[N\] along x1 and x2 that moves `shape` along the surface without friction: ∬ p ∇h, less the tilt
    /// times the normal force. `shape` is the shape of the (first) indenter at its present position, or its moving
    /// part. Of several rigid bodies only the pressure under the first one counts.
    ///
    /// It vanishes on elastic bodies, and in any symmetric contact. Multiplied by the velocity of the indenter, it is
    /// the power that the bodies dissipate or store: on a slope, p does the work p (∂u/∂t − dω/dt). Divided by the
    /// normal force, it is the coefficient of hysteretic friction.
    ///
    /// The pressure is constant on a cell. The slope of a cell is therefore the rise of
    /// [`Geometry::initial_gap`] from side to side. On interpolated maps it is
    /// as accurate as the interpolation: for a rough slider on an elastic body the error is 3e-4 of the normal force
    /// with waves of 2 cells, 2e-5 with waves of 8 cells. Where the rise is not finite, beside the rim of a face, the
    /// slope counts as zero: only [`TravelReport::power`](crate::contact::TravelReport) includes the force of a rim.
    /// NaN where the gap of the shape is NaN.
    ///
    /// A call of all [ranks](crate::parallel) that share out the contact.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let sphere = Sphere::new(10.0e-3)?;
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 2.0e-3)?)
    ///     .geometry(&sphere)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.1))?;
    /// assert!(contact.fields().slope_force(&sphere).iter().all(|force| force.abs() < 1.0e-12));
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn slope_force(&self, shape: &dyn Geometry) -> [f64; 2] {
        let (n2, [half1, half2]) = (self.grid().cells()[1], self.grid().spacing().map(|side| 0.5 * side));
        let rise = |ahead: f64, behind: f64| {
            let rise = ahead - behind;
            if rise.is_finite() || ahead.is_nan() || behind.is_nan() { rise } else { 0.0 }
        };
        let gap = self.held.indenter.gap();
        // the attraction pulls on slopes, too
        let attraction = self.attraction_on_grid();
        let of_row = |i: usize, row: &[f64]| {
            let (mut own, x1) = ([0.0; 2], self.grid().coordinate(0, i));
            let net = |(j, p): (usize, &f64)| (j, p - attraction.as_ref().map_or(0.0, |s| s[i * n2 + j]));
            for (j, p) in row.iter().enumerate().map(net).filter(|(j, p)| *p != 0.0 && gap.owner(i * n2 + j) == 0) {
                let x2 = self.grid().coordinate(1, j);
                own[0] += p * (rise(shape.initial_gap(x1 + half1, x2), shape.initial_gap(x1 - half1, x2)));
                own[1] += p * (rise(shape.initial_gap(x1, x2 + half2), shape.initial_gap(x1, x2 - half2)));
            }
            own
        };
        let (sums, tilt) = (self.sum_of_rows(of_row), self.tilt());
        let force = self.body(0).map_or(0.0, |body| body.force);
        [0, 1].map(|axis| sums[axis] * self.grid().spacing()[1 - axis] - tilt[axis] * force)
    }
}
