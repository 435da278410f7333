//! The scene of a study, on a grid that the study chooses.

use std::fmt;
use std::sync::Arc;

use crate::Grid;
use crate::contact::{Builder, Settings};
use crate::elastic::ElasticBuilder;
use crate::error::Result;
use crate::load::LoadHistory;
use crate::states::softest_compliance;
use crate::study::accuracy::settings;

/// The scene on a grid, with these settings.
pub(super) type SceneOf<'a> = Box<dyn Fn(Grid, Settings) -> Result<Builder> + 'a>;

/// A scene along its load histories.
pub(super) struct StudyScene<'a> {
    pub(super) on: SceneOf<'a>,
    /// One for each rigid body.
    pub(super) histories: Vec<&'a dyn LoadHistory>,
    pub(super) until: f64,
    pub(super) accuracy: f64,
}

impl fmt::Debug for StudyScene<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StudyScene").field("until", &self.until).finish_non_exhaustive()
    }
}

impl StudyScene<'_> {
    /// The contact on a grid; its materials are fitted over the times of the run.
    pub(super) fn builder(&self, grid: Grid) -> Result<Builder> {
        let builder = (self.on)(grid, settings(self.accuracy))?;
        Ok(match self.histories.first() {
            Some(history) if builder.times.is_none() => builder.times_of(*history, self.until),
            _ => builder,
        })
    }
}

impl Builder {
    /// The maximum compliance of the bodies in a run.
    pub(super) fn compliance_until(&self, until: f64) -> Result<f64> {
        let bodies: Vec<_> = [&self.material, &self.counter_body].into_iter().flatten().collect();
        softest_compliance(&bodies, self.temperature.as_ref(), until)
    }
}

impl ElasticBuilder {
    /// The shapes, kernel and settings of a contact.
    pub(super) fn of(contact: &Builder) -> ElasticBuilder {
        let gaps = contact.gaps.iter().map(|(_, gap)| gap.clone()).collect();
        let elastic = ElasticBuilder::with_gaps(contact.grid.clone(), gaps, contact.waves.clone());
        let elastic = elastic.settings(contact.settings);
        match &contact.kernel {
            Some(kernel) => elastic.kernel(Arc::clone(kernel)),
            None => elastic,
        }
    }
}
