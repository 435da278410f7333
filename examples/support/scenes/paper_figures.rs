//! The scenes of the source paper's figures and their figures of merit, shared by a test and the example that draws them.
//! Needs `step_loaded_sphere` beside it.
#![allow(dead_code, reason = "the test draws nothing")]

use viscocontact::Result;
use viscocontact::analytic::RigidPunch;
use viscocontact::prelude::*;

use super::step_loaded_sphere::{StepLoadedSphere, errors};

/// Of the flat punch: radius \[m\], force \[N\] and shear modulus of the body \[Pa\].
pub const RADIUS: f64 = 1.0e-3;
pub const FORCE: f64 = 0.05;
pub const MODULUS: f64 = 1.0e6;

/// Eccentricities over the radius: the whole face in contact (Figure 2), and an open contact (Figure 3).
pub const CLOSED: [f64; 4] = [0.0, 0.1, 0.2, 0.3];
pub const OPEN: [f64; 4] = [0.4, 0.5, 0.6, 0.8];

/// Times of the profiles in Figures 4 and 5 over τ.
pub const TIMES: [f64; 4] = [0.0, 0.5, 1.0, 2.0];

/// Numbers of steps in Figure 6, each twice the one before, and those of its reference.
pub const STEP_COUNTS: [usize; 5] = [10, 20, 40, 80, 160];
const REFERENCE_STEPS: usize = 1280;

/// Numbers of steps to 2τ of Figures 4 and 5 with fields asked for, the accuracies asked for, and the steps of the reference.
pub const FEW_STEPS: [usize; 4] = [4, 8, 16, 100];
pub const ASKED: [f64; 2] = [1e-2, 1e-3];
const MANY_STEPS: usize = 400;

/// A figure of merit, and the range in which it must be.
#[derive(Debug, Clone, Copy)]
pub struct Merit {
    pub figure: u32,
    pub quantity: &'static str,
    /// Of which curve.
    pub of: f64,
    pub value: f64,
    pub range: [f64; 2],
}

impl Merit {
    pub fn holds(&self) -> bool {
        (self.range[0]..=self.range[1]).contains(&self.value)
    }
}

/// The rigid flat punch under a force at `eccentricity` radii from its axis, on an elastic body.
pub fn pressed_punch(cells: usize, eccentricity: f64) -> Result<ViscoelasticContact> {
    let mut contact = ViscoelasticContact::builder(Grid::square(cells, 2.1 * RADIUS)?)
        .geometry(&FlatPunch::circular(RADIUS)?)
        .material(Material::incompressible(Elastic::new(MODULUS)?))
        .settings(Settings::default().with_tolerance(1e-7))
        .build()?;
    contact.step(0.0, Load::eccentric_force(FORCE, [eccentricity * RADIUS, 0.0]))?;
    Ok(contact)
}

/// Lur'e's solution for the same punch.
pub fn lure(eccentricity: f64) -> Result<RigidPunch> {
    RigidPunch::new(RADIUS, 4.0 * MODULUS, FORCE, eccentricity * RADIUS)
}

/// Figure 2: the greatest relative error of the pressure within 0.8 R.
pub fn figure_2(contact: &ViscoelasticContact, eccentricity: f64) -> Result<Merit> {
    let (exact, grid, [_, n2]) = (lure(eccentricity)?, contact.grid(), contact.grid().cells());
    let errors = contact.pressure().iter().enumerate().map(|(k, p)| {
        let [x1, x2] = grid.center(k / n2, k % n2);
        if x1.hypot(x2) < 0.8 * RADIUS { (p / exact.pressure(x1, x2) - 1.0).abs() } else { 0.0 }
    });
    let quantity = "pressure against Lur'e, r < 0.8 R";
    Ok(Merit { figure: 2, quantity, of: eccentricity, value: errors.fold(0.0, f64::max), range: [0.0, 6e-3] })
}

/// Figure 3: tilt and contact area beside those on twice the cells.
pub fn figure_3([contact, finer]: [&ViscoelasticContact; 2], eccentricity: f64) -> [Merit; 2] {
    let merit = |quantity, value: f64, finer: f64| {
        let value = (value / finer - 1.0).abs();
        Merit { figure: 3, quantity, of: eccentricity, value, range: [0.0, 1e-2] }
    };
    [
        merit("tilt against twice the cells", contact.tilt()[0], finer.tilt()[0]),
        merit("area against twice the cells", contact.contact_area(), finer.contact_area()),
    ]
}

/// Figures 4 and 5: the step-loaded sphere in 100 steps to 2 τ, given to `show` at each time shown, with its figure of merit.
pub fn figures_4_and_5(
    figure: u32,
    cells: usize,
    mut show: impl FnMut(&ViscoelasticContact, Merit),
) -> Result<StepLoadedSphere> {
    let scene = if figure == 4 { StepLoadedSphere::maxwell() } else { StepLoadedSphere::zener() };
    let (exact, mut contact) = (scene.reference()?, scene.contact(cells, Settings::default())?);
    for step in 0..=100 {
        contact.step(if step > 0 { 0.02 * scene.tau } else { 0.0 }, Load::force(scene.force))?;
        let time = f64::from(step) / 50.0;
        if TIMES.contains(&time) {
            let value = errors(&contact, &exact).l1;
            show(&contact, Merit { figure, quantity: "L1 of p against Table 1", of: time, value, range: [0.0, 7e-4] });
        }
    }
    Ok(scene)
}

/// Figure 6 by one rule: the pressures at 2τ for each number of steps, and their errors in time relative to the pressure p′ on
/// the same cells in many steps by the default rule.
pub struct TimeStudy {
    /// Whether by the paper's own algorithm.
    pub literally: bool,
    pub cells: usize,
    pub pressures: Vec<Vec<f64>>,
    /// Σ |p − p′| / Σ p′, and |p / p′ − 1| in the middle.
    pub errors: Vec<[f64; 2]>,
}

