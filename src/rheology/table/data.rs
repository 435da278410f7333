//! Checks of measured data before a fit.

use crate::rounded::rounded;
use std::fmt;

use crate::error::{Refusal, Result, least_length};
use crate::rheology::fit::{FitWarning, MaterialFunction, Sample};

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
pub(crate) struct TableRow {
    pub(crate) place: Place,
    pub(crate) x: f64,
    pub(crate) values: Vec<f64>,
    /// Number of measurements averaged in it.
    pub(crate) count: f64,
}

impl TableRow {
    pub(crate) fn new(place: Place, x: f64, values: Vec<f64>) -> TableRow {
        TableRow { place, x, values, count: 1.0 }
    }

    /// Whether another measurement at the same abscissa agrees within what short tables may scatter.
    fn agrees(&self, other: &TableRow) -> bool {
        let mut ratios = self.values.iter().zip(&other.values).map(|(one, other)| other / one);
        self.x == other.x && ratios.all(|ratio| (ratio - 1.0).abs() <= MOST_NOISE_OF_FEW)
    }
}

/// Rows of which those at the abscissa of the row before them, as where times are printed with few digits, are averaged
/// with it: two values at one time are two measurements. Values that contradict each other stay.
pub(crate) fn averaged_repeats(rows: Vec<TableRow>) -> Vec<TableRow> {
    let mut averaged: Vec<TableRow> = Vec::with_capacity(rows.len());
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
    /// Whether an abscissa of zero is allowed.
    pub(crate) zero: bool,
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
        let zero = matches!(self, Experiment::Creep | Experiment::Relaxation);
        Layout { table, abscissa: if zero { "time" } else { "angular frequency" }, columns, zero }
    }
}

/// Data may deviate from a monotone curve by this many standard deviations of their scatter, ...
pub(super) const DEVIATIONS: f64 = 6.0;
/// ... but by no more than this, relatively; ...
pub(super) const MOST_NOISE: f64 = 0.5;
/// ... in short tables, whose scatter is hard to distinguish from their trend, by no more than this.
const MOST_NOISE_OF_FEW: f64 = 0.1;
const FEW: usize = 12;
/// One row of so many moves the curve by a hundredth of its deviation: it may go the wrong way.
const ROWS_PER_KNOCK: usize = 100;
/// Rows before and after one, from which its scatter is judged.
const AROUND: usize = 4;
/// Data without noise may deviate by the rounding of their digits; those printed with few digits, by one in the last.
const LEAST_NOISE: f64 = 1e-9;
/// Number of values for a fit of constant, slope and one term.
pub(super) const LEAST_ROWS: usize = 4;

/// Sorts the rows of a table. Returns its samples, in ascending order.
pub(crate) fn validated(layout: Layout, rows: &mut [TableRow]) -> Result<Vec<Sample>> {
    let Layout { table, abscissa, columns, zero } = layout;
    for TableRow { place, x, values, .. } in &*rows {
        let check = |column, value, inside, allowed| {
            let what = || format!("{table}, {place}: {column} = {value:?} is not allowed: it must be {allowed}");
            let refused =
                || Refusal::value("table_out_of_range", what(), "; leave out rows without a value").naming(column);
            if inside { Ok(()) } else { Err(refused().valued(value).allowing(allowed)) }
        };
        let allowed = if zero { "0, or in [1e-90, 1e90]" } else { "in [1e-90, 1e90]" };
        check(abscissa, *x, *x == 0.0 && zero || (1e-90..=1e90).contains(x), allowed)?;
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
/// rows around explains, or the relative `scatter`, if it is stated; a warning, if one row of a hundred or fewer does.
pub(crate) fn wrong_way(layout: Layout, rows: &[TableRow], scatter: Option<f64>) -> Result<(f64, Option<FitWarning>)> {
    let Layout { table, columns, .. } = layout;
    let (mut greatest, mut knock): (f64, _) = (0.0, None);
    for (index, &(column, function)) in columns.iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.values[index]).collect();
        let rising = match function {
            MaterialFunction::Creep | MaterialFunction::Storage => values,
            MaterialFunction::Relaxation => values.iter().map(|value| 1.0 / value).collect(),
            MaterialFunction::Loss => continue,
        };
        let most = if rows.len() < FEW { MOST_NOISE_OF_FEW } else { MOST_NOISE };
        let everywhere = median_scatter(&second_differences(&rising)).max(1.5 * quantum(&rising) / DEVIATIONS);
        let explained = |row: usize| match scatter {
            Some(scatter) => DEVIATIONS * scatter,
            None => (DEVIATIONS * everywhere.max(scatter_around(&rising, row))).clamp(LEAST_NOISE, most),
        };
        let curve = nearest_monotone(&rising);
        let deviations: Vec<f64> =
            rising.iter().zip(&curve).map(|(value, curve)| (value / curve - 1.0).abs()).collect();
        let excesses: Vec<f64> = deviations.iter().enumerate().map(|(row, change)| change / explained(row)).collect();
        let Some(worst) = (0..rows.len()).max_by(|&a, &b| excesses[a].total_cmp(&excesses[b])) else { continue };
        let (change, noise) = (deviations[worst], explained(worst));
        if change > noise {
            let off = excesses.iter().filter(|excess| **excess > 1.0).count();
            let TableRow { place, ref values, .. } = rows[worst];
            if off * ROWS_PER_KNOCK > rows.len() || change > MOST_NOISE_OF_FEW {
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
            let Some(most) = (0..rows.len()).max_by(|&a, &b| deviations[a].total_cmp(&deviations[b])) else { continue };
            let (x, change, rises) = (rows[most].x, deviations[most], rising[most] > curve[most]);
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
    let mut sorted = magnitudes.to_vec();
    sorted.sort_by(f64::total_cmp);
    // the median of |N(0, σ)| is 0.6745 σ
    sorted.get(sorted.len() / 2).map_or(0.0, |median| median / 0.6745)
}

/// The same of the rows around one: a pair of rows that contradict each other scatters, a single outlier does not.
fn scatter_around(values: &[f64], row: usize) -> f64 {
    if values.len() < FEW {
        return 0.0;
    }
    let from = row.saturating_sub(AROUND).min(values.len() - 2 * AROUND - 1);
    median_scatter(&second_differences(&values[from..=from + 2 * AROUND]))
}
