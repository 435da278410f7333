use std::sync::Arc;

use viscocontact::Error as ContactError;
use viscocontact::TextFormat;
use viscocontact::prelude::*;
use viscocontact_identify::{Curve, Error, Experiment, Nuisance, Protocol, Recording, Result};

use crate::random::{correlated, exact, from_environment, generator, marched, normal};
use crate::scenes::scene;

fn read(text: &str) -> Result<Recording> {
    Recording::from_csv_reader(text.as_bytes(), TextFormat::default())
}

/// A force curve from 1 µm above a Zener body to a position of 2 µm, with a bead of 5 µm on a spring of 0.1 N/m: positions in m
/// and forces in N.
fn force_curve(tip: &Arc<ElasticStates>) -> Result<(Protocol, Vec<f64>)> {
    let protocol = Protocol::ramp_hold_retract(1.0e-6, [1.0e-6, 2.0e-6], 2.0, 0.01)?;
    let experiment = Experiment::new(protocol.clone(), Arc::clone(tip)).with_spring(0.1)?;
    let body = Material::incompressible(Zener::relaxing(5.0e3, 2.0e3, 0.5)?);
    Ok((protocol, marched(&experiment, &body, 1)?))
}

fn curve(protocol: &Protocol, force: &[f64], tip: &Arc<ElasticStates>, units: [f64; 2]) -> Result<Curve> {
    let drive = protocol.drive().iter().map(|drive| units[0] * drive).collect();
    let protocol = Protocol::new(protocol.times().to_vec(), drive)?;
    let experiment = Experiment::new(protocol, Arc::clone(tip)).with_spring(0.1)?;
    Curve::new(experiment, force.iter().map(|force| units[1] * force).collect())
}

#[test]
fn columns_are_found_by_name_and_scaled_by_unit() -> Result<()> {
    let tip = ElasticStates::sphere(5.0e-6)?;
    let (protocol, force) = force_curve(&tip)?;
    let mut text = String::from("# exported\n\nDefl (nm),Time [ms],ignored,Z/um,Force_pN\n");
    for (k, (time, drive)) in protocol.times().iter().zip(protocol.drive()).enumerate() {
        text += &format!("{},{},-,{},{}\n", force[k] / 0.1 * 1e9, time * 1e3, drive * 1e6, force[k] * 1e12);
    }
    let with_force = read(&text)?.spring_curve(&tip, 0.1)?;
    let with_deflection = read(&text.replace("Force_pN", "other"))?.spring_curve(&tip, 0.1)?;
    for curve in [with_force, with_deflection] {
        for (k, exact) in force.iter().enumerate() {
            assert!((curve.force()[k] - exact).abs() <= 1e-14 * exact.abs());
            assert!((curve.experiment().protocol().drive()[k] - protocol.drive()[k]).abs() < 1e-20);
            assert!((curve.experiment().protocol().times()[k] - protocol.times()[k]).abs() < 1e-14);
        }
    }
    // blanks, decimal commas, semicolons and quotes
    let blanks = text.lines().skip(2).map(|line| line.replace(',', "  ")).collect::<Vec<_>>().join("\n");
    let columns = |recording: Recording| -> Vec<Vec<f64>> {
        let columns = [recording.force, recording.deflection, recording.drive];
        columns.into_iter().flatten().chain([recording.times]).collect()
    };
    assert_eq!(columns(read(&blanks)?), columns(read(&text)?));
    let semicolons = text.replace(',', ";").replace('.', ",").replace("Defl (nm)", "\"Defl (nm)\"");
    let format = TextFormat::default().with_decimal_comma(true);
    let semicolons = Recording::from_csv_reader(semicolons.as_bytes(), format)?;
    assert_eq!(columns(semicolons), columns(read(&text)?));
    Ok(())
}

