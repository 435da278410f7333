use std::ops::RangeInclusive;
use std::sync::Arc;

use super::series::{invalid_compliance, no_series};
use crate::UserError;
use crate::error::{Error, Result, poisson_ratio, positive, within};
use crate::rheology::{CreepSpectrum, FitReport, RelaxationSpectrum, Rheology, Tension, is_known, may_follow};

#[cfg(any(feature = "friction", feature = "sliding", feature = "states"))]
mod pair;

/// A rheology in shear and the bulk response: together they give the contact creep compliance C(t),
/// with C = 1/E* = (1 − ν)/2G for an elastic body.
///
/// | volume | C(t) |
/// |---|---|
/// | [`Material::incompressible`] | J(t)/4 |
/// | [`Material::constant_poisson`] | (1 − ν) J(t)/2 |
/// | [`Material::elastic_bulk`] | J(t)/4 + (3/4) K(t), K the creep compliance to the relaxation modulus 3B + G(t) |
/// | [`Material::relaxing_bulk`] | J(t)/4 + (3/4) K(t), the bulk relaxing in proportion to the shear |
/// | [`Material::from_tension`] | (1 − ν²) D(t), D the creep compliance in tension |
/// | [`Material::from_tension_elastic_bulk`] | as of an elastic bulk, J(t) = 3 D(t) − 1/(3B) |
/// | [`Material::against`], two bodies | the sum of both |
///
/// ```
/// use viscocontact::rheology::{Elastic, Material};
///
/// let steel = Material::constant_poisson(Elastic::new(80.0e9)?, 0.3)?;
/// let modulus = 1.0 / steel.contact_compliance(0.0); // E* = 2G/(1 − ν)
/// assert!((modulus - 160.0e9 / 0.7).abs() < 1.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Material {
    /// One body, or the two of a contact.
    pub(crate) bodies: Vec<Body>,
}

#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) rheology: Arc<dyn Rheology>,
    pub(crate) volume: Volume,
}

#[derive(Debug, Clone)]
pub(crate) enum Volume {
    /// C(t) over the creep compliance of the rheology, the same at all times, and Poisson's ratio.
    Proportional { factor: f64, poisson: f64 },
    /// A bulk of this modulus at t = 0: the exact series of C(t), and Poisson's ratio unless it changes.
    Bulk(f64, CreepSpectrum, Option<f64>),
}

impl Material {
    /// An incompressible body (ν = ½): C = J/4.
    pub fn incompressible(rheology: impl Rheology + 'static) -> Material {
        Material::with_volume(rheology, Volume::Proportional { factor: 0.25, poisson: 0.5 })
    }

    /// A body with constant Poisson's ratio `nu`: C = (1 − ν) J/2.
    ///
    /// # Errors
    /// If `nu` is outside (−1, ½].
    pub fn constant_poisson(rheology: impl Rheology + 'static, nu: f64) -> Result<Material> {
        let poisson = poisson_ratio("Poisson's ratio", nu)?;
        Ok(Material::with_volume(rheology, Volume::Proportional { factor: 0.5 * (1.0 - nu), poisson }))
    }

