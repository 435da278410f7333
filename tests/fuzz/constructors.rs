//! Constructors of models, shapes, histories and reference solutions, with any numbers.

use viscocontact::analytic::{GrowingSphere, Hertz, HertzEllipse, RigidPunch};
use viscocontact::geometry::Roughness;
use viscocontact::motion::Path;
use viscocontact::prelude::*;
use viscocontact::rheology::library;

use crate::engine::{Outcome, Target, Verdict, finite, judged, known};
use crate::models;
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "rheology", short: 4000, run: rheology },
        Target { name: "series", short: 50, run: series },
        Target { name: "geometry", short: 3000, run: geometry },
        Target { name: "rough", short: 500, run: rough },
        Target { name: "history", short: 3000, run: history },
        Target { name: "kernel", short: 1000, run: kernel },
        Target { name: "analytic", short: 12000, run: analytic },
    ]
}

fn rheology(source: &mut Source) -> Verdict {
    judged(models::rheology(source, true), |body| {
        // a closure of the user's may return anything
        if format!("{body:?}").contains("FnRheology") {
            return Ok(());
        }
        models::creeps(&*body, body.known_until())?;
        let nu = source.between(-0.5, 0.5);
        let Ok(material) = Material::constant_poisson(body, nu) else { return Ok(()) };
        known("contact compliance", [0.0, 1.0, 1e300].map(|t| material.contact_compliance(t)))?;
        if let Ok(published) = library::find(source.choose(&["nothing", "pmma", ""])) {
            known("published", published.terms().into_iter().flat_map(|(a, b)| [a, b]))?;
        }
        Ok(())
    })
}

fn series(source: &mut Source) -> Verdict {
    let Ok(body) = models::rheology(source, true) else { return Ok(Outcome::Refused) };
    let first = source.scale(1e-6, 1e3);
    let times = first..=first * source.scale(1.0, 1e8);
    // fits over more decades take seconds, as documented, up to where they are refused
    if models::is_long_fit(&times) {
        return Ok(Outcome::Refused);
    }
    judged(body.series(times.clone(), source.scale(1e-6, 1e-1)), |series| {
        models::creeps(&series, series.known_until())?;
        known("misfit", [series.report().max_misfit()])
    })
}

fn geometry(source: &mut Source) -> Verdict {
    let length = source.scale(1e-6, 1.0);
    judged(models::geometry(source, length), |shape| {
        // closures and maps with missing points may be NaN
        let text = format!("{shape:?}");
        let own = text.contains("FnGeometry") || text.contains("HeightMap");
        // squares of longer ones leave the range of f64; a contact refuses such a gap by its cell
        if !(1e-100..1e100).contains(&length) {
            return Ok(());
        }
        for _ in 0..8 {
            let at = [length * (source.unit() - 0.5), length * (source.unit() - 0.5)];
            let gap = shape.initial_gap(at[0], at[1]);
            if !own && (gap.is_nan() || gap == f64::NEG_INFINITY) {
                return Err(format!("a gap of {gap} at {at:?} of {text}"));
            }
        }
        Ok(())
    })
}

fn rough(source: &mut Source) -> Verdict {
    let length = source.scale(1e-6, 1.0);
    let cells = [source.count(1, 12), source.count(1, 12)];
    let Ok(grid) = Grid::new(cells, cells.map(|n| length * n as f64 / 12.0)) else { return Ok(Outcome::Refused) };
    let shortest = length / 12.0 * source.between(1.9, 5.0);
    let roll_off = shortest * source.scale(1.0, 4.0);
    let hurst = source.between(0.01, 1.0);
    let longest = roll_off * source.scale(1.0, 4.0);
    let anisotropy = Anisotropy::new(source.scale(1.0, 4.0), source.between(-7.0, 7.0));
    let roughness = if source.chance(0.5) {
        Roughness::RmsHeight(length * source.scale(1e-6, 1e-2))
    } else {
        Roughness::RmsSlope(source.scale(1e-3, 1.0))
    };
    let spec = RoughSpec::new(longest, shortest, roughness)
        .with_hurst(hurst)
        .with_roll_off(roll_off)
        .with_anisotropy(anisotropy)
        .with_seed(source.u64());
    let made = match source.below(2) {
        0 => Rough::new(&grid, spec),
        _ => Rough::windowed(&grid, spec, grid.lengths().map(|length| length * source.count(1, 3) as f64)),
    };
    judged(made, |rough| finite("heights", rough.height_map().heights().iter().copied()))
}

