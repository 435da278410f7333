//! What ends a search from outside.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::error::Result;

/// Whether a search goes on: where nothing tells, it does.
#[derive(Clone, Default)]
pub(crate) struct Watch(Option<Arc<dyn Fn() -> ControlFlow<()> + Send + Sync>>);

impl Watch {
    pub(crate) fn new(goes_on: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Watch {
        Watch(Some(Arc::new(goes_on)))
    }

    /// Ends a call whose watch breaks.
    pub(crate) fn goes_on(&self) -> Result<()> {
        let ends = self.0.as_ref().is_some_and(|goes_on| goes_on().is_break());
        if ends { Err(viscocontact::Error::Cancelled { what: "the fit" }.into()) } else { Ok(()) }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a watch")
    }
}
