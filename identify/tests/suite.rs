//! Tests of the public interface.

mod data;
mod protocols;
