//! What an accuracy promises, a planned run delivers.

use std::ops::ControlFlow;

use crate::common::histories::four_terms;
use crate::common::refused::refused;
use crate::common::{Draws, RADIUS, contact_of, elastic, figures, from_environment, maxwell, zener};
use approx::assert_abs_diff_eq;
use viscocontact::analytic::GrowingSphere;
use viscocontact::contact::Builder;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
use viscocontact::states::{Reach, StatesError, Sweep};
use viscocontact::{Axis, Error};

/// Greatest errors of approach and central pressure over a planned run, relative to the greatest values, and
/// Σ cells × convolutions.
struct Outcome {
    approach: f64,
    pressure: f64,
    work: f64,
    plan: Plan,
}

/// Runs a plan; `exact` gives the approach and, if it is wanted, the pressure at a distance from the axis, by the time of the
/// bodies.
fn deliver(
    geometry: &dyn Geometry,
    material: &Material,
    history: &dyn LoadHistory,
    until: f64,
    accuracy: Accuracy,
    exact: impl FnMut(f64, f64) -> (f64, Option<f64>),
) -> Outcome {
    run(Plan::builder(geometry, material, history, until).accuracy(accuracy).build().unwrap(), history, until, exact)
}

fn run(
    plan: Plan,
    history: &dyn LoadHistory,
    until: f64,
    mut exact: impl FnMut(f64, f64) -> (f64, Option<f64>),
) -> Outcome {
    let mut contact = plan.builder.clone().build().unwrap();
    let mut run = contact.follow(history, plan.stepping, until).stop_at(&plan.stops[..]).unwrap();
    let (mut errors, mut greatest, mut work, mut steps) = ([0.0_f64; 2], [0.0_f64; 2], 0.0, 0);
    while let Some(report) = run.next_step().unwrap() {
        let grid = run.contact().grid();
        let [n1, n2] = grid.cells();
        let [x1, x2] = grid.center(n1 / 2, n2 / 2);
        let (approach, pressure) = exact(run.contact().reduced_time(), x1.hypot(x2));
        greatest[0] = greatest[0].max(approach);
        errors[0] = errors[0].max((report.approach - approach).abs());
        if let Some(pressure) = pressure {
            greatest[1] = greatest[1].max(pressure);
            errors[1] = errors[1].max((run.contact().pressure()[n1 / 2 * n2 + n2 / 2] - pressure).abs());
        }
        work += report.convolution_equivalents() * grid.len() as f64;
        steps += 1;
    }
    assert!(steps <= 2 * plan.steps && plan.steps <= 2 * steps, "{steps} steps, {} planned", plan.steps);
    let relative = |which: usize| if greatest[which] > 0.0 { errors[which] / greatest[which] } else { 0.0 };
    Outcome { approach: relative(0), pressure: relative(1), work, plan }
}

fn check(name: &str, accuracy: Accuracy, outcome: &Outcome) {
    let Outcome { approach, pressure, work, plan } = outcome;
    println!(
        "{name}, {plan}: approach {approach:.1e}, central pressure {pressure:.1e}; cells × convolutions {work:.1e}"
    );
    if name != "planned" {
        let [cells, _] = plan.grid.cells();
        let pressure = if *pressure > 0.0 { format!("{pressure:.1e}") } else { "–".to_owned() };
        let rest = format!("{cells}² | {} | {approach:.1e} | {pressure} |", plan.steps);
        figures::row("presets", &format!("| {name} | {:e} |", accuracy.target()), &rest).unwrap();
    }
    assert!(*approach <= accuracy.target(), "{name} {accuracy:?}: approach {approach:e}");
    assert!(*pressure <= accuracy.target(), "{name} {accuracy:?}: pressure {pressure:e}");
}

/// A body that warms by 30 K under a held force, which its creep follows through four decades of reduced time.
#[test]
fn warming_spheres_are_as_accurate_as_planned() {
    let sphere = Sphere::new(RADIUS).unwrap();
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let body = Material::incompressible(four_terms());
    let law = TimeTemperature::wlf(17.44, 51.6, 263.15).unwrap();
    let warming = TemperatureHistory::table(law.clone(), &[(1.0, 263.15), (5.0, 293.15)]).unwrap();
    let exact = GrowingSphere::step(RADIUS, &body, 1.0).unwrap();
    for accuracy in PRESETS {
        let plan = Plan::builder(&sphere, &body, &load, 6.0).accuracy(accuracy).temperature(&warming).build().unwrap();
        let mut last = 0.0;
        let outcome = run(plan, &load, 6.0, |reduced, r| {
            last = reduced;
            (exact.approach(reduced), Some(exact.pressure(r, reduced)))
        });
        assert!(last > 1e3, "{last}");
        check("warming", accuracy, &outcome);
    }
    // below the end of the law
    let cold = TemperatureHistory::function(law, |t| 263.15 - 20.0 * t, &[]).unwrap();
    let refused =
        Plan::builder(&sphere, &body, &load, 6.0).accuracy(Accuracy::COARSE).temperature(&cold).build().unwrap_err();
    assert!(matches!(refused, Error::OutOfRange { field: "temperature", .. }), "{refused}");
}

