//! The error of v where the course of u has a kink within a step: where a body meets a cell.

use std::sync::OnceLock;

use crate::hereditary::exponential_rule::ExponentialRule;

/// Shares of a step at which the states within it are judged, besides its end.
const SHARES: [f64; 3] = [0.25, 0.5, 0.75];

/// The errors of v by kinks of u in the step predicted last.
///
/// u of a cell follows its extrapolated course until a body meets the cell within the step of length Δ. From then on
/// u changes faster, by `jump` Δ⁻¹ more, and at the end it is off by `bend`: the cell was met at the time (1 − θ) Δ,
/// θ = bend/jump. With z_i = Δ/τ_i, v responds at the time σ Δ by
///
/// Σ E_i (1 − e^(−(σ − 1 + θ) z_i))/z_i jump + η jump/Δ.
///
/// The rule instead responds to `bend` as to any change that the steps before do not predict.
pub(super) struct Kinks<'a> {
    rule: &'a ExponentialRule,
    /// The response, at each of the [`SHARES`] σ, to a u that has grown linearly by 1 since the start of the step:
    /// Σ E_i (1 − e^(−σ z_i))/(σ z_i). Computed for the first kink: most steps have none.
    linear: OnceLock<[f64; SHARES.len()]>,
}

impl Kinks<'_> {
    pub(super) fn of(rule: &ExponentialRule) -> Kinks<'_> {
        Kinks { rule, linear: OnceLock::new() }
    }

    /// What v lacks at the end of the step: by the polynomial on it, and with what the kink wrongly changes of the
    /// step before, which was smooth. The next step puts right a part of either.
    pub(super) fn at_end(&self, jump: f64, bend: f64) -> [f64; 2] {
        let since = bend / jump;
        if !(since > 0.0 && since < 1.0) {
            return [0.0; 2];
        }
        let exact = (self.rule.relaxing(since) + self.rule.viscous()) * jump;
        self.rule.responses_to_unexpected().map(|response| exact - response * bend)
    }

    /// What v lacks at each of the [`SHARES`], where a shorter step from the same start takes u to be linear. Short
    /// relaxation times respond to the kink and forget it before the step ends, so that its end does not show this
    /// error.
    ///
    /// An immediate dashpot responds by a finite pressure to a cell just met, however short the step: nothing
    /// resolves that.
    pub(super) fn within(&self, jump: f64, bend: f64) -> [f64; SHARES.len()] {
        let met = 1.0 - bend / jump;
        let linear = || SHARES.map(|share| self.rule.relaxing(share) / share);
        std::array::from_fn(|k| {
            let since = SHARES[k] - met;
            if !(met > 0.0 && since > 0.0) || self.rule.has_dashpot() {
                return 0.0;
            }
            (self.rule.relaxing(since) - since * self.linear.get_or_init(linear)[k]) * jump
        })
    }
}
