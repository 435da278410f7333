//! viscocontact for Python: arrays in, arrays out. The GIL is free while Rust computes; nothing is computed here.

mod analytic;
mod arrays;
mod attraction;
mod checkpoint;
mod contact;
mod curves;
mod errors;
mod fields;
mod grid;
mod held;
mod identify;
mod interrupt;
mod kernels;
mod loads;
mod maps;
mod materials;
mod measured;
mod observe;
mod plan;
mod recipe;
mod reports;
mod rheology;
mod run;
mod scene;
mod scratch;
mod shapes;
mod sliding;
mod states;
mod states_contact;
mod temperature;
mod writers;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use crate::analytic::{GrowingSphere, hertz, jkr_pull_off, persson_friction};
    #[pymodule_export]
    use crate::attraction::Attraction;
    #[pymodule_export]
    use crate::contact::{Snapshot, ViscoelasticContact};
    #[pymodule_export]
    use crate::curves::{Curve, Experiment, Recording};
    #[pymodule_export]
    use crate::errors::{Cancelled, ConvergenceError};
    #[pymodule_export]
    use crate::grid::Grid;
    #[pymodule_export]
    use crate::held::Times;
    #[pymodule_export]
    use crate::identify::{Estimate, Fit, Identification};
    #[pymodule_export]
    use crate::kernels::{InfluenceKernel, Layer};
    #[pymodule_export]
    use crate::loads::{Load, LoadHistory};
    #[pymodule_export]
    use crate::maps::HeightMap;
    #[pymodule_export]
    use crate::materials::{Material, Tension, published_materials};
    #[pymodule_export]
    use crate::measured::{MasterCurve, Measurements};
    #[pymodule_export]
    use crate::observe::SubsurfaceStress;
    #[pymodule_export]
    use crate::plan::Plan;
    #[pymodule_export]
    use crate::recipe::again;
    #[pymodule_export]
    use crate::reports::{BodyState, StepReport};
    #[pymodule_export]
    use crate::rheology::Rheology;
    #[pymodule_export]
    use crate::run::{Run, Sample};
    #[pymodule_export]
    use crate::scene::memory;
    #[pymodule_export]
    use crate::shapes::Shape;
    #[pymodule_export]
    use crate::sliding::{SlidingReport, SlidingTable, SteadySliding};
    #[pymodule_export]
    use crate::states::ElasticStates;
    #[pymodule_export]
    use crate::states_contact::StatesContact;
    #[pymodule_export]
    use crate::temperature::{TemperatureHistory, TimeTemperature};
    #[pymodule_export]
    use crate::writers::{CsvHistory, FrameSeries};
}
