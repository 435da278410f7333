//! How many elastic states does an accuracy take?

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::figures;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// Five shapes on 40² cells, and how deep they are pressed.
fn shapes(grid: &Grid) -> [(&'static str, Box<dyn Geometry>, f64); 5] {
    let waves = RoughSpec::new(0.5, 0.15, Roughness::RmsHeight(4e-3));
    let rough = Sum::new(Sphere::new(1.5).unwrap(), Rough::new(grid, waves).unwrap());
    [
        ("sphere", Box::new(Sphere::new(1.5).unwrap()), 0.08),
        ("cone", Box::new(Cone::new(0.2).unwrap()), 0.12),
        // flat in the middle
        ("blunt punch, r⁸", Box::new(FnGeometry::new(|x1: f64, x2: f64| 60.0 * x1.hypot(x2).powi(8))), 0.05),
        ("pyramid", Box::new(FnGeometry::new(|x1: f64, x2: f64| 0.2 * x1.abs().max(x2.abs()))), 0.1),
        ("rough ball", Box::new(rough), 0.08),
    ]
}

/// Sweeps keep the accuracy asked of them within a factor of two, against a sweep ten times as accurate as the finest of them.
#[test]
fn sweeps_are_as_accurate_as_asked() {
    let grid = Grid::square(40, 1.0).unwrap();
    let asked = [1e-2, 1e-3, 1e-4, 1e-5];
    let mut table = "| shape | 1e-2 | 1e-3 | 1e-4 | 1e-5 |\n|---|---|---|---|---|\n".to_owned();
    let mut curves = Vec::new();
    for (name, shape, depth) in shapes(&grid) {
        let sweep = |accuracy: f64, most: usize| -> Arc<ElasticStates> {
            let settings = Settings::default().with_tolerance(1e-10);
            let sweep = Sweep::new(grid.clone(), &*shape).accuracy(accuracy).max_states(most).settings(settings);
            sweep.run(Reach::Approach(depth)).unwrap()
        };
        let exact = sweep(1e-6, 4000);
        let mut points = Vec::new();
        table += &format!("| {name} |");
        for accuracy in asked {
            let states = sweep(accuracy, 4000);
            let (error, count) = (error_of(&states, &exact), states.states().len());
            println!("{name}, {accuracy:.0e}: {count} states of {}, {error:.1e}", exact.states().len());
            assert!(states.interpolation_error() <= accuracy, "{name}: {states:?}");
            assert!(error < 2.0 * accuracy, "{name}: {error:e} where {accuracy:e} is asked");
            table += &format!(" {count}: {error:.1e} |");
            points.push((count as f64, error));
        }
        table.push('\n');
        curves.push((name, points));
    }
    figures::figure("states against error", &table).unwrap();
    picture(curves);
}

/// A sweep that ends at its limit gives its error, or infinity.
#[test]
fn sweeps_that_end_at_their_limit_give_their_error() {
    let grid = Grid::square(40, 1.0).unwrap();
    let settings = Settings::default().with_tolerance(1e-10);
    let (mut compared, mut unknown, mut least) = (0, 0, f64::INFINITY);
    for (name, shape, depth) in shapes(&grid) {
        let sweep = |accuracy: f64, most: usize| {
            let sweep = Sweep::new(grid.clone(), &*shape).accuracy(accuracy).max_states(most).settings(settings);
            sweep.run(Reach::Approach(depth)).unwrap()
        };
        let exact = sweep(3e-6, 4000);
        assert!(exact.interpolation_error() <= 5e-6 && exact.states().len() < 4000, "{name}: {exact:?}");
        for most in [3, 10, 25, 40, 60, 100] {
            let states = sweep(3e-6, most);
            assert_eq!(states.states().len(), most);
            let (error, stated) = (error_of(&states, &exact), states.interpolation_error());
            println!("{name}, {most} states: {error:.1e}, stated {stated:.1e}");
            assert!(error < 2.0 * stated, "{name}, {most} states: {error:e}, stated {stated:e}");
            if stated.is_finite() {
                (compared, least) = (compared + 1, least.min(error / stated));
            } else {
                unknown += 1;
            }
        }
        // whatever the progress asks for is a limit, too
        let early = Sweep::new(grid.clone(), &*shape).run_with(Reach::Approach(depth), |_| ControlFlow::Break(()));
        assert_eq!(early.unwrap().interpolation_error(), f64::INFINITY);
    }
    assert!(compared >= 10 && unknown >= 10 && least > 1e-2, "{compared} {unknown} {least:e}");
}

/// Greatest error of the depth, relative to √(δ δ_last), over the levels of a finer sweep.
fn error_of(states: &ElasticStates, exact: &ElasticStates) -> f64 {
    let [first, last] = [exact.states().first().unwrap(), exact.states().last().unwrap()];
    let rest = exact.approach(0.0);
    let error = (0..=2000).map(|k| {
        let level = first.level * (last.level / first.level).powf(f64::from(k) / 2000.0);
        let depth = exact.approach(level) - rest;
        (states.approach(level) - exact.approach(level)).abs() / (depth * (last.approach - rest)).sqrt()
    });
    error.fold(0.0, f64::max)
}

/// Drawn where figures are written.
fn picture(curves: Vec<(&str, Vec<(f64, f64)>)>) {
    use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};

    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures/states_error.png");
    if !std::env::var("FIGURES").is_ok_and(|figures| figures == "write") {
        return;
    }
    let mut chart = Chart::new("Error of the depth between elastic states", "states", "error", Legend::UpperRight);
    chart.scale = Scale::LogLog;
    for ((name, points), color) in curves.into_iter().zip(COLORS) {
        chart.add(name, color, Style::LineAndDots, points);
    }
    chart.save(path).unwrap();
}
