//! What bodies store and dissipate of the work of their load, against integrals by hand.

use crate::common::builder_of;
use std::f64::consts::PI;

use viscocontact::contact::{Energies, EnergyBalance, Frame};
use viscocontact::output::{CsvHistory, Earlier, Metadata};
use viscocontact::prelude::*;

use crate::common::temporary::Temporary;

/// E(t) = `RELAXED` + `RELAXING` e^(−t/`TIME`) of the contact.
const RELAXED: f64 = 1.0e6;
const RELAXING: f64 = 3.0e6;
const TIME: f64 = 0.7;

/// With the contact modulus E(t): incompressible bodies have 4 G.
fn zener() -> Material {
    Material::incompressible(Zener::relaxing((RELAXED + RELAXING) / 4.0, RELAXED / 4.0, TIME).unwrap())
}

fn contact_of(geometry: &dyn Geometry, cells: usize) -> ViscoelasticContact {
    let builder = ViscoelasticContact::builder(Grid::square(cells, 4.0e-3).unwrap()).geometry(geometry);
    builder.material(zener()).settings(Settings::default().with_tolerance(1e-9)).build().unwrap()
}

/// The energies after these steps to loads.
fn follow(contact: &mut ViscoelasticContact, steps: impl IntoIterator<Item = (f64, Load)>) -> Vec<Energies> {
    let mut balance = EnergyBalance::new(contact).unwrap();
    let step = |(dt, load)| {
        let report = contact.step(dt, load).unwrap();
        balance.record(contact, &report).unwrap()
    };
    steps.into_iter().map(step).collect()
}

/// A ball held at a depth keeps its circle: every branch relaxes from its part of the Hertzian energy, 2/5 F δ, and dissipates it. Steps of
/// any length are exact.
#[test]
fn a_held_ball_dissipates_what_its_springs_let_go() {
    let (radius, depth) = (10.0e-3, 1.0e-4);
    let mut contact = contact_of(&Sphere::new(radius).unwrap(), 96);
    let hold = Load::approach(depth);
    let energies = follow(&mut contact, [(0.0, hold), (0.1, hold), (0.8, hold), (40.0, hold)]);
    // F = 4/3 E* √R δ^(3/2)
    let hertz = 0.4 * 4.0 / 3.0 * (RELAXED + RELAXING) * radius.sqrt() * depth.powf(2.5);
    let first = energies[0];
    assert!((first.stored / hertz - 1.0).abs() < 5e-3, "{} {hertz}", first.stored);
    assert!(first.viscous.abs().max(first.imbalance().abs()) < 1e-12 * first.work && first.lost == 0.0, "{first:?}");
    for (found, time) in energies[1..].iter().zip([0.1, 0.9, 40.9_f64]) {
        let let_go = first.stored * RELAXING / (RELAXED + RELAXING) * -(-2.0 * time / TIME).exp_m1();
        assert!((found.viscous / let_go - 1.0).abs() < 1e-7, "{time}: {} {let_go}", found.viscous);
        assert!((found.work / first.work - 1.0).abs() < 1e-12 && found.imbalance().abs() < 1e-7 * found.work);
    }
}

/// A punch on a body under a held force sinks in by C(t): its energies are those of one spring beside a spring with a dashpot.
#[test]
fn a_punch_under_a_force_is_a_spring_beside_a_spring_with_a_dashpot() {
    let force = 2.0;
    let instant = 1.0 / (RELAXED + RELAXING);
    let retarded = TIME * (RELAXED + RELAXING) / RELAXED;
    let mut errors = Vec::new();
    for steps in [20, 40, 80] {
        let mut contact = contact_of(&FlatPunch::circular(1.0e-3).unwrap(), 32);
        let load = Load::force(force);
        let dt = 2.0 / f64::from(steps);
        let energies = follow(&mut contact, std::iter::once((0.0, load)).chain((0..steps).map(|_| (dt, load))));
        // δ = unit F C(t); a circle has 1/(2a)
        let unit = energies[0].work / (0.5 * force * force * instant);
        assert!((unit * 2.0e-3 - 1.0).abs() < 0.05, "{unit}");
        let scale = unit * force * force;
        let decay = (-2.0 / retarded).exp();
        let compliance = 1.0 / RELAXED + (instant - 1.0 / RELAXED) * decay;
        // σ = 1 − E∞ C of the branch falls as e^(−t/retarded)
        let [before, after] = [1.0, decay].map(|decay| (1.0 - RELAXED * instant) * decay);
        let work = scale * (compliance - 0.5 * instant);
        let stored = scale * 0.5 * (RELAXED * compliance * compliance + after * after / RELAXING);
        let viscous = scale * 0.5 * retarded / (RELAXING * TIME) * (before * before - after * after);
        assert!((work - stored - viscous).abs() < 1e-12 * work);
        let found = energies.last().unwrap();
        let off = [found.work - work, found.stored - stored, found.viscous - viscous].map(|off| off.abs() / work);
        println!("{steps} steps: {off:?}, imbalance {:.1e}", found.imbalance() / work);
        errors.push(off.into_iter().fold(0.0, f64::max));
    }
    assert!(errors[0] < 1e-3 && errors[2] < 0.3 * errors[1] && errors[1] < 0.3 * errors[0], "{errors:?}");
}

