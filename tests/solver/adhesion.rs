//! Do surfaces that attract each other reach the states of theories and of independent computations? Units E* = R = w = 1, with the relaxed E*.

use std::f64::consts::PI;

use viscocontact::Special;
use viscocontact::adhesion::{AdhesionError, Attraction, Dugdale, ExponentialAttraction, LinearSoftening, VanDerWaals};
use viscocontact::analytic::MaugisDugdale;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

fn elastic() -> Material {
    Material::incompressible(Elastic::new(0.25).unwrap())
}

/// A sphere on a square of side `side`.
fn sphere(cells: usize, side: f64, material: Material, law: impl Attraction + 'static) -> ViscoelasticContact {
    ViscoelasticContact::builder(Grid::square(cells, side).unwrap())
        .geometry(&Sphere::new(1.0).unwrap())
        .material(material)
        .attraction(law)
        .settings(Settings::default().with_edge(Edge::Allow))
        .build()
        .unwrap()
}

/// Forces at `count` + 1 approaches from one to another, taken one after the other; energy must not rise in any step.
fn forces(contact: &mut ViscoelasticContact, [from, to]: [f64; 2], count: usize) -> Vec<(f64, f64)> {
    let approaches = (0..=count).map(|k| from + (to - from) * k as f64 / count as f64);
    let step = |approach: f64| {
        let report = contact.step(1.0, Load::approach(approach)).unwrap();
        let passes = contact.passes().unwrap();
        assert!(passes.rise < 1e-6, "{approach}: {passes:?}");
        (approach, report.force)
    };
    approaches.map(step).collect()
}

/// The least force of a path, by a parabola through the lowest three.
fn least(path: &[(f64, f64)]) -> f64 {
    let k = (1..path.len() - 1).min_by(|&i, &j| path[i].1.total_cmp(&path[j].1)).unwrap();
    let [(x0, y0), (x1, y1), (x2, y2)] = [path[k - 1], path[k], path[k + 1]];
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let bend = (second - first) / (x2 - x0);
    let x = 0.5 * (x0 + x1) - 0.5 * first / bend;
    y0 + first * (x - x0) + bend * (x - x0) * (x - x1)
}

fn pull_off(cells: usize, law: impl Attraction + 'static) -> f64 {
    let mut contact = sphere(cells, 8.0, elastic(), law);
    contact.step(1.0, Load::approach(1.0)).unwrap();
    least(&forces(&mut contact, [0.2, -1.4], 16))
}

/// Exponential law at μ = 1: 0.3 % at 6 cells in the zone, 1e-3 at 12, and of an order of 1.5 or more.
#[test]
fn the_exponential_law_is_reached_as_the_mesh_is_refined() {
    let exact = -1.66407685 * PI;
    let errors =
        [24, 48, 96].map(|cells| (pull_off(cells, ExponentialAttraction::new(1.0, 1.0).unwrap()) / exact - 1.0).abs());
    println!("pull-off at 3, 6 and 12 cells in the zone: errors {errors:?}");
    assert!(errors[0] < 1.2e-2 && errors[1] < 3e-3 && errors[2] < 1e-3, "{errors:?}");
    let mut contact = sphere(120, 10.0, elastic(), ExponentialAttraction::new(1.0, 1.0).unwrap());
    let force = contact.step(1.0, Load::approach(1.4006335)).unwrap().force;
    println!("force at a = 2: {force}");
    assert!((force + 1.7760281).abs() < 1e-3 * 1.664 * PI, "{force}");
}

/// Dugdale's law, with 8 cells in the zone and 4 at its end, against the sharp one of Maugis; linear softening is reached at 6 cells.
#[test]
fn dugdales_law_is_that_of_maugis() {
    let law = Dugdale::new(1.0, 1.0).unwrap();
    let exact = MaugisDugdale::new(1.0, 1.0, 1.0, 1.0).unwrap().pull_off()[0];
    let found = pull_off(64, law);
    println!("Dugdale: {found}, Maugis {exact}");
    assert!((found / exact - 1.0).abs() < 3e-3, "{found} {exact}");
    let [coarse, fine] = [48, 96].map(|cells| pull_off(cells, LinearSoftening::new(1.0, 1.0).unwrap()));
    println!("linear softening: {coarse} with 6, {fine} with 12 cells in the zone");
    assert!((coarse / fine - 1.0).abs() < 3e-3, "{coarse} {fine}");
}

