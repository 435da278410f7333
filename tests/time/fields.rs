//! Pressures to an accuracy: of runs in space at any time, and of contacts on elastic states.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use viscocontact::contact::Edge;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact::states::{Reach, Sweep};

use crate::common::random_histories::{Control, FromSmallLoad};
use crate::common::{
    Draws, Features, RADIUS, Ratios, Scene, Temporary, builder_of, figures, from_environment, maxwell, sphere_on,
};
use crate::io::numbers_of;

fn ball() -> ViscoelasticContact {
    sphere_on(Grid::square(32, 4.0e-3).unwrap(), maxwell(), Settings::default())
}

/// Ends of given steps: graded after and before each of the knots, and evenly between. `FIELD_FINE` makes so many times as many.
fn fine_times(scene: &Scene, asked: &[f64], ratio: f64) -> Vec<f64> {
    let until = scene.body.until;
    let mut knots: Vec<f64> = scene.moments();
    knots.extend(scene.history.corners.iter().copied().chain(asked.iter().copied()).chain([0.0, until]));
    knots.retain(|time| (0.0..=until).contains(time));
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|a, b| *a - *b < 1e-9 * until);
    // an error of the level counts as many times as the bodies creep
    let fine = if scene.body.creep_ratio() > 100.0 { 4 } else { 1 } * from_environment("FIELD_FINE", 1) as u32;
    let (count, ratio) = (400 * fine, ratio.powf(1.0 / f64::from(fine)));
    let mut times: Vec<f64> = (1..count).map(|k| until * f64::from(k) / f64::from(count)).collect();
    for pair in knots.windows(2) {
        let mut off = 1e-6 * (pair[1] - pair[0]);
        while off < 0.5 * (pair[1] - pair[0]) {
            times.extend([pair[0] + off, pair[1] - off]);
            off *= ratio;
        }
    }
    let near = |time: f64| knots.iter().any(|knot| (knot - time).abs() < 1e-9 * until);
    times.retain(|&time| !near(time));
    times.extend(knots.into_iter().filter(|time| *time > 0.0));
    times.sort_by(f64::total_cmp);
    times
}

struct Field {
    time: f64,
    pressure: Vec<f64>,
}

/// The pressures at the asked times, after jumps, by given fine steps, and the greatest force.
fn truth(scene: &Scene, load: &dyn LoadHistory, asked: &[f64]) -> Option<(Vec<Field>, f64)> {
    let mut contact = scene.contact(1e-8);
    let (mut fields, mut greatest) = (Vec::new(), 0.0_f64);
    contact.step(0.0, load.at(0.0)).ok()?;
    for time in fine_times(scene, asked, 1.2) {
        contact.step(time - contact.time(), load.before(time)).ok()?;
        greatest = greatest.max(contact.force());
        if load.at(time) != load.before(time) {
            contact.step(0.0, load.at(time)).ok()?;
            greatest = greatest.max(contact.force());
        }
        if asked.contains(&time) {
            fields.push(Field { time, pressure: contact.pressure().to_vec() });
        }
    }
    Some((fields, greatest))
}

/// L1 over what was asked, L2 over the field and the greatest error over the greatest pressure likewise, the estimate over the truth, and
/// elastic contacts.
#[derive(Default)]
struct Population {
    /// Least error over what was asked that is compared with its estimate.
    least: f64,
    over: Ratios,
    squares: Ratios,
    most: Ratios,
    told: Ratios,
    contacts: Ratios,
    apart: usize,
}

/// Three random times of a scene.
fn asked_of(scene: &Scene, seed: u64, number: u64) -> Vec<f64> {
    let mut draws = Draws::new(seed.wrapping_mul(7919).wrapping_add(number));
    let mut asked: Vec<f64> = (0..3).map(|_| draws.between(0.02, 1.0) * scene.body.until).collect();
    asked.sort_by(f64::total_cmp);
    asked
}

