//! The displacement under a steady pressure that moves, in the frame of the pressure.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::Grid;
use crate::fft::RealPlane;
use crate::kernel::InfluenceKernel;
use crate::rheology::CreepSpectrum;

/// A linear map of the pressure \[Pa\] to the displacement \[m\] of the bodies that it moves over, and an approximate inverse.
///
/// A point x in the frame of the pressure was at x + v s a time s before. On bodies that are periodic along both axes a wave q of the pressure
/// therefore displaces by
///
/// u(q) = K(q) C(q·v) p(q), C(ω) = C(0) + Σ C_k/(1 − iω λ_k):
///
/// the conjugate of the complex compliance at the frequency at which the wave passes a point. Its real part is positive, so that the map is strictly
/// monotone, and a contact has one steady state.
#[derive(Debug)]
pub(super) struct MovingBodies {
    pub(super) response: Multiplier,
    pub(super) inverse: Multiplier,
}

impl MovingBodies {
    /// Bodies that are periodic along both axes, under a pressure with this `velocity` \[m/s\].
    pub(super) fn periodic(kernel: &InfluenceKernel, creep: &CreepSpectrum, velocity: [f64; 2]) -> MovingBodies {
        let grid = kernel.grid();
        let [n1, n2] = grid.cells();
        let response = Multiplier::new(grid, |k, q| {
            // a wave of alternating cells is its own mirror image: it moves both ways
            let signs = [0, 1].map(|axis| if 2 * k[axis] == [n1, n2][axis] { &[1.0, -1.0][..] } else { &[1.0] });
            let omegas = signs[0]
                .iter()
                .flat_map(|s1| signs[1].iter().map(move |s2| s1 * q[0] * velocity[0] + s2 * q[1] * velocity[1]));
            let count = (signs[0].len() * signs[1].len()) as f64;
            kernel.of_wave(k) / count * omegas.map(|omega| moving_compliance(creep, omega)).sum::<Complex64>()
        });
        let inverse = response.factors.iter().map(|&of| if of == Complex64::ZERO { of } else { of.inv() }).collect();
        MovingBodies { inverse: Multiplier { factors: inverse, ..response.clone() }, response }
    }

    /// −∬ p ∇u over the area of a cell \[N/m²\]: the force along each axis with which the bodies resist.
    pub(super) fn drag(&mut self, pressure: &[f64]) -> [f64; 2] {
        let Multiplier { plane, waves, factors, coefficients, cells: [n1, n2], .. } = &mut self.response;
        plane.forward(pressure.chunks_exact(*n2), coefficients);
        let mut drag = [0.0; 2];
        for (k, (p, response)) in coefficients.iter().zip(&*factors).enumerate() {
            let k2 = k / *n1;
            // the other half of the waves is conjugate to this one
            let count = if k2 == 0 || 2 * k2 == *n2 { 1.0 } else { 2.0 };
            (0..2).for_each(|axis| drag[axis] += count * waves[k][axis] * p.norm_sqr() * response.im);
        }
        drag.map(|sum| sum / (*n1 * *n2) as f64)
    }
}

/// A map of fields that multiplies each wave by a factor.
#[derive(Debug, Clone)]
pub(super) struct Multiplier {
    cells: [usize; 2],
    plane: RealPlane,
    factors: Vec<Complex64>,
    /// Wave numbers along each axis \[1/m\].
    waves: Vec<[f64; 2]>,
    coefficients: Vec<Complex64>,
    /// Pairs of a forward and an inverse transform so far.
    pub(super) pairs: usize,
}

impl Multiplier {
    /// `factor` is called with the indices of the absolute wave numbers, and the wave numbers \[1/m\].
    fn new(grid: &Grid, factor: impl Fn([usize; 2], [f64; 2]) -> Complex64) -> Multiplier {
        let (cells @ [n1, n2], [length1, length2]) = (grid.cells(), grid.lengths());
        let plane = RealPlane::new(cells);
        let number = |k1: usize| if 2 * k1 > n1 { k1 as f64 - n1 as f64 } else { k1 as f64 };
        let indices = || (0..=n2 / 2).flat_map(|k2| (0..n1).map(move |k1| [k1, k2]));
        let waves: Vec<_> = indices().map(|[k1, k2]| [TAU * number(k1) / length1, TAU * k2 as f64 / length2]).collect();
        let factors = indices().zip(&waves).map(|([k1, k2], &q)| factor([k1.min(n1 - k1), k2], q)).collect();
        Multiplier { cells, factors, waves, coefficients: vec![Complex64::ZERO; plane.coefficients()], plane, pairs: 0 }
    }

    pub(super) fn apply(&mut self, field: &[f64], out: &mut [f64]) {
        let [n1, n2] = self.cells;
        self.plane.forward(field.chunks_exact(n2), &mut self.coefficients);
        let scale = 1.0 / (n1 * n2) as f64;
        self.coefficients.iter_mut().zip(&self.factors).for_each(|(own, factor)| *own *= scale * factor);
        self.plane.inverse(&mut self.coefficients, out.chunks_exact_mut(n2));
        self.pairs += 1;
    }
}

/// Beyond this ωλ a term has only its imaginary part left, and squares overflow.
const FAST: f64 = 1e100;

/// C(0) + Σ C_k/(1 − iω λ_k) \[1/Pa\].
fn moving_compliance(creep: &CreepSpectrum, omega: f64) -> Complex64 {
    let term = |&(compliance, time): &(f64, f64)| {
        let x = omega * time;
        if x.abs() > FAST { Complex64::I * (compliance / x) } else { compliance / Complex64::new(1.0, -x) }
    };
    creep.glassy() + creep.terms().iter().map(term).sum::<Complex64>()
}
