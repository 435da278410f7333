//! Tables of measured data from text files.

use std::io::Read;
use std::path::Path;

use super::data::Place;
use crate::error::{Refusal, Result, positive};
use crate::file::open;
use crate::input::{Quantity, TakenColumn, TextFormat, TextTable, UnitOf, WantedColumn, name, same, symbol};
use crate::rheology::table::data::{Deformation, MeasuredRow};
use crate::rheology::table::{Experiment, Measurements};
use crate::rounded::rounded;

/// The units of a file in SI, which its headings must agree with, or the units of its headings.
///
/// ```
/// use viscocontact::rheology::Units;
///
/// let minutes_and_compliances_in_1_gpa = Units::new(60.0, 1.0e-9)?;
/// # let _ = minutes_and_compliances_in_1_gpa;
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    abscissa: Option<f64>,
    value: Option<f64>,
}

impl Units {
    /// s, rad/s, 1/Pa, Pa.
    pub const SI: Units = Units { abscissa: Some(1.0), value: Some(1.0) };
    /// What the headings say, column by column: each must name its unit.
    pub const OF_HEADINGS: Units = Units { abscissa: None, value: None };

    /// One unit of time in s, or of frequency in rad/s: 60 for minutes, 2π for Hz. One unit of compliance in 1/Pa, or
    /// of modulus in Pa: 1e-9 for 1/GPa, 1e6 for MPa.
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn new(abscissa: f64, value: f64) -> Result<Units> {
        let [abscissa, value] = [positive("Units::abscissa", abscissa)?, positive("Units::value", value)?];
        Ok(Units { abscissa: Some(abscissa), value: Some(value) })
    }
}

/// Parts of the headings of other quantities than moduli and compliances.
const OTHERS: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%", "stor", "loss", "viscosity"];
const NOT_STORAGE: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%", "loss"];
const NOT_LOSS: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%", "stor"];

const fn wanted(
    name: &'static str,
    words: &'static [&'static str],
    others: &'static [&'static str],
    quantity: Quantity,
) -> WantedColumn {
    WantedColumn { name, words, others, quantity, by_unit: false }
}

const TIME: WantedColumn = WantedColumn { by_unit: true, ..wanted("time", &["time", "t"], &[], Quantity::TIME) };
const FREQUENCY: WantedColumn = WantedColumn {
    by_unit: true,
    ..wanted(
        "angular frequency",
        &["omega", "ω", "angular", "ang", "frequency", "freq", "f", "w"],
        &[],
        Quantity::FREQUENCY,
    )
};
// a D without a unit may be a diameter
const CREEP: WantedColumn = WantedColumn {
    by_unit: true,
    ..wanted("creep compliance", &["j", "creep", "compliance", "d(t)"], OTHERS, Quantity::COMPLIANCE)
};
const RELAXATION: WantedColumn =
    wanted("relaxation modulus", &["g", "e", "relaxation", "modulus", "young's"], OTHERS, Quantity::MODULUS);
const STORAGE: WantedColumn = wanted(
    "storage modulus",
    &["g'", "g′", "e'", "e′", "storage", "gp", "g_stor", "e_stor"],
    NOT_STORAGE,
    Quantity::MODULUS,
);
const LOSS: WantedColumn = wanted(
    "loss modulus",
    &["g''", "g″", "g\"", "e''", "e″", "e\"", "loss", "gpp", "g_loss", "e_loss"],
    NOT_LOSS,
    Quantity::MODULUS,
);
const COMPLEX: WantedColumn =
    wanted("complex modulus", &["|g*|", "|e*|", "g*", "e*", "complex modulus"], OTHERS, Quantity::MODULUS);
const TAN: WantedColumn =
    wanted("loss factor", &["tan", "tanδ", "tand", "tandelta", "loss factor", "loss tangent"], &[], Quantity::NUMBER);
const PHASE: WantedColumn = wanted("phase angle", &["phase", "delta", "δ"], &["tan"], Quantity::ANGLE);

/// The columns of a table, and how the moduli of a dynamic one are made of them.
pub(super) struct Columns {
    pub(super) taken: Vec<TakenColumn>,
    /// Whether the first modulus is |G*|.
    complex: bool,
    /// tan δ, if the second column is not a loss modulus.
    tan: Option<fn(f64) -> f64>,
}

