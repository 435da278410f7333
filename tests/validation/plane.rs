//! Contacts in plane strain against Westergaard's closed form; Hertz's line contact is in `elastic` and in docs/validation.md.

use crate::common::{E_STAR, builder_of, elastic};
use approx::assert_abs_diff_eq;
use std::f64::consts::PI;

use viscocontact::prelude::*;

fn contact(grid: &Grid, kernel: InfluenceKernel, shape: &dyn Geometry, settings: Settings) -> ViscoelasticContact {
    builder_of(shape, grid.clone(), elastic()).kernel(kernel).settings(settings).build().unwrap()
}

/// A wavy surface under less than the pressure of full contact, against H. M. Westergaard, J. Appl. Mech. 6 (1939):
/// p = 2 p̄ cos(πx/λ) √(sin²(πa/λ) − sin²(πx/λ)) / sin²(πa/λ), where p̄ = π E* Δ/λ sin²(πa/λ).
#[test]
fn a_wavy_surface_in_partial_contact_is_westergaards() {
    let (wavelength, amplitude, cells) = (1.0e-3, 1.0e-6, 512);
    let grid = Grid::new([cells, 1], [wavelength, 1.0]).unwrap();
    let shape = FnGeometry::new(move |x1, _| amplitude * (1.0 - (2.0 * PI * x1 / wavelength).cos()));
    for share in [0.1_f64, 0.3, 0.6, 0.9] {
        for symmetry in [true, false] {
            let settings = Settings::default().with_symmetry(symmetry);
            let mut contact = contact(&grid, InfluenceKernel::periodic(&grid).unwrap(), &shape, settings);
            let mean = share * PI * E_STAR * amplitude / wavelength;
            contact.step(0.0, Load::force(mean * wavelength)).unwrap();
            let (half_width, sine) = (share.sqrt().asin() / PI * wavelength, share.sqrt());
            let exact = |x: f64| {
                let (s, c) = (PI * x / wavelength).sin_cos();
                2.0 * mean / share * c * (sine * sine - s * s).max(0.0).sqrt()
            };
            let peak = contact.pressure().iter().copied().fold(0.0, f64::max);
            assert!((peak / exact(0.0) - 1.0).abs() < 5e-4, "{share}: {peak} {}", exact(0.0));
            // the width in cells
            let side = wavelength / cells as f64;
            let (width, exact_width) = (contact.contact_area() / side, 2.0 * half_width / side);
            assert!((width - exact_width).abs() < 0.6, "{share}: {width} {exact_width}");
            assert_abs_diff_eq!(contact.contact_cells() as f64, exact_width, epsilon = 2.0);
            let pairs = contact.pressure().iter().enumerate();
            let l1 = pairs.map(|(i, p)| (p - exact(grid.center(i, 0)[0])).abs()).sum::<f64>() / cells as f64 / mean;
            assert!(l1 < 4e-3, "{share}: {l1}");
        }
    }
}

/// Beyond Westergaard's pressure the contact is full, and the pressure a wave; the approach at which it becomes full is the
/// mean gap, and no approach exceeds it.
#[test]
fn a_wavy_surface_in_full_contact_is_westergaards() {
    let grid = Grid::new([64, 1], [1.0, 1.0]).unwrap();
    let shape = FnGeometry::new(|x1, _| 1e-3 * (1.0 - (2.0 * PI * x1).cos()));
    let mut contact = contact(&grid, InfluenceKernel::periodic(&grid).unwrap(), &shape, Settings::default());
    let (amplitude, mean) = (PI * E_STAR * 1e-3, 1.5 * PI * E_STAR * 1e-3);
    let report = contact.step(0.0, Load::force(mean)).unwrap();
    assert!(report.convolutions <= 4, "the preconditioner is the inverse: {report:?}");
    for (i, p) in contact.pressure().iter().enumerate() {
        let exact = mean + amplitude * (2.0 * PI * grid.center(i, 0)[0]).cos();
        assert!((p / exact - 1.0).abs() < 1e-5, "{i}: {p} {exact}");
    }
    assert_abs_diff_eq!(contact.approach() / 1e-3, 1.0, epsilon = 1e-9);
    assert_eq!(contact.contact_area(), 1.0);
    let error = contact.step(0.0, Load::approach(1.1e-3)).unwrap_err();
    let Error::Step(StepError::BeyondFullContact { maximum, .. }) = error else { panic!("{error}") };
    assert_abs_diff_eq!(maximum / 1e-3, 1.0, epsilon = 1e-9);
    contact.step(0.0, Load::approach(0.5e-3)).unwrap();
    assert!(contact.contact_cells() < 64);
    let error = contact.step(0.0, Load::eccentric_force(1.0, [0.1, 0.0])).unwrap_err();
    assert!(matches!(error, Error::Step(StepError::TiltOfPeriodic { axis: Axis::X1, .. })), "{error}");
}

