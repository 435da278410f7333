//! Tests of the public interface.

mod bounds;
mod data;
mod dynamic;
mod noise;
mod protocols;
mod random;
mod recovery;
mod scenes;
