//! Do rough surfaces and indenters that move press as they must?

#[path = "../common/mod.rs"]
mod common;
mod motion;
mod rough;
