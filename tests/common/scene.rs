//! Whole scenes drawn at random, on small meshes: bodies, shapes, histories, and the times at which they are looked at.

use super::spheres::builder_of;
use std::sync::Arc;

use viscocontact::adhesion::{Attraction, ExponentialAttraction, LinearSoftening, VanDerWaals};
use viscocontact::contact::Builder;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

use super::draws::Draws;
use super::random_bodies::{Body, body_of_twenty_decades, random_body};
use super::random_histories::{Control, RandomHistory, random_history, taps};
use super::random_returns::{returning_body, returning_history};

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Features {
    /// Whether loads go back and return to a surface that recovers.
    pub returns: bool,
    /// Whether a spring drives the body, which taps in some scenes; else a force or a given approach.
    pub by_spring: bool,
    /// Whether the surfaces attract each other.
    pub attracts: bool,
    /// Whether a rough surface touches a periodic body, which no returning load does.
    pub periodic: bool,
}

impl Features {
    pub const ANY: Features = Features { returns: false, by_spring: false, attracts: false, periodic: false };
    pub const SPRING: Features = Features { by_spring: true, ..Features::ANY };
    pub const RETURNING: Features = Features { returns: true, ..Features::ANY };
    pub const RETURNING_BY_SPRING: Features = Features { returns: true, ..Features::SPRING };
    pub const PERIODIC: Features = Features { periodic: true, ..Features::ANY };

    /// The same of surfaces that attract each other.
    pub const fn attracted(self) -> Features {
        Features { attracts: true, ..self }
    }
}

/// What is touched.
#[derive(Debug, Clone, Copy)]
pub enum Beneath {
    HalfSpace,
    /// Periodic along both sides of the grid.
    Periodic,
    Layer(Layer),
}

impl Beneath {
    pub fn kernel(self, grid: &Grid) -> Result<InfluenceKernel, Error> {
        match self {
            Beneath::HalfSpace => InfluenceKernel::half_space(grid),
            Beneath::Periodic => InfluenceKernel::periodic(grid),
            Beneath::Layer(layer) => InfluenceKernel::layer(grid, layer),
        }
    }
}

pub struct Scene {
    pub name: String,
    pub body: Body,
    pub history: RandomHistory,
    pub control: Control,
    /// Times to look at, besides the breakpoints of the history \[s\].
    pub stops: Vec<f64>,
    pub geometry: Box<dyn Geometry>,
    pub beneath: Beneath,
    grid: Grid,
    kernel: Arc<InfluenceKernel>,
    law: Option<Arc<dyn Attraction>>,
}

const LENGTH: f64 = 4.0e-3;
const RADIUS: f64 = 8.0e-3;

/// A shape, what it is, and the depth to which it touches a circle of radius `reach`, roughly.
pub(super) fn random_shape(draws: &mut Draws, reach: f64) -> (&'static str, Box<dyn Geometry>, f64) {
    let sphere = || Sphere::new(RADIUS).unwrap();
    let depth = reach * reach / RADIUS;
    match draws.below(20) {
        0..10 => ("sphere", Box::new(sphere()), depth),
        10 | 11 => {
            let by = [draws.between(-0.1, 0.1) * reach, draws.between(-0.1, 0.1) * reach];
            ("shifted sphere", Box::new(Shifted::new(sphere(), by).unwrap()), depth)
        }
        12..15 => {
            let other = RADIUS * draws.between(0.4, 1.0);
            ("ellipsoid", Box::new(Ellipsoid::new(RADIUS, other).unwrap()), depth)
        }
        15 | 16 => ("cone", Box::new(Cone::new(0.1).unwrap()), 0.5 * std::f64::consts::PI * 0.1 * reach),
        17 => ("flat punch", Box::new(FlatPunch::circular(reach).unwrap()), depth),
        _ => {
            let wavy = Wavy::new(draws.between(0.05, 0.3) * depth, LENGTH / draws.between(2.0, 4.0)).unwrap();
            ("wavy sphere", Box::new(Sum::new(sphere(), wavy)), depth)
        }
    }
}

fn random_grid(draws: &mut Draws) -> Grid {
    Grid::new([12 + draws.below(5), 12 + draws.below(3)], [LENGTH, 0.95 * LENGTH]).unwrap()
}

fn random_reach(draws: &mut Draws) -> f64 {
    0.5 * LENGTH * draws.between(0.5, 0.75)
}

/// A rough sphere, as [`random_shape`].
fn rough_sphere(draws: &mut Draws, grid: &Grid, reach: f64) -> (&'static str, Box<dyn Geometry>, f64) {
    let depth = reach * reach / RADIUS;
    let height = Roughness::RmsHeight(depth * draws.between(0.01, 0.1));
    let spec = RoughSpec::new(LENGTH, LENGTH / 4.0, height).with_seed(draws.below(1000) as u64);
    let rough = Rough::new(grid, spec).unwrap();
    ("rough sphere", Box::new(Sum::new(Sphere::new(RADIUS).unwrap(), rough)), depth)
}

