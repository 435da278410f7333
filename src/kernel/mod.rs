//! The influence of pressure on displacement: Boussinesq's half-space, discretised by Love and
//! convolved by fast Fourier transforms; and related kernels.
//!
//! For an elastic body with contact compliance C = 1/E* the surface displacement is u = C K p with
//! a purely geometric operator:
//!
//! | body | K |
//! |---|---|
//! | half-space (Eq. 6 of the paper) | (K p)(x) = ∬ p(x′) / (π \|x − x′\|) dx′ |
//! | periodic along both axes | 2/\|q\| for each wave q, nothing for the mean |
//! | periodic along one axis | (2/π) ∫ K0(κ \|x − s\|) p(s) ds for each wave κ along it, of the mean as for a line |
//! | line contact | −(2/π) ∫ ln(\|x − s\|/d) p(s) ds |
//! | layer of thickness h | (2/\|q\|) L(\|q\|h) for each wave q: the half-space, and what is smooth on the scale h |
//! | user-defined | coefficients between cells, or the compliance of each wave |
//!
//! All material behaviour is in C. Normalisation: `convolve` returns K p in Pa·m, with no remaining
//! factor of the transform.

mod constructors;
mod definiteness;
mod even_spectrum;
mod influence;
#[cfg(feature = "layers")]
mod layer;
#[cfg(not(feature = "layers"))]
#[path = "no_layer.rs"]
mod layer;
#[cfg(feature = "layers")]
mod layered;
mod layout;
mod line_load;
mod love;
#[cfg(feature = "adhesion")]
mod near;
#[cfg(feature = "observe")]
mod other_cells;
#[cfg(feature = "sliding")]
mod rows;
mod transform;

pub(crate) use influence::HalfSpace;
pub use layer::Layer;
pub(crate) use layout::{fast_length, images, waves_at};
pub(crate) use line_load::wave_number;
#[cfg(feature = "adhesion")]
pub(crate) use near::{Mean, PeriodInverse};
#[cfg(feature = "sliding")]
pub(crate) use rows::Row;
pub(crate) use transform::{SpectralOperator, TransformWorkspace};

use std::sync::{Arc, OnceLock};

use crate::error::{Error, Refusal, Result, exact_length, finite};
use crate::parallel::Rows;
use crate::{Grid, memory};
use influence::{Body, Response, magnitude};
use layout::{Ends, Layout};
use line_load::Strip;
use love::Love;
use transform::Shares;

/// Memory that making an operator takes, relative to the memory of the operator: its spectrum, and the transform that
/// yields it.
const MEMORY_WHILE_MADE: u128 = 3;

/// The discrete influence operator K of a grid: immutable, shared by `Arc` between contacts and threads.
///
/// Spectra are computed when first needed, and kept: being real and even, a quarter of the padded one is enough, about
/// 8 bytes per cell. Without memory for them, the call that needs them first fails with [`Error::OutOfMemory`]. A
/// [`Workspace`] holds one complex spectrum per row, about 16 bytes per cell, and twice that if several threads share
/// the work (feature `rayon`, grids of 2¹⁵ cells or more, as many threads as the pool has; the result is bitwise the
/// same).
///
/// ```
/// use viscocontact::{Grid, InfluenceKernel};
///
/// let grid = Grid::square(64, 1.0e-3)?;
/// let kernel = InfluenceKernel::half_space(&grid)?;
/// let mut work = kernel.workspace()?;
/// let pressure = vec![1.0e6; grid.len()];
/// let mut kp = vec![0.0; grid.len()];
/// kernel.convolve(&pressure, &mut kp, &mut work)?;
/// // centre of a uniformly loaded square of side L (Love): K p = 4 L asinh(1) / π p
/// let exact = 4.0 * 1.0e-3 * 1_f64.asinh() / std::f64::consts::PI * 1.0e6;
/// assert!((kp[32 * 64 + 32] / exact - 1.0).abs() < 1.0e-3);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct InfluenceKernel {
    grid: Grid,
    body: Body,
    /// Axes along which the body and its load are periodic.
    periodic: [bool; 2],
    /// Distance from a line load at which the displacement is zero \[m\], where one is needed: for a half-space, and
    /// for a layer on one, periodic along one axis.
    datum: Option<f64>,
    response: Response,
    /// Operators on the whole grid, for each choice of folded axes.
    operators: [OnceLock<Arc<SpectralOperator>>; 4],
    facts: Arc<Facts>,
}

