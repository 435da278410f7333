//! Where the work of a load goes, against closed forms.

use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::EnergyBalance;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};

/// A ball pressed at once and held: its contact stays as it is, and the dashpot of every cell dissipates the energy that its spring loses.
pub fn held() -> Outcome {
    let [instant, relaxed, radius, depth] = [4.0e6, 1.0e6, 10.0e-3, 1.0e-4];
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 4.0e-3)?)
        .geometry(&Sphere::new(radius)?)
        .material(Material::incompressible(Zener::relaxing(instant, relaxed, 1.0)?))
        .settings(Settings::default().with_symmetry(true))
        .build()?;
    let mut balance = EnergyBalance::new(&contact)?;
    let report = contact.step(0.0, Load::approach(depth))?;
    balance.record(&contact, &report)?;
    for _ in 0..20 {
        let report = contact.step(0.05, Load::approach(depth))?;
        balance.record(&contact, &report)?;
    }
    let energies = balance.energies();
    // E* = 4 G of an incompressible body
    let work = 8.0 / 15.0 * 4.0 * instant * radius.sqrt() * depth.powf(2.5);
    let share = (1.0 - relaxed / instant) * (1.0 - (-2.0_f64).exp());
    let rows = [
        ("work [J]", energies.work, work, 1e-3),
        ("viscous part of the work after τ", energies.viscous / energies.work, share, 1e-6),
    ];
    Ok(Checked::new("energies of a sphere pressed at once and held", "Hertz 1881, a spring and a dashpot", &rows))
}

/// A ball that snaps onto an elastic body and is pulled off again, until the bodies are as they were.
pub fn loop_of_a_sticking_ball() -> Outcome {
    const STEPS: u32 = 240;
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 8.0)?)
        .geometry(&Sphere::new(1.0)?)
        .material(Material::incompressible(Elastic::new(0.25)?))
        .attraction(ExponentialAttraction::new(1.0, 0.5)?)
        .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(true))
        .build()?;
    let touch = contact.approach();
    let mut balance = EnergyBalance::new(&contact)?;
    for k in 0..=2 * STEPS {
        let course = 1.0 - (f64::from(k) / f64::from(STEPS) - 1.0).abs();
        let report = contact.step(1.0, Load::approach(touch - 3.0 + 3.2 * course))?;
        balance.record(&contact, &report)?;
    }
    // at the end the bodies are nearly apart
    let energies = balance.energies();
    let rows = [(
        "work less what is stored, over what is lost in jumps",
        (energies.work - energies.stored) / energies.lost,
        1.0,
        1e-3,
    )];
    Ok(Checked::new(
        "energies of a sphere that sticks and is pulled off, elastic, μ = 2",
        "conservation of energy",
        &rows,
    ))
}
