//! What bodies are made of, in a contact: elastic bulk, two bodies, fitted series.

use crate::common::RADIUS;
use crate::common::refused::{field, says};
use approx::assert_abs_diff_eq;
use viscocontact::Error;
use viscocontact::prelude::*;

const FORCE: f64 = 1.0;

/// A sphere on a grid that holds the contact of compliance `c`.
fn builder(cells: usize, c: f64) -> viscocontact::contact::Builder {
    let widest = (0.75 * RADIUS * FORCE * c).cbrt();
    ViscoelasticContact::builder(Grid::square(cells, 2.3 * widest).unwrap()).geometry(&Sphere::new(RADIUS).unwrap())
}

/// Contact radius cubed, measured through the approach ω = a²/R, which is far more accurate than counted cells.
fn cubed_radius(contact: &ViscoelasticContact) -> f64 {
    (contact.approach() * RADIUS).powf(1.5)
}

#[test]
fn elastic_bulks_are_refused_by_name() {
    for bad in [0.0, -1.0, f64::NAN] {
        assert_eq!(field(Material::elastic_bulk(Elastic::new(1.0).unwrap(), bad)), "bulk modulus");
    }
    let refused = Material::elastic_bulk(PowerLaw::new(1.0, 1.0, 0.5).unwrap(), 1.0).unwrap_err();
    says(&refused, "material_no_exponential_series", "an elastic bulk needs an exponential series, and ");
}

/// A body without an exact series is fitted at the build, over the times given there; the material holds a report of the fit.
#[test]
fn a_body_without_an_exact_series_is_fitted_over_the_times_it_is_wanted_for() {
    let closure = || Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())));
    let exact = |t: f64| 3.0 / 16.0 * RADIUS * FORCE * 1.0e-6 * (1.0 + t.sqrt());
    let wide = builder(64, 0.25e-6 * (1.0 + 10f64.sqrt()));
    let mut contact = wide.material(closure()).times(1e-3..=1e5).build().unwrap();
    assert_eq!(contact.material().fit_reports().count(), 1);
    contact.step(0.0, Load::force(FORCE)).unwrap();
    let jump = cubed_radius(&contact) / exact(0.0) - 1.0;
    assert_abs_diff_eq!(jump, 0.0, epsilon = 5e-3);
    for k in 1..=100 {
        contact.step(0.1, Load::force(FORCE)).unwrap();
        let relative = cubed_radius(&contact) / exact(0.1 * f64::from(k)) - 1.0;
        assert!(relative.abs() < if k < 5 { 2e-2 } else { 5e-3 }, "{k}: {relative:e}");
    }
    let fit = contact.material().fit_reports().next().unwrap().clone();
    println!("{fit}");
    assert!(fit.max_misfit() <= 1e-4);
    let [first, last] = fit.range().unwrap();
    assert_abs_diff_eq!(first / 1e-3, 1.0, epsilon = 1e-12);
    assert_abs_diff_eq!(last / 1e5, 1.0, epsilon = 1e-12);
    // a step beyond is refused and changes nothing
    let before = (contact.time(), contact.approach());
    assert!(matches!(contact.step(1e5, Load::force(FORCE)), Err(Error::Step(StepError::BeyondMaterial { .. }))));
    assert_eq!(before, (contact.time(), contact.approach()));
    contact.step(0.1, Load::force(FORCE)).unwrap();

    // nor does a failed first step change what was fitted
    let mut contact = builder(64, 0.5e-6).material(closure()).times(1e-5..=1e10).build().unwrap();
    contact.step(0.0, Load::force(FORCE)).unwrap();
    assert!(matches!(contact.step(1e9, Load::force(1e6 * FORCE)), Err(Error::Step(StepError::ContactAtEdge { .. }))));
    contact.step(1e-3, Load::force(FORCE)).unwrap();
    let [first, _] = contact.material().fit_reports().next().unwrap().range().unwrap();
    assert_abs_diff_eq!(first / 1e-5, 1.0, epsilon = 1e-12);

    // without an elastic response, what it has crept by the shortest time counts as immediate
    let body = PowerLaw::new(1.0e-6, 1.0, 0.5).unwrap();
    let mut contact = builder(64, 0.5e-6).material(Material::incompressible(body)).times(1e-2..=1e2).build().unwrap();
    contact.step(0.0, Load::force(FORCE)).unwrap();
    let at_first = 3.0 / 16.0 * RADIUS * FORCE * body.creep_compliance(1e-2);
    assert!(contact.contact_cells() > 0 && cubed_radius(&contact) < 1.01 * at_first);
    contact.step(0.5, Load::force(FORCE)).unwrap();
    // what no series can be fitted to
    let arched = Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t * t)));
    let error = builder(64, 1e-6).material(arched).times(1e-2..=1e2).build().unwrap_err();
    says(&error, "material_poor_fit", "no exponential series was found within 1e-4: ");
    assert!(error.value().unwrap() > 1e-2, "{error}");
}

