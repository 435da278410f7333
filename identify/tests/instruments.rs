//! What instruments add to a force. (From their files to a material: the example `instruments`.)

use std::sync::Arc;

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, FitWarning, Identification, Model, Noise, Nuisance, Protocol, Result};

use crate::random::{from_environment, generator, normal};

const BODY: [(&str, f64); 3] = [("E0", 4.0e3), ("Einf", 1.0e3), ("tau", 0.3)];

/// A force curve from 0.4 µm above the surface, with a hold; forces without noise.
fn force_curve(tip: &Arc<ElasticStates>) -> Result<(Experiment, Vec<f64>)> {
    let protocol = Protocol::ramp_hold_retract(4.0e-6, [0.4e-6, 1.2e-6], 1.5, 0.005)?;
    let experiment = Experiment::new(protocol, Arc::clone(tip)).with_spring(0.05)?;
    let samples = Identification::new(Model::Zener).respond(&experiment, &BODY)?;
    Ok((experiment, samples.iter().map(|sample| sample.force).collect()))
}

/// The greatest force, and noise of 0.5 % of it.
fn with_noise(force: &[f64], seed: u64) -> (f64, Vec<f64>) {
    let greatest = force.iter().copied().fold(0.0, f64::max);
    let rng = &mut generator(seed);
    (greatest, force.iter().map(|force| force + 0.005 * greatest * normal(rng)).collect())
}

/// What instruments add: fits with the nuisance that describes it are unbiased, and where none is described, the fit says so.
#[test]
fn what_instruments_add_is_described_or_told() -> Result<()> {
    let bead = ElasticStates::sphere(5.0e-6)?;
    let (experiment, exact) = force_curve(&bead)?;
    let (times, drive) = (experiment.protocol().times(), experiment.protocol().drive());
    let speed = |k: usize| (drive[(k + 1).min(drive.len() - 1)] - drive[k.saturating_sub(1)]) / 0.01;
    let base = || Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted);
    // of a sample, the greatest force and the force
    type Added<'a> = Box<dyn Fn(usize, f64, f64) -> f64 + 'a>;
    let cases: Vec<(&str, Added<'_>, Identification)> = vec![
        ("tilt", Box::new(|k, f, _| 0.02 * f * drive[k] / 1e-6), base().tilt(Nuisance::Fitted)),
        ("drift", Box::new(|k, f, _| 0.02 * f * times[k]), base().drift(Nuisance::Fitted)),
        ("drag", Box::new(|k, f, _| 0.02 * f * speed(k) / 4e-6), base().drag(Nuisance::Fitted)),
        ("unmodelled tilt", Box::new(|k, f, _| 0.02 * f * drive[k] / 1e-6), base()),
        ("hum", Box::new(|k, f, _| 0.01 * f * (314.159 * times[k]).sin()), base().noise(Noise::Autoregressive)),
        ("steps of a converter", Box::new(|_, f, force| (force / (0.02 * f)).round() * 0.02 * f - force), base()),
    ];
    for (name, added, fitting) in cases {
        let (mut fits, mut flagged) = (Vec::new(), 0);
        for seed in 0..from_environment("SYSTEMATIC_SEEDS", 40) {
            let (greatest, force) = with_noise(&exact, 100 + seed);
            let force = force.iter().enumerate().map(|(k, force)| force + added(k, greatest, *force)).collect();
            let fit = fitting.fit(&[Curve::new(experiment.clone(), force)?])?;
            flagged += u64::from(fit.warnings().iter().any(|warning| matches!(warning, FitWarning::Misfit { .. })));
            fits.push(fit);
        }
        let bias = |name: &str, truth: f64| {
            let errors =
                fits.iter().map(|fit| fit.estimate(name).unwrap()).map(|e| (e.value / truth).ln() / e.deviation);
            errors.sum::<f64>() / fits.len() as f64
        };
        let worst = BODY.iter().map(|(name, truth)| bias(name, *truth).abs()).fold(0.0, f64::max);
        println!("{name}: worst bias {worst:.2} deviations, flagged {flagged} of {}", fits.len());
        // the mean of few seeds scatters
        let allowed = 0.5 + 3.0 / (fits.len() as f64).sqrt();
        assert!(worst < allowed || flagged as f64 >= 0.95 * fits.len() as f64, "{name}: {worst} {flagged}");
    }
    Ok(())
}

#[test]
fn a_misfit_has_a_size_and_its_effect_on_the_modulus_is_told() -> Result<()> {
    let bead = ElasticStates::sphere(5.0e-6)?;
    let (experiment, exact) = force_curve(&bead)?;
    let (greatest, force) = with_noise(&exact, 3);
    let drifting = force.iter().zip(experiment.protocol().times()).map(|(force, time)| force + 0.05 * greatest * time);
    let fit = Identification::new(Model::Zener).contact_point(Nuisance::Fitted);
    let right = fit.fit(&[Curve::new(experiment.clone(), force.clone())?])?;
    let wrong = fit.fit(&[Curve::new(experiment.clone(), drifting.collect())?])?;
    let ([right_noise, right_force], [wrong_noise, _]) = (right.misfit(), wrong.misfit());
    assert!(
        (right_noise - 1.0).abs() < 0.15 && (right_force / 0.005 - 1.0).abs() < 0.15,
        "{right_noise} {right_force}"
    );
    assert!(wrong_noise > 1.5, "{wrong_noise}");
    let variants = wrong.variants().unwrap();
    assert_eq!(variants.len(), 4);
    let best = variants.iter().min_by(|a, b| a.aicc_difference.total_cmp(&b.aicc_difference)).unwrap();
    assert_eq!(best.assumption, "drift");
    assert!((best.ratios[2] - 1.0).abs() > 0.02, "{best:?}");
    assert!(
        right.variants().unwrap().iter().all(|variant| variant.ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.05))
    );
    Ok(())
}
