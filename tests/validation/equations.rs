//! The equations of the source paper, evaluated as they stand from what a caller sees of a run.

use crate::common::builder_of;
use crate::common::fields::gap;
use std::f64::consts::PI;

use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;

const SHEAR_MODULUS: f64 = 2.0e6;
const POISSON: f64 = 0.3;
const CELLS: [usize; 2] = [14, 11];
const RADIUS: f64 = 0.38e-3;
/// Lengths of the steps \[s\], forces \[N\] and where they act \[m\]: a jump, steps of unequal lengths, a contact that opens.
const STEPS: [(f64, f64, [f64; 2]); 6] = [
    (0.0, 0.02, [0.0, 0.0]),
    (0.3, 0.02, [0.1e-3, 0.0]),
    (0.1, 0.05, [0.1e-3, 0.05e-3]),
    (0.5, 0.05, [0.25e-3, -0.05e-3]),
    (0.2, 0.03, [0.25e-3, -0.1e-3]),
    (0.0, 0.01, [-0.1e-3, -0.1e-3]),
];

/// A punch with a domed face.
fn initial_gap(x1: f64, x2: f64) -> f64 {
    let squared = x1 * x1 + x2 * x2;
    if squared < RADIUS * RADIUS { 20.0 * squared } else { f64::INFINITY }
}

/// A state after a step, as a caller sees it.
struct State {
    time: f64,
    pressure: Vec<f64>,
    displacement: Vec<f64>,
    gap: Vec<f64>,
    approach: f64,
    tilt: [f64; 2],
}

struct Run {
    grid: Grid,
    kernel: InfluenceKernel,
    states: Vec<State>,
}

fn zener() -> Material {
    Material::constant_poisson(Zener::new(SHEAR_MODULUS, 1.5e6, 0.6e6).unwrap(), POISSON).unwrap()
}

/// Solved far below the tolerances of these tests.
fn run(material: Material) -> Run {
    let grid = Grid::new(CELLS, [1.0e-3, 0.9e-3]).unwrap();
    let settings = Settings::default().with_tolerance(1e-11);
    let shape = FnGeometry::new(initial_gap);
    let builder = builder_of(&shape, grid.clone(), material);
    let mut contact = builder.settings(settings).build().unwrap();
    let mut states = Vec::new();
    for (dt, force, at) in STEPS {
        contact.step(dt, Load::eccentric_force(force, at)).unwrap();
        states.push(State {
            time: contact.time(),
            pressure: contact.pressure().to_vec(),
            displacement: contact.fields().displacement().to_vec(),
            gap: gap(contact.fields()),
            approach: contact.approach(),
            tilt: contact.tilt(),
        });
    }
    Run { kernel: InfluenceKernel::half_space(&grid).unwrap(), grid, states }
}

impl Run {
    fn centers(&self) -> impl Iterator<Item = [f64; 2]> {
        (0..self.grid.len()).map(|cell| self.grid.center(cell / CELLS[1], cell % CELLS[1]))
    }

    /// The double sum of K(i − k, j − l) p(k, l) over all cells (k, l), by coefficients.
    fn sum(&self, pressure: &[f64], cell: usize) -> f64 {
        let offset = |to: usize, from: usize| to as isize - from as isize;
        let k = |from: usize| {
            let [i, j] = [offset(cell / CELLS[1], from / CELLS[1]), offset(cell % CELLS[1], from % CELLS[1])];
            self.kernel.coefficient(i, j).unwrap()
        };
        pressure.iter().enumerate().filter(|(_, p)| **p != 0.0).map(|(from, p)| k(from) * p).sum()
    }
}

