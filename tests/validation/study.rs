//! What a study tells of its errors, against closed forms; domains, budgets, refusals and files.

use std::ops::ControlFlow;

use crate::common::histories::four_terms;
use crate::common::refused::{not_covered, refused};
use crate::common::{Draws, RADIUS, StepLoadedSphere, builder_of, elastic, figures, from_environment, maxwell, zener};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::analytic::GrowingSphere;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
use viscocontact::study::{Ending, StudyResult};
use viscocontact::{Axis, Error};

const PRESETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

fn study<'a>(shape: &'a dyn Geometry, material: &'a Material, history: &'a dyn LoadHistory, until: f64) -> Study<'a> {
    let scene = |grid, settings| Ok(builder_of(shape, grid, material.clone()).settings(settings));
    Study::new(scene, history, until).accuracy(1e-2)
}

/// Compares approach and greatest pressure at the ends of steps with exact ones; the greatest pressure is that of the run.
fn check(name: &str, study: &StudyResult, exact: impl Fn(f64) -> [f64; 2]) {
    let [mut off, mut most, mut peak] = [0.0_f64; 3];
    for (time, approach) in study.times().iter().zip(study.values("approach").unwrap()) {
        let [depth, pressure] = exact(*time);
        (off, most, peak) = (off.max((approach - depth).abs()), most.max(depth), peak.max(pressure));
    }
    let approach = off / most;
    let pressure = (study.values("maximum pressure").unwrap()[0] / peak - 1.0).abs();
    let told = ["approach", "maximum pressure"].map(|name| study.measured(name).unwrap().error());
    println!("{name}: approach {approach:.1e}, pressure {pressure:.1e}\n{study}");
    let ([n1, _], target) = (study.contact().grid().cells(), study.accuracy);
    let show = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.1e}"));
    let of_pressure = if peak > 0.0 { show(Some(pressure)) } else { "–".to_owned() };
    let [of_approach, told_pressure] = told.map(show);
    let told_pressure = if peak > 0.0 { told_pressure } else { "–".to_owned() };
    let steps = study.times().len();
    let rest = format!("{n1}² | {steps} | {approach:.1e} | {of_approach} | {of_pressure} | {told_pressure} |");
    figures::row("studies", &format!("| {name} | {target:e} |"), &rest).unwrap();
    assert!(study.is_converged() && approach <= target, "{name}: {approach:e}");
    // an error that is told is that of the run, to a factor
    let ratio = told[0].unwrap() / approach;
    assert!((0.3..30.0).contains(&ratio), "{name}: told over true {ratio}");
}

#[test]
fn held_spheres_are_as_accurate_as_asked() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let zener = Material::constant_poisson(Zener::with_time(1.0e9, 1.0e8, 1.0).unwrap(), 0.3).unwrap();
    let four = Material::incompressible(four_terms());
    for (name, material, until) in [("Maxwell", maxwell(), 2.0), ("Zener", zener, 5.0), ("four times", four, 20.0)] {
        let exact = GrowingSphere::step(RADIUS, &material, 1.0).unwrap();
        let mut found = Vec::new();
        for accuracy in PRESETS {
            let study = study(&sphere, &material, &load, until).accuracy(accuracy).ask(Observable::MaxPressure);
            let study = study.run().unwrap();
            check(name, &study, |t| [exact.approach(t), exact.pressure(0.0, t)]);
            found.push(format!("{}² cells and {} steps", study.contact().grid().cells()[0], study.times().len()));
        }
        if name == "Maxwell" {
            figures::figure("studies of a sphere", &found.join(", ")).unwrap();
            let study = study(&sphere, &material, &load, until).accuracy(1e-3).run().unwrap();
            let error = study.measured("approach").unwrap().error().unwrap();
            let size = format!("{}² cells and {} steps", study.contact().grid().cells()[0], study.times().len());
            figures::figure("study of the README", &format!("{size}, with a measured error of {error:.1e}")).unwrap();
        }
    }
}

/// A body that warms by 30 K under a held force, which its creep follows through four decades of reduced time.
#[test]
fn warming_spheres_are_as_accurate_as_asked() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let body = Material::incompressible(four_terms());
    let law = TimeTemperature::wlf(17.44, 51.6, 263.15).unwrap();
    let warming = TemperatureHistory::table(law.clone(), &[(1.0, 263.15), (5.0, 293.15)]).unwrap();
    let exact = GrowingSphere::step(RADIUS, &body, 1.0).unwrap();
    let on = |temperature: &TemperatureHistory, accuracy: f64| {
        let scene = |grid, settings| {
            Ok(builder_of(&sphere, grid, body.clone()).settings(settings).temperature(temperature.clone()))
        };
        Study::new(scene, &load, 6.0).accuracy(accuracy).run()
    };
    for accuracy in [1e-2, 1e-3] {
        let study = on(&warming, accuracy).unwrap();
        assert!(study.contact().reduced_time() > 1e3);
        check("warming", &study, |t| {
            let reduced = warming.reduced_time(0.0, t).unwrap();
            [exact.approach(reduced), exact.pressure(0.0, reduced)]
        });
    }
    // below the end of the law
    let cold = TemperatureHistory::function(law, |t| 263.15 - 20.0 * t, &[]).unwrap();
    let refused = on(&cold, 1e-2).unwrap_err();
    assert!(matches!(refused, Error::OutOfRange { field: "temperature", .. }), "{refused}");
}

