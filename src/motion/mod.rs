//! Indenters that move along the surface.
//!
//! | what moves | how |
//! |---|---|
//! | an indenter, by any path, over bodies that the grid is fixed to | [`Travel`] and [`ViscoelasticContact::step_along`](crate::ViscoelasticContact::step_along) |
//! | the grid with the indenter, over endless bodies, by whole cells | [`ViscoelasticContact::step_over`](crate::ViscoelasticContact::step_over) |
//! | the same, until nothing changes any more | [`ViscoelasticContact::toward_steady`](crate::ViscoelasticContact::toward_steady) |
//!
//! Without friction, what slides and what rolls differ in one thing only: where roughness goes. On a *sliding* indenter it
//! moves along; of a *rolling* one each asperity meets its own place of the track, and that is where it stays. Roughness of
//! the creeping body stays there too ([`Travel::over`]).
//!
//! One body creeps in place. Where both bodies creep ([`Builder::counter_body`](crate::contact::Builder::counter_body)) they must roll
//! on each other: rolling pairs the same places of both for as long as they are in touch, sliding would not. An elastic
//! counter-body may slide: it remembers nothing.
//!
//! In the frame of the bodies any path may be taken, in steps of any length: a shape known by its formula is moved exactly, a
//! periodic map by its waves, any other map by bicubic interpolation. Long tracks need bodies that come round
//! ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic)) and a shape that does
//! ([`Repeated`](crate::geometry::Repeated)).

mod path;
mod travel;

pub use path::{FnPath, Path, Straight};
pub use travel::Travel;
