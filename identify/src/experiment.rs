//! What is driven, and what is measured.

use std::sync::Arc;

use viscocontact::states::ElasticStates;

use crate::error::{Error, Result, positive, within};

/// The drive over time: a depth, or the position of a base that carries the tip on a spring.
///
/// Between two times the drive is linear. It grows toward the sample.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Protocol {
    pub(crate) times: Vec<f64>,
    pub(crate) drive: Vec<f64>,
}

impl Protocol {
    /// A drive \[m\] at ascending `times` \[s\].
    ///
    /// # Errors
    /// If the lengths differ, there are fewer than two times, a value is not finite, or times do not ascend.
    pub fn new(times: Vec<f64>, drive: Vec<f64>) -> Result<Protocol> {
        same_length("drive", drive.len(), times.len())?;
        if times.len() < 2 {
            return Err(Error::TooFewPoints { points: times.len(), parameters: 1 });
        }
        for &value in &drive {
            within("drive", value, true, "finite")?;
        }
        for (index, pair) in times.windows(2).enumerate() {
            within("time", pair[1], true, "finite")?;
            if pair[1] <= pair[0] || pair[0].is_nan() {
                return Err(Error::TimesNotAscending { index: index + 1, value: pair[1], previous: pair[0] });
            }
        }
        within("time", times[0], true, "finite")?;
        Ok(Protocol { times, drive })
    }

    /// The times \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The drive at each time \[m\].
    pub fn drive(&self) -> &[f64] {
        &self.drive
    }
}

/// A drive and the tip it presses onto the sample: everything that is known before the force is measured.
#[derive(Clone, Debug)]
pub struct Experiment {
    pub(crate) protocol: Protocol,
    pub(crate) tip: Arc<ElasticStates>,
    /// Stiffness of the spring between base and tip \[N/m\]; infinite where the drive is the depth.
    pub(crate) stiffness: f64,
}

impl Experiment {
    /// A tip whose depth is driven: the drive is the position of the tip itself.
    ///
    /// The elastic states of the tip are closed forms ([`ElasticStates::sphere`], `cone`, `punch`, `power`), a sweep over
    /// any tip on any layer, or a table.
    pub fn new(protocol: Protocol, tip: Arc<ElasticStates>) -> Experiment {
        Experiment { protocol, tip, stiffness: f64::INFINITY }
    }

    /// The drive is the position of a base, and the tip hangs on a spring of this `stiffness` \[N/m\]: the cantilever of an
    /// atomic force microscope, a load cell, the frame of a machine.
    ///
    /// # Errors
    /// If the stiffness is not finite and positive.
    pub fn with_spring(mut self, stiffness: f64) -> Result<Experiment> {
        self.stiffness = positive("stiffness of the spring", stiffness)?;
        Ok(self)
    }

    /// The drive over time.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// The elastic states of the tip.
    pub fn tip(&self) -> &Arc<ElasticStates> {
        &self.tip
    }
}

/// A measured curve: an experiment and the force at each time.
#[derive(Clone, Debug)]
pub struct Curve {
    pub(crate) experiment: Experiment,
    pub(crate) force: Vec<f64>,
}

impl Curve {
    /// The `force` \[N\] measured at each time of the protocol; pressing is positive.
    ///
    /// # Errors
    /// If the lengths differ, or a force is not finite.
    pub fn new(experiment: Experiment, force: Vec<f64>) -> Result<Curve> {
        same_length("force", force.len(), experiment.protocol.times.len())?;
        for &value in &force {
            within("force", value, true, "finite")?;
        }
        Ok(Curve { experiment, force })
    }

    /// The experiment.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// The measured force at each time \[N\].
    pub fn force(&self) -> &[f64] {
        &self.force
    }
}

fn same_length(field: &'static str, len: usize, expected: usize) -> Result<()> {
    if len == expected { Ok(()) } else { Err(Error::WrongLength { field, len, expected }) }
}