/// Balls pressed and lifted until they part, and punches that tilt: the balance closes with the second order of the steps, and what is
/// stored comes back but for what was dissipated.
#[test]
fn work_is_stored_or_dissipated() {
    let ball = Sphere::new(10.0e-3).unwrap();
    let punch = FlatPunch::rectangular([1.5e-3, 2.5e-3]).unwrap();
    let lifted = |t: f64| Load::approach(1.0e-4 * (0.2 + 1.8 * (PI * t).sin() - 0.2 * t));
    let aside = |t: f64| Load::eccentric_force(3.0 * t * (1.3 - t), [0.1e-3, -0.2e-3 * t]);
    let turned = |t: f64| Load::force_and_tilt(3.0 * t.sqrt(), [2.0e-3 * t * t, 1.0e-3 * (3.0 * t).sin()]);
    let loads: [&dyn Fn(f64) -> Load; 3] = [&lifted, &aside, &turned];
    let geometries: [(&str, &dyn Geometry); 3] = [("ball", &ball), ("aside", &punch), ("turned", &punch)];
    for ((name, geometry), load) in geometries.into_iter().zip(loads) {
        let mut imbalances = Vec::new();
        for steps in [50, 100, 200] {
            let mut contact = contact_of(geometry, 40);
            let times = (0..=steps).map(|k| f64::from(k) / f64::from(steps));
            let dt = |t: f64| if t > 0.0 { 1.0 / f64::from(steps) } else { 0.0 };
            let energies = follow(&mut contact, times.map(|t| (dt(t), load(t))));
            let greatest = energies.iter().map(|energies| energies.work).fold(0.0, f64::max);
            let imbalance = energies.iter().map(|energies| energies.imbalance().abs()).fold(0.0, f64::max);
            let Energies { work, stored, viscous, lost, .. } = *energies.last().unwrap();
            println!(
                "{name}, {steps}: {:.1e}; work {work:.3e}, stored {stored:.1e}, viscous {viscous:.3e}",
                imbalance / greatest
            );
            assert!(viscous > 0.1 * greatest && lost == 0.0);
            assert!(energies.is_sorted_by(|a, b| b.viscous >= a.viscous), "{name}: heat goes back");
            imbalances.push(imbalance / greatest);
        }
        assert!(
            imbalances[2] < 5e-3 && imbalances[2] < 0.5 * imbalances[1] && imbalances[1] < 0.5 * imbalances[0],
            "{name} {imbalances:?}"
        );
    }
}

/// A history has columns for energies; contacts whose energies are not covered are refused.
#[test]
fn energies_are_columns_of_histories() {
    let folder = Temporary::folder("energies");
    let ball = Sphere::new(10.0e-3).unwrap();
    let mut contact = contact_of(&ball, 24);
    let mut balance = EnergyBalance::new(&contact).unwrap();
    let path = folder.join("history.csv");
    let mut history =
        CsvHistory::create(&path, &Metadata::new("energies"), &contact, &EnergyBalance::COLUMNS, Earlier::Refuse)
            .unwrap();
    let report = contact.step(0.0, Load::force(0.5)).unwrap();
    let energies = balance.record(&contact, &report).unwrap();
    history.record(&contact, &report, &energies.values()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = rows[0].iter().position(|&name| name.trim_matches('"') == "stored energy [J]").unwrap();
    assert_eq!(rows[1][column].parse::<f64>().unwrap(), energies.stored);

    let late = EnergyBalance::new(&contact).unwrap_err();
    assert!(late.to_string().contains("before any step"), "{late}");
    let settings = Settings::default().with_frame(Frame::Indenter);
    let builder = builder_of(&ball, Grid::square(24, 4.0e-3).unwrap(), zener());
    let moving = EnergyBalance::new(&builder.settings(settings).build().unwrap()).unwrap_err();
    assert!(matches!(moving, Error::NotCovered { special: "on a grid that is fixed to the indenter", .. }), "{moving}");
}
