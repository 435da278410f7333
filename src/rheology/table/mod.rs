//! Measured data as rheologies.

mod columns;
mod data;
mod isotherm;
mod master_curve;
mod measured;
mod outliers;
mod shift;
mod uncertainty;

pub use columns::Units;
pub use isotherm::Isotherm;
pub use master_curve::MasterCurve;

use self::data::Place;
use crate::error::{Refusal, Result, positive};
use crate::input::TakenColumn;
use crate::rheology::fit::{FitReport, FitWarning, MOST_MISFIT, Sample, Search};
use crate::rheology::{CreepSeries, Tension};
use crate::rounded::rounded;
use crate::values::Counted;
pub use data::Experiment;
use data::{Deformation, LEAST_ROWS, MeasuredRow, averaged_repeats, check_monotone, sorted_samples};
use measured::FITTING;
use uncertainty::INTERVAL;

/// A table of measured creep, relaxation or dynamic moduli. [`Measurements::fit`] makes a body of it.
///
/// ```
/// use viscocontact::rheology::{Measurements, Rheology};
///
/// let table = [(0.1, 1.05e-6), (0.3, 1.14e-6), (1.0, 1.39e-6), (3.0, 1.78e-6), (10.0, 1.99e-6), (100.0, 2.00e-6)];
/// let body = Measurements::creep(&table)?.fit()?;
/// println!("{}", body.report());
/// assert!(body.report().max_misfit() < 5e-3);
/// assert!((body.creep_compliance(5.0) / 1.92e-6 - 1.0).abs() < 1e-2);
/// assert!(body.creep_compliance(200.0).is_nan()); // never measured
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Measurements {
    experiment: Experiment,
    deformation: Deformation,
    /// Ascending.
    rows: Vec<MeasuredRow>,
    /// Number of rows that were averaged with the row before them.
    averaged: usize,
    samples: Vec<Sample>,
    /// Relative standard deviation of the values, if it is stated.
    scatter: Option<f64>,
    /// What was taken for what in a file.
    columns: Vec<TakenColumn>,
}

debug_by! {
    self: Measurements =>
    experiment: self.experiment, deformation: self.deformation, rows: Counted(&self.rows),
    samples: Counted(&self.samples), scatter: self.scatter
}

impl Measurements {
    /// Creep: a `table` of times ≥ 0 \[s\] and compliances \[1/Pa\], in any order. Columns `times` and `compliances`
    /// become its rows by `std::iter::zip(times, compliances).collect::<Vec<_>>()`.
    ///
    /// # Errors
    /// If there are fewer than four rows, a value is not finite and positive, or a time is negative or given twice.
    /// Rows at the time of the row before them, as where times are printed with
    /// few digits, are averaged with it if they agree within 10 % ([`FitReport::averaged`]).
    pub fn creep(table: &[(f64, f64)]) -> Result<Measurements> {
        Measurements::from_pairs(Experiment::Creep, table)
    }

    /// Relaxation: a `table` of times ≥ 0 \[s\] and moduli \[Pa\], in any order.
    ///
    /// A table without a modulus at t = 0 does not show the relaxation before its first time, which slows the creep
    /// for many times as long: after a drop to a tenth, creep is uncertain by a factor of two at the first time, and
    /// by 5 % at five times as long or more. [`FitReport::uncertainties`] includes it, [`FitReport::warning`] reports
    /// it, and
    /// [`Rheology::measured`](crate::rheology::Rheology::measured) begins where it is below 5 %, so that shorter steps of a
    /// contact warn by [`Warnings::FASTER_THAN_MATERIAL`](crate::contact::Warnings::FASTER_THAN_MATERIAL).
    ///
    /// ```
    /// use viscocontact::rheology::{Measurements, Rheology};
    ///
    /// let table = [0.01, 0.1, 0.3, 1.0, 3.0, 10.0].map(|t: f64| (t, 1.0e6 + 2.0e6 * (-t).exp()));
    /// let body = Measurements::relaxation(&table)?.fit()?;
    /// assert!((body.creep_compliance(0.0) * 3.0e6 - 1.0).abs() < 1e-4);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::creep`].
    pub fn relaxation(table: &[(f64, f64)]) -> Result<Measurements> {
        Measurements::from_pairs(Experiment::Relaxation, table)
    }

    /// Dynamic moduli: a `table` of angular frequencies > 0 \[rad/s\], storage moduli and loss moduli \[Pa\], in any
    /// order.
    ///
    /// ```
    /// use viscocontact::rheology::{GeneralizedMaxwell, Measurements, Rheology};
    ///
    /// let truth = GeneralizedMaxwell::new(1.0e6, &[(4.0e6, 1.0)])?;
    /// let spectrum = truth.creep_spectrum().unwrap().relaxation();
    /// let omega = (-8..=8).map(|k| 10f64.powf(0.25 * f64::from(k)));
    /// let moduli = omega.map(|omega| (omega, spectrum.complex_modulus(omega)));
    /// let table: Vec<(f64, f64, f64)> = moduli.map(|(omega, modulus)| (omega, modulus.re, modulus.im)).collect();
    /// let body = Measurements::dynamic(&table)?.fit()?;
    /// assert!((body.creep_compliance(2.0) / truth.creep_compliance(2.0) - 1.0).abs() < 1e-4);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::creep`]; frequencies and both moduli must be positive.
    pub fn dynamic(table: &[(f64, f64, f64)]) -> Result<Measurements> {
        let rows = table.iter().map(|&(omega, storage, loss)| (omega, vec![storage, loss]));
        Measurements::of_values(Experiment::Dynamic, rows)
    }

