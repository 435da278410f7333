//! The source paper's algorithm, which shares nothing with the crate, against the crate: `LITERAL_SCENES` (20) random scenes, `LITERAL_SEED` (1).

use viscocontact::prelude::*;
use viscocontact_paper as paper;

use crate::common::{Draws, Ratios, builder_of, from_environment};

const CELLS: usize = 24;
const RADIUS: f64 = 10.0e-3;

struct Scene {
    shape: Box<dyn Geometry>,
    creep: GeneralizedKelvin,
    /// Of C(t): J(t)/4.
    terms: Vec<(f64, f64)>,
    glassy: f64,
    until: f64,
    force: f64,
    /// The force over its greatest value, at equal parts of the time; greater than 0.
    knots: Vec<f64>,
    /// Where the force acts on a body that tilts.
    at: Option<[f64; 2]>,
    side: f64,
}

impl Scene {
    fn draw(draws: &mut Draws) -> Scene {
        let (glassy, until) = (1.0e-6, draws.power_of_ten(-2.0, 3.0));
        let terms: Vec<(f64, f64)> =
            (0..1 + draws.below(3)).map(|_| (draws.scale(0.1, 3.0) * glassy, until * draws.scale(0.05, 5.0))).collect();
        let shape: Box<dyn Geometry> = match draws.below(4) {
            0 => Box::new(Sphere::new(RADIUS).unwrap()),
            1 => Box::new(Cone::new(0.05).unwrap()),
            2 => Box::new(FlatPunch::circular(1.0e-3).unwrap()),
            _ => Box::new(FnGeometry::new(|x: f64, y: f64| {
                0.5 * (x * x + 2.0 * y * y) / RADIUS + 4.0e-6 * (4.0e3 * x + 1.0).cos() * (5.0e3 * y).cos()
            })),
        };
        let is_flat = shape.initial_gap(0.0, 0.0) == 0.0 && shape.initial_gap(2.0e-3, 0.0).is_infinite();
        let tilts = is_flat && draws.chance(0.7);
        Scene {
            shape,
            creep: GeneralizedKelvin::new(glassy, 0.0, &terms).unwrap(),
            terms,
            glassy,
            until,
            force: 0.3,
            knots: (0..5).map(|_| draws.between(0.2, 1.0)).collect(),
            at: tilts.then(|| [draws.between(0.0, 0.5e-3), draws.between(-0.2e-3, 0.2e-3)]),
            side: 3.2e-3 / CELLS as f64,
        }
    }

    fn compliance(&self, t: f64) -> f64 {
        0.25 * self.terms.iter().fold(self.glassy, |sum, (c, time)| sum - c * (-t / time).exp_m1())
    }

    fn force(&self, t: f64) -> f64 {
        let place = (t / self.until * 4.0).clamp(0.0, 4.0);
        let k = (place as usize).min(3);
        let share = place - k as f64;
        self.force * ((1.0 - share) * self.knots[k] + share * self.knots[k + 1])
    }

    /// The pressure at the end, by the paper in so many steps.
    fn literally(&self, steps: usize) -> Vec<f64> {
        let grid = paper::Grid { cells: CELLS, side: self.side };
        let at = |k: usize| self.shape.initial_gap(grid.center(k)[0], grid.center(k)[1]);
        let creep = |t: f64| self.compliance(t);
        let gap = (0..grid.len()).map(at).collect();
        let mut contact = paper::History::new(paper::Influence::new(grid), &creep, gap, 1e-9);
        for step in 0..=steps {
            let time = self.until * step as f64 / steps as f64;
            let load = paper::Load { force: self.force(time), at: self.at };
            assert!(contact.step(time, load), "step {step} of {steps}");
        }
        contact.state.pressure
    }

    /// The same by the crate.
    fn pressure(&self, steps: usize) -> Vec<f64> {
        let grid = Grid::square(CELLS, CELLS as f64 * self.side).unwrap();
        let settings = Settings::default().with_tolerance(1e-9).with_edge(viscocontact::contact::Edge::Allow);
        let builder = builder_of(&*self.shape, grid, Material::incompressible(self.creep.clone()));
        let mut contact = builder.settings(settings).build().unwrap();
        for step in 0..=steps {
            let force = self.force(self.until * step as f64 / steps as f64);
            let load = self.at.map_or(Load::force(force), |at| Load::eccentric_force(force, at));
            contact.step(if step == 0 { 0.0 } else { self.until / steps as f64 }, load).unwrap();
        }
        contact.pressure().to_vec()
    }
}

fn off(found: &[f64], exact: &[f64]) -> f64 {
    let off: f64 = found.iter().zip(exact).map(|(found, exact)| (found - exact).abs()).sum();
    off / exact.iter().sum::<f64>()
}

#[test]
fn the_papers_algorithm_differs_by_the_order_of_its_rule() {
    let (scenes, seed) = (from_environment("LITERAL_SCENES", 20), from_environment("LITERAL_SEED", 1));
    let (mut elastic, mut orders, mut last) = (Ratios::default(), Ratios::default(), Ratios::default());
    for number in 0..scenes {
        let scene = Scene::draw(&mut Draws::new(seed * 1000 + number));
        // nothing has crept: one elastic contact
        let still = Scene {
            knots: vec![scene.knots[0]; 5],
            until: 1e-9 * scene.until,
            ..Scene::draw(&mut Draws::new(seed * 1000 + number))
        };
        elastic.push(off(&still.literally(1), &still.pressure(1)), "");
        let exact = scene.pressure(512);
        let errors = [16, 32, 64].map(|steps| off(&scene.literally(steps), &exact));
        println!("{number}: {:?} tilts {}", errors.map(|error| format!("{error:.1e}")), scene.at.is_some());
        // a punch whose face stays in contact has no error in time
        if errors[2] > 1e-6 {
            orders.push((errors[0] / errors[2]).log2() / 2.0, "");
        }
        last.push(errors[2], "");
    }
    elastic.print("elastic contacts", 0);
    orders.print("order", 0);
    last.print("in 64 steps", 0);
    assert!(elastic.greatest() < 1e-5, "{elastic:?}");
    assert!(2 * orders.count() as u64 > scenes && orders.quantile(0.0) > 0.9 && orders.median() < 1.2, "{orders:?}");
    assert!(last.greatest() < 0.01, "{last:?}");
}

/// Σ K p by FFT and by sums; coefficients of Eq. 8 as in the crate.
#[test]
fn convolutions_are_sums_and_coefficients_those_of_the_crate() {
    let (grid, mut draws) = (paper::Grid { cells: 12, side: 1.0e-3 }, Draws::new(5));
    let pressure: Vec<f64> = (0..grid.len()).map(|_| draws.between(0.0, 1.0)).collect();
    let influence = paper::Influence::new(grid);
    let (fast, sums) = (influence.displacement(&pressure), influence.displacement_by_sums(&pressure));
    let crates = Grid::square(12, 12.0e-3).unwrap();
    let kernel = InfluenceKernel::half_space(&crates).unwrap();
    let mut of_crate = vec![0.0; grid.len()];
    kernel.convolve(&pressure, &mut of_crate, &mut kernel.workspace().unwrap()).unwrap();
    for k in 0..grid.len() {
        assert!((fast[k] - sums[k]).abs() < 1e-14 * 12.0 && (fast[k] / of_crate[k] - 1.0).abs() < 1e-12, "{k}");
    }
}
