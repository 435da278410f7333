//! Shapes, height maps, their laws, and laws of attraction.

use viscocontact::ErrorKind::{File, Value};
use viscocontact::adhesion::{Attraction, Dugdale, VanDerWaals, laws as attraction_laws};
use viscocontact::analytic::{Dmt, MaugisDugdale, RigidPunch};
use viscocontact::geometry::{LengthUnit, laws};
use viscocontact::prelude::*;
use viscocontact::states::ElasticStates;

use super::Table;

/// An attraction that grows with the gap.
#[derive(Debug)]
struct Growing;

impl Attraction for Growing {
    fn traction(&self, gap: f64) -> f64 {
        1.0e3 * gap / (1.0e-6 + gap)
    }
    fn energy(&self, _: f64) -> f64 {
        0.1
    }
    fn range(&self) -> f64 {
        1.0e-6
    }
}

/// A shape whose field depends on what was there before, or is not shifted.
#[derive(Debug)]
struct Careless {
    adds: bool,
}

impl Careless {
    fn add_to(&self, grid: &Grid, gap: &mut [f64]) {
        let n2 = grid.cells()[1];
        for (k, value) in gap.iter_mut().enumerate() {
            let [x1, x2] = grid.center(k / n2, k % n2);
            *value += self.initial_gap(x1, x2);
        }
    }
}

impl Geometry for Careless {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        x1 * x1 + x2 * x2
    }
    fn fill_gap_at(&self, grid: &Grid, _: [f64; 2], gap: &mut [f64]) {
        gap.iter_mut().for_each(|value| *value = if self.adds { *value } else { 1.0e-3 });
        self.add_to(grid, gap);
    }
    fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
        gap.iter_mut().for_each(|value| *value = if self.adds { *value } else { 0.0 });
        self.add_to(grid, gap);
    }
}

fn map() -> HeightMap {
    HeightMap::new([2, 2], [1.0e-3; 2], vec![0.0, 1.0e-6, 2.0e-6, 3.0e-6]).unwrap()
}

