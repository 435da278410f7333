//! Files that rank 0 writes, of what all ranks bring.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use crate::error::Result;
use crate::file::{Part, failed};
use crate::parallel::{Rows, catch_rank_loss};

impl Rows {
    /// Replaces a file when its new contents are complete and on the medium. A call of all ranks: all of them run `write`, rank 0
    /// with the file. An error of one of them is an error on all, and leaves the old file.
    pub(crate) fn replace_file(
        &self,
        path: &Path,
        write: impl FnOnce(Option<&mut BufWriter<File>>) -> io::Result<()>,
    ) -> Result<()> {
        let first = self.group().is_none_or(|group| group.rank() == 0);
        catch_rank_loss(self, || {
            let part = self.agree(if first { Part::create(path).map(Some) } else { Ok(None) })?;
            self.agree(match part {
                Some((part, file)) => part.fill(file, |out| write(Some(out))),
                None => write(None).map_err(|error| failed(path, error)),
            })
        })
    }
}
