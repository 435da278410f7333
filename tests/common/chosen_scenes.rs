//! Scenes that ranks share out, each chosen for a way in which cells, rows or loads are treated.

use std::f64::consts::TAU;
use std::sync::Arc;

use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

use super::any_scene::{AnyScene, Steps};
use super::bodies::maxwell;
use super::spheres::sphere;

/// Steps of given length, each to a force.
fn forces(steps: &[(f64, f64)]) -> Steps {
    Steps::Given(steps.iter().map(|&(dt, force)| (dt, Load::force(force))).collect())
}

/// A few waves of different lengths and directions, periodic on a square of 1 mm.
fn waves(x1: f64, x2: f64) -> f64 {
    let wave = |k1: f64, k2: f64, phase: f64| (TAU * (k1 * x1 + k2 * x2) / 1.0e-3 + phase).cos();
    1.0e-6 * (wave(1.0, 0.0, 0.3) + 0.6 * wave(2.0, 3.0, 1.1) + 0.3 * wave(-5.0, 7.0, 2.0) + 0.2 * wave(11.0, 4.0, 0.7))
}

/// A flat punch under an eccentric force that moves, until the rim lifts off.
pub fn punch() -> AnyScene {
    let punch = FlatPunch::rectangular([0.8e-3, 0.6e-3]).unwrap();
    let at = [0.1e-3, 0.13e-3, 0.16e-3, 0.19e-3, 0.25e-3].map(|at| Load::eccentric_force(1.0, [at, 0.05e-3]));
    let steps = at.into_iter().enumerate().map(|(k, load)| (if k == 0 { 0.0 } else { 0.2 }, load)).collect();
    let scene = AnyScene::plain("punch", Grid::new([170, 161], [1.2e-3, 1.0e-3]).unwrap(), punch, Steps::Given(steps));
    AnyScene { settings: scene.settings.with_symmetry(false), ..scene }
}

/// Waves on periodic bodies.
pub fn rough() -> AnyScene {
    let grid = Grid::new([176, 192], [1.0e-3, 1.0e-3]).unwrap();
    let kernel = Arc::new(InfluenceKernel::periodic(&grid).unwrap());
    let steps = forces(&[(0.0, 2.0e-3), (0.4, 2.8e-3), (0.3, 2.6e-3), (0.4, 4.0e-3), (0.2, 9.0e-3)]);
    AnyScene { kernel, ..AnyScene::plain("rough", grid, FnGeometry::new(waves), steps) }
}

/// A sphere in the middle: a quarter of the cells is computed.
pub fn folded() -> AnyScene {
    let steps = forces(&[(0.0, 1.0), (0.3, 1.2), (0.3, 1.0), (0.3, 0.4)]);
    AnyScene::plain("folded", Grid::square(384, 4.0e-3).unwrap(), sphere(), steps)
}

/// Symmetric about one axis alone: half of the rows is computed, by other ranks than had evaluated them, or half of each
/// row, in other bands.
pub fn beside(axis: usize) -> AnyScene {
    let by = if axis == 0 { [0.31e-3, 0.0] } else { [0.0, 0.1e-3] };
    let shape = Shifted::new(sphere(), by).unwrap();
    let steps = forces(&[(0.0, 0.15), (0.3, 0.2)]);
    AnyScene::plain("beside the middle", Grid::new([384, 201], [4.0e-3, 2.1e-3]).unwrap(), shape, steps)
}

pub fn line() -> AnyScene {
    let grid = Grid::new([25_000, 1], [4.0e-3, 1.0]).unwrap();
    let kernel = Arc::new(InfluenceKernel::line(&grid, 1.0).unwrap());
    let steps = forces(&[(0.0, 100.0), (0.4, 110.0), (0.4, 100.0)]);
    let scene = AnyScene::plain("line", grid, Cylinder::new(10.0e-3).unwrap(), steps);
    AnyScene { kernel, settings: scene.settings.with_symmetry(false), ..scene }
}

/// Steps chosen by their error on a body of two relaxation times: ranks begin within a block of the past, and one of five has
/// no rows.
pub fn adaptive() -> AnyScene {
    let table = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.3)].map(|(time, force)| (time, Load::force(force)));
    let history = Box::new(PiecewiseLinear::new(&table).unwrap());
    let steps = Steps::Along(history, Stepping::adaptive(3.0e-3), 2.0);
    let body = GeneralizedMaxwell::new(1.0e6, &[(1.0e6, 0.3), (0.5e6, 2.0)]).unwrap();
    let scene = AnyScene::plain("adaptive", Grid::new([384, 340], [4.0e-3, 3.6e-3]).unwrap(), sphere(), steps);
    AnyScene { material: Material::incompressible(body), ..scene }
}

