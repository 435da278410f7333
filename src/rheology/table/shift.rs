//! The shift of one isotherm relative to another.
//!
//! Every row of either isotherm is compared with the straight line through its neighbours in the other, in every
//! column, relative to the scatter of the column. The logarithm of 1 + z² in place of z² makes outliers, and the end
//! of a column that the machine spoils, cost little. The column that determines the shift best finds it first, by the
//! fewest decades of the union, so that two ends which match by chance are not taken for the overlap; all columns
//! refine it.

use super::data::{TableRow, median_scatter};
use super::isotherm::Isotherm;
use crate::error::{Error, Refusal, Result};
use crate::numeric;

/// Shifts tried before the best is refined.
const TRIED: usize = 400;
/// Fraction of the shorter isotherm that must overlap.
const LEAST_OVERLAP: f64 = 0.1;
/// Relative scatter below which values are as good as exact: the line between two rows is no better.
const LEAST_SCATTER: f64 = 2e-3;
/// Isotherms of one body superpose at least so well in a column: worse, they are of no thermorheologically simple body
/// and match somewhere by chance. Scatters are tried in steps of this factor.
const MOST_MODEL_ERROR: f64 = 0.1;
const LADDER: f64 = 1.5;
/// Least mean of ln(1 + z²): 0.53 of a normal deviate, and more with an outlier in thirty rows, of which each spoils
/// three differences.
const EXPECTED: f64 = 0.75;
/// Price of a decade of the union.
const PER_DECADE: f64 = 4.0;
/// Rows on either side of a row through which its slope is taken.
const AROUND: usize = 4;
/// Shifts whose difference is less than this above the least are as good.
const AS_GOOD: f64 = 8.0;
/// The squared error over the squared error of independent differences: each is counted from both sides, and outliers
/// count less.
const INFLATION: f64 = 6.0;
/// Few differences tell their own scatter poorly: three deviations of Student's t with n degrees of freedom, squared,
/// are about 1 + 6/n times as great as three of the normal law. Half of the differences are independent.
const FEW: f64 = 12.0;
/// Shifts that differ by less, in ln a, agree: 0.05 decades.
const LEAST_DISAGREEMENT: f64 = 0.115;
/// ln of the values may differ by this in the root mean square where two isotherms overlap.
const MOST_APART: f64 = 0.3;

/// A shift and its standard error, in ln a.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Shift {
    pub(super) log: f64,
    pub(super) error: f64,
    /// ln of the factor of the values of the warmer, 0 if they are not to be shifted.
    pub(super) vertical: f64,
    /// The shifts by storage and by loss moduli alone differ by this, if it is more than their errors explain.
    pub(super) disagreement: f64,
}

/// A row of one isotherm against the other: difference in the sense of the first minus the second.
struct Difference {
    column: usize,
    value: f64,
    /// Its variance over the variance of a value.
    variance: f64,
    /// Its slope over the shift, and the variance of the slope over the variance of a value.
    slope: [f64; 2],
}

struct Pair<'a> {
    isotherms: [&'a Isotherm; 2],
    /// Of each isotherm and column, at each row.
    slopes: [Vec<Vec<[f64; 2]>>; 2],
    /// What a difference of each column costs as a rule. Were it less, isotherms would flee from an overlap that has
    /// outliers.
    usual: Vec<f64>,
    /// Whether values may differ by a factor, the same in all columns.
    is_vertical: bool,
}

