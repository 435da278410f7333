//! A relaxation spectrum without a model, and the decades of time that data determine.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Col, Mat, Side};
use viscocontact::numeric::non_negative_least_squares;

use crate::error::{Error, Result};
use crate::fit::Fit;
use crate::forward::Real;
use crate::problem::Problem;
use crate::series::{Prony, times};

/// Relaxation times per decade.
const PER_DECADE: f64 = 5.0;
/// Strengths of the smoothing that are tried, from none to all.
const STRENGTHS: usize = 25;
/// Rounds in which the spectrum and the extent of the contact agree.
const MAX_ROUNDS: usize = 40;
/// Change of the forces, relative to the greatest, below which they agree.
const AGREED: f64 = 1e-7;
/// Least modulus of a term, relative to the sum, so that its force is known.
const LEAST: f64 = 1e-12;
/// A decade is determined if its modulus is known to this fraction of the modulus at the shortest sampling interval, which the data show whatever the model.
const DETERMINED: f64 = 0.1;

/// A spectrum of relaxation times found without a model: moduli of zero or more at fixed times.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FreeSpectrum {
    /// Modulus at long times \[Pa\].
    pub equilibrium: f64,
    /// Relaxation times \[s\] and their moduli \[Pa\].
    pub terms: Vec<(f64, f64)>,
    /// Strength of the smoothing: weight of the squared second differences of the moduli, relative to the data.
    pub smoothing: f64,
    /// Standard deviation of the residuals \[N\].
    pub sigma: f64,
    /// Force at each sample, by curve, offset, drift and drag included \[N\].
    pub forces: Vec<Vec<f64>>,
    /// Rounds until the spectrum and the extent of the contact agreed.
    pub rounds: usize,
}

impl FreeSpectrum {
    /// The contact modulus at a time after a sudden step \[Pa\].
    pub fn modulus(&self, t: f64) -> f64 {
        self.equilibrium + self.terms.iter().map(|(time, modulus)| modulus * (-t / time).exp()).sum::<f64>()
    }
}

/// What data tell of the relaxation times of one decade.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Decade {
    /// First and last relaxation time \[s\].
    pub times: [f64; 2],
    /// Modulus that relaxes in this decade \[Pa\].
    pub modulus: f64,
    /// Its standard deviation, if the moduli of all decades and at long times are unknown \[Pa\]; at most the modulus at the shortest sampling interval.
    pub deviation: f64,
    /// Whether the deviation is below a tenth of the modulus at the shortest sampling interval.
    pub is_determined: bool,
}

impl Fit {
    /// A spectrum without a model, from the curves of this fit, with its contact points and the other properties of the measurement.
    ///
    /// For a known extent of the contact the force is linear in the spectrum, so that its moduli are found by least squares with values of
    /// zero or more. They are smoothed by their second differences, as much as generalised cross-validation (Golub, Heath & Wahba 1979)
    /// asks. The extent of the contact during retraction depends on the spectrum: both are iterated.
    ///
    /// # Errors
    /// If the iteration fails.
    pub fn free_spectrum(&self) -> Result<FreeSpectrum> {
        let (problem, rates) = (&self.problem, rates(self.problem.window));
        let mut prony = nearest(&self.prony(), &rates);
        let data = problem.white((0..problem.parts.len()).map(|curve| problem.bare(curve, &self.values)));
        let data = Col::from_fn(data.len(), |k| data[k]);
        let mut last = Col::full(data.nrows(), f64::INFINITY);
        for round in 1..=MAX_ROUNDS {
            let basis = basis(problem, &self.values, &prony)?;
            let (moduli, smoothing, sum) = smoothed(&basis, &data);
            let forces = &basis * Col::from_fn(moduli.len(), |j| moduli[j]);
            let (greatest, change) = (forces.norm_max(), (&forces - last).norm_max());
            let total: f64 = moduli.iter().sum();
            prony = Prony { moduli: moduli.iter().map(|m| m.max(LEAST * total)).collect(), rates: rates.clone() };
            if change <= AGREED * greatest || round == MAX_ROUNDS && change <= 1e-3 * greatest {
                let of_curve = |curve: usize| problem.whole().force(curve, &self.values, &prony);
                return Ok(FreeSpectrum {
                    equilibrium: moduli[0],
                    terms: rates[1..].iter().zip(&moduli[1..]).map(|(rate, &modulus)| (1.0 / rate, modulus)).collect(),
                    smoothing,
                    sigma: (sum / problem.len() as f64).sqrt(),
                    forces: (0..problem.parts.len()).map(of_curve).collect::<Result<_>>()?,
                    rounds: round,
                });
            }
            last = forces;
        }
        let reason = "the spectrum and the extent of the contact do not agree: fit a model with few parameters instead";
        Err(Error::NotConverged { iterations: MAX_ROUNDS, reason })
    }

