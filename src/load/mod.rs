//! Loads, and how they change with time.
//!
//! A [`Load`] is the load of one step. A [`LoadHistory`] returns the load at every time, for
//! [`Contact::follow`](crate::run::Contact::follow).
//!
//! | history | load |
//! |---|---|
//! | [`StepLoad`] | none, then a constant load |
//! | [`Ramp`] | linear from one load to another, then constant |
//! | [`PiecewiseLinear`] | a table, linear in between, with jumps |
//! | [`Periodic`] | square, triangle, sawtooth, any table, repeated |
//! | [`Sinusoid`] | oscillation between two loads |
//! | [`FnHistory`] | any closure of time |

#[cfg(feature = "contacts")]
pub(crate) mod along;
mod checked;
mod effect;
mod function;
#[cfg(feature = "laws")]
pub mod laws;
mod periodic;
mod piecewise_linear;
mod ramp;
mod sinusoid;
mod step_load;

pub use function::FnHistory;
pub use periodic::Periodic;
pub use piecewise_linear::PiecewiseLinear;
pub use ramp::Ramp;
pub use sinusoid::Sinusoid;
pub use step_load::StepLoad;

use std::fmt::{self, Debug};

use crate::error::{Error, Result, UserError, finite, non_negative, positive};

/// The load at the end of a step: the force or the approach of the rigid body, or the spring that drives it, and its
/// tilt.
///
/// Either the normal force or the approach is prescribed, or the far end of a spring between them, and for each of
/// the two tilts either the angle, or the coordinate of the pivot about which the body rotates freely. The
/// constructors cover the usual cases; the variants cover every combination.
///
/// ```
/// use viscocontact::load::{Load, Tilt};
///
/// // 5 N at x1 = 1 mm, free to tilt along x1, but guided along x2
/// let hinge = Load::Force { normal: 5.0, tilt: [Tilt::Free { at: 1.0e-3 }, Tilt::Fixed(0.0)] };
/// assert_ne!(hinge, Load::eccentric_force(5.0, [1.0e-3, 0.0]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Load {
    /// The normal force is prescribed, the approach follows.
    Force {
        /// Normal force \[N\], ≥ 0; a step of surfaces that attract each other also takes forces that pull
        /// ([`Builder::attraction`](crate::contact::Builder::attraction)).
        normal: f64,
        /// Tilt along x1 and along x2.
        tilt: [Tilt; 2],
    },
    /// The approach is prescribed, the force follows.
    Approach {
        /// Approach \[m\] of the point about which the body tilts: the coordinates `at` of the free tilts,
        /// the origin along axes with a prescribed tilt.
        approach: f64,
        /// Tilt along x1 and along x2.
        tilt: [Tilt; 2],
    },
    /// A spring drives the body, as the frame of a machine or the cantilever of a microscope: W = k (z − ω), without
    /// tension unless surfaces attract each other.
    Spring {
        /// Stiffness k of the spring, > 0 \[N/m\].
        stiffness: f64,
        /// Position z of its far end \[m\]: the approach of the body if nothing pressed against it. The spring acts
        /// at the point about which the body tilts, as a given approach does.
        drive: f64,
        /// Tilt along x1 and along x2.
        tilt: [Tilt; 2],
    },
}

/// The tilt along one axis: the rotation by which the body lowers the surface by α x.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Tilt {
    /// The angle is prescribed \[rad\].
    Fixed(f64),
    /// The body rotates freely: the resultant of the pressure acts at this coordinate.
    Free {
        /// Coordinate along the axis \[m\].
        at: f64,
    },
}

/// The load point of these tilts: `at` along an axis of free tilt, 0 along an axis of fixed tilt.
pub(crate) fn load_point(tilt: [Tilt; 2]) -> [f64; 2] {
    tilt.map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 })
}

