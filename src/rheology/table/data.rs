//! Checks of measured data before a fit.

use crate::rounded::rounded;
use std::fmt;

use crate::error::{Refusal, Result, least_length};
use crate::rheology::fit::{FitWarning, MOST_MISFIT, MaterialFunction, Sample};

/// A place in a table: the entry of a slice, or the line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    /// Index into the slices given.
    Entry(usize),
    /// Line of the file, from 1.
    Line(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Entry(index) => write!(f, "entry {index}"),
            Place::Line(line) => write!(f, "line {line}"),
        }
    }
}

/// One row of a table: its place, the abscissa, and one value for each column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeasuredRow {
    pub(crate) place: Place,
    pub(crate) x: f64,
    pub(crate) values: Vec<f64>,
    /// Number of measurements averaged in it.
    pub(crate) count: f64,
}

impl MeasuredRow {
    pub(crate) fn new(place: Place, x: f64, values: Vec<f64>) -> MeasuredRow {
        MeasuredRow { place, x, values, count: 1.0 }
    }

    /// Whether another measurement at the same abscissa agrees within what short tables may scatter.
    fn agrees(&self, other: &MeasuredRow) -> bool {
        let mut ratios = self.values.iter().zip(&other.values).map(|(one, other)| other / one);
        self.x == other.x && ratios.all(|ratio| (ratio - 1.0).abs() <= MOST_MISFIT)
    }
}

/// Rows of which those at the abscissa of the row before them, as where times are printed with few digits, are averaged
/// with it: two values at one time are two measurements. Values that contradict each other stay.
pub(crate) fn averaged_repeats(rows: Vec<MeasuredRow>) -> Vec<MeasuredRow> {
    let mut averaged: Vec<MeasuredRow> = Vec::with_capacity(rows.len());
    for row in rows {
        match averaged.last_mut().filter(|mean| mean.agrees(&row)) {
            Some(mean) => {
                mean.count += row.count;
                let share = row.count / mean.count;
                mean.values.iter_mut().zip(&row.values).for_each(|(mean, value)| *mean += share * (value - *mean));
            }
            None => averaged.push(row),
        }
    }
    averaged
}

/// What a table of measurements holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Experiment {
    /// Time \[s\] and creep compliance \[1/Pa\]: J in shear, D in tension.
    Creep,
    /// Time \[s\] and relaxation modulus \[Pa\]: G in shear, E in tension.
    Relaxation,
    /// Angular frequency \[rad/s\], storage and loss modulus \[Pa\]: G′, G″ in shear (rheometer), E′, E″ in tension
    /// (DMA).
    Dynamic,
    /// Angular frequency \[rad/s\] and storage modulus \[Pa\] alone.
    Storage,
}

/// What the headings of a file say about the deformation of the specimen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Deformation {
    /// Nothing, or numbers without headings.
    Unnamed,
    /// J, G, G′ or G″.
    Shear,
    /// D, E, E′ or E″.
    Tension,
}

impl Deformation {
    /// Rejects a table whose headings say otherwise than `wanted`.
    pub(crate) fn accepts(self, wanted: Deformation) -> Result<()> {
        if self == Deformation::Unnamed || self == wanted {
            return Ok(());
        }
        let (modulus, remedy) = if self == Deformation::Tension {
            ("tension", ": use Measurements::fit_tension and Material::from_tension")
        } else {
            ("shear", ": use Measurements::fit and a material made from shear")
        };
        let what = format!("the headings of the table name moduli in {modulus}");
        Err(Refusal::value("table_deformation", what, remedy).into())
    }
}

/// The columns of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) table: &'static str,
    pub(crate) abscissa: &'static str,
    /// Name and meaning of each column.
    pub(crate) columns: &'static [(&'static str, MaterialFunction)],
    /// Whether the abscissa is a time, which may be 0; else it is an angular frequency.
    pub(crate) is_over_time: bool,
}

impl Experiment {
    /// The factor of its values that belongs to a factor of moduli, and the reverse: compliances change as the
    /// reciprocal.
    pub(crate) fn of_modulus(self, factor: f64) -> f64 {
        if self == Experiment::Creep { 1.0 / factor } else { factor }
    }

