//! In place of the room of observations where it is not compiled.

use crate::error::Result;
use crate::fields::Fields;
use crate::fields::mesh_error::MeshError;

impl Fields<'_> {
    /// Not measured.
    pub(crate) fn mesh_error(&self) -> Result<Option<MeshError>> {
        Ok(None)
    }
}
