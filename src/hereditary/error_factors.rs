//! The weights of the embedded estimate of the error in time: what the theory of smooth steps leaves open.
//!
//! They were chosen on random scenes (docs/maintainers/measurements.md, errors of adaptive steps), so that the true
//! error is at most twice the tolerance in 99 % of them.

/// ErrorFactors of the error of a step in space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ErrorFactors {
    /// Share of the defect of a step that is left once the next step has put it right, ...
    pub(crate) corrected: f64,
    /// ... of a body that answers by an immediate dashpot, ...
    pub(crate) corrected_of_dashpot: f64,
    /// ... and of one that is never put right, of linear steps. Fitted on one cell under smooth loads.
    pub(crate) not_corrected: f64,
    /// A force, and an immediate dashpot, press cells at the edge of the contact more than others: a rigid body
    /// presses hardest there.
    pub(crate) edge: f64,
    /// Bodies that nothing pressed before meet all their cells within a step, and their kinks agree: most of that
    /// error is one of the pressure alone. For the estimates of given steps (`tests/time/fixed_steps.rs`).
    pub(crate) from_rest: f64,
    /// A corner of the temperature is one of the second derivative of u. The steps before do not show it: the estimate
    /// of the first step after it, which the next step does not put right, is too low by this factor times the ratio
    /// of the step before to this one.
    pub(crate) at_turn: f64,
    /// An error of u before a switch to a given approach counts at most so many times: the force by which stiffer
    /// glass answers is over before the first step ends.
    pub(crate) most_on_switch: f64,
    /// Events shorter than this fraction of the time between corners, times the tolerance, are not resolved.
    pub(crate) shortest: f64,
    /// The error of a step with a jump of an adhesive contact is multiplied by this: the state after a jump depends
    /// little on when it jumped, and on the energy lost.
    pub(crate) jumped: f64,
    /// The part of the difference between an adhesive step and its halves that counts: the whole of it where the rule
    /// has the order one, a third of it at the order two of most steps.
    pub(crate) halves: f64,
}

pub(crate) const ERROR_FACTORS: ErrorFactors = ErrorFactors {
    corrected: 0.4,
    corrected_of_dashpot: 1.2,
    not_corrected: 0.25,
    edge: 3.0,
    from_rest: 0.1,
    at_turn: 5.0,
    most_on_switch: 3e3,
    shortest: 0.03,
    jumped: 100.0,
    halves: 0.5,
};
