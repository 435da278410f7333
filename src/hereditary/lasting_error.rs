//! What the defects of many steps leave in the displacement.

use crate::hereditary::exponential_rule::ExponentialRule;

/// The mean error of u that the defects of earlier steps have left, with the errors of the q_i that belong to it.
/// Bodies being linear, an error follows the recursion of u itself, as in a cell to whose q_i each step adds its
/// defect: the defect relaxes, and u keeps its response until the bodies creep back.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LastingError {
    u: f64,
    q: Vec<f64>,
}

impl LastingError {
    /// No error, of bodies that follow the rule.
    pub(crate) fn none(rule: &ExponentialRule) -> LastingError {
        LastingError { u: 0.0, q: vec![0.0; rule.branches()] }
    }

    /// Whether a run can be continued with it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self) -> bool {
        self.u.is_finite() && self.q.iter().all(|q| q.is_finite())
    }

    /// The error of u.
    pub(crate) fn of_displacement(&self) -> f64 {
        self.u.abs()
    }

    /// Takes in the step of this `defect` of v that the rule has predicted and not yet replaced by the next
    /// prediction. Where a motion is given, u has no error.
    pub(crate) fn include(&mut self, rule: &ExponentialRule, defect: f64, motion_is_given: bool) {
        let (mut answer, mut left) = (rule.viscous(), 0.0);
        for (q, [decay, of_u, share]) in self.q.iter_mut().zip(rule.responses()) {
            *q = decay * *q + share * defect;
            (answer, left) = (answer + of_u, left + *q);
        }
        let u = if motion_is_given { 0.0 } else { (answer * self.u - left) / (answer + rule.equilibrium()) };
        let change = u - self.u;
        self.q.iter_mut().zip(rule.responses()).for_each(|(q, [_, of_u, _])| *q += of_u * change);
        self.u = u;
    }
}
