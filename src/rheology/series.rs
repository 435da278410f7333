use std::ops::RangeInclusive;

use crate::error::{Error, Refusal, Result, within};
use crate::rheology::fit::{FitReport, MaterialFunction, Sample, Search};
use crate::rheology::{CreepSpectrum, Rheology, is_known, may_follow};
use crate::rounded::rounded;

/// The exponential series that approximates a creep compliance over a range of times, and its error.
///
/// Made by [`Rheology::series`] of a formula, and by [`Measurements::fit`](crate::rheology::Measurements::fit) of a
/// table. It is a [`Rheology`] itself: exact at t = 0 if the body has an elastic response, within the tolerance over
/// the range, and known up to its end. A body without elastic response gets one: its creep up to the shortest time
/// counts as immediate.
///
/// ```
/// use viscocontact::rheology::{FnRheology, Rheology};
///
/// let gel = FnRheology::new(|t| 1.0e-4 * (1.0 + 0.2 * t.sqrt()));
/// let series = gel.series(1.0e-3..=1.0e4, 1.0e-4)?;
/// assert!(series.report().max_misfit() <= 1.0e-4);
/// assert!((series.creep_compliance(50.0) / gel.creep_compliance(50.0) - 1.0).abs() < 1.0e-4);
/// assert_eq!(series.known_until(), 1.0e4);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CreepSeries {
    pub(super) spectrum: CreepSpectrum,
    pub(super) report: FitReport,
    pub(super) known_until: f64,
    pub(super) measured: [f64; 2],
}

/// How a function is sampled, chosen on formulas over three to ten decades within tolerances of 1e-2 to 1e-6.
struct Sampling {
    /// Samples per decade to which a series is fitted, and at which it is checked.
    fitted: f64,
    checked: f64,
    /// Part of the tolerance that the fit may use, so that the finer check passes.
    share: f64,
    /// Factor by which the times of the terms extend beyond the range.
    beyond: f64,
}

const SAMPLING: Sampling = Sampling { fitted: 16.0, checked: 67.0, share: 0.9, beyond: 10.0 };

impl CreepSeries {
    /// The exact series of `rheology`, or one fitted over `times`: the fewest terms whose relative error is at
    /// most `tolerance`.
    pub(crate) fn new<R: Rheology + ?Sized>(
        rheology: &R,
        times: RangeInclusive<f64>,
        tolerance: f64,
    ) -> Result<CreepSeries> {
        let (first, last) = (*times.start(), *times.end());
        let ordered = first <= last && last <= 1e90;
        within("shortest time of a series", first, (1e-90..=1e90).contains(&first), "in [1e-90, 1e90]")?;
        within("longest time of a series", last, ordered, "no less than the shortest, and at most 1e90")?;
        within("tolerance of a series", tolerance, (1e-8..=0.1).contains(&tolerance), "in [1e-8, 0.1]")?;
        if let Some(spectrum) = rheology.creep_spectrum() {
            let exact = || FitReport::exact(spectrum.terms().len());
            let report = rheology.fit_report().cloned().unwrap_or_else(exact);
            let (known_until, measured) = (rheology.known_until(), rheology.measured());
            return Ok(CreepSeries { spectrum, report, known_until, measured });
        }
        // The time of a fit grows with the fourth power of the decades: the number of terms grows with them, and each
        // merger of two terms polishes all the others by least squares, which takes the square of their number for each
        // sample. Fifty decades take three seconds with a tolerance of 1e-4, and seventeen with 1e-6.
        let decades = (last / first).log10();
        within("decades of a series", decades, decades <= 50.0, "at most 50 (name fewer with Builder::times)")?;

        let glassy = checked(rheology, 0.0, 0.0)?;
        let samples = sampled(rheology, [first, last], SAMPLING.fitted, glassy)?;
        let search = Search {
            constant: (glassy > 0.0).then_some(glassy),
            slope: true,
            times: [first / SAMPLING.beyond, last * SAMPLING.beyond],
            hidden: f64::INFINITY,
        };
        let series = search.within(&samples, SAMPLING.share * tolerance);
        let report = FitReport::new(&series, &sampled(rheology, [first, last], SAMPLING.checked, glassy)?);
        if let Some(worst) = report.worst().filter(|worst| worst.misfit().abs() > tolerance) {
            let what = format!(
                "no exponential series was found within {tolerance:e}: the error of the best is {:.1e}, at {} s",
                worst.misfit().abs(),
                rounded(worst.x, 3)
            );
            let remedy = "; raise the tolerance (Settings::series_tolerance) to at least that, 0.1 at most, or fit \
                over shorter times";
            return Err(Refusal::search("material_poor_fit", what, remedy)
                .naming("error of the series")
                .valued(worst.misfit().abs())
                .into());
        }
        let spectrum = CreepSpectrum::new(series.constant, series.slope, &series.terms)?;
        let known_until = last.min(rheology.known_until());
        crate::traced::fitted([first, last], series.terms.len(), report.max_misfit());
        let [from, to] = rheology.measured();
        let measured = [first.max(from), known_until.min(to)];
        Ok(CreepSeries { spectrum, report, known_until, measured })
    }

