//! A file that has a temporary name until it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, IntoInnerError};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{check_regular, failed};
use crate::error::Result;

/// Distinguishes the files that this process is writing.
static NUMBER: AtomicU64 = AtomicU64::new(0);

/// A file that is being written. Its name is the name of the final file, followed by the process number and `.part`, so
/// that no two writers share it. It is removed with this value, unless it was placed.
#[derive(Debug)]
pub(crate) struct Part {
    path: PathBuf,
    part: PathBuf,
    placed: bool,
}

impl Drop for Part {
    fn drop(&mut self) {
        if !self.placed {
            let _ = fs::remove_file(&self.part);
        }
    }
}

impl Part {
    /// Creates the file in the folder of the one that it will replace; links are followed. Only regular files are
    /// replaced.
    pub(crate) fn create(path: &Path) -> Result<(Part, File)> {
        path.file_name().ok_or_else(|| failed(path, ErrorKind::InvalidFilename.into()))?;
        check_regular(path)?;
        // a link remains, and its target is replaced
        let path = match path.is_symlink() {
            true => fs::canonicalize(path).map_err(|error| failed(path, error))?,
            false => path.to_owned(),
        };
        loop {
            let mut name = path.file_name().unwrap_or_default().to_owned();
            name.push(format!(".{}-{}.part", process::id(), NUMBER.fetch_add(1, Ordering::Relaxed)));
            let part = path.with_file_name(name);
            match File::create_new(&part) {
                Ok(file) => return Ok((Part { path, part, placed: false }, file)),
                // left by a killed process with the same number
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(failed(&path, error)),
            }
        }
    }

    /// Syncs the complete file and renames it to its final name.
    pub(crate) fn place(&mut self, file: File) -> Result<()> {
        let unusable = |error: io::Error| failed(&self.path, error);
        file.sync_all().map_err(unusable)?;
        drop(file); // some systems do not rename open files
        check_regular(&self.path)?;
        fs::rename(&self.part, &self.path).map_err(unusable)?;
        self.placed = true;
        // the new name is durable once its folder is synced, where the system can do so; the file is complete in any
        // case
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Writes the file and places it.
    pub(crate) fn fill(mut self, file: File, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
        let mut writer = BufWriter::with_capacity(1 << 18, file);
        let written = write(&mut writer).and_then(|()| writer.into_inner().map_err(IntoInnerError::into_error));
        let file = written.map_err(|error| failed(&self.path, error))?;
        self.place(file)
    }
}

/// Writes a file under a temporary name, syncs it and renames it to `path`. A file of this name is replaced then, and
/// is unchanged if anything fails; of several concurrent writers the last one to finish wins.
pub(crate) fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    let (part, file) = Part::create(path)?;
    part.fill(file, write)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::error::Error;

    /// An empty folder of this name and process.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("viscocontact-{name}-{}", process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_failed_file_leaves_the_old_one_and_nothing_else() {
        let folder = folder("file");
        let path = folder.join("a.bin");
        replace(&path, |out| out.write_all(b"old")).unwrap();
        let error = replace(&path, |out| {
            out.write_all(b"new")?;
            Err(io::Error::other("the disk is full"))
        });
        let Err(Error::Output(error)) = error else { panic!("{error:?}") };
        let cause = std::error::Error::source(&error).unwrap();
        assert_eq!((error.path(), cause.to_string()), (&*path, "the disk is full".into()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        replace(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(matches!(replace(&folder.join(".."), |_| Ok(())), Err(Error::Output(_))));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn writers_at_once_do_not_disturb_each_other() {
        let folder = folder("at-once");
        let path = folder.join("a.bin");
        std::thread::scope(|scope| {
            for writer in 0..4_u8 {
                let path = &path;
                scope.spawn(move || {
                    for round in 0..30_u8 {
                        // every third fails half way
                        let written = replace(path, |out| {
                            out.write_all(&[writer; 4096])?;
                            out.flush()?;
                            if round % 3 == 2 { Err(io::Error::other("full")) } else { out.write_all(&[writer; 4096]) }
                        });
                        assert_eq!(written.is_ok(), round % 3 != 2, "{written:?}");
                        let file = fs::read(path).unwrap();
                        assert!(file.len() == 8192 && file.iter().all(|&byte| byte == file[0]));
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_replaced() {
        use std::os::unix::fs::{FileTypeExt, symlink};

        let folder = folder("kinds");
        let at = |name: &str| folder.join(name);
        fs::create_dir(at("folder")).unwrap();
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
        assert!(process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        symlink("/dev/null", at("device")).unwrap();
        symlink("pipe", at("to-pipe")).unwrap();
        symlink("nowhere", at("to-nothing")).unwrap();
        let count = || fs::read_dir(&folder).unwrap().count();
        let before = count();
        for (name, expected) in [
            ("folder", "a folder"),
            ("socket", "a socket"),
            ("pipe", "a pipe"),
            ("to-pipe", "a pipe"),
            ("device", "a device"),
            ("to-nothing", "a symbolic link to nothing"),
        ] {
            let error = replace(&at(name), |out| out.write_all(b"new")).unwrap_err();
            assert_eq!(error.code(), "not_a_file", "{error}");
            assert!(error.to_string().contains(expected) && error.to_string().contains(name), "{error}");
        }
        let null = replace(Path::new("/dev/null"), |_| Ok(())).unwrap_err();
        assert!(null.code() == "not_a_file" && null.to_string().contains("it is a device"), "{null}");
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        assert_eq!(count(), before);

        // a link remains and leads to the new file; the part is created beside that
        fs::write(at("folder/file"), b"old").unwrap();
        symlink("folder/file", at("link")).unwrap();
        symlink("link", at("again")).unwrap();
        replace(&at("again"), |out| out.write_all(b"new")).unwrap();
        assert!(at("link").is_symlink() && at("again").is_symlink());
        assert_eq!(fs::read(at("folder/file")).unwrap(), b"new");
        assert_eq!(fs::read_dir(at("folder")).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }
}
