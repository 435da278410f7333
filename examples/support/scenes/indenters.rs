//! Three flat punches and a sphere on one incompressible half-space, each with a force of its own, none tilting.

use std::f64::consts::{FRAC_2_PI, PI};

use viscocontact::Result;
use viscocontact::prelude::*;

/// Punches left, right and above, the sphere in the middle.
#[derive(Debug, Clone, Copy)]
pub struct Indenters {
    /// Radius of the punches \[m\].
    pub punch: f64,
    /// Radius of the sphere \[m\].
    pub sphere: f64,
    /// From the centre of each punch to the centre of the sphere \[m\].
    pub distance: f64,
    /// Along each side of the grid.
    pub cells: usize,
}

/// The sphere, after the three punches.
pub const SPHERE: usize = 3;

impl Indenters {
    pub fn center(&self, body: usize) -> [f64; 2] {
        let d = self.distance;
        [[-d, 0.0], [d, 0.0], [0.0, d], [0.0, 0.0]][body]
    }

    pub fn shape(&self, body: usize) -> Result<Box<dyn Geometry>> {
        Ok(if body == SPHERE {
            Box::new(Sphere::new(self.sphere)?)
        } else {
            Box::new(Shifted::new(FlatPunch::circular(self.punch)?, self.center(body))?)
        })
    }

    fn grid(&self) -> Result<Grid> {
        Grid::square(self.cells, 2.2 * (self.distance + self.punch))
    }

    /// The first `bodies` of them.
    pub fn on(&self, material: &Material, bodies: usize) -> Result<ViscoelasticContact> {
        let builder = ViscoelasticContact::builder(self.grid()?).material(material.clone());
        let settings = Settings::default().with_tolerance(1e-8);
        let mut builder = builder.settings(settings).geometry(&self.shape(0)?);
        for body in 1..bodies {
            builder = builder.another_body(&self.shape(body)?);
        }
        builder.build()
    }

    /// The contact of an elastic body of compliance `compliance` \[1/Pa\] under `forces` \[N\], as many bodies as forces.
    ///
    /// Under forces that jump at t = 0 and are held no contact shrinks, so that by the correspondence principle (Lee &
    /// Radok 1960, Ting 1966) the approaches of a creeping body are those of the elastic one of compliance C(t).
    pub fn elastic(&self, compliance: f64, forces: &[f64]) -> Result<ViscoelasticContact> {
        let mut contact = self.on(&Material::incompressible(Elastic::new(0.25 / compliance)?), forces.len())?;
        contact.step(0.0, forces.iter().map(|&force| Load::force(force)).collect::<Vec<_>>())?;
        Ok(contact)
    }

    /// Approach of `body` if it is alone under `force` on the elastic body, by the same cells \[m\].
    pub fn approach_alone(&self, body: usize, force: f64, compliance: f64) -> Result<f64> {
        let mut contact = ViscoelasticContact::builder(self.grid()?)
            .geometry(&self.shape(body)?)
            .material(Material::incompressible(Elastic::new(0.25 / compliance)?))
            .build()?;
        Ok(contact.step(0.0, Load::force(force))?.approach)
    }

    /// Surface displacement at the distance `r` from the centre of `body` \[m\] if it is alone under `force` on an elastic
    /// body of compliance `compliance`; its approach at r = 0. Outside a punch (2/π) ω asin(a/r), outside a sphere Hertz's
    /// (Johnson, *Contact Mechanics*, 1985, §3.4).
    pub fn alone(&self, body: usize, force: f64, compliance: f64, r: f64) -> f64 {
        if body == SPHERE {
            let a = (0.75 * self.sphere * force * compliance).cbrt();
            if r <= a {
                return (a * a - 0.5 * r * r) / self.sphere;
            }
            let root = (1.0 - (a / r).powi(2)).sqrt();
            return ((2.0 * a * a - r * r) * (a / r).asin() + a * r * root) / (PI * self.sphere);
        }
        let approach = 0.5 * force * compliance / self.punch;
        if r <= self.punch { approach } else { FRAC_2_PI * approach * (self.punch / r).asin() }
    }

    /// Displacement at the point `at` \[m\] if each body displaced what it does alone; the approach at the centre of one.
    pub fn sum_of_lone(&self, at: [f64; 2], forces: &[f64], compliance: f64) -> f64 {
        let of = |(body, &force): (usize, &f64)| {
            let [x, y] = self.center(body);
            self.alone(body, force, compliance, (at[0] - x).hypot(at[1] - y))
        };
        forces.iter().enumerate().map(of).sum()
    }
}

/// Punches whose faces stay in contact all over are a linear system, ω_i(t) = Σ_j S_ij ∫ C(t − s) dW_j(s), with the S_ij
/// \[1/m\] of an elastic body.
pub struct ClosedFaces {
    pub compliances: [[f64; 3]; 3],
}

impl ClosedFaces {
    /// From elastic contacts: one with all forces equal to `least` \[N\], and one for each punch with the force `most`.
    pub fn new(scene: &Indenters, least: f64, most: f64) -> Result<ClosedFaces> {
        let approaches = |contact: ViscoelasticContact| {
            [0, 1, 2].map(|body| contact.fields().body(body).map_or(f64::NAN, |body| body.approach))
        };
        let compliance = 1.0e-6;
        let rest = approaches(scene.elastic(compliance, &[least; 3])?);
        let mut compliances = [[0.0; 3]; 3];
        for pressed in 0..3 {
            let mut forces = [least; 3];
            forces[pressed] = most;
            let raised = approaches(scene.elastic(compliance, &forces)?);
            for body in 0..3 {
                compliances[body][pressed] = (raised[body] - rest[body]) / ((most - least) * compliance);
            }
        }
        Ok(ClosedFaces { compliances })
    }

    /// The approaches at time `t` \[m\] after jumps of the forces: (time, by how much each changes \[N\]).
    pub fn approaches(&self, material: &Material, jumps: &[(f64, [f64; 3])], t: f64) -> [f64; 3] {
        self.compliances.map(|row| {
            let of_jump = |(time, by): &(f64, [f64; 3])| {
                material.contact_compliance(t - time) * row.iter().zip(by).map(|(s, by)| s * by).sum::<f64>()
            };
            jumps.iter().filter(|(time, _)| *time <= t).map(of_jump).sum()
        })
    }
}
