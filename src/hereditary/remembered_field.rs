//! A field that follows the recursion of the displacement.

use educe::Educe;

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::field::{Field, Role};
use crate::hereditary::past::Past;
use crate::parallel::Rows;
use crate::sum::greatest;

/// What lies below zero by less than this part of the greatest value is rounding.
const DIP: f64 = -1e-9;
/// So small a part of the side of a cell is what a convolution leaves of nothing.
const NOISE: f64 = -1e-14;

/// A field and the memory of its past. The bodies being linear, whatever the displacement is a convolution of
/// follows the recursion of the displacement itself.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RememberedField {
    pub(super) past: Past,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) now: Vec<f64>,
    /// At the end of the step being tried; between steps the field before the last one, which the past has yet to take in.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) trial: Vec<f64>,
}

impl RememberedField {
    /// The undisturbed field of bodies with so many relaxation times.
    pub(crate) fn new(branches: usize, cells: usize) -> RememberedField {
        let past = Past::undisturbed(branches, cells);
        RememberedField { past, now: vec![0.0; cells], trial: vec![0.0; cells] }
    }

    /// The undisturbed field of a rule, on no cells yet. It keeps the differences that steps of given length need, so that none
    /// of these steps allocates.
    pub(super) fn on_no_cells(rule: &ExponentialRule, branches: usize) -> RememberedField {
        let mut field = RememberedField::new(branches, 0);
        field.past.keep(rule.least_kept(), 0);
        field
    }

    /// The field at the end of the step being tried; between steps that before the last one.
    pub(crate) fn trial(&self) -> &[f64] {
        &self.trial
    }

    /// Writes what the past makes of the end of a step to the trial.
    pub(crate) fn predict(&mut self, rule: &ExponentialRule) {
        self.past.predict(rule, &self.now, &mut self.trial);
    }

    /// Predicts the end of the step whose weights were computed last. No pressure has pulled the surface up yet: where the field would fall
    /// below zero, a polynomial of lower degree is taken, where `sign_counts`. `side` \[m\] is the width of a cell.
    pub(crate) fn predict_non_negative(
        &mut self,
        rule: &mut ExponentialRule,
        side: f64,
        rows: &Rows,
        sign_counts: impl Fn() -> bool,
    ) {
        self.predict(rule);
        while rule.has_less() && self.falls_below_zero(rule, side, rows) && sign_counts() {
            rule.reduce_order();
            self.predict(rule);
        }
    }

    /// Whether the trial is negative somewhere, by more than the rounding of the greatest field so far, or of a convolution that
    /// leaves nothing.
    pub(super) fn falls_below_zero(&self, rule: &mut ExponentialRule, side: f64, rows: &Rows) -> bool {
        rule.greatest = rule.greatest.max(rows.greatest(greatest(&self.now)));
        let least = (DIP * rule.greatest).min(NOISE * side);
        rows.any(self.trial.iter().any(|&value| value < least))
    }

    /// Adds c times a source to the trial.
    pub(crate) fn add(&mut self, c: f64, source: &[f64]) {
        self.trial.iter_mut().zip(source).for_each(|(value, &source)| *value += c * source);
    }

    /// Accepts the step predicted last.
    pub(crate) fn commit(&mut self) {
        self.past.commit();
        std::mem::swap(&mut self.now, &mut self.trial);
    }

    /// Returns to the start of the step accepted last; only before anything else is predicted.
    pub(super) fn roll_back(&mut self) {
        self.past.roll_back();
        std::mem::swap(&mut self.now, &mut self.trial);
    }

    /// Lets the past take in the last step, so that nothing depends on the field before it any more.
    pub(super) fn apply_pending_step(&mut self, rule: &ExponentialRule) {
        self.past.apply_pending_step(rule, &mut self.trial, &self.now);
    }

    /// A field of the same past whose fields are what `map` makes of these; the fields of `far` are the sources of these.
    pub(super) fn map(
        &self,
        far: Option<&RememberedField>,
        map: &mut impl FnMut(Field<'_>) -> Vec<f64>,
    ) -> RememberedField {
        RememberedField {
            past: self.past.map(far.map(|far| &far.past), map),
            now: map(Field::single(&self.now, Role::Lasting { source: far.map(|far| &far.now[..]) })),
            trial: map(Field::single(&self.trial, Role::OfStep)),
        }
    }
}
