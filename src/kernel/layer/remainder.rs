//! The addition of a layer to the influence coefficients of a half-space.
//!
//! Of the compliance (2/q) L(qh), the half-space has (2/q), in closed form: Love's, or a line's. The rest is
//! smooth on the scale h: a point load adds, at the distance r,
//!
//! g(r) = (1/π) ∫ (L(qh) − 1) J0(qr) dq = G(r/h)/(πh),   G(ρ) = ∫ (L(t) − 1) J0(ρt) dt,
//!
//! analytic but for ρ = ±2i, ±4i, …, the images of the load. A line load adds
//!
//! w(x) = (2/π) [(1 − L(0)) ½ ln(1 + ξ²/4) + ∫ S(t) cos(ξt) dt],   S(t) = (L(t) − L(0) − (1 − L(0)) (1 − e^(−2t)))/t,
//!
//! ξ = x/h, to −(2/π) ln(|x|/2h): from ∫ (1 − e^(−2t))/t cos(ξt) dt = ½ ln(1 + 4/ξ²). Where L(0) = 0, on a rigid base,
//! both together vanish far away, as e^(−1.19ξ) or sooner. Elsewhere −(2/π) L(0) ln ξ remains, and the user's datum
//! is the datum of the surface. A wave of wave number κ along a line load adds
//!
//! w(x) = (2/π) ∫ (L(τ) − 1)/τ cos(ξt) dt,   τ = √(t² + κ²h²),
//!
//! to (2/π) K0(κ |x|): nothing where κh is so large that the wave does not reach the base.

use std::f64::consts::{FRAC_2_PI, PI};

use super::Layer;
use super::oscillation::{Oscillation, Weight};
use super::table::Table;
use crate::quadrature::GaussLegendre;

/// Error of the integral over a cell, relative to the integrand: digits of the rule with n points on a piece whose
/// distance from the images is d side lengths are about 2n log₁₀ 4d.
const DIGITS: f64 = 15.0;
/// Points on a piece; one that needs more is halved.
const MOST_POINTS: usize = 10;

/// κh of a wave that leaves e^(−2κh) of itself at the base: rounding.
const DEEPEST_WAVE: f64 = 20.0;
/// κx of a wave that has decayed to rounding.
const FARTHEST_WAVE: f64 = 40.0;

/// The remainder of a layer, by distance.
#[derive(Debug, Clone)]
pub(in crate::kernel) struct Remainder {
    thickness: f64,
    table: Table,
    /// 1 − L(0) for lines, which have a logarithm beside the table, else 0.
    log: f64,
    /// w at the datum, where it counts as zero.
    datum: f64,
    /// Rules of 1, 2, … points.
    rules: Vec<GaussLegendre>,
}

impl Remainder {
    /// The remainder of a load on a cell, for distances up to `last` \[m\].
    pub(in crate::kernel) fn of_cells(layer: &Layer, last: f64) -> Remainder {
        let response = layer.response();
        let hankel = Oscillation::new(Weight::Bessel, response.least_scale(), |t| response.less_one(t));
        Remainder::new(layer, last, |x| hankel.integral(x))
    }

    /// The remainder of a load on a line; `datum` \[m\] is where the displacement on a base that is a half-space is
    /// zero.
    pub(in crate::kernel) fn of_lines(layer: &Layer, last: f64, datum: Option<f64>) -> Remainder {
        let (response, longest) = (layer.response(), layer.longest_over_half_space());
        let fourier = Oscillation::new(Weight::Cosine, response.least_scale(), |t: f64| {
            ((response.at(t) - longest) + (1.0 - longest) * (-2.0 * t).exp_m1()) / t
        });
        let log = 1.0 - longest;
        let at_datum = datum.map_or(0.0, |datum| {
            let x = datum / layer.thickness;
            FRAC_2_PI * (fourier.integral(x) + logarithm(log, x))
        });
        Remainder { log, datum: at_datum, ..Remainder::new(layer, last, |x| fourier.integral(x)) }
    }

