//! The shift of one isotherm relative to another.
//!
//! Every row of either isotherm is compared with the straight line through its neighbours in the other, in every
//! column, relative to the scatter of the column. The logarithm of 1 + z² in place of z² makes outliers, and the end
//! of a column that the machine spoils, cost little. The column that determines the shift best finds it first, by the
//! fewest decades of the union, so that two ends which match by chance are not taken for the overlap; all columns
//! refine it.

use std::f64::consts::{LN_2, LN_10};

use super::data::{SCATTER, median, median_scatter};
use super::isotherm::Isotherm;
use crate::error::{Error, Refusal, Result};
use crate::numeric;

/// How isotherms are shifted: chosen on the random isotherms of tests/materials/measured/populations.rs.
struct Shifting {
    /// Shifts tried before the best is refined.
    tried: usize,
    /// Fraction of the shorter isotherm that must overlap.
    least_overlap: f64,
    /// Relative scatter below which values are as good as exact: the line between two rows is no better.
    least_scatter: f64,
    /// Isotherms of one body superpose at least so well in a column: worse, they are of no thermorheologically simple
    /// body and match somewhere by chance. Scatters are tried in steps of the factor `ladder`.
    most_model_error: f64,
    ladder: f64,
    /// Least mean of ln(1 + z²): 0.53 of a normal deviate, and more with an outlier in thirty rows, of which each
    /// spoils three differences.
    expected: f64,
    /// Price of a decade of the union.
    per_decade: f64,
    /// Shifts whose difference is less than this above the least are as good.
    as_good: f64,
    /// The squared error over the squared error of independent differences: each is counted from both sides, and
    /// outliers count less. Half of it does as well.
    inflation: f64,
    /// ln of the values may differ by this in the root mean square where two isotherms overlap.
    most_apart: f64,
}

const SHIFTING: Shifting = Shifting {
    tried: 400,
    least_overlap: 0.1,
    least_scatter: 2e-3,
    most_model_error: 0.1,
    ladder: 1.5,
    expected: 0.75,
    per_decade: 4.0,
    as_good: 8.0,
    inflation: 6.0,
    most_apart: 0.3,
};

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
    /// Of each isotherm and column, before each row.
    slopes: [Vec<Vec<[f64; 2]>>; 2],
    /// What a difference of each column costs as a rule. Were it less, isotherms would flee from an overlap that has
    /// outliers.
    usual: Vec<f64>,
    /// Whether values may differ by a factor, the same in all columns.
    is_vertical: bool,
    /// The shifts at which the two just overlap enough.
    range: [f64; 2],
}

/// The shift of `warmer` relative to `colder`.
pub(super) fn shift_between(colder: &Isotherm, warmer: &Isotherm, is_vertical: bool) -> Result<Shift> {
    let (isotherms, temperatures) = ([colder, warmer], [colder.temperature(), warmer.temperature()]);
    let is_constant = |isotherm: &Isotherm| {
        let logs = || isotherm.rows.iter().map(|row| row.values[0].ln());
        logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min) < 1e-6
    };
    if isotherms.into_iter().any(is_constant) {
        return Err(nothing_to_shift(temperatures));
    }
    let (pair, mut scatter) = Pair::new(isotherms, is_vertical);
    let all: Vec<usize> = (0..scatter.len()).collect();
    // by the column that determines it best: another may be disturbed
    let by_column = all.iter().map(|&column| {
        let shift = pair.superposed(column, &mut scatter);
        (shift, pair.error(shift, &[column], &scatter))
    });
    let mut shift = by_column.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |best| best.0);
    let mut residual = scatter.clone();
    for _ in 0..3 {
        residual = all.iter().map(|&column| pair.residual(shift, column, scatter[column])).collect();
        shift = pair.refined(shift, 0.015, &all, &residual);
    }
    // at the least overlap allowed, the values of the two hardly overlap
    let apart = residual.iter().copied().fold(f64::INFINITY, f64::min);
    if !pair.is_inside(shift) || apart > SHIFTING.most_apart {
        let widest = pair.best(&all, &vec![SHIFTING.most_model_error; all.len()]);
        let spans = isotherms.iter().map(|isotherm| isotherm.span()).map(|[first, last]| last - first);
        let overlap = spans.sum::<f64>() / LN_10 - pair.decades(widest);
        let of_column = |&column: &usize| pair.residual(widest, column, 0.0);
        let there = all.iter().map(of_column).fold(f64::INFINITY, f64::min);
        return Err(no_overlap(temperatures, overlap, apart, there));
    }
    let disagreement = if all.len() == 2 { pair.disagreement(shift, &scatter) } else { 0.0 };
    let error = pair.error(shift, &all, &residual);
    Ok(Shift { log: shift, error, vertical: -pair.factor(shift, &all), disagreement })
}

