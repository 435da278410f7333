//! The largest loads that friction can carry.
//!
//! A load Q is carried if no rigid motion w gains from it: Σ r |B w| ≥ Q·w for all w (the theorem of limit analysis;
//! S. Goyal, A. Ruina, J. Papadopoulos, Wear 143, 1991, call the set of such loads the limit surface). The least of
//! Σ r |B w| over Q·w = 1, a convex problem of three unknowns, is how many times Q may grow.

use crate::friction::problem::{Problem, dot, rigid};
use crate::linalg;

/// How often the length below which a speed is rounded off is quartered.
const ROUNDINGS: usize = 40;
/// Newton steps for each.
const STEPS: usize = 30;

impl Problem<'_> {
    /// Whether the body moves a cell at all: not one that it meets at the very end of a step.
    fn moves(&self, i: usize) -> bool {
        self.entered[i] > 0.0
    }

    /// Σ r |B w| over Σ r, and the derivatives of its rounded form, |v| → √(v² + ε²), in units that make the components
    /// alike.
    fn dissipation(&self, w: [f64; 3], units: [f64; 3], rounding: f64) -> (f64, [f64; 3], [[f64; 3]; 3]) {
        let (mut sum, mut slope, mut bend, total) = (0.0, [0.0; 3], [[0.0; 3]; 3], self.total());
        for i in self.touching().filter(|&i| self.moves(i)) {
            let modes: [[f64; 2]; 3] = std::array::from_fn(|k| rigid(k, self.places[i]).map(|value| units[k] * value));
            let v = [0, 1].map(|axis| (0..3).map(|k| w[k] * modes[k][axis]).sum::<f64>());
            let (size, bound) = (v[0].hypot(v[1]).hypot(rounding), self.bound[i] / total);
            sum += bound * size;
            let along = modes.map(|mode| dot(mode, v) / size);
            for a in 0..3 {
                slope[a] += bound * along[a];
                (0..3).for_each(|b| bend[a][b] += bound / size * (dot(modes[a], modes[b]) - along[a] * along[b]));
            }
        }
        (sum, slope, bend)
    }

    fn total(&self) -> f64 {
        self.touching().filter(|&i| self.moves(i)).map(|i| self.bound[i]).sum()
    }

    /// How many times the prescribed forces may grow before the contact slides, and the rigid motion in which it then
    /// does (shifts and twist, of the largest component 1). A motion that is prescribed holds the body. Of no meaning
    /// where the step is cancelled.
    pub(super) fn load_factor(&self) -> (f64, [f64; 3]) {
        let (wanted, is_driven) =
            (self.wanted.map(|wanted| wanted.unwrap_or(0.0)), self.wanted.map(|wanted| wanted.is_some()));
        let total = self.total();
        let arm =
            self.touching().map(|i| self.bound[i] / total * self.places[i][0].hypot(self.places[i][1])).sum::<f64>();
        let units = [1.0, 1.0, if arm > 0.0 { 1.0 / arm } else { 1.0 }];
        let load: [f64; 3] = std::array::from_fn(|k| if is_driven[k] { units[k] * wanted[k] } else { 0.0 });
        let size = load[0].hypot(load[1]).hypot(load[2]);
        if size == 0.0 {
            return (f64::INFINITY, [0.0; 3]);
        }
        let load = load.map(|q| q / size);
        let shown = |w: [f64; 3]| {
            let motion: [f64; 3] = std::array::from_fn(|k| units[k] * w[k]);
            let most = motion.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            motion.map(|value| value / most)
        };
        if total == 0.0 {
            return (0.0, shown(load));
        }
        let mut w = load;
        let (mut best, mut rounding) = ((self.dissipation(w, units, 0.0).0, w), 1.0);
        for _ in 0..ROUNDINGS {
            for _ in 0..STEPS {
                let (value, slope, bend) = self.dissipation(w, units, rounding);
                // the Newton step in the plane Q·w = 1, held where motions are prescribed
                let mut system = [[0.0; 4]; 4];
                let mut right = [0.0; 4];
                for a in 0..3 {
                    if is_driven[a] {
                        (0..3).filter(|&b| is_driven[b]).for_each(|b| system[a][b] = bend[a][b]);
                        system[a][a] += 1e-14 / rounding;
                        (system[a][3], system[3][a], right[a]) = (load[a], load[a], -slope[a]);
                    }
                }
                let (step, _) = linalg::solve(system, right, 0.0);
                let gain: f64 = (0..3).map(|k| slope[k] * step[k]).sum();
                let mut length = 1.0;
                let moved = |length: f64| -> [f64; 3] { std::array::from_fn(|k| w[k] + length * step[k]) };
                while length > 1e-6 && self.dissipation(moved(length), units, rounding).0 > value + 1e-4 * length * gain
                {
                    length *= 0.5;
                }
                w = moved(length);
                if gain.abs() <= 1e-12 * value || self.is_cancelled() {
                    break;
                }
            }
            let value = self.dissipation(w, units, 0.0).0;
            if value < best.0 {
                best = (value, w);
            }
            rounding *= 0.25;
            if rounding < 1e-12 * best.0 || self.is_cancelled() {
                break;
            }
        }
        (best.0 * (total / size), shown(best.1))
    }
}
