//! The stress below the surface of a half-space.

mod maximum;
mod of_fields;
mod plane;
mod rectangle;
mod section;
mod tensor;
mod waves;

pub use maximum::StressPeak;
pub use section::{StressSection, StressVolume};
pub use tensor::Stress;

use crate::values::Counted;
use num_complex::Complex64;

use crate::axis::Axis;
use crate::error::{Refusal, Result, exact_length, in_order, least_length, within};
use crate::fft::Plane;
use crate::kernel::{HalfSpace, fast_length};
use crate::observe::profile::line_through;
use crate::{Grid, InfluenceKernel, error, memory};
use rectangle::Weights;
use rectangle::corner;
use waves::Wave;

/// Maximum pressure \[Pa\]: the squares of stresses do not overflow.
const GREATEST_PRESSURE: f64 = 1e150;
/// Maximum depth \[m\].
const GREATEST_DEPTH: f64 = 1e100;
/// Maximum distance of a point from the origin, in depths of the point: powers of the distance do not overflow.
const FARTHEST: f64 = 1e40;
/// The sides of cells along a line, in depths: the farthest distance is nothing beside it.
const ENDLESS: f64 = 1e60;

/// The stress below the surface of a half-space under a pressure: on planes, on sections, at points, and where it is
/// largest. See [`Fields::stress`](crate::fields::Fields::stress).
///
/// x3 is the depth below the surface, x1 and x2 are the coordinates of the grid; tension is positive, σ33 at the
/// surface is minus the pressure.
///
/// **Which pressure.** Equations of equilibrium and compatibility contain no modulus but Poisson's ratio ν. While
/// this is constant, the stress in a linear viscoelastic half-space equals the stress in an elastic half-space under
/// the present tractions. These are known on the whole surface: the pressure, and zero outside the contact. Creep and
/// history act only through the pressure. Where ν changes as the body creeps
/// ([`Material::elastic_bulk`](crate::rheology::Material::elastic_bulk)), the stress depends on pressures of the past,
/// too, and is refused.
///
/// **Which bodies.** A half-space loaded on the cells of the grid: closed forms of a rectangle, convolved on a padded
/// grid. Line contacts: plane strain, σ22 (along the line) = ν (σ11 + σ33). Periodic bodies: closed forms of each
/// wave; below the mean pressure p̄ σ33 = −p̄, and the lateral stress is −ν/(1 − ν) p̄, since every period keeps its
/// lengths. The stress in the counter body is the same function of the pressure, with its own ν, and x3 the depth
/// below its surface. The stress is not known, and refused, in layers, in user-defined bodies, and in bodies periodic
/// along one axis with several cells along it.
///
/// **How near the surface.** The pressure is constant over each cell: depths below half the longer side of a cell are
/// refused, since there the stress varies within a cell. Where the pressure rises evenly from cell to cell, the
/// ripple of σ33 is 6 % of the difference between neighbours at half a side, 0.4 % at one side, and falls by e^(−2π)
/// with each further one: (1 + qz) e^(−qz)/π for the wave q = 2π/side.
///
/// Cost: a plane takes one closed form per cell, three forward and three inverse complex transforms of the padded
/// grid, on as many threads as the pool has (feature `rayon`, with the same result); a section takes a plane per
/// depth; a point one closed form per loaded cell.
///
/// ```
/// use viscocontact::{observe::Stress, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(64, 2.4e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Elastic::new(1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(0.5))?;
/// let stress = contact.fields().stress()?;
/// let depths: Vec<f64> = (1..=20).map(|k| f64::from(k) * 0.05e-3).collect();
/// let peak = stress.maximum(&depths, Stress::von_mises)?;
/// // ν = ½: 0.5327 p0 at 0.548 a below the centre
/// let hertz = viscocontact::analytic::Hertz::new(10.0e-3, 4.0e6, 0.5)?;
/// assert!((peak.value / hertz.pressure(0.0) - 0.5327).abs() < 2.0e-3);
/// assert!((peak.position[2] / hertz.contact_radius - 0.548).abs() < 5.0e-3);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SubsurfaceStress {
    grid: Grid,
    body: HalfSpace,
    source: Source,
    transform: Plane,
    min_depth: f64,
}

