//! Responses against the problem they solve, integrals against closed forms and plain sums.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::oscillation::{Oscillation, Weight};
use super::wave::Response;
use super::*;
use crate::quadrature::GaussLegendre;

/// What lies below a layer of thickness 1.
#[derive(Debug, Clone, Copy)]
enum Below {
    Bonded,
    Frictionless,
    HalfSpace { ratio: f64, nu: f64 },
}

/// L(t) by the problem itself: Airy's function f(z) cos z of wave number 1 on a layer of thickness t, f and its
/// derivatives of four (and two in the base) exponentials, the conditions of surface and base solved as a linear
/// system.
fn by_equations(t: f64, nu: f64, below: Below) -> f64 {
    // derivatives 0 to 3 of e^(s(z − z0)), z e^(s (z − z0)) at z
    let rows = |s: f64, z0: f64, z: f64| {
        let e = (s * (z - z0)).exp();
        let plain: [f64; 4] = std::array::from_fn(|n| s.powi(n as i32) * e);
        let linear: [f64; 4] = std::array::from_fn(|n| (s.powi(n as i32) * z + n as f64 * s.powi(n as i32 - 1)) * e);
        [plain, linear]
    };
    let layer = |z: f64| -> Vec<[f64; 4]> { [rows(-1.0, 0.0, z), rows(1.0, t, z)].concat() };
    // 2G times displacements, from Hooke's law in plane strain
    let along = |d: &[f64; 4], nu: f64| (1.0 - nu) * d[2] + nu * d[0];
    let normal = |d: &[f64; 4], nu: f64| (1.0 - nu) * d[3] - (2.0 - nu) * d[1];
    let size = if matches!(below, Below::HalfSpace { .. }) { 6 } else { 4 };
    let mut matrix = Mat::<f64>::zeros(size, size);
    let mut right = Mat::<f64>::zeros(size, 1);
    right[(0, 0)] = 1.0; // −f(0) = σ_zz = −p
    for (k, (top, low)) in layer(0.0).iter().zip(layer(t)).enumerate() {
        (matrix[(0, k)], matrix[(1, k)]) = (top[0], top[1]);
        match below {
            Below::Bonded => (matrix[(2, k)], matrix[(3, k)]) = (along(&low, nu), normal(&low, nu)),
            Below::Frictionless => (matrix[(2, k)], matrix[(3, k)]) = (low[1], normal(&low, nu)),
            Below::HalfSpace { .. } => {
                (matrix[(2, k)], matrix[(3, k)]) = (low[0], low[1]);
                (matrix[(4, k)], matrix[(5, k)]) = (along(&low, nu), normal(&low, nu));
            }
        }
    }
    if let Below::HalfSpace { ratio, nu } = below {
        // decaying downwards; displacements with 1/G₂ = ratio/G₁
        for (k, own) in rows(-1.0, t, t).iter().enumerate() {
            (matrix[(2, 4 + k)], matrix[(3, 4 + k)]) = (-own[0], -own[1]);
            (matrix[(4, 4 + k)], matrix[(5, 4 + k)]) = (-ratio * along(own, nu), -ratio * normal(own, nu));
        }
    }
    let solution = matrix.full_piv_lu().solve(&right);
    let surface: f64 = layer(0.0).iter().enumerate().map(|(k, own)| solution[(k, 0)] * normal(own, nu)).sum();
    // u = C (2/q) L p, C = (1 − ν)/2G
    surface / (2.0 * (1.0 - nu))
}

#[test]
fn responses_solve_the_equations_of_elasticity() {
    for nu in [-0.5, 0.0, 0.3, 0.49, 0.5] {
        let mut cases =
            vec![(Below::Bonded, Response::bonded(nu, 0.5, 0.0)), (Below::Frictionless, Response::Frictionless)];
        for ratio in [1e-3, 0.2, 1.0, 3.0, 1e3] {
            for base in [-0.3, 0.0, 0.3, 0.5] {
                cases.push((Below::HalfSpace { ratio, nu: base }, Response::bonded(nu, base, ratio)));
            }
        }
        for (below, response) in cases {
            for t in [0.02, 0.1, 0.5, 0.74, 0.76, 1.0, 2.0, 5.0, 12.0] {
                let (found, exact) = (response.at(t), by_equations(t, nu, below));
                // the linear system is ill-conditioned where the layer is thin
                let tolerance = 1e-12 + 1e-14 / (t * t * t * t);
                assert!((found / exact - 1.0).abs() < tolerance, "{below:?} ν = {nu}, t = {t}: {found:e} {exact:e}");
                let less = response.less_one(t) - (found - 1.0);
                assert!(less.abs() < 1e-15 * (1.0 + found), "{below:?} ν = {nu}, t = {t}: {less:e}");
            }
        }
    }
}

