//! Steps chosen by their error: what they deliver, what they cost, and what they may not miss.

use crate::common::histories::{Scene, scenes};
use crate::common::{Draws, RADIUS, contact_of, elastic, figures, from_environment, maxwell};
use approx::assert_abs_diff_eq;
use viscocontact::Error;
use viscocontact::analytic::GrowingSphere;
use viscocontact::prelude::*;
use viscocontact::states::{Reach, Sweep};

const CELLS: usize = 48;

/// Time, approach and force after each step, the equivalents of the whole run, and steps rejected.
struct Run {
    history: Vec<[f64; 3]>,
    work: f64,
    rejected: u64,
}

fn run(scene: &Scene, tolerance: f64, land: &[f64]) -> Run {
    let mut contact = scene.contact(CELLS, (1e-3 * tolerance).max(1e-9));
    let mut follow = contact.follow(&*scene.history, Stepping::adaptive(tolerance), scene.until).stop_at(land).unwrap();
    let (mut history, mut work) = (Vec::new(), 0.0);
    while let Some(report) = follow.next_step().unwrap() {
        assert!(report.time_error.is_some_and(|error| error <= tolerance));
        history.push([report.time, report.approach, report.force]);
        work += report.convolution_equivalents();
    }
    Run { history, work, rejected: follow.rejected_steps() }
}

/// True error in time over the one asked for: greatest error of the approach, or of the force where the approach is given,
/// relative to its greatest value, against a run with a far smaller tolerance that meets the same times.
#[test]
fn errors_are_what_was_asked_for() {
    const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];
    for scene in scenes() {
        let runs = TOLERANCES.map(|tolerance| run(&scene, tolerance, &[]));
        let times: Vec<f64> = runs.iter().flat_map(|run| run.history.iter().map(|state| state[0])).collect();
        let fine = run(&scene, 2e-6, &times);
        let greatest = [1, 2].map(|which| fine.history.iter().map(|state| state[which].abs()).fold(0.0, f64::max));
        let by_approach = scene.name.contains("approach");
        let (mut line, mut row) = (String::new(), String::new());
        for (tolerance, run) in TOLERANCES.into_iter().zip(&runs) {
            let mut worst = [0.0_f64; 2];
            for state in run.history.iter().filter(|state| state[0] > 0.0) {
                let near = fine.history.partition_point(|exact| exact[0] < state[0]);
                let exact = fine.history[near];
                assert_eq!(exact[0], state[0], "the fine run meets every time");
                for which in [0, 1] {
                    worst[which] = worst[which].max((state[which + 1] - exact[which + 1]).abs() / greatest[which]);
                }
            }
            let error = worst[usize::from(by_approach)] / tolerance;
            // twelve decades
            assert!(!scene.name.starts_with("power law") || tolerance < 1e-3 || run.history.len() <= 150, "{line}");
            line += &format!(
                "  {tolerance:e}: {} steps, {} rejected, {:.0} equivalents, error {error:.2}",
                run.history.len(),
                run.rejected,
                run.work
            );
            row += &format!(" {error:.2} ({}) |", run.history.len() as u64 + run.rejected);
            // the approach of a held force on a Maxwell body is exact whatever the steps: u is linear in C(t)
            if scene.name != "Maxwell, held" {
                assert!((0.02..2.0).contains(&error), "{} at {tolerance:e}: {error}", scene.name);
            } else {
                assert!(error < 2.0);
            }
        }
        println!("{}:{line}", scene.name);
        let name = scene.name.replace("|sin|", "abs(sin)"); // bars part the cells of a table
        figures::row("adaptive", &format!("| {name} |"), row.trim_start()).unwrap();
    }
}

/// A run that rejects steps goes on exactly as one that never tried them.
#[test]
fn rejected_steps_leave_no_trace() {
    for time_rule in [TimeRule::Exponential, TimeRule::ExponentialLinear] {
        let scene = scenes().into_iter().find(|scene| scene.name.contains("unload")).unwrap();
        let contact =
            |tolerance| scene.contact_with(32, Settings::default().with_tolerance(tolerance).with_time_rule(time_rule));
        let adaptive = |contact: &mut ViscoelasticContact, stops: &[f64]| {
            let run = contact.follow(&*scene.history, Stepping::adaptive(1e-3), scene.until);
            let (mut run, mut times) = (run.stop_at(stops).unwrap(), Vec::new());
            while let Some(report) = run.next_step().unwrap() {
                times.push(report.time);
            }
            (times, run.rejected_steps())
        };
        let mut rejecting = contact(1e-7);
        let (times, rejected) = adaptive(&mut rejecting, &[]);
        assert!(rejected > 0);
        // no step that ends where a step was accepted is too long
        let mut again = contact(1e-7);
        assert_eq!(adaptive(&mut again, &times), (times.clone(), 0));
        assert!(
            again.pressure() == rejecting.pressure()
                && again.fields().displacement() == rejecting.fields().displacement()
        );
        if time_rule == TimeRule::ExponentialLinear {
            // the same steps, fixed, follow the same rule, with the solver's tolerance of the adaptive run, which was set
            let mut given = contact(1e-7);
            let mut run = given.follow(&*scene.history, Stepping::fixed(10.0), scene.until).stop_at(&times).unwrap();
            while run.next_step().unwrap().is_some() {}
            assert!(
                given.pressure() == rejecting.pressure()
                    && given.fields().displacement() == rejecting.fields().displacement()
            );
        }
    }
}