/// The pressure.
#[derive(Clone)]
struct Source {
    field: Vec<f64>,
    /// Its transform on the padded grid.
    spectrum: Vec<Complex64>,
    weights: Weights,
}

debug_by!(self: Source => field: Counted(&self.field), spectrum: Counted(&self.spectrum), weights: self.weights);

impl SubsurfaceStress {
    /// The stress in the body of `kernel` with the constant Poisson's ratio `poisson_ratio`, under `pressure` \[Pa\],
    /// one value per cell of the kernel's grid; negative values pull.
    ///
    /// # Errors
    /// If the stress in the body is not known, there is not one pressure per cell, one is
    /// not finite or beyond ±1e150 Pa, `poisson_ratio` is outside (−1, ½], or there is not enough memory for the
    /// transforms.
    pub fn new(kernel: &InfluenceKernel, pressure: &[f64], poisson_ratio: f64) -> Result<SubsurfaceStress> {
        let nu = error::poisson_ratio("Poisson's ratio", poisson_ratio)?;
        let body = SubsurfaceStress::body_of(kernel)?;
        let grid = kernel.grid().clone();
        exact_length("pressure", pressure.len(), grid.len())?;
        for &value in pressure {
            within("pressure", value, value.abs() <= GREATEST_PRESSURE, "finite and at most 1e150 Pa in magnitude")?;
        }
        let periods = [0, 1].map(|axis| match (body, grid.cells()[axis]) {
            (HalfSpace::Periodic, cells) => cells,
            (_, 1) => 1,
            (_, cells) => fast_length(2 * cells - 1),
        });
        let padded = periods[0] as u128 * periods[1] as u128;
        // the spectrum, two buffers, the field and the closed forms
        memory::check("the stress below the surface", 3 * 16 * padded + 56 * grid.len() as u128)?;
        let transform = Plane::new(periods);
        let mut work = vec![Complex64::default(); transform.len()];
        let mut spectrum = vec![Complex64::default(); transform.len()];
        for (to, from) in spectrum.chunks_exact_mut(periods[1]).zip(pressure.chunks_exact(grid.cells()[1])) {
            to.iter_mut().zip(from).for_each(|(to, &value)| *to = Complex64::from(value));
        }
        transform.forward(&mut spectrum, &mut work);
        let source = Source { field: pressure.to_vec(), spectrum, weights: [1.0, 1.0 - 2.0 * nu] };
        // a single cell along an axis resolves nothing there, unless it is the only one
        let sides = grid.spacing();
        let resolved = (0..2).filter(|&axis| grid.cells()[axis] > 1).map(|axis| sides[axis]);
        let longest = resolved.fold(0.0, f64::max);
        let min_depth = 0.5 * if longest > 0.0 { longest } else { sides[0].max(sides[1]) };
        Ok(SubsurfaceStress { grid, body, source, transform, min_depth })
    }

    /// The half-space whose stress is known.
    fn body_of(kernel: &InfluenceKernel) -> Result<HalfSpace> {
        kernel.half_space_below().ok_or_else(|| {
            let what = format!("the stress below the surface is not known of this body ({kernel})");
            Refusal::unsupported("kernel_no_stress", what, "")
                .must_be("a half-space, one periodic along both axes, or a line contact of half-spaces")
                .into()
        })
    }

    /// The grid of the pressure.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The minimum depth \[m\] at which the stress is given: half of the longer side of a cell. Along an axis with a
    /// single cell, as in line contacts, its side does not count.
    pub fn min_depth(&self) -> f64 {
        self.min_depth
    }

    /// The stress below the centre of each cell at a depth \[m\], in the order of fields.
    ///
    /// # Errors
    /// If the depth is less than [`SubsurfaceStress::min_depth`], or more than 1e100 m.
    pub fn on_plane(&self, depth: f64) -> Result<Vec<Stress>> {
        self.check_depth(depth)?;
        let mut plane = memory::field("the stress on a plane", self.grid.len(), Stress::default())?;
        self.buffers().fill_plane(self, depth, &mut plane);
        Ok(plane)
    }

