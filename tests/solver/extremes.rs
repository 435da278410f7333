//! Steps, times, moduli, lengths and loads at the ends of their ranges.

use crate::common::figures;
use crate::common::{
    RADIUS, builder_of, builder_on, contact_of, elastic, maxwell, sphere, three_times, uniform, zener,
};
use approx::assert_abs_diff_eq;
use viscocontact::Error;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

fn builder(cells: usize, width: f64, material: Material) -> viscocontact::contact::Builder {
    builder_on(Grid::square(cells, width).unwrap(), material)
}

/// Exact approach of a held force: a³ = ¾ R W C(t), ω = a²/R.
fn held(material: &Material, force: f64, t: f64) -> f64 {
    (0.75 * RADIUS * force * material.contact_compliance(t)).powf(2.0 / 3.0) / RADIUS
}

/// Eight steps of Δ after a jump, Δ/τ from 1e-12 to 1e12, both rules: the table of docs/maintainers/measurements.md.
#[test]
fn every_length_of_step_errs_by_no_more_than_its_rule() {
    let mut table = "| Δ/τ | exponential | exponential, linear |\n|---|---|---|".to_owned();
    for exponent in (-12..=12).step_by(3) {
        let dt = 10f64.powi(exponent);
        let mut row = format!("| 1e{exponent} |");
        for time_rule in [TimeRule::Exponential, TimeRule::ExponentialLinear] {
            let maxwell = Material::incompressible(Zener::with_time(1.0e6, 2.0e5, 1.0).unwrap());
            let settings = Settings::default().with_time_rule(time_rule).with_tolerance(1e-9).with_edge(Edge::Allow);
            let width = 2.4 * (0.75 * RADIUS * 6.0 * 0.25e-6_f64).cbrt();
            let mut contact = builder(32, width, maxwell.clone()).settings(settings).build().unwrap();
            contact.step(0.0, Load::force(1.0)).unwrap();
            let mut worst = 0.0_f64;
            for _ in 0..8 {
                match contact.step(dt, Load::force(1.0)) {
                    Ok(report) => {
                        worst = worst.max((report.approach / held(&maxwell, 1.0, report.time) - 1.0).abs());
                    }
                    Err(_) => worst = f64::INFINITY,
                }
            }
            row += &if worst.is_finite() { format!(" {worst:.0e} |") } else { " fails |".to_owned() };
            // short and long steps see nothing or everything; in between the rule's own error
            assert!(worst < if exponent == 0 { 0.1 } else { 3e-3 }, "{row}");
        }
        table += &format!("\n{row}");
    }
    println!("{table}");
    figures::figure("any length of step", &table).unwrap();
}

/// Thirty decades of relaxation times in one body.
#[test]
fn thirty_decades_in_one_body_are_followed() {
    let terms: Vec<_> = (-15..=15).map(|k| (0.2e-6, 10f64.powi(k))).collect();
    let material = Material::incompressible(GeneralizedKelvin::new(1.0e-6, 0.0, &terms).unwrap());
    let width = 2.4 * (0.75 * RADIUS * material.contact_compliance(1e17)).cbrt();
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let mut contact = builder(48, width, material.clone()).build().unwrap();
    let mut run = contact.follow(&load, Stepping::adaptive(1e-3), 1e17);
    let (mut steps, mut worst) = (0, 0.0_f64);
    while let Some(report) = run.next_step().unwrap() {
        steps += 1;
        if report.contact_cells > 150 {
            worst = worst.max((report.approach / held(&material, 1.0, report.time) - 1.0).abs());
        }
    }
    println!("{steps} steps from 1e-17 s to 1e17 s: {worst:.1e}");
    assert!(worst < 3e-3 && steps < 500, "{worst:e} {steps}");
}

#[test]
fn every_poissons_ratio_and_shape_of_cell_gives_hertz() {
    for nu in [0.0, 0.5, -0.9] {
        let material = Material::constant_poisson(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap(), nu).unwrap();
        let width = 2.5 * (0.75 * RADIUS * material.contact_compliance(1e3)).cbrt();
        let mut contact = builder(48, width, material.clone()).build().unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        contact.step(100.0, Load::force(1.0)).unwrap();
        let relative = contact.approach() / held(&material, 1.0, 100.0) - 1.0;
        assert!(relative.abs() < 2e-3, "ν = {nu}: {relative:e}");
    }
    // cells a thousand times as long as wide, under a body of the same proportions
    let ellipsoid = Ellipsoid::new(1.0e-3, 1.0e3).unwrap();
    let hertz = viscocontact::analytic::HertzEllipse::new([1.0e-3, 1.0e3], 4.0e6, 1.0).unwrap();
    let [a, b] = hertz.semi_axes;
    let mut contact =
        contact_of(&ellipsoid, Grid::new([48, 48], [2.4 * a, 2.4 * b]).unwrap(), elastic(), Settings::default());
    let [d1, d2] = contact.grid().spacing();
    contact.step(0.0, Load::force(1.0)).unwrap();
    let relative = contact.approach() / hertz.approach - 1.0;
    println!("cells 1 : {:.0}: approach {relative:.1e}", d2 / d1);
    assert!(d2 / d1 > 1000.0);
    assert_abs_diff_eq!(relative, 0.0, epsilon = 5e-3);
}

