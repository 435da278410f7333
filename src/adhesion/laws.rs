//! The laws that every [`Attraction`] obeys, to test implementations of the trait. [`all`] checks every law, at gaps
//! from zero to a million ranges.

use crate::adhesion::Attraction;
pub use crate::error::{Location, Verdict, Violation};
use crate::quadrature::GaussLegendre;

/// Gap 0, then gaps in a geometric series, 40 a decade, from a thousandth of the range to a million ranges \[m\].
fn gaps(attraction: &dyn Attraction) -> impl Iterator<Item = f64> {
    let range = attraction.range();
    std::iter::once(0.0).chain((0..=360).map(move |k| 1e-3 * range * 10f64.powf(f64::from(k) / 40.0)))
}

/// The integral over an interval, which is halved where two halves differ from the whole: twice at least, since a
/// corner of the law may leave the halves as the whole, and around a corner 24 times at most.
fn integrate(
    rule: &GaussLegendre,
    from: f64,
    to: f64,
    accurate: f64,
    halved: usize,
    value: &dyn Fn(f64) -> f64,
) -> f64 {
    let middle = 0.5 * (from + to);
    let halves = rule.integrate(from, middle, value) + rule.integrate(middle, to, value);
    let off = (halves - rule.integrate(from, to, value)).abs();
    if halved == 24 || halved >= 2 && off <= accurate {
        return halves;
    }
    let part = |from, to| integrate(rule, from, to, accurate, halved + 1, value);
    part(from, middle) + part(middle, to)
}

fn check(law: &'static str, quantity: &'static str, gap: f64, [found, expected]: [f64; 2], holds: bool) -> Verdict {
    if holds { Ok(()) } else { Err(Violation { law, quantity, at: Location::Gap(gap), found, expected }) }
}

/// Every law: work of separation, range and maximum traction are finite and positive, and fit each other; the traction
/// is never negative, and never grows with the gap; the energy is its integral from the gap to infinity.
///
/// # Errors
/// The first violation.
pub fn all(attraction: &dyn Attraction) -> Verdict {
    scales_are_positive(attraction)?;
    attracts_less_with_the_gap(attraction)?;
    energy_is_the_integral(attraction)
}

/// Every law, as far as a contact needs it: an energy may be an integral by a rule of the user, off by a thousandth.
pub(crate) fn usable(attraction: &dyn Attraction) -> Verdict {
    scales_are_positive(attraction)?;
    attracts_less_with_the_gap(attraction)?;
    energy_is_within(1e-3, attraction)
}

/// Work of separation, range and maximum traction are finite and positive, and fit each other.
fn scales_are_positive(attraction: &dyn Attraction) -> Verdict {
    let law = "work, range and maximum traction are finite and positive";
    let (work, range, greatest) = (attraction.work(), attraction.range(), attraction.traction(0.0));
    for (quantity, value) in [("work of separation", work), ("range", range), ("traction", greatest)] {
        check(law, quantity, 0.0, [value, 0.0], value > 0.0 && value.is_finite())?;
    }
    let law = "the work is the energy at gap 0, and the range times the maximum traction";
    for expected in [attraction.energy(0.0), range * greatest] {
        check(law, "work of separation", 0.0, [work, expected], (work - expected).abs() <= 1e-12 * work)?;
    }
    Ok(())
}

/// The traction is never negative, and never grows with the gap.
fn attracts_less_with_the_gap(attraction: &dyn Attraction) -> Verdict {
    let mut before = f64::INFINITY;
    for gap in gaps(attraction) {
        let traction = attraction.traction(gap);
        check("the traction is not negative", "traction", gap, [traction, 0.0], traction >= 0.0)?;
        check("the traction does not grow with the gap", "traction", gap, [traction, before], traction <= before)?;
        before = traction;
    }
    Ok(())
}

/// The energy is the integral of the traction from the gap to infinity: its differences are integrals, and it
/// vanishes far away.
fn energy_is_the_integral(attraction: &dyn Attraction) -> Verdict {
    energy_is_within(1e-7, attraction)
}

/// Differences of energies are integrals to this part of the work of separation.
fn energy_is_within(same: f64, attraction: &dyn Attraction) -> Verdict {
    let (law, rule) = ("the energy is the integral of the traction", GaussLegendre::new(12));
    let (work, mut from) = (attraction.work(), 0.0);
    let accurate = 1e-3 * same * work;
    for gap in gaps(attraction).skip(1) {
        let lost = attraction.energy(from) - attraction.energy(gap);
        let integral = integrate(&rule, from, gap, accurate, 0, &|gap| attraction.traction(gap));
        check(law, "energy", gap, [lost, integral], (lost - integral).abs() <= same * work)?;
        from = gap;
    }
    let left = attraction.energy(from);
    check("the energy vanishes far away", "energy", from, [left, 1e-3 * work], (0.0..=1e-3 * work).contains(&left))
}
