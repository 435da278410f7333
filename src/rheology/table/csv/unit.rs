//! Units in the notations of headings.

/// The quantity of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Time,
    Frequency,
    Modulus,
    Compliance,
}

/// The quantity of a unit, and its size in s, rad/s, Pa or 1/Pa.
pub(super) type Unit = (Kind, f64);

pub(super) const TAU: f64 = std::f64::consts::TAU;

/// Names of each unit, with the name for errors first; its quantity and size.
const UNITS: [(&[&str], Kind, f64); 26] = [
    (&["s", "sec", "secs", "second", "seconds"], Kind::Time, 1.0),
    (&["ms"], Kind::Time, 1e-3),
    (&["µs", "us"], Kind::Time, 1e-6),
    (&["ns"], Kind::Time, 1e-9),
    (&["min", "mins", "minute", "minutes"], Kind::Time, 60.0),
    (&["h", "hr", "hrs", "hour", "hours"], Kind::Time, 3600.0),
    (&["d", "day", "days"], Kind::Time, 86400.0),
    (&["week", "weeks"], Kind::Time, 604_800.0),
    (&["year", "years"], Kind::Time, 31_557_600.0),
    (&["Hz", "hertz"], Kind::Frequency, TAU),
    (&["mHz"], Kind::Frequency, 1e-3 * TAU),
    (&["kHz"], Kind::Frequency, 1e3 * TAU),
    (&["MHz"], Kind::Frequency, 1e6 * TAU),
    (&["Pa", "pascal", "N/m2", "Nm-2"], Kind::Modulus, 1.0),
    (&["mPa"], Kind::Modulus, 1e-3),
    (&["kPa", "kN/m2"], Kind::Modulus, 1e3),
    (&["MPa", "N/mm2", "Nmm-2", "MN/m2"], Kind::Modulus, 1e6),
    (&["GPa", "kN/mm2", "GN/m2"], Kind::Modulus, 1e9),
    (&["TPa", "N/µm2"], Kind::Modulus, 1e12),
    (&["dyn/cm2", "dyne/cm2", "dyncm-2"], Kind::Modulus, 0.1),
    (&["bar"], Kind::Modulus, 1e5),
    (&["mbar"], Kind::Modulus, 1e2),
    (&["kbar"], Kind::Modulus, 1e8),
    (&["N/cm2", "Ncm-2"], Kind::Modulus, 1e4),
    (&["psi"], Kind::Modulus, 6894.757),
    (&["ksi"], Kind::Modulus, 6_894_757.0),
];

impl Kind {
    /// The name of the unit of this size, for errors.
    pub(super) fn name(self, size: f64) -> String {
        let of = |kind, size| {
            let unit = UNITS.iter().find(|unit| unit.1 == kind && same(unit.2, size));
            unit.map(|unit| unit.0[0].to_owned())
        };
        let (si, found) = match self {
            Kind::Time => ("s", of(self, size)),
            Kind::Frequency if same(size, 1.0) => ("rad/s", Some("rad/s".to_owned())),
            Kind::Frequency => ("rad/s", of(self, size)),
            Kind::Modulus => ("Pa", of(self, size)),
            Kind::Compliance => ("1/Pa", of(Kind::Modulus, 1.0 / size).map(|modulus| format!("1/{modulus}"))),
        };
        found.unwrap_or_else(|| format!("{size:e} {si}"))
    }
}

/// Whether two sizes are equal: 2π may be given with few digits.
pub(super) fn same(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() < 1e-2
}

/// The possible meanings of a text as a unit, empty if none: `1/s` is an angular frequency or another notation of Hz.
pub(super) fn readings(text: &str) -> Vec<Unit> {
    // 10⁻⁹ Pa⁻¹ as 10^-9 Pa^-1
    let mut plain = String::new();
    for c in text.trim().chars() {
        let raised = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|other| other == c).map(|digit| char::from(b'0' + digit as u8));
        let raised = if c == '⁻' { Some('-') } else { raised };
        if raised.is_some() && !plain.ends_with(['-', '^']) {
            plain.push('^');
        }
        plain.push(raised.unwrap_or(if c == 'μ' { 'µ' } else { c }));
    }
    let (scale, unit) = scaled(enclosed(&plain));
    let unit: String = unit.chars().filter(|c| !" ^·*".contains(*c)).collect();
    let unit = enclosed(unit.trim_end_matches('.'));
    let mut found = simple(unit);
    let below = unit.strip_prefix("1/").or_else(|| unit.strip_prefix('/')).or_else(|| unit.strip_suffix("-1"));
    for (kind, size) in below.map(|below| simple(enclosed(below))).unwrap_or_default() {
        match kind {
            Kind::Time => found.extend([(Kind::Frequency, 1.0 / size), (Kind::Frequency, TAU / size)]),
            Kind::Modulus => found.push((Kind::Compliance, 1.0 / size)),
            Kind::Frequency | Kind::Compliance => {}
        }
    }
    // rad/s, rad s^-1
    if let Some(rate) = unit.strip_prefix("rad") {
        let time = rate.strip_prefix('/').or_else(|| rate.strip_suffix("-1")).unwrap_or_default();
        let times = simple(time).into_iter().filter(|(kind, _)| *kind == Kind::Time);
        found.extend(times.map(|(_, size)| (Kind::Frequency, 1.0 / size)));
    }
    // m2/N, m2 N^-1, N^-1 m2: the reciprocal of N/m2
    let area_over_force = unit.split_once('/').filter(|(area, _)| area.ends_with('2'));
    let area_and_force = unit.strip_suffix("-1").and_then(|product| product.split_once('2'));
    let force_and_area = unit.split_once("-1").filter(|(_, area)| area.ends_with('2'));
    let pairs = [
        area_over_force.map(|(area, force)| format!("{force}/{area}")),
        area_and_force.map(|(area, force)| format!("{force}/{area}2")),
        force_and_area.map(|(force, area)| format!("{force}/{area}")),
    ];
    for modulus in pairs.iter().flatten() {
        found.extend(simple(modulus).into_iter().map(|(_, size)| (Kind::Compliance, 1.0 / size)));
    }
    found.into_iter().map(|(kind, size)| (kind, scale * size)).collect()
}

