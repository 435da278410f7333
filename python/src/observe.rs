//! What a state shows: patches, profiles, stress.

use numpy::PyArrayMethods;
use viscocontact::observe as ob;

use crate::arrays::{columns, field};
use crate::prelude::*;
use crate::stress::SubsurfaceStress;

/// What a class that has fields shows.
macro_rules! observed {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// The force that moves `shape` along the surface without friction, along x1 and x2 [N]: the pressure times the slopes of the shape,
            /// which leave it within a cell of the edge of the contact. Of a steady motion `SlidingReport.lateral_force` is more accurate.
            fn slope_force(slf: Shared<'_, Self>, py: Python<'_>, shape: &Shape) -> PyResult<(f64, f64)> {
                let contact = slf.shown()?;
                Ok(free(py, || contact.slope_force(&*shape.geometry)).into())
            }

            /// Normal stiffness over the contact modulus [m].
            fn stiffness_over_modulus(slf: Shared<'_, Self>, py: Python<'_>) -> PyResult<f64> {
                let contact = slf.shown()?;
                free(py, || contact.stiffness_over_modulus()).or_raise()
            }

            /// Relative errors due to the mesh, measured by elastic contacts on half and a quarter of the cells along each side: "approach", "max_pressure" (None where it does not converge), "pressure_field" (Σ |δp| over
            /// Σ p), "area"; None where they are too few.
            fn mesh_error<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Option<Dict<'py>>> {
                let contact = slf.shown()?;
                let Some(error) = free(py, || contact.mesh_error()).or_raise()? else { return Ok(None) };
                Ok(Some(dict! { py; error { approach, max_pressure, pressure_field, area } }))
            }

            /// Arrays "position" [m], "pressure", "displacement", "gap" and "traction" along the line of cells in the direction of the axis `along`
            /// (0 or 1) that contains the other coordinate `at` [m].
            #[pyo3(signature = (along=0, at=0.0))]
            fn profile<'py>(slf: Shared<'_, Self>, py: Python<'py>, along: usize, at: f64) -> PyResult<Dict<'py>> {
                let line = slf.shown()?.profile(axis(along)?, at).or_raise()?;
                let named = [
                    ("position", line.positions),
                    ("pressure", line.pressure),
                    ("displacement", line.displacement),
                    ("gap", line.gap),
                    ("traction", line.traction),
                ];
                columns(py, named)
            }

            /// The connected patches of the contact: an array of labels (0 out of contact, k + 1 in patch k), and for each patch a dict of
            /// "cells", "area" [m²], "force" [N], "centroid" [m], "max_pressure" [Pa] and "winds" (around periodic axes).
            fn patches<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Labelled<'py>> {
                let contact = slf.shown()?;
                labelled(py, contact.grid(), free(py, || contact.patches()).or_raise()?)
            }

            /// The stress below the surface of the creeping body, or with `in_counter_body` of the other one.
            ///
            /// Raises NotImplementedError where it is not known: in layers, or with an elastic bulk; ValueError of an `ElasticContact`, which
            /// has no Poisson's ratio: `SubsurfaceStress` takes one.
            #[pyo3(signature = (*, in_counter_body=false))]
            fn stress(slf: Shared<'_, Self>, py: Python<'_>, in_counter_body: bool) -> PyResult<SubsurfaceStress> {
                let contact = slf.shown()?;
                let stress =
                    free(py, || if in_counter_body { contact.stress_in_counter_body() } else { contact.stress() })
                        .or_raise()?;
                Ok(SubsurfaceStress(stress))
            }
        }
    };
}

observed!(ViscoelasticContact);
observed!(ElasticContact);
observed!(Fields);

type Labelled<'py> = (Object<'py>, Vec<Dict<'py>>);

fn labelled<'py>(py: Python<'py>, grid: &viscocontact::Grid, patches: ob::Patches) -> PyResult<Labelled<'py>> {
    let of = |patch: &ob::Patch| {
        let (centroid, winds): ((f64, f64), (bool, bool)) = (patch.centroid.into(), patch.winds.into());
        Ok(dict! { py; patch { cells, area, force, max_pressure }, "centroid": centroid, "winds": winds })
    };
    let all = patches.all.iter().map(of).collect::<PyResult<_>>()?;
    Ok((patches.labels.into_pyarray(py).reshape(grid.cells())?.into_any(), all))
}

/// The connected patches of a pressure [Pa] on a grid, as of `ViscoelasticContact.patches`; `periodic` along x1 and x2 or not.
///
/// >>> import numpy as np
/// >>> labels, all = patches(Grid(8, 1e-3), np.eye(8), periodic=(True, True))
/// >>> len(all), all[0]["cells"]
/// (8, 1)
#[pyfunction]
#[pyo3(signature = (grid, pressure, *, periodic=[false; 2]))]
pub fn patches<'py>(
    py: Python<'py>,
    grid: &Grid,
    pressure: &Object<'py>,
    periodic: [bool; 2],
) -> PyResult<Labelled<'py>> {
    let pressure = field("pressure", pressure, grid.0.cells())?;
    labelled(py, &grid.0, free(py, || ob::Patches::new(&grid.0, &pressure, periodic)).or_raise()?)
}
