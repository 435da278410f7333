//! Files that rank 0 writes, of what all ranks bring.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use crate::error::Result;
use crate::file::{Part, failed};
use crate::parallel::Rows;

impl Rows {
    /// Replaces a file when its new contents are complete and on the medium. A call of all ranks: all of them run
    /// `write`, rank 0 with the file. An error of one of them is an error on all, and leaves the old file.
    pub(crate) fn replace_file(
        &self,
        path: &Path,
        write: impl FnOnce(Option<&mut BufWriter<File>>) -> io::Result<()>,
    ) -> Result<()> {
        self.or_loss(|| {
            let part = self.agree(if self.rank() == 0 { Part::create(path).map(Some) } else { Ok(None) })?;
            self.agree(match part {
                // a file without the rows of a rank that is lost must not be placed
                Some((part, file)) => {
                    part.fill(file, |out| write(Some(out)).and_then(|()| self.intact().map_err(io::Error::other)))
                }
                None => write(None).map_err(|error| failed(path, error)),
            })
        })
    }
}
