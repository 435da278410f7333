use crate::error::{Result, positive};
use crate::rheology::Rheology;

/// Logarithmic creep: J(t) = J_g + c ln(1 + t/λ).
///
/// Metals and rocks at low temperature, paper, soft glasses, concrete over months: equal creep c ln 10 in every decade
/// of time t > λ, and flow at the rate c/λ before. Its retardation spectrum is c e^(−λ/x)/x (over dx), and unbounded.
///
/// ```
/// use viscocontact::rheology::{LogCreep, Rheology};
///
/// let rock = LogCreep::new(20.0e-12, 1.0e-12, 10.0)?;
/// let decade = rock.creep_compliance(1.0e8) - rock.creep_compliance(1.0e7);
/// assert!((decade / (1.0e-12 * 10f64.ln()) - 1.0).abs() < 1e-5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogCreep {
    glassy: f64,
    strength: f64,
    time: f64,
}

impl LogCreep {
    /// A body of `glassy` compliance J_g \[1/Pa\] that creeps by `strength` c \[1/Pa\] for each e-fold of time after
    /// the `time` λ \[s\].
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn new(glassy: f64, strength: f64, time: f64) -> Result<LogCreep> {
        positive("glassy compliance", glassy)?;
        positive("strength of the creep", strength)?;
        positive("onset of the creep", time)?;
        Ok(LogCreep { glassy, strength, time })
    }
}

impl Rheology for LogCreep {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.glassy + self.strength * (t / self.time).ln_1p()
    }
}
