/// Why a run cannot be resumed from a checkpoint.
///
/// Needs the feature `checkpoint`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("it cannot be read: {what}")]
    Unreadable {
        /// The cause.
        what: String,
        /// Its kind.
        kind: std::io::ErrorKind,
    },

    /// The magic number is missing.
    #[error("not a checkpoint: the magic number is missing")]
    Foreign,

    /// It was written by a newer version of this crate.
    #[error("the checkpoint is of format {found}, this version reads format {known}: update viscocontact")]
    Newer {
        /// Format of the checkpoint.
        found: u32,
        /// Format that this version reads.
        known: u32,
    },

    /// It was written by an older version of this crate.
    #[error(
        "the checkpoint is of format {found}, this version reads format {known}: resume it with the version that \
        wrote it"
    )]
    Older {
        /// Format of the checkpoint.
        found: u32,
        /// Format that this version reads.
        known: u32,
    },

    /// The length is wrong: the file is truncated, or data follow the checkpoint.
    #[error("the checkpoint holds {found} bytes, but should hold {expected}: it is truncated or damaged")]
    Size {
        /// Bytes found.
        found: u64,
        /// Bytes expected.
        expected: u64,
    },

    /// The checksum does not match the contents.
    #[error("the checkpoint is damaged: its checksum is {found:08x}, but should be {expected:08x}")]
    Damaged {
        /// Checksum of the contents.
        found: u32,
        /// Checksum stored.
        expected: u32,
    },

    /// The checksum matches, but the contents are not a state: this crate did not write them.
    #[error("the checkpoint holds no state of a contact: {what}")]
    Malformed {
        /// The cause.
        what: String,
    },

    /// The checkpoint is of another scene than the contact that is to resume it.
    #[error(
        "the checkpoint is of another scene: its {what} is {saved}, but the contact has {built}: build the \
        contact as it was saved"
    )]
    OtherScene {
        /// What differs.
        what: &'static str,
        /// Its value in the checkpoint.
        saved: String,
        /// Its value in the contact.
        built: String,
    },
}

impl CheckpointError {
    /// The kind of the system's error behind this one.
    pub(super) fn io_kind(&self) -> Option<std::io::ErrorKind> {
        match self {
            CheckpointError::Unreadable { kind, .. } => Some(*kind),
            _ => None,
        }
    }
}
