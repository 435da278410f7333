//! What came of a step.

use crate::contact::StepReport;

/// What came of a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use = "a contact that slides has not taken the step"]
#[allow(clippy::large_enum_variant)] // a box would be an allocation for each step that holds
pub enum Outcome {
    /// Friction carries the load.
    Holds(FrictionReport),
    /// Friction cannot carry the forces along the surface: the body slides, and the contact is as it was before the
    /// step. Prescribe its motion in place of the force to see it slide.
    Slides {
        /// Shifts along x1 and x2 \[m\] and the twist \[rad\] of the sliding motion, of the largest component 1.
        direction: [f64; 3],
        /// The forces over what is carried in their ratio; infinite where bodies are apart.
        over_limit: f64,
    },
}

/// The report of a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FrictionReport {
    /// Of the normal contact.
    pub normal: StepReport,
    /// Newton steps.
    pub iterations: usize,
    /// Work along the surface, in convolutions of a pressure on the whole grid
    /// ([`InfluenceKernel::convolve`](crate::InfluenceKernel::convolve)).
    pub convolution_equivalents: f64,
    /// The largest slip of a cell that sticks, over the largest displacement, and what is missing of a load, over it.
    pub residual: f64,
}
