//! Where a search begins: the contact point by an elastic fit of the loading, the material by a coarse grid.

use crate::error::{Error, Result};
use crate::experiment::Experiment;
use crate::model::Model;
use crate::parameters::Kind;
use crate::problem::Problem;

/// The variance of a force without contact is above the square of its scatter by less than this over the root of the number of samples:
/// six deviations of their ratio if the noise is white (J. von Neumann, 1941).
const NO_CONTACT: f64 = 11.0;
/// Contact points tried at first, and then between the neighbours of the best.
const CONTACT_POINTS: usize = 24;
/// Searches at most.
const STARTS: usize = 4;
/// Values of a time, between the shortest interval and the length of the curve.
const TIMES: usize = 6;

/// Coordinates from which searches may begin, best first.
pub(crate) fn starts(problem: &Problem) -> Result<Vec<Vec<f64>>> {
    let initial = |parameter: &crate::parameters::Parameter| match (parameter.given, parameter.kind) {
        (Some(value), _) => value,
        (None, Kind::Stiffness) => problem.parts[0].experiment.stiffness,
        (None, _) => 0.0,
    };
    let mut values: Vec<f64> = problem.parameters.iter().map(initial).collect();
    for (curve, part) in problem.parts.iter().enumerate() {
        let at = problem.parameters.iter().position(|p| p.kind == Kind::ContactPoint(curve));
        if let Some(at) = at.filter(|&at| problem.parameters[at].given.is_none()) {
            let has_offset = problem.parameters.iter().any(|p| p.kind == Kind::Offset(curve) && p.is_free);
            let give = 1.0 / problem.stiffness(curve, &values);
            values[at] = contact_point(&part.experiment, &part.data, give, has_offset);
        }
    }
    let reference = elastic_modulus(problem, &values);
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut failure = None;
    for candidate in candidates(problem.model, problem.window) {
        for (k, value) in candidate.iter().enumerate() {
            let unit = if is_modulus(&problem.parameters[k].name) { reference } else { 1.0 };
            values[k] = problem.parameters[k].given.unwrap_or(value * unit);
        }
        match scaled(problem, &mut values) {
            Ok(sum) if sum.is_finite() => found.push((sum, problem.coordinates(&values))),
            Ok(_) => {}
            Err(error) => failure = Some(error),
        }
    }
    if found.is_empty() {
        return Err(failure.unwrap_or(Error::NoContact { curve: 0 }));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(STARTS);
    Ok(found.into_iter().map(|(_, coordinates)| coordinates).collect())
}

fn is_modulus(name: &str) -> bool {
    name.starts_with('E')
}

/// The modulus of an elastic body that fits the forces best, at the depths that a spring leaves of the drive: a softer body would let
/// the tip deeper than it was, perhaps beyond its last elastic state.
fn elastic_modulus(problem: &Problem, values: &[f64]) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for (curve, part) in problem.parts.iter().enumerate() {
        let tip = &part.experiment.tip;
        let point = problem.value_of(values, Kind::ContactPoint(curve)).unwrap_or_default();
        let give = 1.0 / problem.stiffness(curve, values);
        for (z, force) in part.experiment.protocol.drive().iter().zip(&part.data) {
            let depth = z - point - give * force.max(0.0);
            let elastic = part.scale * if depth > 0.0 { tip.level_at(tip.approach(0.0) + depth) } else { 0.0 };
            if elastic.is_finite() {
                (product, square) = (product + elastic * part.scale * force, square + elastic * elastic);
            }
        }
    }
    let modulus = product / square;
    if modulus.is_finite() && modulus > 0.0 { modulus } else { 1.0 }
}

/// Refuses curves without contact.
pub(crate) fn check_contact(problem: &Problem) -> Result<()> {
    let is_flat = |data: &[f64]| {
        let count = data.len() as f64;
        let mean = data.iter().sum::<f64>() / count;
        let variance = data.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / count;
        variance <= (1.0 + NO_CONTACT / count.sqrt()) * scatter(data).powi(2)
    };
    let flat = problem.parts.iter().position(|part| is_flat(&part.data));
    flat.map_or(Ok(()), |curve| Err(Error::NoContact { curve }))
}

/// Standard deviation of the noise, from second differences.
pub(crate) fn scatter(data: &[f64]) -> f64 {
    let differences = data.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2));
    (differences.sum::<f64>() / (6.0 * data.len().saturating_sub(2).max(1) as f64)).sqrt()
}

