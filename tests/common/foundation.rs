//! Winkler elements of the method of dimensionality reduction, each marched by itself: an
//! axisymmetric contact of a body with a Prony series, or with a dashpot beside a spring. It shares
//! nothing with the crate, and follows a prescribed approach or the far end of a spring.

/// The relaxation modulus of a contact: E∞ + Σ E_i exp(−t/τ_i) + η δ(t), with terms or with η.
#[derive(Debug, Clone, Default)]
pub struct Relaxation {
    pub equilibrium: f64,
    /// E_i and τ_i.
    pub terms: Vec<(f64, f64)>,
    pub viscosity: f64,
}

impl Relaxation {
    /// The mean response to a displacement that grows for this time.
    pub fn over(&self, time: f64) -> f64 {
        let part = |&(modulus, tau): &(f64, f64)| -modulus * tau / time * (-time / tau).exp_m1();
        self.equilibrium + self.viscosity / time + self.terms.iter().map(part).sum::<f64>()
    }
}

/// Elements at rest. Those that were never touched are not marched.
pub struct Foundation {
    body: Relaxation,
    /// Of each element: gap, weight in the force, displacement, the depth that touches it, and the
    /// stress of each term.
    gaps: Vec<f64>,
    weights: Vec<f64>,
    moved: Vec<f64>,
    touched: Vec<f64>,
    stresses: Vec<Vec<f64>>,
    /// Number of elements from the first that were touched so far.
    reached: usize,
    pub depth: f64,
    pub force: f64,
}

/// What acts at the end of a step.
#[derive(Debug, Clone, Copy)]
pub enum Drive {
    /// A depth, and its rate there.
    Approach(f64, f64),
    /// The far end of a spring of this stiffness at the end of the step, and at its start.
    Spring(f64, [f64; 2]),
}

impl Foundation {
    /// So many elements within a radius, with the gap `gap` at each place; the first of a body with
    /// a dashpot is at the centre.
    pub fn new(body: &Relaxation, radius: f64, count: usize, gap: impl Fn(f64) -> f64) -> Foundation {
        let width = radius / count as f64;
        let first = if body.viscosity > 0.0 { 0.0 } else { 0.5 };
        let gaps = (0..count).map(|k| gap((k as f64 + first) * width)).collect();
        let mut weights = vec![2.0 * width; count];
        weights[0] *= if count > 1 { 0.5 + first } else { 1.0 };
        Foundation {
            body: body.clone(),
            gaps,
            weights,
            moved: vec![0.0; count],
            touched: vec![0.0; count],
            stresses: vec![vec![0.0; count]; body.terms.len()],
            reached: 0,
            depth: 0.0,
            force: 0.0,
        }
    }

    /// The part of the elements that were touched so far.
    pub fn reached(&self) -> f64 {
        self.reached as f64 / self.gaps.len() as f64
    }

