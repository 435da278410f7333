//! Work on fields, shared between threads: below everything that computes.

mod lanes;
mod tile;

pub(crate) use lanes::{BAND_CELLS, Task, for_each_band, for_each_share, in_pool, join, lanes, middle};
pub(crate) use tile::{TILE, rows_in_a_tile};
