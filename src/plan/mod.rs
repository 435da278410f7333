//! Mesh, domain and steps for a given accuracy.

mod accuracy;

pub use accuracy::Accuracy;

use crate::Grid;
use crate::contact::{Builder, Stepping, ViscoelasticContact};
use crate::error::{Error, Result, positive};
use crate::geometry::Geometry;
use crate::load::{Load, LoadHistory};
use crate::observe::mesh_error::{AREA_ORDER, MeshError};
use crate::rheology::Material;

/// A scene planned for an accuracy: the extent of the contact, the cells and steps needed, and their cost.
///
/// Cheap runs on a coarse mesh find the domain, the steps and the error of the mesh. That error is extrapolated, with
/// second order where the contact is smooth and first order at singular edges, to the number of cells that meets the
/// target. The plan returns a builder, which can be changed before the contact is built.
///
/// ```
/// use viscocontact::plan::{Accuracy, Plan};
/// use viscocontact::prelude::*;
///
/// let sphere = Sphere::new(10.0e-3)?;
/// let body = Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?);
/// let load = StepLoad::new(Load::force(1.0))?;
/// let plan = Plan::new(&sphere, &body, &load, 2.0, Accuracy::Standard)?;
/// println!("{plan}");
///
/// let mut contact = plan.builder().build()?;
/// let mut run = contact.follow(&load, plan.stepping(), 2.0);
/// while run.next_step()?.is_some() {}
/// let exact = viscocontact::analytic::GrowingSphere::step(10.0e-3, &body, 1.0)?;
/// assert!((contact.approach() / exact.approach(2.0) - 1.0).abs() < 1e-3);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Plan {
    accuracy: Accuracy,
    builder: Builder,
    grid: Grid,
    /// Half sides of the rectangle that contains the contact at all times.
    reach: [f64; 2],
    steps: usize,
    convolutions: f64,
    error: MeshError,
    bytes: u64,
}

/// Cells along a side of the coarse runs.
const COARSE_CELLS: usize = 24;
/// Ratio of the domain to the rectangle of the contact.
const DOMAIN_TO_CONTACT: f64 = 1.12;
/// Greatest number of domains tried, each at most ten times as large or as small as the last.
const MAX_DOMAINS: usize = 60;
/// A domain is accepted if the contact spans a fraction of it in this range.
const CONTACT_FRACTION: [f64; 2] = [0.45, 0.92];
/// Cells along a side of a plan: fewer do not resolve a contact, more exceed a workstation.
const LEAST_CELLS: usize = 16;
const MOST_CELLS: usize = 1 << 13;

impl Plan {
    /// Plans a run of one body from rest to the time `until` \[s\].
    ///
    /// # Errors
    /// If the time is not finite and positive, a part is invalid, no domain holds the contact, the coarse runs fail, or
    /// the target needs more than 8192 cells along a side.
    pub fn new(
        geometry: &dyn Geometry,
        material: &Material,
        history: &dyn LoadHistory,
        until: f64,
        accuracy: Accuracy,
    ) -> Result<Plan> {
        positive("end of the run", until)?;
        Accuracy::target_of(accuracy.target())?;
        let coarse = Coarse { geometry, material, history, until, accuracy };
        let (reach, found) = coarse.domain()?;
        let lengths = reach.map(|half| 2.0 * DOMAIN_TO_CONTACT * half);

        // error(n) = second (COARSE_CELLS/n)² + first COARSE_CELLS/n
        let (first, target) = (found.error.singular, accuracy.space());
        let second = (found.error.approach.max(found.error.greatest_pressure) - first).max(0.0);
        let shrink = (first + (first * first + 4.0 * second * target).sqrt()) / (2.0 * target);
        let wanted = (COARSE_CELLS as f64 * shrink).ceil();
        if wanted > MOST_CELLS as f64 {
            let (field, allowed) = ("cells along a side for this accuracy", "at most 8192: choose a lower accuracy");
            return Err(Error::CountOutOfRange { field, value: wanted.min(1e18) as usize, allowed });
        }
        let cells = smooth_size((wanted as usize).max(LEAST_CELLS));
        let ratio = COARSE_CELLS as f64 / cells as f64;
        let grid = Grid::new([cells; 2], lengths)?;
        let finer = |error: f64| (error - first) * ratio * ratio + first * ratio;
        let error = MeshError {
            approach: finer(found.error.approach),
            greatest_pressure: finer(found.error.greatest_pressure),
            area: found.error.area * ratio.powf(AREA_ORDER),
            singular: first * ratio,
        };
        let builder = coarse.builder(grid.clone());
        let memory = builder.memory()?;
        let slope = 8 * memory.computed_cells as u64; // the rate that adaptive steps store
        let bytes = memory.total() + slope;
        Ok(Plan { accuracy, builder, grid, reach, steps: found.steps, convolutions: found.convolutions, error, bytes })
    }

    /// A builder with grid, geometry, material and settings, each of which can be replaced.
    pub fn builder(&self) -> Builder {
        self.builder.clone()
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The stepping, for [`ViscoelasticContact::follow`].
    pub fn stepping(&self) -> Stepping {
        self.accuracy.stepping()
    }

    /// The accuracy.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Expected extent of the contact from the middle of the grid, along x1 and x2 \[m\].
    pub fn reach(&self) -> [f64; 2] {
        self.reach
    }

    /// Approximate number of steps of the run.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Approximate number of convolution equivalents of the run, each O(N log N) in the number of cells.
    pub fn convolutions(&self) -> f64 {
        self.convolutions
    }

    /// Approximate memory of the contact \[bytes\]: [`Builder::memory`], the fields of adaptive steps, and the series
    /// of the material.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Expected errors of the mesh.
    pub fn mesh_error(&self) -> MeshError {
        self.error
    }
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([n1, n2], [l1, l2]) = (self.grid.cells(), self.grid.lengths());
        write!(
            f,
            "for {:.0e}: {n1} × {n2} cells on {l1:.3e} m × {l2:.3e} m, about {} steps, {:.0} convolutions, {:.1} MB; errors of the \
             mesh: approach {:.1e}, peak pressure {:.1e}, area {:.1e}",
            self.accuracy.target(),
            self.steps,
            self.convolutions,
            self.bytes as f64 * 1e-6,
            self.error.approach,
            self.error.greatest_pressure,
            self.error.area
        )
    }
}

