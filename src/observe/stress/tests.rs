//! Transforms against sums, and laws that every stress obeys.

use super::*;
use crate::error::Error;
use crate::observe::stress::waves;

fn field(len: usize) -> Vec<f64> {
    (0..len).map(|k| f64::from(u8::from(k % 3 > 0)) * (1.0 + ((k * k + 7 * k) as f64).sin())).collect()
}

fn kernels() -> Vec<InfluenceKernel> {
    let grid = |cells, lengths| Grid::new(cells, lengths).unwrap();
    vec![
        InfluenceKernel::half_space(&grid([7, 10], [0.7, 2.0])).unwrap(),
        InfluenceKernel::half_space(&grid([1, 6], [0.2, 0.6])).unwrap(),
        InfluenceKernel::half_space(&grid([1, 1], [0.2, 0.6])).unwrap(),
        InfluenceKernel::line(&grid([12, 1], [1.2, 1.0]), 10.0).unwrap(),
        InfluenceKernel::periodic_along(&grid([1, 9], [3.0, 0.9]), Axis::X1, 10.0).unwrap(),
        InfluenceKernel::periodic(&grid([8, 5], [0.8, 0.6])).unwrap(),
        InfluenceKernel::periodic(&grid([9, 1], [0.8, 0.6])).unwrap(),
        InfluenceKernel::periodic(&grid([6, 6], [0.8, 0.6])).unwrap(),
    ]
}

fn close(found: &Stress, exact: &Stress, tolerance: f64, about: &str) {
    for (found, exact) in found.components().iter().zip(exact.components()) {
        assert!((found - exact).abs() < tolerance, "{about}: {found:e} {exact:e}");
    }
}

#[test]
fn planes_are_the_sums_over_all_cells() {
    for kernel in kernels() {
        let grid = kernel.grid();
        let pressure = field(grid.len());
        for nu in [0.3, 0.5] {
            let stress = SubsurfaceStress::new(&kernel, &pressure, nu).unwrap();
            for depth in [stress.min_depth(), 0.13, 0.5, 7.0].into_iter().filter(|&z| z >= stress.min_depth()) {
                let plane = stress.on_plane(depth).unwrap();
                for (k, found) in plane.iter().enumerate() {
                    let [x1, x2] = grid.center(k / grid.cells()[1], k % grid.cells()[1]);
                    let exact = stress.at(&[[x1, x2, depth]]).unwrap()[0];
                    close(found, &exact, 2e-14, &format!("{kernel} {k} at {depth}"));
                }
            }
        }
    }
}

/// ∂σ_ij/∂x_j = 0 by central differences: the residual is of second order.
#[test]
fn stresses_are_in_equilibrium() {
    for kernel in kernels() {
        let stress = SubsurfaceStress::new(&kernel, &field(kernel.grid().len()), 0.3).unwrap();
        for point in [[0.03, 0.11, 0.42], [-0.3, 0.2, 0.35], [0.5, -0.6, 0.8]] {
            let residual = |h: f64| {
                let slope = |axis: usize| {
                    let moved = |sign: f64| {
                        let mut moved = point;
                        moved[axis] += sign * h;
                        stress.at(&[moved]).unwrap()[0]
                    };
                    (0.5 / h) * (moved(1.0) + -1.0 * moved(-1.0))
                };
                let [d1, d2, d3] = [0, 1, 2].map(slope);
                [d1.s11 + d2.s12 + d3.s13, d1.s12 + d2.s22 + d3.s23, d1.s13 + d2.s23 + d3.s33]
            };
            let norm = |values: [f64; 3]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
            let [coarse, fine] = [0.02, 0.01].map(|h| norm(residual(h)));
            assert!(fine < 2e-2, "{kernel} {point:?}: {fine:e}");
            let order = (coarse / fine).log2();
            assert!(coarse < 1e-11 || (order - 2.0).abs() < 0.1, "{kernel} {point:?}: order {order}");
        }
    }
}

/// A plane carries the whole load of a period: to rounding, at every depth.
#[test]
fn a_plane_carries_the_load_of_a_period() {
    for kernel in kernels().into_iter().filter(|kernel| kernel.periodic_axes() == [true; 2]) {
        let pressure = field(kernel.grid().len());
        let stress = SubsurfaceStress::new(&kernel, &pressure, 0.3).unwrap();
        let load: f64 = pressure.iter().sum();
        for depth in [stress.min_depth(), 1.0, 30.0] {
            let plane = stress.on_plane(depth).unwrap();
            let carried: f64 = plane.iter().map(|s| s.s33).sum();
            assert!((carried / load + 1.0).abs() < 1e-14, "{kernel} {depth}: {carried}");
            let [shear1, shear2] = [|s: &Stress| s.s13, |s: &Stress| s.s23].map(|of| plane.iter().map(of).sum::<f64>());
            assert!(shear1.abs() < 1e-13 * load && shear2.abs() < 1e-13 * load);
            let lateral: f64 = plane.iter().map(|s| s.s11).sum();
            assert!((lateral / carried - 0.3 / 0.7).abs() < 1e-13, "{kernel}: {lateral}");
        }
    }
}

