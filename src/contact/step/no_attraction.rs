//! In place of the room of attractions where it is not compiled: no contact has one, since nothing else gives it one.

use crate::Grid;
use crate::attraction::Attraction;
use crate::contact::scene::Scene;
use crate::contact::{State, Step, ViscoelasticContact};
use crate::equilibrium::window::Window;
use crate::equilibrium::{RigidBodies, Trial};
use crate::error::{Result, missing};
use crate::rheology::Material;
use crate::solver::{Freedom, Stop};

/// What steps of surfaces that attract each other work in: there is none.
#[derive(Debug, Clone)]
pub(crate) enum Attracted {}

impl Attracted {
    pub(in crate::contact) fn bytes_per_cell() -> usize {
        0
    }

    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        match *self {}
    }

    pub(super) fn jumped(&self) -> bool {
        match *self {}
    }

    pub(super) fn suspects_jump(&self) -> bool {
        match *self {}
    }

    pub(super) fn beyond_edge(&self, _: &Scene) -> Option<f64> {
        match *self {}
    }

    pub(super) fn check_edge(&self, _: &Scene, _: &Step<'_>) -> Result<()> {
        match *self {}
    }
}

/// A step of surfaces that attract each other.
pub(super) struct AttractedStep<'a> {
    pub(super) scene: &'a Scene,
    pub(super) law: &'a dyn Attraction,
    pub(super) state: &'a State,
    pub(super) step: &'a Step<'a>,
    pub(super) bodies: RigidBodies<'a>,
    pub(super) compliance: f64,
    pub(super) stop: Stop<'a>,
    pub(super) wanted: Freedom,
}

impl AttractedStep<'_> {
    pub(super) fn solve(&self, _: &mut Window, _: &mut Trial, _: &mut Option<Box<Attracted>>) -> Result<()> {
        Err(missing("attraction"))
    }
}

impl ViscoelasticContact {
    pub(super) fn look_for_jump(&mut self, _: &Step<'_>) -> Result<()> {
        Err(missing("attraction"))
    }
}

pub(super) fn coarse_zone(_: &Scene, _: impl FnOnce() -> f64) -> Option<f64> {
    None
}

pub(in crate::contact) fn resolved_softening(_: &dyn Attraction, _: &Material, _: &Grid) -> Result<f64> {
    Err(missing("attraction"))
}