#[test]
fn errors_of_files_name_the_line() {
    let cases = [
        ("1,2,3\n4,5,6\n", "line 1: not exactly one heading names the time"),
        ("t [s],z [nm]\n", "line 1: not exactly one heading names the force"),
        ("#\n\nt [s],F [nN]\n", "line 3: not exactly one heading names the drive"),
        ("t [s],time [s],z [nm],F [nN]\n", "names the time: 1 \"t [s]\", 2 \"time [s]\" (headings: t [s], time [s]"),
        (
            "t [s],z,F [nN]\n",
            "the heading \"z\" has no unit of the drive, or an ambiguous one; write it in brackets, as in '[m]'",
        ),
        ("t [s],z [nm],F [V]\n", "the heading \"F [V]\" has no unit of the force"),
        ("t [s],z [nm],F [nN]\n1,2,3\n# gap\n2,3\n", "line 4: 2 columns separated by commas, but 3 are needed"),
        ("t [s],z [nm],F [nN]\n1,2,3\n\n2,3,x\n", "line 4, column 3: \"x\" is not a number"),
        ("t [s];z [nm];F [nN]\n1;2,000;3,500\n", "decimal_comma"),
        ("t [s],z [nm],F [nN]\n1,2,NaN\n", "line 2, column 3: \"NaN\" is not a number"),
        ("t [s],z [nm],F [nN]\n1,2,3\n1,2,4\n", "line 3: the time 1.0 s follows 1.0 s"),
        ("", "line 1: not exactly one heading names the time"),
    ];
    for (text, expected) in cases {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
    let missing = Recording::from_csv("/nonexistent/curve.csv", TextFormat::default()).expect_err("no file");
    assert!(missing.to_string().contains("/nonexistent/curve.csv"), "{missing}");
}

#[test]
fn columns_that_a_curve_needs_are_named() -> Result<()> {
    let tip = ElasticStates::sphere(5.0e-6)?;
    let recording = read("t [s],z [nm],deflection [nm]\n1,2,3\n2,3,4\n")?;
    for (curve, column) in [
        (recording.depth_curve(&tip), "depth"),
        (read("t [s],depth [nm],deflection [nm]\n")?.depth_curve(&tip), "force"),
        (read("t [s],depth [nm],F [nN]\n")?.spring_curve(&tip, 0.1), "drive"),
    ] {
        let error = curve.expect_err(column);
        assert!(matches!(error, Error::NoColumn { column: found, .. } if found == column), "{error}");
    }
    assert!(matches!(
        recording.spring_curve(&tip, 0.1),
        Err(Error::Contact(ContactError::CountOutOfRange { value: 2, .. }))
    ));
    Ok(())
}

/// Clean and noisy curves pass, up to noise of a fifth of the force; each fault is found under the same noise.
#[test]
fn faults_of_a_curve_are_told_apart_under_noise() -> Result<()> {
    let tip = ElasticStates::sphere(5.0e-6)?;
    let (protocol, force) = force_curve(&tip)?;
    let greatest = force.iter().copied().fold(0.0, f64::max);
    for (seed, noise) in (0_u64..).zip([0.0, 0.001, 0.01, 0.1, 0.2].into_iter().flat_map(|noise| [noise; 20])) {
        let mut rng = generator(seed);
        let noisy: Vec<f64> = force.iter().map(|force| force + noise * greatest * normal(&mut rng)).collect();
        let check = |units: [f64; 2]| curve(&protocol, &noisy, &tip, units)?.check();
        check([1.0; 2]).unwrap_or_else(|error| panic!("noise {noise}, seed {seed}: {error}"));
        let [force, drive, both_1000] = [check([1.0, -1.0]), check([-1.0, 1.0]), check([1e3, 1e3])];
        assert!(matches!(force, Err(Error::ForceFlipped { .. })), "noise {noise}: {force:?}");
        assert!(matches!(drive, Err(Error::DriveFlipped { .. })), "noise {noise}: {drive:?}");
        assert!(matches!(both_1000, Err(Error::DepthTooLarge { .. })), "noise {noise}: {both_1000:?}");
        // a force in µN that is nN
        let soft = check([1.0, 1e3]);
        assert!(matches!(soft, Err(Error::SpringTooSoft { .. })), "noise {noise}: {soft:?}");
    }
    Ok(())
}

fn check_seeds() -> u64 {
    from_environment("CHECK_SEEDS", 40)
}

/// Noise of a tenth of the greatest of these forces.
fn tenth(force: &[f64], correlation: f64, seed: u64) -> Vec<f64> {
    let (greatest, rng) = (force.iter().copied().fold(0.0, f64::max), &mut generator(seed));
    let mut noise = correlated(correlation, rng);
    force.iter().map(|_| 0.1 * greatest * noise()).collect()
}

/// Of curves of each correlation at most one in 100 of noise alone passes, beyond three deviations of that count,
/// and every contact in noise of a tenth of the force.
#[test]
fn contacts_are_told_from_noise_white_or_correlated() -> Result<()> {
    let seeds = check_seeds();
    let tip = ElasticStates::sphere(5.0e-6)?;
    let (protocol, force) = force_curve(&tip)?;
    for correlation in [0.0, 0.5, 0.8, 0.9, 0.95, 0.98] {
        let (mut passed, mut refused) = (0, 0);
        for seed in 0..seeds {
            let noise = tenth(&force, correlation, seed);
            let alone = curve(&protocol, &noise, &tip, [1.0; 2])?.check();
            let contact: Vec<f64> = force.iter().zip(&noise).map(|(force, noise)| force + noise).collect();
            passed += u64::from(alone.is_ok());
            refused += u64::from(curve(&protocol, &contact, &tip, [1.0; 2])?.check().is_err());
            if correlation == 0.0 {
                assert!(matches!(alone, Err(Error::NoContact { .. })), "{alone:?}");
            }
        }
        println!("φ = {correlation}: of {seeds}, {passed} of noise pass and {refused} contacts are refused");
        let most = 0.01 * seeds as f64;
        assert!(seeds > 0 && passed as f64 <= most + 3.0 * most.sqrt(), "φ = {correlation}: {passed} of {seeds}");
        assert_eq!(refused, 0, "φ = {correlation}");
    }
    Ok(())
}

/// Random materials, tips and protocols, most of a few hundred samples: all are contacts without noise and with noise of a hundredth of
/// the force; with a tenth about one in 40 is refused, and about one in 40 of noise alone passes (35 of 1000 at a correlation of 0.98), within three
/// deviations of these counts.
#[test]
fn contacts_of_any_kind_are_no_noise() {
    let seeds = check_seeds();
    for correlation in [0.0, 0.5, 0.8, 0.9, 0.95, 0.98] {
        let (mut passed, mut refused) = (0, 0);
        for seed in 0..seeds {
            let scene = scene(seed);
            let known = scene.identification.clone().contact_point(Nuisance::Fixed(scene.contact_point));
            let force = exact(&known, scene.experiment.clone(), &scene.named()).force().to_vec();
            let noise = tenth(&force, correlation, seed);
            let noisy = force.iter().zip(&noise).map(|(force, noise)| force + noise).collect();
            let check = |force: Vec<f64>| Curve::new(scene.experiment.clone(), force).unwrap().check();
            let is_refused = |force| matches!(check(force), Err(Error::NoContact { .. }));
            refused += u64::from(is_refused(noisy));
            let slightly = force.iter().zip(&noise).map(|(force, noise)| force + 0.1 * noise).collect();
            assert!(!is_refused(force) && !is_refused(slightly), "scene {seed}, φ = {correlation}");
            passed += u64::from(check(noise).is_ok());
        }
        println!("φ = {correlation}: of {seeds} scenes, {passed} of noise pass and {refused} contacts are refused");
        let most = 0.025 * seeds as f64;
        for count in [passed, refused] {
            assert!(seeds > 0 && count as f64 <= most + 3.0 * most.sqrt(), "φ = {correlation}: {count} of {seeds}");
        }
    }
}

#[test]
fn curves_that_do_not_fit_the_tip_are_refused() -> Result<()> {
    let tip = ElasticStates::sphere(5.0e-6)?;
    let (protocol, force) = force_curve(&tip)?;
    // a swept tip has a last state
    let swept = Sweep::new(Grid::square(32, 6.0e-6)?, &Sphere::new(5.0e-6)?).run(Reach::Approach(0.5e-6))?;
    let beyond = curve(&protocol, &force, &swept, [1.0; 2])?.check();
    assert!(matches!(beyond, Err(Error::BeyondStates { .. })), "{beyond:?}");
    // a depth in nm read as pm, without a spring
    let depths: Vec<f64> =
        protocol.drive().iter().zip(&force).map(|(drive, force)| 1e-9 * (drive - force / 0.1)).collect();
    let experiment = Experiment::new(Protocol::new(protocol.times().to_vec(), depths)?, Arc::clone(&tip));
    let modulus = Curve::new(experiment, force.iter().map(|force| 1e3 * force).collect())?.check();
    assert!(matches!(modulus, Err(Error::Modulus { .. })), "{modulus:?}");
    Ok(())
}

/// A relaxation after a jump, a contact that begins at the first point, a fluid that relaxes to nothing, adhesion stronger than
/// the load.
#[test]
fn unusual_curves_pass() -> Result<()> {
    let tip = ElasticStates::sphere(5.0e-6)?;
    let times: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
    let check = |drive: &dyn Fn(f64) -> f64, force: &dyn Fn(f64) -> f64| {
        let drive = times.iter().map(|&t| drive(t)).collect();
        let experiment = Experiment::new(Protocol::new(times.clone(), drive)?, Arc::clone(&tip));
        Curve::new(experiment, times.iter().map(|&t| 1e-9 * force(t)).collect())?.check()
    };
    check(&|_| 1e-6, &|t| 1.0 + (-t).exp())?;
    check(&|t| 1e-6 * t.min(0.05) / 0.05, &|t| if t < 0.05 { 0.0 } else { 1.0 + (-t).exp() })?;
    check(&|t| 1e-7 * t, &|t| t.powf(1.5))?;
    check(&|t| 1e-6 * t.min(1.0), &|t| t.powf(1.5).min(1.0) * (-(t - 1.0).max(0.0)).exp())?;
    let triangle = |t: f64| 1e-7 * (5.0 - (t - 5.0).abs() - 2.0);
    check(&triangle, &|t| {
        let depth = 1e7 * triangle(t);
        if depth > 0.0 {
            depth.powf(1.5)
        } else if t > 5.0 && depth > -1.0 {
            15.0 * depth
        } else {
            0.0
        }
    })?;
    Ok(())
}
