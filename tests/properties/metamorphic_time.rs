//! What must hold between the answers of related scenes, whatever the scene: over time, and in motion.

use super::related::{assert_ends_like, assert_same, difference, end, tight};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::laws::Scenario;
use viscocontact::laws::strategies::scenarios;
use viscocontact::motion::{Straight, Travel};
use viscocontact::prelude::*;

/// Force and approach, pressure and displacement at the start and the end of each step of a run.
struct Record {
    force: Vec<f64>,
    approach: Vec<f64>,
    /// Σ over the cells of the mean pressure times the rise of the displacement, times the area \[J\].
    work: Vec<f64>,
}

/// The rule whose steps use only their own ends.
fn linear() -> Settings {
    tight().with_time_rule(TimeRule::ExponentialLinear)
}

/// Takes `steps`, and records them.
fn record(scene: &Scenario, steps: &[(f64, Load)]) -> Record {
    let settings = tight().with_edge(Edge::Allow);
    let mut contact = scene.builder().settings(settings).build().unwrap();
    let mut record = Record { force: vec![0.0], approach: vec![contact.approach()], work: Vec::new() };
    for &(dt, load) in steps {
        let (pressure, displacement) = (contact.pressure().to_vec(), contact.fields().displacement().to_vec());
        let report = contact.step(dt, load).unwrap();
        let now = contact.pressure().iter().zip(contact.fields().displacement());
        let before = pressure.iter().zip(&displacement);
        let work: f64 = now.zip(before).map(|((q, w), (p, u))| 0.5 * (p + q) * (w - u)).sum();
        record.force.push(report.force);
        record.approach.push(report.approach);
        record.work.push(work * contact.grid().cell_area());
    }
    record
}

/// The approach by which the first step of a scene presses, a scale for depths.
fn depth(scene: &Scenario) -> f64 {
    let mut contact = scene.builder().settings(tight()).build().unwrap();
    let start = contact.approach();
    let (dt, load) = scene.steps[0];
    (contact.step(dt, load).unwrap().approach - start).max(1e-9 * scene.grid.lengths()[0])
}

/// The time in which things happen \[s\].
fn time(scene: &Scenario) -> f64 {
    scene.creep.terms().iter().map(|term| term.1).fold(scene.duration(), f64::max).max(1e-3)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2041), max_shrink_iters: 64, ..ProptestConfig::with_cases(250) })]

    /// What is done later happens later.
    #[test]
    fn waiting_changes_nothing(scene in scenarios(), wait in 0.01..10.0_f64) {
        let one = end(&scene, tight());
        let mut late = scene.clone();
        late.steps.insert(0, (wait * time(&scene), Load::force(0.0)));
        let other = late.run(tight()).unwrap();
        assert_ends_like(&one, other.pressure(), other.fields().displacement(), other.approach())?;
        prop_assert!((other.time() - one.contact.time() - late.steps[0].0).abs() <= 1e-12 * other.time());
    }

    /// Followed along a table of its loads, a scene is the one that is stepped, by a rule that treats no corner differently.
    #[test]
    fn following_is_stepping(scene in scenarios()) {
        let mut table = vec![(0.0, scene.steps[0].1)];
        let mut stepped = scene.builder().settings(linear()).build().unwrap();
        stepped.step(0.0, scene.steps[0].1).unwrap();
        for &(dt, load) in scene.steps[1..].iter().filter(|step| step.0 > 0.0) {
            stepped.step(dt, load).unwrap();
            table.push((stepped.time(), load));
        }
        prop_assume!(table.len() > 1);
        let history = PiecewiseLinear::new(&table).unwrap();
        let mut followed = scene.builder().settings(linear()).build().unwrap();
        let mut run = followed.follow(&history, Stepping::fixed(2.0 * stepped.time()), stepped.time());
        let mut steps = 0;
        while run.next_step().unwrap().is_some() {
            steps += 1;
        }
        prop_assert!(steps >= table.len() - 1);
        prop_assert_eq!(followed.time(), stepped.time());
        assert_same("pressure", stepped.pressure(), followed.pressure(), end(&scene, linear()).pressure, 1e-6)?;
    }

    /// The bodies take more than they give back: at no time have they returned more than was done to them, and over a closed
    /// cycle of the approach the force has done work. Equal steps of either.
    #[test]
    fn bodies_dissipate(scene in scenarios(), deep in 0.2..2.0_f64, dt in 0.01..1.0_f64, steps in 2_usize..5, cycles in 1_usize..3) {
        let (dt, start) = (dt * time(&scene), scene.builder().build().unwrap().approach());
        let deep = deep * depth(&scene);
        let triangle = (1..=steps).chain((0..steps).rev()).map(|k| deep * k as f64 / steps as f64);
        let triangle: Vec<_> = triangle.map(|way| (dt, Load::approach(start + way))).collect();
        let record = record(&scene, &triangle.repeat(cycles));
        let size: f64 = record.work.iter().map(|work| work.abs()).sum();
        let mut done = 0.0;
        for work in &record.work {
            done += work;
            prop_assert!(done >= -1e-7 * size, "{:e} J of {:e} J", done, size);
        }
        let pairs = record.force.windows(2).zip(record.approach.windows(2));
        let pressed: Vec<f64> = pairs.map(|(f, w)| 0.5 * (f[0] + f[1]) * (w[1] - w[0])).collect();
        let size: f64 = pressed.iter().map(|work| work.abs()).sum();
        prop_assert!(pressed.iter().sum::<f64>() >= -1e-7 * size, "{:e} J of {:e} J", pressed.iter().sum::<f64>(), size);
    }

    /// Steps cut in two, and again: on a face that stays down the error in time is of second order, by the rule that
    /// continues nothing across the corners of the load.
    #[test]
    fn splitting_leaves_an_error_of_second_order(scene in scenarios(), parts in prop::collection::vec(0.2..1.0_f64, 2..4), dt in 0.02..0.15_f64) {
        let side = scene.grid.lengths().into_iter().fold(f64::INFINITY, f64::min);
        let punch = std::sync::Arc::new(FlatPunch::circular(0.3 * side).unwrap());
        // steps that resolve the fastest time
        let fastest = scene.creep.relaxation().terms().iter().map(|term| term.1).fold(f64::INFINITY, f64::min);
        let dt = dt * if fastest.is_finite() { fastest } else { time(&scene) };
        let run = |cuts: usize| {
            let (mut steps, mut force) = (vec![(0.0, Load::force(1.0))], 1.0);
            for part in &parts {
                steps.extend((1..=cuts).map(|k| (dt / cuts as f64, Load::force(force + part * k as f64 / cuts as f64))));
                force += part;
            }
            Scenario { shape: punch.clone() as _, steps, ..scene.clone() }.run(linear().with_tolerance(1e-12)).unwrap()
        };
        let [one, two, four] = [1, 2, 4].map(run);
        let (coarse, fine) = (difference(two.fields().displacement(), one.fields().displacement()), difference(four.fields().displacement(), two.fields().displacement()));
        prop_assert!(coarse < 0.05, "{coarse:e}");
        prop_assert!(fine <= coarse / 3.5 + 1e-10, "order {:.2}: {coarse:e} {fine:e}", (coarse / fine).log2());
    }
}

