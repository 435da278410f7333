//! Random small contacts.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::strategy::Union;

use super::{around, built, shape, spectra};
use crate::contact::{Builder, Settings};
use crate::error::Result;
use crate::geometry::{Cone, Ellipsoid, FlatPunch, Geometry, Shifted, Sphere, Sum, Wavy};
use crate::load::Load;
use crate::rheology::{CreepSpectrum, Material};
use crate::{Grid, ViscoelasticContact};

/// A small contact and its steps, in parts that a test may change: scale, mirror, move, split.
///
/// ```
/// use proptest::prelude::*;
/// use viscocontact::laws::strategies::scenarios;
/// use viscocontact::prelude::*;
///
/// proptest!(ProptestConfig::with_cases(8), |(scenario in scenarios())| {
///     let contact = scenario.run(Settings::default())?;
///     let Load::Force { normal, .. } = contact.fields().load() else { unreachable!() };
///     prop_assert!((contact.force() - normal).abs() <= 1e-12 * normal);
/// });
/// ```
#[derive(Debug, Clone)]
#[expect(clippy::exhaustive_structs, reason = "tests construct variants from parts of others")]
pub struct Scenario {
    /// The grid.
    pub grid: Grid,
    /// The indenter.
    pub shape: Arc<dyn Geometry>,
    /// Creep compliance J(t) of an incompressible body.
    pub creep: CreepSpectrum,
    /// The length of each step \[s\], and the load at its end.
    pub steps: Vec<(f64, Load)>,
}

impl Scenario {
    /// A builder of the contact, to which a test may add.
    pub fn builder(&self) -> Builder {
        ViscoelasticContact::builder(self.grid.clone())
            .geometry(&self.shape)
            .material(Material::incompressible(self.creep.clone()))
    }

    /// Builds the contact and takes all steps.
    ///
    /// # Errors
    /// If the contact cannot be built or a step fails.
    pub fn run(&self, settings: Settings) -> Result<ViscoelasticContact> {
        let mut contact = self.builder().settings(settings).build()?;
        for &(dt, load) in &self.steps {
            contact.step(dt, load)?;
        }
        Ok(contact)
    }

    /// Total time of the steps \[s\].
    pub fn duration(&self) -> f64 {
        self.steps.iter().map(|step| step.0).sum()
    }
}

/// Maximum contact radius relative to half the shorter side of the grid.
const MAX_RADIUS: f64 = 0.35;

/// Indenters with a contact radius of at most about `reach` \[m\]. The force is the one under which a sphere of radius
/// `radius` \[m\] has the contact radius `reach`.
fn indenters(radius: f64, reach: f64) -> BoxedStrategy<Arc<dyn Geometry>> {
    let share = 0.4..1.0_f64;
    Union::new([
        shape(share.clone(), move |part| Sphere::new(part * radius)),
        shape([share.clone(), share.clone()], move |[a, b]| Ellipsoid::new(a * radius, b * radius)),
        shape(1.0..2.5_f64, move |part| Cone::new(part * reach / radius)),
        // large enough to contain the centre of a cell
        shape(0.8..1.0_f64, move |part| FlatPunch::circular(part * reach)),
        shape((share, 0.02..0.3_f64, 0.5..2.0_f64), move |(part, height, wave)| {
            // waves low enough that their crests do not extend the contact
            let wavy = Wavy::new(0.1 * height * reach * reach / radius, wave * reach)?;
            Ok(Sum::new(Sphere::new(part * radius)?, wavy))
        }),
    ])
    .boxed()
}

/// Scenarios with 10 to 24 cells per side, not square in general, 1 mm to 10 cm long; single indenters up to two cells
/// off centre, or centred; creep spectra with an elastic response, of 10 kPa to 10 GPa and 1 ms to 1000 s; a jump, then
/// 2 to 7 time steps or jumps, under forces that may vanish. The contact does not reach the edge of the grid.
pub fn scenarios() -> impl Strategy<Value = Scenario> {
    let scales = (around(1e-2), -2.0..2.0_f64, -2.0..2.0_f64);
    let cells = [10_usize..=24, 10_usize..=24];
    (scales, cells, 0.8..1.25_f64).prop_flat_map(|((length, modulus, time), cells, aspect)| {
        let (modulus, time) = (1e7 * 10f64.powf(modulus), 10f64.powf(time));
        let reach = 0.5 * MAX_RADIUS * length * aspect.min(1.0);
        let radius = around(10.0 * length)
            .prop_flat_map(move |radius| indenters(radius, reach).prop_map(move |shape| (radius, shape)));
        let off = prop_oneof![Just([0.0; 2]), [-1.0..1.0_f64, -1.0..1.0_f64]];
        let step = (prop_oneof![1 => Just(0.0), 4 => 0.02..1.0_f64], prop_oneof![1 => Just(0.0), 5 => 0.05..1.0_f64]);
        let steps = prop::collection::vec(step, 2..=7);
        built((radius, off, spectra(modulus, time), 0.1..1.0_f64, steps), move |parts| {
            let ((radius, shape), off, creep, first, steps) = parts;
            let grid = Grid::new(cells, [length, aspect * length])?;
            let by = [0, 1].map(|axis| off[axis] * grid.spacing()[axis].min(0.1 * length));
            let until = time * steps.iter().map(|step| step.0).sum::<f64>();
            // force at which a sphere of this radius has this contact radius: F = 4 a³ E*/3 R
            let most = 4.0 * reach.powi(3) / (3.0 * radius * 0.25 * creep.compliance(until));
            let load = |part: f64| Load::force(part * most);
            let rest = steps.into_iter().map(|(dt, part)| (dt * time, load(part)));
            let steps = std::iter::once((0.0, load(first))).chain(rest).collect();
            Ok(Scenario { grid, shape: Arc::new(Shifted::new(shape, by)?), creep, steps })
        })
    })
}
