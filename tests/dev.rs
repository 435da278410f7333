use viscocontact_scenes as common;
#[path = "time/inside.rs"]
mod inside;
#[path = "time/run.rs"]
mod run;
