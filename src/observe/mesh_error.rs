//! Error due to the mesh: measured by elastic contacts on half and a quarter of the cells along each side.

use crate::elastic::{ElasticBuilder, ElasticContact};
use crate::equilibrium::Edge;
use crate::error::{Error, Result, StepError, coverage};
use crate::fields::Fields;
use crate::fields::area::PressedCells;
use crate::geometry::Gap;
use crate::load::Load;
use crate::observe::MeshError;
use crate::observe::grid_convergence::{OfMesh, SINGULAR, SMOOTH, off_means};
use crate::solver::RigidMotion;
use crate::{Grid, sum};

impl Fields<'_> {
    /// The error due to the mesh, measured: the elastic contact under the same load and over the same surface is
    /// solved on half the cells along each side and, where the contact is eight cells across there, on a quarter. The
    /// surface is what the displacement u leaves beside c K p, with the compliance c of least squares: nothing on an
    /// elastic body, what its history left on one that creeps. The differences between the meshes give the error,
    /// with their observed order, or else the first, by the grid convergence index (P. J. Roache, J. Fluids Eng. 116,
    /// 1994). Costs a convolution, and a third of a step.
    ///
    /// Over true errors of random scenes of all shapes, elastic and creeping, those told are mostly 0.7 to 12 times
    /// as large (docs/accuracy.md). What no mesh of the three resolves is not seen, as waves shorter than cells.
    /// Errors of a whole run are measured by a study (feature `study`).
    ///
    /// Of several bodies the error of the approach is that of the body for which it is largest.
    ///
    /// `None` without contact, for contacts of a body that are less than about six cells across, where half the cells
    /// do not divide a period, and for coefficients of a user, which belong to cells.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let body = Material::incompressible(Elastic::new(1.0e6)?);
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 3.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(body)
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let hertz = viscocontact::analytic::Hertz::new(10.0e-3, 4.0e6, 0.5)?;
    /// let error = (contact.approach() / hertz.approach - 1.0).abs();
    /// let measured = contact.fields().mesh_error()?.expect("in contact").approach;
    /// assert!(error < 2.0 * measured && error > 0.05 * measured);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If [ranks](crate::parallel) share out the rows, surfaces [attract](crate::adhesion) each other, or there is no
    /// memory for the coarser contacts.
    pub fn mesh_error(&self) -> Result<Option<MeshError>> {
        self.covers(coverage::MESH_ERROR)?;
        mesh_error(*self)
    }
}

/// Fewest cells across the contact of a body on half and on a quarter of the cells along a side: the latter show an
/// order.
const FEWEST: [usize; 2] = [3, 8];

/// A state on a mesh.
struct Coarse {
    grid: Grid,
    pressure: Vec<f64>,
    values: Vec<f64>,
}

/// Maximum pressure, area, and the approach or the force of each body in contact.
fn values(of: Fields<'_>, by: Fields<'_>, datum: f64) -> Vec<f64> {
    let main = |body: usize| {
        let own = of.body(body).filter(|_| touches(by, body))?;
        Some(if by.is_by_approach(body) { own.force } else { own.approach - datum })
    };
    [of.max_pressure(), of.contact_area()].into_iter().chain((0..by.bodies()).filter_map(main)).collect()
}

fn touches(fields: Fields<'_>, body: usize) -> bool {
    fields.body(body).is_some_and(|own| own.contact_cells > 0)
}

/// What the state of a contact is on a coarser mesh: its gap and its surface before the pressure now, at every so
/// many cells, and its compliance.
struct State<'a> {
    fields: Fields<'a>,
    gap: Vec<f64>,
    surface: Vec<f64>,
    compliance: f64,
}

