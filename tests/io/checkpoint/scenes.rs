//! Checkpoints of random scenes refused by slightly different scenes.

use crate::common::fields::gap;
use crate::common::{Temporary, builder_of, three_times, uniform};

use viscocontact::prelude::*;

use super::refused;

/// A body at random, which can be built again, turned, or changed a little.
#[derive(Clone, Copy, Debug)]
struct Body {
    kind: usize,
    size: [f64; 2],
    at: [f64; 2],
    height: f64,
}

impl Body {
    fn geometry(self) -> Box<dyn Geometry> {
        let [a, b] = self.size;
        let height = self.height;
        match self.kind {
            0 => Box::new(Shifted::new(Sphere::new(a).unwrap(), self.at).unwrap()),
            1 => Box::new(Shifted::new(Ellipsoid::new(a, b).unwrap(), self.at).unwrap()),
            2 => Box::new(Shifted::new(FlatPunch::rectangular([0.1 * a, 0.1 * b]).unwrap(), self.at).unwrap()),
            _ => {
                let [x, y] = self.at;
                Box::new(FnGeometry::new(move |x1, x2| {
                    height + ((x1 - x).powi(2) / a + (x2 - y).powi(2) / b).sqrt() * 1e-2
                }))
            }
        }
    }
}

/// The scene, or none if a body has no cell to touch.
fn build(grid: &Grid, bodies: &[Box<dyn Geometry>]) -> Option<ViscoelasticContact> {
    let builder = builder_of(&bodies[0], grid.clone(), three_times());
    let builder = bodies[1..].iter().fold(builder, |builder, body| builder.another_body(body));
    builder.settings(Settings::default().with_edge(Edge::Allow)).build().ok()
}

#[test]
fn random_scenes_are_told_apart() {
    let path = Temporary::file("random-scenes");
    let (mut accepted, mut swapped, mut reshaped) = (0, 0, 0);
    for seed in 0..300 {
        let mut number = uniform(seed);
        let mut random = move || number();
        let side = 4.0e-3;
        let cells = [8, 12, 16][(3.0 * random()) as usize];
        let square = random() < 0.5;
        let grid = Grid::new([cells, if square { cells } else { cells + 3 }], [side, side]).unwrap();
        let bodies: Vec<Body> = (0..1 + (3.0 * random()) as usize)
            .map(|_| Body {
                kind: (4.0 * random()) as usize,
                size: [5.0e-3 + 10.0e-3 * random(), 5.0e-3 + 10.0e-3 * random()],
                // centred bodies have more symmetry
                at: if random() < 0.2 { [0.0; 2] } else { [side * (random() - 0.5), side * (random() - 0.5)] },
                height: 1.0e-5 * random(),
            })
            .collect();
        let all = |bodies: &[Body]| -> Vec<Box<dyn Geometry>> { bodies.iter().map(|body| body.geometry()).collect() };
        let Some(mut contact) = build(&grid, &all(&bodies)) else { continue };
        let undisturbed = gap(contact.fields());
        let loads = vec![Load::force(0.02); bodies.len()];
        for _ in 0..2 {
            let _ = contact.step(0.1, &loads);
        }
        contact.save(&path).unwrap();
        build(&grid, &all(&bodies)).unwrap().resume(&path).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        accepted += 1;

        // in another order
        for first in 1..bodies.len() {
            let mut other = bodies.clone();
            other.swap(0, first);
            // of two flat punches one may be left without a cell
            let Some(mut other) = build(&grid, &all(&other)) else { continue };
            let error = refused(&mut other, &path);
            assert_eq!(
                (error.code(), error.name()),
                ("checkpoint_other_scene", Some("geometry")),
                "seed {seed}: {error}"
            );
            swapped += 1;
        }
        // moved, turned, mirrored, larger, a part of it: another geometry unless no cell sees it
        let changed = (random() * bodies.len() as f64) as usize;
        let body = bodies[changed];
        let ([a, b], [x, y]) = (body.size, body.at);
        for other in [
            Body { at: [x + 1e-3 * grid.spacing()[0], y], ..body },
            Body { at: [x, y - 0.7 * grid.spacing()[1]], ..body },
            Body { at: [-x, y], ..body },
            Body { at: [y, x], size: [b, a], ..body },
            Body { size: [b, a], ..body },
            Body { size: [a * (1.0 + 1e-5), b], ..body },
            Body { height: 2.0 * body.height, ..body },
            Body { kind: (body.kind + 1) % 4, ..body },
        ] {
            let mut scene = bodies.clone();
            scene[changed] = other;
            let Some(mut other) = build(&grid, &all(&scene)) else { continue };
            if gap(other.fields()) == undisturbed {
                continue;
            }
            let error = refused(&mut other, &path);
            let named = ("checkpoint_other_scene", Some("geometry"));
            assert_eq!((error.code(), error.name()), named, "seed {seed}, {:?} of {bodies:?}", scene[changed]);
            reshaped += 1;
        }
    }
    println!("{accepted} accepted, {swapped} swapped, {reshaped} reshaped");
    assert!(accepted > 150 && swapped > 100 && reshaped > 800);
}
