/// Why a checkpoint cannot be continued from.
///
/// Needs the feature `checkpoint`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("it cannot be read: {what}")]
    Unreadable {
        /// What stood in the way.
        what: String,
    },

    /// It does not begin as a checkpoint does.
    #[error("not a checkpoint: it does not begin with the mark of one")]
    Foreign,

    /// It was written by a newer version of this crate.
    #[error("the checkpoint is of format {found}, this version reads format {known}: update viscocontact")]
    Newer {
        /// Its format.
        found: u32,
        /// The format known.
        known: u32,
    },

    /// It was written by an older version of this crate.
    #[error(
        "the checkpoint is of format {found}, this version reads format {known}: resume it with the version that wrote it"
    )]
    Older {
        /// Its format.
        found: u32,
        /// The format known.
        known: u32,
    },

    /// It is cut short, or something follows it.
    #[error("the checkpoint holds {found} bytes and should hold {expected}: it is cut short or damaged")]
    Size {
        /// Bytes found.
        found: u64,
        /// Bytes there should be.
        expected: u64,
    },

    /// Its checksum does not fit what it holds.
    #[error("the checkpoint is damaged: its checksum is {found:08x} and should be {expected:08x}")]
    Damaged {
        /// Checksum of what it holds.
        found: u32,
        /// Checksum it should have.
        expected: u32,
    },

    /// Its checksum fits, but not what it says: not written by this crate.
    #[error("the checkpoint holds no state of a contact: {what}")]
    Malformed {
        /// What is wrong.
        what: String,
    },

    /// It belongs to another scene than the contact that was built to continue it.
    #[error("the checkpoint is of another scene: its {what} is {saved}, that of this contact {built}")]
    OtherScene {
        /// What differs.
        what: &'static str,
        /// In the checkpoint.
        saved: String,
        /// In the contact.
        built: String,
    },
}
