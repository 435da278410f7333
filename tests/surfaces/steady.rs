//! Runs towards a steady state: those that arrive are there, and those that do not say why. `STEADY_SCENES` (24) random sliders and
//! rollers, `STEADY_SEED` (1).

use std::f64::consts::TAU;

use crate::common::steady_sliding::{Along, Below, SteadySliding, SteadyState};
use crate::common::{Draws, from_environment};
use viscocontact::contact::Unsteady;
use viscocontact::prelude::*;

/// Glassy compliance of the contact \[1/Pa\].
const GLASSY: f64 = 0.25e-6;

/// A slider or roller, in units of its cells along the motion. It moves by 1 m in 1 s.
struct Scene {
    about: String,
    below: Below,
    grid: Grid,
    axis: Axis,
    velocity: f64,
    shape: Box<dyn Geometry>,
    /// Share of the compliance, relative to the glassy one, and v τ of each term.
    terms: Vec<(f64, f64)>,
    fluidity: f64,
    force: f64,
    tolerance: f64,
    max_distance: Option<f64>,
    /// The cell along the motion in the middle of the cells that may touch, and their number; all of periodic bodies.
    touching: [isize; 2],
}

impl Scene {
    /// `easy`: without a free dashpot, travelling by twenty times the longest v τ, on grids that reach by ten times as much behind.
    fn draw(draws: &mut Draws, easy: bool) -> Scene {
        let below = match draws.below(4) {
            0 | 1 => Below::Periodic,
            2 => Below::HalfSpace,
            _ => Below::Line(draws.scale(1e3, 1e5)),
        };
        let flat = below != Below::HalfSpace && (below != Below::Periodic || draws.chance(0.3));
        let compliances: Vec<f64> = (0..1 + draws.below(3)).map(|_| draws.scale(0.2, 4.0)).collect();
        let relaxed: f64 = 1.0 + compliances.iter().sum::<f64>();
        let half = draws.between(5.0, if flat { 10.0 } else { 7.0 });
        let across = if flat { 1 } else { (2.5 * half) as usize };
        let period = if flat { 32 } else { 16 };
        let (mut reach, mut length) = (0.0, period as f64);
        if below != Below::Periodic {
            length = if easy { half * draws.scale(2.0, 20.0) } else { half * draws.scale(1.0, 16.0) };
        }
        let longest = match (below, easy) {
            (Below::Periodic, true) => 2.0 * length,
            (_, true) => 0.1 * length,
            _ => 1e6 * length,
        };
        let terms: Vec<(f64, f64)> = compliances
            .iter()
            .map(|&c| {
                let l = if easy {
                    draws.scale(0.02 * longest, longest)
                } else if draws.chance(0.4) {
                    draws.scale(2.0, length)
                } else {
                    draws.scale(length, longest)
                };
                reach = f64::max(reach, l);
                (c, l)
            })
            .collect();
        let axis = if flat && below != Below::Periodic { Axis::X1 } else { draws_axis(draws) };
        let velocity = if draws.chance(0.5) { 1.0 } else { -1.0 };
        let along = move |x1: f64, x2: f64| if axis == Axis::X1 { [x1, x2] } else { [x2, x1] };
        let (cells, touching, force): ([usize; 2], _, f64);
        let shape: Box<dyn Geometry>;
        if below == Below::Periodic {
            cells = [period, if flat { 1 } else { period }];
            touching = [period as isize / 2, period as isize];
            let waves: Vec<[f64; 4]> = (0..1 + draws.below(5))
                .map(|k| {
                    let [a, b] = [draws.below(4) as f64, if flat { 0.0 } else { draws.below(4) as f64 }];
                    // a wave along the motion at least
                    let a = if k == 0 { a.max(1.0) } else { a };
                    [a, b, draws.between(0.0, TAU), draws.between(0.3, 1.0)]
                })
                .collect();
            let unit = TAU / length;
            let most: f64 = waves.iter().map(|w| w[3]).sum();
            let stiff: f64 = waves.iter().map(|w| w[3] * w[0].hypot(w[1]) * unit).sum();
            force = draws.scale(0.02, 0.6) * stiff * 0.5 * 1e-2 / (GLASSY * relaxed) * (cells[0] * cells[1]) as f64;
            shape = Box::new(FnGeometry::new(move |x1, x2| {
                let [x, y] = along(x1, x2);
                1e-2 * (most - waves.iter().map(|w| w[3] * (unit * (w[0] * x + w[1] * y) + w[2]).cos()).sum::<f64>())
            }));
        } else {
            let ahead = (2.0 * half) as usize;
            let behind = if easy { length.max(2.0 * half) } else { length };
            let count = (behind + half) as usize + ahead;
            cells = [count, across];
            let at = velocity * (0.5 * count as f64 - ahead as f64);
            let radius = 100.0 * half;
            let center = if velocity > 0.0 { count - ahead } else { ahead } as isize;
            touching = [center, (4.0 * half) as isize];
            if flat {
                force = 0.25 * std::f64::consts::PI * half * half / (radius * GLASSY * relaxed);
            } else {
                force = 4.0 / 3.0 * half.powi(3) / (radius * GLASSY * relaxed);
            }
            shape = Box::new(FnGeometry::new(move |x1, x2| {
                let [x, y] = along(x1, x2);
                ((x - at).powi(2) + if flat { 0.0 } else { y * y }) / (2.0 * radius)
            }));
        }
        let cells = if axis == Axis::X1 { cells } else { [cells[1], cells[0]] };
        let fluidity = if !easy && draws.chance(0.1) { draws.scale(1e-10, 1e-5) } else { 0.0 };
        let tolerance = if easy { 1e-3 } else { draws.scale(1e-5, 1e-3) };
        let lengths = cells.map(|count| count as f64);
        let longest = 20.0 * reach;
        let far = longest.max(4.0 * length);
        let max_distance = if easy || longest < 20.0 * length && draws.chance(0.5) { Some(far) } else { None };
        let about = format!(
            "{below:?} {cells:?} {axis:?} v {velocity} length {length:.1} half {half:.1} terms {terms:.2?} fluidity {fluidity:.1e} tolerance {tolerance:.1e} within {max_distance:?}"
        );
        let grid = Grid::new(cells, lengths).unwrap();
        Scene { about, below, grid, axis, velocity, shape, terms, fluidity, force, tolerance, max_distance, touching }
    }

