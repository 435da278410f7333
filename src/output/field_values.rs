//! The values of fields in the order of a file, also where ranks share out the contact.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use crate::error::Result;
use crate::fields::Fields;
use crate::output::{Field, Format};

/// Cells that ranks send at a time, or one row or some columns where they have more.
const PIECE_CELLS: usize = 1 << 16;
/// Least columns at a time: shorter pieces of a row are slow to read.
const LEAST_COLUMNS: usize = 8;

/// The values of some fields, each to be taken once, in this order. Where ranks share out the contact, rank 0 takes
/// the values, and the other ranks send their rows piece by piece.
#[derive(Debug)]
pub(super) struct FieldValues<'a> {
    contact: Fields<'a>,
    pub(super) fields: &'a [Field],
    format: Format,
    /// Values of a field that the contact does not store.
    buffer: &'a mut Vec<f64>,
}

/// Writes a file with these fields in the place of an earlier file. A call of all ranks, of which rank 0 writes.
pub(super) fn write_fields(
    path: &Path,
    (contact, fields, format): (Fields<'_>, &[Field], Format),
    buffer: &mut Vec<f64>,
    write: impl FnOnce(&mut BufWriter<File>, &mut FieldValues<'_>) -> io::Result<()>,
) -> Result<()> {
    let mut values = FieldValues { contact, fields, format, buffer };
    contact.shared_rows().replace_file(path, |out| {
        let written = out.map_or(Ok(()), |out| write(out, &mut values));
        values.pass_over_the_rest();
        written
    })
}

impl FieldValues<'_> {
    /// Passes the next field to `take`: row by row, or for VTK column by column.
    pub(super) fn next(&mut self, mut take: impl FnMut(&[f64]) -> io::Result<()>) -> io::Result<()> {
        let FieldValues { contact, fields, format, buffer } = self;
        let Some((field, rest)) = fields.split_first() else { return Ok(()) };
        *fields = rest;
        let values = field.values(*contact, buffer).map_err(io::Error::other)?;
        let [n1, n2] = contact.grid().cells();
        let by_rows = !format.is_vtk();
        let (all, most) =
            if by_rows { (n1, (PIECE_CELLS / n2).max(1)) } else { (n2, (PIECE_CELLS / n1).max(LEAST_COLUMNS)) };
        let (mut taken, mut column) = (Ok(()), Vec::new());
        for start in (0..all).step_by(most) {
            let piece = start..(start + most).min(all);
            let [rows, columns] = if by_rows { [piece, 0..n2] } else { [0..n1, piece] };
            let mut brought = None;
            if contact.shared_rows().are_shared() {
                // every rank sends all pieces, even if one could not be written; none can be sent once a rank has left
                brought = contact.bring(values, Some(0), rows.clone(), columns.clone()).map_err(io::Error::other)?;
                if taken.is_err() || brought.is_none() {
                    continue;
                }
            } else if taken.is_err() {
                break;
            }
            let row = |i: usize| match &brought {
                Some(brought) => brought.row(i),
                None => &values[i * n2..(i + 1) * n2][columns.clone()],
            };
            taken = if by_rows {
                rows.clone().try_for_each(|i| take(row(i)))
            } else {
                (0..columns.len()).try_for_each(|j| {
                    column.clear();
                    column.extend(rows.clone().map(|i| row(i)[j]));
                    take(&column)
                })
            };
        }
        taken
    }

    /// Sends the fields that were not taken: the other ranks always, rank 0 after an error.
    fn pass_over_the_rest(&mut self) {
        while self.contact.shared_rows().are_shared() && !self.fields.is_empty() {
            // the loss of a rank is read by `Rows::replace_file`
            let _ = self.next(|_| Ok(()));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::error::{Error, RanksError};
    use crate::parallel::Threads;
    use crate::{Grid, geometry::Sphere, load::Load, rheology::Elastic, rheology::Material};

    /// A medium that is full at any place: the same error on all ranks, none waits, and the next file is written.
    #[test]
    fn ranks_whose_file_fails_go_on_together() {
        let folder = std::env::temp_dir().join(format!("viscocontact-field-values-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (path, fields) = (folder.join("a"), [Field::Pressure, Field::Gap]);
        for format in [
            #[cfg(feature = "npy")]
            Format::Npz,
            Format::Vtk,
        ] {
            for failing in 0..4 {
                let written = Threads::run(3, |ranks| {
                    let mut contact = crate::ViscoelasticContact::builder(Grid::square(256, 4.0e-3)?)
                        .geometry(&Sphere::new(10.0e-3)?)
                        .material(Material::incompressible(Elastic::new(1.0e6)?))
                        .ranks(ranks)
                        .build()?;
                    contact.step(0.0, Load::force(1.0))?;
                    let mut buffer = Vec::new();
                    let full = |taken: usize, most: usize| {
                        if taken > most { Err(io::Error::other("full")) } else { Ok(()) }
                    };
                    let failed = write_fields(&path, (contact.fields(), &fields, format), &mut buffer, |_, values| {
                        let mut taken = 0;
                        for _ in fields {
                            values.next(|part| {
                                taken += part.len();
                                full(taken, failing * 40_000)
                            })?;
                        }
                        Ok(())
                    });
                    let mut count = 0;
                    write_fields(&path, (contact.fields(), &fields, format), &mut buffer, |_, values| {
                        values.next(|part| {
                            count += part.len();
                            Ok(())
                        })
                    })?;
                    Ok::<_, Error>((failed.unwrap_err(), count))
                });
                let written: Vec<_> = written.unwrap().into_iter().map(Result::unwrap).collect();
                assert_eq!(written.iter().map(|(_, count)| *count).collect::<Vec<_>>(), [1 << 16, 0, 0]);
                for (error, _) in &written {
                    assert!(
                        matches!(error, Error::Ranks(RanksError::Failed { rank: 0, message }) if message.contains("full"))
                    );
                }
                assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
            }
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