const PRESETS: [Accuracy; 3] = [Accuracy::COARSE, Accuracy::STANDARD, Accuracy::FINE];

#[test]
fn held_spheres_are_as_accurate_as_planned() {
    let sphere = Sphere::new(RADIUS).unwrap();
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let maxwell = maxwell();
    let zener = Material::constant_poisson(Zener::with_time(1.0e9, 1.0e8, 1.0).unwrap(), 0.3).unwrap();
    let four = Material::incompressible(four_terms());
    for (name, material, until) in [("Maxwell", maxwell, 2.0), ("Zener", zener, 5.0), ("four times", four, 20.0)] {
        let exact = GrowingSphere::step(RADIUS, &material, 1.0).unwrap();
        let mut plans = Vec::new();
        for accuracy in PRESETS {
            let outcome = deliver(&sphere, &material, &load, until, accuracy, |t, r| {
                (exact.approach(t), Some(exact.pressure(r, t)))
            });
            check(name, accuracy, &outcome);
            plans.push((outcome.plan.grid.cells()[0], outcome.plan.steps));
        }
        if name == "Maxwell" {
            let [coarse, standard, fine] = [0, 1, 2].map(|k| format!("{}² cells and {} steps", plans[k].0, plans[k].1));
            figures::figure("plan of the README", &standard).unwrap();
            figures::figure("plans of a sphere", &format!("{coarse}, {standard}, {fine}")).unwrap();
        }
    }
}

/// The paper's own setting against a planned run to 1e-3.
#[test]
fn a_planned_run_is_a_thousand_times_less_work_than_the_papers() {
    let material = maxwell();
    let exact = GrowingSphere::step(RADIUS, &material, 1.0).unwrap();
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let outcome = deliver(&sphere, &material, &load, 2.0, Accuracy::STANDARD, |t, r| {
        (exact.approach(t), Some(exact.pressure(r, t)))
    });
    check("planned", Accuracy::STANDARD, &outcome);
    // 256² cells, 100 steps; fifteen times the mean work of the first ones stands for all, which take a little more
    let cells = 256;
    let grid = Grid::square(cells, 2.25 * exact.contact_radius(2.0)).unwrap();
    let mut contact = contact_of(&sphere, grid, material, Settings::paper());
    contact.step(0.0, Load::force(1.0)).unwrap();
    let work: f64 = (0..15).map(|_| contact.step(0.02, Load::force(1.0)).unwrap().convolution_equivalents()).sum();
    let ratio = work / 15.0 * 100.0 * (cells * cells) as f64 / outcome.work;
    println!("paper / planned: {ratio:.0}");
    figures::figure("paper over plan", &format!("{:.0}00", ratio / 100.0)).unwrap();
    assert!(ratio >= 1000.0, "{ratio}");
    // the paper's rule errs by 7.7e-3 at 100 steps (step_loaded_sphere)
    assert!(outcome.pressure < 7.7e-3);
}

#[test]
fn punches_need_fine_meshes_and_say_so() {
    let radius = 1.0e-3;
    let punch = FlatPunch::circular(radius).unwrap();
    let material = maxwell();
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let exact = |t: f64| material.contact_compliance(t) / (2.0 * radius);
    let outcome = deliver(&punch, &material, &load, 2.0, Accuracy::COARSE, |t, _| (exact(t), None));
    check("punch", Accuracy::COARSE, &outcome);
    // first order: a hundred times the cells a side for a hundredth of the error
    let plan = Plan::builder(&punch, &material, &load, 2.0).accuracy(Accuracy::new(1e-5).unwrap()).build();
    refused([(plan.err(), "cells along a side for this accuracy")]);
}

