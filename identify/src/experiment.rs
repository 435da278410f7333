//! What is driven, and what is measured.

use std::sync::Arc;

use viscocontact::load::{Load, PiecewiseLinear};
use viscocontact::states::ElasticStates;

use crate::error::{Error, Result, positive, same_length, within};
use crate::protocol::Protocol;

/// A drive and the tip it presses onto the sample: everything that is known before the force is measured.
#[derive(Clone, Debug)]
pub struct Experiment {
    pub(crate) protocol: Protocol,
    pub(crate) tip: Arc<ElasticStates>,
    /// Stiffness of the spring between base and tip \[N/m\]; infinite where the drive is the depth.
    pub(crate) stiffness: f64,
    /// Approach of the tip at its first touch, where the depth is 0 \[m\].
    pub(crate) surface: f64,
}

impl Experiment {
    /// A tip whose depth is driven: the drive is the position of the tip itself.
    ///
    /// The elastic states of the tip are closed forms ([`ElasticStates::sphere`], `cone`, `punch`, `power`), a sweep over
    /// any tip on any layer, or a table.
    pub fn new(protocol: Protocol, tip: Arc<ElasticStates>) -> Experiment {
        let surface = tip.approach(0.0);
        Experiment { protocol, tip, stiffness: f64::INFINITY, surface }
    }

    /// The depth of a swept tip counts from its first touch at this `approach` \[m\], 0 for a shape whose minimum gap is 0, and not from where its
    /// first cell touched: the gap at the nearest centre of a cell, dx²/4R of a sphere on cells of side dx. Contacts of few cells are a power of
    /// the depth then. It matters where the contact point is known: one that is fitted takes the difference.
    ///
    /// # Errors
    /// If the approach is not finite, or above the first touch of a cell.
    pub fn with_surface(mut self, approach: f64) -> Result<Experiment> {
        let first = self.tip.approach(0.0);
        let allowed = "finite, and at most the approach at which the first cell touches (ElasticStates::approach(0.0))";
        self.surface = within("approach at first touch", approach, approach <= first, allowed)?;
        Ok(self)
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

    /// Stiffness of the spring between base and tip \[N/m\]; infinite where the drive is the depth.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The drive over time.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// The drive as a load history of the main crate, for a run of a
    /// [`StatesContact`](viscocontact::states::StatesContact) or the full stepper: an approach, or a spring and its far end.
    ///
    /// ```
    /// use viscocontact::load::{Load, LoadHistory};
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Experiment, Protocol};
    ///
    /// let protocol = Protocol::trapezoid(1.0e-6, [1.0, 5.0, 1.0], 0.1)?;
    /// let history = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?).with_spring(0.1)?.load_history()?;
    /// assert_eq!(history.at(3.0), Load::spring(0.1, 1.0e-6));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// None for a protocol that exists; those of [`PiecewiseLinear::new`].
    pub fn load_history(&self) -> Result<PiecewiseLinear> {
        let (times, drive) = (self.protocol.times(), self.protocol.drive());
        let pairs = times.iter().zip(drive);
        let table: Vec<_> = pairs.map(|(&time, &drive)| (time, self.load(drive, self.stiffness))).collect();
        Ok(PiecewiseLinear::new(&table)?)
    }

    /// The load of a drive, through a spring.
    pub(crate) fn load(&self, drive: f64, stiffness: f64) -> Load {
        match stiffness {
            f64::INFINITY => Load::approach(self.surface + drive),
            stiffness => Load::spring(stiffness, self.surface + drive),
        }
    }

    /// The level of the elastic states at a depth \[m²\]: 0 without contact, NaN beyond the last state.
    pub(crate) fn level(&self, depth: f64) -> f64 {
        self.tip.level_at(self.surface + depth)
    }

    /// The level at a depth that the states reach.
    pub(crate) fn level_within(&self, depth: f64) -> Result<f64> {
        let level = self.level(depth);
        if level.is_nan() { Err(Error::BeyondStates { curve: 0, depth }) } else { Ok(level) }
    }

    /// The elastic states of the tip.
    pub fn tip(&self) -> &Arc<ElasticStates> {
        &self.tip
    }
}

/// Curves are equal if drive, tip, spring and force are.
impl PartialEq for Curve {
    fn eq(&self, other: &Curve) -> bool {
        let (a, b) = (&self.experiment, &other.experiment);
        let same_tip = Arc::ptr_eq(&a.tip, &b.tip) || a.tip.states() == b.tip.states();
        let same_setup = (a.stiffness, a.surface) == (b.stiffness, b.surface);
        self.force == other.force && a.protocol == b.protocol && same_setup && same_tip
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
        force.iter().try_for_each(|&value| within("force", value, true, "finite").map(drop))?;
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
