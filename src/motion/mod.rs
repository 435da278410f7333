//! Indenters that move along the surface.
//!
//! | motion | method |
//! |---|---|
//! | an indenter along any path, on a grid fixed to the bodies | [`Travel`] and [`ViscoelasticContact::step_along`](crate::ViscoelasticContact::step_along) |
//! | an indenter and the grid over endless bodies, by whole cells | [`ViscoelasticContact::step_over`](crate::ViscoelasticContact::step_over) |
//! | a steady motion without steps, one contact problem a velocity | [`sliding`](crate::sliding) |
//!
//! Without friction, sliding and rolling differ only in the motion of roughness. The roughness of a *sliding* indenter
//! moves with it. Each asperity of a *rolling* indenter meets its own point of the track, so that its roughness is
//! fixed to the track, as is the roughness of the creeping body ([`Travel::over`]).
//!
//! One body creeps in place. Where both bodies creep
//! ([`Builder::counter_body`](crate::contact::Builder::counter_body)) they must roll on each other:
//! in rolling, the same points of both bodies stay opposite each other while in contact, in sliding
//! they do not. An elastic counter-body may slide, since it has no history. In a steady motion
//! without steps a creeping counter-body may slide, too: its own points are relaxed then
//! ([`CounterMotion`]).
//!
//! In the frame of the bodies, paths and steps are arbitrary: a shape given by a formula is moved exactly, a periodic
//! map by its Fourier series, any other map by bicubic interpolation. Long tracks need periodic bodies
//! ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic)) and a periodic shape
//! ([`Repeated`](crate::geometry::Repeated)).

mod counter;
#[cfg(feature = "motion")]
mod path;
#[cfg(feature = "motion")]
mod travel;

pub use counter::CounterMotion;
#[cfg(feature = "motion")]
pub use path::{FnPath, Path, Straight};
#[cfg(feature = "motion")]
pub use travel::Travel;
