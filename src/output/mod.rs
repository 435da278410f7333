//! Results in files that other tools open, written frame by frame, so that a run does not have to fit into memory.
//!
//! | output | feature | opened by |
//! |---|---|---|
//! | `FrameSeries`: a folder of frames as NPZ archives | `npy` | NumPy, Julia, MATLAB |
//! | `FrameSeries`: a folder of frames as VTK images, with a `series.pvd` | – | ParaView, VisIt, PyVista |
//! | `write_npy`: one field as an NPY file | `npy` | NumPy, Julia, MATLAB |
//! | `write_stress`: the stress in a volume as an NPZ archive | `npy` | NumPy, Julia, MATLAB |
//! | `write_stress`: the stress in a volume as a VTK grid | – | ParaView, VisIt, PyVista |
//! | `write_states`, `read_states`: elastic states as an NPZ archive | `npy` | NumPy, Julia, MATLAB |
//! | `CsvHistory`: one row per step | – | pandas, spreadsheets, gnuplot |
//!
//! Values are written in double precision, bitwise, in SI units. Each file contains [`Metadata`] that describe the
//! run; those of a history are beside it.
//! You choose which [`Field`]s are written. A frame is complete on disk when its `record` returns: if a run is killed,
//! all earlier frames are readable.
//!
//! Files of an earlier run are replaced by these rules. Series and histories grow with a run: [`Earlier`] says
//! whether a folder with frames or an existing file is refused, removed or continued. Files that are written at once
//! (fields, stresses, pictures, animations, checkpoints) replace an existing file when the new one is complete; if
//! the path is a link, its target is replaced. Folders, devices, pipes and sockets are never replaced. While a file is
//! being written, the process ID and `.part` are appended to its
//! name; a process that is killed leaves the file under that name.
//!
//! Where [ranks](crate::parallel) share out a contact, all of them call a function that writes it. Rank 0 writes the
//! same bytes that one process writes; the other ranks send their rows piece by piece. No rank holds a whole field,
//! and no other rank needs the disk. All ranks get the same error. Each rank creates a series: all must see the same
//! folder, or the folder must be new to each.
//!
//! A write that fails, for instance on a full disk, leaves earlier output intact and no partial output of its own. It
//! can be repeated.

mod csv;
#[cfg(feature = "npy")]
mod deferred;
mod field;
mod field_values;
mod format;
mod metadata;
#[cfg(feature = "npy")]
mod npy;
#[cfg(feature = "npy")]
mod npz;
mod one_rank;
mod series;
#[cfg(all(feature = "npy", feature = "states"))]
mod states;
#[cfg(feature = "stress")]
mod stress;
mod vtk;

pub use csv::CsvHistory;
pub use field::Field;
pub use format::Format;
pub use metadata::Metadata;
#[cfg(feature = "npy")]
pub use npy::write_npy;
pub use series::FrameSeries;
#[cfg(all(feature = "npy", feature = "states"))]
pub use states::{read_states, states_from_bytes, states_to_bytes, write_states};
#[cfg(feature = "stress")]
pub use stress::write_stress;

use crate::fields::Fields;

/// What becomes of the files of an earlier run, for [`CsvHistory::create`] and [`FrameSeries::create`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::exhaustive_enums, reason = "there is nothing else to do")]
pub enum Earlier {
    /// They are an error ([`AlreadyExists`](std::io::ErrorKind::AlreadyExists)).
    Refuse,
    /// They are removed first.
    Replace,
    /// They go on after the state of the contact, and what comes later is removed: so a run that is resumed from a
    /// checkpoint, or begins, writes one file or folder.
    Continue,
}

/// The part of the rows or frames of an earlier run that ends with the state of a contact.
#[derive(Default)]
struct Kept {
    /// Its end, if the state is not there.
    earlier: u64,
    /// Its end with the state: others of the same time may come before a jump and after it.
    with_state: Option<u64>,
}

impl Kept {
    /// Includes what ends at `end`, with its time, force and approach, unless it is later than the contact.
    fn includes(&mut self, end: u64, state: [f64; 3], now: [f64; 3]) -> bool {
        let time = state[0];
        if time < now[0] {
            self.earlier = end;
        } else if state == now {
            self.with_state = Some(end);
        }
        time <= now[0]
    }

    fn end(&self) -> u64 {
        self.with_state.unwrap_or(self.earlier)
    }
}

/// The time of a frame: 0 of a contact that knows none.
fn time_of(contact: Fields<'_>) -> f64 {
    contact.time().unwrap_or(0.0)
}
