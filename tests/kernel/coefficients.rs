//! The influence coefficients of every kernel: equations 8 and 12 of the paper.

use std::f64::consts::{FRAC_2_PI, PI, TAU};

use approx::abs_diff_eq;
use viscocontact::rheology::{Material, Maxwell, Zener};
use viscocontact::{Error, Grid, InfluenceKernel, KernelError, Layer};

/// A unit pressure on one cell displaces every other by its coefficient: even, odd and single cells along an axis.
fn assert_is_the_response_to_a_unit_pressure(kernel: &InfluenceKernel) {
    let [n1, n2] = kernel.grid().cells();
    let mut work = kernel.workspace().unwrap();
    let own = kernel.coefficient(0, 0).unwrap();
    for (k1, k2) in [(0, 0), (n1 - 1, n2 - 1), (n1 / 2, n2 / 3)] {
        let (mut pressure, mut displacement) = (vec![0.0; n1 * n2], vec![f64::NAN; n1 * n2]);
        pressure[k1 * n2 + k2] = 1.0;
        kernel.convolve(&pressure, &mut displacement, &mut work).unwrap();
        for (cell, value) in displacement.iter().enumerate() {
            let (i, j) = (cell / n2, cell % n2);
            let found = kernel.coefficient(i as isize - k1 as isize, j as isize - k2 as isize).unwrap();
            assert!((found - value).abs() < 1e-14 * own, "{kernel} [{i}, {j}] of [{k1}, {k2}]: {found} {value}");
        }
    }
}

/// The kernels of every kind on a grid, but those that it does not allow.
fn kernels(grid: &Grid) -> Vec<InfluenceKernel> {
    let layer = |q: f64| 2.0 / q * (0.3 * q).tanh();
    let spectrum = move |q1: f64, q2: f64| if q1 + q2 > 0.0 { layer(q1.hypot(q2)) } else { 0.6 };
    let made = [
        InfluenceKernel::half_space(grid),
        InfluenceKernel::periodic(grid),
        InfluenceKernel::periodic_along(grid, 0, 20.0),
        InfluenceKernel::periodic_along(grid, 1, 20.0),
        InfluenceKernel::from_coefficients(grid, |i, j| 0.1 / (1.0 + (i * i + 2 * j * j) as f64)),
        InfluenceKernel::from_spectrum(grid, spectrum),
    ];
    let sheet = Layer::bonded_to_rigid(0.7, 0.4).unwrap();
    let coating = Layer::bonded_to_half_space(0.3, 0.4, 0.2, 0.3).unwrap();
    let layers = [
        InfluenceKernel::layer(grid, sheet),
        InfluenceKernel::layer(grid, coating),
        InfluenceKernel::layer_periodic(grid, sheet),
        InfluenceKernel::layer_periodic_along(grid, sheet, 0, None),
        InfluenceKernel::layer_periodic_along(grid, coating, 1, Some(20.0)),
    ];
    let lines =
        || [InfluenceKernel::line(grid, 20.0).unwrap(), InfluenceKernel::layer_line(grid, sheet, None).unwrap()];
    let lines = (grid.cells()[1] == 1).then(lines).into_iter().flatten();
    let kernels: Vec<_> = made.into_iter().chain(layers).map(Result::unwrap).chain(lines).collect();
    assert!(kernels.len() >= 11);
    kernels
}

#[test]
fn coefficients_are_responses_to_a_unit_pressure() {
    for cells in [[12, 9], [9, 16], [15, 1], [1, 8], [64, 2]] {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        kernels(&grid).iter().for_each(assert_is_the_response_to_a_unit_pressure);
    }
}

#[test]
fn coefficients_are_even_and_of_the_period() {
    let grid = Grid::new([12, 9], [2.0, 3.0]).unwrap();
    for kernel in kernels(&grid) {
        let at = |i: isize, j: isize| kernel.coefficient(i, j).unwrap();
        let [first, second] = kernel.periodic_axes();
        for (i, j) in [(0, 0), (1, 0), (0, 4), (5, 2), (11, 8)] {
            assert!(
                [at(-i, j), at(i, -j), at(-i, -j)].iter().all(|&mirrored| mirrored == at(i, j)),
                "{kernel} {i} {j}"
            );
            let near = |a: f64, b: f64| abs_diff_eq!(a, b, epsilon = 1e-15 * at(0, 0));
            assert!(!first || i == 0 || near(at(12 - i, j), at(i, j)), "{kernel} {i} {j}");
            assert!(!second || j == 0 || near(at(i, 9 - j), at(i, j)), "{kernel} {i} {j}");
        }
    }
}

/// Love's four-term closed form, written independently of the crate.
#[test]
fn coefficients_of_a_half_space_are_loves() {
    for lengths in [[2.0, 3.0], [2.0e-3, 2.4e-3], [30.0, 1.0]] {
        let grid = Grid::new([20, 24], lengths).unwrap();
        let kernel = InfluenceKernel::half_space(&grid).unwrap();
        let [d1, d2] = grid.spacing();
        let primitive = |x: f64, y: f64| x * (y / x.abs()).asinh() + y * (x / y.abs()).asinh();
        for (i, j) in (-19..20).flat_map(|i| (-23..24).map(move |j| (i, j))) {
            let corner = |a: f64, b: f64| primitive((i as f64 + a) * d1, (j as f64 + b) * d2);
            let exact = (corner(0.5, 0.5) - corner(-0.5, 0.5) - corner(0.5, -0.5) + corner(-0.5, -0.5)) / PI;
            let found = kernel.coefficient(i, j).unwrap();
            assert!((found / exact - 1.0).abs() < 1e-12, "{lengths:?} ({i}, {j}): {found} {exact}");
        }
    }
    let square = InfluenceKernel::half_space(&Grid::square(8, 4.0).unwrap()).unwrap();
    assert_eq!(square.coefficient(0, 0), Ok(0.5 * 4.0 * 1_f64.asinh() / PI));
}

