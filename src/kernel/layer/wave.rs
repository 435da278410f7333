//! The response of a layer to a wave of pressure.
//!
//! A pressure cos qx displaces the surface of the layer by C (2/q) L(t) cos qx, t = qh. In plane strain, with Airy's
//! function φ = f(z) cos qx, f = (A + B z) e^(−qz) + (C + D z) e^(qz), the surface gives f(0) = 1/q², f′(0) = 0, and
//! the base two conditions; L follows from 2G u_z = ((1 − ν) f‴ − (2 − ν) q² f′)/q² at the surface. With θ = e^(−2t),
//! a = 4 (1 − ν₁), kᵢ = 3 − 4νᵢ and the ratio μ = G₁/G₂ of the shear moduli of layer and base, zero if the base is
//! rigid,
//!
//! L = (1 + 4tκθ − λκθ²)/(1 − (λ + κ + 4κt²) θ + λκθ²),   κ = (μ − 1)/P, λ = (μ k₂ − k₁)/Q, P = μ + k₁, Q = 1 + μ k₂
//!
//! for a layer bonded to its base (D. M. Burmister, J. Appl. Phys. 16, 1945), and for one that slides on a rigid base
//! without friction (Lebedev & Ufliand, PMM 22, 1958)
//!
//! L = (cosh 2t − 1)/(sinh 2t + 2t).
//!
//! For t → 0 both parts of the first fraction may vanish. Multiplied by PQ/θ they are, exactly,
//!
//! N = α (sinh 2t − 2t) + β cosh 2t + 2t γ,   D = 2α (sinh² t − t²) + β sinh 2t + a² + 2 a t² (2 + μ (k₂ − 1))
//!
//! with α = 2μ² k₂ + μ (k₁ − 1)(k₂ − 1) + 2 k₁, β = a μ (1 + k₂), γ = 4μ² k₂ + μ (k₁ − 3)(k₂ − 1) + 2 (k₁ − 1): nothing
//! cancels in D, and in N only as far as γ may be negative, which is less than β makes up for.

/// Beyond this t the layer responds like a half-space, and e^(−2t) is zero.
const DEEP: f64 = 380.0;
/// Below this t the hyperbolic functions less the first terms of their series are summed term by term.
const SHALLOW: f64 = 0.75;

/// L(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Response {
    /// Bonded to a base, rigid or a half-space.
    Bonded(Bonded),
    /// Sliding without friction on a rigid base.
    Frictionless,
}

/// The coefficients of N and D of a layer bonded to its base, over (1 + μ)².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bonded {
    /// α, β, γ of N and D.
    sinh: f64,
    cosh: f64,
    linear: f64,
    /// a², and a (2 + μ (k₂ − 1)).
    constant: f64,
    square: f64,
    /// (N − D)/θ = `difference[0]` + `difference[1]` t (1 + t) + `difference[2]` (1 − θ).
    difference: [f64; 3],
}

impl Response {
    pub(super) fn bonded(poisson: f64, base_poisson: f64, mu: f64) -> Response {
        Response::Bonded(Bonded::new(poisson, base_poisson, mu))
    }

    /// L(t), right to rounding for every t ≥ 0.
    pub(super) fn at(&self, t: f64) -> f64 {
        if t > DEEP {
            return 1.0;
        }
        let theta = (-2.0 * t).exp();
        match self {
            Response::Bonded(own) => own.at(t, theta),
            Response::Frictionless => {
                let less = -(-2.0 * t).exp_m1();
                // over θ; 0/0 at 0
                if t == 0.0 { 0.0 } else { less * (less / (-(-4.0 * t).exp_m1() + 4.0 * t * theta)) }
            }
        }
    }

