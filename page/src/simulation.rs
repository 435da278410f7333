//! A contact under its load, step by step, and what was seen of it.

use std::f64::consts::TAU;

use viscocontact::Result;
use viscocontact::contact::{Settings, StepReport};
use viscocontact::geometry::{Geometry, Sum};
use viscocontact::prelude::*;

use crate::settings::{Key, Settings as Scene};

/// What was seen after each step: one number each, and the lines and fields of `cells` or their squares.
#[derive(Debug, Default)]
pub struct Frames {
    /// Times \[s\], forces \[N\], approaches \[m\], contact areas \[m²\] and maximum pressures \[Pa\].
    pub series: [Vec<f64>; 5],
    /// Pressures \[Pa\] of all cells.
    pub pressure: Vec<Vec<f64>>,
    /// Pressures \[Pa\], displacements \[m\] and gaps \[m\] along x1 through the middle.
    pub lines: Vec<[Vec<f64>; 3]>,
}

/// Displacements \[m\] and forces \[N\] along the surface.
pub type Loop = [Vec<f64>; 2];

/// A contact under way.
#[derive(Debug)]
pub struct Simulation {
    settings: Scene,
    run: Option<Run<'static>>,
    /// Whether the depth is held.
    is_held: bool,
    /// What was seen so far.
    pub frames: Frames,
    /// The friction loop, at the end.
    pub friction: Loop,
    /// What the run says of itself.
    pub report: String,
}

fn shape(settings: &Scene, grid: &Grid) -> Result<Box<dyn Geometry>> {
    let radius = settings.get(Key::Radius);
    let rms = settings.get(Key::Roughness);
    Ok(match (settings.count(Key::Shape), rms > 0.0) {
        (0, true) => {
            let side = grid.lengths()[0];
            let spec = RoughSpec::new(0.5 * side, 4.0 * grid.spacing()[0], Roughness::RmsHeight(rms));
            let rough = Rough::new(grid, spec.with_seed(settings.count(Key::Seed) as u64))?;
            Box::new(Sum::new(Sphere::new(radius)?, rough))
        }
        (0, false) => Box::new(Sphere::new(radius)?),
        (1, _) => Box::new(Cone::new(settings.get(Key::Slope))?),
        _ => Box::new(FlatPunch::circular(radius)?),
    })
}

fn material(settings: &Scene) -> Result<Material> {
    let [g, g_k, time] = [Key::Modulus, Key::Retarded, Key::Time].map(|key| settings.get(key));
    let poisson = settings.get(Key::Poisson);
    let material = match settings.count(Key::Material) {
        0 => Material::constant_poisson(Maxwell::with_time(g, time)?, poisson),
        1 => Material::constant_poisson(Zener::with_time(g, g_k, time)?, poisson),
        2 => Material::constant_poisson(FractionalZener::new(g, g_k, time, settings.get(Key::Exponent))?, poisson),
        _ => Material::constant_poisson(Elastic::new(g)?, poisson),
    };
    let end = settings.get(Key::Duration);
    // models without an exact exponential series get one from far below a step to the end
    material?.fitted(1e-6 * end..=end, 1e-4)
}

fn history(settings: &Scene) -> Result<PiecewiseLinear> {
    let load = if settings.is_depth() { Load::approach } else { Load::force };
    let mut table: Vec<_> = settings.load().map(|(time, value)| (time, load(value))).collect();
    // one point is a load that is held
    table.extend(
        table.first().filter(|_| table.len() == 1).map(|&(time, load)| (time + settings.get(Key::Duration), load)),
    );
    PiecewiseLinear::new(&table)
}

/// The end of the run as the load has it, or of its first part if the depth is held from then on.
fn first_end(settings: &Scene) -> f64 {
    let (hold, end) = (settings.get(Key::Hold), settings.get(Key::Duration));
    if hold > 0.0 { hold.min(end) } else { end }
}

fn stepping(settings: &Scene) -> Stepping {
    Stepping::fixed(settings.get(Key::Duration) / settings.get(Key::Steps))
}

/// What the crate refuses, with the remedy that the page has.
fn told(error: Error) -> String {
    let text = error.to_string();
    match text.split_once(": enlarge the grid, ") {
        Some((what, _)) => format!("{what}: enlarge the side of the grid"),
        None => text,
    }
}