impl Population {
    /// Compares the samples of a run with the truth.
    fn compare(
        &mut self,
        scene: &Scene,
        load: &dyn LoadHistory,
        asked: &[f64],
        accuracy: f64,
        (fields, greatest): &(Vec<Field>, f64),
    ) {
        let mut contact = scene.contact(1e-6);
        let run = contact.follow(load, Stepping::adaptive(accuracy), scene.body.until);
        let mut run = run.sample_at(asked).unwrap().fields_to(accuracy).unwrap();
        let (mut found, area) = (0, scene.grid().cell_area());
        while run.next_step().unwrap_or_else(|error| panic!("{}: {error}", scene.name)).is_some() {
            for sample in run.samples() {
                let sample = sample.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
                let exact = fields.iter().find(|field| field.time == sample.contact().time());
                let Some((report, exact)) = sample.field().zip(exact) else { continue };
                found += 1;
                let size = (exact.pressure.iter().sum::<f64>() * area).max(0.01 * greatest);
                // before anything has pressed no error is known
                let nothing_yet = report.error.is_none() && exact.pressure.iter().all(|pressure| *pressure == 0.0);
                if size == 0.0 || nothing_yet {
                    assert!(sample.fields().pressure().iter().all(|pressure| *pressure == 0.0));
                    self.apart += 1;
                    continue;
                }
                let off: Vec<f64> =
                    exact.pressure.iter().zip(sample.fields().pressure()).map(|(a, b)| (a - b).abs()).collect();
                let over = off.iter().sum::<f64>() * area / size / accuracy;
                let greatest = |field: &[f64]| field.iter().copied().fold(0.0, f64::max);
                let squares = |field: &[f64]| field.iter().map(|p| p * p).sum::<f64>().sqrt();
                if size == exact.pressure.iter().sum::<f64>() * area {
                    self.squares.push(squares(&off) / squares(&exact.pressure) / accuracy, &scene.name);
                    self.most.push(greatest(&off) / greatest(&exact.pressure) / accuracy, &scene.name);
                }
                let (told, name) = (report.error.unwrap_or(f64::NAN) / accuracy, &scene.name);
                assert!(told >= 0.0, "{name} at {:.3e}", exact.time);
                let is_low = over > self.least && told < over / 3.0;
                if over > 1.5 || is_low {
                    println!("{over:.2} told {told:.2} at {:.3e}: {name}", exact.time);
                }
                self.over.push(over, name);
                if over > self.least {
                    self.told.push(told / over, name);
                }
                self.contacts.push(report.elastic_contacts as f64, name);
            }
        }
        assert!(found >= asked.len(), "{}: {found}", scene.name);
    }

    /// Number of estimates below a third of the truth.
    fn low(&self) -> usize {
        self.told.count() - self.told.above(1.0 / 3.0)
    }

    fn print(&self, what: &str) {
        println!("{what}, {} apart", self.apart);
        self.over.print("L1 over asked", 0);
        self.squares.print("L2 over asked", 0);
        self.most.print("greatest over asked", 0);
        self.told.print("estimate over truth", 0);
        println!("  estimate below a third of the truth: {}", self.low());
        self.contacts.print("elastic contacts", 0);
    }
}

/// Random scenes; bodies that creep up to 100-fold, and 1000-fold.
fn population(seed: u64, scenes: u64, accuracy: f64) -> [Population; 2] {
    let mut all = [(); 2].map(|()| Population { least: 0.1, ..Population::default() });
    let first = from_environment("FIELD_FIRST", 0);
    for number in first..first + scenes {
        let kinds = [Features::ANY, Features::PERIODIC, Features::SPRING, Features::RETURNING];
        // every other fourth is periodic
        let features = kinds[if number % 8 == 1 { 0 } else { number as usize % 4 }];
        let scene = Scene::draw(seed, number, features);
        let (asked, ratio) = (asked_of(&scene, seed, number), scene.body.creep_ratio());
        let Some(exact) = (ratio <= 1000.0).then(|| truth(&scene, scene.load(), &asked)).flatten() else { continue };
        all[usize::from(ratio > 100.0)].compare(&scene, scene.load(), &asked, accuracy, &exact);
    }
    all
}

