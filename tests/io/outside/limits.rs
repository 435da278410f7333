//! Where warnings begin, and scenes that have none.

use std::sync::Arc;

use super::surfaces::Pressed;
use crate::common::{Draws, Features, Scene, builder_of, elastic, from_environment};
use viscocontact::Error;
use viscocontact::contact::Warnings;
use viscocontact::geometry::{Repeated, Sum};
use viscocontact::prelude::*;

/// A shape that a contact is given later is told of, too; a tilt presses a corner deeper.
#[test]
fn later_shapes_and_tilts_are_seen() {
    let grid = Grid::square(48, 1.0e-3).unwrap();
    let kernel = InfluenceKernel::periodic(&grid).unwrap();
    let wave = |length: f64| Wavy::new(10.0e-6, length).unwrap();
    let mut contact = builder_of(&wave(0.5e-3), grid, elastic()).kernel(kernel).build().unwrap();
    let warned = |contact: &mut ViscoelasticContact| contact.step(0.0, Load::force(0.1)).unwrap().figures.periods;
    assert_eq!(warned(&mut contact), None);
    contact.set_geometries(&[&wave(0.4e-3)]).unwrap();
    assert_eq!(warned(&mut contact), Some(2.5));
    contact.set_geometries(&[&wave(0.25e-3)]).unwrap();
    assert_eq!(warned(&mut contact), None);

    let grid = Grid::square(48, 3.0e-3).unwrap();
    let kernel = Arc::new(InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(0.2e-3, 0.3).unwrap()).unwrap());
    let punch = FlatPunch::rectangular([2.0e-3, 1.0e-3]).unwrap();
    let body = Material::constant_poisson(Elastic::new(1.0e6).unwrap(), 0.3).unwrap();
    for (tilt, symmetry) in [(0.0, true), (0.0, false), (0.02, true), (-0.02, false)] {
        let settings = Settings::default().with_symmetry(symmetry);
        let builder = builder_of(&punch, grid.clone(), body.clone()).kernel(Arc::clone(&kernel)).settings(settings);
        let load = Load::Approach { approach: 30.0e-6, tilt: [Tilt::Fixed(tilt), Tilt::Fixed(0.0)] };
        let report = builder.build().unwrap().step(0.0, load).unwrap();
        let edge = 15.5 * grid.spacing()[0];
        let compression = (30.0e-6 + f64::abs(tilt) * edge) / 0.2e-3;
        assert!((report.figures.compression.unwrap() / compression - 1.0).abs() < 1e-9, "{report} {compression}");
        assert_eq!(report.warnings.contains(Warnings::DEEP), tilt != 0.0, "{report}");
    }
}

/// Depths, periods and waves drawn at random, on both sides of their limits: warned of or refused exactly beyond them.
#[test]
fn limits_are_told_where_they_are() {
    let (mut deep, mut through, mut other, mut fine) = (0, 0, 0, 0);
    let count = from_environment("OUTSIDE_SCENES", 60);
    for number in 0..count {
        let mut draws = Draws::new(7_000_003 + number);
        let (length, cells) = (draws.power_of_ten(-9.0, 3.0), 24 + draws.below(25));
        let grid = Grid::square(cells, length).unwrap();
        // a ball into a layer on a rigid base
        let thickness = length * draws.power_of_ten(-1.5, 0.0);
        let share = draws.between(0.01, 1.2);
        let radius = length * length / (12.0 * share * thickness);
        let scene = Pressed::new(Sphere::new(radius).unwrap(), grid.clone(), share * thickness);
        let layer = match draws.below(3) {
            0 => Layer::bonded_to_rigid(thickness, draws.between(0.0, 0.49)),
            1 => Layer::frictionless_on_rigid(thickness, draws.between(0.0, 0.5)),
            _ => Layer::bonded_to_rigid(thickness, 0.5),
        };
        match scene.on_layer(layer.unwrap()).in_space() {
            Ok(report) => {
                let compression = report.figures.compression.unwrap();
                assert!((compression / share - 1.0).abs() < 0.05 && share < 1.05, "{number}: {report} {share}");
                assert_eq!(report.warnings.contains(Warnings::DEEP), compression > 0.2, "{number}: {report} {share}");
                deep += u32::from(compression > 0.2);
            }
            Err(Error::Step(StepError::ThroughLayer { depth, thickness: found, .. })) => {
                assert!(share > 0.95 && depth > found && found == thickness, "{number}: {share}");
                through += 1;
            }
            Err(error) => panic!("{number}: {error}"),
        }
        // a wave on a periodic body, and the same shifted on another shape
        let (whole, spoilt) = (1 + draws.below(cells / 3), draws.chance(0.5));
        let periods = whole as f64 + if spoilt { draws.between(0.01, 0.99) } else { 0.0 };
        let wave = Wavy::new(1.0e-3 * length / periods, length / periods).unwrap();
        let shape = Sum::new(
            Shifted::new(wave, [draws.between(-1.0, 1.0) * length, 0.0]).unwrap(),
            FnGeometry::new(|_, _| 0.0),
        );
        let report =
            Pressed::new(shape, grid, 0.5e-3 * length / periods).on(InfluenceKernel::periodic).in_space().unwrap();
        assert_eq!(report.warnings.contains(Warnings::OTHER_PERIOD), spoilt, "{number}: {report} {periods}");
        assert!(report.figures.periods.is_none_or(|found| (found / periods - 1.0).abs() < 1e-12), "{number}: {report}");
        assert!(!report.warnings.intersects(Warnings::STEEP | Warnings::FLAT), "{number}: {report}");
        let is_fine = (cells as f64) < 4.0 * periods * (1.0 - 1e-6);
        assert_eq!(report.warnings.contains(Warnings::SHORT_WAVES), is_fine, "{number}: {report} {periods}");
        other += u32::from(spoilt);
        fine += u32::from(is_fine);
    }
    assert!(
        [deep, through, other, fine].into_iter().all(|seen| seen * 20 >= count as u32),
        "{deep} {through} {other} {fine}"
    );
}

