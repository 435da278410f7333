//! Shapes, grids and layers.

use std::sync::Arc;

use super::{judge, told};
use crate::common::{builder_of, sphere, zener};
use viscocontact::contact::StepReport;
use viscocontact::geometry::{Anisotropy, Repeated, Sum};
use viscocontact::output::{Metadata, read_states, write_states};
use viscocontact::prelude::*;
use viscocontact::states::StatesContact;
use viscocontact::{Axis, Error};

/// A surface pressed into a body of Poisson's ratio `nu` by an approach.
pub(super) struct Pressed {
    shape: Box<dyn Geometry>,
    grid: Grid,
    kernel: Arc<InfluenceKernel>,
    nu: f64,
    approach: f64,
}

impl Pressed {
    pub(super) fn new(shape: impl Geometry + 'static, grid: Grid, approach: f64) -> Pressed {
        let kernel = Arc::new(InfluenceKernel::half_space(&grid).unwrap());
        Pressed { shape: Box::new(shape), grid, kernel, nu: 0.5, approach }
    }

    pub(super) fn on(mut self, kernel: impl Fn(&Grid) -> Result<InfluenceKernel, Error>) -> Pressed {
        self.kernel = Arc::new(kernel(&self.grid).unwrap());
        self
    }

    pub(super) fn on_layer(self, layer: Layer) -> Pressed {
        let nu = layer.poisson_ratio();
        Pressed { nu, ..self.on(|grid| InfluenceKernel::layer(grid, layer)) }
    }

    fn material(&self) -> Material {
        Material::constant_poisson(Zener::relaxing(1.0e6, 0.5e6, 1.0).unwrap(), self.nu).unwrap()
    }

    fn settings() -> Settings {
        Settings::default().with_edge(Edge::Allow)
    }

    pub(super) fn in_space(&self) -> Result<StepReport, Error> {
        let contact = builder_of(&*self.shape, self.grid.clone(), self.material()).settings(Pressed::settings());
        contact.kernel(Arc::clone(&self.kernel)).build()?.step(0.0, Load::approach(self.approach))
    }

    /// The same on elastic states that end there, as solved and as read back.
    fn on_states(&self) -> Result<StepReport, Error> {
        let sweep = Sweep::new(self.grid.clone(), &*self.shape).kernel(Arc::clone(&self.kernel));
        let sweep = sweep.settings(Pressed::settings().with_tolerance(1e-8)).accuracy(1e-2).max_states(30);
        let states = sweep.run(Reach::Approach(self.approach))?;
        let report = StatesContact::new(&states, &self.material())?.step(0.0, Load::approach(0.999 * self.approach))?;
        let file = crate::common::Temporary::file("outside-states.npz");
        write_states(&file, &states, &Metadata::new("outside"))?;
        let read = StatesContact::new(&read_states(&file)?, &self.material())?
            .step(0.0, Load::approach(0.999 * self.approach))?;
        assert_eq!((read.warnings, read.figures), (report.warnings, report.figures));
        Ok(report)
    }
}

fn rough(length: f64, shortest: f64, seed: u64) -> Rough {
    let grid = Grid::square(64, length).unwrap();
    let spec = RoughSpec::new(0.5 * length, shortest, Roughness::RmsSlope(0.02)).with_seed(seed);
    Rough::new(&grid, spec).unwrap()
}

/// A map of the same heights on sides of another length.
fn map(length: f64, factor: f64) -> HeightMap {
    let heights = rough(1.0e-3, 0.1e-3, 3).height_map().heights().iter().map(|height| factor * height).collect();
    HeightMap::new([64; 2], [length; 2], heights).unwrap()
}

fn pyramid() -> FnGeometry<impl Fn(f64, f64) -> f64> {
    FnGeometry::new(|x1: f64, x2: f64| x1.abs().max(x2.abs()) / 35.0_f64.to_radians().tan())
}

