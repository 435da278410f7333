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

    /// It was written by another version of this crate.
    #[error("the checkpoint is of format {found}, this version reads format {known}: {}",
        if found > known { "update viscocontact" } else { "resume it with the version that wrote it" })]
    Format {
        /// Format of the checkpoint.
        found: u32,
        /// Format that this version reads.
        known: u32,
    },

    /// The checksum does not match the contents.
    #[error("the checkpoint is damaged or truncated: its checksum is not that of its contents")]
    Damaged,

    /// The checksum matches, but the contents are not a state: this crate did not write them.
    #[error("the checkpoint holds no state of a contact: {what}")]
    Malformed {
        /// The cause.
        what: String,
    },

    /// The checkpoint is of another scene than the contact that is to resume it.
    #[error(
        "the checkpoint is of another scene: its {what} differs from that of the contact: build the contact as it was \
        saved"
    )]
    OtherScene {
        /// The first part that differs.
        what: &'static str,
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
