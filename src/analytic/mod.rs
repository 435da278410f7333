//! Reference solutions, for tests and to verify a scene.
//!
//! | solution | scene |
//! |---|---|
//! | [`Hertz`], [`HertzEllipse`] | sphere, paraboloid with two radii; elastic |
//! | [`RigidPunch`] | flat circular punch, centred or eccentric; elastic |
//! | [`GrowingSphere`] | sphere under a step load (Ting) or any load that never lets the contact shrink (Lee & Radok); viscoelastic |
//! | [`Jkr`], [`MaugisDugdale`], [`Dmt`] | sphere that sticks, by an attraction of short, any and long range; elastic |
//! | [`AdhesivePunch`], [`AdhesiveCylinder`], [`AdhesiveWave`] | other shapes that stick, by an attraction of short range; elastic |
//! | [`OpeningEdge`] | edge of a contact that opens at a speed, sphere that is pulled off; viscoelastic |
//! | [`CattaneoMindlin`], [`LubkinTorsion`] | ball that is sheared or twisted, and slips in part; elastic |
//! | [`RollingCylinder`] | cylinder in steady motion; one retardation time |
//! | [`SlidingLimits`] | ball, ellipsoid, cylinder in slow or fast steady motion; any creep |
//! | [`PerssonFriction`] | rough surface in steady motion, an estimate; any creep |
//!
//! Sphere, cone, punch and other axisymmetric bodies under any load history, loading and unloading, are contacts on
//! closed elastic states: [`ElasticStates::sphere`](crate::states::ElasticStates::sphere) and its neighbours.
//!
//! Contact modulus E* is 1/C of an elastic body: E* = 2G/(1 − ν), 4G if incompressible.

mod adhesion;
mod growing_sphere;
mod hertz;
mod hertz_ellipse;
mod partial_slip;
mod persson;
mod rigid_punch;
mod rolling;
mod sliding_limits;

pub use adhesion::{AdhesiveCylinder, AdhesivePunch, AdhesiveWave, Dmt, Jkr, MaugisDugdale, OpeningEdge, PullOff};
pub use growing_sphere::GrowingSphere;
pub use hertz::Hertz;
pub use hertz_ellipse::HertzEllipse;
pub use partial_slip::{CattaneoMindlin, LubkinTorsion};
pub use persson::PerssonFriction;
pub use rigid_punch::RigidPunch;
pub use rolling::RollingCylinder;
pub use sliding_limits::SlidingLimits;
