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
mod friction;
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
mod prelude;
mod recipe;
mod reports;
mod rheology;
mod run;
mod scene;
mod shapes;
mod sheared;
mod sliding;
mod states;
mod states_contact;
mod stress;
mod study;
mod temperature;
mod used;
mod writers;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // where there is no fork, there is nothing to register
        if let Ok(register) = module.py().import("os")?.getattr("register_at_fork") {
            register.call((), Some(&dict! { module.py(); "after_in_child": module.getattr("_forked")? }))?;
        }
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use crate::{
        analytic::{
            AdhesiveCylinder, AdhesivePunch, AdhesiveWave, Dmt, GrowingSphere, Jkr, MaugisDugdale, OpeningEdge, hertz,
            hertz_ellipse, persson_friction, rigid_punch, rolling_cylinder,
        },
        attraction::Attraction,
        contact::{Snapshot, ViscoelasticContact},
        curves::{Curve, Experiment, Recording},
        elastic::ElasticContact,
        errors::{Cancelled, ConvergenceError},
        fields::Fields,
        fits::{Estimate, Fit, write_fits},
        friction::{FrictionContact, FrictionLimit, ShearLoad, Slides},
        grid::Grid,
        held::Times,
        identify::{Identification, ranked},
        interrupt::forked,
        kernels::{InfluenceKernel, Layer},
        loads::{Load, LoadHistory},
        maps::HeightMap,
        materials::{Material, Tension, published_materials},
        measured::{MasterCurve, Measurements},
        observe::patches,
        pictures::{Animation, Picture},
        recipe::again,
        reports::{BodyState, StepReport},
        rheology::Rheology,
        run::{Run, Sample},
        scene::memory,
        shapes::Shape,
        sliding::{SlidingReport, SlidingTable, SteadySliding},
        states::ElasticStates,
        states_contact::StatesContact,
        stress::{EnergyBalance, SubsurfaceStress},
        study::Study,
        temperature::{TemperatureHistory, TimeTemperature},
        writers::{CsvHistory, FrameSeries},
    };
}