impl<'a> Pair<'a> {
    /// Two isotherms, and the scatter of each column.
    fn new(isotherms: [&'a Isotherm; 2], is_vertical: bool) -> (Pair<'a>, Vec<f64>) {
        let columns = 0..isotherms[0].rows[0].values.len();
        let scattered = |column: usize| {
            let offs = isotherms.map(|isotherm| off_lines(isotherm, column));
            let scatter = offs.iter().map(|offs| median_scatter(offs)).fold(SHIFTING.least_scatter, f64::max);
            let costs: Vec<f64> = offs.iter().flatten().map(|off| (off / scatter).powi(2).ln_1p()).collect();
            (scatter, (costs.iter().sum::<f64>() / costs.len().max(1) as f64).max(SHIFTING.expected))
        };
        let (scatter, usual) = columns.clone().map(scattered).unzip();
        let slopes = isotherms.map(|isotherm| columns.clone().map(|column| slopes(isotherm, column)).collect());
        let [[c0, c1], [w0, w1]] = isotherms.map(Isotherm::span);
        let least = SHIFTING.least_overlap * (c1 - c0).min(w1 - w0);
        (Pair { isotherms, slopes, usual, is_vertical, range: [w0 - c1 + least, w1 - c0 - least] }, scatter)
    }

    /// Decades of the union of the two.
    fn decades(&self, shift: f64) -> f64 {
        let [[c0, c1], [w0, w1]] = self.isotherms.map(Isotherm::span);
        (c1.max(w1 - shift) - c0.min(w0 - shift)) / LN_10
    }

    fn is_inside(&self, shift: f64) -> bool {
        let [low, high] = self.range;
        (shift - low).min(high - shift) > 0.5 * (high - low) / SHIFTING.tried as f64
    }

    /// The shift of least cost in the whole range.
    fn best(&self, columns: &[usize], scatter: &[f64]) -> f64 {
        let cost = |shift: f64| self.cost(shift, columns, scatter) + SHIFTING.per_decade * self.decades(shift);
        numeric::minimum(self.range[0], self.range[1], SHIFTING.tried, cost)
    }

    /// The shift by one column, and its scatter: the least with which the isotherms superpose as well as it says,
    /// inside the range. Smooth isotherms superpose less well than their scatter, for no model of the body is exact;
    /// with too small a scatter, each difference costs so much that the shift flees from the overlap.
    fn superposed(&self, column: usize, scatter: &mut [f64]) -> f64 {
        let (own, first) = (scatter[column], self.best(&[column], scatter));
        let mut shift = first;
        loop {
            let residual = self.residual(shift, column, scatter[column]);
            if self.is_inside(shift) && residual <= SHIFTING.ladder * scatter[column] {
                scatter[column] = residual.max(scatter[column]);
                return shift;
            }
            if scatter[column] > SHIFTING.most_model_error {
                scatter[column] = own;
                return first;
            }
            scatter[column] *= SHIFTING.ladder;
            shift = self.best(&[column], scatter);
        }
    }

    /// By how much the shifts of two columns alone differ, if it is more than 0.05 decades and than their errors explain.
    fn disagreement(&self, shift: f64, scatter: &[f64]) -> f64 {
        let [one, other] = [0, 1].map(|column| {
            let at = self.refined(shift, 0.15, &[column], scatter);
            let residual = self.residual(at, column, scatter[column]);
            (at, self.error(at, &[column], &[residual; 2]))
        });
        let (between, by_error) = ((one.0 - other.0).abs(), one.1.hypot(other.1));
        if between > (0.05 * std::f64::consts::LN_10).max(3.0 * by_error) { between } else { 0.0 }
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
        median(values).unwrap_or(0.0)
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
        let mut sum = SHIFTING.as_good * (factor / LN_2).powi(2);
        self.differences(shift, columns, |found| {
            let z = (found.value - factor) / scatter[found.column];
            sum += (z * z / found.variance).ln_1p() - self.usual[found.column];
        });
        sum
    }

    /// The shift of least cost in a part of the range around another.
    fn refined(&self, near: f64, part: f64, columns: &[usize], scatter: &[f64]) -> f64 {
        let ([low, high], cost) = (self.range, |shift| self.cost(shift, columns, scatter));
        let around = part * (high - low);
        numeric::minimum((near - around).max(low), (near + around).min(high), 48, cost)
    }

    /// The standard error of a shift: by the slopes, or as far as shifts are as good. Few differences tell their own
    /// scatter poorly: three deviations of Student's t with n degrees of freedom, squared, are about 1 + 6/n times as
    /// great as three of the normal law, and half of the differences are independent.
    fn error(&self, shift: f64, columns: &[usize], scatter: &[f64]) -> f64 {
        let [low, high] = self.range;
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
        let noise = SHIFTING.inflation * (1.0 + 12.0 / count);
        let by_slopes = if information > 0.0 { (noise / information).sqrt() } else { high - low };
        let least = self.cost(shift, columns, scatter);
        let tried = (0..=SHIFTING.tried).map(|k| low + (high - low) * k as f64 / SHIFTING.tried as f64);
        // with a factor, curves that are nearly powers of time superpose at any shift
        let near = tried.filter(|other| self.is_vertical || (other - shift).abs() < 0.1 * (high - low));
        let as_good = near.filter(|&other| self.cost(other, columns, scatter) < least + SHIFTING.as_good);
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
    let (rows, at) = (&isotherm.rows, |k: usize| isotherm.rows[k].x.ln());
    // rows of frequencies descend in time
    let x = if isotherm.experiment.layout().is_over_time { log_time } else { -log_time };
    let k = rows.partition_point(|row| row.x.ln() < x).max(1);
    let part = (x - at(k - 1)) / (at(k.min(rows.len() - 1)) - at(k - 1));
    (k < rows.len() && (0.0..=1.0).contains(&part)).then_some((k, part))
}

/// The slope of a column over ln t before each row, the median of the slopes between the rows around, which outliers
/// move little (P. K. Sen, J. Am. Stat. Assoc. 63, 1968), and the variance of such a slope by least squares, over the
/// variance of a value.
fn slopes(isotherm: &Isotherm, column: usize) -> Vec<[f64; 2]> {
    let points: Vec<[f64; 2]> =
        isotherm.rows.iter().map(|row| [isotherm.log_time(row), row.values[column].ln()]).collect();
    let around = |k: usize| {
        let own = &points[k.saturating_sub(SCATTER.around)..points.len().min(k + SCATTER.around)];
        let pairs =
            own.iter().enumerate().flat_map(|(n, a)| own[n + 1..].iter().map(move |b| (b[1] - a[1]) / (b[0] - a[0])));
        let mean = own.iter().map(|point| point[0]).sum::<f64>() / own.len() as f64;
        let squares: f64 = own.iter().map(|point| (point[0] - mean).powi(2)).sum();
        [median(pairs.collect()).unwrap_or(f64::NAN), 1.0 / squares]
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
