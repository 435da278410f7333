//! Tests of the public interface.

mod beyond;
mod bounds;
mod continued;
mod coverage;
mod data;
mod drive;
mod dynamic;
mod instruments;
mod nested;
mod noise;
mod protocols;
mod random;
mod recovery;
mod release;
mod results;
mod scenes;
mod spectra;
mod statements;
mod usual;
mod verify;
