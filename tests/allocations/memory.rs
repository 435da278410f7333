//! The memory that a builder predicts, against the bytes that are allocated.

use crate::common::{Draws, builder_on, elastic, figures, maxwell};
use std::alloc::System;
use std::sync::Arc;

use stats_alloc::Region;
use viscocontact::Result;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::{Builder, Memory};
use viscocontact::prelude::*;

use crate::ALLOCATOR;

/// What a contact keeps beside its fields: names, plans of transforms, traces of the solver.
const SMALL: f64 = 16.0e3;
/// What the threads of a fit keep for the next one, now and then.
const OF_FITS: f64 = 64.0e3;

/// Bytes taken since, and not given back.
fn taken(region: &Region<'_, System>) -> f64 {
    let change = region.change();
    change.bytes_allocated as f64 - change.bytes_deallocated as f64
}

/// The bytes that documents state, with one relaxation time, on one thread: of a cell of the grid by default from 4096² to 32² cells, of
/// a computed cell where all are computed, and in a line contact.
pub fn documents_state_what_builders_announce() {
    let per_cell = |builder: Builder, cells: usize| builder.memory().unwrap().total() as f64 / cells as f64;
    let bytes = || {
        let whole = Settings::default().with_symmetry(false).with_window(false);
        let squares = [Settings::default(), whole].map(|settings| {
            [32, 64, 128, 256, 512, 1024, 2048, 4096].map(|n| {
                let grid = Grid::square(n, 4.0e-3).unwrap();
                per_cell(builder_on(grid, maxwell()).settings(settings), n * n)
            })
        });
        let grid = Grid::new([16384, 1], [8.0e-3, 1.0]).unwrap();
        let kernel = Arc::new(InfluenceKernel::line(&grid, 1.0).unwrap());
        (squares, per_cell(builder_on(grid, maxwell()).kernel(kernel).settings(whole), 16384))
    };
    let (squares, line) = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(bytes);
    println!("{squares:?} {line}");
    let [of_the_grid, computed] = squares.map(|cells| {
        let (least, most) = (cells.into_iter().fold(f64::INFINITY, f64::min), cells.into_iter().fold(0.0, f64::max));
        assert!(least > 50.0 && most < 1.3 * least, "{squares:?}");
        format!("{least:.0} to {most:.0}")
    });
    figures::figure("memory of the grid", &of_the_grid).unwrap();
    figures::figure("memory", &computed).unwrap();
    figures::figure("memory of a line", &format!("{line:.0}")).unwrap();
}

struct Scene {
    grid: Grid,
    kernel: fn(&Grid) -> Result<InfluenceKernel>,
    bodies: usize,
    lopsided: bool,
    terms: usize,
    fitted: bool,
    settings: Settings,
}

fn one_of<T: Copy>(draws: &mut Draws, of: &[T]) -> T {
    of[draws.below(of.len())]
}

fn scene(draws: &mut Draws) -> Scene {
    type Kernel = fn(&Grid) -> Result<InfluenceKernel>;
    let line: Kernel = |grid| InfluenceKernel::line(grid, 10.0);
    let kernels: [Kernel; 6] = [
        InfluenceKernel::half_space,
        InfluenceKernel::half_space,
        InfluenceKernel::periodic,
        |grid| InfluenceKernel::periodic_along(grid, Axis::X2, 10.0),
        line,
        |grid| InfluenceKernel::from_coefficients(grid, |i, j| (-0.1 * f64::hypot(i as f64, j as f64)).exp()),
    ];
    let which = draws.below(kernels.len());
    let sizes = [32, 45, 64, 96, 128, 150, 200, 256, 384, 512];
    let cells = match which {
        4 => [one_of(draws, &[32, 45, 150, 256, 512, 1000, 4096, 5000, 16384, 30000, 65536]), 1],
        _ => [one_of(draws, &sizes), one_of(draws, &sizes)],
    };
    let frame = one_of(draws, &[Frame::Bodies, Frame::Bodies, Frame::Bodies, Frame::Indenter]);
    let time_rule = one_of(draws, &[TimeRule::Exponential, TimeRule::ExponentialLinear]);
    let (symmetry, window) = (one_of(draws, &[true, false]), one_of(draws, &[true, false]));
    Scene {
        grid: Grid::new(cells, cells.map(|cells| 1.0e-5 * cells as f64)).unwrap(),
        kernel: kernels[which],
        bodies: one_of(draws, &[1, 1, 2, 3]),
        lopsided: one_of(draws, &[true, false, false]),
        terms: one_of(draws, &[0, 1, 2, 5, 12]),
        fitted: one_of(draws, &[true, false, false]),
        settings: Settings::default()
            .with_time_rule(time_rule)
            .with_frame(frame)
            .with_symmetry(symmetry)
            .with_window(window)
            .with_edge(Edge::Allow),
    }
}

