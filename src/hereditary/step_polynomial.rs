//! What lies between the ends of the last step.

/// The polynomial through both ends of the last step and the start of the one before it, at a time within the last step: in
/// Newton's form u_before + θ d₁ − θ (1 − θ) Δ/(Δ + Δ′) d₂, where d₂ = d₁ − (Δ/Δ′) times the change in the step before.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepPolynomial {
    /// θ: 0 at the start of the step, 1 at its end.
    share: f64,
    /// Δ/Δ′, or 0 for a line.
    growth: f64,
}

impl StepPolynomial {
    /// At the `share` of a step of length `dt`, after one of length `before` if that tells how the last one went on.
    pub(crate) fn new(share: f64, dt: f64, before: Option<f64>) -> StepPolynomial {
        StepPolynomial { share, growth: before.map_or(0.0, |before| dt / before) }
    }

    /// Whether it is at the end of the step.
    pub(crate) fn is_at_end(&self) -> bool {
        self.share == 1.0
    }

    /// Whether it is the line between the ends.
    pub(crate) fn is_line(&self) -> bool {
        self.growth == 0.0
    }

    /// The line between the ends.
    pub(crate) fn line(&self, [start, end]: [f64; 2]) -> f64 {
        if self.is_at_end() { end } else { start + self.share * (end - start) }
    }

    /// The polynomial through the ends and what changed in the step before.
    pub(crate) fn at(&self, ends: [f64; 2], change_before: f64) -> f64 {
        self.line(ends) - self.share * (1.0 - self.share) * self.bend(ends, change_before)
    }

    /// The same; but the line, where the polynomial falls below zero somewhere between ends that do not.
    pub(crate) fn non_negative_at(&self, ends: [f64; 2], change_before: f64) -> f64 {
        // (1 − θ) a + θ b − θ (1 − θ) bend has a negative minimum beyond bend = (√a + √b)²; negative ends yield NaN
        let most = (ends[0].sqrt() + ends[1].sqrt()).powi(2);
        if self.bend(ends, change_before) > most { self.line(ends) } else { self.at(ends, change_before) }
    }

    /// Δ/(Δ + Δ′) d₂.
    fn bend(&self, [start, end]: [f64; 2], change_before: f64) -> f64 {
        self.growth / (1.0 + self.growth) * (end - start - self.growth * change_before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadratics_are_met_and_none_falls_below_zero() {
        let u = |t: f64| 3.0 - 2.0 * t + 0.7 * t * t;
        for (before, dt) in [(1.0, 1.0), (0.3, 1.1), (2.0, 0.4)] {
            for k in 0..=10 {
                let share = 0.1 * f64::from(k);
                let polynomial = StepPolynomial::new(share, dt, Some(before));
                let found = polynomial.at([u(before), u(before + dt)], u(before) - u(0.0));
                assert!((found - u(before + share * dt)).abs() < 1e-14, "{before} {dt} {share}: {found}");
            }
        }
        // 1, 0.1, 0.05: let go, and nearly back
        for k in 0..=20 {
            let polynomial = StepPolynomial::new(0.05 * f64::from(k), 1.0, Some(1.0));
            let (ends, change) = ([0.1, 0.05], -0.9);
            assert_eq!(polynomial.non_negative_at(ends, change), polynomial.line(ends));
            let (ends, change) = ([0.3, 0.2], -0.7);
            assert_eq!(polynomial.non_negative_at(ends, change), polynomial.at(ends, change));
            assert!(polynomial.at(ends, change) >= 0.0);
        }
        // of a field that may be negative, nothing is held back
        let polynomial = StepPolynomial::new(0.5, 1.0, Some(1.0));
        assert_eq!(polynomial.non_negative_at([-0.1, 0.2], -5.0), polynomial.at([-0.1, 0.2], -5.0));
        assert_eq!(StepPolynomial::new(0.5, 1.0, None).at([1.0, 2.0], 7.0), 1.5);
    }
}