    /// A body whose creep D(t) was measured in tension, with a constant Poisson's ratio `nu`: C = (1 − ν²) D, since
    /// J = 2 (1 + ν) D.
    ///
    /// This is exact if ν does not change with time; polymers that pass from glass to rubber rise from about 0.35 to
    /// 0.5, which changes C by (1 − 0.35²)/(1 − 0.5²), 17 %. [`Material::from_tension_elastic_bulk`] follows the rise.
    ///
    /// ```
    /// use viscocontact::rheology::{Material, Measurements, Tension, Zener};
    ///
    /// let silicone = Material::from_tension(Tension(Zener::relaxing(3.0e6, 1.5e6, 0.1)?), 0.49)?; // E(t): 3 to 1.5 MPa
    /// assert!((silicone.contact_compliance(0.0) * 3.0e6 / (1.0 - 0.49 * 0.49) - 1.0).abs() < 1e-14);
    ///
    /// // storage and loss modulus in tension at five frequencies (DMA)
    /// let table = [
    ///     (0.1, 1.50e6, 0.02e6),
    ///     (1.0, 1.52e6, 0.15e6),
    ///     (10.0, 2.25e6, 0.75e6),
    ///     (100.0, 2.98e6, 0.15e6),
    ///     (1000.0, 3.0e6, 0.02e6),
    /// ];
    /// let measured = Measurements::dynamic(&table)?.fit_tension()?;
    /// let silicone = Material::from_tension(measured, 0.49)?;
    /// # let _ = silicone;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If `nu` is outside (−1, ½].
    pub fn from_tension(tensile: Tension<impl Rheology + 'static>, nu: f64) -> Result<Material> {
        let poisson = poisson_ratio("Poisson's ratio", nu)?;
        let volume = Volume::Proportional { factor: (1.0 - nu) * (1.0 + nu), poisson };
        Ok(Material::with_volume(tensile.0, volume))
    }

    /// A body that creeps in shear and is elastic in bulk, with `bulk_modulus` B \[Pa\], as most polymers approximately
    /// are: Poisson's ratio rises during creep. From (1 − ν)/2G = 1/(4G) + 3/(4 (3B + G)), which holds
    /// for operators as for numbers, C is exactly J/4 + (3/4) K, K being the creep compliance of a body with
    /// relaxation modulus 3B + G(t). It needs one more field for each relaxation time.
    ///
    /// ```
    /// use viscocontact::rheology::{Material, Zener};
    ///
    /// let glassy = 1.0e9;
    /// let polymer = Material::elastic_bulk(Zener::new(glassy, 1.0e6, 1.0e6)?, 3.0e9)?;
    /// let nu = (3.0 * 3.0e9 - 2.0 * glassy) / (2.0 * (3.0 * 3.0e9 + glassy)); // at t = 0
    /// assert!((polymer.contact_compliance(0.0) * 2.0 * glassy / (1.0 - nu) - 1.0).abs() < 1e-14);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the bulk modulus is not finite and positive, or the rheology has no exponential series: fit one with
    /// [`Rheology::series`].
    pub fn elastic_bulk(rheology: impl Rheology + 'static, bulk_modulus: f64) -> Result<Material> {
        positive("bulk modulus", bulk_modulus)?;
        let creep = rheology.creep_spectrum().ok_or_else(|| no_series("an elastic bulk", &rheology))?;
        Material::of_shear_and_bulk(rheology, &creep, Bulk { constant: bulk_modulus, per_shear: 0.0 })
    }

    /// A body whose bulk relaxes in proportion to its shear: B(t)/B(0) = 1 − c (1 − G(t)/G(0)), with `bulk_modulus`
    /// B(0) \[Pa\] and `ratio` c, as Prony series of finite-element programs with k_i = c g_i at the times of the
    /// shear. It is exact as [`Material::elastic_bulk`], with B(t) in place of B.
    ///
    /// ```
    /// use viscocontact::rheology::{GeneralizedMaxwell, Material, PronyTerm};
    ///
    /// // g_i and τ_i of the shear, k_i = g_i/4
    /// let terms = [PronyTerm { share: 0.4, time: 0.1 }, PronyTerm { share: 0.2, time: 10.0 }];
    /// let polymer = Material::relaxing_bulk(GeneralizedMaxwell::prony(1.0e9, &terms)?, 3.0e9, 0.25)?;
    /// let (g, b) = (0.4e9, 3.0e9 * (1.0 - 0.25 * 0.6)); // in the end
    /// let contact = 0.25 / g + 0.75 / (3.0 * b + g);
    /// assert!((polymer.contact_compliance(1.0e9) / contact - 1.0).abs() < 1e-12);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Material::elastic_bulk`]; if the ratio is outside \[0, 1), or the rheology has no elastic response. With
    /// a ratio of 1 Poisson's ratio is constant: [`Material::constant_poisson`].
    pub fn relaxing_bulk(rheology: impl Rheology + 'static, bulk_modulus: f64, ratio: f64) -> Result<Material> {
        positive("bulk modulus", bulk_modulus)?;
        within("ratio of the relaxation in bulk to that in shear", ratio, (0.0..1.0).contains(&ratio), "in [0, 1)")?;
        let creep = rheology.creep_spectrum().ok_or_else(|| no_series("a relaxing bulk", &rheology))?;
        positive("elastic compliance of the rheology", creep.glassy())?;
        let bulk = Bulk { constant: (1.0 - ratio) * bulk_modulus, per_shear: ratio * bulk_modulus * creep.glassy() };
        Material::of_shear_and_bulk(rheology, &creep, bulk)
    }

