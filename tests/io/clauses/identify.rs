//! Fits of measured curves.

use std::sync::Arc;

use viscocontact::ErrorKind::Value;
use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, Identification, Law, Model, Noise, Nuisance, Protocol, tips, usual};

use super::Table;

const ZENER: [(&str, f64); 3] = [("E0", 2.0e3), ("Einf", 5.0e2), ("tau", 0.2)];

fn tip() -> Arc<ElasticStates> {
    ElasticStates::sphere(5.0e-6).unwrap()
}

/// A curve of these forces, while the drive moves straight from one position to another.
fn curve(drive: [f64; 2], force: Vec<f64>, tip: Arc<ElasticStates>) -> Curve {
    let last = (force.len() - 1) as f64;
    let times: Vec<f64> = (0..force.len()).map(|k| 0.01 * k as f64).collect();
    let drive = (0..force.len()).map(|k| drive[0] + (drive[1] - drive[0]) * k as f64 / last).collect();
    Curve::new(Experiment::new(Protocol::new(times, drive).unwrap(), tip), force).unwrap()
}

fn respond(model: Model, values: &[(&str, f64)], experiment: &Experiment) -> Curve {
    let force = Identification::new(model).respond(experiment, values).unwrap();
    Curve::new(experiment.clone(), force.iter().map(|sample| sample.force).collect()).unwrap()
}

pub fn rows(t: &mut Table) {
    let experiment = Experiment::new(Protocol::ramp_hold_retract(5.0e-6, [0.5e-6, 1.0e-6], 1.0, 0.01).unwrap(), tip());
    let zener = Identification::new(Model::Zener);

    // a law whose instantaneous modulus is beyond the range of a material
    let steep = Model::PowerLaw { cutoff: 1.0e-300 };
    let loaded = respond(steep, &[("E1", 1.0e3), ("alpha", 0.5)], &experiment);
    let fit = Identification::new(steep).fit(&[loaded]).unwrap();
    t.row("Fit::material", fit.material(), Value, "relaxing modulus = 2.50276292003e152 → 0, or in [1e-100, 1e100]");
    let infinite =
        Law { name: "infinite", parameters: &["E0", "tau"], modulus: |of, t| of[0] * (t / of[1]).powf(-0.3) };
    let custom = Identification::new(Model::Custom(infinite));
    t.row(
        "Fit::material",
        custom.respond(&experiment, &[("E0", 1.0e3), ("tau", 1.0)]),
        Value,
        "modulus of the law = -inf → finite at all times from t = 0 on",
    );

    let maps = [respond(Model::Zener, &ZENER, &experiment), curve([0.0, 1.0e-6], vec![0.0; 100], tip())];
    let lists = zener.clone().contact_point(vec![Nuisance::Fitted; 3]).fit_each(&maps, |_| {});
    t.row("fit_each", lists.into_iter().last().unwrap(), Value, "contact point: 3 values given, 2 needed");
    let [first, second] = <[_; 2]>::try_from(zener.fit_each(&maps, |_| {})).unwrap();
    assert!(first.is_ok());
    t.row("fit_each", second, Value, "curve 0: the force nowhere rises…: check the sign of the force…");

    let bounds = |of: &Identification, values: &[(&str, f64)], sigma: f64| {
        of.bounds(std::slice::from_ref(&experiment), values, sigma)
    };
    for (values, says) in [
        (vec![("E0", -4.0e3), ZENER[1], ZENER[2]], "E0 = -4000.0 → finite and > 0"),
        (vec![("E0", 1.0e2), ZENER[1], ZENER[2]], "Einf = 500.0 → at most E0"),
        (vec![ZENER[0], ZENER[1]], "the parameter 'tau' is given 0 values: give it exactly one"),
        (vec![ZENER[0], ZENER[0], ZENER[1], ZENER[2]], "the parameter 'E0' is given 2 values: give it exactly one"),
        (vec![ZENER[0], ZENER[1], ("lambda", 0.2)], "there is no parameter 'lambda': the names are E0, Einf, tau"),
        (vec![ZENER[0], ZENER[1], ("tau", f64::NAN)], "tau = NaN → finite and > 0"),
    ] {
        t.row("Identification::bounds", bounds(&zener, &values, 1.0e-11), Value, says);
        let with_zener = zener.respond(&experiment, &values);
        t.row("Identification::bounds", with_zener, Value, says);
    }
    t.row(
        "Identification::bounds",
        bounds(&zener, &ZENER, 0.0),
        Value,
        "standard deviation of the noise = 0.0 → finite and > 0",
    );
    let unknown = zener.clone().noise(Noise::Autoregressive);
    t.row(
        "Identification::bounds",
        bounds(&unknown, &ZENER, 1.0e-11),
        Value,
        "bounds need the correlation…take Noise::AutoregressiveWith",
    );
    let table_of =
        |last: f64| ElasticStates::from_table(&[(1e-15, 1e-9, 1e-7, 1e-14), (1e-12, last, 1e-6, 1e-12)]).unwrap();
    let shallow = Experiment::new(experiment.protocol().clone(), table_of(1.0e-7));
    t.row(
        "Identification::bounds",
        zener.bounds(&[shallow], &ZENER, 1.0e-11),
        Value,
        "curve 0: the depth of 1.50e-7 m is beyond…: sweep it further…",
    );

    let falling = curve([1.0e-6, 0.0], vec![1.0e-9; 50], tip());
    t.row("Curve::approach", falling.approach(), Value, "samples of the segment = 1 → 2 or more");
    for (radius, says) in [
        (0.0, "sphere radius = 0.0 → in [1e-100, 1e100] m"),
        (-1.0, "sphere radius = -1.0 → in [1e-100, 1e100] m"),
        (f64::NAN, "sphere radius = NaN → in [1e-100, 1e100] m"),
        (f64::INFINITY, "sphere radius = inf → in [1e-100, 1e100] m"),
        (1.0e200, "sphere radius = 1e200 → in [1e-100, 1e100] m"),
        (1.0e-200, "sphere radius = 1e-200 → in [1e-100, 1e100] m"),
    ] {
        t.row("tips::sphere", tips::sphere(radius), Value, says);
    }
    let rising = |count: i32| (0..count).map(|k| 1.0e-9 * f64::from(k)).collect::<Vec<_>>();
    let few = curve([0.0, 1.0e-6], rising(4), tip());
    t.row(
        "usual::loading_modulus",
        usual::loading_modulus(&few, None),
        Value,
        "a curve of 4 points is too short: at least 5 are needed…",
    );
    let deep = curve([0.0, 1.0e-6], rising(50), table_of(1.0e-7));
    t.row(
        "usual::loading_modulus",
        usual::loading_modulus(&deep, Some(0.0)),
        Value,
        "curve 0: the depth of 1.00e-6 m is beyond…: sweep it further…",
    );
    let flipped = curve([0.0, 1.0e-6], rising(50).into_iter().map(|force| -force).collect(), tip());
    t.row(
        "usual::loading_modulus",
        usual::loading_modulus(&flipped, None),
        Value,
        "curve 0: the force nowhere rises…: check the sign of the force…",
    );
}
