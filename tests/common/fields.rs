//! Fields of a contact that are written where the caller keeps them, in vectors of their own.

use viscocontact::fields::Fields;
use viscocontact::prelude::*;

/// The gap of each cell \[m\]; what would not be written is not a number.
pub fn gap(fields: Fields<'_>) -> Vec<f64> {
    written(fields, Fields::gap_into)
}

/// The net traction of each cell \[Pa\]; what would not be written is not a number.
pub fn traction(fields: Fields<'_>) -> Vec<f64> {
    written(fields, Fields::traction_into)
}

fn written<'a>(fields: Fields<'a>, write: impl Fn(&Fields<'a>, &mut [f64]) -> Result<(), Error>) -> Vec<f64> {
    let mut field = vec![f64::NAN; fields.grid().len()];
    write(&fields, &mut field).unwrap();
    field
}
