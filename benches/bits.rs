//! Prints a hash of the states of random scenes, a line each: where two trees compute the same bits, they print the same lines.
//!
//! `cargo run --all-features -p viscocontact-tests --bin bits -- 100 > before.txt`, for 100 scenes of each kind.

use std::hash::{DefaultHasher, Hash, Hasher};

use viscocontact::adhesion::{Dugdale, ExponentialAttraction, VanDerWaals};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact_scenes::any_scene::AnyScene;
use viscocontact_scenes::sticky::ball;
use viscocontact_scenes::{Draws, Features, Scene};

fn hash(numbers: impl IntoIterator<Item = u64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    numbers.into_iter().for_each(|number| number.hash(&mut hasher));
    hasher.finish()
}

/// A scene of any kernel, on the whole grid or in a window.
fn of_any_kernel(seed: u64, window: bool) -> String {
    let mut scene = AnyScene::new(seed);
    scene.settings = scene.settings.with_window(window);
    match scene.course(None) {
        Ok(course) => {
            let fields = course.fields.iter().flatten();
            format!("{} steps {:016x}", course.reports.len(), hash(course.numbers.iter().chain(fields).copied()))
        }
        Err(error) => format!("{error}"),
    }
}

/// A scene whose steps are chosen by their error.
fn adaptive(scene: &Scene) -> String {
    let mut contact = scene.contact(1e-10);
    let mut run = contact.follow(scene.load(), Stepping::adaptive(1e-3), scene.body.until);
    let mut steps = 0;
    let end = loop {
        match run.next_step() {
            Ok(Some(_)) if steps < 200 => steps += 1,
            Ok(_) => break "ends".to_string(),
            Err(error) => break error.to_string(),
        }
    };
    let fields = contact.pressure().iter().chain(contact.fields().displacement());
    let numbers = fields.chain([&contact.time(), &contact.approach()]).map(|value| value.to_bits()).collect::<Vec<_>>();
    format!("{steps} steps {:016x} {end}", hash(numbers))
}

/// Surfaces that attract each other, in and out of contact: a ball or a punch with waves on a body that ends, that is periodic,
/// or on a line, by all loads and free tilts. Fields, counts and reports of the attraction enter the hash.
fn sticky(seed: u64) -> String {
    let mut draws = Draws::new(seed);
    let (range, side, kind) = (draws.scale(0.6, 4.0), 6.0, seed % 4);
    let terms = [(draws.scale(0.05, 2.0), draws.scale(0.1, 10.0))];
    let material = match draws.chance(0.5) {
        true => Material::incompressible(GeneralizedMaxwell::new(0.25, &terms).unwrap()),
        false => Material::incompressible(Elastic::new(0.25).unwrap()),
    };
    let law: Box<dyn viscocontact::adhesion::Attraction> = match draws.below(3) {
        0 => Box::new(VanDerWaals::new(1.0, range).unwrap()),
        1 => Box::new(Dugdale::new(1.0, range).unwrap().with_width(0.5).unwrap()),
        _ => Box::new(ExponentialAttraction::new(1.0, range).unwrap()),
    };
    let wave = Wavy::new(draws.between(0.02, 0.4), side / draws.between(2.0, 6.0)).unwrap();
    let shape: Box<dyn Geometry> = match kind {
        3 => Box::new(Sum::new(FlatPunch::circular(1.3).unwrap(), wave)),
        _ => Box::new(Sum::new(Sphere::new(1.0).unwrap(), wave)),
    };
    let mut builder = ball(36, side, material, law).geometry(&shape);
    if kind == 1 {
        builder = builder.kernel(InfluenceKernel::periodic(&Grid::square(36, side).unwrap()).unwrap());
    }
    let mut contact = match builder.build() {
        Ok(contact) => contact,
        Err(error) => return error.to_string(),
    };
    let (touch, step, by) = (contact.approach(), draws.scale(0.05, 5.0), draws.below(3));
    let tilt =
        if kind == 3 { [0, 1].map(|_| Tilt::Free { at: draws.between(-0.2, 0.2) }) } else { [Tilt::Fixed(0.0); 2] };
    let (mut numbers, mut work, stiffness) = (Vec::new(), 0.0, draws.scale(0.5, 1e3));
    for k in 0..20 {
        let down = if k < 7 { f64::from(k) / 6.0 } else { 1.0 - 0.25 * f64::from(k - 6) };
        let load = match by {
            0 => Load::Approach { approach: touch + 0.8 * down - 0.2, tilt },
            1 => Load::Spring { stiffness, drive: touch + 1.2 * down - 0.3, tilt },
            _ => Load::Force { normal: if down > 0.0 { 4.0 * down } else { 8.0 * down }, tilt },
        };
        match contact.step(step, load) {
            Ok(report) => {
                let own = contact.passes().unwrap();
                let counts =
                    [own.passes, own.rejected, usize::from(own.jumped), report.iterations, report.convolutions];
                numbers.extend(counts.map(|count| count as u64));
                numbers.extend([own.rise, own.released, report.residual, report.approach].map(f64::to_bits));
                numbers.extend(report.tilt.iter().chain(contact.pressure()).map(|value| value.to_bits()));
                work += report.convolution_equivalents();
            }
            Err(error) => return format!("{k} steps {work} {:016x} {error}", hash(numbers)),
        }
    }
    format!("{work} {:016x}", hash(numbers))
}