    /// L(t) − 1, which vanishes as e^(−2t) does, relative to e^(−2t).
    pub(super) fn less_one(&self, t: f64) -> f64 {
        if t > DEEP {
            return 0.0;
        }
        let theta = (-2.0 * t).exp();
        let less = -(-2.0 * t).exp_m1();
        match self {
            Response::Bonded(own) => {
                let [constant, polynomial, sliding] = own.difference;
                theta * (constant + polynomial * t * (1.0 + t) + sliding * less) / own.denominator(t, theta)
            }
            Response::Frictionless if t == 0.0 => -1.0,
            Response::Frictionless => -2.0 * theta * (less + 2.0 * t) / (-(-4.0 * t).exp_m1() + 4.0 * t * theta),
        }
    }

    /// The least t at which L changes its course: soft bases dominate for waves much longer than the layer is thick.
    pub(super) fn least_scale(&self) -> f64 {
        match self {
            Response::Bonded(own) if own.cosh > 0.0 => (own.constant / own.cosh).min(1.0),
            _ => 1.0,
        }
    }
}

impl Bonded {
    fn new(poisson: f64, base_poisson: f64, mu: f64) -> Bonded {
        let [k1, k2] = [poisson, base_poisson].map(|nu| 3.0 - 4.0 * nu);
        let a = 4.0 * (1.0 - poisson);
        // (1 + μ)², divided by factor by factor so that no product overflows
        let (unit, ratio) = (1.0 / (1.0 + mu), mu / (1.0 + mu));
        let [first1, first2] = [2.0 * (1.0 - 2.0 * poisson), 2.0 * (1.0 - 2.0 * base_poisson)];
        let q = unit + ratio * k2;
        Bonded {
            sinh: ratio * 2.0 * ratio * k2 + ratio * unit * first1 * first2 + unit * 2.0 * unit * k1,
            cosh: ratio * a * unit * (1.0 + k2),
            linear: ratio * 4.0 * ratio * k2 - ratio * unit * 4.0 * poisson * first2 + unit * 2.0 * unit * first1,
            constant: unit * (a * a) * unit,
            square: unit * a * (unit * 2.0 + ratio * first2),
            difference: [
                unit * a * (ratio * (1.0 + k2) - unit * a),
                (ratio - unit) * 4.0 * q,
                (ratio - unit) * 2.0 * (ratio * k2 - unit * k1),
            ],
        }
    }

    /// L(t).
    fn at(&self, t: f64, theta: f64) -> f64 {
        self.numerator(t, theta) / self.denominator(t, theta)
    }

    /// θ N.
    fn numerator(&self, t: f64, theta: f64) -> f64 {
        self.sinh * sinh_less_first(t, theta) + self.cosh * 0.5 * (1.0 + theta * theta) + self.linear * 2.0 * t * theta
    }

    /// θ D.
    fn denominator(&self, t: f64, theta: f64) -> f64 {
        self.sinh * cosh_less_first(t, theta)
            + self.cosh * -0.5 * (-4.0 * t).exp_m1()
            + (self.constant + self.square * (2.0 * t * t)) * theta
    }
}

/// e^(−2t) (sinh 2t − 2t).
fn sinh_less_first(t: f64, theta: f64) -> f64 {
    if t < SHALLOW { theta * series(2.0 * t, 3) } else { 0.5 * (1.0 - theta * theta) - 2.0 * t * theta }
}

/// e^(−2t) (cosh 2t − 1 − 2t²) = 2 e^(−2t) (sinh² t − t²).
fn cosh_less_first(t: f64, theta: f64) -> f64 {
    if t < SHALLOW { theta * series(2.0 * t, 4) } else { 0.5 * (1.0 + theta * theta) - theta * (1.0 + 2.0 * t * t) }
}

/// Σ xⁿ/n! over n = first, first + 2, …, for x up to 1.5.
fn series(x: f64, first: i32) -> f64 {
    let mut term = (1..=first).map(|n| x / f64::from(n)).product::<f64>();
    let mut sum = 0.0;
    for n in 0..10 {
        sum += term;
        let next = first + 2 * n;
        term *= x * x / f64::from((next + 1) * (next + 2));
    }
    sum
}
