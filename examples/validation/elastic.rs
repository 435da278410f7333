//! Elastic bodies against closed forms.

use std::f64::consts::PI;

use viscocontact::Result;
use viscocontact::analytic::{Hertz, HertzEllipse, RigidPunch};
use viscocontact::observe::Stress;
use viscocontact::plot::Legend;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};

pub const G: f64 = 1.0e6;
const E_STAR: f64 = 4.0 * G;

fn elastic() -> Material {
    Material::incompressible(Elastic::new(G).expect("a modulus"))
}

fn pressed(grid: Grid, shape: &dyn Geometry, load: Load) -> Result<ViscoelasticContact> {
    let mut contact = ViscoelasticContact::builder(grid).geometry(shape).material(elastic()).build()?;
    contact.step(0.0, load)?;
    Ok(contact)
}

/// The pressure along x1 next to x2 = 0: distance \[mm\] and pressure \[kPa\].
pub fn along_x1(contact: &ViscoelasticContact) -> Vec<(f64, f64)> {
    let (grid, [n1, n2]) = (contact.grid(), contact.grid().cells());
    (0..n1).map(|i| (1e3 * grid.center(i, 0)[0], 1e-3 * contact.pressure()[i * n2 + n2 / 2])).collect()
}

/// So many numbers from `low` to `high`.
pub fn between(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..=400).map(move |k| low + (high - low) * f64::from(k) / 400.0)
}

/// Displacement of a square under a uniform pressure, in its middle and in the corner of the grid.
pub fn convolution() -> Outcome {
    let (cells, side) = (96, 1.0e-5);
    let grid = Grid::square(cells, cells as f64 * side)?;
    let kernel = InfluenceKernel::half_space(&grid)?;
    let (mut pressure, mut displacement) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
    let middle = (cells / 2) * (cells + 1);
    pressure[middle] = 1.0;
    kernel.convolve(&pressure, &mut displacement, &mut kernel.workspace()?)?;
    let itself = displacement[middle];
    // Love's closed form, from the corner [0, 0]: the square's own corners are so far away
    let [near, far] = [cells as f64 / 2.0 - 0.5, cells as f64 / 2.0 + 0.5].map(|x| x * side);
    let corner = |x: f64, y: f64| x * (y / x).asinh() + y * (x / y).asinh();
    let distant = corner(far, far) - corner(near, far) - corner(far, near) + corner(near, near);
    let rows = [
        ("its own displacement", itself, 4.0 * side * 1.0_f64.asinh() / PI, 1e-12),
        ("displacement 67 cells away", displacement[0], distant / PI, 1e-9),
    ];
    Ok(Checked::new("one cell of 96² under pressure, by FFT", "Love 1929", &rows))
}

pub fn hertz() -> Outcome {
    let exact = Hertz::new(10.0e-3, E_STAR, 1.0)?;
    let grid = Grid::square(256, 2.6 * exact.contact_radius)?;
    let contact = pressed(grid, &Sphere::new(10.0e-3)?, Load::force(1.0))?;
    let rows = [
        ("approach", contact.approach(), exact.approach, 1e-4),
        ("maximum pressure", contact.fields().max_pressure(), exact.max_pressure, 1e-3),
        ("contact area", contact.contact_area(), PI * exact.contact_radius.powi(2), 2e-3),
        ("stiffness over E*", contact.fields().stiffness_over_modulus()?, 2.0 * exact.contact_radius, 5e-3),
    ];
    Ok(Checked::new("sphere, 256² cells", "Hertz 1882", &rows))
}

/// Where a ball on a body of ν = ½ would yield first (von Mises).
pub fn stress_below_a_ball() -> Outcome {
    let exact = Hertz::new(10.0e-3, E_STAR, 1.0)?;
    let a = exact.contact_radius;
    let contact = pressed(Grid::square(256, 2.6 * a)?, &Sphere::new(10.0e-3)?, Load::force(1.0))?;
    let stress = contact.fields().stress()?;
    let depths: Vec<f64> = (1..=12).map(|k| 0.1 * f64::from(k) * a).collect();
    let peak = stress.maximum(&depths, Stress::von_mises)?;
    let normal = stress.at(&[[0.0, 0.0, 2.0 * a]])?[0].s33;
    let rows = [
        ("maximum von Mises stress", peak.value, 0.532_697 * exact.max_pressure, 1e-3),
        ("its depth", peak.position[2], 0.547_87 * a, 2e-3),
        ("σ33 on the axis at z = 2 a", normal, -0.2 * exact.max_pressure, 1e-3),
    ];
    Ok(Checked::new("stress below a sphere, 256² cells", "Hertz; Johnson 1985, 3.45", &rows))
}