/// Properties of the response, each computed at its first use.
#[derive(Debug, Default)]
struct Facts {
    /// The influence of a cell on itself \[m\].
    on_itself: OnceLock<f64>,
    /// Whether a pressure raises the surface somewhere.
    raises: OnceLock<bool>,
    /// The maximum compliance of a wave \[m\], if the mean has none.
    softest: OnceLock<Option<f64>>,
}

/// Buffers of [`InfluenceKernel::convolve`], made by [`InfluenceKernel::workspace`].
#[derive(Debug, Clone)]
pub struct Workspace(pub(crate) TransformWorkspace);

/// The influence operator on a part of a grid, and on its mirror images along folded axes.
#[derive(Debug, Clone)]
pub(crate) struct LocalKernel {
    /// The kernel on the whole grid, whose lengths are the periods of the waves.
    pub(crate) whole: InfluenceKernel,
    grid: Grid,
    rows: Rows,
    folded: [bool; 2],
    operator: Arc<SpectralOperator>,
}

impl InfluenceKernel {
    /// The grid the kernel was made for.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Buffers for [`InfluenceKernel::convolve`]: one for each thread that convolves.
    ///
    /// # Errors
    /// If there is not enough memory for them, or for the spectrum, which is computed here if it was not needed before.
    pub fn workspace(&self) -> Result<Workspace> {
        memory::check("the workspace of a kernel", self.layout([false; 2]).workspace_bytes(None))?;
        Ok(Workspace(self.whole_operator()?.workspace()))
    }

    /// Writes K p into `displacement` \[Pa·m\]: the surface displacement \[m\] under `pressure` \[Pa\] of
    /// a body of contact compliance 1 Pa⁻¹ (Eq. 7 of the [paper](crate::paper)).
    ///
    /// # Errors
    /// If a field does not hold one value per cell, `work` was made by a kernel of another size, a pressure is not
    /// finite, or K p overflows; the contents of `displacement` are then undefined. If `work` was made by another
    /// kernel, and there is not enough memory for the spectrum of this one.
    pub fn convolve(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) -> Result<()> {
        exact_length("pressure", pressure.len(), self.grid.len())?;
        exact_length("displacement", displacement.len(), self.grid.len())?;
        if self.layout([false; 2]) != work.0.layout {
            let (len, expected) = (work.0.layout.numbers(), self.layout([false; 2]).numbers());
            return Err(Error::WrongLength { field: "workspace", len, expected, exact: true });
        }
        self.whole_operator()?.apply(pressure, displacement, &mut work.0);
        if displacement.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        // the pressure is checked only if the result is not finite
        pressure.iter().try_for_each(|&p| finite("pressure", p).map(drop))?;
        let value = displacement.iter().copied().find(|value| !value.is_finite()).unwrap_or(f64::NAN);
        Err(Error::OutOfRange { field: "K p", value, allowed: "finite: the pressure is too great for this kernel" })
    }