/// FIELD_SCENES=300 FIELD_SEED=1 are the figures of the documents.
#[test]
fn fields_of_runs_are_as_exact_as_asked() {
    let scenes = from_environment("FIELD_SCENES", 5);
    for (accuracy, most) in [(1e-2, 10.0), (1e-3, 30.0)] {
        let all = population(from_environment("FIELD_SEED", 1), scenes, accuracy);
        for (some, creep) in all.iter().zip(["up to 100-fold", "up to 1000-fold"]) {
            some.print(&format!("accuracy {accuracy:.0e}, creep {creep}"));
            assert!(some.over.above(3.0) == 0 && 100 * some.low() <= some.told.count());
        }
        let beyond = all[0].over.above(2.0);
        assert!(100 * beyond <= all[0].over.count(), "{beyond} fields are beyond twice what was asked");
        let contacts = &all[0].contacts;
        // a few scenes have no median to speak of
        assert!(scenes < 8 || contacts.count() as u64 > scenes && contacts.median() <= most);
    }
}

/// Contacts on elastic states: few levels and kept pressures against a contact in space in the same steps.
#[test]
fn fields_of_states_are_as_exact_as_asked() {
    for accuracy in [1e-2, 1e-3] {
        let (mut few, mut kept) = (Ratios::default(), Ratios::default());
        for number in 0..from_environment("FIELD_STATES", 4) {
            let (mut draws, grid) = (Draws::new(number), Grid::square(16, 1.0).unwrap());
            let spec = RoughSpec::new(0.5, 0.2, Roughness::RmsHeight(draws.between(0.001, 0.01)));
            let rough = Sum::new(Sphere::new(1.0).unwrap(), Rough::new(&grid, spec.with_seed(number)).unwrap());
            let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-8);
            let sweep = Sweep::new(grid, &rough).settings(settings).accuracy(accuracy).keep_pressures();
            let states = sweep.run(Reach::Level(0.03)).unwrap();
            assert!(states.interpolation_error() <= accuracy);
            let terms: Vec<_> = (0..3).map(|_| (draws.between(0.1, 1.0), draws.power_of_ten(-2.0, 1.0))).collect();
            let material = Material::incompressible(GeneralizedMaxwell::new(draws.between(0.2, 1.0), &terms).unwrap());
            let (top, by_force) = (states.approach(0.015), draws.chance(0.5));
            let most = 0.01 / material.contact_compliance(2.0);
            let mut contact = StatesContact::new(&states, &material).unwrap().with_linear_steps();
            let settings = settings.with_time_rule(TimeRule::ExponentialLinear);
            let builder = builder_of(&rough, contact.states().grid().unwrap().clone(), material.clone());
            let mut stepper = builder.settings(settings).build().unwrap();
            for step in 1..=200 {
                let t = 0.01 * f64::from(step);
                let part = (0.2 + 0.5 * t - 0.35 * (2.0 * t).sin()).clamp(0.05, 1.0);
                let load = if by_force { Load::force(part * most) } else { Load::approach(part * top) };
                contact.step(0.01, load).unwrap();
                stepper.step(0.01, load).unwrap();
                if step % 50 != 0 || contact.is_separated() {
                    continue;
                }
                let exact = stepper.pressure();
                let off = |field: &[f64]| {
                    let sum: f64 = exact.iter().zip(field).map(|(a, b)| (a - b).abs()).sum();
                    sum / exact.iter().sum::<f64>() / accuracy
                };
                few.push(off(contact.fields(accuracy).unwrap().fields().pressure()), "");
                kept.push(off(&contact.pressure().unwrap()), "");
            }
        }
        few.print("few levels", 0);
        kept.print("kept pressures", 0);
        assert!(few.count() > 8 && few.greatest() < 1.2 && kept.greatest() < 2.0);
    }
}

