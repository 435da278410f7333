//! The influence of pressure on displacement: Boussinesq's half-space, discretised by Love and
//! convolved by fast Fourier transforms; and its relatives.
//!
//! For an elastic body with contact compliance C = 1/E* the surface displacement is u = C K p with
//! a purely geometric operator:
//!
//! | body | K |
//! |---|---|
//! | half-space | (K p)(x) = ∬ p(x′) / (π \|x − x′\|) dx′ |
//! | periodic along both axes | 2/\|q\| for each wave q, nothing for the mean |
//! | periodic along one axis | (2/π) ∫ K0(κ \|x − s\|) p(s) ds for each wave κ along it, of the mean as for a line |
//! | line contact | −(2/π) ∫ ln(\|x − s\|/d) p(s) ds |
//! | a user's | coefficients from cell to cell, or the compliance of each wave |
//!
//! All behaviour of the material is in C. Normalisation: `convolve` returns K p in Pa·m, no factor
//! of the transform is left to the caller.

mod constructors;
mod influence;
mod lanes;
mod layout;
mod lines;
mod love;
mod positive;
mod spectrum;
mod strip;
mod transform;

pub(crate) use lanes::{join, lanes};
pub(crate) use layout::images;
pub(crate) use transform::{SpectralOperator, TransformWorkspace};

use std::fmt;
use std::sync::{Arc, OnceLock};

use crate::Grid;
use crate::error::{Error, Result, exact_length, finite};
use influence::Influence;
use layout::{Ends, Layout};
use lines::Scalar;

/// The discrete influence operator K of a grid: immutable, shared by `Arc` between contacts and threads.
///
/// Spectra are made when they are first needed, and kept: real and even, a quarter of the padded one is enough, about 8 bytes
/// a cell. A [`Workspace`] holds one complex row spectrum a row, about 16 bytes a cell, twice that if several
/// threads share the work (feature `rayon`, grids of 2¹⁵ cells or more, as many as the thread pool has; the
/// answer is the same bit by bit).
///
/// ```
/// use viscocontact::{Grid, InfluenceKernel};
///
/// let grid = Grid::square(64, 1.0e-3)?;
/// let kernel = InfluenceKernel::half_space(&grid)?;
/// let mut work = kernel.workspace();
/// let pressure = vec![1.0e6; grid.len()];
/// let mut kp = vec![0.0; grid.len()];
/// kernel.convolve(&pressure, &mut kp, &mut work)?;
/// // centre of a uniformly loaded square of side L (Love): K p = 4 L asinh(1) / π p
/// let exact = 4.0 * 1.0e-3 * 1_f64.asinh() / std::f64::consts::PI * 1.0e6;
/// assert!((kp[32 * 64 + 32] / exact - 1.0).abs() < 1.0e-3);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct InfluenceKernel {
    grid: Grid,
    influence: Influence,
    /// On the whole grid, for each choice of folded axes.
    operators: [OnceLock<Arc<SpectralOperator<f64>>>; 4],
    /// The same in single precision.
    singles: [OnceLock<Arc<SpectralOperator<f32>>>; 4],
    /// The influence of a cell on itself, where it is no coefficient.
    on_itself: OnceLock<f64>,
}

/// Buffers of [`InfluenceKernel::convolve`], made by [`InfluenceKernel::workspace`].
#[derive(Debug, Clone)]
pub struct Workspace {
    transform: TransformWorkspace<f64>,
    single: Option<TransformWorkspace<f32>>,
}

/// The influence operator on a part of a grid, and on its mirror images along folded axes.
#[derive(Debug, Clone)]
pub(crate) struct LocalKernel {
    grid: Grid,
    operator: Arc<SpectralOperator<f64>>,
    /// K over the influence of a cell on itself, in single precision, where that is wanted.
    single: Option<Arc<SpectralOperator<f32>>>,
    influence: Influence,
    folded: [bool; 2],
    self_influence: f64,
    softest: Option<f64>,
}

impl InfluenceKernel {
    /// The grid the kernel was made for.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Buffers for [`InfluenceKernel::convolve`]: one for each thread that convolves.
    pub fn workspace(&self) -> Workspace {
        Workspace { transform: self.operator([false; 2]).workspace(), single: None }
    }

    /// Writes K p into `displacement` \[Pa·m\]: the surface displacement \[m\] under `pressure` \[Pa\] of
    /// a body of contact compliance 1 Pa⁻¹.
    ///
    /// # Errors
    /// If a field does not hold one value a cell, `work` was made by a kernel of another size, a pressure is not finite, or
    /// K p leaves the range of `f64`; what `displacement` holds then is of no use.
    pub fn convolve(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) -> Result<()> {
        exact_length("pressure", pressure.len(), self.grid.len())?;
        exact_length("displacement", displacement.len(), self.grid.len())?;
        let operator = self.operator([false; 2]);
        if !operator.fits(&work.transform) {
            let (len, expected) = (work.transform.len(), self.workspace().transform.len());
            return Err(Error::WrongLength { field: "workspace", len, expected, exact: true });
        }
        operator.apply(pressure, displacement, [1.0; 2], &mut work.transform);
        if displacement.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        // one look at the result is enough until something is wrong
        pressure.iter().try_for_each(|&p| finite("pressure", p).map(drop))?;
        let value = displacement.iter().copied().find(|value| !value.is_finite()).unwrap_or(f64::NAN);
        Err(Error::OutOfRange { field: "K p", value, allowed: "finite: the pressure is too great for this kernel" })
    }

