use std::f64::consts::PI;
use std::sync::Arc;

use viscocontact::Error as ContactError;
use viscocontact::prelude::*;
use viscocontact_identify::usual::{RampCorrection, hold_relaxation, loading_modulus, oliver_pharr};
use viscocontact_identify::{Curve, Error, Experiment, Protocol, Result};

use crate::random::marched;

const RADIUS: f64 = 10.0e-6;
/// Contact moduli [Pa] and relaxation time [s].
const GLASSY: f64 = 4.0e9;
const EQUILIBRIUM: f64 = 1.0e9;
const TIME: f64 = 2.0;

/// The curve of a Zener body, or of an elastic one of the glassy modulus.
fn measured(experiment: Experiment, creeps: bool) -> Result<Curve> {
    let body = if creeps {
        Material::incompressible(Zener::relaxing(0.25 * GLASSY, 0.25 * EQUILIBRIUM, TIME)?)
    } else {
        Material::incompressible(Elastic::new(0.25 * GLASSY)?)
    };
    let force = marched(&experiment, &body, 1)?;
    Curve::new(experiment, force)
}

#[test]
fn an_elastic_body_is_read_rightly_by_every_formula() -> Result<()> {
    let protocol = Protocol::builder(-50.0e-9, 0.005).line(200.0e-9, 1.0).hold(1.0).line(-50.0e-9, 1.0).build()?;
    let experiment = Experiment::new(protocol, ElasticStates::sphere(RADIUS)?);
    for experiment in [experiment.clone(), experiment.with_spring(1.0e4)?] {
        let curve = measured(experiment, false)?;
        let read = oliver_pharr(&curve, 0.0, |depth| 2.0 * PI * RADIUS * depth)?;
        assert!((read.modulus / GLASSY - 1.0).abs() < 1e-4, "{read:?}");
        for correction in [RampCorrection::Step, RampCorrection::HalfRamp, RampCorrection::Factor] {
            let read = hold_relaxation(&curve, 0.0, correction)?;
            assert!(
                (read.equilibrium / GLASSY - 1.0).abs() < 1e-6
                    && (read.glassy - read.equilibrium).abs() < 1e-6 * GLASSY,
                "{read:?}"
            );
        }
        let read = loading_modulus(&curve, None)?;
        assert!((read.modulus / GLASSY - 1.0).abs() < 1e-4 && read.contact_point.abs() < 1e-11, "{read:?}");
        let read = loading_modulus(&curve, Some(0.0))?;
        assert!(
            (read.modulus / GLASSY - 1.0).abs() < 1e-9 && read.offset.abs() < 1e-9 * curve.force()[200],
            "{read:?}"
        );
    }
    Ok(())
}

/// A jump of the depth is an ideal step; the level of a punch grows linearly in time, where the factor is exact.
#[test]
fn holds_are_read_rightly_where_their_correction_is_exact() -> Result<()> {
    let times: Vec<f64> = (0..400).map(|k| 0.05 * f64::from(k)).collect();
    let step = Experiment::new(Protocol::new(times.clone(), vec![0.2e-6; 400])?, ElasticStates::sphere(RADIUS)?);
    let ramp = |tip: &Arc<ElasticStates>, rise: f64| -> Result<Curve> {
        let protocol = Protocol::builder(0.0, 0.01).line(0.2e-6, rise).hold(20.0).build()?;
        measured(Experiment::new(protocol, Arc::clone(tip)), true)
    };
    let (punch, sphere) = (ElasticStates::punch(RADIUS)?, ElasticStates::sphere(RADIUS)?);
    let read = |curve: &Curve, correction: RampCorrection| -> Result<[f64; 3]> {
        let read = hold_relaxation(curve, 0.0, correction)?;
        Ok([read.glassy / GLASSY - 1.0, read.equilibrium / EQUILIBRIUM - 1.0, read.time / TIME - 1.0])
    };
    for (name, errors, allowed) in [
        ("step", read(&measured(step, true)?, RampCorrection::Step)?, 1e-5),
        ("punch", read(&ramp(&punch, 3.0)?, RampCorrection::Factor)?, 1e-4),
        // t_R/τ = 0.1: off by (t_R/τ)²/24 of E₁ on a punch
        ("half ramp", read(&ramp(&punch, 0.2)?, RampCorrection::HalfRamp)?, 5e-4),
    ] {
        assert!(errors.iter().all(|error| error.abs() < allowed), "{name}: {errors:?}");
    }
    // elsewhere they are off, by a known sign: the level of a sphere grows fastest at the end of the ramp
    let [step, half, factor] = [RampCorrection::Step, RampCorrection::HalfRamp, RampCorrection::Factor]
        .map(|kind| read(&ramp(&sphere, 2.0)?, kind));
    let [step, half, factor] = [step?[0], half?[0], factor?[0]];
    println!("sphere, t_R = τ: {step:.3} {half:.3} {factor:.3}");
    assert!(step < -0.1 && half > 0.03 && factor > 0.03, "{step} {half} {factor}");
    Ok(())
}