/// The shift of `warmer` relative to `colder`.
pub(super) fn shift_between(colder: &Isotherm, warmer: &Isotherm, is_vertical: bool) -> Result<Shift> {
    let (isotherms, columns) = ([colder, warmer], colder.rows[0].values.len());
    let slopes = isotherms.map(|isotherm| (0..columns).map(|column| slopes(isotherm, column)).collect());
    let temperatures = [colder.temperature(), warmer.temperature()];
    let all: Vec<usize> = (0..columns).collect();
    let scattered = |&column: &usize| {
        let offs = isotherms.map(|isotherm| off_lines(isotherm, column));
        let scatter = offs.iter().map(|offs| median_scatter(offs)).fold(LEAST_SCATTER, f64::max);
        let costs: Vec<f64> = offs.iter().flatten().map(|off| (off / scatter).powi(2).ln_1p()).collect();
        (scatter, (costs.iter().sum::<f64>() / costs.len().max(1) as f64).max(EXPECTED))
    };
    let (mut scatter, usual): (Vec<f64>, Vec<f64>) = all.iter().map(scattered).unzip();
    let pair = Pair { isotherms, slopes, usual, is_vertical };
    let is_constant = |isotherm: &Isotherm| {
        let logs = || isotherm.rows.iter().map(|row| row.values[0].ln());
        logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min) < 1e-6
    };
    if is_constant(colder) || is_constant(warmer) {
        return Err(nothing_to_shift(temperatures));
    }
    let ([c0, c1], [w0, w1]) = (colder.span(), warmer.span());
    let least = LEAST_OVERLAP * (c1 - c0).min(w1 - w0);
    let (low, high) = (w0 - c1 + least, w1 - c0 - least);
    let step = (high - low) / TRIED as f64;
    let decades = |shift: f64| (c1.max(w1 - shift) - c0.min(w0 - shift)) / std::f64::consts::LN_10;
    // by the column that determines it best: another may be disturbed
    let mut by_column: Vec<(f64, f64)> = Vec::new();
    for &column in &all {
        let at_scatter = |scatter: &[f64]| {
            numeric::minimum(low, high, TRIED, |by| pair.cost(by, &[column], scatter) + PER_DECADE * decades(by))
        };
        let is_inside = |shift: f64| (shift - low).min(high - shift) > 0.5 * step;
        let shift = pair.superposed(column, &mut scatter, at_scatter, is_inside);
        by_column.push((shift, pair.error(shift, [low, high], &[column], &scatter)));
    }
    let mut shift = by_column.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |best| best.0);
    let mut residual = scatter.clone();
    for _ in 0..3 {
        residual = all.iter().map(|&column| pair.residual(shift, column, scatter[column])).collect();
        shift = pair.refined(shift, [low, high], 0.015, (&all, &residual));
    }
    // at the least overlap allowed, the values of the two hardly overlap
    let at_end = (shift - low).min(high - shift) < 0.5 * step;
    let apart = residual.iter().copied().fold(f64::INFINITY, f64::min);
    if at_end || apart > MOST_APART {
        let wide = vec![MOST_MODEL_ERROR; columns];
        let cost = |shift: f64| pair.cost(shift, &all, &wide) + PER_DECADE * decades(shift);
        let widest = numeric::minimum(low, high, TRIED, cost);
        let overlap = (c1 - c0 + w1 - w0) / std::f64::consts::LN_10 - decades(widest);
        let of_column = |&column: &usize| pair.residual(widest, column, 0.0);
        let there = all.iter().map(of_column).fold(f64::INFINITY, f64::min);
        return Err(no_overlap(temperatures, overlap, apart, there));
    }
    let error = pair.error(shift, [low, high], &all, &residual);
    let mut disagreement: f64 = 0.0;
    if let [storage, loss] = all[..] {
        let alone = [storage, loss].map(|column| {
            let at = pair.refined(shift, [low, high], 0.15, (&[column], &scatter));
            let residual = vec![pair.residual(at, column, scatter[column]); 2];
            (at, pair.error(at, [low, high], &[column], &residual))
        });
        let (between, by_error) = ((alone[0].0 - alone[1].0).abs(), alone[0].1.hypot(alone[1].1));
        disagreement = if between > LEAST_DISAGREEMENT.max(3.0 * by_error) { between } else { 0.0 };
    }
    Ok(Shift { log: shift, error, vertical: -pair.factor(shift, &all), disagreement })
}

