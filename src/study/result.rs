//! What a study found.

use std::fmt;
use std::io::Write;
use std::path::Path;

use crate::contact::{Builder, ViscoelasticContact};
use crate::error::{Error, Result};
use crate::fields::{Fields, KeptFields};
use crate::file::replace;
use crate::run::Stepping;
use crate::study::level::Level;
use crate::study::tuning::TUNING;
use crate::study::{Cost, accuracy};

/// A mesh of a study, and what its run took.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Mesh {
    /// Cells along x1 and x2.
    pub cells: [usize; 2],
    /// Sides of a cell \[m\].
    pub spacing: [f64; 2],
    /// Steps of the run.
    pub steps: usize,
    /// Convolution equivalents of the run, each O(N log N) in the number of cells.
    pub convolutions: f64,
    /// The change of each quantity from the mesh before, in the order of [`StudyResult::quantities`]; `None` on the
    /// first one.
    pub changes: Vec<Option<f64>>,
}

impl Mesh {
    pub(super) fn of(level: &Level, changes: Vec<Option<f64>>) -> Mesh {
        let Level { grid, convolutions, .. } = level;
        Mesh {
            cells: grid.cells(),
            spacing: grid.spacing(),
            steps: level.steps(),
            convolutions: *convolutions,
            changes,
        }
    }

    /// The side of a square of the area of a cell, along x1 on a line.
    pub(super) fn side(&self) -> f64 {
        let [s1, s2] = self.spacing;
        if self.cells[1] == 1 { s1 } else { (s1 * s2).sqrt() }
    }
}

/// The measured error of a quantity in the finest run, relative to its maximum value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Measured {
    /// The quantity.
    pub name: String,
    /// Whether its accuracy was asked for.
    pub is_asked: bool,
    /// Error in time, from a run in shorter steps on the first mesh.
    pub time: f64,
    /// Error of the mesh: the grid convergence index. `None` where it does not converge, or one mesh alone was run.
    pub mesh: Option<f64>,
    /// The order in the side of the cells that three meshes show; `None` where they do not show one.
    pub order: Option<f64>,
}

impl Measured {
    /// Errors in time and of the mesh together; `None` where it does not converge.
    pub fn error(&self) -> Option<f64> {
        self.mesh.map(|mesh| mesh + self.time)
    }
}

/// Why a study ended.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Ending {
    /// What was asked is met.
    Reached,
    /// The error in time of a quantity that is asked for does not fall below the accuracy with shorter steps: meshes
    /// would not lower it.
    Time,
    /// A quantity that is asked for does not converge: its changes do not fall with the cells.
    NoConvergence,
    /// The next mesh would have more cells than allowed.
    Cells,
    /// The next run would need more memory than allowed, or than there is.
    Memory,
    /// The next run is expected to take more work than is left.
    Work,
    /// The run on the next mesh failed.
    Failed(Error),
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Ending::Reached => "reached",
            Ending::Time => "not reached: shorter steps do not lower the error in time",
            Ending::NoConvergence => "not reached: a quantity does not converge",
            Ending::Cells => "not reached with the cells that are allowed",
            Ending::Memory => "not reached with the memory there is",
            Ending::Work => "not reached with the work that is allowed",
            Ending::Failed(error) => return write!(f, "not reached: the next run failed: {error}"),
        })
    }
}

/// Powers with which steps grow as their tolerance falls, and convolutions of a step with the cells along a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Growth {
    pub(super) steps: f64,
    pub(super) convolutions: f64,
}

/// How the steps of a run are chosen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steps {
    /// Further times at which steps end.
    pub(super) stops: Vec<f64>,
    pub(super) tolerance: f64,
}

/// The result of a [`Study`](crate::study::Study): its finest run, with the measured error of each quantity and the
/// table of all meshes ([`Display`](std::fmt::Display), [`StudyResult::write_csv`], and with the feature `plot` a
/// picture).
#[derive(Debug)]
#[non_exhaustive]
pub struct StudyResult {
    /// The accuracy that was asked for.
    pub accuracy: f64,
    /// Why it ended.
    pub ending: Ending,
    /// The meshes, the coarsest first.
    pub meshes: Vec<Mesh>,
    /// The quantities, with the errors of the finest run.
    pub quantities: Vec<Measured>,
    /// Runs of the whole study.
    pub runs: usize,
    /// Convolution equivalents of the whole study, each times the cells of its mesh.
    pub work: f64,
    pub(super) finest: Level,
    steps: Steps,
    pub(super) growth: Growth,
}