    /// The remainder of a load on a line that varies as a wave of wave number `kappa` \[1/m\] > 0 along it; `None`
    /// where the wave does not reach the base.
    pub(in crate::kernel) fn of_wave(layer: &Layer, last: f64, kappa: f64) -> Option<Remainder> {
        let (response, k) = (layer.response(), kappa * layer.thickness);
        if k > DEEPEST_WAVE {
            return None;
        }
        let least = response.least_scale().min(k);
        let fourier = Oscillation::new(Weight::Cosine, least, |t: f64| {
            let tau = t.hypot(k);
            response.less_one(tau) / tau
        });
        // far along the surface the wave is gone, with and without the layer
        Some(Remainder::new(layer, last, |x| if k * x > FARTHEST_WAVE { 0.0 } else { fourier.integral(x) }))
    }

    /// `added` is the addition at a distance in units of the thickness.
    fn new(layer: &Layer, last: f64, added: impl Fn(f64) -> f64) -> Remainder {
        let (thickness, rules) = (layer.thickness, (1..=MOST_POINTS).map(GaussLegendre::new).collect());
        Remainder { thickness, table: Table::new(last / thickness, added), log: 0.0, datum: 0.0, rules }
    }

    /// The displacement \[m\] under a unit pressure on the rectangle of these sides \[m\] around a point `at` \[m\].
    pub(in crate::kernel) fn on_cell(&self, at: [f64; 2], sides: [f64; 2]) -> f64 {
        // in units of the thickness
        let [at, sides] = [at, sides].map(|pair| pair.map(|length| length / self.thickness));
        self.over(at, sides) * self.thickness / PI
    }

    /// The displacement \[m\] under a unit pressure on a strip of this width \[m\] at a distance \[m\], in plane
    /// strain.
    pub(in crate::kernel) fn on_line(&self, at: f64, side: f64) -> f64 {
        let [at, side] = [at, side].map(|length| length / self.thickness);
        FRAC_2_PI * self.along(at, side) * self.thickness - self.datum * side * self.thickness
    }

    /// ∬ G over a rectangle.
    fn over(&self, at: [f64; 2], sides: [f64; 2]) -> f64 {
        let nearest = [0, 1].map(|axis| (at[axis].abs() - 0.5 * sides[axis]).max(0.0));
        let distance = nearest[0].hypot(nearest[1]).hypot(2.0);
        let points = sides.map(|side| points(side, distance));
        let long = if sides[0] >= sides[1] { 0 } else { 1 };
        if points[long] > MOST_POINTS {
            let mut halves = [at; 2];
            let mut half = sides;
            half[long] *= 0.5;
            halves[0][long] -= 0.5 * half[long];
            halves[1][long] += 0.5 * half[long];
            return halves.into_iter().map(|at| self.over(at, half)).sum();
        }
        let rules = points.map(|points| &self.rules[points - 1]);
        let row = |x: f64| {
            let inner = |y: f64| self.table.at(x.hypot(at[1] + 0.5 * sides[1] * y));
            rules[1].sum(inner)
        };
        0.25 * sides[0] * sides[1] * rules[0].sum(|x| row(at[0] + 0.5 * sides[0] * x))
    }

    /// ∫ of the addition of a line over an interval.
    fn along(&self, at: f64, side: f64) -> f64 {
        let distance = (at.abs() - 0.5 * side).max(0.0).hypot(2.0);
        let points = points(side, distance);
        if points > MOST_POINTS {
            return self.along(at - 0.25 * side, 0.5 * side) + self.along(at + 0.25 * side, 0.5 * side);
        }
        let rule = &self.rules[points - 1];
        0.5 * side
            * rule.sum(|s| {
                let x = (at + 0.5 * side * s).abs();
                self.table.at(x) + logarithm(self.log, x)
            })
    }
}

/// (1 − L(0)) ½ ln(1 + ξ²/4).
fn logarithm(factor: f64, x: f64) -> f64 {
    0.5 * factor * (0.25 * x * x).ln_1p()
}

/// Points on a piece of length `side`, the images being at a `distance`.
fn points(side: f64, distance: f64) -> usize {
    let digits = 2.0 * (4.0 * distance / side).log10();
    if digits <= 0.0 { usize::MAX } else { (DIGITS / digits).ceil().max(1.0) as usize }
}