impl Pair<'_> {
    /// The shift by one column, and its scatter: the least with which the isotherms superpose as well as it says,
    /// inside the range. Smooth isotherms superpose less well than their scatter, for no model of the body is exact;
    /// with too small a scatter, each difference costs so much that the shift flees from the overlap.
    fn superposed(
        &self,
        column: usize,
        scatter: &mut [f64],
        at_scatter: impl Fn(&[f64]) -> f64,
        is_inside: impl Fn(f64) -> bool,
    ) -> f64 {
        let (own, first) = (scatter[column], at_scatter(scatter));
        let mut shift = first;
        loop {
            let residual = self.residual(shift, column, scatter[column]);
            if is_inside(shift) && residual <= LADDER * scatter[column] {
                scatter[column] = residual.max(scatter[column]);
                return shift;
            }
            if scatter[column] > MOST_MODEL_ERROR {
                scatter[column] = own;
                return first;
            }
            scatter[column] *= LADDER;
            shift = at_scatter(scatter);
        }
    }

    fn differences(&self, shift: f64, columns: &[usize], mut take: impl FnMut(Difference)) {
        let [colder, warmer] = self.isotherms;
        // warmer at ln t is at ln t − shift on the axis of colder
        let [of_colder, of_warmer] = &self.slopes;
        for (one, other, slopes, sign) in [(colder, warmer, of_warmer, 1.0), (warmer, colder, of_colder, -1.0)] {
            for row in &one.rows {
                let Some((k, part)) = place(other, one.log_time(row) + sign * shift) else { continue };
                for &column in columns {
                    let [a, b] = [k - 1, k].map(|k| other.rows[k].values[column].ln());
                    take(Difference {
                        column,
                        value: sign * (row.values[column].ln() - (a + part * (b - a))),
                        variance: 1.0 + part * part + (1.0 - part) * (1.0 - part),
                        slope: slopes[column][k],
                    });
                }
            }
        }
    }

    /// The median of the differences, 0 if values are not to be shifted.
    fn factor(&self, shift: f64, columns: &[usize]) -> f64 {
        let mut values = Vec::new();
        if self.is_vertical {
            self.differences(shift, columns, |found| values.push(found.value));
        }
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    }

    /// The scatter of the differences of a column at a shift.
    fn residual(&self, shift: f64, column: usize, scatter: f64) -> f64 {
        let (mut values, factor) = (Vec::new(), self.factor(shift, &[column]));
        self.differences(shift, &[column], |found| values.push((found.value - factor).abs() / found.variance.sqrt()));
        if values.is_empty() { scatter } else { median_scatter(&values).max(0.3 * scatter) }
    }

    fn cost(&self, shift: f64, columns: &[usize], scatter: &[f64]) -> f64 {
        let factor = self.factor(shift, columns);
        // values of neighbours differ by little: a factor of two costs what makes another shift as good
        let mut sum = AS_GOOD * (factor / std::f64::consts::LN_2).powi(2);
        self.differences(shift, columns, |found| {
            let z = (found.value - factor) / scatter[found.column];
            sum += (z * z / found.variance).ln_1p() - self.usual[found.column];
        });
        sum
    }

    /// The shift of least cost in a part of the range around another.
    fn refined(&self, near: f64, [low, high]: [f64; 2], part: f64, (columns, scatter): (&[usize], &[f64])) -> f64 {
        let around = part * (high - low);
        numeric::minimum((near - around).max(low), (near + around).min(high), 48, |shift| {
            self.cost(shift, columns, scatter)
        })
    }

    /// The standard error of a shift: by the slopes, or as far as shifts are as good.
    fn error(&self, shift: f64, [low, high]: [f64; 2], columns: &[usize], scatter: &[f64]) -> f64 {
        let (mut sums, mut count, factor) = ([0.0; 3], 0.0, self.factor(shift, columns));
        self.differences(shift, columns, |found| {
            let scatter = scatter[found.column];
            let robust = 1.0 / (1.0 + (0.5 * (found.value - factor) / scatter).powi(2) / found.variance);
            let weight = robust / (found.variance * scatter * scatter);
            let [slope, variance] = found.slope;
            // noise makes slopes where there are none
            let square = slope * slope - variance * scatter * scatter;
            count += 1.0;
            sums.iter_mut().zip([1.0, slope, square]).for_each(|(sum, part)| *sum += weight * part);
        });
        // of slopes that are alike a factor takes the place of a shift
        let information = sums[2] - if self.is_vertical { sums[1] * sums[1] / sums[0] } else { 0.0 };
        let by_slopes =
            if information > 0.0 { (INFLATION * (1.0 + FEW / count) / information).sqrt() } else { high - low };
        let least = self.cost(shift, columns, scatter);
        let tried = (0..=TRIED).map(|k| low + (high - low) * k as f64 / TRIED as f64);
        // with a factor, curves that are nearly powers of time superpose at any shift
        let near = tried.filter(|other| self.is_vertical || (other - shift).abs() < 0.1 * (high - low));
        let as_good = near.filter(|&other| self.cost(other, columns, scatter) < least + AS_GOOD);
        as_good.map(|other| (other - shift).abs()).fold(by_slopes, f64::max)
    }
}