    /// The series.
    pub fn spectrum(&self) -> &CreepSpectrum {
        &self.spectrum
    }

    /// The error of the series, at about 70 times per decade, or at the rows of a table.
    pub fn report(&self) -> &FitReport {
        &self.report
    }

    /// The same body, with its series extrapolated beyond the last time.
    #[must_use]
    pub fn extrapolated(self) -> CreepSeries {
        CreepSeries { known_until: f64::INFINITY, ..self }
    }
}

impl Rheology for CreepSeries {
    fn creep_compliance(&self, t: f64) -> f64 {
        if is_known(t, self.known_until) { self.spectrum.compliance(t) } else { f64::NAN }
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        Some(self.spectrum.clone())
    }

    fn known_until(&self) -> f64 {
        self.known_until
    }

    fn measured(&self) -> [f64; 2] {
        self.measured
    }

    fn fit_report(&self) -> Option<&FitReport> {
        (!self.report.is_exact()).then_some(&self.report)
    }
}

/// J at log-spaced times, both ends included.
fn sampled<R: Rheology + ?Sized>(
    rheology: &R,
    [first, last]: [f64; 2],
    per_decade: f64,
    glassy: f64,
) -> Result<Vec<Sample>> {
    let count = ((last / first).log10() * per_decade).ceil() as usize;
    let mut previous = glassy;
    let mut samples = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let x = match k {
            0 => first,
            _ if k == count => last,
            _ => first * (last / first).powf(k as f64 / count as f64),
        };
        previous = checked(rheology, x, previous)?;
        samples.push(Sample { function: MaterialFunction::Creep, x, value: previous, weight: 1.0 });
    }
    Ok(samples)
}

/// J(t), no less than at an earlier time, and above 0 after t = 0.
fn checked<R: Rheology + ?Sized>(rheology: &R, time: f64, previous: f64) -> Result<f64> {
    let value = rheology.creep_compliance(time);
    if may_follow(value, previous) && (value > 0.0 || time == 0.0 && value == 0.0) {
        Ok(value)
    } else {
        Err(rheology.failure().map_or_else(|| invalid_compliance(time, value, previous), Error::User))
    }
}

/// The error of a J(t) that no body can have.
pub(super) fn invalid_compliance(time: f64, value: f64, previous: f64) -> Error {
    let [at, shown, previous] = [time, value, previous].map(|number| rounded(number, 5));
    let allowed = "finite, ≥ 0 (> 0 after t = 0) and non-decreasing";
    let what = format!(
        "creep compliance J({at} s) = {shown} 1/Pa is not allowed: it must be {allowed} (J was {previous} before)"
    );
    let refusal = Refusal::value("material_invalid_compliance", what, "").naming("creep compliance");
    refusal.valued(value).allowing(allowed).into()
}

/// The error of a rheology without an exact exponential series, which `what` needs.
pub(super) fn no_series(what: &'static str, rheology: &dyn std::fmt::Debug) -> Error {
    let what = format!("{what} needs an exponential series, and {rheology:?} has no exact one");
    let remedy = ": name the times to fit one over, with Builder::times (first and last) or Builder::times_of (a load \
        history and its end), or fit one with Rheology::series or Material::fitted";
    Refusal::value("material_no_exponential_series", what, remedy).into()
}