/// The stiffness of unloading is the glassy one, the nearer the faster the unloading; slow unloading relaxes meanwhile.
#[test]
fn fast_unloading_reads_the_glassy_modulus() -> Result<()> {
    let read = |fall: f64| -> Result<f64> {
        let loading = Protocol::builder(0.0, 0.05).line(0.2e-6, 1.0).hold(20.0);
        let protocol = loading.every(1e-3 * fall).line(0.0, fall).build()?;
        let curve = measured(Experiment::new(protocol, ElasticStates::sphere(RADIUS)?), true)?;
        Ok(oliver_pharr(&curve, 0.0, |depth| 2.0 * PI * RADIUS * depth)?.stiffness
            / (2.0 * GLASSY * (0.2e-6 * RADIUS).sqrt()))
    };
    let [fast, slow] = [read(0.01)?, read(100.0)?];
    println!("stiffness over glassy stiffness: {fast:.3}, slow {slow:.3}");
    assert!((fast - 1.0).abs() < 0.1 && slow < 0.6, "{fast} {slow}");
    Ok(())
}

#[test]
fn a_loading_modulus_lies_between_glassy_and_equilibrium_and_falls_with_the_time() -> Result<()> {
    let mut last = GLASSY;
    for rise in [0.02, 0.2, 2.0, 20.0, 200.0] {
        let protocol = Protocol::trapezoid(0.2e-6, [rise, 0.0, rise], 0.005 * rise)?;
        let curve = measured(Experiment::new(protocol, ElasticStates::sphere(RADIUS)?), true)?;
        let read = loading_modulus(&curve, Some(0.0))?.modulus;
        assert!(read < last && read > EQUILIBRIUM, "{rise} s: {read:e}");
        last = read;
    }
    assert!(last < 1.05 * EQUILIBRIUM);
    Ok(())
}

#[test]
fn curves_without_the_part_that_is_read_are_refused() -> Result<()> {
    let loading = Protocol::builder(0.0, 0.01).line(0.2e-6, 1.0).build()?;
    let curve = measured(Experiment::new(loading, ElasticStates::sphere(RADIUS)?), true)?;
    let unloading = oliver_pharr(&curve, 0.0, |depth| 2.0 * PI * RADIUS * depth);
    assert!(
        matches!(unloading, Err(Error::Contact(ContactError::CountOutOfRange { field: "points that are read", .. }))),
        "{unloading:?}"
    );
    let held = hold_relaxation(&curve, 0.0, RampCorrection::Step);
    assert!(
        matches!(held, Err(Error::Contact(ContactError::CountOutOfRange { field: "points that are read", .. }))),
        "{held:?}"
    );
    let swept = Sweep::new(Grid::square(32, 4.0e-6)?, &Sphere::new(RADIUS)?).run(Reach::Approach(0.1e-6))?;
    let beyond = Curve::new(Experiment::new(curve.experiment().protocol().clone(), swept), curve.force().to_vec())?;
    assert!(matches!(loading_modulus(&beyond, Some(0.0)), Err(Error::BeyondStates { .. })));
    // no elastic law has forces that fall, or a contact beyond the curve
    let falling = Curve::new(curve.experiment().clone(), curve.force().iter().map(|force| -force).collect())?;
    for read in
        [loading_modulus(&falling, None), loading_modulus(&falling, Some(0.0)), loading_modulus(&curve, Some(0.3e-6))]
    {
        assert!(matches!(read, Err(Error::NoContact { .. })), "{read:?}");
    }
    Ok(())
}
