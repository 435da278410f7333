//! Whole scenes through the public interface, on few cells.

use viscocontact::motion::{Straight, Travel};
use viscocontact::output::Metadata;
use viscocontact::prelude::*;
use viscocontact::run::Stepping;

use crate::engine::{Outcome, Target, Verdict, finite, known};
use crate::models;
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "scene_steps", short: 2000, run: |source| steps(source, false) },
        Target { name: "scene_fitted", short: 30, run: |source| steps(source, true) },
        Target { name: "scene_follow", short: 600, run: follow },
        Target { name: "scene_moving", short: 600, run: moving },
    ]
}

/// A contact with what its scales are.
struct Scale {
    contact: ViscoelasticContact,
    length: f64,
    softness: f64,
}

fn settings(source: &mut Source) -> Settings {
    let frame = if source.chance(0.2) { Frame::Indenter } else { Frame::Bodies };
    let rules = [TimeRule::Exponential, TimeRule::Exponential, TimeRule::ExponentialLinear];
    Settings::default()
        .with_tolerance(source.scale(1e-10, 1e-2))
        .with_max_iterations(source.choose(&[1, 3, 30, 200, 200, 200, 0]))
        .with_time_rule(source.choose(&rules))
        .with_edge(source.choose(&[Edge::Allow, Edge::Allow, Edge::Refuse]))
        .with_series_tolerance(source.scale(1e-4, 1e-1))
        .with_symmetry(source.chance(0.7))
        .with_window(source.chance(0.7))
        .with_frame(frame)
}

fn build(source: &mut Source, fitted: bool, settings: Settings) -> viscocontact::Result<Scale> {
    let length = source.scale(1e-6, 1.0);
    let cells = [source.count(1, 12), if source.chance(0.2) { 1 } else { source.count(1, 12) }];
    let grid = Grid::new(cells, [length, length * source.scale(0.3, 3.0)])?;
    let material = models::material(source, fitted)?;
    let softness = material.contact_compliance(source.scale(1e-2, 1e2)).abs().max(1e-300);
    let mut builder = ViscoelasticContact::builder(grid.clone())
        .geometry(&models::geometry(source, length)?)
        .material(material)
        .settings(settings);
    if source.chance(0.1) {
        builder = builder.another_body(&models::geometry(source, length)?);
    }
    if source.chance(0.6) {
        builder = builder.kernel(models::kernel(source, &grid)?);
    }
    if fitted {
        let first = source.scale(1e-4, 1.0);
        let times = first..=first * source.scale(1.0, 1e6);
        if !models::is_long_fit(&times) {
            builder = builder.times(times);
        }
    }
    Ok(Scale { contact: builder.build()?, length, softness })
}

/// What can be seen of a contact, bit by bit.
pub fn state(contact: &ViscoelasticContact) -> Vec<u64> {
    let numbers = [contact.time(), contact.approach(), contact.tilt()[0], contact.tilt()[1], contact.force()];
    numbers.into_iter().chain(contact.pressure().iter().copied()).map(f64::to_bits).collect()
}

/// Everything that a contact shows.
pub fn look(contact: &ViscoelasticContact, report: &StepReport, source: &mut Source) -> Result<(), String> {
    let StepReport { time, dt, residual, time_error, approach, tilt, force, .. } = *report;
    finite("report", [time, dt, residual, time_error.unwrap_or(0.0), approach, tilt[0], tilt[1], force])?;
    if report.contact_cells != contact.contact_cells() {
        return Err("cells in contact differ between report and contact".to_owned());
    }
    finite("pressure", contact.pressure().iter().copied())?;
    if contact.pressure().iter().any(|&p| p < 0.0) {
        return Err(format!("a negative pressure in {report:?} of {contact:?}: {:?}", contact.pressure()));
    }
    finite("displacement", contact.fields().displacement().iter().copied())?;
    let len = contact.grid().len();
    let mut field = vec![0.0; len];
    contact.fields().gap_into(&mut field).map_err(|error| error.to_string())?;
    known("gap", field.iter().copied())?;
    finite("sums", [contact.force(), contact.contact_area()])?;
    finite("moment", contact.fields().moment())?;
    for body in (0..contact.fields().bodies()).filter_map(|body| contact.fields().body(body)) {
        finite("body", [body.approach, body.force].into_iter().chain(body.tilt))?;
        finite("moment of a body", body.moment)?;
    }
    if let Some(space) = contact.fields().mesh_error().unwrap() {
        known(
            "error of the mesh",
            [space.approach, space.area, space.pressure_field].into_iter().chain(space.max_pressure),
        )?;
    }
    known("pressures", [contact.mean_pressure(), contact.fields().max_pressure()])?;
    if let Ok(patches) = contact.fields().patches() {
        let all = patches.all.iter();
        let of = |patch: &viscocontact::observe::Patch| [patch.area, patch.force, patch.centroid[0], patch.centroid[1]];
        known("patches", all.flat_map(of))?;
    }
    if let Ok(profile) = contact.fields().profile(source.choose(&[Axis::X1, Axis::X2]), 0.0) {
        known("profile", profile.positions.into_iter().chain(profile.gap))?;
    }
    if let Ok(within) = contact.within_step(time - 0.3 * dt) {
        finite("within", [within.time(), within.approach(), within.force()].into_iter().chain(within.tilt()))?;
        finite("pressure within", within.pressure().iter().copied())?;
        finite("displacement within", within.fields().displacement().iter().copied())?;
    }
    if source.chance(0.1) {
        if let Ok(stiffness) = contact.fields().stiffness_over_modulus() {
            known("stiffness", [stiffness])?;
        }
        let text = Metadata::new("fuzz").json(contact);
        if text.contains("NaN") || !text.ends_with('}') {
            return Err("a description that is no JSON".to_owned());
        }
    }
    Ok(())
}

