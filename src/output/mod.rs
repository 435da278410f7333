//! Results in files that other tools open, written frame by frame, so that a run does not have to fit into memory.
//!
//! | output | feature | opened by |
//! |---|---|---|
//! | `FrameSeries`: a folder of frames as NPZ archives | `npy` | NumPy, Julia, MATLAB |
//! | `FrameSeries`: a folder of frames as VTK images, with a `series.pvd` | `vtk` | ParaView, VisIt, PyVista |
//! | `write_npy`, `write_field_npy`: one field as an NPY file | `npy` | NumPy, Julia, MATLAB |
//! | `write_stress`: the stress in a volume as an NPZ archive | `npy` | NumPy, Julia, MATLAB |
//! | `write_stress`: the stress in a volume as a VTK grid | `vtk` | ParaView, VisIt, PyVista |
//! | `CsvHistory`: one row per step | `csv` | pandas, spreadsheets, gnuplot |
//!
//! Values are written in double precision, bitwise, in SI units. Each file contains [`Metadata`] that describe the run.
//! You choose which [`Field`]s are written. A frame is complete on disk when its `write` returns: if a run is killed,
//! all earlier frames are readable.
//!
//! Files of an earlier run are replaced by these rules. What grows with a run, a series or a history, is not replaced by
//! `create`, which refuses a folder with frames or an existing file ([`AlreadyExists`](std::io::ErrorKind::AlreadyExists));
//! `create_or_replace` removes them first. What is written at once (`write_npy`, stresses, pictures, animations, checkpoints) replaces
//! an existing file, once the new one is complete; if the path is a link, its target is replaced. Folders, devices, pipes and sockets are never replaced:
//! [`Error::NotAFile`](crate::Error::NotAFile). While a file is being written, the process ID and `.part` are appended
//! to its name; a process that is killed leaves it under that name.
//!
//! Where [ranks](crate::parallel) share out a contact, writing it is a call of all of them. Rank 0 writes, the same bytes that one
//! process writes, and the rows of the others come to it some at a time: no rank holds a whole field, and no other rank needs
//! the disk. An error is one of all ranks. A series is created by each of them: so the folder must be one that all see, or be
//! new to each.
//!
//! A write that fails, for instance on a full disk, leaves earlier output intact and no partial output of its own. It
//! can be repeated.

#[cfg(feature = "csv")]
mod csv;
#[cfg(feature = "npy")]
mod deferred;
mod field;
#[cfg(any(feature = "npy", feature = "vtk"))]
mod field_values;
mod metadata;
#[cfg(feature = "npy")]
mod npy;
#[cfg(feature = "npy")]
mod npz;
#[cfg(any(feature = "npy", feature = "vtk"))]
mod series;
#[cfg(any(feature = "npy", feature = "vtk"))]
mod stress;
#[cfg(feature = "vtk")]
mod vtk;

#[cfg(feature = "csv")]
pub use csv::CsvHistory;
pub use field::Field;
pub use metadata::Metadata;
#[cfg(feature = "npy")]
pub use npy::{write_field_npy, write_npy};
#[cfg(any(feature = "npy", feature = "vtk"))]
pub use series::{Format, FrameSeries};
#[cfg(any(feature = "npy", feature = "vtk"))]
pub use stress::write_stress;