/// Steps over whole cells of periodic bodies: the grid moves with the indenter, or the indenter over the grid.
mod frames {
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2042), max_shrink_iters: 64, ..ProptestConfig::with_cases(250) })]

        #[test]
        fn agree(scene in scenarios(), cells in [-3_i32..=3, -3_i32..=3], dt in 0.05..1.0_f64) {
            let (grid, [n1, n2]) = (&scene.grid, scene.grid.cells());
            let kernel = std::sync::Arc::new(InfluenceKernel::periodic(grid).unwrap());
            let shape = Repeated::new(std::sync::Arc::clone(&scene.shape), grid.lengths()).unwrap();
            let dt = dt * time(&scene);
            let velocity = [0, 1].map(|axis| f64::from(cells[axis]) * grid.spacing()[axis] / dt);
            let travel = Travel::new(shape.clone(), Straight::new([0.0; 2], velocity).unwrap());
            let settings = |frame| tight().with_frame(frame).with_edge(Edge::Allow);
            let builder = scene.builder().geometry(&shape).kernel(kernel);
            let mut still = builder.clone().settings(settings(Frame::Bodies)).build().unwrap();
            let mut moving = builder.settings(settings(Frame::Indenter)).build().unwrap();
            let load = scene.steps[0].1;
            still.step(0.0, load).unwrap();
            moving.step(0.0, load).unwrap();
            for step in 1..=4_i32 {
                let along = still.step_along(&travel, dt, load).unwrap();
                moving.step_over(cells.map(|cells| cells as isize), dt, load).unwrap();
                let moved = |field: &[f64]| (0..grid.len()).map(|k| {
                    let at = |cell: usize, axis: usize, count: usize| (cell as i32 + step * cells[axis]).rem_euclid(count as i32);
                    field[at(k / n2, 0, n1) as usize * n2 + at(k % n2, 1, n2) as usize]
                }).collect::<Vec<_>>();
                assert_same("pressure", moving.pressure(), &moved(still.pressure()), 0.0, 1e-6)?;
                assert_same("displacement", moving.fields().displacement(), &moved(still.fields().displacement()), 0.0, 1e-7)?;
                assert_same("approach", &[moving.approach()], &[along.step.approach], 0.0, 1e-7)?;
                let lateral = moving.fields().slope_force(&shape);
                assert_same("lateral force", &lateral, &along.lateral_force, along.step.force, 1e-6)?;
            }
        }
    }
}
