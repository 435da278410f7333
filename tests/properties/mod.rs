//! Does what must hold for every model, surface, load history and scene hold for each, and for random ones?

mod attractions;
mod laws;
mod metamorphic;
mod metamorphic_time;
mod periodic;
mod ranks;
mod related;
mod sisters;
