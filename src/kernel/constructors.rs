//! Constructors of the kernels.

use std::sync::Arc;

use super::definiteness::is_positive;
use super::influence::indices;
use super::{Body, Ends, InfluenceKernel, Layout, Love, MEMORY_WHILE_MADE, Strip, magnitude, wave_number};
use crate::axis::Axis;
use crate::error::{Error, Refusal, Result, count_within, within};
use crate::{Grid, memory};

/// Maximum difference of mirrored coefficients, relative to the maximum coefficient.
const UNEQUAL: f64 = 1e-12;
/// Sides of the cells of a half-space \[m\], and their ratios: within these, coefficients and their sums do not
/// overflow.
const RANGE: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
/// Maximum influence of a user-defined kernel \[m\].
const GREATEST: f64 = 1e100;
/// Maximum datum of a line load \[m\]: no grid of such cells is longer.
const FARTHEST_DATUM: f64 = 1e120;

/// The error of an influence coefficient, or of the compliance of a wave, that no body can have.
fn invalid(of: &'static str, at: [isize; 2], value: f64, allowed: &'static str) -> Error {
    let what = format!("the influence {of} [{}, {}] is {value:?}", at[0], at[1]);
    Refusal::value("kernel_invalid_influence", what, "").naming(of).valued(value).must_be(allowed).into()
}

impl InfluenceKernel {
    /// The kernel of a body with this response on the grid.
    pub(super) fn new(
        grid: &Grid,
        body: Body,
        periodic: [bool; 2],
        response: impl Fn([usize; 2]) -> f64 + Send + Sync + 'static,
    ) -> InfluenceKernel {
        InfluenceKernel {
            grid: grid.clone(),
            body,
            periodic,
            datum: None,
            response: Arc::new(response),
            operators: Default::default(),
            facts: Default::default(),
        }
    }

    /// The kernel of an elastic half-space (Eq. 6 of the [paper](crate::paper)): Love's coefficients, right to 1e-14
    /// at every distance and for cells of any aspect ratio up to 1000, zero-padded so that the convolution is linear.
    ///
    /// Cost, at the first use: one Love integral per cell and one transform.
    ///
    /// # Errors
    /// If a side of a cell, or their ratio, is not in \[1e-100, 1e100\] (m): the coefficients would leave the range of
    /// `f64`.
    pub fn half_space(grid: &Grid) -> Result<InfluenceKernel> {
        representable(grid)?;
        let love = Love::new(grid.spacing());
        Ok(InfluenceKernel::new(grid, Body::HalfSpace, [false; 2], move |at| love.coefficient(at)))
    }

    /// A half-space that is periodic along both axes, the grid being one period: Westergaard's K p = 2p/|q| for each
    /// wave q of the pressure (Trans. ASME J. Appl. Mech. 6, 1939).
    ///
    /// The mean displacement of an endless surface is undetermined; it is the datum, and zero: the approach is measured
    /// from a rigid plane at the mean of the undeformed surface. It cannot exceed the approach of full contact. Without
    /// padding, a convolution costs a third of the half-space's. On a grid of N × 1 cells this is the periodic contact
    /// in plane strain.
    ///
    /// ```
    /// use viscocontact::{Grid, InfluenceKernel};
    ///
    /// let grid = Grid::new([64, 1], [1.0, 1.0])?;
    /// let kernel = InfluenceKernel::periodic(&grid)?;
    /// let q = std::f64::consts::TAU;
    /// let wave: Vec<f64> = (0..64).map(|i| (q * grid.center(i, 0)[0]).cos()).collect();
    /// let mut kp = vec![0.0; 64];
    /// kernel.convolve(&wave, &mut kp, &mut kernel.workspace()?)?;
    /// assert!((kp[10] - 2.0 / q * wave[10]).abs() < 1e-14);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the grid has one cell: nothing on it can be displaced. If a side of a cell, or their ratio, is not in
    /// \[1e-100, 1e100\] (m).
    pub fn periodic(grid: &Grid) -> Result<InfluenceKernel> {
        let allowed = "2 or more: the mean of a periodic surface is not displaced";
        count_within("cells of a periodic grid", grid.len(), grid.len() > 1, allowed)?;
        representable(grid)?;
        let q = magnitude(grid, grid.cells());
        let compliance = move |k: [usize; 2]| if k == [0, 0] { 0.0 } else { 2.0 / q(k) };
        Ok(InfluenceKernel::new(grid, Body::HalfSpace, [true; 2], compliance))
    }

