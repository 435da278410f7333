//! Terms of the force over an interval in which the contact grows.

use crate::forward::real::Real;
use crate::forward::tip::Elastic;

/// One term Eᵢ exp(−t/τᵢ) of the series at one time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Term<const N: usize> {
    /// ∫ Eᵢ exp(−(t − s)/τᵢ) dδ of the tip \[Pa m\].
    pub(super) tip: Real<N>,
    /// Its part of the force of the columns in contact \[N\].
    pub(super) force: Real<N>,
    /// Its part of the pressure of the column at the edge \[Pa m\]: the parts of all terms cancel there.
    pub(super) edge: Real<N>,
}

/// The columns that touch in an interval, one after the other: from the edge of the contact at its start to the edge at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth<const N: usize> {
    /// Change of the depth of the tip \[m\].
    rise: Real<N>,
    /// Coefficients of ξ⁰, ξ¹, ξ² of df/dδ at the edge: a parabola with the right ends and the right mean.
    stiffness: [Real<N>; 3],
    /// Whether no column has touched before, so that none has a past.
    pub(super) fresh: bool,
}

/// Extents that differ by less than this fraction have one stiffness.
const SAME: f64 = 1e-9;

impl<const N: usize> Growth<N> {
    pub(super) fn new(from: (Real<N>, Elastic<N>), to: (Real<N>, Elastic<N>), rise: Real<N>, fresh: bool) -> Growth<N> {
        let ([a, b], width) = ([from.1.stiffness, to.1.stiffness], to.0 - from.0);
        let mean = match width.value() > SAME * to.0.value() {
            true => (to.1.force - from.1.force) / width,
            false => Real::from(0.5) * (a + b),
        };
        let six = Real::from(6.0) * mean;
        let stiffness = [a, six - Real::from(4.0) * a - Real::from(2.0) * b, Real::from(3.0) * (a + b) - six];
        Growth { rise, stiffness, fresh }
    }

    /// The force of terms of some moments: the factors of the modulus, of the pressure with which columns touch at the start, and of its change.
    #[inline(always)]
    fn factors(&self, &[m0, m1, m2]: &[Real<N>; 3]) -> [Real<N>; 3] {
        let [s0, s1, s2] = self.stiffness;
        let twice = s2 + s2;
        [self.rise * (s0 * m0 + s1 * m1 + s2 * m2), s1 * m0 + twice * m1, s1 * m1 + twice * m2]
    }

    /// Force of terms whose moments have the sums `modulus` Σ Eᵢ Mₖ, `start` Σ qᵢ Mₖ and `change` Σ Δqᵢ Mₖ, where q is the pressure of a
    /// column as it touches, linear in ξ from qᵢ to qᵢ + Δqᵢ:
    /// ∫ dδ/dξ f′ exp(−a (1 − ξ)) dξ + ∫ df′/dξ q(ξ) exp(−a (1 − ξ)) dξ.
    pub(super) fn force(&self, modulus: &[Real<N>; 3], start: &[Real<N>; 3], change: &[Real<N>; 3]) -> Real<N> {
        let [tip, ..] = self.factors(modulus);
        if self.fresh { tip } else { tip + self.factors(start)[1] + self.factors(change)[2] }
    }

    /// A term at the end of the interval, where the column at the edge has the pressure `edge`.
    pub(super) fn after(
        &self,
        term: &Term<N>,
        modulus: Real<N>,
        decay: Real<N>,
        moments: &[Real<N>; 3],
        edge: Real<N>,
    ) -> Term<N> {
        let [of_modulus, of_start, of_change] = self.factors(moments);
        let tip = decay * term.tip + modulus * self.rise * moments[0];
        let force = decay * term.force + modulus * of_modulus;
        if self.fresh {
            return Term { tip, force, edge: Real::from(0.0) };
        }
        Term { tip, force: force + of_start * term.edge + of_change * (edge - term.edge), edge }
    }
}
