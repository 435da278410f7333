//! Random scenes of elastic contacts, of friction in space and on elastic states, and of several bodies along histories:
//! `tests/test_more_scenes.py` computes the same in Python.

use viscocontact::elastic::ElasticContact;
use viscocontact::friction::{Component, Coulomb, FrictionContact, FrictionLimit, Lesser, Outcome, ShearLoad, Tresca};
use viscocontact::load::LoadHistory;
use viscocontact::prelude::*;

use crate::{Draw, rheology, shape};

type Bits = viscocontact::Result<Vec<f64>>;

/// What a scene of a kind comes to; `None` of a kind that there is not.
pub fn scene_of(kind: &str) -> Option<fn(&mut Draw) -> Bits> {
    Some(match kind {
        "elastic" => elastic,
        "friction" => friction,
        "sheared" => sheared,
        "several" => several,
        _ => return None,
    })
}

fn grid(draw: &mut Draw) -> viscocontact::Result<Grid> {
    let cells = [12 + draw.below(9), 12 + draw.below(9)];
    Grid::new(cells, [draw.within(3e-3, 5e-3), draw.within(3e-3, 5e-3)])
}

fn load(draw: &mut Draw) -> Load {
    match draw.below(3) {
        0 => Load::force(draw.within(1e-3, 0.1)),
        1 => Load::approach(draw.within(1e-6, 3e-5)),
        _ => Load::spring(draw.within(1e3, 1e4), draw.within(1e-6, 5e-5)),
    }
}

fn elastic(draw: &mut Draw) -> Bits {
    let (grid, shape, modulus) = (grid(draw)?, shape(draw)?, draw.within(1e6, 1e7));
    let kernel =
        if draw.below(2) == 0 { InfluenceKernel::half_space(&grid)? } else { InfluenceKernel::periodic(&grid)? };
    let settings = Settings::default().with_edge(viscocontact::contact::Edge::Allow);
    let builder = ElasticContact::builder(grid).geometry(&shape).modulus(modulus).kernel(kernel).settings(settings);
    let (mut contact, mut all) = (builder.build()?, Vec::new());
    for _ in 0..3 {
        contact.solve(load(draw))?;
        let fields = contact.fields();
        all.extend([fields.force(), fields.approach(), fields.contact_area()]);
        all.extend(fields.pressure().iter().chain(fields.displacement()));
        all.extend(fields.approach_gradient()?);
    }
    Ok(all)
}

/// A limit that is no model of the crate.
#[derive(Debug)]
struct Own;

impl FrictionLimit for Own {
    fn limit(&self, pressure: f64) -> f64 {
        0.3 * pressure + 1e3
    }
}

fn friction(draw: &mut Draw) -> Bits {
    let pad = ViscoelasticContact::builder(grid(draw)?)
        .geometry(&shape(draw)?)
        .material(Material::incompressible(rheology(draw)?))
        .settings(Settings::default().with_edge(viscocontact::contact::Edge::Allow));
    let (f, strength) = (draw.within(0.1, 1.0), draw.within(1e3, 1e5));
    let mut contact = match draw.below(4) {
        0 => FrictionContact::new(pad, Coulomb::new(f)?),
        1 => FrictionContact::new(pad, Tresca::new(strength)?),
        2 => FrictionContact::new(pad, Lesser(Coulomb::new(f)?, Tresca::new(strength)?)),
        _ => FrictionContact::new(pad, Own),
    }?;
    let _ = contact.step(0.0, Load::force(draw.within(1e-2, 0.1)), ShearLoad::force([0.0; 2]))?;
    let mut all = Vec::new();
    for _ in 0..3 {
        let (dt, normal) = (draw.within(0.01, 1.0), draw.within(1e-2, 0.1));
        let components = [0, 1, 2].map(|axis| {
            let (force, motion) = if axis < 2 { (1e-2, 2e-6) } else { (1e-6, 1e-3) };
            if draw.below(2) == 0 {
                Component::Force(draw.within(-force, force))
            } else {
                Component::Motion(draw.within(-motion, motion))
            }
        });
        match contact.step(dt, Load::force(normal), ShearLoad { components })? {
            Outcome::Slides { direction, over_limit } => all.extend(direction.iter().chain([&over_limit])),
            Outcome::Holds(report) => all.extend([report.residual, report.convolution_equivalents]),
            _ => {}
        }
        let of = contact.lateral_work();
        let work = [of.work, of.slip, of.stored, of.creep];
        all.extend(contact.motion().iter().chain(&contact.force()).chain(&work));
        all.extend([contact.traction(), contact.slip()].iter().flatten().flatten());
        all.extend(contact.sticks().iter().map(|sticks| f64::from(u8::from(*sticks))));
        all.extend(contact.normal().pressure());
    }
    Ok(all)
}

