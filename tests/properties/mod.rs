//! Does what must hold for every model, surface, load history and scene hold for each, and for random ones?

mod attractions;
mod laws;
#[cfg(feature = "laws")]
mod metamorphic;
#[cfg(feature = "laws")]
mod metamorphic_time;
mod periodic;
#[cfg(feature = "npy")]
mod ranks;
