//! A layer on a half-space that creeps otherwise.
//!
//! In a steady motion a wave meets both at one frequency, so that it displaces by (2/q) C₁ L(μ, qh) with the ratio
//! μ = G₁/G₂ of the complex moduli. Where bodies end, its coefficients are in three parts,
//!
//! (2/q) C₁ L = (2/q) C₁ + (2/q) (C₂ − C₁) e^(−2qh) + rest:
//!
//! a half-space of the layer's material, and the influence of cells at a depth 2h below the points, both by
//! recursion. The rest is bounded at q = 0, vanishes as e^(−2qh), and is integrated on panels that double from zero
//! on.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::Arc;

use faer::Mat;
use num_complex::Complex64;

use super::coefficients::{RowOfCells, Rules};
use super::coverage;
use super::creep::Creep;
use super::operator::Coefficients;
use crate::Layer;
use crate::error::{Result, within};
use crate::kernel::InfluenceKernel;
use crate::quadrature::GaussLegendre;
use crate::rheology::Material;

/// Points of a panel, and the maximum change of phase on one.
const POINTS: usize = 16;
const PHASE: f64 = 8.0;
/// The rest is negligible beyond this qh.
const LAST: f64 = 18.0;
/// The first panel over the least wave number on which anything changes.
const FIRST: f64 = 1e-3;
/// Maximum length of the grid over the thickness.
pub(super) const THINNEST: f64 = 64.0;

pub(super) struct LayerOnBase {
    pub(super) layer: Layer,
    /// How the layer and its base creep.
    pub(super) own: Creep,
    pub(super) base: Creep,
    pub(super) kernel: Arc<InfluenceKernel>,
}

impl Layer {
    /// A layer of one material bonded to a half-space of another one, with the ratio of their moduli at rest: for
    /// [`Builder::build_sliding_on`](crate::contact::Builder::build_sliding_on) the base.
    ///
    /// # Errors
    /// As [`Layer::bonded_to_half_space`]; if a material has no constant Poisson's ratio or no series, or flows.
    pub fn bonded_to_material(thickness: f64, layer: &Material, base: &Material) -> Result<Layer> {
        let [(nu, own), (base_nu, below)] = [at_rest(layer)?, at_rest(base)?];
        Layer::bonded_to_half_space(thickness, nu, below / (1.0 - base_nu) * ((1.0 - nu) / own), base_nu)
    }
}

/// Poisson's ratio of a material, and its contact compliance after a long time.
fn at_rest(material: &Material) -> Result<(f64, f64)> {
    let ratios: Vec<_> = material.poisson_ratios().collect();
    let [Some(nu)] = ratios[..] else { return Err(coverage::CHANGING_RATIO.error()) };
    let creep = material.spectrum_for("a layer on a base")?;
    within(
        "fluidity of a layer or its base",
        creep.fluidity(),
        creep.fluidity() == 0.0,
        "0: give it an equilibrium modulus",
    )?;
    Ok((nu, creep.relaxed()))
}

/// The mean of a wave over a cell, cos(qx) over |x| < side/2.
fn of_cell(q: f64, side: f64) -> f64 {
    let half = 0.5 * q * side;
    if half < 1e-4 { 1.0 - half * half / 6.0 } else { half.sin() / half }
}

/// What even waves of these numbers and weights displace at the distances of n cells of a side.
fn to_cells(waves: &[(f64, f64)], n: usize, side: f64) -> Mat<f64> {
    Mat::from_fn(n, waves.len(), |i, k| {
        let (q, weight) = waves[k];
        FRAC_1_PI * weight * side * of_cell(q, side) * (q * side * i as f64).cos()
    })
}

impl LayerOnBase {
    /// C₁ and C₂ at a frequency, and L of a wave qh.
    fn at(&self, omega: f64) -> (Complex64, Complex64, impl Fn(f64) -> Complex64) {
        let [own, base] = [&self.own, &self.base].map(|creep| creep.at(omega));
        let base_poisson = self.layer.base_poisson().unwrap_or(0.5);
        let layer = self.layer.oscillating(base / (1.0 - base_poisson) * ((1.0 - self.layer.poisson_ratio()) / own));
        (own, base, move |t| layer.at(t))
    }

    /// The displacement under a unit wave \[m/Pa\].
    pub(super) fn compliance(&self, q: f64, omega: f64) -> Complex64 {
        let (own, _, response) = self.at(omega);
        2.0 / q * own * response(q * self.layer.thickness())
    }

    /// The rest of waves `aside`, at each wave number of the nodes `along`: of all waves, or of the mean alone, the
    /// second part is taken out. `moves`: the nodes, or the waves, pass at a `speed`.
    fn rest(&self, along: &[(f64, f64)], aside: &[f64], (lines, moves, speed): (bool, bool, f64)) -> [Mat<f64>; 2] {
        let h = self.layer.thickness();
        let mut parts = [Mat::zeros(along.len(), aside.len()), Mat::zeros(along.len(), aside.len())];
        for (k, &(q1, _)) in along.iter().enumerate() {
            let mut known = self.at(q1 * speed);
            for (j, &q2) in aside.iter().enumerate() {
                if !moves {
                    known = self.at(q2 * speed);
                }
                let (own, base, response) = &known;
                let q = q1.hypot(q2);
                let deep = if lines && q2 > 0.0 { Complex64::ZERO } else { (base - own) * (-2.0 * q * h).exp() };
                let rest = 2.0 / q * (own * (response(q * h) - 1.0) - deep);
                (parts[0][(k, j)], parts[1][(k, j)]) = (rest.re, rest.im);
            }
        }
        parts
    }

