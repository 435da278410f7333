//! viscocontact for Python: arrays in, arrays out. The GIL is free while Rust computes; nothing is computed here.

#[macro_use]
mod macros;

mod analytic;
mod arrays;
mod attraction;
mod both;
mod contact;
mod curves;
mod elastic;
mod errors;
mod fields;
mod fits;
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
mod pictures;
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
mod stress;
mod study;
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
    use crate::analytic::{
        AdhesiveCylinder, AdhesivePunch, AdhesiveWave, Dmt, GrowingSphere, Jkr, MaugisDugdale, OpeningEdge, hertz,
        hertz_ellipse, persson_friction, rigid_punch, rolling_cylinder,
    };
    #[pymodule_export]
    use crate::attraction::Attraction;
    #[pymodule_export]
    use crate::contact::{Snapshot, ViscoelasticContact};
    #[pymodule_export]
    use crate::curves::{Curve, Experiment, Recording};
    #[pymodule_export]
    use crate::elastic::ElasticContact;
    #[pymodule_export]
    use crate::errors::{Cancelled, ConvergenceError};
    #[pymodule_export]
    use crate::fields::Fields;
    #[pymodule_export]
    use crate::fits::{Estimate, Fit, write_fits};
    #[pymodule_export]
    use crate::grid::Grid;
    #[pymodule_export]
    use crate::held::Times;
    #[pymodule_export]
    use crate::identify::{Identification, ranked};
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
    use crate::observe::patches;
    #[pymodule_export]
    use crate::pictures::{Animation, Picture};
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
    use crate::stress::{EnergyBalance, StressHistory, SubsurfaceStress};
    #[pymodule_export]
    use crate::study::Study;
    #[pymodule_export]
    use crate::temperature::{TemperatureHistory, TimeTemperature};
    #[pymodule_export]
    use crate::writers::{CsvHistory, FrameSeries};
}
