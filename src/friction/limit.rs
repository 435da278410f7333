//! What the surface can carry along itself.

use std::fmt::Debug;

use crate::error::{Result, non_negative};

/// A limit of the traction along the surface, |τ| ≤ r(p).
pub trait FrictionLimit: Debug + Send + Sync {
    /// r \[Pa\] under a pressure p ≥ 0 \[Pa\]: finite, not negative. Cells without pressure carry nothing.
    fn limit(&self, pressure: f64) -> f64;
}

/// Coulomb's law, r = f p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb(f64);

impl Coulomb {
    /// Of this coefficient of friction f.
    ///
    /// # Errors
    /// If it is negative or not finite.
    pub fn new(coefficient: f64) -> Result<Coulomb> {
        non_negative("coefficient of friction", coefficient).map(Coulomb)
    }
}

impl FrictionLimit for Coulomb {
    fn limit(&self, pressure: f64) -> f64 {
        self.0 * pressure
    }
}

/// A constant shear strength wherever surfaces touch, r = τ₀ (Tresca): what smooth rubber shows on glass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tresca(f64);

impl Tresca {
    /// Of this shear strength τ₀ \[Pa\].
    ///
    /// # Errors
    /// If it is negative or not finite.
    pub fn new(strength: f64) -> Result<Tresca> {
        non_negative("shear strength", strength).map(Tresca)
    }
}

impl FrictionLimit for Tresca {
    fn limit(&self, _: f64) -> f64 {
        self.0
    }
}

/// The lesser of two limits: Coulomb's law under light pressure and a shear strength under high pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lesser<A, B>(pub A, pub B);

impl<A: FrictionLimit, B: FrictionLimit> FrictionLimit for Lesser<A, B> {
    fn limit(&self, pressure: f64) -> f64 {
        self.0.limit(pressure).min(self.1.limit(pressure))
    }
}
