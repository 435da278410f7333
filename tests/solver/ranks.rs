//! A contact that ranks share out is the same as in one process, bit by bit, whatever their number.

use std::f64::consts::TAU;
use std::sync::Arc;

use viscocontact::geometry::Sum;
use viscocontact::parallel::{Ranks, Threads};
use viscocontact::prelude::*;

/// What is compared: reports as they print, to the last bit, and fields of the whole grid.
#[derive(Debug, PartialEq)]
struct Course {
    reports: Vec<String>,
    numbers: Vec<u64>,
    pressure: Vec<u64>,
    displacement: Vec<u64>,
}

/// Who computes: one process, or a rank, which evaluates the geometry on own rows or on the whole grid.
struct Start {
    ranks: Option<Arc<dyn Ranks>>,
    on_own_rows: bool,
}

impl Start {
    fn builder(&self, grid: &Grid) -> Builder {
        let builder = ViscoelasticContact::builder(grid.clone());
        match &self.ranks {
            Some(ranks) if self.on_own_rows => builder.ranks(Arc::clone(ranks)),
            _ => builder,
        }
    }

    fn rough(&self, grid: &Grid, spec: RoughSpec) -> Result<Box<dyn Geometry>, Error> {
        Ok(match &self.ranks {
            Some(ranks) => Box::new(Rough::shared(grid, spec, ranks)?),
            None => Box::new(Rough::new(grid, spec)?),
        })
    }

    fn end(&self, builder: Builder) -> Builder {
        match &self.ranks {
            Some(ranks) if !self.on_own_rows => builder.ranks(Arc::clone(ranks)),
            _ => builder,
        }
    }
}

/// Its parts, and steps.
type Parts = fn(&Start) -> Result<Builder, Error>;
type Scene = fn(Builder) -> Result<(ViscoelasticContact, Vec<StepReport>), Error>;

/// What a rank sees; fields on rank 0 alone.
fn course(builder: Parts, scene: Scene, start: &Start) -> Result<Course, Error> {
    let (contact, reports) = scene(start.end(builder(start)?))?;
    let bits = |field: Vec<f64>| field.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    let whole = |field: &[f64]| Ok::<_, Error>(bits(contact.gathered(field, 0)?.unwrap_or_default()));
    let ([moment1, moment2], [tilt1, tilt2]) = (contact.moment(), contact.tilt());
    let numbers = vec![contact.force(), contact.approach(), moment1, moment2, tilt1, tilt2, contact.max_pressure()];
    Ok(Course {
        reports: reports.iter().map(|report| format!("{report:?}")).collect(),
        numbers: bits(numbers),
        pressure: whole(contact.pressure())?,
        displacement: whole(contact.displacement())?,
    })
}

/// Compares the scene on some numbers of ranks with that of one process: on fewer and on more than there are bands of rows.
fn same_on_all(builder: Parts, scene: Scene) {
    let alone = course(builder, scene, &Start { ranks: None, on_own_rows: false }).unwrap();
    assert!(alone.pressure.iter().any(|&p| p != 0) && !alone.reports.is_empty());
    for size in [1, 2, 3, 8] {
        let start = |ranks| Start { ranks: Some(ranks), on_own_rows: size != 3 };
        let courses = Threads::run(size, |ranks| course(builder, scene, &start(ranks))).unwrap();
        for (rank, course) in courses.into_iter().enumerate() {
            let course = course.unwrap();
            assert_eq!(course.reports, alone.reports, "rank {rank} of {size}");
            assert_eq!(course.numbers, alone.numbers, "rank {rank} of {size}");
            if rank == 0 {
                assert!(course.pressure == alone.pressure, "pressure on {size} ranks");
                assert!(course.displacement == alone.displacement, "displacement on {size} ranks");
            }
        }
    }
}

fn zener() -> Result<Material, Error> {
    Ok(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6)?))
}

/// The whole grid is computed in one process, too.
fn settings() -> Settings {
    Settings::default().with_window(false)
}

