//! Plans of random scenes. Balls, cones, ellipsoids and punches, in the middle or aside, under steps, ramps, holds and sines of
//! force and approach are compared with their equivalent foundation of independent springs; bodies that tilt, and those on other
//! bodies than the half-space, with a finer run. `PLANS`, `PLANS_FIRST` and `PLANS_SEED` choose how many scenes and which,
//! `PLANS_CELLS` the side of the largest mesh that is run.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use viscocontact::analytic::{Hertz, HertzEllipse};
use viscocontact::prelude::*;

use crate::common::random_bodies::{Body, random_body};
use crate::common::{Draws, RADIUS, Ratios, builder_of, from_environment};

const SLOPE: f64 = 0.05;
const PUNCH: f64 = 1.0e-3;
/// Modulus at once [Pa]: E* is four times that.
const MODULUS: f64 = 1.0e6;
/// Greatest work of planning over the work of the run, in the median, in convolutions times cells.
const MOST_PLANNING: f64 = 3.0;

#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    Ball,
    Cone,
    Ellipsoid(f64),
    Punch,
}

impl Shape {
    fn geometry(self) -> Box<dyn Geometry> {
        match self {
            Shape::Ball => Box::new(Sphere::new(RADIUS).unwrap()),
            Shape::Cone => Box::new(Cone::new(SLOPE).unwrap()),
            Shape::Ellipsoid(other) => Box::new(Ellipsoid::new(RADIUS, other).unwrap()),
            Shape::Punch => Box::new(FlatPunch::circular(PUNCH).unwrap()),
        }
    }

    /// States in closed form, and what multiplies its approach, its pressure and its contact radius. Ellipses of contact
    /// keep their shape: they behave as the sphere whose contact radius is their semi-axis a.
    pub(super) fn states(self) -> (Arc<ElasticStates>, [f64; 3]) {
        match self {
            Shape::Ball => (ElasticStates::sphere(RADIUS).unwrap(), [1.0; 3]),
            Shape::Cone => (ElasticStates::cone(SLOPE).unwrap(), [1.0; 3]),
            Shape::Punch => (ElasticStates::punch(PUNCH).unwrap(), [1.0; 3]),
            Shape::Ellipsoid(other) => {
                let ellipse = HertzEllipse::new([RADIUS, other], 4.0 * MODULUS, 1.0).unwrap();
                let [a, b] = ellipse.semi_axes;
                let radius = a.powi(3) * 4.0 * MODULUS / 0.75;
                let sphere = Hertz::new(radius, 4.0 * MODULUS, 1.0).unwrap();
                (ElasticStates::sphere(radius).unwrap(), [ellipse.approach / sphere.approach, a / b, (b / a).sqrt()])
            }
        }
    }

    /// Pressure at the distance `r` from the axis of the elastic contact of unit compliance.
    pub(super) fn pressure(self, elastic: &ElasticStates, level: f64, r: f64) -> f64 {
        let a = 0.5 * elastic.stiffness(level);
        match self {
            _ if r >= a => 0.0,
            Shape::Cone => 0.5 * SLOPE * (a / r).acosh(),
            _ => 2.0 / PI * elastic.approach(level) / a * (1.0 - (r / a).powi(2)).sqrt(),
        }
    }

    /// Approach and force of elastic bodies of a compliance whose contact is as large as a circle of this radius.
    fn elastic(self, radius: f64, compliance: f64) -> [f64; 2] {
        match self {
            Shape::Ball => [radius * radius / RADIUS, radius.powi(3) / (0.75 * RADIUS * compliance)],
            Shape::Cone => {
                let depth = 0.5 * std::f64::consts::PI * SLOPE * radius;
                [depth, depth * radius / compliance]
            }
            Shape::Ellipsoid(other) => {
                let unit = HertzEllipse::new([RADIUS, other], 1.0 / compliance, 1.0).unwrap();
                let force = (radius / unit.semi_axes[0]).powi(3);
                [unit.approach * force.powf(2.0 / 3.0), force]
            }
            Shape::Punch => [0.02 * PUNCH, 0.04 * PUNCH * PUNCH / compliance],
        }
    }
}

pub(super) type Kernel = Box<dyn Fn(&Grid) -> Result<InfluenceKernel, Error>>;

