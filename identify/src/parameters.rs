//! The parameters of a fit: of the material, and of the measurement.

use crate::error::{Result, same_length, unknown, within};
use crate::experiment::Curve;
use crate::model::{Model, Scale};
use crate::statistics::range;

/// A parameter that may be known or fitted.
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

/// A parameter of all curves alike or of each curve for itself.
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
    /// The parameter of one curve alone.
    pub(crate) fn of(&self, curve: usize) -> PerCurve {
        let own = self.0.get(if self.0.len() == 1 { 0 } else { curve });
        PerCurve(own.map_or_else(Vec::new, |own| vec![*own]))
    }

    /// The parameter of each of so many curves.
    pub(crate) fn each(&self, field: &'static str, curves: usize) -> Result<impl Iterator<Item = Nuisance>> {
        if self.0.len() != 1 {
            same_length(field, self.0.len(), curves)?;
        }
        Ok(self.0.iter().copied().cycle().take(curves))
    }
}

/// A property of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Property {
    /// Stiffness of the spring \[N/m\].
    Stiffness,
    /// Drive at first touch \[m\].
    ContactPoint,
    /// Force without contact \[N\].
    Offset,
    /// Growth of this force \[N/s\].
    Drift,
    /// Growth of this force with the drive \[N/m\].
    Tilt,
    /// Force over the speed of the drive \[N s/m\].
    Drag,
}

impl Property {
    const ALL: [Self; 6] = [Self::Stiffness, Self::ContactPoint, Self::Offset, Self::Drift, Self::Tilt, Self::Drag];

    pub(crate) fn name(self) -> &'static str {
        ["stiffness", "contact point", "offset", "drift", "tilt", "drag"][self as usize]
    }

    /// What refusals call the list of values of a parameter.
    pub(crate) fn field(name: &str) -> &'static str {
        Self::ALL.into_iter().map(Self::name).find(|own| *own == name).unwrap_or("parameters of the material")
    }
}

/// Which quantity a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Material,
    /// A property of one curve, or of all of them.
    Measurement(Property, Option<usize>),
}

impl Kind {
    /// The only curve on which the parameter acts.
    pub(crate) fn curve(self) -> Option<usize> {
        if let Kind::Measurement(_, curve) = self { curve } else { None }
    }

    /// The property, if the force is linear in it.
    pub(crate) fn linear(self) -> Option<Property> {
        let Kind::Measurement(property, _) = self else { return None };
        (!matches!(property, Property::Stiffness | Property::ContactPoint)).then_some(property)
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
    fn new(name: String, kind: Kind, scale: Scale, unit: f64, nuisance: Nuisance) -> Result<Parameter> {
        let (is_free, given) = match nuisance {
            Nuisance::Fixed(value) => (false, Some(value)),
            Nuisance::Fitted => (true, None),
            Nuisance::FittedFrom(value) => (true, Some(value)),
        };
        given.map(|value| scale.check(&name, value)).transpose()?;
        Ok(Parameter { name, kind, scale, unit, is_free, given })
    }

    /// The parameters of a model, of which some are set.
    pub(crate) fn of_material(model: Model, chosen: &Chosen) -> Result<Vec<Parameter>> {
        let parameter = |name: String| {
            let set = chosen.of(&name).map(|set| set.each(Property::field(&name), 1)).transpose()?;
            let nuisance = set.and_then(|mut set| set.next()).unwrap_or(Nuisance::Fitted);
            let scale = Model::scale(&name);
            Parameter::new(name, Kind::Material, scale, 1.0, nuisance)
        };
        model.parameters().into_iter().map(parameter).collect()
    }

    /// The coordinate of a search.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        self.scale.forward(value) / self.unit
    }

    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        self.scale.back(coordinate * self.unit)
    }
}

/// What is set of each parameter of an identification, by name; the last counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Chosen(pub(crate) Vec<(String, PerCurve)>);

impl Chosen {
    fn of(&self, name: &str) -> Option<&PerCurve> {
        self.0.iter().rev().find(|(set, _)| set == name).map(|(_, each)| each)
    }

    /// All parameters of a model and of the measurement of some curves.
    pub(crate) fn parameters(&self, model: Model, curves: &[Curve]) -> Result<Vec<Parameter>> {
        let names = model.parameters();
        let is_known = |name: &String| names.contains(name) || Property::ALL.iter().any(|other| other.name() == name);
        if let Some((name, _)) = self.0.iter().find(|(name, _)| !is_known(name)) {
            return Err(unknown(name, names.iter()));
        }
        let mut all = Parameter::of_material(model, self)?;
        for property in Property::ALL {
            let Some(set) = self.of(property.name()) else { continue };
            // of one spring, unless several are given
            let is_common = property == Property::Stiffness && set.0.len() == 1;
            let each = set.each(property.name(), curves.len())?.take(if is_common { 1 } else { curves.len() });
            for (curve, (nuisance, of)) in each.zip(curves).enumerate() {
                let (times, drive) = (of.experiment.protocol.times(), range(of.experiment.protocol.drive()));
                if let (Property::ContactPoint, Nuisance::FittedFrom(value)) = (property, nuisance) {
                    let inside = (drive[0]..=drive[1]).contains(&value);
                    within("start of the contact point", value, inside, "within the range of the drive")?;
                }
                let size = |[low, high]: [f64; 2]| if high > low { high - low } else { 1.0 };
                let (depth, force, time) = (size(drive), size(range(&of.force)), times[times.len() - 1] - times[0]);
                let (scale, unit) = match property {
                    Property::Stiffness => (Scale::Logarithm, 1.0),
                    Property::ContactPoint => (Scale::Linear, depth),
                    Property::Offset => (Scale::Linear, force),
                    Property::Drift => (Scale::Linear, force / time),
                    Property::Tilt => (Scale::Linear, force / depth),
                    Property::Drag => (Scale::Linear, force / (depth / time)),
                };
                let is_only = is_common || curves.len() == 1;
                let name = if is_only { property.name().into() } else { format!("{} {curve}", property.name()) };
                let kind = Kind::Measurement(property, (!is_common).then_some(curve));
                all.push(Parameter::new(name, kind, scale, unit, nuisance)?);
            }
        }
        Ok(all)
    }
}