#[test]
fn sphere_folded() {
    let builder: Parts = |start| {
        let grid = Grid::square(384, 4.0e-3)?;
        Ok(start.builder(&grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = vec![contact.step(0.0, Load::force(1.0))?];
        for _ in 0..3 {
            reports.push(contact.step(0.3, Load::force(1.0))?);
        }
        Ok((contact, reports))
    });
}

#[test]
fn sphere_whole() {
    let builder: Parts = |start| {
        let settings = settings().with_symmetry(false);
        let grid = Grid::new([203, 178], [4.0e-3, 3.6e-3])?;
        Ok(start.builder(&grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = Vec::new();
        for (dt, load) in [
            (0.0, Load::force(1.0)),
            (0.3, Load::force(1.5)),
            (0.5, Load::approach(2.0e-4)),
            (0.5, Load::approach(2.0e-4)),
            (0.2, Load::force(0.2)),
        ] {
            reports.push(contact.step(dt, load)?);
        }
        Ok((contact, reports))
    });
}

/// Symmetric about one axis alone: half of the rows are computed, by other ranks than those that have evaluated them, or half
/// of each row, in other bands.
#[test]
fn spheres_off_the_middle() {
    fn off(start: &Start, by: [f64; 2]) -> Result<Builder, Error> {
        let (grid, sphere) = (Grid::new([320, 256], [4.0e-3, 3.2e-3])?, Shifted::new(Sphere::new(10.0e-3)?, by)?);
        Ok(start.builder(&grid).geometry(&sphere).material(zener()?).settings(settings()))
    }
    let scene: Scene = |builder| {
        let mut contact = builder.build()?;
        let reports = vec![contact.step(0.0, Load::force(0.4))?, contact.step(0.3, Load::force(0.4))?];
        Ok((contact, reports))
    };
    same_on_all(|start| off(start, [0.31e-3, 0.0]), scene);
    same_on_all(|start| off(start, [0.0, 0.31e-3]), scene);
}

#[test]
fn tilting_punch() {
    let builder: Parts = |start| {
        let grid = Grid::new([170, 160], [1.2e-3, 1.0e-3])?;
        let (punch, settings) = (FlatPunch::rectangular([0.8e-3, 0.6e-3])?, settings().with_symmetry(false));
        Ok(start.builder(&grid).geometry(&punch).material(zener()?).settings(settings))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = Vec::new();
        for step in 0..4 {
            let dt = if step == 0 { 0.0 } else { 0.2 };
            reports.push(contact.step(dt, Load::eccentric_force(1.0, [0.1e-3 + 0.03e-3 * f64::from(step), 0.05e-3]))?);
        }
        // the rim lifts off, and the body turns at a given approach
        reports.push(contact.step(0.1, Load::eccentric_force(1.0, [0.25e-3, 0.15e-3]))?);
        Ok((contact, reports))
    });
}

/// A few waves of different lengths and directions, periodic on the grid.
fn waves(x1: f64, x2: f64) -> f64 {
    let wave = |k1: f64, k2: f64, phase: f64| (TAU * (k1 * x1 + k2 * x2) / 1.0e-3 + phase).cos();
    1.0e-6 * (wave(1.0, 0.0, 0.3) + 0.6 * wave(2.0, 3.0, 1.1) + 0.3 * wave(-5.0, 7.0, 2.0) + 0.2 * wave(11.0, 4.0, 0.7))
}

#[test]
fn rough_periodic() {
    let builder: Parts = |start| {
        let grid = Grid::new([176, 192], [1.0e-3, 1.0e-3])?;
        let kernel = Arc::new(InfluenceKernel::periodic(&grid)?);
        let surface = FnGeometry::new(waves);
        Ok(start.builder(&grid).geometry(&surface).material(zener()?).kernel(kernel).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = vec![contact.step(0.0, Load::force(2.0e-3))?];
        for step in 0..3 {
            reports.push(contact.step(0.4, Load::force(2.0e-3 + 1.0e-3 * f64::from(step)))?);
        }
        Ok((contact, reports))
    });
}

#[test]
fn rough_periodic_surface_drawn_at_random() {
    let builder: Parts = |start| {
        let grid = Grid::square(192, 1.0e-3)?;
        let kernel = Arc::new(InfluenceKernel::periodic(&grid)?);
        let rough = start.rough(&grid, RoughSpec::new(0.5e-3, 0.03e-3, Roughness::RmsSlope(0.02)))?;
        Ok(start.builder(&grid).geometry(&rough).material(zener()?).kernel(kernel).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let reports = vec![contact.step(0.0, Load::force(1.0e-2))?, contact.step(0.5, Load::force(1.0e-2))?];
        Ok((contact, reports))
    });
}

/// A measured surface, shifted by a part of a cell by its Fourier series, on a sphere.
#[test]
fn measured_surface_shifted() {
    let builder: Parts = |start| {
        let grid = Grid::square(192, 1.0e-3)?;
        let cells = grid.cells();
        let heights = (0..grid.len()).map(|k| grid.center(k / cells[1], k % cells[1])).map(|[x1, x2]| waves(x1, x2));
        let map = HeightMap::new(cells, [1.0e-3; 2], heights.collect())?.periodic();
        let shape = Sum::new(Sphere::new(5.0e-3)?, Shifted::new(map, [1.7e-6, 0.4e-6])?);
        Ok(start.builder(&grid).geometry(&shape).material(zener()?).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let reports = vec![contact.step(0.0, Load::force(1.0e-2))?, contact.step(0.5, Load::force(1.0e-2))?];
        Ok((contact, reports))
    });
}

#[test]
fn line() {
    let builder: Parts = |start| {
        let grid = Grid::new([25_000, 1], [4.0e-3, 1.0])?;
        let kernel = Arc::new(InfluenceKernel::line(&grid, 1.0)?);
        let cylinder = Cylinder::new(10.0e-3)?;
        let settings = settings().with_symmetry(false);
        Ok(start.builder(&grid).geometry(&cylinder).material(zener()?).kernel(kernel).settings(settings))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = vec![contact.step(0.0, Load::force(100.0))?];
        for _ in 0..3 {
            reports.push(contact.step(0.4, Load::force(100.0))?);
        }
        Ok((contact, reports))
    });
}

