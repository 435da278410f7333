//! The source paper's scene, by the crate and by the paper's own algorithm; shared by tests, benches and examples.
#![allow(dead_code, reason = "each user takes what it needs")]

use std::collections::HashMap;

use viscocontact::Result;
use viscocontact::analytic::GrowingSphere;
use viscocontact::prelude::*;
use viscocontact_paper as paper;

/// The source paper's scene: a sphere under a force applied at t = 0 and held, on a half-space.
#[derive(Debug, Clone)]
pub struct StepLoadedSphere {
    pub name: &'static str,
    pub radius: f64,
    pub force: f64,
    /// Glassy shear modulus.
    pub modulus: f64,
    /// Relaxation time of the Maxwell, retardation time of the Zener body.
    pub tau: f64,
    pub duration: f64,
    pub material: Material,
}

impl StepLoadedSphere {
    /// G = 1 MPa, τ = 1 s, to t = 2τ.
    pub fn maxwell() -> StepLoadedSphere {
        let material = Material::incompressible(Maxwell::with_time(1.0e6, 1.0).unwrap());
        StepLoadedSphere {
            name: "Maxwell",
            radius: 10.0e-3,
            force: 1.0,
            modulus: 1.0e6,
            tau: 1.0,
            duration: 2.0,
            material,
        }
    }

    /// G = G_K = 1 MPa, retardation time 1 s, to t = 2τ.
    pub fn zener() -> StepLoadedSphere {
        StepLoadedSphere::zener_with(1.0e6)
    }

    /// G = 1 MPa, `g_k`, retardation time 1 s, to t = 2τ.
    pub fn zener_with(g_k: f64) -> StepLoadedSphere {
        let material = Material::incompressible(Zener::with_time(1.0e6, g_k, 1.0).unwrap());
        StepLoadedSphere { name: "Zener", material, ..StepLoadedSphere::maxwell() }
    }

    pub fn reference(&self) -> Result<GrowingSphere> {
        GrowingSphere::step(self.radius, &self.material, self.force)
    }

    /// A square that leaves an eighth of the final contact diameter free around it.
    pub fn grid(&self, cells: usize) -> Result<Grid> {
        Grid::square(cells, 2.25 * self.reference()?.contact_radius(self.duration))
    }

    pub fn contact(&self, cells: usize, settings: Settings) -> Result<ViscoelasticContact> {
        self.contact_on(self.grid(cells)?, settings)
    }

    pub fn contact_on(&self, grid: Grid, settings: Settings) -> Result<ViscoelasticContact> {
        ViscoelasticContact::builder(grid)
            .geometry(&Sphere::new(self.radius)?)
            .material(self.material.clone())
            .settings(settings)
            .build()
    }

    /// The jump and `steps` equal steps; returns the contact and the convolution equivalents per step.
    pub fn run(&self, cells: usize, steps: usize, settings: Settings) -> Result<(ViscoelasticContact, f64)> {
        let mut contact = self.contact(cells, settings)?;
        contact.step(0.0, Load::force(self.force))?;
        let mut work = 0.0;
        for _ in 0..steps {
            let report = contact.step(self.duration / steps as f64, Load::force(self.force))?;
            work += report.convolution_equivalents();
        }
        Ok((contact, work / steps as f64))
    }

    /// The same by the source paper's own algorithm: its last state, and the convolutions of the past and of contact problems.
    pub fn literally(&self, cells: usize, steps: usize) -> Result<(paper::State, [usize; 2])> {
        let grid = paper::Grid { cells, side: self.grid(cells)?.spacing()[0] };
        let square = |k: usize| grid.center(k).map(|x| x * x).iter().sum::<f64>();
        let gap = (0..grid.len()).map(|k| square(k) / (2.0 * self.radius)).collect();
        let creep = |t: f64| self.material.contact_compliance(t);
        let mut contact = paper::History::new(paper::Influence::new(grid), &creep, gap, 1e-7);
        for step in 0..=steps {
            let time = self.duration * step as f64 / steps as f64;
            assert!(contact.step(time, paper::Load { force: self.force, at: None }), "step {step} does not converge");
        }
        Ok((contact.state, contact.convolutions))
    }
}

/// Relative errors of a state against its reference.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// Pressure of the cells nearest to the centre, compared at their own distance from it.
    pub central_pressure: f64,
    /// Σ |p − p_exact| / Σ p over all cells.
    pub l1: f64,
    /// Radius of the circle with the area of the cells in contact.
    pub contact_radius: f64,
    pub approach: f64,
}

pub fn errors(contact: &ViscoelasticContact, reference: &GrowingSphere) -> Errors {
    let (grid, t) = (contact.grid(), contact.time());
    let [n1, n2] = grid.cells();
    let pressure = contact.pressure();
    // equal distances have equal pressures: evaluate each once
    let mut known = HashMap::new();
    let mut exact = |i: usize, j: usize| {
        let [x1, x2] = grid.center(i, j);
        let key = ((2 * i + 1).abs_diff(n1).pow(2), (2 * j + 1).abs_diff(n2).pow(2));
        *known.entry((key.0 + key.1, n1, n2)).or_insert_with(|| reference.pressure(x1.hypot(x2), t))
    };
    let mut l1 = 0.0;
    for i in 0..n1 {
        for j in 0..n2 {
            l1 += (pressure[i * n2 + j] - exact(i, j)).abs();
        }
    }
    let (i, j) = (n1 / 2, n2 / 2);
    let central_pressure = pressure[i * n2 + j] / exact(i, j) - 1.0;
    let radius = (contact.contact_area() / std::f64::consts::PI).sqrt();
    Errors {
        central_pressure,
        l1: l1 / pressure.iter().sum::<f64>(),
        contact_radius: radius / reference.contact_radius(t) - 1.0,
        approach: contact.approach() / reference.approach(t) - 1.0,
    }
}
