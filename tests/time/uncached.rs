//! The cost that the source paper states: its history of pressures, with one convolution for each past step in every step.

use crate::common::{StepLoadedSphere, builder_on, maxwell, three_times};
use std::sync::Arc;

use viscocontact::contact::Builder;
use viscocontact::prelude::*;

/// Differences by rounding in the iterations are then below the bounds of these tests.
const TIGHT: f64 = 1e-12;

fn sphere(material: Material, settings: Settings) -> Builder {
    builder_on(Grid::new([24, 20], [5.0e-3, 4.0e-3]).unwrap(), material).settings(settings)
}

fn difference(one: &[f64], other: &[f64]) -> f64 {
    let greatest = one.iter().fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest
}

/// Loaded, unloaded, apart for two steps, loaded again; from the fourth step on at a distance from the axis.
fn loads(distance: f64) -> impl Iterator<Item = (f64, Load)> {
    let forces = [0.0, 0.3, 0.6, 0.8, 0.5, 0.2, 0.0, 0.0, 0.4, 0.7, 0.7, 0.7];
    forces.into_iter().enumerate().map(move |(k, force)| {
        let load =
            if k < 3 || distance == 0.0 { Load::force(force) } else { Load::eccentric_force(force, [distance, 0.0]) };
        (if k == 2 { 0.0 } else { 0.1 + 0.02 * k as f64 }, load)
    })
}

/// The same pressures and displacements as of sums whose convolutions are kept; two convolutions per iteration and one more,
/// and one for each step since the first contact.
#[test]
fn uncached_sums_differ_in_cost_only() {
    let closure = Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.powf(0.3))));
    // an eccentric load ends the symmetry; periodic bodies do not tilt
    let scenes = [(maxwell(), false, 1.0e-5), (closure, true, 1.0e-5), (three_times(), false, 0.0)];
    for (material, symmetry, distance) in scenes {
        let with = |settings: Settings| {
            let builder = sphere(material.clone(), settings.with_tolerance(TIGHT).with_symmetry(symmetry));
            let grid = Grid::new([24, 20], [5.0e-3, 4.0e-3]).unwrap();
            let kernel = || Arc::new(InfluenceKernel::periodic_along(&grid, Axis::X2, 1.0).unwrap());
            if distance == 0.0 { builder.kernel(kernel()).build().unwrap() } else { builder.build().unwrap() }
        };
        let (mut cached, mut uncached) = (with(Settings::paper()), with(Settings::paper_literal()));
        for (step, (dt, load)) in loads(distance).enumerate() {
            let [kept, repeated] = [&mut cached, &mut uncached].map(|contact| contact.step(dt, load).unwrap());
            let apart = difference(cached.displacement(), uncached.displacement());
            println!("{step}: {} and {} iterations, {apart:.1e}", kept.iterations, repeated.iterations);
            // the first step does not touch, and apart there is nothing to solve
            let past = step.saturating_sub(1);
            if kept.force > 0.0 {
                assert!(apart < 1e-10 && difference(cached.pressure(), uncached.pressure()) < 1e-9);
                assert_eq!(kept.convolutions, 2 * kept.iterations + 1);
                assert_eq!(repeated.convolutions, 2 * repeated.iterations + 1 + past);
            } else {
                assert_eq!(repeated.convolutions, kept.convolutions + past);
            }
        }
    }
}

/// N(N + 1)/2 convolutions of the past after a jump and N steps: the formula of the paper's section 4.
#[test]
fn uncached_sums_cost_as_many_convolutions_as_the_paper_says() {
    let run = |steps: usize, settings| {
        let mut contact = sphere(maxwell(), settings).build().unwrap();
        contact.step(0.0, Load::force(0.5)).unwrap();
        let reports = (0..steps).map(|_| contact.step(1.0 / steps as f64, Load::force(0.5)).unwrap());
        let counts = reports.map(|report| [report.convolutions, report.iterations]);
        counts.fold([0; 2], |sum, count| [sum[0] + count[0], sum[1] + count[1]])
    };
    for steps in [1, 10, 40] {
        let [cached, iterations] = run(steps, Settings::paper());
        assert_eq!(cached, 2 * iterations + steps);
        let [uncached, iterations] = run(steps, Settings::paper_literal());
        assert_eq!(uncached, 2 * iterations + steps + steps * (steps + 1) / 2);
    }
}

/// Twice the steps take four times the convolutions by the paper's algorithm, once the superposition prevails, and twice by the
/// default one, once the steps are so short that shorter ones take no less work.
#[test]
fn convolutions_grow_with_the_square_of_the_steps_in_the_paper_only() {
    let scene = StepLoadedSphere::maxwell();
    let exponent = |cells: usize, steps: [usize; 2], settings: Settings| {
        let [few, many] = steps.map(|steps| scene.run(cells, steps, settings).unwrap().1 * steps as f64);
        (many / few).log2() / (steps[1] as f64 / steps[0] as f64).log2()
    };
    let literal = Settings::paper_literal();
    let [paper, default] = [exponent(16, [400, 800], literal), exponent(32, [800, 3200], Settings::default())];
    println!("exponents {paper} and {default}");
    assert!((paper - 2.0).abs() < 0.1 && (default - 1.0).abs() < 0.05, "{paper} {default}");
}

#[test]
fn uncached_sums_are_refused_where_cached_ones_are() {
    let build = |material, settings: Settings| sphere(material, settings).build();
    let uncached = Settings::paper_literal().with_tolerance(TIGHT);
    let voigt = Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0).unwrap());
    assert!(matches!(build(voigt, uncached), Err(Error::Step(StepError::NoElasticResponse { .. }))));
    let moving = uncached.with_frame(Frame::Indenter);
    assert!(matches!(build(maxwell(), moving), Err(Error::WrongFrame { .. })));
    // a step longer than the relaxation time is warned of, and the third increment does not fit
    let mut contact = build(maxwell(), uncached.with_history_limit(2 * 24 * 20 * 8)).unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    assert!(contact.step(1.5, Load::force(0.1)).unwrap().warnings.contains(Warnings::RINGS));
    assert!(matches!(contact.step(0.1, Load::force(0.1)), Err(Error::Step(StepError::HistoryFull { steps: 2, .. }))));
    // a field more than the cached sum
    let memory = |settings: Settings| sphere(maxwell(), settings.with_tolerance(TIGHT)).memory().unwrap();
    let [cached, uncached] = [Settings::paper(), Settings::paper_literal()].map(memory);
    assert_eq!((uncached.total(), uncached.each_step), (cached.total() + 8 * 480, cached.each_step));
}