/// A punch that is pulled off a thin layer: its edge runs over many cells within a step.
fn running_edge(seed: u64) -> String {
    let cells = 128 + 32 * (seed % 3) as usize;
    let grid = Grid::new([cells, 1], [3.0, 1.0]).unwrap();
    let layer = Layer::bonded_to_rigid(0.15 + 0.05 * (seed % 2) as f64, 0.0).unwrap();
    let kernel = if seed.is_multiple_of(2) {
        InfluenceKernel::layer_periodic(&grid, layer)
    } else {
        InfluenceKernel::layer_line(&grid, layer, None)
    };
    let mut contact = ViscoelasticContact::builder(grid)
        .geometry(&FlatPunch::rectangular([2.0, 1.0]).unwrap())
        .kernel(kernel.unwrap())
        .material(Material::constant_poisson(Elastic::new(0.5).unwrap(), 0.0).unwrap())
        .attraction(ExponentialAttraction::new(0.1, (1.8 / cells as f64).sqrt()).unwrap())
        .build()
        .unwrap();
    let mut numbers = Vec::new();
    for k in 0..30 {
        match contact.step(1.0, Load::approach(-0.01 * f64::from(k))) {
            Ok(report) => {
                let own = contact.passes().unwrap();
                numbers.extend([own.passes, own.rejected, report.convolutions].map(|count| count as u64));
                numbers.extend(contact.pressure().iter().map(|value| value.to_bits()));
            }
            Err(error) => return format!("{k} steps {:016x} {error}", hash(numbers)),
        }
    }
    format!("{:016x}", hash(numbers))
}

fn main() {
    let count: u64 = std::env::args().nth(1).map_or(24, |count| count.parse().expect("a number of scenes"));
    for seed in 0..count {
        for window in [false, true] {
            println!("any kernel {seed} window {window}: {}", of_any_kernel(seed, window));
        }
        println!("adaptive {seed}: {}", adaptive(&Scene::draw(1, seed, Features::ANY)));
        println!("returning {seed}: {}", adaptive(&Scene::draw(1, seed, Features::RETURNING)));
        println!("sticky {seed}: {}", sticky(seed));
        println!("running edge {seed}: {}", running_edge(seed));
        if seed % 4 == 0 {
            println!("sticky, adaptive {seed}: {}", adaptive(&Scene::draw(1, seed, Features::ANY.attracted())));
        }
    }
}
