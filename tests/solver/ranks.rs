//! A contact that ranks share out is the same as in one process, bit by bit, whatever their number.

use std::sync::Arc;

use viscocontact::prelude::*;
use viscocontact::ranks::{Ranks, Threads};

/// What is compared: reports as they print, to the last bit, and fields of the whole grid.
#[derive(Debug, PartialEq)]
struct Course {
    reports: Vec<String>,
    numbers: Vec<u64>,
    pressure: Vec<u64>,
    displacement: Vec<u64>,
}

/// A scene on all rows, or on those of a rank.
type Scene = fn(Builder) -> Result<(ViscoelasticContact, Vec<StepReport>), Error>;

fn with_ranks(builder: Builder, ranks: Option<Arc<dyn Ranks>>) -> Builder {
    match ranks {
        Some(ranks) => builder.ranks(ranks),
        // a process by itself computes all of the grid, as ranks do
        None => builder,
    }
}

/// What a rank sees; fields on rank 0 alone.
fn course(builder: fn() -> Result<Builder, Error>, scene: Scene, ranks: Option<Arc<dyn Ranks>>) -> Result<Course, Error> {
    let (contact, reports) = scene(with_ranks(builder()?, ranks))?;
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

/// Compares the scene on 1 to 5 ranks with that of one process.
fn same_on_all(builder: fn() -> Result<Builder, Error>, scene: Scene) {
    let alone = course(builder, scene, None).unwrap();
    assert!(alone.pressure.iter().any(|&p| p != 0) && !alone.reports.is_empty());
    for size in [1, 2, 3, 4, 5] {
        let courses = Threads::run(size, |ranks| course(builder, scene, Some(ranks))).unwrap();
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
    let builder = || {
        let grid = Grid::square(384, 4.0e-3)?;
        Ok(ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings()))
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
    let builder = || {
        let settings = settings().with_symmetry(false);
        let grid = Grid::new([203, 178], [4.0e-3, 3.6e-3])?;
        Ok(ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings))
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