pub fn hertz_ellipse() -> Outcome {
    let exact = HertzEllipse::new([20.0e-3, 5.0e-3], E_STAR, 1.0)?;
    let [a1, a2] = exact.semi_axes;
    let grid = Grid::new([192, 128], [2.5 * a1, 2.5 * a2])?;
    let contact = pressed(grid, &Ellipsoid::new(20.0e-3, 5.0e-3)?, Load::force(1.0))?;
    let rows = [
        ("approach", contact.approach(), exact.approach, 2e-4),
        ("maximum pressure", contact.fields().max_pressure(), exact.max_pressure, 4e-4),
        ("contact area", contact.contact_area(), PI * a1 * a2, 5e-3),
    ];
    Ok(Checked::new("ellipsoid 4 : 1, 192 × 128 cells", "Hertz 1882", &rows))
}

pub fn punch() -> Outcome {
    let exact = RigidPunch::new(1.0e-3, E_STAR, 1.0, 0.3e-3)?;
    let contact =
        pressed(Grid::square(256, 2.1e-3)?, &FlatPunch::circular(1.0e-3)?, Load::eccentric_force(1.0, [0.3e-3, 0.0]))?;
    // within the last cell the closed form is infinite
    let line = between(-0.99e-3, 0.99e-3).map(|x| (1e3 * x, 1e-3 * exact.pressure(x, 0.0))).collect();
    let rows = [("approach", contact.approach(), exact.approach, 1e-2), ("tilt", contact.tilt()[0], exact.tilt, 1e-2)];
    Ok(Checked::new("flat punch, force at 0.3 R, 256² cells", "Lur'e 1964", &rows).drawn(
        ["x1 [mm]", "pressure [kPa]"],
        Legend::UpperMiddle,
        line,
        along_x1(&contact),
    ))
}

pub fn wavy() -> Outcome {
    let (wavelength, amplitude, share) = (1.0e-3, 1.0e-6, 0.4_f64);
    let grid = Grid::new([512, 1], [wavelength, 1.0])?;
    let mean = share * PI * E_STAR * amplitude / wavelength;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&Wavy::new(amplitude, wavelength)?)
        .material(elastic())
        .kernel(InfluenceKernel::periodic(&grid)?)
        .build()?;
    contact.step(0.0, Load::force(mean * wavelength))?;
    let line = between(-0.5 * wavelength, 0.5 * wavelength).map(|x| {
        let (c, s) = ((PI * x / wavelength).cos(), (PI * x / wavelength).sin());
        (1e3 * x, 1e-3 * 2.0 * mean * c / share * (share - s * s).max(0.0).sqrt())
    });
    let rows = [
        ("maximum pressure", contact.fields().max_pressure(), 2.0 * mean / share.sqrt(), 5e-3),
        ("contact width", contact.contact_area(), 2.0 * share.sqrt().asin() / PI * wavelength, 5e-3),
    ];
    Ok(Checked::new("wavy surface, periodic, plane strain, 512 cells", "Westergaard 1939", &rows).drawn(
        ["x1 [mm]", "pressure [kPa]"],
        Legend::UpperLeft,
        line.collect(),
        along_x1(&contact),
    ))
}

pub fn line() -> Outcome {
    let (radius, per_length) = (0.02, 500.0);
    let half_width = (4.0 * per_length * radius / (PI * E_STAR)).sqrt();
    let grid = Grid::new([512, 1], [4.0 * half_width, 1.0])?;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&Cylinder::new(radius)?)
        .material(elastic())
        .kernel(InfluenceKernel::line(&grid, 1.0)?)
        .build()?;
    contact.step(0.0, Load::force(per_length))?;
    let approach = per_length / (PI * E_STAR) * (2.0 * (2.0 / half_width).ln() + 1.0);
    let rows = [
        ("half-width", 0.5 * contact.contact_area(), half_width, 5e-3),
        ("maximum pressure", contact.fields().max_pressure(), 2.0 * per_length / (PI * half_width), 1e-3),
        ("approach to a datum", contact.approach(), approach, 1e-3),
    ];
    Ok(Checked::new("cylinder in line contact, 512 cells", "Hertz; Johnson 1985, 4.2 and 5.6", &rows))
}