    pub(crate) fn layout(self) -> Layout {
        let (table, columns): (_, &[_]) = match self {
            Experiment::Creep => ("creep table", &[("creep compliance", MaterialFunction::Creep)]),
            Experiment::Relaxation => ("relaxation table", &[("relaxation modulus", MaterialFunction::Relaxation)]),
            Experiment::Dynamic => (
                "dynamic table",
                &[("storage modulus", MaterialFunction::Storage), ("loss modulus", MaterialFunction::Loss)],
            ),
            Experiment::Storage => ("table of storage moduli", &[("storage modulus", MaterialFunction::Storage)]),
        };
        let is_over_time = matches!(self, Experiment::Creep | Experiment::Relaxation);
        Layout { table, abscissa: if is_over_time { "time" } else { "angular frequency" }, columns, is_over_time }
    }
}

/// What is scatter in a table, and what contradicts it (outliers.rs): chosen on tests/materials/one_bad_row.rs.
pub(super) struct Scatter {
    /// Data may deviate from a monotone curve by this many standard deviations of their scatter, ...
    pub(super) deviations: f64,
    /// ... but by no more than this, relatively: half and twice of it do as well.
    pub(super) most: f64,
    /// Rows on either side of one, by which its scatter and its slope are judged; tables of fewer than three times as
    /// many are short.
    pub(super) around: usize,
    /// Of so many rows, one may be an outlier: more are a property of the table, and fewer do not tell their scatter. Ten
    /// do as well.
    pub(super) per_outlier: usize,
    /// Relative deviations of outliers are at least this: less does little, and curves without scatter are continued no
    /// better. Half of it does as well.
    pub(super) least: f64,
    /// A fit of all samples leaves less of an outlier inside than a fit of the others, but at least this many
    /// deviations: one and four do as well.
    pub(super) suspect: f64,
    /// An end that deviates by more than this share of what makes it an outlier follows the curve of the others poorly.
    pub(super) doubtful: f64,
}

pub(super) const SCATTER: Scatter =
    Scatter { deviations: 6.0, most: 0.5, around: 4, per_outlier: 20, least: 1e-2, suspect: 2.0, doubtful: 0.4 };

/// Number of values for a fit of constant, slope and one term.
pub(super) const LEAST_ROWS: usize = 4;

/// Sorts the rows of a table. Returns its samples, in ascending order.
pub(crate) fn sorted_samples(layout: Layout, rows: &mut [MeasuredRow]) -> Result<Vec<Sample>> {
    let Layout { table, abscissa, columns, is_over_time } = layout;
    for MeasuredRow { place, x, values, .. } in &*rows {
        let check = |column, value, inside, allowed| {
            let what = || format!("{table}, {place}: {column} = {value:?} is not allowed: it must be {allowed}");
            let refused =
                || Refusal::value("table_out_of_range", what(), "; leave out rows without a value").naming(column);
            if inside { Ok(()) } else { Err(refused().valued(value).allowing(allowed)) }
        };
        let allowed = if is_over_time { "0, or in [1e-90, 1e90]" } else { "in [1e-90, 1e90]" };
        check(abscissa, *x, *x == 0.0 && is_over_time || (1e-90..=1e90).contains(x), allowed)?;
        for (&value, &(column, _)) in values.iter().zip(columns) {
            check(column, value, value.is_finite() && value > 0.0, "finite and > 0")?;
        }
    }
    rows.sort_by(|a, b| a.x.total_cmp(&b.x));
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].x == pair[1].x) {
        let (earlier, place, value) = (pair[0].place, pair[1].place, pair[0].x);
        let what = format!("{table}: {place} and {earlier} give two values for {abscissa} = {value}");
        let remedy = ": give their mean, take one section of the file (TextTable::section), or read several \
            temperatures as isotherms (Isotherm::from_csv_reader)";
        return Err(Refusal::value("table_duplicate", what, remedy).naming(abscissa).valued(value).into());
    }
    least_length(table, rows.len(), LEAST_ROWS)?;
    let sample = |index: usize, function| {
        rows.iter().map(move |row| Sample { function, x: row.x, value: row.values[index], weight: row.count })
    };
    Ok(columns.iter().enumerate().flat_map(|(index, &(_, function))| sample(index, function)).collect())
}

