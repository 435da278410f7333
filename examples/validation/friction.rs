//! Friction against closed forms and another program.

use viscocontact::Result;
use viscocontact::analytic::{CattaneoMindlin, Hertz, LubkinTorsion};
use viscocontact::friction::{Coulomb, FrictionContact, ShearLoad};
use viscocontact::plot::Legend;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};

const FORCE: f64 = 1.0;
const FRICTION: f64 = 0.5;

/// Two bodies of ν = 0, whose contact modulus is their shear modulus.
fn pair(rheology: impl Fn() -> Result<Box<dyn Rheology>>) -> Result<Material> {
    let body = || Material::constant_poisson(rheology()?, 0.0);
    Ok(body()?.against(body()?))
}

/// Cattaneo and Mindlin: loading, unloading, loading again, and what a cycle dissipates.
pub fn ball() -> Outcome {
    let (radius, modulus) = (10.0e-3, 4.0e6);
    let hertz = Hertz::new(radius, modulus, FORCE)?;
    let exact = CattaneoMindlin::new(&hertz, FORCE, FRICTION, 1.0)?;
    let body = pair(|| Ok(Box::new(Elastic::new(modulus)?)))?;
    let mut contact = StatesContact::new(&ElasticStates::sphere(radius)?, &body)?.with_friction(FRICTION)?;
    contact.step_sheared(0.0, Load::force(FORCE), Load::force(0.0))?;
    let most = 0.8 * exact.limit;
    let move_to = |contact: &mut StatesContact, force: f64| -> Result<f64> {
        contact.step_sheared(0.0, Load::force(FORCE), Load::force(force))?;
        Ok(contact.lateral_displacement())
    };
    let loaded = move_to(&mut contact, most)?;
    let stick = (contact.stick_area() / std::f64::consts::PI).sqrt();
    let unloaded = move_to(&mut contact, -0.3 * exact.limit)?;
    let again = move_to(&mut contact, 0.5 * exact.limit)?;
    // in small steps, since the work of a step is that of a straight path
    let (mut curve, mut before) = (Vec::new(), 0.0);
    for k in 0..=8000 {
        let phase = std::f64::consts::TAU * f64::from(k) / 4000.0;
        let d = move_to(&mut contact, most * phase.cos())?;
        if k == 4000 {
            before = contact.lateral_work().slip;
        }
        if k >= 4000 {
            curve.push((1e6 * d, contact.lateral_force()));
        }
    }
    let loss = contact.lateral_work().slip - before;
    let branch = |from: f64, to: f64| {
        (0..=200).map(move |k| {
            let force = from + (to - from) * f64::from(k) / 200.0;
            let turns = if from > 0.0 { vec![most, force] } else { vec![most, -most, force] };
            (1e6 * exact.displacement(&turns), force)
        })
    };
    let rows = [
        ("displacement at 0.8 f P", loaded, exact.displacement(&[most]), 1e-9),
        ("radius that sticks", stick, exact.stick_radius(most), 1e-9),
        ("displacement back at −0.3 f P", unloaded, exact.displacement(&[most, -0.3 * exact.limit]), 1e-9),
        (
            "displacement again at 0.5 f P",
            again,
            exact.displacement(&[most, -0.3 * exact.limit, 0.5 * exact.limit]),
            1e-9,
        ),
        ("loss of a cycle of 4000 steps", loss, exact.loss(most), 1e-4),
    ];
    let checked = Checked::new("sphere on elastic states, sheared", "Cattaneo 1938, Mindlin 1949", &rows);
    let branches = branch(most, -most).chain(branch(-most, most)).collect();
    Ok(checked.drawn(["displacement [µm]", "force along the surface [N]"], Legend::UpperLeft, branches, curve))
}

/// A punch, whose contact does not change, sheared by a force that rises: by correspondence, the elastic displacement
/// creeps. All of it sticks, d = 1/(2a) ∫ C dQ, with C = 4 − 3 e^(−t/4) over E.
pub fn punch() -> Outcome {
    let (radius, modulus) = (1.0e-3, 1.0e6);
    let body = pair(|| Ok(Box::new(GeneralizedMaxwell::new(0.25 * modulus, &[(0.75 * modulus, 1.0)])?)))?;
    let mut contact = StatesContact::new(&ElasticStates::punch(radius)?, &body)?.with_friction(FRICTION)?;
    let until = 4.0;
    contact.step_sheared(0.0, Load::force(FORCE), Load::force(0.0))?;
    for k in 1..=4000 {
        let part = f64::from(k) / 4000.0;
        contact.step_sheared(until / 4000.0, Load::force(FORCE), Load::force(0.3 * FORCE * part))?;
    }
    // ∫₀ᵗ C(t − s) ds = 4 t − 12 (1 − e^(−t/4))
    let compliance = (4.0 * until - 12.0 * (1.0 - (-0.25 * until).exp())) / modulus;
    let exact = 0.3 * FORCE / until * compliance / (2.0 * radius);
    let rows = [("displacement after 4 τ", contact.lateral_displacement(), exact, 1e-6)];
    Ok(Checked::new("punch on creeping elastic states, sheared", "correspondence", &rows))
}

