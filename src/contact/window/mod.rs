//! The part of the grid that is computed: which one, with what, and how a state gets to a larger one.

pub(in crate::contact) mod fields;
pub(crate) mod placement;
pub(crate) mod region;
#[expect(clippy::module_inception, reason = "the file is named after its type")]
pub(crate) mod window;