    /// A half-space that is periodic along an axis, the grid being one period, and loaded on the grid
    /// only along the other: K0(κ |x|) for each wave κ along the axis, as for a line load for the mean.
    ///
    /// The displacement of a half-space under a load on an endless line is unbounded. `datum` \[m\] is the distance
    /// from the line at which the displacement is zero, and from which the approach is measured: with twice the
    /// distance the approach is greater by (2 ln 2/π) C times the force per unit length.
    ///
    /// # Errors
    /// If `datum` is not finite, or less than the length of the grid along the other
    /// axis, or more than 1e120 m; if a side of a cell, or their ratio, is not in \[1e-100, 1e100\] (m).
    pub fn periodic_along(grid: &Grid, along: Axis, datum: f64) -> Result<InfluenceKernel> {
        let (axis, across) = along.and_other();
        let strip = strip(grid, across, datum)?;
        Ok(InfluenceKernel::strips(grid, Body::HalfSpace, axis, (strip, Some(datum)), |_, _| 0.0))
    }

    /// A line contact, in plane strain: a grid of N × 1 cells, and pressures that do not depend on x2,
    /// (K p)(x) = −(2/π) ∫ ln(|x − s|/d) p(s) ds (K. L. Johnson, Contact Mechanics, 1985, section 2.3).
    ///
    /// A contact uniform along x2 is periodic there, and has no edge. The force acts on the length of the grid along
    /// x2: with 1 m, forces are forces per metre. `datum` is the distance d \[m\] from a line load at which the
    /// displacement is zero, and from which the approach is measured: pressures and gaps do not depend on it.
    ///
    /// # Errors
    /// If the grid has more than one cell along x2, or `datum` is not finite, or less than the length of the grid along
    /// x1: a pressure would pull the surface up. If it is more than 1e120 m, or a side of a cell, or their ratio, is
    /// not in \[1e-100, 1e100\] (m).
    pub fn line(grid: &Grid, datum: f64) -> Result<InfluenceKernel> {
        check_line(grid)?;
        InfluenceKernel::periodic_along(grid, Axis::X2, datum)
    }

