//! What can be set on the page: one table, from which the form, its checks and its links are made.

use std::fmt::Write;

/// One number of a scene, or one choice.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its name in links.
    pub key: &'static str,
    /// Its name in the form.
    pub label: &'static str,
    /// The unit in which the form has it.
    pub unit: &'static str,
    /// That unit in the units of the crate.
    pub factor: f64,
    /// The value at the start.
    pub default: f64,
    /// The lowest and the highest value allowed.
    pub range: [f64; 2],
    /// The names of the choices, whose numbers are the values; none of a number.
    pub choices: &'static [&'static str],
}

/// Places in the table.
#[derive(Debug, Clone, Copy)]
#[expect(missing_docs, reason = "as in the table")]
pub enum Key {
    Shape,
    Radius,
    Slope,
    Roughness,
    Seed,
    Material,
    Modulus,
    Retarded,
    Time,
    Exponent,
    Poisson,
    Control,
    Duration,
    Hold,
    Side,
    Cells,
    Steps,
    Friction,
    Amplitude,
    Period,
}

const fn number(
    key: &'static str,
    label: &'static str,
    unit: (&'static str, f64),
    default: f64,
    range: [f64; 2],
) -> Parameter {
    Parameter { key, label, unit: unit.0, factor: unit.1, default, range, choices: &[] }
}

const fn choice(key: &'static str, label: &'static str, choices: &'static [&'static str]) -> Parameter {
    let range = [0.0, (choices.len() - 1) as f64];
    Parameter { key, label, unit: "", factor: 1.0, default: 0.0, range, choices }
}

/// In the order of [`Key`].
pub const PARAMETERS: [Parameter; 20] = [
    choice("shape", "shape", &["ball", "cone", "flat punch"]),
    number("radius", "radius", ("mm", 1e-3), 10.0, [0.01, 1000.0]),
    number("slope", "slope", ("", 1.0), 0.1, [0.001, 1.0]),
    number("roughness", "rms roughness", ("µm", 1e-6), 0.0, [0.0, 1000.0]),
    number("seed", "seed of the roughness", ("", 1.0), 1.0, [0.0, 1e6]),
    choice("material", "material", &["Maxwell", "Zener", "fractional Zener", "elastic"]),
    number("modulus", "instantaneous shear modulus G", ("MPa", 1e6), 1.0, [1e-4, 1e6]),
    number("retarded", "retarded modulus G_K", ("MPa", 1e6), 0.5, [1e-4, 1e6]),
    number("time", "relaxation (Maxwell) or retardation time", ("s", 1.0), 1.0, [1e-6, 1e9]),
    number("exponent", "order of the springpot", ("", 1.0), 0.5, [0.05, 0.95]),
    number("poisson", "Poisson's ratio", ("", 1.0), 0.5, [-0.9, 0.5]),
    choice("control", "prescribed", &["force", "depth"]),
    number("duration", "duration", ("s", 1.0), 2.0, [1e-6, 1e9]),
    number("hold", "hold the depth from (0: never)", ("s", 1.0), 0.0, [0.0, 1e9]),
    number("side", "side of the grid", ("mm", 1e-3), 4.0, [0.001, 1000.0]),
    number("cells", "cells along a side", ("", 1.0), 64.0, [8.0, 256.0]),
    number("steps", "steps", ("", 1.0), 100.0, [1.0, 400.0]),
    number("friction", "friction coefficient", ("", 1.0), 0.0, [0.0, 10.0]),
    number("amplitude", "amplitude of the motion along the surface", ("µm", 1e-6), 30.0, [0.0, 1e6]),
    number("period", "period of the motion", ("s", 1.0), 1.0, [1e-6, 1e9]),
];

/// The numbers of a scene in the units of the form, and its load: times \[s\] and values \[N or µm\], linear in between.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    values: [f64; PARAMETERS.len()],
    load: Vec<(f64, f64)>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { values: PARAMETERS.map(|parameter| parameter.default), load: vec![(0.0, 1.0)] }
    }
}

