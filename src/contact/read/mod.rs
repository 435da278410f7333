//! Short names for what `fields()` gives, the balance of energies, and the limits of the material. What is read of every
//! contact is in `crate::fields`.

pub(in crate::contact) mod accessors;
#[cfg(feature = "energies")]
pub(in crate::contact) mod energies;
pub(crate) mod limits;
