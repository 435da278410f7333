//! The fast convolution against the naive double sum over Love's coefficients.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::{Error, Grid, InfluenceKernel};

/// Love's four-term closed form: right to 1e-11 on the small grids of these tests, and written
/// independently of the crate.
fn love(grid: &Grid, i: usize, j: usize) -> f64 {
    let [d1, d2] = grid.spacing();
    let primitive = |x: f64, y: f64| x * (y / x.abs()).asinh() + y * (x / y.abs()).asinh();
    let (x, y, a, b) = (i as f64 * d1, j as f64 * d2, 0.5 * d1, 0.5 * d2);
    let sum = primitive(x + a, y + b) - primitive(x - a, y + b) - primitive(x + a, y - b) + primitive(x - a, y - b);
    sum / std::f64::consts::PI
}

fn naive(grid: &Grid, pressure: &[f64]) -> Vec<f64> {
    let [n1, n2] = grid.cells();
    let coefficients: Vec<f64> = (0..grid.len()).map(|k| love(grid, k / n2, k % n2)).collect();
    let at = |i: usize, j: usize| {
        let cells = (0..n1).flat_map(|k| (0..n2).map(move |l| (k, l)));
        cells.map(|(k, l)| coefficients[i.abs_diff(k) * n2 + j.abs_diff(l)] * pressure[k * n2 + l]).sum::<f64>()
    };
    (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
}

fn convolve(grid: &Grid, pressure: &[f64]) -> Vec<f64> {
    let kernel = InfluenceKernel::half_space(grid).unwrap();
    let mut displacement = vec![f64::NAN; grid.len()];
    kernel.convolve(pressure, &mut displacement, &mut kernel.workspace().unwrap()).unwrap();
    displacement
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::with_cases(64) })]

    #[test]
    fn the_fast_convolution_is_the_naive_sum(
        n1 in 1_usize..24,
        n2 in 1_usize..24,
        aspect in -2.0..2.0_f64,
        seed in prop::collection::vec(-1.0..1.0_f64, 576),
    ) {
        let grid = Grid::new([n1, n2], [1.0e-3, 1.0e-3 * 10f64.powf(aspect)]).unwrap();
        let pressure = &seed[..grid.len()];
        let (fast, slow) = (convolve(&grid, pressure), naive(&grid, pressure));
        let scale = pressure.iter().map(|p| p.abs()).sum::<f64>() * love(&grid, 0, 0);
        for (a, b) in fast.iter().zip(&slow) {
            prop_assert!((a - b).abs() <= 1e-12 * scale, "{a} {b}");
        }
    }
}

#[test]
fn influence_is_reciprocal() {
    let grid = Grid::new([20, 31], [1.0, 2.0]).unwrap();
    let impulse = |k: usize| {
        let mut field = vec![0.0; grid.len()];
        field[k] = 1.0;
        convolve(&grid, &field)
    };
    let (here, there) = (17, 603);
    assert_abs_diff_eq!(impulse(here)[there] / impulse(there)[here], 1.0, epsilon = 1e-13);
}

#[test]
fn fields_of_the_wrong_length_are_refused() {
    let grid = Grid::square(8, 1.0).unwrap();
    let kernel = InfluenceKernel::half_space(&grid).unwrap();
    let mut work = kernel.workspace().unwrap();
    let mut out = vec![0.0; 64];
    let wrong = |result: Result<(), Error>| match result.unwrap_err() {
        Error::WrongLength { field, .. } => field,
        other => panic!("unexpected {other}"),
    };
    assert_eq!(wrong(kernel.convolve(&[0.0; 63], &mut out, &mut work)), "pressure");
    assert_eq!(wrong(kernel.convolve(&[0.0; 64], &mut out[..60], &mut work)), "displacement");
    let other = InfluenceKernel::half_space(&Grid::square(9, 1.0).unwrap()).unwrap();
    assert_eq!(wrong(kernel.convolve(&[0.0; 64], &mut out, &mut other.workspace().unwrap())), "workspace");
}