/// Area by the gap extrapolated to the edge, against Hertz, wherever the contact lies on the mesh, also where it grows.
#[test]
fn areas_are_known_to_a_part_of_a_cell() {
    let bodies = [
        elastic(),
        maxwell(),
        Material::incompressible(Zener::with_time(1.0e6, 1.0e4, 1.0).unwrap()),
        Material::incompressible(GeneralizedKelvin::new(1.0e-8, 0.0, &[(1.0e-6, 0.1), (1.0e-6, 1.0)]).unwrap()),
    ];
    let mut rows = Vec::new();
    for (cells, places, allowed) in [(64, 12, 3e-3), (256, 3, 5e-4)] {
        let mut worst = [0.0_f64; 2];
        for (k, body) in (0..places).flat_map(|k| bodies.iter().map(move |body| (k, body))) {
            let share = |x: f64| (f64::from(k) * x).fract();
            let radius = 0.5e-3 * (0.5 + 0.25 * share(0.618));
            let side = 1.0e-3 / cells as f64;
            let sphere = Shifted::new(Sphere::new(RADIUS).unwrap(), [side * share(0.37), side * share(0.71)]).unwrap();
            let mut contact =
                contact_of(&sphere, Grid::square(cells, 1.0e-3).unwrap(), body.clone(), Settings::default());
            let under_unit_force = GrowingSphere::step(RADIUS, body, 1.0).unwrap().contact_radius(1.0);
            let load = StepLoad::new(Load::force((radius / under_unit_force).powi(3))).unwrap();
            let mut run = contact.follow(&load, Stepping::adaptive(1e-4), 1.0);
            while run.next_step().unwrap().is_some() {}
            let exact = std::f64::consts::PI * radius * radius;
            let counted = contact.contact_cells() as f64 * contact.grid().cell_area();
            for (worst, area) in worst.iter_mut().zip([contact.contact_area(), counted]) {
                *worst = worst.max((area / exact - 1.0).abs());
            }
        }
        println!("{cells}²: {:.1e}, counted cells {:.1e}", worst[0], worst[1]);
        rows.push(worst.map(|error| format!("{error:.1e}")));
        assert!(worst[0] < allowed, "{cells}: {:e}", worst[0]);
    }
    let [[coarse, counted], [fine, counted_fine]] = &rows[..] else { unreachable!() };
    figures::figure("area on 64² cells", coarse).unwrap();
    let all =
        format!("{coarse} at 64² cells and {fine} at 256²; that of counted cells is {counted} and {counted_fine}");
    figures::figure("areas", &all).unwrap();
    // a square punch ends with its cells
    let mut contact = contact_of(
        &FlatPunch::rectangular([0.5e-3, 0.25e-3]).unwrap(),
        Grid::square(64, 1.0e-3).unwrap(),
        elastic(),
        Settings::default(),
    );
    contact.step(0.0, Load::force(1.0)).unwrap();
    let exact = contact.contact_cells() as f64 * contact.grid().cell_area();
    assert_abs_diff_eq!(contact.contact_area() / exact, 1.0, epsilon = 2e-3);
}

/// A load that jumps where it names no corner, by little more than the tolerance: the step before it is shortened to the last
/// digit of the time, where it rounds to itself, and must not be tried for ever.
#[test]
fn steps_of_the_last_digit_come_to_an_end() {
    use std::sync::atomic::{AtomicU32, Ordering};
    let sphere = Sphere::new(10.0e-3).unwrap();
    let body = maxwell();
    let mut stopped = 0;
    for jump in [1.006, 1.008, 1.01, 1.012, 1.015, 1.02, 1.04, 1.2] {
        for at in [0.3, 0.0123, 0.77, 3.3e-5] {
            let asked = AtomicU32::new(0);
            let history = FnHistory::new(move |t| {
                assert!(asked.fetch_add(1, Ordering::Relaxed) < 1_000_000, "it is tried for ever");
                Load::force(if t < at { 0.5 } else { 0.5 * jump })
            });
            let mut contact = contact_of(&sphere, Grid::square(8, 4.0e-3).unwrap(), body.clone(), Settings::default());
            let mut run = contact.follow(&history, Stepping::adaptive(5e-3), 1.0);
            let end = loop {
                match run.next_step() {
                    Ok(Some(_)) => {}
                    other => break other,
                }
            };
            match end {
                Ok(_) => {}
                Err(Error::Step(StepError::StepTooShort { time, .. })) if (time / at - 1.0).abs() < 1e-9 => {
                    stopped += 1
                }
                Err(error) => panic!("{jump} at {at} s: {error}"),
            }
        }
    }
    assert!(stopped > 0);
}