    /// The stress on a vertical section: below the line of cells in the direction of `along` that contains the other
    /// coordinate `at` \[m\], at each of the `depths` \[m\].
    ///
    /// # Errors
    /// If `at` lies outside the grid, there are no depths, they do not rise, or one is out of the range of
    /// [`SubsurfaceStress::on_plane`].
    pub fn on_section(&self, along: Axis, at: f64, depths: &[f64]) -> Result<StressSection> {
        let (axis, across) = along.and_other();
        let line = line_through(&self.grid, across, ("coordinate of the section", at))?;
        self.check_depths(depths)?;
        let cells = self.grid.cells()[axis];
        let mut values = memory::field("the stress on a section", cells * depths.len(), Stress::default())?;
        let mut plane = memory::field("the stress on a plane", self.grid.len(), Stress::default())?;
        let (mut buffers, n2) = (self.buffers(), self.grid.cells()[1]);
        let cell = |k: usize| if axis == 0 { k * n2 + line } else { line * n2 + k };
        for (layer, &depth) in depths.iter().enumerate() {
            buffers.fill_plane(self, depth, &mut plane);
            (0..cells).for_each(|k| values[k * depths.len() + layer] = plane[cell(k)]);
        }
        Ok(StressSection {
            along,
            at: self.grid.coordinate(across, line),
            positions: (0..cells).map(|k| self.grid.coordinate(axis, k)).collect(),
            depths: depths.to_vec(),
            values,
        })
    }

    /// The stress in a volume: below the centre of each cell, at each of the `depths` \[m\].
    ///
    /// # Errors
    /// As [`SubsurfaceStress::on_section`], and if there is not enough memory for six numbers per cell and depth.
    pub fn in_volume(&self, depths: &[f64]) -> Result<StressVolume> {
        self.check_depths(depths)?;
        let count = self.grid.len().saturating_mul(depths.len());
        let mut values = memory::field("the stress in a volume", count, Stress::default())?;
        let mut buffers = self.buffers();
        for (&depth, plane) in depths.iter().zip(values.chunks_exact_mut(self.grid.len())) {
            buffers.fill_plane(self, depth, plane);
        }
        Ok(StressVolume { grid: self.grid.clone(), depths: depths.to_vec(), values })
    }

    /// The stress at points (x1, x2, x3) \[m\], anywhere below the surface and not only below the grid: by the sum
    /// over all cells, without transforms. Along the axis of a line contact the coordinate does not matter.
    ///
    /// # Errors
    /// If the depth x3 of a point is out of the range of [`SubsurfaceStress::on_plane`], or x1 or x2 is not finite,
    /// or beyond ±1e40 depths.
    pub fn at(&self, points: &[[f64; 3]]) -> Result<Vec<Stress>> {
        for &[x1, x2, x3] in points {
            self.check_depth(x3)?;
            for (field, x) in [("coordinate x1 of a point", x1), ("coordinate x2 of a point", x2)] {
                within(field, x, x.abs() <= FARTHEST * x3, "finite and at most 1e40 times the depth of the point")?;
            }
        }
        Ok(points.iter().map(|&point| self.at_point(point)).collect())
    }

    /// The stress at a point in the range that [`SubsurfaceStress::at`] accepts.
    fn at_point(&self, point: [f64; 3]) -> Stress {
        let Source { field, spectrum, weights } = &self.source;
        match self.body {
            HalfSpace::Periodic => waves::below_field(&self.grid, spectrum, point, *weights),
            _ => rectangle::below_cells(&self.grid, self.sides(point[2]), field, point, *weights),
        }
    }

    /// Sides of a loaded cell \[m\], endless along a line.
    fn sides(&self, depth: f64) -> [f64; 2] {
        let mut sides = self.grid.spacing();
        if let HalfSpace::Line { across } = self.body {
            sides[1 - across] = ENDLESS * depth;
        }
        sides
    }

    fn check_depth(&self, depth: f64) -> Result<()> {
        let near = "at least half the longest side of a cell across which the grid resolves anything \
            (`min_depth`): nearer the stress varies within a cell";
        within("depth", depth, depth >= self.min_depth, near)?;
        within("depth", depth, depth <= GREATEST_DEPTH, "at most 1e100 m").map(drop)
    }

    fn check_depths(&self, depths: &[f64]) -> Result<()> {
        least_length("depths", depths.len(), 1)?;
        depths.iter().try_for_each(|&depth| self.check_depth(depth))?;
        in_order("depths", depths.iter().copied(), "rise", |previous, value| value > previous)
    }
}

#[cfg(test)]
mod tests;
