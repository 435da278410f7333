//! What must hold between the answers of related scenes, whatever the scene: of the same instant.

use std::sync::Arc;

use super::related::{assert_ends_like, assert_same, difference, end, field, tight};
use crate::common::contact_of;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::laws::Scenario;
use viscocontact::laws::strategies::scenarios;
use viscocontact::prelude::*;

/// A scene with another shape.
fn reshaped(scene: &Scenario, gap: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Scenario {
    Scenario { shape: Arc::new(FnGeometry::new(gap)), ..scene.clone() }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2031), max_shrink_iters: 64, ..ProptestConfig::with_cases(250) })]

    /// Lengths, pressures and times in other units.
    #[test]
    fn units_do_not_matter(scene in scenarios(), powers in [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64]) {
        let [length, stress, time] = powers.map(|power| 10f64.powf(power));
        let (grid, shape) = (&scene.grid, Arc::clone(&scene.shape));
        let steps = scene.steps.iter().map(|&(dt, load)| match load {
            Load::Force { normal, tilt } => (dt * time, Load::Force { normal: normal * stress * length * length, tilt }),
            other => (dt, other),
        });
        let other = Scenario {
            grid: Grid::new(grid.cells(), grid.lengths().map(|side| side * length)).unwrap(),
            shape: Arc::new(FnGeometry::new(move |x1, x2| length * shape.initial_gap(x1 / length, x2 / length))),
            creep: scene.creep.scaled(1.0 / stress).unwrap().slowed(time).unwrap(),
            steps: steps.collect(),
        };
        let (one, other) = (end(&scene, tight()), other.run(tight()).unwrap());
        let (pressure, displacement) = (field(other.pressure(), 1.0 / stress), field(other.fields().displacement(), 1.0 / length));
        assert_ends_like(&one, &pressure, &displacement, other.approach() / length)?;
    }

    /// Turned over along either axis, or the axes exchanged.
    #[test]
    fn mirrored_scenes_have_mirrored_answers(scene in scenarios(), turn in [any::<bool>(), any::<bool>()], exchange in any::<bool>()) {
        let sign = turn.map(|turn| if turn { -1.0 } else { 1.0 });
        let shape = Arc::clone(&scene.shape);
        let mut other = reshaped(&scene, move |x1, x2| {
            let [a, b] = if exchange { [x2, x1] } else { [x1, x2] };
            shape.initial_gap(sign[0] * a, sign[1] * b)
        });
        let ([n1, n2], [l1, l2]) = (scene.grid.cells(), scene.grid.lengths());
        if exchange {
            other.grid = Grid::new([n2, n1], [l2, l1]).unwrap();
        }
        let (one, other) = (end(&scene, tight()), other.run(tight()).unwrap());
        let place = |i: usize, j: usize| {
            let (i, j) = (if turn[0] { n1 - 1 - i } else { i }, if turn[1] { n2 - 1 - j } else { j });
            if exchange { j * n1 + i } else { i * n2 + j }
        };
        let back = |field: &[f64]| (0..n1 * n2).map(|k| field[place(k / n2, k % n2)]).collect::<Vec<_>>();
        assert_ends_like(&one, &back(other.pressure()), &back(other.fields().displacement()), other.approach())?;
    }

    /// On a wider grid, off the middle by whole cells.
    #[test]
    fn shifted_scenes_have_shifted_answers(scene in scenarios(), shift in [-4_i32..=4, -4_i32..=4]) {
        let ([n1, n2], spacing) = (scene.grid.cells(), scene.grid.spacing());
        let by = [0, 1].map(|axis| f64::from(shift[axis]) * spacing[axis]);
        let wide = [n1 + 8, n2 + 8];
        let moved = Scenario {
            grid: Grid::new(wide, [0, 1].map(|axis| wide[axis] as f64 * spacing[axis])).unwrap(),
            shape: Arc::new(Shifted::new(Arc::clone(&scene.shape), by).unwrap()),
            ..scene.clone()
        };
        let (one, other) = (end(&scene, tight()), moved.run(tight()).unwrap());
        let here = |field: &[f64]| (0..n1 * n2).map(|k| {
            let [i, j] = [(k / n2) as i32 + 4 + shift[0], (k % n2) as i32 + 4 + shift[1]];
            field[i as usize * wide[1] + j as usize]
        }).collect::<Vec<_>>();
        assert_ends_like(&one, &here(other.pressure()), &here(other.fields().displacement()), other.approach())?;
    }

    /// A gap that is wider everywhere is approached by as much more.
    #[test]
    fn a_wider_gap_is_a_longer_way(scene in scenarios(), wider in -1.0..1.0_f64) {
        let (shape, wider) = (Arc::clone(&scene.shape), wider * 1e-2 * scene.grid.lengths()[0]);
        let other = reshaped(&scene, move |x1, x2| shape.initial_gap(x1, x2) + wider);
        let (one, other) = (end(&scene, tight()), other.run(tight()).unwrap());
        let scale = one.contact.approach().abs().max(wider.abs()).max(one.displacement);
        assert_same("pressure", one.contact.pressure(), other.pressure(), one.pressure, 1e-6)?;
        assert_same("approach", &[one.contact.approach()], &[other.approach() - wider], scale, 1e-8)?;
    }

    /// With and without windows and symmetry.
    #[test]
    fn settings_choose_the_work_not_the_answer(scene in scenarios()) {
        let one = end(&scene, tight());
        let others = [
            tight().with_window(false),
            tight().with_symmetry(false),
        ];
        for settings in others {
            let other = scene.run(settings).unwrap();
            assert_ends_like(&one, other.pressure(), other.fields().displacement(), other.approach())?;
        }
    }

    /// Two bodies that creep are one body that creeps as both.
    #[test]
    fn two_creeping_bodies_are_one_of_their_sum(scene in scenarios(), share in 0.05..0.95_f64) {
        let part = |share: f64| Material::incompressible(scene.creep.scaled(share).unwrap());
        let builder = scene.builder().material(part(share)).counter_body(part(1.0 - share));
        let mut both = builder.settings(tight()).build().unwrap();
        for &(dt, load) in &scene.steps {
            both.step(dt, load).unwrap();
        }
        let one = end(&scene, tight());
        assert_ends_like(&one, both.pressure(), both.fields().displacement(), both.approach())?;
    }
}

