//! Contacts with friction in space: any limit, load and motion.

use viscocontact::friction::{
    Component, Coulomb, FrictionContact, FrictionLimit, LateralWork, Outcome as Step, ShearLoad,
};
use viscocontact::prelude::*;

use crate::engine::{Outcome, Target, Verdict, known};
use crate::models;
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![Target { name: "friction: steps", short: 600, run: steps }]
}

/// A limit that may be anything.
#[derive(Debug, Clone, Copy)]
struct Own(f64, f64);

impl FrictionLimit for Own {
    fn limit(&self, pressure: f64) -> f64 {
        self.0 + self.1 * pressure
    }
}

fn component(source: &mut Source, force: f64, length: f64) -> Component {
    match source.below(5) {
        0 => Component::Force(source.anything()),
        1 => Component::Motion(source.anything()),
        2 => Component::Motion(length * source.between(-0.1, 0.1)),
        3 => Component::Force(0.0),
        _ => Component::Force(force * source.between(-0.7, 0.7)),
    }
}

fn steps(source: &mut Source) -> Verdict {
    let length = source.scale(1e-9, 1e3);
    let Ok(grid) = Grid::new([source.count(1, 9), source.count(1, 9)], [length, source.scale(0.3, 3.0) * length])
    else {
        return Ok(Outcome::Refused);
    };
    let (Ok(material), Ok(shape)) = (models::material(source, false), models::geometry(source, length)) else {
        return Ok(Outcome::Refused);
    };
    let alike = source.chance(0.6);
    let mut builder = ViscoelasticContact::builder(grid.clone()).geometry(&*shape).material(material.clone());
    if alike {
        builder = builder.counter_body(material);
    }
    if source.chance(0.3) {
        let Ok(kernel) = InfluenceKernel::periodic(&grid) else { return Ok(Outcome::Refused) };
        builder = builder.kernel(kernel);
    }
    builder = builder.settings(Settings::default().with_edge(Edge::Allow));
    let made = if source.chance(0.3) {
        FrictionContact::new(builder, Own(source.anything(), source.anything()))
    } else {
        Coulomb::new(source.between(0.05, 1.5)).and_then(|law| FrictionContact::new(builder, law))
    };
    let Ok(mut contact) = made else { return Ok(Outcome::Refused) };
    let mut taken = 0;
    for _ in 0..6 {
        let state = |contact: &FrictionContact| {
            let normal = contact.normal();
            format!("{:?}", (contact.motion(), contact.force(), contact.traction(), normal.time(), normal.force()))
        };
        let (before, softness) = (state(&contact), source.scale(1e-9, 1.0));
        let dt = if source.chance(0.3) { 0.0 } else { source.scale(1e-6, 1e6) };
        let load = models::load(source, length, softness);
        let force = contact.normal().force();
        let shear = ShearLoad { components: [(); 3].map(|()| component(source, force, length)) };
        match contact.step(dt, load, shear) {
            Ok(Step::Holds(report)) => {
                known("shear", contact.motion().into_iter().chain(contact.force()))?;
                let LateralWork { work, slip, stored, creep, .. } = contact.lateral_work();
                known("work", [work, slip, stored, creep])?;
                known("fields", contact.traction().into_iter().chain(contact.slip()).flatten())?;
                known("report", [report.residual, report.convolution_equivalents])?;
                taken += 1;
            }
            Ok(Step::Slides { direction, .. }) => known("direction", direction)?,
            Ok(_) => return Err("another outcome".to_owned()),
            Err(_) => {}
        }
        if taken == 0 && state(&contact) != before {
            return Err("a refused step changed the contact".to_owned());
        }
    }
    Ok(if taken > 0 { Outcome::Accepted } else { Outcome::Refused })
}