/// A group of levels that has relaxed to nothing keeps its place in the pressure.
#[test]
fn relaxed_levels_press_no_more() {
    let (grid, settings) = (Grid::square(32, 4.0e-3).unwrap(), Settings::default().with_tolerance(1e-8));
    let sweep =
        Sweep::new(grid.clone(), &Sphere::new(RADIUS).unwrap()).settings(settings).accuracy(1e-3).keep_pressures();
    let states = sweep.run(Reach::Approach(6.0e-5)).unwrap();
    let mut contact = StatesContact::new(&states, &maxwell()).unwrap();
    for (dt, depth) in [(0.0, 2.0e-5), (100.0, 2.0e-5), (0.0, 4.0e-5), (1.0, 5.0e-5)] {
        contact.step(dt, Load::approach(depth)).unwrap();
        let force = contact.pressure().unwrap().iter().sum::<f64>() * grid.cell_area();
        assert!((force - contact.force()).abs() <= 1e-3 * contact.force() + 1e-12, "{force:e} {:e}", contact.force());
    }
}

/// Where elastic contacts give the fields the steps stay as they are, bitwise; a jump has the field before it and after it; bodies apart
/// have none.
#[test]
fn fields_leave_the_steps_as_they_are() {
    let force = Load::force;
    let rows = [(0.0, force(0.1)), (1.0, force(0.4)), (1.0, force(0.2)), (2.0, force(0.2)), (2.0, force(0.0))];
    let history = PiecewiseLinear::new(&rows).unwrap();
    let run = |fields: bool| {
        let mut contact = ball();
        let mut run = contact.follow(&history, Stepping::adaptive(1e-2), 3.0).sample_at([0.5, 1.0, 2.5]).unwrap();
        run = if fields { run.fields_to(1e-2).unwrap() } else { run };
        let (mut reports, mut sums) = (Vec::new(), Vec::new());
        while let Some(report) = run.next_step().unwrap() {
            reports.push(report);
            for sample in run.samples().map(Result::unwrap).filter(|sample| fields && sample.is_asked_for()) {
                let of_step = run.contact().force();
                assert!(sample.field().is_some_and(|field| field.error.is_some_and(|error| error <= 1e-2)));
                sums.push((sample.contact().time(), sample.fields().force(), of_step));
            }
        }
        assert_eq!(run.error_budget().field.is_some(), fields);
        (reports, sums)
    };
    let (plain, (reports, sums)) = (run(false).0, run(true));
    assert_eq!(plain, reports);
    let forces: Vec<f64> = sums.iter().map(|sum| sum.1).collect();
    assert_eq!(forces.len(), 4, "{sums:?}");
    for (force, expected) in forces.iter().zip([0.25, 0.4, 0.2, 0.0]) {
        assert!((force - expected).abs() <= 1e-6, "{forces:?}");
    }
}

/// A run that is resumed from a file has the same fields.
#[test]
fn fields_are_found_again_after_a_resumption() {
    let history = Ramp::new(Load::force(0.05), Load::force(0.5), 0.5).unwrap();
    let file = Temporary::file("fields");
    let fields_of = |steps: usize, resumes: bool| {
        let (mut contact, mut found) = (ball(), Vec::new());
        if resumes {
            contact.resume(&*file).unwrap();
        }
        let run = contact.follow(&history, Stepping::adaptive(1e-2), 2.0).sample_at([0.3, 0.8, 1.9]).unwrap();
        let mut run = run.fields_to(1e-3).unwrap();
        for _ in 0..steps {
            if run.next_step().unwrap().is_none() {
                break;
            }
            let asked = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
            found.extend(asked.map(|sample| (sample.contact().time(), sample.fields().pressure().to_vec())));
        }
        if !resumes && steps < usize::MAX {
            run.save(&*file).unwrap();
        }
        found
    };
    let (whole, mut parts) = (fields_of(usize::MAX, false), fields_of(4, false));
    assert!(!parts.is_empty() && parts.len() < 3, "{}", parts.len());
    parts.extend(fields_of(usize::MAX, true));
    assert!(whole.len() == 3 && parts.len() == 3);
    for (part, whole) in parts.iter().zip(&whole) {
        let off: f64 = part.1.iter().zip(&whole.1).map(|(a, b)| (a - b).abs()).sum();
        assert!(part.0 == whole.0 && off <= 1e-5 * whole.1.iter().sum::<f64>(), "{off:e}");
    }
}

