//! What a user writes: a body, an indenter and a load history of their own.

use viscocontact::load::{Load, LoadHistory};
use viscocontact::prelude::*;
use viscocontact::rheology::CreepSpectrum;

/// A gel: G = G∞ + G1 e^(−t/τ), written down by its creep.
#[derive(Debug, Clone, Copy)]
pub struct Gel {
    /// G∞ \[Pa\].
    pub relaxed: f64,
    /// G1 \[Pa\].
    pub delayed: f64,
    /// Relaxation time τ \[s\].
    pub time: f64,
}

impl Gel {
    /// Retardation time τ (G∞ + G1)/G∞ \[s\].
    fn retardation(&self) -> f64 {
        self.time * (self.relaxed + self.delayed) / self.relaxed
    }
}

impl Rheology for Gel {
    fn creep_compliance(&self, t: f64) -> f64 {
        let (glassy, relaxed) = (1.0 / (self.relaxed + self.delayed), 1.0 / self.relaxed);
        glassy - (relaxed - glassy) * (-t / self.retardation()).exp_m1()
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        let glassy = 1.0 / (self.relaxed + self.delayed);
        CreepSpectrum::new(glassy, 0.0, &[(1.0 / self.relaxed - glassy, self.retardation())]).ok()
    }
}

/// The same gel, of which only the creep is known: the library fits its series.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredGel(pub Gel);

impl Rheology for MeasuredGel {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.0.creep_compliance(t)
    }
}

/// A bowl r²/2R.
#[derive(Debug, Clone, Copy)]
pub struct Bowl {
    /// R \[m\].
    pub radius: f64,
}

impl Geometry for Bowl {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        (x1 * x1 + x2 * x2) / (2.0 * self.radius)
    }

    fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
        // the sum of two parabolas, row by row
        let [n1, n2] = grid.cells();
        for i in 0..n1 {
            for j in 0..n2 {
                let [x1, x2] = grid.center(i, j);
                gap[i * n2 + j] = 0.5 * x1 * x1 / self.radius + 0.5 * x2 * x2 / self.radius;
            }
        }
    }
}

/// Half sines, one after the other, with a pause after each: presses, lets go, waits.
#[derive(Debug, Clone, Copy)]
pub struct Heartbeat {
    /// The greatest force \[N\].
    pub force: f64,
    /// How long it presses, and how long it waits \[s\].
    pub half_period: f64,
}

impl LoadHistory for Heartbeat {
    fn at(&self, t: f64) -> Load {
        let beat = (t / self.half_period).max(0.0);
        let pressed = beat.floor() % 2.0 == 0.0;
        let sine = (std::f64::consts::PI * beat.fract()).sin().max(0.0);
        Load::force(if pressed { self.force * sine } else { 0.0 })
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        if after < 0.0 {
            return Some(0.0);
        }
        let mut beat = (after / self.half_period).floor() + 1.0;
        while beat * self.half_period <= after {
            beat += 1.0;
        }
        Some(beat * self.half_period)
    }
}
