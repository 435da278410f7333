//! A least-squares problem: the model forces of all curves, less the measured ones, made white.

use std::cell::Cell;
use std::rc::Rc;

use faer::Mat;

use crate::error::Result;
use crate::experiment::Experiment;
use crate::forward::{Drive, Dual, Forward, LANES, Real, Response, Roots, Sample, Term};
use crate::model::Model;
use crate::noise::Whitening;
use crate::parameters::{Kind, Parameter};
use crate::protocol::Protocol;
use crate::series::Prony;

/// Least share of a modulus that relaxes.
const LEAST_SHARE: f64 = 1e-12;
/// Samples of a curve with which a search begins.
const ROUGH: usize = 128;
/// A search ends where the linearised residuals promise less than this fraction of the sum of squares; one with few samples, early.
const ENOUGH: [f64; 2] = [1e-12, 1e-4];
/// Residuals are rounding below this fraction of the squared data.
const EXACT: f64 = 1e-18;

/// One curve of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) experiment: Experiment,
    /// The measured forces; zeros where none are measured yet.
    pub(crate) data: Vec<f64>,
    pub(crate) whitening: Whitening,
    /// Weights of the residuals made white: a scale of the curve, times the weights of outliers.
    pub(crate) weights: Vec<f64>,
    pub(crate) scale: f64,
    pub(crate) outliers: Vec<f64>,
    forward: Forward,
    /// Speed of the drive at each sample \[m/s\].
    speed: Vec<f64>,
}

impl Part {
    pub(crate) fn new(experiment: &Experiment, data: Vec<f64>, whitening: Whitening) -> Part {
        let (times, drive) = (experiment.protocol.times(), experiment.protocol.drive());
        let last = times.len() - 1;
        let speed = |k: usize| {
            let [a, b] = [k.saturating_sub(1), (k + 1).min(last)];
            (drive[b] - drive[a]) / (times[b] - times[a])
        };
        let speed = (0..times.len()).map(speed).collect();
        let weights = vec![1.0; times.len()];
        let (outliers, forward) = (weights.clone(), Forward::new(&experiment.tip));
        Part { experiment: experiment.clone(), data, whitening, weights, scale: 1.0, outliers, forward, speed }
    }

    /// Means of neighbouring samples, as if their noise were white.
    fn thinned(&self) -> Part {
        let of = |values: &[f64]| -> Vec<f64> {
            let means = values.chunks(self.len().div_ceil(ROUGH));
            means.map(|chunk| chunk.iter().sum::<f64>() / chunk.len() as f64).collect()
        };
        let Protocol { times, drive } = &self.experiment.protocol;
        let protocol = Protocol { times: of(times), drive: of(drive) };
        let (data, speed, weights, outliers) = (of(&self.data), of(&self.speed), of(&self.weights), of(&self.outliers));
        let experiment = Experiment { protocol, ..self.experiment.clone() };
        let whitening = Whitening::Autoregressive(0.0);
        Part { experiment, data, whitening, weights, outliers, speed, ..self.clone() }
    }

    pub(crate) fn len(&self) -> usize {
        self.data.len()
    }

    /// Makes a column of the data white, with its weights.
    pub(crate) fn whiten(&self, column: &mut [f64]) {
        self.whitening.apply(column);
        column.iter_mut().zip(&self.weights).for_each(|(value, weight)| *value *= weight);
    }

    /// −ln of the determinant of the covariance, up to the factor σ².
    pub(crate) fn log_weight(&self) -> f64 {
        self.whitening.log_weight() + 2.0 * self.len() as f64 * self.scale.ln()
    }

    /// Force of the contact, and where the tip is, at each sample. `record` is given each with the terms of its force.
    pub(crate) fn respond<T: Real>(
        &self,
        curve: usize,
        prony: &Prony<T>,
        contact_point: T,
        stiffness: T,
        roots: &mut Roots,
        record: impl FnMut(Response<T>, &[Term<T>]),
    ) -> Result<()> {
        let protocol = &self.experiment.protocol;
        let drive: Vec<T> = protocol.drive().iter().map(|&z| T::from(z) - contact_point).collect();
        let drive = Drive { times: protocol.times(), drive: &drive };
        self.forward.respond(prony, drive, T::from(1.0) / stiffness, curve, roots, record)
    }
}

