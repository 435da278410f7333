//! Maps and charts of a contact.

use crate::error::Result;
use crate::output::Field;
use crate::plot::quantity::measure;
use crate::plot::{COLORS, Chart, Color, Legend, Map, Quantity, Style};
use crate::{Axis, ViscoelasticContact};

impl Map {
    /// The pressure of a contact, white out of contact; the colour scale begins at zero. A line contact, whose map is a
    /// strip, is better shown by [`Chart::profile`].
    ///
    /// # Errors
    /// If a pressure exceeds 1e100 Pa.
    pub fn pressure(contact: &ViscoelasticContact) -> Result<Map> {
        Map::field(contact, Field::Pressure)
    }

    /// The gap of a contact, grey where it is infinite, with the contact outlined; the colour scale begins at zero.
    ///
    /// # Errors
    /// If a finite gap exceeds 1e100 m.
    pub fn gap(contact: &ViscoelasticContact) -> Result<Map> {
        Map::field(contact, Field::Gap)?.outline_contact(contact)
    }

    /// The displacement of a contact, with the contact outlined.
    ///
    /// # Errors
    /// If a displacement exceeds 1e100 m in magnitude.
    pub fn displacement(contact: &ViscoelasticContact) -> Result<Map> {
        Map::field(contact, Field::Displacement)?.outline_contact(contact)
    }

    /// Outlines the cells of `contact` that are in contact.
    ///
    /// # Errors
    /// If map and contact differ in the number of cells.
    pub fn outline_contact(self, contact: &ViscoelasticContact) -> Result<Map> {
        self.outline(contact.pressure().iter().map(|&p| p > 0.0).collect())
    }

    /// A field of a contact, titled with its time.
    pub(super) fn field(contact: &ViscoelasticContact, field: Field) -> Result<Map> {
        contact.not_shared("a picture of fields")?;
        let mut buffer = Vec::new();
        let mut values = field.values(contact, &mut buffer)?.to_vec();
        if field == Field::Pressure {
            // cells out of contact stay blank
            values.iter_mut().filter(|p| **p <= 0.0).for_each(|p| *p = f64::NAN);
        }
        let mut map = Map::new(contact.grid(), values, Quantity::new(field.name(), field.unit()))?;
        if field != Field::Displacement && map.range[1] > 0.0 {
            map.range[0] = 0.0;
        }
        if field == Field::Gap {
            map.blank = Color::GREY;
        }
        map.title = time_title(contact);
        Ok(map)
    }
}

impl Chart {
    /// The pressure along a line of cells, see [`ViscoelasticContact::profile`].
    ///
    /// # Errors
    /// If `at` lies outside the grid.
    pub fn profile(contact: &ViscoelasticContact, along: Axis, at: f64) -> Result<Chart> {
        let profile = contact.profile(along, at)?;
        let [name, across] = match along {
            Axis::X1 => ["x1", "x2"],
            Axis::X2 => ["x2", "x1"],
        };
        let (x, y) = (Quantity::new(name, "m"), Quantity::new("pressure", "Pa"));
        let title = format!("{}, {across} = {}", time_title(contact), measure(at, "m"));
        let mut chart = Chart::new(title, x, y, Legend::UpperRight);
        let points = profile.positions.into_iter().zip(profile.pressure).collect();
        chart.add("", COLORS[0], Style::LineAndDots, points);
        Ok(chart)
    }
}

/// The time of a contact, as a title.
pub(super) fn time_title(contact: &ViscoelasticContact) -> String {
    format!("t = {}", measure(contact.time(), "s"))
}
