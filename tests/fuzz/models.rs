//! Random bodies, shapes, loads, histories and kernels.

use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact::rheology::{PronyTerm, TimeTemperature};

use crate::engine::known;
use crate::source::Source;

/// Terms of a series.
fn terms(source: &mut Source, size: [f64; 2]) -> Vec<(f64, f64)> {
    (0..source.below(5)).map(|_| (source.scale(size[0], size[1]), source.scale(1e-3, 1e3))).collect()
}

/// A body of any model; models without an exact series are slow to fit, and can be left out.
pub fn rheology(source: &mut Source, fitted: bool) -> viscocontact::Result<Box<dyn Rheology>> {
    let g = source.scale(1e5, 1e8);
    let (j, t, n) = (source.scale(1e-9, 1e-5), source.scale(1e-3, 1e3), source.between(0.05, 0.95));
    let [a, b] = [source.scale(1e4, 1e9), source.scale(1e4, 1e9)];
    Ok(match source.below(if fitted { 15 } else { 7 }) {
        0 => Box::new(Elastic::new(g)?),
        1 if source.chance(0.5) => Box::new(Maxwell::with_time(g, t)?),
        1 => Box::new(Maxwell::new(g, a)?),
        2 if source.chance(0.5) => Box::new(KelvinVoigt::with_time(g, t)?),
        2 => Box::new(KelvinVoigt::new(g, a)?),
        3 if source.chance(0.5) => Box::new(Zener::relaxing(g.max(a), g.min(a), t)?),
        3 => Box::new(Zener::new(g, a, b)?),
        4 if source.chance(0.5) => Box::new(Burgers::with_times((g, t), (a, source.scale(1e-3, 1e3)))?),
        4 => Box::new(Burgers::new(g, a, b, source.scale(1e4, 1e9))?),
        5 => {
            let fluidity = if source.chance(0.5) { 0.0 } else { source.scale(1e-12, 1e-6) };
            Box::new(GeneralizedKelvin::new(j, fluidity, &terms(source, [1e-9, 1e-5]))?)
        }
        6 if source.chance(0.3) => {
            let terms = terms(source, [1e-3, 1.0]).into_iter();
            let terms: Vec<_> = terms.map(|(share, time)| PronyTerm { share, time }).collect();
            Box::new(GeneralizedMaxwell::prony(g, &terms)?)
        }
        6 => Box::new(GeneralizedMaxwell::new(source.choose(&[g, g, 0.0]), &terms(source, [1e4, 1e8]))?),
        7 => Box::new(PowerLaw::new(j, t, n)?),
        8 if source.chance(0.5) => Box::new(FractionalMaxwell::findley(j, source.scale(1e-9, 1e-5), n)?),
        8 if source.chance(0.5) => Box::new(FractionalMaxwell::with_time(g, t, n)?),
        8 => Box::new(FractionalMaxwell::new(g, a, n)?),
        9 if source.chance(0.5) => Box::new(FractionalZener::relaxing(g.max(a), g.min(a), t, n)?),
        9 => Box::new(FractionalZener::new(g, a, t, n)?),
        10 => Box::new(Kww::new(j, source.scale(1e-9, 1e-5), t, n)?),
        11 => Box::new(LogCreep::new(j, source.scale(1e-9, 1e-6), t)?),
        12 => Box::new(SlowCreep::new(j, source.scale(1e-9, 1e-6), t, n)?),
        13 => {
            let law = if source.chance(0.5) {
                TimeTemperature::wlf(
                    source.between(5.0, 20.0),
                    source.between(30.0, 200.0),
                    source.between(250.0, 400.0),
                )?
            } else {
                TimeTemperature::arrhenius(source.scale(1e4, 2e5), source.between(250.0, 400.0))?
            };
            Box::new(law.at(Zener::new(g, a, b)?, source.between(250.0, 400.0))?)
        }
        _ => {
            let [slope, bend] = [source.between(-0.01, 1.0), source.between(0.1, 1.0)];
            Box::new(FnRheology::new(move |t| j * (1.0 + slope * t.powf(bend))))
        }
    })
}

/// `Err` if J is NaN up to an age, or falls below zero.
pub fn creeps(rheology: &dyn Rheology, until: f64) -> Result<(), String> {
    let times = [0.0, 5e-324, 1e-300, 1e-30, 1e-9, 1e-3, 1.0, 17.0, 1e3, 1e9, 1e30, 1e300, f64::MAX];
    for t in times.into_iter().chain([0.5 * until, until]).filter(|&t| t <= until && t.is_finite()) {
        let value = rheology.creep_compliance(t);
        let allowed = value >= 0.0;
        if !allowed {
            return Err(format!("J({t:e} s) = {value:?} of {rheology:?}"));
        }
    }
    if let Some(spectrum) = rheology.creep_spectrum() {
        let relaxation = spectrum.relaxation();
        for t in [0.0, 1e-300, 1e-3, 1.0, 1e3, 1e300] {
            let values = [spectrum.compliance(t), relaxation.modulus(t)];
            known("compliance, modulus", values).map_err(|what| format!("{what} at {t:e} s of {rheology:?}"))?;
        }
        let series = spectrum.terms().iter().chain(relaxation.terms()).flat_map(|&(strength, time)| [strength, time]);
        let ends = [spectrum.glassy(), spectrum.fluidity(), relaxation.equilibrium(), relaxation.viscosity()];
        known("terms", series.chain(ends)).map_err(|what| format!("{what} of {rheology:?}"))?;
    }
    Ok(())
}