/// A rough plane that touches a part of its cells, as [`random_shape`].
fn rough_plane(draws: &mut Draws, grid: &Grid) -> (&'static str, Box<dyn Geometry>, f64) {
    let height = 1.0e-3 * LENGTH * draws.between(0.5, 2.0);
    let spec = RoughSpec::new(LENGTH, LENGTH / 3.0, Roughness::RmsHeight(height)).with_seed(draws.below(1000) as u64);
    ("rough plane", Box::new(Rough::new(grid, spec).unwrap()), height * draws.between(0.3, 0.8))
}

/// A law whose range is about the depth, and that acts over a zone of so many cells in the end.
fn random_law(draws: &mut Draws, scene: &Scene, depth: f64) -> Arc<dyn Attraction> {
    let [side, other] = scene.grid.spacing();
    let (range, zone) = (depth * draws.scale(0.3, 1.5), side.max(other) * draws.scale(4.5, 20.0));
    let work = range * range / zone / scene.body.material.contact_compliance(scene.body.until);
    match draws.below(3) {
        0 => Arc::new(ExponentialAttraction::new(work, range).unwrap()),
        1 => Arc::new(VanDerWaals::new(work, range).unwrap()),
        _ => Arc::new(LinearSoftening::new(work, range).unwrap()),
    }
}

impl Scene {
    /// The scene of this number in the series of this seed.
    pub fn draw(seed: u64, number: u64, features: Features) -> Scene {
        let Features { returns, by_spring, attracts, periodic } = features;
        let series = seed.wrapping_mul(1_000_003).wrapping_add(number).wrapping_add(if returns { 1 << 40 } else { 0 });
        let draws = &mut Draws::new(series);
        let is_wide = by_spring && !returns && draws.chance(0.15);
        let body = match returns {
            true => returning_body(draws),
            false if is_wide => body_of_twenty_decades(draws),
            false => random_body(draws),
        };
        let grid = random_grid(draws);
        let reach = random_reach(draws);
        let (shape, geometry, depth) = match returns && draws.below(6) == 0 {
            _ if periodic => rough_plane(draws, &grid),
            true => rough_sphere(draws, &grid, reach),
            false => random_shape(draws, reach),
        };
        let thickness = (returns && draws.chance(0.2)).then(|| reach * draws.power_of_ten(-0.3, 1.0));
        let (on, beneath) = match thickness {
            Some(thickness) => (" on a layer", Beneath::Layer(Layer::bonded_to_rigid(thickness, 0.5).unwrap())),
            None => ("", if periodic { Beneath::Periodic } else { Beneath::HalfSpace }),
        };
        let mut scene = Scene::unloaded(body, geometry, grid, beneath);
        let (touch, force) = scene.answers(depth);
        // ten kinds of control; of loads that return, half are approaches
        let kind = if returns { 0 } else { draws.below(10) };
        scene.control = match kind {
            _ if by_spring => Control::by_spring(draws, touch, depth, force),
            _ if returns && !draws.chance(0.5) => Control::Force(force),
            0..4 => Control::Approach { touch, depth },
            4 => Control::EccentricForce(force, [(); 2].map(|()| draws.between(-0.15, 0.15) * reach)),
            _ => Control::Force(force),
        };
        let until = scene.body.until;
        scene.history = match returns {
            true => returning_history(draws, scene.control, until),
            false if by_spring && draws.chance(0.15) => taps(draws, scene.control, until),
            false => random_history(draws, scene.control, until, scene.body.is_elastic_at_once()),
        };
        let count = if returns { 8 } else { 1 + draws.below(10) };
        let mut part = |k: usize| match returns || k.is_multiple_of(2) {
            true => draws.between(0.0, 1.0),
            false => draws.power_of_ten(-4.0, 0.0),
        };
        scene.stops = (0..count).map(|k| part(k) * until).collect();
        scene.stops.push(until);
        if attracts {
            scene.law = Some(random_law(draws, &scene, depth));
        }
        scene.called(seed, number, &format!("{shape}{on}"))
    }

    fn unloaded(body: Body, geometry: Box<dyn Geometry>, grid: Grid, beneath: Beneath) -> Scene {
        let kernel = Arc::new(beneath.kernel(&grid).unwrap());
        Scene {
            name: String::new(),
            body,
            history: RandomHistory {
                name: String::new(),
                history: Box::new(FnHistory::new(|_| Load::force(0.0))),
                corners: vec![],
            },
            control: Control::Force(0.0),
            stops: Vec::new(),
            geometry,
            beneath,
            grid,
            kernel,
            law: None,
        }
    }

