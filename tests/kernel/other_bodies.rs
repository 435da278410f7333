//! The kernels beside the half-space's, each against its closed form and a sum of its own.

use std::f64::consts::TAU;

use super::{assert_answers_waves, convolve, noise, values};
use crate::common::refused::field;
use viscocontact::{Axis, Error, Grid, InfluenceKernel, KernelError};

/// Westergaard's waves, on lengths of period even, odd and not smooth.
#[test]
fn periodic_bodies_displace_waves_as_westergaard_says() {
    for cells in [[16, 24], [15, 22], [11, 1], [1, 32], [64, 2]] {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        assert_answers_waves(&InfluenceKernel::periodic(&grid).unwrap(), |q| 2.0 / q);
    }
}

/// Waves that end across the strip are, in its middle, Westergaard's; uniform ones are lines; and both axes do it.
#[test]
fn strips_are_periodic_along_one_axis() {
    let (cells, lengths) = ([96, 20], [12.0, 2.5]);
    for axis in [1, 0] {
        let turn = |pair: [usize; 2]| if axis == 1 { pair } else { [pair[1], pair[0]] };
        let grid = Grid::new(turn(cells), if axis == 1 { lengths } else { [lengths[1], lengths[0]] }).unwrap();
        let kernel = InfluenceKernel::periodic_along(&grid, Axis::BOTH[axis], 20.0).unwrap();
        assert_eq!(kernel.periodic_axes(), [axis == 0, axis == 1]);
        let kappa = TAU * 2.0 / 2.5;
        let along = |x: [f64; 2]| (kappa * x[axis]).cos();
        let wave = values(&grid, |x1, x2| along([x1, x2]));
        let found = convolve(&kernel, &wave);
        for j in 0..20 {
            let [i, j] = turn([48, j]);
            let k = i * grid.cells()[1] + j;
            // the tail of K0 beyond ± 6 is left out: e^(−κ 6)/…
            assert!((found[k] - 2.0 / kappa * wave[k]).abs() < 1e-12, "{k}: {} {}", found[k], wave[k]);
        }
        let line = InfluenceKernel::line(&Grid::new([96, 1], [12.0, 1.0]).unwrap(), 20.0).unwrap();
        let profile = noise(96);
        let uniform: Vec<f64> =
            (0..grid.len()).map(|k| profile[[k / grid.cells()[1], k % grid.cells()[1]][1 - axis]]).collect();
        let (found, exact) = (convolve(&kernel, &uniform), convolve(&line, &profile));
        for (k, value) in found.iter().enumerate() {
            let own = exact[[k / grid.cells()[1], k % grid.cells()[1]][1 - axis]];
            assert!((value - own).abs() < 1e-13 * exact[0].abs().max(1.0), "{k}: {value} {own}");
        }
    }
}

#[test]
fn impossible_bodies_are_refused() {
    let grid = Grid::new([12, 8], [1.0, 1.0]).unwrap();
    let coefficient = |f: &dyn Fn(isize, isize) -> f64| InfluenceKernel::from_coefficients(&grid, f).unwrap_err();
    assert!(matches!(coefficient(&|_, _| f64::NAN), Error::Kernel(KernelError::InvalidInfluence { at: [0, 0], .. })));
    let lopsided = coefficient(&|i, j| (-(i * i + j * j) as f64).exp() + 1e-3 * i as f64);
    assert!(matches!(lopsided, Error::Kernel(KernelError::InvalidInfluence { at: [-1, 0], .. })), "{lopsided}");
    // the neighbours sink in more than the loaded cell
    let unstable = coefficient(&|i, j| if (i, j) == (0, 0) { 1.0 } else { 2.0 / (1 + i * i + j * j) as f64 });
    assert!(
        matches!(unstable, Error::Kernel(KernelError::NotPositiveDefinite { least, .. }) if least < -0.1),
        "{unstable}"
    );
    // positive though its embedding in a period is not: the half-space, which many a grid has
    assert!(InfluenceKernel::from_coefficients(&grid, |i, j| 1.0 / (1.0 + (i * i + j * j) as f64)).is_ok());
    let wave = |f: fn(f64, f64) -> f64| InfluenceKernel::from_spectrum(&grid, f).unwrap_err();
    assert!(matches!(wave(|_, _| -1.0), Error::Kernel(KernelError::InvalidInfluence { of: "wave", at: [0, 0], .. })));
    assert!(matches!(wave(|q1, _| 7.0 - q1), Error::Kernel(KernelError::InvalidInfluence { at: [2, 0], .. })));
    let line = Grid::new([12, 1], [1.0, 1.0]).unwrap();
    assert_eq!(field(InfluenceKernel::line(&grid, 2.0)), "cells along x2 of a line contact");
    assert_eq!(field(InfluenceKernel::line(&line, 0.5)), "datum of a line load");
    assert_eq!(field(InfluenceKernel::line(&line, f64::NAN)), "datum of a line load");
    assert_eq!(field(InfluenceKernel::periodic(&Grid::square(1, 1.0).unwrap())), "cells of a periodic grid");
}