/// Powers of two change no bit; other factors round otherwise, and iterations take other ways to the same answer.
#[test]
fn units_do_not_matter_beyond_rounding() {
    let run = |[length, modulus, time]: [f64; 3], tolerance: f64| {
        let body = Zener::new(1.0e6 * modulus, 0.5e6 * modulus, 0.5e6 * modulus * time).unwrap();
        let (ball, grid) = (Sphere::new(10.0e-3 * length).unwrap(), Grid::square(32, 4.0e-3 * length).unwrap());
        let settings = Settings::default().with_tolerance(tolerance);
        let mut contact = contact_of(&ball, grid, Material::incompressible(body), settings);
        for (dt, share) in [(0.0, 0.3), (0.1, 0.5), (0.3, 0.6), (1.0, 0.2), (0.2, 0.0), (0.1, 0.4)] {
            contact.step(dt * time, Load::force(share * modulus * length * length)).unwrap();
        }
        (field(contact.pressure(), 1.0 / modulus), contact.approach() / length)
    };
    let one = run([1.0; 3], 1e-6);
    for powers in [[-33, 0, 0], [0, -40, 0], [0, 30, 0], [27, 30, 40], [-30, -40, -40]] {
        assert!(run(powers.map(|power| 2f64.powi(power)), 1e-6) == one, "2^{powers:?} m, Pa, s");
    }
    let (pressure, approach) = run([1.0; 3], 1e-13);
    let others =
        [[1e-8, 1.0, 1.0], [1e8, 1.0, 1.0], [1.0, 1e-12, 1.0], [1.0, 1e9, 1.0], [1e-8, 1e3, 1e-9], [1e8, 1e-12, 1e9]];
    for units in others {
        let (scaled, deep) = run(units, 1e-13);
        assert!((deep / approach - 1.0).abs() < 1e-12, "{units:?}: {:e}", deep / approach - 1.0);
        let far = difference(&scaled, &pressure);
        assert!(far < 1e-11, "{units:?}: pressure {far:e}");
    }
}

/// On grids that threads share, their number changes no bit.
mod threads {
    use super::*;
    use crate::common::bodies::zener;
    use crate::common::spheres::RADIUS;
    use crate::common::sticky::ball;
    use crate::common::temporary::Temporary;
    use viscocontact::adhesion::ExponentialAttraction;

    fn on<T: Send>(threads: usize, run: impl Fn() -> T + Send + Sync) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
    }

    fn bits(contact: &ViscoelasticContact) -> Vec<u64> {
        [contact.pressure(), contact.fields().displacement()].concat().iter().map(|x| x.to_bits()).collect()
    }

    fn whole() -> Settings {
        Settings::default().with_symmetry(false).with_window(false)
    }

    /// Rows that end anywhere in a band, and so many cells that threads share the coarser levels of the extension as well.
    #[test]
    fn any_number_gives_the_same_bits_on_a_large_grid() {
        let pressed = || {
            let (shape, grid) =
                (Ellipsoid::new(RADIUS, 0.7 * RADIUS).unwrap(), Grid::new([400, 370], [8.0e-3; 2]).unwrap());
            let mut contact = contact_of(&shape, grid, zener(), whole());
            for dt in [0.0, 0.3, 0.5] {
                contact.step(dt, Load::eccentric_force(0.3, [1.0e-4, -2.0e-4])).unwrap();
            }
            bits(&contact)
        };
        let attracted = || {
            let body = Material::incompressible(GeneralizedMaxwell::new(0.25, &[(0.5, 1.0)]).unwrap());
            let law = ExponentialAttraction::new(1.0, 1.0).unwrap();
            let settings = whole().with_edge(Edge::Allow);
            let mut contact = ball(146, 8.0, body, law).settings(settings).build().unwrap();
            for approach in [0.5, 0.3, -0.2] {
                contact.step(0.3, Load::approach(approach)).unwrap();
            }
            bits(&contact)
        };
        for run in [&pressed as &(dyn Fn() -> Vec<u64> + Send + Sync), &attracted] {
            let one = on(1, run);
            assert!([2, 3, 5].into_iter().all(|threads| on(threads, run) == one));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2033), max_shrink_iters: 0, ..ProptestConfig::with_cases(4) })]

        /// Written into the same file as well, and read from it.
        #[test]
        fn any_number_gives_the_same_bits(scene in scenarios()) {
            let grid = Grid::new([192, 176], scene.grid.lengths()).unwrap();
            let fine = Scenario { grid, ..scene };
            let run = || {
                let path = Temporary::file("threads");
                let [mut contact, mut resumed] = [0; 2].map(|_| fine.builder().settings(whole()).build().unwrap());
                for (k, &(dt, load)) in fine.steps.iter().take(4).enumerate() {
                    if k < 2 { &mut contact } else { &mut resumed }.step(dt, load).unwrap();
                    if k < 2 {
                        contact.save(&path).unwrap();
                        resumed.resume(&path).unwrap();
                    }
                }
                (bits(&resumed), std::fs::read(&path).unwrap())
            };
            let one = on(1, run);
            prop_assert!(on(2, run) == one && on(3, run) == one);
        }
    }
}
