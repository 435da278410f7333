//! The parameters of a fit: of the material, and of the measurement.

use crate::error::{Error, Result};
use crate::model::{Model, Scale};

/// A property of the measurement that may be known or fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Nuisance {
    /// Known.
    Fixed(f64),
    /// Fitted, from a value found in the data.
    Fitted,
    /// Fitted, from this value.
    FittedFrom(f64),
}

/// Which quantity a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A parameter of the material, by index.
    Material(usize),
    /// Stiffness of the spring \[N/m\].
    Stiffness,
    /// Drive at first touch of a curve \[m\].
    ContactPoint(usize),
    /// Force without contact \[N\].
    Offset(usize),
    /// Growth of this force \[N/s\].
    Drift(usize),
    /// Force over the speed of the drive \[N s/m\].
    Drag(usize),
}

impl Kind {
    /// The only curve on which the parameter acts.
    pub(crate) fn curve(self) -> Option<usize> {
        match self {
            Kind::Material(_) | Kind::Stiffness => None,
            Kind::ContactPoint(curve) | Kind::Offset(curve) | Kind::Drift(curve) | Kind::Drag(curve) => Some(curve),
        }
    }

    /// Whether the force is linear in the parameter.
    pub(crate) fn is_linear(self) -> bool {
        matches!(self, Kind::Offset(_) | Kind::Drift(_) | Kind::Drag(_))
    }
}

/// One parameter: what it is, and how it is searched for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) scale: Scale,
    /// Size of the parameter on a linear scale.
    pub(crate) unit: f64,
    pub(crate) is_free: bool,
    /// Value given by the user: the start, if the parameter is free.
    pub(crate) given: Option<f64>,
}

impl Parameter {
    /// The parameters of a model, of which some are set: value, and whether it is fixed.
    pub(crate) fn of_material(model: Model, chosen: &[(String, f64, bool)]) -> Vec<Parameter> {
        let parameter = |(index, name): (usize, String)| {
            let set = chosen.iter().rev().find(|(set, ..)| *set == name);
            Parameter {
                kind: Kind::Material(index),
                scale: Model::scale(&name),
                unit: 1.0,
                is_free: set.is_none_or(|(_, _, fixed)| !fixed),
                given: set.map(|(_, value, _)| *value),
                name,
            }
        };
        model.parameters().into_iter().enumerate().map(parameter).collect()
    }

    /// The coordinate of a search.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        self.scale.forward(value) / self.unit
    }

    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        self.scale.back(coordinate * self.unit)
    }
}

/// What is set of each parameter of an identification.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chosen {
    pub(crate) contact_point: Nuisance,
    pub(crate) offset: Nuisance,
    pub(crate) drift: Nuisance,
    pub(crate) drag: Nuisance,
    pub(crate) stiffness: Option<Nuisance>,
    /// Material parameters by name: value, and whether it is fixed.
    pub(crate) material: Vec<(String, f64, bool)>,
}

impl Default for Chosen {
    fn default() -> Chosen {
        let known = Nuisance::Fixed(0.0);
        Chosen { contact_point: known, offset: known, drift: known, drag: known, stiffness: None, material: Vec::new() }
    }
}

/// Sizes of the curves: depth, force and duration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) depth: f64,
    pub(crate) force: f64,
    pub(crate) time: f64,
}

/// All parameters of a problem.
pub(crate) fn parameters(model: Model, chosen: &Chosen, sizes: &[Size]) -> Result<Vec<Parameter>> {
    let names = model.parameters();
    if let Some((name, ..)) = chosen.material.iter().find(|(name, ..)| !names.contains(name)) {
        return Err(Error::UnknownParameter { name: name.clone(), names: names.join(", ") });
    }
    let mut all = Parameter::of_material(model, &chosen.material);
    let mut add = |name: String, kind: Kind, scale: Scale, unit: f64, nuisance: Nuisance| {
        let (is_free, given) = match nuisance {
            Nuisance::Fixed(value) => (false, Some(value)),
            Nuisance::Fitted => (true, None),
            Nuisance::FittedFrom(value) => (true, Some(value)),
        };
        all.push(Parameter { name, kind, scale, unit, is_free, given });
    };
    if let Some(stiffness) = chosen.stiffness {
        add("stiffness".to_string(), Kind::Stiffness, Scale::Logarithm, 1.0, stiffness);
    }
    for (curve, size) in sizes.iter().enumerate() {
        let name = |name: &str| if sizes.len() == 1 { name.to_string() } else { format!("{name} {curve}") };
        let speed = size.depth / size.time;
        add(name("contact point"), Kind::ContactPoint(curve), Scale::Linear, size.depth, chosen.contact_point);
        add(name("offset"), Kind::Offset(curve), Scale::Linear, size.force, chosen.offset);
        add(name("drift"), Kind::Drift(curve), Scale::Linear, size.force / size.time, chosen.drift);
        add(name("drag"), Kind::Drag(curve), Scale::Linear, size.force / speed, chosen.drag);
    }
    Ok(all)
}
