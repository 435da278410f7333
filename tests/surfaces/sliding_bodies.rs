//! Steady motions over a half-space that flows, and by a modulus over frequency. Layers are in `sliding_chains`.

use std::f64::consts::{PI, TAU};

use crate::common::builder_of;
use crate::common::gauss::points;
use crate::common::moving_bodies::Creep;
use crate::common::steady_sliding::{Below, SteadySliding as Dense};
use viscocontact::prelude::*;

const GLASSY: f64 = 0.25e-6;

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
    let lateral = sliding.fields().slope_force(&shape)[0] / force;
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
    let shape = FnGeometry::new(|x1: f64, x2: f64| 2e-3 * (2.0 - (TAU * x1).cos() - (TAU * x2).cos()));
    let body = || Creep { glassy: 1.0, terms: vec![(2.0, 0.05), (4.0, 1.0)] }.times(GLASSY).material(0.5);
    let builder = || {
        let kernel = InfluenceKernel::periodic(&grid).unwrap();
        builder_of(&shape, grid.clone(), body()).kernel(kernel).settings(Settings::default().with_tolerance(1e-11))
    };
    let series = body().contact_spectrum().unwrap().unwrap();
    let mut by_series = builder().build_sliding().unwrap();
    let mut by_modulus = builder().build_sliding_by(move |omega: f64| series.complex_modulus(omega)).unwrap();
    for velocity in [[0.01, 0.0], [0.3, -2.0], [-40.0, 0.0]] {
        let [found, exact] = [&mut by_modulus, &mut by_series].map(|own| own.at(velocity, Load::force(20.0)).unwrap());
        let errors = [found.friction() / exact.friction() - 1.0, found.approach / exact.approach - 1.0];
        assert!(errors.iter().all(|error| error.abs() < 1e-8), "{velocity:?}: {errors:?}");
    }
}
