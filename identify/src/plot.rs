//! Pictures of fits. Feature `plot`.

use viscocontact::plot::{COLORS, Chart, Legend, Picture, Quantity, Scale, Style};

use crate::error::Result;
use crate::fit::Fit;
use crate::series::times;

/// A normal variable is within so many standard deviations in 95 of 100 cases.
const WITHIN_95: f64 = 1.959963984540054;
/// Points of a curve of the modulus.
const POINTS: usize = 100;

/// Pictures of the fit; those of one curve by its index.
///
/// ```
/// use viscocontact::states::ElasticStates;
/// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
///
/// let protocol = Protocol::trapezoid(1.0e-6, [0.1, 1.0, 0.1], 0.01)?;
/// let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?);
/// let maxwell = Identification::new(Model::Maxwell);
/// let force = maxwell.respond(&experiment, &[("E0", 2.0e3), ("tau", 0.5)])?;
/// // 1 % of scatter, in place of a measurement
/// let scatter = |k: usize| 1.0e-10 * (k as f64 * k as f64).sin();
/// let force = force.iter().enumerate().map(|(k, sample)| sample.force + scatter(k)).collect();
/// let fit = maxwell.fit(&[Curve::new(experiment, force)?])?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-fit-{}.png", std::process::id()));
/// fit.picture(0)?.save(&path)?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
impl Fit {
    /// The contact modulus over time with its band of 95 %, from the shortest sampling interval to the length of the curves.
    pub fn modulus_chart(&self) -> Chart {
        let times = times(self.problem.window, POINTS).into_iter();
        let band: Vec<(f64, [f64; 2])> = times.map(|time| (time, self.modulus_band(time))).collect();
        let falls_by_decades = band[0].1[0] > 10.0 * band[POINTS - 1].1[0];
        let (scale, modulus) = if falls_by_decades {
            (Scale::LogLog, Quantity::from("E* [Pa]"))
        } else {
            (Scale::LogX, Quantity::new("E*", "Pa"))
        };
        let mut chart = Chart::new("Contact modulus", "time [s]", modulus, Legend::UpperRight);
        chart.scale = scale;
        let line = |deviations: f64| -> Vec<(f64, f64)> {
            band.iter().map(|&(time, [modulus, relative])| (time, modulus * (deviations * relative).exp())).collect()
        };
        chart.add("95 %", COLORS[5], Style::Line, line(WITHIN_95));
        chart.add("", COLORS[5], Style::Line, line(-WITHIN_95));
        chart.add("identified", COLORS[1], Style::Line, line(0.0));
        chart
    }

    /// Side by side: measured and fitted force of a curve over time with the band within which 95 % of the noise should
    /// be, the same less the fitted force, where neighbours on one side show that the model is wrong, and the modulus.
    ///
    /// # Errors
    /// If there is no such curve; those of [`Chart::draw`] and [`Picture::beside`].
    pub fn picture(&self, curve: usize) -> Result<Picture> {
        let times = self.experiment(curve)?.protocol().times();
        let (fitted, rest) = (self.force(curve), &vec![0.0; times.len()]);
        let mut forces = self.noise_chart(curve, ["Force", "force", "measured"], self.curves()[curve].force(), fitted);
        forces.add(format!("fitted, {}", self.model()), COLORS[1], Style::Line, pairs(times, fitted));
        let titles = ["Residuals", "measured - fitted force", ""];
        let charts = [forces, self.noise_chart(curve, titles, self.residuals(curve), rest), self.modulus_chart()];
        let pictures = charts.iter().map(Chart::draw).collect::<viscocontact::Result<Vec<_>>>()?;
        Ok(Picture::beside(&pictures)?)
    }

    /// A chart of forces, and the limits of 95 % of the noise about others: of correlated noise, of the whole one. The
    /// title is followed by the names of the axis and of the forces.
    fn noise_chart(&self, curve: usize, [title, name, dots]: [&str; 3], forces: &[f64], middle: &[f64]) -> Chart {
        let mut chart = Chart::new(title, Quantity::new("time", "s"), Quantity::new(name, "N"), Legend::UpperRight);
        let times = self.curves()[curve].experiment().protocol().times();
        let phi = self.autoregression_of(curve).unwrap_or_default();
        let limit = WITHIN_95 * self.sigma_of(curve) / (1.0 - phi * phi).sqrt();
        for (label, side) in [("95 % of the noise", limit), ("", -limit)] {
            let moved: Vec<f64> = middle.iter().map(|force| force + side).collect();
            chart.add(label, COLORS[5], Style::Line, pairs(times, &moved));
        }
        chart.add(dots, COLORS[0], Style::Dots, pairs(times, forces));
        chart
    }
}

fn pairs(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    x.iter().copied().zip(y.iter().copied()).collect()
}