/// A load whose point moves, or whose tilts turn.
#[derive(Debug)]
struct Turning<'a> {
    load: &'a dyn LoadHistory,
    /// Farthest distance of the point \[m\], or greatest tilt, turns per second and at t = 0.
    most: f64,
    rate: f64,
    turned: f64,
    is_free: bool,
}

impl Turning<'_> {
    fn turned(&self, load: Load, t: f64) -> Load {
        let at = self.most * (std::f64::consts::TAU * (self.rate * t + self.turned)).sin();
        let tilt = [at, -0.3 * at].map(|at| if self.is_free { Tilt::Free { at } } else { Tilt::Fixed(at) });
        match load {
            Load::Force { normal, .. } => Load::Force { normal, tilt },
            Load::Approach { approach, .. } => Load::Approach { approach, tilt },
            Load::Spring { stiffness, drive, .. } => Load::Spring { stiffness, drive, tilt },
            other => other,
        }
    }
}

impl LoadHistory for Turning<'_> {
    fn at(&self, t: f64) -> Load {
        self.turned(self.load.at(t), t)
    }

    fn before(&self, t: f64) -> Load {
        self.turned(self.load.before(t), t)
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.load.next_breakpoint(after)
    }
}

/// Bodies that are surely apart have no pressure. Where they may touch, and nothing has pressed yet, no error is known.
#[test]
fn no_error_of_zero_is_told_at_the_first_touch() {
    let mut contact = ball();
    let touch = contact.approach();
    let rows = [(0.0, -1e-5), (1.0, 0.0), (3.0, 2e-5)].map(|(time, depth)| (time, Load::approach(touch + depth)));
    let history = PiecewiseLinear::new(&rows).unwrap();
    let run = contact.follow(&history, Stepping::adaptive(1e-2), 3.0).sample_at([0.5, 1.0, 2.0]).unwrap();
    let (mut run, mut told) = (run.fields_to(1e-2).unwrap(), Vec::new());
    while run.next_step().unwrap().is_some() {
        let asked = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
        told.extend(asked.map(|sample| sample.field().and_then(|field| field.error)));
    }
    assert!(matches!(told[..], [Some(0.0), None, Some(error)] if 0.0 < error && error < 1e-2), "{told:?}");
}

/// Tilts that turn, load points that move, surfaces that attract each other and elastic contacts that shrink as their load grows, as under
/// loads far aside: graded steps, and an estimate by steps twice as long.
#[test]
fn fields_without_states_are_found_by_graded_steps() {
    let (seed, scenes) = (from_environment("FIELD_SEED", 1), from_environment("FIELD_TURNS", 20));
    let first = from_environment("FIELD_FIRST", 0);
    for accuracy in [1e-2, 1e-3] {
        // errors less than 1e-4 are compared with no estimate
        let mut all = [(); 4].map(|()| Population { least: 1e-4 / accuracy, ..Population::default() });
        for number in first..first + scenes {
            let kind = [0, 1, 3, 2][number as usize % 4];
            let features = if kind == 2 { Features::ANY.attracted() } else { Features::ANY };
            let scene = Scene::draw(seed + 17, number, features);
            let (asked, mut draws) = (asked_of(&scene, seed, number), Draws::new(number));
            let is_free = kind % 2 == 1;
            if scene.body.creep_ratio() > 100.0 || is_free && !matches!(scene.control, Control::Force(_)) {
                continue;
            }
            let least = Load::force(if let Control::Force(force) = scene.control { 0.01 * force } else { 0.0 });
            let pressed = is_free.then(|| FromSmallLoad::new(scene.load(), least, scene.body.until));
            let (most, rate) = (if is_free { 3e-4 } else { 0.03 }, draws.between(0.2, 1.5) / scene.body.until);
            let (rate, turned) = if kind == 3 { (0.0, 0.25) } else { (rate, 0.0) };
            let load = pressed.as_ref().map_or(scene.load(), |pressed| pressed as &dyn LoadHistory);
            let turning = Turning { load, most: draws.scale(0.1 * most, most), rate, turned, is_free };
            let load: &dyn LoadHistory = if kind == 2 { scene.load() } else { &turning };
            let Some(exact) = truth(&scene, load, &asked) else { continue };
            all[kind].compare(&scene, load, &asked, accuracy, &exact);
        }
        for (some, what) in all.iter().zip(["tilts that turn", "load points that move", "attraction", "loads aside"]) {
            some.print(&format!("accuracy {accuracy:.0e}, {what}"));
            assert!(some.over.above(2.0) == 0 && 10 * some.low() <= some.told.count().max(10));
        }
    }
}

