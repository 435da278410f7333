use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file or folder of results that cannot be written, and why.
///
/// The cause is the [`source`](std::error::Error::source) of the error, an [`io::Error`]: the message names the path
/// alone.
///
/// ```
/// use std::io::ErrorKind;
/// use viscocontact::prelude::*;
/// use viscocontact::output::{Earlier, CsvHistory, Metadata};
///
/// let contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Elastic::new(1.0e6)?))
///     .build()?;
/// let (path, metadata) = ("no/such/folder/history.csv", Metadata::new("Ball on rubber"));
/// let error = CsvHistory::create(path, &metadata, &contact, &[], Earlier::Refuse).unwrap_err();
/// assert_eq!(error.io_kind(), Some(ErrorKind::NotFound));
/// let Error::Output(error) = error else { panic!("{error}") };
/// println!("create {:?} first", error.path().parent());
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct OutputError {
    path: PathBuf,
    cause: Arc<io::Error>,
}

impl OutputError {
    pub(crate) fn new(path: &Path, cause: io::Error) -> OutputError {
        OutputError { path: path.to_owned(), cause: Arc::new(cause) }
    }

    /// The file or folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The kind of the cause: [`AlreadyExists`](io::ErrorKind::AlreadyExists) where there are files of an earlier run,
    /// [`InvalidInput`](io::ErrorKind::InvalidInput) where the requested output cannot be written, else the kind of the
    /// system's error.
    pub(crate) fn kind(&self) -> io::ErrorKind {
        self.cause.kind()
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cannot be written", self.path.display())
    }
}

impl std::error::Error for OutputError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&*self.cause)
    }
}

/// Of the same path, kind and message.
impl PartialEq for OutputError {
    fn eq(&self, other: &OutputError) -> bool {
        self.path == other.path && self.kind() == other.kind() && self.cause.to_string() == other.cause.to_string()
    }
}
