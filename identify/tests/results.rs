use std::sync::atomic::{AtomicUsize, Ordering};

use viscocontact::Error as ContactError;
use viscocontact::states::ElasticStates;
use viscocontact_identify::{
    Curve, Error, Experiment, Fit, FitWarning, Identification, Model, Nuisance, Protocol, Result, Summary,
};

use crate::random::{generator, noisy, normal};

/// A map of six curves, one of which has no contact.
#[test]
fn each_curve_of_a_map_is_fitted_as_if_alone() -> Result<()> {
    let experiment =
        Experiment::new(Protocol::trapezoid(1.0e-6, [0.5, 2.0, 0.5], 0.05)?, ElasticStates::sphere(5.0e-6)?);
    let zener = Identification::new(Model::Zener);
    let mut rng = generator(9);
    let mut map = Vec::new();
    for k in 0..6 {
        let modulus = if k == 2 { 1.0e-3 } else { 1.0e3 * f64::from(k + 1) };
        let body = [("E0", modulus), ("Einf", 0.3 * modulus), ("tau", 0.4)];
        map.push(noisy(&zener, experiment.clone(), &body, |_| 1.0e-10 * normal(&mut rng)));
    }
    let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let fits = zener.fit_each(&map, |fit| {
        done.fetch_add(1, Ordering::Relaxed);
        failed.fetch_add(usize::from(fit.is_err()), Ordering::Relaxed);
    });
    assert_eq!((fits.len(), done.into_inner(), failed.into_inner()), (6, 6, 1));
    for (k, fit) in fits.iter().enumerate() {
        match (fit, zener.fit(std::slice::from_ref(&map[k]))) {
            (Ok(fit), Ok(alone)) => assert_eq!(fit.estimates(), alone.estimates()),
            (Err(fit), Err(alone)) => assert!(*fit == alone && k == 2, "{fit}"),
            (fit, alone) => panic!("curve {k}: {fit:?}, alone {alone:?}"),
        }
    }
    Ok(())
}

/// Springs, contact points and starts of each curve, fitted one by one and together.
#[test]
fn each_curve_has_its_own_spring_contact_point_and_start() -> Result<()> {
    let (springs, points, moduli) = ([0.02, 0.2], [0.0, 2.0e-7], [1.0e3, 4.0e3]);
    let zener = Identification::new(Model::Zener);
    let curve = |k: usize, modulus: f64| {
        let protocol = Protocol::trapezoid(1.0e-6, [0.5, 2.0, 0.5], 0.02)?;
        let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?).with_spring(springs[k])?;
        let at = zener.clone().contact_point(Nuisance::Fixed(points[k]));
        let exact = at.respond(&experiment, &[("E0", modulus), ("Einf", 0.3 * modulus), ("tau", 0.4)])?;
        // the spring of the experiment is another one
        Curve::new(experiment.with_spring(1.0)?, exact.iter().map(|sample| sample.force).collect())
    };
    let fixed = |of: [f64; 2]| of.map(Nuisance::Fixed).to_vec();
    let fitting = zener.clone().stiffness(fixed(springs)).contact_point(fixed(points));
    let found = |fit: &Fit| fit.estimate("E0").expect("a modulus").value;
    let joint = fitting.fit(&[curve(0, moduli[0])?, curve(1, moduli[0])?])?;
    assert!((found(&joint) / moduli[0] - 1.0).abs() < 1e-6, "{joint}");
    let starts = fitting.parameter("E0", moduli.map(|modulus| Nuisance::FittedFrom(1.2 * modulus)).to_vec());
    for (fit, modulus) in starts.fit_each(&[curve(0, moduli[0])?, curve(1, moduli[1])?], |_| ()).into_iter().zip(moduli)
    {
        assert!((found(&fit?) / modulus - 1.0).abs() < 1e-6);
    }
    // a list that is too short, and a name of nothing
    let short = starts.fit_each(&[curve(0, moduli[0])?, curve(1, moduli[1])?, curve(0, moduli[0])?], |_| ());
    assert!(matches!(short[2], Err(Error::Contact(ContactError::WrongLength { .. }))), "{:?}", short[2]);
    // and one that is too long
    let long = zener.clone().contact_point(vec![Nuisance::Fitted; 3]);
    let curves = [curve(0, moduli[0])?, curve(1, moduli[1])?];
    let each = long.fit_each(&curves, |_| ());
    assert!(
        each.iter()
            .all(|fit| matches!(fit, Err(Error::Contact(ContactError::WrongLength { len: 3, expected: 2, .. })))),
        "{each:?}"
    );
    assert!(matches!(long.fit(&curves), Err(Error::Contact(ContactError::WrongLength { len: 3, expected: 2, .. }))));
    // values without a coordinate, known or as a start
    for (name, values) in
        [("stiffness", [0.0, -0.1]), ("E0", [0.0, -1.0]), ("tau", [0.0, f64::NAN]), ("contact point", [f64::NAN; 2])]
    {
        for of in values.into_iter().flat_map(|value| [Nuisance::Fixed(value), Nuisance::FittedFrom(value)]) {
            let with = zener.clone().parameter(name, of);
            let experiment = curve(0, moduli[0])?.experiment().clone();
            let body = [("E0", 1.0e3), ("Einf", 3.0e2), ("tau", 0.4)];
            for refused in [with.fit(&[curve(0, moduli[0])?]).map(drop), with.respond(&experiment, &body).map(drop)] {
                let is_named = match &refused {
                    Err(Error::ParameterOutOfRange { name: named, .. }) => named == name,
                    Err(Error::Contact(ContactError::OutOfRange { field, .. })) => field.ends_with(name),
                    _ => false,
                };
                assert!(is_named, "{name} {of:?}: {refused:?}");
            }
        }
    }
    let nothing = zener.clone().parameter("colour", Nuisance::Fitted).fit(&[curve(0, moduli[0])?]);
    assert!(matches!(nothing, Err(Error::UnknownParameter { .. })));
    let warning = FitWarning::AtLimit { parameter: "Einf".into(), limit: "Einf = 0: no equilibrium" };
    assert!(warning.to_string().contains("take the simpler model"), "{warning}");
    Ok(())
}

