//! Maps of the stress on a section.

use crate::error::{Result, exact_length, in_order, least_length, within};
use crate::fields::Fields;
use crate::observe::{Stress, StressSection};
use crate::plot::contact::time_title;
use crate::plot::map::runs;
use crate::plot::{Map, Quantity};
use crate::{Axis, Grid};

/// Maximum difference of the steps between depths, relative to the first of them.
const UNEQUAL: f64 = 1e-6;

impl Map {
    /// A quantity of the stress on a section below the surface of `contact`, such as [`Stress::von_mises`]; the bar
    /// on the surface is the contact along the section. Each depth fills the layer from half a step above it to half
    /// a step below, so that depths of ½, 3/2, … steps begin at the surface.
    ///
    /// ```
    /// use viscocontact::{Axis, observe::Stress};
    /// use viscocontact::{plot::{Map, Quantity}, prelude::*};
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 2.4e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Elastic::new(1.0e6)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let depths: Vec<f64> = (0..16).map(|k| (f64::from(k) + 0.5) * 0.1e-3).collect();
    /// let section = contact.fields().stress()?.on_section(Axis::X1, 0.0, &depths)?;
    /// let map = Map::section(&contact, &section, Stress::von_mises, Quantity::new("von Mises stress", "Pa"))?;
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-section-{}.png", std::process::id()));
    /// map.save(&path)?;
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If there are fewer than two depths, they do not rise in equal steps, the section does not lie below the grid
    /// of the contact, or a value is beyond ±1e100.
    pub fn section<'a>(
        contact: impl Into<Fields<'a>>,
        section: &StressSection,
        quantity: impl Fn(&Stress) -> f64,
        name: impl Into<Quantity>,
    ) -> Result<Map> {
        let contact = contact.into();
        let (axis, _) = section.along.and_other();
        let (positions, depths) = (&section.positions, &section.depths);
        exact_length("positions of a section", positions.len(), contact.grid().cells()[axis])?;
        let centre = |k: usize| if axis == 0 { contact.grid().center(k, 0)[0] } else { contact.grid().center(0, k)[1] };
        let (field, allowed) = ("position of a section", "the middle of a cell of the contact");
        for (k, &position) in positions.iter().enumerate() {
            within(field, position, (position - centre(k)).abs() <= UNEQUAL * contact.grid().spacing()[axis], allowed)?;
        }
        exact_length("stresses on a section", section.values.len(), positions.len() * depths.len())?;
        least_length("depths of a section", depths.len(), 2)?;
        let step = depths[1] - depths[0];
        let equal = |previous: f64, value: f64| (value - previous - step).abs() <= UNEQUAL * step;
        in_order("depths of a section", depths.iter().copied(), "rise in equal steps", equal)?;
        let (side, count) = (contact.grid().spacing()[axis], depths.len());
        let grid = Grid::new([positions.len(), count], [side * positions.len() as f64, step * count as f64])?;
        // the map is drawn from below
        let from_below = section.values.chunks_exact(count).flat_map(|column| column.iter().rev());
        let mut map = Map::new(&grid, from_below.map(quantity).collect(), name)?;
        let surface = 0.5 * step - depths[0];
        map.middle = [0.5 * (positions[0] + positions[positions.len() - 1]), surface - 0.5 * grid.lengths()[1]];
        let label = if section.along == Axis::X1 { "x1" } else { "x2" };
        map.axes = [Quantity::new(label, "m"), Quantity::new("−depth", "m")];
        map.title = time_title(contact);
        let profile = contact.profile(section.along, section.at)?;
        let pressed = runs(positions.len(), |k| profile.pressure[k] > 0.0).into_iter();
        let ends = pressed.map(|(from, to)| [positions[from] - 0.5 * side, positions[to - 1] + 0.5 * side]);
        map.lines = ends.map(|ends| ends.map(|x| (x, surface))).collect();
        Ok(map)
    }
}