impl Measurements {
    /// Reads a text file of an `experiment`: the columns of [`Experiment`].
    ///
    /// [`TextTable`] says where a table begins, and [`TextFormat`] how it is written. Its headings name the columns by the first
    /// word or symbol, whatever the case, and by their units; rows and columns may stand in any order. A dynamic
    /// table may have tan δ or the phase angle in place of the loss modulus, and with them |G*| or |E*| in place of
    /// the storage modulus. Without headings there are the columns of the experiment, in their order.
    ///
    /// Units come from the headings (`t [min]`, `J (1/GPa)`, `E/MPa`) with [`Units::OF_HEADINGS`]; other `units` are
    /// stated, and headings must agree with them. Headings that name moduli or compliances in tension (E, E′, E″, D)
    /// make a table for
    /// [`Measurements::fit_tension`]; those in shear, for [`Measurements::fit`].
    ///
    /// # Errors
    /// As [`Measurements::creep`]; if the file cannot be read
    /// ([`Error::Unreadable`](crate::Error::Unreadable)), or, each reported with its line: columns that no heading
    /// names, or several; a heading without a unit; too
    /// few or too many columns; an entry that is not a number, or has the other decimal mark; a unit that differs.
    pub fn from_csv(
        experiment: Experiment,
        path: impl AsRef<Path>,
        units: Units,
        format: TextFormat,
    ) -> Result<Measurements> {
        Measurements::from_csv_reader(experiment, open(path.as_ref())?, units, format)
    }

    /// [`Measurements::from_csv`] from any reader.
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::rheology::{Experiment, Measurements, Units};
    ///
    /// let text = "# PMMA, 23 °C\ntime [min], J [1/GPa]\n10, 1.2\n1, 1.0\n100, 1.3\n3, 1.1\n";
    /// let (units, format) = (Units::OF_HEADINGS, TextFormat::default());
    /// let body = Measurements::from_csv_reader(Experiment::Creep, text.as_bytes(), units, format)?.fit()?;
    /// println!("{}", body.report());
    ///
    /// let text = "omega,G',tan delta\n0.1,1.0e6,0.2\n1,1.5e6,0.27\n10,2.2e6,0.18\n100,2.5e6,0.04\n";
    /// let body = Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::SI, format)?.fit()?;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::from_csv`].
    pub fn from_csv_reader(
        experiment: Experiment,
        reader: impl Read,
        units: Units,
        format: TextFormat,
    ) -> Result<Measurements> {
        Measurements::from_table(experiment, &TextTable::named(reader, experiment.layout().table, format)?, units)
    }

    /// [`Measurements::from_csv`] from a table that was read before, where its columns are to be chosen or named
    /// ([`TextTable::only`], [`TextTable::with_heading`]).
    ///
    /// # Errors
    /// As [`Measurements::from_csv`].
    pub fn from_table(experiment: Experiment, table: &TextTable, units: Units) -> Result<Measurements> {
        let columns = Columns::of(experiment, table, units)?;
        let deformation = columns.deformation();
        Ok(Measurements {
            deformation,
            columns: columns.taken.clone(),
            ..Measurements::from_rows(experiment, columns.rows(table)?)?
        })
    }
}

impl Columns {
    pub(super) fn of(experiment: Experiment, table: &TextTable, units: Units) -> Result<Columns> {
        match (Columns::named(experiment, table, units), table.without_comment()) {
            // a comment that is a remark names no columns
            (Err(error), Some(plain)) if error.code() == "text_heading" => {
                Columns::named(experiment, &plain, units).or(Err(error))
            }
            (found, _) => found,
        }
    }