    /// For each decade of relaxation times, from the sampling interval to a hundred times the length of the curves, whether the data determine
    /// how much modulus relaxes in it, without a model.
    ///
    /// # Errors
    /// As [`Fit::free_spectrum`].
    pub fn decades(&self) -> Result<Vec<Decade>> {
        let [shortest, longest] = self.problem.window;
        let first = shortest.log10().floor();
        let count = (longest.log10() - first).ceil().max(1.0) as usize + 2;
        let edges: Vec<[f64; 2]> =
            (0..count).map(|k| [0.0, 1.0].map(|end| 10.0_f64.powf(first + k as f64 + end))).collect();
        // the equilibrium, and three times in each decade, which share its modulus
        let times = edges.iter().flat_map(|[low, _]| [1.0, 3.0, 5.0].map(|sixth| low * 10.0_f64.powf(sixth / 6.0)));
        let rates: Vec<f64> = std::iter::once(0.0).chain(times.map(|time| 1.0 / time)).collect();
        let share = |term: usize, decade: usize| match term {
            0 => f64::from(u8::from(decade == 0)),
            _ => f64::from(u8::from(term.div_ceil(3) == decade)) / 3.0,
        };
        let (total, prony) = (self.modulus(shortest), self.prony());
        let mut path = prony.clone();
        path.moduli.resize(prony.moduli.len() + rates.len(), LEAST * total);
        path.rates.extend(&rates);
        let basis = basis(&self.problem, &self.values, &path)?;
        let columns =
            basis.subcols(prony.moduli.len(), rates.len()) * Mat::from_fn(rates.len(), count + 1, share) / self.sigma();
        // nobody expects more in a decade than the modulus at the shortest sampling interval: a weak prior, without which decades that the data do
        // not see have no deviation
        let scaled = total * total * columns.transpose() * &columns + Mat::<f64>::identity(count + 1, count + 1);
        let reason = "the forces of the decades are not finite: check the times and the noise";
        let singular = |_| Error::NotConverged { iterations: 0, reason };
        let inverse = scaled.llt(Side::Lower).map_err(singular)?.inverse();
        let decade = |(k, times): (usize, [f64; 2])| {
            let is_inside = |rate: f64| (times[0]..times[1]).contains(&(1.0 / rate));
            let inside = prony.moduli.iter().zip(&prony.rates).filter(|(_, rate)| is_inside(**rate));
            let modulus = inside.fold(0.0, |sum, (modulus, _)| sum + modulus);
            let deviation = total * inverse[(k + 1, k + 1)].sqrt();
            Decade { times, modulus, deviation, is_determined: deviation < DETERMINED * total }
        };
        Ok(edges.into_iter().enumerate().map(decade).collect())
    }
}

/// Rates from 0 to twice the fastest that samples show.
fn rates([shortest, longest]: [f64; 2]) -> Vec<f64> {
    let ends = [0.5 * shortest, 3.0 * longest];
    let count = ((ends[1] / ends[0]).log10() * PER_DECADE).ceil() as usize;
    std::iter::once(0.0).chain(times(ends, count + 1).into_iter().map(|time| 1.0 / time)).collect()
}

