//! Does the answer depend on the steps, on the rule, or on how a load history is followed?

mod adaptive;
#[path = "../common/mod.rs"]
mod common;
mod follow;
mod honest;
mod protocols;
mod protocols_run;
mod time_rules;
mod uncached;
