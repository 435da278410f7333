//! Bounds of a planned experiment.

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Experiment, Identification, Model, Nuisance, Protocol};

/// Depth 1 in unit time, held to 2, and out at unit speed: 1000 equal samples.
fn experiment() -> Experiment {
    // sampled a little beyond the loss of contact at 2.4228
    let times: Vec<f64> = (0..1000).map(|k| 2.6 * f64::from(k) / 999.0).collect();
    let drive = times.iter().map(|&t: &f64| t.min(1.0).min(3.0 - t)).collect();
    Experiment::new(Protocol::new(times, drive).unwrap(), ElasticStates::sphere(9.0 / 16.0).unwrap())
}

/// Bounds of an independent program, with noise of 1 % of the greatest force.
#[test]
fn bounds_of_a_trapezoid_agree_with_an_independent_program() {
    let expected = [("E0", 1.0), ("Einf", 0.25), ("tau", 1.0)];
    let zener = Identification::new(Model::Zener);
    let samples = zener.respond(&experiment(), &expected).unwrap();
    let sigma = 0.01 * samples.iter().fold(0.0, |most: f64, sample| most.max(sample.force));
    let known = zener.bounds(&[experiment()], &expected, sigma).unwrap();
    let fitted = zener.contact_point(Nuisance::Fitted).bounds(&[experiment()], &expected, sigma).unwrap();
    for (bounds, name, deviation) in [
        (&known, "E0", 0.00222),
        (&known, "Einf", 0.01949),
        (&known, "tau", 0.01525),
        (&fitted, "E0", 0.00429),
        (&fitted, "Einf", 0.02579),
        (&fitted, "tau", 0.01938),
        (&fitted, "contact point", 0.00136),
    ] {
        let found = bounds.deviation(name).unwrap();
        println!("{name}: {found:.6} {deviation}");
        assert!((found / deviation - 1.0).abs() < 0.004, "{name}: {found} in place of {deviation}");
    }
}
