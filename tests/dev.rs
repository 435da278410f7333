use viscocontact_scenes as common;
#[path = "io/clauses/mod.rs"]
mod clauses;
