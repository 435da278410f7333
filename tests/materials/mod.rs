//! Is a body what was asked for: its spectra, its tables, its fitted series, its share in a contact?

mod bodies;
mod intervals;
mod measured;
mod sparse_tables;
mod spectra;
mod tension;