/// Figure 6: the paper's algorithm, on half the cells a side and in fewer steps, since it takes long; and the default.
pub fn figure_6(cells: usize) -> Result<[TimeStudy; 2]> {
    let scene = StepLoadedSphere::maxwell();
    let settings = Settings::default().with_tolerance(1e-9);
    let by_default = |cells: usize, steps: usize| -> Result<Vec<f64>> {
        Ok(scene.run(cells, steps, settings)?.0.pressure().to_vec())
    };
    let study = |literally: bool, cells: usize, counts: &[usize]| -> Result<TimeStudy> {
        let run = |&steps: &usize| {
            if literally { Ok(scene.literally(cells, steps)?.0.pressure) } else { by_default(cells, steps) }
        };
        let (pressures, reference) =
            (counts.iter().map(run).collect::<Result<Vec<_>>>()?, by_default(cells, REFERENCE_STEPS)?);
        let middle = cells / 2 * (cells + 1);
        let error = |pressure: &Vec<f64>| {
            let differences = pressure.iter().zip(&reference).map(|(p, exact)| (p - exact).abs());
            let l1 = differences.sum::<f64>() / reference.iter().sum::<f64>();
            [l1, (pressure[middle] / reference[middle] - 1.0).abs()]
        };
        Ok(TimeStudy { literally, cells, errors: pressures.iter().map(error).collect(), pressures })
    };
    Ok([study(true, cells / 2, &STEP_COUNTS[..4])?, study(false, cells, &STEP_COUNTS)?])
}

impl TimeStudy {
    /// The orders of the errors, from their fall over all numbers of steps. Where cells come into contact the displacement has a
    /// kink, which the default rule meets with second order: the whole pressure converges with that order, its middle faster.
    pub fn orders(&self) -> [Merit; 2] {
        let doublings = self.errors.len() - 1;
        let order = |which: usize| (self.errors[0][which] / self.errors[doublings][which]).log2() / doublings as f64;
        let merits = if self.literally {
            [("order of the paper's rule, L1 of p", [0.9, 1.1]), ("order of the paper's rule, p(0)", [0.9, 1.1])]
        } else {
            [("order of the default rule, L1 of p", [2.0, 4.0]), ("order of the default rule, p(0)", [2.5, 4.0])]
        };
        [0, 1].map(|which| {
            let (quantity, range) = merits[which];
            Merit { figure: 6, quantity, of: 2.0, value: order(which), range }
        })
    }
}

/// Figure 4 or 5 in few steps.
pub struct FewSteps {
    pub figure: u32,
    pub steps: usize,
    /// The pressure at 2τ of the steps alone, and with fields to each accuracy asked for.
    pub pressures: Vec<Vec<f64>>,
    /// Greatest error in time of the profiles, Σ |p − p′| / Σ p′, with p′ on the same cells in many steps by the default rule.
    pub errors: Vec<f64>,
    /// Convolutions of the run and its fields.
    pub convolutions: Vec<usize>,
}

/// The pressures at some times of the step-loaded sphere, in so many steps, with fields to an accuracy; and the convolutions.
fn profiles(
    scene: &StepLoadedSphere,
    (cells, steps): (usize, usize),
    times: &[f64],
    accuracy: Option<f64>,
) -> Result<(Vec<Vec<f64>>, usize)> {
    let settings = Settings::default().with_tolerance(1e-8);
    let (mut contact, until) = (scene.contact(cells, settings)?, 2.0 * scene.tau);
    let load = StepLoad::new(Load::force(scene.force))?;
    let run = contact.follow(&load, Stepping::fixed(until / steps as f64), until);
    let mut run = run.sample_at(times.iter().map(|time| time * scene.tau).collect::<Vec<_>>())?;
    run = if let Some(accuracy) = accuracy { run.fields_to(accuracy)? } else { run };
    let (mut pressures, mut convolutions) = (Vec::new(), 0);
    while let Some(report) = run.next_step()? {
        convolutions += report.convolutions;
        for sample in run.samples() {
            let sample = sample?;
            if sample.is_asked_for() {
                pressures.push(sample.fields().pressure().to_vec());
                convolutions += sample.field().map_or(0, |field| field.convolutions);
            }
        }
    }
    Ok((pressures, convolutions))
}

/// Figures 4 and 5 in few steps, alone and with fields asked for.
pub fn figures_in_few_steps(cells: usize) -> Result<Vec<FewSteps>> {
    let mut all = Vec::new();
    for figure in [4, 5] {
        let scene = if figure == 5 { StepLoadedSphere::zener() } else { StepLoadedSphere::maxwell() };
        let times = &TIMES[1..];
        let exact = profiles(&scene, (cells, MANY_STEPS), times, None)?.0;
        for steps in FEW_STEPS {
            let mut few =
                FewSteps { figure, steps, pressures: Vec::new(), errors: Vec::new(), convolutions: Vec::new() };
            for accuracy in [None].into_iter().chain(ASKED.map(Some)) {
                let (mut found, convolutions) = profiles(&scene, (cells, steps), times, accuracy)?;
                let error = |(found, exact): (&Vec<f64>, &Vec<f64>)| {
                    let off = found.iter().zip(exact).map(|(found, exact)| (found - exact).abs());
                    off.sum::<f64>() / exact.iter().sum::<f64>()
                };
                few.errors.push(found.iter().zip(&exact).map(error).fold(0.0, f64::max));
                few.pressures.extend(found.pop());
                few.convolutions.push(convolutions);
            }
            all.push(few);
        }
    }
    Ok(all)
}