/// Another body than the half-space: its kernel, and the period along both axes or the length of a line, if it has one.
pub(super) struct Other {
    pub(super) kernel: Kernel,
    pub(super) period: Option<f64>,
    pub(super) line: Option<f64>,
}

pub(super) struct Scene {
    pub(super) name: String,
    /// The shape of the foundation that is the reference, if there is one.
    pub(super) shape: Option<Shape>,
    pub(super) geometry: Box<dyn Geometry>,
    pub(super) other: Option<Other>,
    pub(super) material: Material,
    pub(super) history: Box<dyn LoadHistory>,
    pub(super) until: f64,
    pub(super) by_force: bool,
    pub(super) accuracy: Accuracy,
    /// Whether the area is promised, too.
    pub(super) area: bool,
    /// How far the shape is aside of the load \[m\].
    pub(super) aside: f64,
    /// Creep ratio, and kind of the history.
    pub(super) ratio: f64,
    pub(super) kind: usize,
}

/// A step, a ramp, a ramp that is held or a wave over `until` seconds; its name and kind.
pub(super) fn history(
    draws: &mut Draws,
    full: &dyn Fn(f64) -> Load,
    until: f64,
) -> (usize, String, Box<dyn LoadHistory>) {
    let (kind, part) = (draws.below(4), draws.power_of_ten(-1.5, 0.0));
    let (low, period) = (draws.between(0.2, 0.8), until / draws.between(0.3, 3.0));
    let (name, history): (_, Box<dyn LoadHistory>) = match kind {
        0 => ("step".into(), Box::new(StepLoad::new(full(1.0)).unwrap())),
        1 => ("ramp".into(), Box::new(Ramp::new(full(0.0), full(1.0), until * 1.001).unwrap())),
        2 => (format!("ramp and hold ({part:.2})"), Box::new(Ramp::new(full(0.0), full(1.0), part * until).unwrap())),
        _ if low < 0.28 => ("triangle".into(), Box::new(Periodic::triangle(full(low), full(1.0), period).unwrap())),
        _ if low < 0.35 => ("square".into(), Box::new(Periodic::square(full(1.0), full(low), period, 0.5).unwrap())),
        _ => ("sine".into(), Box::new(Sinusoid::new(full(low), full(1.0), period.recip()).unwrap())),
    };
    (kind, name, history)
}

pub(super) fn accuracy(draws: &mut Draws) -> Accuracy {
    if draws.chance(0.7) { Accuracy::COARSE } else { Accuracy::STANDARD }
}

/// A body that answers at once and creeps up to 1000-fold.
fn body(draws: &mut Draws) -> Body {
    loop {
        let body = random_body(draws);
        if body.is_elastic_at_once() && (1.1..1e3).contains(&body.creep_ratio()) {
            return body;
        }
    }
}

pub(super) fn scene(seed: u64, number: u64) -> Scene {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_003).wrapping_add(number));
    let shape = match draws.below(4) {
        0 => Shape::Ball,
        1 => Shape::Cone,
        2 => Shape::Ellipsoid(RADIUS * draws.power_of_ten(-1.0, 1.0)),
        _ => Shape::Punch,
    };
    let body = body(draws);
    let (ratio, until) = (body.creep_ratio(), body.until);
    let (body, material) = (body.name, body.material);
    let radius = draws.power_of_ten(-4.0, -2.8);
    let by_force = draws.chance(0.5);
    let [depth, force] = shape.elastic(radius, material.contact_compliance(until));
    let full = |share: f64| if by_force { Load::force(share * force) } else { Load::approach(share * depth) };
    let (kind, history_name, history) = history(draws, &full, until);
    let accuracy = accuracy(draws);
    // a punch aside of the load tilts, and sinks in as much in its middle
    let most = if matches!(shape, Shape::Punch) { 0.8 * PUNCH } else { f64::INFINITY };
    let aside = if draws.chance(0.3) { f64::min(draws.between(0.1, 2.0) * radius, most) } else { 0.0 };
    let area = draws.chance(0.3);
    let (geometry, history): (Box<dyn Geometry>, _) = match shape {
        Shape::Punch if aside > 0.0 && by_force => {
            let at = [aside.min(0.3 * PUNCH), 0.0];
            let held = Box::new(StepLoad::new(Load::eccentric_force(force, at)).unwrap()) as Box<dyn LoadHistory>;
            (shape.geometry(), held)
        }
        _ if aside > 0.0 => (Box::new(Shifted::new(shape.geometry(), [aside, -0.3 * aside]).unwrap()), history),
        _ => (shape.geometry(), history),
    };
    let by = if by_force { "force" } else { "approach" };
    let name = format!(
        "{seed}:{number} {shape:?} {aside:.1e} m aside, {body} ×{ratio:.1}, {history_name} of {by}, {until:.1e} s, \
         {accuracy:?}, area {area}"
    );
    let other = None;
    Scene {
        name,
        shape: Some(shape),
        geometry,
        other,
        material,
        history,
        until,
        by_force,
        accuracy,
        area,
        aside,
        ratio,
        kind,
    }
}

