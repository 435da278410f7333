//! The columns of a recording in a file.

use viscocontact::input::{Quantity, TakenColumn, TextTable, WantedColumn};

use crate::data::Recording;
use crate::error::{Error, Result};

/// The unit alone tells times and forces, but not which length one is.
const fn wanted(name: &'static str, words: &'static [&'static str], quantity: Quantity, by_unit: bool) -> WantedColumn {
    WantedColumn { name, words, others: &["rate", "speed", "velocity"], quantity, by_unit }
}

const TIME: WantedColumn = wanted("time", &["t", "time"], Quantity::TIME, true);
const FORCE: WantedColumn = wanted("force", &["f", "force", "load", "p"], Quantity::FORCE, true);
const DEFLECTION: WantedColumn =
    wanted("deflection", &["deflection", "defl", "vdeflection", "cantilever"], Quantity::LENGTH, false);
const DRIVE: WantedColumn =
    wanted("drive", &["z", "zsnsr", "height", "drive", "position", "piezo", "base", "stage"], Quantity::LENGTH, false);
const DEPTH: WantedColumn =
    wanted("depth", &["depth", "indentation", "δ", "delta", "h", "displacement into"], Quantity::LENGTH, false);

impl Recording {
    /// [`Recording::from_csv`] of a table that was read before, where its columns are to be chosen or named
    /// ([`TextTable::only`], [`TextTable::with_heading`]).
    ///
    /// # Errors
    /// As [`Recording::from_csv`].
    pub fn from_table(table: &TextTable) -> Result<Recording> {
        let required = |column: &WantedColumn| table.missing(column, "");
        let find = |column: &WantedColumn| table.find(column);
        let time = find(&TIME)?.ok_or_else(|| required(&TIME))?;
        let [force, deflection, drive, depth] = [find(&FORCE)?, find(&DEFLECTION)?, find(&DRIVE)?, find(&DEPTH)?];
        for (one, other, wanted) in [(&force, &deflection, &FORCE), (&drive, &depth, &DRIVE)] {
            if one.is_none() && other.is_none() {
                return Err(required(wanted).into());
            }
        }
        let columns: Vec<TakenColumn> = [Some(time), force, deflection, drive, depth].into_iter().flatten().collect();
        let units = columns.iter().map(TakenColumn::unit).collect::<Result<Vec<_>, _>>()?;
        let rows = table.rows(&columns)?;
        for row in &rows {
            row.check_finite(&columns)?;
        }
        for pair in rows.windows(2) {
            let [previous, value] = [&pair[0], &pair[1]].map(|row| units[0] * row.values[0]);
            if value <= previous {
                return Err(Error::RowsNotAscending { line: pair[1].line, value, previous });
            }
        }
        let column = |wanted: &WantedColumn| -> Option<Vec<f64>> {
            let place = columns.iter().position(|column| column.name() == wanted.name)?;
            Some(rows.iter().map(|row| units[place] * row.values[place]).collect())
        };
        let [force, deflection, drive, depth] = [&FORCE, &DEFLECTION, &DRIVE, &DEPTH].map(column);
        Ok(Recording { times: column(&TIME).unwrap_or_default(), force, deflection, drive, depth, columns })
    }
}