pub fn rows(t: &mut Table) {
    for (width, says) in [
        (0.009, "width of the end of Dugdale's law = 0.009 → in [0.01, 2]"),
        (2.1, "width of the end of Dugdale's law = 2.1 → in [0.01, 2]"),
        (f64::NAN, "width of the end of Dugdale's law = NaN → in [0.01, 2]"),
    ] {
        t.row("Dugdale::with_width", Dugdale::new(0.1, 1.0e-6).unwrap().with_width(width), Value, says);
    }
    t.row(
        "attracts_less_with_the_gap",
        attraction_laws::attracts_less_with_the_gap(&Growing),
        Value,
        "the traction does not grow with the gap: …1e-9 m is 0.999…",
    );
    for ([work, range], says) in [
        ([0.0, 1.0e-6], "work of separation = 0.0 → finite and > 0"),
        ([0.1, f64::NAN], "range of the attraction = NaN → finite, > 0 and at most 1e300 m"),
        ([1.0e-300, 1.0e300], "greatest traction of the attraction = 0.0 → finite and > 0"),
        ([1.0e300, 1.0e-300], "greatest traction of the attraction = inf → finite and > 0"),
    ] {
        t.row("VanDerWaals::new", VanDerWaals::new(work, range), Value, says);
    }
    for (k, says) in [
        "radius = … → finite and > 0",
        "contact modulus = … → finite and > 0",
        "work of separation = … → finite and > 0",
        "traction = … → finite and > 0",
    ]
    .into_iter()
    .enumerate()
    {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut values = [1.0e-3, 1.0e6, 0.05, 1.0e5];
            values[k] = bad;
            let [radius, modulus, work, traction] = values;
            t.row("MaugisDugdale::new", MaugisDugdale::new(radius, modulus, work, traction), Value, says);
            if k < 3 {
                t.row("Dmt::new", Dmt::new(radius, modulus, work), Value, says);
            }
        }
    }
    for ([radius, modulus, force, eccentricity], says) in [
        ([0.0, 1.0e6, 1.0, 0.0], "punch radius = 0.0 → finite and > 0"),
        ([1.0e-3, f64::NAN, 1.0, 0.0], "contact modulus = NaN → finite and > 0"),
        ([1.0e-3, 1.0e6, -1.0, 0.0], "force = -1.0 → finite and >= 0"),
        ([1.0e-3, 1.0e6, 1.0, -0.4e-3], "eccentricity = -0.0004 → in [-R/3, R/3], otherwise the contact opens"),
        ([1.0e-3, 1.0e6, 1.0, f64::NAN], "eccentricity = NaN → in [-R/3, R/3], otherwise the contact opens"),
    ] {
        t.row("RigidPunch::new", RigidPunch::new(radius, modulus, force, eccentricity), Value, says);
    }

    let grid = Grid::square(8, 1.0e-3).unwrap();
    t.row(
        "repeats_itself",
        laws::repeats_itself(&Careless { adds: true }, &grid),
        Value,
        "repeated evaluations give the same gap: gap on cell [0, 0] …",
    );
    t.row(
        "zero_shift_changes_nothing",
        laws::zero_shift_changes_nothing(&Careless { adds: false }, &grid),
        Value,
        "a shift by zero changes nothing: gap on cell [0, 0] …",
    );
    for shift in [[f64::NAN, 0.0], [0.0, f64::INFINITY]] {
        t.row("Shifted::new", Shifted::new(Sphere::new(1.0).unwrap(), shift), Value, "shift along x… → finite");
    }
    t.row("HeightMap::new", HeightMap::new([0, 2], [1.0; 2], vec![]), Value, "cells along x1 = 0 → 1 or more");
    t.row(
        "HeightMap::new",
        HeightMap::new([2, 2], [1.0, -1.0], vec![0.0; 4]),
        Value,
        "length along x2 = -1.0 → finite and > 0",
    );
    t.row("HeightMap::new", HeightMap::new([2, 2], [1.0; 2], vec![0.0; 3]), Value, "heights: 3 given, 4 needed");
    t.row(
        "HeightMap::new",
        HeightMap::new([2, 1], [1.0; 2], vec![0.0, f64::INFINITY]),
        Value,
        "height 1 of the map is inf: …within ±1e300 m…",
    );
    t.row(
        "HeightMap::new",
        HeightMap::new([2, 1], [1.0; 2], vec![0.0, -2.0e300]),
        Value,
        "height 1 of the map is -2e300: …within ±1e300 m…",
    );
    t.row("HeightMap::scaled", map().scaled(f64::NAN), Value, "factor of the heights = NaN → finite");
    t.row("HeightMap::scaled", map().scaled(1.0e307), Value, "height 1 of the map is 9.99…e300: …within ±1e300 m…");
    let gsf = |lines: &str, heights: usize| {
        let mut file = format!("Gwyddion Simple Field 1.0\n{lines}").into_bytes();
        file.resize(file.len() + 4 - file.len() % 4, 0);
        file.resize(file.len() + 4 * heights, 0);
        HeightMap::from_gsf(&file[..], None)
    };
    let units = "XYUnits = mm\nZUnits = nm\n";
    for (lines, heights, kind, says) in [
        (
            format!("XRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\n{units}"),
            1,
            File,
            "the GSF file should hold 8 bytes of heights, but holds 4",
        ),
        (
            format!("XRes = 1\nYRes = two\nXReal = 5\nYReal = 10\n{units}"),
            2,
            File,
            "the GSF file has YRes = \"two\", which must be a whole number",
        ),
        (
            format!("XRes = 1\nYRes = 2\nYReal = 10\n{units}"),
            2,
            File,
            "the GSF file has no XReal: add it, or export the map anew",
        ),
        (
            format!("XRes = 1\nYRes = 2\nXReal = -5\nYReal = 10\n{units}"),
            2,
            File,
            "the GSF file has XReal = \"-5\", which must be > 0",
        ),
        (
            "XRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\nXYUnits = mm\n".into(),
            2,
            File,
            "the GSF file has no ZUnits, …: give it, as to HeightMap::from_gsf",
        ),
        (
            "XRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\nXYUnits = mm\nZUnits = inch\n".into(),
            2,
            File,
            "\"inch\" is not a known unit of length: m, cm, mm, …",
        ),
        (format!("XRes = 0\nYRes = 2\nXReal = 5\nYReal = 10\n{units}"), 0, Value, "cells along x1 = 0 → 1 or more"),
    ] {
        t.row("HeightMap::from_gsf", gsf(&lines, heights), kind, says);
    }
    t.row(
        "HeightMap::from_gsf",
        HeightMap::from_gsf(&b"GIF89a"[..], Some(LengthUnit::Metre)),
        File,
        "not a GSF file: it does not begin with…export it anew…",
    );
    let points = |points: &[[f64; 3]]| HeightMap::from_points(points);
    t.row("HeightMap::from_points", points(&[]), Value, "different x of the points: 0 given, at least 2 needed");
    t.row(
        "HeightMap::from_points",
        points(&[[0.0, 0.0, 1.0], [f64::NAN, 0.0, 1.0]]),
        Value,
        "x of the points = NaN → within ±1e30 m",
    );
    t.row(
        "HeightMap::from_points",
        points(&[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]),
        Value,
        "different x of the points: 1 given, at least 2 needed",
    );
    let square = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]];
    t.row(
        "HeightMap::from_points",
        points(&[&square[..], &[[1.0, 1.0, 2.0]]].concat()),
        File,
        "lines 4 and 5 give two heights for the point (1, 1) m: give their mean",
    );
    t.row(
        "HeightMap::from_points",
        points(&[&square[..], &[[2.3, 1.0, 2.0]]].concat()),
        File,
        "line 4: x = 1 m is 0.076 spacings…off the regular grid…",
    );
    let diagonal: Vec<_> = (0..200).map(|k| [f64::from(k), f64::from(k), 0.0]).collect();
    t.row("HeightMap::from_points", points(&diagonal), File, "200 points are too few for…200 x 200…: interpolate…");
    let away = map().centered_at([1.0, 0.0]).unwrap();
    t.row(
        "HeightMap::resampled",
        away.resampled(&grid),
        Value,
        "no height is known: …take a part of the map with heights",
    );
    t.row(
        "HeightMap::resampled",
        map().resampled(&Grid::square(1 << 20, 1.0e-3).unwrap()),
        viscocontact::ErrorKind::Memory,
        "a map on another grid needs 8796093022208 bytes…take fewer cells…",
    );

    for radius in [0.0, -1.0e-6, f64::NAN, 1.0e200] {
        t.row("ElasticStates::punch", ElasticStates::punch(radius), Value, "punch radius = … → in [1e-100, 1e100]");
    }
    let state = (1.0e-12, 1.0e-6, 1.0e-6, 1.0e-12);
    for (rows, says) in [
        (vec![], "elastic states: 0 given, at least 2 needed"),
        (vec![state], "elastic states: 1 given, at least 2 needed"),
        (vec![state, (2.0e-12, 2.0e-6, f64::NAN, 1.0e-12)], "stiffness of an elastic state = NaN → finite and > 0"),
        (vec![state, (2.0e-12, 1.0e-6, 1.0e-6, 1.0e-12)], "approaches of elastic states[1] = 1e-6 …must ascend"),
        (vec![state, (0.5e-12, 2.0e-6, 1.0e-6, 1.0e-12)], "levels of elastic states[1] = 5e-13 …must ascend"),
        (vec![state, (2.0e-12, 2.0e-6, 1.0e-6, 0.0)], "area of an elastic state = 0.0 → finite and > 0"),
    ] {
        t.row("ElasticStates::from_table", ElasticStates::from_table(&rows), Value, says);
    }
    let sweep = || Sweep::new(grid.clone(), &Sphere::new(1.0e-3).unwrap());
    let run = |sweep: Sweep, to: Reach| sweep.run_with(to, |_| std::ops::ControlFlow::Continue(()));
    t.row(
        "Sweep::run_with",
        run(sweep().accuracy(0.5), Reach::Approach(1.0e-6)),
        Value,
        "accuracy of a sweep = 0.5 → in [1e-8, 0.1]",
    );
    t.row(
        "Sweep::run_with",
        run(sweep().max_states(2), Reach::Approach(1.0e-6)),
        Value,
        "states of a sweep = 2 → 3 or more",
    );
    t.row("Sweep::run_with", run(sweep(), Reach::Approach(0.0)), Value, "reach of a sweep = 0.0 → finite and > 0");
    t.row("Sweep::run_with", run(sweep(), Reach::Approach(f64::NAN)), Value, "reach of a sweep = NaN → finite and > 0");
    t.row(
        "Sweep::run_with",
        run(sweep(), Reach::Approach(1.0e-3)),
        Value,
        "at t = 0 s the contact touches the edge…: enlarge the grid…",
    );
}
