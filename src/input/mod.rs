//! Text files as instruments and programs write them: encodings, lines, headings with units, columns, numbers.
//!
//! Readers of one kind of data ([`Measurements::from_csv`](crate::rheology::Measurements::from_csv)) use a
//! [`TextTable`], which they also accept; so do other crates, by [`TextTable::find`].
//! Binary and image formats of height maps have readers of their own in `geometry/surfaces/height_map/read`.
//!
//! | to add | in |
//! |---|---|
//! | a unit | `unit::UNITS` |
//! | a word of a heading | the `WantedColumn` of its reader: `rheology/table/columns.rs` and `isotherm.rs`, `xyz.rs`, identify |
//! | a notation of headings | `heading.rs`, `sections.rs` |

mod column;
mod encoding;
mod format;
mod heading;
mod lines;
mod number;
mod sections;
mod table;
mod unit;

use std::io::Read;

use crate::error::Result;
use crate::file::unreadable;

pub use column::{TableRow, TakenColumn, WantedColumn};
pub(crate) use encoding::by_lines;
pub use format::{Delimiter, TextFormat};
pub(crate) use heading::{UnitOf, symbol};
pub(crate) use lines::{Text, TextRow};
pub(crate) use number::number;
pub use table::TextTable;
pub use unit::Quantity;
pub(crate) use unit::{name, readings, same};

/// All bytes of a reader. `name` stands for the file in errors.
pub(crate) fn bytes(mut reader: impl Read, name: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| unreadable(name.to_owned(), error))?;
    Ok(bytes)
}
