//! v = ∫ E(t − s) du(s) by the recursion and by quadrature.

use super::integral::{Past, relaxing};
use super::{INTERPOLANTS, Random, bodies, creep};
use crate::hereditary::remembered_field::RememberedField;
use crate::hereditary::{ExponentialRule, Interpolant};
use crate::rheology::CreepSpectrum;

/// One cell whose displacement is prescribed.
struct Cell {
    rule: ExponentialRule,
    field: RememberedField,
}

impl Cell {
    fn new(body: &CreepSpectrum) -> Cell {
        let rule = ExponentialRule::new(body);
        Cell { field: RememberedField::new(rule.branches(), 1), rule }
    }

    /// v that moves the cell to `u` in a step, and what rounding of u makes of it.
    fn step(&mut self, dt: f64, u: f64, interpolant: Interpolant) -> [f64; 2] {
        self.rule.compute_weights(dt, interpolant);
        self.field.predict(&self.rule);
        let c = self.rule.compliance();
        let v = (u - self.field.trial[0]) / c;
        self.field.add(c, &[v]);
        self.field.trial[0] = u;
        self.rule.commit();
        self.field.commit();
        [v, u.abs() / c]
    }
}

fn random_body(random: &mut Random) -> CreepSpectrum {
    let mut terms: Vec<(f64, f64)> = Vec::new();
    for _ in 0..(1.0 + 5.0 * random.next()) as usize {
        terms.push((random.decades(0.1, 10.0), random.decades(1e-4, 1e4)));
    }
    let glassy = if random.next() < 0.6 { random.decades(0.1, 10.0) } else { 0.0 };
    let fluidity = if random.next() < 0.4 { random.decades(0.01, 100.0) } else { 0.0 };
    creep(glassy, fluidity, &terms)
}

/// Any body, any lengths of steps, jumps, corners, and changes of the interpolant.
#[test]
fn the_recursion_is_the_integral() {
    let mut random = Random(7);
    let mut worst = [0.0_f64; 3];
    for round in 0..600 {
        let body = random_body(&mut random);
        let (mut cell, mut past) = (Cell::new(&body), Past::undisturbed(&body.relaxation()));
        let own = round % 3;
        let changes = random.next() < 0.2;
        let mut dt = random.decades(1e-5, 1e3);
        for step in 0..24 {
            let which = if changes { (3.0 * random.next()) as usize } else { own };
            // ratios within the limits and far beyond them
            dt *= if random.next() < 0.7 { random.decades(0.4, 3.0) } else { random.decades(0.05, 20.0) };
            let jump = body.glassy() > 0.0 && random.next() < 0.1;
            if random.next() < 0.05 {
                cell.rule.reset_differences();
                past.reset_differences();
            }
            let (length, u) = (if jump { 0.0 } else { dt }, random.between(-1.0, 1.0));
            let [v, rounding] = cell.step(length, u, INTERPOLANTS[which]);
            past.step(length, u, INTERPOLANTS[which]);
            let [exact, size] = past.potential();
            let error = (v - exact).abs() / (size + rounding);
            assert!(error < 1e-12, "round {round}, step {step}, {:?}: {v:e} {exact:e}", INTERPOLANTS[which]);
            worst[own] = worst[own].max(error);
        }
    }
    println!("recursion and quadrature differ by {worst:?}");
}

