//! Numbers that others have published: of another program, of an expansion, of a table.

use viscocontact::Result;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};
use crate::layers::press;

/// Two cylinders of polyamide that roll at 1 m/s (G. Wang & K. Knothe, J. Appl. Mech. 60, 1993), to the printed digits of CONTACT's example `visc_cylindr`.
pub fn rolling_polyamide() -> Outcome {
    let (shear, side) = (0.5 * 1143.0e6, 24.0e-3);
    let grid = Grid::new([512, 1], [side, 1.0])?;
    let peak = |time: f64| -> Result<f64> {
        let mut sliding = ViscoelasticContact::builder(grid.clone())
            .geometry(&Cylinder::new(0.05)?)
            .material(Material::constant_poisson(Zener::with_time(shear, shear, time)?, 0.4)?)
            .kernel(InfluenceKernel::line(&grid, 1.0e3)?)
            .build_sliding()?;
        sliding.at([1.0, 0.0], Load::force(600.0e3))?;
        Ok(1e-6 * sliding.fields().pressure().iter().copied().fold(0.0, f64::max))
    };
    let rows = [
        // a time far below that of a passage in place of 0
        ("maximum pressure [MPa], relaxed", peak(1e-7)?, 60.32, 2e-4),
        ("maximum pressure [MPa], τ = 9 ms", peak(9e-3)?, 78.74, 2e-4),
        ("maximum pressure [MPa], τ = 45 ms", peak(45e-3)?, 84.72, 2e-4),
        ("maximum pressure [MPa], τ = 2 s", peak(2.0)?, 85.31, 2e-4),
    ];
    Ok(Checked::new("cylinders that roll, 512 cells", "Wang & Knothe 1993; CONTACT, example visc_cylindr", &rows))
}

/// A ball that rebounds from a Kelvin–Voigt body of little damping: with x = (3/2) τ (k/m)^(2/5) v^(1/5), F = k δ^(3/2) of the elastic body, the coefficient of
/// restitution is e = 1 − C₁ x + …, C₁ = 1.15344 (R. Ramírez, T. Pöschel, N. V. Brilliantov, T. Schwager, Phys. Rev. E 60, 1999, 4465). In the next term
/// their ball sticks at the edge until δ = 0, so that C₁ is extrapolated from two times τ.
pub fn rebound() -> Outcome {
    let (radius, modulus, mass, speed) = (10.0e-3_f64, 4.0e6, 0.03, 0.5_f64);
    let stiffness = 4.0 / 3.0 * modulus * radius.sqrt();
    let states = ElasticStates::sphere(radius)?;
    // a six-thousandth of the time of the contact
    let dt = 0.5e-3 * (1.25 * mass / stiffness).powf(0.4) * speed.powf(-0.2);
    let lost = |time: f64| -> Result<f64> {
        let body = Material::incompressible(KelvinVoigt::with_time(0.25 * modulus, time)?);
        let mut contact = StatesContact::new(&states, &body)?;
        let (mut depth, mut velocity, mut force) = (0.0, speed, 0.0);
        while force > 0.0 || velocity > 0.0 {
            let half = velocity - 0.5 * dt * force / mass;
            depth += dt * half;
            force = contact.step(dt, Load::approach(depth))?.force;
            velocity = half - 0.5 * dt * force / mass;
        }
        Ok((1.0 + velocity / speed) / (1.5 * time * (stiffness / mass).powf(0.4) * speed.powf(0.2)))
    };
    let rows = [("C₁ of the coefficient of restitution", 2.0 * lost(5e-6)? - lost(1e-5)?, 1.153_44, 2e-4)];
    Ok(Checked::new("ball that rebounds, elastic states", "Ramírez et al. 1999", &rows))
}

/// The table of W. C. Hayes, L. M. Keer, G. Herrmann, L. F. Mockros (J. Biomech. 5, 1972, 541) for a flat punch on cartilage that is bonded to bone, ν = 0.45.
pub fn cartilage() -> Outcome {
    let radius = 1.0e-3;
    let value = |over_thickness: f64| -> Result<f64> {
        let force = press(&FlatPunch::circular(radius)?, radius / over_thickness, 0.45, (256, 2.04 * radius), 1.0e-6)?;
        Ok(force / (2.0 * radius * 1.0e-6))
    };
    let rows = [
        ("force over the half-space's, a/h = 0.2", value(0.2)?, 1.252, 5e-3),
        ("force over the half-space's, a/h = 0.6", value(0.6)?, 2.031, 5e-3),
        ("force over the half-space's, a/h = 1", value(1.0)?, 3.085, 5e-3),
    ];
    Ok(Checked::new("flat punch on a bonded layer, ν = 0.45, 256² cells", "Hayes et al. 1972", &rows))
}