/// Cells whose coefficients `f64` cannot represent are refused with the reason; below that K p is a number.
#[test]
fn cells_beyond_numbers_are_refused() {
    type Make = fn(&Grid) -> Result<InfluenceKernel, Error>;
    let kernels: [Make; 4] = [
        InfluenceKernel::half_space,
        InfluenceKernel::periodic,
        |grid| InfluenceKernel::periodic_along(grid, Axis::X1, grid.lengths()[1]),
        |grid| InfluenceKernel::periodic_along(grid, Axis::X2, 1.0e120),
    ];
    let sides = |d1: f64, d2: f64| Grid::new([4, 3], [4.0 * d1, 3.0 * d2]).unwrap();
    for make in kernels {
        assert_eq!(field(make(&sides(1.0e-101, 1.0))), "cell side along x1");
        assert_eq!(field(make(&sides(1.0, 1.0e110))), "cell side along x2");
        assert_eq!(field(make(&sides(1.0e-60, 1.0e60))), "aspect ratio of the cells");
        for (d1, d2) in [(1.0e-99, 1.0), (1.0, 1.0e-99), (1.0e-40, 1.0e40), (1.0e99, 1.0e99), (1.0e-99, 1.0e-99)] {
            let grid = sides(d1, d2);
            let kernel = make(&grid).unwrap();
            let found = convolve(&kernel, &noise(12));
            assert!(found.iter().all(|value| value.is_finite()), "{d1:e} {d2:e} {kernel}: {found:?}");
        }
    }
    let line = Grid::new([4, 1], [1.0, 1.0]).unwrap();
    assert_eq!(field(InfluenceKernel::line(&line, 1.0e121)), "datum of a line load");
    let grid = sides(1.0, 1.0);
    let beyond = |result: Result<InfluenceKernel, Error>| {
        matches!(result, Err(Error::Kernel(KernelError::InvalidInfluence { .. })))
    };
    assert!(beyond(InfluenceKernel::from_coefficients(&grid, |i, j| if i == 0 && j == 0 { 1e101 } else { 0.0 })));
    assert!(beyond(InfluenceKernel::from_spectrum(&grid, |_, _| 1e101)));
}

/// Cells far more slender than the proof of the coefficients covers: under a unit pressure everywhere, K p on a row of cells
/// equals K p on one cell of the same outline.
#[test]
fn slender_cells_add_up_to_one() {
    for aspect in [1e3, 1e6, 1e20, 1e90] {
        let grid = Grid::new([1, 3], [aspect, 3.0]).unwrap();
        let row = convolve(&InfluenceKernel::half_space(&grid).unwrap(), &[1.0; 3]);
        let one = Grid::new([1, 1], [aspect, 3.0]).unwrap();
        let whole = convolve(&InfluenceKernel::half_space(&one).unwrap(), &[1.0]);
        assert!((row[1] / whole[0] - 1.0).abs() < 1e-12, "{aspect:e}: {:e} {:e}", row[1], whole[0]);
    }
}