/// All curves, and the parameters of their forces.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    pub(crate) model: Model,
    pub(crate) parts: Vec<Part>,
    pub(crate) parameters: Vec<Parameter>,
    /// Shortest interval between samples and longest curve \[s\].
    pub(crate) window: [f64; 2],
    /// Fraction of the sum of squares that a search leaves.
    pub(crate) enough: f64,
    /// Exponentials that were advanced by a sample, each derivative counted.
    pub(crate) work: Rc<Cell<usize>>,
}

impl Problem {
    pub(crate) fn new(model: Model, parts: Vec<Part>, parameters: Vec<Parameter>) -> Problem {
        let times = || parts.iter().map(|part| part.experiment.protocol.times());
        let shortest = times().flat_map(|t| t.windows(2).map(|w| w[1] - w[0])).fold(f64::INFINITY, f64::min);
        let longest = times().map(|t| t[t.len() - 1] - t[0]).fold(0.0, f64::max);
        let (enough, work) = (ENOUGH[0], Rc::default());
        Problem { model, parts, parameters, window: [shortest, longest], enough, work }
    }

    /// The same problem with few samples, on which a search is cheap; `None` where there are few, or their noise is given by a matrix.
    pub(crate) fn thinned(&self) -> Option<Problem> {
        let is_long = self.parts.iter().any(|part| part.len() > ROUGH);
        let is_simple = self.parts.iter().all(|part| matches!(part.whitening, Whitening::Autoregressive(_)));
        let parts = || self.parts.iter().map(Part::thinned).collect();
        (is_long && is_simple).then(|| Problem { parts: parts(), enough: ENOUGH[1], ..self.clone() })
    }

    /// The same problem with a simpler model; `None` where parameters of the material are given.
    pub(crate) fn with_model(&self, model: Model) -> Option<Problem> {
        let is_material = |parameter: &&Parameter| matches!(parameter.kind, Kind::Material(_));
        if self.parameters.iter().filter(is_material).any(|parameter| parameter.given.is_some()) {
            return None;
        }
        let others = self.parameters.iter().filter(|parameter| !is_material(parameter)).cloned();
        let parameters = Parameter::of_material(model, &[]).into_iter().chain(others).collect();
        Some(Problem { model, parameters, ..self.clone() })
    }

    /// Values of all parameters from those of a contained model.
    pub(crate) fn of_contained(&self, inner: Model, values: &[f64]) -> Vec<f64> {
        let (material, others) = values.split_at(inner.parameters().len());
        let mut all = self.model.of_contained(inner, material, self.window[1]);
        all.extend_from_slice(others);
        all
    }

    /// The same problem with the weights of curves alone.
    pub(crate) fn without_outliers(&self) -> Problem {
        let mut problem = self.clone();
        problem.parts.iter_mut().for_each(|part| part.weights.fill(part.scale));
        problem
    }

    /// Number of samples of all curves.
    pub(crate) fn len(&self) -> usize {
        self.parts.iter().map(Part::len).sum()
    }

    /// A sum of squares that is rounding.
    pub(crate) fn rounding(&self) -> f64 {
        EXACT * self.parts.iter().flat_map(|part| &part.data).map(|force| force * force).sum::<f64>()
    }

