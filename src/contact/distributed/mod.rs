//! What a contact does for ranks that share out its rows.

pub(in crate::contact) mod area;
pub(in crate::contact) mod gap;
pub(in crate::contact) mod local_rows;