/// A ball or a punch that is turned while it is pressed.
fn tilting(seed: u64, number: u64) -> Scene {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_003).wrapping_add(number).wrapping_add(1 << 40));
    let (ratio, by_force) = (draws.power_of_ten(0.1, 2.0), draws.chance(0.5));
    let creep = [((ratio - 1.0) / MODULUS, draws.power_of_ten(-2.0, 0.3))];
    let material = Material::incompressible(GeneralizedKelvin::new(1.0 / MODULUS, 0.0, &creep).unwrap());
    let (geometry, loads): (Box<dyn Geometry>, [Load; 3]) = if by_force {
        let [first, second] = [draws.between(0.0, 1e-3), draws.between(0.0, 5e-4)];
        let face = FlatPunch::rectangular([1.0e-3, draws.power_of_ten(-3.5, -2.5)]).unwrap();
        let loads = [(1.0, [0.0; 2]), (1.0, [first, 0.0]), (0.5, [0.0, second])];
        (Box::new(face), loads.map(|(force, tilt)| Load::force_and_tilt(force, tilt)))
    } else {
        let (tilt, end) = (draws.between(-0.05, 0.05), draws.between(0.8, 1.2));
        let loads = [(0.3, [0.0; 2]), (1.0, [tilt, 0.0]), (end, [0.0, 0.02])];
        let ball = Sphere::new(RADIUS).unwrap();
        (Box::new(ball), loads.map(|(depth, tilt)| Load::approach_and_tilt(1.0e-4 * depth, tilt)))
    };
    let table: Vec<_> = [0.0, 0.45, 1.0].into_iter().zip(loads).collect();
    let (history, name) =
        (PiecewiseLinear::new(&table).unwrap(), format!("{seed}:{number} tilting, creep ×{ratio:.1}"));
    let (history, accuracy) = (Box::new(history), Accuracy::COARSE);
    let (shape, until, area, aside, kind) = (None, 1.0, draws.chance(0.3), 0.0, 1);
    Scene { name, shape, geometry, other: None, material, history, until, by_force, accuracy, area, aside, ratio, kind }
}

/// Approach (force where the approach is given) and contact radius √(area/π); `None` where they are not known.
type State = [Option<f64>; 2];
/// The state at each time, and the greatest pressure of the run.
type Truth = (Vec<State>, Option<f64>);