/// Periodic along x1 alone, so that the rows of the pyramid go on at the other end.
#[test]
fn wave_across_a_strip() {
    let builder: Parts = |start| {
        let grid = Grid::new([192, 176], [1.0e-3, 1.0e-3])?;
        let kernel = Arc::new(InfluenceKernel::periodic_along(&grid, 0, 1.0e-2)?);
        let surface = FnGeometry::new(|x1, x2| 400.0 * x2 * x2 + waves(x1, x2));
        Ok(start.builder(&grid).geometry(&surface).material(zener()?).kernel(kernel).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let reports = vec![contact.step(0.0, Load::force(0.02))?, contact.step(0.5, Load::force(0.02))?];
        Ok((contact, reports))
    });
}

#[test]
fn layer() {
    let builder: Parts = |start| {
        let grid = Grid::square(192, 4.0e-3)?;
        let layer = Layer::bonded_to_rigid(1.0e-3, 0.4)?;
        let kernel = Arc::new(InfluenceKernel::layer(&grid, layer)?);
        let body = Material::constant_poisson(Zener::new(1.0e6, 1.0e6, 1.0e6)?, 0.4)?;
        let settings = settings().with_symmetry(false);
        let sphere = Sphere::new(10.0e-3)?;
        Ok(start.builder(&grid).geometry(&sphere).material(body).kernel(kernel).settings(settings))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let reports = vec![contact.step(0.0, Load::force(1.0))?, contact.step(0.5, Load::force(1.0))?];
        Ok((contact, reports))
    });
}

#[test]
fn adaptive_loading_and_unloading() {
    let builder: Parts = |start| {
        let grid = Grid::square(384, 4.0e-3)?;
        Ok(start.builder(&grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let table = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.5, 0.0)].map(|(time, force)| (time, Load::force(force)));
        let history = PiecewiseLinear::new(&table)?;
        let mut reports = Vec::new();
        let mut run = contact.follow(&history, Stepping::adaptive(2.0e-2), 2.5);
        while let Some(report) = run.next_step()? {
            reports.push(report);
        }
        drop(run);
        // pressed once more, so that there is a field to compare
        reports.push(contact.step(0.1, Load::force(0.3))?);
        Ok((contact, reports))
    });
}

/// A body that flows, whose approach is held: the pressure falls by many decades, and its guess is the last one, scaled.
#[test]
fn maxwell_held() {
    let builder: Parts = |start| {
        let grid = Grid::square(384, 4.0e-3)?;
        let body = Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?);
        Ok(start.builder(&grid).geometry(&Sphere::new(10.0e-3)?).material(body).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        let mut reports = vec![contact.step(0.0, Load::approach(1.0e-4))?];
        for dt in [0.1, 0.5, 2.0, 5.0] {
            reports.push(contact.step(dt, Load::approach(1.0e-4))?);
        }
        // a jump that asks for no pressure
        reports.push(contact.step(0.0, Load::force(0.5))?);
        Ok((contact, reports))
    });
}

/// Snapshots go back on all ranks alike.
#[test]
fn snapshots_go_back() {
    let builder: Parts = |start| {
        let grid = Grid::square(384, 4.0e-3)?;
        Ok(start.builder(&grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings()))
    };
    same_on_all(builder, |builder| {
        let mut contact = builder.build()?;
        contact.step(0.0, Load::force(1.0))?;
        let snapshot = contact.snapshot();
        contact.step(0.3, Load::force(2.0))?;
        contact.restore(&snapshot)?;
        let reports = vec![contact.step(0.3, Load::force(1.0))?];
        Ok((contact, reports))
    });
}
