//! Rough surfaces on periodic bodies: the work of the solver, and published results.

use crate::common::{E_STAR, G, builder_of, elastic, figures};

use crate::common::rough::self_affine;
use viscocontact::prelude::*;

const LENGTH: f64 = 1.0e-3;
const SLOPE: f64 = 0.05;

fn rough(cells: usize, shortest: f64, seed: u64) -> (Grid, Rough) {
    let grid = Grid::square(cells, LENGTH).unwrap();
    let spec = self_affine(LENGTH / 4.0, shortest * LENGTH / cells as f64, seed);
    let shape = Rough::new(&grid, spec).unwrap();
    (grid, shape)
}

fn pressed(grid: &Grid, shape: &Rough, material: Material, settings: Settings) -> ViscoelasticContact {
    builder_of(shape, grid.clone(), material)
        .kernel(InfluenceKernel::periodic(grid).unwrap())
        .settings(settings)
        .build()
        .unwrap()
}

/// The force of a mean pressure of so many E* times the rms slope.
fn force(share: f64) -> f64 {
    share * E_STAR * SLOPE * LENGTH * LENGTH
}

fn share_of_cells(contact: &ViscoelasticContact) -> f64 {
    contact.contact_cells() as f64 / contact.grid().len() as f64
}

/// At small loads the area is κ p̄/(E* h′): Persson's theory has κ = √(8/π) = 1.6, the theory of Bush, Gibson & Thomas
/// √(2π) = 2.5; computations lie between them (Hyun et al., Phys. Rev. E 70, 2004: 1.8 … 2.2).
#[test]
fn area_is_proportional_to_small_loads() {
    let (load, mut kappas) = (0.03, Vec::new());
    for seed in 0..5 {
        let (grid, shape) = rough(1024, 8.0, seed);
        let mut contact = pressed(&grid, &shape, elastic(), Settings::default().with_tolerance(1e-4));
        contact.step(0.0, Load::force(force(load))).unwrap();
        kappas.push(contact.contact_area() / (LENGTH * LENGTH) / load);
        let counted = share_of_cells(&contact) / load;
        println!("seed {seed}: κ = {:.3}, counting cells {counted:.3}", kappas[seed as usize]);
        assert!((1.6..2.3).contains(&kappas[seed as usize]) && (1.6..2.4).contains(&counted), "{kappas:?} {counted}");
    }
    let count = kappas.len() as f64;
    let mean = kappas.iter().sum::<f64>() / count;
    let spread = (kappas.iter().map(|kappa| (kappa - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    println!("κ = {mean:.3} ± {spread:.3}");
    figures::figure("area over load", &format!("{mean:.2} ± {spread:.2}")).unwrap();
    assert!(spread < 0.15, "{spread}");
}

/// Half of the surface in contact: what a solve takes. Nothing is padded: a preconditioner costs as much as a convolution.
#[test]
fn half_full_contact_takes_few_convolutions() {
    let (grid, shape) = rough(256, 8.0, 1);
    let mut contact = pressed(&grid, &shape, elastic(), Settings::default());
    let report = contact.step(0.0, Load::force(force(0.27))).unwrap();
    assert!((0.47..0.53).contains(&share_of_cells(&contact)), "{}", share_of_cells(&contact));
    let [convolutions, preconditioners] = [report.convolutions, report.preconditioner_applications];
    let text = format!("{convolutions} convolutions and {preconditioners} preconditioners");
    figures::figure("half of the cells in contact", &text).unwrap();
    assert!(convolutions + preconditioners <= 60, "{text}");
}

/// Nearly all of the surface in contact, where many pressures are close to zero, far from the mean.
#[test]
fn nearly_full_contact_converges() {
    let (grid, shape) = rough(2048, 8.0, 1);
    let mut contact = pressed(&grid, &shape, elastic(), Settings::default());
    let report = contact.step(0.0, Load::force(force(1.25))).unwrap();
    println!("{} of the cells: {report:?}", share_of_cells(&contact));
    let text =
        format!("{} convolutions and {} preconditioners", report.convolutions, report.preconditioner_applications);
    figures::figure("nearly all cells in contact", &text).unwrap();
    assert!((0.985..0.995).contains(&share_of_cells(&contact)), "{}", share_of_cells(&contact));
    assert!(report.convolutions <= 40 && report.fallback_iterations == 0, "{report:?}");
}

/// After the load drops to a constant, the area grows, if it changes at all (Li, Brenner & Frérot 2025): what the bodies
/// remember of the greater load does not open the contact again.
#[test]
fn area_never_falls_in_a_hold() {
    let material = Material::incompressible(
        GeneralizedMaxwell::new(0.2 * G, &[(0.4 * G, 0.1), (0.3 * G, 1.0), (0.1 * G, 10.0)]).unwrap(),
    );
    for seed in 0..12 {
        let (grid, shape) = rough(96, 6.0, seed);
        let mut contact = pressed(&grid, &shape, material.clone(), Settings::default().with_tolerance(1e-7));
        contact.step(0.0, Load::force(force(0.06))).unwrap();
        for _ in 0..10 {
            contact.step(0.2, Load::force(force(0.06))).unwrap();
        }
        let loaded = contact.contact_cells();
        let drop = [0.2, 0.5, 0.8][seed as usize % 3];
        contact.step(0.0, Load::force(force(0.06 * drop))).unwrap();
        let mut area = contact.contact_cells();
        assert!(area < loaded, "{seed}");
        let (first, mut dt) = (area, 1e-3);
        for step in 0..40 {
            contact.step(dt, Load::force(force(0.06 * drop))).unwrap();
            let now = contact.contact_cells();
            assert!(now >= area, "seed {seed}, drop to {drop}, step {step}: {area} {now}");
            (area, dt) = (now, dt * 1.25);
        }
        println!("seed {seed}, to {drop}: {loaded} {first} {area} cells");
        assert!(area > first);
    }
}
