//! The user's models obey the laws, and their contact agrees with the theory.

use downstream::{Bowl, Gel, Heartbeat, MeasuredGel};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::laws;
use viscocontact::prelude::*;

const GEL: Gel = Gel { relaxed: 1.0e5, delayed: 4.0e5, time: 0.2 };
const BOWL: Bowl = Bowl { radius: 10.0e-3 };

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(9), ..ProptestConfig::with_cases(64) })]

    #[test]
    fn models_obey_the_laws(
        moduli in [1e3..1e9_f64, 1e3..1e9_f64], time in 1e-3..1e3_f64, radius in 1e-3..1.0_f64,
        cells in [2_usize..24, 2_usize..24], force in 0.0..10.0_f64, count in 3_usize..30,
    ) {
        let gel = Gel { relaxed: moduli[0], delayed: moduli[1], time };
        let times = laws::rheology::log_times(1e-3 * time, 1e3 * time);
        let broken = |law: &dyn std::fmt::Display| TestCaseError::fail(law.to_string());
        laws::rheology::all(&gel, &times).map_err(|law| broken(&law))?;
        let grid = Grid::new(cells, [1.0e-3, 2.0e-3]).unwrap();
        laws::geometry::all(&Bowl { radius }, &grid).map_err(|law| broken(&law))?;
        laws::geometry::shift_matches_points(&Bowl { radius }, &grid, [1e-4, 2e-5], 0.0).map_err(|law| broken(&law))?;
        let beat = Heartbeat { force, half_period: time };
        laws::load::all(&beat, &laws::load::even_times(0.0, 7.3 * time, count)).map_err(|law| broken(&law))?;
    }
}

fn contact(body: impl Rheology + 'static, cells: usize) -> ViscoelasticContact {
    ViscoelasticContact::builder(Grid::square(cells, 4.0e-3).unwrap())
        .geometry(&BOWL)
        .material(Material::incompressible(body))
        .times(1e-3..=1e2)
        .settings(Settings::default().with_tolerance(1e-8))
        .build()
        .unwrap()
}

/// Under a force that is held the contact grows, and Lee and Radok's solution holds: a³ = (3/4) F R C(t), C = J/4.
#[test]
fn a_held_force_is_lee_and_radok() {
    for (mut contact, name) in [(contact(GEL, 96), "series"), (contact(MeasuredGel(GEL), 96), "fitted")] {
        let force = 0.1;
        contact.step(0.0, Load::force(force)).unwrap();
        for step in 1..=100 {
            let report = contact.step(0.02, Load::force(force)).unwrap();
            let creep = 0.25 * GEL.creep_compliance(0.02 * f64::from(step));
            let radius = (0.75 * force * BOWL.radius * creep).cbrt();
            let depth = radius * radius / BOWL.radius;
            assert!((report.approach / depth - 1.0).abs() < 5e-3, "{name}: {} for {depth}", report.approach);
            assert!((contact.contact_area() / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.05, "{name}");
        }
    }
}

/// Along a history of the user's own: the forces are carried, steps end on its corners, nothing rests on the gel while it
/// waits, and each beat finds it pressed in a little deeper than the one before.
#[test]
fn each_beat_presses_deeper() {
    let beat = Heartbeat { force: 0.1, half_period: 0.3 };
    let mut contact = contact(GEL, 48);
    let mut run = contact.follow(&beat, Stepping::adaptive(1e-3), 1.8);
    let (mut corners, mut deepest) = (0, [0.0_f64; 3]);
    while let Some(report) = run.next_step().unwrap() {
        let Load::Force { normal, .. } = beat.at(report.time) else { unreachable!() };
        assert!((report.force - normal).abs() <= 1e-9 * beat.force);
        let beats = report.time / beat.half_period;
        corners += usize::from((beats - beats.round()).abs() < 1e-9);
        if beats.fract() < 0.5 && report.force > 0.0 {
            let deep = &mut deepest[(beats / 2.0) as usize];
            *deep = deep.max(report.approach);
        }
        if report.force == 0.0 && beats > 0.5 {
            assert_eq!(report.contact_cells, 0);
        }
    }
    assert!(corners >= 6, "{corners}");
    assert!(deepest[0] > 0.0 && deepest[1] > 1.02 * deepest[0] && deepest[2] > deepest[1], "{deepest:?}");
}
