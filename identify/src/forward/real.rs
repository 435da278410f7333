//! Numbers that carry derivatives.

use std::ops::{Add, Div, Mul, Sub};

use viscocontact::numeric::root;

use crate::error::{Error, Result};

/// Derivatives that one evaluation carries: by parameters and, last, by the unknown of an equation.
pub(crate) const LANES: usize = 6;
/// Derivatives of an evaluation without parameters.
pub(crate) const PLAIN: usize = 1;
/// Last step to a root, as a share of its bracket: the next one would be its square.
const CONVERGED: f64 = 1e-6;

/// A number of the forward model with its derivatives by some parameters and, last, by the unknown of an equation. Values are computed alike, bit by
/// bit, whatever the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Real<const N: usize> {
    value: f64,
    pub(crate) slopes: [f64; N],
}

impl<const N: usize> Real<N> {
    pub(crate) fn new(value: f64, slopes: [f64; N]) -> Self {
        Real { value, slopes }
    }

    /// The number without its derivatives.
    #[inline(always)]
    pub(crate) fn value(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn with(self, value: f64, slope: impl Fn(usize) -> f64) -> Self {
        let mut slopes = [0.0; N];
        slopes.iter_mut().enumerate().for_each(|(k, of)| *of = slope(k));
        Real { value, slopes }
    }

    /// A function of this number with a given value and slope.
    #[inline(always)]
    pub(super) fn mapped(self, value: f64, slope: f64) -> Self {
        self.with(value, |k| slope * self.slopes[k])
    }

    /// exp(−x) of this number x.
    pub(super) fn decay(self) -> Self {
        let value = (-self.value).exp();
        self.mapped(value, -value)
    }

    /// The root of a function that falls between two numbers, near a share of the way between them, with the derivatives of its equation by the theorem of implicit functions; an end is
    /// what it depends on.
    pub(super) fn root(
        [low, high]: [Self; 2],
        near: f64,
        mut falling: impl FnMut(Self) -> Result<Self>,
    ) -> Result<Self> {
        let (mut residual, width) = (Ok(low), high - low);
        let from = if (0.0..=1.0).contains(&near) { near } else { 1.0 };
        let share = root([0.0, 1.0], from, CONVERGED, |share| {
            let unknown = low.with(share, |k| if k + 1 == N { 1.0 } else { 0.0 });
            residual = falling(low + unknown * width);
            residual.as_ref().map_or([f64::NAN; 2], |rest| [-rest.value, -rest.slopes[N - 1]])
        });
        let residual = residual?;
        if share.is_nan() {
            let reason = "the spring and the contact do not balance: check the stiffness of the spring and the moduli";
            return Err(Error::NotConverged { iterations: 0, reason });
        }
        let by_unknown = residual.slopes[N - 1];
        let is_end = share == 0.0 || share == 1.0 || by_unknown == 0.0;
        let slope = |k: usize| if k + 1 == N || is_end { 0.0 } else { -residual.slopes[k] / by_unknown };
        Ok(low + low.with(share, slope) * width)
    }
}

impl<const N: usize> Default for Real<N> {
    fn default() -> Self {
        Real::from(0.0)
    }
}

impl<const N: usize> From<f64> for Real<N> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Real { value, slopes: [0.0; N] }
    }
}

/// An operator with the value and the slopes of its result.
macro_rules! operator {
    ($Operator:ident, $name:ident, |$a:ident, $b:ident| $value:expr, |$of:ident, $k:ident| $slope:expr) => {
        impl<const N: usize> $Operator for Real<N> {
            type Output = Self;
            #[allow(clippy::suspicious_arithmetic_impl, reason = "rules of products and quotients")]
            #[inline(always)]
            fn $name(self, $b: Self) -> Self {
                let $a = self;
                let $of = $value;
                $a.with($of, |$k| $slope)
            }
        }
    };
}

operator!(Add, add, |a, b| a.value + b.value, |_sum, k| a.slopes[k] + b.slopes[k]);
operator!(Sub, sub, |a, b| a.value - b.value, |_rest, k| a.slopes[k] - b.slopes[k]);
operator!(Mul, mul, |a, b| a.value * b.value, |_product, k| a.slopes[k] * b.value + a.value * b.slopes[k]);
operator!(Div, div, |a, b| a.value / b.value, |quotient, k| (a.slopes[k] - quotient * b.slopes[k]) / b.value);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let of = |x: f64, y: f64| (-x * y).exp() / (y - x) + x;
        let [x, y] = [Real::new(0.7, [1.0, 0.0]), Real::new(1.9, [0.0, 1.0])];
        let found = (x * y).decay() / (y - x) + x;
        assert_eq!(found.value(), of(0.7, 1.9));
        let step = 1e-6;
        let differences = [of(0.7 + step, 1.9) - of(0.7 - step, 1.9), of(0.7, 1.9 + step) - of(0.7, 1.9 - step)];
        for (lane, difference) in differences.into_iter().enumerate() {
            assert!((found.slopes[lane] / (difference / (2.0 * step)) - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn a_root_has_the_derivatives_of_its_equation() {
        // u² = x: du/dx = 1/(2u)
        let x = Real::new(4.0, [1.0, 0.0]);
        let root = Real::root([Real::from(0.0), x], 0.3, |u| Ok(x - u * u)).unwrap();
        assert!((root.value() - 2.0).abs() < 1e-12 && (root.slopes[0] - 0.25).abs() < 1e-7, "{root:?}");
    }
}