/// Shapes, grids and bodies, each computed by the stepper and on elastic states.
#[test]
fn surfaces_outside_the_model_are_warned_of_or_refused_by_both_contacts() {
    let square = |cells: usize, length: f64| Grid::square(cells, length).unwrap();
    let line = |cells: usize, length: f64| Grid::new([cells, 1], [length, 1.0]).unwrap();
    let (ball, gel) = (|| Sphere::new(1.0e-3).unwrap(), Layer::bonded_to_rigid(20.0e-6, 0.45).unwrap());
    let on_gel = |depth: f64| Pressed::new(ball(), square(48, 1.2e-3), depth).on_layer(gel);
    let sliding = Layer::frictionless_on_rigid(0.1e-3, 0.5).unwrap();
    let soft = Layer::bonded_to_half_space(20.0e-6, 0.45, 1.0e-3, 0.3).unwrap();
    let sheet = Layer::bonded_to_rigid(0.2e-3, 0.3).unwrap();
    let periodic = |shape: Box<dyn Geometry>, length: f64, approach: f64| {
        Pressed::new(shape, square(48, length), approach).on(InfluenceKernel::periodic)
    };
    let wave = |length: f64| Wavy::new(10.0e-6, length).unwrap();
    let waves = |length: f64| Wavy::in_two_directions([5.0e-6; 2], [length; 2]).unwrap();
    let grooves = || {
        let grid = square(64, 1.0e-3);
        let along = Anisotropy::new(4.0, 0.0);
        let spec = RoughSpec::new(0.5e-3, 0.05e-3, Roughness::RmsSlope(0.02)).with_anisotropy(along).with_seed(2);
        Rough::new(&grid, spec).unwrap()
    };
    let balls = |period: f64| Repeated::new(ball(), [period, period]).unwrap();
    let (other, fine) = ("make the grid as long", "refine the mesh, or leave them out");
    let (deep, steep) = ("over a fifth of its thickness: press less", "check that lengths are in m");
    let (flat, cells) = ("heights and lengths are in m", "refine the mesh");
    let through = "press less (a fifth of the thickness is warned of), or check the thickness";
    #[rustfmt::skip]
    let scenes: Vec<(&str, Pressed, &str)> = vec![
        ("a gel indented by 0.23 of its thickness", on_gel(4.6e-6), deep),
        ("a gel indented by 0.75 of its thickness", on_gel(15.0e-6), deep),
        ("a gel indented by its thickness", on_gel(20.5e-6), through),
        ("a gel indented by 1.5 of its thickness", on_gel(30.0e-6), through),
        ("a sheet that slides on its base", Pressed::new(sphere(), square(48, 4.0e-3), 30.0e-6).on_layer(sliding), deep),
        ("a sheet squeezed by a punch", Pressed::new(FlatPunch::circular(1.0e-3).unwrap(), square(48, 3.0e-3), 60.0e-6).on_layer(sheet), deep),
        ("a punch through its sheet", Pressed::new(FlatPunch::circular(1.0e-3).unwrap(), square(48, 3.0e-3), 0.25e-3).on_layer(sheet), through),
        ("a soft coating", Pressed::new(ball(), square(48, 1.2e-3), 10.0e-6).on_layer(soft), deep),
        ("a layer under waves", Pressed { nu: 0.3, ..Pressed::new(wave(1.0e-3), square(48, 1.0e-3), 50.0e-6).on(|grid| InfluenceKernel::layer_periodic(grid, sheet)) }, deep),
        ("a layer in line contact", Pressed { nu: 0.3, ..Pressed::new(Cylinder::new(10.0e-3).unwrap(), line(128, 6.0e-3), 60.0e-6).on(|grid| InfluenceKernel::layer_line(grid, sheet, None)) }, deep),
        ("a ball pressed in by its radius", Pressed::new(Sphere::new(25.0e-6).unwrap(), square(48, 80.0e-6), 20.0e-6), steep),
        ("a pyramid of 35 degrees", Pressed::new(pyramid(), square(48, 4.0e-6), 0.9e-6), steep),
        ("a cone of slope 1", Pressed::new(Cone::new(1.0).unwrap(), square(48, 4.0e-3), 1.5e-3), steep),
        ("heights in µm as m", Pressed::new(map(1.0e-3, 1.0e6), square(64, 1.0e-3), 0.5), steep),
        ("eight cells", Pressed::new(sphere(), square(8, 4.0e-3), 0.2e-3), cells),
        ("heights in mm on sides in m", Pressed::new(map(1.0, 0.1), square(64, 1.0), 1.0e-7), flat),
        ("sides in µm as m", Pressed::new(map(1.0e3, 1.0), square(64, 1.0e3), 1.0e-6), flat),
        ("a rough surface of another period", periodic(Box::new(rough(1.0e-3, 0.15e-3, 1)), 1.5e-3, 1.0e-6), other),
        ("a shifted one", periodic(Box::new(Shifted::new(rough(1.0e-3, 0.15e-3, 1), [1.0e-4, 0.0]).unwrap()), 1.5e-3, 1.0e-6), other),
        ("a rough ball on a body of another period", periodic(Box::new(Sum::new(sphere(), rough(1.0e-3, 0.15e-3, 1))), 1.5e-3, 2.0e-6), other),
        ("a wave of another period", periodic(Box::new(wave(0.4e-3)), 1.0e-3, 2.0e-6), other),
        ("one of two waves of another period", periodic(Box::new(Wavy::in_two_directions([5.0e-6; 2], [0.5e-3, 0.3e-3]).unwrap()), 1.0e-3, 2.0e-6), other),
        ("balls of another period", periodic(Box::new(balls(0.4e-3)), 1.0e-3, 1.0e-6), other),
        ("a periodic map of other sides", periodic(Box::new(map(1.0e-3, 1.0).periodic()), 1.25e-3, 1.0e-6), other),
        ("a wave of another period along one axis", Pressed::new(waves(0.4e-3), square(48, 1.0e-3), 1.0e-6).on(|grid| InfluenceKernel::periodic_along(grid, Axis::X1, 1.0e-2)), other),
        ("a wave of another period in plane strain", Pressed::new(wave(0.4e-3), line(128, 1.0e-3), 2.0e-6).on(InfluenceKernel::periodic), other),
        ("half a period", periodic(Box::new(wave(2.0e-3)), 1.0e-3, 1.0e-6), other),
        ("a rough surface finer than the cells", periodic(Box::new(rough(1.0e-3, 0.04e-3, 4)), 1.0e-3, 1.0e-6), fine),
        ("a rough ball finer than the cells", Pressed::new(Sum::new(sphere(), rough(1.0e-3, 0.05e-3, 4)), square(48, 1.0e-3), 5.0e-6), fine),
        ("grooves finer than the cells across", periodic(Box::new(grooves()), 1.0e-3, 1.0e-6), fine),
        ("a wave of 3.7 cells", periodic(Box::new(wave(1.0e-3 / 13.0)), 1.0e-3, 5.0e-6), fine),
        ("waves of a cell and a half", periodic(Box::new(waves(1.0e-3 / 32.0)), 1.0e-3, 5.0e-6), fine),
        ("a map on every second of its points", Pressed::new(map(1.0e-3, 1.0), square(32, 1.0e-3), 2.0e-6), fine),
        ("fine waves repeated", periodic(Box::new(Repeated::new(wave(0.04e-3), [0.5e-3, f64::INFINITY]).unwrap()), 1.0e-3, 2.0e-6), fine),
        ("fine waves in plane strain", Pressed::new(wave(0.02e-3), line(128, 1.0e-3), 2.0e-6).on(InfluenceKernel::periodic), fine),
    ];
    let wrong = scenes.iter().flat_map(|(name, scene, words)| {
        let both =
            [(*name).to_owned(), format!("{name}, on states")].into_iter().zip([scene.in_space(), scene.on_states()]);
        both.filter_map(|(name, report)| judge(&name, report.map(told), words))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Closed forms have no cells: their slope is the slope at the edge of the contact.
#[test]
fn closed_forms_too_steep_are_warned_of_with_their_slope() {
    let table = |radius: f64| {
        let row = |a: f64| (4.0 / 3.0 * a.powi(3) / radius, a * a / radius, 2.0 * a, std::f64::consts::PI * a * a);
        ElasticStates::from_table(&[row(1.0e-5), row(1.0e-3), row(0.1)]).unwrap()
    };
    let scenes = [
        ("a ball of 10 mm pressed in by 50 mm", ElasticStates::sphere(10.0e-3), 50.0e-3, 5.0_f64.sqrt()),
        ("a cone of slope 0.7", ElasticStates::cone(0.7), 1.0e-6, 0.7),
        ("a body of the fourth power", ElasticStates::power(1.0, 4.0), 0.4, 4.0 * (0.4 * 3.0 / 8.0_f64).powf(0.75)),
        ("a table of a ball", Ok(table(10.0e-3)), 20.0e-3, 2.0_f64.sqrt()),
    ];
    for (name, states, depth, slope) in scenes {
        let report = StatesContact::new(&states.unwrap(), &zener()).unwrap().step(0.0, Load::approach(depth)).unwrap();
        let found = report.figures.max_slope.unwrap();
        assert!((found / slope - 1.0).abs() < 1e-6, "{name}: {found} {slope}");
        assert_eq!(judge(name, Ok(told(report)), "check that lengths are in m"), None);
    }
    for (states, depth) in [
        (ElasticStates::sphere(10.0e-3), 2.4e-3),
        (ElasticStates::cone(0.49), 1.0),
        (ElasticStates::punch(1.0e-3), 1.0e-3),
        (ElasticStates::power(1.0, 4.0), 0.05),
    ] {
        let report = StatesContact::new(&states.unwrap(), &zener()).unwrap().step(0.0, Load::approach(depth)).unwrap();
        assert!(report.warnings.is_empty(), "{report}");
    }
}
