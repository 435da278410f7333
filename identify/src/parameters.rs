//! The parameters of a fit: of the material, and of the measurement.

use crate::error::{Error, Result, same_length, within};
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

/// A property of the measurement, of all curves alike or of each curve for itself.
///
/// ```
/// use viscocontact_identify::{Identification, Model, Nuisance};
///
/// // one contact point is known, the other one is fitted
/// let points = vec![Nuisance::Fixed(1.0e-7), Nuisance::Fitted];
/// let fitting = Identification::new(Model::Zener).contact_point(points).offset(Nuisance::Fitted);
/// # let _ = fitting;
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PerCurve(Vec<Nuisance>);

impl From<Nuisance> for PerCurve {
    fn from(of_all: Nuisance) -> PerCurve {
        PerCurve(vec![of_all])
    }
}

impl From<Vec<Nuisance>> for PerCurve {
    fn from(of_each: Vec<Nuisance>) -> PerCurve {
        PerCurve(of_each)
    }
}

impl PerCurve {
    /// The property of a curve.
    pub(crate) fn of(&self, curve: usize) -> Nuisance {
        self.0.get(curve).or(self.0.first().filter(|_| self.0.len() == 1)).copied().unwrap_or(Nuisance::Fixed(0.0))
    }

    /// Whether there is one for each of so many curves, and all are numbers.
    fn check(&self, field: &'static str, curves: usize) -> Result<()> {
        if self.0.len() != 1 {
            same_length(field, self.0.len(), curves)?;
        }
        for nuisance in &self.0 {
            if let Nuisance::Fixed(value) | Nuisance::FittedFrom(value) = *nuisance {
                within(field, value, true, "finite")?;
            }
        }
        Ok(())
    }
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
    /// Growth of the force without contact with the drive \[N/m\].
    Tilt(usize),
    /// Force over the speed of the drive \[N s/m\].
    Drag(usize),
}

impl Kind {
    /// The only curve on which the parameter acts.
    pub(crate) fn curve(self) -> Option<usize> {
        match self {
            Kind::Material(_) | Kind::Stiffness => None,
            Kind::ContactPoint(curve)
            | Kind::Offset(curve)
            | Kind::Drift(curve)
            | Kind::Tilt(curve)
            | Kind::Drag(curve) => Some(curve),
        }
    }

    /// Whether the force is linear in the parameter.
    pub(crate) fn is_linear(self) -> bool {
        matches!(self, Kind::Offset(_) | Kind::Drift(_) | Kind::Tilt(_) | Kind::Drag(_))
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
    pub(crate) contact_point: PerCurve,
    pub(crate) offset: PerCurve,
    pub(crate) drift: PerCurve,
    pub(crate) tilt: PerCurve,
    pub(crate) drag: PerCurve,
    pub(crate) stiffness: Option<Nuisance>,
    /// Material parameters by name: value, and whether it is fixed.
    pub(crate) material: Vec<(String, f64, bool)>,
}

impl Default for Chosen {
    fn default() -> Chosen {
        let known = || PerCurve::from(Nuisance::Fixed(0.0));
        Chosen {
            contact_point: known(),
            offset: known(),
            drift: known(),
            tilt: known(),
            drag: known(),
            stiffness: None,
            material: Vec::new(),
        }
    }
}

/// Sizes of the curves: depth, force and duration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) depth: f64,
    /// Least and greatest drive \[m\].
    pub(crate) drive: [f64; 2],
    pub(crate) force: f64,
    pub(crate) time: f64,
}

/// All parameters of a problem.
pub(crate) fn parameters(model: Model, chosen: &Chosen, sizes: &[Size]) -> Result<Vec<Parameter>> {
    let names = model.parameters();
    if let Some((name, ..)) = chosen.material.iter().find(|(name, ..)| !names.contains(name)) {
        return Err(Error::UnknownParameter { name: name.clone(), names: names.join(", ") });
    }
    for (field, each) in [
        ("contact point", &chosen.contact_point),
        ("offset", &chosen.offset),
        ("drift", &chosen.drift),
        ("tilt", &chosen.tilt),
        ("drag", &chosen.drag),
    ] {
        each.check(field, sizes.len())?;
    }
    for (curve, size) in sizes.iter().enumerate() {
        if let Nuisance::FittedFrom(value) = chosen.contact_point.of(curve) {
            let inside = (size.drive[0]..=size.drive[1]).contains(&value);
            within("start of the contact point", value, inside, "within the range of the drive")?;
        }
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
        add(
            name("contact point"),
            Kind::ContactPoint(curve),
            Scale::Linear,
            size.depth,
            chosen.contact_point.of(curve),
        );
        add(name("offset"), Kind::Offset(curve), Scale::Linear, size.force, chosen.offset.of(curve));
        add(name("drift"), Kind::Drift(curve), Scale::Linear, size.force / size.time, chosen.drift.of(curve));
        add(name("tilt"), Kind::Tilt(curve), Scale::Linear, size.force / size.depth, chosen.tilt.of(curve));
        add(name("drag"), Kind::Drag(curve), Scale::Linear, size.force / speed, chosen.drag.of(curve));
    }
    Ok(all)
}
