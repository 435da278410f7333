//! Tables of results.

use std::fmt;
use std::io::Write;

use crate::error::{Error, Result};
use crate::fit::{Estimate, Fit, FitWarning};
use crate::model::{Model, Scale};

/// The numbers of a fit without its curves: what a table of results contains.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Summary {
    /// The model.
    pub model: Model,
    /// Its parameters.
    pub estimates: Vec<Estimate>,
    /// Akaike's criterion, corrected: less is better.
    pub aicc: f64,
    /// Standard deviation of the noise \[N\].
    pub sigma: f64,
    /// Autoregressive coefficient of the noise of the first curve, if it has one.
    pub autoregression: Option<f64>,
    /// Samples with the tip in contact.
    pub points_in_contact: usize,
    /// Iterations of the search.
    pub iterations: usize,
    /// Probability of correlations of the residuals as great, if the model is right.
    pub probability: f64,
    /// What a user should know before the parameters are used.
    pub warnings: Vec<FitWarning>,
}

/// Columns of a table of results.
const COLUMNS: &str = "model,aicc,parameter,value,unit,deviation,scale of deviation,lower 95 %,upper 95 %,warnings";

/// The name of the model, without its settings.
impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let debug = format!("{self:?}");
        f.pad(if let Model::Custom(law) = self { law.name } else { debug.split(" {").next().unwrap_or(&debug) })
    }
}

/// A number in four digits, without an exponent where there are few zeros.
fn digits(value: f64) -> String {
    let decade = value.abs().log10().floor();
    if value == 0.0 || !value.is_finite() {
        value.to_string()
    } else if (-3.0..6.0).contains(&decade) {
        format!("{value:.*}", (3.0 - decade).max(0.0) as usize)
    } else {
        format!("{value:.3e}")
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.interval.map(digits);
        write!(f, "{} = {} {} (95 %: {low} to {high})", self.name, digits(self.value), unit(&self.name))?;
        self.limit.map_or(Ok(()), |limit| write!(f, ", at its limit: {limit}"))
    }
}

/// The model, its parameters and the warnings, each on a line.
impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: noise {} N", self.model(), digits(self.sigma()))?;
        self.estimates().iter().try_for_each(|estimate| write!(f, "\n  {estimate}"))?;
        self.warnings().iter().try_for_each(|warning| write!(f, "\n  warning: {warning}"))
    }
}

impl Fit {
    /// The numbers of this fit without its curves.
    pub fn summary(&self) -> Summary {
        Summary {
            model: self.model(),
            estimates: self.estimates().to_vec(),
            aicc: self.aicc(),
            sigma: self.sigma(),
            autoregression: self.autoregression_of(0),
            points_in_contact: self.points_in_contact(),
            iterations: self.iterations(),
            probability: self.probability(),
            warnings: self.warnings(),
        }
    }
}

impl Summary {
    /// Writes a table of some fits as CSV with headings: a row for each parameter, in SI units.
    ///
    /// ```
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol, Summary};
    ///
    /// let protocol = Protocol::trapezoid(1.0e-6, [0.1, 1.0, 0.1], 0.01)?;
    /// let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?);
    /// let maxwell = Identification::new(Model::Maxwell);
    /// let force = maxwell.respond(&experiment, &[("E0", 2.0e3), ("tau", 0.5)])?;
    /// let curve = Curve::new(experiment, force.iter().map(|sample| sample.force).collect())?;
    /// let mut table = Vec::new();
    /// Summary::write_csv(&[maxwell.fit(&[curve])?.summary()], &mut table)?;
    /// assert!(String::from_utf8_lossy(&table).starts_with("model,aicc,parameter,value,unit"));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Unwritable`].
    pub fn write_csv(summaries: &[Summary], mut to: impl Write) -> Result<()> {
        let quoted = |field: &str| match field.contains([',', '"']) {
            true => format!("\"{}\"", field.replace('"', "\"\"")),
            false => field.to_owned(),
        };
        let mut lines = vec![COLUMNS.to_owned()];
        for Summary { model, aicc, estimates, warnings, .. } in summaries {
            let model = quoted(&model.to_string());
            let warnings = quoted(&warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
            for Estimate { name, value, scale, deviation, interval: [low, high], .. } in estimates {
                let (name, unit) = (quoted(name), unit(name));
                let numbers = format!("{value},{unit},{deviation},{scale:?},{low},{high}");
                lines.push(format!("{model},{aicc},{name},{numbers},{warnings}"));
            }
        }
        let written = to.write_all((lines.join("\n") + "\n").as_bytes()).and_then(|()| to.flush());
        written.map_err(|error| Error::Unwritable { reason: error.to_string() })
    }

    /// Writes some fits as a JSON array of objects with the names of the fields of [`Summary`].
    ///
    /// # Errors
    /// [`Error::Unwritable`].
    #[cfg(feature = "serde")]
    pub fn write_json(summaries: &[Summary], to: impl Write) -> Result<()> {
        serde_json::to_writer_pretty(to, summaries).map_err(|error| Error::Unwritable { reason: error.to_string() })
    }
}

/// The unit of a parameter.
fn unit(name: &str) -> &'static str {
    match name.split(' ').next().unwrap_or_default() {
        "stiffness" | "tilt" => "N/m",
        "contact" => "m",
        "offset" => "N",
        "drift" => "N/s",
        "drag" => "N s/m",
        other => match Model::scale(other) {
            Scale::Logit => "1",
            _ if other.starts_with("tau") => "s",
            _ => "Pa",
        },
    }
}
