//! A field that follows the recursion of the displacement.

use crate::hereditary::exponential::Exponential;
use crate::rheology::CreepSpectrum;

/// A field, and what it remembers of its past. The bodies being linear, whatever the displacement is a convolution of
/// follows the recursion of the displacement itself.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RememberedField<R = Exponential> {
    pub(super) recursion: R,
    pub(super) now: Vec<f64>,
    /// At the end of the step being tried; between steps the field before the last one, which the recursion has yet to
    /// take in.
    pub(super) trial: Vec<f64>,
}

impl<R> RememberedField<R> {
    pub(super) fn undisturbed(recursion: R, cells: usize) -> RememberedField<R> {
        RememberedField { recursion, now: vec![0.0; cells], trial: vec![0.0; cells] }
    }

    /// The field at the end of the step being tried; between steps that before the last one.
    pub(crate) fn trial(&self) -> &[f64] {
        &self.trial
    }

    pub(super) fn copy_fields_from(&mut self, other: &RememberedField<R>) {
        self.now.clone_from(&other.now);
        self.trial.clone_from(&other.trial);
    }

    #[cfg(feature = "checkpoint")]
    pub(super) fn has_cells(&self, cells: usize) -> bool {
        [self.now.len(), self.trial.len()] == [cells; 2]
    }
}

impl RememberedField {
    /// The undisturbed field of bodies with contact compliance `creep`.
    pub(crate) fn new(creep: &CreepSpectrum, cells: usize) -> RememberedField {
        RememberedField::undisturbed(Exponential::new(creep, cells), cells)
    }

    /// The same, undisturbed, on `cells` cells.
    pub(super) fn undisturbed_on(&self, cells: usize) -> RememberedField {
        RememberedField::undisturbed(self.recursion.undisturbed_on(cells), cells)
    }

    /// Bytes per cell that the recursion takes.
    pub(crate) fn bytes_per_cell(&self) -> usize {
        self.recursion.bytes_per_cell()
    }

    /// Writes what the past makes of the end of a step to the trial, and returns the compliance c of the step.
    pub(crate) fn predict(&mut self, dt: f64) -> f64 {
        self.recursion.predict(dt, &self.now, &mut self.trial)
    }

    /// Adds c times a source to the trial.
    pub(crate) fn add(&mut self, c: f64, source: &[f64]) {
        self.trial.iter_mut().zip(source).for_each(|(value, &source)| *value += c * source);
    }

    /// Accepts the step predicted last.
    pub(crate) fn commit(&mut self) {
        self.recursion.commit();
        std::mem::swap(&mut self.now, &mut self.trial);
    }

    /// Lets the recursion take in the last step, so that nothing depends on the field before it any more.
    pub(super) fn settle(&mut self) {
        self.recursion.settle(&self.trial, &self.now);
    }

    /// Copies another without reallocating.
    pub(super) fn copy_from(&mut self, other: &RememberedField) {
        self.recursion.copy_from(&other.recursion);
        self.copy_fields_from(other);
    }

    /// The same past on `cells` other cells, once settled; `carry` returns each of its fields there.
    pub(super) fn carried(&self, cells: usize, mut carry: impl FnMut(&[f64]) -> Vec<f64>) -> RememberedField {
        let recursion = self.recursion.carried(cells, self.now.len(), |_, branch| carry(branch));
        RememberedField { recursion, now: carry(&self.now), trial: vec![0.0; cells] }
    }

    /// Whether its recursion is like another, and its fields have so many cells.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, recursion: &Exponential, cells: usize) -> bool {
        self.recursion.fits(recursion, cells) && self.has_cells(cells)
    }
}