    /// A body whose creep was measured in tension ([`Material::from_tension`]) and that is elastic in bulk, with
    /// `bulk_modulus` B \[Pa\]: D(t) = J(t)/3 + 1/(9B), so that J(t) = 3 D(t) − 1/(3B), and the rest is
    /// [`Material::elastic_bulk`]. This is exact for an elastic bulk; Poisson's ratio follows from it.
    ///
    /// ```
    /// use viscocontact::rheology::{Elastic, Material, Tension};
    ///
    /// let (e, nu) = (2.0e9, 0.35);
    /// let bulk = e / (3.0 * (1.0 - 2.0 * nu));
    /// let glass = Material::from_tension_elastic_bulk(Tension(Elastic::new(e)?), bulk)?;
    /// assert!((glass.contact_compliance(0.0) * e / (1.0 - nu * nu) - 1.0).abs() < 1e-14);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Material::elastic_bulk`]; if Young's modulus at t = 0 is 9B or more, which no elastic body of that bulk has.
    pub fn from_tension_elastic_bulk(
        Tension(tensile): Tension<impl Rheology + 'static>,
        bulk_modulus: f64,
    ) -> Result<Material> {
        positive("bulk modulus", bulk_modulus)?;
        let tension = tensile.creep_spectrum().ok_or_else(|| no_series("an elastic bulk", &tensile))?;
        let (glassy, of_bulk) = (3.0 * tension.glassy(), 1.0 / (3.0 * bulk_modulus));
        let allowed = "more than 1/9 of Young's modulus at t = 0: give moduli in tension, in Pa";
        within("bulk modulus", bulk_modulus, glassy > of_bulk, allowed)?;
        let terms: Vec<_> = tension.terms().iter().map(|&(compliance, time)| (3.0 * compliance, time)).collect();
        let shear = CreepSpectrum::new(glassy - of_bulk, 3.0 * tension.fluidity(), &terms)?;
        Material::of_shear_and_bulk(tensile, &shear, Bulk { constant: bulk_modulus, per_shear: 0.0 })
    }

    fn of_shear_and_bulk(rheology: impl Rheology + 'static, creep: &CreepSpectrum, bulk: Bulk) -> Result<Material> {
        let (shear, factor) = (creep.relaxation(), 1.0 + 3.0 * bulk.per_shear);
        let equilibrium = factor * shear.equilibrium() + 3.0 * bulk.constant;
        let terms: Vec<_> = shear.terms().iter().map(|&(modulus, time)| (factor * modulus, time)).collect();
        let stiffened = RelaxationSpectrum::new(equilibrium, factor * shear.viscosity(), &terms)?.creep();
        let contact = creep.scaled(0.25)?.plus(&stiffened.scaled(0.75)?)?;
        let at_once = bulk.constant + if bulk.per_shear > 0.0 { bulk.per_shear / creep.glassy() } else { 0.0 };
        let volume = Volume::Bulk(at_once, contact, bulk.poisson(&stiffened));
        Ok(Material::with_volume(rheology, volume))
    }

    fn with_volume(rheology: impl Rheology + 'static, volume: Volume) -> Material {
        Material { bodies: vec![Body { rheology: Arc::new(rheology), volume }] }
    }

