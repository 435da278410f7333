//! The decades of time that data determine.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use crate::error::{Error, Result};
use crate::fit::Fit;
use crate::forward::Real;
use crate::problem::Problem;
use crate::series::Prony;

/// Least modulus of a term, relative to the modulus at the shortest sampling interval, so that its force is known.
const LEAST: f64 = 1e-12;
/// A decade is determined if its modulus is known to this fraction of the modulus at the shortest sampling interval, which the data show whatever the model.
const DETERMINED: f64 = 0.1;

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
    /// For each decade of relaxation times, from the sampling interval to a hundred times the length of the curves, whether the data determine
    /// how much modulus relaxes in it, without a model.
    ///
    /// # Errors
    /// If the forces of the decades are not finite.
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
