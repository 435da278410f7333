//! The warnings of a step.

// A new one: CONTRIBUTING.md says where its number and its reasons are.

use std::fmt;

use bitflags::bitflags;

bitflags! {
    /// Reasons why the result of a step may be less accurate than expected: none, one or several.
    ///
    /// ```
    /// use viscocontact::contact::Warnings;
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let report = contact.step(0.0, Load::force(0.1))?;
    /// assert!(report.warnings.contains(Warnings::FEW_CELLS));
    /// for warning in &report.warnings {
    ///     println!("{warning}");
    /// }
    /// # Ok::<(), Error>(())
    /// ```
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub struct Warnings: u32 {
        /// Contact is within two cells of an edge of the grid beyond which the bodies extend. Under a slightly
        /// greater load a step fails with [`StepError::ContactAtEdge`](crate::contact::StepError::ContactAtEdge).
        /// Enlarge the grid. Only with
        /// [`Edge::Refuse`](crate::contact::Edge::Refuse).
        const NEAR_EDGE = 1 << 0;
        /// The contact is fewer than 8 cells across
        /// ([`Figures::cells_across`](crate::contact::Figures::cells_across)): that of one body, or the patches of it
        /// on average, as on rough surfaces. Refine the mesh;
        /// [`Fields::mesh_error`](crate::fields::Fields::mesh_error) measures the error from 6 on. A sphere's approach,
        /// maximum pressure and contact area err by up to 1.3 %, 4 % and 8 % with contacts of 4 cells across, by 0.5
        /// %, 1.5 % and 2.5 % with 8; the approach and the area of rough surfaces by up to 10 % each with 4, by up to
        /// 3 % and 5 % with 8.
        const FEW_CELLS = 1 << 1;
        /// The loading time exceeds the measured range of the material: a table is extrapolated beyond its data
        /// ([`CreepSeries::extrapolated`](crate::rheology::CreepSeries::extrapolated)).
        const EXTRAPOLATED = 1 << 2;
        /// The step is shorter than the times for which the material is known: creep within it counts as elastic.
        const FASTER_THAN_MATERIAL = 1 << 3;
        /// Of single steps: one more step of this length would exceed the range in which the material is known, and
        /// fail with
        /// [`StepError::BeyondMaterial`](crate::contact::StepError::BeyondMaterial).
        const NEAR_END_OF_MATERIAL = 1 << 4;
        /// The solver stagnated, and its slow fall-back took over for a while:
        /// [`StepReport::fallback_iterations`](crate::contact::StepReport::fallback_iterations). The result meets the
        /// tolerance. If this happens often, take smaller steps or a larger tolerance.
        const FALL_BACK = 1 << 6;
        /// The table of the material does not determine its creep well, or is inconsistent with a linear body: see
        /// [`FitReport::warning`](crate::rheology::FitReport::warning) of each of the
        /// [`Material::fit_reports`](crate::rheology::Material::fit_reports).
        const UNCERTAIN_MATERIAL = 1 << 7;
        /// The gap is a sum of numbers whose rounding exceeds
        /// [`Settings::tolerance`](crate::contact::Settings::tolerance) times the displacement due to the pressure,
        /// as where little pressure is left on bodies that were pressed much harder before, or where the heights of a
        /// shape are all far from 0: the error of pressure and force exceeds the residual.
        const ROUNDING = 1 << 8;
        /// The contact modulus at once, 1/C(0), is below 10 Pa or above 1e13 Pa, which no solid has: moduli are given
        /// in another unit than Pa, or compliances in another one than 1/Pa.
        const MODULUS = 1 << 9;
        /// The undeformed bodies are steeper than 0.5 somewhere in contact
        /// ([`Figures::max_slope`](crate::contact::Figures::max_slope)): slopes and strains are not small, and
        /// half-spaces are no model of the bodies. Heights in µm that are read as metres are that steep. A slope is
        /// the lesser of the slopes to the neighbours on each side, so that a step between two cells does not count.
        const STEEP = 1 << 10;
        /// The zone at the edge of the contact in which the attraction acts is less than 4 cells long at the
        /// compliance that the bodies have reached: the force of a slow pull-off is off by a percent or more. A fast
        /// pull finds a stiffer body, and a longer zone. Refine the mesh, or take an attraction of longer range.
        const COARSE_ZONE = 1 << 11;
        /// Surfaces that attract each other snapped together or apart within the step: its end is known, not the
        /// moment within it. A jump is what stays however a step is split
        /// ([`PassReport::jumped`](crate::contact::PassReport::jumped));
        /// [`PassReport::released`](crate::contact::PassReport::released) is the energy that was lost. Adaptive steps
        /// are shortened until the moment no longer matters.
        const JUMP = 1 << 12;
        /// The undeformed bodies are flatter than a slope of 1e-6 everywhere on the grid, a nanometre over a
        /// millimetre, but not flat: sides of a map or a grid in µm that are read as metres are that long for their
        /// heights.
        ///
        /// Or the grid is longer than 0.1 m along a side of several cells, and they rise by less than 1e-4 of it.
        const FLAT = 1 << 13;
        /// The bodies are pressed into a layer by more than a fifth of its thickness
        /// ([`Figures::compression`](crate::contact::Figures::compression)): strains are not small, and the layer is
        /// stiffer than computed. A step that presses them in by the whole thickness fails with
        /// [`StepError::ThroughLayer`](crate::contact::StepError::ThroughLayer).
        const DEEP = 1 << 14;
        /// A shape has another period than the periodic bodies
        /// ([`Figures::periods`](crate::contact::Figures::periods)): it jumps at the edge of the grid, where a step
        /// of the surface carries pressure. Make the grid a whole number of periods long.
        const OTHER_PERIOD = 1 << 15;
        /// The shortest waves of a shape have fewer than 4 cells
        /// ([`Figures::cells_in_wave`](crate::contact::Figures::cells_in_wave)): their crests are missed, or seem
        /// longer waves below 2 cells. Refine the mesh, or leave these waves out.
        const SHORT_WAVES = 1 << 16;
        /// The estimated error in time of the step exceeds 5 %
        /// ([`StepReport::time_error`](crate::contact::StepReport::time_error)): take shorter steps, or
        /// [`Stepping::adaptive`](crate::run::Stepping::adaptive) ones. Adaptive steps of a greater tolerance
        /// carry it, too.
        const LONG_STEP = 1 << 17;
        /// The run has ended, and its approach or spring has never brought the bodies into contact: they touch at the
        /// approach that equals the minimum gap, and a greater approach presses. Carried by the last step of a run.
        const NO_CONTACT = 1 << 18;
        /// The attraction beyond the edge of the grid, which is not computed, would add more than 1e-3 of the force
        /// ([`Figures::beyond_edge`](crate::contact::Figures::beyond_edge)), or than
        /// [`Settings::tolerance`](crate::contact::Settings::tolerance): enlarge the grid. From 5 % on a step fails.
        /// Only with
        /// [`Edge::Refuse`](crate::contact::Edge::Refuse).
        const BEYOND_EDGE = 1 << 19;
        /// Waves that hold more than a tenth of the elastic energy of a steady motion, or of its
        /// part that can be lost, pass the bodies at frequencies at which the material was not
        /// measured ([`Figures::unmeasured`](crate::contact::Figures::unmeasured)): the series of a
        /// table is elastic beyond its data, and resists too little. Measure at the frequencies q·v
        /// of the waves in contact.
        const FREQUENCIES = 1 << 20;
        /// Traces of the indenter have left the grid behind it that could change approach or lateral force by more
        /// than 1 % ([`Figures::wake`](crate::contact::Figures::wake)): friction comes out too small. Lengthen the
        /// grid behind the contact, to some v τ of the slowest creep, or compute the steady state at once
        /// ([`sliding`](crate::sliding)).
        const WAKE = 1 << 21;
    }
}

