//! One contact on several ranks: processes, or threads that play processes, each of which has some rows of the grid.
//!
//! A contact that outgrows a machine is shared out over several. The program is started once on each of them, makes
//! the same calls there, and adds one line to its scene, [`Builder::ranks`](crate::contact::Builder::ranks):
//!
//! ```
//! use viscocontact::prelude::*;
//! use viscocontact::parallel::Threads;
//!
//! let forces = Threads::run(3, |ranks| {
//!     let mut contact = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?)
//!         .ranks(ranks)
//!         .geometry(&Sphere::new(10.0e-3)?)
//!         .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
//!         .build()?;
//!     contact.step(0.0, Load::force(1.0))?;
//!     contact.step(0.5, Load::force(1.0))?; // every rank gets the same report
//!     Ok::<_, Error>(contact.force())
//! })?;
//! for force in forces {
//!     assert!((force? - 1.0).abs() < 1e-12);
//! }
//! # Ok::<(), Error>(())
//! ```
//!
//! The result does not depend on the number of ranks, bit by bit: sums are taken over bands of whole rows, and the
//! bands are added in the same order on every rank. Ranks compute the whole grid, as far as symmetry does not leave
//! less: they pass over
//! [`Settings::window`](crate::contact::Settings::window). A contact without ranks has the same bits if that setting is false;
//! with its default, true, its results differ from theirs by the tolerance of the solver. A
//! [`StepReport`](crate::contact::StepReport) is the same on all ranks; fields are fields of the [local
//! rows](crate::fields::Fields::rows), and [`gathered`](crate::fields::Fields::gathered) brings them to one rank.
//! Rows are given out in bands of about 8192 cells: more ranks than bands are possible, and have nothing to do.
//!
//! Every call that computes is a call of all ranks, in the same order and with the same arguments: steps, runs, and
//! observations that look at all cells ([`moment`](crate::fields::Fields::moment),
//! [`max_pressure`](crate::fields::Fields::max_pressure), [`contact_area`](crate::ViscoelasticContact::contact_area),
//! [`slope_force`](crate::fields::Fields::slope_force), [`profile`](crate::fields::Fields::profile)), files and
//! checkpoints. What a rank has by itself may be read by one
//! alone: time, force, approach, tilt, contact cells, local rows.
//!
//! If a rank leaves, the call that misses it returns [`RanksError::Left`] and leaves the contact as it was. An
//! observation without an error to return is NaN, and the next call returns the error.
//!
//! | covered | refused, by [`Error::NotCovered`](crate::Error::NotCovered) |
//! |---|---|
//! | half-spaces, bodies periodic along one axis or both, lines, layers | several rigid bodies |
//! | symmetry: half or a quarter of the grid | loads that break a symmetry that was found (set [`Settings::symmetry`](crate::contact::Settings::symmetry) to false) |
//! | force and approach, tilts, runs in steps given or chosen by their error | indenters that move or change, [`Frame::Indenter`](crate::contact::Frame::Indenter) |
//! | snapshots in memory; checkpoints, which any number of ranks resumes | checkpoints of a window of the grid ([`Settings::window`](crate::contact::Settings::window)), or of indenters that have moved |
//! | [files](crate::output): NPZ, NPY, VTK, histories; profiles | pictures, patches, stresses, [`mesh_error`](crate::fields::Fields::mesh_error) |
//!
//! Surfaces that attract each other are refused, too.
//!
//! Files and checkpoints are written by rank 0, files with the same bytes for any number of ranks; the other ranks
//! send it their rows a piece at a time. A checkpoint is read by all ranks: `ViscoelasticContact::resume`.
//!
//! A contact needs memory for the whole grid on no rank: [`Builder::ranks`](crate::contact::Builder::ranks), given
//! before the geometry, has each evaluate it on own rows, coefficients of the kernel are computed by rows and kept by
//! columns. [`Builder::memory`](crate::contact::Builder::memory) returns the bytes of a rank. Measured and random
//! surfaces hold all their heights on each rank. Clones and snapshots are of the same ranks.

mod exchange;
#[cfg(any(feature = "checkpoint", feature = "output"))]
mod file;
mod lanes;
mod ranks;
mod rows;
mod threads;
mod tile;

pub(crate) use lanes::{BAND_CELLS, Task, cut, for_each_band, for_each_share, fork, in_pool, join, lanes};
pub(crate) use rows::{Rows, part};
pub(crate) use tile::{TILE, rows_in_a_tile};

pub use crate::error::RanksError;
pub use ranks::Ranks;
pub use threads::Threads;
