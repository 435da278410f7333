//! Creeping bodies against closed forms and other formulations.

use std::f64::consts::{PI, TAU};

use viscocontact::Result;
use viscocontact::analytic::{Hertz, HertzEllipse};
use viscocontact::plot::Legend;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};
use crate::elastic::{G, along_x1, between};
use crate::march::march;
use crate::rolling::RollingCylinder;
use crate::step_loaded_sphere::{StepLoadedSphere, errors};

pub fn step_loaded(scene: &StepLoadedSphere, name: &'static str) -> Outcome {
    let reference = scene.reference()?;
    let (contact, _) = scene.run(256, 100, Settings::default())?;
    let errors = errors(&contact, &reference);
    let t = contact.time();
    let half = 0.5 * contact.grid().lengths()[0];
    let line = between(-half, half).map(|x| (1e3 * x, 1e-3 * reference.pressure(x.abs(), t))).collect();
    let rows = [
        ("central pressure", 1.0 + errors.central_pressure, 1.0, 1e-4),
        ("approach", contact.approach(), reference.approach(t), 1e-4),
        ("contact radius", (contact.contact_area() / PI).sqrt(), reference.contact_radius(t), 3e-3),
    ];
    Ok(Checked::new(name, "Ting 1966; the source paper's Table 1", &rows).drawn(
        ["x1 [mm]", "pressure [kPa]"],
        Legend::LowerMiddle,
        line,
        along_x1(&contact),
    ))
}

/// While a contact grows, W = ∫ E(t − s) df, f the elastic force over E* of the ellipse that touches at s, as for the sphere (Lee &
/// Radok 1960). Under a step of W hence f = C(t) W: the ellipse is Hertz's with the compliance of the time, and ω and the area
/// follow C^(2/3).
pub fn step_loaded_ellipsoid() -> Outcome {
    let material = Material::incompressible(Maxwell::with_time(G, 1.0)?);
    let radii = [20.0e-3, 5.0e-3];
    let exact = |t: f64| HertzEllipse::new(radii, 1.0 / material.contact_compliance(t), 1.0);
    let [a1, a2] = exact(2.0)?.semi_axes;
    let mut contact = ViscoelasticContact::builder(Grid::new([192, 128], [2.25 * a1, 2.25 * a2])?)
        .geometry(&Ellipsoid::new(radii[0], radii[1])?)
        .material(material.clone())
        .build()?;
    contact.step(0.0, Load::force(1.0))?;
    let at_once = contact.approach();
    for _ in 0..50 {
        contact.step(0.04, Load::force(1.0))?;
    }
    let ratio = material.contact_compliance(2.0) / material.contact_compliance(0.0);
    let rows = [
        ("approach", contact.approach(), exact(2.0)?.approach, 1e-3),
        ("approach over its instantaneous value", contact.approach() / at_once, ratio.powf(2.0 / 3.0), 1e-3),
        ("contact area", contact.contact_area(), PI * a1 * a2, 5e-3),
    ];
    Ok(Checked::new(
        "step-loaded ellipsoid 4 : 1 on a Maxwell body, 192 × 128 cells",
        "Hertz 1882 with C(t), f = C W",
        &rows,
    ))
}

/// A flat face half lifted by its force: h = C K p − ω − α x1 on it, so that pressure and contact stay, and ω and α follow C(t)
/// (E. H. Lee, Q. Appl. Math. 13, 1955, p. 183: stresses that do not change with time).
pub fn opened_punch() -> Outcome {
    let material = Material::incompressible(Zener::with_time(G, 0.5 * G, 1.0)?);
    let mut contact = ViscoelasticContact::builder(Grid::square(96, 2.1e-3)?)
        .geometry(&FlatPunch::circular(1.0e-3)?)
        .material(material.clone())
        .build()?;
    let load = Load::eccentric_force(1.0, [0.6e-3, 0.0]);
    let state = |contact: &ViscoelasticContact| {
        [contact.approach(), contact.tilt()[0], contact.contact_area(), contact.fields().max_pressure()]
    };
    contact.step(0.0, load)?;
    let start = state(&contact);
    for _ in 0..50 {
        contact.step(0.04, load)?;
    }
    let end = state(&contact);
    let growth = material.contact_compliance(2.0) / material.contact_compliance(0.0);
    let rows = [
        ("approach over its instantaneous value", end[0] / start[0], growth, 1e-4),
        ("tilt over its instantaneous value", end[1] / start[1], growth, 1e-4),
        ("contact area over its instantaneous value", end[2] / start[2], 1.0, 1e-4),
        ("maximum pressure over its instantaneous value", end[3] / start[3], 1.0, 1e-4),
    ];
    Ok(Checked::new(
        "flat punch on a Zener body, force at 0.6 R, half open, held",
        "Lee 1955: p stays, u ∝ C(t)",
        &rows,
    ))
}

