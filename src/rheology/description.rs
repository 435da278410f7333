//! A material in words and numbers.

use std::fmt;

use crate::rheology::{Material, Volume};

/// The line that `Display` prints. A rheology may be a closure, so that a material is not read back: save the
/// arguments of its models, or its [`CreepSpectrum`](crate::rheology::CreepSpectrum), which is.
#[cfg(feature = "serde")]
impl serde::Serialize for Material {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One line: volume and contact modulus 1/C of each body, and its retardation times.
///
/// ```
/// use viscocontact::rheology::{Elastic, Material, Zener};
///
/// let rubber = Material::incompressible(Zener::relaxing(4.0e6, 1.0e6, 0.5)?);
/// assert_eq!(rubber.to_string(), "incompressible, 1/C from 1.600e7 Pa to 4.000e6 Pa, 1 retardation time (2.0e0 s)");
/// let steel = Material::constant_poisson(Elastic::young(210.0e9, 0.3)?, 0.3)?;
/// assert_eq!(rubber.against(steel).to_string().split(" against ").nth(1), Some("Poisson's ratio 0.3, 1/C 2.308e11 Pa"));
/// # Ok::<(), viscocontact::Error>(())
/// ```
impl fmt::Display for Material {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, body) in self.bodies.iter().enumerate() {
            if k > 0 {
                f.write_str(" against ")?;
            }
            match body.volume {
                Volume::Proportional { poisson: 0.5, .. } => f.write_str("incompressible")?,
                Volume::Proportional { poisson, .. } => write!(f, "Poisson's ratio {poisson}")?,
                Volume::Bulk(at_once, ..) => write!(f, "bulk modulus {at_once:.3e} Pa")?,
            }
            let Ok(Some(creep)) = body.contact_spectrum() else {
                let glassy = body.contact_compliance(0.0);
                if glassy > 0.0 {
                    write!(f, ", 1/C {:.3e} Pa at t = 0", 1.0 / glassy)?;
                } else {
                    f.write_str(", no elastic response")?;
                }
                f.write_str(", no exact series")?;
                continue;
            };
            let (glassy, fluidity, terms) = (creep.glassy(), creep.fluidity(), creep.terms());
            let rubbery = glassy + terms.iter().map(|(compliance, _)| compliance).sum::<f64>();
            match (glassy > 0.0, fluidity > 0.0, terms.is_empty()) {
                (true, false, true) => write!(f, ", 1/C {:.3e} Pa", 1.0 / glassy)?,
                (true, false, false) => write!(f, ", 1/C from {:.3e} Pa to {:.3e} Pa", 1.0 / glassy, 1.0 / rubbery)?,
                (true, true, _) => write!(f, ", 1/C {:.3e} Pa at t = 0, flows", 1.0 / glassy)?,
                (false, false, _) => write!(f, ", no elastic response, 1/C {:.3e} Pa in the end", 1.0 / rubbery)?,
                (false, true, _) => f.write_str(", no elastic response, flows")?,
            }
            match *terms {
                [] => {}
                [(_, time)] => write!(f, ", 1 retardation time ({time:.1e} s)")?,
                [(_, first), .., (_, last)] => {
                    write!(f, ", {} retardation times ({first:.1e} s to {last:.1e} s)", terms.len())?;
                }
            }
        }
        Ok(())
    }
}