    /// Storage moduli alone: a `table` of angular frequencies > 0 \[rad/s\] and storage moduli \[Pa\], in any order.
    ///
    /// # Errors
    /// As [`Measurements::dynamic`].
    pub fn storage(table: &[(f64, f64)]) -> Result<Measurements> {
        Measurements::from_pairs(Experiment::Storage, table)
    }

    /// The columns of the file that were read, with their headings and units; none of a table that was given as rows.
    pub fn columns(&self) -> &[TakenColumn] {
        &self.columns
    }

    /// The same with a known relative standard deviation of the values (0.05 for 5 %), in place of one that is judged
    /// from the values themselves. Values may then deviate by six times as much from a monotone curve, and the best
    /// series by as much in the root mean square, if this is more than 10 %.
    ///
    /// ```
    /// use viscocontact::rheology::{FitWarning, Measurements};
    ///
    /// let creep = [(0.1, 1.0e-9), (1.0, 1.4e-9), (10.0, 1.1e-9), (100.0, 1.6e-9), (1000.0, 2.1e-9)];
    /// let measured = Measurements::creep(&creep)?;
    /// assert!(measured.fit().is_err()); // 1.1 after 1.4 is more scatter than is judged from few rows
    /// let report = measured.with_scatter(0.08)?.fit()?.report().clone();
    /// println!("{report}");
    /// match report.warning() {
    ///     Some(FitWarning::FewSamples { uncertainty }) => println!("±{:.0} % between rows", 100.0 * uncertainty),
    ///     Some(other) => println!("{other}"),
    ///     None => println!("creep within {:.0} %", 100.0 * report.uncertainty()),
    /// }
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If it is not finite and positive.
    pub fn with_scatter(self, scatter: f64) -> Result<Measurements> {
        Ok(Measurements { scatter: Some(positive("scatter", scatter)?), ..self })
    }

    fn from_pairs(experiment: Experiment, table: &[(f64, f64)]) -> Result<Measurements> {
        Measurements::of_values(experiment, table.iter().map(|&(x, value)| (x, vec![value])))
    }

    fn of_values(experiment: Experiment, table: impl Iterator<Item = (f64, Vec<f64>)>) -> Result<Measurements> {
        let row = |(k, (x, values))| MeasuredRow::new(Place::Entry(k), x, values);
        Measurements::from_rows(experiment, table.enumerate().map(row).collect())
    }

    fn from_rows(experiment: Experiment, rows: Vec<MeasuredRow>) -> Result<Measurements> {
        let given = rows.len();
        let mut rows = averaged_repeats(rows);
        let averaged = given - rows.len();
        let samples = sorted_samples(experiment.layout(), &mut rows)?;
        let (deformation, scatter, columns) = (Deformation::Unnamed, None, Vec::new());
        Ok(Measurements { experiment, deformation, rows, averaged, samples, scatter, columns })
    }

    /// The body that the table describes: a series with positive coefficients, by least squares of the relative misfit.
    ///
    /// The series is a smooth curve through noise, with no more terms than needed. [`CreepSeries::report`] has its
    /// error, and the values needed to plot data and fit. Relaxation and dynamic moduli, both in their relative
    /// misfit, are then converted to creep exactly.
    ///
    /// Over four to eight decades of smooth creep without noise, the error of J at and between the rows is below 0.1
    /// % with two rows per decade or more. With fewer it is below 0.3 % in most cases, and several percent at worst.
    /// Where the rows do not determine J between them, [`FitReport::warning`] reports it, as do the steps of a
    /// contact ([`Warnings::UNCERTAIN_MATERIAL`](crate::contact::Warnings::UNCERTAIN_MATERIAL)).
    ///
    /// Outside the data: creep before the first time, or faster than the highest frequency, counts as elastic (the
    /// compliance is between J_g of the fit and its value there). After the last time, or after 1/ω of the lowest
    /// frequency, J is NaN, and a step of a contact fails with
    /// [`StepError::BeyondMaterial`](crate::contact::StepError::BeyondMaterial), unless you choose
    /// [`CreepSeries::extrapolated`].
    ///
    /// # Errors
    /// If a compliance decreases, a relaxation modulus increases, or a storage modulus decreases with the frequency,
    /// by more than the scatter of the rows around explains, in more than one row of a hundred or by more than a tenth;
    /// if no series fits the table; or if the headings of its file name moduli in tension.
    pub fn fit(&self) -> Result<CreepSeries> {
        self.fitted(Deformation::Shear)
    }