    /// The influence coefficient K(i, j) \[m\]: the displacement, over C, of a cell under a unit pressure on the cell
    /// `i` cells away along x1 and `j` along x2. [`InfluenceKernel::convolve`] is the double sum of K(i − k, j − l)
    /// p(k, l) over all cells (k, l), Eq. 7.
    ///
    /// K is purely geometric. The coefficients of the source paper follow from it and the contact compliance C
    /// ([`Material::contact_compliance`](crate::rheology::Material::contact_compliance)):
    ///
    /// | [paper](crate::paper) | body | coefficient \[m/Pa\] |
    /// |---|---|---|
    /// | Eq. 8 | elastic | K_el(i, j) = K(i, j)/E* = (1 − ν) K(i, j)/2G |
    /// | Eq. 12 | viscoelastic, a time t_k after the pressure began | K_vs(i, j, k) = C(t_k) K(i, j), that is 2G Φ(t_k) K_el(i, j) with Φ = J/2 and a constant ν |
    ///
    /// Along a periodic axis the pressure acts on all images of the cell, and i, i − N and −i are equivalent. Where the
    /// mean displacement is the datum ([`InfluenceKernel::periodic`]), distant coefficients are negative.
    ///
    /// One coefficient of a half-space takes one Love integral; of a body given by waves, a sum over all of them
    /// (along its periodic axis, if there is only one), so that for many coefficients the convolution of a unit
    /// pressure takes less time.
    ///
    /// ```
    /// use viscocontact::rheology::{Material, Maxwell};
    /// use viscocontact::{Grid, InfluenceKernel};
    ///
    /// let grid = Grid::square(64, 1.0e-3)?;
    /// let kernel = InfluenceKernel::half_space(&grid)?;
    /// let (shear_modulus, viscosity) = (1.0e6, 2.0e6);
    /// let body = Material::constant_poisson(Maxwell::new(shear_modulus, viscosity)?, 0.4)?;
    ///
    /// let k = kernel.coefficient(3, -5)?;
    /// let elastic = (1.0 - 0.4) / (2.0 * shear_modulus) * k; // Eq. 8
    /// let after_4_s = body.contact_compliance(4.0) * k; // Eq. 12
    /// // J(4 s) = 3/G at a relaxation time of 2 s
    /// assert!((after_4_s / elastic - 3.0).abs() < 1e-14);
    /// // far away the pressure acts as a point force: K → cell area/(π r)
    /// let r = f64::hypot(3.0, 5.0) * grid.spacing()[0];
    /// assert!((k * std::f64::consts::PI * r / grid.cell_area() - 1.0).abs() < 2e-3);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If no two cells of the grid are so far apart: |i| must be less than the number of cells along x1, |j| less than
    /// that along x2.
    pub fn coefficient(&self, i: isize, j: isize) -> Result<f64> {
        let ([n1, n2], at) = (self.grid.cells(), [i, j].map(isize::unsigned_abs));
        if at[0] >= n1 || at[1] >= n2 {
            let what = format!(
                "offset ({i}, {j}) in cells is not allowed: it must be in (-{n1}, {n1}) along x1 and (-{n2}, {n2}) \
                 along x2, the grid having {n1} × {n2} cells"
            );
            return Err(Refusal::value("kernel_offset_outside_grid", what, "").naming("offset").into());
        }
        Ok(self.coefficient_at(at))
    }

    /// The operator on the whole grid, without folded axes; an error if there is not enough memory for it.
    fn whole_operator(&self) -> Result<&Arc<SpectralOperator>> {
        if self.operators[index([false; 2])].get().is_none() {
            let layout = self.layout([false; 2]);
            memory::check("the spectrum of a kernel", MEMORY_WHILE_MADE * layout.operator_bytes(None))?;
        }
        Ok(self.operator([false; 2]))
    }

    /// Bytes of the kernel on some rows, operator and workspace, of the approximate inverse, and of the near field
    /// and its inverse, or the inverse of periodic bodies. An operator that exists already counts zero.
    pub(crate) fn bytes(&self, rows: &Rows, folded: [bool; 2]) -> [u128; 3] {
        let layout = Layout { cells: rows.cells(), ..self.layout(folded) };
        let shares = Shares::new(&layout, rows);
        let shares = shares.as_ref();
        let made = self.is_whole(&layout, rows) && self.operators[index(folded)].get().is_some();
        let operator = if made { 0 } else { layout.operator_bytes(shares) };
        let beside = |other: Layout| {
            let of_other = Shares::new(&other, rows);
            let of_other = of_other.as_ref();
            let work = other.workspace_bytes(of_other) - other.shared_bytes(of_other, (&layout, shares));
            other.operator_bytes(of_other) + work
        };
        let in_gap = if self.periodic == [true; 2] { 1 } else { 2 } * beside(layout.ending(Ends::Closed));
        [operator + layout.workspace_bytes(shares), beside(layout.wrapped()), in_gap]
    }

