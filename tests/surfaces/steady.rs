//! Motions over the bodies to a steady state: where no trace that matters has left the grid they end at the reference, and else they warn.
//! `STEADY_SCENES` (40) random sliders and rollers, `STEADY_SEED` (1).

use std::f64::consts::{PI, TAU};

use crate::common::march::march;
use crate::common::steady_sliding::{Below, SteadySliding, SteadyState, Time};
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::contact::{Builder, Edge, Warnings};
use viscocontact::prelude::*;

/// Glassy compliance of the contact \[1/Pa\].
const GLASSY: f64 = 0.25e-6;

/// A slider or roller on cells with sides of 1 m. It moves by one cell in 1 s.
#[derive(Debug, Clone)]
struct Scene {
    below: Below,
    /// Whether u is linear in time within all steps.
    linear: bool,
    axis: Axis,
    velocity: f64,
    /// Waves under a periodic slider: periods along the motion and across it, phase, height. Else it is a ball or a cylinder.
    waves: Vec<[f64; 4]>,
    /// Half the length of the relaxed contact of a ball or a cylinder.
    half: f64,
    /// Cells behind the middle of the contact and ahead of it, and across the motion.
    behind: usize,
    ahead: usize,
    across: usize,
    /// Compliance relative to the glassy one, and v τ, of each term.
    terms: Vec<(f64, f64)>,
    fluidity: f64,
    force: f64,
    tolerance: f64,
}

impl Scene {
    /// `easy`: no free dashpot, a track of twenty times the longest v τ, and a grid that reaches by ten times as much behind.
    fn draw(draws: &mut Draws, easy: bool) -> Scene {
        let below = match draws.below(4) {
            0 | 1 => Below::Periodic,
            2 => Below::HalfSpace,
            _ => Below::Line(draws.scale(1e3, 1e5)),
        };
        let periodic = below == Below::Periodic;
        let plane = if periodic { draws.chance(0.3) } else { below != Below::HalfSpace };
        let (linear, half) = (!periodic || draws.chance(0.5), draws.between(5.0, if plane { 10.0 } else { 7.0 }));
        let length = match (periodic, easy) {
            (true, _) => {
                if plane {
                    32.0
                } else {
                    16.0
                }
            }
            (_, true) => half * draws.scale(6.0, 20.0),
            _ => half * draws.scale(1.0, 16.0),
        };
        let longest = match (easy, periodic) {
            (true, true) => 2.0 * length,
            (true, false) => 0.1 * length,
            _ => 1e6 * length,
        };
        let least = 0.3;
        let terms: Vec<(f64, f64)> = (0..1 + draws.below(3))
            .map(|_| {
                let reach = match easy {
                    true => draws.scale(f64::min(least, 0.5 * longest), longest),
                    _ if draws.chance(0.5) => draws.scale(least, length.max(2.0 * least)),
                    _ => draws.scale(length, longest),
                };
                (draws.scale(0.2, 4.0), reach)
            })
            .collect();
        let relaxed = GLASSY * terms.iter().fold(1.0, |sum, (c, _)| sum + c);
        let mut periods = |least: usize| [draws.below(4).max(least), if plane { 0 } else { draws.below(4) }];
        let mut waves: Vec<[usize; 2]> = Vec::new();
        if periodic {
            waves.push(periods(1));
            (0..4).for_each(|_| waves.push(periods(0)));
        }
        waves.truncate(1 + draws.below(5));
        let waves: Vec<[f64; 4]> = waves
            .into_iter()
            .map(|[a, b]| [a as f64, b as f64, draws.between(0.0, TAU), 1e-2 * draws.between(0.3, 1.0)])
            .collect();
        let force = if periodic {
            // up to what closes all waves at once
            let stiff: f64 = waves.iter().map(|[a, b, _, height]| PI * a.hypot(*b) / length * height / relaxed).sum();
            draws.scale(0.02, 0.6) * stiff * length * if plane { 1.0 } else { length }
        } else if plane {
            0.25 * PI * half / (100.0 * relaxed)
        } else {
            half.powi(2) / (75.0 * relaxed)
        };
        let longest = terms.iter().map(|(_, reach)| *reach).fold(0.0, f64::max);
        let behind = if periodic { 0.5 * length } else { half + if easy { 10.0 * longest } else { length } };
        Scene {
            below,
            linear,
            axis: if draws.chance(0.5) && (periodic || !plane) { Axis::X2 } else { Axis::X1 },
            velocity: if draws.chance(0.5) { 1.0 } else { -1.0 },
            waves,
            half,
            behind: behind.ceil() as usize,
            ahead: if periodic { behind as usize } else { (2.0 * half) as usize },
            across: if plane {
                1
            } else if periodic {
                length as usize
            } else {
                (2.5 * half) as usize
            },
            terms,
            fluidity: if !easy && draws.chance(0.1) { draws.scale(1e-10, 1e-5) } else { 0.0 },
            force,
            tolerance: if easy { 1e-3 } else { draws.scale(1e-5, 1e-3) },
        }
    }