/// By the states of a shape in closed form.
fn of_states(scene: &Scene, shape: Shape, times: &[f64]) -> Truth {
    let (elastic, [approaches, pressures, radii]) = shape.states();
    let punch = matches!(shape, Shape::Punch);
    let mut contact = StatesContact::new(&elastic, &scene.material).unwrap();
    // steps are graded after the start: pressures may be greatest early
    let parts = from_environment("PLANS_FINE", 1) as u32;
    let log_spaced = |k: u32| scene.until * 10f64.powf(-6.0 + 6.0 * f64::from(k) / f64::from(240 * parts));
    let mut fine: Vec<f64> = (0..240 * parts).map(log_spaced).collect();
    fine.extend((1..=400 * parts).map(|k| scene.until * f64::from(k) / f64::from(400 * parts)));
    fine.extend(times.iter().copied().chain([0.0]));
    let mut breakpoint = scene.history.next_breakpoint(0.0);
    while let Some(at) = breakpoint.filter(|&at| at <= scene.until) {
        let since = |k: u32| (scene.until - at) * 10f64.powf(-5.0 + 0.25 * f64::from(k) / f64::from(parts));
        fine.extend((0..20 * parts).map(|k| at + since(k)));
        fine.push(at);
        breakpoint = scene.history.next_breakpoint(at);
    }
    fine.retain(|&time| time <= scene.until);
    fine.sort_by(f64::total_cmp);
    fine.dedup();
    let (mut states, mut highest) = (Vec::new(), 0.0_f64);
    for time in fine {
        // up to a jump, and over it
        let [before, after] = [scene.history.before(time), scene.history.at(time)];
        for load in [before].into_iter().chain((after != before).then_some(after)) {
            let load = match load {
                Load::Approach { approach, .. } => Load::approach(approach / approaches),
                // an eccentric force leaves the approach of the middle as it is
                Load::Force { normal, .. } => Load::force(normal),
                load => panic!("{load:?}"),
            };
            contact.step(time - contact.time(), load).unwrap();
        }
        let edge = (contact.contact_area() / PI).sqrt();
        if times.contains(&time) {
            let main = if scene.by_force { approaches * contact.approach() } else { contact.force() };
            // under a given approach bodies part at a time that no plan promises
            let grows = scene.by_force && !punch;
            states.push([Some(main), grows.then_some(radii * edge)]);
        }
        if !punch {
            let pressure = |k: f64| {
                let r = edge * (1.0 - 10f64.powf(-0.15 * k));
                pressures * contact.superposed(|level| shape.pressure(&elastic, level, r))
            };
            let of_all: Vec<f64> = (0..24).map(|k| pressure(f64::from(k))).collect();
            let best = (0..24).max_by(|&a, &b| of_all[a].total_cmp(&of_all[b])).unwrap();
            highest = highest.max(of_all[best]);
            if best > 0 && of_all[best] > 0.97 * highest {
                let near = (-4..=4).map(|part| pressure(best as f64 + 0.2 * f64::from(part)));
                highest = near.fold(highest, f64::max);
            }
        }
    }
    (states, (!punch).then_some(highest))
}

/// By a run on cells of half the side or a third, in finer steps.
fn of_finer_run(scene: &Scene, plan: &Plan, times: &[f64]) -> Result<Truth, Error> {
    let finer = if scene.by_force && scene.other.is_none() { 3 } else { 2 };
    let cells = plan.grid.cells().map(|cells| if cells == 1 { 1 } else { finer * cells });
    let grid = Grid::new(cells, plan.grid.lengths()).unwrap();
    let mut builder = builder_of(&scene.geometry, grid.clone(), scene.material.clone());
    if let Some(other) = &scene.other {
        builder = builder.kernel((other.kernel)(&grid)?);
    }
    let mut contact = builder.settings(Settings::default().with_tolerance(1e-7)).build()?;
    let stepping = Stepping::adaptive(0.036 * scene.accuracy.target());
    let run = contact.follow(&scene.history, stepping, scene.until).stop_at(times)?;
    let (mut states, highest) = ends_of(scene, run)?;
    states.retain(|(time, _)| times.contains(time));
    Ok((states.into_iter().map(|(_, state)| state).collect(), Some(highest)))
}

/// The states at the ends of steps, of several at a time the last, and the greatest pressure.
fn ends_of(scene: &Scene, mut run: Run<'_, ViscoelasticContact>) -> Result<(Vec<(f64, State)>, f64), Error> {
    let (mut states, mut highest) = (Vec::<(f64, _)>::new(), 0.0_f64);
    while let Some(report) = run.next_step()? {
        states.pop_if(|(time, _)| *time == report.time);
        let [main, radius] = observed(scene, run.contact());
        // the radius of a few cells is not known
        states.push((report.time, [main, radius.filter(|_| !report.warnings.contains(Warnings::FEW_CELLS))]));
        highest = highest.max(run.contact().fields().max_pressure());
    }
    Ok((states, highest))
}

fn observed(scene: &Scene, contact: &ViscoelasticContact) -> State {
    let main = if scene.by_force { contact.approach() } else { contact.force() };
    // contact on other bodies is no ellipse
    [Some(main), scene.other.is_none().then(|| (contact.contact_area() / PI).sqrt())]
}

/// True errors over what was asked: of approach or force, of the contact radius, and of the greatest pressure if that is
/// promised.
struct Outcome {
    over: [Option<f64>; 3],
    /// Work of planning over the work of the run.
    ratio: f64,
    promises: bool,
    /// Radii of a finer run that the planned one is compared with, and those that are left out, of few cells.
    radii: [usize; 2],
    note: String,
}