/// The traction on a plane that approaches the surface becomes the pressure, in first order for smooth pressures.
#[test]
fn traction_becomes_the_pressure() {
    let grid = Grid::new([32, 16], [1.0, 0.5]).unwrap();
    let kernel = InfluenceKernel::periodic(&grid).unwrap();
    let q = [2.0 * std::f64::consts::TAU, 2.0 * std::f64::consts::TAU];
    let pressure: Vec<f64> = (0..grid.len())
        .map(|k| grid.center(k / 16, k % 16))
        .map(|[x, y]| 1.0 + (q[0] * x).cos() * (q[1] * y).sin())
        .collect();
    let spectrum = SubsurfaceStress::new(&kernel, &pressure, 0.3).unwrap().source.spectrum.clone();
    for k in [0, 37, 200, 511] {
        let [x, y] = grid.center(k / 16, k % 16);
        let below = |z: f64| waves::below_field(&grid, &spectrum, [x, y, z], [1.0, 0.4]);
        assert!((below(1e-6).s33 + pressure[k]).abs() < 1e-9);
        assert!(below(1e-9).s13.abs() < 1e-7 && below(1e-9).s23.abs() < 1e-7);
        // one wave, by its closed form
        let (z, q) = (0.1, q[0].hypot(q[1]));
        let exact = -1.0 - (pressure[k] - 1.0) * (1.0 + q * z) * (-q * z).exp();
        assert!((below(z).s33 - exact).abs() < 1e-13);
    }
}

/// A long period is a half-space, below a load in its middle. The images add a uniform sheet there, whose lateral
/// stress is −(1 + 2ν)/2 p̄ if it is summed in squares, and −ν/(1 − ν) p̄ if the period keeps its lengths.
#[test]
fn a_long_period_is_a_half_space() {
    let grid = Grid::square(192, 192.0).unwrap();
    let of = |[x, y]: [f64; 2]| (-((x - 1.0).powi(2) + (y + 2.0).powi(2)) / 288.0).exp();
    let pressure: Vec<f64> = (0..grid.len()).map(|k| of(grid.center(k / 192, k % 192))).collect();
    let mean = pressure.iter().sum::<f64>() / grid.len() as f64;
    let half_space = SubsurfaceStress::new(&InfluenceKernel::half_space(&grid).unwrap(), &pressure, 0.3).unwrap();
    let periodic = SubsurfaceStress::new(&InfluenceKernel::periodic(&grid).unwrap(), &pressure, 0.3).unwrap();
    let points = [[0.0, 0.0, 3.0], [3.5, -2.5, 2.5], [-16.5, 14.5, 1.0]];
    for (one, mut other) in half_space.at(&points).unwrap().into_iter().zip(periodic.at(&points).unwrap()) {
        let lateral = (0.5 * (1.0 + 0.6) - 0.3 / 0.7) * mean;
        assert!(lateral > 8e-3);
        (other.s11, other.s22) = (other.s11 - lateral, other.s22 - lateral);
        close(&one, &other, 2e-3, "half-space and period");
    }
}

#[test]
fn wrong_arguments_are_refused_by_name() {
    let name = |error: Error| match error {
        Error::OutOfRange { field, .. } | Error::WrongLength { field, .. } | Error::OutOfOrder { field, .. } => field,
        other => panic!("{other}"),
    };
    let grid = Grid::new([4, 6], [4.0, 3.0]).unwrap();
    let kernel = InfluenceKernel::half_space(&grid).unwrap();
    let new = |pressure: &[f64], nu| SubsurfaceStress::new(&kernel, pressure, nu);
    assert_eq!(name(new(&[1.0; 23], 0.3).unwrap_err()), "pressure");
    assert_eq!(name(new(&[f64::NAN; 24], 0.3).unwrap_err()), "pressure");
    assert_eq!(name(new(&[1e200; 24], 0.3).unwrap_err()), "pressure");
    for nu in [0.51, -1.0, f64::NAN] {
        assert_eq!(name(new(&[1.0; 24], nu).unwrap_err()), "Poisson's ratio");
    }
    let stress = new(&[1.0; 24], 0.3).unwrap();
    assert_eq!(stress.min_depth(), 0.5);
    for depth in [0.4999, 0.0, -1.0, f64::NAN, f64::INFINITY, 1e101] {
        assert_eq!(name(stress.on_plane(depth).unwrap_err()), "depth");
        assert_eq!(name(stress.at(&[[0.0, 0.0, depth]]).unwrap_err()), "depth");
        assert_eq!(name(stress.on_section(Axis::X1, 0.0, &[depth]).unwrap_err()), "depth");
        assert_eq!(name(stress.maximum(&[depth], Stress::von_mises).unwrap_err()), "depth");
    }
    assert_eq!(name(stress.on_section(Axis::X1, 0.0, &[]).unwrap_err()), "depths");
    assert_eq!(name(stress.in_volume(&[1.0, 1.0]).unwrap_err()), "depths");
    assert_eq!(name(stress.on_section(Axis::X1, 1.6, &[1.0]).unwrap_err()), "coordinate of the section");
    assert_eq!(name(stress.at(&[[f64::NAN, 0.0, 1.0]]).unwrap_err()), "coordinate x1 of a point");
    assert_eq!(name(stress.at(&[[0.0, 1e41, 1.0]]).unwrap_err()), "coordinate x2 of a point");
    // the ends of all ranges give numbers
    let strong = new(&[1e150; 24], -0.999).unwrap();
    for point in [[1e39, -1e39, 1.0], [0.0, 0.0, 1e100], [0.5, 0.5, 0.5]] {
        let found = strong.at(&[point]).unwrap()[0];
        assert!(found.von_mises().is_finite() && found.tresca().is_finite(), "{point:?} {found:?}");
    }
    assert!(strong.on_plane(1e100).unwrap().iter().all(|stress| stress.von_mises().is_finite()));
}