    /// The free parameters.
    pub(crate) fn free(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|parameter| parameter.is_free)
    }

    /// Whether E0 and Einf are parameters of the material.
    fn has_equilibrium(&self) -> bool {
        self.parameters.len() > 1 && self.parameters[1].name == "Einf"
    }

    /// Values of all parameters from the coordinates of the free ones. The coordinate of E0 is ln(E0 − Einf); that of Einf below a fixed E0 is
    /// ln(Einf/(E0 − Einf)): every coordinate is allowed.
    pub(crate) fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut free = coordinates.iter();
        let value = |parameter: &Parameter| match parameter.is_free {
            true => free.next().map_or(f64::NAN, |&x| parameter.value(x)),
            false => parameter.given.unwrap_or(f64::NAN),
        };
        let mut values: Vec<f64> = self.parameters.iter().map(value).collect();
        if self.has_equilibrium() {
            if self.parameters[0].is_free {
                values[0] += values[1];
            } else if self.parameters[1].is_free {
                values[1] = values[0] / (1.0 + 1.0 / values[1]);
            }
        }
        values
    }

    /// Coordinates of the free parameters of given values.
    pub(crate) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let mut own = values.to_vec();
        if self.has_equilibrium() {
            let relaxing = (values[0] - values[1]).max(LEAST_SHARE * values[0]);
            if self.parameters[0].is_free {
                own[0] = relaxing;
            } else if self.parameters[1].is_free {
                own[1] = values[1] / relaxing;
            }
        }
        let pairs = self.parameters.iter().zip(own).filter(|(parameter, _)| parameter.is_free);
        pairs.map(|(parameter, value)| parameter.coordinate(value)).collect()
    }

    /// Derivatives of the free parameters, on their scales, by the coordinates.
    pub(crate) fn scales(&self, values: &[f64]) -> Mat<f64> {
        let free: Vec<&Parameter> = self.free().collect();
        let mut scales = Mat::from_fn(free.len(), free.len(), |i, j| if i == j { free[i].unit } else { 0.0 });
        if self.has_equilibrium() {
            let share = values[1] / values[0];
            if self.parameters[0].is_free {
                scales[(0, 0)] = 1.0 - share;
                if self.parameters[1].is_free {
                    scales[(0, 1)] = share;
                }
            } else if self.parameters[1].is_free {
                scales[(0, 0)] = 1.0 - share;
            }
        }
        scales
    }

    /// The exponentials of the material of given values.
    pub(crate) fn prony(&self, values: &[f64]) -> Result<Prony> {
        let is_material = |parameter: &&Parameter| matches!(parameter.kind, Kind::Material(_));
        let count = self.parameters.iter().filter(is_material).count();
        self.model.prony(&values[..count], self.window)
    }

    /// The value of a parameter, if there is one of this kind.
    pub(crate) fn value_of(&self, values: &[f64], kind: Kind) -> Option<f64> {
        self.parameters.iter().position(|parameter| parameter.kind == kind).map(|at| values[at])
    }

    /// Stiffness of the spring of a curve.
    pub(crate) fn stiffness(&self, curve: usize, values: &[f64]) -> f64 {
        self.value_of(values, Kind::Stiffness).unwrap_or(self.parts[curve].experiment.stiffness)
    }

    /// Counts an evaluation of a curve.
    fn count<T: Real>(&self, curve: usize, prony: &Prony<T>) {
        let each = if T::DERIVES { LANES + 1 } else { 1 };
        self.work.set(self.work.get() + each * self.parts[curve].len() * prony.moduli.len());
    }

    /// Response of one curve.
    pub(crate) fn samples(&self, curve: usize, values: &[f64], prony: &Prony) -> Result<Vec<Sample>> {
        let contact_point = self.value_of(values, Kind::ContactPoint(curve)).unwrap_or_default();
        let mut samples = Vec::with_capacity(self.parts[curve].len());
        let push = |response: Response<f64>, _: &[Term<f64>]| samples.push(response.into());
        let stiffness = self.stiffness(curve, values);
        self.count(curve, prony);
        self.parts[curve].respond(curve, prony, contact_point, stiffness, &mut Roots::default(), push)?;
        Ok(samples)
    }

    /// The force that a curve would measure, from the force of its contact.
    pub(crate) fn measured(&self, curve: usize, values: &[f64], contact: impl Iterator<Item = f64>) -> Vec<f64> {
        let value = |kind: Kind| self.value_of(values, kind).unwrap_or_default();
        let [offset, drift, tilt, drag] =
            [Kind::Offset(curve), Kind::Drift(curve), Kind::Tilt(curve), Kind::Drag(curve)].map(value);
        let part = &self.parts[curve];
        let (times, drive) = (part.experiment.protocol.times(), part.experiment.protocol.drive());
        let of = |(k, force): (usize, f64)| {
            force + offset + drift * (times[k] - times[0]) + tilt * (drive[k] - drive[0]) + drag * part.speed[k]
        };
        contact.enumerate().map(of).collect()
    }

    /// The modelled force of one curve.
    pub(crate) fn force(&self, curve: usize, values: &[f64], prony: &Prony) -> Result<Vec<f64>> {
        let samples = self.samples(curve, values, prony)?;
        Ok(self.measured(curve, values, samples.iter().map(|sample| sample.force)))
    }

    /// Model less data of one curve, not made white.
    fn deviations(&self, curve: usize, values: &[f64], prony: &Prony) -> Result<Vec<f64>> {
        let mut force = self.force(curve, values, prony)?;
        for (force, data) in force.iter_mut().zip(&self.parts[curve].data) {
            *force -= data;
        }
        Ok(force)
    }

    /// Model less data of each curve, not made white.
    pub(crate) fn all_deviations(&self, values: &[f64]) -> Result<Vec<Vec<f64>>> {
        let prony = self.prony(values)?;
        (0..self.parts.len()).map(|curve| self.deviations(curve, values, &prony)).collect()
    }

    /// Model less data of all curves, made white.
    pub(crate) fn residuals(&self, coordinates: &[f64]) -> Result<Vec<f64>> {
        let mut all = Vec::with_capacity(self.len());
        for (part, mut deviations) in self.parts.iter().zip(self.all_deviations(&self.values(coordinates))?) {
            part.whiten(&mut deviations);
            all.append(&mut deviations);
        }
        Ok(all)
    }

    /// Derivatives of the residuals by the free coordinates.
    pub(crate) fn jacobian(&self, coordinates: &[f64]) -> Result<Mat<f64>> {
        let values = self.values(coordinates);
        let material = self.free().filter(|parameter| matches!(parameter.kind, Kind::Material(_))).count();
        let count = self.model.parameters().len();
        let moved = |column: usize, width: f64| {
            let mut moved = coordinates.to_vec();
            moved[column] += width;
            self.values(&moved)[..count].to_vec()
        };
        let (prony, slopes) = self.model.derived(&values[..count], self.window, material, moved)?;
        let mut jacobian = Mat::zeros(self.len(), coordinates.len());
        let (mut roots, mut row) = (Roots::default(), 0);
        for (curve, part) in self.parts.iter().enumerate() {
            let acts = |parameter: &Parameter| parameter.kind.curve().is_none_or(|only| only == curve);
            let columns = || self.free().enumerate().filter(|(_, parameter)| acts(parameter));
            let mut put = |column: usize, mut slopes: Vec<f64>| {
                part.whiten(&mut slopes);
                slopes.into_iter().enumerate().for_each(|(k, slope)| jacobian[(row + k, column)] = slope);
            };
            for (column, parameter) in columns().filter(|(_, parameter)| parameter.kind.is_linear()) {
                put(column, self.linear_slopes(curve, parameter));
            }
            let curved: Vec<_> = columns().filter(|(_, parameter)| !parameter.kind.is_linear()).collect();
            for lanes in curved.chunks(LANES) {
                let dual = |value: f64, slope: &dyn Fn(usize, &Parameter) -> f64| {
                    Dual::new(value, std::array::from_fn(|lane| lanes.get(lane).map_or(0.0, |&(c, p)| slope(c, p))))
                };
                let of = |values: &[f64], slope: &dyn Fn(&Prony) -> f64, at: usize| {
                    dual(values[at], &|column, _| slopes.get(column).map_or(0.0, slope))
                };
                let terms = 0..prony.moduli.len();
                let derived = Prony {
                    moduli: terms.clone().map(|at| of(&prony.moduli, &|by| by.moduli[at], at)).collect(),
                    rates: terms.map(|at| of(&prony.rates, &|by| by.rates[at], at)).collect(),
                };
                let contact_point = self.value_of(&values, Kind::ContactPoint(curve)).unwrap_or_default();
                let stiffness = self.stiffness(curve, &values);
                let shift = dual(contact_point, &|_, parameter| match parameter.kind {
                    Kind::ContactPoint(_) => parameter.unit,
                    _ => 0.0,
                });
                let spring =
                    dual(stiffness, &|_, parameter| if parameter.kind == Kind::Stiffness { stiffness } else { 0.0 });
                self.count(curve, &prony);
                self.count(curve, &derived);
                part.respond(curve, &prony, contact_point, stiffness, &mut roots, |_, _| {})?;
                let mut forces = Vec::with_capacity(part.len());
                part.respond(curve, &derived, shift, spring, &mut roots, |response, _| forces.push(response.force))?;
                for (lane, &(column, _)) in lanes.iter().enumerate() {
                    put(column, forces.iter().map(|force| force.slope(lane)).collect());
                }
            }
            row += part.len();
        }
        Ok(jacobian)
    }

    /// Derivative by a parameter in which the force is linear.
    fn linear_slopes(&self, curve: usize, parameter: &Parameter) -> Vec<f64> {
        let part = &self.parts[curve];
        let (times, drive) = (part.experiment.protocol.times(), part.experiment.protocol.drive());
        let of = |k: usize| match parameter.kind {
            Kind::Offset(_) => 1.0,
            Kind::Drift(_) => times[k] - times[0],
            Kind::Tilt(_) => drive[k] - drive[0],
            _ => part.speed[k],
        };
        (0..part.len()).map(|k| parameter.unit * of(k)).collect()
    }
}