/// A flag that is set while a field is looked for ends the search, beside elastic contacts and by finer steps; the field is found when it is asked
/// for again.
#[test]
fn a_flag_ends_the_search_for_a_field() {
    let load = Ramp::new(Load::approach(0.0), Load::approach(20.0e-6), 1.0).unwrap();
    let turning = Turning { load: &load, most: 0.02, rate: 0.4, turned: 0.0, is_free: false };
    let loads: [&dyn LoadHistory; 2] = [&load, &turning];
    for load in loads {
        let fields = |cancels: bool| {
            let (mut contact, flag) = (ball(), Arc::new(AtomicBool::new(false)));
            let run = contact.follow(load, Stepping::adaptive(0.1), 1.0).sample_at([0.7, 1.0]).unwrap();
            let mut run = run.fields_to(1e-3).unwrap().cancelled_by(Arc::clone(&flag));
            let (mut found, mut cancelled) = (Vec::new(), 0);
            while run.next_step().unwrap().is_some() {
                flag.store(cancels, Ordering::Relaxed);
                cancelled += run.samples().filter(|sample| matches!(sample, Err(Error::Cancelled { .. }))).count();
                flag.store(false, Ordering::Relaxed);
                let asked = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
                found.extend(asked.map(|sample| sample.fields().pressure().to_vec()));
            }
            (found, cancelled)
        };
        let ((plain, none), (again, cancelled)) = (fields(false), fields(true));
        assert!(plain.len() == 2 && again.len() == 2 && none == 0 && cancelled > 0, "{none} {cancelled}");
        for (one, other) in plain.iter().zip(&again) {
            // to the accuracy of both: contacts on the curve stay there
            let off: f64 = one.iter().zip(other).map(|(one, other)| (one - other).abs()).sum();
            assert!(off <= 2e-3 * one.iter().sum::<f64>(), "{off}");
        }
    }
}