/// Bodies that are too steep or too flat, and the names of their warnings.
pub fn sloped() -> [(AnyScene, &'static str); 4] {
    let pressed = |depth: f64| Steps::Given(vec![(0.0, Load::approach(depth)), (0.1, Load::approach(depth))]);
    let grid = Grid::new([192, 176], [1.0e-3, 1.0e-3]).unwrap();
    let cone = AnyScene::plain("cone", grid.clone(), Cone::new(0.8).unwrap(), pressed(1.0e-4));
    let beside = FnGeometry::new(|x1: f64, x2: f64| 0.9 * (x1 - 3.1e-5).hypot(0.8 * (x2 + 1.7e-5)));
    let beside = AnyScene::plain("elliptic cone", grid.clone(), beside, pressed(1.0e-4));
    let rough = AnyScene { steps: pressed(2.0e-5), ..rough() };
    let steep = RoughSpec::new(0.5e-3, 0.03e-3, Roughness::RmsSlope(0.4));
    let rough = AnyScene { shape: Box::new(Rough::new(&rough.grid, steep).unwrap()), ..rough };
    let flat = AnyScene::plain("ball of a kilometre", grid, Sphere::new(1.0e3).unwrap(), pressed(1.0e-11));
    [(cone, "STEEP"), (beside, "STEEP"), (rough, "STEEP"), (flat, "FLAT")]
}

/// All of these but the sloped ones, and more.
pub fn all() -> Vec<AnyScene> {
    let square = |cells: usize| Grid::square(cells, 1.0e-3).unwrap();
    let two = |force: f64| forces(&[(0.0, force), (0.5, force)]);
    let mut scenes = vec![folded(), beside(0), beside(1), punch(), rough(), line(), adaptive()];

    let steps = [
        (0.0, Load::force(1.0)),
        (0.3, Load::force(1.5)),
        (0.5, Load::approach(2.0e-4)),
        (0.5, Load::approach(2.0e-4)),
        (0.2, Load::force(0.2)),
    ];
    let grid = Grid::new([203, 178], [4.0e-3, 3.6e-3]).unwrap();
    let whole = AnyScene::plain("whole", grid, sphere(), Steps::Given(steps.to_vec()));
    scenes.push(AnyScene { settings: whole.settings.with_symmetry(false), ..whole });

    let rough = RoughSpec::new(0.5e-3, 0.03e-3, Roughness::RmsSlope(0.02));
    let rough = Rough::new(&square(192), rough).unwrap();
    let drawn = AnyScene::plain("drawn at random", square(192), rough, two(1.0e-2));
    let kernel = Arc::new(InfluenceKernel::periodic(&drawn.grid).unwrap());
    scenes.push(AnyScene { kernel, ..drawn });

    // shifted by a part of a cell by its Fourier series
    let grid = square(192);
    let heights = (0..grid.len()).map(|k| grid.center(k / 192, k % 192)).map(|[x1, x2]| waves(x1, x2)).collect();
    let map = HeightMap::new([192; 2], [1.0e-3; 2], heights).unwrap().periodic();
    let shape = Sum::new(Sphere::new(5.0e-3).unwrap(), Shifted::new(map, [1.7e-6, 0.4e-6]).unwrap());
    scenes.push(AnyScene::plain("measured", grid, shape, two(1.0e-2)));

    // periodic along x1 alone: the rows of the pyramid go on at the other end
    let grid = Grid::new([192, 176], [1.0e-3, 1.0e-3]).unwrap();
    let kernel = Arc::new(InfluenceKernel::periodic_along(&grid, Axis::X1, 1.0e-2).unwrap());
    let ridge = FnGeometry::new(|x1, x2| 400.0 * x2 * x2 + waves(x1, x2));
    scenes.push(AnyScene { kernel, ..AnyScene::plain("strip", grid, ridge, two(0.02)) });

    let grid = Grid::square(192, 4.0e-3).unwrap();
    let layer = Layer::bonded_to_rigid(1.0e-3, 0.4).unwrap();
    let kernel = Arc::new(InfluenceKernel::layer(&grid, layer).unwrap());
    let material = Material::constant_poisson(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap(), 0.4).unwrap();
    let scene = AnyScene::plain("layer", grid, sphere(), two(1.0));
    scenes.push(AnyScene { kernel, material, settings: scene.settings.with_symmetry(false), ..scene });

    // the pressure falls by many decades, and its guess is the last one, scaled; then a jump that asks for no pressure
    let mut steps = [0.0, 0.1, 0.5, 2.0, 5.0].map(|dt| (dt, Load::approach(1.0e-4))).to_vec();
    steps.push((0.0, Load::force(0.5)));
    let scene = AnyScene::plain("held", Grid::square(384, 4.0e-3).unwrap(), sphere(), Steps::Given(steps));
    scenes.push(AnyScene { material: maxwell(), ..scene });
    scenes
}