/// The work of an elastic contact without jumps is what it stores.
#[test]
fn work_is_stored_where_nothing_jumps() {
    for law in [
        Box::new(ExponentialAttraction::new(1.0, 1.0).unwrap()) as Box<dyn Attraction>,
        Box::new(LinearSoftening::new(1.0, 1.0).unwrap()),
        Box::new(VanDerWaals::new(1.0, 1.0).unwrap()),
    ] {
        let name = format!("{law:?}");
        let mut contact = sphere(32, 8.0, elastic(), law);
        contact.step(1.0, Load::approach(1.5)).unwrap();
        let stored = |contact: &ViscoelasticContact| {
            let cells = contact.grid().len();
            let (mut traction, mut gap) = (vec![0.0; cells], vec![0.0; cells]);
            contact.traction_into(&mut traction).unwrap();
            contact.gap_into(&mut gap).unwrap();
            let displaced = traction.iter().zip(contact.displacement()).map(|(p, u)| 0.5 * p * u);
            let attracted = gap.iter().map(|h| contact.attraction().unwrap().energy(h.max(0.0)));
            (displaced.sum::<f64>() - attracted.sum::<f64>()) * contact.grid().cell_area()
        };
        let start = stored(&contact);
        let path = forces(&mut contact, [1.5, -0.7], 44);
        let work: f64 = path.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum();
        let gained = stored(&contact) - start;
        println!("{name}: work {work:.5}, stored {gained:.5}");
        assert!((work - gained).abs() < 1e-3 * work.abs(), "{name}: {work} {gained}");
    }
}

/// A sphere that has relaxed, E = 1 + 9 e^(−t), and is retracted: forces of an independent axisymmetric computation, μ = 2.
#[test]
fn a_creeping_sphere_pulls_harder_the_faster_it_is_retracted() {
    let creeping = || Material::incompressible(GeneralizedMaxwell::new(0.25, &[(2.25, 1.0)]).unwrap());
    let mut relaxed = sphere(144, 12.0, creeping(), ExponentialAttraction::new(1.0, 0.5).unwrap());
    let start = 5.3203098;
    // the contact grows to its final size much more slowly than the material relaxes
    for _ in 0..4 {
        relaxed.step(1e4, Load::approach(start)).unwrap();
    }
    println!("relaxed at a = 3: {:.4}", relaxed.force());
    assert!((relaxed.force() - 12.847194).abs() < 2e-3 * 12.847194, "{}", relaxed.force());
    let retract = |speed: f64, step: f64, until: f64| {
        let mut contact = relaxed.clone();
        let begin = contact.time();
        let mut path = vec![(0.0, contact.force())];
        while path.last().unwrap().0 < until {
            let time = contact.time() - begin + step;
            let force = contact.step(step, Load::approach(start - speed * time)).unwrap().force;
            path.push((time, force));
        }
        path
    };
    let path = retract(1.0, 0.09848, 5.0);
    println!("V = 1: {:.4} at 0.4924, greatest pull {:.4}", path[5].1, least(&path));
    assert!((path[5].0 - 0.4924).abs() < 1e-9 && (path[5].1 + 9.458).abs() < 0.01 * 9.458, "{:?}", path[5]);
    assert!((least(&path) + 26.958).abs() < 0.01 * 26.958, "{}", least(&path));
    let fast = retract(1000.0, 1e-4, 6e-3);
    println!("V = 1000: greatest pull {:.4}", least(&fast));
    assert!((least(&fast) + 33.078).abs() < 0.01 * 33.078, "{}", least(&fast));
}

/// Under a given force the contact holds until a force that it reports, and goes on apart under a given approach.
#[test]
fn a_force_pulls_the_bodies_off() {
    let law = || ExponentialAttraction::new(1.0, 1.0).unwrap();
    let mut contact = sphere(48, 8.0, elastic(), law());
    let report = contact.step(1.0, Load::force(0.0)).unwrap();
    assert!(report.contact_cells > 100 && report.force.abs() < 1e-10, "{report}");
    let approach = contact.approach();
    let mut given = sphere(48, 8.0, elastic(), law());
    assert!(given.step(1.0, Load::approach(approach)).unwrap().force.abs() < 2e-3);
    contact.step(1.0, Load::force(-5.15)).unwrap();
    let before = (contact.time(), contact.approach(), contact.pressure().to_vec());
    let refused = contact.step(1.0, Load::force(-5.35)).unwrap_err();
    assert!(
        matches!(refused, Error::Adhesion(AdhesionError::PulledOff { time, force }) if time == 3.0 && (force + 5.35).abs() < 1e-12),
        "{refused}"
    );
    assert_eq!(before, (contact.time(), contact.approach(), contact.pressure().to_vec()));
    let apart = contact.step(1.0, Load::approach(-6.0)).unwrap();
    assert!(apart.contact_cells == 0 && (-0.2..0.0).contains(&apart.force), "{apart}");
    // without attraction forces do not pull
    let mut plain = ViscoelasticContact::builder(Grid::square(16, 8.0).unwrap())
        .geometry(&Sphere::new(1.0).unwrap())
        .material(elastic())
        .build()
        .unwrap();
    assert!(matches!(plain.step(1.0, Load::force(-1.0)), Err(Error::OutOfRange { .. })));
}