/// A sphere that is pressed and sheared in proportion, Q = 0.2 P, and creeps: d = 0.2 δ.
pub fn oblique() -> Outcome {
    let body = pair(|| Ok(Box::new(GeneralizedMaxwell::new(0.25e6, &[(0.75e6, 1.0)])?)))?;
    let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &body)?.with_friction(FRICTION)?;
    for k in 0..=400 {
        let force = FORCE * f64::from(k.min(100)) / 100.0;
        let dt = if k == 0 { 0.0 } else { 0.01 };
        contact.step_sheared(dt, Load::force(force), Load::force(0.2 * force))?;
    }
    let rows = [
        ("displacement after 4 τ", contact.lateral_displacement(), 0.2 * contact.approach(), 1e-9),
        ("area that sticks", contact.stick_area(), contact.contact_area(), 1e-12),
    ];
    Ok(Checked::new("sphere on creeping elastic states, oblique load", "τ = 0.2 p", &rows))
}

/// A sphere on cells, sheared by 0.875 f P: CONTACT's example `cattaneo`.
pub fn contact_example() -> Outcome {
    let (grid, force, friction) = (Grid::square(19, 19.0 * 0.133_333_3)?, 9.195, 0.4);
    let body = || Material::constant_poisson(Elastic::new(200.0)?, 0.42);
    let shape = FnGeometry::new(|x, y| 0.01 * (x * x + y * y));
    let settings = Settings::default().with_tolerance(1e-10).with_edge(Edge::Allow);
    let scene = ViscoelasticContact::builder(grid.clone()).geometry(&shape).settings(settings);
    let mut contact = FrictionContact::new(scene.material(body()?.against(body()?)), Coulomb::new(friction)?)?;
    for share in [0.0, 0.875] {
        let _ = contact.step(0.0, Load::force(force), ShearLoad::force([share * friction * force, 0.0]))?;
    }
    let at = (0..grid.len()).find(|k| {
        let [x, y] = grid.center(k / 19, k % 19);
        x.abs() < 1e-9 && (y + 0.9333).abs() < 1e-3
    });
    let traction = at.map_or(f64::NAN, |k| contact.traction()[0][k].hypot(contact.traction()[1][k]));
    let slips = contact.normal().contact_cells() - contact.stick_cells();
    let rows = [
        ("shift", contact.motion()[0], 8.155e-3, 1e-4),
        ("cells that stick", contact.stick_cells() as f64, 45.0, 0.0),
        ("cells that slip", slips as f64, 132.0, 0.0),
        ("traction at y = −0.9333", traction, 0.575, 1e-3),
    ];
    Ok(Checked::new("sphere on 19² cells, ν = 0.42, sheared", "CONTACT (Vollebregt), example cattaneo", &rows))
}

/// A sphere on cells, twisted to half of what friction carries.
pub fn torsion() -> Outcome {
    let (radius, nu, cells) = (10.0, 0.3, 96);
    let hertz = Hertz::new(radius, 1.0 / (1.0 - nu), 4.0 / 3.0 / (1.0 - nu) / radius)?;
    let force = 4.0 / 3.0 / (1.0 - nu) / radius;
    let body = || Material::constant_poisson(Elastic::new(1.0)?, nu);
    let shape = FnGeometry::new(move |x, y| 0.5 * (x * x + y * y) / radius);
    let scene = ViscoelasticContact::builder(Grid::square(cells, 2.4)?).geometry(&shape);
    let mut contact = FrictionContact::new(scene.material(body()?.against(body()?)), Coulomb::new(FRICTION)?)?;
    // two bodies turn as one of half the modulus
    let exact = LubkinTorsion::new([FRICTION * hertz.max_pressure, 0.5], hertz.contact_radius, 0.813_568_13)?;
    for torque in [0.0, exact.moment] {
        let _ = contact.step(0.0, Load::force(force), ShearLoad::force([0.0; 2]).with_torque(torque))?;
    }
    let rows = [("angle at half of the limit", contact.motion()[2], exact.angle, 2e-3)];
    Ok(Checked::new("sphere on 96² cells, ν = 0.3, twisted", "Lubkin 1951", &rows))
}
