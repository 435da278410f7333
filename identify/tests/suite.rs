//! Tests of the public interface.

mod data;
mod dynamic;
mod protocols;
mod random;
