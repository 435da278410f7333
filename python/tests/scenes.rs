//! Random scenes, and the bits of their states: `tests/test_scenes.py` computes the same scenes in Python.

#[path = "more_scenes.rs"]
mod more_scenes;

use std::ops::RangeInclusive;
use std::sync::Arc;

use viscocontact::geometry::{Cone, Ellipsoid, Geometry, Shifted, Sphere, Sum, Wavy};
use viscocontact::prelude::*;
use viscocontact::rheology::PronyTerm;

/// Times over which bodies without an exact series are fitted [s].
const FITTED: RangeInclusive<f64> = 1e-4..=1e2;

/// Numbers that both languages draw alike (Vigna's xorshift64*).
struct Draw(u64);

impl Draw {
    fn of_seed(seed: u64) -> Draw {
        Draw(0x9E37_79B9_7F4A_7C15 ^ (seed + 1).wrapping_mul(0xD134_2543_DE82_EF95))
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, n: u64) -> usize {
        (self.next() % n) as usize
    }

    /// A number between two others.
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

fn shape(draw: &mut Draw) -> viscocontact::Result<Arc<dyn Geometry>> {
    let base: Arc<dyn Geometry> = match draw.below(3) {
        0 => Arc::new(Sphere::new(draw.within(5e-3, 20e-3))?),
        1 => Arc::new(Cone::new(draw.within(0.02, 0.1))?),
        _ => Arc::new(Ellipsoid::new(draw.within(5e-3, 20e-3), draw.within(5e-3, 20e-3))?),
    };
    Ok(match draw.below(3) {
        0 => base,
        1 => Arc::new(Shifted::new(base, [draw.within(-2e-4, 2e-4), draw.within(-2e-4, 2e-4)])?),
        _ => Arc::new(Sum::new(base, Wavy::new(draw.within(1e-7, 2e-6), draw.within(1e-3, 2e-3))?)),
    })
}

fn rheology(draw: &mut Draw) -> viscocontact::Result<Arc<dyn Rheology>> {
    let (g, time) = (draw.within(0.5e6, 2e6), draw.within(0.1, 10.0));
    let shares = |draw: &mut Draw| [time, 10.0 * time].map(|time| PronyTerm { share: draw.within(0.1, 0.4), time });
    Ok(match draw.below(8) {
        0 => Arc::new(Elastic::new(g)?),
        1 => Arc::new(Maxwell::with_time(g, time)?),
        2 => Arc::new(Zener::with_time(g, draw.within(0.5e6, 2e6), time)?),
        3 => Arc::new(GeneralizedMaxwell::new(
            g,
            &[(draw.within(1e5, 1e7), time), (draw.within(1e5, 1e7), 10.0 * time)],
        )?),
        4 => {
            let body = FractionalZener::new(g, draw.within(0.5e6, 2e6), time, draw.within(0.3, 0.9))?;
            Arc::new(body.series(FITTED, 1e-4)?)
        }
        5 => Arc::new(GeneralizedMaxwell::prony(g, &shares(draw))?),
        6 => Arc::new(GeneralizedMaxwell::prony_long_term(g, &shares(draw))?),
        _ => {
            let body = SlowCreep::new(1.0 / g, draw.within(1e-7, 1e-6), time, draw.within(0.3, 0.9))?;
            Arc::new(body.series(FITTED, 1e-4)?)
        }
    })
}

fn scene(seed: u64) -> viscocontact::Result<ViscoelasticContact> {
    let mut draw = Draw::of_seed(seed);
    let cells = [12 + draw.below(13), 12 + draw.below(13)];
    let lengths = [draw.within(3e-3, 5e-3), draw.within(3e-3, 5e-3)];
    let (grid, shape, rheology) = (Grid::new(cells, lengths)?, shape(&mut draw)?, rheology(&mut draw)?);
    let material = match draw.below(3) {
        0 => Material::incompressible(rheology),
        1 => Material::constant_poisson(rheology, draw.within(0.1, 0.49))?,
        _ => Material::elastic_bulk(rheology, draw.within(5e6, 1e9))?,
    };
    let rule = if draw.below(2) == 0 { TimeRule::Exponential } else { TimeRule::ExponentialLinear };
    let settings = Settings::default()
        .with_symmetry(draw.below(2) == 0)
        .with_time_rule(rule)
        .with_edge(viscocontact::contact::Edge::Allow);
    let mut contact =
        ViscoelasticContact::builder(grid).geometry(&shape).material(material).settings(settings).build()?;
    contact.step(0.0, Load::force(draw.within(1e-3, 0.1)))?;
    for _ in 0..3 {
        let dt = draw.within(0.01, 1.0);
        let load = match draw.below(3) {
            0 => Load::force(draw.within(1e-3, 0.1)),
            1 => Load::approach(draw.within(1e-6, 3e-5)),
            _ => Load::spring(draw.within(1e3, 1e4), draw.within(1e-6, 5e-5)),
        };
        contact.step(dt, load)?;
    }
    let (start, end) = (contact.time(), contact.time() + draw.within(0.1, 2.0));
    let table = [(start, Load::force(draw.within(1e-3, 0.1))), (end, Load::force(draw.within(1e-3, 0.1)))];
    let history = PiecewiseLinear::new(&table)?;
    let mut run = contact.follow(&history, Stepping::adaptive(1e-2), end);
    while run.next_step()?.is_some() {}
    Ok(contact)
}

/// Time of a step of a ball on `n`² cells, the least of rounds of so many steps [s]: `tests/figures.py` measures the same in Python.
fn time_of_a_step(n: usize, steps: u32, rounds: u32) -> viscocontact::Result<f64> {
    let builder = ViscoelasticContact::builder(Grid::square(n, 4e-3)?).geometry(&Sphere::new(10e-3)?);
    let mut contact = builder.material(Material::incompressible(Maxwell::with_time(1e6, 1.0)?)).build()?;
    contact.step(0.0, Load::force(1.0))?;
    let mut least = f64::INFINITY;
    for _ in 0..rounds {
        let start = std::time::Instant::now();
        for _ in 0..steps {
            contact.step(1e-5, Load::force(1.0))?;
        }
        least = least.min(start.elapsed().as_secs_f64() / f64::from(steps));
    }
    Ok(least)
}

/// All bits of some numbers.
fn mixed<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> u64 {
    numbers.into_iter().fold(0u64, |mixed, value| mixed.rotate_left(5) ^ value.to_bits())
}

/// A line for each scene: its state, bit by bit, or its error.
fn main() {
    if std::env::args().nth(1).as_deref() == Some("steps") {
        for (n, steps, rounds) in [(16, 100, 400), (64, 10, 400), (256, 2, 200)] {
            println!("{n}² cells: {:?} µs a step", time_of_a_step(n, steps, rounds).map(|time| 1e6 * time));
        }
        return;
    }
    let count = |place| std::env::args().nth(place).and_then(|count| count.parse().ok());
    if let Some(scene) = std::env::args().nth(1).and_then(|kind| more_scenes::scene_of(&kind)) {
        for seed in 0..count(2).unwrap_or(100) {
            match scene(&mut Draw::of_seed(seed)) {
                Ok(numbers) => println!("{seed} {:016x} {}", mixed(&numbers), numbers.len()),
                Err(error) => println!("{seed} {error}"),
            }
        }
        return;
    }
    let count = count(1).unwrap_or(300);
    for seed in 0..count {
        match scene(seed) {
            Ok(contact) => {
                let mixed = mixed(contact.pressure().iter().chain(contact.fields().displacement()));
                let [time, force, approach] = [contact.time(), contact.force(), contact.approach()].map(f64::to_bits);
                println!("{seed} {time:016x} {force:016x} {approach:016x} {mixed:016x}");
            }
            Err(error) => println!("{seed} {error}"),
        }
    }
}
