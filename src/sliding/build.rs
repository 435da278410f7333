//! The contact in steady motion that a builder makes.

use std::sync::Arc;

use num_complex::Complex64;

use super::bodies::Bodies;
use super::creep::Creep;
use super::{SteadySliding, coverage, gmres};
use crate::contact::{Builder, Frame, Scene};
use crate::equilibrium::{Ground, Held, Region};
use crate::error::{Result, Special};
use crate::fields::View;
use crate::kernel::HalfSpace;
use crate::memory;
use crate::motion::CounterMotion;
use crate::rheology::{CreepSpectrum, Elastic, Material};

/// Whether a gap changes at one place along a periodic axis by far more than anywhere else: a
/// height map that does not repeat has a step where its end meets its beginning, wherever its
/// origin lies. Rows that are not finite everywhere do not close.
fn jumps(gap: &[f64], cells: [usize; 2], periodic: [bool; 2]) -> bool {
    (0..2).filter(|&axis| periodic[axis] && cells[axis] > 2).any(|axis| {
        let (n, [along, aside]) = (cells[axis], if axis == 0 { [cells[1], 1] } else { [1, cells[1]] });
        let mut rises = vec![0.0_f64; n];
        for row in 0..gap.len() / n {
            let height = |i: usize| gap[row * aside + i % n * along];
            if (0..n).all(|i| height(i).is_finite()) {
                rises.iter_mut().enumerate().for_each(|(i, rise)| *rise = rise.max((height(i + 1) - height(i)).abs()));
            }
        }
        rises.sort_by(f64::total_cmp);
        rises[n - 1] > JUMP * rises[n - 2]
    })
}

/// A shape that changes at one place by so many times as much as at any other one jumps there.
const JUMP: f64 = 4.0;

/// Bytes of a problem in steady motion beside its contact, at most.
fn bytes(cells: [usize; 2], periodic: [bool; 2]) -> u64 {
    let [n1, n2] = cells.map(|n| n as u64);
    let padded = [0, 1].map(|axis| if periodic[axis] || cells[axis] == 1 { 1 } else { 2 } * cells[axis] as u64);
    // factors, coefficients and losses of the response, with its symmetric part; of the inverses,
    // and of both on coarser meshes
    let (response, inverse) = (80 * padded[0] * (padded[1] / 2 + 1), 86 * n1 * (n2 / 2 + 1));
    // influences at about four nodes a cell, and the panels of these; tables of coefficients
    let nodes = if periodic == [true; 2] { 0 } else { 150 * n1 * n2 };
    // two fields for each direction, and a dozen others
    response + inverse + nodes + 8 * (2 * gmres::MOST as u64 + 12) * n1 * n2
}

fn series(material: &Material) -> Result<Creep> {
    material.spectrum_for("a motion").map(Creep::Series)
}

/// How the bodies respond to a steady motion.
struct CreepInMotion {
    creep: Creep,
    measured: [f64; 2],
    /// The part of the relaxed compliance of points at rest that was not measured.
    unmeasured_at_rest: f64,
}

impl CreepInMotion {
    fn of(material: &Material, motion: Option<CounterMotion>) -> Result<CreepInMotion> {
        let (pair, [own, counter]) = (material.poisson_ratios().count() > 1, material.apart());
        if pair && let Some(CounterMotion::Slides) = motion {
            let (own_creep, resting) = (own.spectrum_for("a motion")?, counter.spectrum_for("a motion")?);
            coverage::FLOWING_COUNTER.refuse_if(|_| resting.fluidity() > 0.0)?;
            // its points are at rest under the pressure
            let relaxed = resting.relaxed();
            let is_measured = Creep::Series(resting).is_relaxed(counter.measured()[1]);
            let unmeasured_at_rest = if is_measured { 0.0 } else { relaxed / (relaxed + own_creep.relaxed()) };
            let glassy = own_creep.glassy() + relaxed;
            let creep = Creep::Series(CreepSpectrum::new(glassy, own_creep.fluidity(), own_creep.terms())?);
            return Ok(CreepInMotion { creep, measured: own.measured(), unmeasured_at_rest });
        }
        let creeps = |own: CreepSpectrum| own.fluidity() > 0.0 || !own.terms().is_empty();
        let unknown = pair && motion.is_none() && counter.contact_spectrum()?.is_none_or(creeps);
        coverage::COUNTER_BODY.refuse_if(|_| unknown)?;
        Ok(CreepInMotion { creep: series(material)?, measured: material.measured(), unmeasured_at_rest: 0.0 })
    }
}

impl Builder {
    /// Whether a creeping counter-body slides or rolls in a steady motion:
    /// [`Builder::build_sliding`] needs to know. Steps do not, in which bodies that both creep roll
    /// ([`motion`](crate::motion)).
    pub fn counter_motion(self, motion: CounterMotion) -> Builder {
        Builder { counter_motion: Some(motion), ..self }
    }

