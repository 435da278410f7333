//! Steady motions at many velocities, loads and temperatures.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use super::{SlidingReport, SteadySliding};
use crate::error::Result;
use crate::file::replace;
use crate::load::Load;
#[cfg(feature = "plot")]
use crate::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use crate::rheology::TimeTemperature;
#[cfg(feature = "plot")]
use crate::rounded::rounded;

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

    /// At each of these temperatures \[K\]: the material is that at the reference temperature of the law, and passes as many times faster as a_T.
    pub fn at_temperatures(self, law: TimeTemperature, temperatures: impl IntoIterator<Item = f64>) -> SlidingSweep {
        SlidingSweep { law: Some((law, temperatures.into_iter().collect())), ..self }
    }
}

/// A state of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
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
pub struct SlidingTable(Vec<SweptState>);

impl SteadySliding {
    /// The states of a sweep, each found from the one before.
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
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-sweep-{}", std::process::id()));
    /// table.save(&path)?; // a CSV file, and with the feature `plot` a picture of the friction
    /// # let _ = std::fs::remove_file(path.with_extension("png"));
    /// # std::fs::remove_file(path.with_extension("csv")).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`SteadySliding::at`] and [`TimeTemperature::shift_factor`].
    pub fn sweep(&mut self, sweep: &SlidingSweep) -> Result<SlidingTable> {
        self.sweep_with(sweep, |_, _| ControlFlow::Continue(()))
    }

    /// [`SteadySliding::sweep`], calling `progress` after each state with it and the part of the sweep that is done; it may end the sweep early, with the states
    /// found by then.
    ///
    /// # Errors
    /// As [`SteadySliding::sweep`].
    pub fn sweep_with(
        &mut self,
        sweep: &SlidingSweep,
        mut progress: impl FnMut(&SweptState, f64) -> ControlFlow<()>,
    ) -> Result<SlidingTable> {
        let shift = |law: &TimeTemperature, kelvin: f64| Ok((Some(kelvin), law.shift_factor(kelvin)?));
        let shifts: Vec<_> = match &sweep.law {
            Some((law, kelvins)) => kelvins.iter().map(|&kelvin| shift(law, kelvin)).collect::<Result<_>>()?,
            None => vec![(None, 1.0)],
        };
        let count = (shifts.len() * sweep.loads.len() * sweep.velocities.len()) as f64;
        let mut table = SlidingTable::default();
        for (temperature, shift) in shifts {
            for &load in &sweep.loads {
                for &velocity in &sweep.velocities {
                    let report = SlidingReport { velocity, ..self.at(velocity.map(|v| v * shift), load)? };
                    table.0.push(SweptState { temperature, load, report });
                    if progress(&table.0[table.0.len() - 1], table.0.len() as f64 / count).is_break() {
                        return Ok(table);
                    }
                }
            }
        }
        Ok(table)
    }
}

impl SlidingTable {
    /// The states, in the order of the sweep.
    pub fn states(&self) -> &[SweptState] {
        &self.0
    }

    /// Writes the table as a CSV file, and with the feature `plot` a picture of the friction over the speed: `path` with the endings `csv` and `png`.
    /// Existing files are replaced. Columns: temperature \[K\], velocity along x1 and x2, force, approach, friction, lateral force along x1 and x2, contact area, mean
    /// gap, dissipation \[SI\], cells in contact, sets, pairs of transforms, residual.
    ///
    /// # Errors
    /// If a file cannot be written, or there is nothing to draw.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let head = "temperature [K],velocity 1 [m/s],velocity 2 [m/s],force [N],approach [m],friction,lateral force 1 [N],lateral force 2 [N],\
            contact area [m2],mean gap [m],dissipation [W],contact cells,sets,transforms,residual";
        replace(&path.with_extension("csv"), |out| {
            writeln!(out, "{head}")?;
            for SweptState { temperature, report: own, .. } in &self.0 {
                let ([v1, v2], [f1, f2]) = (own.velocity, own.lateral_force);
                let kelvin = temperature.map(|kelvin| format!("{kelvin:?}")).unwrap_or_default();
                write!(
                    out,
                    "{kelvin},{v1:?},{v2:?},{:?},{:?},{:?},{f1:?},{f2:?},",
                    own.force,
                    own.approach,
                    own.friction()
                )?;
                write!(out, "{:?},{:?},{:?},", own.contact_area, own.mean_gap, own.dissipation())?;
                writeln!(out, "{},{},{},{:?}", own.contact_cells, own.sets, own.transforms, own.residual)?;
            }
            Ok(())
        })?;
        #[cfg(feature = "plot")]
        self.chart("coefficient of friction", SlidingReport::friction).save(path.with_extension("png"))?;
        Ok(())
    }

    /// A chart of a value of the states over the speed, a curve for each temperature and load.
    #[cfg(feature = "plot")]
    pub fn chart(&self, quantity: impl Into<Quantity>, value: impl Fn(&SlidingReport) -> f64) -> Chart {
        let mut chart = Chart::new("Steady motion", Quantity::new("speed", "m/s"), quantity, Legend::UpperLeft);
        chart.scale = Scale::LogX;
        let curves = self.0.chunk_by(|a, b| (a.temperature, a.load) == (b.temperature, b.load));
        for (k, curve) in curves.enumerate() {
            let point = |own: &SweptState| (own.report.velocity[0].hypot(own.report.velocity[1]), value(&own.report));
            let kelvin = curve[0].temperature.map(|kelvin| format!("{} K, ", rounded(kelvin, 5))).unwrap_or_default();
            let label = format!("{kelvin}{}", curve[0].load);
            chart.add(label, COLORS[k % COLORS.len()], Style::LineAndDots, curve.iter().map(point).collect());
        }
        chart
    }
}