/// A spring carries the force of its length, pulling too, and separates where it must.
#[test]
fn a_spring_pulls() {
    let mut contact = sphere(32, 8.0, elastic(), ExponentialAttraction::new(1.0, 1.0).unwrap());
    let stiffness = 20.0;
    for drive in [1.0, 0.5, 0.0, -0.5, -0.8] {
        let report = contact.step(1.0, Load::spring(stiffness, drive)).unwrap();
        let expected = stiffness * (drive - report.approach);
        assert!((report.force - expected).abs() < 1e-3 * expected.abs().max(1.0), "{report}: {expected}");
        let mut given = sphere(32, 8.0, elastic(), ExponentialAttraction::new(1.0, 1.0).unwrap());
        given.step(1.0, Load::approach(1.0)).unwrap();
        let force = given.step(1.0, Load::approach(report.approach)).unwrap().force;
        assert!((force - report.force).abs() < 5e-3, "{drive}: {force} {}", report.force);
    }
    let apart = contact.step(1.0, Load::spring(stiffness, -4.0)).unwrap();
    assert!(apart.contact_cells == 0 && apart.force > -1.0, "{apart}");
}

/// A force beside the middle turns a punch; symmetry, snapshots and clones change nothing.
#[test]
fn tilts_symmetry_and_snapshots() {
    let build = |symmetry: bool| {
        ViscoelasticContact::builder(Grid::square(32, 4.0).unwrap())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(elastic())
            .attraction(ExponentialAttraction::new(1.0, 1.0).unwrap())
            .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(symmetry))
            .build()
            .unwrap()
    };
    let (mut folded, mut whole) = (build(true), build(false));
    for approach in [0.5, 0.2, 0.4] {
        let [a, b] = [&mut folded, &mut whole].map(|contact| contact.step(1.0, Load::approach(approach)).unwrap());
        assert!((a.force - b.force).abs() < 1e-3, "{a} {b}");
    }
    let snapshot = folded.snapshot();
    let once = folded.step(1.0, Load::approach(-0.1)).unwrap();
    folded.restore(&snapshot).unwrap();
    let again = folded.step(1.0, Load::approach(-0.1)).unwrap();
    assert_eq!(once.force.to_bits(), again.force.to_bits());
    // the net traction has its resultant where the force acts
    let at = [0.2, -0.1];
    let mut punch = ViscoelasticContact::builder(Grid::square(32, 4.0).unwrap())
        .geometry(&FlatPunch::circular(1.5).unwrap())
        .material(elastic())
        .attraction(ExponentialAttraction::new(1.0, 1.0).unwrap())
        .build()
        .unwrap();
    for force in [3.0, 1.0, -0.5] {
        let report = punch.step(1.0, Load::eccentric_force(force, at)).unwrap();
        let moment = punch.moment();
        assert!((report.force - force).abs() < 1e-9, "{report}");
        assert!((0..2).all(|axis| (moment[axis] - force * at[axis]).abs() < 1e-6), "{force}: {moment:?}");
        assert!(report.tilt[0] * force > 0.0 && report.tilt[1] * force < 0.0, "{report:?}");
    }
}

/// What is not covered, not resolved, or coarse.
#[test]
fn what_is_not_covered_is_refused() {
    let builder = |range: f64| {
        ViscoelasticContact::builder(Grid::square(32, 8.0).unwrap())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(elastic())
            .attraction(ExponentialAttraction::new(1.0, range).unwrap())
    };
    let refused = |settings: Settings| builder(1.0).settings(settings).build().unwrap_err();
    for error in [
        refused(Settings::default().with_frame(Frame::Indenter)),
        refused(Settings::default().with_solver(Solver::PolonskyKeer)),
        refused(Settings::default().with_time_rule(TimeRule::Rectangle)),
        builder(1.0).another_body(&Sphere::new(1.0).unwrap()).build().unwrap_err(),
        builder(1.0)
            .build()
            .unwrap()
            .step(1.0, Load::Approach { approach: 0.1, tilt: [Tilt::Free { at: 0.0 }; 2] })
            .unwrap_err(),
        builder(1.0).build().unwrap().stress().unwrap_err(),
    ] {
        assert!(matches!(error, Error::NotCovered { special: Special::Attraction, .. }), "{error}");
    }
    // cells of 1/4: the zone has 4 ρ² cells
    let Err(Error::Adhesion(AdhesionError::ZoneNotResolved { cells, spacing, range, .. })) = builder(0.5).build()
    else {
        panic!()
    };
    assert!((cells - 1.0).abs() < 1e-12 && (spacing - 0.125).abs() < 1e-12 && (range - 0.5f64.sqrt()).abs() < 1e-12);
    for (range, coarse) in [(0.8, true), (1.1, false)] {
        let report = builder(range).build().unwrap().step(1.0, Load::approach(0.2)).unwrap();
        assert_eq!(report.warnings.contains(Warnings::COARSE_ZONE), coarse);
    }
    // without attraction the net traction is the pressure
    let mut plain = ViscoelasticContact::builder(Grid::square(32, 8.0).unwrap())
        .geometry(&Sphere::new(1.0).unwrap())
        .material(elastic())
        .build()
        .unwrap();
    plain.step(1.0, Load::force(0.5)).unwrap();
    let mut traction = vec![0.0; 32 * 32];
    plain.traction_into(&mut traction).unwrap();
    assert!(
        plain.pressure() == traction && plain.passes().is_none() && plain.traction_into(&mut traction[1..]).is_err()
    );
}