    /// This body pressed against `other`: both deform, C = C₁ + C₂.
    ///
    /// ```
    /// use viscocontact::rheology::{Elastic, Material, Maxwell};
    ///
    /// let pad = Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?);
    /// let steel = Material::constant_poisson(Elastic::new(80.0e9)?, 0.3)?;
    /// let sum = pad.contact_compliance(2.0) + steel.contact_compliance(2.0);
    /// assert_eq!(pad.against(steel).contact_compliance(2.0), sum);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    #[must_use]
    pub fn against(mut self, other: Material) -> Material {
        self.bodies.extend(other.bodies);
        self
    }

    /// The contact creep compliance C(t) \[1/Pa\] at t ≥ 0 \[s\]: the factor of the material in Eq. 8 and Eq. 12 of the
    /// [paper](crate::paper). NaN beyond [`Material::known_until`], where steps fail.
    pub fn contact_compliance(&self, t: f64) -> f64 {
        self.bodies.iter().map(|body| body.contact_compliance(t)).sum()
    }

    /// Poisson's ratio of each body: one, or the two of [`Material::against`]; `None` for a body that creeps
    /// with an elastic bulk: its ratio rises.
    ///
    /// ```
    /// use viscocontact::rheology::{Elastic, Material, Maxwell};
    ///
    /// let pad = Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?);
    /// let polymer = Material::elastic_bulk(Maxwell::new(1.0e9, 1.0e9)?, 3.0e9)?;
    /// assert_eq!(pad.against(polymer).poisson_ratios().collect::<Vec<_>>(), [Some(0.5), None]);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn poisson_ratios(&self) -> impl Iterator<Item = Option<f64>> {
        self.bodies.iter().map(|body| match &body.volume {
            Volume::Proportional { poisson, .. } => Some(*poisson),
            Volume::Bulk(_, _, poisson) => *poisson,
        })
    }

    /// Whether C(t) is in proportion to the creep of one rheology.
    pub(crate) fn is_one_body_in_proportion(&self) -> bool {
        matches!(&self.bodies[..], [Body { volume: Volume::Proportional { .. }, .. }])
    }

    /// The longest time \[s\] at which all rheologies are known, +∞ for formulas.
    pub fn known_until(&self) -> f64 {
        self.bodies.iter().map(|body| body.rheology.known_until()).fold(f64::INFINITY, f64::min)
    }

    /// The times \[s\] over which all the rheologies were measured or fitted, (0, +∞) for formulas:
    /// [`Rheology::measured`].
    pub fn measured(&self) -> [f64; 2] {
        let all = self.bodies.iter().map(|body| body.rheology.measured());
        all.fold([0.0, f64::INFINITY], |[from, until], [first, last]| [from.max(first), until.min(last)])
    }

    /// The exact exponential series of C(t), if every rheology has one.
    ///
    /// # Errors
    /// If the scaled series leaves the range of `f64`.
    pub fn contact_spectrum(&self) -> Result<Option<CreepSpectrum>> {
        let mut sum: Option<CreepSpectrum> = None;
        for body in &self.bodies {
            let Some(spectrum) = body.contact_spectrum()? else { return Ok(None) };
            sum = Some(match sum {
                Some(others) => others.plus(&spectrum)?,
                None => spectrum,
            });
        }
        Ok(sum)
    }

    /// The same material with an exponential series, fitted over `times` \[s\] within the relative error `tolerance`,
    /// in place of every rheology without an exact one: [`Rheology::series`].
    ///
    /// # Errors
    /// As [`Rheology::series`].
    pub fn fitted(&self, times: RangeInclusive<f64>, tolerance: f64) -> Result<Material> {
        let fit = |body: &Body| {
            let is_exact = body.rheology.creep_spectrum().is_some();
            let series = || body.rheology.series(times.clone(), tolerance);
            Ok(if is_exact { body.clone() } else { Body { rheology: Arc::new(series()?), ..body.clone() } })
        };
        Ok(Material { bodies: self.bodies.iter().map(fit).collect::<Result<_>>()? })
    }

    /// The errors of series fitted to tables, or by [`Material::fitted`]; none for exact series.
    pub fn fit_reports(&self) -> impl Iterator<Item = &FitReport> {
        self.bodies.iter().filter_map(|body| body.rheology.fit_report())
    }

    /// The error of a rheology of the user, as [`Rheology::failure`]: NaN stands for the value that it could not give.
    pub fn failure(&self) -> Option<UserError> {
        // the failures of both bodies are taken, and the first is returned
        self.bodies.iter().fold(None, |first, body| first.or(body.rheology.failure()))
    }

    /// Accepts rheologies whose times are not NaN, and whose series is their creep.
    pub(crate) fn validate(&self) -> Result<()> {
        for rheology in self.bodies.iter().map(|body| &body.rheology) {
            let refused = |field, value, allowed| Err(Error::OutOfRange { field, value, allowed });
            let (until, measured) = (rheology.known_until(), rheology.measured());
            if until.is_nan() || until <= 0.0 {
                return refused("Rheology::known_until", until, "> 0, +∞ for a formula");
            }
            if let Some(value) = measured.into_iter().find(|time| time.is_nan()) {
                return refused("Rheology::measured", value, "two times");
            }
            super::own_series::series_is_creep(rheology)?;
        }
        Ok(())
    }

    /// C(0), which must be a number ≥ 0.
    pub(crate) fn glassy_compliance(&self) -> Result<f64> {
        let glassy = self.contact_compliance(0.0);
        if may_follow(glassy, 0.0) {
            return Ok(glassy);
        }
        let mut of_bodies = self.bodies.iter().map(|body| body.rheology.creep_compliance(0.0));
        let found = of_bodies.find(|&value| !may_follow(value, value)).map(|value| (value, value));
        let (value, previous) = found.unwrap_or((glassy, 0.0));
        Err(self.failure().map_or_else(|| invalid_compliance(0.0, value, previous), Error::User))
    }

    /// [`Material::contact_spectrum`], which `what` needs.
    pub(crate) fn spectrum_for(&self, what: &'static str) -> Result<CreepSpectrum> {
        self.contact_spectrum()?.ok_or_else(|| {
            match self.bodies.iter().find(|body| body.rheology.creep_spectrum().is_none()) {
                Some(lacking) => no_series(what, &lacking.rheology),
                None => no_series(what, &self.bodies),
            }
        })
    }
}