/// The paper's own setting against a whole study to 1e-3, with all its meshes.
#[test]
fn a_study_is_a_thousand_times_less_work_than_the_papers_run() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let study = study(&sphere, &maxwell(), &load, 2.0).accuracy(1e-3).run().unwrap();
    // 256² cells and 100 steps, the convolutions counted on 32² cells, where contact problems take fewer
    let (_, convolutions) = StepLoadedSphere::maxwell().literally(32, 100).unwrap();
    let ratio = convolutions.iter().sum::<usize>() as f64 * 256.0_f64.powi(2) / study.work;
    println!("paper / study: {ratio:.0}, {convolutions:?} convolutions of the past and of contact problems");
    figures::figure("paper over study", &format!("{:.0}00", ratio / 100.0)).unwrap();
    assert!(ratio >= 1000.0, "{ratio}");
}

#[test]
fn punches_converge_slowly_and_their_pressure_never() {
    let radius = 1.0e-3;
    let (punch, material, load) =
        (FlatPunch::circular(radius).unwrap(), maxwell(), StepLoad::new(Load::force(1.0)).unwrap());
    let study_of = |accuracy: f64| study(&punch, &material, &load, 2.0).accuracy(accuracy);
    let exact = |t: f64| [material.contact_compliance(t) / (2.0 * radius), 0.0];
    let coarse = study_of(1e-2).run().unwrap();
    check("punch", &coarse, exact);
    assert_eq!(coarse.measured("maximum pressure").unwrap().error(), None);
    assert!(coarse.to_string().contains("maximum pressure: not converged"));
    let asked = study_of(3e-2).ask(Observable::MaxPressure).run().unwrap();
    assert_eq!(asked.ending, Ending::NoConvergence);
    // first order: a hundred times the cells a side for a hundredth of the error
    let (fine, cost) = (study_of(1e-5).run().unwrap(), coarse.cost_for(1e-5).unwrap().unwrap());
    assert!(
        fine.ending == Ending::Cells && cost.cells[0] > 10_000 && !fine.is_converged(),
        "{:?} {cost:?}",
        fine.ending
    );
}

/// The cost that a coarse study tells is that of the finer one, to a factor.
#[test]
fn costs_are_told_before_the_dear_runs() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), Ramp::new(Load::force(0.0), Load::force(1.0), 1.0).unwrap());
    let body = zener();
    let coarse = study(&sphere, &body, &load, 5.0).accuracy(1e-3).run().unwrap();
    let told = coarse.cost_for(1e-4).unwrap().unwrap();
    let fine = study(&sphere, &body, &load, 5.0).accuracy(1e-4).run().unwrap();
    let last = fine.meshes.last().unwrap();
    let took = last.convolutions * last.cells.iter().product::<usize>() as f64;
    println!("{told:?}\n{coarse}\n{fine}");
    assert!((0.2..5.0).contains(&(told.cells[0] as f64 / last.cells[0] as f64)), "{told:?}");
    assert!((0.1..10.0).contains(&(told.work / took)), "{} {took}", told.work);
    // of a budget of work nothing is spent that is not there
    let budget = 0.3 * fine.work;
    let less = study(&sphere, &body, &load, 5.0).accuracy(1e-4).work(budget).run().unwrap();
    assert!(less.ending == Ending::Work && less.work < 1.2 * budget && less.meshes.len() > 1, "{less}");
    assert!(less.measured("approach").unwrap().error().unwrap() > 1e-4);
    let small = study(&sphere, &body, &load, 5.0).accuracy(1e-4).memory(coarse.bytes()).run().unwrap();
    assert!(small.ending == Ending::Memory && small.bytes() <= coarse.bytes(), "{small}");
}