/// A load history and its end determine over which times a body is fitted.
#[test]
fn a_history_and_its_end_give_the_times() {
    let closure = || Material::incompressible(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())));
    let load = StepLoad::new(Load::force(FORCE)).unwrap();
    let wide = builder(64, 0.25e-6 * (1.0 + 1e4));
    let mut contact = wide.material(closure()).times_of(&load, 1e8).build().unwrap();
    let [_, last] = contact.material().fit_reports().next().unwrap().range().unwrap();
    assert_abs_diff_eq!(last / 1e8, 1.0, epsilon = 1e-12);
    let mut run = contact.follow(&load, Stepping::fixed(1e-3), 1e8);
    run.next_step().unwrap();
    run.next_step().unwrap();
    // what happens between corners of the load is resolved
    let corners = [(0.0, 0.0), (1.0, 1.0), (1.01, 0.5), (10.0, 0.5)];
    let table = PiecewiseLinear::new(&corners.map(|(time, force)| (time, Load::force(force * FORCE)))).unwrap();
    let mut contact = builder(32, 0.25e-6 * 5.0).material(closure()).times_of(&table, 10.0).build().unwrap();
    let [first, last] = contact.material().fit_reports().next().unwrap().range().unwrap();
    // a part of the time between two of them, not of the whole run
    assert!(first < 1e-7, "{first:e}");
    assert_abs_diff_eq!(last / 10.0, 1.0, epsilon = 1e-12);
    let mut run = contact.follow(&table, Stepping::adaptive(1e-3), 10.0);
    while run.next_step().unwrap().is_some() {}
    assert_eq!(contact.time(), 10.0);
    for end in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = field(builder(16, 0.5e-6).material(closure()).times_of(&load, end).build());
        assert!(refused.ends_with("time of a series"), "{end}: {refused}");
    }
}

/// Ends of the range of the fractional Zener body: its limits, or refused by name.
#[test]
fn a_fractional_zener_body_has_its_limits() {
    let relaxed = 1.0e-9 + 1.0e-6;
    for (time, exponent) in [(1e-300, 0.99), (5e-324, 0.5), (1e-200, 0.999)] {
        let body = FractionalZener::new(1.0e9, 1.0e6, time, exponent).unwrap();
        for t in [1e200, 1e300, f64::MAX] {
            let value = body.creep_compliance(t);
            assert!((value / relaxed - 1.0).abs() < 1e-12, "J({t:e} s) = {value:e} of {body:?}");
        }
    }
    assert_eq!(field(FractionalZener::new(5e-324, 1.0, 1.0, 0.5)), "compliance 1/G");
    assert_eq!(field(FractionalZener::new(1.0, 1e-310, 1.0, 0.5)), "compliance 1/G_K");
}

/// What has an exact series needs no fit.
#[test]
fn series_span_forty_decades() {
    let body = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap();
    assert!(body.series(1e-10..=1e30, 0.1).unwrap().report().max_misfit() <= 0.1);
    let exact = Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap();
    assert!(exact.series(1e-90..=1e90, 1e-4).unwrap().report().samples().is_empty());
}
