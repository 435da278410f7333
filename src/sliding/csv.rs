//! Sweeps of steady motions as CSV tables.

use std::io::Write;
use std::path::Path;

use crate::error::Result;
use crate::file::replace;
use crate::sliding::{SlidingTable, SweptState};

const COLUMNS: &str = "temperature [K],velocity 1 [m/s],velocity 2 [m/s],force [N],approach [m],friction,lateral force 1 [N],lateral force 2 [N],\
    contact area [m2],mean gap [m],dissipation [W],contact cells,sets,transforms,residual,warnings";

impl SlidingTable {
    /// Writes the table as a CSV file, a row for each state: temperature \[K\], velocity along x1
    /// and x2, force, approach, friction, lateral force along x1 and x2, contact area, mean gap,
    /// dissipation \[SI\], cells in contact, sets, pairs of transforms, residual, and the warnings,
    /// in quotes. Numbers have enough digits to be read back bitwise. An existing file is replaced.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_csv(&self, path: impl AsRef<Path>) -> Result<()> {
        replace(path.as_ref(), |out| {
            writeln!(out, "{COLUMNS}")?;
            for SweptState { temperature, report: own, .. } in self.states() {
                let kelvin = temperature.map(|kelvin| format!("{kelvin:?}")).unwrap_or_default();
                let ([v1, v2], [f1, f2]) = (own.velocity, own.lateral_force);
                write!(out, "{kelvin},{v1:?},{v2:?},{:?},{:?},{:?},", own.force, own.approach, own.friction())?;
                write!(out, "{f1:?},{f2:?},{:?},{:?},{:?},", own.contact_area, own.mean_gap, own.dissipation())?;
                write!(out, "{},{},{},{:?},", own.contact_cells, own.sets, own.transforms, own.residual)?;
                writeln!(out, "\"{}\"", own.messages().collect::<Vec<_>>().join("; "))?;
            }
            Ok(())
        })
    }
}