#[test]
fn studies_find_the_domain_whatever_its_size() {
    let load = |force: f64| StepLoad::new(Load::force(force)).unwrap();
    let half = |study: &StudyResult, axis: usize| 0.5 * study.contact().grid().lengths()[axis] / 1.12;
    for (scale, modulus, force) in [(1e-9, 1e9, 1e-9_f64), (1e-3, 1e6, 1.0), (1e3, 1e10, 1e12), (1.0, 1e-3, 1e-6)] {
        let sphere = Sphere::new(scale).unwrap();
        let material = Material::incompressible(Elastic::new(modulus).unwrap());
        let force = force.min(modulus * scale * scale * 1e-2);
        let radius = (0.75 * scale * force * material.contact_compliance(0.0)).cbrt();
        let study = study(&sphere, &material, &load(force), 1.0).run().unwrap();
        assert!((half(&study, 0) / radius - 1.0).abs() < 0.12, "{scale:e}: {:e} {radius:e}", half(&study, 0));
    }
    // an ellipse gets a domain of its own shape
    let (ellipsoid, material) = (Ellipsoid::new(10.0e-3, 160.0e-3).unwrap(), elastic());
    let [l1, l2] = study(&ellipsoid, &material, &load(1.0), 1.0).run().unwrap().contact().grid().lengths();
    assert!(l2 > 3.0 * l1, "{l1} {l2}");
    // a driven approach, and one that never touches
    let sphere = Sphere::new(RADIUS).unwrap();
    let driven = StepLoad::new(Load::approach(1.0e-4)).unwrap();
    let found = study(&sphere, &material, &driven, 1.0).run().unwrap();
    assert!((half(&found, 0) / (RADIUS * 1.0e-4).sqrt() - 1.0).abs() < 0.12);
    let apart = StepLoad::new(Load::approach(-1.0e-4)).unwrap();
    refused([(study(&sphere, &material, &apart, 1.0).run().err(), "no domain was found that holds the contact")]);
}

#[test]
fn what_a_study_cannot_be_is_refused() {
    let (sphere, material) = (Sphere::new(RADIUS).unwrap(), maxwell());
    let driven = StepLoad::new(Load::approach(1.0e-4)).unwrap();
    for until in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused([(study(&sphere, &material, &driven, until).run().err(), "end of the run")]);
    }
    let study = || study(&sphere, &material, &driven, 1.0);
    let sticky = |grid, settings| {
        let law = ExponentialAttraction::new(0.05, 1.0e-5)?;
        Ok(builder_of(&sphere, grid, material.clone()).settings(settings).attraction(law))
    };
    refused([
        (study().period(Axis::X1, 4.0e-3).run().err(), "period of the body along x1"),
        (study().line(1.0).run().err(), "length of a line contact"),
        (study().domain([0.0, 1.0]).run().err(), "side of the domain along x1"),
        (study().domain([1.0, f64::NAN]).run().err(), "side of the domain along x2"),
        (study().fields_at(&[2.0]).run().err(), "time of a pressure field"),
        (study().cells(0).run().err(), "cells of a study"),
        (study().work(f64::NAN).run().err(), "work of a study"),
        (study().ask_own("approach", |_| 0.0).run().err(), "name of a quantity"),
        (Study::along_each(sticky, &[], 1.0).run().err(), "load histories of the rigid bodies"),
    ]);
    not_covered([(Study::new(sticky, &driven, 1.0).run().err(), "Study::domain")]);
    refused([0.0, -1.0, 1e-7, 0.2, 5.0, f64::NAN].map(|target| (study().accuracy(target).run().err(), "accuracy")));
}

/// Surfaces that attract each other on a domain that is given, from the first mesh that resolves the zone.
#[test]
fn attraction_is_studied_on_a_given_domain() {
    let (sphere, body) =
        (Sphere::new(1.0e-3).unwrap(), Material::incompressible(Zener::new(2.5e5, 5.0e4, 5.0e4).unwrap()));
    let load = Ramp::new(Load::force(0.0), Load::force(-20.0e-6), 0.2).unwrap();
    let scene = |grid, settings| {
        let law = ExponentialAttraction::new(0.05, 2.0e-6)?;
        Ok(builder_of(&sphere, grid, body.clone()).settings(settings).attraction(law))
    };
    let study = Study::new(scene, &load, 0.2).accuracy(3e-2).domain([0.3e-3; 2]).run().unwrap();
    println!("{study}");
    assert!(study.is_converged() && study.contact().force() < 0.0);
}

/// Two bodies along histories of their own, and a body whose rheology has no series.
#[test]
fn several_bodies_and_closures_are_studied() {
    let ball = |x1: f64| Shifted::new(Sphere::new(5.0e-3).unwrap(), [x1, 0.0]).unwrap();
    let (left, right, body) = (ball(-0.8e-3), ball(0.8e-3), zener());
    let held = StepLoad::new(Load::approach(10.0e-6)).unwrap();
    let pressed = Ramp::new(Load::force(0.0), Load::force(0.3), 1.0).unwrap();
    let scene = |grid, settings| Ok(builder_of(&left, grid, body.clone()).another_body(&right).settings(settings));
    let study = Study::along_each(scene, &[&held, &pressed], 2.0).accuracy(1e-2);
    let study = study.ask_own("other approach", |fields| fields.body(1).unwrap().approach).run().unwrap();
    println!("{study}");
    assert!(study.is_converged() && study.measured("other approach").unwrap().error().unwrap() < 1e-2);
    assert!(study.contact().grid().lengths()[0] > 1.5 * study.contact().grid().lengths()[1]);

    let material = Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())));
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let study = self::study(&sphere, &material, &load, 10.0).run().unwrap();
    let held = |t: f64| (0.75 * RADIUS * material.contact_compliance(t)).powf(2.0 / 3.0) / RADIUS;
    check("held on a closure", &study, |t| [held(t), 0.0]);
}

