//! A force that oscillates, what a cycle of it loses, and the loss of a contact that stays as it is.

use std::f64::consts::{PI, TAU};

use viscocontact::Result;
use viscocontact::prelude::*;
use viscocontact::rheology::CreepSpectrum;

/// Periods for which the mean force is held first, and cycles that follow; the last is evaluated.
const HELD: f64 = 1000.0;
const CYCLES: u32 = 4;

/// A force that is held and then oscillates. It begins with a jump to its crest: the transients that this starts fade
/// before the last cycle.
#[derive(Debug, Clone, Copy)]
pub struct Oscillation {
    /// Mean and amplitude \[N\].
    pub mean: f64,
    pub amplitude: f64,
    /// Cycles per second \[Hz\].
    pub frequency: f64,
}

impl LoadHistory for Oscillation {
    fn at(&self, t: f64) -> Load {
        Load::force(self.force(t))
    }

    fn before(&self, t: f64) -> Load {
        if t <= HELD / self.frequency { Load::force(self.mean) } else { self.at(t) }
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        [0.0, HELD / self.frequency].into_iter().find(|time| *time > after)
    }
}

impl Oscillation {
    fn force(&self, t: f64) -> f64 {
        let cycles = t * self.frequency - HELD;
        // a trough of zero must not be rounded to less
        if cycles < 0.0 { self.mean } else { (self.mean + self.amplitude * (TAU * cycles).cos()).max(0.0) }
    }

    /// The end of step `k` of `steps` in each cycle \[s\].
    fn time(&self, k: u32, steps: u32) -> f64 {
        (HELD + f64::from(k) / f64::from(steps)) / self.frequency
    }

    /// The last cycle of a contact at `steps` phases, the steps chosen for an error in time of `tolerance`.
    pub fn follow(&self, contact: &mut ViscoelasticContact, steps: u32, tolerance: f64) -> Result<Cycle> {
        let stops: Vec<f64> = ((CYCLES - 1) * steps..=CYCLES * steps).map(|k| self.time(k, steps)).collect();
        let mut cycle = Cycle::default();
        let mut run = contact.follow(self, Stepping::adaptive(tolerance), self.time(CYCLES, 1)).stop_at(&stops)?;
        while let Some(report) = run.next_step()? {
            if report.time == stops[cycle.forces.len()] {
                cycle.push(report.force, report.approach);
            }
        }
        Ok(cycle)
    }

    /// The last cycle on a one-dimensional foundation, in `steps` equal steps a cycle.
    pub fn follow_on(&self, mut foundation: StatesContact, steps: u32) -> Result<Cycle> {
        foundation.step(0.0, Load::force(self.mean))?;
        // with a quarter of these steps, the loss errs by 2e-3
        for k in -288..=0 {
            let time = HELD / self.frequency * 10_f64.powf(f64::from(k) / 48.0);
            foundation.step(time - foundation.time(), Load::force(self.mean))?;
        }
        let mut cycle = Cycle::default();
        for k in 0..=CYCLES * steps {
            let time = self.time(k, steps);
            let force = self.force(time);
            foundation.step(time - foundation.time(), Load::force(force))?;
            if k >= (CYCLES - 1) * steps {
                cycle.push(force, foundation.approach());
            }
        }
        Ok(cycle)
    }

    /// Contact radius of a ball of radius `ball` under the mean force alone, in the middle of the last cycle \[m\].
    pub fn radius_under_mean(&self, material: &Material, ball: f64) -> f64 {
        let time = (HELD + f64::from(CYCLES) - 0.5) / self.frequency;
        (0.75 * ball * self.mean * material.contact_compliance(time)).cbrt()
    }

    /// π Wa² C″ / 2a \[J\]: what a cycle loses if the contact radius stays at `radius`, on a body of contact compliance
    /// `creep`.
    pub fn loss_of_fixed_contact(&self, creep: &CreepSpectrum, radius: f64) -> f64 {
        -PI * self.amplitude.powi(2) * creep.complex_compliance(TAU * self.frequency).im / (2.0 * radius)
    }

    /// (Approach, force) about their means, if the contact radius stays at `radius`.
    pub fn ellipse(&self, creep: &CreepSpectrum, radius: f64) -> Vec<(f64, f64)> {
        let compliance = creep.complex_compliance(TAU * self.frequency);
        let at = |phase: f64| {
            let approach = compliance.re * phase.cos() - compliance.im * phase.sin();
            (self.amplitude * approach / (2.0 * radius), self.amplitude * phase.cos())
        };
        (0..=200).map(|k| at(TAU * f64::from(k) / 200.0)).collect()
    }
}

/// Force \[N\] and approach \[m\] at equal phases of a cycle, both ends included.
#[derive(Debug, Clone, Default)]
pub struct Cycle {
    pub forces: Vec<f64>,
    pub approaches: Vec<f64>,
}

impl Cycle {
    fn push(&mut self, force: f64, approach: f64) {
        self.forces.push(force);
        self.approaches.push(approach);
    }

    fn mean(values: &[f64]) -> f64 {
        values[1..].iter().sum::<f64>() / (values.len() - 1) as f64
    }

    /// ∮ (W − Wm) dω \[J\]: a mean approach that still creeps is no loss of the oscillation.
    ///
    /// The chords cut an ellipse short by sin Δ / Δ, Δ being the phase of a step; since a sinusoidal force works on the
    /// first harmonic of the approach only, this is so for any approach.
    pub fn loss(&self) -> f64 {
        let mean = Cycle::mean(&self.forces);
        let chords = self.forces.windows(2).zip(self.approaches.windows(2));
        let work: f64 = chords.map(|(force, at)| (0.5 * (force[0] + force[1]) - mean) * (at[1] - at[0])).sum();
        let phase = TAU / (self.forces.len() - 1) as f64;
        work * phase / phase.sin()
    }

    /// (Approach, force) about their means.
    pub fn about_means(&self) -> impl Iterator<Item = (f64, f64)> {
        let means = [&self.approaches, &self.forces].map(|values| Cycle::mean(values));
        self.approaches.iter().zip(&self.forces).map(move |(approach, force)| (approach - means[0], force - means[1]))
    }
}
