//! Several bodies, some free to tilt, some held, some released, on elastic and creeping bodies: warm steps solve what a fresh
//! contact solves. `SEVERAL_SCENES` (30) scenes of six steps, from `SEVERAL_FIRST` (2360) on: of these, the 2378th once left
//! the fall-back without a gain.

use crate::common::{Draws, builder_of, elastic, from_environment};
use viscocontact::prelude::*;

/// Numbers of the stream in which that scene was found.
fn draws(seed: u64) -> Draws {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..4).for_each(|_| _ = next());
    Draws::of(next)
}

#[test]
fn steps_of_several_bodies_converge() {
    let (first, scenes) = (from_environment("SEVERAL_FIRST", 2360), from_environment("SEVERAL_SCENES", 30));
    let (mut steps, mut outside) = (0, 0);
    for scene in first..first + scenes {
        let mut draws = draws(99_000 + scene);
        let (cells, bodies) = (12 + draws.below(24), 2 + draws.below(2));
        let grid = Grid::square(cells, 6.0e-3).unwrap();
        let place = |body: usize| -2.0e-3 + 2.0e-3 * body as f64;
        let shapes: Vec<Box<dyn Geometry>> = (0..bodies)
            .map(|body| {
                let by = [place(body) + draws.between(-2.0e-4, 2.0e-4), draws.between(-1.0e-3, 1.0e-3)];
                match draws.below(3) {
                    0 => Box::new(Shifted::new(Sphere::new(0.01).unwrap(), by).unwrap()) as Box<dyn Geometry>,
                    1 => Box::new(Shifted::new(Cone::new(0.05).unwrap(), by).unwrap()),
                    _ => Box::new(Shifted::new(FlatPunch::circular(7.0e-4).unwrap(), by).unwrap()),
                }
            })
            .collect();
        let softening = || Material::incompressible(Zener::with_time(1.0e6, 1.0e5, 1.0).unwrap());
        let material = if draws.chance(0.5) { elastic() } else { softening() };
        let build = || {
            let settings = Settings::default().with_edge(Edge::Allow);
            let builder = builder_of(&shapes[0], grid.clone(), material.clone());
            shapes[1..].iter().fold(builder.settings(settings), |builder, shape| builder.another_body(shape)).build()
        };
        let Ok(mut contact) = build() else { continue };
        for _ in 0..6 {
            let loads: Vec<Load> = (0..bodies)
                .map(|body| match draws.below(4) {
                    0 => Load::force(draws.scale(1.0e-4, 0.1)),
                    1 => Load::approach(draws.between(-1.0e-5, 5.0e-5)),
                    2 => Load::force(0.0),
                    _ => {
                        let force = draws.scale(1.0e-4, 0.1);
                        let by = [draws.between(-2.0e-4, 2.0e-4), draws.between(-2.0e-4, 2.0e-4)];
                        Load::eccentric_force(force, [place(body) + by[0], by[1]])
                    }
                })
                .collect();
            let dt = if draws.chance(0.3) { 0.0 } else { draws.scale(1.0e-3, 10.0) };
            steps += 1;
            match contact.step(dt, &loads) {
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
                Err(Error::Step(StepError::LoadOutsideHull { .. })) => outside += 1,
                Err(error) => panic!("scene {scene} after {dt} s under {loads:?}: {error}"),
            }
        }
    }
    println!("{steps} steps, {outside} of them with a load outside the hull");
    assert!(outside < steps / 5);
}
