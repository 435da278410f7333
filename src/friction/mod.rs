//! Friction in space: partial slip, shear and torsion of creeping bodies.
//!
//! A [`FrictionContact`] presses bodies as [`ViscoelasticContact`](crate::ViscoelasticContact) does and shears them: a
//! force or a displacement along each axis, a torque or an angle about the normal, in any mixture. Each cell sticks or
//! slips within a [`FrictionLimit`], Coulomb's law among them. The tractions of a step are the one minimum of a convex
//! problem, found by Newton's method in the sets of cells that stick and slip.
//!
//! Bodies are half-spaces, periodic bodies or line contacts of a constant Poisson's ratio ν that do not couple normal
//! and tangential loads: ν = ½ on a rigid body, or two bodies of one material. On elastic states
//! ([`StatesContact::with_friction`](crate::states::StatesContact)) shear in one direction takes microseconds.

mod by_motion;
mod contact;
mod kernel;
mod limit;
mod load;
mod load_factor;
mod modes;
mod newton;
mod operator;
mod preconditioner;
mod problem;
mod rectangle;
mod report;
mod run;
#[cfg(feature = "checkpoint")]
mod saved;
mod shear_history;
mod snapshot;
mod state;
mod work;

pub use contact::FrictionContact;
pub use limit::{Coulomb, FrictionLimit, Lesser, Tresca};
pub use load::{Component, ShearLoad};
pub use report::{FrictionReport, Outcome};
pub use shear_history::ShearHistory;
pub use snapshot::FrictionSnapshot;

pub use crate::load::along::LateralWork;