#[test]
fn responses_hold_from_the_longest_wave_to_the_shortest() {
    for nu in [-0.9, 0.0, 0.3, 0.4999, 0.5] {
        let bonded = Response::bonded(nu, 0.5, 0.0);
        for t in [1e-300, 1e-100, 1e-8, 1e-4] {
            let exact = if nu == 0.5 {
                2.0 / 3.0 * t * t * t
            } else {
                // and the next order
                (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu) * (1.0 - nu)) * t
            };
            let next = if nu < 0.5 { 4.0 * t * t * t / (1.0 - 2.0 * nu) } else { 8.0 * t.powi(5) };
            assert!((bonded.at(t) - exact).abs() <= 1e-14 * exact + next, "{nu} {t:e} {:e} {exact:e}", bonded.at(t));
            assert!((Response::Frictionless.at(t) / (0.5 * t) - 1.0).abs() < 1e-14 + t * t);
        }
        for response in [bonded, Response::Frictionless, Response::bonded(nu, 0.2, 7.0), Response::bonded(nu, 0.5, 1e6)]
        {
            for exponent in -300..=300 {
                let t = 10_f64.powi(exponent);
                let value = response.at(t);
                assert!(value.is_finite() && value >= 0.0 && response.less_one(t).is_finite(), "{response:?} {t:e}");
                assert!(t < 1e3 || (value == 1.0 && response.less_one(t) == 0.0));
            }
        }
    }
    // the same material: a half-space
    for t in [0.0, 1e-9, 0.3, 4.0] {
        assert!((Response::bonded(0.3, 0.3, 1.0).at(t) - 1.0).abs() < 1e-15);
        assert_eq!(Response::bonded(0.3, 0.3, 1.0).less_one(t), 0.0);
    }
    // a thin layer is its base: μ (1 − ν₂)/(1 − ν₁)
    assert!((Response::bonded(0.3, 0.45, 20.0).at(0.0) / (20.0 * 0.55 / 0.7) - 1.0).abs() < 1e-14);
}

#[test]
fn oscillating_integrals_have_their_closed_forms() {
    let plain = Oscillation::new(Weight::Bessel, 1.0, |t: f64| (-2.0 * t).exp());
    let squared = Oscillation::new(Weight::Bessel, 1.0, |t: f64| t * t * (-2.0 * t).exp());
    let cosine = Oscillation::new(Weight::Cosine, 1.0, |t: f64| (-2.0 * t).exp());
    let soft = Oscillation::new(Weight::Bessel, 1e-6, |t: f64| (-2e6 * t).exp());
    for x in [0.0, 0.1, 1.0, 3.0, 5.0, 5.4, 7.0, 30.0, 1e3, 1e5, 1e8] {
        let r = 4.0 + x * x;
        let close = |found: f64, exact: f64, scale: f64| {
            assert!((found - exact).abs() < 2e-14 * scale, "{x}: {found:e} {exact:e}");
        };
        close(plain.integral(x), 1.0 / r.sqrt(), 1.0 / r.sqrt());
        // second derivative with respect to the depth; its terms are as large as 1/r^(3/2)
        close(squared.integral(x), (8.0 - x * x) / (r * r * r.sqrt()), 1.0 / r.sqrt());
        close(cosine.integral(x), 2.0 / r, 1.0 / r.sqrt());
        close(soft.integral(x), 1.0 / (4e12 + x * x).sqrt(), 1.0 / (4e12 + x * x).sqrt());
    }
}

/// ∫ over an interval in many pieces.
fn plain(from: f64, to: f64, pieces: usize, f: impl Fn(f64) -> f64) -> f64 {
    let (rule, length) = (GaussLegendre::new(8), (to - from) / pieces as f64);
    (0..pieces).map(|n| rule.integrate(from + n as f64 * length, from + (n + 1) as f64 * length, &f)).sum()
}

