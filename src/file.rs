//! Files that are either complete or not there.

use std::fmt::Display;
use std::path::Path;

use crate::error::Error;

/// The error of a file.
pub(crate) fn failed(path: &Path, what: impl Display) -> Error {
    Error::Output { path: path.display().to_string(), what: what.to_string() }
}

/// Writes a file under another name and gives it its own when it is complete and on the medium. What was of this
/// name before is replaced then, and not touched if anything fails.
#[cfg(any(feature = "checkpoint", feature = "npy", feature = "plot", feature = "vtk"))]
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&mut std::io::BufWriter<std::fs::File>) -> std::io::Result<()>,
) -> crate::Result<()> {
    use std::fs::{self, File};
    use std::io::BufWriter;

    let mut name = path.file_name().ok_or_else(|| failed(path, "it names no file"))?.to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let attempt = || {
        let mut writer = BufWriter::with_capacity(1 << 18, File::create(&part)?);
        write(&mut writer)?;
        writer.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&part, path)
    };
    attempt().map_err(|error| {
        // it may not even exist; the error that matters is the first
        let _ = fs::remove_file(&part);
        failed(path, error)
    })?;
    // the new name is on the medium when its folder is, on systems that can say so; the file is complete in any case
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

#[cfg(all(test, any(feature = "checkpoint", feature = "npy", feature = "plot", feature = "vtk")))]
mod tests {
    use std::fs;
    use std::io::{self, Write};

    use super::*;

    #[test]
    fn a_failed_file_leaves_the_old_one_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("viscocontact-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.bin");
        replace(&path, |out| out.write_all(b"old")).unwrap();
        let error = replace(&path, |out| {
            out.write_all(b"new")?;
            Err(io::Error::other("the disk is full"))
        });
        assert_eq!(
            error.unwrap_err(),
            Error::Output { path: path.display().to_string(), what: "the disk is full".into() }
        );
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        replace(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(matches!(replace(&folder.join(".."), |_| Ok(())), Err(Error::Output { .. })));
        fs::remove_dir_all(&folder).unwrap();
    }
}