/// Random scenes inside the model, along their histories: nothing of what is outside is warned of.
#[test]
fn scenes_inside_the_model_give_no_false_alarm() {
    let outside = Warnings::STEEP
        | Warnings::FLAT
        | Warnings::MODULUS
        | Warnings::DEEP
        | Warnings::OTHER_PERIOD
        | Warnings::LONG_STEP
        | Warnings::NO_CONTACT;
    let (mut steps, mut runs) = (0, 0);
    for number in 0..from_environment("OUTSIDE_SCENES", 60) {
        let scene = match number % 3 {
            0 => Scene::draw(41, number, Features::ANY),
            1 => Scene::draw(41, number, Features::SPRING),
            _ => Scene::draw(41, number, Features::RETURNING),
        };
        let mut contact = scene.contact(1e-6);
        let mut run = contact.follow(scene.load(), Stepping::adaptive(1e-2), scene.body.until);
        while let Some(report) = run.next_step().unwrap_or_else(|error| panic!("{}: {error}", scene.name)) {
            let mut warned = report.warnings & outside;
            // layers are drawn thin enough for some scenes to be deep
            if report.figures.compression > Some(0.2) {
                warned -= Warnings::DEEP;
            }
            // few of the scenes have waves, of few cells
            if !scene.name.contains("wavy") && !scene.name.contains("rough") {
                warned |= report.warnings & Warnings::SHORT_WAVES;
            }
            assert!(warned.is_empty(), "{}: {report}", scene.name);
            steps += 1;
        }
        runs += 1;
    }
    assert!(runs > 0 && steps > 10 * runs, "{runs} {steps}");
}

/// A shape repeats after the period that it tells, and the shortest wave that it tells is its own.
#[test]
fn shapes_repeat_after_the_periods_that_they_tell() {
    let grid = Grid::new([24, 16], [3.0, 2.0]).unwrap();
    let rough = || Rough::new(&grid, RoughSpec::new(1.5, 0.6, Roughness::RmsHeight(0.01))).unwrap();
    let shapes: [(Box<dyn Geometry>, f64); 6] = [
        (Box::new(Wavy::new(0.1, 0.7).unwrap()), 0.7),
        (Box::new(Wavy::in_two_directions([0.1, 0.2], [0.7, 0.5]).unwrap()), 0.5),
        (Box::new(rough()), 0.6),
        (Box::new(rough().height_map().clone()), 0.5),
        (Box::new(Shifted::new(rough(), [0.3, -0.2]).unwrap()), 0.6),
        (Box::new(Repeated::new(Wavy::new(0.1, 0.7).unwrap(), [2.0, f64::INFINITY]).unwrap()), 0.7),
    ];
    let mut draws = Draws::new(9_000_001);
    for (shape, least) in &shapes {
        let waves = shape.waves();
        let shortest = waves.iter().flat_map(|waves| waves.shortest).fold(f64::INFINITY, f64::min);
        assert!((shortest / least - 1.0).abs() < 1e-12, "{shape:?}: {shortest}");
        let periods = [0, 1].map(|axis| waves[0].period[axis]);
        assert!(periods.iter().any(|period| period.is_finite()), "{shape:?}");
        for _ in 0..50 {
            let [x1, x2] = [draws.between(-2.0, 2.0), draws.between(-2.0, 2.0)];
            let here = shape.initial_gap(x1, x2);
            for (axis, period) in periods.into_iter().enumerate().filter(|(_, period)| period.is_finite()) {
                let there = if axis == 0 { [x1 + period, x2] } else { [x1, x2 + period] };
                assert!((shape.initial_gap(there[0], there[1]) - here).abs() < 1e-9, "{shape:?} {x1} {x2} {axis}");
            }
        }
    }
}