impl Simulation {
    /// At rest.
    ///
    /// # Errors
    /// What the settings or the crate refuse.
    pub fn new(settings: &Scene) -> std::result::Result<Simulation, String> {
        settings.check()?;
        Simulation::built(settings).map_err(told)
    }

    fn built(settings: &Scene) -> Result<Simulation> {
        let grid = Grid::square(settings.count(Key::Cells), settings.get(Key::Side))?;
        let shape = shape(settings, &grid)?;
        // far below what is seen: rounding, which differs between processors, does not choose how often steps iterate
        let solver = Settings::default().with_tolerance(1e-10);
        let material = material(settings)?;
        let builder = ViscoelasticContact::builder(grid).geometry(&*shape).material(material);
        let contact = builder.settings(solver).build()?;
        let run = contact.into_follow(history(settings)?, stepping(settings), first_end(settings));
        Ok(Simulation {
            settings: settings.clone(),
            run: Some(run),
            is_held: false,
            frames: Frames::default(),
            friction: Loop::default(),
            report: String::new(),
        })
    }

    /// Takes one step; false at the end.
    ///
    /// # Errors
    /// Why a step failed. What was seen before stays.
    pub fn advance(&mut self) -> std::result::Result<bool, String> {
        self.advanced().map_err(told)
    }

    fn advanced(&mut self) -> Result<bool> {
        let Some(run) = &mut self.run else { return Ok(false) };
        if let Some(report) = run.next_step()? {
            self.frames.record(run.contact(), &report)?;
            self.report = format!("{report}\n{}", run.error_budget());
            return Ok(true);
        }
        let end = self.settings.get(Key::Duration);
        if let Some(run) = self.run.take_if(|run| !self.is_held && run.contact().time() < end) {
            let contact = run.into_contact();
            let held = StepLoad::new(Load::approach(contact.approach()))?;
            self.run = Some(contact.into_follow(held, stepping(&self.settings), end));
            self.is_held = true;
            return self.advanced();
        }
        self.run = None;
        if self.settings.get(Key::Friction) > 0.0 {
            self.friction = friction(&self.settings)?;
        }
        Ok(false)
    }
}

impl Frames {
    fn record(&mut self, contact: &ViscoelasticContact, report: &StepReport) -> Result<()> {
        let fields = contact.fields();
        let seen = [report.time, report.force, report.approach, contact.contact_area(), fields.max_pressure()];
        self.series.iter_mut().zip(seen).for_each(|(series, value)| series.push(value));
        self.pressure.push(contact.pressure().to_vec());
        let line = fields.profile(Axis::X1, 0.0)?;
        self.lines.push([line.pressure, line.displacement, line.gap]);
        Ok(())
    }
}

/// The same load on a smooth body that is moved to and fro along the surface besides, on elastic states.
fn friction(settings: &Scene) -> Result<Loop> {
    let radius = settings.get(Key::Radius);
    let states = match settings.count(Key::Shape) {
        0 => ElasticStates::sphere(radius)?,
        1 => ElasticStates::cone(settings.get(Key::Slope))?,
        _ => ElasticStates::punch(radius)?,
    };
    let (amplitude, period) = (settings.get(Key::Amplitude), settings.get(Key::Period));
    let motion = FnHistory::new(move |time: f64| Load::approach(amplitude * (TAU * time / period).sin()));
    let mut contact = StatesContact::new(&states, &material(settings)?)?
        .with_estimated_friction(settings.get(Key::Friction))?
        .sheared_by(motion)?;
    let end = settings.get(Key::Duration);
    // a cycle in at least 100 steps
    let step = (end / settings.get(Key::Steps)).min(0.01 * period);
    let mut points = Loop::default();
    let pressed = history(settings)?;
    follow(&mut contact, &pressed, step, first_end(settings), &mut points)?;
    if contact.time() < end {
        let held = StepLoad::new(Load::approach(contact.approach()))?;
        follow(&mut contact, &held, step, end, &mut points)?;
    }
    Ok(points)
}

fn follow(contact: &mut StatesContact, load: &dyn LoadHistory, step: f64, end: f64, points: &mut Loop) -> Result<()> {
    let mut run = contact.follow(load, Stepping::fixed(step), end);
    while run.next_step()?.is_some() {
        points[0].push(run.contact().lateral_displacement());
        points[1].push(run.contact().lateral_force());
    }
    Ok(())
}
