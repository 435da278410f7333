//! A writer that reports its first error at the end.

use std::io::{self, ErrorKind, Seek, SeekFrom, Write};

/// Writes from the beginning of `inner`. After the first error it accepts and discards everything, and
/// [`Deferred::finish`] returns the error. Needed for `ZipWriter`, which completes its archive even when it is dropped
/// after an error, and prints to standard error if that fails again.
#[derive(Debug)]
pub(super) struct Deferred<W> {
    inner: W,
    position: u64,
    end: u64,
    error: Option<io::Error>,
}

impl<W: Write + Seek> Deferred<W> {
    pub(super) fn new(inner: W) -> Deferred<W> {
        Deferred { inner, position: 0, end: 0, error: None }
    }

    /// Flushes `inner`, or returns the first error.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        self.error.map_or(Ok(()), Err)
    }
}

impl<W: Write> Write for Deferred<W> {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut accepted = buf.len();
        if self.error.is_none() && !buf.is_empty() {
            match self.inner.write(buf) {
                Ok(0) => self.error = Some(ErrorKind::WriteZero.into()),
                Ok(count) => accepted = count,
                Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error), // the caller tries again
                Err(error) => self.error = Some(error),
            }
        }
        self.position += accepted as u64;
        self.end = self.end.max(self.position);
        Ok(accepted)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.error.is_none() {
            self.error = self.inner.flush().err();
        }
        Ok(())
    }
}

impl<W: Seek> Seek for Deferred<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => position,
            SeekFrom::Current(by) => self.position.saturating_add_signed(by),
            SeekFrom::End(by) => self.end.saturating_add_signed(by),
        };
        if self.error.is_none() && position != self.position {
            self.error = self.inner.seek(SeekFrom::Start(position)).err();
        }
        self.position = position;
        Ok(position)
    }
}
