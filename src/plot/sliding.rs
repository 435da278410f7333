//! Charts of sweeps of steady motions.

use crate::load::Load;
use crate::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use crate::rounded::rounded;
use crate::sliding::{SlidingReport, SlidingTable, SweptState};

impl SlidingTable {
    /// A chart of a value of the states over the speed, a curve for each temperature and load.
    pub fn chart(&self, quantity: impl Into<Quantity>, value: impl Fn(&SlidingReport) -> f64) -> Chart {
        let mut chart = Chart::new("Steady motion", Quantity::new("speed", "m/s"), quantity, Legend::UpperLeft);
        chart.scale = Scale::LogX;
        let curves = self.states().chunk_by(|a, b| (a.temperature, a.load) == (b.temperature, b.load));
        for (k, curve) in curves.enumerate() {
            let point = |own: &SweptState| (own.report.velocity[0].hypot(own.report.velocity[1]), value(&own.report));
            let load = curve[0].load;
            let kelvin = curve[0].temperature.map(|kelvin| format!("{} K", rounded(kelvin, 5)));
            let several = kelvin.is_none() || self.states().iter().any(|state| state.load != load);
            let force = match load {
                Load::Force { .. } => format!("{} N", rounded(curve[0].report.force, 4)),
                _ => load.to_string(),
            };
            let label = kelvin.into_iter().chain(several.then_some(force)).collect::<Vec<_>>().join(", ");
            chart.add(label, COLORS[k % COLORS.len()], Style::LineAndDots, curve.iter().map(point).collect());
        }
        chart
    }
}