/// A bulk modulus linear in the shear modulus: B(t) = `constant` + `per_shear` G(t).
struct Bulk {
    /// \[Pa\].
    constant: f64,
    per_shear: f64,
}

impl Bulk {
    /// Poisson's ratio of a body that does not creep in H = 3B + G, of which `stiffened` is the creep; else it changes.
    /// 1 − 2ν = 3G/H is (3 − 9b/H)/(1 + 3c) with B = b + c G.
    fn poisson(&self, stiffened: &CreepSpectrum) -> Option<f64> {
        let scale = 1.0 / (1.0 + 3.0 * self.per_shear);
        // of a body that is much stiffer in bulk, the difference is rounding of either sign
        let compressibility = (3.0 * scale - 9.0 * self.constant * scale * stiffened.glassy()).max(0.0);
        stiffened.terms().is_empty().then_some(0.5 * (1.0 - compressibility))
    }
}

impl Body {
    pub(super) fn contact_compliance(&self, t: f64) -> f64 {
        match &self.volume {
            Volume::Proportional { factor, .. } => factor * self.rheology.creep_compliance(t),
            Volume::Bulk(_, contact, _) if is_known(t, self.rheology.known_until()) => contact.compliance(t),
            Volume::Bulk(..) => f64::NAN,
        }
    }

    pub(crate) fn contact_spectrum(&self) -> Result<Option<CreepSpectrum>> {
        match &self.volume {
            Volume::Proportional { factor, .. } => {
                self.rheology.creep_spectrum().map(|spectrum| spectrum.scaled(*factor)).transpose()
            }
            Volume::Bulk(_, contact, _) => Ok(Some(contact.clone())),
        }
    }
}

#[cfg(test)]
mod tests;
