//! The laws that every [`Rheology`] obeys, to test implementations of the trait. [`all`] checks them at given times,
//! and reports which law is violated, where and by how much.
//!
//! ```
//! use viscocontact::rheology::{Rheology, laws};
//!
//! #[derive(Debug)]
//! struct Tired; // forgets its load after a second
//!
//! impl Rheology for Tired {
//!     fn creep_compliance(&self, t: f64) -> f64 {
//!         if t < 1.0 { 1.0e-6 * (1.0 + t) } else { 1.0e-6 }
//!     }
//! }
//! let violation = laws::all(&Tired, &laws::log_times(1.0e-3, 1.0e3)).unwrap_err();
//! assert_eq!(violation.law, "creep never decreases");
//! println!("{violation}");
//! ```

pub use crate::error::{Location, Verdict, Violation};
use crate::rheology::{Rheology, may_follow};

/// Relative difference allowed between formulas that are equal but for rounding.
const SAME: f64 = 1e-10;

/// Eight times per decade from `first` to `last` \[s\], suitable for most laws; empty unless 0 < `first` ≤ `last` < ∞.
pub fn log_times(first: f64, last: f64) -> Vec<f64> {
    if !(first > 0.0 && first <= last && last.is_finite()) {
        return Vec::new();
    }
    let (from, decades) = (first.log10(), last.log10() - first.log10());
    let count = (decades * 8.0).ceil().max(1.0) as usize;
    (0..=count).map(|k| 10_f64.powf(from + decades * (k as f64 / count as f64))).collect()
}

/// Every law, at ascending `times` > 0 \[s\], as far as J is known ([`Rheology::known_until`]): J is finite, not
/// negative, positive after t = 0, and never decreases; its rate never increases, as for every body of springs and
/// dashpots; it starts at J(0), and the exact series, if there is one, equals it.
///
/// # Errors
/// The first violation; or if there are no times, or they are not positive and ascending.
pub fn all(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    Violation::check_ascending(times, 1, 0.0)?;
    non_negative(rheology, times)?;
    non_decreasing(rheology, times)?;
    concave(rheology, times)?;
    starts_at_its_glassy_compliance(rheology, times)?;
    spectrum_reproduces_creep(rheology, times)
}

/// The times at which J is known.
fn known<'a>(rheology: &dyn Rheology, times: &'a [f64]) -> impl Iterator<Item = f64> + use<'a> {
    let until = rheology.known_until();
    times.iter().copied().filter(move |t| *t <= until)
}

const IS_FINITE: &str = "creep is finite and not negative";

/// The verdict of a law of J at one time.
fn check(law: &'static str, t: f64, found: f64, expected: f64, holds: bool) -> Verdict {
    if !found.is_finite() || !expected.is_finite() {
        let of_time = if found.is_finite() { expected } else { found };
        return Violation::check(IS_FINITE, "creep compliance", t, [of_time, 0.0], false);
    }
    Violation::check(law, "creep compliance", t, [found, expected], holds)
}

/// Accepts a compliance that equals the expected one but for rounding.
fn check_same(law: &'static str, t: f64, found: f64, expected: f64) -> Verdict {
    check(law, t, found, expected, (found - expected).abs() <= SAME * expected)
}

/// J ≥ 0, and finite; > 0 after t = 0.
fn non_negative(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    for t in std::iter::once(0.0).chain(known(rheology, times)) {
        let found = rheology.creep_compliance(t);
        check(IS_FINITE, t, found, 0.0, found >= 0.0)?;
        check("creep is positive after t = 0", t, found, 0.0, found > 0.0 || t == 0.0)?;
    }
    Ok(())
}

/// J never decreases.
fn non_decreasing(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    let mut previous = rheology.creep_compliance(0.0);
    for t in known(rheology, times) {
        let found = rheology.creep_compliance(t);
        check("creep never decreases", t, found, previous, may_follow(found, previous))?;
        previous = found;
    }
    Ok(())
}

/// The creep rate never increases (J is concave), as for every body of springs and dashpots.
fn concave(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    let (mut before, mut value) = (0.0, rheology.creep_compliance(0.0));
    let mut slowest = (f64::INFINITY, 0.0);
    for t in known(rheology, times) {
        let next = rheology.creep_compliance(t);
        let (rate, uncertain) = ((next - value) / (t - before), 1e-11 * next / (t - before));
        let holds = rate <= slowest.0 + slowest.1 + uncertain;
        Violation::check("the creep rate never increases", "creep rate", t, [rate, slowest.0], holds)?;
        if rate < slowest.0 {
            slowest = (rate, uncertain);
        }
        (before, value) = (t, next);
    }
    Ok(())
}

/// J tends to J(0) as t → 0: below the first of `times` the rise must decrease with t.
fn starts_at_its_glassy_compliance(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    let (glassy, first) = (rheology.creep_compliance(0.0), times.first().copied().unwrap_or(1.0));
    let rise = |t: f64| rheology.creep_compliance(t) - glassy;
    let (here, far) = (rise(first), first * 1e-60);
    let found = rise(far);
    check("creep starts at J(0)", far, found, 0.5 * here, found <= 0.5 * here + SAME * glassy)
}

/// The exact series, if there is one, equals J.
fn spectrum_reproduces_creep(rheology: &dyn Rheology, times: &[f64]) -> Verdict {
    let Some(spectrum) = rheology.creep_spectrum() else { return Ok(()) };
    for t in std::iter::once(0.0).chain(known(rheology, times)) {
        check_same("the series is the creep compliance", t, spectrum.compliance(t), rheology.creep_compliance(t))?;
    }
    Ok(())
}