/// "a force of 5 N, at x1 = 0.001 m, tilt along x2 0.1 rad": prescribed values, without tilts of zero.
impl fmt::Display for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Load::Force { normal, .. } => write!(f, "a force of {normal} N")?,
            Load::Approach { approach, .. } => write!(f, "an approach of {approach} m")?,
            Load::Spring { stiffness, drive, .. } => write!(f, "a spring of {stiffness} N/m driven by {drive} m")?,
        }
        for (tilt, axis) in self.tilt().into_iter().zip(["x1", "x2"]) {
            match tilt {
                Tilt::Fixed(0.0) => {}
                Tilt::Fixed(angle) => write!(f, ", tilt along {axis} {angle} rad")?,
                Tilt::Free { at } => write!(f, ", at {axis} = {at} m")?,
            }
        }
        Ok(())
    }
}

/// The number of values that a load prescribes, 0 where there are fewer.
const VALUES: usize = 4;

const UPRIGHT: [Tilt; 2] = [Tilt::Fixed(0.0); 2];

/// The load of one rigid body, where a method takes a load for each.
impl AsRef<[Load]> for Load {
    fn as_ref(&self) -> &[Load] {
        std::slice::from_ref(self)
    }
}

impl Load {
    /// A normal force \[N\] on a body that cannot tilt (Eq. 4 of the [paper](crate::paper)); 0 unloads.
    pub fn force(normal: f64) -> Load {
        Load::Force { normal, tilt: UPRIGHT }
    }

    /// A normal force \[N\] at the point `at` \[m\]: the body tilts freely until the resultant of the pressure acts
    /// there (Eq. 5 of the [paper](crate::paper); its Figures 2 and 3).
    pub fn eccentric_force(normal: f64, at: [f64; 2]) -> Load {
        Load::Force { normal, tilt: at.map(|at| Tilt::Free { at }) }
    }

    /// A normal force \[N\] on a body with prescribed tilts \[rad\].
    pub fn force_and_tilt(normal: f64, tilt: [f64; 2]) -> Load {
        Load::Force { normal, tilt: tilt.map(Tilt::Fixed) }
    }

    /// An approach \[m\] without tilt.
    pub fn approach(approach: f64) -> Load {
        Load::Approach { approach, tilt: UPRIGHT }
    }

    /// An approach of the origin \[m\] and tilts \[rad\].
    pub fn approach_and_tilt(approach: f64, tilt: [f64; 2]) -> Load {
        Load::Approach { approach, tilt: tilt.map(Tilt::Fixed) }
    }

    /// A spring of `stiffness` \[N/m\] whose far end is at `drive` \[m\], on a body that cannot tilt: it carries the
    /// force W = k (z − ω), or holds the body at ω = z where it does not touch.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))
    ///     .build()?;
    /// let report = contact.step(0.0, Load::spring(1.0e4, 100.0e-6))?;
    /// assert!((report.force - 1.0e4 * (100.0e-6 - report.approach)).abs() < 1.0e-5 * report.force);
    /// assert!(contact.step(1.0, Load::spring(1.0e4, 100.0e-6))?.force < report.force); // the body creeps, the spring relaxes
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn spring(stiffness: f64, drive: f64) -> Load {
        Load::Spring { stiffness, drive, tilt: UPRIGHT }
    }

    /// Tilt along x1 and along x2.
    pub fn tilt(&self) -> [Tilt; 2] {
        let (Load::Force { tilt, .. } | Load::Approach { tilt, .. } | Load::Spring { tilt, .. }) = *self;
        tilt
    }

    pub(crate) fn is_force(&self) -> bool {
        matches!(self, Load::Force { .. })
    }

    /// Force, approach or drive.
    pub(crate) fn main(&self) -> f64 {
        let (Load::Force { normal: main, .. }
        | Load::Approach { approach: main, .. }
        | Load::Spring { drive: main, .. }) = *self;
        main
    }

    /// Force, approach or drive, then the tilts or load points along x1 and x2, and the stiffness of a spring.
    fn values(&self) -> [f64; VALUES] {
        let [first, second] = self.tilt().map(|(Tilt::Fixed(value) | Tilt::Free { at: value })| value);
        let stiffness = if let Load::Spring { stiffness, .. } = *self { stiffness } else { 0.0 };
        [self.main(), first, second, stiffness]
    }