    fn run(&self) -> (ViscoelasticContact, std::result::Result<(), Unsteady>) {
        let kernel = match self.below {
            Below::Periodic => InfluenceKernel::periodic(&self.grid),
            Below::HalfSpace => InfluenceKernel::half_space(&self.grid),
            Below::Line(datum) => InfluenceKernel::line(&self.grid, datum),
        };
        let terms: Vec<(f64, f64)> = self.terms.iter().map(|&(c, l)| (4.0 * GLASSY * c, l)).collect();
        let body = GeneralizedKelvin::new(4.0 * GLASSY, self.fluidity, &terms).unwrap();
        let settings = Settings::default()
            .with_frame(Frame::Indenter)
            .with_tolerance(1e-3 * self.tolerance)
            .with_edge(viscocontact::contact::Edge::Allow);
        let mut contact = ViscoelasticContact::builder(self.grid.clone())
            .geometry(&*self.shape)
            .material(Material::incompressible(body))
            .kernel(std::sync::Arc::new(kernel.unwrap()))
            .settings(settings)
            .build()
            .unwrap();
        let motion = SteadyMotion::new(self.axis, self.velocity, Load::force(self.force))
            .with_tolerance(self.tolerance)
            .with_max_distance(self.max_distance);
        let ended = contact.toward_steady(motion).and_then(|run| run.run());
        let ended = match ended {
            Ok(()) => Ok(()),
            Err(Error::Step(StepError::NotSteady { reason, .. })) => Err(reason),
            Err(error) => panic!("{}: {error}", self.about),
        };
        (contact, ended)
    }