    /// The approach of first touch, and the force that presses the bodies deeper by `depth` in the end.
    fn answers(&self, depth: f64) -> (f64, f64) {
        let (touch, stiffness) = self.elastic_force(depth);
        (touch, stiffness / self.body.material.contact_compliance(self.body.until))
    }

    fn called(mut self, seed: u64, number: u64, shape: &str) -> Scene {
        let by = match self.control {
            Control::Force(_) => "force",
            Control::EccentricForce(..) => "eccentric force",
            Control::Approach { .. } => "approach",
            Control::Spring { over, .. } => &format!("spring of {over:.2}"),
        };
        let (body, history) = (&self.body, &self.history);
        let law = self.law.as_ref().map_or(String::new(), |law| format!(", {law:?}"));
        self.name = format!(
            "{seed}:{number} {} (creep {:.1e}, {:.0e} s of {:.0e} s), {shape} {:?}, {by}, {}{law}",
            body.name,
            body.creep_ratio(),
            body.until,
            body.shortest_time(),
            self.grid.cells(),
            history.name
        );
        self
    }

    /// The approach of first touch, and the force on an elastic body of compliance 1/Pa pressed deeper by `depth`.
    fn elastic_force(&self, depth: f64) -> (f64, f64) {
        let unit = Material::incompressible(Elastic::new(0.25).unwrap());
        let mut contact = self.contact_of(unit, TimeRule::Exponential, 1e-6);
        let touch = contact.approach();
        contact.step(0.0, Load::approach(touch + depth)).unwrap();
        (touch, contact.force())
    }

    fn contact_of(&self, material: Material, time_rule: TimeRule, tolerance: f64) -> ViscoelasticContact {
        let settings = Settings::default().with_tolerance(tolerance).with_time_rule(time_rule);
        self.builder(settings).material(material).build().unwrap()
    }

    /// The scene before it is built, with contact allowed at the edge.
    pub fn builder(&self, settings: Settings) -> Builder {
        let builder = builder_of(&*self.geometry, self.grid.clone(), self.body.material.clone())
            .kernel(self.kernel.clone())
            .settings(settings.with_edge(Edge::Allow));
        match &self.law {
            Some(law) => builder.attraction(Arc::clone(law)),
            None => builder,
        }
    }

    /// The grid of the scene.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The contact before any load, whose problems are solved to `tolerance`.
    pub fn contact(&self, tolerance: f64) -> ViscoelasticContact {
        self.contact_by(TimeRule::Exponential, tolerance)
    }

    /// The same by a rule of time.
    pub fn contact_by(&self, time_rule: TimeRule, tolerance: f64) -> ViscoelasticContact {
        self.contact_of(self.body.material.clone(), time_rule, tolerance)
    }

    /// The history itself.
    pub fn load(&self) -> &dyn LoadHistory {
        &*self.history.history
    }

    /// The times at which states are compared \[s\], ascending: those to look at, and the breakpoints of the history.
    pub fn moments(&self) -> Vec<f64> {
        let mut moments = self.stops.clone();
        let mut after = 0.0;
        while let Some(next) = self.load().next_breakpoint(after).filter(|&next| next <= self.body.until) {
            moments.push(next);
            after = next;
        }
        sorted(moments)
    }

    /// Ends of given steps \[s\]: graded after the start, after every corner, jump, touch and time looked at; the finer the
    /// higher the `level`, which halves every step.
    pub fn graded_times(&self, level: u32) -> Vec<f64> {
        let until = self.body.until;
        let shortest = self.body.shortest_time();
        let corners = self.history.corners.iter().copied().filter(|&time| time > 0.0 && time < until);
        let knots = sorted([0.0].into_iter().chain(corners).chain(self.moments()).collect());
        let corners = &self.history.corners;
        let mut times = Vec::new();
        let mut origin = 0.0;
        for pair in knots.windows(2) {
            let (start, end) = (pair[0], pair[1]);
            if start == 0.0 || corners.contains(&start) {
                origin = start;
            }
            // from a corner on, steps grow with the time since
            let longest = until.min(4.0 * end) / 40.0;
            let first = 0.05 * shortest.min(end - start) * if start == 0.0 { 1e-2 } else { 1.0 };
            let mut now = start;
            let mut coarse = vec![];
            while now < end {
                let step = (0.25 * (now - origin)).max(first).min(longest);
                now = if now + 1.5 * step >= end { end } else { now + step };
                coarse.push(now);
            }
            let parts = 1 << level;
            let mut before = start;
            for now in coarse {
                let part = |k: i32| before + (now - before) * f64::from(k) / f64::from(parts);
                times.extend((1..parts).map(part));
                times.push(now);
                before = now;
            }
        }
        times
    }
}

/// Ascending, each once.
fn sorted(mut times: Vec<f64>) -> Vec<f64> {
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
