//! Files and folders of a test, removed when it is over.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A path in the folder of temporary files that no other test uses.
#[derive(Debug)]
pub struct Temporary(PathBuf);

impl Temporary {
    /// A path at which nothing is.
    pub fn file(name: &str) -> Temporary {
        let path = std::env::temp_dir().join(format!("viscocontact-{name}-{}", std::process::id()));
        // of an earlier process of the same number
        remove(&path);
        Temporary(path)
    }

    /// An empty folder.
    pub fn folder(name: &str) -> Temporary {
        let folder = Temporary::file(name);
        fs::create_dir_all(&folder.0).unwrap();
        folder
    }

    /// The names of what is in the folder, ascending.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}

impl Deref for Temporary {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for Temporary {
    fn as_ref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        remove(&self.0);
    }
}
