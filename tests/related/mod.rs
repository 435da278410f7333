//! What tests of related scenes compare with.
#![allow(dead_code, reason = "each user takes what it needs")]

use proptest::prelude::*;
use viscocontact::laws::Scene;
use viscocontact::prelude::*;

/// Solved so tightly that what is left is the difference of the scenes.
pub const TIGHT: f64 = 1e-10;

pub fn tight() -> Settings {
    Settings { tolerance: TIGHT, ..Settings::default() }
}

pub fn pressures(contact: &ViscoelasticContact) -> Vec<f64> {
    contact.pressure().to_vec()
}

/// The field in other units.
pub fn field(field: &[f64], factor: f64) -> Vec<f64> {
    field.iter().map(|value| value * factor).collect()
}

pub fn forces(scene: &Scene) -> impl Iterator<Item = f64> {
    scene.steps.iter().map(|(_, load)| if let Load::Force { normal, .. } = load { *normal } else { 0.0 })
}

/// The greatest difference, of the greatest value.
pub fn difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let most = one.iter().chain(other).fold(0.0, |most: f64, value| most.max(value.abs()));
    let apart = one.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if apart == 0.0 { 0.0 } else { apart / most }
}

pub fn assert_same(what: &str, one: &[f64], other: &[f64], within: f64) -> Result<(), TestCaseError> {
    let apart = difference(one, other);
    prop_assert!(apart <= within, "{}: {:e} apart", what, apart);
    Ok(())
}
