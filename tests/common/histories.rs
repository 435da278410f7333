//! Scenes that span what a time rule has to deal with: jumps, corners, oscillation, decades of time, control of the
//! approach.

use viscocontact::prelude::*;

use super::spheres::{RADIUS, sphere_on};

pub struct Scene {
    pub name: &'static str,
    pub material: Material,
    pub history: Box<dyn LoadHistory>,
    pub until: f64,
}

impl Scene {
    fn new(
        name: &'static str,
        rheology: impl Rheology + 'static,
        history: impl LoadHistory + 'static,
        until: f64,
    ) -> Scene {
        Scene { name, material: Material::incompressible(rheology), history: Box::new(history), until }
    }

    /// A grid that holds the contact of a sphere under 1 N.
    pub fn contact(&self, cells: usize, tolerance: f64) -> ViscoelasticContact {
        self.contact_with(cells, Settings::default().with_tolerance(tolerance))
    }

    pub fn contact_with(&self, cells: usize, settings: Settings) -> ViscoelasticContact {
        let widest = (0.75 * RADIUS * self.material.contact_compliance(self.until)).cbrt();
        sphere_on(Grid::square(cells, 2.3 * widest).unwrap(), self.material.clone(), settings)
    }
}

fn hold() -> StepLoad {
    StepLoad::new(Load::force(1.0)).unwrap()
}

/// Load, unload, wait, load again, in units of τ and N.
pub fn triangle() -> PiecewiseLinear {
    let corners = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.5, 0.0), (3.5, 1.0)];
    PiecewiseLinear::new(&corners.map(|(time, force)| (time, Load::force(force)))).unwrap()
}

pub fn four_terms() -> GeneralizedKelvin {
    let terms = [(0.5e-6, 0.05), (0.5e-6, 0.3), (0.5e-6, 2.0), (0.5e-6, 10.0)];
    GeneralizedKelvin::new(1.0e-6, 0.0, &terms).unwrap()
}

pub fn scenes() -> Vec<Scene> {
    let ten: Vec<_> = (0..10).map(|k| (1.0e-6, 10f64.powi(k - 4))).collect();
    let power = FractionalMaxwell::findley(1.0e-6, 1.0e-6, 0.3).unwrap().series(1e-6..=1e6, 1e-5).unwrap();
    vec![
        Scene::new("Maxwell, held", Maxwell::with_time(1.0e6, 1.0).unwrap(), hold(), 2.0),
        Scene::new("Zener, held", Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap(), hold(), 5.0),
        Scene::new("Zener, load-unload-load", Zener::with_time(1.0e6, 0.5e6, 1.0).unwrap(), triangle(), 3.5),
        Scene::new(
            "four times, sine",
            four_terms(),
            Sinusoid::new(Load::force(0.2), Load::force(1.0), 1.0).unwrap(),
            3.0,
        ),
        Scene::new("ten times, held", GeneralizedKelvin::new(1.0e-6, 0.0, &ten).unwrap(), hold(), 1e5),
        Scene::new("power law, twelve decades", power, hold(), 1e6),
        Scene::new(
            "Maxwell, approach |sin|",
            Maxwell::with_time(1.0e6, 1.0).unwrap(),
            FnHistory::new(|t: f64| Load::approach(1.0e-4 * (3.0 * t).sin().abs())),
            2.0,
        ),
    ]
}
