//! How creep depends on temperature.

mod history;
mod law;
mod shifted;

pub use history::TemperatureHistory;
pub(crate) use history::vertical_factors;
#[cfg(feature = "data")]
pub(crate) use law::GAS_CONSTANT;
pub use law::TimeTemperature;
pub use shifted::ShiftedRheology;