/// By what power of the step the error falls from 8 to 16 to 32 steps.
pub fn order() -> Outcome {
    let scene = StepLoadedSphere::maxwell();
    // the default rule does not yet show its order in so few steps
    let settings = Settings::default().with_tolerance(1e-9).with_time_rule(TimeRule::ExponentialLinear);
    let middle = |steps: usize| -> Result<f64> {
        let (contact, _) = scene.run(96, steps, settings)?;
        let [n1, n2] = contact.grid().cells();
        Ok(contact.pressure()[n1 / 2 * n2 + n2 / 2])
    };
    let [coarse, middle, fine] = [middle(8)?, middle(16)?, middle(32)?];
    let order = ((coarse - middle) / (middle - fine)).abs().log2();
    let rows = [("order in time, of the central pressure", order, 2.0, 0.05)];
    Ok(Checked::new("step-loaded sphere on a Maxwell body, 8, 16, 32 steps", "the order of the linear rule", &rows))
}

/// A body that creeps by the power law t^0.3 for five decades.
pub fn power_law() -> Outcome {
    let material = Material::constant_poisson(PowerLaw::new(1.0 / G, 1.0, 0.3)?, 0.4)?;
    // Hertz with the compliance of the time: a³ = ¾ R W C(t)
    let exact = Hertz::new(10.0e-3, 1.0 / material.contact_compliance(1.0e4), 1.0)?;
    let grid = Grid::square(128, 2.3 * exact.contact_radius)?;
    let mut contact = ViscoelasticContact::builder(grid)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(material)
        .times(1.0e-3..=1.0e4)
        .build()?;
    // a step of the load, twenty steps a decade from two decades before the first time that counts
    for k in 0..=140 {
        let t = 10_f64.powf(-3.0 + f64::from(k) / 20.0);
        contact.step(t - contact.time(), Load::force(1.0))?;
    }
    let rows = [("approach", contact.approach(), exact.approach, 2e-3)];
    Ok(Checked::new("sphere on a power law t^0.3, seven decades, 128² cells", "Lee & Radok 1960", &rows))
}

/// A polymer that softens a thousandfold in shear while its bulk stays elastic, at once and in the end.
pub fn elastic_bulk() -> Outcome {
    let (glassy, relaxed, bulk) = (1.0e9, 1.0e6, 3.0e9);
    let material = Material::elastic_bulk(GeneralizedMaxwell::new(relaxed, &[(glassy - relaxed, 1.0)])?, bulk)?;
    let hertz = |g: f64| (0.5 / g) * (1.0 - (3.0 * bulk - 2.0 * g) / (2.0 * (3.0 * bulk + g)));
    let approach = |g: f64| ((0.75 * hertz(g)).powi(2) / 10.0e-3).cbrt();
    let sphere = |g: f64| -> Result<ViscoelasticContact> {
        let grid = Grid::square(128, 2.3 * (0.75 * 10.0e-3 * hertz(g)).cbrt())?;
        ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(material.clone()).build()
    };
    let (mut at_once, mut at_last) = (sphere(glassy)?, sphere(relaxed)?);
    at_once.step(0.0, Load::force(1.0))?;
    at_last.step(1.0e9, Load::force(1.0))?;
    let rows = [
        ("instantaneous approach", at_once.approach(), approach(glassy), 1e-3),
        ("approach in the end", at_last.approach(), approach(relaxed), 1e-3),
    ];
    Ok(Checked::new("sphere, shear relaxing from 1 GPa to 1 MPa, bulk elastic", "Hertz 1882, ν of G and B", &rows))
}

/// A punch that oscillates: its force has the loss tangent of the body.
pub fn oscillating() -> Outcome {
    let (body, omega, steps) = (Zener::with_time(G, 0.5 * G, 1.0)?, 2.0, 128);
    let spectrum = body.creep_spectrum().ok_or("a Zener body has a spectrum")?;
    let complex = spectrum.complex_modulus(omega);
    let mut contact = ViscoelasticContact::builder(Grid::square(64, 2.1e-3)?)
        .geometry(&FlatPunch::circular(1.0e-3)?)
        .material(Material::incompressible(body))
        .build()?;
    let dt = TAU / omega / f64::from(steps);
    let (mut storage, mut loss, mut curve) = (0.0, 0.0, Vec::new());
    for k in 1..=12 * steps {
        let phase = TAU * f64::from(k) / f64::from(steps);
        contact.step(dt, Load::approach(1.0e-5 + 0.2e-5 * phase.sin()))?;
        if k > 11 * steps {
            storage += contact.force() * phase.sin();
            loss += contact.force() * phase.cos();
            curve.push((1e6 * contact.approach(), 1e3 * contact.force()));
        }
    }
    let mean = curve.iter().map(|(_, force)| force).sum::<f64>() / curve.len() as f64;
    let stiffness = 2.0 * 1e3 * storage.hypot(loss) / f64::from(steps);
    let (sine, cosine) = (complex.re / complex.norm(), complex.im / complex.norm());
    let exact =
        between(0.0, TAU).map(|x| (10.0 + 2.0 * x.sin(), mean + stiffness * (sine * x.sin() + cosine * x.cos())));
    let rows = [
        ("loss tangent", loss / storage, complex.im / complex.re, 2e-3),
        ("amplitude of the force", 1e-3 * stiffness, 2.0 * 1.0e-3 * 4.0 * complex.norm() * 0.2e-5, 1e-2),
    ];
    Ok(Checked::new("flat punch that oscillates on a Zener body, ω τ = 1", "complex modulus", &rows).drawn(
        ["approach [µm]", "force [mN]"],
        Legend::UpperLeft,
        exact.collect(),
        curve,
    ))
}

