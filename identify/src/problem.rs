//! A least-squares problem: the model forces of all curves, less the measured ones, made white.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use faer::Mat;

use crate::error::{Result, count_within};
use crate::experiment::Curve;
use crate::forward::{Cycle, LANES, PLAIN, Real, Sample};
use crate::model::{Model, Scale};
use crate::noise::Noise;
use crate::parameters::{Chosen, Kind, Parameter, Property};
use crate::part::Part;
use crate::protocol::Protocol;
use crate::series::Prony;
use crate::statistics::square;
use crate::watch::Watch;

/// Least share of a modulus that relaxes.
const LEAST_SHARE: f64 = 1e-12;
/// Means of neighbouring samples of a curve with which a search begins, and with which it ends.
pub(crate) const ROUGH: usize = 128;
pub(crate) const LONG: usize = 2048;
/// A search ends with the step that reduces the sum of squares by less than this fraction; one with few samples, early.
pub(crate) const ENOUGH: [f64; 2] = [1e-10, 1e-4];
/// Residuals are rounding below this fraction of the squared data.
const EXACT: f64 = 1e-18;
/// Width of coordinates over which derivatives of parameters are taken.
pub(crate) const WIDTH: f64 = 1e-5;

/// All curves, and the parameters of their forces.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    pub(crate) model: Model,
    pub(crate) parts: Vec<Part>,
    /// The problem of all samples, where those of the parts are means.
    pub(crate) whole: Option<Arc<Problem>>,
    pub(crate) parameters: Vec<Parameter>,
    /// Shortest interval between samples and longest curve \[s\].
    pub(crate) window: [f64; 2],
    /// Fraction of the sum of squares by which the last step of a search reduces it.
    pub(crate) enough: f64,
    /// Exponentials that were advanced by a sample, each derivative counted.
    pub(crate) work: Arc<AtomicUsize>,
    /// What may end a search.
    pub(crate) watch: Watch,
}

/// A curve by a model, at each sample.
#[derive(Clone, Debug)]
pub(crate) struct Response {
    pub(crate) samples: Vec<Sample>,
    /// The force that is measured \[N\].
    pub(crate) force: Vec<f64>,
    /// Measured less modelled force \[N\].
    pub(crate) residuals: Vec<f64>,
}

impl Problem {
    pub(crate) fn new(model: Model, chosen: &Chosen, curves: Vec<Curve>, noise: Noise) -> Result<Problem> {
        count_within("curves", curves.len(), !curves.is_empty(), "1 or more")?;
        let parameters = chosen.parameters(model, &curves)?;
        let times = || curves.iter().map(|curve| curve.experiment.protocol.times());
        let shortest = times().flat_map(|t| t.windows(2).map(|w| w[1] - w[0])).fold(f64::INFINITY, f64::min);
        let window = [shortest, times().map(|t| t[t.len() - 1] - t[0]).fold(0.0, f64::max)];
        let part = |(index, curve): (usize, Curve)| Part::new(index, curve, noise);
        let parts = curves.into_iter().enumerate().map(part).collect();
        Ok(Problem {
            model,
            parts,
            whole: None,
            parameters,
            window,
            enough: ENOUGH[0],
            work: Arc::default(),
            watch: Watch::default(),
        })
    }

    /// The same problem with at most so many means of neighbours of each curve; `None` where there are no more samples.
    pub(crate) fn thinned(&self, most: usize) -> Option<Problem> {
        let is_long = self.parts.iter().any(|part| part.len() > most);
        let parts = || self.parts.iter().map(|part| part.thinned(most)).collect();
        is_long.then(|| Problem { parts: parts(), whole: None, ..self.clone() })
    }

    /// The same problem with all samples.
    pub(crate) fn whole(&self) -> &Problem {
        self.whole.as_deref().unwrap_or(self)
    }

    /// Share of the information on a coordinate that means of neighbours have lost, by the variance of its slopes within a mean; the maximum of all.
    pub(crate) fn lost(&self, slopes: &[Vec<f64>]) -> f64 {
        let of = |column: &Vec<f64>| {
            let change: f64 = column.windows(2).map(|pair| (pair[1] - pair[0]).powi(2) / 12.0).sum();
            if change > 0.0 { change / square(column) } else { 0.0 }
        };
        if self.whole.is_none() { 0.0 } else { slopes.iter().map(of).fold(0.0, f64::max) }
    }

    /// The same problem with a simpler model; `None` where parameters of the material are given.
    pub(crate) fn with_model(&self, model: Model) -> Option<Problem> {
        let (material, others) = self.parameters.split_at(self.model.parameters().len());
        if material.iter().any(|parameter| parameter.given.is_some()) {
            return None;
        }
        let parameters = [Parameter::of_material(model, &Chosen::default()).ok()?, others.to_vec()].concat();
        Some(Problem { model, parameters, ..self.clone() })
    }