fn history(source: &mut Source) -> Verdict {
    let softness = source.scale(1e-8, 1e-4);
    judged(models::history(source, 1e-2, softness), |history| {
        let own = format!("{history:?}").contains("FnHistory");
        let mut time = source.between(-2.0, 2.0);
        for _ in 0..12 {
            for load in [history.at(time), history.before(time)] {
                let (Load::Force { normal: size, tilt } | Load::Approach { approach: size, tilt }) = load else {
                    continue;
                };
                let tilts = tilt.map(|tilt| match tilt {
                    Tilt::Fixed(tilt) => tilt,
                    Tilt::Free { at } => at,
                    _ => unreachable!("{tilt:?}"),
                });
                if !own && time.is_finite() {
                    known("a load", [size, tilts[0], tilts[1]])
                        .map_err(|what| format!("{what} of {history:?} at {time:?}"))?;
                }
            }
            match history.next_breakpoint(time) {
                Some(next) if next <= time || next.is_nan() => {
                    return Err(format!("after {time:?} comes {next:?} in {history:?}"));
                }
                Some(next) => time = next,
                None => time = source.between(-10.0, 1e3),
            }
        }
        if let Ok(path) = Straight::new([source.between(-1.0, 1.0); 2], [source.between(-1.0, 1.0); 2]) {
            known("a path", path.at(source.unit()))?;
        }
        Ok(())
    })
}

fn kernel(source: &mut Source) -> Verdict {
    let cells = [source.count(1, 9), if source.chance(0.3) { 1 } else { source.count(1, 9) }];
    let Ok(grid) = Grid::new(cells, [source.scale(1e-6, 1.0), source.scale(1e-6, 1.0)]) else {
        return Ok(Outcome::Refused);
    };
    judged(models::kernel(source, &grid), |kernel| {
        let pressure: Vec<f64> = (0..grid.len()).map(|_| source.unit()).collect();
        let mut displacement = vec![0.0; grid.len()];
        let mut work = kernel.workspace().unwrap();
        kernel.convolve(&pressure, &mut displacement, &mut work).map_err(|error| error.to_string())?;
        finite("K p", displacement.iter().copied())?;
        // any numbers at all: K p is a number, or refused
        let pressure: Vec<f64> = (0..grid.len()).map(|_| source.anything()).collect();
        match kernel.convolve(&pressure, &mut displacement, &mut work) {
            Ok(()) => finite("K p of anything", displacement),
            Err(error) if error.to_string().is_empty() => Err("an error without words".to_owned()),
            Err(_) => Ok(()),
        }
    })
}

fn analytic(source: &mut Source) -> Verdict {
    let (radius, modulus, force) = (source.scale(1e-3, 1.0), source.scale(1e5, 1e11), source.scale(1e-3, 1e3));
    let [r, s] = [source.scale(1e-9, 1.0), source.scale(1e-9, 1.0)];
    match source.below(5) {
        0 => judged(Hertz::new(radius, modulus, force), |hertz| {
            finite("Hertz", [hertz.contact_radius, hertz.max_pressure, hertz.approach, hertz.pressure(0.0)])
        }),
        1 => judged(HertzEllipse::new([radius, source.scale(1e-3, 1.0)], modulus, force), |ellipse| {
            let [a, b] = ellipse.semi_axes;
            finite("ellipse", [a, b, ellipse.max_pressure, ellipse.approach, ellipse.pressure(0.0, 0.0)])
        }),
        2 => judged(RigidPunch::new(radius, modulus, force, radius * source.between(-0.4, 0.4)), |punch| {
            finite("punch", [punch.approach, punch.tilt, punch.pressure(0.0, 0.0)])
        }),
        3 => {
            let Ok(material) = models::material(source, false) else { return Ok(Outcome::Refused) };
            judged(GrowingSphere::step(radius, &material, force), |sphere| {
                if ![r, s].iter().all(|x| x.is_finite() && *x >= 0.0) {
                    return Ok(());
                }
                known("growing sphere", [sphere.contact_radius(r), sphere.approach(s)])?;
                // the pressure of what has crept beyond all numbers is none, as documented
                if sphere.contact_radius(s).is_finite() { known("pressure", [sphere.pressure(r, s)]) } else { Ok(()) }
            })
        }
        _ => {
            let Ok(material) = models::material(source, false) else { return Ok(Outcome::Refused) };
            let states = match source.below(4) {
                0 => ElasticStates::sphere(radius),
                1 => ElasticStates::cone(r),
                2 => ElasticStates::power(r, s),
                _ => ElasticStates::punch(radius),
            };
            let Ok(mut foundation) = states.and_then(|states| StatesContact::new(&states, &material)) else {
                return Ok(Outcome::Refused);
            };
            for _ in 0..3 {
                let dt = if source.chance(0.3) { 0.0 } else { source.scale(1e-3, 1e3) };
                let load = match source.below(3) {
                    0 => Load::force(force * source.scale(1e-3, 1.0)),
                    1 => Load::approach(radius * source.between(-1e-3, 1e-2)),
                    _ => Load::spring(modulus * radius, radius * source.between(-1e-3, 1e-2)),
                };
                if let Ok(report) = foundation.step(dt, load) {
                    finite(
                        "states",
                        [report.time, report.approach, report.force, foundation.contact_area(), foundation.level()],
                    )?;
                }
            }
            Ok(Outcome::Accepted)
        }
    }
}