#[test]
fn plans_find_the_domain_whatever_its_size() {
    let load = |force: f64| StepLoad::new(Load::force(force)).unwrap();
    for (scale, modulus, force) in [(1e-9, 1e9, 1e-9_f64), (1e-3, 1e6, 1.0), (1e3, 1e10, 1e12), (1.0, 1e-3, 1e-6)] {
        let sphere = Sphere::new(scale).unwrap();
        let material = Material::incompressible(Elastic::new(modulus).unwrap());
        let force = force.min(modulus * scale * scale * 1e-2);
        let radius = (0.75 * scale * force * material.contact_compliance(0.0)).cbrt();
        let plan = Plan::builder(&sphere, &material, &load(force), 1.0).accuracy(Accuracy::COARSE).build().unwrap();
        let [half, _] = plan.reach;
        assert!((half / radius - 1.0).abs() < 0.12, "{scale:e}: {half:e} {radius:e}");
    }
    // an ellipse gets a domain of its own shape
    let ellipsoid = Ellipsoid::new(10.0e-3, 160.0e-3).unwrap();
    let material = elastic();
    let plan = Plan::builder(&ellipsoid, &material, &load(1.0), 1.0).accuracy(Accuracy::COARSE).build().unwrap();
    let [l1, l2] = plan.grid.lengths();
    assert!(l2 > 3.0 * l1, "{l1} {l2}");
    // a driven approach, and one that never touches
    let sphere = Sphere::new(RADIUS).unwrap();
    let driven = StepLoad::new(Load::approach(1.0e-4)).unwrap();
    let plan = Plan::builder(&sphere, &material, &driven, 1.0).accuracy(Accuracy::COARSE).build().unwrap();
    assert_abs_diff_eq!(plan.reach[0] / (RADIUS * 1.0e-4).sqrt(), 1.0, epsilon = 0.12);
    let apart = StepLoad::new(Load::approach(-1.0e-4)).unwrap();
    let apart = Plan::builder(&sphere, &material, &apart, 1.0).accuracy(Accuracy::COARSE).build();
    refused([(apart.err(), "no domain was found that holds the contact")]);
    for until in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let plan = Plan::builder(&sphere, &material, &driven, until).accuracy(Accuracy::COARSE).build();
        refused([(plan.err(), "end of the run")]);
    }
    // a body that has no such period
    let plan = || Plan::builder(&sphere, &material, &driven, 1.0);
    refused([
        (plan().period(Axis::X1, 4.0e-3).build().err(), "period along x1"),
        (plan().line(1.0).build().err(), "period or line along x2"),
    ]);
    refused([0.0, -1.0, 1e-7, 0.2, 5.0, f64::NAN].map(|target| (Accuracy::new(target).err(), "accuracy")));
}

/// A plan fits a body without an exact series over the times of its run.
#[test]
fn plans_give_the_times_over_which_a_body_is_wanted() {
    let material = Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())));
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let plan = Plan::builder(&sphere, &material, &load, 10.0).accuracy(Accuracy::COARSE).build().unwrap();
    let contact = plan.builder.clone().build().unwrap();
    let [first, last] = contact.material().fit_reports().next().unwrap().range().unwrap();
    assert!(first < 0.1, "{first:e}");
    assert_abs_diff_eq!(last / 10.0, 1.0, epsilon = 1e-12);
    let held = |t: f64| (0.75 * RADIUS * material.contact_compliance(t)).powf(2.0 / 3.0) / RADIUS;
    let outcome = deliver(&sphere, &material, &load, 10.0, Accuracy::COARSE, |t, _| (held(t), None));
    check("held on a closure", Accuracy::COARSE, &outcome);
}

/// Planning reports every step of its coarse runs, and ends where its caller wants.
#[test]
fn planning_reports_its_progress_and_can_be_cancelled() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let material = maxwell();
    let builder = Plan::builder(&sphere, &material, &load, 2.0).accuracy(Accuracy::COARSE);
    let mut steps = 0;
    let plan = builder.build_with(|progress| {
        steps += 1;
        assert_eq!(progress.steps, steps);
        assert!(progress.time <= 2.0 && progress.cells[0] >= 14);
        ControlFlow::Continue(())
    });
    assert_eq!(plan.unwrap().grid, builder.build().unwrap().grid);
    for last in (1..=steps).step_by(1 + steps / 9) {
        let cancelled =
            builder.build_with(
                |progress| {
                    if progress.steps < last { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
                },
            );
        assert!(matches!(cancelled, Err(Error::Cancelled { what: "a plan" })));
    }
}