/// A study reports every step of its runs, and ends where its caller wants.
#[test]
fn studies_report_their_progress_and_can_be_cancelled() {
    let (sphere, load) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap());
    let material = maxwell();
    let study = || study(&sphere, &material, &load, 2.0);
    let (mut steps, mut work) = (0, 0.0);
    let whole = study().run_with(|progress| {
        steps += 1;
        assert!(progress.work > work && progress.time <= 2.0 && progress.until == 2.0);
        work = progress.work;
        ControlFlow::Continue(())
    });
    let whole = whole.unwrap();
    assert!(whole.work == work && whole.runs >= 3 && whole.meshes.len() < whole.runs);
    for last in (1..=steps).step_by(1 + steps / 9) {
        let mut taken = 0;
        let cancelled = study().run_with(|_| {
            taken += 1;
            if taken < last { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        assert!(matches!(cancelled, Err(Error::Cancelled { what: "a study" })));
    }
    let flag = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    assert!(matches!(study().cancelled_by(flag).run(), Err(Error::Cancelled { .. })));
}

/// The table as text and CSV has what the result has.
#[test]
fn tables_of_a_study_are_read_back() {
    let (sphere, load, material) = (Sphere::new(RADIUS).unwrap(), StepLoad::new(Load::force(1.0)).unwrap(), maxwell());
    let study = study(&sphere, &material, &load, 2.0).fields_at(&[1.0, 2.0]).accuracy(5e-2);
    let study = study.run().unwrap();
    let path = std::env::temp_dir().join(format!("viscocontact-study-{}.csv", std::process::id()));
    study.write_csv(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = rows.headers().unwrap().iter().skip(7).map(str::to_owned).collect();
    assert_eq!(names, study.quantities.iter().map(|own| own.name.clone()).collect::<Vec<_>>());
    let rows: Vec<csv::StringRecord> = rows.records().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), study.meshes.len() + 4);
    for (mesh, row) in study.meshes.iter().zip(&rows) {
        assert_eq!(row[1].parse::<usize>().unwrap(), mesh.cells[0]);
        assert_eq!(row[5].parse::<usize>().unwrap(), mesh.steps);
        let changes: Vec<Option<f64>> = row.iter().skip(7).map(|cell| cell.parse().ok()).collect();
        assert_eq!(changes, mesh.changes);
    }
    let errors: Vec<Option<f64>> = rows.last().unwrap().iter().skip(7).map(|cell| cell.parse().ok()).collect();
    assert_eq!(errors, study.quantities.iter().map(|own| own.error()).collect::<Vec<_>>());
    let text = study.to_string();
    assert!(study.meshes.iter().all(|mesh| text.contains(&format!("{} × {}", mesh.cells[0], mesh.cells[1]))), "{text}");
    assert_eq!(study.fields().map(|fields| fields.time().unwrap()).collect::<Vec<_>>(), [1.0, 2.0]);
}

/// An error of the history is an error of the study, whatever part of it needed the load.
#[test]
fn errors_of_histories_come_out_of_studies() {
    let (sphere, body, until) = (Sphere::new(RADIUS).unwrap(), zener(), 2.0);
    let mut seen = 0;
    for number in 0..from_environment("STUDY_ERRORS", 30) {
        let draws = &mut Draws::new(number);
        let from = until * draws.between(0.0, 0.99);
        let is_met = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
        let met = std::sync::Arc::clone(&is_met);
        let history = FnHistory::fallible(move |t: f64| {
            if t > from && t < from + 0.01 * until {
                met.store(true, std::sync::atomic::Ordering::Relaxed);
                return Err(format!("no load at {t}"));
            }
            Ok(Load::force(0.5 * (0.2 + (2.0 * t).sin().abs())))
        });
        let result = study(&sphere, &body, &history, until).fields_at(&[1.0, 2.0]).accuracy(5e-2).run();
        if is_met.load(std::sync::atomic::Ordering::Relaxed) {
            seen += 1;
            let failed = match &result {
                Err(Error::User(_)) => true,
                Ok(study) => matches!(study.ending, Ending::Failed(Error::User(_))),
                Err(_) => false,
            };
            assert!(failed, "{from}: {result:?}");
        }
    }
    println!("{seen} errors were met");
    assert!(seen > 2);
}
