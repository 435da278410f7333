//! Every law of attraction, and wrong ones, against the laws of the trait.

use viscocontact::adhesion::{
    Attraction, Dugdale, ExponentialAttraction, LinearSoftening, VanDerWaals, laws, tabor_number,
};
use viscocontact::prelude::*;

const WORK: f64 = 0.05;
const RANGE: f64 = 20.0e-9;

fn attractions() -> Vec<Box<dyn Attraction>> {
    vec![
        Box::new(ExponentialAttraction::new(WORK, RANGE).unwrap()),
        Box::new(VanDerWaals::new(WORK, RANGE).unwrap()),
        Box::new(LinearSoftening::new(WORK, RANGE).unwrap()),
        Box::new(Dugdale::new(WORK, RANGE).unwrap()),
        Box::new(Dugdale::new(WORK, RANGE).unwrap().with_width(0.02).unwrap()),
        Box::new(std::sync::Arc::new(Dugdale::new(WORK, RANGE).unwrap().with_width(2.0).unwrap())),
    ]
}

#[test]
fn every_attraction_obeys_every_law() {
    for law in attractions() {
        if let Err(violation) = laws::all(&*law) {
            panic!("{law:?}: {violation}");
        }
        assert!((law.work() / WORK - 1.0).abs() < 1e-14 && (law.range() / RANGE - 1.0).abs() < 1e-14, "{law:?}");
    }
}

/// A Dugdale law as wide as it can be is the linear one.
#[test]
fn the_widest_end_is_linear_softening() {
    let linear = LinearSoftening::new(WORK, RANGE).unwrap();
    let dugdale = Dugdale::new(WORK, RANGE).unwrap().with_width(2.0).unwrap();
    for k in 0..50 {
        let gap = 0.05 * f64::from(k) * RANGE;
        assert!((linear.traction(gap) - dugdale.traction(gap)).abs() < 1e-12 * WORK / RANGE);
        assert!((linear.energy(gap) - dugdale.energy(gap)).abs() < 1e-12 * WORK);
    }
}

type Function = fn(f64) -> f64;

/// s = a + b h + c e^(−h), with an energy of its own.
#[derive(Debug)]
struct Wrong {
    traction: Function,
    energy: Function,
}

impl Attraction for Wrong {
    fn traction(&self, gap: f64) -> f64 {
        (self.traction)(gap)
    }
    fn energy(&self, gap: f64) -> f64 {
        (self.energy)(gap)
    }
}

#[test]
fn a_wrong_law_is_found() {
    let exponential = |h: f64| (-h).exp();
    let broken = |traction: Function, energy: Function| laws::all(&Wrong { traction, energy }).unwrap_err();
    assert!(laws::all(&Wrong { traction: exponential, energy: exponential }).is_ok());
    let violation = broken(exponential, |h| (-h).exp() * (1.0 + 1e-4 * h));
    assert_eq!(violation.law, "the energy is the integral of the traction");
    assert!(violation.to_string().contains("at a gap of"), "{violation}");
    assert_eq!(broken(|h| (-h).exp() / 1.1, |h| ((-h).exp() + 0.1) / 1.1).law, "the energy vanishes far away");
    let growing = broken(|h| (-h).exp() + if h > 2.0 { 0.1 } else { 0.0 }, exponential);
    assert_eq!(growing.law, "the traction does not grow with the gap");
    assert_eq!(broken(|h| 1.0 - h, |h| 0.5 * (1.0 - h).powi(2)).law, "the traction is not negative");
    assert_eq!(broken(|_| 0.0, exponential).quantity, "range");
}

/// A contact takes no law that attracts more with the gap, repels, or whose energy is another one; an energy of a rule of the user serves.
#[test]
fn a_contact_takes_attractions_only() {
    let built = |traction: Function, energy: Function| {
        ViscoelasticContact::builder(Grid::square(16, 8.0).unwrap())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(Material::incompressible(Elastic::new(0.25).unwrap()))
            .attraction(Wrong { traction, energy })
            .build()
    };
    let exponential = |h: f64| (-h).exp();
    assert!(built(exponential, |h| (-h).exp() * (1.0 + 1e-4 * h)).is_ok());
    let wrong: [(Function, Function, &str); 6] = [
        (|h| (-h).exp() * (1.0 + 3.0 * h), |h| (4.0 + 3.0 * h) * (-h).exp(), "does not grow with the gap"),
        (|h| (-h).exp() + (-(h - 3.0).powi(2)).exp(), exponential, "does not grow with the gap"),
        (|h| (1.0 - h) * (-0.5 * h).exp(), |h| (2.0 * h - 6.0) * (-0.5 * h).exp() + 8.0, "is not negative"),
        (exponential, |h| 2.0 * (-h).exp(), "energy is the integral"),
        (|h| if h > 1.0 { f64::NAN } else { 1.0 }, exponential, "is not negative"),
        (exponential, |h| (-0.5 * h).exp(), "energy is the integral"),
    ];
    for (traction, energy, what) in wrong {
        let refused = built(traction, energy).unwrap_err();
        assert!(refused.code() == "adhesion_law", "{refused}");
        assert!(refused.to_string().contains(what), "{refused}");
    }
}

#[test]
fn scales_out_of_range_are_refused() {
    for (work, range) in [(0.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1e300, 1e-300)] {
        assert!(matches!(ExponentialAttraction::new(work, range), Err(Error::OutOfRange { .. })), "{work} {range}");
        assert!(matches!(Dugdale::new(work, range), Err(Error::OutOfRange { .. })), "{work} {range}");
    }
    for width in [0.0, 2.1, f64::NAN] {
        assert!(matches!(Dugdale::new(1.0, 1.0).unwrap().with_width(width), Err(Error::OutOfRange { .. })));
    }
    let law = VanDerWaals::new(WORK, RANGE).unwrap();
    for (radius, modulus) in [(0.0, 1.0), (1.0, -1.0)] {
        assert!(matches!(tabor_number(&law, radius, modulus), Err(Error::OutOfRange { .. })));
    }
}

/// Random laws of every kind obey the laws.
#[test]
fn random_attractions_obey_every_law() {
    use proptest::prelude::*;
    let config = ProptestConfig {
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(38),
        ..ProptestConfig::with_cases(60)
    };
    proptest!(config, |(law in viscocontact::laws::strategies::attractions(0.1, 1.0e-8))| {
        laws::all(&*law).map_err(|violation| TestCaseError::fail(format!("{law:?}: {violation}")))?;
    });
}