    fn length(&self) -> usize {
        self.behind + self.ahead
    }

    /// In the order of x1 and x2, from along and across the motion.
    fn by_axis<T>(&self, along: T, across: T) -> [T; 2] {
        if self.axis == Axis::X1 { [along, across] } else { [across, along] }
    }

    /// The gap at a distance ahead of the middle of the contact, and aside.
    fn gap(&self, ahead: f64, aside: f64) -> f64 {
        if self.waves.is_empty() {
            return (ahead * ahead + if self.across == 1 { 0.0 } else { aside * aside }) / (200.0 * self.half);
        }
        let unit = TAU / self.length() as f64;
        let wave = |[a, b, phase, height]: &[f64; 4]| height * (1.0 - (unit * (a * ahead + b * aside) + phase).cos());
        self.waves.iter().map(wave).sum()
    }

    /// The middle of the contact, along the motion from the middle of the grid.
    fn middle(&self) -> f64 {
        0.5 * (self.behind as f64 - self.ahead as f64)
    }

    fn shape(&self) -> impl Geometry + 'static {
        let scene = self.clone();
        let middle = self.middle();
        FnGeometry::new(move |x1: f64, x2: f64| {
            let [along, aside] = scene.by_axis(x1, x2);
            scene.gap(scene.velocity * along - middle, aside)
        })
    }

    /// The contact, but for its settings.
    fn builder(&self) -> Builder {
        let cells = self.by_axis(self.length(), self.across);
        let grid = Grid::new(cells, cells.map(|count| count as f64)).unwrap();
        let kernel = match self.below {
            Below::Periodic => InfluenceKernel::periodic(&grid),
            Below::HalfSpace => InfluenceKernel::half_space(&grid),
            Below::Line(datum) => InfluenceKernel::line(&grid, datum),
        };
        let terms: Vec<(f64, f64)> = self.terms.iter().map(|&(c, reach)| (4.0 * GLASSY * c, reach)).collect();
        builder_of(
            &self.shape(),
            grid,
            Material::incompressible(GeneralizedKelvin::new(4.0 * GLASSY, self.fluidity, &terms).unwrap()),
        )
        .kernel(kernel.unwrap())
    }

    /// v τ of the slowest term.
    fn longest(&self) -> f64 {
        self.terms.iter().map(|(_, reach)| *reach).fold(0.0, f64::max)
    }

    /// Marches to the steady state; returns the contact, and the part of approach or lateral force that what has left the grid could change.
    fn run(&self) -> (ViscoelasticContact, Option<f64>) {
        let rule = if self.linear { TimeRule::ExponentialLinear } else { TimeRule::Exponential };
        let settings = Settings::default().with_frame(Frame::Indenter).with_time_rule(rule).with_edge(Edge::Allow);
        let mut contact = self.builder().settings(settings.with_tolerance(1e-3 * self.tolerance)).build().unwrap();
        let (load, cell) = (Load::force(self.force), self.by_axis(self.velocity as isize, 0));
        let track = (10.0 * self.longest()).max(4.0 * self.length() as f64);
        march(&mut contact, self.axis, self.velocity, load, (track, self.tolerance)).unwrap();
        let report = contact.step_over(cell, 1.0, load).unwrap();
        assert_eq!(report.figures.wake.is_some(), report.warnings.contains(Warnings::WAKE));
        (contact, report.figures.wake)
    }

    fn reference(&self, time: Time) -> Option<SteadyState> {
        // cells about the middle of the contact that it may touch, of which there is one behind for each ahead
        let count = if self.waves.is_empty() { 2 * (2.0 * self.half) as usize } else { self.length() };
        let at = |k: usize, shift: f64| {
            let [x, y] = [(k / self.across, count), (k % self.across, self.across)].map(from_middle);
            self.gap(x + shift, y)
        };
        let all = 0..count * self.across;
        let sliding = SteadySliding {
            below: self.below,
            cells: [count, self.across],
            spacing: [1.0; 2],
            glassy: GLASSY,
            terms: self.terms.iter().map(|&(c, reach)| (GLASSY * c, reach)).collect(),
            gap: all.clone().map(|k| at(k, 0.0)).collect(),
            rise: all.clone().map(|k| at(k, 0.5) - at(k, -0.5)).collect(),
            force: self.force,
        };
        sliding.solve(time)
    }

    /// Relative errors of friction and approach, of the same cells and steps. Friction is relative to the greater of two that the mesh
    /// cannot tell apart: from the slope of the shape over each cell, and over two.
    fn errors(&self, contact: &ViscoelasticContact) -> [f64; 2] {
        let lateral = self.velocity * contact.fields().slope_force(&self.shape())[self.axis.index()];
        let exact = self.reference(if self.linear { Time::Steps } else { Time::Corrected });
        let exact = exact.expect("the dense problem has a solution");
        let count = exact.pressure.len() / self.across;
        let rise = |k: usize| {
            let [x, y] = [(k / self.across, count), (k % self.across, self.across)].map(from_middle);
            0.5 * (self.gap(x + 1.0, y) - self.gap(x - 1.0, y))
        };
        let wide: f64 = exact.pressure.iter().enumerate().map(|(k, p)| p * rise(k)).sum::<f64>() / self.force;
        let scale = exact.friction.abs().max(wide.abs());
        [(lateral / contact.force() - exact.friction).abs() / scale, (contact.approach() / exact.approach - 1.0).abs()]
    }
}