impl Warnings {
    /// The warnings whose reasons apply.
    pub(crate) fn of(reasons: &[(Warnings, bool)]) -> Warnings {
        reasons.iter().filter(|(_, applies)| *applies).map(|(warning, _)| *warning).collect()
    }
}

impl IntoIterator for &Warnings {
    type Item = Warnings;
    type IntoIter = bitflags::iter::Iter<Warnings>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// What each warning says, and its remedy.
const MESSAGES: [(Warnings, &str); 21] = [
    (Warnings::NEAR_EDGE, "contact is within two cells of the edge of the grid: enlarge the grid"),
    (Warnings::FEW_CELLS, "contact is fewer than 8 cells across, of a body or of patches on average: refine the mesh"),
    (Warnings::EXTRAPOLATED, "the material is extrapolated beyond its data: measure it longer, or end earlier"),
    (Warnings::FASTER_THAN_MATERIAL, "the step counts as elastic, shorter than the material is known for: lengthen it"),
    (
        Warnings::NEAR_END_OF_MATERIAL,
        "the next such step exceeds the times at which the material is known: take a shorter one, or measure longer",
    ),
    (Warnings::FALL_BACK, "the solver needed its slow fall-back: take smaller steps if this happens often"),
    (Warnings::UNCERTAIN_MATERIAL, "the table of the material leaves its creep uncertain: see its fit report"),
    (
        Warnings::ROUNDING,
        "the rounding of the gap makes the pressure uncertain, so small is it, or so far are heights from 0: do \
        not use it",
    ),
    (Warnings::MODULUS, "no solid has such a modulus: moduli are in Pa, compliances in 1/Pa"),
    (
        Warnings::STEEP,
        "the bodies are steeper than 0.5 in contact, too steep for small strains: check that lengths are in m",
    ),
    (Warnings::FLAT, "the bodies are flatter than real ones: check that heights and lengths are in m"),
    (Warnings::COARSE_ZONE, "the attraction acts over fewer than 4 cells: refine the mesh, or lengthen its range"),
    (Warnings::JUMP, "surfaces snapped together or apart in this step: take shorter steps to see when"),
    (Warnings::DEEP, "the layer is pressed in by over a fifth of its thickness: press less, or check the thickness"),
    (Warnings::OTHER_PERIOD, "no whole number of periods of the shape fits the bodies: make the grid as long"),
    (
        Warnings::SHORT_WAVES,
        "the shortest waves of the shape have fewer than 4 cells: refine the mesh, or leave them out",
    ),
    (Warnings::LONG_STEP, "the step is too long, its error in time over 5 %: take shorter or adaptive steps"),
    (Warnings::BEYOND_EDGE, "attraction beyond the edge of the grid is left out: enlarge the grid"),
    (
        Warnings::FREQUENCIES,
        "waves in contact pass at frequencies at which the material was not measured: measure there, or change \
        the speed",
    ),
    (Warnings::WAKE, "traces that still recover have left the grid: lengthen it behind the contact"),
    (Warnings::NO_CONTACT, "the bodies never touched in the run: raise the approach, or check its sign and unit"),
];

/// The warnings, separated by semicolons; nothing if there are none.
/// [`StepReport::messages`](crate::contact::StepReport::messages) adds their numbers.
impl fmt::Display for Warnings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (_, message) in MESSAGES.iter().filter(|(warning, _)| self.contains(*warning)) {
            write!(f, "{separator}{message}")?;
            separator = "; ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_warning_has_a_message() {
        assert!(Warnings::empty().to_string().is_empty());
        assert!(Warnings::all().iter().all(|warning| !warning.to_string().is_empty()));
        assert_eq!(Warnings::all().to_string().split("; ").count(), MESSAGES.len());
    }
}