/// The scene on a coarse mesh.
struct Coarse<'a> {
    geometry: &'a dyn Geometry,
    material: &'a Material,
    history: &'a dyn LoadHistory,
    until: f64,
    accuracy: Accuracy,
}

/// The result of a coarse run.
struct Found {
    /// Half sides of the rectangle about the origin that contained the contact.
    reach: [f64; 2],
    steps: usize,
    convolutions: f64,
    /// Greatest errors of the mesh while the force is not small.
    error: MeshError,
}

impl Coarse<'_> {
    fn builder(&self, grid: Grid) -> Builder {
        let builder = ViscoelasticContact::builder(grid).geometry(self.geometry).material(self.material.clone());
        builder.settings(self.accuracy.settings()).times_of(self.history, self.until)
    }

    /// Runs on domains until the contact fills one well; returns its extent.
    fn domain(&self) -> Result<([f64; 2], Found)> {
        let mut lengths = [self.first_length()?; 2];
        for _ in 0..MAX_DOMAINS {
            match self.run(lengths) {
                Err(Error::ContactAtEdge { .. }) => lengths = lengths.map(|length| 1.7 * length),
                Err(Error::NothingToTouch { .. }) => lengths = lengths.map(|length| 0.3 * length),
                Err(error) => return Err(error),
                Ok(found) => {
                    let filled = [0, 1].map(|axis| 2.0 * found.reach[axis] / lengths[axis]);
                    if filled.iter().all(|part| (CONTACT_FRACTION[0]..=CONTACT_FRACTION[1]).contains(part)) {
                        return Ok((found.reach, found));
                    }
                    let least = 2.0 / COARSE_CELLS as f64;
                    lengths = [0, 1].map(|axis| lengths[axis] * (filled[axis].max(least) * 1.3).clamp(0.1, 1.7));
                }
            }
        }
        Err(Error::NoDomain { length: lengths[0].max(lengths[1]) })
    }

    fn run(&self, lengths: [f64; 2]) -> Result<Found> {
        let grid = Grid::new([COARSE_CELLS; 2], lengths)?;
        let mut contact = self.builder(grid).build()?;
        let mut found = Found { reach: [0.0; 2], steps: 0, convolutions: 0.0, error: MeshError::default() };
        let (mut deepest, mut highest, mut states) = (0.0_f64, 0.0_f64, Vec::new());
        let mut run = contact.follow(self.history, self.accuracy.stepping(), self.until);
        while let Some(report) = run.next_step()? {
            found.steps += 1;
            found.convolutions += report.convolution_equivalents();
            let peak = run.contact().pressure().iter().copied().fold(0.0, f64::max);
            (deepest, highest) = (deepest.max(report.approach), highest.max(peak));
            states.push((report.approach, peak, run.contact().mesh_error()));
            let touched = run.contact().reach_of_contact();
            found.reach = [0, 1].map(|axis| found.reach[axis].max(touched[axis]));
        }
        // errors relative to the greatest values of the run: a small contact may be coarse if its share is small
        for (approach, peak, error) in states {
            let (approach, peak) = ((approach / deepest).clamp(0.0, 1.0), peak / highest);
            if approach.is_nan() || peak.is_nan() {
                continue;
            }
            found.error = MeshError {
                approach: found.error.approach.max(approach * error.approach),
                greatest_pressure: found.error.greatest_pressure.max(peak * error.greatest_pressure),
                area: found.error.area.max(approach * error.area),
                singular: found.error.singular.max(approach * error.singular),
            };
        }
        Ok(found)
    }

    /// Initial length of the domain: a contact of half width L/4 is indented by the gap there, under a force of about
    /// E* L times that gap.
    fn first_length(&self) -> Result<f64> {
        let (mut force, mut approach) = (0.0_f64, 0.0_f64);
        for k in 0..=64 {
            let time = self.until * f64::from(k) / 64.0;
            match self.history.at(time).validated_at(time)? {
                Load::Force { normal, .. } => force = force.max(normal),
                Load::Approach { approach: depth, .. } => approach = approach.max(depth),
            }
        }
        let mut compliance = self.material.contact_compliance(self.until.min(self.material.known_until()));
        if !compliance.is_finite() {
            compliance = self.material.contact_compliance(0.0);
        }
        let lowest = self.geometry.initial_gap(0.0, 0.0);
        let rise = |length: f64| {
            let around = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
            let gaps = around.map(|[x1, x2]| self.geometry.initial_gap(0.25 * length * x1, 0.25 * length * x2));
            gaps.into_iter().fold(f64::INFINITY, f64::min) - lowest
        };
        let depth = |length: f64| {
            let rise = rise(length);
            rise >= approach.max(force * compliance / length) || rise.is_nan() || rise == f64::INFINITY
        };
        let lengths = (-48..=36).map(|k| 10f64.powf(0.25 * f64::from(k)));
        lengths.into_iter().find(|&length| depth(length)).ok_or(Error::NoDomain { length: 1e9 })
    }
}

/// The next number of cells whose double has no prime factor above 5, for fast transforms.
fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least..).find(|&n| n.is_multiple_of(2) && smooth(n)).unwrap_or(least)
}
