use crate::error::{Result, least_length, positive, within};
use crate::rheology::{CreepSpectrum, ROUNDING, RelaxationSpectrum, forward_rheology};

/// A spring and any number of Maxwell elements in parallel (a Prony series):
/// G(t) = G_∞ + Σ G_k e^(−t/τ_k). A solid if G_∞ > 0, otherwise a fluid.
///
/// ```
/// use viscocontact::rheology::{GeneralizedMaxwell, Rheology};
///
/// let body = GeneralizedMaxwell::new(1.0e6, &[(3.0e6, 0.1), (1.0e6, 10.0)])?;
/// assert!((body.creep_compliance(0.0) * 5.0e6 - 1.0).abs() < 1e-14); // glassy: 1/ΣG
/// assert!((body.creep_compliance(1.0e6) * 1.0e6 - 1.0).abs() < 1e-14); // relaxed: 1/G_∞
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedMaxwell(CreepSpectrum);

impl GeneralizedMaxwell {
    /// A body of `equilibrium` modulus \[Pa\] (0 for a fluid) and `terms` of (modulus \[Pa\], relaxation
    /// time \[s\]).
    ///
    /// # Errors
    /// As [`RelaxationSpectrum::new`]; also without terms.
    pub fn new(equilibrium: f64, terms: &[(f64, f64)]) -> Result<GeneralizedMaxwell> {
        least_length("Maxwell elements", terms.len(), 1)?;
        Ok(GeneralizedMaxwell(RelaxationSpectrum::new(equilibrium, 0.0, terms)?.creep()))
    }

    /// A body of `glassy` modulus G(0) \[Pa\] and shares of it, as finite-element programs write Prony series:
    /// G(t) = G(0) (1 − Σ g_k (1 − e^(−t/τ_k))). The rest of the shares does not relax.
    ///
    /// | program | how its numbers are given |
    /// |---|---|
    /// | Abaqus, `*VISCOELASTIC, TIME=PRONY` | g_i, τ_i with the instantaneous modulus; with `MODULI=LONG TERM` G(0) is that modulus over 1 − Σ g_i |
    /// | Ansys, `TB,PRONY` | α_i, τ_i with the instantaneous modulus |
    /// | COMSOL, generalized Maxwell | moduli G_m of branches beside the long-term modulus G: [`GeneralizedMaxwell::new`] |
    ///
    /// Shares k_i of a bulk modulus that relaxes in proportion:
    /// [`Material::relaxing_bulk`](crate::rheology::Material::relaxing_bulk).
    ///
    /// ```
    /// use viscocontact::rheology::{GeneralizedMaxwell, PronyTerm, Rheology};
    ///
    /// let terms = [PronyTerm { share: 0.5, time: 0.1 }, PronyTerm { share: 0.25, time: 10.0 }];
    /// let body = GeneralizedMaxwell::prony(4.0e6, &terms)?;
    /// assert!((body.creep_compliance(1.0e6) * 1.0e6 - 1.0).abs() < 1e-14); // a quarter is left
    /// assert!(GeneralizedMaxwell::prony(4.0e6, &[PronyTerm { share: 1.25, time: 10.0 }]).is_err());
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the modulus is not finite and positive, a share is not in \[0, 1\], or their sum exceeds 1 by more than
    /// rounding; as [`GeneralizedMaxwell::new`].
    pub fn prony(glassy: f64, terms: &[PronyTerm]) -> Result<GeneralizedMaxwell> {
        positive("glassy modulus", glassy)?;
        let mut rest = 1.0;
        for &PronyTerm { share, .. } in terms {
            rest -= within("share of the glassy modulus", share, (0.0..=1.0).contains(&share), "in [0, 1]")?;
        }
        within("sum of the shares", 1.0 - rest, rest >= -ROUNDING, "at most 1")?;
        // shares printed with few digits may add up to 1 but for rounding: a fluid
        let rest = if rest > ROUNDING { rest } else { 0.0 };
        GeneralizedMaxwell::new(rest * glassy, &PronyTerm::times(terms, glassy))
    }

    /// A body of `rubbery` modulus G_∞ \[Pa\] and terms relative to it: G(t) = G_∞ (1 + Σ g_k e^(−t/τ_k)).
    ///
    /// ```
    /// use viscocontact::rheology::{GeneralizedMaxwell, PronyTerm, Rheology};
    ///
    /// let body = GeneralizedMaxwell::prony_long_term(1.0e6, &[PronyTerm { share: 3.0, time: 0.1 }])?;
    /// assert!((body.creep_compliance(0.0) * 4.0e6 - 1.0).abs() < 1e-14);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the modulus is not finite and positive; as [`GeneralizedMaxwell::new`].
    pub fn prony_long_term(rubbery: f64, terms: &[PronyTerm]) -> Result<GeneralizedMaxwell> {
        positive("rubbery modulus", rubbery)?;
        GeneralizedMaxwell::new(rubbery, &PronyTerm::times(terms, rubbery))
    }
}

/// A term of a Prony series relative to a modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PronyTerm {
    /// Its modulus over the modulus of the series: g_k.
    pub share: f64,
    /// Its relaxation time τ_k \[s\].
    pub time: f64,
}

impl PronyTerm {
    /// Moduli \[Pa\] and times \[s\] of terms relative to a modulus.
    fn times(terms: &[PronyTerm], modulus: f64) -> Vec<(f64, f64)> {
        terms.iter().map(|term| (term.share * modulus, term.time)).collect()
    }
}

forward_rheology!(self: GeneralizedMaxwell => self.0);