/// The position of a cell from the middle of so many.
fn from_middle((cell, count): (usize, usize)) -> f64 {
    cell as f64 + 0.5 - 0.5 * count as f64
}

fn scenes(easy: bool) -> impl Iterator<Item = Scene> {
    let (scenes, seed) = (from_environment("STEADY_SCENES", 40), from_environment("STEADY_SEED", 1));
    (0..scenes).map(move |k| Scene::draw(&mut Draws::new(seed * 1_000_000 + k), easy))
}

/// Errors beyond this are told.
const MOST: f64 = 0.02;

#[test]
fn random_motions_are_steady_or_warn() {
    let (mut silent, mut told, mut untold) = (Ratios::default(), Ratios::default(), Ratios::default());
    // the track of slower creep is too long for a test
    let short = |scene: &Scene| scene.fluidity == 0.0 && scene.longest() < 4.0 * scene.length() as f64;
    for (k, scene) in scenes(false).enumerate().filter(|(_, scene)| short(scene)) {
        let (contact, missing) = scene.run();
        let error = scene.errors(&contact).into_iter().fold(0.0, f64::max);
        println!(
            "{k}: {error:.1e} {missing:?} {:?} longest {:.1} behind {}",
            scene.below,
            scene.longest(),
            scene.behind
        );
        match missing {
            Some(missing) => told.push(missing / error, ""),
            None => untold.push(error, ""),
        }
        if missing.is_none() && error > MOST {
            silent.push(error, "");
        }
    }
    told.print("told over true", 0);
    untold.print("errors that are not told", 0);
    assert!(silent.count() == 0 && told.count() > 2 && untold.count() > 5, "{silent:?}");
}

#[test]
fn random_motions_with_track_and_grid_enough_arrive() {
    let (mut errors, mut warned) = (Ratios::default(), 0);
    for scene in scenes(true) {
        let (contact, missing) = scene.run();
        errors.push(scene.errors(&contact).into_iter().fold(0.0, f64::max), "");
        warned += usize::from(missing.is_some());
    }
    errors.print("errors", 0);
    assert!(errors.greatest() < 0.01 && 20 * warned <= errors.count(), "{warned}");
}

/// A cylinder over 128 cells of a rigid body.
fn over_cylinder(radius: f64, side: f64, force: f64) -> SteadySliding {
    let x = |k: usize| (k as f64 + 0.5 - 64.0) * side;
    SteadySliding {
        below: Below::Line(100.0),
        cells: [128, 1],
        spacing: [side, 1.0],
        glassy: 0.0,
        terms: Vec::new(),
        gap: (0..128).map(|k| 0.5 * x(k).powi(2) / radius).collect(),
        rise: (0..128).map(|k| x(k) * side / radius).collect(),
        force,
    }
}

#[test]
fn a_body_without_elastic_response_arrives() {
    let grid = Grid::new([256, 1], [8.0e-3, 1.0]).unwrap();
    let (radius, at, force) = (10.0e-3, 2.0e-3, 100.0);
    let cylinder = Shifted::new(Cylinder::new(radius).unwrap(), [at, 0.0]).unwrap();
    let terms = [(1.0e-6, 1.0e-3), (2.0e-6, 3.0e-3)];
    let mut contact = builder_of(
        &cylinder,
        grid.clone(),
        Material::incompressible(GeneralizedKelvin::new(0.0, 0.0, &terms).unwrap()),
    )
    .kernel(InfluenceKernel::line(&grid, 1.0).unwrap())
    .settings(Settings::default().with_frame(Frame::Indenter))
    .build()
    .unwrap();
    march(&mut contact, Axis::X1, 0.1, Load::force(force), (grid.lengths()[0], 1e-3)).unwrap();
    let mut sliding = over_cylinder(radius, grid.spacing()[0], force);
    sliding.below = Below::Line(1.0);
    sliding.terms = terms.iter().map(|&(compliance, time)| (0.25 * compliance, 0.1 * time)).collect();
    let exact = sliding.solve(Time::Exact).unwrap();
    let friction = contact.fields().slope_force(&cylinder)[0] / contact.force();
    let errors = [friction / exact.friction - 1.0, contact.approach() / exact.approach - 1.0];
    println!("{errors:?}");
    assert!(errors[0].abs() < 0.02 && errors[1].abs() < 2e-3, "{errors:?}");
}
