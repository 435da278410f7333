//! Files in the XML formats of VTK: the XML announces arrays, whose values follow it as binary in the same order.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};

use crate::fields::Fields;
use crate::file::write_numbers;
use crate::output::field_values::FieldValues;
use crate::output::time_of;
use crate::output::{Field, Metadata};

/// What the numbers follow.
const OPENING: &[u8] = b"  <AppendedData encoding=\"raw\">\n   _";
/// End of a file.
pub(super) const CLOSING: &[u8] = b"\n  </AppendedData>\n</VTKFile>\n";

/// An element of the XML: its name and attributes, and the attributes and numbers of values of its arrays.
pub(super) type Section<'a> = (&'a str, Vec<(String, usize)>);

/// Writes a frame as an image; `area` is the contact area.
pub(super) fn write_frame(
    out: &mut impl Write,
    (contact, area): (Fields<'_>, f64),
    metadata: &Metadata,
    values: &mut FieldValues<'_>,
) -> io::Result<()> {
    let grid = contact.grid();
    let ([n1, n2], [d1, d2], [c1, c2]) = (grid.cells(), grid.spacing(), grid.center(0, 0));
    let (o1, o2) = (c1 - 0.5 * d1, c2 - 0.5 * d2);
    let numbers: [(&str, &[f64]); 5] = [
        ("TimeValue", &[time_of(contact)]),
        ("approach [m]", &[contact.approach()]),
        ("force [N]", &[contact.force()]),
        ("tilt [rad]", &contact.tilt()),
        ("contact area [m2]", &[area]),
    ];
    let array = |field: &Field| (format!("Name=\"{} [{}]\"", field.name(), field.unit()), grid.len());
    write_opening(
        out,
        ("ImageData", &format!("0 {n1} 0 {n2} 0 0")),
        &format!(" Origin=\"{o1:?} {o2:?} 0\" Spacing=\"{d1:?} {d2:?} {d1:?}\""),
        (&numbers, &metadata.of(Some(contact))),
        &[("CellData", values.fields.iter().map(array).collect())],
    )?;
    for _ in values.fields {
        write_length(out, grid.len())?;
        values.next(|part| write_numbers(out, part.iter().copied()))?;
    }
    out.write_all(CLOSING)
}

/// Time, force and approach of a frame: the first numbers after the XML, each after its length.
pub(super) fn state_of(frame: File) -> io::Result<[f64; 3]> {
    let (mut file, mut xml) = (BufReader::new(frame), Vec::new());
    while !xml.ends_with(OPENING) {
        if file.read_until(b'_', &mut xml)? == 0 {
            return Err(io::ErrorKind::InvalidData.into());
        }
    }
    let mut numbers = [0; 48];
    file.read_exact(&mut numbers)?;
    let number = |k: usize| numbers[16 * k + 8..].first_chunk().map_or(f64::NAN, |bytes| f64::from_le_bytes(*bytes));
    Ok([number(0), number(2), number(1)])
}

/// Writes the XML of a file of this kind and extent, and the values of its field data: `numbers` and the metadata.
pub(super) fn write_opening(
    out: &mut impl Write,
    (kind, extent): (&str, &str),
    attributes: &str,
    (numbers, metadata): (&[(&str, &[f64])], &str),
    sections: &[Section<'_>],
) -> io::Result<()> {
    let mut offset = 0;
    let mut place = |bytes: usize| {
        let start = offset;
        offset += 8 + bytes as u64;
        format!("format=\"appended\" offset=\"{start}\"/>")
    };
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
         <{kind} WholeExtent=\"{extent}\"{attributes}>\n    <FieldData>\n"
    );
    for (name, values) in numbers {
        // one tuple with as many components as values
        let shape = format!("NumberOfComponents=\"{}\" NumberOfTuples=\"1\"", values.len());
        xml += &format!("      <DataArray type=\"Float64\" Name=\"{name}\" {shape} {}\n", place(8 * values.len()));
    }
    // strings end with a NUL byte, which JSON does not contain
    let text = place(metadata.len() + 1);
    xml += &format!("      <Array type=\"String\" Name=\"metadata\" NumberOfTuples=\"1\" {text}\n    </FieldData>\n");
    xml += &format!("    <Piece Extent=\"{extent}\">\n");
    for (section, arrays) in sections {
        xml += &format!("      <{section}>\n");
        for (array, count) in arrays {
            xml += &format!("        <DataArray type=\"Float64\" {array} {}\n", place(8 * count));
        }
        xml += &format!("      </{}>\n", section.split(' ').next().unwrap_or_default());
    }
    write!(out, "{xml}    </Piece>\n  </{kind}>\n")?;
    out.write_all(OPENING)?;
    for (_, values) in numbers {
        write_array(out, values.len(), values.iter().copied())?;
    }
    out.write_all(&(metadata.len() as u64 + 1).to_le_bytes())?;
    write!(out, "{metadata}\0")
}

/// Writes an array of `count` numbers.
pub(super) fn write_array(out: &mut impl Write, count: usize, values: impl Iterator<Item = f64>) -> io::Result<()> {
    write_length(out, count)?;
    write_numbers(out, values)
}

/// Begins an array of `count` numbers with its size in bytes.
fn write_length(out: &mut impl Write, count: usize) -> io::Result<()> {
    out.write_all(&(8 * count as u64).to_le_bytes())
}
