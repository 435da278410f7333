//! Tests of the forward model.

use std::sync::Arc;

use viscocontact::load::Load;
use viscocontact::states::{ElasticStates, StatesContact};

use super::*;

fn response(tip: &Arc<ElasticStates>, prony: &Prony, times: &[f64], drive: &[f64], give: f64) -> Vec<Sample> {
    let mut samples = Vec::new();
    let push = |contact: &Cycle<PLAIN>| samples.push(contact.sample());
    let drive: Vec<Real<PLAIN>> = drive.iter().map(|&z| Real::from(z)).collect();
    Cycle::new(&prony.into(), &Tip::new(0, tip, 0.0), Real::from(give), times).follow(&drive, push).unwrap();
    samples
}

fn zener() -> Prony {
    Prony { moduli: vec![0.25, 0.75], rates: vec![0.0, 1.0] }
}

/// Up in unit time, held to 2, and out at unit speed.
fn trapezoid(t: f64) -> f64 {
    t.min(1.0).min(3.0 - t)
}

/// Times at which tables give forces, among equal samples.
fn samples(count: usize, end: f64) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

#[test]
fn one_indentation_has_the_forces_of_the_closed_equations() {
    // independent quadrature of Ting's equations, to 9 digits
    let table = [
        (0.5, 0.307_325_743),
        (1.0, 0.769_660_555),
        (2.0, 0.441_172_434),
        (2.1, 0.285_883_046),
        (2.2, 0.159_045_973),
        (2.4, 0.004_874_310_16),
    ];
    let tip = ElasticStates::sphere(9.0 / 16.0).unwrap();
    for (count, tolerance) in [(30, 2e-4), (300, 2e-6), (3000, 2e-8)] {
        let times = samples(count, 3.0);
        let drive: Vec<f64> = times.iter().map(|&t| trapezoid(t)).collect();
        let found = response(&tip, &zener(), &times, &drive, 0.0);
        for (t, force) in table {
            let k = (t * count as f64 / 3.0).round() as usize;
            let error = (found[k].force - force).abs();
            assert!(error < tolerance, "{count} samples, t = {t}: {} off by {error:e}", found[k].force);
        }
        let contact = found[2 * count / 3 + count / 30].contact_depth;
        assert!((contact - 0.797_539_416).abs() < tolerance, "t1 = {contact}");
    }
}

#[test]
fn a_spring_gives_way() {
    let table = [(0.5, 0.166160), (1.0, 0.374890), (1.5, 0.325633), (2.0, 0.289532), (2.2, 0.171695), (2.4, 0.069760)];
    let tip = ElasticStates::sphere(9.0 / 16.0).unwrap();
    let times = samples(3000, 3.0);
    let drive: Vec<f64> = times.iter().map(|&t| trapezoid(t)).collect();
    let found = response(&tip, &zener(), &times, &drive, 1.0);
    for (t, force) in table {
        let k = (t * 1000.0_f64).round() as usize;
        assert!((found[k].force - force).abs() < 2e-6, "t = {t}: {}", found[k].force);
    }
}

/// A history that rises, falls and rises again, with corners at tenths.
fn zigzag(t: f64) -> f64 {
    let corners = [0.0, 1.0, 0.55, 1.3, 1.1, 1.35, 0.2, 0.9, -0.2, 0.8, 0.8];
    let at = (2.0 * t).min(9.999_999);
    let k = at as usize;
    corners[k] + (corners[k + 1] - corners[k]) * (at - k as f64)
}

/// The force of single columns of equal width, each by its own history over fine steps: the tip whose elastic stiffness f′ is a power of the depth.
fn one_by_one(prony: &Prony, power: f64, count: usize, end: f64, columns: usize) -> Vec<f64> {
    let (step, width) = (end / count as f64, 1.4 / columns as f64);
    let decay: Vec<f64> = prony.rates.iter().map(|rate| (-rate * step).exp()).collect();
    let mean = |rate: f64| if rate == 0.0 { 1.0 } else { -(-rate * step).exp_m1() / (rate * step) };
    let unit: Vec<f64> = prony.moduli.iter().zip(&prony.rates).map(|(e, &rate)| e * mean(rate)).collect();
    let total: f64 = unit.iter().sum();
    let terms = unit.len();
    let mut states = vec![0.0; columns * terms];
    let mut surfaces: Vec<f64> = (0..columns).map(|k| (k as f64 + 0.5) * width).collect();
    let stiffness = |k: usize| (width * k as f64).powf(power);
    let weights: Vec<f64> = (0..columns).map(|k| stiffness(k + 1) - stiffness(k)).collect();
    let mut forces = vec![0.0];
    for sample in 1..=count {
        let depth = zigzag(sample as f64 * step);
        let mut force = 0.0;
        for ((state, surface), weight) in states.chunks_exact_mut(terms).zip(&mut surfaces).zip(&weights) {
            let past: f64 = state.iter().zip(&decay).map(|(q, decay)| q * decay).sum();
            // without pressure, or with the tip
            let rise = (-past / total).max(depth - *surface);
            for i in 0..terms {
                state[i] = state[i] * decay[i] + unit[i] * rise;
            }
            *surface += rise;
            force += (past + total * rise) * weight;
        }
        forces.push(force);
    }
    forces
}