/// Whether a fit over these times would take longer than an execution may, and yet not be refused.
pub fn is_long_fit(times: &std::ops::RangeInclusive<f64>) -> bool {
    (1e12..1.01e50).contains(&(times.end() / times.start()))
}

/// A body of the contact.
pub fn material(source: &mut Source, fitted: bool) -> viscocontact::Result<Material> {
    let body = rheology(source, fitted)?;
    Ok(match source.below(7) {
        5 => Material::from_tension(Tension(body), source.between(-0.5, 0.5))?,
        6 => Material::from_tension_elastic_bulk(Tension(body), source.scale(1e6, 1e10))?,
        0 => Material::constant_poisson(body, source.between(-0.5, 0.5))?,
        1 => Material::elastic_bulk(body, source.scale(1e6, 1e10))?,
        2 => Material::incompressible(body).against(Material::incompressible(Elastic::new(source.scale(1e6, 1e12))?)),
        _ => Material::incompressible(body),
    })
}

/// A shape for a grid of about this length.
pub fn geometry(source: &mut Source, length: f64) -> viscocontact::Result<Box<dyn Geometry>> {
    let radius = length * source.scale(0.5, 1e2);
    Ok(match source.below(13) {
        0 | 1 => Box::new(Sphere::new(radius)?),
        2 => Box::new(Cylinder::new(radius)?),
        3 => Box::new(Cone::new(source.scale(1e-3, 1.0))?),
        4 => Box::new(Ellipsoid::new(radius, length * source.scale(0.5, 1e2))?),
        5 => Box::new(FlatPunch::circular(length * source.between(0.1, 0.6))?),
        6 => Box::new(FlatPunch::rectangular([length * source.between(0.1, 0.9), length * source.between(0.1, 0.9)])?),
        7 => Box::new(Wavy::new(length * source.scale(1e-6, 1e-2), length * source.scale(0.2, 2.0))?),
        8 => {
            let by = [length * source.between(-0.5, 0.5), length * source.between(-0.5, 0.5)];
            Box::new(Shifted::new(Sphere::new(radius)?, by)?)
        }
        9 => {
            let wavy = Wavy::in_two_directions(
                [length * source.scale(1e-6, 1e-2), length * source.scale(1e-6, 1e-2)],
                [length * source.scale(0.2, 2.0), length * source.scale(0.2, 2.0)],
            )?;
            Box::new(Sum::new(Sphere::new(radius)?, wavy))
        }
        10 => {
            let period = [length * source.scale(0.2, 2.0), length * source.scale(0.2, 2.0)];
            Box::new(Repeated::new(Sphere::new(radius)?, period)?)
        }
        11 => {
            let cells = [source.count(1, 8), source.count(1, 8)];
            let height = length * source.scale(1e-5, 1e-2);
            let heights = (0..cells[0] * cells[1])
                .map(|_| if source.chance(0.02) { f64::NAN } else { height * (source.unit() - 0.5) })
                .collect();
            let map = HeightMap::new(cells, [length, length], heights)?;
            Box::new(if source.chance(0.5) { map.periodic() } else { map.masked() })
        }
        _ => {
            let [slope, gap] = [source.between(-1e-2, 1e-2), source.between(-1e-3, 1e-3) * length];
            let hole = source.chance(0.3);
            Box::new(FnGeometry::new(move |x1: f64, x2: f64| {
                if hole && x1.hypot(x2) < 0.2 * length {
                    f64::INFINITY
                } else {
                    gap + slope * x1.abs() + x2 * x2 / radius
                }
            }))
        }
    })
}

/// A load on bodies that an elastic contact of this length and softness would give way to.
pub fn load(source: &mut Source, length: f64, softness: f64) -> Load {
    let tilt = |source: &mut Source| match source.below(6) {
        0 => Tilt::Free { at: length * source.between(-0.2, 0.2) },
        1 => Tilt::Fixed(source.between(-1e-2, 1e-2)),
        _ => Tilt::Fixed(0.0),
    };
    let tilt = [tilt(source), tilt(source)];
    if source.chance(0.75) {
        let normal = if source.chance(0.1) { 0.0 } else { length * length / softness * source.scale(1e-6, 1e-1) };
        Load::Force { normal, tilt }
    } else if source.chance(0.6) {
        Load::Approach { approach: length * source.between(-1e-3, 1e-2), tilt }
    } else {
        let stiffness = length / softness * source.scale(1e-6, 1e6);
        let drive = length * source.between(-1e-3, 1e-2) * (1.0 + length / (softness * stiffness));
        Load::Spring { stiffness, drive, tilt }
    }
}