fn deliver(scene: &Scene, limit: usize) -> Result<Outcome, Error> {
    let Scene { geometry, other, material, history, until, accuracy, .. } = scene;
    let started = Instant::now();
    let mut work = 0.0;
    let mut builder = Plan::builder(geometry, material, history, *until).accuracy(*accuracy).area(scene.area);
    if let Some(Other { kernel, period, line }) = other {
        builder = builder.kernel(kernel);
        builder = period.map_or(builder, |period| builder.period(Axis::X1, period).period(Axis::X2, period));
        builder = line.map_or(builder, |length| builder.line(length));
    }
    let plan = builder.build_with(|progress| {
        work = progress.work;
        ControlFlow::Continue(())
    })?;
    let ratio = work / (plan.convolutions * plan.grid.len() as f64);
    let planning = started.elapsed().as_secs_f64();
    let note = format!("{plan}; planned in {planning:.2} s, {ratio:.2} of the work of the run");
    if plan.grid.len() > limit * limit {
        return Ok(Outcome { over: [None; 3], ratio, promises: plan.pressure_converges(), radii: [0; 2], note });
    }
    let mut contact = plan.builder.clone().build()?;
    let (states, highest) = ends_of(scene, contact.follow(history, plan.stepping, *until).stop_at(&plan.stops[..])?)?;
    let (times, states): (Vec<f64>, Vec<_>) = states.into_iter().unzip();
    let (truth, peak) = match scene.shape {
        Some(shape) => of_states(scene, shape, &times),
        None => of_finer_run(scene, &plan, &times)?,
    };
    assert_eq!(truth.len(), states.len());
    let is_by_run = scene.shape.is_none() && other.is_none();
    let radii =
        [true, false].map(|known| truth.iter().filter(|state| is_by_run && state[1].is_some() == known).count());
    let in_time = plan.time_error.filter(|_| other.is_none());
    let asked = accuracy.target().max(in_time.unwrap_or(0.0));
    let promised = [asked, asked.max(0.5 * plan.mesh_error.area)];
    let error = |which: usize| {
        let greatest = truth.iter().filter_map(|truth| truth[which]).map(f64::abs).fold(0.0, f64::max);
        let pairs = states.iter().zip(&truth).filter_map(|(state, truth)| Some((state[which]?, truth[which]?)));
        let worst = pairs.map(|(found, exact)| (found - exact).abs() / greatest).reduce(f64::max)?;
        Some(worst / promised[which])
    };
    let pressure = peak.map(|peak| (highest / peak - 1.0).abs() / asked);
    let [main, radius, promised] = [error(0), error(1), pressure.filter(|_| plan.pressure_converges())];
    let show = |value: Option<f64>| value.map_or("-".into(), |over| format!("{over:.2}"));
    let note = format!("main {}, radius {}, pressure {}; {note}", show(main), show(radius), show(pressure));
    Ok(Outcome { over: [main, radius, promised], ratio, promises: plan.pressure_converges(), radii, note })
}

/// Whether the shape meets nothing at any approach of the history, as 400² points over ten times the width of any contact show.
fn stays_apart(scene: &Scene) -> bool {
    let approach = |k: u32| match scene.history.at(f64::from(k) / 1000.0) {
        Load::Approach { approach, .. } => approach,
        _ => f64::INFINITY,
    };
    let deepest = (0..=1000).map(approach).fold(f64::NEG_INFINITY, f64::max);
    let places = (0..400 * 400).map(|k| [k / 400, k % 400].map(|k| 0.005 * (f64::from(k) - 199.5)));
    places.into_iter().all(|[x1, x2]| scene.geometry.initial_gap(x1, x2) > deepest)
}

