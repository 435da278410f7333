//! Integrals of polynomials against a relaxation.

/// e^(−700) is near the smallest normal number: what decays further counts as zero.
const MAX_EXPONENT: f64 = 700.0;
/// Terms of the series of φ₄ for z < 1: the last is below the rounding of 1.
const SERIES_TERMS: usize = 18;

/// φ₁ … φ₄ at −z, for z ≥ 0: φ₁ = (1 − e^(−z))/z, φ_(k+1) = (1/k! − φ_k)/z.
///
/// For z < 1 by the series φ₄ = Σ (−z)^j/(j + 4)! and the recursion downward, which there cancels nothing.
fn phi(z: f64) -> [f64; 4] {
    if z < 1.0 {
        // Horner's rule for 1/4! (1 − z/5 (1 − z/6 (…)))
        let last = (0..SERIES_TERMS).rev().fold(1.0, |sum, j| 1.0 - z / (j + 5) as f64 * sum) / 24.0;
        let third = 1.0 / 6.0 - z * last;
        let second = 0.5 - z * third;
        return [1.0 - z * second, second, third, last];
    }
    let first = -(-z).exp_m1() / z;
    let second = (1.0 - first) / z;
    let third = (0.5 - second) / z;
    [first, second, third, (1.0 / 6.0 - third) / z]
}

/// What a relaxation leaves of a step of length z relaxation times.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Relaxed {
    z: f64,
    /// e^(−z), 0 where that is near the smallest normal number.
    pub(super) decay: f64,
    phi: [f64; 4],
}

impl Relaxed {
    pub(super) fn new(z: f64) -> Relaxed {
        Relaxed { z, decay: if z < MAX_EXPONENT { (-z).exp() } else { 0.0 }, phi: phi(z) }
    }
}

/// The last few [`Relaxed`] of each relaxation time: a rule asks for a step again where it is tried with less degree, and when
/// the next step corrects it. Copies begin empty.
#[derive(Debug, Default)]
pub(super) struct RelaxedSteps(Vec<([Relaxed; KEPT], usize)>);

/// A step, its half, and the step before.
const KEPT: usize = 3;

impl Clone for RelaxedSteps {
    fn clone(&self) -> RelaxedSteps {
        RelaxedSteps::new(self.0.len())
    }

    fn clone_from(&mut self, _: &RelaxedSteps) {}
}

impl RelaxedSteps {
    /// For this number of relaxation times.
    pub(super) fn new(times: usize) -> RelaxedSteps {
        RelaxedSteps(vec![Default::default(); times])
    }

    pub(super) fn of(&mut self, branch: usize, z: f64) -> Relaxed {
        let Some((kept, next)) = self.0.get_mut(branch) else { return Relaxed::new(z) };
        if let Some(relaxed) = kept.iter().find(|relaxed| relaxed.z == z && z > 0.0) {
            return *relaxed;
        }
        kept[*next] = Relaxed::new(z);
        let relaxed = kept[*next];
        *next = (*next + 1) % KEPT;
        relaxed
    }
}

/// I_k = ∫ e^(−z (1 − s/Δ)) N_k′(s) ds over a step of length Δ, over Δ^k, for the polynomials of Newton's form
///
/// N₁ = s, N₂ = s (s − Δ), N₃ = s (s − Δ)(s + Δ′),
///
/// where `past` = Δ′/Δ is the step before. All are positive: by parts I_k = −(z/Δ) ∫ e^… N_k ds for k > 1, where N₂ and N₃ are
/// negative inside the step. That form serves for z < 1, where the other cancels.
pub(super) fn moments(Relaxed { z, phi: [first, second, third, fourth], .. }: Relaxed, past: f64) -> [f64; 3] {
    if z < 1.0 {
        let bend = z * (second - 2.0 * third);
        [first, bend, z * (past * second - 2.0 * (past - 1.0) * third - 6.0 * fourth)]
    } else {
        [first, 2.0 * second - first, 6.0 * third + 2.0 * (past - 1.0) * second - past * first]
    }
}

/// The slopes N_k′ at the end of the step, over Δ^(k − 1): the response of an immediate dashpot.
pub(super) fn slopes(past: f64) -> [f64; 3] {
    [1.0, 1.0, 1.0 + past]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ e^(−z (1 − s)) N′(s) ds over 0 … 1, by Gauss–Legendre on panels that shrink towards the end; for small z the integral of
    /// e^… − 1, besides the `change` N(1) − N(0), which would cancel.
    fn quadrature(z: f64, change: f64, slope: impl Fn(f64) -> f64) -> f64 {
        // five points, exact for degree 9
        let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_5, 0.236_926_885_056_189_1];
        let mut edges: Vec<f64> = (0..80).map(|k| 1.0 - 0.75_f64.powi(k)).collect();
        edges.push(1.0);
        let relaxed = |exponent: f64| if z < 1.0 { exponent.exp_m1() } else { exponent.exp() };
        let mut sum = if z < 1.0 { change } else { 0.0 };
        for pair in edges.windows(2) {
            let panels = 40;
            let width = (pair[1] - pair[0]) / f64::from(panels);
            for panel in 0..panels {
                let middle = pair[0] + (f64::from(panel) + 0.5) * width;
                for (&x, &w) in nodes.iter().zip(&weights) {
                    for side in if x == 0.0 { &[0.0][..] } else { &[-1.0, 1.0] } {
                        let s = middle + 0.5 * width * x * side;
                        sum += 0.5 * width * w * relaxed(-z * (1.0 - s)) * slope(s);
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn moments_are_the_integrals() {
        for exponent in -12..=8 {
            let z = 10f64.powf(0.5 * f64::from(exponent));
            for r in [0.0, 0.2, 1.0, 5.0] {
                let m = moments(Relaxed::new(z), r);
                let exact = [
                    quadrature(z, 1.0, |_| 1.0),
                    quadrature(z, 0.0, |s| 2.0 * s - 1.0),
                    quadrature(z, 0.0, |s| 3.0 * s * s + 2.0 * (r - 1.0) * s - r),
                ];
                for (k, (m, exact)) in m.into_iter().zip(exact).enumerate() {
                    assert!((m / exact - 1.0).abs() < 1e-11, "z = {z}, r = {r}, {k}: {m:e}, {exact:e}");
                    assert!(m > 0.0);
                }
            }
        }
    }

    /// Both forms meet where one takes over, and the limits are right at zero time and at very long times.
    #[test]
    fn moments_have_their_limits() {
        let (below, above) = (moments(Relaxed::new(1.0 - 1e-12), 0.8), moments(Relaxed::new(1.0), 0.8));
        below.iter().zip(&above).for_each(|(a, b)| assert!((a / b - 1.0).abs() < 1e-11, "{a:e} {b:e}"));
        assert_eq!(moments(Relaxed::new(0.0), 1.0), [1.0, 0.0, 0.0]);
        for z in [1e12, 1e200, f64::INFINITY] {
            for (m, slope) in moments(Relaxed::new(z), 2.0).into_iter().zip(slopes(2.0)) {
                let limit = slope / z; // what is remembered is the slope at the end
                assert!((m - limit).abs() <= 3e-12 * limit, "{z:e}: {m:e} {limit:e}");
            }
        }
    }
}