    /// Whether rows with this layout are all of the grid, in this process.
    fn is_whole(&self, layout: &Layout, rows: &Rows) -> bool {
        *layout == self.layout(layout.folded) && !rows.are_shared()
    }

    /// The operator on the whole grid.
    fn operator(&self, folded: [bool; 2]) -> &Arc<SpectralOperator> {
        self.operators[index(folded)].get_or_init(|| Arc::new(self.make(self.layout(folded), None)))
    }

    /// The layout of the whole grid, or of half or a quarter of it where axes are folded.
    fn layout(&self, folded: [bool; 2]) -> Layout {
        let cells = [0, 1].map(|axis| self.grid.cells()[axis] / if folded[axis] { 2 } else { 1 });
        Layout { cells, ends: self.ends(), folded }
    }

    /// An operator of this layout; where ranks share out its rows, each makes its part of the spectrum.
    fn make(&self, layout: Layout, shares: Option<Shares>) -> SpectralOperator {
        let symbol = self.symbol(layout, shares.as_ref());
        SpectralOperator::new(layout, shares, symbol)
    }

    /// The kernel on a part of the grid and its mirror images along folded axes. Along periodic axes the part is the
    /// whole.
    pub(crate) fn on(&self, part: &Grid, folded: [bool; 2]) -> LocalKernel {
        self.on_rows(part, folded, &Rows::all(part.cells()))
    }

    /// Like [`InfluenceKernel::on`], where `part` is the local rows of `rows`.
    pub(crate) fn on_rows(&self, part: &Grid, folded: [bool; 2], rows: &Rows) -> LocalKernel {
        let layout = Layout { cells: rows.cells(), ..self.layout(folded) };
        let operator = if self.is_whole(&layout, rows) {
            Arc::clone(self.operator(folded))
        } else {
            Arc::new(self.make(layout, Shares::new(&layout, rows)))
        };
        LocalKernel { whole: self.clone(), grid: part.clone(), rows: rows.clone(), folded, operator }
    }

    /// Numbers that tell the kernel from others of its kind.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn mark(&self) -> Vec<f64> {
        let of_user = (self.body == Body::User).then(|| self.table().0.enumerate());
        let sum = of_user.map(|table| table.map(|(k, value)| value.abs() * crate::sum::scattered(k)).sum());
        [self.self_influence()].into_iter().chain(sum).collect()
    }

    /// Axes along which the bodies are periodic, the grid being one period.
    pub fn periodic_axes(&self) -> [bool; 2] {
        self.periodic
    }
}

fn index(folded: [bool; 2]) -> usize {
    2 * usize::from(folded[0]) + usize::from(folded[1])
}

impl LocalKernel {
    /// The local rows.
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The local rows, with the reductions over all ranks.
    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// An approximate inverse, on a layout without padding, and its buffers beside [`LocalKernel::workspace`].
    pub(crate) fn inverse(&self) -> (SpectralOperator, TransformWorkspace) {
        let (layout, symbol) = self.whole.inverse(self.rows.cells(), self.folded);
        let inverse = SpectralOperator::new(layout, Shares::new(&layout, &self.rows), symbol);
        let work = inverse.workspace_sharing(&self.operator);
        (inverse, work)
    }

    /// Axes along which the cells are one whole period.
    pub(crate) fn periodic_axes(&self) -> [bool; 2] {
        [0, 1].map(|axis| self.whole.periodic_axes()[axis] && !self.folded[axis])
    }

    /// Number of mirror images of each cell, itself included.
    pub(crate) fn images(&self) -> f64 {
        images(self.folded) as f64
    }

    pub(crate) fn workspace(&self) -> Workspace {
        Workspace(self.operator.workspace())
    }

    /// [`InfluenceKernel::convolve`] for fields of the right length.
    pub(crate) fn apply(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) {
        self.operator.apply(pressure, displacement, &mut work.0);
    }
}