/// A relaxation, shared out to the nearest rates, of which the first is 0.
fn nearest(prony: &Prony, rates: &[f64]) -> Prony {
    let total: f64 = prony.moduli.iter().sum();
    let mut moduli = vec![LEAST * total; rates.len()];
    for (modulus, rate) in prony.moduli.iter().zip(&prony.rates) {
        let distance = |at: &usize| (rate / rates[*at]).ln().abs();
        let nearest = (1..rates.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|_| *rate > 0.0);
        moduli[nearest.unwrap_or(0)] += modulus;
    }
    Prony { moduli, rates: rates.to_vec() }
}

/// Force of each term per unit modulus, made white.
fn basis(problem: &Problem, values: &[f64], prony: &Prony) -> Result<Mat<f64>> {
    let forces =
        |curve: usize| problem.each(curve, values, prony, |contact| contact.forces().map(Real::value).collect());
    let curves: Vec<Vec<Vec<f64>>> = (0..problem.parts.len()).map(forces).collect::<Result<_>>()?;
    let column = |term: usize| {
        let of_term = |rows: &Vec<Vec<f64>>| rows.iter().map(|row| row[term] / prony.moduli[term]).collect();
        problem.white(curves.iter().map(of_term))
    };
    let white: Vec<Vec<f64>> = (0..prony.moduli.len()).map(column).collect();
    Ok(problem.matrix(&white))
}

/// The smoothed moduli of the least criterion of cross-validation, with the strength of the smoothing and the sum of squares.
fn smoothed(matrix: &Mat<f64>, data: &Col<f64>) -> (Vec<f64>, f64, f64) {
    let (count, all, right) = (matrix.ncols(), matrix.transpose() * matrix, matrix.transpose() * data);
    // second differences of neighbouring relaxation times; the equilibrium modulus is the first unknown
    let roughness = Mat::from_fn(count - 3, count, |i, j| {
        [(1, 1.0), (2, -2.0), (3, 1.0)].iter().find(|(k, _)| i + k == j).map_or(0.0, |(_, v)| *v)
    });
    let penalty = roughness.transpose() * &roughness;
    let scale = (0..count).map(|j| all[(j, j)]).fold(0.0, f64::max);
    let points = matrix.nrows() as f64;
    let mut best: Option<(f64, Vec<f64>, f64, f64)> = None;
    for k in 0..STRENGTHS {
        let strength = 10.0_f64.powf(-12.0 + 0.5 * k as f64);
        let gram = Mat::from_fn(count, count, |i, j| {
            all[(i, j)] + scale * (strength * penalty[(i, j)] + if i == j { 1e-14 } else { 0.0 })
        });
        // with G = L Lᵀ, ½ xᵀ G x − hᵀ x is least where |Lᵀ x − L⁻¹ h| is
        let Ok(factor) = gram.llt(Side::Lower) else { continue };
        let lower = factor.L();
        let mut reduced = right.clone();
        lower.solve_lower_triangular_in_place(reduced.as_mut());
        let reduced: Vec<f64> = reduced.iter().copied().collect();
        let moduli = non_negative_least_squares(&reduced, count, |i, j| lower[(j, i)]);
        let sum = (matrix * Col::from_fn(count, |j| moduli[j]) - data).squared_norm_l2();
        // degrees of freedom: the trace of the influence matrix over the free unknowns
        let at: Vec<usize> = (0..count).filter(|&j| moduli[j] > 0.0).collect();
        let part = |of: &Mat<f64>| Mat::from_fn(at.len(), at.len(), |i, j| of[(at[i], at[j])]);
        let freedom = part(&gram).llt(Side::Lower).map_or(at.len() as f64, |factor| {
            let influence = factor.inverse() * part(&all);
            (0..at.len()).map(|i| influence[(i, i)]).sum()
        });
        let criterion = sum / (points - freedom).powi(2);
        if best.as_ref().is_none_or(|(least, ..)| criterion < *least) {
            best = Some((criterion, moduli, strength, sum));
        }
    }
    best.map_or((vec![0.0; count], 0.0, 0.0), |(_, moduli, strength, sum)| (moduli, strength, sum))
}