/// After an error nothing has changed.
pub fn unchanged(before: &[u64], contact: &ViscoelasticContact, error: &Error) -> Result<(), String> {
    if error.to_string().is_empty() {
        return Err("an error without words".to_owned());
    }
    if before == state(contact) { Ok(()) } else { Err(format!("a failed step left its mark: {error}")) }
}

fn length_of_step(source: &mut Source) -> f64 {
    match source.below(5) {
        0 => 0.0,
        1 => source.scale(1e-9, 1e9),
        _ => source.scale(1e-3, 1e2),
    }
}

fn steps(source: &mut Source, fitted: bool) -> Verdict {
    let settings = settings(source);
    let Ok(Scale { mut contact, length, softness }) = build(source, fitted, settings) else {
        return Ok(Outcome::Refused);
    };
    let mut accepted = false;
    for _ in 0..source.count(1, 6) {
        let loads: Vec<Load> = (0..contact.fields().bodies()).map(|_| models::load(source, length, softness)).collect();
        let (dt, before) = (length_of_step(source), state(&contact));
        if source.chance(0.05)
            && let Ok(shape) = models::geometry(source, length)
            && let Err(error) = contact.set_geometries(&[&shape])
        {
            unchanged(&before, &contact, &error)?;
        }
        let before = state(&contact);
        match contact.step(dt, &loads) {
            Ok(report) => {
                accepted = true;
                look(&contact, &report, source)?;
            }
            Err(error) => unchanged(&before, &contact, &error)?,
        }
    }
    Ok(if accepted { Outcome::Accepted } else { Outcome::Refused })
}

/// Looks at the first steps of a run, and at its error budget.
pub fn look_along(
    mut run: Run,
    steps: usize,
    source: &mut Source,
    mut seen: impl FnMut(StepReport),
) -> Result<(), String> {
    for _ in 0..steps {
        match run.next_step() {
            Ok(Some(report)) => {
                look(run.contact(), &report, source)?;
                seen(report);
            }
            Ok(None) => break,
            Err(error) if error.to_string().is_empty() => return Err("an error without words".to_owned()),
            Err(_) => break,
        }
    }
    let budget = run.error_budget();
    let mesh = budget.mesh.map(|mesh| mesh.approach);
    known("error budget", budget.time.into_iter().chain(mesh).chain([budget.solver]))
}

fn follow(source: &mut Source) -> Verdict {
    let settings = settings(source);
    let Ok(Scale { mut contact, length, softness }) = build(source, false, settings) else {
        return Ok(Outcome::Refused);
    };
    let Ok(history) = models::history(source, length, softness) else { return Ok(Outcome::Refused) };
    let until = source.scale(1e-3, 1e4);
    let stepping = if source.chance(0.7) {
        Stepping::adaptive(source.scale(1e-5, 0.1))
    } else {
        Stepping::fixed(until * source.scale(1e-2, 1.0))
    };
    let landings = [source.between(0.0, 1.0) * until, source.between(0.0, 1.0) * until];
    let mut reports = Vec::new();
    {
        let Ok(run) = contact.follow(&*history, stepping, until).stop_at(landings) else {
            return Ok(Outcome::Refused);
        };
        // no more than these, or the slowest scenes take for ever
        look_along(run, 12, source, |report| reports.push(report))?;
    }
    if reports.windows(2).any(|pair| pair[1].time < pair[0].time) {
        return Err("time runs backwards".to_owned());
    }
    Ok(if reports.is_empty() { Outcome::Refused } else { Outcome::Accepted })
}

fn moving(source: &mut Source) -> Verdict {
    let frame = source.choose(&[Frame::Bodies, Frame::Indenter, Frame::Indenter]);
    let settings = settings(source).with_frame(frame).with_time_rule(TimeRule::Exponential);
    let Ok(Scale { mut contact, length, softness }) = build(source, false, settings) else {
        return Ok(Outcome::Refused);
    };
    let mut accepted = false;
    for _ in 0..source.count(1, 6) {
        let (dt, load, before) = (length_of_step(source), models::load(source, length, softness), state(&contact));
        let result = if frame == Frame::Indenter {
            let cells = [source.below(9) as isize - 4, source.below(9) as isize - 4];
            let far = source.chance(0.02);
            contact.step_over(if far { [isize::MAX, isize::MIN] } else { cells }, dt, load)
        } else {
            let Ok(shape) = models::geometry(source, length) else { continue };
            let start = [length * source.between(-0.3, 0.3), length * source.between(-0.3, 0.3)];
            let velocity = [length * source.between(-1.0, 1.0), length * source.between(-1.0, 1.0)];
            let Ok(path) = Straight::new(start, velocity) else { continue };
            let mut travel = Travel::new(shape, path);
            if source.chance(0.2)
                && let Ok(track) = models::geometry(source, length)
            {
                travel = travel.over(track);
            }
            contact.step_along(&travel, dt, load).map(|report| report.step)
        };
        match result {
            Ok(report) => {
                accepted = true;
                look(&contact, &report, source)?;
            }
            Err(error) => unchanged(&before, &contact, &error)?,
        }
    }
    Ok(if accepted { Outcome::Accepted } else { Outcome::Refused })
}
