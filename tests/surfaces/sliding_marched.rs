//! Steady motions as one problem against marching to the limit by steps of one cell. `SLIDING_MARCHES` (4) random scenes, `SLIDING_CELLS` (32) cells a side, and half
//! as many, `SLIDING_SEED` (1).

use std::f64::consts::TAU;

use crate::common::march::march;
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::prelude::*;

/// Waves on a period of 1 m, terms with reaches up to three periods, and a force.
#[derive(Debug, Clone)]
struct Scene {
    waves: Vec<[f64; 4]>,
    terms: Vec<(f64, f64)>,
    force: f64,
    axis: Axis,
    velocity: f64,
    thickness: Option<f64>,
}

impl Scene {
    fn draw(draws: &mut Draws) -> Scene {
        let mut waves: Vec<[f64; 4]> = (0..8)
            .map(|_| {
                let [a, b] = [draws.below(6) as f64, draws.below(6) as f64];
                [a, b, draws.between(0.0, TAU), draws.between(0.2, 1.0) * 1e-2 / (1.0 + a * a + b * b)]
            })
            .collect();
        (waves[0][0], waves[1][1]) = (1.0, 1.0);
        let terms: Vec<_> = (0..1 + draws.below(3)).map(|_| (draws.scale(0.3, 6.0), draws.scale(0.02, 3.0))).collect();
        let relaxed: f64 = 1e-6 * (1.0 + terms.iter().map(|(c, _)| c).sum::<f64>());
        Scene {
            waves,
            terms,
            force: draws.scale(0.03, 0.5) * 3e-2 / relaxed,
            axis: if draws.chance(0.5) { Axis::X1 } else { Axis::X2 },
            velocity: if draws.chance(0.5) { 1.0 } else { -1.0 },
            thickness: draws.chance(0.3).then(|| draws.scale(0.05, 0.5)),
        }
    }

    fn shape(&self) -> impl Geometry + 'static {
        let waves = self.waves.clone();
        FnGeometry::new(move |x1: f64, x2: f64| {
            waves.iter().map(|[a, b, phase, h]| h * (TAU * (a * x1 + b * x2) + phase).cos()).sum::<f64>()
        })
    }

    /// Friction by steps to the limit, and as one problem.
    fn frictions(&self, cells: usize) -> [f64; 2] {
        let grid = Grid::square(cells, 1.0).unwrap();
        let kernel = match self.thickness {
            Some(thickness) => {
                InfluenceKernel::layer_periodic(&grid, viscocontact::Layer::bonded_to_rigid(thickness, 0.5).unwrap())
            }
            None => InfluenceKernel::periodic(&grid),
        };
        let terms: Vec<_> = self.terms.iter().map(|&(c, time)| (4e-6 * c, time)).collect();
        let shape = self.shape();
        let builder = || {
            builder_of(
                &shape,
                grid.clone(),
                Material::incompressible(GeneralizedKelvin::new(4e-6, 0.0, &terms).unwrap()),
            )
        };
        let kernel = kernel.unwrap();
        let load = Load::force(self.force);
        let velocity = if self.axis == Axis::X1 { [self.velocity, 0.0] } else { [0.0, self.velocity] };
        let mut sliding = builder().kernel(kernel.clone()).build_sliding().unwrap();
        sliding.at(velocity, load).unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let settings = Settings::default().with_frame(Frame::Indenter).with_tolerance(1e-7);
        let mut marched = builder().kernel(kernel).settings(settings).build().unwrap();
        // a term is e^(−track/(v λ)) short of its limit
        let slowest = self.terms.iter().map(|(_, time)| *time).fold(0.0, f64::max);
        let track = (8.0 * self.velocity.abs() * slowest).max(1.0);
        march(&mut marched, self.axis, self.velocity, load, (track, 3e-4))
            .unwrap_or_else(|error| panic!("{self:?}: {error}"));
        // from the slope of the shape in both
        [marched.fields(), sliding.fields()]
            .map(|own| self.velocity * own.lateral_force(&shape)[self.axis.index()] / own.force())
    }
}

#[test]
fn marching_ends_where_the_problem_is_solved() {
    let scenes = from_environment("SLIDING_MARCHES", 4);
    let (cells, seed) = (from_environment("SLIDING_CELLS", 32) as usize, from_environment("SLIDING_SEED", 1));
    let mut errors = [Ratios::default(), Ratios::default()];
    for number in 0..scenes {
        let scene = Scene::draw(&mut Draws::new(9_000_000 * seed + number));
        let own = [cells / 2, cells].map(|cells| scene.frictions(cells));
        println!("{number}: {own:?}");
        for (errors, [marched, solved]) in errors.iter_mut().zip(own) {
            errors.push((marched / solved - 1.0).abs(), "");
        }
    }
    let [coarse, fine] = errors.map(|errors| [errors.median(), errors.greatest()]);
    println!("{scenes} scenes, median and greatest: {coarse:?} on {}², {fine:?} on {cells}²", cells / 2);
    // steps of a cell err in the second order of the mesh: 1 % and 3 % at 128²
    let mesh = (128.0 / cells as f64).powi(2);
    assert!(fine[0] < 0.01 * mesh && fine[1] < 0.03 * mesh && fine[0] < coarse[0], "{coarse:?} {fine:?}");
}