/// Scales the free moduli to the data; returns the sum of squared deviations.
fn scaled(problem: &Problem, values: &mut [f64]) -> Result<f64> {
    // with a spring, the force is not proportional to the moduli
    let is_stiff = (0..problem.parts.len()).all(|curve| problem.stiffness(curve, values) == f64::INFINITY);
    let rounds = if is_stiff { 1 } else { 2 };
    let mut sum = f64::INFINITY;
    for round in 0..=rounds {
        let prony = problem.prony(values)?;
        let (mut product, mut square, mut data_square) = (0.0, 0.0, 0.0);
        for (curve, part) in problem.parts.iter().enumerate() {
            let samples = problem.samples(curve, values, &prony)?;
            let rest: Vec<f64> = problem.measured(curve, values, samples.iter().map(|_| 0.0));
            for ((sample, data), rest) in samples.iter().zip(&part.data).zip(rest) {
                let (force, data) = (part.scale * sample.force, part.scale * (data - rest));
                product += force * data;
                square += force * force;
                data_square += data * data;
            }
        }
        let factor = product / square;
        if round == rounds {
            sum = if is_stiff { sum } else { data_square - 2.0 * product + square };
            break;
        }
        if !(factor.is_finite() && factor > 0.0) {
            return Ok(f64::INFINITY);
        }
        sum = data_square - product * factor;
        for (value, parameter) in values.iter_mut().zip(&problem.parameters) {
            if is_modulus(&parameter.name) && parameter.given.is_none() {
                *value *= factor;
            }
        }
        if is_stiff {
            break;
        }
    }
    Ok(sum)
}

/// Parameters of a model on a coarse grid, in units of a modulus.
fn candidates(model: Model, [shortest, longest]: [f64; 2]) -> Vec<Vec<f64>> {
    let [low, high] = [(2.0 * shortest).ln(), longest.ln()];
    let time = |k: f64| (low + (high - low) * k).exp();
    let times = || (0..TIMES).map(move |k| time((k as f64 + 0.5) / TIMES as f64));
    let ratios = [0.6, 0.2, 0.04];
    if let Model::Prony(terms) = model {
        // the times spread over the whole range, or over a part of it
        let spreads = [(0.05, 0.95), (0.05, 0.6), (0.4, 0.95)];
        let grid = ratios.iter().flat_map(|&ratio| spreads.map(move |spread| (ratio, spread)));
        let spread = |(ratio, (from, to)): (f64, (f64, f64))| {
            let each = (1.0 - ratio) / terms.max(1) as f64;
            let place = |k: usize| from + (to - from) * (k as f64 + 0.5) / terms as f64;
            std::iter::once(ratio).chain((0..terms).flat_map(|k| [each, time(place(k))])).collect()
        };
        return grid.map(spread).collect();
    }
    let names = model.parameters();
    let has_times = names.iter().any(|name| name.starts_with("tau"));
    let values = |index: usize| -> Vec<f64> {
        match names[index].as_str() {
            _ if index == 0 => vec![1.0],
            name if is_modulus(name) => ratios.to_vec(),
            name if name.starts_with("tau") => times().collect(),
            _ if has_times => vec![0.35, 0.7],
            _ => vec![0.03, 0.1, 0.2, 0.35, 0.5, 0.75],
        }
    };
    (0..names.len()).fold(vec![vec![]], |grid, index| {
        let values = values(index);
        grid.iter().flat_map(|first| values.iter().map(move |&value| [&first[..], &[value]].concat())).collect()
    })
}

/// The contact point for which an elastic law, with an offset if there is one, fits the loading best.
fn contact_point(experiment: &Experiment, data: &[f64], give: f64, has_offset: bool) -> f64 {
    let drive = experiment.protocol.drive();
    let last = (0..data.len()).max_by(|&a, &b| data[a].total_cmp(&data[b])).unwrap_or(0);
    let lowest = drive[..=last].iter().copied().fold(f64::INFINITY, f64::min);
    let tip = &experiment.tip;
    let rest = tip.approach(0.0);
    let misfit = |point: f64| {
        // sums of 1, f, f², F, F², f F
        let mut sums = [0.0; 6];
        for (z, force) in drive[..=last].iter().zip(data) {
            let depth = z - point - give * force.max(0.0);
            let elastic = if depth > 0.0 { tip.level_at(rest + depth) } else { 0.0 };
            if elastic.is_nan() {
                return f64::INFINITY;
            }
            let terms = [1.0, elastic, elastic * elastic, *force, force * force, elastic * force];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        let [count, f, ff, y, yy, fy] = sums;
        let (ff, yy, fy) =
            if has_offset { (ff - f * f / count, yy - y * y / count, fy - f * y / count) } else { (ff, yy, fy) };
        if ff > 0.0 && fy > 0.0 { yy - fy * fy / ff } else { f64::INFINITY }
    };
    let (mut low, mut high) = (lowest, drive[last]);
    let mut best = low;
    for _ in 0..3 {
        let at = |k: usize| low + (high - low) * k as f64 / CONTACT_POINTS as f64;
        let k = (0..CONTACT_POINTS).min_by(|&a, &b| misfit(at(a)).total_cmp(&misfit(at(b)))).unwrap_or(0);
        best = at(k);
        (low, high) = (at(k.saturating_sub(1)), at(k + 1));
    }
    best
}
