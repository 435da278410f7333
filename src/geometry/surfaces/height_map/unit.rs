//! Units of length in files of surfaces.

use std::str::FromStr;

use crate::error::{Error, Refusal, Result};
use crate::input::{Quantity, readings, same};

/// A unit of length in files of measured surfaces.
///
/// ```
/// use viscocontact::geometry::LengthUnit;
///
/// assert_eq!("µm".parse(), Ok(LengthUnit::Micrometre));
/// assert_eq!(LengthUnit::Micrometre.to_metres(2.5), 2.5e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LengthUnit {
    /// m.
    Metre,
    /// cm.
    Centimetre,
    /// mm.
    Millimetre,
    /// µm.
    Micrometre,
    /// nm.
    Nanometre,
    /// Å, 0.1 nm.
    Angstrom,
    /// pm.
    Picometre,
}

impl LengthUnit {
    /// Length of one unit \[m\].
    pub fn factor(self) -> f64 {
        1.0 / self.per_metre()
    }

    /// Converts `value` to metres.
    ///
    /// The value is divided by the whole number of units per metre. The result is rounded once: 2.5 µm is `2.5e-6`,
    /// bitwise.
    pub fn to_metres(self, value: f64) -> f64 {
        value / self.per_metre()
    }

    /// Number of units per metre.
    fn per_metre(self) -> f64 {
        UNITS[self as usize].1
    }
}

/// The units, and their number per metre.
const UNITS: [(LengthUnit, f64); 7] = [
    (LengthUnit::Metre, 1.0),
    (LengthUnit::Centimetre, 1e2),
    (LengthUnit::Millimetre, 1e3),
    (LengthUnit::Micrometre, 1e6),
    (LengthUnit::Nanometre, 1e9),
    (LengthUnit::Angstrom, 1e10),
    (LengthUnit::Picometre, 1e12),
];

impl FromStr for LengthUnit {
    type Err = Error;

    /// The unit of a symbol: m, cm, mm, µm (um), nm, Å (A), pm. Case matters: Mm is not a millimetre.
    fn from_str(symbol: &str) -> Result<LengthUnit> {
        let symbol = symbol.trim();
        let unknown = || {
            let what = format!("{symbol:?} is not a known unit of length: m, cm, mm, µm (um), nm, Å (A) or pm");
            Refusal::file("map_unit", what, "").into()
        };
        // of an ångström, and of 1E-9
        let is_capital = |c: char| c.is_uppercase() && !"AÅ\u{212b}E".contains(c);
        if symbol.contains(is_capital) {
            return Err(unknown());
        }
        let mut sizes = readings(symbol).into_iter().filter(|unit| unit.0 == Quantity::LENGTH).map(|unit| unit.1);
        let known = sizes.find_map(|size| UNITS.iter().find(|(_, per_metre)| same(size * per_metre, 1.0)));
        known.map(|unit| unit.0).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_parsed() {
        let cases = [
            ("m", 1.0),
            ("cm", 1e-2),
            ("mm", 1e-3),
            ("µm", 1e-6),
            ("μm", 1e-6),
            (" um\r", 1e-6),
            ("nm", 1e-9),
            ("Å", 1e-10),
            ("pm", 1e-12),
        ];
        for (symbol, metres) in cases {
            let unit: LengthUnit = symbol.parse().unwrap();
            assert_eq!((unit.factor(), unit.to_metres(1.0)), (metres, metres), "{symbol}");
        }
        for symbol in ["", "Mm", "MM", "NM", "Nm", "V", "m^2", "inch"] {
            assert!(symbol.parse::<LengthUnit>().is_err_and(|error| error.code() == "map_unit"), "{symbol}");
        }
    }

    #[test]
    fn lengths_are_rounded_once() {
        for k in 1..1000 {
            let metres: f64 = format!("{k}e-6").parse().unwrap();
            assert_eq!(LengthUnit::Micrometre.to_metres(f64::from(k)), metres);
        }
    }
}
