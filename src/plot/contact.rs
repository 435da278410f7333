//! Maps and charts of a contact.

use crate::Axis;
use crate::error::{Result, coverage};
use crate::fields::Fields;
use crate::output::Field;
use crate::plot::quantity::measure;
use crate::plot::{COLORS, Chart, Color, ColorScale, Legend, Map, Quantity, Style};

impl Map {
    /// A field of a contact, titled with its time. The contact is outlined but on [`Field::Pressure`], whose cells
    /// out of contact are white; [`Map::outline`] outlines it there, too. The colours of pressure and gap begin at
    /// zero; those of [`Field::Traction`], the net traction between the bodies, are red where they press, blue where
    /// they [attract](crate::adhesion) each other and white at zero. Cells whose gap is infinite are grey in maps of
    /// the gap and of the traction. A line contact, whose map is a strip, is better shown by [`Chart::profile`].
    ///
    /// # Errors
    /// If a finite value exceeds 1e100 in magnitude.
    pub fn of<'a>(contact: impl Into<Fields<'a>>, field: Field) -> Result<Map> {
        let contact = contact.into();
        let map = Map::field(contact, field)?;
        if field == Field::Pressure { Ok(map) } else { map.outline_contact(contact) }
    }

    /// Outlines the cells of `contact` that are in contact.
    pub(super) fn outline_contact(self, contact: Fields<'_>) -> Result<Map> {
        self.outline(contact.pressure().iter().map(|&p| p > 0.0).collect())
    }

    /// A field of a contact, titled with its time.
    pub(super) fn field(contact: Fields<'_>, field: Field) -> Result<Map> {
        contact.covers(coverage::PICTURE)?;
        let mut buffer = Vec::new();
        let mut values = field.values(contact, &mut buffer)?.to_vec();
        if field == Field::Pressure {
            // cells out of contact stay blank
            values.iter_mut().filter(|p| **p <= 0.0).for_each(|p| *p = f64::NAN);
        }
        if field == Field::Traction {
            // cells without anything to touch stay blank
            let gap = Field::Gap.values(contact, &mut buffer)?;
            values.iter_mut().zip(gap).filter(|(_, h)| !h.is_finite()).for_each(|(value, _)| *value = f64::NAN);
        }
        let mut map = Map::new(contact.grid(), values, Quantity::new(field.name(), field.unit()))?;
        map.colors = ColorScale::of(field);
        if matches!(field, Field::Pressure | Field::Gap) && map.range[1] > 0.0 {
            map.range[0] = 0.0;
        }
        if matches!(field, Field::Gap | Field::Traction) {
            map.blank = Color::GREY;
        }
        map.title = time_title(contact);
        Ok(map)
    }
}

impl Chart {
    /// The pressure along a line of cells, see [`Fields::profile`], and beside it the net traction where surfaces
    /// [attract](crate::adhesion) each other.
    ///
    /// # Errors
    /// If `at` lies outside the grid.
    pub fn profile<'a>(contact: impl Into<Fields<'a>>, along: Axis, at: f64) -> Result<Chart> {
        let contact = contact.into();
        let profile = contact.profile(along, at)?;
        let [name, across] = match along {
            Axis::X1 => ["x1", "x2"],
            Axis::X2 => ["x2", "x1"],
        };
        let (x, y) = (Quantity::new(name, "m"), Quantity::new("pressure", "Pa"));
        let line = format!("{across} = {}", measure(at, "m"));
        let title =
            [time_title(contact), line].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
        let mut chart = Chart::new(title, x, y, Legend::UpperRight);
        let points = |values: Vec<f64>| profile.positions.iter().copied().zip(values).collect();
        if contact.attraction().is_some() {
            chart.add("pressure of the wall", COLORS[0], Style::LineAndDots, points(profile.pressure));
            chart.add("net traction", COLORS[1], Style::LineAndDots, points(profile.traction));
        } else {
            chart.add("", COLORS[0], Style::LineAndDots, points(profile.pressure));
        }
        Ok(chart)
    }
}

/// The time of a contact, as a title; empty if it knows none.
pub(super) fn time_title(contact: Fields<'_>) -> String {
    contact.time().map(|time| format!("t = {}", measure(time, "s"))).unwrap_or_default()
}