    fn named(experiment: Experiment, table: &TextTable, units: Units) -> Result<Columns> {
        let find = |column: &WantedColumn| -> Result<TakenColumn> {
            table.find(column)?.ok_or_else(|| table.missing(column, ""))
        };
        let abscissa = if experiment.layout().is_over_time { &TIME } else { &FREQUENCY };
        let values: &[&WantedColumn] = match experiment {
            Experiment::Creep => &[&CREEP],
            Experiment::Relaxation => &[&RELAXATION],
            Experiment::Storage => &[&STORAGE],
            Experiment::Dynamic => &[&STORAGE, &LOSS],
        };
        let mut complex = false;
        let mut tan: Option<fn(f64) -> f64> = None;
        let mut taken;
        if table.headings().is_empty() {
            let places = std::iter::once(&abscissa).chain(values).enumerate();
            taken = places.map(|(place, column)| table.by_place(column, place)).collect();
        } else {
            taken = vec![find(abscissa)?];
            match (experiment, table.find(&LOSS)?, table.find(&TAN)?, table.find(&PHASE)?) {
                (Experiment::Dynamic, None, of_tan, of_phase) if of_tan.is_some() || of_phase.is_some() => {
                    tan = Some(if of_tan.is_some() { |tan| tan } else { f64::tan });
                    let storage = table.find(&STORAGE)?;
                    complex = storage.is_none();
                    taken.extend([storage.map_or_else(|| find(&COMPLEX), Ok)?]);
                    taken.extend(of_tan.or(of_phase));
                }
                (Experiment::Dynamic, None, ..) if table.find(&STORAGE)?.is_some() => {
                    let what = format!(
                        "line {}: the headings name a storage modulus, but no loss modulus, phase angle or loss \
                         factor (tan)",
                        taken[0].line()
                    );
                    let remedy = ": name it, or read the table as Experiment::Storage";
                    return Err(Refusal::value("table_storage_only", what, remedy).into());
                }
                _ => {
                    for column in values {
                        taken.push(find(column)?);
                    }
                }
            }
        }
        let given = |place: usize, column: &TakenColumn| match column.name() {
            name if name == TAN.name => Some(("value", Some(if is_percentage(column.heading()) { 0.01 } else { 1.0 }))),
            name if name == PHASE.name => None,
            _ => Some(if place == 0 { ("abscissa", units.abscissa) } else { ("value", units.value) }),
        };
        let sized = |(place, column): (usize, TakenColumn)| sized(given(place, &column), column);
        Ok(Columns { taken: taken.into_iter().enumerate().map(sized).collect::<Result<_>>()?, complex, tan })
    }

    pub(super) fn rows(&self, table: &TextTable) -> Result<Vec<MeasuredRow>> {
        let sizes: Vec<f64> = self.taken.iter().map(TakenColumn::unit).collect::<Result<_, _>>()?;
        let rows = table.rows(&self.taken)?.into_iter().map(|row| {
            let mut values: Vec<f64> = row.values.iter().zip(&sizes).map(|(value, size)| value * size).collect();
            if let Some(tan) = self.tan {
                let (modulus, tan) = (values[1], tan(values[2]));
                values[1] = if self.complex { modulus / tan.hypot(1.0) } else { modulus };
                values[2] = values[1] * tan;
            }
            MeasuredRow::new(Place::Line(row.line), values.remove(0), values)
        });
        Ok(rows.collect())
    }

    /// The deformation that the headings of the columns of values name.
    pub(super) fn deformation(&self) -> Deformation {
        let named = |column: &TakenColumn| {
            let heading = column.heading().to_lowercase();
            let word = symbol(heading.trim_start_matches('|'));
            let letter = word.trim_end_matches(['\'', '′', '"', '″']);
            if ["e", "d"].contains(&letter)
                || word == "young's"
                || heading.contains("tensile")
                || heading.contains("tension")
            {
                Deformation::Tension
            } else if ["g", "j", "gp", "gpp"].contains(&letter) || heading.contains("shear") {
                Deformation::Shear
            } else {
                Deformation::Unnamed
            }
        };
        let mut named = self.taken.iter().filter(|column| column.name() != PHASE.name).skip(1).map(named);
        named.find(|named| *named != Deformation::Unnamed).unwrap_or(Deformation::Unnamed)
    }
}

/// Whether a heading of a number ends with a percent sign for its unit, and not with a number of percent.
fn is_percentage(heading: &str) -> bool {
    let ends = |c: char| c.is_whitespace() || ")]}".contains(c);
    let of = heading.trim_end_matches(ends).strip_suffix('%');
    of.is_some_and(|of| !of.trim_end().ends_with(|c: char| c.is_ascii_digit()))
}

/// A column with its unit: the one given for a field of [`Units`], with which the heading must agree, or the unit of
/// the heading.
fn sized(given: Option<(&'static str, Option<f64>)>, column: TakenColumn) -> Result<TakenColumn> {
    let Some((field, Some(given))) = given else {
        column.unit()?;
        return Ok(column);
    };
    let refused = |unit: &str, size: Option<f64>| {
        let (line, index, heading) = (column.line(), column.index() + 1, column.heading());
        let expected = name(column.quantity, given);
        let size = size.map(|size| format!("; of {unit} it is {}", rounded(size, 5))).unwrap_or_default();
        let what = format!(
            "line {line}, column {index}: the heading {heading:?} says {unit}, but Units::{field} = {given} means \
             {expected}{size}"
        );
        Err(Refusal::value("table_unit", what, "").naming(field).valued(given).into())
    };
    match &column.unit_of {
        UnitOf::Sizes(unit, sizes) if !sizes.iter().any(|&size| same(size, given)) => {
            refused(unit, sizes.first().copied())
        }
        UnitOf::Other(unit) | UnitOf::Unclear(unit) => refused(unit, None),
        _ => Ok(column.with_unit(given)),
    }
}