#[test]
fn bodies_without_a_closed_form_are_refused() {
    let grid = Grid::square(4, 1.0).unwrap();
    let refused = |result: Result<SubsurfaceStress>| {
        let error = result.unwrap_err();
        assert_eq!(error.code(), "kernel_no_stress", "{error}");
        error.to_string()
    };
    let layer = InfluenceKernel::from_spectrum(&grid, |q1, q2| if q1 + q2 > 0.0 { 1.0 } else { 0.0 }).unwrap();
    assert!(refused(SubsurfaceStress::new(&layer, &[0.0; 16], 0.3)).contains("user-defined"));
    let strips = InfluenceKernel::periodic_along(&grid, Axis::X2, 2.0).unwrap();
    assert!(refused(SubsurfaceStress::new(&strips, &[0.0; 16], 0.3)).contains("periodic along x2"));
}

/// A section equals its line of a plane, wherever the line is, and a volume is its planes.
#[test]
fn sections_and_volumes_are_cut_from_planes() {
    let mut kernels = kernels();
    kernels.push(InfluenceKernel::periodic(&Grid::new([1, 7], [0.8, 0.6]).unwrap()).unwrap());
    kernels.push(InfluenceKernel::half_space(&Grid::new([9, 1], [0.8, 0.6]).unwrap()).unwrap());
    for kernel in kernels {
        let grid = kernel.grid();
        let [n1, n2] = grid.cells();
        let stress = SubsurfaceStress::new(&kernel, &field(grid.len()), 0.3).unwrap();
        let depths = [0.35, 0.5, 3.0];
        let volume = stress.in_volume(&depths).unwrap();
        assert_eq!(volume.plane(3), None);
        for (along, axis, lines) in [(Axis::X1, 0, n2), (Axis::X2, 1, n1)] {
            for line in 0..lines {
                let at = grid.coordinate(1 - axis, line);
                let section = stress.on_section(along, at + 0.3 * grid.spacing()[1 - axis], &depths).unwrap();
                let positions = (0..grid.cells()[axis]).map(|k| grid.coordinate(axis, k));
                assert!(section.at == at && positions.eq(section.positions.iter().copied()));
                for (layer, depth) in depths.into_iter().enumerate() {
                    let plane = stress.on_plane(depth).unwrap();
                    assert_eq!(volume.plane(layer), Some(&plane[..]));
                    for k in 0..grid.cells()[axis] {
                        let cell = if axis == 0 { k * n2 + line } else { line * n2 + k };
                        let found = &section.values[k * depths.len() + layer];
                        close(found, &plane[cell], 2e-14, &format!("{kernel}, {along:?} {line}, {k} at {depth}"));
                    }
                }
            }
        }
    }
}

/// Threads share the lines of a plane and change no bit.
#[cfg(feature = "rayon")]
#[test]
fn planes_do_not_depend_on_the_number_of_threads() {
    let grid = Grid::new([200, 170], [2.0, 1.7]).unwrap();
    let periodic = InfluenceKernel::periodic(&Grid::new([200, 180], [2.0, 1.8]).unwrap()).unwrap();
    for kernel in [InfluenceKernel::half_space(&grid).unwrap(), periodic] {
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let plane = || SubsurfaceStress::new(&kernel, &field(kernel.grid().len()), 0.3)?.on_plane(0.1);
            pool.install(plane).unwrap()
        };
        let one = of(1);
        assert!([2, 3, 7].into_iter().all(|threads| of(threads) == one), "{kernel}");
    }
}
