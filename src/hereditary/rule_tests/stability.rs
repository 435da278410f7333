//! What free cells do, step after step: nothing may grow.

use super::{bodies, kelvin_voigt};
use crate::hereditary::remembered_field::RememberedField;
use crate::hereditary::{ExponentialRule, Interpolant};
use crate::rheology::CreepSpectrum;

const CORRECTED: [Interpolant; 2] = [Interpolant::CorrectedLinear, Interpolant::CorrectedQuadratic];

/// Free cells, v = 0, each of which begins with one of u, its differences and q_i/E(0) alone.
struct Free {
    rule: ExponentialRule,
    field: RememberedField,
    interpolant: Interpolant,
    /// E(0), or 1 for a dashpot alone.
    modulus: f64,
}

impl Free {
    fn new(body: &CreepSpectrum, interpolant: Interpolant) -> Free {
        let (rule, relaxation) = (ExponentialRule::new(body), body.relaxation());
        let differences = if rule.has_dashpot() || interpolant == Interpolant::CorrectedQuadratic { 2 } else { 1 };
        let field = RememberedField::new(rule.branches(), 1 + differences + rule.branches());
        let modulus = relaxation.modulus(0.0);
        Free { rule, field, interpolant, modulus: if modulus > 0.0 { modulus } else { 1.0 } }
    }

    fn step(&mut self, dt: f64) {
        self.rule.compute_weights(dt, self.interpolant);
        self.field.predict(&self.rule);
        self.rule.commit();
        self.field.commit();
    }

    /// Calls `change` with each part of the state: a field in which each cell holds what became of its beginning.
    fn parts(&mut self, mut change: impl FnMut(usize, f64, &mut [f64])) {
        self.field.apply_pending_step(&self.rule);
        let (cells, branches) = (self.field.now.len(), self.rule.branches());
        let (mut part, modulus) = (0, self.modulus);
        self.field.change_start(&mut vec![0.0; cells], |own| {
            change(part, if (1..=branches).contains(&part) { modulus } else { 1.0 }, own);
            part += 1;
        });
        assert_eq!(part, cells);
    }

    fn begin(&mut self) {
        self.parts(|part, unit, own| {
            own.fill(0.0);
            own[part] = unit;
        });
    }

    /// From the beginnings to the present state, row by row.
    fn matrix(&mut self) -> Vec<Vec<f64>> {
        let mut matrix = vec![Vec::new(); self.field.now.len()];
        self.parts(|part, unit, own| matrix[part] = own.iter().map(|value| value / unit).collect());
        matrix
    }
}

/// The maximum sum of absolute values of a row.
fn norm(matrix: &[Vec<f64>]) -> f64 {
    matrix.iter().map(|row| row.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max)
}

fn square(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut square = vec![vec![0.0; matrix.len()]; matrix.len()];
    for (row, own) in square.iter_mut().zip(matrix) {
        for (factor, other) in own.iter().zip(matrix) {
            row.iter_mut().zip(other).for_each(|(sum, value)| *sum += factor * value);
        }
    }
    square
}

/// How often the matrix of a period is squared: with a norm of 1e4 in the end, the spectral radius is at most
/// 1 + 5e-13.
const SQUARES: u32 = 44;

/// An upper bound of the spectral radius of a period of steps that begins with a step `first`: the norm of a very
/// high power of its matrix, to the inverse of that power.
fn radius(body: &CreepSpectrum, interpolant: Interpolant, first: f64, ratios: &[f64]) -> f64 {
    let mut free = Free::new(body, interpolant);
    let period = |free: &mut Free| {
        let mut dt = first;
        for ratio in ratios {
            free.step(dt);
            dt *= ratio;
        }
    };
    (0..4).for_each(|_| period(&mut free));
    free.begin();
    period(&mut free);
    let mut matrix = free.matrix();
    for squares in 0..SQUARES {
        let norm = norm(&matrix);
        if !(1e-100..1e100).contains(&norm) {
            return norm.powf(0.5_f64.powi(squares as i32));
        }
        matrix = square(&matrix);
    }
    norm(&matrix).powf(0.5_f64.powi(SQUARES as i32))
}

/// Steps from 1e-12 to 1e12 relaxation times, closer together where they are about as long as one.
fn lengths() -> Vec<f64> {
    let near = (-4..8).map(|k| 10f64.powf(0.25 * f64::from(k)));
    (-12..=12).map(|k| 10f64.powi(k)).chain(near).collect()
}

#[test]
fn no_periodic_sequence_of_steps_grows() {
    for interpolant in CORRECTED {
        let mut worst = (0.0, String::new());
        for (name, body) in bodies() {
            for r in [1.0, 1.5, 2.0, 2.4, 3.0, 3.9, 5.0_f64] {
                let i = 1.0 / r;
                for ratios in [&[r, i][..], &[r, r, i * i], &[r, 1.0, i], &[r, r, r, i, i, i], &[i, i, r * r]] {
                    for first in lengths() {
                        let radius = radius(&body, interpolant, first, ratios);
                        if radius > worst.0 {
                            worst = (radius, format!("{name}, ratios {ratios:.2?} from {first:.1e}"));
                        }
                    }
                }
            }
        }
        println!("{interpolant:?}: radius - 1 = {:.1e}, {}", worst.0 - 1.0, worst.1);
        assert!(worst.0 <= 1.0 + 1e-12, "{interpolant:?}: {:e}, {}", worst.0 - 1.0, worst.1);
    }
}

/// Steps that go on growing, or shrinking, by the same ratio over 24 decades: the largest that any state becomes.
#[test]
fn growing_steps_amplify_little() {
    for interpolant in CORRECTED {
        for (name, body) in bodies() {
            // the moduli of seventeen decades add up to so much more than that of the last
            let most_allowed = match name {
                "seventeen decades" => 12000.0,
                _ if body.glassy() == 0.0 => 75.0,
                _ => 12.0,
            };
            let mut line = String::new();
            for ratio in [1.5, 2.0, 2.4, 3.0, 3.9, 5.0, 0.5, 0.2_f64] {
                let mut dt = if ratio > 1.0 { 1e-12 } else { 1e12 };
                let mut free = Free::new(&body, interpolant);
                (1..=5).rev().for_each(|k| free.step(dt / ratio.powi(k)));
                free.begin();
                let mut most = 0.0_f64;
                while (1e-12..=1e12).contains(&dt) {
                    free.step(dt);
                    most = most.max(norm(&free.matrix()));
                    dt *= ratio;
                }
                line += &format!(" {ratio}: {most:.3}");
                assert!(most < most_allowed, "{name}, {interpolant:?}, {ratio}: {most}");
            }
            println!("{interpolant:?}, {name}: {line}");
        }
    }
}

/// A free cell after steps of very many times: recovered, but for what flowed.
#[test]
fn a_long_step_recovers_all() {
    for interpolant in CORRECTED {
        for (name, body) in bodies().into_iter().chain([("Kelvin-Voigt", kelvin_voigt())]) {
            let mut free = Free::new(&body, interpolant);
            (0..4).for_each(|_| free.step(0.1));
            free.begin();
            (0..4).for_each(|_| free.step(1e22));
            let (fluid, matrix) = (body.fluidity() > 0.0, free.matrix());
            for (i, row) in matrix.iter().enumerate() {
                for (j, left) in row.iter().enumerate() {
                    // all that was remembered ends as flow
                    let lasts = fluid && i == 0;
                    assert!(lasts || left.abs() < 1e-9, "{name}, {interpolant:?}: {i} {j} {left:e}");
                }
            }
        }
    }
}
