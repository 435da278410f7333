//! The hereditary integral of Eq. 9 and Eq. 10, as the sum of Eq. 11 with the coefficients of Eq. 12, and the flow chart of Figure 1.

use crate::contact::{Load, State, solve};
use crate::influence::Influence;

/// The contact creep compliance C(t) = (1 − ν) Φ(t) \[1/Pa\]: any function of time, measured data included.
pub type Creep<'a> = &'a dyn Fn(f64) -> f64;

/// A contact, and the pressures of all its steps so far.
pub struct History<'a> {
    influence: Influence,
    creep: Creep<'a>,
    /// h_i \[m\].
    initial_gap: Vec<f64>,
    tolerance: f64,
    /// Times t_m and increments p(m) − p(m − 1).
    increments: Vec<(f64, Vec<f64>)>,
    /// Pressure and motion at the end of the last step.
    pub state: State,
    /// Convolutions of the past and of contact problems so far.
    pub convolutions: [usize; 2],
}

impl<'a> History<'a> {
    /// An undisturbed contact; pressures change by less than `tolerance` in the last iteration of a contact problem.
    pub fn new(influence: Influence, creep: Creep<'a>, initial_gap: Vec<f64>, tolerance: f64) -> History<'a> {
        let state = State { pressure: vec![0.0; initial_gap.len()], ..State::default() };
        History { influence, creep, initial_gap, tolerance, increments: Vec::new(), state, convolutions: [0; 2] }
    }

    /// A step of Figure 1 to the time t_n; false if its contact problem does not converge.
    pub fn step(&mut self, time: f64, load: Load) -> bool {
        // displacement due to the past, and what is left of it under the pressure of this step
        let mut gap = self.past(time);
        let glassy = (self.creep)(0.0);
        let before = self.influence.displacement(&self.state.pressure);
        self.convolutions[0] += 1;
        // gap before any pressure: Eq. 1
        for (k, gap) in gap.iter_mut().enumerate() {
            *gap += self.initial_gap[k] - glassy * before[k];
        }
        // the contact problem of an elastic body of compliance C(0): Eq. 2 to 8
        let guess = &self.state.pressure;
        let Some(state) = solve(&self.influence, glassy, &gap, load, guess, self.tolerance) else { return false };
        self.convolutions[1] += state.convolutions;
        // the pressure is kept for the steps to come: Eq. 11
        let increment = state.pressure.iter().zip(guess).map(|(now, before)| now - before).collect();
        self.increments.push((time, increment));
        self.state = state;
        true
    }

    /// Eq. 11 and 12 up to the last step: Σ_m C(t_n − t_m) K [p(m) − p(m − 1)], every increment convolved anew, which
    /// makes the cost of N_t steps O(N_t² N² log N) (section 4).
    fn past(&mut self, time: f64) -> Vec<f64> {
        let mut u = vec![0.0; self.initial_gap.len()];
        for (then, increment) in &self.increments {
            let compliance = (self.creep)(time - then);
            let moved = self.influence.displacement(increment);
            self.convolutions[0] += 1;
            u.iter_mut().zip(&moved).for_each(|(u, moved)| *u += compliance * moved);
        }
        u
    }

    /// The grid.
    pub fn grid(&self) -> crate::Grid {
        self.influence.grid
    }
}