impl Scene {
    fn builder(&self, kernel: &Arc<InfluenceKernel>) -> Builder {
        let [length, _] = self.grid.lengths();
        let aside = if self.lopsided { 0.013 * length } else { 0.0 };
        let sphere = || Sphere::new(10.0e-3).unwrap();
        let mut builder = ViscoelasticContact::builder(self.grid.clone())
            .geometry(&Shifted::new(sphere(), [aside, 0.5 * aside]).unwrap())
            .kernel(Arc::clone(kernel))
            .settings(self.settings);
        for body in 1..self.bodies {
            let beside = if body == 1 { 0.3 } else { -0.3 };
            builder = builder.another_body(&Shifted::new(sphere(), [beside * length, 0.0]).unwrap());
        }
        let terms: Vec<_> = (0..self.terms).map(|k| (1.0e6, 10f64.powf(0.5 * k as f64))).collect();
        if self.fitted {
            let body = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap();
            return builder.material(Material::incompressible(body)).times(1.0e-2..=1.0e1);
        }
        builder.material(match terms.len() {
            0 => elastic(),
            _ => Material::incompressible(GeneralizedMaxwell::new(1.0e6, &terms).unwrap()),
        })
    }
}

/// An attraction takes 76 bytes a cell, and 3.8 for the lines of its near field and its inverse on 128 columns, its first steps included.
pub fn attraction_takes_what_is_announced() {
    let cells = 128.0 * 128.0;
    let [without, with] = [false, true].map(|attracts| {
        let grid = Grid::square(128, 8.0).unwrap();
        let kernel = Arc::new(InfluenceKernel::half_space(&grid).unwrap());
        let region = Region::new(ALLOCATOR);
        let mut builder = ViscoelasticContact::builder(grid)
            .geometry(&Sphere::new(1.0).unwrap())
            .kernel(kernel)
            .material(Material::incompressible(Elastic::new(0.25).unwrap()))
            .settings(Settings::default().with_window(false).with_symmetry(false).with_edge(Edge::Allow));
        if attracts {
            builder = builder.attraction(ExponentialAttraction::new(1.0, 1.0).unwrap());
        }
        let told = builder.memory().unwrap().total() as f64 / cells;
        let mut contact = builder.build().unwrap();
        for approach in [0.5, 0.4, 0.3] {
            let report = contact.step(1.0, Load::approach(approach)).unwrap();
            assert!(report.contact_cells > 0);
        }
        (told, taken(&region) / cells)
    });
    let [told, counted] = [with.0 - without.0, with.1 - without.1];
    println!("an attraction takes {counted:.2} bytes a cell, {told:.2} are told");
    assert!((told - 79.8).abs() < 0.5 && (counted - 79.8).abs() < 0.5, "{told} {counted}");
}

pub fn builders_announce_what_is_counted() {
    let draws = &mut Draws::new(7);
    // threads and what fits keep for the next are taken once
    let warm = Scene { fitted: true, bodies: 1, settings: Settings::default(), ..scene(draws) };
    let warm = Scene { grid: Grid::square(256, 1.0e-2).unwrap(), kernel: InfluenceKernel::half_space, ..warm };
    drop(warm.builder(&Arc::new((warm.kernel)(&warm.grid).unwrap())).build().unwrap());
    rayon::broadcast(|_| ());
    let (mut equal, mut bounded, mut grown) = (0, 0, 0);
    for number in 0..300 {
        let scene = scene(draws);
        let kernel = Arc::new((scene.kernel)(&scene.grid).unwrap());
        // what coefficients and their proof took is the user's
        let region = Region::new(ALLOCATOR);
        let builder = scene.builder(&kernel);
        let asked = Region::new(ALLOCATOR);
        let memory: Memory = match builder.memory() {
            Ok(memory) => memory,
            Err(error) => {
                assert!(scene.fitted || matches!(error, Error::Step(StepError::NoElasticResponse { .. })), "{error}");
                assert_eq!(builder.build().unwrap_err().to_string(), error.to_string());
                continue;
            }
        };
        let small = SMALL + if scene.fitted { OF_FITS } else { 0.0 };
        assert!(taken(&asked).abs() < small, "{number}: {} bytes stay after the question", taken(&asked));
        let contact = builder.build().unwrap();
        let (counted, told) = (taken(&region), memory.total() as f64);
        let what = format!(
            "{number}: {counted} counted, {told} told, {:?} cells of {}, {} bodies, {} terms, {:?}: {memory}",
            scene.grid.cells(),
            contact.fields().kernel(),
            scene.bodies,
            scene.terms,
            scene.settings
        );
        assert!(counted <= 1.05 * told + small, "{what}");
        // a window is as small as the contact at first, and may grow
        let on_half_space = contact.fields().kernel().to_string() == "half-space";
        let recursive = scene.settings.frame() == Frame::Bodies;
        let least = if scene.settings.window() && on_half_space && recursive { 0.0 } else { 0.95 };
        assert!(counted >= least * told - small, "{what}");
        if least > 0.0 {
            equal += 1;
            continue;
        }
        // which is when it takes the most; contact at the edge of the grid is no matter here
        let mut contact = contact;
        for force in [1.0e-3, 1.0e-1, 10.0] {
            let stepped = contact.step(0.0, vec![Load::force(force); scene.bodies]);
            grown += usize::from(stepped.is_ok_and(|_| taken(&region) > 2.0 * counted));
            // what the solver makes for several bodies when it first needs it
            let late = if scene.bodies > 1 { 32.0 * memory.computed_cells as f64 } else { 0.0 };
            assert!(taken(&region) <= 1.05 * told + small + late, "{} after a step: {what}", taken(&region));
        }
        bounded += 1;
    }
    println!("{equal} {bounded} {grown}");
    assert!(equal > 200 && bounded > 10 && grown > 20, "{equal} {bounded} {grown}");
}
