//! Stress below a uniformly loaded rectangle on a half-space, and below a loaded strip.
//!
//! A normal pressure p on the surface of a half-space gives, with the potentials V = ∬ p/ρ and χ = ∬ p ln(ρ + z),
//! V = ∂χ/∂z, both harmonic (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929),
//!
//! ```text
//! 2π σ_zz = V_z − z V_zz          2π σ_xz = −z V_xz          2π σ_yz = −z V_yz
//! 2π σ_xx = V_z − z V_xx + (1 − 2ν) χ_yy
//! 2π σ_yy = V_z − z V_yy + (1 − 2ν) χ_xx
//! 2π σ_xy = −z V_xy − (1 − 2ν) χ_xy
//! ```
//!
//! Love writes 2ν V_z − (1 − 2ν) χ_xx in σ_xx, which is equal since χ_xx + χ_yy + V_z = 0. The form above separates
//! the part that depends on Poisson's ratio: a plane stress with Airy's function χ, in equilibrium without other
//! components.
//!
//! Over a rectangle of uniform pressure each derivative is the double difference of a function of the corner, of
//! which ∂²/∂x∂y is that derivative of 1/ρ or ln(ρ + z). With ξ = x/z, η = y/z from the corner and
//! ρ = √(1 + ξ² + η²), all over z:
//!
//! ```text
//! V_z   −atan(ξη/ρ)                 z V_xx  −ξη/((1 + ξ²) ρ)       z V_xy  1/ρ
//! χ_xx  atan(ξη(ρ − 1)/(ξ²ρ + η²))  z V_xz  −η/((1 + ξ²) ρ)        χ_xy    ln(ρ + 1)
//! ```
//!
//! and the same with ξ and η exchanged. ρ − 1 = (ξ² + η²)/(ρ + 1); no other term cancels, whatever the signs of ξ and
//! η: the forms with ln(ρ + x) that do belong to the displacement and to shear loads. χ_xx is the difference of two
//! arc tangents, joined so that no branch is left.
//!
//! For a strip, |η| → ∞ on both sides: plane strain (K. L. Johnson, Contact Mechanics, 1985, section 2.5). Where
//! |η| is so great that ξ² is below the rounding of η², the terms round to this limit: ξη/ρ to ±ξ, and η/ρ to ±1.

use std::f64::consts::TAU;

use super::Stress;
use crate::Grid;

/// Weights of the part of the stress that does not depend on ν, and of the part with the factor 1 − 2ν.
pub(super) type Weights = [f64; 2];

/// The function of the corner whose double difference over the corners of a rectangle is the stress below the
/// rectangle, for a unit pressure. `xi` and `eta` are the distances from the corner over the depth.
pub(super) fn corner(xi: f64, eta: f64, [all, by_ratio]: Weights) -> Stress {
    let (x2, y2) = (xi * xi, eta * eta);
    let rho = (1.0 + x2 + y2).sqrt();
    let product = xi * eta;
    let v_z = -(product / rho).atan();
    let (of_x, of_y) = (1.0 / ((1.0 + x2) * rho), 1.0 / ((1.0 + y2) * rho));
    let mut stress = Stress {
        s11: all * (v_z + product * of_x),
        s22: all * (v_z + product * of_y),
        s33: all * (v_z - product * (of_x + of_y)),
        s12: -all / rho,
        s13: all * eta * of_x,
        s23: all * xi * of_y,
    };
    if by_ratio != 0.0 {
        let above = product * (x2 + y2) / (rho + 1.0);
        // at the corner itself, 0/0, both are 0
        let (chi_xx, chi_yy) = (above.atan2(x2 * rho + y2), above.atan2(y2 * rho + x2));
        stress.s11 += by_ratio * chi_yy;
        stress.s22 += by_ratio * chi_xx;
        stress.s12 -= by_ratio * rho.ln_1p();
    }
    (1.0 / TAU) * stress
}

