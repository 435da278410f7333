//! Read-only accessors.

use crate::Grid;
use crate::contact::{Settings, ViscoelasticContact};
use crate::error::{Result, coverage};
use crate::rheology::{Material, TemperatureHistory};

impl ViscoelasticContact {
    /// Time \[s\], initially 0.
    pub fn time(&self) -> f64 {
        self.computation.state.clock.time
    }

    /// The reduced time \[s\] of the material: ∫ dt/a_T(T(t)) with a history of the temperature
    /// ([`Builder::temperature`](crate::contact::Builder::temperature)), else the time.
    pub fn reduced_time(&self) -> f64 {
        self.computation.state.clock.reduced_time
    }

    /// The history of the temperature, if the contact has one.
    pub fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    pub(crate) fn settings(&self) -> &Settings {
        &self.scene.ground.settings
    }

    /// The material of the bodies. For a rheology without exact exponential series it contains the series fitted over
    /// [`Builder::times`](crate::contact::Builder::times); [`Material::fit_reports`] gives the error of the fit.
    pub fn material(&self) -> &Material {
        &self.scene.material
    }

    /// The grid of every field.
    pub fn grid(&self) -> &Grid {
        self.fields().grid()
    }

    /// [`Fields::pressure`](crate::fields::Fields::pressure) \[Pa\], one value per cell.
    pub fn pressure(&self) -> &[f64] {
        self.fields().pressure()
    }

    /// [`Fields::force`](crate::fields::Fields::force), the normal force on all bodies \[N\].
    pub fn force(&self) -> f64 {
        self.fields().force()
    }

    /// [`Fields::approach`](crate::fields::Fields::approach) of the (first) body \[m\].
    pub fn approach(&self) -> f64 {
        self.fields().approach()
    }

    /// [`Fields::tilt`](crate::fields::Fields::tilt) of the (first) body \[rad\].
    pub fn tilt(&self) -> [f64; 2] {
        self.fields().tilt()
    }

    /// [`Fields::contact_area`](crate::fields::Fields::contact_area) \[m²\].
    pub fn contact_area(&self) -> f64 {
        self.fields().contact_area()
    }

    /// [`Fields::contact_cells`](crate::fields::Fields::contact_cells), the number of cells in contact.
    pub fn contact_cells(&self) -> usize {
        self.fields().contact_cells()
    }

    /// Force and moments of the first body, and the parts of its motion on which they do work.
    pub(in crate::contact) fn load_and_motion(&self) -> [[f64; 3]; 2] {
        let ([moment1, moment2], [tilt1, tilt2]) = (self.fields().moment(), self.tilt());
        [[self.force(), moment1, moment2], [self.approach(), tilt1, tilt2]]
    }

    /// Refuses what this contact does not cover.
    pub(crate) fn covers(&self, case: coverage::Case) -> Result<()> {
        self.fields().covers(case)
    }
}

debug_by! {
    self: ViscoelasticContact =>
    grid: self.scene.ground.grid,
    settings: self.scene.ground.settings,
    time: self.computation.state.clock.time,
    loads: self.computation.state.held.loads,
    motions: self.computation.state.held.current.motions,
    contact_cells: self.computation.state.held.current.contact_cells
}
