//! Observations of a contact: functions of `observe` applied to its fields.

use crate::Axis;
use crate::equilibrium::Held;
use crate::error::{Error, Refusal, Result, coverage};
use crate::fields::Fields;
use crate::linalg::solve_normal_equations;
use crate::observe::profile::line_through;
use crate::observe::{LineProfile, Patches};
use crate::solver::{FLAT_PUNCH_TOLERANCE, flat_punch};

/// Share of a motion, by its square, that is taken for dependent on the others: of a body that tilts on two cells.
const DEPENDENT: f64 = 1e-9;
/// Residual of a gradient, far below what differences of solutions resolve.
const GRADIENT_TOLERANCE: f64 = 1e-12;

/// The pressures q_j of unit motions, K q_j = ξ_j on the contact, and S_ij = ∬ q_j ξ_i, as [`Fields::stiffnesses`] has
/// them; empty and 0 along axes without free tilt.
struct Punches {
    fields: [Vec<f64>; 3],
    matrix: [[f64; 3]; 3],
}

/// The error of a motion under which no pressure was found.
fn undetermined(iterations: usize, residual: f64, tolerance: f64) -> Error {
    let what = format!(
        "the body hardly determines the pressure under a rigid motion (residual {residual:.2e} after {iterations} \
        iterations, above {tolerance:e})"
    );
    Refusal::search("stiffness_not_converged", what, ": check its influence coefficients").into()
}

