//! Whether the error estimated for steps of given length is the one they make.

use std::collections::BTreeMap;

use crate::common::{figures, sphere_on};
use viscocontact::prelude::*;

/// Approach, or force where the approach is given, at every multiple of `dt` by steps of that over `parts`, and the greatest
/// error in time estimated.
fn run(material: &Material, load: &dyn LoadHistory, dt: f64, parts: u32) -> (Vec<f64>, f64) {
    let mut contact =
        sphere_on(Grid::square(32, 4.0e-3).unwrap(), material.clone(), Settings::default().with_tolerance(1e-9));
    let mut run = contact.follow(load, Stepping::fixed(dt / f64::from(parts)), 5.0);
    let mut answer = Vec::new();
    while let Some(report) = run.next_step().unwrap() {
        let steps = report.time / dt;
        if report.dt > 0.0 && (steps - steps.round()).abs() < 1e-6 {
            let given = matches!(load.at(report.time), Load::Approach { .. });
            answer.push(if given { report.force } else { report.approach });
        }
    }
    (answer, run.error_budget().time.expect("steps were taken"))
}

/// Loads, and their rows in docs/maintainers/measurements.md.
const RATIOS: [(&str, &str); 4] = [
    ("force held", "force held after a jump (of Maxwell: exact)"),
    ("force ramp", "force that grows linearly"),
    ("force sine", "force 1 − cos, whose first step has no earlier data"),
    ("approach ramp", "approach that grows linearly"),
];

/// Steps of the reference in one step of a run under test.
const PARTS: u32 = 16;

/// The true error, relative to the answer at its time, or to a part of the greatest, as estimates are: at most three times the
/// estimate, and at least a third of it, for forces that jump or grow linearly. At most five times where nothing determines how
/// a load goes on within the first step.
#[test]
fn the_error_of_given_steps_is_estimated() {
    let burgers = |g, eta, g_k, eta_k| Material::incompressible(Burgers::new(g, eta, g_k, eta_k).unwrap());
    let materials = [
        ("Burgers, 1 s", burgers(1.0e6, 2.0e6, 0.5e6, 0.5e6)),
        ("Burgers, 0.5 s", burgers(1.0e6, 10.0e6, 1.0e6, 0.5e6)),
        ("Burgers, 0.2 s", burgers(1.0e6, 5.0e6, 0.5e6, 0.1e6)),
        ("Zener", Material::incompressible(Zener::with_time(1.0e6, 0.25e6, 1.0).unwrap())),
        ("Maxwell", Material::incompressible(Maxwell::with_time(1.0e6, 1.0).unwrap())),
        ("Kelvin-Voigt", Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0).unwrap())),
    ];
    let mut failures = Vec::new();
    // of bodies with elastic response, by load and length of the steps
    let mut ranges = BTreeMap::<(&str, &str), [f64; 2]>::new();
    for (body, material) in &materials {
        let held = |load| Box::new(StepLoad::new(load).unwrap());
        let ramp = |from, to| Box::new(Ramp::new(from, to, 2.0).unwrap());
        let sine = |t: f64| Load::force(0.3 * (1.0 - (1.3 * t).cos()));
        let root = |t: f64| Load::approach(1.0e-5 * (1.5 * t).sin().abs().sqrt());
        let loads: [(&str, bool, Box<dyn LoadHistory>); 6] = [
            ("force held", true, held(Load::force(0.5))),
            ("force ramp", true, ramp(Load::force(0.0), Load::force(0.5))),
            ("force sine", false, Box::new(FnHistory::new(sine))),
            ("approach held", false, held(Load::approach(4.0e-5))),
            ("approach ramp", false, ramp(Load::approach(0.0), Load::approach(4.0e-5))),
            ("approach root", false, Box::new(FnHistory::new(root))),
        ];
        for (what, tight, load) in &loads {
            // bodies without elastic response follow no jump
            if material.contact_compliance(0.0) == 0.0 && what.ends_with("held") {
                continue;
            }
            for dt in [0.5, 0.1] {
                let (coarse, estimate) = run(material, &**load, dt, 1);
                let (fine, _) = run(material, &**load, dt, PARTS);
                assert_eq!(coarse.len(), fine.len());
                let greatest = fine.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                let least = greatest * if what.starts_with("force") { 0.05 } else { 0.2 };
                let errors = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs() / b.abs().max(least));
                let error = errors.fold(0.0, f64::max);
                let line = format!(
                    "{body:<15} {what:<14} {dt} s: error {error:.1e}, estimate {estimate:.1e}, ratio {:.2}",
                    error / estimate
                );
                println!("{line}");
                let judged = !matches!((*body, *what), ("Kelvin-Voigt", _) | ("Maxwell", "force held"));
                if judged && let Some(range) = RATIOS.iter().find(|(load, _)| load == what) {
                    let [least, most] =
                        ranges.entry((range.1, if dt > 0.3 { "0.5" } else { "0.1" })).or_insert([f64::INFINITY, 0.0]);
                    (*least, *most) = (least.min(error / estimate), most.max(error / estimate));
                }
                // errors of the solver are not those of the steps
                let high_enough = error < if *tight { 3.0 } else { 5.0 } * estimate + 1e-8;
                let low_enough = !tight || error > estimate / 3.0 || error < 1e-8;
                if !(high_enough && low_enough) {
                    failures.push(line);
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for (_, row) in RATIOS {
        let [long, short] =
            ["0.5", "0.1"].map(|dt| ranges[&(row, dt)]).map(|[least, most]| format!("{least:.2} … {most:.2}"));
        figures::row("errors over estimates", &format!("| {row} |"), &format!("{long} | {short} |")).unwrap();
    }
}
