//! The influence of pressure on displacement: Boussinesq's half-space, discretised by Love and
//! convolved by fast Fourier transforms.
//!
//! For an elastic body with contact compliance C = 1/E* the surface displacement is u = C K p with
//! the purely geometric operator
//!
//! (K p)(x) = ∬ p(x′) / (π |x − x′|) dx′;
//!
//! all behaviour of the material is in C. Normalisation: `convolve` returns K p in Pa·m, no factor
//! of the transform is left to the caller.

mod lanes;
mod lines;
mod love;
mod spectrum;
mod transform;

pub(crate) use transform::{Layout, SpectralOperator, TransformWorkspace};

use std::sync::{Arc, OnceLock};

use crate::Grid;
use crate::error::{Result, exact_length};
use love::Love;

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
    love: Love,
    /// On the whole grid, for each choice of folded axes.
    operators: [OnceLock<Arc<SpectralOperator<f64>>>; 4],
}

/// Buffers of [`InfluenceKernel::convolve`], made by [`InfluenceKernel::workspace`].
#[derive(Debug, Clone)]
pub struct Workspace {
    transform: TransformWorkspace<f64>,
}

/// The influence operator on a part of a grid, and on its mirror images along folded axes.
#[derive(Debug, Clone)]
pub(crate) struct LocalKernel {
    grid: Grid,
    operator: Arc<SpectralOperator<f64>>,
    folded: [bool; 2],
    self_influence: f64,
}

impl InfluenceKernel {
    /// The kernel of an elastic half-space: Love's coefficients, right to 1e-14 at every distance
    /// and for cells of any aspect ratio up to 1000, zero-padded so that the convolution is
    /// linear.
    ///
    /// Cost, at the first use: one Love integral a cell and one transform.
    ///
    /// # Errors
    /// None today; the signature leaves room for grids too large to pad.
    pub fn half_space(grid: &Grid) -> Result<InfluenceKernel> {
        Ok(InfluenceKernel { grid: grid.clone(), love: Love::new(grid.spacing()), operators: Default::default() })
    }

    /// The grid the kernel was made for.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Buffers for [`InfluenceKernel::convolve`]: one for each thread that convolves.
    pub fn workspace(&self) -> Workspace {
        Workspace { transform: self.operator([false; 2]).workspace() }
    }

    /// Writes K p into `displacement` \[Pa·m\]: the surface displacement \[m\] under `pressure` \[Pa\] of
    /// a body of contact compliance 1 Pa⁻¹.
    ///
    /// # Errors
    /// If a field does not hold one value a cell, or `work` was made by a kernel of another size.
    pub fn convolve(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) -> Result<()> {
        exact_length("pressure", pressure.len(), self.grid.len())?;
        exact_length("displacement", displacement.len(), self.grid.len())?;
        let operator = self.operator([false; 2]);
        if !operator.fits(&work.transform) {
            let (len, expected) = (work.transform.len(), self.workspace().transform.len());
            return Err(crate::Error::WrongLength { field: "workspace", len, expected, exact: true });
        }
        operator.apply(pressure, displacement, 1.0, &mut work.transform);
        Ok(())
    }

    /// The operator on the whole grid, half or a quarter of it where axes are folded.
    fn operator(&self, folded: [bool; 2]) -> &Arc<SpectralOperator<f64>> {
        let [n1, n2] = self.grid.cells();
        let cells = [if folded[0] { n1 / 2 } else { n1 }, if folded[1] { n2 / 2 } else { n2 }];
        let kept = &self.operators[2 * usize::from(folded[0]) + usize::from(folded[1])];
        kept.get_or_init(|| Arc::new(self.make(Layout { cells, padded: true, folded })))
    }

    fn make(&self, layout: Layout) -> SpectralOperator<f64> {
        SpectralOperator::from_coefficients(layout, |i, j| self.love.coefficient(i, j))
    }

    /// The kernel on a part of the grid and its mirror images along folded axes.
    pub(crate) fn on(&self, part: &Grid, folded: [bool; 2]) -> LocalKernel {
        let images = folded.iter().filter(|folded| **folded).count();
        let operator = if part.len() << images == self.grid.len() {
            Arc::clone(self.operator(folded))
        } else {
            Arc::new(self.make(Layout { cells: part.cells(), padded: true, folded }))
        };
        LocalKernel { grid: part.clone(), operator, folded, self_influence: self.love.coefficient(0, 0) }
    }
}

impl LocalKernel {
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How many cells each cell stands for.
    pub(crate) fn images(&self) -> f64 {
        self.folded.iter().map(|&folded| if folded { 2.0 } else { 1.0 }).product()
    }

    pub(crate) fn workspace(&self) -> Workspace {
        Workspace { transform: self.operator.workspace() }
    }

    /// The coefficient of a cell on itself \[m\].
    pub(crate) fn self_influence(&self) -> f64 {
        self.self_influence
    }

    /// [`InfluenceKernel::convolve`] for fields known to fit.
    pub(crate) fn apply(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) {
        self.operator.apply(pressure, displacement, 1.0, &mut work.transform);
    }
}