/// h = h_i + u − ω − α₁ x₁ − α₂ x₂.
#[test]
fn equation_1_is_the_gap() {
    let run = run(zener());
    assert!(run.states.iter().all(|state| state.tilt[1] != 0.0 || state.time == 0.0));
    for State { displacement, gap, approach, tilt, .. } in &run.states {
        for (([x1, x2], u), h) in run.centers().zip(displacement).zip(gap) {
            let exact = initial_gap(x1, x2) + u - approach - tilt[0] * x1 - tilt[1] * x2;
            assert!(*h == exact || (h - exact).abs() < 1e-14 * approach, "{h} {exact}");
        }
    }
}

/// p ≥ 0, h ≥ 0 and p h = 0, on the whole face and, once it tilts, on a part of it.
#[test]
fn equations_2_and_3_are_the_conditions_of_contact() {
    let mut open = Vec::new();
    for State { pressure, gap, approach, .. } in run(zener()).states {
        open.push(pressure.iter().zip(&gap).filter(|(p, h)| **p == 0.0 && h.is_finite()).count());
        for (&p, &h) in pressure.iter().zip(&gap) {
            assert!(p >= 0.0 && h >= -1e-9 * approach && (p == 0.0 || h <= 1e-9 * approach), "{p} {h}");
        }
    }
    assert!(open[0] == 0 && open[3..].iter().all(|&cells| cells > 20), "{open:?}");
}

/// W = Σ p ΔA and W e = Σ p x ΔA.
#[test]
fn equations_4_and_5_balance_the_load() {
    let run = run(zener());
    for (State { pressure, .. }, (_, force, at)) in run.states.iter().zip(STEPS) {
        let total: f64 = pressure.iter().sum::<f64>() * run.grid.cell_area();
        assert_abs_diff_eq!(total, force, epsilon = 1e-12 * force);
        for axis in [0, 1] {
            let moment: f64 = run.centers().zip(pressure).map(|(x, p)| p * x[axis]).sum::<f64>() * run.grid.cell_area();
            assert!((moment - force * at[axis]).abs() < 1e-12 * force * RADIUS, "{moment} {force} {at:?}");
        }
    }
}

/// K_el is the integral of Boussinesq's B = (1 − ν)/(2πG r) over a cell, by the midpoint rule here.
#[test]
fn equations_6_and_8_integrate_boussinesqs_function() {
    let Run { grid, kernel, .. } = run(zener());
    let elastic = Material::constant_poisson(Elastic::new(SHEAR_MODULUS).unwrap(), POISSON).unwrap();
    let [d1, d2] = grid.spacing();
    let points = 200;
    for (i, j) in [(1, 0), (0, -2), (4, 3), (-13, 10)] {
        let at = |offset: isize, point: usize, side: f64| {
            side * (offset as f64 + (point as f64 + 0.5) / points as f64 - 0.5)
        };
        let distances = (0..points).flat_map(|k| (0..points).map(move |l| f64::hypot(at(i, k, d1), at(j, l, d2))));
        let b = |r: f64| (1.0 - POISSON) / (2.0 * PI * SHEAR_MODULUS * r);
        let integral = distances.map(b).sum::<f64>() * grid.cell_area() / (points * points) as f64;
        let found = elastic.contact_compliance(0.0) * kernel.coefficient(i, j).unwrap();
        assert!((found / integral - 1.0).abs() < 1e-5, "({i}, {j}): {found} {integral}");
    }
}

/// u(i, j) = ΣΣ K_el(i − k, j − l) p(k, l) on an elastic body.
#[test]
fn equation_7_is_the_displacement_of_an_elastic_body() {
    let run = run(Material::constant_poisson(Elastic::new(SHEAR_MODULUS).unwrap(), POISSON).unwrap());
    let factor = (1.0 - POISSON) / (2.0 * SHEAR_MODULUS);
    for State { pressure, displacement, approach, .. } in &run.states {
        for (cell, u) in displacement.iter().enumerate() {
            let sum = factor * run.sum(pressure, cell);
            assert_abs_diff_eq!(*u, sum, epsilon = 1e-13 * approach);
        }
    }
}