pub fn loaded_and_unloaded() -> Outcome {
    let material = Material::constant_poisson(Zener::with_time(G, 0.5 * G, 1.0)?, 0.3)?;
    let corners = [(0.0, 0.0), (1.0, 1.0), (1.6, 0.4)].map(|(t, force)| (t, Load::force(force)));
    let history = PiecewiseLinear::new(&corners)?;
    let widest = (0.75 * 10.0e-3 * material.contact_compliance(1e3)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 2.1 * widest)?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(material.clone())
        .build()?;
    let mut run = contact.follow(&history, Stepping::fixed(0.02), 1.6);
    let mut computed = Vec::new();
    while let Some(report) = run.next_step()? {
        computed.push((1e6 * report.approach, report.force));
    }
    let mut exact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &material)?;
    let mut line = Vec::new();
    for k in 1..=1600 {
        let t = 1e-3 * f64::from(k);
        exact.step(1e-3, Load::force(if t <= 1.0 { t } else { 1.0 - (t - 1.0) }))?;
        line.push((1e6 * exact.approach(), exact.force()));
    }
    let rows = [
        ("approach", contact.approach(), exact.approach(), 1e-3),
        ("contact radius", (contact.contact_area() / PI).sqrt(), (exact.contact_area() / PI).sqrt(), 1e-2),
    ];
    Ok(Checked::new(
        "sphere on a Zener body, up and down, 128² cells",
        "method of dimensionality reduction (Popov & Heß)",
        &rows,
    )
    .drawn(["approach [µm]", "force [N]"], Legend::UpperLeft, line, computed))
}

pub fn relaxing() -> Outcome {
    // at a constant approach the force follows the relaxation modulus
    let tau = 1.0;
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 4.0e-3)?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Maxwell::with_time(G, tau)?))
        .build()?;
    contact.step(0.0, Load::approach(1.0e-4))?;
    let start = contact.force();
    for _ in 0..50 {
        contact.step(0.04, Load::approach(1.0e-4))?;
    }
    let rows = [("force after 2 τ over its instantaneous value", contact.force() / start, (-2.0_f64).exp(), 1e-4)];
    Ok(Checked::new("sphere held at its approach on a Maxwell body", "Lee & Radok 1960", &rows))
}

pub fn rolling() -> Outcome {
    let mut scene = RollingCylinder { radius: 0.02, per_length: 500.0, glassy: 0.25 / G, delayed: 0.5 / G, reach: 1.0 };
    let (glassy, relaxed) = (scene.hertz(scene.glassy).0, scene.hertz(scene.glassy + scene.delayed).0);
    scene.reach = 2.0 * glassy;
    let (side, exact) = (glassy / 32.0, scene.steady(500));
    let cells = ((10.0 * scene.reach + 3.0 * relaxed) / side) as usize;
    let grid = Grid::new([cells, 1], [cells as f64 * side, 1.0])?;
    let cylinder = Shifted::new(Cylinder::new(scene.radius)?, [0.5 * grid.lengths()[0] - 2.0 * relaxed, 0.0])?;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&cylinder)
        .material(Material::incompressible(Zener::with_time(G, 0.5 * G, 1.0)?))
        .kernel(InfluenceKernel::line(&grid, 1.0e3)?)
        .settings(Settings::default().with_frame(Frame::Indenter))
        .build()?;
    let load = Load::force(scene.per_length);
    march(&mut contact, Axis::X1, scene.reach, load, (grid.lengths()[0], 2e-4))?;
    let [behind, ahead] = exact.ends();
    let friction = contact.fields().slope_force(&cylinder)[0] / contact.force();
    let axis = 1e3 * (0.5 * grid.lengths()[0] - 2.0 * relaxed);
    let line = exact.positions.iter().zip(&exact.pressure).map(|(x, p)| (1e3 * x, 1e-3 * p)).collect();
    let dots = along_x1(&contact).into_iter().map(|(x, p)| (x - axis, p));
    let dots = dots.filter(|(x, _)| x.abs() < 1e3 * 1.5 * relaxed).collect();
    let rows = [
        ("maximum pressure", contact.fields().max_pressure(), exact.peak(), 1e-2),
        ("contact width", contact.contact_area(), ahead - behind, 1e-2),
        ("hysteretic friction", friction, exact.friction(scene.radius), 2e-2),
    ];
    Ok(Checked::new(
        "cylinder rolling on a Zener body, v τ = 2 a",
        "steady state without steps (exponential integrals)",
        &rows,
    )
    .drawn(["x1 [mm]", "pressure [kPa]"], Legend::UpperLeft, line, dots))
}