/// The stress at a point below a field on rectangles: the sum over all corners, weighted by the double difference of
/// the field at the corner. Each corner is computed once; corners between equal values are skipped. The rectangles
/// have the sides of the cells, or are endless along an axis with one cell.
pub(super) fn below_cells(grid: &Grid, sides: [f64; 2], field: &[f64], point: [f64; 3], weights: Weights) -> Stress {
    let ([x, y, z], [n1, n2], [d1, d2]) = (point, grid.cells(), sides);
    let mut sum = Stress::default();
    for i in 0..=n1 {
        let before = (i > 0).then(|| &field[(i - 1) * n2..i * n2]);
        let after = (i < n1).then(|| &field[i * n2..(i + 1) * n2]);
        let xi = (x - (grid.coordinate(0, 0) + (i as f64 - 0.5) * d1)) / z;
        let step = |j: usize| after.map_or(0.0, |row| row[j]) - before.map_or(0.0, |row| row[j]);
        let mut last = 0.0;
        for j in 0..=n2 {
            let next = if j < n2 { step(j) } else { 0.0 };
            if next != last {
                let eta = (y - (grid.coordinate(1, 0) + (j as f64 - 0.5) * d2)) / z;
                sum += (next - last) * corner(xi, eta, weights);
            }
            last = next;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::observe::stress::ENDLESS;
    use crate::quadrature::GaussLegendre;

    /// Displacement (u1, u2, u3) times 4πG under a point force of 1 N (J. Boussinesq; Johnson, section 3.2).
    fn boussinesq(from: [f64; 3], nu: f64) -> [f64; 3] {
        let [x, y, z] = from;
        let rho = (x * x + y * y + z * z).sqrt();
        let lateral = z / rho.powi(3) - (1.0 - 2.0 * nu) / (rho * (rho + z));
        [x * lateral, y * lateral, z * z / rho.powi(3) + 2.0 * (1.0 - nu) / rho]
    }

    /// Stress below a rectangle of half sides a, b under unit pressure: Hooke's law on differences of fourth order of
    /// Boussinesq's displacement, integrated over the rectangle.
    fn by_quadrature(half: [f64; 2], below: [f64; 3], nu: f64) -> Stress {
        let [a, b] = half;
        let rule = GaussLegendre::new(48);
        let displacement = |point: [f64; 3], component: usize| {
            let at = |s: f64, t: f64| boussinesq([point[0] - s, point[1] - t, point[2]], nu)[component];
            rule.integrate(-a, a, |s| rule.integrate(-b, b, |t| at(s, t)))
        };
        let h = 2e-3 * below[2];
        let slope = |component: usize, axis: usize| {
            let at = |steps: f64| {
                let mut point = below;
                point[axis] += steps * h;
                displacement(point, component)
            };
            (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
        };
        let gradient = [0, 1, 2].map(|component| [0, 1, 2].map(|axis| slope(component, axis)));
        let trace = gradient[0][0] + gradient[1][1] + gradient[2][2];
        // 2G (ε + ν/(1 − 2ν) tr ε): the displacement is times 4πG
        let lambda = nu / (1.0 - 2.0 * nu) * trace;
        let normal = [0, 1, 2].map(|k| (gradient[k][k] + lambda) / TAU);
        let shear = [(0, 1), (0, 2), (1, 2)].map(|(k, l)| 0.5 * (gradient[k][l] + gradient[l][k]) / TAU);
        Stress::new(normal, shear)
    }

    fn below(half: [f64; 2], point: [f64; 3], nu: f64) -> Stress {
        let grid = Grid::new([1, 1], half.map(|side| 2.0 * side)).unwrap();
        below_cells(&grid, grid.spacing(), &[1.0], point, [1.0, 1.0 - 2.0 * nu])
    }

    #[test]
    fn rectangle_agrees_with_boussinesq() {
        for nu in [0.0, 0.3, 0.45, -0.4] {
            for (half, point) in [
                ([0.5, 0.5], [0.0, 0.0, 0.5]),
                ([0.5, 0.5], [0.1, -0.2, 0.5]),
                ([0.5, 1.5], [-1.7, 0.3, 0.8]),
                ([2.0, 0.3], [-2.0, -0.3, 0.6]),
                ([0.5, 0.7], [3.0, -4.0, 0.5]),
                ([0.5, 0.7], [-0.6, 0.9, 5.0]),
            ] {
                let (found, exact) = (below(half, point, nu), by_quadrature(half, point, nu));
                let scale = exact.components().iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for (found, exact) in found.components().iter().zip(exact.components()) {
                    assert!((found - exact).abs() < 2e-9 * scale.max(0.1), "{nu} {point:?}: {found:e} {exact:e}");
                }
            }
        }
    }

    /// At the surface the traction is the pressure, and beside the rectangle none.
    #[test]
    fn the_traction_at_the_surface_is_the_pressure() {
        for z in [1e-6, 1e-9, 1e-30] {
            for nu in [0.3, 0.5] {
                let inside = below([1.0, 0.5], [0.3, -0.2, z], nu);
                assert!((inside.s33 + 1.0).abs() < 1e-14, "{inside:?}");
                assert!(inside.s13.abs() < 10.0 * z && inside.s23.abs() < 10.0 * z);
                // the sum of lateral stresses is (1 + 2ν) σ33
                assert!((inside.s11 + inside.s22 + 1.0 + 2.0 * nu).abs() < 1e-5, "{inside:?}");
                let beside = below([1.0, 0.5], [1.4, 0.2, z], nu);
                assert!(beside.s33.abs() < 1e-14 && beside.s13.abs() < 10.0 * z);
            }
        }
    }

    /// Above a corner a quarter of the pressure, above an edge half.
    #[test]
    fn corners_bear_a_quarter_of_the_pressure_and_edges_half() {
        for (point, share) in [([1.0, 0.5], 0.25), ([-1.0, -0.5], 0.25), ([1.0, 0.0], 0.5), ([0.0, -0.5], 0.5)] {
            let stress = below([1.0, 0.5], [point[0], point[1], 1e-7], 0.3);
            assert!((stress.s33 + share).abs() < 1e-6, "{point:?} {stress:?}");
            assert!(stress.components().iter().all(|value| value.is_finite()));
        }
    }

    /// Far away a rectangle is a point force: Boussinesq's σ33 = −3Pz³/(2πρ⁵).
    #[test]
    fn far_away_it_is_a_point_force() {
        let (x, y, z) = (300.0, -400.0, 500.0);
        let rho = f64::sqrt(x * x + y * y + z * z);
        let stress = below([0.5, 0.5], [x, y, z], 0.3);
        assert!((stress.s33 * 2.0 * PI * rho.powi(5) / (3.0 * z.powi(3)) + 1.0).abs() < 1e-4, "{stress:?}");
        assert!((stress.s13 / stress.s33 - x / z).abs() < 1e-4 && (stress.s23 / stress.s33 - y / z).abs() < 1e-4);
    }

    /// A long rectangle is a strip, and a strip is Johnson's (2.30).
    #[test]
    fn a_long_rectangle_is_a_strip() {
        let (grid, weights) = (Grid::new([1, 1], [2.0, 1.0]).unwrap(), [1.0, 1.0 - 2.0 * 0.3]);
        for point in [[0.3, 0.0, 0.4], [-2.0, 0.0, 1.5], [1.0, 0.0, 0.1]] {
            let endless = ENDLESS * point[2];
            let strip = below_cells(&grid, [2.0, endless], &[1.0], point, weights);
            // the lateral stress differs by the width over the length
            let long = below([1.0, 1e13], point, 0.3);
            for (strip, long) in strip.components().iter().zip(long.components()) {
                assert!((strip - long).abs() < 1e-12, "{point:?}: {strip} {long}");
            }
            let [x, _, z] = point;
            let (first, second) = (z.atan2(x - 1.0), z.atan2(x + 1.0));
            let (angle, sines) = (2.0 * (first - second), (2.0 * first).sin() - (2.0 * second).sin());
            assert!((strip.s11 + (angle + sines) / TAU).abs() < 1e-14);
            assert!((strip.s33 + (angle - sines) / TAU).abs() < 1e-14);
            assert!((strip.s13 - ((2.0 * first).cos() - (2.0 * second).cos()) / TAU).abs() < 1e-14);
            assert!((strip.s22 - 0.3 * (strip.s11 + strip.s33)).abs() < 1e-14);
            let turned = Grid::new([1, 1], [1.0, 2.0]).unwrap();
            let turned = below_cells(&turned, [endless, 2.0], &[1.0], [0.0, x, z], weights);
            let Stress { s11, s22, s33, s12, s13, s23 } = strip;
            assert_eq!(turned, Stress { s11: s22, s22: s11, s33, s12, s13: s23, s23: s13 });
        }
    }
}