    /// Values of all parameters from those of a contained model.
    pub(crate) fn of_contained(&self, inner: Model, values: &[f64]) -> Vec<f64> {
        let (material, others) = values.split_at(inner.parameters().len());
        [self.model.of_contained(inner, material, self.window[1]), others.to_vec()].concat()
    }

    /// The same problem without weights of outliers.
    pub(crate) fn without_outliers(&self) -> Problem {
        let mut problem = self.clone();
        problem.parts.iter_mut().for_each(|part| part.outliers.fill(1.0));
        problem
    }

    /// Number of samples of all curves.
    pub(crate) fn len(&self) -> usize {
        self.parts.iter().map(Part::len).sum()
    }

    /// A sum of squares that is rounding.
    pub(crate) fn rounding(&self) -> f64 {
        EXACT * self.parts.iter().flat_map(|part| &part.curve.force).map(|force| force * force).sum::<f64>()
    }

    /// The free parameters.
    pub(crate) fn free(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|parameter| parameter.is_free)
    }

    /// (t/tau)^exponent in the middle of the data, of a model with one time.
    fn relaxed(&self, values: &[f64]) -> f64 {
        let of = |name: &str| self.parameters.iter().position(|parameter| parameter.name == name).map(|at| values[at]);
        let (middle, exponent) = ((self.window[0] * self.window[1]).sqrt(), of("alpha").or(of("beta")).unwrap_or(1.0));
        of("tau").map_or(0.0, |tau| (middle / tau).powf(exponent))
    }

    /// The factor by which a part of the modulus falls to the middle of the data, or nearly so: it is better known there than at the time 0.
    fn fall(&self, values: &[f64]) -> f64 {
        if self.model == Model::Stretched { self.relaxed(values).exp() } else { 1.0 + self.relaxed(values) }
    }

    /// Values of all parameters from the coordinates of the free ones. The coordinate of E0 is ln((E0 − Einf)/fall); that of Einf below a fixed E0
    /// is ln(Einf/(E0 − Einf)): every coordinate is allowed.
    ///
    /// That of tau with an exponent beta is the logarithm of the slope beta (t/tau)^beta of the part of the modulus that
    /// relaxes in the middle of the data: where beta falls to 0, which is a power law, modulus and slope there stay.
    pub(crate) fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut free = coordinates.iter();
        let value = |parameter: &Parameter| match parameter.is_free {
            true => free.next().map_or(f64::NAN, |&x| parameter.value(x)),
            false => parameter.given.unwrap_or(f64::NAN),
        };
        let mut values: Vec<f64> = self.parameters.iter().map(value).collect();
        if self.model == Model::Stretched && self.parameters[2].is_free {
            values[2] = (self.window[0] * self.window[1]).sqrt() * (values[3] / values[2]).powf(1.0 / values[3]);
        }
        if self.model.has_equilibrium() {
            if self.parameters[0].is_free {
                values[0] = values[1] + values[0] * self.fall(&values);
            } else if self.parameters[1].is_free {
                values[1] = values[0] / (1.0 + 1.0 / values[1]);
            }
        }
        values
    }

    /// Coordinates of the free parameters of given values.
    pub(crate) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let mut own = values.to_vec();
        if self.model == Model::Stretched && self.parameters[2].is_free {
            own[2] = values[3] * self.relaxed(values);
        }
        if self.model.has_equilibrium() {
            let relaxing = (values[0] - values[1]).max(LEAST_SHARE * values[0]);
            // a start that is not allowed is not at the limit, where no search leaves
            let relaxing = if values[0] < values[1] { values[1] } else { relaxing };
            if self.parameters[0].is_free {
                own[0] = relaxing / self.fall(values);
            } else if self.parameters[1].is_free {
                own[1] = values[1] / relaxing;
            }
        }
        let pairs = self.parameters.iter().zip(own).filter(|(parameter, _)| parameter.is_free);
        pairs.map(|(parameter, value)| parameter.coordinate(value)).collect()
    }

    /// Values of all parameters where a coordinate is larger by some width.
    pub(crate) fn moved(&self, coordinates: &[f64], column: usize, width: f64) -> Vec<f64> {
        let mut moved = coordinates.to_vec();
        moved[column] += width;
        self.values(&moved)
    }

    /// Derivatives of the free parameters, on their scales, by the coordinates.
    pub(crate) fn scales(&self, coordinates: &[f64]) -> Mat<f64> {
        let on_scales = |column: usize, width: f64| -> Vec<f64> {
            let pairs = self.parameters.iter().zip(self.moved(coordinates, column, width));
            pairs.filter(|(of, _)| of.is_free).map(|(of, value)| of.scale.forward(value)).collect()
        };
        let count = coordinates.len();
        let ends: Vec<_> = (0..count).map(|column| [-WIDTH, WIDTH].map(|width| on_scales(column, width))).collect();
        Mat::from_fn(count, count, |i, j| (ends[j][1][i] - ends[j][0][i]) / (2.0 * WIDTH))
    }

    /// The exponentials of the material of given values.
    pub(crate) fn prony(&self, values: &[f64]) -> Result<Prony> {
        self.model.prony(&values[..self.model.parameters().len()], self.window)
    }

    /// The value of a property of a curve, if it is a parameter.
    pub(crate) fn value_of(&self, values: &[f64], property: Property, curve: usize) -> Option<f64> {
        let is_it = |parameter: &Parameter| matches!(parameter.kind, Kind::Measurement(own, of) if own == property && of.is_none_or(|of| of == curve));
        self.parameters.iter().position(is_it).map(|at| values[at])
    }

    /// Drive at first touch of a curve \[m\].
    pub(crate) fn contact_point(&self, curve: usize, values: &[f64]) -> f64 {
        self.value_of(values, Property::ContactPoint, curve).unwrap_or_default()
    }

    /// Stiffness of the spring of a curve.
    pub(crate) fn stiffness(&self, curve: usize, values: &[f64]) -> f64 {
        self.value_of(values, Property::Stiffness, curve).unwrap_or(self.parts[curve].curve.experiment.stiffness)
    }

    /// Computes the contact of a curve; `record` is given it at each sample.
    fn respond<const N: usize>(
        &self,
        curve: usize,
        prony: &Prony<Real<N>>,
        contact_point: Real<N>,
        stiffness: Real<N>,
        record: impl FnMut(&Cycle<N>),
    ) -> Result<()> {
        let part = &self.parts[curve];
        self.work.fetch_add(N * part.len() * prony.moduli.len(), Ordering::Relaxed);
        let Protocol { times, drive } = &part.curve.experiment.protocol;
        let drive: Vec<Real<N>> = drive.iter().map(|&z| Real::from(z) - contact_point).collect();
        Cycle::new(prony, &part.tip, Real::from(1.0) / stiffness, times).follow(&drive, record)
    }

    /// What `of` tells of the contact of a curve at each sample.
    pub(crate) fn each<T>(
        &self,
        curve: usize,
        values: &[f64],
        prony: &Prony,
        of: impl Fn(&Cycle<PLAIN>) -> T,
    ) -> Result<Vec<T>> {
        let [contact_point, stiffness] =
            [self.contact_point(curve, values), self.stiffness(curve, values)].map(Real::from);
        let mut all = Vec::with_capacity(self.parts[curve].len());
        self.respond(curve, &prony.into(), contact_point, stiffness, |contact| all.push(of(contact)))?;
        Ok(all)
    }

    /// Response of one curve.
    pub(crate) fn samples(&self, curve: usize, values: &[f64], prony: &Prony) -> Result<Vec<Sample>> {
        self.each(curve, values, prony, |contact| contact.sample())
    }

    /// The force that a curve would measure, from the force of its contact.
    pub(crate) fn measured(&self, curve: usize, values: &[f64], contact: impl Iterator<Item = f64>) -> Vec<f64> {
        let own = self.parameters.iter().zip(values).filter(|(parameter, _)| parameter.kind.curve() == Some(curve));
        let linear: Vec<_> = own.filter_map(|(parameter, value)| Some((parameter.kind.linear()?, value))).collect();
        let of = |(k, force): (usize, f64)| {
            let each = linear.iter().map(|&(property, value)| value * self.parts[curve].force_over(property, k));
            each.fold(force, |sum, part| sum + part)
        };
        contact.enumerate().map(of).collect()
    }

    /// The response of a curve.
    pub(crate) fn response(&self, curve: usize, values: &[f64], prony: &Prony) -> Result<Response> {
        let samples = self.samples(curve, values, prony)?;
        let force = self.measured(curve, values, samples.iter().map(|sample| sample.force));
        let residuals = self.parts[curve].curve.force.iter().zip(&force).map(|(data, force)| data - force).collect();
        Ok(Response { samples, force, residuals })
    }

    /// The data of a curve without offset, drift, tilt and drag.
    pub(crate) fn bare(&self, curve: usize, values: &[f64]) -> Vec<f64> {
        let data = &self.parts[curve].curve.force;
        let rest = self.measured(curve, values, data.iter().map(|_| 0.0));
        data.iter().zip(rest).map(|(data, rest)| data - rest).collect()
    }

    /// Columns of the curves, made white, one after the other.
    pub(crate) fn white(&self, columns: impl IntoIterator<Item = Vec<f64>>) -> Vec<f64> {
        let white = |(part, mut column): (&Part, Vec<f64>)| {
            part.whiten(&mut column);
            column
        };
        self.parts.iter().zip(columns).flat_map(white).collect()
    }

    /// Model less data of all curves, made white.
    pub(crate) fn residuals(&self, coordinates: &[f64]) -> Result<Vec<f64>> {
        let values = self.values(coordinates);
        let prony = self.prony(&values)?;
        let deviations = |curve: usize| {
            self.watch.goes_on()?;
            Ok(self.response(curve, &values, &prony)?.residuals.iter().map(|rest| -rest).collect())
        };
        let columns: Vec<Vec<f64>> = (0..self.parts.len()).map(deviations).collect::<Result<_>>()?;
        Ok(self.white(columns))
    }

    /// Derivatives of the residuals by the free coordinates.
    pub(crate) fn jacobian(&self, coordinates: &[f64]) -> Result<Mat<f64>> {
        Ok(self.matrix(&self.slopes(coordinates)?))
    }

    /// A matrix of columns of the data.
    pub(crate) fn matrix(&self, columns: &[Vec<f64>]) -> Mat<f64> {
        Mat::from_fn(self.len(), columns.len(), |k, j| columns[j][k])
    }

    /// Derivatives of the residuals, a column for each free coordinate.
    pub(crate) fn slopes(&self, coordinates: &[f64]) -> Result<Vec<Vec<f64>>> {
        let values = self.values(coordinates);
        let material = self.free().filter(|parameter| parameter.kind == Kind::Material).count();
        let moved = |column: usize| [WIDTH, -WIDTH].map(|width| self.moved(coordinates, column, width));
        let count = self.model.parameters().len();
        let all = std::iter::once(values.clone()).chain((0..material).flat_map(moved));
        let sums = self.model.sums(&all.map(|values| values[..count].to_vec()).collect::<Vec<_>>(), self.window)?;
        let prony = &sums[0];
        let mut columns = vec![vec![0.0; self.len()]; coordinates.len()];
        let mut row = 0;
        for (curve, part) in self.parts.iter().enumerate() {
            let mut put = |column: usize, mut slopes: Vec<f64>| {
                part.whiten(&mut slopes);
                columns[column][row..row + part.len()].copy_from_slice(&slopes);
            };
            let mut curved = Vec::new();
            for (column, parameter) in self.free().enumerate() {
                match parameter.kind.linear() {
                    _ if parameter.kind.curve().is_some_and(|only| only != curve) => {}
                    Some(property) => {
                        put(column, (0..part.len()).map(|k| parameter.unit * part.force_over(property, k)).collect())
                    }
                    None => curved.push((column, parameter)),
                }
            }
            for lanes in curved.chunks(LANES - 1) {
                self.watch.goes_on()?;
                let dual = |value: f64, slope: &dyn Fn(usize, &Parameter) -> f64| {
                    Real::new(value, std::array::from_fn(|lane| lanes.get(lane).map_or(0.0, |&(c, p)| slope(c, p))))
                };
                let terms = |of: fn(&Prony) -> &Vec<f64>| -> Vec<Real<LANES>> {
                    let slope = |at: usize, column: usize| match sums.get(2 * column + 1..2 * column + 3) {
                        Some([up, down]) => (of(up)[at] - of(down)[at]) / (2.0 * WIDTH),
                        _ => 0.0,
                    };
                    let term = |(at, &value)| dual(value, &|column, _| slope(at, column));
                    of(prony).iter().enumerate().map(term).collect()
                };
                let derived = Prony { moduli: terms(|prony| &prony.moduli), rates: terms(|prony| &prony.rates) };
                let measured = |value: f64, property: Property| {
                    dual(value, &|_, parameter| match (parameter.kind, parameter.scale) {
                        (Kind::Measurement(own, _), Scale::Linear) if own == property => parameter.unit,
                        (Kind::Measurement(own, _), _) if own == property => value,
                        _ => 0.0,
                    })
                };
                let shift = measured(self.contact_point(curve, &values), Property::ContactPoint);
                let spring = measured(self.stiffness(curve, &values), Property::Stiffness);
                let mut forces = Vec::with_capacity(part.len());
                self.respond(curve, &derived, shift, spring, |contact| forces.push(contact.force()))?;
                for (lane, &(column, _)) in lanes.iter().enumerate() {
                    put(column, forces.iter().map(|force| force.slopes[lane]).collect());
                }
            }
            row += part.len();
        }
        Ok(columns)
    }
}
