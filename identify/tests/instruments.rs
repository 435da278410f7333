//! From files as instruments export them to a material, and what instruments add to a force.

use std::fmt::Write;
use std::sync::Arc;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use viscocontact::TextFormat;
use viscocontact::states::ElasticStates;
use viscocontact_identify::{
    Curve, Experiment, Fit, FitWarning, Identification, Model, Noise, Nuisance, Protocol, Recording, Result, tips,
};

use crate::random::normal;

const BODY: [(&str, f64); 3] = [("E0", 4.0e3), ("Einf", 1.0e3), ("tau", 0.3)];

/// A force curve from 0.4 µm above the surface, with a hold; forces without noise.
fn force_curve(tip: &Arc<ElasticStates>, stiffness: Option<f64>) -> Result<(Experiment, Vec<f64>)> {
    let protocol = Protocol::ramp_hold_retract(4.0e-6, [0.4e-6, 1.2e-6], 1.5, 0.005)?;
    let experiment = Experiment::new(protocol, Arc::clone(tip));
    let experiment = stiffness.map_or(Ok(experiment.clone()), |stiffness| experiment.with_spring(stiffness))?;
    let samples = Identification::new(Model::Zener).respond(&experiment, &BODY)?;
    Ok((experiment, samples.iter().map(|sample| sample.force).collect()))
}

fn assert_found(fit: &Fit, text: &str) {
    for (name, truth) in BODY {
        let estimate = fit.estimate(name).unwrap();
        let error = (estimate.value / truth).ln();
        assert!(error.abs() < 4.0 * estimate.deviation + 1e-3 && error.abs() < 0.1, "{text}: {estimate}");
    }
}

/// The greatest force, and noise of 0.5 % of it.
fn with_noise(force: &[f64], seed: u64) -> (f64, Vec<f64>) {
    let greatest = force.iter().copied().fold(0.0, f64::max);
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    (greatest, force.iter().map(|force| force + 0.005 * greatest * normal(rng)).collect())
}

/// A file of rows of time, drive or depth, and force, in the units of the file.
fn file(head: &str, row: impl Fn(f64, f64, f64) -> String, experiment: &Experiment, force: &[f64]) -> String {
    let mut text = head.to_owned();
    let protocol = experiment.protocol();
    for ((time, drive), force) in protocol.times().iter().zip(protocol.drive()).zip(force) {
        writeln!(text, "{}", row(*time, *drive, *force)).unwrap();
    }
    text
}

/// A layout, with what is special of the instrument.
type Layout<'a> = (&'a str, String, Box<dyn Fn(f64, f64, f64) -> String>);