    /// Wave numbers and weights of an integral over q > 0, along an axis of the grid.
    fn nodes(&self, axis: usize, speed: f64) -> Vec<(f64, f64)> {
        let (h, lengths) = (self.layer.thickness(), self.kernel.grid().lengths());
        let softest = self.layer.longest_over_half_space().max(1.0);
        let reaches = [&self.own, &self.base].map(|creep| creep.reaches(speed)).concat();
        let longest = reaches.iter().map(|(_, reach)| *reach).fold(h * softest, f64::max);
        let (rule, mut begin, mut nodes) = (GaussLegendre::new(POINTS), 0.0, Vec::new());
        let mut length = FIRST / longest.max(lengths[0]).max(lengths[1]);
        while begin < LAST / h {
            nodes.extend(rule.points().iter().map(|(t, w)| (begin + 0.5 * length * (1.0 + t), 0.5 * length * w)));
            begin += length;
            length = begin.min(PHASE / lengths[axis]);
        }
        nodes
    }

    /// Rows of the influence at depth 2h, of cells or of the mean wave.
    fn below(&self, axis: usize) -> Vec<crate::kernel::Row> {
        let mut rows = self.kernel.rows_along(axis, Some(2.0 * self.layer.thickness())).unwrap_or_default();
        rows.truncate(if self.kernel.periodic_axes()[1 - axis] { 1 } else { rows.len() });
        rows
    }

    /// What of the mean is taken out so that a line load displaces nothing at its datum.
    fn at_datum(&self, axis: usize) -> f64 {
        let per_width = self.kernel.datum().map_or(0.0, |datum| self.layer.at_datum(datum));
        per_width * self.kernel.grid().spacing()[axis] * self.own.at(0.0).re
    }

    /// Adds the second part and the rest to the coefficients of a motion along an axis on which the bodies end.
    pub(super) fn add_along(&self, (axis, speed): (usize, f64), out: &mut Coefficients, rules: &Rules) {
        let (grid, lines) = (self.kernel.grid(), self.kernel.periodic_axes()[1 - axis]);
        let [(n, d), (m, side)] = [axis, 1 - axis].map(|axis| (grid.cells()[axis], grid.spacing()[axis]));
        let less = self.own.reaches(speed).into_iter().map(|(compliance, reach)| (-compliance, reach));
        let reaches: Vec<_> = self.base.reaches(speed).into_iter().chain(less).collect();
        for (j, row) in self.below(axis).into_iter().enumerate() {
            out.add(j, &RowOfCells::new(row, n, d, rules), &reaches, rules);
        }
        let along = self.nodes(axis, speed);
        let aside = self.nodes(1 - axis, speed);
        let waves: Vec<f64> = match lines {
            true => (0..out.response.len()).map(|k| crate::kernel::wave_number(k, m, side)).collect(),
            false => aside.iter().map(|(q, _)| *q).collect(),
        };
        let mut rest = self.rest(&along, &waves, (lines, true, speed));
        if !lines {
            let to_rows = to_cells(&aside, m, side);
            rest = rest.map(|part| &part * to_rows.transpose());
        }
        let sum = |cells: Range<isize>, wave: fn(f64) -> f64, of_q: fn(f64) -> f64, part: &Mat<f64>| {
            let to_cells = Mat::from_fn(cells.len(), along.len(), |i, k| {
                let ((q, weight), x) = (along[k], (i as isize + cells.start) as f64 * d);
                FRAC_1_PI * weight * d * of_cell(q, d) * of_q(q) * wave(q * x)
            });
            &to_cells * part
        };
        let (end, [re, im]) = (n as isize, &rest);
        let response = sum(1 - end..end, f64::cos, |_| 1.0, re) - sum(1 - end..end, f64::sin, |_| 1.0, im);
        let loss = sum(0..end, f64::cos, |q| q, im);
        let at_datum = self.at_datum(axis);
        for j in 0..out.response.len() {
            let at_datum = if lines && j == 0 { at_datum } else { 0.0 };
            out.response[j].iter_mut().enumerate().for_each(|(i, own)| *own += response[(i, j)] - at_datum);
            out.loss[j].iter_mut().enumerate().for_each(|(i, own)| *own += loss[(i, j)]);
        }
    }

    /// The displacements aside of a cell under each of the waves of a motion along a periodic axis.
    pub(super) fn of_waves(&self, (axis, speed): (usize, f64), waves: &[f64]) -> Vec<Vec<Complex64>> {
        let (n, d) = (self.kernel.grid().cells()[1 - axis], self.kernel.grid().spacing()[1 - axis]);
        let along = self.nodes(1 - axis, 0.0);
        let to_cells = to_cells(&along, n, d);
        let [re, im] = self.rest(&along, waves, (true, false, speed)).map(|part| &to_cells * &part);
        let own = self.kernel.rows_along(1 - axis, Some(0.0)).unwrap_or_default();
        let (below, at_datum) = (self.below(1 - axis), self.at_datum(1 - axis));
        let of = |i: usize, k: usize| {
            let (x, (layer, base, _)) = (i as f64 * d, self.at(waves[k] * speed));
            let mean = if k == 0 { (base - layer) * (below[0].influence)(x) - at_datum } else { Complex64::ZERO };
            layer * (own[k].influence)(x) + mean + Complex64::new(re[(i, k)], im[(i, k)])
        };
        (0..n).map(|i| (0..waves.len()).map(|k| of(i, k)).collect()).collect()
    }
}
