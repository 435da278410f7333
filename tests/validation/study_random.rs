//! Studies of random scenes. Balls, cones, ellipsoids and punches, in the middle or aside, under steps, ramps, holds and sines of
//! force and approach are compared with their equivalent foundation of independent springs; bodies that tilt, and those on other
//! bodies than the half-space, with a finer run. `STUDIES`, `STUDIES_FIRST` and `STUDIES_SEED` choose how many scenes and which,
//! `STUDIES_CELLS` the side of the largest mesh.

use std::f64::consts::PI;
use std::sync::Arc;

use viscocontact::analytic::{Hertz, HertzEllipse};
use viscocontact::prelude::*;
use viscocontact::study::StudyResult;

use crate::common::random_bodies::{Body, random_body};
use crate::common::{Draws, RADIUS, Ratios, builder_of, from_environment};

const SLOPE: f64 = 0.05;
const PUNCH: f64 = 1.0e-3;
/// Modulus at once [Pa]: E* is four times that.
const MODULUS: f64 = 1.0e6;

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
    pub(super) accuracy: f64,
    /// Whether the area is asked for, too.
    pub(super) area: bool,
    /// How far the shape is aside of the load \[m\].
    pub(super) aside: f64,
    /// Creep ratio.
    pub(super) ratio: f64,
}

/// A step, a ramp, a ramp that is held or a wave over `until` seconds; its name.
pub(super) fn history(draws: &mut Draws, full: &dyn Fn(f64) -> Load, until: f64) -> (String, Box<dyn LoadHistory>) {
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
    (name, history)
}

pub(super) fn accuracy(draws: &mut Draws) -> f64 {
    if draws.chance(0.7) { 1e-2 } else { 1e-3 }
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
    let (history_name, history) = history(draws, &full, until);
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
    let (history, accuracy) = (Box::new(history), 1e-2);
    let (shape, until, area, aside) = (None, 1.0, draws.chance(0.3), 0.0);
    Scene { name, shape, geometry, other: None, material, history, until, by_force, accuracy, area, aside, ratio }
}

/// Approach (force where the approach is given) and contact area; `None` where they are not known.
type State = [Option<f64>; 2];
/// The state at each time, and the greatest pressure of the run.
type Truth = (Vec<State>, Option<f64>);

/// By the states of a shape in closed form.
fn of_states(scene: &Scene, shape: Shape, times: &[f64]) -> Truth {
    let (elastic, [approaches, pressures, radii]) = shape.states();
    let punch = matches!(shape, Shape::Punch);
    let mut contact = StatesContact::new(&elastic, &scene.material).unwrap();
    // steps are graded after the start: pressures may be greatest early
    let parts = from_environment("STUDIES_FINE", 1) as u32;
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
            // under a given approach bodies part at a time that no study tells
            let grows = scene.by_force && !punch;
            states.push([Some(main), grows.then_some(PI * (radii * edge).powi(2))]);
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

/// By a run on cells of half the side, in finer steps.
fn of_finer_run(scene: &Scene, study: &StudyResult, times: &[f64]) -> Result<Truth, Error> {
    let cells = study.contact().grid().cells().map(|cells| if cells == 1 { 1 } else { 2 * cells });
    let grid = Grid::new(cells, study.contact().grid().lengths()).unwrap();
    let settings = Settings::default().with_tolerance(1e-7);
    let mut contact = scene.builder(grid, settings)?.build()?;
    let stepping = Stepping::adaptive(0.036 * scene.accuracy);
    let mut run = contact.follow(&scene.history, stepping, scene.until).stop_at(times)?;
    let (mut states, mut highest) = (Vec::<(f64, State)>::new(), 0.0_f64);
    while let Some(report) = run.next_step()? {
        states.pop_if(|(time, _)| *time == report.time);
        let contact = run.contact();
        let main = if scene.by_force { contact.approach() } else { contact.force() };
        states.push((report.time, [Some(main), Some(contact.contact_area())]));
        highest = highest.max(contact.fields().max_pressure());
    }
    states.retain(|(time, _)| times.contains(time));
    Ok((states.into_iter().map(|(_, state)| state).collect(), Some(highest)))
}

impl Scene {
    pub(super) fn builder(&self, grid: Grid, settings: Settings) -> Result<Builder, Error> {
        let kernel = self.other.as_ref().map(|other| (other.kernel)(&grid)).transpose()?;
        let builder = builder_of(&self.geometry, grid, self.material.clone()).settings(settings);
        Ok(kernel.into_iter().fold(builder, Builder::kernel))
    }

    pub(super) fn study(&self) -> Study<'_> {
        let study = Study::new(|grid, settings| self.builder(grid, settings), &self.history, self.until);
        let study = study.accuracy(self.accuracy);
        let study = if self.area { study.ask(Observable::ContactArea) } else { study };
        let Some(Other { period, line, .. }) = &self.other else { return study };
        match (period, line) {
            (Some(length), _) => study.domain([*length; 2]),
            (None, Some(length)) => study.line(*length),
            (None, None) => study,
        }
    }
}

