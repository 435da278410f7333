//! Random scenes: any body, any shape, loads that jump from place to place.

use viscocontact::Result;
use viscocontact::prelude::*;

use crate::common::{Draws, uniform};

/// The numbers that choose the parts of a scene.
fn draws(seed: u64) -> Draws {
    let mut next = uniform(seed);
    // the first numbers of neighbouring seeds resemble each other
    (0..8).for_each(|_| _ = next());
    Draws::of(next)
}

/// A contact and the steps it takes.
pub struct Scene {
    pub name: String,
    pub grid: Grid,
    /// The initial gap of each rigid body.
    pub shapes: Vec<Box<dyn Geometry>>,
    pub rheology: Body,
    /// The length of each step \[s\], and the loads at its end.
    pub steps: Vec<(f64, Vec<Load>)>,
}

/// What the creeping body is made of: J(t) = `glassy` + `fluidity` t + Σ c (1 − e^(−t/λ)).
#[derive(Debug, Clone)]
pub struct Body {
    pub glassy: f64,
    pub fluidity: f64,
    pub terms: Vec<(f64, f64)>,
}

impl Body {
    pub fn random(draws: &mut Draws) -> Body {
        let j = 1.0e-6;
        match draws.below(6) {
            0 => Body { glassy: j, fluidity: 0.0, terms: Vec::new() },
            1 => Body { glassy: 0.0, fluidity: 0.0, terms: vec![(j, 1.0)] },
            2 => Body { glassy: j, fluidity: 0.0, terms: vec![(draws.scale(0.3, 30.0) * j, 1.0)] },
            3 => Body { glassy: j, fluidity: j, terms: Vec::new() },
            4 => Body { glassy: j, fluidity: 0.0, terms: terms(draws, j) },
            _ => Body { glassy: j * draws.between(0.0, 1.0), fluidity: j, terms: terms(draws, j) },
        }
    }

    pub fn material(&self) -> Material {
        let Body { glassy, fluidity, ref terms } = *self;
        Material::incompressible(GeneralizedKelvin::new(glassy, fluidity, terms).unwrap())
    }

    /// Whether it answers a jump of the load.
    pub fn is_elastic_at_first(&self) -> bool {
        self.glassy > 0.0
    }
}

/// Up to four retardation times.
fn terms(draws: &mut Draws, j: f64) -> Vec<(f64, f64)> {
    (0..=draws.below(4)).map(|_| (draws.scale(0.1, 10.0) * j, draws.scale(1e-3, 1e3))).collect()
}

pub const SIDE: f64 = 4.0e-3;

/// A shape whose face holds the square |x1|, |x2| < 1.2 mm, or what it may touch does.
pub fn shape(draws: &mut Draws) -> (&'static str, Box<dyn Geometry>) {
    let radius = 10.0e-3;
    match draws.below(10) {
        0 => ("sphere", Box::new(Sphere::new(radius).unwrap())),
        1 => ("cone", Box::new(Cone::new(draws.scale(0.02, 0.3)).unwrap())),
        2 => ("ellipsoid", Box::new(Ellipsoid::new(radius, draws.scale(0.2, 5.0) * radius).unwrap())),
        3 => ("round punch", Box::new(FlatPunch::circular(draws.between(0.8e-3, 1.8e-3)).unwrap())),
        4 => {
            let sides = [draws.between(1.0e-3, 3.4e-3), draws.between(1.0e-3, 3.4e-3)];
            ("square punch", Box::new(FlatPunch::rectangular(sides).unwrap()))
        }
        5 => {
            let [inner, outer] = [draws.between(0.3e-3, 1.0e-3), draws.between(1.3e-3, 2.0e-3)];
            let ring = move |r: f64| if (inner..outer).contains(&r) { 0.0 } else { f64::INFINITY };
            ("ring", Box::new(FnGeometry::new(move |x, y| ring(x.hypot(y)))))
        }
        6 => {
            let apart = draws.between(0.2e-3, 0.8e-3);
            let feet = move |x: f64| if x.abs() > apart { 0.5 * x * x / radius } else { f64::INFINITY };
            ("two feet", Box::new(FnGeometry::new(move |x, y| feet(x) + 0.2 * y * y / radius)))
        }
        7 => {
            let height = draws.scale(1.0e-8, 1.0e-5);
            let noise = move |x: f64, y: f64| height * (1e7 * (13.0 * x + 78.0 * y)).sin();
            ("noise", Box::new(FnGeometry::new(noise)))
        }
        8 => {
            let bend = draws.between(0.1, 0.9) / radius;
            ("saddle", Box::new(FnGeometry::new(move |x, y| 0.5 * bend * (x * x - y * y) + 0.3e-3 * bend * x)))
        }
        _ => {
            // a bowl with waves in any direction
            let waves: Vec<[f64; 4]> = (0..12)
                .map(|_| {
                    let q = draws.scale(1.0e3, 1.0e4);
                    let angle = draws.between(0.0, 6.3);
                    [2.0e-3 / q * draws.between(0.2, 1.0), q * angle.cos(), q * angle.sin(), draws.between(0.0, 6.3)]
                })
                .collect();
            let height = move |x: f64, y: f64| {
                let rough: f64 = waves.iter().map(|[a, q1, q2, phase]| a * (q1 * x + q2 * y + phase).cos()).sum();
                (x * x + y * y) / (2.0 * radius) + rough
            };
            ("rough", Box::new(FnGeometry::new(height)))
        }
    }
}

