//! The values of fields as files take them, whoever has them.

use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::Range;
use std::path::Path;

use crate::ViscoelasticContact;
use crate::contact::Brought;
use crate::error::Result;
use crate::file::replace;
use crate::output::Field;

/// Cells that ranks bring at a time, or one row or some columns where they have more.
const PIECE_CELLS: usize = 1 << 16;
/// Least columns at a time: fewer numbers beside each other are slow to find.
#[cfg(feature = "vtk")]
const LEAST_COLUMNS: usize = 8;

/// The values of some fields, each to be taken once, in this order. Where ranks share out the contact, rank 0 takes them, and
/// the others bring their rows, some at a time.
#[derive(Debug)]
pub(super) struct FieldValues<'a> {
    contact: &'a ViscoelasticContact,
    fields: &'a [Field],
    order: Order,
    /// For fields that the contact does not store.
    buffer: &'a mut Vec<f64>,
}

/// The order in which a format has the cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Rows one after the other: the index along x2 varies fastest.
    #[cfg(feature = "npy")]
    Rows,
    /// That along x1.
    #[cfg(feature = "vtk")]
    Columns,
}

/// Writes a file with these fields in the place of another ([`replace`]): a call of all ranks, of which rank 0 writes. Without
/// ranks the values come from where they are.
pub(super) fn write_fields(
    path: &Path,
    (contact, fields, order): (&ViscoelasticContact, &[Field], Order),
    buffer: &mut Vec<f64>,
    write: impl FnOnce(&mut BufWriter<File>, &mut FieldValues<'_>) -> io::Result<()>,
) -> Result<()> {
    let mut values = FieldValues { contact, fields, order, buffer };
    let rows = contact.shared_rows();
    let Some(group) = rows.group() else { return replace(path, |out| write(out, &mut values)) };
    // whether rank 0 could begin
    let all_begin = |begun: bool| rows.together(|| Ok(!rows.any(!begun)));
    rows.together(|| {
        if group.rank() > 0 {
            if all_begin(true)? {
                values.pass_over_the_rest();
            }
            return rows.agree(Ok(()));
        }
        let mut begun = false;
        let written = replace(path, |out| {
            begun = true;
            all_begin(true).map_err(io::Error::other)?;
            let written = write(out, &mut values);
            values.pass_over_the_rest();
            written
        });
        if !begun {
            all_begin(false)?;
        }
        rows.agree(written)
    })
}

impl FieldValues<'_> {
    /// The next field, some rows at a time.
    #[cfg(feature = "npy")]
    pub(super) fn by_rows(&mut self, mut take: impl FnMut(&[f64]) -> io::Result<()>) -> io::Result<()> {
        let FieldValues { contact, fields, buffer, .. } = self;
        let Some((field, rest)) = fields.split_first() else { return Ok(()) };
        *fields = rest;
        let values = field.values(contact, buffer).map_err(io::Error::other)?;
        if !contact.shared_rows().are_shared() {
            return take(values);
        }
        let [n1, n2] = contact.grid().cells();
        let pieces = pieces(n1, (PIECE_CELLS / n2).max(1)).map(|rows| [rows, 0..n2]);
        bring(contact, values, pieces, |brought, [mut rows, _]| rows.try_for_each(|row| take(brought.row(row))))
    }

    /// The next field, value by value of its columns.
    #[cfg(feature = "vtk")]
    pub(super) fn by_columns(&mut self, mut take: impl FnMut(f64) -> io::Result<()>) -> io::Result<()> {
        let FieldValues { contact, fields, buffer, .. } = self;
        let Some((field, rest)) = fields.split_first() else { return Ok(()) };
        *fields = rest;
        let values = field.values(contact, buffer).map_err(io::Error::other)?;
        let [n1, n2] = contact.grid().cells();
        if !contact.shared_rows().are_shared() {
            return (0..n2).flat_map(|j| (0..n1).map(move |i| values[i * n2 + j])).try_for_each(take);
        }
        let pieces = pieces(n2, (PIECE_CELLS / n1).max(LEAST_COLUMNS)).map(|columns| [0..n1, columns]);
        bring(contact, values, pieces, |brought, [rows, columns]| {
            (0..columns.len()).try_for_each(|j| rows.clone().try_for_each(|row| take(brought.row(row)[j])))
        })
    }

    /// Brings what was not taken, as others wait for it to be.
    fn pass_over_the_rest(&mut self) {
        while !self.fields.is_empty() {
            // errors were kept
            let _ = match self.order {
                #[cfg(feature = "npy")]
                Order::Rows => self.by_rows(|_| Ok(())),
                #[cfg(feature = "vtk")]
                Order::Columns => self.by_columns(|_| Ok(())),
            };
        }
    }
}

/// So many things, some at a time.
fn pieces(all: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    (0..all).step_by(most).map(move |start| start..(start + most).min(all))
}

/// Brings rectangles of a field to rank 0, where each is taken: all of them, even if one could not be.
fn bring(
    contact: &ViscoelasticContact,
    values: &[f64],
    rectangles: impl Iterator<Item = [Range<usize>; 2]>,
    mut take: impl FnMut(&Brought, [Range<usize>; 2]) -> io::Result<()>,
) -> io::Result<()> {
    let mut taken = Ok(());
    for [rows, columns] in rectangles {
        // without a rank that is lost nothing can be brought
        let brought = contact.bring(values, Some(0), rows.clone(), columns.clone()).map_err(io::Error::other)?;
        if let (Some(brought), Ok(())) = (brought, &taken) {
            taken = take(&brought, [rows, columns]);
        }
    }
    taken
}

#[cfg(all(test, feature = "npy", feature = "vtk"))]
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
        for order in [Order::Rows, Order::Columns] {
            for failing in 0..4 {
                let written = Threads::run(3, |ranks| {
                    let mut contact = ViscoelasticContact::builder(Grid::square(256, 4.0e-3)?)
                        .geometry(&Sphere::new(10.0e-3)?)
                        .material(Material::incompressible(Elastic::new(1.0e6)?))
                        .ranks(ranks)
                        .build()?;
                    contact.step(0.0, Load::force(1.0))?;
                    let mut buffer = Vec::new();
                    let full = |taken: usize, most: usize| {
                        if taken > most { Err(io::Error::other("full")) } else { Ok(()) }
                    };
                    let failed = write_fields(&path, (&contact, &fields, order), &mut buffer, |_, values| {
                        let mut taken = 0;
                        for _ in fields {
                            let mut take = |count: usize| {
                                taken += count;
                                full(taken, failing * 40_000)
                            };
                            match order {
                                Order::Rows => values.by_rows(|part| take(part.len()))?,
                                Order::Columns => values.by_columns(|_| take(1))?,
                            }
                        }
                        Ok(())
                    });
                    let mut count = 0;
                    write_fields(&path, (&contact, &fields, order), &mut buffer, |_, values| {
                        values.by_rows(|part| {
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