/// K p is carried from guess to guess: on an elastic body u = C K p shows whether it is still K p.
fn drift(contact: &ViscoelasticContact, fresh: &mut [f64]) -> f64 {
    let kernel = contact.fields().kernel();
    kernel.convolve(contact.pressure(), fresh, &mut kernel.workspace().unwrap()).unwrap();
    let scale = fresh.iter().copied().fold(0.0, f64::max);
    let c = contact.material().contact_compliance(0.0);
    contact.fields().displacement().iter().zip(fresh.iter()).map(|(u, v)| (u / c - v).abs()).fold(0.0, f64::max) / scale
}

fn elastic_sphere(cells: usize) -> ViscoelasticContact {
    builder(cells, 4.0e-3, elastic()).build().unwrap()
}

/// Loads that fall by halves: the extrapolated guess cancels to noise.
#[test]
fn k_p_stays_exact_under_falling_loads() {
    let shapes: [&dyn Geometry; 2] = [&sphere(), &FlatPunch::circular(1.0e-3).unwrap()];
    for shape in shapes {
        let mut contact = contact_of(shape, Grid::square(32, 3.0e-3).unwrap(), elastic(), Settings::default());
        let mut fresh = vec![0.0; contact.grid().len()];
        let halves = (0..40).map(|k| 0.4 * 0.5_f64.powi(k)).chain((0..12).map(|k| 0.4 * 0.65_f64.powi(k)));
        for force in halves.chain([0.4, 0.2, 1e-3, 1e-6, 0.3, 0.3]) {
            contact.step(1.0, Load::force(force)).unwrap();
            assert!(drift(&contact, &mut fresh) < 1e-11, "at {force}");
        }
    }
}

/// Steps that grow carry the rounding of K p along, larger each time: it must be computed afresh in time.
#[test]
fn k_p_stays_exact_as_steps_grow() {
    for growth in [1.0, 1.2, 1.5, 2.0, 2.9] {
        let mut contact = elastic_sphere(24);
        let mut fresh = vec![0.0; contact.grid().len()];
        let (mut dt, mut worst) = (1e-60, 0.0_f64);
        for step in 0..250_u32 {
            contact.step(dt, Load::force(0.6 + 0.3 * (0.01 * f64::from(step)).sin())).unwrap();
            dt *= growth;
            worst = worst.max(drift(&contact, &mut fresh));
        }
        println!("growth {growth}: {worst:.1e}");
        assert!(worst < 1e-10, "growth {growth}: {worst:e}");
    }
}

#[test]
fn a_million_steps_do_not_drift() {
    let mut contact = elastic_sphere(8);
    let mut fresh = vec![0.0; contact.grid().len()];
    let mut worst = 0.0_f64;
    for step in 0..1_000_000_u32 {
        contact.step(1e-4, Load::force(0.6 + 0.3 * (0.01 * f64::from(step)).sin())).unwrap();
        if step % 997 == 0 {
            worst = worst.max(drift(&contact, &mut fresh));
        }
    }
    println!("K p after a million steps: {worst:.1e}");
    assert!(worst < 1e-10, "{worst:e}");
}

/// A body with several times under a periodic load: once the beginning is forgotten, all periods are the same.
#[test]
fn periodic_steps_of_a_viscoelastic_body_do_not_drift() {
    let period = 500;
    let kelvin = Material::incompressible(GeneralizedKelvin::new(0.0, 0.0, &[(1.0e-6, 0.03), (1.0e-6, 3.0)]).unwrap());
    for (material, steps) in [(three_times(), 250_000_u32), (kelvin, 150_000)] {
        let settings = Settings::default().with_tolerance(1e-11);
        let mut contact = builder(8, 8.0e-3, material).settings(settings).build().unwrap();
        let (mut settled, mut approach) = (Vec::new(), 0.0);
        let mut worst = 0.0_f64;
        for step in 1..=steps {
            let phase = std::f64::consts::TAU * f64::from(step % period) / f64::from(period);
            contact.step(1e-2, Load::force(0.6 + 0.3 * phase.sin())).unwrap();
            // the longest retardation time is about 20 s
            if step == 200 * period {
                (settled, approach) = (contact.fields().displacement().to_vec(), contact.approach());
            } else if step > 200 * period && step % (10 * period) == 0 {
                let far = contact
                    .fields()
                    .displacement()
                    .iter()
                    .zip(&settled)
                    .map(|(u, v)| (u - v).abs())
                    .fold(0.0, f64::max);
                worst = worst.max((far + (contact.approach() - approach).abs()) / approach);
            }
        }
        println!("after {steps} steps: {worst:.1e}");
        assert!(worst < 1e-9, "{worst:e}");
    }
}