impl Scene {
    /// Few cells, or on a finer mesh more, one to three bodies, and loads of every kind.
    pub fn any(seed: u64, steps: usize, fine: bool) -> Scene {
        let draws = &mut draws(seed);
        let (least, range) = if fine { (9, 40) } else { (5, 8) };
        let cells = [least + draws.below(range), least + draws.below(range)];
        let grid = Grid::new(cells, [SIDE, SIDE * draws.scale(0.5, 2.0)]).unwrap();
        let bodies = [1, 1, 1, 2, 3][draws.below(5)];
        let mut name = format!("seed {seed}: {}x{}", cells[0], cells[1]);
        let width = SIDE / bodies as f64;
        let centres: Vec<f64> = (0..bodies).map(|body| (body as f64 + 0.5) * width - 0.5 * SIDE).collect();
        let shapes: Vec<Box<dyn Geometry>> = centres
            .iter()
            .map(|&centre| {
                let (kind, shape) = shape(draws);
                name += &format!(" {kind}");
                let lift = draws.between(0.0, 1.0e-6);
                let own = FnGeometry::new(move |x1, x2| {
                    if bodies == 1 {
                        return shape.initial_gap(x1, x2);
                    }
                    let own = (x1 - centre).abs() < 0.499 * width;
                    if own { lift + shape.initial_gap(x1 - centre, x2) } else { f64::INFINITY }
                });
                Box::new(own) as Box<dyn Geometry>
            })
            .collect();
        let body = Body::random(draws);
        // an upright beginning is computed on a small window, by symmetry on a quarter of it
        let upright_first = fine && draws.chance(0.5);
        let steps = (0..steps)
            .map(|k| {
                let jumps = body.is_elastic_at_first() && (k == 0 || draws.chance(0.3));
                let dt = if jumps { 0.0 } else { draws.scale(1.0e-3, 1.0e2) };
                let loads = centres.iter().map(|&centre| {
                    let reach = 0.3 * width;
                    let tilt = |draws: &mut Draws, at: f64| match draws.below(3) {
                        0 => Tilt::Fixed(0.0),
                        1 => Tilt::Fixed(draws.between(-2.0e-3, 2.0e-3)),
                        _ => Tilt::Free { at },
                    };
                    if upright_first && k == 0 {
                        return Load::force(draws.scale(0.001, 1.0));
                    }
                    let at = [centre + draws.between(-reach, reach), draws.between(-1.0e-3, 1.0e-3)];
                    let tilt = at.map(|at| tilt(draws, at));
                    match draws.below(8) {
                        0 => Load::Force { normal: 0.0, tilt },
                        1 | 2 => Load::Approach { approach: draws.between(-1.0e-6, 2.0e-5), tilt },
                        _ => Load::Force { normal: draws.scale(0.001, 1.0), tilt },
                    }
                });
                (dt, loads.collect())
            })
            .collect();
        Scene { name, grid, shapes, rheology: body, steps }
    }

    pub fn contact(&self, settings: Settings) -> Result<ViscoelasticContact> {
        let mut builder = ViscoelasticContact::builder(self.grid.clone()).material(self.rheology.material());
        builder = builder.geometry(&*self.shapes[0]);
        for shape in &self.shapes[1..] {
            builder = builder.another_body(&**shape);
        }
        builder.settings(settings).build()
    }
}