impl StudyResult {
    pub(super) fn new(
        finest: Level,
        meshes: Vec<Mesh>,
        quantities: Vec<Measured>,
        accuracy: f64,
        steps: Steps,
        growth: Growth,
    ) -> StudyResult {
        StudyResult { accuracy, ending: Ending::Cells, meshes, quantities, runs: 0, work: 0.0, finest, steps, growth }
    }

    /// Whether all that was asked for is met.
    pub fn is_converged(&self) -> bool {
        self.ending == Ending::Reached
    }

    /// A quantity by its name.
    pub fn measured(&self, name: &str) -> Option<&Measured> {
        self.quantities.iter().find(|own| own.name == name)
    }

    /// The contact at the end of the finest run.
    pub fn contact(&self) -> &ViscoelasticContact {
        &self.finest.contact
    }

    /// The builder of the finest run, to take it again: from rest, with [`StudyResult::stepping`] and steps that end at
    /// [`StudyResult::stops`].
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let (ball, load) = (Sphere::new(10.0e-3)?, StepLoad::new(Load::force(1.0))?);
    /// let body = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
    /// let scene = |grid: Grid, settings: Settings| {
    ///     Ok(ViscoelasticContact::builder(grid).geometry(&ball).material(body.clone()).settings(settings))
    /// };
    /// let study = Study::new(scene, &load, 5.0).accuracy(1e-2).run()?;
    /// let mut contact = study.builder().clone().build()?;
    /// let mut run = contact.follow(&load, study.stepping(), 5.0).stop_at(study.stops())?;
    /// while run.next_step()?.is_some() {}
    /// assert_eq!(contact.approach(), study.contact().approach());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn builder(&self) -> &Builder {
        &self.finest.builder
    }

    /// The stepping of the finest run.
    pub fn stepping(&self) -> Stepping {
        Stepping::adaptive(self.steps.tolerance)
    }

    /// Further times at which steps of the finest run end \[s\].
    pub fn stops(&self) -> &[f64] {
        &self.steps.stops
    }

    /// Ends of the steps of the finest run \[s\], each of several at one time.
    pub fn times(&self) -> &[f64] {
        &self.finest.times
    }

    /// A quantity at [`StudyResult::times`] in the finest run, by its name; the maximum pressure of the run is one
    /// number.
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        let k = self.quantities.iter().position(|own| own.name == name)?;
        Some(&self.finest.values[k])
    }

    /// The fields of the finest run at the times that were asked for
    /// ([`Study::fields_at`](crate::study::Study::fields_at)).
    pub fn fields(&self) -> impl Iterator<Item = Fields<'_>> {
        self.finest.fields.iter().map(KeptFields::fields)
    }

    /// Bytes of the contact of the finest run.
    pub fn bytes(&self) -> u64 {
        self.finest.bytes
    }

    pub(super) fn work_of_finest(&self) -> f64 {
        self.finest.convolutions * self.finest.grid.len() as f64
    }

    /// What a run to an accuracy is expected to take; `None` where a quantity that is asked for does not converge.
    ///
    /// # Errors
    /// If no study has such an accuracy.
    pub fn cost_for(&self, accuracy: f64) -> Result<Option<Cost>> {
        accuracy::check(accuracy)?;
        Ok(self.cost(accuracy))
    }

    pub(super) fn cost(&self, target: f64) -> Option<Cost> {
        let (mut finer, mut shorter) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for own in self.quantities.iter().filter(|own| own.is_asked) {
            let mesh = own.mesh?;
            finer = finer.max((mesh / ((1.0 - TUNING.in_time) * target)).powf(1.0 / own.order.unwrap_or(1.0)));
            shorter = shorter.max(own.time / (TUNING.in_time * target));
        }
        let coarsest = self.meshes.first()?.cells;
        // no coarser than the first mesh
        let finer = finer.max(coarsest[0] as f64 / self.finest.grid.cells()[0] as f64);
        let cells = self.finest.grid.cells().map(|n| if n == 1 { 1 } else { (finer * n as f64).ceil() as usize });
        // as numbers: cells of an order of a half may be more than memory could ever hold
        let many = cells.iter().map(|n| *n as f64).product::<f64>() / self.finest.grid.len() as f64;
        let steps = self.finest.steps() as f64 * shorter.max(1e-3).powf(self.growth.steps);
        let work = self.work_of_finest() * steps / self.finest.steps().max(1) as f64
            * many
            * finer.powf(self.growth.convolutions);
        Some(Cost { cells, steps: steps.ceil() as usize, work, bytes: (self.bytes() as f64 * many) as u64 })
    }

    /// Writes the table as a CSV file: a row for each mesh, and rows of orders and errors. An existing file
    /// is replaced.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_csv(&self, path: impl AsRef<Path>) -> Result<()> {
        replace(path.as_ref(), |out| {
            write!(out, "row,cells 1,cells 2,cell side 1 [m],cell side 2 [m],steps,convolutions")?;
            self.quantities.iter().try_for_each(|own| write!(out, ",{}", own.name))?;
            writeln!(out)?;
            for Mesh { cells: [n1, n2], spacing: [s1, s2], steps, convolutions, changes } in &self.meshes {
                write!(out, "change,{n1},{n2},{s1:?},{s2:?},{steps},{convolutions:?}")?;
                changes.iter().try_for_each(|change| write!(out, ",{}", optional(*change)))?;
                writeln!(out)?;
            }
            for (name, of) in ROWS {
                write!(out, "{name},,,,,,")?;
                self.quantities.iter().try_for_each(|own| write!(out, ",{}", optional(of(own))))?;
                writeln!(out)?;
            }
            Ok(())
        })
    }
}

