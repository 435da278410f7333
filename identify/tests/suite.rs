//! Tests of the public interface.

mod protocols;
