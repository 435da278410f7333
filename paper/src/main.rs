//! Figures 2 to 6 of the source paper as tables, and the cost that its section 4 states, by the paper's own algorithm.
//!
//! `cargo run --release -p viscocontact-paper` (a minute), or with a number of cells along a side, 64 by default.

use std::f64::consts::PI;
use std::time::Instant;

use viscocontact_paper::{Creep, Grid, History, Influence, Load};

/// Shear modulus \[Pa\], force \[N\] and radius \[m\] of sphere and punch. Bodies are incompressible: C(t) = J(t)/4.
const G: f64 = 1.0e6;
const FORCE: f64 = 1.0;
const SPHERE: f64 = 10.0e-3;
const PUNCH: f64 = 1.0e-3;

fn main() {
    let cells = std::env::args().nth(1).and_then(|cells| cells.parse().ok()).unwrap_or(64);
    figures_2_and_3(cells);
    figures_4_and_5(cells);
    figure_6(cells / 2);
    cost(cells / 2);
}

/// A flat punch under a force beside its axis, on an elastic body: a contact of one step.
fn figures_2_and_3(cells: usize) {
    println!("| e/R | greatest error of p, r < 0.8 R (Figure 2, Lur'e) | area over the face (Figure 3) | tilt |");
    println!("|---|---|---|---|");
    let grid = Grid { cells, side: 2.1 * PUNCH / cells as f64 };
    let radius = |k: usize| grid.center(k)[0].hypot(grid.center(k)[1]);
    let face = |k: usize| if radius(k) <= PUNCH { 0.0 } else { f64::INFINITY };
    for e in [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8] {
        let gap: Vec<f64> = (0..grid.len()).map(face).collect();
        let cells_of_face = gap.iter().filter(|gap| gap.is_finite()).count();
        let mut contact = History::new(Influence::new(grid), &|_| 0.25 / G, gap, 1e-7);
        if !contact.step(0.0, Load { force: FORCE, at: Some([e * PUNCH, 0.0]) }) {
            println!("| {e} | not converged | | |");
            continue;
        }
        let p = &contact.state.pressure;
        // (1 + 3 e x/R²) W/(2π R √(R² − r²)), as long as the whole face presses: e ≤ R/3
        let lure = |k: usize| {
            let x = grid.center(k)[0];
            (1.0 + 3.0 * e * x / PUNCH) * FORCE / (2.0 * PI * PUNCH * (PUNCH.powi(2) - radius(k).powi(2)).sqrt())
        };
        let inside = (0..grid.len()).filter(|k| radius(*k) < 0.8 * PUNCH);
        let error = inside.map(|k| (p[k] / lure(k) - 1.0).abs()).fold(0.0, f64::max);
        let error = if e < 1.0 / 3.0 { format!("{error:.1e}") } else { "opens".into() };
        let area = p.iter().filter(|p| **p > 0.0).count() as f64 / cells_of_face as f64;
        println!("| {e} | {error} | {area:.3} | {:.3e} |", contact.state.tilt[0]);
    }
}

/// A sphere under a force that is held from t = 0 on: Table 1.
struct StepLoadedSphere {
    creep: fn(f64) -> f64,
    /// n, and the factor before the integral, with τ = 1 s.
    n: f64,
}

/// J = (1 + t)/G, and J = 1/G + (1 − e^(−t))/G: G_K = G.
const MAXWELL: StepLoadedSphere = StepLoadedSphere { creep: |t| 0.25 * (1.0 + t) / G, n: 1.0 };
const ZENER: StepLoadedSphere = StepLoadedSphere { creep: |t| 0.25 * (2.0 - (-t).exp()) / G, n: 2.0 };

impl StepLoadedSphere {
    /// a(t) = (¾ R W C(t))^(1/3).
    fn radius(&self, t: f64) -> f64 {
        (0.75 * SPHERE * FORCE * (self.creep)(t)).cbrt()
    }

    /// p = 8G/(πR) [s(t) − ∫ e^(−n (t − t′)) s(t′) dt′], s = √(a² − r²), by the trapezoidal rule.
    fn pressure(&self, r: f64, t: f64) -> f64 {
        let s = |t: f64| (self.radius(t).powi(2) - r * r).max(0.0).sqrt();
        let parts = 4000;
        let at = |k: usize| t * k as f64 / parts as f64;
        let value = |k: usize| (self.n * (at(k) - t)).exp() * s(at(k));
        let sum: f64 = (1..parts).map(value).sum::<f64>() + 0.5 * (value(0) + value(parts));
        8.0 * G / (PI * SPHERE) * (s(t) - t / parts as f64 * sum)
    }

    fn contact(&self, cells: usize) -> History<'_> {
        let grid = Grid { cells, side: 2.25 * self.radius(2.0) / cells as f64 };
        let gap = (0..grid.len()).map(|k| grid.center(k).map(|x| x * x).iter().sum::<f64>() / (2.0 * SPHERE));
        History::new(Influence::new(grid), &self.creep as Creep<'_>, gap.collect(), 1e-8)
    }

    /// So many equal steps to 2 τ, after the one at t = 0.
    fn run(&self, cells: usize, steps: usize) -> History<'_> {
        let mut contact = self.contact(cells);
        for step in 0..=steps {
            let time = 2.0 * step as f64 / steps as f64;
            assert!(contact.step(time, Load { force: FORCE, at: None }), "the contact problem does not converge");
        }
        contact
    }

    /// Σ |p − p′| over Σ p′ against Table 1 at 2 τ.
    fn error(&self, contact: &History<'_>) -> f64 {
        let grid = contact.grid();
        let exact = |k: usize| self.pressure(grid.center(k)[0].hypot(grid.center(k)[1]), 2.0);
        let pairs = contact.state.pressure.iter().enumerate().map(|(k, p)| (p, exact(k)));
        let [off, sum] = pairs.fold([0.0; 2], |[off, sum], (p, exact)| [off + (p - exact).abs(), sum + exact]);
        off / sum
    }
}

fn figures_4_and_5(cells: usize) {
    println!("\n| figure | steps to 2 τ | error of p at 2 τ (L1, Table 1) |\n|---|---|---|");
    for (figure, sphere) in [(4, MAXWELL), (5, ZENER)] {
        println!("| {figure} | 100 | {:.1e} |", sphere.error(&sphere.run(cells, 100)));
    }
}

/// Convergence in time: the pressure against the one in many steps, on the same cells.
fn figure_6(cells: usize) {
    println!("\n| steps to 2 τ (Figure 6) | p(0) over that of 640 steps, less 1 | order |\n|---|---|---|");
    let middle = |steps: usize| MAXWELL.run(cells, steps).state.pressure[cells / 2 * (cells + 1)];
    let exact = middle(640);
    let mut last: Option<f64> = None;
    for steps in [10, 20, 40, 80] {
        let error = middle(steps) / exact - 1.0;
        let order = last.map_or(String::new(), |last| format!("{:.2}", (last / error).abs().log2()));
        println!("| {steps} | {error:.1e} | {order} |");
        last = Some(error);
    }
}

/// Section 4: O(N_t² N² log N).
fn cost(cells: usize) {
    println!("\n| steps N_t | convolutions of the past | of contact problems | s |\n|---|---|---|---|");
    for steps in [25, 50, 100, 200] {
        let start = Instant::now();
        let [past, solved] = MAXWELL.run(cells, steps).convolutions;
        println!("| {steps} | {past} | {solved} | {:.2} |", start.elapsed().as_secs_f64());
    }
}