impl Fields<'_> {
    /// Normal stiffness of the contact over the contact modulus \[m\]: dW/dω = E* times this while the contact area
    /// stays as it is; with 1/C(0) it is the response to a jump, with 1/C(t) the response to a step held for t. 2a
    /// for a circle of radius a. It depends on the area alone, not on the material; the electrical and thermal
    /// conductance of the contact are proportional to it (J. R. Barber, Proc. R. Soc. A 459, 2003).
    ///
    /// Zero without contact; infinite on periodic bodies in full contact, whose mean displacement is fixed. Costs about
    /// ten convolutions, ten preconditioner applications, and memory for them.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 3.0e-3)?)
    ///     .geometry(&FlatPunch::circular(1.0e-3)?)
    ///     .material(Material::incompressible(Elastic::new(1.0e6)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(1.0))?;
    /// assert!((contact.fields().stiffness_over_modulus()? / 2.0e-3 - 1.0).abs() < 0.01);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the iteration does not converge.
    pub fn stiffness_over_modulus(&self) -> Result<f64> {
        self.stiffnesses([None; 2]).map(|(upright, _)| upright)
    }

    /// [`Fields::stiffness_over_modulus`], and how a load point and the tilts move under a unit of force over the modulus,
    /// while the body tilts freely about it along each axis of which the point is given: (S⁻¹)_i0 of the matrix
    /// S_ij = ∬ q_j ξ_i, K q_j = ξ_j on the contact, ξ = 1, x1 − e1, x2 − e2.
    pub(crate) fn stiffnesses(&self, load_point: [Option<f64>; 2]) -> Result<(f64, [f64; 3])> {
        let current = &self.held.current;
        if current.contact_cells == 0 {
            return Ok((0.0, [f64::INFINITY, 0.0, 0.0]));
        }
        if self.ground.kernel.mean_is_held() && current.contact_cells == self.grid().len() {
            return Ok((f64::INFINITY, [0.0; 3]));
        }
        let matrix = self.punches(load_point, FLAT_PUNCH_TOLERANCE)?.matrix;
        Ok((matrix[0][0], solve_normal_equations(&matrix, [1.0, 0.0, 0.0], DEPENDENT)))
    }

    /// How the approach changes with the height of each cell, ∂ω/∂g: the pressure of a flat punch on the contact,
    /// over its force. The gap g of the undeformed bodies is greater where the body is higher; the body carries a
    /// given force, and does not tilt. One value per cell, ≥ 0, of the sum 1 where bodies touch, else 0. So an
    /// elastic body that is held at its approach changes its force by −E* S ∂ω/∂g, with S the
    /// [stiffness over the modulus](Fields::stiffness_over_modulus).
    ///
    /// It costs about twenty convolutions.
    ///
    /// ```
    /// use viscocontact::elastic::ElasticContact;
    /// use viscocontact::prelude::*;
    ///
    /// let grid = Grid::square(32, 3.0e-3)?;
    /// let mut contact = ElasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).modulus(1.0e6).build()?;
    /// contact.solve(Load::force(0.3))?;
    /// let gradient = contact.fields().approach_gradient()?;
    /// assert!((gradient.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the iteration does not converge.
    pub fn approach_gradient(&self) -> Result<Vec<f64>> {
        self.load_point_gradient([None; 2])
    }

    /// [`Fields::approach_gradient`] of a load point about which the body tilts freely along each axis of which it is
    /// given.
    pub(crate) fn load_point_gradient(&self, load_point: [Option<f64>; 2]) -> Result<Vec<f64>> {
        let Held { region, current, .. } = self.held;
        let mut whole = vec![0.0; region.shown_len()];
        if current.contact_cells == 0 {
            return Ok(whole);
        }
        // the mean gap alone matters in full contact
        if self.ground.kernel.mean_is_held() && current.contact_cells == self.grid().len() {
            whole.fill(1.0 / current.contact_cells as f64);
            return Ok(whole);
        }
        let Punches { fields, matrix } = self.punches(load_point, GRADIENT_TOLERANCE)?;
        // of one cell, where the region's own stand for their mirror images as well
        let cell_area: f64 = self.grid().spacing().iter().product();
        let parts = solve_normal_equations(&matrix, [1.0, 0.0, 0.0], DEPENDENT).map(|part| part * cell_area);
        let mut sum = vec![0.0; region.len()];
        for (part, punch) in parts.into_iter().zip(&fields) {
            sum.iter_mut().zip(punch).for_each(|(sum, q)| *sum += part * q);
        }
        region.show(&sum, &mut whole);
        Ok(whole)
    }

    /// The contact as a flat punch in each motion that is free.
    fn punches(&self, load_point: [Option<f64>; 2], tolerance: f64) -> Result<Punches> {
        let (Held { region, current, .. }, rows) = (self.held, self.held.region.rows());
        let own;
        let kernel = match self.kernel {
            Some(kernel) => kernel,
            None => {
                own = self.ground.kernel.on_rows(region.grid(), region.folded(), &rows);
                &own
            }
        };
        // a body that is even along an axis does not tilt along it
        let tilts = |axis: usize| load_point[axis].filter(|_| !region.folded()[axis]);
        let motion = |motion: usize, k: usize| match motion.checked_sub(1) {
            Some(axis) => tilts(axis).map_or(0.0, |at| region.center(k)[axis] - at),
            None => 1.0,
        };
        let touches = |k: usize| current.solution.pressure[k] > 0.0;
        let (mut fields, mut matrix) = ([const { Vec::new() }; 3], [[0.0; 3]; 3]);
        for j in (0..3).filter(|j| *j == 0 || tilts(j - 1).is_some()) {
            let q = kernel
                .rows()
                .or_loss(|| Ok(flat_punch(kernel, touches, |k| motion(j, k), tolerance)))?
                .map_err(|(iterations, residual)| undetermined(iterations, residual, tolerance))?;
            let area = region.cell_area();
            matrix[0][j] = rows.sum(&q) * area;
            for i in (1..3).filter(|i| tilts(i - 1).is_some()) {
                let moments: Vec<f64> = q.iter().enumerate().map(|(k, q)| q * motion(i, k)).collect();
                matrix[i][j] = rows.sum(&moments) * area;
            }
            fields[j] = q;
        }
        Ok(Punches { fields, matrix })
    }

    /// Pressure, displacement, gap and net traction along the line of cells in the direction of `along` that contains
    /// the other coordinate `at` \[m\]; if `at` lies on the boundary of two lines, along the upper one. Nothing is
    /// interpolated:
    /// [`LineProfile::at`] is the coordinate of the cell centres.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(33, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let profile = contact.fields().profile(Axis::X1, 0.0)?;
    /// assert_eq!([profile.positions.len(), profile.pressure.len()], [33, 33]);
    /// assert_eq!(profile.pressure[16], contact.fields().max_pressure());
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If `at` lies outside the grid, or there is no memory for the gap.
    ///
    /// A call of all [ranks](crate::parallel) that share out the contact, each of which gets the whole profile.
    pub fn profile(&self, along: Axis, at: f64) -> Result<LineProfile> {
        let ((axis, across), grid) = (along.and_other(), self.grid());
        let line = line_through(grid, across, ("coordinate of the profile", at))?;
        let mut field = self.gap()?;
        let rows = self.held.region.rows();
        let line_of = |field: &[f64]| self.line_of(field, along, line);
        let [pressure, displacement, gap] =
            rows.or_loss(|| Ok([line_of(self.pressure())?, line_of(self.displacement())?, line_of(&field)?]))?;
        let traction = if self.attraction().is_some() {
            self.traction_into(&mut field)?;
            line_of(&field)?
        } else {
            pressure.clone()
        };
        let positions = (0..grid.cells()[axis]).map(|k| grid.coordinate(axis, k)).collect();
        Ok(LineProfile { at: grid.coordinate(across, line), positions, pressure, displacement, gap, traction })
    }

    /// The connected patches of the contact; where the bodies are periodic, the first and the last cells are
    /// neighbours.
    ///
    /// # Errors
    /// If the force of a patch overflows `f64`.
    pub fn patches(&self) -> Result<Patches> {
        self.covers(coverage::PATCHES)?;
        Patches::new(self.grid(), self.pressure(), self.kernel().periodic_axes())
    }

    /// The values of a field along a line of cells, of all ranks.
    fn line_of(&self, field: &[f64], along: Axis, line: usize) -> Result<Vec<f64>> {
        let [n1, n2] = self.grid().cells();
        let [rows, columns] = if along == Axis::X1 { [0..n1, line..line + 1] } else { [line..line + 1, 0..n2] };
        let brought = self.bring(field, None, rows.clone(), columns)?;
        Ok(brought.iter().flat_map(|line| rows.clone().flat_map(|row| line.row(row))).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use crate::load::Load;
    use crate::observe::tests::{hertz, sphere};

    #[test]
    fn mean_and_greatest_pressure_of_hertz() {
        let [radius, peak] = hertz(0.5);
        // odd number of cells: one lies in the middle
        let mut contact = sphere([129; 2], [2.6 * radius; 2], [0.0; 2], 0.5);
        assert_abs_diff_eq!(contact.fields().max_pressure() / peak, 1.0, epsilon = 1e-3);
        assert_abs_diff_eq!(contact.fields().mean_pressure() / (peak / 1.5), 1.0, epsilon = 3e-3);
        contact.step(0.0, Load::force(0.0)).unwrap();
        assert_eq!([contact.fields().mean_pressure(), contact.fields().max_pressure()], [0.0; 2]);
    }
}
