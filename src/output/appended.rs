//! Arrays appended to the XML of a VTK file: all values in binary, each array preceded by its size in bytes.

use std::io::{self, Write};

/// What follows the last element of the XML.
pub(super) const OPENING: &str = "  <AppendedData encoding=\"raw\">\n   _";
/// What follows the last array.
pub(super) const CLOSING: &[u8] = b"\n  </AppendedData>\n</VTKFile>\n";

/// Where the arrays of a file begin, in the order of their announcements.
#[derive(Default)]
pub(super) struct Offsets(u64);

impl Offsets {
    /// The end of the element that announces an array of so many bytes.
    pub(super) fn next(&mut self, bytes: usize) -> String {
        let this = self.0;
        self.0 += 8 + bytes as u64;
        format!("format=\"appended\" offset=\"{this}\"/>")
    }

    /// The element that announces the metadata.
    pub(super) fn metadata(&mut self, metadata: &str) -> String {
        let place = self.next(metadata.len() + 1);
        format!("      <Array type=\"String\" Name=\"metadata\" NumberOfTuples=\"1\" {place}\n")
    }
}

/// Writes an array of `count` numbers.
pub(super) fn write_numbers(
    out: &mut impl Write,
    count: usize,
    mut values: impl Iterator<Item = f64>,
) -> io::Result<()> {
    write_length(out, count)?;
    values.try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

/// Begins an array of `count` numbers.
pub(super) fn write_length(out: &mut impl Write, count: usize) -> io::Result<()> {
    out.write_all(&(8 * count as u64).to_le_bytes())
}

/// Writes a text. Strings end with a NUL byte, which JSON does not contain.
pub(super) fn write_text(out: &mut impl Write, text: &str) -> io::Result<()> {
    out.write_all(&(text.len() as u64 + 1).to_le_bytes())?;
    out.write_all(text.as_bytes())?;
    out.write_all(&[0])
}
