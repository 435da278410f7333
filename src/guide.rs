//! Guides: pages with programs to start from, all of which are run as tests.
//!
//! | page | |
//! |---|---|
//! | [`tour`] | from a grid to a picture |
//! | [`accuracy`] | mesh, steps, tolerance: what to choose, and how to check it |
//! | [`own_models`] | your own rheology, shape and load |
//! | [`data`] | units, moduli in tension, tables of DMA |
//! | [`curves`] | smooth curves of an adaptive run |
//! | [`coupling`] | a contact inside another integrator, with steps that are taken back |
//! | [`adhesion`] | surfaces that stick: law, range, resolution, loads that pull |
//! | [`elastic_states`] | a surface solved once, for many materials and histories: when to take which |
//! | [`steady_motion`] | sliding and rolling that do not change: when to step, and when to solve for the state |
//! | [`long_runs`] | saved and resumed runs, many contacts on threads |
//! | [`results`] | files in pandas, NumPy and PyVista; views as arrays and matrices |
//!
//! The same pages are in the folder `docs/guide` of the source.

macro_rules! pages {
    ($($page:ident)*) => {$(
        pub mod $page {
            #![doc = include_str!(concat!("../docs/guide/", stringify!($page), ".md"))]

            use crate::prelude::*;
            use crate::*;
        }
    )*};
}
pages! { tour accuracy own_models data curves coupling adhesion elastic_states steady_motion long_runs results }
