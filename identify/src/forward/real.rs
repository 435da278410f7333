//! Numbers that carry derivatives.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Parameters by which one evaluation differentiates.
pub(crate) const LANES: usize = 5;

/// A number of the forward model: a plain one, or one with its derivatives. Values are computed alike, bit by bit.
pub(crate) trait Real:
    Copy
    + Debug
    + Default
    + From<f64>
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Whether the number has derivatives.
    const DERIVES: bool;

    /// The number without its derivatives.
    fn value(self) -> f64;

    /// A function of this number with a given value and slope.
    fn mapped(self, value: f64, slope: f64) -> Self;

    /// The unknown of an equation, at its root.
    fn unknown(root: f64) -> Self;

    /// The root of an equation, from the residual at [`Real::unknown`]: by the theorem of implicit functions.
    fn implicit(root: f64, residual: Self) -> Self;

    fn exp(self) -> Self {
        let value = self.value().exp();
        self.mapped(value, value)
    }
}

impl Real for f64 {
    const DERIVES: bool = false;

    fn value(self) -> f64 {
        self
    }

    fn mapped(self, value: f64, _: f64) -> f64 {
        value
    }

    fn unknown(root: f64) -> f64 {
        root
    }

    fn implicit(root: f64, _: f64) -> f64 {
        root
    }
}

/// A value with its derivatives by some parameters and, last, by the unknown of an equation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Dual {
    value: f64,
    slopes: [f64; LANES + 1],
}

impl Dual {
    pub(crate) fn new(value: f64, slopes: [f64; LANES]) -> Dual {
        let mut all = [0.0; LANES + 1];
        all[..LANES].copy_from_slice(&slopes);
        Dual { value, slopes: all }
    }

    /// Derivative by a parameter.
    pub(crate) fn slope(self, lane: usize) -> f64 {
        self.slopes[lane]
    }

    fn with(self, value: f64, slope: impl Fn(usize) -> f64) -> Dual {
        Dual { value, slopes: std::array::from_fn(slope) }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Dual {
        Dual { value, slopes: [0.0; LANES + 1] }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        self.with(self.value + other.value, |k| self.slopes[k] + other.slopes[k])
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, other: Dual) {
        *self = *self + other;
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        self.with(self.value - other.value, |k| self.slopes[k] - other.slopes[k])
    }
}

impl Mul for Dual {
    type Output = Dual;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the rule of products")]
    fn mul(self, other: Dual) -> Dual {
        let slope = |k: usize| self.slopes[k] * other.value + self.value * other.slopes[k];
        self.with(self.value * other.value, slope)
    }
}

impl Div for Dual {
    type Output = Dual;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the rule of quotients")]
    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        self.with(value, |k| (self.slopes[k] - value * other.slopes[k]) / other.value)
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        self.with(-self.value, |k| -self.slopes[k])
    }
}

impl Real for Dual {
    const DERIVES: bool = true;

    fn value(self) -> f64 {
        self.value
    }

    fn mapped(self, value: f64, slope: f64) -> Dual {
        self.with(value, |k| slope * self.slopes[k])
    }

    fn unknown(root: f64) -> Dual {
        let mut unknown = Dual::from(root);
        unknown.slopes[LANES] = 1.0;
        unknown
    }

    fn implicit(root: f64, residual: Dual) -> Dual {
        let by_unknown = residual.slopes[LANES];
        let slope = |k: usize| if k == LANES || by_unknown == 0.0 { 0.0 } else { -residual.slopes[k] / by_unknown };
        residual.with(root, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let of = |x: f64, y: f64| (x * y).exp() / (y - x) + x;
        let [x, y] = [Dual::new(0.7, [1.0, 0.0, 0.0, 0.0, 0.0]), Dual::new(1.9, [0.0, 1.0, 0.0, 0.0, 0.0])];
        let found = (x * y).exp() / (y - x) + x;
        assert_eq!(found.value(), of(0.7, 1.9));
        let step = 1e-6;
        let differences = [of(0.7 + step, 1.9) - of(0.7 - step, 1.9), of(0.7, 1.9 + step) - of(0.7, 1.9 - step)];
        for (lane, difference) in differences.into_iter().enumerate() {
            assert!((found.slope(lane) / (difference / (2.0 * step)) - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn a_root_has_the_derivatives_of_its_equation() {
        // u² = x: du/dx = 1/(2u)
        let x = Dual::new(4.0, [1.0, 0.0, 0.0, 0.0, 0.0]);
        let u = Dual::unknown(2.0);
        let root = Dual::implicit(2.0, u * u - x);
        assert_eq!((root.value(), root.slope(0), root.slope(1)), (2.0, 0.25, 0.0));
    }
}