/// Fits of a noisy curve.
fn fits() -> Result<[Fit; 3]> {
    let experiment =
        Experiment::new(Protocol::trapezoid(1.0e-6, [0.5, 2.0, 0.5], 0.01)?, ElasticStates::sphere(5.0e-6)?);
    let zener = Identification::new(Model::Zener);
    let (body, mut rng) = ([("E0", 2.0e3), ("Einf", 5.0e2), ("tau", 0.4)], generator(5));
    let curve = [noisy(&zener, experiment, &body, |_| 1.0e-10 * normal(&mut rng))];
    let fit = |model: Model| Identification::new(model).fit(&curve);
    Ok([zener.fit(&curve)?, fit(Model::PowerLaw { cutoff: 1.0e-4 })?, fit(Model::Stretched)?])
}

#[test]
fn a_table_holds_every_parameter_to_the_last_bit() -> Result<()> {
    let summaries = fits()?.map(|fit| fit.summary());
    let mut text = Vec::new();
    Summary::write_csv(&summaries, &mut text)?;
    let mut table = csv::Reader::from_reader(text.as_slice());
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let expected =
        summaries.iter().flat_map(|summary| summary.estimates.iter().map(move |estimate| (summary, estimate)));
    assert_eq!(rows.len(), 9);
    for (row, (summary, estimate)) in rows.iter().zip(expected) {
        let number = |column: usize| row[column].parse::<f64>().expect("a number");
        assert_eq!((&row[0], &row[2]), (summary.model.to_string().as_str(), estimate.name.as_str()));
        assert_eq!([number(1), number(3), number(5)], [summary.aicc, estimate.value, estimate.deviation]);
        assert_eq!([number(7), number(8)], estimate.interval);
    }
    let units: Vec<&str> = rows.iter().map(|row| &row[4]).collect();
    assert_eq!(units, ["Pa", "Pa", "s", "Pa", "1", "Pa", "Pa", "s", "1"]);
    assert_eq!((&rows[0][0], &rows[4][0]), ("Zener", "PowerLaw"));
    // the power law misses these data
    assert!(rows[0][9].is_empty() && rows[4][9].contains("residuals"), "{rows:?}");
    Ok(())
}

#[test]
fn a_table_that_cannot_be_written_is_an_error() -> Result<()> {
    /// A full disk.
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("no space left"))
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let summaries = fits()?.map(|fit| fit.summary());
    let error = Summary::write_csv(&summaries, Full).expect_err("the disk is full");
    assert!(matches!(&error, Error::Unwritable { reason } if reason.contains("no space left")), "{error}");
    Ok(())
}

#[cfg(feature = "serde")]
#[test]
fn json_has_the_same_numbers() -> Result<()> {
    let summaries = fits()?.map(|fit| fit.summary());
    let mut text = Vec::new();
    Summary::write_json(&summaries, &mut text)?;
    let read: serde_json::Value = serde_json::from_slice(&text).expect("valid JSON");
    // the reader rounds the last bit
    let same =
        |read: &serde_json::Value, value: f64| read.as_f64().is_some_and(|read| (read / value - 1.0).abs() < 4e-16);
    for (read, summary) in read.as_array().expect("an array").iter().zip(&summaries) {
        assert!(same(&read["aicc"], summary.aicc));
        for (read, estimate) in read["estimates"].as_array().expect("an array").iter().zip(&summary.estimates) {
            assert_eq!(read["name"].as_str(), Some(estimate.name.as_str()));
            assert!(same(&read["value"], estimate.value) && same(&read["interval"][1], estimate.interval[1]), "{read}");
        }
    }
    Ok(())
}

#[cfg(feature = "plot")]
#[test]
fn pictures_show_each_curve_and_refuse_others() -> Result<()> {
    let [fit, ..] = fits()?;
    let picture = fit.picture(0)?;
    assert_eq!(picture.size(), [3600, 800]);
    // all of it is not one colour
    assert!(picture.rgb().chunks(3).any(|pixel| pixel != &picture.rgb()[..3]));
    assert!(matches!(fit.picture(1), Err(Error::Contact(ContactError::CountOutOfRange { value: 1, .. }))));
    Ok(())
}
