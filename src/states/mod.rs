//! A creeping contact from its own elastic states, a thousand times cheaper than step by step in space.
//!
//! Let p_e(x; l) and y_e(l) be the pressure and the motions of the *elastic* contact of unit compliance under the load
//! l, the *level*. Where this contact only grows with l, the creeping contact is, in every history of force or
//! approach, with separation and renewed contact, a superposition of its elastic states:
//!
//! ```text
//! p(x, t) = ∫₀ᶜ w(l, t) dp_e(x; l),    A(t) = A_e(c(t)),    W = C ∗ dw
//! F(t)    = ∫₀ᶜ w(l, t) dl,            y(t) = ∫ W(l, t) dy_e(l)
//! ```
//!
//! Levels below c(t) are held at W = 1, those above are free, w = 0. So the surface is solved once ([`Sweep`]), and
//! every material, history and temperature after that costs a recursion on numbers ([`StatesContact`]). Ting (1966,
//! 1968) and Graham (1967) have this for contacts of one parameter; docs/methods.md proves it for every shape.
//!
//! | covered | not covered: [`ViscoelasticContact`](crate::ViscoelasticContact) |
//! |---|---|
//! | any shape or height map; half-space, periodic body, line, layer, a user's kernel | an elastic contact that shrinks somewhere as the load grows |
//! | one creep function of the contact: two bodies, elastic bulk, temperature in reduced time | layers that creep otherwise than their base |
//! | an upright body, one held at given tilts, one that tilts freely under a force at a fixed point | a load point that moves, tilts that change, several bodies, moving indenters |
//!
//! A level is a force times a compliance, in m²: an elastic body of contact modulus E* is at the level F/E*.
//!
//! ```
//! use viscocontact::prelude::*;
//! use viscocontact::states::{Reach, StatesContact, Sweep};
//!
//! let grid = Grid::square(64, 4.0e-3)?;
//! let states = Sweep::new(grid, &Sphere::new(10.0e-3)?).run(Reach::Level(1.0e-6))?;
//! // a hundred materials on one surface: no contact problem is solved any more
//! for time in 1..=100 {
//!     let body = Material::incompressible(Maxwell::with_time(1.0e6, f64::from(time))?);
//!     let mut contact = StatesContact::new(&states, &body)?;
//!     contact.step(0.0, Load::force(1.0))?;
//!     contact.step(1.0, Load::force(1.0))?;
//!     assert!(contact.contact_area() > 4.8e-6);
//! }
//! # Ok::<(), viscocontact::Error>(())
//! ```

mod beside;
mod closed_forms;
mod contact;
mod contacts;
mod control;
mod coulomb;
mod curve;
mod elastic;
mod fields;
mod friction;
mod gradient;
mod levels;
mod outside;
mod passing;
mod pressed;
mod profile;
mod reach;
mod refined;
mod repeated;
mod run;
mod run_fields;
#[cfg(feature = "checkpoint")]
mod saved;
mod snapshot;
mod solved_curve;
mod superposed;
mod sweep;

pub use crate::load::along::LateralWork;
pub use contact::StatesContact;
pub use curve::{ElasticState, ElasticStates};
#[cfg(feature = "npy")]
pub(crate) use pressed::Pressed;
pub use reach::Reach;
pub(crate) use reach::{as_elastic, greatest, sampled, softest_compliance};
pub use sweep::Sweep;

use crate::error::{Error, Result};

/// Nothing where elastic states do not cover a scene.
pub(crate) fn none_if_not_covered<T>(found: Result<Option<T>>) -> Result<Option<T>> {
    match found {
        Err(error) if does_not_superpose(&error) => Ok(None),
        other => other,
    }
}

/// Whether a step failed, or elastic states do not cover it.
fn does_not_superpose(error: &Error) -> bool {
    let is_step = matches!(error, Error::Step(_) | Error::Shrinks { .. } | Error::Slides { .. });
    is_step || error.code().starts_with("states_")
}