/// What is told of each quantity.
type Row = (&'static str, fn(&Measured) -> Option<f64>);
const ROWS: [Row; 4] = [
    ("order", |own| own.order),
    ("error of mesh", |own| own.mesh),
    ("error in time", |own| Some(own.time)),
    ("error", Measured::error),
];

fn optional(value: Option<f64>) -> String {
    value.map(|value| format!("{value:?}")).unwrap_or_default()
}

/// A table: the change of each quantity from mesh to mesh, and its errors in the finest run.
impl fmt::Display for StudyResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([n1, n2], side) = (self.finest.grid.cells(), self.finest.grid.spacing()[0]);
        writeln!(
            f,
            "accuracy {:e}: {}; {n1} × {n2} cells of {side:.2e} m, {} steps, {} runs",
            self.accuracy,
            self.ending,
            self.finest.steps(),
            self.runs
        )?;
        let width = |own: &Measured| own.name.len().max(9);
        write!(f, "{:>15} {:>6}", "cells", "steps")?;
        self.quantities.iter().try_for_each(|own| write!(f, "  {:>width$}", own.name, width = width(own)))?;
        for Mesh { cells: [n1, n2], steps, changes, .. } in &self.meshes {
            write!(f, "\n{:>15} {steps:>6}", format!("{n1} × {n2}"))?;
            for (own, change) in self.quantities.iter().zip(changes) {
                let text = change.map_or("–".to_owned(), |change| format!("{change:.1e}"));
                write!(f, "  {text:>width$}", width = width(own))?;
            }
        }
        for (name, of) in ROWS {
            write!(f, "\n{name:>22}")?;
            for own in &self.quantities {
                let text = match (of(own), name) {
                    (Some(value), "order") => format!("{value:.2}"),
                    (Some(value), _) => format!("{value:.1e}"),
                    (None, "error") => "none".to_owned(),
                    (None, _) => "–".to_owned(),
                };
                write!(f, "  {text:>width$}", width = width(own))?;
            }
        }
        let all = self.quantities.iter().enumerate();
        all.filter(|(_, own)| own.error().is_none() && self.meshes.len() > 1).try_for_each(|(k, own)| {
            let change = self.meshes.iter().filter_map(|mesh| mesh.changes[k]).next_back().unwrap_or(f64::NAN);
            write!(f, "\n{}: not converged, last change {change:.1e}", own.name)
        })
    }
}