    /// The operator on the whole grid.
    fn operator(&self, folded: [bool; 2]) -> &Arc<SpectralOperator<f64>> {
        let layout = self.layout(folded);
        self.operators[index(folded)].get_or_init(|| Arc::new(self.make(layout, 1.0)))
    }

    /// The whole grid, half or a quarter of it where axes are folded.
    fn layout(&self, folded: [bool; 2]) -> Layout {
        let cells = [0, 1].map(|axis| self.grid.cells()[axis] / if folded[axis] { 2 } else { 1 });
        Layout { cells, ends: self.influence.ends(), folded }
    }

    fn make<T: Scalar>(&self, layout: Layout, unit: f64) -> SpectralOperator<T> {
        let symbol = self.influence.symbol(&self.grid, layout);
        SpectralOperator::from_symbol(layout, |k1, k2| symbol(k1, k2) / unit)
    }

    /// The kernel on a part of the grid and its mirror images along folded axes; `single` if it is wanted in single
    /// precision, too. Parts of periodic bodies are whole.
    pub(crate) fn on(&self, part: &Grid, folded: [bool; 2], single: bool) -> LocalKernel {
        let layout = Layout { cells: part.cells(), ..self.layout(folded) };
        let unit = self.self_influence();
        let (operator, single) = if layout == self.layout(folded) {
            let kept = &self.singles[index(folded)];
            let single = single.then(|| Arc::clone(kept.get_or_init(|| Arc::new(self.make(layout, unit)))));
            (Arc::clone(self.operator(folded)), single)
        } else {
            (Arc::new(self.make(layout, 1.0)), single.then(|| Arc::new(self.make(layout, unit))))
        };
        let softest = self.influence.softest_wave_if_mean_is_held(&self.grid);
        let influence = self.influence.clone();
        LocalKernel { grid: part.clone(), operator, single, influence, folded, self_influence: unit, softest }
    }

    /// The influence of a cell on itself \[m\].
    pub(crate) fn self_influence(&self) -> f64 {
        let layout = self.layout([false; 2]);
        let average = || layout.average(self.influence.symbol(&self.grid, layout));
        self.influence.on_itself().unwrap_or_else(|| *self.on_itself.get_or_init(average))
    }

    /// Numbers that tell it from others of the same kind.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn mark(&self) -> Vec<f64> {
        let mut mark = vec![self.self_influence()];
        if let Influence::Coefficients { values, columns } | Influence::Waves { values, columns } = &self.influence {
            mark.extend(crate::sum::moments(values.iter().copied(), *columns));
        }
        mark
    }

    /// Axes along which the bodies are periodic, the grid being one period.
    pub fn periodic_axes(&self) -> [bool; 2] {
        self.influence.ends().map(|end| end == Ends::Periodic)
    }

    /// Whether the surface sinks in everywhere around a load, and no less than the half-space does.
    pub(crate) fn is_half_space(&self) -> bool {
        matches!(self.influence, Influence::HalfSpace(_))
    }
}

/// Says which body it is of: "half-space, periodic along x2, datum 1e0 m".
impl fmt::Display for InfluenceKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.influence.fmt(f)
    }
}

fn index(folded: [bool; 2]) -> usize {
    2 * usize::from(folded[0]) + usize::from(folded[1])
}

impl LocalKernel {
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The greatest compliance of a wave \[m\], where that of the mean is zero.
    pub(crate) fn softest_wave_if_mean_is_held(&self) -> Option<f64> {
        self.softest
    }

    /// Whether a uniform pressure displaces nothing: then the approach cannot exceed that at which the gap is closed.
    pub(crate) fn mean_is_held(&self) -> bool {
        self.softest.is_some()
    }

    /// What an approximate inverse, in the order of 1/`unit`, multiplies the waves of a layout without padding by.
    pub(crate) fn inverse<T: Scalar>(&self, unit: f64) -> SpectralOperator<T> {
        let (layout, symbol) = self.influence.inverse(&self.grid, self.grid.cells(), self.folded);
        SpectralOperator::from_symbol(layout, |k1, k2| symbol(k1, k2) / unit)
    }

    /// How many cells each cell stands for.
    pub(crate) fn images(&self) -> f64 {
        images(self.folded) as f64
    }

    pub(crate) fn workspace(&self) -> Workspace {
        let single = self.single.as_ref().map(|single| single.workspace());
        Workspace { transform: self.operator.workspace(), single }
    }

    /// The coefficient of a cell on itself \[m\].
    pub(crate) fn self_influence(&self) -> f64 {
        self.self_influence
    }

    /// [`InfluenceKernel::convolve`] for fields known to fit.
    pub(crate) fn apply(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) {
        self.operator.apply(pressure, displacement, [1.0; 2], &mut work.transform);
    }

    /// [`LocalKernel::apply`], as precisely as a correction of the pressure of the given size needs it.
    pub(crate) fn apply_to_correction(&self, pressure: &[f64], size: f64, image: &mut [f64], work: &mut Workspace) {
        match (&self.single, &mut work.single) {
            (Some(single), Some(work)) if (1.0 / size).is_normal() => {
                single.apply(pressure, image, [1.0 / size, size * self.self_influence], work);
            }
            _ => self.apply(pressure, image, work),
        }
    }

    /// Whether corrections are convolved in single precision.
    pub(crate) fn is_mixed(&self) -> bool {
        self.single.is_some()
    }
}
