//! Times in ascending order.

use crate::error::{Result, finite};

/// Finite times \[s\], ascending: breakpoints, corners, times to stop at.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ascending(Vec<f64>);

impl Ascending {
    /// Adds `times` in any order; `field` names them in the error of one that is not finite.
    pub(crate) fn add(&mut self, field: &'static str, times: &[f64]) -> Result<()> {
        for &time in times {
            self.0.push(finite(field, time)?);
        }
        self.0.sort_by(f64::total_cmp);
        self.0.dedup();
        Ok(())
    }

    /// The first of them after a time.
    pub(crate) fn after(&self, time: f64) -> Option<f64> {
        self.0.get(self.0.partition_point(|&own| own <= time)).copied()
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.0
    }
}
