//! Guides: pages with programs to start from, all of which are run as tests.
//!
//! | page | |
//! |---|---|
//! | [`tour`] | from a grid to a picture |
//! | [`curves`] | smooth curves of an adaptive run |
//! | [`data`] | units, moduli in tension, tables of DMA |
//! | [`accuracy`] | mesh, steps, tolerance: what to choose, and how to check it |
//! | [`own_models`] | your own rheology, shape and load |
//! | [`adhesion`] | adhesion: law, range, resolution, pull-off and jumps |
//! | [`elastic_states`] | a surface solved once, for many materials and histories: when to take which |
//! | [`friction`] | partial slip, shear and fretting of creeping bodies on elastic states |
//! | [`steady_motion`] | sliding and rolling that do not change: when to step, and when to solve for the state |
//! | [`coupling`] | a contact inside another integrator, with steps that are taken back |
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
pages! { tour curves data accuracy own_models adhesion elastic_states friction steady_motion coupling long_runs results }
