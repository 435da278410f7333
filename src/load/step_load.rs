use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// A constant load from t = 0 on, and no load before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepLoad {
    load: Load,
}

impl StepLoad {
    /// `load` applied at t = 0 and held.
    ///
    /// # Errors
    /// If the load is not finite. A force that pulls is refused by the contact that it acts on, unless surfaces
    /// attract each other.
    pub fn new(load: Load) -> Result<StepLoad> {
        load.validate()?;
        Ok(StepLoad { load })
    }
}

impl LoadHistory for StepLoad {
    fn at(&self, t: f64) -> Load {
        if t >= 0.0 { self.load } else { Load::force(0.0) }
    }

    fn before(&self, t: f64) -> Load {
        if t > 0.0 { self.load } else { Load::force(0.0) }
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        (after < 0.0).then_some(0.0)
    }
}