/// The maximum deviation of sorted rows from a monotone curve: an error where it exceeds what the scatter of the
/// rows around explains, or the relative `scatter`, if it is stated; a warning, if one row of a hundred or fewer
/// does, by a tenth at most.
pub(crate) fn check_monotone(
    layout: Layout,
    rows: &[MeasuredRow],
    scatter: Option<f64>,
) -> Result<(f64, Option<FitWarning>)> {
    let Layout { table, columns, .. } = layout;
    let (mut greatest, mut knock): (f64, _) = (0.0, None);
    for (index, &(column, function)) in columns.iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.values[index]).collect();
        let rising = match function {
            MaterialFunction::Creep | MaterialFunction::Storage => values,
            MaterialFunction::Relaxation => values.iter().map(|value| 1.0 / value).collect(),
            MaterialFunction::Loss => continue,
        };
        let deviations = SCATTER.deviations;
        // in short tables, scatter is hard to distinguish from the trend
        let most = if are_few(rows.len()) { MOST_MISFIT } else { SCATTER.most };
        let everywhere = median_scatter(&second_differences(&rising)).max(1.5 * quantum(&rising) / deviations);
        let explained = |row: usize| match scatter {
            Some(scatter) => deviations * scatter,
            // data without noise deviate by the rounding of their digits
            None => (deviations * everywhere.max(scatter_around(&rising, row))).clamp(1e-9, most),
        };
        let curve = nearest_monotone(&rising);
        let changes: Vec<f64> = rising.iter().zip(&curve).map(|(value, curve)| (value / curve - 1.0).abs()).collect();
        let excesses: Vec<f64> = changes.iter().enumerate().map(|(row, change)| change / explained(row)).collect();
        let Some(worst) = (0..rows.len()).max_by(|&a, &b| excesses[a].total_cmp(&excesses[b])) else { continue };
        let (change, noise) = (changes[worst], explained(worst));
        if change > noise {
            let off = excesses.iter().filter(|excess| **excess > 1.0).count();
            let MeasuredRow { place, ref values, .. } = rows[worst];
            // one row of a hundred moves the curve by a hundredth of its deviation: it may go the wrong way
            if off * 100 > rows.len() || change > MOST_MISFIT {
                let (value, [off, noise]) = (values[index], [change, noise].map(|part| 100.0 * part));
                let what = format!(
                    "{table}, {place}: {column} = {} deviates by {off:.2} % from the nearest monotone curve, where \
                     the scatter of the data explains {noise:.2} %",
                    rounded(value, 5)
                );
                let remedy = ": compliances rise, moduli of relaxation fall (Experiment); Measurements::with_scatter \
                    states more scatter";
                return Err(Refusal::value("table_wrong_way", what, remedy).naming(column).valued(value).into());
            }
            // rows after a knock deviate, too
            let Some(most) = (0..rows.len()).max_by(|&a, &b| changes[a].total_cmp(&changes[b])) else { continue };
            let (x, change, rises) = (rows[most].x, changes[most], rising[most] > curve[most]);
            let deviation = if rises == (function != MaterialFunction::Relaxation) { change } else { -change };
            knock = Some(FitWarning::Outlier { x, deviation });
        }
        greatest = greatest.max(change);
    }
    Ok((greatest, knock))
}

/// The non-decreasing curve nearest to the values: decreasing neighbours are pooled into their mean, until there are
/// none.
fn nearest_monotone(values: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::with_capacity(values.len());
    for &value in values {
        pools.push((value, 1));
        while let [.., (before, n), (last, m)] = pools[..] {
            if before <= last {
                break;
            }
            pools.truncate(pools.len() - 2);
            pools.push(((before * n as f64 + last * m as f64) / (n + m) as f64, n + m));
        }
    }
    pools.into_iter().flat_map(|(mean, count)| std::iter::repeat_n(mean, count)).collect()
}

/// The least relative step between unequal neighbours: for values printed with few digits, one in the last.
fn quantum(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|w| (w[1] / w[0] - 1.0).abs()).filter(|step| *step > 0.0);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Relative second differences of values over their standard deviation for white noise of one.
fn second_differences(values: &[f64]) -> Vec<f64> {
    values.windows(3).map(|w| ((w[0] - 2.0 * w[1] + w[2]) / w[1]).abs() / 6f64.sqrt()).collect()
}

/// The standard deviation of values around zero, from the median of their magnitudes, which a few outliers or a kink
/// do not change.
pub(super) fn median_scatter(magnitudes: &[f64]) -> f64 {
    // the median of |N(0, σ)| is 0.6745 σ
    median(magnitudes.to_vec()).map_or(0.0, |median| median / 0.6745)
}

pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Whether a table is too short for [`Scatter::around`].
fn are_few(rows: usize) -> bool {
    rows < 3 * SCATTER.around
}

/// The same of the rows around one: a pair of rows that contradict each other scatters, a single outlier does not.
fn scatter_around(values: &[f64], row: usize) -> f64 {
    if are_few(values.len()) {
        return 0.0;
    }
    let around = SCATTER.around;
    let from = row.saturating_sub(around).min(values.len() - 2 * around - 1);
    median_scatter(&second_differences(&values[from..=from + 2 * around]))
}
