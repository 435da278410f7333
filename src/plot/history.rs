//! Charts of quantities over time.

use crate::error::{Result, exact_length};
use crate::plot::{COLORS, Chart, Legend, Quantity, Style};

impl Chart {
    /// Labelled columns of values of one quantity over time \[s\]. [`Chart::scale`] makes axes logarithmic; time 0 is
    /// left out on those.
    ///
    /// ```
    /// use viscocontact::plot::{Chart, Quantity, Scale};
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let (mut times, mut approaches) = (Vec::new(), Vec::new());
    /// for dt in [0.0, 0.1, 0.2] {
    ///     let report = contact.step(dt, Load::force(0.5))?;
    ///     times.push(report.time);
    ///     approaches.push(report.approach);
    /// }
    /// let mut chart = Chart::history("", &times, Quantity::new("approach", "m"), &[("", &approaches)])?;
    /// chart.scale = Scale::LogX;
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-history-{}.png", std::process::id()));
    /// chart.save(&path)?;
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a column does not have one value per time.
    pub fn history(
        title: impl Into<String>,
        times: &[f64],
        quantity: impl Into<Quantity>,
        columns: &[(&str, &[f64])],
    ) -> Result<Chart> {
        let mut chart = Chart::new(title, Quantity::new("time", "s"), quantity, Legend::LowerRight);
        for (k, (label, values)) in columns.iter().enumerate() {
            exact_length("column of a history", values.len(), times.len())?;
            let points = times.iter().copied().zip(values.iter().copied()).collect();
            chart.add(*label, COLORS[k % COLORS.len()], Style::LineAndDots, points);
        }
        Ok(chart)
    }
}
