//! Kernels of layers: limits, sums over cells, waves, and invalid layers.

use std::f64::consts::{FRAC_2_PI, TAU};

use super::{assert_answers_waves, convolve};
use crate::common::refused::field;
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;

fn coefficients(kernel: &InfluenceKernel) -> Vec<f64> {
    let [n1, n2] = kernel.grid().cells();
    let at = |i: usize, j: usize| kernel.coefficient(i as isize, j as isize).unwrap();
    (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
}

/// Greatest difference, relative to the coefficient of the half-space.
fn difference(found: &InfluenceKernel, exact: &InfluenceKernel) -> f64 {
    let pairs = coefficients(found).into_iter().zip(coefficients(exact));
    pairs.map(|(found, exact)| ((found - exact) / exact).abs()).fold(0.0, f64::max)
}

fn layers(thickness: f64, nu: f64) -> [Layer; 3] {
    [
        Layer::bonded_to_rigid(thickness, nu).unwrap(),
        Layer::frictionless_on_rigid(thickness, nu).unwrap(),
        Layer::bonded_to_half_space(thickness, nu, 5.0, 0.3).unwrap(),
    ]
}

#[test]
fn a_layer_of_the_material_of_its_base_is_a_half_space() {
    let (grid, line) = (Grid::new([24, 17], [2.0, 3.0]).unwrap(), Grid::new([40, 1], [2.0, 1.0]).unwrap());
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let periodic = InfluenceKernel::periodic(&grid).unwrap();
    let of_line = InfluenceKernel::line(&line, 30.0).unwrap();
    for thickness in [0.2, 1.0, 30.0] {
        let same = Layer::bonded_to_half_space(thickness, 0.3, 1.0, 0.3).unwrap();
        assert!(difference(&InfluenceKernel::layer(&grid, same).unwrap(), &half_space) < 1e-12);
        assert!(difference(&InfluenceKernel::layer_periodic(&grid, same).unwrap(), &periodic) < 1e-12);
        assert!(difference(&InfluenceKernel::layer_line(&line, same, Some(30.0)).unwrap(), &of_line) < 1e-12);
    }
    let nearly = Layer::bonded_to_half_space(0.5, 0.3, 1.0 + 1e-12, 0.3).unwrap();
    let found = difference(&InfluenceKernel::layer(&grid, nearly).unwrap(), &half_space);
    assert!(found < 1e-11, "{found:e}");
}

#[test]
fn thick_layers_are_half_spaces() {
    let (grid, line) = (Grid::new([24, 17], [2.0, 3.0]).unwrap(), Grid::new([40, 1], [2.0, 1.0]).unwrap());
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let of_line = InfluenceKernel::line(&line, 30.0).unwrap();
    for nu in [0.0, 0.5] {
        for thickness in [1e14, 1e30, 1e100] {
            for layer in layers(thickness, nu) {
                let found = difference(&InfluenceKernel::layer(&grid, layer).unwrap(), &half_space);
                assert!(found < 1e-12, "{layer}: {found:e}");
            }
            let layer = layers(thickness, nu)[2];
            let found = difference(&InfluenceKernel::layer_line(&line, layer, Some(30.0)).unwrap(), &of_line);
            assert!(found < 1e-12, "{layer}: {found:e}");
        }
        // and at first order in 1/h before that
        let error = |thickness| {
            let kernel = InfluenceKernel::layer(&grid, layers(thickness, nu)[0]).unwrap();
            difference(&kernel, &half_space)
        };
        let order = (error(1e3) / error(1e4)).log10();
        assert!((order - 1.0).abs() < 1e-2, "{order}");
    }
}

/// Hankel's integrals against Fourier's: a long row of cells under one pressure is a line contact.
#[test]
fn rows_of_cells_are_lines() {
    for (nu, side) in [(0.5, 0.25), (0.2, 0.25), (0.0, 1.5)] {
        for layer in &layers(1.0, nu)[..2] {
            let count = (60.0 / side) as usize;
            let row = Grid::new([6, count], [6.0 * side, side * count as f64]).unwrap();
            let line = Grid::new([6, 1], [6.0 * side, 1.0]).unwrap();
            let cells = InfluenceKernel::layer(&row, *layer).unwrap();
            let line = InfluenceKernel::layer_line(&line, *layer, None).unwrap();
            for i in 0..6 {
                let at = |j: usize| cells.coefficient(i, j as isize).unwrap();
                let sum = at(0) + 2.0 * (1..count).map(at).sum::<f64>();
                let (exact, scale) = (line.coefficient(i, 0).unwrap(), line.coefficient(0, 0).unwrap());
                assert!((sum - exact).abs() < 1e-10 * scale, "{layer}, {i}: {sum:e} {exact:e}");
            }
        }
    }
}

/// A pressure on all cells of a large grid compresses the middle by the mean of long waves; cells much longer than the
/// layer is thick do so by themselves.
#[test]
fn uniform_pressure_compresses_a_layer_as_long_waves_do() {
    let grid = Grid::square(121, 60.5).unwrap();
    for layer in &layers(1.0, 0.2)[..2] {
        let kernel = InfluenceKernel::layer(&grid, *layer).unwrap();
        let (found, exact) = (convolve(&kernel, &vec![1.0; grid.len()])[60 * 122], layer.compliance(1e-7));
        assert!((found / exact - 1.0).abs() < 1e-11, "{layer}: {found:e} {exact:e}");
        let coarse = Grid::square(3, 3.0 * 80.0).unwrap();
        let kernel = InfluenceKernel::layer(&coarse, *layer).unwrap();
        let own = kernel.coefficient(0, 0).unwrap();
        assert!((own / exact - 1.0).abs() < 1e-10, "{layer}: {own:e} {exact:e}");
        assert_abs_diff_eq!(kernel.coefficient(1, 0).unwrap(), 0.0, epsilon = 1e-10 * own);
    }
    // bonded, long waves and the mean are the same; by Hooke's law
    let bonded = layers(1.0, 0.2)[0];
    assert_abs_diff_eq!(bonded.compliance(0.0), 0.6 / 0.64, epsilon = 1e-15);
    assert_abs_diff_eq!(bonded.compliance(1e-7), bonded.compliance(0.0), epsilon = 1e-12);
}

#[test]
fn periodic_layers_answer_every_wave() {
    for cells in [[16, 24], [15, 22], [32, 1]] {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        for layer in layers(0.4, 0.3).into_iter().chain(layers(0.4, 0.5)) {
            let kernel = InfluenceKernel::layer_periodic(&grid, layer).unwrap();
            assert_answers_waves(&kernel, |q| layer.compliance(q));
        }
    }
}

/// Far from a load on a layer on a half-space, in line contact, the surface follows the base to where it is at rest.
#[test]
fn lines_on_half_spaces_are_at_rest_at_their_datum() {
    let layer = Layer::bonded_to_half_space(0.05, 0.4, 5.0, 0.3).unwrap();
    let grid = Grid::new([2001, 1], [40.02, 1.0]).unwrap();
    let kernel = InfluenceKernel::layer_line(&grid, layer, Some(40.02)).unwrap();
    let side = grid.spacing()[0];
    let base = 5.0 * 0.7 / 0.6;
    let at = |i: isize| kernel.coefficient(i, 0).unwrap();
    for i in [500, 1000, 2000] {
        let exact = -FRAC_2_PI * base * side * (side * i as f64 / 40.02).ln();
        assert!((at(i) - exact).abs() < 1e-4 * at(0), "{i}: {:e} {exact:e}", at(i));
    }
}

/// What a layer that is periodic along x2 adds to the half-space, for a wave along x2, from the sum over many images of what it
/// adds to the coefficients of cells. That is smooth, so that uniform cells leave of the wave sin(κd/2)/(κd/2), and no other
/// one as long as they are short against the thickness.
#[test]
fn layers_periodic_along_one_axis_are_sums_of_images() {
    let (side, count, cells, periods) = (0.25, 6, 32, 80);
    let length = side * count as f64;
    // the end of the sum, so smooth that the waves do not see it
    let end = |y: f64| {
        let p = (2.0 * y / f64::from(periods) - 1.0).max(0.0);
        1.0 - p.powi(5) * (126.0 - 420.0 * p + 540.0 * p * p - 315.0 * p.powi(3) + 70.0 * p.powi(4))
    };
    let grid = Grid::new([count, cells * periods as usize], [length, f64::from(periods)]).unwrap();
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let strips = Grid::new([count, 8], [length, 1.0]).unwrap();
    for thickness in [0.15, 0.6, 3.0] {
        for layer in layers(thickness, 0.5).into_iter().chain(layers(thickness, 0.2)) {
            let kernel = InfluenceKernel::layer(&grid, layer).unwrap();
            let datum = layer.compliance(0.0).is_infinite().then_some(10.0);
            let periodic = InfluenceKernel::layer_periodic_along(&strips, layer, Axis::X2, datum).unwrap();
            let of_half_space = InfluenceKernel::periodic_along(&strips, Axis::X2, 10.0).unwrap();
            for waves in [1.0, 2.0] {
                let wave: Vec<f64> = (0..strips.len())
                    .map(|k| if k < 8 { (TAU * waves * strips.center(0, k)[1]).cos() } else { 0.0 })
                    .collect();
                let [with, without] = [&periodic, &of_half_space].map(|kernel| convolve(kernel, &wave));
                let half = 0.5 * TAU * waves / cells as f64;
                for i in 0..count {
                    let term = |j: usize| {
                        let at = |kernel: &InfluenceKernel| kernel.coefficient(i as isize, j as isize).unwrap();
                        let y = j as f64 / cells as f64;
                        end(y) * (TAU * waves * y).cos() * (at(&kernel) - at(&half_space))
                    };
                    let exact = term(0) + 2.0 * (1..cells * periods as usize).map(term).sum::<f64>();
                    let found = (with[8 * i] - without[8 * i]) / wave[0] * half.sin() / half;
                    let scale = without[0] / wave[0];
                    assert!((found - exact).abs() < 1e-9 * scale, "{layer}, {waves}, {i}: {found:e} {exact:e}");
                }
            }
        }
    }
}

#[test]
fn layers_periodic_along_one_axis_are_lines_and_half_spaces() {
    let grid = Grid::new([24, 10], [2.0, 1.0]).unwrap();
    let turned = Grid::new([10, 24], [1.0, 2.0]).unwrap();
    let line = Grid::new([24, 1], [2.0, 1.0]).unwrap();
    for layer in layers(0.3, 0.4) {
        let datum = layer.compliance(0.0).is_infinite().then_some(7.0);
        let along = |grid: &Grid, axis| InfluenceKernel::layer_periodic_along(grid, layer, axis, datum).unwrap();
        let (kernel, other) = (along(&grid, Axis::X2), along(&turned, Axis::X1));
        assert_eq!((kernel.periodic_axes(), other.periodic_axes()), ([false, true], [true, false]));
        // uniform along x2: a line
        let uniform: Vec<f64> = (0..24).map(|i| ((i * i) as f64).sin() + 1.1).collect();
        let on_line = convolve(&InfluenceKernel::layer_line(&line, layer, datum).unwrap(), &uniform);
        let rows: Vec<f64> = uniform.iter().flat_map(|&p| [p; 10]).collect();
        let found = convolve(&kernel, &rows);
        let greatest = on_line.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        assert!((0..240).all(|k| (found[k] - on_line[k / 10]).abs() < 1e-13 * greatest), "{layer}");
        // axes exchanged
        let pressure: Vec<f64> = (0..240).map(|k| ((k * k + 3 * k) as f64).sin()).collect();
        let exchanged: Vec<f64> = (0..240).map(|k| pressure[k % 24 * 10 + k / 24]).collect();
        let (one, two) = (convolve(&kernel, &pressure), convolve(&other, &exchanged));
        assert!((0..240).all(|k| (one[k] - two[k % 10 * 24 + k / 10]).abs() < 1e-13 * greatest), "{layer}");
    }
    // a layer of the material of its base, and a thick one
    let half_space = InfluenceKernel::periodic_along(&grid, Axis::X2, 7.0).unwrap();
    let same = Layer::bonded_to_half_space(0.3, 0.3, 1.0, 0.3).unwrap();
    for layer in [same, Layer::bonded_to_half_space(1e15, 0.3, 4.0, 0.4).unwrap()] {
        let kernel = InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, Some(7.0)).unwrap();
        assert!(difference(&kernel, &half_space) < 1e-12, "{layer}");
    }
    let rigid = Layer::bonded_to_rigid(0.3, 0.3).unwrap();
    let along = |layer, datum| field(InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, datum));
    assert_eq!(along(same, Some(1.9)), "datum of a line load");
    let thin = Layer::bonded_to_rigid(1e-5, 0.3).unwrap();
    assert_eq!(along(thin, None), "longer side of a cell over the thickness of the layer");
    let datum = |layer, datum| {
        let refused = InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, datum);
        refused.as_ref().is_err_and(|error| error.code() == "kernel_layer_datum")
    };
    assert!(datum(rigid, Some(7.0)) && datum(same, None));
}

/// K on cells of layers thick and thin passes the check of user-defined coefficients.
#[test]
fn operators_of_layers_are_positive_definite() {
    let grid = Grid::new([12, 9], [1.2, 0.9]).unwrap();
    let mut compared = 0;
    for thickness in [0.002, 0.02, 0.05, 0.1, 0.5, 5.0] {
        for layer in layers(thickness, 0.5).into_iter().chain(layers(thickness, 0.48)).chain(layers(thickness, -0.5)) {
            let Ok(kernel) = InfluenceKernel::layer(&grid, layer) else { continue };
            let own = coefficients(&kernel);
            let checked =
                InfluenceKernel::from_coefficients(&grid, |i, j| own[i.unsigned_abs() * 9 + j.unsigned_abs()]);
            assert!(checked.is_ok(), "{layer}: {checked:?}");
            compared += 1;
        }
    }
    // two of 54 are too thin for the cells
    assert_eq!(compared, 52);
}
