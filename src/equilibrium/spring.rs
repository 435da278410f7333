//! Bodies that springs drive.
//!
//! The force F of a spring is the solution of g(F) = ω(F) + F/k − z = 0, with ω(F) the approach at the end of the
//! step under the force F. ω never falls as F grows, since it is the slope of a convex energy, so that there is one
//! solution. It is found by the steps of Barzilai and Borwein (IMA J. Numer. Anal. 8, 1988), which for one body are
//! those of the secant method. Each solves the contact problem from the pressure of the last, which is nearly in
//! balance.

use std::f64::consts::PI;

use crate::equilibrium::request::TriedSpring;
use crate::equilibrium::{Ground, Held, Request, Trial};
use crate::geometry::Gap;
use crate::load::Load;
use crate::quadrature::bisect;
use crate::solver::Outcome;
use crate::sum::ROUNDING;

/// The springs of the bodies, each with the body that it drives, its compliance \[m/N\] and its drive from the datum
/// of the gap.
fn springs(request: Request<'_>) -> impl Iterator<Item = (usize, f64, f64)> + Clone {
    let datum = request.indenter.gap().datum;
    request.loads.iter().enumerate().filter_map(move |(body, load)| match *load {
        Load::Spring { stiffness, drive, .. } => Some((body, 1.0 / stiffness, drive - datum)),
        Load::Force { .. } | Load::Approach { .. } => None,
    })
}

/// Estimated dω/dF, as of a circle with the area of the present contact in a step of compliance `c`.
fn yielding(ground: &Ground, held: &Held, c: f64) -> f64 {
    let pressed = (held.current.contact_cells.max(1) / ground.bodies).max(1) as f64;
    0.5 * c / (pressed * ground.grid.cell_area() / PI).sqrt()
}

/// The maximum part of an error of the force under a given approach that a spring leaves: 1 of a spring far stiffer
/// than the contact, 0 without springs.
pub(crate) fn share_of_force(ground: &Ground, held: &Held, request: Request<'_>, c: f64) -> f64 {
    let yielding = yielding(ground, held, c);
    springs(request).fold(0.0, |most, (_, give, _)| f64::max(most, yielding / (yielding + give)))
}

/// Writes the first forces to try to the free motions: those that the present pressure, and in a first contact the
/// shape, suggest.
pub(crate) fn guess_forces(ground: &Ground, held: &Held, gap: &Gap, request: Request<'_>, c: f64, trial: &mut Trial) {
    let (area, rows, now) = (held.region.cell_area(), held.region.rows(), &held.current.solution);
    for (body, give, drive) in springs(request) {
        let above = &trial.gap;
        let own = |k: usize| gap.owner(k) == body && above[k].is_finite();
        // Σ p, and Σ p times the height at which this pressure would hold a cell
        let [sum, heights] = rows.sum_terms(|k| {
            let (p, height) = (now.pressure[k], above[k] + c * now.potential[k]);
            (p > 0.0 && own(k)).then_some([p, p * height])
        });
        let force = if sum > 0.0 {
            let change = drive - give * sum * area - heights / sum;
            sum * area + change / (give + yielding(ground, held, c))
        } else {
            let heights = || (0..above.len()).filter(|&k| own(k)).map(|k| above[k]);
            let lowest = rows.least(heights().fold(f64::INFINITY, f64::min));
            // Hertz's force on the cells below half of a depth, see the cold start of the solver
            let carried = |depth: f64| {
                let level = lowest + 0.5 * depth;
                let cells = rows.count(heights().filter(|&height| height <= level).count()) as f64;
                0.5 * depth * (cells * area).sqrt() / (0.375 * PI.sqrt() * c)
            };
            let is_short = |depth: f64| depth + give * carried(depth) < drive - lowest;
            let depth = bisect(0.0, (drive - lowest).max(0.0), 40, is_short)[1];
            // a body that does not respond takes all that the spring presses with, beyond rounding
            let rounding = ROUNDING * (drive.abs() + lowest.abs() + gap.datum.abs());
            match depth > 0.0 {
                true if c > 0.0 => carried(depth),
                true if drive - lowest > rounding => (drive - lowest) / give,
                _ => 0.0,
            }
        };
        trial.free[body].total = force.max(0.0) / area;
        trial.springs[body] = TriedSpring::default();
    }
}

/// Solves the contact problem, again and again until the springs carry the forces that their approaches lead to.
pub(crate) fn solve_with_springs(
    ground: &Ground,
    held: &Held,
    request: Request<'_>,
    c: f64,
    trial: &mut Trial,
    mut solve: impl FnMut(&mut Trial) -> Outcome,
) -> Outcome {
    let (area, least) = (held.region.cell_area(), yielding(ground, held, c));
    let one_cell = c / ground.grid.cell_area().sqrt();
    for tries in 0..60 {
        let outcome = solve(trial);
        if springs(request).next().is_none() || outcome != Outcome::Converged {
            return outcome;
        }
        // Σ s (dg/dF) s by the estimate, and Σ s Δg
        let (mut estimated, mut found) = (0.0, 0.0);
        for (body, give, drive) in springs(request) {
            let (force, position) = (trial.free[body].total * area, trial.solution.motions[body].0[0]);
            let before = trial.springs[body];
            let now = TriedSpring { force, excess: position + give * force - drive, missing: 0.0, ..before };
            trial.springs[body] = now;
            let change = now.force - before.force;
            estimated += (give + least) * change * change;
            found += change * (now.excess - before.excess);
        }
        let ratio = if tries > 0 && found > 0.0 && estimated > 0.0 { estimated / found } else { 1.0 };
        let mut worst = 0.0f64;
        for (body, give, drive) in springs(request) {
            let TriedSpring { force, excess, hanging, .. } = trial.springs[body];
            let motion = &mut trial.solution.motions[body];
            if force == 0.0 && (excess >= 0.0 || hanging.is_some()) {
                *motion = hanging.unwrap_or(*motion);
                motion.0[0] = drive;
                continue;
            }
            let mut next = (force - ratio * excess / (give + least)).max(0.0);
            if next == 0.0 && trial.free[body].tilts() {
                // without force it hangs above the surface in this tilt, if it is higher than all of this force
                // lowers it
                let lifts = excess > 2.0 * force * (give + one_cell);
                (next, trial.springs[body].hanging) = if lifts { (0.0, Some(*motion)) } else { (0.1 * force, None) };
            }
            trial.springs[body].missing = (next - force).abs();
            worst = worst.max((next - force).abs() / force.max(next));
            trial.free[body].total = next / area;
        }
        // at a jump of a body without elastic response nothing moves; `worst` is a change that is still to come
        if c == 0.0 || worst <= 0.3 * request.tolerance {
            springs(request).for_each(|(body, ..)| trial.free[body].total = trial.springs[body].force / area);
            return outcome;
        }
        trial.predicted = false;
    }
    Outcome::Stagnated
}