/// A uniform pressure displaces nothing on bodies whose mean is held: flat on flat is solved all the same, and let go.
#[test]
fn flat_on_flat_is_solved_and_let_go() {
    for cells in [[16, 16], [15, 9], [64, 1], [7, 1]] {
        for ripple in [0.0, 1e-15] {
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let shape = FnGeometry::new(move |x1, _| ripple * (2.0 * PI * x1).cos());
            let kernel = InfluenceKernel::periodic(&grid).unwrap();
            let mut contact = contact(&grid, kernel, &shape, Settings::default());
            contact.step(0.0, Load::force(1.0)).unwrap();
            assert!(contact.pressure().iter().all(|p| (p - 1.0).abs() < 0.05), "{cells:?}");
            contact.step(0.0, Load::approach(-1.0e-6)).unwrap();
            assert_eq!(contact.contact_cells(), 0);
        }
    }
    let grid = Grid::square(16, 1.0).unwrap();
    let mut two = ViscoelasticContact::builder(grid.clone())
        .geometry(&FnGeometry::new(|x1, _| if x1 < 0.0 { 0.0 } else { f64::INFINITY }))
        .another_body(&FnGeometry::new(|x1, _| if x1 < 0.0 { f64::INFINITY } else { 0.0 }))
        .material(elastic())
        .kernel(InfluenceKernel::periodic(&grid).unwrap())
        .build()
        .unwrap();
    let error = two.step(0.0, [Load::approach(1.0); 2]).unwrap_err();
    assert!(matches!(error, Error::Step(StepError::BeyondFullContact { .. })), "{error}");
}

/// The measured error of the mesh falls with it; where coarser meshes of a full contact do not bear the load, or have no error, none is large.
#[test]
fn errors_of_the_mesh_are_measured_on_lines() {
    let estimates = [64, 256, 1024].map(|cells| {
        let grid = Grid::new([cells, 1], [0.04, 1.0]).unwrap();
        let kernel = InfluenceKernel::line(&grid, 1.0).unwrap();
        let shape = Cylinder::new(0.02).unwrap();
        let mut contact = contact(&grid, kernel, &shape, Settings::default().with_tolerance(1e-9));
        contact.step(0.0, Load::force(2.0e4)).unwrap();
        let half_width = (4.0 * 2.0e4 * 0.02 / (PI * E_STAR)).sqrt();
        let (pressure, n) = (contact.pressure(), cells as f64);
        // the means over cells are those of an ellipse, whose integral is known
        let integral = |x: f64| {
            let t = (x / half_width).clamp(-1.0, 1.0);
            0.5 * half_width * (t * (1.0 - t * t).sqrt() + t.asin())
        };
        let side = 0.04 / n;
        let mean = |k: usize| {
            let x = contact.grid().center(k, 0)[0];
            2.0 * 2.0e4 / (PI * half_width) * (integral(x + 0.5 * side) - integral(x - 0.5 * side)) / side
        };
        let off = (0..cells).map(|k| (pressure[k] - mean(k)).abs()).sum::<f64>() * side / 2.0e4;
        let measured = contact.fields().mesh_error().unwrap().unwrap().pressure_field;
        assert!((0.5 * off..20.0 * off).contains(&measured), "{cells}: {measured} {off}");
        measured
    });
    assert!(estimates[1] < 0.4 * estimates[0] && estimates[2] < 0.4 * estimates[1], "{estimates:?}");
    let grid = Grid::square(8, 1.0).unwrap();
    let flat = FnGeometry::new(|_, _| 0.0);
    let mut full = contact(&grid, InfluenceKernel::periodic(&grid).unwrap(), &flat, Settings::default());
    full.step(0.0, Load::force(1.0)).unwrap();
    let error = full.fields().mesh_error().unwrap();
    assert!(error.is_none_or(|error| error.approach < 1e-9 && error.area < 1e-9), "{error:?}");
}