    /// Takes a step in which all displacements are linear. Of a body with a dashpot the stress in
    /// the middle of the step counts, and elements recover exactly under a prescribed approach.
    pub fn step(&mut self, dt: f64, drive: Drive) {
        let (viscous, equilibrium) = (self.body.viscosity > 0.0, self.body.equilibrium);
        let factors: Vec<[f64; 2]> = self
            .body
            .terms
            .iter()
            .map(|&(modulus, tau)| {
                let x = dt / tau;
                let mean = if x > 1e-8 { -(-x).exp_m1() / x } else { 1.0 - 0.5 * x };
                [(-x).exp(), modulus * mean]
            })
            .collect();
        let rate = if viscous { self.body.viscosity / dt } else { 0.0 };
        let share = if viscous { 0.5 } else { 1.0 };
        let stiffness = share * equilibrium + rate + factors.iter().map(|factor| factor[1]).sum::<f64>();
        let left_of_displacement = match drive {
            Drive::Approach(..) if viscous => (-dt * equilibrium / self.body.viscosity).exp(),
            _ => (rate - share * equilibrium) / stiffness,
        };
        for k in 0..self.reached {
            let moved = self.moved[k];
            self.touched[k] = self.gaps[k]
                + if viscous {
                    left_of_displacement * moved
                } else {
                    let left = |(stresses, [decay, mean]): (&Vec<f64>, &[f64; 2])| decay * stresses[k] - mean * moved;
                    -self.stresses.iter().zip(&factors).map(left).sum::<f64>() / stiffness
                };
        }
        let depth = match drive {
            Drive::Approach(depth, _) => depth,
            Drive::Spring(spring, [stop, before]) => {
                let drive = if viscous { stop + before - self.depth } else { stop };
                let depth = self.balanced(drive, share * spring, stiffness);
                if self.pressing(depth)[0] > 0.0 { depth } else { stop }
            }
        };
        while self.gaps.get(self.reached).is_some_and(|gap| depth > *gap) {
            self.touched[self.reached] = self.gaps[self.reached];
            self.reached += 1;
        }
        assert!(self.reached < self.gaps.len() || self.gaps.len() == 1, "the contact is wider than the elements");
        let mut force = 0.0;
        for k in 0..self.reached {
            let over = depth - self.touched[k];
            let moved = if over > 0.0 { depth } else { self.touched[k] } - self.gaps[k];
            let change = moved - self.moved[k];
            for (stresses, [decay, mean]) in self.stresses.iter_mut().zip(&factors) {
                stresses[k] = stresses[k] * decay + mean * change;
            }
            self.moved[k] = moved;
            let stress = match drive {
                _ if over <= 0.0 => 0.0,
                Drive::Approach(_, rate) if viscous => equilibrium * moved + self.body.viscosity * rate,
                _ => stiffness * over,
            };
            if stress < 0.0 {
                self.moved[k] = (self.touched[k] - self.gaps[k]).max(depth - self.gaps[k]);
            }
            force += self.weights[k] * stress.max(0.0);
        }
        if let Drive::Approach(_, rate) = drive
            && viscous
        {
            force = self.resisting(depth, rate);
        } else if let Drive::Spring(spring, [stop, _]) = drive
            && viscous
        {
            force = if force > 0.0 { (spring * (stop - depth)).max(0.0) } else { 0.0 };
        }
        (self.depth, self.force) = (depth, force);
    }

    /// The force of elements with a dashpot at a depth that changes at this rate: linear between
    /// elements, up to the edges of the contact between them.
    fn resisting(&self, depth: f64, rate: f64) -> f64 {
        // overlap and stress of an element, if it touches
        let at = |k: usize| {
            let touched = if k < self.reached { self.touched[k] } else { self.gaps[k] };
            [depth - touched, self.body.equilibrium * (depth - self.gaps[k]) + self.body.viscosity * rate]
        };
        let presses = |element: [f64; 2]| element[0] > 0.0 && element[1] > 0.0;
        let mut force = 0.0;
        // the gap is a power of the radius
        let power = (self.gaps[2] / self.gaps[1]).log2();
        for k in 0..self.reached.min(self.gaps.len() - 1) {
            let [mut inner, mut outer] = [at(k), at(k + 1)];
            if !presses(inner) {
                (inner, outer) = (outer, inner);
            }
            if presses(inner) {
                let to = |j: usize| if outer[j] <= 0.0 { inner[j] / (inner[j] - outer[j]) } else { 1.0 };
                let of_overlap = if k == 0 { to(0).powf(1.0 / power) } else { to(0) };
                let part = of_overlap.min(to(1));
                force += self.weights[1] * part * (inner[1] + 0.5 * part * (outer[1] - inner[1]));
            }
        }
        force
    }

    /// The sum of what presses at a depth, over the stiffness of an element, and its slope.
    fn pressing(&self, depth: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        let mut press = |touched: f64, weight: f64| {
            if depth > touched {
                sums[0] += weight * (depth - touched);
                sums[1] += weight;
            }
        };
        self.touched[..self.reached].iter().zip(&self.weights).for_each(|(touched, weight)| press(*touched, *weight));
        let fresh = self.gaps[self.reached..].iter().take_while(|gap| depth > **gap);
        fresh.zip(&self.weights).for_each(|(gap, weight)| press(*gap, *weight));
        sums
    }

    /// The depth at which a spring whose far end is at `drive` balances the elements: a convex
    /// function of the depth, by Newton's method.
    fn balanced(&self, drive: f64, spring: f64, stiffness: f64) -> f64 {
        let mut depth = self.depth;
        for _ in 0..200 {
            let [force, slope] = self.pressing(depth).map(|sum| stiffness * sum);
            let next = depth - (force + spring * (depth - drive)) / (slope + spring);
            if (next - depth).abs() <= 1e-15 * next.abs() {
                return next;
            }
            depth = next;
        }
        depth
    }
}