#[test]
fn a_load_removed_and_restored_a_thousand_times_leaves_nothing() {
    let mut contact = builder(32, 4.0e-3, zener()).build().unwrap();
    for _ in 0..1000 {
        contact.step(1e-3, Load::force(0.5)).unwrap();
        contact.step(1e-3, Load::force(0.0)).unwrap();
        assert_eq!(contact.contact_cells(), 0);
    }
    // half the time loaded, until everything is in equilibrium: the mean displacement is half the relaxed one
    contact.step(0.0, Load::force(0.5)).unwrap();
    assert_abs_diff_eq!(contact.force() / 0.5, 1.0, epsilon = 1e-12);
    assert!(contact.contact_cells() > 50);
    contact.step(0.0, Load::force(0.0)).unwrap();
    let left = contact.fields().displacement().iter().copied().fold(0.0, f64::max);
    // each step of many relaxation times leaves the share τ/Δ
    let mut forgotten = left;
    for _ in 0..3 {
        contact.step(1e3, Load::force(0.0)).unwrap();
        let now = contact.fields().displacement().iter().map(|u| u.abs()).fold(0.0, f64::max);
        assert!(now < 1e-3 * forgotten, "{forgotten:e} {now:e}");
        forgotten = now;
    }
}

/// From next to no load, on one cell, to all of them.
#[test]
fn contact_grows_from_one_cell_to_all() {
    let settings = Settings::default().with_edge(Edge::Allow);
    let mut contact = builder(16, 1.0e-3, zener()).settings(settings).build().unwrap();
    let mut cells = Vec::new();
    for exponent in -200..=2 {
        contact.step(1e-3, Load::force(10f64.powi(exponent))).unwrap();
        assert_abs_diff_eq!(contact.force() / 10f64.powi(exponent), 1.0, epsilon = 1e-12);
        cells.push(contact.contact_cells());
    }
    assert!(
        cells[0] <= 4 && cells.windows(2).all(|pair| pair[1] >= pair[0]) && cells[cells.len() - 1] == 256,
        "{cells:?}"
    );
    // and what cannot be represented is said
    let error = contact.step(0.0, Load::force(1e-323)).and_then(|_| contact.step(0.0, Load::force(1e308))).unwrap_err();
    assert!(matches!(error, Error::Step(StepError::Overflow { .. })), "{error}");
}

/// A force that is a number on an arm that makes its moment none.
#[test]
fn moments_beyond_numbers_are_refused() {
    let mut contact = contact_of(
        &Shifted::new(Sphere::new(1.0e90).unwrap(), [0.3e90, 0.0]).unwrap(),
        Grid::square(8, 1.0e90).unwrap(),
        Material::incompressible(Elastic::new(1.0e50).unwrap()),
        Settings::default(),
    );
    let error = contact.step(0.0, Load::force(1.0e220)).unwrap_err();
    assert!(matches!(error, Error::Step(StepError::Overflow { what: "the moment of the force", .. })), "{error}");
    contact.step(0.0, Load::force(1.0e215)).unwrap();
    assert_abs_diff_eq!(contact.fields().moment()[0], 0.3e305, epsilon = 0.1 * 0.3e305);
}