    /// [`Measurements::fit`] of a table in tension, E(t), D(t), or E′ and E″ (a DMA): the creep D(t) of a rod, which only
    /// [`Material::from_tension`](crate::rheology::Material::from_tension) and its like take.
    ///
    /// ```
    /// use viscocontact::rheology::{Material, Measurements, Rheology};
    ///
    /// let table = [(0.1, 5.0e-10), (1.0, 5.3e-10), (10.0, 5.8e-10), (100.0, 6.5e-10), (1000.0, 7.4e-10)];
    /// let rod = Measurements::creep(&table)?.fit_tension()?;
    /// let (nu, strain) = (0.38, rod.0.creep_compliance(10.0));
    /// let body = Material::from_tension(rod, nu)?;
    /// assert!((body.contact_compliance(10.0) / ((1.0 - nu * nu) * strain) - 1.0).abs() < 1e-15);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::fit`], if the headings name moduli in shear.
    pub fn fit_tension(&self) -> Result<Tension<CreepSeries>> {
        self.fitted(Deformation::Tension).map(Tension)
    }

    fn fitted(&self, deformation: Deformation) -> Result<CreepSeries> {
        self.deformation.accepts(deformation)?;
        let (layout, samples) = (self.experiment.layout(), &self.samples);
        let (wrong_way, knock) = check_monotone(layout, &self.rows, self.scatter)?;
        let time = |x: f64| if layout.is_over_time { x } else { 1.0 / x };
        let positive = || samples.iter().map(|sample| time(sample.x)).filter(|t| *t > 0.0);
        let (first, last) = (positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max));
        let averaged = averaged(samples, (last / first).log10());
        let mut search = Search {
            constant: None,
            slope: self.experiment == Experiment::Creep,
            times: [first / FITTING.beyond, last * FITTING.beyond],
            hidden: FITTING.hidden,
        };
        // terms shorter than the first time have not fully decayed there
        let times = [first / INTERVAL.hidden_before, search.times[1]];
        let wider = Search { times, hidden: INTERVAL.hidden, ..search.clone() };
        let is_late = self.experiment == Experiment::Relaxation && samples[0].x > 0.0;
        let (averaged, outliers) = (if is_late { &wider } else { &search }).without_outliers(&averaged, self.scatter);
        let of_others = outliers.first().map(|&(Sample { x, .. }, deviation)| FitWarning::Outlier { x, deviation });
        let first = if is_late { averaged[0].x } else { first };
        if is_late && averaged.len() > LEAST_ROWS && search.misses(&wider, &averaged[1..]) {
            search = wider;
        }
        let measured = search.measured(&averaged);
        let uncertainty = measured.uncertainty(&search, &averaged, [first, last])?;
        let known_from = uncertainty.known_from;
        // a smooth series through few rows of much noise is further from them than the nearest
        let [report, nearest] =
            [&measured.series, &measured.least_squares].map(|series| FitReport::new(series, samples));
        let nearest = if nearest.rms_misfit() < report.rms_misfit() { nearest } else { report.clone() };
        let report = report.of_measurements(wrong_way, measured.ambiguity, uncertainty, &nearest, knock.or(of_others));
        let report = FitReport { averaged: self.averaged, ..report };
        let most = self.scatter.map_or(MOST_MISFIT, |scatter| scatter.max(MOST_MISFIT));
        let rms = nearest.rms_misfit();
        if let Some(worst) = nearest.worst().filter(|_| rms > most) {
            let table = layout.table;
            let what = format!(
                "the {table} is not that of a linear body: the best series deviates by {:.0} % in the root mean \
                 square, and by {:.0} % at x = {}",
                100.0 * rms,
                100.0 * worst.misfit().abs(),
                rounded(worst.x, 3)
            );
            let remedy = "; Measurements::with_scatter states more scatter";
            return Err(Refusal::value("table_inconsistent", what, remedy).naming("misfit").valued(rms).into());
        }
        let spectrum = measured.series.creep(samples[0].function)?;
        Ok(CreepSeries { spectrum, report, known_until: last, measured: [known_from, last] })
    }
}

/// Replaces neighbouring samples by their geometric means where there are more than a fit needs.
fn averaged(samples: &[Sample], decades: f64) -> Vec<Sample> {
    let per_decade = FITTING.means * (30.0 / decades).min(1.0);
    let bin = |sample: &Sample| (sample.x.log10() * per_decade).floor();
    let mut averaged: Vec<Sample> = Vec::new();
    for &sample in samples {
        match averaged.last_mut() {
            Some(mean) if mean.function == sample.function && bin(mean) == bin(&sample) && mean.x > 0.0 => {
                let share = sample.weight / (mean.weight + sample.weight);
                mean.x *= (sample.x / mean.x).powf(share);
                mean.value *= (sample.value / mean.value).powf(share);
                mean.weight += sample.weight;
            }
            _ => averaged.push(sample),
        }
    }
    averaged
}
