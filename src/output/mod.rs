//! Results as files that other tools open, written frame by frame: a run does not have to fit into memory.
//!
//! | what | feature | opened by |
//! |---|---|---|
//! | `NpzSeries`: a folder of NPZ archives, one a frame | `npy` | NumPy, Julia, MATLAB |
//! | `write_npy`: one field as an NPY file | `npy` | NumPy, Julia, MATLAB |
//! | `VtkSeries`: a folder of VTK images and a `series.pvd` | `vtk` | ParaView, VisIt, PyVista |
//! | `CsvHistory`: one row a step | `csv` | pandas, spreadsheets, gnuplot |
//!
//! Values are written in double precision, bit by bit, in SI units; each file carries a [`Scene`] that says
//! what was computed. Which [`Field`]s are written is chosen. A frame is complete on disk when its `write`
//! returns, so that a run that is killed leaves all frames before readable.
//!
//! Nothing of an earlier run is overwritten: a series is refused a folder that holds frames, a history a file
//! that exists. A single file (`write_npy`, pictures, checkpoints) replaces a file of its name when it is complete; where its name
//! is a link, the link stays and the file that it leads to is replaced. A folder, device, pipe or socket is left alone:
//! [`Error::NotAFile`](crate::Error::NotAFile). Until it is complete a file has the number of the process and `.part` behind its
//! name; a process that is killed leaves it so.
//!
//! A write that fails, as on a full disk, leaves what was written before, no part of its own, and can be tried again.

#[cfg(feature = "csv")]
mod csv;
#[cfg(feature = "npy")]
mod deferred;
mod field;
#[cfg(any(feature = "npy", feature = "vtk"))]
mod frames;
mod json;
#[cfg(feature = "npy")]
mod npy;
#[cfg(feature = "npy")]
mod npz;
mod scene;
#[cfg(feature = "vtk")]
mod vtk;

#[cfg(feature = "csv")]
pub use csv::CsvHistory;
pub use field::Field;
#[cfg(feature = "npy")]
pub use npy::write_npy;
#[cfg(feature = "npy")]
pub use npz::NpzSeries;
pub use scene::Scene;
#[cfg(feature = "vtk")]
pub use vtk::VtkSeries;
