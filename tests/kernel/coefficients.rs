//! The influence coefficients of every kernel: equations 8 and 12 of the paper.

use std::f64::consts::{FRAC_2_PI, TAU};

use super::{convolve, noise};
use approx::abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::{Axis, Error, Grid, InfluenceKernel, Layer};

/// What a convolution returns is the double sum of K(i − k, j − l) p(k, l) over all cells (k, l): equation 7.
fn sum_defect(kernel: &InfluenceKernel, pressure: &[f64]) -> f64 {
    let n2 = kernel.grid().cells()[1];
    let at = |k: usize| kernel.coefficient((k / n2) as isize, (k % n2) as isize).unwrap();
    let coefficients: Vec<f64> = (0..pressure.len()).map(at).collect();
    let scale = coefficients[0] * pressure.iter().map(|p| p.abs()).sum::<f64>();
    let defect = |(cell, value): (usize, f64)| {
        let k = |from: usize| coefficients[(cell / n2).abs_diff(from / n2) * n2 + (cell % n2).abs_diff(from % n2)];
        let sum: f64 = pressure.iter().enumerate().map(|(from, p)| k(from) * p).sum();
        (value - sum).abs() / scale
    };
    convolve(kernel, pressure).into_iter().enumerate().map(defect).fold(0.0, f64::max)
}

/// The kernels of every kind but layers.
fn kernels_without_layers(grid: &Grid) -> Vec<InfluenceKernel> {
    let layer = |q: f64| 2.0 / q * (0.3 * q).tanh();
    let spectrum = move |q1: f64, q2: f64| if q1 + q2 > 0.0 { layer(q1.hypot(q2)) } else { 0.6 };
    let made = [
        InfluenceKernel::half_space(grid),
        InfluenceKernel::periodic(grid),
        InfluenceKernel::periodic_along(grid, Axis::X1, 20.0),
        InfluenceKernel::periodic_along(grid, Axis::X2, 20.0),
        InfluenceKernel::from_coefficients(grid, |i, j| 0.1 / (1.0 + (i * i + 2 * j * j) as f64)),
        InfluenceKernel::from_spectrum(grid, spectrum),
    ];
    let line = (grid.cells()[1] == 1).then(|| InfluenceKernel::line(grid, 20.0));
    made.into_iter().chain(line).map(Result::unwrap).collect()
}

/// The kernels of every kind that a grid allows.
fn kernels(grid: &Grid) -> Vec<InfluenceKernel> {
    let sheet = Layer::bonded_to_rigid(0.7, 0.4).unwrap();
    let coating = Layer::bonded_to_half_space(0.3, 0.4, 0.2, 0.3).unwrap();
    let layers = [
        InfluenceKernel::layer(grid, sheet),
        InfluenceKernel::layer(grid, coating),
        InfluenceKernel::layer_periodic(grid, sheet),
        InfluenceKernel::layer_periodic_along(grid, sheet, Axis::X1, None),
        InfluenceKernel::layer_periodic_along(grid, coating, Axis::X2, Some(20.0)),
    ];
    let line = (grid.cells()[1] == 1).then(|| InfluenceKernel::layer_line(grid, sheet, None));
    let layers = layers.into_iter().chain(line).map(Result::unwrap);
    kernels_without_layers(grid).into_iter().chain(layers).collect()
}

#[test]
fn convolutions_are_sums_over_the_coefficients() {
    for cells in [[12, 9], [9, 16], [15, 1], [1, 8], [64, 2]] {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        for kernel in kernels(&grid) {
            let defect = sum_defect(&kernel, &noise(grid.len()));
            assert!(defect < 1e-14, "{kernel}, {cells:?}: {defect:e}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::with_cases(128) })]

    #[test]
    fn convolutions_on_random_grids_are_sums_over_the_coefficients(
        n1 in 1_usize..24,
        n2 in 1_usize..24,
        aspect in -2.0..2.0_f64,
        which in any::<prop::sample::Index>(),
        pressure in prop::collection::vec(-1.0..1.0_f64, 576),
    ) {
        // sides up to one: other kernels than the half-space have a length of their own
        let grid = Grid::new([n1, n2], [-aspect, aspect].map(|power| 10f64.powf(power.min(0.0)))).unwrap();
        let kernels = kernels_without_layers(&grid);
        let defect = sum_defect(&kernels[which.index(kernels.len())], &pressure[..grid.len()]);
        prop_assert!(defect <= 1e-12, "{defect:e}");
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
    // at the datum the surface stays where it was
    let far = InfluenceKernel::line(&Grid::new([2001, 1], [8.004, 1.0]).unwrap(), 8.004).unwrap();
    let exact = -FRAC_2_PI * 0.004 * (8.0_f64 / 8.004).ln();
    assert!((far.coefficient(2000, 0).unwrap() - exact).abs() < 1e-9, "{exact}");
    // the waves of a period add up to the coefficients; the mean is their sum
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

#[test]
fn offsets_outside_the_grid_are_refused() {
    let grid = Grid::new([12, 9], [2.0, 3.0]).unwrap();
    for kernel in kernels(&grid) {
        for offset in [[12, 0], [-12, 3], [0, 9], [11, -9], [isize::MAX, 0], [0, isize::MIN]] {
            let refused = kernel.coefficient(offset[0], offset[1]).unwrap_err();
            assert_eq!(refused.code(), "kernel_offset_outside_grid", "{kernel}");
        }
        assert!(kernel.coefficient(11, -8).is_ok() && kernel.coefficient(-11, 8).is_ok());
    }
    let error: Error = InfluenceKernel::half_space(&grid).unwrap().coefficient(3, -9).unwrap_err();
    let text = "offset (3, -9) in cells is not allowed: it must be in (-12, 12) along x1 and (-9, 9) along x2, \
                the grid having 12 × 9 cells";
    assert_eq!(error.to_string(), text);
}
