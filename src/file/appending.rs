//! A file that grows piece by piece.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

/// A writer that can be truncated, to continue from there.
pub(crate) trait Cut: Write {
    /// Truncates to `length` bytes.
    fn cut(&mut self, length: u64) -> io::Result<()>;
}

impl Cut for File {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(drop)
    }
}

/// A file of complete pieces: a write that fails, as on a full disk, leaves the file unchanged.
#[derive(Debug)]
pub(crate) struct Appending<F> {
    file: F,
    length: u64,
    /// Whether a part of a failed piece is still to be cut off.
    torn: bool,
}

impl<F: Cut> Appending<F> {
    /// Begins an empty file.
    pub(crate) fn new(file: F) -> Appending<F> {
        Appending { file, length: 0, torn: false }
    }

    /// Continues a file after its first `length` bytes.
    pub(crate) fn after(mut file: F, length: u64) -> io::Result<Appending<F>> {
        file.cut(length)?;
        Ok(Appending { file, length, torn: false })
    }

    /// Writes and flushes a piece, or fails and leaves nothing of it in the file.
    pub(crate) fn append(&mut self, piece: &[u8]) -> io::Result<()> {
        if self.torn {
            self.file.cut(self.length)?;
            self.torn = false;
        }
        match self.file.write_all(piece).and_then(|()| self.file.flush()) {
            Ok(()) => {
                self.length += piece.len() as u64;
                Ok(())
            }
            Err(error) => {
                // if this fails, the part is cut off before the next piece
                self.torn = self.file.cut(self.length).is_err();
                Err(error)
            }
        }
    }

    /// The file.
    #[cfg(feature = "plot")]
    pub(crate) fn into_inner(self) -> F {
        self.file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file in memory on a disk with room for `room` bytes, whose truncation may also fail.
    #[derive(Default)]
    struct Disk {
        bytes: Vec<u8>,
        room: usize,
        stuck: bool,
        flushes: bool,
    }

    impl Write for Disk {
        fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
            match buf.len().min(self.room) {
                0 => Err(io::ErrorKind::StorageFull.into()),
                taken => {
                    self.room -= taken;
                    self.bytes.extend(&buf[..taken]);
                    Ok(taken)
                }
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            if self.flushes { Ok(()) } else { Err(io::Error::other("no flush")) }
        }
    }

    impl Cut for Disk {
        fn cut(&mut self, length: u64) -> io::Result<()> {
            if self.stuck {
                return Err(io::Error::other("stuck"));
            }
            self.bytes.truncate(length as usize);
            Ok(())
        }
    }

    /// Disks that are temporarily full, from any byte on: the file holds the pieces that were reported as written.
    #[test]
    fn the_file_holds_what_was_reported_as_written() {
        let (mut failures, mut recoveries) = (0, 0);
        for seed in 0..500_u64 {
            let mut state = seed;
            let mut random = |below: u64| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) % below
            };
            let mut file = Appending::new(Disk::default());
            let (mut expected, mut failed) = (Vec::new(), false);
            for row in 0..60 {
                let piece = format!("{row},{}\n", "x".repeat(random(40) as usize));
                file.file.room = if random(3) == 0 { random(piece.len() as u64) as usize } else { usize::MAX };
                file.file.flushes = random(10) > 0;
                file.file.stuck = random(10) == 0;
                let written = file.append(piece.as_bytes());
                if written.is_ok() {
                    expected.extend(piece.bytes());
                    recoveries += usize::from(failed);
                }
                failed = written.is_err();
                failures += usize::from(failed);
                assert!(file.torn || file.file.bytes == expected, "seed {seed}, row {row}");
            }
            file.file = Disk { room: usize::MAX, flushes: true, ..file.file };
            file.file.stuck = false;
            file.append(b"end").unwrap();
            expected.extend(b"end");
            assert_eq!(file.file.bytes, expected, "seed {seed}");
        }
        assert!(failures > 5000 && recoveries > 3000, "{failures} failures, {recoveries} recoveries");
    }

    #[test]
    fn files_are_cut_where_they_stood() {
        let path = std::env::temp_dir().join(format!("viscocontact-appending-{}", std::process::id()));
        let mut file = File::create(&path).unwrap();
        file.write_all(b"kept, and cut").unwrap();
        file.cut(4).unwrap();
        file.write_all(b"!").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"kept!");
        std::fs::remove_file(path).unwrap();
    }
}
