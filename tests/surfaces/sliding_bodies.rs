//! Steady motions over layers whose limits are other bodies, over a half-space that flows, and by a modulus over frequency.

use std::f64::consts::{PI, TAU};

use crate::common::builder_of;
use crate::common::gauss::points;
use crate::common::moving_bodies::Creep;
use crate::common::steady_sliding::{Below, SteadySliding as Dense};
use viscocontact::Layer;
use viscocontact::prelude::*;
use viscocontact::sliding::SlidingReport;

const GLASSY: f64 = 0.25e-6;

/// Compliances relative to [`GLASSY`].
fn creep(glassy: f64, terms: Vec<(f64, f64)>) -> Creep {
    Creep { glassy, terms }.times(GLASSY)
}

/// A builder of a ball or a wavy indenter on a grid of 1 m.
fn pressed(kernel: impl Fn(&Grid) -> viscocontact::Result<InfluenceKernel>, grid: &Grid) -> Builder {
    let kernel = kernel(grid).unwrap();
    let periodic = kernel.periodic_axes();
    let shape = FnGeometry::new(move |x1: f64, x2: f64| {
        let along = |axis: usize, x: f64| if periodic[axis] { 2e-3 * (1.0 - (TAU * x).cos()) } else { 0.05 * x * x };
        along(0, x1) + along(1, x2)
    });
    ViscoelasticContact::builder(grid.clone())
        .geometry(&shape)
        .kernel(kernel)
        .settings(Settings::default().with_tolerance(1e-11))
}

fn body(factor: f64, nu: f64) -> Material {
    creep(factor, vec![(2.0 * factor, 0.05), (4.0 * factor, 1.0)]).material(nu)
}

/// The kernels of a body, without a layer and with one.
type Kernels = dyn Fn(&Grid, Option<Layer>) -> viscocontact::Result<InfluenceKernel>;

/// Friction and approach over two bases are the same to 1e-8.
fn same(what: &str, found: &SlidingReport, exact: &SlidingReport) {
    let errors = [found.friction() / exact.friction() - 1.0, found.approach / exact.approach - 1.0];
    println!("{what}: {errors:?}");
    assert!(errors.iter().all(|error| error.abs() < 1e-8), "{what}: {errors:?}");
}

/// The general layer on a base of its own material, on one as stiff in proportion, and on ever stiffer ones is the half-space, the layer whose base creeps as it
/// does, and the layer on a rigid base.
#[test]
fn bases_that_are_equal_elastic_or_rigid_are_limits() {
    let thickness = 0.1;
    let grids = [Grid::square(16, 1.0).unwrap(), Grid::new([48, 1], [1.0, 1.0]).unwrap()];
    let bodies: [(&Grid, &Kernels); 4] = [
        (&grids[0], &|grid, layer| {
            layer.map_or_else(|| InfluenceKernel::half_space(grid), |layer| InfluenceKernel::layer(grid, layer))
        }),
        (&grids[0], &|grid, layer| {
            layer.map_or_else(|| InfluenceKernel::periodic(grid), |layer| InfluenceKernel::layer_periodic(grid, layer))
        }),
        (&grids[0], &|grid, layer| match layer {
            Some(layer) => {
                let datum = format!("{layer}").contains("half-space").then_some(40.0);
                InfluenceKernel::layer_periodic_along(grid, layer, Axis::X2, datum)
            }
            None => InfluenceKernel::periodic_along(grid, Axis::X2, 40.0),
        }),
        (&grids[1], &|grid, layer| match layer {
            Some(layer) => {
                let datum = format!("{layer}").contains("half-space").then_some(40.0);
                InfluenceKernel::layer_line(grid, layer, datum)
            }
            None => InfluenceKernel::line(grid, 40.0),
        }),
    ];
    for (number, (grid, kernel)) in bodies.into_iter().enumerate() {
        // the mean of a compressible layer counts on a rigid base alone
        let nu = if number == 1 { 0.5 } else { 0.4 };
        for velocity in [[0.3, 0.0], [0.0, -0.3]] {
            if number == 3 && velocity[0] == 0.0 {
                continue;
            }
            let at = |sliding: viscocontact::Result<SteadySliding>| {
                sliding.unwrap().at(velocity, Load::force(20.0)).unwrap()
            };
            let half_space = at(pressed(|grid| kernel(grid, None), grid).material(body(1.0, nu)).build_sliding());
            let on = |base: Material| {
                let layer = Layer::bonded_to_material(thickness, &body(1.0, nu), &base).unwrap();
                let builder = || pressed(|grid| kernel(grid, Some(layer)), grid).material(body(1.0, nu));
                [at(builder().build_sliding_on(base)), at(builder().build_sliding())]
            };
            same(&format!("{number} equal"), &on(body(1.0, nu))[0], &half_space);
            let [general, own] = on(body(0.2, 0.3));
            same(&format!("{number} in proportion"), &general, &own);
            // linear in the compliance of the base but for its square
            let [stiff, stiffer] = [4e-6, 2e-6].map(|part| on(body(part, 0.3))[0]);
            let rigid = at(pressed(|grid| kernel(grid, Some(Layer::bonded_to_rigid(thickness, nu)?)), grid)
                .material(body(1.0, nu))
                .build_sliding());
            let limit = [
                (stiffer.friction(), stiff.friction(), rigid.friction()),
                (stiffer.approach, stiff.approach, rigid.approach),
            ];
            let errors = limit.map(|(stiffer, stiff, rigid)| (2.0 * stiffer - stiff) / rigid - 1.0);
            println!("{number} rigid: {errors:?}");
            assert!(errors.iter().all(|error| error.abs() < 1e-8), "{number}: {errors:?}");
        }
    }
}