/// A history of loads.
pub fn history(source: &mut Source, length: f64, softness: f64) -> viscocontact::Result<Box<dyn LoadHistory>> {
    let first = load(source, length, softness);
    // mostly of the same kind, as histories need
    let second = match first {
        Load::Force { normal, tilt } if source.chance(0.9) => {
            Load::Force { normal: normal * source.scale(0.1, 3.0), tilt }
        }
        Load::Approach { approach, tilt } if source.chance(0.9) => {
            Load::Approach { approach: approach * source.scale(0.1, 3.0), tilt }
        }
        Load::Spring { stiffness, drive, tilt } if source.chance(0.9) => {
            let stiffness = if source.chance(0.5) { stiffness } else { stiffness * source.scale(0.1, 3.0) };
            Load::Spring { stiffness, drive: drive * source.scale(0.1, 3.0), tilt }
        }
        _ => load(source, length, softness),
    };
    let period = source.scale(1e-3, 1e3);
    Ok(match source.below(9) {
        0 => Box::new(StepLoad::new(first)?),
        1 => Box::new(Ramp::new(first, second, period)?),
        2 => Box::new(Sinusoid::new(first, second, period.recip())?),
        3 => Box::new(Sinusoid::about(first, source.scale(1e-9, 1.0), period.recip())?),
        4 => Box::new(Periodic::square(first, second, period, source.unit())?),
        5 => Box::new(Periodic::triangle(first, second, period)?),
        6 => Box::new(Periodic::sawtooth(first, second, period)?),
        7 => {
            let mut time = source.between(-1.0, 1.0);
            let mut table = Vec::new();
            for k in 0..source.count(0, 5) {
                table.push((time, if k % 2 == 0 { first } else { second }));
                time += if source.chance(0.2) { 0.0 } else { source.scale(1e-3, 1e2) };
            }
            if source.chance(0.5) { Box::new(Periodic::new(&table)?) } else { Box::new(PiecewiseLinear::new(&table)?) }
        }
        _ => {
            let (normal, rate) = (length * length / softness * source.scale(1e-6, 1e-1), source.scale(1e-3, 1e3));
            let corner = source.between(0.0, 10.0);
            Box::new(
                FnHistory::new(move |t| Load::force(normal * (1.0 + (rate * t).sin()))).with_breakpoints(&[corner])?,
            )
        }
    })
}

/// A history that turns a few times in a second or so. Nothing tilts: tilts drawn at random put the contact hundreds of its
/// widths off the middle of a domain that must hold both, which is no small input.
pub fn few_turns(source: &mut Source, length: f64, softness: f64) -> viscocontact::Result<Box<dyn LoadHistory>> {
    let [first, second] = [load(source, length, softness), load(source, length, softness)].map(|load| match load {
        Load::Force { normal, .. } => Load::force(normal),
        Load::Approach { approach, .. } => Load::approach(approach),
        Load::Spring { stiffness, drive, .. } => Load::spring(stiffness, drive),
        other => other,
    });
    Ok(match source.below(5) {
        4 => Box::new(Periodic::triangle(first, second, source.scale(1.0, 10.0))?),
        0 | 1 => Box::new(StepLoad::new(first)?),
        2 => Box::new(Ramp::new(first, second, source.scale(0.1, 10.0))?),
        _ => Box::new(PiecewiseLinear::new(&[(0.0, first), (source.scale(0.1, 1.0), second)])?),
    })
}

/// The answer of a body to pressure.
pub fn kernel(source: &mut Source, grid: &Grid) -> viscocontact::Result<InfluenceKernel> {
    let lengths = grid.lengths();
    match source.below(8) {
        0 | 1 => InfluenceKernel::half_space(grid),
        2 | 3 => InfluenceKernel::periodic(grid),
        4 => {
            let axis = source.choose(&Axis::BOTH);
            InfluenceKernel::periodic_along(grid, axis, lengths[0].max(lengths[1]) * source.between(0.9, 9.0))
        }
        5 => InfluenceKernel::line(grid, lengths[0] * source.between(0.9, 9.0)),
        6 => {
            let (size, decay) = (lengths[0] * source.scale(1e-2, 1.0), source.between(0.0, 2.0));
            let lean = if source.chance(0.05) { 0.1 } else { 0.0 };
            InfluenceKernel::from_coefficients(grid, |i, j| {
                let distance = (i as f64 + lean).hypot(j as f64);
                size / (1.0 + distance).powf(1.0 + decay)
            })
        }
        _ => {
            let (size, exponent, mean) = (source.scale(0.1, 10.0), source.between(-1.0, 2.0), source.below(2) as f64);
            InfluenceKernel::from_spectrum(grid, |q1, q2| {
                let q = q1.hypot(q2);
                if q == 0.0 { mean * lengths[0] } else { size * lengths[0] / (q * lengths[0]).powf(exponent) }
            })
        }
    }
}
