//! The force of a protocol: exact for one indentation, by elastic states for every other history.

mod cycle;
mod moments;
mod tip;

use std::sync::Arc;

use viscocontact::load::Load;
use viscocontact::states::{ElasticStates, StatesContact};

use crate::error::{Error, Result};
use crate::model::Prony;
use cycle::{Cycle, Stop};
use tip::Tip;

/// A drive beyond the contact point \[m\] at times \[s\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'a> {
    pub(crate) times: &'a [f64],
    pub(crate) drive: &'a [f64],
}

/// A sample of a response.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Sample {
    /// Force of the contact \[N\].
    pub force: f64,
    /// Depth of the tip, beyond its first touch \[m\]; negative above the surface.
    pub depth: f64,
    /// Depth at which the elastic contact is as large \[m\]: 0 without contact.
    pub contact_depth: f64,
}

/// The tip and the spring of one curve, ready for many evaluations.
#[derive(Clone, Debug)]
pub(crate) struct Forward {
    tip: Tip,
    states: Arc<ElasticStates>,
}

impl Forward {
    pub(crate) fn new(states: &Arc<ElasticStates>) -> Forward {
        Forward { tip: Tip::new(states), states: Arc::clone(states) }
    }

    /// The response to a drive through a spring of `give` 1/k \[m/N\]. `record` is given each sample and, for a single
    /// indentation, the terms of its force. `curve` is the index of the curve in errors.
    pub(crate) fn respond(
        &self,
        prony: &Prony,
        drive: Drive<'_>,
        give: f64,
        curve: usize,
        mut record: impl FnMut(Sample, Option<&[f64]>),
    ) -> Result<()> {
        let mut samples = Vec::with_capacity(drive.times.len());
        let mut terms = Vec::with_capacity(drive.times.len() * prony.moduli.len());
        let single = Cycle::new(prony, &self.tip, give).follow(drive, |sample, of_sample| {
            samples.push(sample);
            terms.extend_from_slice(of_sample);
        });
        match single {
            Ok(()) => {
                for (k, sample) in samples.into_iter().enumerate() {
                    let count = prony.moduli.len();
                    record(sample, Some(&terms[k * count..][..count]));
                }
                Ok(())
            }
            Err(Stop::Returns) => self.by_states(prony, drive, give, record),
            Err(Stop::Beyond(depth)) => Err(Error::BeyondStates { curve, depth }),
            Err(Stop::NoRoot) => {
                let reason =
                    "the spring and the contact do not balance: check the stiffness of the spring and the moduli";
                Err(Error::NotConverged { iterations: 0, reason })
            }
        }
    }

    /// Any history, by a contact on elastic states with a step between two samples.
    fn by_states(
        &self,
        prony: &Prony,
        drive: Drive<'_>,
        give: f64,
        mut record: impl FnMut(Sample, Option<&[f64]>),
    ) -> Result<()> {
        let mut contact = StatesContact::new(&self.states, &prony.material_on(&self.states)?)?;
        let rest = self.tip.rest();
        let mut before = drive.times.first().copied().unwrap_or_default();
        for (&time, &z) in drive.times.iter().zip(drive.drive) {
            let load = if give > 0.0 { Load::spring(1.0 / give, rest + z) } else { Load::approach(rest + z) };
            let report = contact.step(time - before, load)?;
            let contact_depth = self.states.approach(contact.level()) - rest;
            record(Sample { force: report.force, depth: report.approach - rest, contact_depth }, None);
            before = time;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(tip: &Arc<ElasticStates>, prony: &Prony, times: &[f64], drive: &[f64], give: f64) -> Vec<Sample> {
        let mut samples = Vec::new();
        let forward = Forward::new(tip);
        forward.respond(prony, Drive { times, drive }, give, 0, |sample, _| samples.push(sample)).unwrap();
        samples
    }

    fn zener() -> Prony {
        Prony { moduli: vec![0.25, 0.75], rates: vec![0.0, 1.0] }
    }

    /// Up in unit time, held to 2, and out at unit speed.
    fn trapezoid(t: f64) -> f64 {
        t.min(1.0).min(3.0 - t)
    }

    /// Times at which tables give forces, among equal samples.
    fn samples(count: usize, end: f64) -> Vec<f64> {
        (0..=count).map(|k| end * k as f64 / count as f64).collect()
    }

    #[test]
    fn one_indentation_has_the_forces_of_the_closed_equations() {
        // independent quadrature of Ting's equations, to 9 digits
        let table = [
            (0.5, 0.307_325_743),
            (1.0, 0.769_660_555),
            (2.0, 0.441_172_434),
            (2.1, 0.285_883_046),
            (2.2, 0.159_045_973),
            (2.4, 0.004_874_310_16),
        ];
        let tip = ElasticStates::sphere(9.0 / 16.0).unwrap();
        for (count, tolerance) in [(30, 2e-4), (300, 2e-6), (3000, 2e-8)] {
            let times = samples(count, 3.0);
            let drive: Vec<f64> = times.iter().map(|&t| trapezoid(t)).collect();
            let found = response(&tip, &zener(), &times, &drive, 0.0);
            for (t, force) in table {
                let k = (t * count as f64 / 3.0).round() as usize;
                let error = (found[k].force - force).abs();
                assert!(error < tolerance, "{count} samples, t = {t}: {} off by {error:e}", found[k].force);
            }
            let contact = found[2 * count / 3 + count / 30].contact_depth;
            assert!((contact - 0.797_539_416).abs() < tolerance, "t1 = {contact}");
        }
    }

    #[test]
    fn a_spring_gives_way() {
        let table =
            [(0.5, 0.166160), (1.0, 0.374890), (1.5, 0.325633), (2.0, 0.289532), (2.2, 0.171695), (2.4, 0.069760)];
        let tip = ElasticStates::sphere(9.0 / 16.0).unwrap();
        let times = samples(3000, 3.0);
        let drive: Vec<f64> = times.iter().map(|&t| trapezoid(t)).collect();
        let found = response(&tip, &zener(), &times, &drive, 1.0);
        for (t, force) in table {
            let k = (t * 1000.0_f64).round() as usize;
            assert!((found[k].force - force).abs() < 2e-6, "t = {t}: {}", found[k].force);
        }
    }

    #[test]
    fn single_indentations_agree_with_steps_on_states() {
        for (tip, name) in [
            (ElasticStates::sphere(1.0).unwrap(), "sphere"),
            (ElasticStates::cone(0.5).unwrap(), "cone"),
            (ElasticStates::punch(0.7).unwrap(), "punch"),
        ] {
            let prony = Prony { moduli: vec![0.2, 0.5, 0.3], rates: vec![0.0, 2.0, 0.1] };
            for give in [0.0, 0.5] {
                let times = samples(2000, 3.0);
                let drive: Vec<f64> = times.iter().map(|&t| trapezoid(t) - 0.1).collect();
                let found = response(&tip, &prony, &times, &drive, give);
                let forward = Forward::new(&tip);
                let mut k = 0;
                let greatest = found.iter().fold(0.0_f64, |most, sample| most.max(sample.force));
                let compared = Drive { times: &times, drive: &drive };
                let compare = |sample: Sample, _: Option<&[f64]>| {
                    let error = (sample.force - found[k].force).abs() / greatest;
                    assert!(error < 2e-4, "{name}, give {give}, t = {}: {} {}", times[k], found[k].force, sample.force);
                    k += 1;
                };
                forward.by_states(&prony, compared, give, compare).unwrap();
            }
        }
    }
}
