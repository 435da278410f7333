//! The fields of a contact that can be written.

use crate::Result;
use crate::fields::Fields;

/// A field that can be written, with one value per cell.
///
/// ```
/// use viscocontact::output::Field;
///
/// assert_eq!(Field::Gap.name(), "gap");
/// assert_eq!(Field::Pressure.unit(), "Pa");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Field {
    /// [`Fields::pressure`] \[Pa\].
    Pressure,
    /// [`Fields::displacement`] \[m\].
    Displacement,
    /// [`Fields::gap_into`] \[m\]; +∞ where the
    /// initial gap is infinite.
    Gap,
    /// [`Fields::traction_into`]: the net traction \[Pa\], < 0 where the bodies
    /// pull at each other; without attraction the pressure.
    Traction,
}

/// Name in files and SI unit of each field.
const NAMES_AND_UNITS: [(&str, &str); 4] =
    [("pressure", "Pa"), ("displacement", "m"), ("gap", "m"), ("traction", "Pa")];

impl Field {
    /// All fields.
    pub const ALL: [Field; 4] = [Field::Pressure, Field::Displacement, Field::Gap, Field::Traction];

    /// The fields of a contact: all of them where surfaces [attract](crate::adhesion) each other, else all but
    /// [`Field::Traction`], which is the pressure then.
    pub fn of<'a>(contact: impl Into<Fields<'a>>) -> &'static [Field] {
        if contact.into().attraction().is_some() { &Field::ALL } else { &Field::ALL[..3] }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].0
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].1
    }

    /// Values in the current state of the contact, on the local rows where ranks share it out. `buffer` receives the
    /// values of a field that the contact does not store.
    pub(crate) fn values<'a>(self, contact: Fields<'a>, buffer: &'a mut Vec<f64>) -> Result<&'a [f64]> {
        match self {
            Field::Pressure => Ok(contact.pressure()),
            Field::Displacement => Ok(contact.displacement()),
            Field::Gap => {
                buffer.resize(contact.pressure().len(), 0.0);
                contact.gap_into(buffer)?;
                Ok(buffer)
            }
            Field::Traction if contact.attraction().is_none() => Ok(contact.pressure()),
            Field::Traction => {
                buffer.resize(contact.pressure().len(), 0.0);
                contact.traction_into(buffer)?;
                Ok(buffer)
            }
        }
    }
}