impl State<'_> {
    /// u = u₀ + c K p with the c of least squares: an elastic body has u₀ = 0, and one that creeps keeps in it what
    /// its history left.
    fn of(fields: Fields<'_>) -> Result<Option<State<'_>>> {
        let (grid, pressure) = (fields.grid(), fields.pressure());
        let (mut potential, kernel) = (vec![0.0; grid.len()], fields.kernel());
        kernel.convolve(pressure, &mut potential, &mut kernel.workspace()?)?;
        let displacement = fields.displacement();
        let dot = |a: &[f64], b: &[f64]| sum::sum(&a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>());
        let compliance = dot(displacement, pressure) / dot(&potential, pressure);
        if !(compliance > 0.0 && compliance.is_finite()) {
            return Ok(None);
        }
        let surface = displacement.iter().zip(&potential).map(|(u, v)| u - compliance * v).collect();
        let (initial, n2) = (fields.initial_gap(), grid.cells()[1]);
        let gap = initial.above.iter().enumerate().map(|(k, above)| {
            let ([x1, x2], [tilt1, tilt2]) = (grid.center(k / n2, k % n2), fields.motion(initial.owner(k)).tilt);
            above - tilt1 * x1 - tilt2 * x2
        });
        Ok(Some(State { fields, gap: gap.collect(), surface, compliance }))
    }

    /// The elastic contact on every so many cells along each side; nothing where they do not divide a period, or are
    /// no mesh of this body.
    fn on_every(&self, step: usize) -> Result<Option<Coarse>> {
        let (fields, [n1, n2]) = (self.fields, self.fields.grid().cells());
        let (spacing, periodic) = (fields.grid().spacing(), fields.kernel().periodic_axes());
        let steps = [n1, n2].map(|n| if n == 1 { 1 } else { step });
        if (0..2).any(|axis| periodic[axis] && [n1, n2][axis] % steps[axis] > 0) {
            return Ok(None);
        }
        let cells = [n1 / steps[0], n2 / steps[1]];
        let lengths = [0, 1].map(|axis| (cells[axis] * steps[axis]) as f64 * spacing[axis]);
        let made =
            Grid::new(cells, lengths).and_then(|grid| Ok((fields.kernel().on_other_cells(&grid).transpose()?, grid)));
        let (kernel, grid) = match made {
            Ok((Some(kernel), grid)) => (kernel, grid),
            // cells that are too few, or too large, for this body
            Ok((None, _)) | Err(Error::OutOfRange { .. } | Error::CountOutOfRange { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let fine = |k: usize| k / cells[1] * steps[0] * n2 + k % cells[1] * steps[1];
        let initial = fields.initial_gap();
        let of_body = |body: usize| {
            let own = |k: usize| if initial.owner(fine(k)) == body { self.gap[fine(k)] } else { f64::INFINITY };
            Ok((0..grid.len()).map(own).collect::<Vec<f64>>())
        };
        let gaps: Vec<_> = (0..fields.bodies()).map(of_body).collect();
        let settings = fields.settings().with_edge(Edge::Allow);
        let elastic = ElasticBuilder::with_gaps(grid.clone(), gaps, Vec::new()).kernel(kernel).settings(settings);
        let mut contact: ElasticContact = elastic.modulus(1.0 / self.compliance).build()?;
        contact.set_surface(&(0..grid.len()).map(|k| self.surface[fine(k)]).collect::<Vec<_>>())?;
        let loads = (0..fields.bodies()).map(|body| match (fields.is_by_approach(body), fields.body(body)) {
            (true, _) => Load::approach(fields.motion(body).approach - initial.datum),
            (false, own) => Load::force(own.map_or(0.0, |own| own.force)),
        });
        contact.solve(loads.collect::<Vec<_>>())?;
        let own = contact.fields();
        let pressed = (0..fields.bodies()).filter(|&body| touches(fields, body));
        let mut cells_of = pressed.filter_map(|body| own.body(body)).map(|own| own.contact_cells);
        let fewest = FEWEST[usize::from(step > 2)];
        // in a circle so many cells across
        let fewest = if cells.contains(&1) { fewest } else { 11 * fewest * fewest / 14 };
        if cells_of.any(|cells| cells < fewest) {
            return Ok(None);
        }
        Ok(Some(Coarse { grid, pressure: own.pressure().to_vec(), values: values(own, fields, 0.0) }))
    }
}

/// The errors of a state; `None` without contact, where half the cells are too few or no mesh of this body, or
/// nothing is pressed there.
fn mesh_error(fields: Fields<'_>) -> Result<Option<MeshError>> {
    if fields.contact_cells() == 0 {
        return Ok(None);
    }
    let Some(state) = State::of(fields)? else { return Ok(None) };
    // a coarse mesh may miss what is pressed, or not bear it
    let on_every = |step: usize| match state.on_every(step) {
        Err(Error::Step(
            StepError::BeyondFullContact { .. } | StepError::LoadOutsideHull { .. } | StepError::NotConverged { .. },
        ))
        | Err(Error::NothingToTouch { .. }) => Ok(None),
        other => other,
    };
    let Some(half) = on_every(2)? else { return Ok(None) };
    let quarter = on_every(4)?;
    // errors are those of values as they are told, which have a datum
    let [own, scales] = [fields.initial_gap().datum, 0.0].map(|datum| values(fields, fields, datum));
    let sides = [4.0, 2.0, 1.0];
    let measured = |differences: [Option<f64>; 2], most: f64| {
        let differences: Vec<f64> = differences.into_iter().flatten().collect();
        let of_all = OfMesh::of(&sides, &differences, most);
        // without an order the last two meshes count alone
        let [.., last] = differences[..] else { return of_all };
        if of_all.order.is_some() { of_all } else { OfMesh::of(&sides, &[last], most) }
    };
    let of_value = |which: usize, most: f64| {
        let off = |a: f64, b: f64| ((a - b) / scales[which]).abs();
        let first = quarter.as_ref().map(|quarter| off(quarter.values[which], half.values[which]));
        measured([first, Some(off(half.values[which], own[which]))], most)
    };
    let peak = of_value(0, SMOOTH);
    let most = if peak.order.is_some() { SMOOTH } else { SINGULAR };
    let periodic = fields.kernel().periodic_axes();
    let first = quarter.as_ref().map(|quarter| difference(quarter, &half.pressure, &half.grid, periodic));
    let field = measured([first, Some(difference(&half, fields.pressure(), fields.grid(), periodic))], most);
    Ok(Some(MeshError {
        approach: (2..own.len()).map(|which| of_value(which, most).error).fold(0.0, f64::max),
        max_pressure: peak.order.map(|_| peak.error),
        pressure_field: field.error,
        area: of_value(1, most).error,
    }))
}

/// Σ |p − p′| / Σ p′ over the cells of the coarser mesh, each about every other fine one: p′ are means over it.
fn difference(coarse: &Coarse, fine: &[f64], grid: &Grid, periodic: [bool; 2]) -> f64 {
    let [n1, n2] = grid.cells();
    let fine = PressedCells { grid, first: None, periodic, pressure: fine, gap: &|_| 0.0, extent: None };
    // beside every other cell, of which a coarse one holds half; along a line there are no others
    let beside = |n: usize, k: usize| {
        let k = k as isize;
        if n == 1 { [(k, 0.0), (k, 1.0), (k, 0.0)] } else { [(2 * k - 1, 0.25), (2 * k, 0.5), (2 * k + 1, 0.25)] }
    };
    let mean = |k: usize| {
        let (rows, columns) = (beside(n1, k / coarse.grid.cells()[1]), beside(n2, k % coarse.grid.cells()[1]));
        let all = rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column)));
        all.map(|((i, w1), (j, w2))| w1 * w2 * fine.pressure_at([*i, *j])).sum::<f64>()
    };
    off_means(&coarse.pressure, (0..coarse.pressure.len()).map(mean))
}

impl<'a> Fields<'a> {
    /// The motion of a body.
    pub(crate) fn motion(&self, body: usize) -> RigidMotion {
        self.held.current.motions[body]
    }

    /// The gap before the bodies deform.
    fn initial_gap(&self) -> &'a Gap {
        self.held.indenter.gap()
    }

    /// Whether the approach of a body is given.
    fn is_by_approach(&self, body: usize) -> bool {
        matches!(self.held.loads[body], Load::Approach { .. })
    }
}