fn sheared(draw: &mut Draw) -> Bits {
    let is_swept = draw.below(2) == 0;
    let states = if is_swept {
        let (grid, shape) = (Grid::square(16, 5e-3)?, Sphere::new(draw.within(5e-3, 20e-3))?);
        Sweep::new(grid, &shape).accuracy(1e-3).keep_pressures().run(Reach::Level(5e-7))?
    } else {
        ElasticStates::sphere(draw.within(5e-3, 20e-3))?
    };
    let material = Material::constant_poisson(rheology(draw)?, draw.within(0.1, 0.49))?;
    let friction = draw.within(0.1, 1.0);
    let mut contact = StatesContact::new(&states, &material)?.with_estimated_friction(friction)?;
    if draw.below(2) == 0 {
        let moved = Ramp::new(Load::approach(0.0), Load::approach(draw.within(-2e-6, 2e-6)), 1.0)?;
        contact = contact.sheared_by(moved)?;
        let (held, until) = (StepLoad::new(Load::force(draw.within(1e-3, 1e-2)))?, draw.within(0.5, 2.0));
        let mut run = contact.follow(&held, Stepping::adaptive(1e-2), until);
        while run.next_step()?.is_some() {}
    } else {
        contact.step(0.0, Load::force(5e-3))?;
        for _ in 0..4 {
            let (dt, normal) = (draw.within(0.01, 1.0), draw.within(1e-3, 1e-2));
            let along = match draw.below(3) {
                0 => Load::force(draw.within(-5e-3, 5e-3)),
                1 => Load::approach(draw.within(-1e-6, 1e-6)),
                _ => Load::spring(draw.within(1e3, 1e4), draw.within(-1e-5, 1e-5)),
            };
            match contact.step_sheared(dt, Load::force(normal), along) {
                Err(Error::Slides { .. }) => {}
                other => drop(other?),
            }
        }
    }
    let work = contact.lateral_work();
    let mut all = vec![contact.lateral_force(), contact.lateral_displacement(), contact.slid(), contact.stick_level()];
    all.extend([contact.stick_area(), work.work, work.slip, work.stored, work.creep]);
    all.extend(contact.shear_tractions().flat_map(|(level, traction)| [level, traction]));
    if is_swept {
        all.extend(contact.shear()?);
        all.extend(contact.approach_gradient()?);
    }
    Ok(all)
}

fn several(draw: &mut Draw) -> Bits {
    let ball = |draw: &mut Draw, x1: f64| Shifted::new(Sphere::new(draw.within(5e-3, 20e-3))?, [x1, 0.0]);
    let (one, other) = (ball(draw, -1e-3)?, ball(draw, 1e-3)?);
    let mut contact = ViscoelasticContact::builder(Grid::new([32, 16], [4e-3, 2e-3])?)
        .geometry(&one)
        .another_body(&other)
        .material(Material::incompressible(rheology(draw)?))
        .settings(Settings::default().with_edge(viscocontact::contact::Edge::Allow))
        .build()?;
    let held = StepLoad::new(load(draw))?;
    let pressed = Ramp::new(Load::force(0.0), Load::force(draw.within(1e-3, 0.1)), draw.within(0.1, 1.0))?;
    let histories: [&dyn LoadHistory; 2] = [&held, &pressed];
    let mut run = contact.follow_each(&histories, Stepping::adaptive(1e-2), 1.5)?;
    while run.next_step()?.is_some() {}
    let fields = contact.fields();
    let bodies = (0..2).filter_map(|body| fields.body(body)).flat_map(|body| [body.force, body.approach]);
    Ok(bodies.chain(fields.pressure().iter().copied()).collect())
}
