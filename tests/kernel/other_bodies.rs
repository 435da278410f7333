//! The kernels beside the half-space's, each against its closed form and a sum of its own.

use std::f64::consts::{PI, TAU};

use super::{assert_answers_waves, convolve, noise, values};
use viscocontact::{Axis, Grid, InfluenceKernel};

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

/// Far from a point load a strip is a row of half-spaces: differences of the displacement are those of the sum over
/// the images.
#[test]
fn strips_are_rows_of_images() {
    let (grid, period) = (Grid::new([80, 80], [4.0, 4.0]).unwrap(), 4.0);
    let kernel = InfluenceKernel::periodic_along(&grid, Axis::X2, 4.0).unwrap();
    // a smooth load: the waves of a cell's corners are not resolved
    let bump = |x: f64, y: f64| (-(x * x + y * y) / 0.08).exp();
    let v = convolve(&kernel, &values(&grid, bump));
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let near = convolve(&half_space, &values(&grid, bump));
    let force = values(&grid, bump).iter().sum::<f64>() * grid.cell_area();
    // a Gaussian of the width σ² = 0.04 is, far away, a point load and a Laplacian of its potential
    let far = |x: f64, y: f64| {
        let r = x.hypot(y);
        force / PI * (1.0 / r + 0.5 * 0.04 / r.powi(3))
    };
    let images = |[x, y]: [f64; 2]| {
        (1..4000)
            .map(|m| f64::from(m) * period)
            .map(|d| far(x, y - d) + far(x, y + d) - 2.0 * force / (PI * d))
            .sum::<f64>()
    };
    let (a, b) = ([60, 44], [42, 10]);
    let at = |[i, j]: [usize; 2]| (i * 80 + j, grid.center(i, j));
    let ((ka, xa), (kb, xb)) = (at(a), at(b));
    let (found, exact) = (v[ka] - v[kb], near[ka] - near[kb] + images(xa) - images(xb));
    assert!(
        (found - exact).abs() < 3e-4 * near[ka] && (images(xa) - images(xb)).abs() > 0.01 * near[ka],
        "{found} {exact} {}",
        near[ka]
    );
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