impl Settings {
    /// Those of the start, except for some values and the load.
    pub fn with(values: &[(Key, f64)], load: &[(f64, f64)]) -> Settings {
        let mut settings = Settings { load: load.to_vec(), ..Settings::default() };
        values.iter().for_each(|&(key, value)| settings.values[key as usize] = value);
        settings
    }

    /// Sets the value at a place of the table; places beyond it are passed over.
    pub fn set(&mut self, place: usize, value: f64) {
        if let Some(old) = self.values.get_mut(place) {
            *old = value;
        }
    }

    /// Forgets the load.
    pub fn clear_load(&mut self) {
        self.load.clear();
    }

    /// Adds a point of the load.
    pub fn add_load(&mut self, time: f64, value: f64) {
        self.load.push((time, value));
    }

    /// A value in units of the crate.
    pub fn get(&self, key: Key) -> f64 {
        self.values[key as usize] * PARAMETERS[key as usize].factor
    }

    /// A value that is a count or a choice.
    pub fn count(&self, key: Key) -> usize {
        self.values[key as usize] as usize
    }

    /// Whether the depth is prescribed, rather than the force.
    pub fn is_depth(&self) -> bool {
        self.count(Key::Control) == 1
    }

    /// Times \[s\] and values \[N or m\] of the load.
    pub fn load(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let factor = if self.is_depth() { 1e-6 } else { 1.0 };
        self.load.iter().map(move |&(time, value)| (time, value * factor))
    }

    /// # Errors
    /// If a value is outside its range, or a count is not whole.
    pub fn check(&self) -> Result<(), String> {
        for (value, Parameter { label, range: [low, high], unit, choices, key, .. }) in
            self.values.iter().zip(PARAMETERS)
        {
            if !(low..=high).contains(value) {
                return Err(format!("{label}: {value} {unit} is outside the range of {low} to {high} {unit}"));
            }
            let is_whole = !choices.is_empty() || ["cells", "steps", "seed"].contains(&key);
            if is_whole && value.fract() != 0.0 {
                return Err(format!("{label}: {value} is not a whole number"));
            }
        }
        Ok(())
    }

    /// Those of the settings that are not as at the start, and the load, as the fragment of a link.
    pub fn fragment(&self) -> String {
        let mut text = String::new();
        for (value, parameter) in
            self.values.iter().zip(PARAMETERS).filter(|(value, parameter)| **value != parameter.default)
        {
            let _ = match parameter.choices.get(*value as usize) {
                Some(name) => write!(text, "{}={}&", parameter.key, name.replace(' ', "-")),
                None => write!(text, "{}={value}&", parameter.key),
            };
        }
        let points: Vec<_> = self.load.iter().map(|(time, value)| format!("{time}:{value}")).collect();
        text + "load=" + &points.join(",")
    }
}

/// The table and the scenes as JSON.
pub fn described(scenes: &[(&str, &str, Settings)]) -> String {
    let texts = |texts: &[&str]| texts.iter().map(|text| format!("{text:?}")).collect::<Vec<_>>().join(",");
    let parameter = |Parameter { key, label, unit, default, range: [low, high], choices, .. }: &Parameter| {
        format!(
            r#"{{"key":{key:?},"label":{label:?},"unit":{unit:?},"default":{default},"low":{low},"high":{high},"choices":[{}]}}"#,
            texts(choices)
        )
    };
    let scene = |(name, text, settings): &(&str, &str, Settings)| {
        format!(r#"{{"name":{name:?},"text":{text:?},"link":{:?}}}"#, settings.fragment())
    };
    let join = |parts: Vec<String>| parts.join(",");
    format!(
        r#"{{"parameters":[{}],"scenes":[{}]}}"#,
        join(PARAMETERS.iter().map(parameter).collect()),
        join(scenes.iter().map(scene).collect())
    )
}
