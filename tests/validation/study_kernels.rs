//! Studies on all bodies: random shapes on layers, periodic bodies, lines and half-spaces, under steps, ramps, holds and
//! sines of force and approach, compared with a run on finer cells in shorter steps. `STUDIES_KERNELS`, `STUDIES_FIRST` and
//! `STUDIES_SEED` choose how many and which, `STUDIES_CELLS` the side of the largest mesh that is run.

use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

use super::study_random::{Kernel, Other, Scene, accuracy, history, tell_their_errors};
use crate::common::{Draws, from_environment};

fn scene(seed: u64, number: u64) -> Scene {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_033).wrapping_add(number));
    let ratio = draws.power_of_ten(0.3, 2.0);
    let time = draws.power_of_ten(-2.0, 0.3);
    // E* = 4 G is 1 Pa at once
    let creep = GeneralizedKelvin::new(4.0, 0.0, &[(4.0 * (ratio - 1.0), time)]).unwrap();
    let material = Material::incompressible(creep);
    let rough = |height: f64| {
        let grid = Grid::square(64, 1.0).unwrap();
        let spec = RoughSpec::new(0.5, 0.12, Roughness::RmsHeight(height)).with_seed(number);
        Rough::new(&grid, spec).unwrap()
    };
    let thickness = draws.power_of_ten(-1.0, 0.5);
    let layer = Layer::bonded_to_rigid(thickness, 0.5).unwrap();
    let half_space = || -> Kernel { Box::new(InfluenceKernel::half_space) };
    let (kind, geometry, kernel, period, line, force): (_, Box<dyn Geometry>, Kernel, _, _, f64) = match draws.below(6)
    {
        0 => {
            let kernel: Kernel = Box::new(move |grid| InfluenceKernel::layer(grid, layer));
            ("ball on a layer", Box::new(Sphere::new(1.0).unwrap()), kernel, None, None, 0.01)
        }
        1 => {
            let kernel: Kernel = Box::new(InfluenceKernel::periodic);
            ("periodic rough", Box::new(rough(0.01)), kernel, Some(1.0), None, 0.005)
        }
        2 => {
            let wave = |x1: f64, x2: f64| {
                let turn = std::f64::consts::TAU;
                0.01 * (2.0 - (turn * x1).cos() - (turn * x2).cos())
            };
            let kernel: Kernel = Box::new(InfluenceKernel::periodic);
            ("periodic wave", Box::new(FnGeometry::new(wave)), kernel, Some(1.0), None, 0.005)
        }
        3 => {
            let kernel: Kernel = Box::new(|grid| InfluenceKernel::line(grid, 100.0));
            let cylinder = FnGeometry::new(|x1: f64, _| 0.5 * x1 * x1);
            ("cylinder", Box::new(cylinder), kernel, None, Some(2.0), 0.02)
        }
        4 => {
            let kernel: Kernel = Box::new(move |grid| InfluenceKernel::layer_line(grid, layer, None));
            let cylinder = FnGeometry::new(|x1: f64, _| 0.5 * x1 * x1);
            ("cylinder on a layer", Box::new(cylinder), kernel, None, Some(1.0), 0.02)
        }
        _ => {
            let tip = Sum::new(Sphere::new(1.0).unwrap(), rough(draws.power_of_ten(-4.0, -3.0)));
            ("rough tip", Box::new(tip), half_space(), None, None, 0.005)
        }
    };
    let by_force = draws.chance(0.5);
    let (force, depth) = (force * draws.power_of_ten(-1.0, 0.0) / ratio, 0.01 * draws.power_of_ten(-0.7, 0.3));
    // the approach of a periodic body and of a line is measured from another datum
    let by_force = by_force || period.is_some() || line.is_some();
    let full = |share: f64| if by_force { Load::force(share * force) } else { Load::approach(share * depth) };
    let (history_name, history) = history(draws, &full, 1.0);
    let accuracy = accuracy(draws);
    let by = if by_force { "force" } else { "approach" };
    let name = format!(
        "{seed}:{number} {kind} (layer {thickness:.2}), creep ×{ratio:.1} in {time:.2}, {history_name} of {by}, {accuracy:?}"
    );
    let (other, shape, until, area) = (Some(Other { kernel, period, line }), None, 1.0, false);
    Scene { name, shape, geometry, other, material, history, until, by_force, accuracy, area, aside: 0.0, ratio }
}

#[test]
fn studies_on_all_bodies_tell_their_errors() {
    let [seed, first] =
        [("STUDIES_SEED", 1), ("STUDIES_FIRST", 4)].map(|(name, default)| from_environment(name, default));
    let numbers = first..first + from_environment("STUDIES_KERNELS", 8);
    tell_their_errors(numbers.map(|number| scene(seed, number)), 128);
}