/// After enough steps, all that v lacks is what the polynomial of the last step lacks: what lies before it is
/// remembered exactly, a quadratic by the corrected linear rule, a cubic by the corrected quadratic one.
#[test]
fn polynomials_are_remembered_exactly() {
    let mut random = Random(11);
    let several = [(1.0, 0.03), (0.5, 0.3), (0.5, 3.0)];
    for body in
        [creep(1.0, 0.0, &several), creep(1.0, 1.0, &several), creep(0.0, 0.0, &several), creep(0.0, 1.0, &several)]
    {
        let (relaxation, dashpot) = (body.relaxation(), body.glassy() == 0.0);
        for interpolant in [Interpolant::CorrectedLinear, Interpolant::CorrectedQuadratic] {
            let degree = if dashpot || interpolant == Interpolant::CorrectedQuadratic { 2 } else { 1 };
            // s from the middle of the run on
            let factor = if degree == 2 { 20.0 } else { 0.0 };
            let u = |s: f64| 2.0 + s + 0.3 * s * s + factor * s * s * s;
            let slope = |s: f64| 1.0 + 0.6 * s + 3.0 * factor * s * s;
            let mut cell = Cell::new(&body);
            // nodes, the last three
            let mut nodes = [-1.0; 3];
            let (mut dt, mut left) = (0.1_f64, 0.0_f64);
            for step in 0.. {
                dt = (dt * random.decades(0.55, 2.2)).clamp(0.02, 0.3);
                nodes = [nodes[1], nodes[2], nodes[2] + dt / 100.0];
                let [_, middle, end] = nodes;
                if end > 1.0 {
                    assert!(step > 600);
                    break;
                }
                // time runs 100 times as fast as s
                let [v, rounding] = cell.step(dt, u(end), interpolant);
                let at = |age: f64| end - age / 100.0;
                let exact_slope = |age: f64| slope(at(age)) / 100.0;
                let polynomial = |age: f64| {
                    let first = (u(end) - u(middle)) / (end - middle);
                    let second = (first - (u(middle) - u(nodes[0])) / (middle - nodes[0])) / (end - nodes[0]);
                    let second = if degree == 2 { second } else { 0.0 };
                    (first + second * (2.0 * at(age) - end - middle)) / 100.0
                };
                if end < 0.5 {
                    continue;
                }
                let whole = relaxing(&relaxation, 0.0, 150.0, exact_slope);
                let last = relaxing(&relaxation, 0.0, dt, |age| exact_slope(age) - polynomial(age));
                let fast = relaxation.viscosity() * polynomial(0.0);
                let exact = relaxation.equilibrium() * u(end) + whole - last + fast;
                let error = (v - exact).abs() / (v.abs() + rounding);
                assert!(error < 1e-12, "{interpolant:?}, {body:?}, step {step}: {v:e} {exact:e}");
                left = left.max(last.abs() / v);
            }
            assert!(left > 1e-9, "what the last step lacks counts: {left:e}");
        }
    }
}

/// After a step of very many relaxation times nothing is left of what was before, however long the steps before it
/// were.
#[test]
fn a_long_step_forgets() {
    for (name, body) in bodies() {
        for interpolant in INTERPOLANTS {
            let (mut one, mut other) = (Cell::new(&body), Cell::new(&body));
            let mut random = Random(3);
            for _ in 0..12 {
                let dt = random.decades(1e-3, 1e3);
                one.step(dt, random.next(), interpolant);
                other.step(dt, random.next(), interpolant);
            }
            // the same slope of u for all that is remembered
            let mut differ = f64::INFINITY;
            for dt in [1e22, 1e22, 1e22, 1e22] {
                let [a, rounding] = one.step(dt, 0.5, interpolant);
                let [b, _] = other.step(dt, 0.5, interpolant);
                differ = (a - b).abs() / rounding.max(f64::MIN_POSITIVE);
            }
            assert!(differ < 1e-12, "{name}, {interpolant:?}: {differ:e}");
        }
    }
}

/// In a long hold stresses relax to zero, and do not stay at numbers too small to be fast.
#[test]
fn what_has_relaxed_is_forgotten() {
    let times = [1e-2, 0.3, 10.0, 30.0, 100.0, 1e9];
    let body = creep(1.0, 0.0, &times.map(|time| (0.2, time)));
    for interpolant in INTERPOLANTS {
        let mut cell = Cell::new(&body);
        for _ in 0..40_000 {
            cell.step(1.0, 1.0, interpolant);
        }
        let mut found = Vec::new();
        cell.field.change_start(&mut [0.0], |values| found.extend_from_slice(values));
        assert!(!found.iter().any(|value| value.is_subnormal()), "{interpolant:?}: {found:?}");
        assert!(found.iter().filter(|value| **value == 0.0).count() >= 4, "{interpolant:?}: {found:?}");
        assert!(found.iter().filter(|value| **value > 1e-10).count() >= 2, "{interpolant:?}: {found:?}");
    }
}