#[test]
fn any_history_has_the_force_of_single_columns() {
    let prony = Prony { moduli: vec![0.2, 0.5, 0.3], rates: vec![0.0, 5.0, 0.5] };
    // f′ of a cone is in proportion to δ, of a ball to √δ
    for (tip, power) in [(ElasticStates::cone(1.0).unwrap(), 1.0), (ElasticStates::sphere(1.0).unwrap(), 0.5)] {
        let (stiffness, end) = (tip.level_at(1.0) * (1.0 + power), 5.0);
        let exact = one_by_one(&prony, power, 20_000, end, 4000);
        let greatest = exact.iter().copied().fold(0.0, f64::max);
        let mut errors = Vec::new();
        for count in [100, 200, 400, 800] {
            let times = samples(count, end);
            let drive: Vec<f64> = times.iter().map(|&t| zigzag(t)).collect();
            let found = response(&tip, &prony, &times, &drive, 0.0);
            let of = |k: usize| (found[k].force / stiffness - exact[k * 20_000 / count]).abs() / greatest;
            errors.push((0..=count).map(of).fold(0.0, f64::max));
        }
        println!("power {power}: {errors:?}");
        for (error, count) in errors.into_iter().zip([100.0, 200.0, 400.0, 800.0_f64]) {
            assert!(error < 1e-3 * (100.0 / count).powi(2) + 2e-5, "power {power}, {count} samples: {error:e}");
        }
    }
}

#[test]
fn histories_agree_with_steps_on_states() {
    for (tip, name) in [
        (ElasticStates::sphere(1.0).unwrap(), "sphere"),
        (ElasticStates::cone(0.5).unwrap(), "cone"),
        (ElasticStates::punch(0.7).unwrap(), "punch"),
    ] {
        let prony = Prony { moduli: vec![0.2, 0.5, 0.3], rates: vec![0.0, 2.0, 0.1] };
        for (give, history) in [(0.0, 0), (0.5, 0), (0.0, 1), (0.5, 1), (0.5, 2)] {
            let times = samples(2000, 3.0 + 2.0 * f64::from(history.min(1)));
            let at = |t: f64| match history {
                0 => trapezoid(t) - 0.1,
                1 => zigzag(t),
                _ => trapezoid(t) - 0.1 + 1e-3 * (t * 1777.0).sin(),
            };
            let drive: Vec<f64> = times.iter().map(|&t| at(t)).collect();
            let found = response(&tip, &prony, &times, &drive, give);
            let greatest = found.iter().fold(0.0_f64, |most, sample| most.max(sample.force));
            let material = prony.material_on(&tip).unwrap();
            let mut contact = StatesContact::new(&tip, &material).unwrap().with_merge_error(0.0).unwrap();
            let (mut worst, mut before) = (0.0_f64, 0.0);
            for (k, (&time, &z)) in times.iter().zip(&drive).enumerate() {
                let load = if give > 0.0 { Load::spring(1.0 / give, z) } else { Load::approach(z) };
                let force = contact.step(time - before, load).unwrap().force;
                let error = (force - found[k].force).abs() / greatest;
                worst = worst.max(error);
                before = time;
            }
            println!("{name}, give {give}, history {history}: {worst:.1e}");
            assert!(worst < 1e-5, "{name}, give {give}, history {history}: {worst:e}");
        }
    }
}

#[test]
fn derivatives_agree_with_differences() {
    for tip in
        [ElasticStates::sphere(1.0).unwrap(), ElasticStates::cone(0.5).unwrap(), ElasticStates::punch(0.7).unwrap()]
    {
        for (give, jitter) in [(0.0, 0.0), (0.5, 0.0), (0.0, 3e-3), (0.5, 3e-3)] {
            let times = samples(400, 5.0);
            let noise = |k: usize| jitter * (1.7 * (k * k) as f64).sin();
            let drive: Vec<f64> = times.iter().enumerate().map(|(k, &t)| zigzag(t) + noise(k)).collect();
            let at = [0.3, 0.7, 1.3, 0.0513];
            let plain = |[einf, e1, rate, contact]: [f64; 4]| {
                let prony = Prony { moduli: vec![einf, e1], rates: vec![0.0, rate] };
                let drive: Vec<f64> = drive.iter().map(|z| z - contact).collect();
                response(&tip, &prony, &times, &drive, give)
            };
            let [einf, e1, rate, contact] = [0, 1, 2, 3]
                .map(|lane| Real::<LANES>::new(at[lane], std::array::from_fn(|k| f64::from(u8::from(k == lane)))));
            let prony = Prony { moduli: vec![einf, e1], rates: vec![Real::from(0.0), rate] };
            let moved: Vec<Real<LANES>> = drive.iter().map(|&z| Real::from(z) - contact).collect();
            let mut found = Vec::new();
            let push = |contact: &Cycle<LANES>| found.push(contact.force());
            Cycle::new(&prony, &Tip::new(0, &tip, 0.0), Real::from(give), &times).follow(&moved, push).unwrap();
            let values = plain(at);
            assert!(found.iter().zip(&values).all(|(dual, plain)| dual.value() == plain.force));
            for lane in 0..4 {
                let step = 1e-6;
                let [mut up, mut down] = [at; 2];
                up[lane] += step;
                down[lane] -= step;
                let difference: Vec<f64> =
                    plain(up).iter().zip(plain(down)).map(|(a, b)| (a.force - b.force) / (2.0 * step)).collect();
                let scale = difference.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
                let mut errors: Vec<f64> =
                    found.iter().zip(&difference).map(|(dual, d)| (dual.slopes[lane] - d).abs() / scale).collect();
                if errors.iter().any(|e| *e > 1e-6) {
                    for (k, e) in errors.iter().enumerate() {
                        if *e > 1e-6 {
                            print!("{k}:{e:.1e} ");
                        }
                    }
                    println!();
                }
                errors.sort_by(f64::total_cmp);
                // at a kink, derivative and difference differ
                assert!(errors[395] < 1e-6, "give {give}, jitter {jitter}, lane {lane}: {:?}", &errors[390..]);
            }
        }
    }
}