    /// A user-defined body: `coefficient(i, j)` \[m\] is the displacement, over C, of a cell under a unit pressure
    /// on the cell i cells away along x1 and j along x2. It is called for all |i|, |j| below the number of cells.
    ///
    /// A layer, a coating, a point load of another resolution: any body whose response is linear, the same at every
    /// point, and mirrored when the load is.
    ///
    /// # Errors
    /// If a coefficient is not finite, or beyond ±1e100 m, or differs from the coefficients of its mirror images, or
    /// if K is not positive definite: unless its spectrum is positive, negative eigenvalues are looked for by the
    /// Lanczos method, which detects any far below zero. If there is not enough memory for coefficients and spectrum.
    pub fn from_coefficients(grid: &Grid, coefficient: impl Fn(isize, isize) -> f64) -> Result<InfluenceKernel> {
        let [n1, n2] = grid.cells();
        let layout = Layout { cells: grid.cells(), ends: [Ends::Free; 2], folded: [false; 2] };
        let coefficients = (grid.len() * size_of::<f64>()) as u128;
        memory::check("a kernel of coefficients", 2 * coefficients + MEMORY_WHILE_MADE * layout.operator_bytes(None))?;
        let mut values = Vec::with_capacity(grid.len());
        let distances = || indices([n1, n2]).map(|at| at.map(|index| index as isize));
        for [i, j] in distances() {
            let value = coefficient(i, j);
            // also rejects NaN
            if !(-GREATEST..=GREATEST).contains(&value) {
                let allowed = "finite, and at most 1e100 m in absolute value";
                return Err(invalid("coefficient", [i, j], value, allowed));
            }
            values.push(value);
        }
        let greatest = values.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()));
        for ([i, j], own) in distances().zip(&values) {
            for at in [[-i, j], [i, -j], [-i, -j]] {
                let value = coefficient(at[0], at[1]);
                let equal = (value - own).abs() <= UNEQUAL * greatest;
                if !equal {
                    let allowed = "the same as that of its mirror images";
                    return Err(invalid("coefficient", at, value, allowed));
                }
            }
        }
        let kernel = InfluenceKernel::new(grid, Body::User, [false; 2], move |[i, j]| values[i * n2 + j]);
        let whole = kernel.operator([false; 2]);
        let symbol = kernel.symbol(layout, None);
        if !indices([0, 1].map(|axis| layout.period(axis) / 2 + 1)).all(|[k1, k2]| symbol(k1, k2) > 0.0) {
            memory::check(
                "the check that a kernel is positive definite",
                layout.workspace_bytes(None) + 3 * coefficients,
            )?;
            if !is_positive(whole, grid.len()) {
                let what = "the influence coefficients are not positive definite: some pressure has no positive energy";
                let remedy = "; check their signs, and that near cells influence each other more than distant ones";
                return Err(Refusal::value("kernel_not_positive_definite", what, remedy)
                    .naming("influence coefficients")
                    .allowing("positive definite")
                    .into());
            }
        }
        Ok(kernel)
    }

    /// A user-defined body that is periodic along both axes, the grid being one period: `compliance(q1, q2)` \[m\] is
    /// the displacement, over C, under a unit wave of pressure cos(q1 x1) cos(q2 x2), wave numbers \[1/m\] ≥ 0. The
    /// half-space has 2/|q|.
    ///
    /// Zero at q = 0 fixes the mean displacement, as in [`InfluenceKernel::periodic`]; a body on a foundation is
    /// displaced by a uniform pressure, too.
    ///
    /// ```
    /// use viscocontact::{Grid, InfluenceKernel};
    ///
    /// // an incompressible layer bonded to a rigid base: thin against the wave it is stiff, thick against it a half-space
    /// // (K. L. Johnson, Contact Mechanics, 1985, section 5.8)
    /// let depth = 0.1;
    /// let layer = |q: f64| 2.0 / q * ((2.0 * q * depth).sinh() - 2.0 * q * depth)
    ///     / ((2.0 * q * depth).cosh() + 1.0 + 2.0 * (q * depth).powi(2));
    /// let grid = Grid::square(32, 1.0)?;
    /// let kernel = InfluenceKernel::from_spectrum(&grid, |q1, q2| {
    ///     let q = f64::hypot(q1, q2);
    ///     if q > 0.0 { layer(q) } else { 0.0 } // an incompressible layer keeps its volume
    /// })?;
    /// # let _ = kernel;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the compliance of a wave is not positive, the compliance of the mean is negative, or either is more than
    /// 1e100 m; if there is not enough memory for them.
    pub fn from_spectrum(grid: &Grid, compliance: impl Fn(f64, f64) -> f64) -> Result<InfluenceKernel> {
        let counts = grid.cells().map(|cells| cells / 2 + 1);
        let q = |axis: usize, k: usize| wave_number(k, grid.cells()[axis], grid.spacing()[axis]);
        memory::check("a kernel of waves", 2 * size_of::<f64>() as u128 * counts[0] as u128 * counts[1] as u128)?;
        let mut values = Vec::with_capacity(counts[0] * counts[1]);
        for k in indices(counts) {
            let (value, mean) = (compliance(q(0, k[0]), q(1, k[1])), k == [0, 0]);
            if !(value <= GREATEST && (value > 0.0 || (mean && value == 0.0))) {
                let allowed = if mean { "in [0, 1e100] m" } else { "> 0, and at most 1e100 m" };
                return Err(invalid("wave", k.map(|index| index as isize), value, allowed));
            }
            values.push(value);
        }
        if values.iter().all(|&value| value == 0.0) {
            let allowed = "> 0 on a grid of one cell";
            return Err(invalid("wave", [0, 0], 0.0, allowed));
        }
        let compliance = move |[k1, k2]: [usize; 2]| values[k1 * counts[1] + k2];
        Ok(InfluenceKernel::new(grid, Body::User, [true; 2], compliance))
    }

    /// A body that is periodic along `axis`. Its response is the coefficient of a strip of a half-space for each wave
    /// along the axis, and the addition of a layer for each wave that reaches its base.
    pub(super) fn strips(
        grid: &Grid,
        body: Body,
        axis: usize,
        (strip, datum): (Strip, Option<f64>),
        added: impl Fn(usize, f64) -> f64 + Send + Sync + 'static,
    ) -> InfluenceKernel {
        let (cells, along, side) = (grid.cells()[axis], grid.spacing()[axis], grid.spacing()[1 - axis]);
        let response = move |at: [usize; 2]| {
            let (i, k) = (at[1 - axis], at[axis]);
            strip.at(i as f64 * side, wave_number(k, cells, along)) + added(k, i as f64 * side)
        };
        InfluenceKernel { datum, ..InfluenceKernel::new(grid, body, [axis == 0, axis == 1], response) }
    }
}

/// Rejects cells whose influence coefficients `f64` cannot represent.
pub(super) fn representable(grid: &Grid) -> Result<()> {
    let [d1, d2] = grid.spacing();
    for (field, side) in [("cell side along x1", d1), ("cell side along x2", d2)] {
        within(field, side, RANGE.contains(&side), "in [1e-100, 1e100] m for the kernel of a half-space")?;
    }
    let field = "aspect ratio of the cells";
    within(field, d1 / d2, RANGE.contains(&(d1 / d2)), "in [1e-100, 1e100] for the kernel of a half-space").map(drop)
}

/// Rejects grids of more than one cell along x2.
pub(super) fn check_line(grid: &Grid) -> Result<()> {
    let cells = grid.cells()[1];
    count_within("cells along x2 of a line contact", cells, cells == 1, "1")
}

/// The strips of a half-space on cells along `axis`.
pub(super) fn strip(grid: &Grid, axis: usize, datum: f64) -> Result<Strip> {
    representable(grid)?;
    let reaches = datum >= grid.lengths()[axis];
    within(
        "datum of a line load",
        datum,
        reaches,
        "finite, and no less than the length of the grid across the lines: usually the distance to the support",
    )?;
    within("datum of a line load", datum, datum <= FARTHEST_DATUM, "at most 1e120 m")?;
    Ok(Strip { side: grid.spacing()[axis], datum })
}