/// The text without brackets around it.
fn enclosed(text: &str) -> &str {
    let pairs = [['(', ')'], ['[', ']'], ['{', '}']];
    let inside = pairs.iter().find_map(|[open, close]| text.trim().strip_prefix(*open)?.strip_suffix(*close));
    // of (a)/(b), the brackets at the ends are no pair
    let paired = |inside: &&str| {
        let mut depth = 0;
        inside.chars().all(|c| {
            depth += i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
            depth >= 0
        })
    };
    inside.filter(paired).unwrap_or(text)
}

/// The power of ten before a unit, and the unit.
fn scaled(text: &str) -> (f64, &str) {
    let Some(power) = text.strip_prefix("10^").or_else(|| text.strip_prefix("1e")).or_else(|| text.strip_prefix("1E"))
    else {
        return (1.0, text);
    };
    let power = power.trim_start_matches('{');
    let end = power.char_indices().find(|&(at, c)| !(c.is_ascii_digit() || at == 0 && "+-".contains(c)));
    let (digits, unit) = power.split_at(end.map_or(power.len(), |(at, _)| at));
    match digits.parse::<i32>() {
        Ok(power) => (10_f64.powi(power), unit.trim_start_matches(['}', ' ', '·', '*', '×'])),
        Err(_) => (1.0, text),
    }
}

/// A unit without exponent or slash; case is ignored in names longer than a letter.
fn simple(name: &str) -> Vec<Unit> {
    let units = |fits: &dyn Fn(&str) -> bool| -> Vec<Unit> {
        UNITS.iter().filter(|unit| unit.0.iter().any(|name| fits(name))).map(|unit| (unit.1, unit.2)).collect()
    };
    let exact = units(&|unit| unit == name);
    if exact.is_empty() && name.len() > 1 { units(&|unit| unit.eq_ignore_ascii_case(name)) } else { exact }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_every_notation() {
        for (texts, unit) in [
            (&["s", "sec", "seconds", "SEC", "10^0 s"][..], (Kind::Time, 1.0)),
            (&["min", "Min", "minutes", "minute", "min."], (Kind::Time, 60.0)),
            (&["h", "hr", "hour"], (Kind::Time, 3600.0)),
            (&["week", "weeks"], (Kind::Time, 604_800.0)),
            (&["cm2/dyn", "dyn^-1 cm^2", "cm²/dyn"], (Kind::Compliance, 10.0)),
            (&["1/kbar", "kbar^-1"], (Kind::Compliance, 1e-8)),
            (&["TPa^-1", "µm²/N"], (Kind::Compliance, 1e-12)),
            (&["µs", "μs", "us", "10⁻⁶ s", "1e-6 s"], (Kind::Time, 1e-6)),
            (&["rad/s", "rad s^-1", "rad·s⁻¹", "1/s", "s^-1"], (Kind::Frequency, 1.0)),
            (&["Hz", "HZ", "1/s", "s⁻¹"], (Kind::Frequency, TAU)),
            (&["GPa", "gpa", "10^9 Pa", "1E9 Pa", "10⁹·Pa"], (Kind::Modulus, 1e9)),
            (&["MPa", "mpa", "N/mm^2", "N/mm²"], (Kind::Modulus, 1e6)),
            (
                &["1/GPa", "GPa^-1", "GPa⁻¹", "/GPa", "1 / GPa", "10^-9/Pa", "10^{-9} 1/Pa", "1/(GPa)"],
                (Kind::Compliance, 1e-9),
            ),
            (&["1/MPa", "mm²/N", "MPa-1"], (Kind::Compliance, 1e-6)),
        ] {
            for text in texts {
                let readings = readings(text);
                let found = readings.iter().any(|reading| reading.0 == unit.0 && same(reading.1, unit.1));
                assert!(found, "{text}: {readings:?}");
            }
            let (kind, size) = unit;
            assert!(
                self::readings(&kind.name(size)).iter().any(|&(k, s)| k == kind && same(s, size)),
                "{}",
                kind.name(size)
            );
        }
        for text in ["", "%", "t", "S", "H", "1", "10^", "K", "°C", "-", "5 MPa", "1 Hz", "ω", "mm", "1/K"] {
            assert_eq!(readings(text), [], "{text}");
        }
        assert_eq!(Kind::Time.name(7.0), "7e0 s");
    }
}