/// A plate on an elastic foundation bends away from the middle of its contact, which shrinks there while the load grows: no levels give its fields.
#[test]
fn fields_of_contacts_that_shrink_are_found_by_graded_steps() {
    let (mut errors, mut told) = (Ratios::default(), Ratios::default());
    for number in 0..from_environment("FIELD_PLATES", 3) {
        let (mut draws, grid, ball) = (Draws::new(number), Grid::square(48, 1.0).unwrap(), Sphere::new(1.5).unwrap());
        let length = draws.between(0.05, 0.08);
        let plate = move |q1: f64, q2: f64| 1.0 / (1.0 + (length * f64::hypot(q1, q2)).powi(4)) + 1e-4;
        let kernel = std::sync::Arc::new(InfluenceKernel::from_spectrum(&grid, plate).unwrap());
        let terms =
            [(draws.between(2.0, 8.0), draws.between(0.2, 1.0)), (draws.between(2.0, 8.0), draws.between(1.0, 9.0))];
        let material = Material::incompressible(GeneralizedMaxwell::new(1.0, &terms).unwrap());
        let (level, until) = (draws.scale(8e-4, 2e-3), 3.0);
        let force = level / material.contact_compliance(until);
        let sweep = Sweep::new(grid.clone(), &ball).kernel(std::sync::Arc::clone(&kernel)).accuracy(1e-2);
        let sweep = sweep.run(Reach::Level(level));
        assert!(matches!(sweep, Err(Error::Shrinks { .. })), "{sweep:?}");
        let contact = |tolerance: f64| {
            let builder = builder_of(&ball, grid.clone(), material.clone()).kernel(std::sync::Arc::clone(&kernel));
            builder.settings(Settings::default().with_edge(Edge::Allow).with_tolerance(tolerance)).build().unwrap()
        };
        let history = Ramp::new(Load::force(0.1 * force), Load::force(force), 1.0).unwrap();
        let asked = [0.4, 1.0, draws.between(1.2, until)];
        let mut times: Vec<f64> = (1..=600).map(|k| until * f64::from(k) / 600.0).chain(asked).collect();
        times.extend([0.0, 1.0].iter().flat_map(|corner| (1..40).map(move |k| corner + 0.3 * 0.7f64.powi(k))));
        times.extend(asked.iter().flat_map(|end| (1..40).map(move |k| end - 0.3 * 0.7f64.powi(k))));
        times.sort_by(f64::total_cmp);
        times.dedup_by(|a, b| *a - *b < 1e-9);
        let (mut exact, mut fields) = (contact(1e-8), Vec::new());
        exact.step(0.0, history.at(0.0)).unwrap();
        for time in times {
            exact.step(time - exact.time(), history.at(time)).unwrap();
            fields.extend(asked.iter().any(|end| (end - time).abs() < 1e-9).then(|| exact.pressure().to_vec()));
        }
        for accuracy in [1e-2, 1e-3] {
            let (mut contact, mut found) = (contact(1e-6), 0);
            let run = contact.follow(&history, Stepping::adaptive(accuracy), until).sample_at(asked).unwrap();
            let mut run = run.fields_to(accuracy).unwrap();
            while run.next_step().unwrap().is_some() {
                for sample in run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for()) {
                    let off = fields[found].iter().zip(sample.fields().pressure()).map(|(a, b)| (a - b).abs());
                    let over = off.sum::<f64>() / fields[found].iter().sum::<f64>() / accuracy;
                    let field = sample.field().unwrap();
                    assert_eq!(field.elastic_contacts, 0);
                    errors.push(over, "");
                    told.push(field.error.unwrap() / accuracy / over.max(0.1), "");
                    found += 1;
                }
            }
            assert_eq!(found, asked.len());
        }
    }
    errors.print("L1 over asked", 0);
    told.print("estimate over truth", 0);
    let (beyond, low) = (errors.above(2.0), told.count() - told.above(1.0 / 3.0));
    assert!(
        errors.count() >= 18 && 20 * beyond <= errors.count() && errors.greatest() < 6.0 && 10 * low <= told.count(),
        "{beyond} {low}"
    );
}