    fn reference(&self, along: Along) -> Option<SteadyState> {
        let axis = self.axis.index();
        let [count, across] = [self.grid.cells()[axis], self.grid.cells()[1 - axis]];
        let cells = [self.touching[1] as usize, across];
        let gap = |offset: f64| -> Vec<f64> {
            let cell = |i: usize, j: usize| {
                let ahead = (i as f64 + 0.5 - 0.5 * cells[0] as f64) + offset;
                let x = self.touching[0] as f64 - 0.5 * count as f64 + self.velocity * ahead;
                let y = j as f64 + 0.5 - 0.5 * across as f64;
                let [x1, x2] = if axis == 0 { [x, y] } else { [y, x] };
                self.shape.initial_gap(x1, x2)
            };
            (0..cells[0]).flat_map(|i| (0..across).map(move |j| (i, j))).map(|(i, j)| cell(i, j)).collect()
        };
        let rise = gap(0.5).iter().zip(gap(-0.5)).map(|(ahead, behind)| ahead - behind).collect();
        let terms = self.terms.iter().map(|&(c, l)| (GLASSY * c, l)).collect();
        let sliding = SteadySliding {
            below: self.below,
            cells,
            spacing: [1.0; 2],
            glassy: GLASSY,
            terms,
            gap: gap(0.0),
            rise,
            force: self.force,
        };
        sliding.solve(along)
    }
}

fn draws_axis(draws: &mut Draws) -> Axis {
    if draws.chance(0.5) { Axis::X1 } else { Axis::X2 }
}

#[test]
fn random_motions_that_arrive_are_steady() {
    let (scenes, seed) = (from_environment("STEADY_SCENES", 24), from_environment("STEADY_SEED", 1));
    let (mut arrived, mut compared, mut sharp) = (0, 0, 0);
    for k in 0..scenes {
        let mut draws = Draws::new(seed * 1_000_000 + k);
        let scene = Scene::draw(&mut draws, false);
        let started = std::time::Instant::now();
        let (contact, ended) = scene.run();
        let took = started.elapsed().as_secs_f64();
        let friction = scene.velocity * contact.lateral_force(&*scene.shape)[scene.axis.index()] / contact.force();
        let (Some(exact), Some(linear)) = (scene.reference(Along::Exact), scene.reference(Along::Linear)) else {
            println!("{k}: no reference: {}", scene.about);
            continue;
        };
        let error = |value: f64, of: fn(&SteadyState) -> f64| {
            let [mesh, error] = [of(&linear), value].map(|value| (value / of(&exact) - 1.0).abs());
            [error, mesh]
        };
        let [of_friction, of_approach] = [error(friction, |s| s.friction), error(contact.approach(), |s| s.approach)];
        println!(
            "{k}: {took:.2} s {ended:?} friction {friction:.3e} off {:.1e} {:.1e} approach {:.1e} {:.1e} | {}",
            of_friction[0], of_friction[1], of_approach[0], of_approach[1], scene.about
        );
        arrived += usize::from(ended.is_ok());
    }
    println!("{arrived} of {scenes} arrived");
    let _ = (&mut compared, &mut sharp);
}

#[test]
fn random_easy_motions_arrive() {
    let (scenes, seed) = (from_environment("STEADY_SCENES", 24), from_environment("STEADY_SEED", 1));
    let mut arrived = 0;
    for k in 0..scenes {
        let mut draws = Draws::new(seed * 2_000_000 + k);
        let scene = Scene::draw(&mut draws, true);
        let started = std::time::Instant::now();
        let (contact, ended) = scene.run();
        let took = started.elapsed().as_secs_f64();
        let friction = scene.velocity * contact.lateral_force(&*scene.shape)[scene.axis.index()] / contact.force();
        let (Some(exact), Some(linear)) = (scene.reference(Along::Exact), scene.reference(Along::Linear)) else {
            println!("{k}: no reference: {}", scene.about);
            continue;
        };
        let error = |value: f64, of: fn(&SteadyState) -> f64| {
            [value, of(&linear)].map(|value| (value / of(&exact) - 1.0).abs())
        };
        let [of_friction, of_approach] = [error(friction, |s| s.friction), error(contact.approach(), |s| s.approach)];
        println!(
            "{k}: {took:.2} s {ended:?} friction {friction:.3e} off {:.1e} {:.1e} approach {:.1e} {:.1e} | {}",
            of_friction[0], of_friction[1], of_approach[0], of_approach[1], scene.about
        );
        arrived += usize::from(ended.is_ok());
    }
    println!("{arrived} of {scenes} arrived");
}