/// Plans the scenes, and runs those on at most `limit`² cells.
pub(super) fn keep_their_promise(scenes: impl Iterator<Item = Scene>, limit: u64) {
    let limit = from_environment("PLANS_CELLS", limit) as usize;
    let (mut failed, mut delivered, mut ratios, mut radii) = (vec![], [0; 3], Ratios::default(), [0; 2]);
    for scene in scenes {
        match deliver(&scene, limit) {
            // a tilting punch needs more cells than a plan allows
            Err(Error::CountOutOfRange { .. }) if scene.shape.is_none() && scene.other.is_none() && scene.by_force => {}
            // a rough tip may stay above the body
            Err(Error::NoDomain { .. }) if scene.other.is_some() && stays_apart(&scene) => {}
            Err(error) => failed.push(format!("{}: {error}", scene.name)),
            Ok(Outcome { over, ratio, radii: own, note, .. }) => {
                radii.iter_mut().zip(own).for_each(|(count, own)| *count += own);
                ratios.push(ratio, &scene.name);
                println!("{}: {note}", scene.name);
                delivered.iter_mut().zip(over).for_each(|(count, over)| *count += usize::from(over.is_some()));
                if over.iter().flatten().any(|&over| over > 2.0) {
                    failed.push(format!("{}: {over:.2?}, {note}", scene.name));
                }
            }
        }
    }
    let ([run, radius, pressure], count) = (delivered, ratios.count());
    println!(
        "{run} of {count} plans run, {radius} with a contact radius, {pressure} with the greatest pressure promised"
    );
    let [known, of_few] = radii;
    println!("{known} radii of finer runs known, {of_few} of few cells");
    ratios.print("planning over the run", 3);
    assert!(failed.is_empty(), "{} of {count} plans:\n{}", failed.len(), failed.join("\n"));
    assert!(run > 0, "no plan was run");
    assert!(of_few <= known / 10, "{of_few} radii of few cells, {known} known");
    // a few scenes have no median to speak of
    assert!(ratios.count() < 8 || ratios.quantile(0.5) <= MOST_PLANNING, "{}", ratios.quantile(0.5));
}

#[test]
fn plans_of_random_scenes_keep_their_promise() {
    let [seed, first] = [("PLANS_SEED", 1), ("PLANS_FIRST", 0)].map(|(name, default)| from_environment(name, default));
    let scenes = (first..first + from_environment("PLANS", 12)).flat_map(|number| {
        [Some(scene(seed, number)), (number % 4 == 0).then(|| tilting(seed, number))].into_iter().flatten()
    });
    keep_their_promise(scenes, 150);
}

/// A rim that joins in long steps, seen by cells before the greatest pressure; contacts that are small for long on a body that creeps a thousandfold;
/// tips of cones whose first contacts are a cell or two wide.
#[test]
fn plans_of_rims_of_few_cells_and_of_tips_keep_their_promise() {
    let number = 1 << 20;
    keep_their_promise(
        [(number + 1, 67), (5, 165), (5, 162), (7, 57)].into_iter().map(|(seed, number)| scene(seed, number)),
        250,
    );
}

/// Balls and ellipsoids on bodies that creep up to 30-fold: most plans promise the greatest pressure, and no promise is off by more than
/// twice. `PROMISES` chooses how many plans.
#[test]
fn plans_promise_the_greatest_pressure_of_smooth_shapes() {
    let (seed, count) = (from_environment("PLANS_SEED", 1), from_environment("PROMISES", 12));
    let is_smooth =
        |scene: &Scene| scene.ratio <= 30.0 && matches!(scene.shape, Some(Shape::Ball | Shape::Ellipsoid(_)));
    let scenes = (0..).map(|number| scene(seed.wrapping_add(1 << 20), number)).filter(is_smooth);
    let (mut promised, mut kept, mut off) = ([[0; 2]; 4], 0, Vec::new());
    for scene in scenes.take(count as usize) {
        let Outcome { over, note, promises, .. } =
            deliver(&scene, 150).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        promised[scene.kind][usize::from(promises)] += 1;
        println!("{}: {note}", scene.name);
        kept += usize::from(over[2].is_some());
        off.extend(over[2].filter(|over| *over > 2.0).map(|over| format!("{over:.1}: {}", scene.name)));
    }
    println!("not promised and promised, of steps, ramps, ramps and holds, sines: {promised:?}; {kept} compared");
    assert!(off.is_empty() && kept > 0, "{off:#?}");
    // a few scenes have no share to speak of
    let [not, yes] = [0, 1].map(|which| promised[1..].iter().map(|kind| kind[which]).sum::<u64>());
    assert!(
        if count >= 40 { yes >= 4 * not } else { yes > not },
        "{not} of {} ramps and sines are not promised",
        not + yes
    );
}
