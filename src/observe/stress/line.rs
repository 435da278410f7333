//! The stress below one line of cells, for sections.
//!
//! The stress below the line l is a sum of convolutions along lines, T_(l − j) * p_j over the lines j. Each distance |l − j|
//! takes one line of closed forms and one transform for every two components. The mirrored side has the same transforms but
//! for signs, and one inverse transform yields the line. A section takes an eighth of the transforms of a plane, and half of
//! its closed forms if the line is in the middle.

use num_complex::Complex64;

use super::plane::{SIGNS, pair_of, pairs_below_wave, set_pair};
use super::{Source, Stress, SubsurfaceStress, Wave, corner};
use crate::error::Result;
use crate::kernel::HalfSpace;
use crate::memory;

/// Transforms and buffers for the stress below a line of cells, reused at every depth.
pub(super) struct LineBelow<'a> {
    stress: &'a SubsurfaceStress,
    /// The axis along the line, and the index of the line across it.
    axis: usize,
    line: usize,
    /// For each source the transforms of its lines, one after the other; empty for periodic bodies.
    spectra: Vec<Vec<Complex64>>,
    sums: [Vec<Complex64>; 3],
    term: Vec<Complex64>,
}

impl<'a> LineBelow<'a> {
    pub(super) fn new(stress: &'a SubsurfaceStress, axis: usize, line: usize) -> Result<LineBelow<'a>> {
        let period = stress.transform.periods()[axis];
        let spectra = match stress.body {
            HalfSpace::Periodic => Vec::new(),
            _ => stress.sources.iter().map(|source| lines_of(stress, axis, source)).collect::<Result<_>>()?,
        };
        let empty = || vec![Complex64::default(); period];
        Ok(LineBelow { stress, axis, line, spectra, sums: [empty(), empty(), empty()], term: empty() })
    }

    /// Calls `write` with each cell of the line and the stress below it.
    pub(super) fn at_depth(&mut self, depth: f64, mut write: impl FnMut(usize, Stress)) {
        self.sums.iter_mut().for_each(|sum| sum.fill(Complex64::default()));
        let SubsurfaceStress { grid, body, sources, transform, .. } = self.stress;
        for source in 0..sources.len() {
            if *body == HalfSpace::Periodic { self.add_waves(depth, source) } else { self.add_cells(depth, source) }
        }
        // waves, transformed along both axes, are summed across and transformed back along the line only
        let count = if *body == HalfSpace::Periodic { transform.len() } else { transform.periods()[self.axis] };
        let norm = 1.0 / count as f64;
        self.sums.iter_mut().for_each(|sum| transform.along[self.axis].inverse(sum));
        for k in 0..grid.cells()[self.axis] {
            let mut stress = Stress::default();
            (0..3).for_each(|pair| set_pair(&mut stress, pair, norm * self.sums[pair][k]));
            write(k, stress);
        }
    }

    /// Adds the stress due to the cells of a source.
    fn add_cells(&mut self, depth: f64, source: usize) {
        let LineBelow { stress, axis, line, spectra, sums, term } = self;
        let (axis, line, across, period) = (*axis, *line, 1 - *axis, term.len());
        let (cells, sides) = (stress.grid.cells(), stress.grid.spacing().map(|side| side / depth));
        let weights = stress.sources[source].weights;
        let of_line = |j: usize| &spectra[source][j * period..(j + 1) * period];
        let corners = |distance: f64, out: &mut Vec<Stress>| {
            let at = |k: usize| {
                let (along, aside) = ((k as f64 - 0.5) * sides[axis], distance * sides[across]);
                if axis == 0 { corner(along, aside, weights) } else { corner(aside, along, weights) }
            };
            out.clear();
            out.extend((0..=cells[axis]).map(at));
        };
        let (mut near, mut far) = (Vec::new(), Vec::new());
        corners(-0.5, &mut near);
        for distance in 0..=line.max(cells[across] - 1 - line) {
            corners(distance as f64 + 0.5, &mut far);
            for (pair, sum) in sums.iter_mut().enumerate() {
                let signs = pair_of(SIGNS[axis], pair);
                term.fill(Complex64::default());
                for k in 0..cells[axis] {
                    let own = (far[k + 1] + -1.0 * far[k]) + -1.0 * (near[k + 1] + -1.0 * near[k]);
                    let value = pair_of(own.components(), pair);
                    // the other way along the line
                    term[(period - k) % period] = Complex64::new(signs.re * value.re, signs.im * value.im);
                    term[k] = value;
                }
                stress.transform.along[axis].forward(term);
                if line >= distance {
                    let terms = term.iter().zip(of_line(line - distance));
                    sum.iter_mut().zip(terms).for_each(|(sum, (a, b))| *sum += a * b);
                }
                let beyond = line + distance;
                if distance > 0 && beyond < cells[across] {
                    // the transform of (a, −b) is the conjugate of the transform of (a, b) at the opposite wave
                    let mirrored = |k: usize| match (pair, across) {
                        (0, _) => term[k],
                        (2, 0) => -term[(period - k) % period].conj(),
                        _ => term[(period - k) % period].conj(),
                    };
                    let terms = of_line(beyond).iter().enumerate();
                    sum.iter_mut().zip(terms).for_each(|(sum, (k, b))| *sum += mirrored(k) * b);
                }
            }
            std::mem::swap(&mut near, &mut far);
        }
    }

    /// Adds the waves of a source, evaluated at the line's coordinate across it.
    fn add_waves(&mut self, depth: f64, source: usize) {
        let LineBelow { stress, axis, line, sums, .. } = self;
        let (axis, [n1, n2], [d1, d2]) = (*axis, stress.grid.cells(), stress.grid.spacing());
        let Source { spectrum, weights, .. } = &stress.sources[source];
        let cells = [n1, n2][1 - axis];
        let turns: Vec<Complex64> = (0..cells)
            .map(|k| Complex64::cis(std::f64::consts::TAU * ((k * *line) % cells) as f64 / cells as f64))
            .collect();
        for k1 in 0..n1 {
            let first = Wave::new(k1, n1, d1);
            for k2 in 0..n2 {
                let factors = pairs_below_wave([first, Wave::new(k2, n2, d2)], depth, *weights);
                let (along, across) = if axis == 0 { (k1, k2) } else { (k2, k1) };
                let amplitude = spectrum[k1 * n2 + k2] * turns[across];
                sums.iter_mut().zip(factors).for_each(|(sum, factor)| sum[along] += factor * amplitude);
            }
        }
    }
}

/// The transforms of the lines of a source along an axis.
fn lines_of(stress: &SubsurfaceStress, axis: usize, source: &Source) -> Result<Vec<Complex64>> {
    let ([n1, n2], period) = (stress.grid.cells(), stress.transform.periods()[axis]);
    let (along, across) = if axis == 0 { (n1, n2) } else { (n2, n1) };
    let mut lines = memory::field("the stress on a section", across * period, Complex64::default())?;
    for (j, line) in lines.chunks_exact_mut(period).enumerate() {
        for (k, value) in line[..along].iter_mut().enumerate() {
            *value = Complex64::from(source.field[if axis == 0 { k * n2 + j } else { j * n2 + k }]);
        }
    }
    stress.transform.along[axis].forward(&mut lines);
    Ok(lines)
}
