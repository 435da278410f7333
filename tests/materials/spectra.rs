//! Creep, relaxation, and the passage between them.

use super::tension::carson;
use crate::common::spectra::spectra;
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, RelaxationSpectrum};
use viscocontact::states::ElasticStates;

/// s Ĵ(s) · s Ĝ(s) − 1 at a real s, from the definitions of both series.
fn carson_defect(creep: &CreepSpectrum, relaxation: &RelaxationSpectrum, s: f64) -> f64 {
    let branch = |&(g, tau): &(f64, f64)| g * (s * tau / (1.0 + s * tau));
    let g = relaxation.equilibrium() + s * relaxation.viscosity() + relaxation.terms().iter().map(branch).sum::<f64>();
    carson(creep, s) * g - 1.0
}

pub fn assert_reciprocal(creep: &CreepSpectrum) {
    let relaxation = creep.relaxation();
    let back = relaxation.creep();
    for exponent in -80..=80 {
        let s = 10f64.powf(0.25 * exponent as f64);
        let defect = carson_defect(creep, &relaxation, s);
        assert!(defect.abs() < 1e-12, "s = {s:e}: {defect:e}\n{creep:?}\n{relaxation:?}");
        let round_trip = back.compliance(1.0 / s) / creep.compliance(1.0 / s) - 1.0;
        assert!(round_trip.abs() < 1e-10, "t = {:e}: {round_trip:e}\n{creep:?}", 1.0 / s);
    }
    // signs: both are sums of positive terms
    assert!(relaxation.terms().iter().all(|&(g, tau)| g >= 0.0 && tau > 0.0));
}

#[test]
fn every_model_evaluates_its_formula() {
    let t: f64 = 0.7;
    let kelvin = |g: f64, eta: f64| (1.0 - (-t * g / eta).exp()) / g;
    let cases: [(&dyn Rheology, f64); 12] = [
        (&Elastic::new(2.0).unwrap(), 0.5),
        (&Maxwell::with_time(2.0, 2.5).unwrap(), 0.5 + t / 5.0),
        (&KelvinVoigt::with_time(2.0, 2.5).unwrap(), kelvin(2.0, 5.0)),
        (&Maxwell::new(2.0, 5.0).unwrap(), 0.5 + t / 5.0),
        (&KelvinVoigt::new(2.0, 5.0).unwrap(), kelvin(2.0, 5.0)),
        (&Zener::new(2.0, 3.0, 4.0).unwrap(), 0.5 + kelvin(3.0, 4.0)),
        (&Zener::with_time(2.0, 3.0, 4.0 / 3.0).unwrap(), 0.5 + kelvin(3.0, 4.0)),
        (&Burgers::with_times((2.0, 2.5), (3.0, 4.0 / 3.0)).unwrap(), 0.5 + t / 5.0 + kelvin(3.0, 4.0)),
        (&Burgers::new(2.0, 5.0, 3.0, 4.0).unwrap(), 0.5 + t / 5.0 + kelvin(3.0, 4.0)),
        (&GeneralizedKelvin::new(0.5, 0.2, &[(1.0 / 3.0, 4.0 / 3.0)]).unwrap(), 0.5 + 0.2 * t + kelvin(3.0, 4.0)),
        (&FnRheology::new(|t| 1.0 + t), 1.7),
        (&PowerLaw::new(2.0, 3.0, 0.3).unwrap(), 2.0 * (0.3 * (t / 3.0).ln()).exp()),
    ];
    for (model, expected) in cases {
        assert!((model.creep_compliance(t) / expected - 1.0).abs() < 1e-14, "{model:?}");
        if let Some(spectrum) = model.creep_spectrum() {
            assert_eq!(spectrum.compliance(t), model.creep_compliance(t), "{model:?}");
        }
    }
    // a generalized Maxwell body with one element is a Zener body: G = G∞ + G1, same relaxation
    let prony = GeneralizedMaxwell::new(0.75, &[(2.25, 1.0)]).unwrap();
    let zener = Zener::with_time(3.0, 1.0, 4.0).unwrap();
    assert_abs_diff_eq!(prony.creep_compliance(t) / zener.creep_compliance(t), 1.0, epsilon = 1e-14);
    let relaxed = prony.creep_spectrum().unwrap().relaxation().modulus(t);
    assert_abs_diff_eq!(relaxed / (0.75 + 2.25 * (-t).exp()), 1.0, epsilon = 1e-14);
}

#[test]
fn a_hundred_terms_over_thirty_decades_are_reciprocal() {
    let terms: Vec<(f64, f64)> =
        (0..100).map(|k| (1.0 + (k * k % 17) as f64, 10f64.powf(-15.0 + 30.0 * k as f64 / 99.0))).collect();
    for (glassy, fluidity) in [(1.0, 0.0), (1.0, 1e-12), (0.0, 0.0), (0.0, 1e3)] {
        assert_reciprocal(&CreepSpectrum::new(glassy, fluidity, &terms).unwrap());
    }
}

