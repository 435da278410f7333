/// Why a file cannot be read or written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// A file cannot be read, or does not have its format.
    #[error("{file} cannot be read: {reason}")]
    Unreadable {
        /// Its name, or its format if it has none.
        file: String,
        /// The message of the system or the reader.
        reason: String,
        /// The kind of the system's error; `None` if the contents cannot be read.
        kind: Option<std::io::ErrorKind>,
    },

    /// Something other than a regular file exists at the path. It is left unchanged: only regular files are replaced.
    #[error("{path} cannot be written: it is {kind}, not a regular file; give the path of a file")]
    NotAFile {
        /// The path.
        path: String,
        /// What exists there.
        kind: &'static str,
    },

    /// The extension of a file names no format that can be written.
    #[error("{path}: the extension must be .{}", .allowed.join(" or ."))]
    Extension {
        /// The file.
        path: String,
        /// The extensions allowed, without the point.
        allowed: &'static [&'static str],
    },
}
