//! Steady oscillation: complex moduli of a series.

use num_complex::Complex64;

use crate::rheology::{CreepSpectrum, RelaxationSpectrum};

impl RelaxationSpectrum {
    /// The complex modulus G*(ω) = G′ + i G″ \[Pa\] at the angular frequency `omega` \[rad/s\]: stress over
    /// strain in steady oscillation, both ∝ e^(iωt). G*(−ω) is its complex conjugate.
    ///
    /// G* = G_∞ + iωη + Σ G_k iωτ_k/(1 + iωτ_k)
    ///
    /// ```
    /// use viscocontact::rheology::{Maxwell, Rheology};
    ///
    /// let fluid = Maxwell::with_time(2.0e6, 1.0)?.creep_spectrum().unwrap().relaxation();
    /// let modulus = fluid.complex_modulus(1.0); // at ωτ = 1 half is stored, half is lost
    /// assert!((modulus.re - 1.0e6).abs() < 1e-6 && (modulus.im - 1.0e6).abs() < 1e-6);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn complex_modulus(&self, omega: f64) -> Complex64 {
        let ends =
            Complex64::new(self.equilibrium(), if self.viscosity() > 0.0 { omega * self.viscosity() } else { 0.0 });
        // iy/(1 + iy) = (y + i)/(y + 1/y)
        let branch = |&(g, tau): &(f64, f64)| {
            let y = omega * tau;
            if y == 0.0 { Complex64::ZERO } else { Complex64::new(y.min(1e200), 1.0) * (g / (y.min(1e200) + 1.0 / y)) }
        };
        ends + self.terms().iter().map(branch).sum::<Complex64>()
    }
}

impl CreepSpectrum {
    /// The complex compliance J*(ω) = J′ − i J″ = 1/G*(ω) \[1/Pa\] at the angular frequency `omega`
    /// \[rad/s\]: strain over stress in steady oscillation. J*(−ω) is its complex conjugate.
    ///
    /// J* = J_g − iφ/ω + Σ J_k/(1 + iωλ_k)
    pub fn complex_compliance(&self, omega: f64) -> Complex64 {
        let flow = if self.fluidity() > 0.0 { self.fluidity() / omega } else { 0.0 };
        // 1/(1 + iy) = (1/y − i)/(y + 1/y)
        let branch = |&(c, lambda): &(f64, f64)| {
            let y = (omega * lambda).abs().clamp(1e-200, 1e200).copysign(omega);
            Complex64::new(1.0 / y, -1.0) * (c / (y + 1.0 / y))
        };
        Complex64::new(self.glassy(), -flow) + self.terms().iter().map(branch).sum::<Complex64>()
    }

    /// The complex modulus G*(ω) = 1/J*(ω) \[Pa\] at the angular frequency `omega` \[rad/s\]: of a fluid 0 at 0.
    pub fn complex_modulus(&self, omega: f64) -> Complex64 {
        if omega == 0.0 && self.fluidity() > 0.0 { Complex64::ZERO } else { self.complex_compliance(omega).finv() }
    }
}