/// Under a ball a plate on an elastic foundation bends away from the middle of the contact, which shrinks there while the load grows: its
/// runs are no superpositions of its elastic states. A sweep refuses them, and a plan takes trial runs, on several meshes.
#[test]
fn plans_of_contacts_that_shrink_take_trial_runs() {
    let ball = Sphere::new(1.5).unwrap();
    let material = Material::incompressible(Zener::new(4.0, 12.0, 6.0).unwrap());
    let history = Ramp::new(Load::force(0.0), Load::force(0.01), 1.0).unwrap();
    for (length, shrinks) in [(0.05, true), (0.002, false)] {
        let spectrum = move |q1: f64, q2: f64| {
            let q = q1.hypot(q2);
            if shrinks { 1.0 / (1.0 + (length * q).powi(4)) + 1e-4 } else { 1.0 / (q + length) }
        };
        let kernel = move |grid: &Grid| InfluenceKernel::from_spectrum(grid, spectrum);
        let grid = Grid::square(48, 1.0).unwrap();
        let sweep = Sweep::new(grid.clone(), &ball).kernel(kernel(&grid).unwrap()).accuracy(1e-2);
        let sweep = sweep.run(Reach::Level(0.01 * material.contact_compliance(2.0)));
        assert_eq!(matches!(sweep, Err(Error::States(StatesError::Shrinks { .. }))), shrinks, "{sweep:?}");
        let builder = Plan::builder(&ball, &material, &history, 2.0).accuracy(Accuracy::COARSE).kernel(&kernel);
        let (mut meshes_of_runs, builder) = (Vec::new(), builder.period(Axis::X1, 1.0).period(Axis::X2, 1.0));
        let plan = builder.build_with(|progress| {
            meshes_of_runs.extend((progress.time > 0.0).then_some(progress.cells));
            ControlFlow::Continue(())
        });
        let plan = plan.unwrap();
        meshes_of_runs.dedup();
        assert_eq!(meshes_of_runs.len() > 1, shrinks, "{meshes_of_runs:?}");

        let approaches = |builder: &Builder, stepping: Stepping| {
            let times = [0.1, 0.3, 0.6, 1.0, 1.3, 2.0];
            let mut contact = builder.clone().build().unwrap();
            let mut run = contact.follow(&history, stepping, 2.0).stop_at(&times[..]).unwrap();
            let mut found = Vec::new();
            while let Some(report) = run.next_step().unwrap() {
                found.extend(times.contains(&report.time).then_some(report.approach));
            }
            found
        };
        let finer = Grid::new(plan.grid.cells().map(|cells| 2 * cells), plan.grid.lengths()).unwrap();
        let reference = ViscoelasticContact::builder(finer.clone()).geometry(&ball).material(material.clone());
        let reference = reference.kernel(kernel(&finer).unwrap()).settings(Settings::default().with_tolerance(1e-7));
        let exact = approaches(&reference, Stepping::adaptive(1e-4));
        let found = approaches(&plan.builder, plan.stepping);
        let scale = exact.iter().fold(0.0f64, |most, approach| most.max(approach.abs()));
        let error = found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max) / scale;
        println!("{plan}: {error:.1e}");
        assert!(exact.len() == 6 && error < 2e-2, "{error}");
    }
}

/// An error of the history is an error of the plan, whatever part of the planning needed the load.
#[test]
fn errors_of_histories_come_out_of_plans() {
    let (sphere, body, until) = (Sphere::new(RADIUS).unwrap(), zener(), 2.0);
    let mut seen = 0;
    for number in 0..from_environment("PLAN_ERRORS", 60) {
        let draws = &mut Draws::new(number);
        // between the 4097 times at which runs look at the load without a step
        let from = until * (draws.below(4096) as f64 + 0.3) / 4096.0;
        let is_met = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
        let met = std::sync::Arc::clone(&is_met);
        let history = FnHistory::fallible(move |t: f64| {
            if t > from && t < from + 0.4 * until / 4096.0 {
                met.store(true, std::sync::atomic::Ordering::Relaxed);
                return Err(format!("no load at {t}"));
            }
            Ok(Load::force(0.5 * (0.2 + (2.0 * t).sin().abs())))
        });
        let plan = Plan::builder(&sphere, &body, &history, until).accuracy(Accuracy::COARSE);
        let plan = plan.fields_at(&[1.0, 2.0]).build();
        if is_met.load(std::sync::atomic::Ordering::Relaxed) {
            seen += 1;
            assert!(matches!(plan, Err(Error::User(_))), "{from}: {plan:?}");
        }
    }
    println!("{seen} errors were met");
    assert!(seen > 5);
}