/// A jump that a history names is followed at any time, on bodies that creep faster than times are resolved there.
#[test]
fn named_jumps_are_followed_however_late() {
    let grid = Grid::square(12, 4.0e-3).unwrap();
    let sphere = Sphere::new(10.0e-3).unwrap();
    let sweep = Sweep::new(grid.clone(), &sphere).accuracy(1e-5);
    let states = sweep.run(Reach::Level(4.0e-7)).unwrap();
    let (mut late, mut worst, mut unresolved) = (0, 0.0f64, 0.0f64);
    for number in 0..from_environment("LATE_JUMPS", 30) {
        let mut draws = Draws::new(number.wrapping_add(57_000_001));
        let terms: Vec<_> = (0..21).map(|k| (1.0e5 * draws.power_of_ten(-1.0, 0.0), 10.0_f64.powi(k - 10))).collect();
        let body = Material::incompressible(GeneralizedMaxwell::new(1.0e5, &terms).unwrap());
        let end = draws.power_of_ten(0.0, 9.0);
        let jump = end * draws.between(0.05, 0.95);
        let last = 4.0e-7 / body.contact_compliance(end) * 0.9;
        let (before, tolerance) = (draws.between(0.1, 0.9) * last, draws.power_of_ten(-4.0, -2.0));
        let loads = [(0.0, 0.0), (0.0, before), (jump, before), (jump, last), (end, last)];
        let history = PiecewiseLinear::new(&loads.map(|(time, force)| (time, Load::force(force)))).unwrap();
        let mut contact = contact_of(&sphere, grid.clone(), body.clone(), Settings::default().with_tolerance(1e-9));
        let mut run = contact.follow(&history, Stepping::adaptive(tolerance), end);
        let mut steps = 0;
        while let Some(report) = run.next_step().unwrap_or_else(|error| panic!("{number}, jump at {jump:e} s: {error}"))
        {
            steps += 1;
            let since = report.time - jump;
            let increase = if since > 0.0 || report.force > 0.5 * (before + last) { last - before } else { 0.0 };
            let level =
                before * body.contact_compliance(report.time) + increase * body.contact_compliance(since.max(0.0));
            let off = (report.approach / states.approach(level) - 1.0).abs();
            // the report estimates the error of steps that are not resolved
            if since > 0.0 && since < 1e3 * f64::EPSILON * jump {
                unresolved = unresolved.max(off / report.time_error.unwrap().max(tolerance));
            } else {
                worst = worst.max(off / tolerance);
            }
            assert!(steps < 3000, "{number}");
        }
        late += u32::from(jump > 1e7);
    }
    println!(
        "{late} jumps after 1e7 s; maximum error over the tolerance {worst:.2}, over the one reported {unresolved:.2}"
    );
    assert!(late > 3 && worst < 2.0 && unresolved < 4.0, "{late} {worst} {unresolved}");
}

/// A run that begins on bodies that were stepped, as after a ramp or a resumed file, keeps its tolerance: its first step
/// counts on nothing that was not seen.
#[test]
fn a_second_run_is_as_accurate_as_the_first() {
    let ball = || {
        let rubber = Zener::with_time(1.0e6, 0.5e6, 0.2).unwrap();
        let builder = ViscoelasticContact::builder(Grid::square(32, 4.0e-3).unwrap());
        builder.geometry(&Sphere::new(10.0e-3).unwrap()).material(Material::incompressible(rubber)).build().unwrap()
    };
    let load = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0).unwrap();
    let to = |contact: &mut ViscoelasticContact, stepping, until| {
        let mut run = contact.follow(&load, stepping, until);
        while run.next_step().unwrap().is_some() {}
    };
    let mut truth = ball();
    to(&mut truth, Stepping::fixed(2.0e-3), 2.0);
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let mut contact = ball();
        to(&mut contact, Stepping::adaptive(tolerance), 1.0);
        to(&mut contact, Stepping::adaptive(tolerance), 2.0);
        let error = (contact.approach() / truth.approach() - 1.0).abs();
        assert!(error < tolerance, "{error:.1e} of {tolerance:.0e}");
    }
}
