//! Contacts on elastic states: tables of any numbers, any material and load, and damaged files.

use viscocontact::output::{read_states, write_states};
use viscocontact::prelude::*;
use viscocontact_scenes::Temporary;

use crate::engine::{Outcome, Target, Verdict, known};

use crate::models;
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "states: table", short: 3000, run: table },
        Target { name: "states: file", short: 1500, run: file },
    ]
}

/// A table of growing contacts, and sometimes of anything.
fn any_table(source: &mut Source) -> Vec<(f64, f64, f64, f64)> {
    let (mut level, mut depth) = (source.scale(1e-12, 1.0), source.scale(1e-9, 1e-3));
    let mut table = Vec::new();
    for _ in 0..source.count(0, 12) {
        let row = (level, depth, source.scale(1e-6, 1.0), source.scale(1e-12, 1.0));
        table.push(if source.chance(0.03) {
            (source.anything(), source.anything(), source.anything(), source.anything())
        } else {
            row
        });
        let by = source.between(1.0, 3.0);
        (level, depth) = (level * by, depth * by.powf(source.between(0.4, 1.0)));
    }
    table
}

fn table(source: &mut Source) -> Verdict {
    let states = ElasticStates::from_table(&any_table(source));
    let Ok(material) = models::material(source, false) else { return Ok(Outcome::Refused) };
    let Ok(mut contact) = states.and_then(|states| StatesContact::new(&states, &material)) else {
        return Ok(Outcome::Refused);
    };
    if source.chance(0.5) {
        let coefficient = if source.chance(0.1) { source.anything() } else { source.between(0.05, 1.5) };
        match contact.clone().with_estimated_friction(coefficient) {
            Ok(rubs) => contact = rubs,
            Err(_) => return Ok(Outcome::Refused),
        }
    }
    let depth = contact.states().states().last().map_or(1.0, |state| state.approach);
    let mut taken = 0;
    for _ in 0..8 {
        let before = format!("{contact:?}");
        let dt = if source.chance(0.3) { 0.0 } else { source.scale(1e-6, 1e6) };
        let load = match source.below(4) {
            0 => Load::force(source.anything()),
            1 => Load::force(source.scale(1e-9, 1e9)),
            2 => Load::approach(depth * source.between(-0.5, 1.2)),
            _ => Load::spring(source.scale(1e-3, 1e9), depth * source.between(-0.5, 1.2)),
        };
        let along = match source.below(5) {
            0 => Load::force(source.anything()),
            1 => Load::force(contact.force() * source.between(-0.5, 0.5)),
            2 => Load::approach(depth * source.between(-2.0, 2.0)),
            3 => Load::spring(source.scale(1e-3, 1e9), depth * source.between(-2.0, 2.0)),
            _ => Load::force(0.0),
        };
        let rubs = contact.clone().with_slip_from_start().is_ok();
        let taken_step = if rubs { contact.step_sheared(dt, load, along) } else { contact.step(dt, load) };
        match taken_step {
            Ok(report) => {
                let work = contact.lateral_work();
                let along = [contact.lateral_force(), contact.lateral_displacement(), contact.stick_level()];
                known("shear", [along[0], along[1], along[2], work.work, work.slip, work.stored])?;
                let contact = [contact.contact_area(), contact.level(), contact.stiffness_over_modulus()];
                known("report", [report.time, report.force, report.approach, contact[0], contact[1], contact[2]])?;
                taken += 1;
            }
            Err(_) if format!("{contact:?}") != before => return Err("a refused step changed the contact".to_owned()),
            Err(_) => {}
        }
    }
    Ok(if taken > 0 { Outcome::Accepted } else { Outcome::Refused })
}

fn file(source: &mut Source) -> Verdict {
    let Ok(states) = ElasticStates::from_table(&any_table(source)) else { return Ok(Outcome::Refused) };
    let folder = Temporary::folder("fuzz-states");
    let path = folder.join("states.npz");
    write_states(&path, &states, &Metadata::new("a table")).map_err(|error| error.to_string())?;
    let bytes = std::fs::read(&path).map_err(|error| error.to_string())?;
    std::fs::write(&path, source.damage(&bytes)).map_err(|error| error.to_string())?;
    let Ok(read) = read_states(&path) else { return Ok(Outcome::Refused) };
    let table = read.states().iter();
    known("states of a file", table.flat_map(|state| [state.level, state.approach, state.stiffness, state.area]))?;
    Ok(Outcome::Accepted)
}