    /// With another force, approach or drive, by `change`.
    fn changed(mut self, change: f64) -> Load {
        let (Load::Force { normal: main, .. }
        | Load::Approach { approach: main, .. }
        | Load::Spring { drive: main, .. }) = &mut self;
        *main += change;
        self
    }

    /// The names of these values.
    fn names(&self) -> [&'static str; VALUES] {
        let main = match self {
            Load::Force { .. } => "normal force",
            Load::Approach { .. } => "approach",
            Load::Spring { .. } => "drive of the spring",
        };
        let free = self.tilt().map(|tilt| matches!(tilt, Tilt::Free { .. }));
        let first = if free[0] { "load point along x1" } else { "tilt along x1" };
        [main, first, if free[1] { "load point along x2" } else { "tilt along x2" }, "stiffness of the spring"]
    }

    /// Accepts loads with finite values, and a force ≥ 0 unless surfaces attract each other.
    pub(crate) fn validate_in(&self, attracts: bool) -> Result<()> {
        if let (Load::Force { normal, .. }, false) = (*self, attracts) {
            non_negative(self.names()[0], normal)?;
        }
        self.validate()
    }

    /// Accepts loads with finite values: forces may pull, which only a contact of surfaces that attract each other
    /// allows.
    pub(crate) fn validate(&self) -> Result<()> {
        let (names, values) = (self.names(), self.values());
        if let Load::Spring { stiffness, .. } = *self {
            positive("stiffness of the spring", stiffness)?;
        }
        names.into_iter().zip(values).try_for_each(|(name, value)| finite(name, value).map(drop))
    }

    /// [`Load::validate_in`] for the load that a history returned for `time`.
    pub(crate) fn validated_at(self, time: f64, attracts: bool) -> Result<Load> {
        match self.validate_in(attracts) {
            Ok(()) => Ok(self),
            Err(Error::OutOfRange { field, value, allowed }) => {
                Err(Error::LoadOutOfRange { time, field, value, allowed })
            }
            Err(other) => Err(other),
        }
    }

    /// The kind of load in words: what it controls, and which tilts are free.
    pub(crate) fn kind(&self) -> [&'static str; 2] {
        let control = match self {
            Load::Force { .. } => "a force",
            Load::Approach { .. } => "an approach",
            Load::Spring { .. } => "a spring",
        };
        let tilts = match self.tilt().map(|tilt| matches!(tilt, Tilt::Free { .. })) {
            [false, false] => "tilts prescribed",
            [true, false] => "tilt along x1 free",
            [false, true] => "tilt along x2 free",
            [true, true] => "tilts free",
        };
        [control, tilts]
    }

    /// Accepts valid loads of one kind, which can be interpolated.
    pub(crate) fn validate_all(field: &'static str, loads: impl IntoIterator<Item = Load>) -> Result<()> {
        let mut kind = None;
        for load in loads {
            load.validate()?;
            let first = *kind.get_or_insert(load.kind());
            if load.kind() != first {
                return Err(piecewise_linear::mixed(field, first, load.kind()));
            }
        }
        Ok(())
    }

    /// Whether both loads prescribe the same quantities.
    pub(crate) fn is_like(&self, other: &Load) -> bool {
        self.kind() == other.kind()
    }

    /// Deviation at `time` from the polynomial through loads of the same kind at other times: force, approach or
    /// drive relative to `scale`, tilts, points and stiffness relative to their maximum value.
    pub(crate) fn deviation(&self, time: f64, nodes: &[(f64, Load)], scale: f64) -> f64 {
        let here = self.values();
        let (mut far, mut greatest) = (here, here.map(f64::abs));
        for (k, (at, load)) in nodes.iter().enumerate() {
            // Lagrange's form
            let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
            let weight: f64 = others.map(|(_, (other, _))| (time - other) / (at - other)).product();
            for (axis, value) in load.values().into_iter().enumerate() {
                far[axis] -= weight * value;
                greatest[axis] = greatest[axis].max(value.abs());
            }
        }
        // the rounding of a load is no deviation
        let relative = |axis: usize, scale: f64| {
            let far = far[axis].abs();
            if far <= 4.0 * f64::EPSILON * greatest[axis] { 0.0 } else { far / scale }
        };
        (1..VALUES).map(|axis| relative(axis, greatest[axis])).fold(relative(0, scale), f64::max)
    }

