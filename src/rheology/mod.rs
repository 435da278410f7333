//! Linear viscoelastic materials: how a body creeps.
//!
//! | model | shear creep compliance J(t) |
//! |---|---|
//! | [`Elastic`] | 1/G |
//! | [`Maxwell`] | 1/G + t/η |
//! | [`KelvinVoigt`] | (1 − e^(−t/λ))/G, λ = η/G |
//! | [`Zener`] | 1/G + (1 − e^(−t/λ))/G_K, λ = η_K/G_K |
//! | [`Burgers`] | 1/G + t/η + (1 − e^(−t/λ))/G_K |
//! | [`GeneralizedKelvin`] | J_g + φ t + Σ J_k (1 − e^(−t/λ_k)) |
//! | [`GeneralizedMaxwell`] | creep of the relaxation modulus G_∞ + Σ G_k e^(−t/τ_k) |
//! | [`PowerLaw`] | J₁ (t/t₁)^α |
//! | [`FractionalMaxwell`] | 1/G + t^α/(V Γ(1 + α)); Findley's J₀ + m tⁿ |
//! | [`FractionalZener`] | 1/G + [1 − E_α(−(t/λ)^α)]/G_K |
//! | [`Kww`] | J_g + ΔJ [1 − e^(−(t/λ)^β)] |
//! | [`LogCreep`] | J_g + c ln(1 + t/λ) |
//! | [`SlowCreep`] | J_g + c ln(1 + (t/λ)ⁿ) |
//! | [`FnRheology`] | any closure |
//! | [`CreepSeries`] | fitted to [`Measurements`], or to another model |
//! | [`ShiftedRheology`] | J of another model, at a constant temperature; [`TemperatureHistory`]: at a changing one |
//!
//! # Arguments
//!
//! One order everywhere: a strength first (modulus \[Pa\] or compliance \[1/Pa\]), then its time \[s\], an exponent
//! last. A term of a series is the pair (strength, time): (modulus, relaxation time) where it relaxes, (compliance,
//! retardation time) where it creeps. Constructors of one name take the same of every model:
//!
//! | constructor | takes |
//! |---|---|
//! | `new` | of single elements: moduli, and the viscosity \[Pa·s\] of each dashpot; of models of several terms: pairs (strength, time); the numbers of the formula above |
//! | `with_time`, `with_times` | the same, with a time in place of each viscosity |
//! | `relaxing` | glassy modulus, rubbery modulus, relaxation time |
//! | [`GeneralizedMaxwell::prony`] | glassy modulus, share of it and relaxation time of each term ([`PronyTerm`]) |
//! | [`GeneralizedMaxwell::prony_long_term`] | shares of the rubbery modulus |
//!
//! Moduli are shear moduli. Data in tension, E(t), D(t), E′ and E″, are a [`Tension`], of which
//! [`Material::from_tension`] makes a material; elastic constants by [`Elastic::young`].
//!
//! # Materials
//!
//! A [`Rheology`] describes shear; a [`Material`] adds the bulk response and gives the contact
//! compliance C(t) of the surface. Published materials are in [`library`], the laws that every
//! rheology obeys in [`laws`].
//!
//! # Exponential series
//!
//! A contact stores its history as an exponential series: one field for each relaxation time, whatever the number of
//! steps. The models above the power law, the tables, and models derived from them have an exact series
//! ([`Rheology::creep_spectrum`]). For the others [`Rheology::series`] finds the fewest terms within a tolerance over a
//! range of times, and reports the error; contacts fit the series over the times that
//! [`Builder::times`](crate::contact::Builder::times) names. Measured with a tolerance of 1e-4:
//!
//! | J(t) | terms per decade |
//! |---|---|
//! | t^0.1 … t^0.9 over ten decades | 1.9 … 2.2 |
//! | fractional Zener, α = 0.5 | 1.8 |
//! | stretched exponential, β = 0.33 | 1.9 |
//! | logarithmic | 1.3 … 2.7 |

mod burgers;
mod dynamic;
mod elastic;
mod fit;
mod fractional_maxwell;
mod fractional_zener;
mod function;
mod generalized_maxwell;
mod interconversion;
mod kelvin_voigt;
mod kww;
#[cfg(feature = "laws")]
pub mod laws;
#[cfg(feature = "data")]
pub mod library;
mod log_creep;
mod material;
mod maxwell;
mod mittag_leffler;
mod own_series;
mod power_law;
mod ratio;
mod series;
mod slow_creep;
mod spectrum;
#[cfg(feature = "data")]
mod table;
#[cfg(feature = "temperature")]
mod temperature;
#[cfg(not(feature = "temperature"))]
#[path = "no_temperature.rs"]
mod temperature;
mod tension;
mod zener;

