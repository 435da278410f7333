//! Several bodies, some free to tilt, some held, some released, on elastic and creeping bodies: warm steps solve what a fresh
//! contact solves. `SEVERAL_SCENES` (30) scenes of six steps, from `SEVERAL_FIRST` (2360) on: of these, the 2378th once left
//! the fall-back without a gain.

use crate::common::environment::from_environment;
use viscocontact::prelude::*;

/// Numbers drawn at random.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03);
        (0..4).for_each(|_| _ = random.unit());
        random
    }

    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn power(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize % count
    }
}

#[test]
fn several_bodies_never_stall() {
    let (first, scenes) = (from_environment("SEVERAL_FIRST", 2360), from_environment("SEVERAL_SCENES", 30));
    let (mut steps, mut outside) = (0, 0);
    for scene in first..first + scenes {
        let mut random = Random::new(99_000 + scene);
        let (cells, bodies) = (12 + random.below(24), 2 + random.below(2));
        let grid = Grid::square(cells, 6.0e-3).unwrap();
        let place = |body: usize| -2.0e-3 + 2.0e-3 * body as f64;
        let shapes: Vec<Box<dyn Geometry>> = (0..bodies)
            .map(|body| {
                let by = [place(body) + random.between(-2.0e-4, 2.0e-4), random.between(-1.0e-3, 1.0e-3)];
                match random.below(3) {
                    0 => Box::new(Shifted::new(Sphere::new(0.01).unwrap(), by).unwrap()) as Box<dyn Geometry>,
                    1 => Box::new(Shifted::new(Cone::new(0.05).unwrap(), by).unwrap()),
                    _ => Box::new(Shifted::new(FlatPunch::circular(7.0e-4).unwrap(), by).unwrap()),
                }
            })
            .collect();
        let material = match random.unit() < 0.5 {
            true => Material::incompressible(Elastic::new(1.0e6).unwrap()),
            false => Material::incompressible(Zener::new(1.0e6, 1.0e5, 1.0e5).unwrap()),
        };
        let build = || {
            let settings = Settings::default().with_edge(Edge::Allow);
            let builder = ViscoelasticContact::builder(grid.clone()).geometry(&shapes[0]).material(material.clone());
            shapes[1..].iter().fold(builder.settings(settings), |builder, shape| builder.another_body(shape)).build()
        };
        let Ok(mut contact) = build() else { continue };
        for _ in 0..6 {
            let loads: Vec<Load> = (0..bodies)
                .map(|body| match random.below(4) {
                    0 => Load::force(random.power(1.0e-4, 0.1)),
                    1 => Load::approach(random.between(-1.0e-5, 5.0e-5)),
                    2 => Load::force(0.0),
                    _ => {
                        let force = random.power(1.0e-4, 0.1);
                        let by = [random.between(-2.0e-4, 2.0e-4), random.between(-2.0e-4, 2.0e-4)];
                        Load::eccentric_force(force, [place(body) + by[0], by[1]])
                    }
                })
                .collect();
            let dt = if random.unit() < 0.3 { 0.0 } else { random.power(1.0e-3, 10.0) };
            steps += 1;
            match contact.step_each(dt, &loads) {
                Ok(_) => {
                    for (body, load) in loads.iter().enumerate() {
                        let Load::Force { normal, .. } = load else { continue };
                        let force = contact.body(body).unwrap().force;
                        assert!(
                            (force - normal).abs() <= 1e-9 * normal,
                            "scene {scene}, body {body}: {force}, {normal}"
                        );
                    }
                    assert!(contact.pressure().iter().all(|&p| p >= 0.0), "scene {scene}");
                }
                Err(Error::LoadOutsideHull { .. }) => outside += 1,
                Err(error) => panic!("scene {scene} after {dt} s under {loads:?}: {error}"),
            }
        }
    }
    println!("{steps} steps, {outside} of them with a load outside the hull");
    assert!(outside < steps / 5);
}