    /// Linear interpolation at the fraction `s` from `self` to `to`, which is of the same kind.
    pub(crate) fn towards(&self, to: &Load, s: f64) -> Load {
        let mix = |a: f64, b: f64| if s == 1.0 { b } else { a + s * (b - a) };
        let mix_tilt = |a: Tilt, b: Tilt| match (a, b) {
            (Tilt::Fixed(a), Tilt::Fixed(b)) => Tilt::Fixed(mix(a, b)),
            (Tilt::Free { at: a }, Tilt::Free { at: b }) => Tilt::Free { at: mix(a, b) },
            _ => b,
        };
        let tilt = [0, 1].map(|axis| mix_tilt(self.tilt()[axis], to.tilt()[axis]));
        match (*self, *to) {
            (Load::Force { normal: a, .. }, Load::Force { normal: b, .. }) => Load::Force { normal: mix(a, b), tilt },
            (Load::Approach { approach: a, .. }, Load::Approach { approach: b, .. }) => {
                Load::Approach { approach: mix(a, b), tilt }
            }
            (Load::Spring { stiffness, drive, .. }, Load::Spring { stiffness: k, drive: z, .. }) => {
                Load::Spring { stiffness: mix(stiffness, k), drive: mix(drive, z), tilt }
            }
            _ => *to,
        }
    }
}

/// A load for every time.
///
/// ```
/// use viscocontact::load::{Load, LoadHistory};
///
/// /// Half a sine, then no load.
/// #[derive(Debug)]
/// struct Knock;
///
/// impl LoadHistory for Knock {
///     fn at(&self, t: f64) -> Load {
///         Load::force(if t < 1.0 { (std::f64::consts::PI * t).sin().max(0.0) } else { 0.0 })
///     }
///     fn next_breakpoint(&self, after: f64) -> Option<f64> {
///         (after < 1.0).then_some(1.0)
///     }
/// }
/// assert_eq!(Knock.at(0.5), Load::force(1.0));
/// ```
pub trait LoadHistory: Debug + Send + Sync {
    /// The load at time `t` \[s\]; at a jump, the load after it (right-continuous).
    ///
    /// A run of fixed steps ([`Stepping::fixed`](crate::run::Stepping::fixed)) asks for the load at the start and at
    /// the end of the step that it takes, and for the next breakpoint; so a history may read a channel whose values
    /// come while the run goes on. [Events](crate::run::Run::stop_when) look within that step. A run of adaptive
    /// steps asks for loads of the whole history before its first step, and then within each step and ahead. A run
    /// fails with [`Error::LoadOutOfRange`] at a load that is not allowed.
    fn at(&self, t: f64) -> Load;

    /// The load just before time `t`; it differs from [`LoadHistory::at`] only at a jump.
    fn before(&self, t: f64) -> Load {
        self.at(t)
    }

    /// The first breakpoint (corner or jump) later than `after` \[s\]; steps end exactly there.
    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        let _ = after;
        None
    }

    /// Why the last load was none, of a history that can fail ([`FnHistory::fallible`]). Such a load has a value that
    /// is not finite; the step that needs it then fails with [`Error::User`].
    fn failure(&self) -> Option<UserError> {
        None
    }
}

/// Implements [`LoadHistory`] for a wrapper by the history inside.
macro_rules! forward_load {
    ($($wrapper:tt)*) => {
        forward! {
            $crate::load::LoadHistory, ($($wrapper)*),
            at(t: f64) -> $crate::load::Load;
            before(t: f64) -> $crate::load::Load;
            next_breakpoint(after: f64) -> Option<f64>;
            failure() -> Option<$crate::UserError>;
        }
    };
}
use forward_load;

forward_load!(<T> self: &T => **self);
forward_load!(<T> self: Box<T> => **self);
forward_load!(<T> self: std::sync::Arc<T> => **self);