/// The other bodies: logarithms, waves, and the user's own numbers.
#[test]
fn coefficients_of_other_bodies_are_their_closed_forms() {
    let line = InfluenceKernel::line(&Grid::new([40, 1], [8.0, 1.0]).unwrap(), 10.0).unwrap();
    let primitive = |x: f64| x * (x.abs() / 10.0).ln() - x;
    for i in -39..40_isize {
        let exact = -FRAC_2_PI * (primitive(0.2 * (i as f64 + 0.5)) - primitive(0.2 * (i as f64 - 0.5)));
        let found = line.coefficient(i, 0).unwrap();
        assert!((found / exact - 1.0).abs() < 1e-12, "{i}: {found} {exact}");
    }
    // the waves of a period add up to the coefficients; that of the mean is their sum
    let grid = Grid::new([10, 7], [2.0, 3.0]).unwrap();
    let wave = |q1: f64, q2: f64| 1.0 / (1.0 + q1 * q1 + 2.0 * q2);
    let kernel = InfluenceKernel::from_spectrum(&grid, wave).unwrap();
    for (m1, m2) in [(0, 0), (1, 0), (3, 2), (5, 3)] {
        let (q1, q2) = (TAU * f64::from(m1) / 2.0, TAU * f64::from(m2) / 3.0);
        let [d1, d2] = grid.spacing();
        let offsets = (0..10_isize).flat_map(|i| (0..7_isize).map(move |j| (i, j)));
        let crests = |(i, j): (isize, isize)| (q1 * i as f64 * d1).cos() * (q2 * j as f64 * d2).cos();
        let found: f64 = offsets.map(|(i, j)| kernel.coefficient(i, j).unwrap() * crests((i, j))).sum();
        assert!((found - wave(q1, q2)).abs() < 1e-14, "{m1} {m2}: {found}");
    }
    let own = |i: isize, j: isize| 0.1 / (1.0 + (i * i + 2 * j * j) as f64);
    let kernel = InfluenceKernel::from_coefficients(&grid, own).unwrap();
    assert_eq!(kernel.coefficient(-7, 6), Ok(own(7, 6)));
}

/// Equation 12, K_vs = 2G Φ K_el with Φ = J/2, and equation 7 as the sum that it is.
#[test]
fn viscoelastic_coefficients_are_creep_times_geometry() {
    let (modulus, branch, nu) = (2.0e6, 3.0e6, 0.3);
    let grid = Grid::new([9, 6], [3.0e-3, 2.0e-3]).unwrap();
    let kernel = InfluenceKernel::half_space(&grid).unwrap();
    let maxwell = Material::constant_poisson(Maxwell::new(modulus, 4.0e6).unwrap(), nu).unwrap();
    let zener = Material::constant_poisson(Zener::new(modulus, branch, 6.0e6).unwrap(), nu).unwrap();
    for t in [0.0, 0.3, 2.0, 40.0] {
        let phi_maxwell = 0.5 * (1.0 + t / 2.0) / modulus;
        let phi_zener = 0.5 * (1.0 / modulus - (-t / 2.0).exp_m1() / branch);
        for (body, phi) in [(&maxwell, phi_maxwell), (&zener, phi_zener)] {
            for (i, j) in [(0, 0), (3, -5), (-8, 1)] {
                let k = kernel.coefficient(i, j).unwrap();
                let elastic = (1.0 - nu) / (2.0 * modulus) * k;
                let exact = 2.0 * modulus * phi * elastic;
                assert!((body.contact_compliance(t) * k / exact - 1.0).abs() < 1e-14, "{t} ({i}, {j})");
            }
        }
    }
    let pressure: Vec<f64> = (0..grid.len()).map(|cell| ((cell * cell) as f64 * 0.37 + 1.0).sin()).collect();
    let mut fast = vec![f64::NAN; grid.len()];
    kernel.convolve(&pressure, &mut fast, &mut kernel.workspace().unwrap()).unwrap();
    let offset = |to: usize, from: usize| to as isize - from as isize;
    for (cell, value) in fast.iter().enumerate() {
        let k = |from: usize| kernel.coefficient(offset(cell / 6, from / 6), offset(cell % 6, from % 6)).unwrap();
        let sum: f64 = pressure.iter().enumerate().map(|(from, p)| k(from) * p).sum();
        assert!((value - sum).abs() < 1e-14 * 54.0 * k(cell), "{cell}: {value} {sum}");
    }
}

#[test]
fn offsets_outside_the_grid_are_refused() {
    let grid = Grid::new([12, 9], [2.0, 3.0]).unwrap();
    for kernel in kernels(&grid) {
        for offset in [[12, 0], [-12, 3], [0, 9], [11, -9], [isize::MAX, 0], [0, isize::MIN]] {
            let refused = kernel.coefficient(offset[0], offset[1]).unwrap_err();
            assert_eq!(refused, KernelError::OffsetOutsideGrid { offset, cells: [12, 9] }.into(), "{kernel}");
        }
        assert!(kernel.coefficient(11, -8).is_ok() && kernel.coefficient(-11, 8).is_ok());
    }
    let error: Error = KernelError::OffsetOutsideGrid { offset: [3, -9], cells: [12, 9] }.into();
    let text = "offset (3, -9) in cells is not allowed: it must be in (-12, 12) along x1 and (-9, 9) along x2, \
                the grid having 12 × 9 cells";
    assert_eq!(error.to_string(), text);
}