/// The distance of each inner row from the line between its neighbours, over its standard deviation for a scatter of
/// one.
fn off_lines(isotherm: &Isotherm, column: usize) -> Vec<f64> {
    let points: Vec<(f64, f64)> =
        isotherm.rows.iter().map(|row| (isotherm.log_time(row), row.values[column].ln())).collect();
    let off = |own: &[(f64, f64)]| {
        let [before, point, after] = [own[0], own[1], own[2]];
        let part = (point.0 - before.0) / (after.0 - before.0);
        let line = before.1 + part * (after.1 - before.1);
        (point.1 - line).abs() / (1.0 + part * part + (1.0 - part) * (1.0 - part)).sqrt()
    };
    points.windows(3).map(off).collect()
}

/// The row after ln t, and the part of the way to it from the row before.
fn place(isotherm: &Isotherm, log_time: f64) -> Option<(usize, f64)> {
    let at = |k: usize| isotherm.log_time(&isotherm.rows[k]);
    // rows of frequencies descend in time
    let rising = at(0) < at(isotherm.rows.len() - 1);
    let is_before =
        |row: &TableRow| if rising { isotherm.log_time(row) < log_time } else { isotherm.log_time(row) > log_time };
    let next = isotherm.rows.partition_point(is_before);
    let k = next.max(1);
    let part = (log_time - at(k - 1)) / (at(k.min(isotherm.rows.len() - 1)) - at(k - 1));
    (k < isotherm.rows.len() && (0.0..=1.0).contains(&part)).then_some((k, part))
}

/// The slope of a column over ln t at each row, the median of the slopes between the rows around, which outliers move
/// little (P. K. Sen, J. Am. Stat. Assoc. 63, 1968), and the variance of such a slope by least squares, over the
/// variance of a value.
fn slopes(isotherm: &Isotherm, column: usize) -> Vec<[f64; 2]> {
    let points: Vec<[f64; 2]> =
        isotherm.rows.iter().map(|row| [isotherm.log_time(row), row.values[column].ln()]).collect();
    let around = |k: usize| {
        let own = &points[k.saturating_sub(AROUND)..points.len().min(k + AROUND)];
        let pairs =
            own.iter().enumerate().flat_map(|(n, a)| own[n + 1..].iter().map(move |b| (b[1] - a[1]) / (b[0] - a[0])));
        let mut slopes: Vec<f64> = pairs.collect();
        slopes.sort_by(f64::total_cmp);
        let mean = own.iter().map(|point| point[0]).sum::<f64>() / own.len() as f64;
        let squares: f64 = own.iter().map(|point| (point[0] - mean).powi(2)).sum();
        [slopes[slopes.len() / 2], 1.0 / squares]
    };
    (0..points.len()).map(around).collect()
}

/// The error of an isotherm that is constant in time.
fn nothing_to_shift(temperatures: [f64; 2]) -> Error {
    let [colder, warmer] = temperatures;
    let what = format!(
        "one of the isotherms at {colder} K and {warmer} K is constant in time: its shift cannot be determined"
    );
    Refusal::value("table_nothing_to_shift", what, "; use MasterCurve::with_law").into()
}

/// The error of isotherms whose values do not overlap: the decades of the widest overlap in which they are near each
/// other, and how far they are apart at the best shift and there.
fn no_overlap(temperatures: [f64; 2], overlap: f64, apart: f64, there: f64) -> Error {
    let [colder, warmer] = temperatures;
    let what = format!(
        "the isotherms at {colder} K and {warmer} K do not overlap in their values: at the best shift they differ by \
         {:.0} %, and where they overlap by {overlap:.1} decades by {:.0} %",
        100.0 * apart,
        100.0 * there
    );
    let remedy = "; measure at a temperature in between, or use MasterCurve::with_law";
    Refusal::value("table_no_overlap", what, remedy).into()
}
