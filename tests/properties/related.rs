//! What tests of related scenes compare with.

use proptest::prelude::*;
use viscocontact::laws::Scenario;
use viscocontact::prelude::*;

/// Tolerance below which errors of the solver are far smaller than differences of the scenes.
pub const TIGHT: f64 = 1e-10;

pub fn tight() -> Settings {
    Settings::default().with_tolerance(TIGHT)
}

/// The field in other units.
pub fn field(field: &[f64], factor: f64) -> Vec<f64> {
    field.iter().map(|value| value * factor).collect()
}

/// The greatest difference, of the greatest value.
pub fn difference(one: &[f64], other: &[f64]) -> f64 {
    apart(one, other, 0.0)
}

/// The greatest difference, of the greatest value or of `scale`.
fn apart(one: &[f64], other: &[f64], scale: f64) -> f64 {
    assert_eq!(one.len(), other.len());
    let most = one.iter().chain(other).fold(scale, |most: f64, value| most.max(value.abs()));
    let apart = one.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if apart == 0.0 { 0.0 } else { apart / most }
}

/// Whether fields are the same, to `within` of the greatest value or of `scale`: after a release, rounding remains
/// of what was there before.
pub fn assert_same(what: &str, one: &[f64], other: &[f64], scale: f64, within: f64) -> Result<(), TestCaseError> {
    let apart = apart(one, other, scale);
    prop_assert!(apart <= within, "{}: {:e} apart", what, apart);
    Ok(())
}

/// A state at the end of a scene, and the greatest pressure and displacement on the way to it.
pub struct End {
    pub contact: ViscoelasticContact,
    pub pressure: f64,
    pub displacement: f64,
}

/// All steps of a scene.
pub fn end(scene: &Scenario, settings: Settings) -> End {
    let contact = scene.builder().settings(settings).build().unwrap();
    let mut end = End { contact, pressure: 0.0, displacement: 0.0 };
    for &(dt, load) in &scene.steps {
        end.contact.step(dt, load).unwrap();
        let greatest = |field: &[f64], most: f64| field.iter().fold(most, |most, value| most.max(value.abs()));
        end.pressure = greatest(end.contact.pressure(), end.pressure);
        end.displacement = greatest(end.contact.fields().displacement(), end.displacement);
    }
    end
}

/// Whether a state is the same as one that was reached in a run, given its fields and its approach.
pub fn assert_ends_like(one: &End, pressure: &[f64], displacement: &[f64], approach: f64) -> Result<(), TestCaseError> {
    assert_same("pressure", one.contact.pressure(), pressure, one.pressure, 1e-6)?;
    assert_same("displacement", one.contact.fields().displacement(), displacement, one.displacement, 1e-7)?;
    assert_same("approach", &[one.contact.approach()], &[approach], one.displacement, 1e-7)
}
