//! A run of a study on one mesh.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::{Builder, ViscoelasticContact};
use crate::error::{Error, Result};
use crate::fields::KeptFields;
use crate::observe::grid_convergence::{difference, difference_of_fields};
use crate::run::Stepping;
use crate::study::domain::{Domain, Side};
use crate::study::observable::{Observed, Reading};
use crate::study::scene::StudyScene;
use crate::study::tuning::TUNING;
use crate::study::{Cost, StudyProgress};
use crate::{Grid, memory};

/// What all runs of a study have in common.
pub(super) struct Runs<'a, 'p> {
    pub(super) scene: &'p StudyScene<'a>,
    pub(super) observed: &'p [Observed<'a>],
    /// Times at which pressure fields are compared.
    pub(super) fields_at: &'p [f64],
    pub(super) sides: [Side; 2],
    pub(super) cancelled: Option<&'p Arc<AtomicBool>>,
    pub(super) progress: &'p mut dyn FnMut(StudyProgress) -> ControlFlow<()>,
    /// Number of runs, convolution equivalents times cells so far, and what the study expects its end to cost.
    pub(super) runs: usize,
    pub(super) work: f64,
    pub(super) expected: Option<Cost>,
}

/// A run on one mesh.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) grid: Grid,
    pub(super) builder: Builder,
    pub(super) contact: ViscoelasticContact,
    /// Ends of steps; where several steps end at one time, as at a jump, each is listed.
    pub(super) times: Vec<f64>,
    /// Values of each observable at these times; a single one for [`Reading::Greatest`], none for
    /// [`Reading::Pressure`].
    pub(super) values: Vec<Vec<f64>>,
    pub(super) fields: Vec<KeptFields>,
    /// The maximum error in time of these that the run tells.
    pub(super) field_error: f64,
    /// The sides, and where the contact was at any time.
    pub(super) footprint: Domain,
    /// Convolution equivalents.
    pub(super) convolutions: f64,
    pub(super) bytes: u64,
}

impl Runs<'_, '_> {
    /// Runs the scene in adaptive steps that end at `stops`, too.
    pub(super) fn level(&mut self, grid: Grid, tolerance: f64, stops: &[f64]) -> Result<Level> {
        let StudyScene { histories, until, accuracy, .. } = self.scene;
        let builder = self.scene.builder(grid.clone())?;
        let bytes = builder.memory()?;
        // adaptive steps keep the rate of the displacement
        let bytes = bytes.total() + 8 * bytes.computed_cells as u64;
        memory::check("the run of a study", u128::from(bytes))?;
        let mut contact = builder.clone().build()?;
        let mut run = contact.follow_each(histories, Stepping::adaptive(tolerance), *until)?.stop_at(stops)?;
        if let Some(flag) = self.cancelled {
            run = run.cancelled_by(Arc::clone(flag));
        }
        if !self.fields_at.is_empty() {
            let in_time = (TUNING.of_fields * accuracy).min(tolerance).clamp(TUNING.least_of_fields, 0.1);
            run = run.sample_at(self.fields_at)?.fields_to(in_time)?;
        }
        let (mut times, mut values, mut fields) = (Vec::new(), vec![Vec::new(); self.observed.len()], Vec::new());
        let (mut footprint, mut convolutions, mut field_error) = (Domain::empty(self.sides), 0.0, 0.0_f64);
        let (cells, size) = (grid.cells(), grid.len() as f64);
        while let Some(report) = run.next_step()? {
            let now = run.contact().fields();
            times.push(report.time);
            footprint.include(now);
            for (Observed { reading, .. }, values) in self.observed.iter().zip(&mut values) {
                match reading {
                    Reading::Value(of) => values.push(of(now)),
                    Reading::Greatest(of) => {
                        let most = values.pop().unwrap_or(f64::NEG_INFINITY);
                        values.push(of(now).max(most));
                    }
                    Reading::Pressure => {}
                }
            }
            if !self.fields_at.is_empty() {
                for sample in run.samples() {
                    let sample = sample?;
                    if sample.is_asked_for() {
                        // of states at one time, as around a jump, the last
                        field_error = field_error.max(sample.field().and_then(|field| field.error).unwrap_or(0.0));
                        let kept = sample.fields().keep();
                        fields.pop_if(|last: &mut KeptFields| last.fields().time() == kept.fields().time());
                        fields.push(kept);
                    }
                }
            }
            convolutions += report.convolution_equivalents();
            self.work += report.convolution_equivalents() * size;
            let (runs, expected, work) = (self.runs, self.expected, self.work);
            let told =
                StudyProgress { runs, cells, steps: times.len(), time: report.time, until: *until, work, expected };
            if (self.progress)(told).is_break() {
                return Err(Error::Cancelled { what: "a study" });
            }
        }
        drop(run);
        self.runs += 1;
        Ok(Level { grid, builder, contact, times, values, fields, field_error, footprint, convolutions, bytes })
    }
}

impl Level {
    pub(super) fn steps(&self) -> usize {
        self.times.len()
    }

    /// The difference of each observable from a run on a finer mesh or in shorter steps, at all ends of steps that
    /// both have.
    pub(super) fn differences(&self, finer: &Level, observed: &[Observed<'_>]) -> Vec<f64> {
        let common = common_ends(&self.times, &finer.times);
        let one = |(k, Observed { reading, .. }): (usize, &Observed<'_>)| match reading {
            Reading::Value(_) => {
                let [own, other] = [0, 1].map(|which| {
                    let values = if which == 0 { &self.values[k] } else { &finer.values[k] };
                    common.iter().map(|pair| values[pair[which]]).collect::<Vec<_>>()
                });
                difference(&own, &other)
            }
            Reading::Greatest(_) => difference(&self.values[k], &finer.values[k]),
            Reading::Pressure => {
                let pairs = self.fields.iter().zip(&finer.fields).map(|(own, other)| {
                    let [own, other] = [own, other].map(|kept| kept.fields().pressure());
                    difference_of_fields((own, self.grid.cells()), (other, finer.grid.cells()))
                });
                pairs.fold(0.0, f64::max)
            }
        };
        observed.iter().enumerate().map(one).collect()
    }
}

/// The places of the ends that both lists have: each of several at one time by its order there.
fn common_ends(own: &[f64], other: &[f64]) -> Vec<[usize; 2]> {
    let (mut found, mut from) = (Vec::new(), 0);
    for (k, time) in own.iter().enumerate() {
        let at = from + other[from..].partition_point(|other| other < time);
        if other.get(at) == Some(time) {
            found.push([k, at]);
            from = at + 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::common_ends;

    #[test]
    fn ends_at_one_time_are_matched_in_their_order() {
        let found = common_ends(&[0.0, 1.0, 1.0, 2.0, 3.0], &[0.0, 0.5, 1.0, 1.0, 2.5, 3.0]);
        assert_eq!(found, [[0, 0], [1, 2], [2, 3], [4, 5]]);
        assert!(common_ends(&[], &[1.0]).is_empty());
    }
}
