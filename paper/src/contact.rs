//! The contact problem of a step, which is that of an elastic body: Eq. 1 to 5.

use crate::influence::Influence;

/// The force W \[N\] on the rigid body and, if it is free to tilt, the point e \[m\] at which it acts.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    pub force: f64,
    pub at: Option<[f64; 2]>,
}

/// Pressure p, and the motion of the rigid body: approach ω \[m\] and tilt α.
#[derive(Debug, Clone, Default)]
pub struct State {
    pub pressure: Vec<f64>,
    pub approach: f64,
    pub tilt: [f64; 2],
    /// Convolutions that it took.
    pub convolutions: usize,
}

/// Most iterations of a contact problem.
const MOST_ITERATIONS: usize = 20_000;

/// Finds p, ω and α with
///
/// ```text
/// (1)  h = h_i + u − ω − α₁ x₁ − α₂ x₂,   u = u_old + C K p
/// (2)  p ≥ 0, h ≥ 0     (3)  p h = 0
/// (4)  W = ΔA Σ p       (5)  W e = ΔA Σ p x
/// ```
///
/// by the conjugate gradients of Polonsky and Keer, from a first `guess` of the pressure, until p changes by less than
/// `tolerance` in an iteration, Σ |δp| over Σ p. `gap` is h_i + u_old; it is infinite outside the face of a punch. `None`
/// if they do not converge.
pub fn solve(
    influence: &Influence,
    compliance: f64,
    gap: &[f64],
    load: Load,
    guess: &[f64],
    tolerance: f64,
) -> Option<State> {
    let (grid, cells) = (influence.grid, gap.len());
    let area = grid.side * grid.side;
    let mut state = State { pressure: guess.to_vec(), ..State::default() };
    if state.pressure.iter().all(|p| *p <= 0.0) {
        state.pressure = gap.iter().map(|gap| if gap.is_finite() { 1.0 } else { 0.0 }).collect();
    }
    balance(&mut state.pressure, &grid, load, area)?;
    let (mut direction, mut square_before, mut conjugate) = (vec![0.0; cells], 1.0, 0.0);
    for _ in 0..MOST_ITERATIONS {
        let u = influence.displacement(&state.pressure);
        let on = |k: &usize| state.pressure[*k] > 0.0;
        let contact: Vec<usize> = (0..cells).filter(on).collect();
        // Eq. 1 before ω and α, which are those that fit best in contact
        let mut h: Vec<f64> = gap.iter().zip(&u).map(|(gap, u)| gap + compliance * u).collect();
        let [approach, tilt1, tilt2] = best_motion(&grid, &contact, &h, load);
        let motion = |k: usize| {
            let [x1, x2] = grid.center(k);
            approach + tilt1 * x1 + tilt2 * x2
        };
        (0..cells).for_each(|k| h[k] -= motion(k));
        (state.approach, state.tilt) = (approach, [tilt1, tilt2]);
        // the direction, conjugate to the one before unless cells have joined
        let square: f64 = contact.iter().map(|&k| h[k] * h[k]).sum();
        let old = std::mem::replace(&mut direction, vec![0.0; cells]);
        contact.iter().for_each(|&k| direction[k] = h[k] + conjugate * square / square_before * old[k]);
        square_before = square;
        // the length of the step along it
        let mut r: Vec<f64> = influence.displacement(&direction).iter().map(|u| compliance * u).collect();
        let [mean, slope1, slope2] = best_motion(&grid, &contact, &r, load);
        for (k, r) in r.iter_mut().enumerate() {
            let [x1, x2] = grid.center(k);
            *r -= mean + slope1 * x1 + slope2 * x2;
        }
        let sum = |of: &[f64]| contact.iter().map(|&k| of[k] * direction[k]).sum::<f64>();
        let (numerator, denominator) = (sum(&h), sum(&r));
        state.convolutions += 2;
        let length = if denominator == 0.0 { 0.0 } else { numerator / denominator };
        let before = state.pressure.clone();
        contact.iter().for_each(|&k| state.pressure[k] = (before[k] - length * direction[k]).max(0.0));
        // Eq. 2: cells that overlap without pressure join
        let joined: Vec<usize> = (0..cells).filter(|&k| state.pressure[k] == 0.0 && h[k] < 0.0).collect();
        let mean = load.force / area / contact.len() as f64;
        let step = length.abs();
        joined.iter().for_each(|&k| state.pressure[k] = if step > 0.0 { -step * h[k] } else { mean });
        conjugate = if joined.is_empty() { 1.0 } else { 0.0 };
        balance(&mut state.pressure, &grid, load, area)?;
        let change: f64 = state.pressure.iter().zip(&before).map(|(now, before)| (now - before).abs()).sum();
        if joined.is_empty() && change <= tolerance * before.iter().sum::<f64>() {
            return Some(state);
        }
    }
    None
}

/// The free motions, as functions of the position: 1, and x₁ and x₂ for a body that tilts.
fn modes(x: [f64; 2], load: Load) -> [f64; 3] {
    if load.at.is_some() { [1.0, x[0], x[1]] } else { [1.0, 0.0, 0.0] }
}

/// The motion ω + α₁ x₁ + α₂ x₂ nearest to a field in contact, in the sense of least squares.
fn best_motion(grid: &crate::Grid, contact: &[usize], field: &[f64], load: Load) -> [f64; 3] {
    let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for &k in contact {
        let own = modes(grid.center(k), load);
        for i in 0..3 {
            (0..3).for_each(|j| matrix[i][j] += own[i] * own[j]);
            right[i] += own[i] * field[k];
        }
    }
    solve_three(matrix, right)
}

/// Eq. 4 and 5: multiplies the pressure by a + b₁ x₁ + b₂ x₂, so that it carries force and moment.
fn balance(pressure: &mut [f64], grid: &crate::Grid, load: Load, area: f64) -> Option<()> {
    let [e1, e2] = load.at.unwrap_or_default();
    let wanted = [1.0, e1, e2].map(|arm| arm * load.force / area);
    for _ in 0..50 {
        let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for (k, p) in pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let own = modes(grid.center(k), load);
            (0..3).for_each(|i| (0..3).for_each(|j| matrix[i][j] += p * own[i] * own[j]));
        }
        (0..3).for_each(|i| right[i] = if load.at.is_some() || i == 0 { wanted[i] } else { 0.0 });
        let factor = solve_three(matrix, right);
        let mut cut = false;
        for (k, p) in pressure.iter_mut().enumerate() {
            let own = modes(grid.center(k), load);
            let scaled = *p * (0..3).map(|i| factor[i] * own[i]).sum::<f64>();
            cut |= scaled < 0.0;
            *p = scaled.max(0.0);
        }
        if !cut {
            return Some(());
        }
    }
    None
}

/// Gaussian elimination of three equations; what no equation determines is 0.
fn solve_three(mut a: [[f64; 3]; 3], mut b: [f64; 3]) -> [f64; 3] {
    for k in 0..3 {
        for i in k + 1..3 {
            let factor = if a[k][k] == 0.0 { 0.0 } else { a[i][k] / a[k][k] };
            (k..3).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    let mut x = [0.0; 3];
    for k in (0..3).rev() {
        let rest: f64 = (k + 1..3).map(|j| a[k][j] * x[j]).sum();
        x[k] = if a[k][k] == 0.0 { 0.0 } else { (b[k] - rest) / a[k][k] };
    }
    x
}