#[test]
fn clustered_repeated_and_weak_terms_are_reciprocal() {
    for gap in [1e-15, 1e-13, 1e-10, 1e-8, 3e-7, 2e-6, 1e-5, 1e-3] {
        let near: Vec<(f64, f64)> = (0..8).map(|k| (1.0, 1.0 + gap * k as f64)).collect();
        assert_reciprocal(&CreepSpectrum::new(1.0, 0.0, &near).unwrap());
    }
    let repeated = CreepSpectrum::new(1.0, 0.0, &[(1.0, 2.0), (2.0, 2.0), (3.0, 1.0)]).unwrap();
    assert_eq!(repeated.terms(), [(3.0, 1.0), (3.0, 2.0)]);
    assert_reciprocal(&repeated);
    let weak = [(1e-30, 1.0), (1.0, 1.5), (1e-20, 1.5000001), (1e-18, 7.0), (1.0, 1e4)];
    assert_reciprocal(&CreepSpectrum::new(1.0, 1e-25, &weak).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::with_cases(256) })]

    #[test]
    fn random_spectra_are_reciprocal(creep in spectra()) {
        assert_reciprocal(&creep);
    }

    /// A body with all times doubled has J(t/2).
    #[test]
    fn times_of_random_spectra_scale(creep in spectra(), exponent in -11.0..11.0_f64) {
        let t = 10f64.powf(exponent);
        let (slow, fast) = (creep.slowed(2.0).unwrap().compliance(2.0 * t), creep.compliance(t));
        prop_assert!((slow - fast).abs() <= 1e-10 * fast, "{slow} {fast}");
    }
}

/// Coefficients and times from one end of their range to the other: what comes out are numbers.
#[test]
fn spectra_between_the_ends_of_their_range_have_numbers_for_reciprocals() {
    let sizes = [1e-100, 1e-95, 1.0, 1e95, 1e100];
    for glassy in [0.0, 1e-100, 1.0, 1e100] {
        for fluidity in [0.0, 1e-100, 1.0, 1e100] {
            for one in sizes {
                for other in sizes {
                    for (short, long) in [(1e-100, 1e100), (1e-95, 1e95), (1.0, 1e100), (1e-100, 1.0)] {
                        let creep = CreepSpectrum::new(glassy, fluidity, &[(one, short), (other, long)]).unwrap();
                        let relaxation = creep.relaxation();
                        let terms = relaxation.terms().iter().flat_map(|&(g, tau)| [g, tau]);
                        let numbers = terms.chain([relaxation.equilibrium(), relaxation.viscosity()]);
                        assert!(numbers.clone().all(|x| x.is_finite() && x >= 0.0), "{relaxation:?} of {creep:?}");
                    }
                }
            }
        }
    }
}

/// A term too weak to count, at the very time at which the others have a zero: the reciprocal must not notice it.
#[test]
fn a_negligible_term_does_not_change_the_relaxation() {
    for weak in [1e-10, 1e-15, 1e-17, 1e-20, 1e-28, 1e-34, 1e-60, 1e-100] {
        // 1 + 1/(1 + s) vanishes at s = −2
        let creep = CreepSpectrum::new(1.0, 0.0, &[(1.0, 1.0), (weak, 0.5)]).unwrap();
        let relaxation = creep.relaxation();
        assert!((relaxation.modulus(0.0) - 1.0).abs() < 1e-7, "{weak:e}: {relaxation:?}");
        for s in [1e-3, 0.3, 1.0, 2.0, 30.0, 1e4] {
            let defect = carson_defect(&creep, &relaxation, s);
            assert!(defect.abs() < 1e-7, "{weak:e}, s = {s}: {defect:e}");
        }
    }
    // as between the ends of the range
    let creep = CreepSpectrum::new(1.0, 0.0, &[(1e-100, 1.0), (1e100, 1e100)]).unwrap();
    assert!((creep.relaxation().modulus(0.0) - 1.0).abs() < 1e-12, "{:?}", creep.relaxation());
}

/// Both series have a conjugate modulus at a negative frequency, and that of a slow motion at none; elastic states and closed forms have no value
/// at no place.
#[test]
fn evaluation_keeps_nan_and_signs() {
    let [creep, fluid] =
        [0.0, 2.0].map(|fluidity| CreepSpectrum::new(1.0, fluidity, &[(3.0, 0.5), (1.0, 7.0)]).unwrap());
    for of in [&creep, &fluid] {
        for omega in [1e-9, 0.1, 1.0, 30.0, 1e9] {
            let (ahead, back) = (of.complex_modulus(omega), of.complex_modulus(-omega));
            assert!((ahead.conj() - back).norm() < 1e-14 * ahead.norm() && ahead.im > 0.0);
            let [ahead, back] = [omega, -omega].map(|omega| of.relaxation().complex_modulus(omega));
            assert!((ahead.conj() - back).norm() < 1e-14 * ahead.norm());
        }
        assert!(of.complex_modulus(f64::NAN).is_nan());
    }
    assert_eq!(fluid.complex_modulus(0.0).norm(), 0.0);
    assert!((creep.complex_modulus(0.0).re - 0.2).abs() < 1e-15);
    let states = ElasticStates::sphere(1e-2).unwrap();
    for of in [ElasticStates::approach, ElasticStates::level_at, ElasticStates::area, ElasticStates::stiffness] {
        assert!(of(&states, f64::NAN).is_nan() && of(&states, 1e-6) > 0.0 && of(&states, 0.0) == 0.0);
    }
    let dmt = viscocontact::analytic::Dmt::new(1e-3, 1e5, 0.1).unwrap();
    assert!(dmt.state(-1e-5).iter().chain(&dmt.state(f64::NAN)).all(|number| number.is_nan()));
}