/// ∬ G over a cell, piece by piece.
fn naive_cell(response: Response, thickness: f64, at: [f64; 2], sides: [f64; 2]) -> f64 {
    let farthest = at[0].hypot(at[1]) + sides[0] + sides[1];
    let pieces = 60 + (8.0 * farthest / thickness) as usize;
    let g = |r: f64| {
        let wave = |t: f64| response.less_one(t) * libm::j0(t * r / thickness);
        (plain(0.0, 1.0, 60, wave) + plain(1.0, 26.0, pieces, wave)) / (std::f64::consts::PI * thickness)
    };
    let count = |side: f64| (1.0 + 1.5 * side / thickness).ceil() as usize;
    let inner =
        |x: f64| plain(at[1] - 0.5 * sides[1], at[1] + 0.5 * sides[1], count(sides[1]), |y| g(f64::hypot(x, y)));
    plain(at[0] - 0.5 * sides[0], at[0] + 0.5 * sides[0], count(sides[0]), inner)
}

#[test]
fn remainders_of_cells_are_their_integrals() {
    let bonded = Layer::bonded_to_rigid;
    for layer in [bonded(1.0, 0.5), bonded(0.3, 0.0), Layer::bonded_to_half_space(0.5, 0.3, 8.0, 0.4)] {
        let layer = layer.unwrap();
        let (response, thickness) = (layer.response(), layer.thickness());
        let remainder = Remainder::of_cells(&layer, 50.0);
        for (at, sides) in [([0.0, 0.0], [0.1, 0.2]), ([0.0, 0.0], [1.0, 0.7]), ([0.6, 1.4], [0.6, 0.7])] {
            let (found, exact) = (remainder.on_cell(at, sides), naive_cell(response, thickness, at, sides));
            let scale = sides[0] * sides[1] / (std::f64::consts::PI * (at[0].hypot(at[1]) + thickness));
            assert!((found - exact).abs() < 2e-12 * scale, "{response:?} {at:?}: {found:e} {exact:e}");
        }
        // cells far larger than the layer is thick: as their pieces
        let side = 30.0 * thickness;
        let whole = remainder.on_cell([side, 0.0], [side; 2]);
        let piece = |k: usize| {
            let offset = |k: usize| side * ((k as f64 + 0.5) / 30.0 - 0.5);
            remainder.on_cell([side + offset(k / 30), offset(k % 30)], [thickness; 2])
        };
        let pieces: f64 = (0..900).map(piece).sum();
        assert!((whole / pieces - 1.0).abs() < 1e-13, "{whole:e} {pieces:e}");
    }
}

/// On a rigid base nothing is left of a load far away.
#[test]
fn remainders_cancel_the_half_space_far_from_a_load() {
    let bonded = |nu: f64| Layer::bonded_to_rigid(1.0, nu).unwrap();
    for layer in [bonded(0.5), bonded(0.1), Layer::frictionless_on_rigid(1.0, 0.3).unwrap()] {
        let (side, far) = (0.1, 40.0);
        let cells = Remainder::of_cells(&layer, 50.0);
        let point = side * side / (std::f64::consts::PI * far);
        assert!((cells.on_cell([far, 0.0], [side; 2]) / -point - 1.0).abs() < 1e-6); // the cell is no point
        let lines = Remainder::of_lines(&layer, 50.0, None);
        let line = std::f64::consts::FRAC_2_PI * side * (far / 2.0).ln();
        assert!((lines.on_line(far, side) / line - 1.0).abs() < 1e-6);
        // all cells of a plane together: the mean of long waves
        let sum: f64 = (-400..=400).map(|i| lines.on_line(f64::from(i) * side, side)).sum::<f64>();
        let strip = crate::kernel::line_load::Strip { side, datum: 2.0 };
        let total = sum + strip.at(0.0, 0.0) + 2.0 * (1..=400).map(|i| strip.at(f64::from(i) * side, 0.0)).sum::<f64>();
        let long = layer.compliance(1e-7);
        assert!((total - long).abs() < 1e-10, "{total:e} {long:e}");
    }
}
