//! Where a search begins: the contact point by an elastic fit of the loading, the material by a coarse grid.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::parameters::{Kind, Parameter, Property};
use crate::problem::Problem;

/// Searches at most.
const STARTS: usize = 4;
/// Change of the moduli at which they are scaled to the data.
const ENOUGH: f64 = 1e-3;
/// Rounds in which moduli are scaled to the data: through a spring, forces are not proportional to them.
const ROUNDS: usize = 3;
/// Values of a time, between the shortest interval and the length of the curve.
const TIMES: usize = 6;

/// Coordinates from which searches may begin, best first.
pub(crate) fn starts(problem: &Problem) -> Result<Vec<Vec<f64>>> {
    let initial = |parameter: &Parameter| match (parameter.given, parameter.kind) {
        (Some(value), _) => value,
        (None, Kind::Measurement(Property::Stiffness, curve)) => {
            problem.parts[curve.unwrap_or_default()].curve.experiment.stiffness
        }
        (None, _) => 0.0,
    };
    let mut values: Vec<f64> = problem.parameters.iter().map(initial).collect();
    // a body softer than an elastic one would let the tip deeper than it was, perhaps beyond its last elastic state
    let mut reference = 0.0_f64;
    for (curve, part) in problem.parts.iter().enumerate() {
        let give = 1.0 / problem.stiffness(curve, &values);
        let find = |property: Property| {
            problem.parameters.iter().position(|of| of.is_free && of.kind == Kind::Measurement(property, Some(curve)))
        };
        let has_offset = find(Property::Offset).is_some();
        if let Some(at) = find(Property::ContactPoint).filter(|&at| problem.parameters[at].given.is_none()) {
            values[at] = part.curve.elastic_contact_point(give, has_offset);
        }
        let [_, modulus, _] = part.curve.elastic_law(problem.contact_point(curve, &values), give, has_offset);
        reference = reference.max(modulus);
    }
    let unit = if reference > 0.0 { reference } else { 1.0 };
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut failure = Error::NoContact { curve: 0 };
    for candidate in candidates(problem.model, problem.window) {
        for ((value, parameter), size) in values.iter_mut().zip(&problem.parameters).zip(candidate) {
            *value = parameter.given.unwrap_or(if is_modulus(&parameter.name) { size * unit } else { size });
        }
        match scaled(problem, &mut values) {
            Ok(sum) if sum.is_finite() => found.push((sum, values.clone())),
            Ok(_) => {}
            Err(error) => failure = error,
        }
    }
    if found.is_empty() {
        return Err(failure);
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(found.into_iter().take(STARTS).map(|(_, values)| problem.coordinates(&values)).collect())
}

fn is_modulus(name: &str) -> bool {
    name.starts_with('E')
}

/// Scales the free moduli to the data in some rounds; returns the sum of squared deviations: after the last scaling, if forces are
/// proportional to the moduli, and before it where a modulus is given.
fn scaled(problem: &Problem, values: &mut [f64]) -> Result<f64> {
    let mut sum = f64::INFINITY;
    for _ in 0..ROUNDS {
        // of E0 and Einf, the one that is free may be beyond the other
        let prony = problem.prony(values).or_else(|_| {
            values.copy_from_slice(&problem.values(&problem.coordinates(values)));
            problem.prony(values)
        })?;
        let (mut product, mut square, mut data_square) = (0.0, 0.0, 0.0);
        for (curve, part) in problem.parts.iter().enumerate() {
            let samples = problem.samples(curve, values, &prony)?;
            for (sample, data) in samples.iter().zip(problem.bare(curve, values)) {
                let (force, data) = (part.scale * sample.force, part.scale * data);
                product += force * data;
                square += force * force;
                data_square += data * data;
            }
        }
        let factor = product / square;
        if !(factor.is_finite() && factor > 0.0) {
            return Ok(f64::INFINITY);
        }
        let mut reached = factor;
        for (value, parameter) in values.iter_mut().zip(&problem.parameters).filter(|(_, of)| is_modulus(&of.name)) {
            match parameter.given {
                None => *value *= factor,
                Some(_) => reached = 1.0,
            }
        }
        sum = data_square - reached * (2.0 * product - reached * square);
        if (factor - 1.0).abs() < ENOUGH {
            break;
        }
    }
    Ok(sum)
}

/// Parameters of a model on a coarse grid, in units of a modulus.
fn candidates(model: Model, [shortest, longest]: [f64; 2]) -> Vec<Vec<f64>> {
    let [low, high] = [(2.0 * shortest).ln(), longest.ln()];
    let time = |k: f64| (low + (high - low) * k).exp();
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
    // other moduli are in units of the first
    let first = names.iter().position(|name| is_modulus(name));
    let values = |index: usize| -> Vec<f64> {
        match names[index].as_str() {
            _ if Some(index) == first => vec![1.0],
            name if is_modulus(name) => ratios.to_vec(),
            name if name.starts_with("tau") => (0..TIMES).map(|k| time((k as f64 + 0.5) / TIMES as f64)).collect(),
            _ if has_times => vec![0.35, 0.7],
            _ => vec![0.03, 0.1, 0.2, 0.35, 0.5, 0.75],
        }
    };
    (0..names.len()).fold(vec![vec![]], |grid, index| {
        let values = values(index);
        grid.iter().flat_map(|first| values.iter().map(move |&value| [&first[..], &[value]].concat())).collect()
    })
}
