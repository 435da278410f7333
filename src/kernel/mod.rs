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

use crate::Grid;
use crate::error::{Result, exact_length};
use love::Love;

/// The discrete influence operator K of a grid: built once, immutable, shared by `Arc` between
/// contacts and threads.
///
/// It keeps a quarter of the padded spectrum, which is real and even: about 8 bytes a cell. A
/// [`Workspace`] holds one complex row spectrum a row, about 16 bytes a cell, one for each thread that
/// convolves.
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
    operator: SpectralOperator<f64>,
    self_influence: f64,
}

/// Buffers of [`InfluenceKernel::convolve`], made by [`InfluenceKernel::workspace`].
#[derive(Debug, Clone)]
pub struct Workspace {
    transform: TransformWorkspace<f64>,
}

impl InfluenceKernel {
    /// The kernel of an elastic half-space: Love's coefficients, right to 1e-14 at every distance
    /// and for cells of any aspect ratio up to 1000, zero-padded so that the convolution is
    /// linear.
    ///
    /// Cost: one Love integral a cell and one transform.
    ///
    /// # Errors
    /// None today; the signature leaves room for grids too large to pad.
    pub fn half_space(grid: &Grid) -> Result<InfluenceKernel> {
        let cells = grid.cells();
        let love = Love::new(grid.spacing());
        let layout = Layout { cells, padded: true, folded: [false; 2] };
        let operator = SpectralOperator::from_coefficients(layout, |i, j| love.coefficient(i, j));
        Ok(InfluenceKernel { grid: grid.clone(), operator, self_influence: love.coefficient(0, 0) })
    }

    /// The grid the kernel was made for.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Buffers for [`InfluenceKernel::convolve`]: one for each thread that convolves.
    pub fn workspace(&self) -> Workspace {
        Workspace { transform: self.operator.workspace() }
    }

    /// Writes K p into `displacement` \[Pa·m\]: the surface displacement \[m\] under `pressure` \[Pa\] of
    /// a body of contact compliance 1 Pa⁻¹.
    ///
    /// # Errors
    /// If a field does not hold one value a cell, or `work` was made by a kernel of another size.
    pub fn convolve(&self, pressure: &[f64], displacement: &mut [f64], work: &mut Workspace) -> Result<()> {
        exact_length("pressure", pressure.len(), self.grid.len())?;
        exact_length("displacement", displacement.len(), self.grid.len())?;
        if !self.operator.fits(&work.transform) {
            let (len, expected) = (work.transform.len(), self.workspace().transform.len());
            return Err(crate::Error::WrongLength { field: "workspace", len, expected, exact: true });
        }
        self.apply(pressure, displacement, work);
        Ok(())
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