    /// A contact in steady motion, for [`SteadySliding::at`]: it takes the parts of
    /// [`Builder::build`]. All fields take the whole grid.
    ///
    /// All bodies of the crate are covered but kernels of coefficients
    /// ([`InfluenceKernel::from_coefficients`](crate::InfluenceKernel::from_coefficients)). Bodies
    /// that are periodic along both axes are passed in any direction, the others along x1 or x2.
    /// Where a body is periodic the shape must be periodic too: a height map that does not repeat
    /// slides over an edge, and a shape with a single step in its period, at whatever place, is
    /// refused. A half-space may flow: the pressure under a force is steady then. A counter-body
    /// that creeps slides or rolls: [`Builder::counter_motion`] says which.
    ///
    /// # Errors
    /// As [`Builder::build`], and if the body is another one, or flows, the surfaces attract each
    /// other, there are several rigid bodies, ranks, or a history of the temperature: scale the
    /// velocity by the shift factor instead.
    pub fn build_sliding(self) -> Result<SteadySliding> {
        self.sliding(None)
    }

    /// [`Builder::build_sliding`] on a body of which the complex contact modulus E* = 1/C \[Pa\] is
    /// known as a function of the frequency ≥ 0 \[rad/s\], E′ + i E″, without a series, with E″ ≥ 0
    /// for bodies that dissipate. It takes the place of [`Builder::material`]; 4 G* if the body is
    /// incompressible. Only bodies that are periodic along both axes are covered.
    ///
    /// # Errors
    /// As [`Builder::build_sliding`]; if the body is not periodic along both axes, or there is a
    /// counter-body. [`SteadySliding::at`] fails where E′ is not positive, or E″ is negative.
    pub fn build_sliding_by(
        mut self,
        modulus: impl Fn(f64) -> Complex64 + Send + Sync + 'static,
    ) -> Result<SteadySliding> {
        self = self.material(Material::incompressible(Elastic::new(0.25 * modulus(0.0).re)?));
        self.sliding(Some(Creep::Modulus(Arc::new(modulus))))
    }

    /// Bytes of a contact in steady motion at most, with all cells in contact: of
    /// [`Builder::memory`], the factors of waves and the nodes of influences, and the directions of
    /// the iteration, which are most. No field is allocated to find out.
    ///
    /// # Errors
    /// As [`Builder::memory`].
    pub fn sliding_memory(&self) -> Result<u64> {
        let own = self.memory()?;
        // neither symmetry nor a window counts
        let times = (self.grid.len() as u64).div_ceil(own.computed_cells.max(1) as u64);
        let periodic = self.kernel.as_ref().map_or([false; 2], |kernel| kernel.periodic_axes());
        Ok(own.total().saturating_mul(times).saturating_add(bytes(self.grid.cells(), periodic)))
    }

    fn sliding(mut self, modulus: Option<Creep>) -> Result<SteadySliding> {
        self.is_covered(Special::SteadyMotion)?;
        self.settings = self.settings.with_symmetry(false).with_window(false).with_frame(Frame::Bodies);
        memory::check("a contact in steady motion", self.sliding_memory()?.into())?;
        let motion = self.counter_motion;
        let (scene, _, indenter) = self.parts()?;
        let Scene { ground: Ground { grid, kernel, .. }, material, .. } = &scene;
        let periodic = kernel.periodic_axes();
        let mut ends = (0..2).filter(|&axis| !periodic[axis]);
        let has_rows = periodic == [true; 2] || ends.any(|axis| kernel.has_rows_along(axis));
        let jumps = jumps(&indenter.gap().above, grid.cells(), periodic);
        let (by_modulus, pair) = (modulus.is_some(), material.poisson_ratios().count() > 1);
        coverage::COEFFICIENTS.refuse_if(|_| !has_rows)?;
        coverage::JUMPING_SHAPE.refuse_if(|_| jumps)?;
        coverage::MODULUS.refuse_if(|_| by_modulus && periodic != [true; 2])?;
        coverage::MODULUS_OF_TWO.refuse_if(|_| by_modulus && pair)?;
        let CreepInMotion { creep, measured, unmeasured_at_rest } = match modulus {
            Some(creep) => CreepInMotion { creep, measured: material.measured(), unmeasured_at_rest: 0.0 },
            None => CreepInMotion::of(material, motion)?,
        };
        let flows = creep.fluidity() > 0.0 && kernel.half_space_below() != Some(HalfSpace::LoadedOnGrid);
        coverage::FLOW.refuse_if(|_| flows)?;
        let relaxed = creep.is_relaxed(measured[1]);
        let (kernel, rows) = (kernel.clone(), Default::default());
        let bodies = Arc::new(Bodies { kernel, creep, rows, measured, relaxed, unmeasured_at_rest });
        let mut held = Held::layout(Arc::new(indenter), Region::whole(grid, [false; 2]));
        let displacement = vec![0.0; grid.len()];
        held.current.solution.pressure.clone_from(&displacement);
        let (scene, view) = (Arc::new(scene), View::default());
        Ok(SteadySliding { scene, held, displacement, view, bodies, cancelled: None })
    }
}
