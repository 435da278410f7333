use viscocontact_identify::{Error, Result, TimeAtSize, Verdict};

use crate::random::{generator, normal};

/// Share of 4000 pairs of times with each verdict, where times grow as a power of the area.
fn shares(power: f64, area: f64, log_error: f64) -> Result<[f64; 4]> {
    let mut rng = generator(7);
    let (mut counts, draws) = ([0.0; 4], 4000);
    for _ in 0..draws {
        let mut at = |area: f64| TimeAtSize {
            time: 0.3 * area.powf(power) * (log_error * normal(&mut rng)).exp(),
            log_error,
            area: 1.0e-12 * area,
        };
        let verdict = at(1.0).scaling(at(area))?.verdict;
        let all = [Verdict::Creep, Verdict::Drainage, Verdict::Undecided, Verdict::Neither];
        counts[all.iter().position(|other| *other == verdict).expect("one of four")] += 1.0 / f64::from(draws);
    }
    Ok(counts)
}

/// The level of the test is 5 %: 4000 draws determine it to 0.35 %.
#[test]
fn each_hypothesis_is_rejected_in_5_percent_where_it_is_true() -> Result<()> {
    for (area, log_error) in [(4.0, 0.05), (4.0, 0.5), (0.2, 0.1)] {
        let [creep, drainage, undecided, neither] = shares(0.0, area, log_error)?;
        assert!((drainage + neither - 0.05).abs() < 0.0125, "{drainage} {neither}");
        assert!(log_error > 0.2 || creep > 0.93 && undecided == 0.0, "{creep} {undecided}");
        let [creep, drainage, undecided, neither] = shares(1.0, area, log_error)?;
        assert!((creep + neither - 0.05).abs() < 0.0125, "{creep} {neither}");
        assert!(log_error > 0.2 || drainage > 0.93 && undecided == 0.0, "{drainage} {undecided}");
    }
    Ok(())
}

#[test]
fn what_cannot_be_told_apart_is_undecided_and_a_mixture_is_neither() -> Result<()> {
    assert!(shares(0.0, 1.2, 0.5)?[2] > 0.9);
    assert!(shares(0.5, 10.0, 0.05)?[3] > 0.999);
    let time = TimeAtSize { time: 1.0, log_error: 0.1, area: 1.0 };
    for (wrong, name) in [
        (TimeAtSize { time: 0.0, ..time }, "relaxation time"),
        (TimeAtSize { log_error: f64::NAN, ..time }, "standard deviation of ln τ"),
        (TimeAtSize { area: -1.0, ..time }, "contact area"),
    ] {
        assert!(matches!(time.scaling(wrong), Err(Error::OutOfRange { field, .. }) if field == name));
    }
    Ok(())
}