pub use burgers::Burgers;
pub use elastic::Elastic;
pub use fit::{FitReport, FitSample, FitWarning, MaterialFunction};
pub use fractional_maxwell::FractionalMaxwell;
pub use fractional_zener::FractionalZener;
pub use function::FnRheology;
pub use generalized_maxwell::{GeneralizedMaxwell, PronyTerm};
pub use kelvin_voigt::KelvinVoigt;
pub use kww::Kww;
pub use log_creep::LogCreep;
pub use material::Material;
pub(crate) use material::Volume;
pub use maxwell::Maxwell;
pub use power_law::PowerLaw;
pub use series::CreepSeries;
pub use slow_creep::SlowCreep;
#[cfg(feature = "checkpoint")]
pub(crate) use spectrum::SavedRelaxation;
pub use spectrum::{CreepSpectrum, GeneralizedKelvin, RelaxationSpectrum};
#[cfg(feature = "data")]
pub use table::{Experiment, Isotherm, MasterCurve, Measurements, Units};
#[cfg(feature = "data")]
pub(crate) use temperature::GAS_CONSTANT;
#[cfg(not(feature = "temperature"))]
pub(crate) use temperature::TemperatureHistory;
#[cfg(feature = "temperature")]
pub(crate) use temperature::vertical_factors;
#[cfg(feature = "temperature")]
pub use temperature::{ShiftedRheology, TemperatureHistory, TimeTemperature};
pub use tension::Tension;
pub use zener::Zener;

use std::fmt::Debug;
use std::ops::RangeInclusive;

use crate::error::{Result, UserError};

/// The shear creep of a linear viscoelastic body.
///
/// J(t) is the shear strain at time t after a unit shear stress was applied at t = 0. It is ≥ 0 and never decreases;
/// J(0) = 1/G is the elastic response, 0 for a body without one. After t = 0 it is positive, and concave for every body
/// of springs and dashpots; other bodies have no exact series: one is fitted
/// ([`laws`]).
///
/// ```
/// use viscocontact::rheology::Rheology;
///
/// /// Logarithmic creep.
/// #[derive(Debug)]
/// struct Logarithmic;
///
/// impl Rheology for Logarithmic {
///     fn creep_compliance(&self, t: f64) -> f64 {
///         1.0e-9 * (1.0 + 0.1 * t.ln_1p())
///     }
/// }
/// assert_eq!(Logarithmic.creep_compliance(0.0), 1.0e-9);
/// assert!(Logarithmic.creep_spectrum().is_none());
/// ```
pub trait Rheology: Debug + Send + Sync {
    /// J(t) \[1/Pa\] at t ≥ 0 \[s\], 2Φ(t) in Eq. 9 of the [paper](crate::paper).
    fn creep_compliance(&self, t: f64) -> f64;

    /// Why a value was none, of a creep function that can fail ([`FnRheology::fallible`]): such a value is NaN.
    fn failure(&self) -> Option<UserError> {
        None
    }

    /// The exact exponential series of J, if there is one.
    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        None
    }

    /// The longest time \[s\] at which J is known, +∞ for a formula. Steps beyond it fail.
    fn known_until(&self) -> f64 {
        f64::INFINITY
    }

    /// The shortest and the longest time \[s\] of the measurement or fit of J: (0, +∞) for a formula. J is extrapolated
    /// below and, if so chosen, above; steps there have a warning
    /// ([`Warnings::EXTRAPOLATED`](crate::contact::Warnings::EXTRAPOLATED)).
    fn measured(&self) -> [f64; 2] {
        [0.0, self.known_until()]
    }

    /// The error of the series, if it was fitted to a table or another function.
    fn fit_report(&self) -> Option<&FitReport> {
        None
    }

    /// The exact exponential series of J, or else one fitted over `times` \[s\]: the fewest terms found whose
    /// relative error is at most `tolerance`. With a series, the cost of a step does not depend on the number of steps
    /// before.
    ///
    /// # Errors
    /// If the times are not in \[1e-90, 1e90\] and in order, a series must be fitted over more than 50 decades of them,
    /// the tolerance is outside \[1e-8, 0.1\], J is not a creep compliance there, or no series reaches the tolerance:
    /// no body of springs and dashpots has this J, or the tolerance is too small (below
    /// 1e-6).
    fn series(&self, times: RangeInclusive<f64>, tolerance: f64) -> Result<CreepSeries> {
        CreepSeries::new(self, times, tolerance)
    }
}

/// A smaller relative decrease of a compliance is rounding, and so is a smaller distance of a sum of shares from 1.
const ROUNDING: f64 = 1e-12;

/// Whether `t` is within the range of a rheology known until `until`, but for rounding.
pub(crate) fn is_known(t: f64, until: f64) -> bool {
    t <= until * (1.0 + 1e-9)
}

/// Whether a compliance is finite and no less than an earlier one, but for rounding.
fn may_follow(value: f64, earlier: f64) -> bool {
    value.is_finite() && value >= earlier * (1.0 - ROUNDING)
}

/// Implements [`Rheology`] for a wrapper by the rheology inside.
macro_rules! forward_rheology {
    ($($wrapper:tt)*) => {
        forward! {
            $crate::rheology::Rheology, ($($wrapper)*),
            creep_compliance(t: f64) -> f64;
            failure() -> Option<$crate::UserError>;
            creep_spectrum() -> Option<$crate::rheology::CreepSpectrum>;
            known_until() -> f64;
            measured() -> [f64; 2];
            fit_report() -> Option<&$crate::rheology::FitReport>;
            series(times: std::ops::RangeInclusive<f64>, tolerance: f64) -> $crate::error::Result<$crate::rheology::CreepSeries>;
        }
    };
}
use forward_rheology;

forward_rheology!(<T> self: &T => **self);
forward_rheology!(<T> self: Box<T> => **self);
forward_rheology!(<T> self: std::sync::Arc<T> => **self);
