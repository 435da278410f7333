//! Steady motions at many velocities, loads and temperatures.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use super::{SlidingReport, SteadySliding};
use crate::error::{Error, Result};
use crate::load::Load;
use crate::parallel::{cut, fork};
use crate::rheology::TimeTemperature;
use crate::rheology::vertical_factors;

/// Velocities, loads and temperatures of steady motions, for [`SteadySliding::sweep`].
#[derive(Debug, Clone)]
pub struct SlidingSweep {
    velocities: Vec<[f64; 2]>,
    loads: Vec<Load>,
    law: Option<(TimeTemperature, Vec<f64>)>,
}

impl SlidingSweep {
    /// All velocities \[m/s\] under each of the loads, in this order: neighbours cost least.
    pub fn new(velocities: impl IntoIterator<Item = [f64; 2]>, loads: impl IntoIterator<Item = Load>) -> SlidingSweep {
        SlidingSweep { velocities: velocities.into_iter().collect(), loads: loads.into_iter().collect(), law: None }
    }

    /// At each of these temperatures \[K\]: the material is that at the reference temperature of the law, and passes
    /// as many times faster as a_T; all its moduli are b_T times as great, if the law has [vertical
    /// factors](TimeTemperature::with_vertical_factors).
    pub fn at_temperatures(self, law: TimeTemperature, temperatures: impl IntoIterator<Item = f64>) -> SlidingSweep {
        SlidingSweep { law: Some((law, temperatures.into_iter().collect())), ..self }
    }
}

/// A state of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SweptState {
    /// Temperature \[K\], of sweeps over temperatures.
    pub temperature: Option<f64>,
    /// The load.
    pub load: Load,
    /// The state, with the velocity at the temperature.
    pub report: SlidingReport,
}

/// The states of a sweep, made by [`SteadySliding::sweep`].
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlidingTable(Vec<SweptState>);

impl SteadySliding {
    /// The states of a sweep, each found from the one before: [`SteadySliding::sweep_with`].
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::sliding::SlidingSweep;
    ///
    /// let grid = Grid::new([256, 1], [4.0e-3, 1.0])?;
    /// let rubber = GeneralizedMaxwell::new(1.0e6, &[(1.0e7, 1.0e-5), (1.0e7, 1.0e-3), (3.0e6, 0.1)])?;
    /// let mut roller = ViscoelasticContact::builder(grid.clone())
    ///     .geometry(&Cylinder::new(10.0e-3)?)
    ///     .material(Material::incompressible(rubber))
    ///     .kernel(InfluenceKernel::line(&grid, 1.0)?)
    ///     .build_sliding()?;
    /// let speeds = (-4..=2).map(|decade| [10_f64.powi(decade), 0.0]);
    /// let table = roller.sweep(&SlidingSweep::new(speeds, [Load::force(50.0), Load::force(100.0)]))?;
    /// assert_eq!(table.states().len(), 14);
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-sweep-{}.csv", std::process::id()));
    /// table.write_csv(&path)?; // with the feature `plot`, `save` draws the friction, too
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`SteadySliding::at`], [`TimeTemperature::shift_factor`] and [`TimeTemperature::vertical_factor`]; if the
    /// law has vertical factors and the contact a second body or a bulk, which does not follow it.
    pub fn sweep(&mut self, sweep: &SlidingSweep) -> Result<SlidingTable> {
        self.sweep_with(sweep, |_, _| ControlFlow::Continue(()))
    }

    /// [`SteadySliding::sweep`], calling `progress` after each state with it and the part of the sweep that is done; it may end the sweep early, with the states
    /// found by then.
    ///
    /// The velocities under one load at one temperature are found one from another, from the state before the sweep
    /// on. Several such chains run beside each other on as many threads as the pool has (feature `rayon`), each with
    /// a contact of its own: states do not depend on the number of threads.
    ///
    /// # Errors
    /// As [`SteadySliding::sweep`].
    pub fn sweep_with(
        &mut self,
        sweep: &SlidingSweep,
        progress: impl FnMut(&SweptState, f64) -> ControlFlow<()> + Send,
    ) -> Result<SlidingTable> {
        let shift = |law: &TimeTemperature, kelvin: f64| {
            Ok((Some(kelvin), law.shift_factor(kelvin)?, law.vertical_factor(kelvin)?))
        };
        let shifts: Vec<_> = match &sweep.law {
            Some((law, kelvins)) => kelvins.iter().map(|&kelvin| shift(law, kelvin)).collect::<Result<_>>()?,
            None => vec![(None, 1.0, 1.0)],
        };
        let in_proportion = self.scene.material.is_one_body_in_proportion();
        if !in_proportion && shifts.iter().any(|(_, _, vertical)| *vertical != 1.0) {
            return Err(vertical_factors("a sweep over temperatures"));
        }
        let chains: Vec<_> =
            shifts.iter().flat_map(|&shift| sweep.loads.iter().map(move |&load| (shift, load))).collect();
        let count = (chains.len() * sweep.velocities.len()) as f64;
        let told = Mutex::new((progress, 0, false));
        let chain = |k: usize| {
            let ((temperature, shift, vertical), load) = chains[k];
            let is_ended = || told.lock().unwrap_or_else(PoisonError::into_inner).2;
            let (mut own, mut states, mut is_told) = (self.clone(), Vec::new(), false);
            for &velocity in &sweep.velocities {
                if is_ended() {
                    break;
                }
                // with moduli b times as great, the same shape takes pressures b times as great
                let found = match own.at(velocity.map(|v| v * shift), load.with_force_over(vertical)) {
                    Err(_) if is_ended() => break,
                    found => found?,
                };
                let force = |force: f64| force * vertical;
                let report = SlidingReport {
                    velocity,
                    force: force(found.force),
                    lateral_force: found.lateral_force.map(force),
                    ..found
                };
                let state = SweptState { temperature, load, report };
                let (progress, done, ended) = &mut *told.lock().unwrap_or_else(PoisonError::into_inner);
                is_told = !*ended;
                if *ended {
                    break;
                }
                states.push(state);
                *done += 1;
                *ended = progress(&state, f64::from(*done) / count).is_break();
            }
            own.scale(load, vertical);
            // the state of the table that was found last
            Ok::<_, Error>((is_told.then_some(own), states))
        };
        let mut found: Vec<_> = chains.iter().map(|_| None).collect();
        fork(0..chains.len(), true, [&mut found[..]], &cut, &|k, [own]| {
            own.iter_mut().for_each(|own| *own = Some(chain(k)));
        });
        let mut table = SlidingTable::default();
        for found in found.into_iter().flatten() {
            let (last, states) = found?;
            *self = last.unwrap_or_else(|| self.clone());
            table.0.extend(states);
        }
        Ok(table)
    }
}

impl SlidingTable {
    /// The states, in the order of the sweep.
    pub fn states(&self) -> &[SweptState] {
        &self.0
    }
}

impl Load {
    /// The load with its force, if it is one, divided by a factor.
    fn with_force_over(self, factor: f64) -> Load {
        match self {
            Load::Force { normal, tilt } => Load::Force { normal: normal / factor, tilt },
            Load::Approach { .. } | Load::Spring { .. } => self,
        }
    }
}
