//! Operations of a contact whose rows ranks share out.

pub(in crate::contact) mod area;
pub(in crate::contact) mod gap;
pub(in crate::contact) mod local_rows;
