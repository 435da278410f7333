//! Settings of a contact.

use crate::error::{Result, count_within, within};
use crate::hereditary::Interpolant;

/// Adaptive steps that are less accurate solve less accurately, unless a stricter tolerance was asked for.
pub(crate) const DEFAULT_TOLERANCE: f64 = 1e-6;

value! {
/// How a contact is computed: [`Settings::default`], changed by methods `with_…`, and validated when a contact is
/// built.
///
/// ```
/// use viscocontact::contact::{Settings, TimeRule};
///
/// let settings = Settings::default().with_tolerance(1e-8).with_time_rule(TimeRule::ExponentialLinear);
/// assert_eq!(Settings::default().tolerance(), 1e-6);
/// # let _ = settings;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Settings {
    /// Tolerance of the contact problem of a step: rms |h| in contact, relative to rms (c K p) there; the deepest
    /// penetration, in contact or outside, may be ten times that (default: 1e-6; range \[1e-13, 0.1\]). Adaptive
    /// steps solve to 0.03 of their own tolerance if that is more, unless this one is stricter than the default.
    /// Where surfaces attract each other, forces are as exact, over the maximum attraction, down to 3e-4, and below
    /// 1e-6 to three hundred tolerances.
    tolerance: f64, with_tolerance;
    /// Iterations a step may take before it fails, twice as many where surfaces attract each other (default: 1000;
    /// range: 1 or more).
    max_iterations: usize, with_max_iterations;
    /// The time rule of the hereditary integral (default: [`TimeRule::Exponential`]).
    time_rule: TimeRule, with_time_rule;
    /// What happens when contact reaches the edge of the grid (default: [`Edge::Refuse`]).
    edge: Edge, with_edge;
    /// Relative error of the creep compliance of an exponential series that is fitted to a rheology without an exact
    /// one (default: 1e-4; range \[1e-8, 0.1\]).
    series_tolerance: f64, with_series_tolerance;
    /// Whether only half or a quarter of the cells is computed where gap and load are even in x1, x2, or both,
    /// bitwise, and the number of cells along that axis is even (default: true). The iterations of the solver differ,
    /// and so does the result, by about ten times the [tolerance](Settings::tolerance) in the pressure and less in
    /// the approach.
    symmetry: bool, with_symmetry;
    /// Whether only the rectangle in which the bodies can touch is computed, and the rest of the grid on demand
    /// (default: true). The rectangle grows with the contact; a step in which it grows allocates memory. On
    /// bodies other than the half-space loaded on the grid, such as layers, the whole grid is computed.
    window: bool, with_window;
    /// The frame of the grid (default: [`Frame::Bodies`]).
    frame: Frame, with_frame;
}
}

/// The frame of the grid. It only matters for motion along the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Frame {
    /// The creeping bodies: an indenter moves over the grid
    /// ([`ViscoelasticContact::step_along`](crate::ViscoelasticContact::step_along)), by any path, as far as the grid
    /// reaches, or endlessly on periodic bodies.
    #[default]
    Bodies,
    /// The indenter: the bodies move under the grid, by whole cells
    /// ([`ViscoelasticContact::step_over`](crate::ViscoelasticContact::step_over)), endlessly. A step costs one
    /// convolution more; a further relaxation time costs two fields and their recursion. The whole grid is computed.
    Indenter,
}

/// The time rule of the hereditary integral. The rule of the [paper](crate::paper), of first order, is in the package
/// `viscocontact-paper`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TimeRule {
    /// Exponential integration of the relaxation form, stable for steps of any length, one field per relaxation time.
    /// Within a step the displacement is a polynomial of time through its last values, and each step corrects the
    /// step before, which had one value less. Steps of given length take it to be linear: third order. Steps chosen
    /// by their error ([`Stepping::adaptive`](crate::run::Stepping::adaptive)), and all of a body without elastic
    /// response (as Kelvin–Voigt), take it to be quadratic: fourth order, second without elastic response. A kink of
    /// the displacement, as at cells that come into contact, is met with second order.
    ///
    /// A rheology without an exact exponential series gets a fitted one: see
    /// [`Builder::times`](crate::contact::Builder::times).
    #[default]
    Exponential,
    /// The same with the displacement linear within each step, and no correction afterwards: second order (first
    /// without elastic response). A prediction never rises above the undeformed surface, whatever the lengths of the
    /// steps.
    ExponentialLinear,
}

/// What happens when contact reaches the outermost cells of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Edge {
    /// The step fails with [`StepError::ContactAtEdge`](crate::contact::StepError::ContactAtEdge): the bodies go on
    /// beyond the grid, so that the result would be wrong.
    #[default]
    Refuse,
    /// The step continues: the rigid body ends where the grid does.
    Allow,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            tolerance: DEFAULT_TOLERANCE,
            max_iterations: 1000,
            time_rule: TimeRule::default(),
            edge: Edge::default(),
            series_tolerance: 1e-4,
            symmetry: true,
            window: true,
            frame: Frame::Bodies,
        }
    }
}

impl Settings {
    /// How the displacement changes within a step of given length.
    pub(crate) fn interpolant(&self) -> Interpolant {
        if self.time_rule == TimeRule::ExponentialLinear { Interpolant::Linear } else { Interpolant::CorrectedLinear }
    }

    /// How the displacement changes within a step chosen by its error.
    pub(crate) fn adaptive_interpolant(&self) -> Interpolant {
        if self.time_rule == TimeRule::ExponentialLinear {
            Interpolant::Linear
        } else {
            Interpolant::CorrectedQuadratic
        }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        let tolerance = self.tolerance;
        within("Settings::tolerance", tolerance, (1e-13..=0.1).contains(&tolerance), "in [1e-13, 0.1]")?;
        let series = self.series_tolerance;
        within("Settings::series_tolerance", series, (1e-8..=0.1).contains(&series), "in [1e-8, 0.1]")?;
        let iterations = self.max_iterations;
        count_within("Settings::max_iterations", iterations, iterations > 0, "1 or more")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed() -> Settings {
        Settings {
            tolerance: 1e-7,
            max_iterations: 7,
            time_rule: TimeRule::ExponentialLinear,
            edge: Edge::Allow,
            series_tolerance: 1e-3,
            symmetry: false,
            window: false,
            frame: Frame::Indenter,
        }
    }

    #[test]
    fn each_method_changes_its_field() {
        let settings = Settings::default()
            .with_tolerance(1e-7)
            .with_max_iterations(7)
            .with_time_rule(TimeRule::ExponentialLinear)
            .with_edge(Edge::Allow)
            .with_series_tolerance(1e-3)
            .with_symmetry(false)
            .with_window(false)
            .with_frame(Frame::Indenter);
        assert_eq!(settings, changed());
    }

    #[cfg(feature = "checkpoint")]
    #[test]
    fn serialised_values_come_back() {
        use crate::geometry::{RoughSpec, Roughness};
        use crate::load::Load;

        fn there_and_back<T: serde::Serialize + serde::de::DeserializeOwned>(value: T) -> T {
            postcard::from_bytes(&postcard::to_stdvec(&value).unwrap()).unwrap()
        }
        assert_eq!(there_and_back(changed()), changed());
        let load = Load::eccentric_force(1.0, [1.0e-3, 0.0]);
        assert_eq!(there_and_back(load), load);
        let spec = RoughSpec::new(1.0e-3, 1.0e-5, Roughness::RmsSlope(0.1)).with_seed(3);
        assert_eq!(there_and_back(spec), spec);
    }
}