/// True errors of approach or force, of the area and of the greatest pressure, and those that the study told.
struct Outcome {
    errors: [Option<f64>; 3],
    told: [Option<f64>; 3],
    result: StudyResult,
}

fn outcome(scene: &Scene, cells: usize) -> Result<Outcome, Error> {
    let result = scene.study().cells(cells * cells).run()?;
    let main = if scene.by_force { "approach" } else { "force" };
    // of several states at a time the last
    let mut states = Vec::<(f64, [f64; 2])>::new();
    let [values, areas] = [main, "contact area"].map(|name| result.values(name).unwrap());
    for ((&time, &main), &area) in result.times().iter().zip(values).zip(areas) {
        states.pop_if(|(last, _)| *last == time);
        states.push((time, [main, area]));
    }
    let (times, states): (Vec<f64>, Vec<_>) = states.into_iter().unzip();
    let (truth, peak) = match scene.shape {
        Some(shape) => of_states(scene, shape, &times),
        None => of_finer_run(scene, &result, &times)?,
    };
    assert_eq!(truth.len(), states.len());
    let error = |which: usize| {
        let greatest = truth.iter().filter_map(|truth| truth[which]).map(f64::abs).fold(0.0, f64::max);
        let pairs = states.iter().zip(&truth).filter_map(|(state, truth)| Some((state[which], truth[which]?)));
        pairs.map(|(found, exact)| (found - exact).abs() / greatest).reduce(f64::max)
    };
    let found = result.values("maximum pressure").unwrap()[0];
    let pressure = peak.map(|peak| (found / peak - 1.0).abs());
    let errors = [error(0), error(1), pressure];
    let told = [main, "contact area", "maximum pressure"].map(|name| result.measured(name).unwrap().error());
    Ok(Outcome { errors, told, result })
}

/// Errors over what was asked, of those that reached it.
pub(super) fn tell_their_errors(scenes: impl Iterator<Item = Scene>, limit: u64) {
    let limit = from_environment("STUDIES_CELLS", limit) as usize;
    let (mut over, mut told, mut failed) = (Ratios::default(), Ratios::default(), Vec::new());
    let (mut of_area, mut of_peak, mut reached, mut count) = (Ratios::default(), Ratios::default(), 0, 0);
    for scene in scenes {
        count += 1;
        let Outcome { errors, told: [main, area, peak], result } = match outcome(&scene, limit) {
            Ok(outcome) => outcome,
            // bodies that never touch have no domain
            Err(error) if error.code() == "no_domain" && stays_apart(&scene) => continue,
            Err(error) => {
                failed.push(format!("{}: {error}", scene.name));
                continue;
            }
        };
        let asked = scene.accuracy;
        let show = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.1e}"));
        let all = errors.iter().zip([main, area, peak]).map(|(&error, told)| format!("{} {}", show(error), show(told)));
        let all = all.collect::<Vec<_>>().join(", ");
        println!(
            "{}: {} | {:?} {} steps, {} runs, work {:.3e} | error and told: {all}",
            scene.name,
            result.ending,
            result.contact().grid().cells(),
            result.times().len(),
            result.runs,
            result.work
        );
        if from_environment("STUDIES_TABLES", 0) > 0 {
            println!("{result}");
        }
        // rounding and the solver's tolerance are no errors of the mesh
        let ratio = |told: f64, error: f64| told / error.max(0.01 * asked);
        if let Some((error, main)) = errors[0].zip(main) {
            told.push(ratio(main, error), &scene.name);
        }
        if let Some((error, area)) = errors[1].zip(area) {
            of_area.push(ratio(area, error), &scene.name);
        }
        if let Some((error, peak)) = errors[2].zip(peak) {
            of_peak.push(ratio(peak, error), &scene.name);
        }
        if result.is_converged() {
            reached += 1;
            let asked_for =
                errors.iter().zip([true, scene.area]).filter_map(|(error, is_asked)| error.filter(|_| is_asked));
            asked_for.for_each(|error| over.push(error / asked, &scene.name));
        }
    }
    println!("{reached} of {count} reached what was asked on at most {limit}² cells");
    over.print("true over asked", 5);
    told.print("told over true, of approach or force", 3);
    of_area.print("told over true, of the area", 3);
    of_peak.print("told over true, of the maximum pressure", 3);
    assert!(failed.is_empty(), "{} of {count}:\n{}", failed.len(), failed.join("\n"));
    assert!(over.count() > 0 && over.above(3.0) == 0 && over.quantile(0.99) <= 2.0, "true over asked");
    assert!(reached * 4 > count, "{reached} of {count} were reached");
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

#[test]
fn studies_of_random_scenes_tell_their_errors() {
    let [seed, first] =
        [("STUDIES_SEED", 1), ("STUDIES_FIRST", 0)].map(|(name, default)| from_environment(name, default));
    let scenes = (first..first + from_environment("STUDIES", 12)).flat_map(|number| {
        [Some(scene(seed, number)), (number % 4 == 0).then(|| tilting(seed, number))].into_iter().flatten()
    });
    tell_their_errors(scenes, 128);
}
