use std::f64::consts::TAU;
use std::sync::Arc;

use viscocontact::Error as ContactError;
use viscocontact::num_complex::Complex;
use viscocontact::prelude::*;
use viscocontact_identify::{Curve, Error, Experiment, Protocol, Result};

use crate::random::{generator, marched, normal};

/// Contact modulus of the bodies of these tests: E∞, then (E_i, τ_i).
const EQUILIBRIUM: f64 = 2.0e3;
const TERMS: [(f64, f64); 2] = [(3.0e3, 0.02), (1.0e3, 0.3)];

/// E∞ + Σ E_i iωτ_i/(1 + iωτ_i).
fn exact(frequency: f64) -> Complex<f64> {
    let term = |&(modulus, time): &(f64, f64)| {
        let angle = Complex::new(0.0, TAU * frequency * time);
        modulus * angle / (1.0 + angle)
    };
    EQUILIBRIUM + TERMS.iter().map(term).sum::<Complex<f64>>()
}

/// The force at each time of the protocol, in so many steps between two times.
fn force(experiment: &Experiment, substeps: u32) -> Result<Vec<f64>> {
    // an incompressible body of shear modulus G has the contact modulus 4 G
    let terms = TERMS.map(|(modulus, time)| (0.25 * modulus, time));
    let body = Material::incompressible(GeneralizedMaxwell::new(0.25 * EQUILIBRIUM, &terms)?);
    marched(experiment, &body, substeps)
}

/// A ramp to a depth of 1 µm, a dwell of ten times the longest relaxation time, and 12 periods.
fn oscillation(frequency: f64, amplitude: f64) -> Result<Protocol> {
    Protocol::builder(0.0, 0.05).line(1.0e-6, 0.5).hold(3.0).oscillate(amplitude, frequency, 12, 80).build()
}

/// The last six periods.
fn window(frequency: f64) -> std::ops::Range<f64> {
    3.5 + 6.0 / frequency..3.5 + 12.0 / frequency
}

/// Two closed forms and one sweep, driven in depth and through springs softer and stiffer than the contact.
#[test]
fn the_complex_modulus_is_the_closed_form_as_the_amplitude_falls() -> Result<()> {
    let swept = Sweep::new(Grid::square(48, 8.0e-6)?, &Cone::new(0.3)?).run(Reach::Approach(1.3e-6))?;
    let tips = [ElasticStates::sphere(5.0e-6)?, ElasticStates::cone(0.4)?, swept];
    for (tip, spring) in tips.iter().flat_map(|tip| [None, Some(0.002), Some(0.1)].map(|spring| (tip, spring))) {
        for frequency in [1.0, 8.0] {
            let deviation = |amplitude: f64| -> Result<f64> {
                let mut experiment = Experiment::new(oscillation(frequency, amplitude)?, Arc::clone(tip));
                if let Some(stiffness) = spring {
                    experiment = experiment.with_spring(stiffness)?;
                }
                let curve = Curve::new(experiment.clone(), force(&experiment, 4)?)?;
                let measured = curve.complex_modulus(frequency, window(frequency), 0.0)?;
                Ok((Complex::new(measured.storage, measured.loss) - exact(frequency)).norm() / exact(frequency).norm())
            };
            let [large, small] = [deviation(20.0e-9)?, deviation(2.0e-9)?];
            println!("{spring:?} {frequency} Hz: {large:.2e}, {small:.2e}");
            assert!(large < 0.02 && small < 3e-3, "{spring:?}, {frequency} Hz: {large:.2e}, {small:.2e}");
        }
    }
    Ok(())
}

/// The spread of the results over 300 seeds is the standard error of each, and no result is biased.
#[test]
fn the_standard_error_is_the_spread() -> Result<()> {
    let (frequency, tip) = (5.0, ElasticStates::sphere(5.0e-6)?);
    for spring in [None, Some(0.01)] {
        let mut experiment = Experiment::new(oscillation(frequency, 5.0e-9)?, Arc::clone(&tip));
        if let Some(stiffness) = spring {
            experiment = experiment.with_spring(stiffness)?;
        }
        let force = force(&experiment, 2)?;
        let measure = |noise: f64, seed: u64| {
            let mut rng = generator(seed);
            let noisy = force.iter().map(|force| force + noise * normal(&mut rng)).collect();
            Curve::new(experiment.clone(), noisy)?.complex_modulus(frequency, window(frequency), 0.0)
        };
        // a hundredth of the amplitude of the force
        let (clean, count) = (measure(0.0, 0)?, 300);
        let noise = 0.01 * clean.amplitude * clean.stiffness * clean.storage.hypot(clean.loss);
        let results = (1..=count).map(|seed| measure(noise, seed)).collect::<Result<Vec<_>>>()?;
        let mean = |of: &dyn Fn(usize) -> f64| (0..results.len()).map(of).sum::<f64>() / count as f64;
        type Of = fn(&viscocontact_identify::ComplexModulus) -> [f64; 2];
        let parts: [(&str, Of); 2] =
            [("E′", |of| [of.storage, of.storage_error]), ("E″", |of| [of.loss, of.loss_error])];
        for (name, of) in parts {
            let exact = of(&clean)[0];
            let (average, error) = (mean(&|k| of(&results[k])[0]), mean(&|k| of(&results[k])[1]));
            let spread = mean(&|k| (of(&results[k])[0] - average).powi(2)).sqrt();
            // 300 draws determine a spread to 4 %, and a mean to 6 % of it
            assert!((spread / error - 1.0).abs() < 0.13, "{spring:?} {name}: spread {spread}, standard error {error}");
            assert!((average - exact).abs() < 0.25 * spread, "{spring:?} {name}: {average} for {exact}");
        }
    }
    Ok(())
}

#[test]
fn windows_that_cannot_work_are_refused() -> Result<()> {
    let experiment = Experiment::new(oscillation(5.0, 5.0e-9)?, ElasticStates::sphere(5.0e-6)?);
    let curve = Curve::new(experiment.clone(), force(&experiment, 1)?)?;
    for (frequency, window, contact_point, expected) in [
        (0.0, 4.0..5.0, 0.0, "frequency"),
        (5.0, 4.0..4.3, 0.0, "periods in the window"),
        (5.0, 6.0..5.0, 0.0, "periods in the window"),
        (2.0e3, 4.0..5.0, 0.0, "points of a period in the window"),
        (5.0, 4.0..5.0, 2.0e-6, "mean depth in the window"),
        (5.0, 1.0..3.0, 0.0, "amplitude of the depth"),
    ] {
        match curve.complex_modulus(frequency, window, contact_point) {
            Err(Error::Contact(ContactError::OutOfRange { field, .. })) => assert_eq!(field, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    // two periods, to the sample
    curve.complex_modulus(5.0, 4.0..4.4, 0.0)?;
    Ok(())
}
