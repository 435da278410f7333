//! Results of a contact: fields, scalars, observations, energies, reports and warnings.

pub(in crate::contact) mod accessors;
#[cfg(feature = "energies")]
pub(in crate::contact) mod energies;
pub(crate) mod limits;
