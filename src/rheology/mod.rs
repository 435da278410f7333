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
//! | [`GeneralizedMaxwell`] | of the relaxation modulus G_∞ + Σ G_k e^(−t/τ_k) |
//! | [`PowerLaw`] | J₁ (t/t₁)^α |
//! | [`FractionalMaxwell`] | 1/G + t^α/(V Γ(1 + α)); Findley's J₀ + m tⁿ |
//! | [`FractionalZener`] | 1/G + [1 − E_α(−(t/λ)^α)]/G_K |
//! | [`Kww`] | J_g + ΔJ [1 − e^(−(t/λ)^β)] |
//! | [`LogCreep`] | J_g + c ln(1 + t/λ) |
//! | [`SlowCreep`] | J_g + c ln(1 + (t/λ)ⁿ) |
//! | [`FnRheology`] | any closure |
//! | [`TabulatedCreep`], [`TabulatedRelaxation`], [`TabulatedDynamic`] | fitted to measurements |
//! | [`AtTemperature`] | of another model, at another temperature |
//!
//! A [`Rheology`] describes shear; a [`Material`] adds what the volume does and yields the contact
//! compliance C(t) that the surface responds with. Published materials are in [`library`], the laws that every
//! rheology obeys in [`laws`].
//!
//! # Exponential series
//!
//! A contact remembers through an exponential series: one field for each relaxation time, however many steps came
//! before. The models above the power law, the tables and what is made of them have an exact one
//! ([`Rheology::creep_spectrum`]). For the others [`Rheology::series`] finds the fewest terms that stay within a
//! tolerance over a range of times, and tells how well it did; contacts do so on their own
//! ([`Builder::times`](crate::contact::Builder::times)). Measured with a tolerance of 1e-4:
//!
//! | J(t) | terms a decade |
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
mod generalized_kelvin;
mod generalized_maxwell;
mod interconversion;
mod kelvin_voigt;
mod kww;
pub mod laws;
pub mod library;
mod log_creep;
mod material;
mod maxwell;
mod mittag_leffler;
mod power_law;
mod series;
mod slow_creep;
mod spectrum;
mod table;
mod time_temperature;
mod zener;

pub use crate::error::{MaterialError, Place, TableError};
pub use burgers::Burgers;
pub use elastic::Elastic;
pub use fit::{FitReport, FitSample, FitWarning, MaterialFunction};
pub use fractional_maxwell::FractionalMaxwell;
pub use fractional_zener::FractionalZener;
pub use function::FnRheology;
pub use generalized_kelvin::GeneralizedKelvin;
pub use generalized_maxwell::GeneralizedMaxwell;
pub use kelvin_voigt::KelvinVoigt;
pub use kww::Kww;
pub use log_creep::LogCreep;
pub use material::Material;
pub use maxwell::Maxwell;
pub use power_law::PowerLaw;
pub use series::CreepSeries;
pub use slow_creep::SlowCreep;
pub use spectrum::{CreepSpectrum, RelaxationSpectrum};
#[cfg(feature = "csv")]
pub use table::Units;
pub use table::{Isotherm, MasterCurve, TabulatedCreep, TabulatedDynamic, TabulatedRelaxation};
pub(crate) use time_temperature::GAS_CONSTANT;
pub use time_temperature::{AtTemperature, TimeTemperature};
pub use zener::Zener;

use std::fmt::Debug;
use std::ops::RangeInclusive;

use crate::error::Result;

/// The shear creep of a linear viscoelastic body.
///
/// J(t) is the shear strain at time t after a unit shear stress was applied at t = 0. It is ≥ 0 and
/// never decreases; J(0) = 1/G is the elastic response, 0 for a body without one. After t = 0 it is positive, and for every body of
/// springs and dashpots it is concave, too: others have no series, and only direct sums take them ([`laws`]).
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
    /// J(t) \[1/Pa\] at t ≥ 0 \[s\].
    fn creep_compliance(&self, t: f64) -> f64;

    /// The exact exponential series of J, if there is one.
    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        None
    }

    /// The age \[s\] up to which J is known, +∞ for a formula. A contact refuses to look further.
    fn known_until(&self) -> f64 {
        f64::INFINITY
    }

    /// The shortest and the longest time \[s\] that J was measured, or fitted, over: (0, +∞) for a formula. It goes on below
    /// and, where it was told to, above: there it is a guess, and a step says so
    /// ([`Warning::Extrapolated`](crate::contact::Warning::Extrapolated)).
    fn measured(&self) -> [f64; 2] {
        [0.0, self.known_until()]
    }

    /// How well the series stands for what it was fitted to, if it was: a table, or another function.
    fn fit_report(&self) -> Option<&FitReport> {
        None
    }

    /// The exact exponential series of J, or else one fitted over `times` \[s\]: the fewest terms found whose
    /// relative error is at most `tolerance`. With a series a step of a contact costs the same however many
    /// went before.
    ///
    /// # Errors
    /// If the times are not in \[1e-90, 1e90\] and in order, a series must be fitted over more than 50 decades of them, the
    /// tolerance is outside \[1e-8, 0.1\], J is not a creep compliance there, or no series found reaches the tolerance ([`MaterialError::PoorFit`]): J is
    /// then not that of a body of springs and dashpots, or the tolerance is too small (below 1e-6).
    fn series(&self, times: RangeInclusive<f64>, tolerance: f64) -> Result<CreepSeries> {
        CreepSeries::new(self, times, tolerance)
    }
}

/// Compliances that fall by less, relatively, do so by rounding.
const ROUNDING: f64 = 1e-12;

/// Whether a rheology known until some time is known at `t`, which may miss the end by rounding.
pub(crate) fn is_known(t: f64, until: f64) -> bool {
    t <= until * (1.0 + 1e-9)
}

/// Whether a compliance may follow an earlier one: it is finite and has not fallen, but for rounding.
fn may_follow(value: f64, earlier: f64) -> bool {
    value.is_finite() && value >= earlier * (1.0 - ROUNDING)
}

/// What is owned, shared or chosen at run time behind a pointer serves like the thing itself.
macro_rules! forward_rheology {
    ($($pointer:ty),*) => {$(
        impl<T: Rheology + ?Sized> Rheology for $pointer {
            fn creep_compliance(&self, t: f64) -> f64 {
                (**self).creep_compliance(t)
            }

            fn creep_spectrum(&self) -> Option<CreepSpectrum> {
                (**self).creep_spectrum()
            }

            fn known_until(&self) -> f64 {
                (**self).known_until()
            }

            fn measured(&self) -> [f64; 2] {
                (**self).measured()
            }

            fn fit_report(&self) -> Option<&FitReport> {
                (**self).fit_report()
            }

            fn series(&self, times: RangeInclusive<f64>, tolerance: f64) -> Result<CreepSeries> {
                (**self).series(times, tolerance)
            }
        }
    )*};
}
forward_rheology!(Box<T>, std::sync::Arc<T>);

/// [`Rheology`] for a model that holds its exact series in a field `spectrum`.
macro_rules! exponential_rheology {
    ($model:ty) => {
        impl $crate::rheology::Rheology for $model {
            fn creep_compliance(&self, t: f64) -> f64 {
                self.spectrum.compliance(t)
            }

            fn creep_spectrum(&self) -> Option<$crate::rheology::CreepSpectrum> {
                Some(self.spectrum.clone())
            }
        }
    };
}
use exponential_rheology;
