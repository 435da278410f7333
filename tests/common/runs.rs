//! Runs of all kinds, for tests of what must not change their course.

use std::sync::Arc;

use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

use super::bodies::{power_law, three_times};
use super::spheres::{builder_of, builder_on, sphere, sphere_on};

pub type Build = Box<dyn Fn() -> ViscoelasticContact>;
pub type Step = Box<dyn Fn(&mut ViscoelasticContact, u32) -> StepReport>;

/// A load that rises, falls and rises, with a jump now and then.
pub fn wandering(contact: &mut ViscoelasticContact, k: u32) -> StepReport {
    let force = 0.3 + 0.2 * f64::from(k * k % 7) / 7.0;
    contact.step(if k.is_multiple_of(5) { 0.0 } else { 0.02 * f64::from(1 + k % 3) }, Load::force(force)).unwrap()
}

/// Scenes of all kinds, how they are built, and their k-th step.
pub fn scenes() -> Vec<(&'static str, Build, Step)> {
    let grid = || Grid::square(48, 4.0e-3).unwrap();
    let wide = || Grid::square(96, 8.0e-3).unwrap();
    let with = |settings: Settings| move || sphere_on(Grid::square(48, 4.0e-3).unwrap(), three_times(), settings);
    let whole = Settings::default().with_window(false).with_symmetry(false);
    let line = || {
        let grid = Grid::new([200, 1], [10.0e-3, 1.0]).unwrap();
        builder_of(&Cylinder::new(10.0e-3).unwrap(), grid.clone(), three_times())
            .kernel(InfluenceKernel::line(&grid, 1.0).unwrap())
            .settings(Settings::default().with_frame(Frame::Indenter))
            .build()
            .unwrap()
    };
    let rolling = |contact: &mut ViscoelasticContact, k: u32| {
        contact.step_over([1 + (k % 2) as isize, 0], 0.01, Load::force(60.0 + f64::from(k))).unwrap()
    };
    let strip = || {
        let grid = Grid::new([64, 24], [8.0e-3, 3.0e-3]).unwrap();
        builder_on(grid.clone(), three_times())
            .kernel(InfluenceKernel::periodic_along(&grid, Axis::X2, 1.0).unwrap())
            .build()
            .unwrap()
    };
    let sliding = |contact: &mut ViscoelasticContact, k: u32| {
        let path = Straight::new([0.0; 2], [0.004, 0.003]).unwrap();
        let travel = Travel::new(Repeated::new(sphere(), [f64::INFINITY, 3.0e-3]).unwrap(), path);
        contact.step_along(&travel, if k == 0 { 0.0 } else { 5.0e-3 }, Load::force(0.1)).unwrap().step
    };
    let tilting = |contact: &mut ViscoelasticContact, k: u32| {
        let at = [1.0e-4 * f64::from(k % 3), -0.5e-4 * f64::from(k % 4)];
        contact.step(0.02, Load::eccentric_force(0.3, at)).unwrap()
    };
    let two = || {
        let at = |x: f64| Shifted::new(sphere(), [x, 0.0]).unwrap();
        ViscoelasticContact::builder(Grid::new([96, 48], [8.0e-3, 4.0e-3]).unwrap())
            .geometry(&at(-2.0e-3))
            .another_body(&at(2.0e-3))
            .material(three_times())
            .build()
            .unwrap()
    };
    let in_turn = |contact: &mut ViscoelasticContact, k: u32| {
        contact.step(0.02, [Load::force(0.2), Load::force(0.1 + 0.01 * f64::from(k % 4))]).unwrap()
    };
    let layer = move || {
        let layer = Layer::bonded_to_rigid(1.0e-3, 0.5).unwrap();
        let kernel = Arc::new(InfluenceKernel::layer(&grid(), layer).unwrap());
        builder_on(grid(), three_times()).kernel(kernel).build().unwrap()
    };
    let warming = move || {
        let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
        let temperature = TemperatureHistory::function(law, |t| 290.0 + 4.0 * t, &[0.5]).unwrap();
        builder_on(grid(), three_times()).temperature(temperature).build().unwrap()
    };
    let attracted = move || {
        let law = ExponentialAttraction::new(1.0, 2.0e-5).unwrap();
        let settings = Settings::default().with_edge(Edge::Allow);
        builder_on(grid(), three_times()).attraction(law).settings(settings).build().unwrap()
    };
    let pulled = |contact: &mut ViscoelasticContact, k: u32| {
        contact.step(0.02, Load::approach(1.0e-5 * f64::from(k * k % 7) - 3.7e-5)).unwrap()
    };
    vec![
        ("window", Box::new(move || sphere_on(wide(), three_times(), Settings::default())), Box::new(wandering)),
        ("folded", Box::new(with(Settings::default().with_window(false))), Box::new(wandering)),
        ("whole", Box::new(with(whole)), Box::new(wandering)),
        ("layer", Box::new(layer), Box::new(wandering)),
        ("warming", Box::new(warming), Box::new(wandering)),
        (
            "fitted",
            Box::new(move || builder_on(grid(), power_law()).times(2e-4..=2e4).build().unwrap()),
            Box::new(|c, k| c.step(0.02, Load::force(0.1 + 0.01 * f64::from(k % 9))).unwrap()),
        ),
        ("line, rolling", Box::new(line), Box::new(rolling)),
        ("strip, sliding", Box::new(strip), Box::new(sliding)),
        ("tilting", Box::new(with(Settings::default())), Box::new(tilting)),
        ("two bodies", Box::new(two), Box::new(in_turn)),
        ("attracted", Box::new(attracted), Box::new(pulled)),
    ]
}
