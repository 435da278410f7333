//! Tests of the public interface.

mod data;
mod drainage;
mod dynamic;
mod protocols;
mod random;
mod usual;
