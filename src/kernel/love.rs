//! Influence coefficients of a rectangular cell under unit pressure on a half-space.
//!
//! The coefficient of the cell at distance (i Δ1, j Δ2) is Love's integral (Phil. Trans. R. Soc. A
//! 228, 1929; Eq. 8 of the paper, without its factor of the material)
//!
//! K(i, j) = (1/π) ∬ dx dy / √((iΔ1 − x)² + (jΔ2 − y)²)   over |x| < Δ1/2, |y| < Δ2/2.
//!
//! The textbook four-term closed form subtracts numbers that grow with the distance while the
//! result shrinks: its relative error grows as ε (distance/Δ)². Instead the integral is taken in
//! closed form along the longer side, where it is the potential of a uniform rod with end
//! distances r1 and r2 and length L,
//!
//! ln (r1 + r2 + L)/(r1 + r2 − L),
//!
//! written below without any cancellation, and by Gauss–Legendre quadrature along the shorter
//! side. Every term is positive, so that rounding errors do not accumulate beyond a few units in the last
//! place, and the integrand is analytic in an ellipse that grows with the distance, so that the
//! number of points falls from 24 beside the source to 3 far away.

use std::f64::consts::PI;

use crate::quadrature::GaussLegendre;

/// Love coefficients of one cell shape \[m\].
#[derive(Debug, Clone)]
pub(crate) struct Love {
    /// Whether x1 is the longer side of the cell.
    pub(super) long_first: bool,
    /// Half sides of the cell in units of `scale`, the longer one first.
    pub(super) half: [f64; 2],
    /// Half of the longer side \[m\].
    pub(super) scale: f64,
    /// Quadrature rules by number of points, each with the distance from which it is exact to rounding.
    pub(super) rules: Vec<(f64, GaussLegendre)>,
}

impl Love {
    /// Coefficients for cells with sides `spacing` \[m\].
    pub(crate) fn new(spacing: [f64; 2]) -> Love {
        let long_first = spacing[0] >= spacing[1];
        let (long, short) = if long_first { (spacing[0], spacing[1]) } else { (spacing[1], spacing[0]) };
        // n points integrate a function analytic in the Bernstein ellipse ρ with an error near ρ^(−2n);
        // a singularity at distance D from the middle of the short side (half-width 1) gives
        // ρ = D + √(D² − 1) when it lies on its line, the least favourable place, and at least
        // D + √(D² + 1) when it lies across.
        let rules = [3, 4, 6, 8, 12, 24]
            .map(|points| {
                let rho = (f64::EPSILON / 4.0).powf(-0.5 / points as f64);
                (0.5 * (rho + 1.0 / rho), GaussLegendre::new(points))
            })
            .into();
        Love { long_first, half: [1.0, short / long], scale: 0.5 * long, rules }
    }

    /// The coefficient of the cell (i, j) cells away \[m\].
    pub(crate) fn coefficient(&self, [i, j]: [usize; 2]) -> f64 {
        let (along, across) = if self.long_first { (i, j) } else { (j, i) };
        let [a, b] = self.half;
        if along == 0 && across == 0 {
            return self.scale * 4.0 / PI * (a * (b / a).asinh() + b * (a / b).asinh());
        }
        let (x, y) = (2.0 * a * along as f64, 2.0 * b * across as f64);
        // distance of the nearest singularity of the integrand, in half-widths of the short side
        let nearest = if along == 0 { y / b } else { y.hypot(x - a) / b };
        let rule =
            &self.rules.iter().find(|(reach, _)| nearest >= *reach).unwrap_or(&self.rules[self.rules.len() - 1]).1;
        self.scale * b / PI * rule.sum(|s| rod_potential(x, y + b * s, a))
    }
}

/// ∫ ds / √((x − s)² + y²) over |s| < a, for x ≥ 0: the potential of a rod.
pub(super) fn rod_potential(x: f64, y: f64, a: f64) -> f64 {
    let (r1, r2) = ((x + a).hypot(y), (x - a).hypot(y));
    // r1 + r2 − 2a, each bracket free of cancellation: r − d = y²/(r + d) for r² = d² + y²
    let excess = y * y / (r1 + (x + a)) + y * y / (r2 + (x - a).abs()) + 2.0 * (x - a).max(0.0);
    (4.0 * a / excess).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_cell_on_itself() {
        assert_eq!(Love::new([0.5, 0.5]).coefficient([0, 0]), 0.5 * 4.0 * 1_f64.asinh() / PI);
    }

    #[test]
    fn cells_may_be_exchanged_and_scaled() {
        let love = Love::new([1.0, 3.0]);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (5, 2), (40, 700)] {
            assert_eq!(love.coefficient([i, j]), Love::new([3.0, 1.0]).coefficient([j, i]));
            assert_eq!(4.0 * love.coefficient([i, j]), Love::new([4.0, 12.0]).coefficient([i, j]));
        }
    }
}