/// A ball on a half-space that flows: the pressure is steady, from coefficients that are integrals over the whole way.
#[test]
fn a_half_space_may_flow() {
    let (n, m, fluidity, speed, force) = (32, 16, 2e-6, 1.5, 30.0);
    let grid = Grid::new([n, m], [2.0, 1.0]).unwrap();
    let d = grid.spacing()[0];
    let shape = FnGeometry::new(|x1: f64, x2: f64| 0.05 * (x1 * x1 + x2 * x2));
    let rheology = || GeneralizedKelvin::new(4.0 * GLASSY, 4.0 * fluidity, &[(8.0 * GLASSY, 0.2)]).unwrap();
    let builder = || builder_of(&shape, grid.clone(), Material::incompressible(rheology()));
    let mut sliding = builder().settings(Settings::default().with_tolerance(1e-10)).build_sliding().unwrap();
    let report = sliding.at([speed, 0.0], Load::force(force)).unwrap();
    let at = |k: usize, shift: f64| {
        let [x1, x2] = grid.center(k / m, k % m);
        0.05 * ((x1 + shift).powi(2) + x2 * x2)
    };
    let dense = Dense {
        below: Below::HalfSpace,
        cells: [n, m],
        spacing: grid.spacing(),
        glassy: GLASSY,
        terms: vec![(2.0 * GLASSY, 0.2 * speed)],
        gap: (0..n * m).map(|k| at(k, 0.0)).collect(),
        rise: (0..n * m).map(|k| at(k, 0.5 * d) - at(k, -0.5 * d)).collect(),
        force,
    };
    let mut table = dense.coefficients();
    for (j, row) in table.iter_mut().enumerate() {
        let love = |x: f64| dense.influence(x, j);
        // over a way of S, less what a point has done from the length of the grid on
        let (mut tail, mut from) = (0.0, n as f64 * d);
        while from < 1e7 {
            tail += points(from, 2.0 * from, 4).map(|(x, w)| w * love(x)).sum::<f64>();
            from *= 2.0;
        }
        let mut sum = tail - d * d / PI * (from / 2.0).ln();
        for i in (0..2 * n - 1).rev() {
            let x = (i as f64 - (n - 1) as f64) * d;
            sum +=
                points(x, x + 0.5 * d, 8).chain(points(x + 0.5 * d, x + d, 8)).map(|(x, w)| w * love(x)).sum::<f64>();
            row[i] += fluidity / speed * sum;
        }
    }
    let exact = dense.solve_by(&table).unwrap();
    let lateral = sliding.fields().lateral_force(&shape)[0] / force;
    let errors = [report.approach / exact.approach - 1.0, lateral / exact.friction - 1.0];
    println!("{errors:?} {report}");
    assert!(errors.iter().all(|error| error.abs() < 1e-6), "{errors:?}");
    for (velocity, load) in [([speed, 0.0], Load::approach(0.01)), ([0.0, 0.0], Load::force(force))] {
        assert!(sliding.at(velocity, load).unwrap_err().to_string().contains("flows"));
    }
}

/// A modulus over frequency that is the series' finds the same state; those that give energy away are in `sliding_asked`.
#[test]
fn a_modulus_over_frequency_is_its_series() {
    let grid = Grid::square(32, 1.0).unwrap();
    let builder = || pressed(InfluenceKernel::periodic, &grid);
    let series = body(1.0, 0.5).contact_spectrum().unwrap().unwrap();
    let modulus = move |omega: f64| series.complex_modulus(omega);
    let mut by_series = builder().material(body(1.0, 0.5)).build_sliding().unwrap();
    let mut by_modulus = builder().build_sliding_by(modulus).unwrap();
    for velocity in [[0.01, 0.0], [0.3, -2.0], [-40.0, 0.0]] {
        let [found, exact] = [&mut by_modulus, &mut by_series].map(|own| own.at(velocity, Load::force(20.0)).unwrap());
        same("modulus", &found, &exact);
    }
}