#[test]
fn six_instruments_give_the_material_of_their_files() -> Result<()> {
    let (bead, cone, stiffness) = (tips::paraboloid(5.0e-6)?, ElasticStates::cone(0.7)?, 0.05);
    let settings: String = (0..36).map(|k| format!("Setting {k}\t{k}\n")).collect();
    let springs: [Layout<'_>; 4] = [
        (
            "JPK",
            "# data-description: force\n# columns: seriesTime height vDeflection\n# units: s m m\n".to_owned(),
            Box::new(|t, z, f| format!("{t:e} {z:e} {:e}", f / 0.05)),
        ),
        (
            "Chiaro",
            settings + "Time (s)\tLoad (uN)\tCantilever (nm)\tPiezo (nm)\n",
            Box::new(|t, z, f| format!("{t}\t{:e}\t{:e}\t{:e}", 1e6 * f, 1e9 * f / 0.05, 1e9 * z)),
        ),
        (
            "decimal commas",
            "Zeit\nTime (ms);Position (um);Force (nN)\n".to_owned(),
            Box::new(|t, z, f| format!("{:e};{:e};{:e}", 1e3 * t, 1e6 * z, 1e9 * f).replace('.', ",")),
        ),
        ("NumPy", "# time_s drive_m force_N\n".to_owned(), Box::new(|t, z, f| format!("{t:.18e} {z:.18e} {f:.18e}"))),
    ];
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted);
    let (experiment, exact) = force_curve(&bead, Some(stiffness))?;
    for (seed, (name, head, row)) in springs.into_iter().enumerate() {
        let (_, force) = with_noise(&exact, seed as u64);
        let text = file(&head, row, &experiment, &force);
        let format = TextFormat::default().with_decimal_comma(name == "decimal commas");
        let recording = Recording::from_csv_reader(text.as_bytes(), format);
        let recording = recording.unwrap_or_else(|error| panic!("{name}: {error}"));
        let curve = recording.spring_curve(&bead, stiffness).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_found(&fitting.fit(&[curve])?, name);
    }
    // a nanoindenter: depth and load, units in a row below
    let (experiment, exact) = force_curve(&cone, None)?;
    let (_, force) = with_noise(&exact, 7);
    let head = "Displacement Into Surface,Load On Sample,Time On Sample\nnm,mN,s\n";
    let text = file(head, |t, z, f| format!("{:e},{:e},{t:e}", 1e9 * z, 1e3 * f), &experiment, &force);
    let curve = Recording::from_csv_reader(text.as_bytes(), TextFormat::default())?.depth_curve(&cone)?;
    assert_found(&fitting.fit(&[curve])?, "nanoindenter");
    // a stage that moves the other way, a tilted base line, and an adhesive tip
    let (experiment, exact) = force_curve(&bead, Some(stiffness))?;
    let (greatest, mut force) = with_noise(&exact, 8);
    let times = experiment.protocol().times();
    for (k, force) in force.iter_mut().enumerate() {
        let pull = if (2.21..2.25).contains(&times[k]) { -0.2 * greatest } else { 0.0 };
        *force += pull + 0.02 * greatest * experiment.protocol().drive()[k] / 1.0e-6;
    }
    let row = |t: f64, z: f64, f: f64| format!("{t:e},{:e},{:e}", -1e6 * z, 1e9 * f / 0.05);
    let text = file("Time_s,ZSnsr_um,Defl_nm\n", row, &experiment, &force);
    let recording = Recording::from_csv_reader(text.as_bytes(), TextFormat::default())?.flip_drive();
    let curve = recording.spring_curve(&bead, stiffness)?;
    let whole = fitting.fit(std::slice::from_ref(&curve))?;
    assert!(whole.warnings().iter().any(|warning| matches!(warning, FitWarning::PullOff { .. })), "{whole}");
    let cut = curve.until_release()?;
    assert!(cut.pull_off().is_none() && cut.force().len() < curve.force().len());
    assert_found(&fitting.tilt(Nuisance::Fitted).fit(&[cut])?, "adhesive tip");
    Ok(())
}

/// Number of seeds: `SYSTEMATIC_SEEDS`, or fewer.
fn seeds() -> u64 {
    std::env::var("SYSTEMATIC_SEEDS").ok().and_then(|text| text.parse().ok()).unwrap_or(40)
}

/// What instruments add: fits with the nuisance that describes it are unbiased, and where none is described, the fit says so.
#[test]
fn what_instruments_add_is_described_or_told() -> Result<()> {
    let bead = tips::paraboloid(5.0e-6)?;
    let (experiment, exact) = force_curve(&bead, Some(0.05))?;
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
        for seed in 0..seeds() {
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
    let bead = tips::paraboloid(5.0e-6)?;
    let (experiment, exact) = force_curve(&bead, Some(0.05))?;
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
    let variants = wrong.variants();
    assert_eq!(variants.len(), 4);
    let best = variants.iter().min_by(|a, b| a.aicc_difference.total_cmp(&b.aicc_difference)).unwrap();
    assert_eq!(best.assumption, "drift");
    assert!((best.ratios[2] - 1.0).abs() > 0.02, "{best:?}");
    assert!(right.variants().iter().all(|variant| variant.ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.05)));
    Ok(())
}