/// States within steps, frames and maps of random scenes have the field that was asked for, bitwise where it is written.
#[test]
fn what_follows_a_run_has_its_fields() {
    use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
    use viscocontact::plot::Map;

    let (accuracy, mut followed) = (1e-2, 0);
    for number in 0..from_environment("FIELD_FOLLOWED", 8) {
        let kinds = [Features::ANY, Features::PERIODIC, Features::SPRING, Features::RETURNING];
        let scene = Scene::draw(from_environment("FIELD_SEED", 1) + 5, number, kinds[number as usize % 4]);
        let (asked, name) = (asked_of(&scene, 3, number), &scene.name);
        let turning =
            Turning { load: scene.load(), most: 0.01, rate: 1.0 / scene.body.until, turned: 0.0, is_free: false };
        let load: &dyn LoadHistory = if number % 8 > 3 { &turning } else { scene.load() };
        let exact = (scene.body.creep_ratio() <= 100.0).then(|| truth(&scene, load, &asked)).flatten();
        let Some((fields, greatest)) = exact else { continue };
        let (mut contact, folder) = (scene.contact(1e-6), Temporary::folder("followed"));
        let (metadata, wanted) = (Metadata::new("fields"), [Field::Pressure]);
        let mut series =
            FrameSeries::create(&*folder, Format::Npz, &metadata, &contact, &wanted, Earlier::Refuse).unwrap();
        let run = contact.follow(load, Stepping::adaptive(accuracy), scene.body.until);
        let mut run = run.sample_at(&asked[..]).unwrap().fields_to(accuracy).unwrap();
        while run.next_step().unwrap().is_some() {
            for sample in run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for()) {
                let (shown, time) = (sample.fields(), sample.contact().time());
                let exact = &fields.iter().find(|field| field.time == time).unwrap().pressure;
                let frame = numbers_of(&series.record(shown).unwrap(), "pressure");
                // cells out of contact are blank in a map
                let map = Map::of(shown, Field::Pressure).unwrap();
                let drawn: Vec<f64> = map.values().iter().map(|p| if p.is_nan() { 0.0 } else { *p }).collect();
                assert!(frame == shown.pressure() && drawn == frame, "{name}");
                let size = exact.iter().sum::<f64>().max(0.01 * greatest / scene.grid().cell_area());
                let within = run.fields_within_step(time).unwrap();
                for field in [&frame[..], within.fields().pressure()] {
                    let off: f64 = exact.iter().zip(field).map(|(a, b)| (a - b).abs()).sum();
                    assert!(off <= 2.0 * accuracy * size, "{name} at {time}: {:e}", off / size);
                }
                followed += 1;
            }
        }
    }
    println!("{followed} fields were followed");
    assert!(followed > 10);
}

/// Convolutions of a field at the end over the convolutions of a run for the motions alone, on 64² cells.
#[test]
fn a_field_costs_little_over_its_run() {
    let history = Ramp::new(Load::force(0.05), Load::force(0.5), 0.5).unwrap();
    let fractional = FractionalZener::relaxing(1.0e6, 1.0e5, 0.1, 0.4).unwrap();
    let bodies = [
        ("Maxwell", maxwell()),
        ("Zener", Material::incompressible(Zener::relaxing(1.0e6, 0.1e6, 0.5).unwrap())),
        (
            "three relaxation times",
            Material::incompressible(
                GeneralizedMaxwell::new(0.1e6, &[(0.4e6, 0.01), (0.3e6, 0.3), (0.2e6, 10.0)]).unwrap(),
            ),
        ),
        ("fractional Zener", Material::incompressible(fractional).fitted(1e-6..=3.0, 1e-3).unwrap()),
        ("Kelvin-Voigt", Material::incompressible(KelvinVoigt::with_time(0.5e6, 1.0).unwrap())),
    ];
    let mut table = String::from("| body | 3e-2 | 1e-2 | 3e-3 | 1e-3 |\n|---|---|---|---|---|");
    for (name, material) in bodies {
        let jumps = material.contact_compliance(0.0) > 0.0;
        let slow = Ramp::new(Load::force(0.0), Load::force(0.5), 0.5).unwrap();
        let history = if jumps { &history } else { &slow };
        let mut row = Vec::new();
        for accuracy in [3e-2, 1e-2, 3e-3, 1e-3] {
            let grid = Grid::square(64, 5.0e-3).unwrap();
            let builder = ViscoelasticContact::builder(grid).geometry(&Sphere::new(RADIUS).unwrap());
            let mut contact = builder.material(material.clone()).build().unwrap();
            let run = contact.follow(history, Stepping::adaptive(accuracy), 2.0);
            let mut run = run.sample_at([2.0]).unwrap().fields_to(accuracy).unwrap();
            let (mut of_run, mut of_field) = (0, None);
            while let Some(report) = run.next_step().unwrap() {
                of_run += report.convolutions;
                let last = run.samples().last().unwrap().unwrap();
                of_field = last.field().map(|field| field.convolutions).or(of_field);
            }
            let cost = of_field.unwrap() as f64 / of_run as f64;
            assert!(cost < 5.0, "{name} {accuracy}: {cost}");
            row.push(format!("{cost:.1}"));
        }
        table += &format!("\n| {name} | {} |", row.join(" | "));
    }
    println!("{table}");
    figures::figure("what a field costs", &table).unwrap();
}
