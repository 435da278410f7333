//! Integrals ∫ f(t) w(xt) dt over t > 0 of an oscillating weight w, J0 or cos, and a function f that vanishes as
//! e^(−2t) does.
//!
//! Pieces follow f where it varies faster, and the half-waves of w where those are shorter. Of many half-waves only
//! the first are integrated: the integrals over them alternate in sign, and of such a series repeated means of the
//! partial sums converge as fast as the differences of its terms vanish (Euler's transformation).

use std::f64::consts::PI;

use crate::quadrature::GaussLegendre;

/// f is negligible beyond this.
const END: f64 = 24.0;
/// Longest piece of f.
const LONGEST: f64 = 0.5;
/// Half-waves that are integrated before the series is extrapolated, and half-waves that it is extrapolated from.
const FIRST: usize = 12;
const EXTRAPOLATED: usize = 28;
/// Points on a piece.
const POINTS: usize = 16;

/// An oscillating weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// J0(xt).
    Bessel,
    /// cos(xt).
    Cosine,
}

impl Weight {
    fn at(self, z: f64) -> f64 {
        match self {
            Weight::Bessel => libm::j0(z),
            Weight::Cosine => z.cos(),
        }
    }

    /// The end of the n-th half-wave: a zero, as z → ∞.
    fn zero(self, n: usize) -> f64 {
        PI * (n as f64 - if self == Weight::Bessel { 0.25 } else { 0.5 })
    }
}

/// The integrals of a function f.
pub(super) struct Oscillation<F> {
    weight: Weight,
    function: F,
    /// The ends of pieces on which f is smooth, from zero on.
    pieces: Vec<f64>,
    rule: GaussLegendre,
}

impl<F: Fn(f64) -> f64> Oscillation<F> {
    /// `least` is the least scale on which f varies, near t = 0.
    pub(super) fn new(weight: Weight, least: f64, function: F) -> Oscillation<F> {
        let mut pieces = vec![0.0];
        let mut end = 0.25 * least;
        while end < LONGEST {
            pieces.push(end);
            end *= 2.0;
        }
        pieces.extend((1..=(END / LONGEST) as usize).map(|n| n as f64 * LONGEST));
        Oscillation { weight, function, pieces, rule: GaussLegendre::new(POINTS) }
    }

    /// ∫ f(t) w(xt) dt.
    pub(super) fn integral(&self, x: f64) -> f64 {
        let half_waves = FIRST + EXTRAPOLATED;
        if x * END <= self.weight.zero(half_waves) {
            return self.between(0.0, END, x);
        }
        let zero = |n: usize| self.weight.zero(n) / x;
        let mut sum = self.between(0.0, zero(FIRST), x);
        let mut sums = [0.0; EXTRAPOLATED + 1];
        sums[0] = sum;
        for n in 0..EXTRAPOLATED {
            sum += self.between(zero(FIRST + n), zero(FIRST + n + 1), x);
            sums[n + 1] = sum;
        }
        for last in (1..sums.len()).rev() {
            for n in 0..last {
                sums[n] = 0.5 * (sums[n] + sums[n + 1]);
            }
        }
        sums[0]
    }

    /// ∫ f(t) w(xt) dt between two limits.
    fn between(&self, from: f64, to: f64, x: f64) -> f64 {
        let inside = |end: f64| end.min(to);
        let first = self.pieces.partition_point(|&end| end <= from);
        let mut start = from;
        let mut sum = 0.0;
        for end in self.pieces[first..].iter().copied().map(inside) {
            if end <= start {
                break;
            }
            // no piece longer than a half-wave
            let count = ((end - start) * x / PI).ceil().max(1.0);
            let length = (end - start) / count;
            for n in 0..count as usize {
                let begin = start + n as f64 * length;
                sum += self.rule.integrate(begin, begin + length, |t| (self.function)(t) * self.weight.at(x * t));
            }
            start = end;
        }
        sum
    }
}