/// Pressures so small that their squares vanish: a pull among them is still a pull.
#[test]
fn the_least_pressures_are_not_negative() {
    let (mut accepted, mut refused) = (0, 0);
    for dt in [f64::MAX, 1e300, 1e250, 1e200] {
        for k in 0..40 {
            let tilt = [Tilt::Fixed(0.0), Tilt::Fixed(2.4e-4 * f64::from(k))];
            for (cells, load) in [
                ([12, 1], Load::Approach { approach: 2.0e-8, tilt }),
                ([6, 5], Load::Approach { approach: 5.0e-8, tilt }),
            ] {
                let grid = Grid::new(cells, [3.1e-6, 3.9e-6]).unwrap();
                let wavy = Wavy::new(1.0e-8 * (1.0 + 0.1 * f64::from(k)), 1.1e-6).unwrap();
                let mut contact = builder_of(&Sum::new(Sphere::new(1.0e-4).unwrap(), wavy), grid, maxwell())
                    .settings(Settings::default().with_edge(Edge::Allow).with_tolerance(4.5e-8))
                    .build()
                    .unwrap();
                match contact.step(dt, load) {
                    Ok(_) => accepted += 1,
                    Err(_) => refused += 1,
                }
                let pulls = contact.pressure().iter().filter(|&&p| p < 0.0).count();
                assert_eq!(pulls, 0, "{dt:e} s, {k}, {cells:?}: {:?}", contact.pressure());
            }
        }
    }
    assert!(accepted > 50, "{accepted} accepted, {refused} refused");
}

/// Bodies that are held relax: on a Maxwell body all that happens to the pressure is the factor e^(−t/τ), in steps of any
/// length, as long as numbers last.
#[test]
fn a_held_approach_relaxes_by_many_decades() {
    let mut dice = uniform(7);
    let mut between = |low: f64, high: f64| low + (high - low) * dice();
    for scene in 0..40 {
        let shapes: [Box<dyn Geometry>; 4] = [
            Box::new(Sphere::new(between(5.0e-3, 20.0e-3)).unwrap()),
            Box::new(Ellipsoid::new(between(5.0e-3, 20.0e-3), between(5.0e-3, 20.0e-3)).unwrap()),
            Box::new(Cone::new(between(0.01, 0.1)).unwrap()),
            Box::new(FlatPunch::circular(between(0.5e-3, 1.5e-3)).unwrap()),
        ];
        let cells = [24 + (between(0.0, 24.0) as usize), 24 + (between(0.0, 24.0) as usize)];
        let mut contact =
            contact_of(&shapes[scene % 4], Grid::new(cells, [4.0e-3; 2]).unwrap(), maxwell(), Settings::default());
        let held = Load::approach_and_tilt(between(0.2e-5, 3.0e-5), [between(0.0, 1.0e-3), 0.0]);
        // held where it is, or where a force has brought it
        let held = if scene % 3 == 0 {
            contact.step(0.0, Load::force(between(0.01, 0.3))).unwrap();
            Load::approach(contact.approach())
        } else {
            contact.step(0.0, held).unwrap();
            held
        };
        let (start, force) = (contact.pressure().to_vec(), contact.force());
        for _ in 0..4 {
            // in one step, or in several
            let dt = between(0.1, 60.0);
            let report = contact.step(dt, held).unwrap();
            let left = (-report.time).exp();
            assert!((contact.force() / (left * force) - 1.0).abs() < 1e-5, "scene {scene}, {dt}: {report}");
            let errors = contact.pressure().iter().zip(&start).map(|(p, p0)| (p - left * p0).abs());
            assert!(errors.sum::<f64>() < 1e-5 * left * start.iter().sum::<f64>(), "scene {scene}, {dt}: {report}");
            assert!(report.residual <= contact.fields().settings().tolerance());
        }
        // beyond the range of numbers there is nothing left
        contact.step(1.0e6, held).unwrap();
        assert_eq!(contact.force(), 0.0);
    }
}

/// A flat punch on an elastic body is pressed in proportion to its approach, however much deeper it was before.
#[test]
fn pressure_is_proportional_to_the_approach_of_a_punch() {
    let mut dice = uniform(3);
    let mut between = |low: f64, high: f64| low + (high - low) * dice();
    for scene in 0..30 {
        let cells = 24 + between(0.0, 48.0) as usize;
        let mut contact = contact_of(
            &FlatPunch::circular(between(0.5e-3, 1.5e-3)).unwrap(),
            Grid::square(cells, 4.0e-3).unwrap(),
            elastic(),
            Settings::default().with_tolerance(1e-8).with_symmetry(scene % 2 == 0).with_window(scene % 3 == 0),
        );
        contact.step(0.0, Load::approach(1.0e-5)).unwrap();
        let whole = contact.pressure().to_vec();
        for _ in 0..6 {
            let approach = 10f64.powf(between(-19.0, -5.0));
            contact.step(0.0, Load::approach(approach)).unwrap();
            let share = approach / 1.0e-5;
            let errors = contact.pressure().iter().zip(&whole).map(|(p, whole)| (p - share * whole).abs());
            let sum: f64 = whole.iter().sum();
            assert!(errors.sum::<f64>() < 1e-5 * share * sum, "scene {scene}, {approach:e} m");
        }
    }
}
