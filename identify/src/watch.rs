//! What ends a search from outside.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::error::Result;

/// Whether a search goes on.
#[derive(Clone)]
pub(crate) struct Watch(Arc<dyn Fn() -> ControlFlow<()> + Send + Sync>);

impl Watch {
    pub(crate) fn new(goes_on: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Watch {
        Watch(Arc::new(goes_on))
    }

    /// Ends a call whose watch breaks.
    pub(crate) fn goes_on(&self) -> Result<()> {
        match (self.0)() {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(viscocontact::Error::Cancelled { what: "the fit" }.into()),
        }
    }
}

impl Default for Watch {
    fn default() -> Watch {
        Watch::new(|| ControlFlow::Continue(()))
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a watch")
    }
}
