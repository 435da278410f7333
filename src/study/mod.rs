//! The convergence study: the error of a result in mesh and time, measured by runs.

mod accuracy;
mod cost;
mod domain;
mod driver;
mod level;
mod observable;
mod result;
mod scene;
mod tuning;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub use cost::Cost;
pub use observable::Observable;
pub use result::{Ending, Measured, Mesh, StudyResult};

use crate::Grid;
use crate::axis::Axis;
use crate::contact::{Builder, Settings};
use crate::error::{Refusal, Result, count_within, coverage, exact_length, positive, within};
use crate::fields::Fields;
use crate::load::LoadHistory;
use crate::study::domain::{Side, probe};
use crate::study::observable::{Observed, Reading};
use crate::study::scene::StudyScene;

/// The accuracy of a study, unless another is set.
const DEFAULT_ACCURACY: f64 = 1e-3;
/// Most cells of a mesh, unless another budget is given.
const DEFAULT_CELLS: usize = 1 << 18;

/// A convergence study of a scene along its load history: the extent of the contact is found, the error in time
/// measured on a coarse mesh, and the error of the mesh on meshes each 1.25 to 2 times as fine as the last, until what
/// is asked is met. The result is the finest run itself, with the measured error of each quantity.
///
/// # Rule
/// 1. *Domain*: elastic contacts under the maximum loads, on 24 × 24 cells, then the first run of the study;
///    [`Study::domain`],
///    [`Study::period`] and [`Study::line`] give sides instead.
/// 2. *Time*: on the first mesh, 16 cells across the widest contact or 32 along a domain that is given, the run is taken with a tolerance and with an
///    eighth of it. Their difference at the ends of steps is the error in time; the tolerance falls until this is at
///    most 0.4 of the accuracy.
/// 3. *Mesh*: the run is taken on finer meshes, in the same steps or shorter ones. Of three meshes the differences d₁
///    and d₂ show the order p, and 1.25 d₂/(rᵖ − 1) is the error of the finest: the grid convergence index (P. J.
///    Roache, J. Fluids Eng. 116 (1994) 405). Two meshes have 1.25 d/(r − 1); where no order
///    of ½ or more is observed, the factor is 3, p is ½, and d the larger of both differences.
/// 4. It ends where error in time and error of the mesh of all quantities that are [asked](Study::ask) for are at
///    most the accuracy, where the [budget](Study::cells) is used up, or where a quantity does not converge on four
///    meshes in a row, or in time ([`Ending`]).
///
/// Each error is relative to the maximum value of the run. Where the differences do not fall with the cells, as of a
/// pressure that is infinite at an edge, the study gives no error, and says so ([`Measured::error`]). A measured
/// error is a typical size of the true one and no bound: `docs/accuracy.md` has the ratios of random scenes. What no
/// mesh of the study resolves, such as waves shorter than its cells, is not seen by it.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let sphere = Sphere::new(10.0e-3)?;
/// let body = Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?);
/// let load = StepLoad::new(Load::force(1.0))?;
/// let scene = |grid: Grid, settings: Settings| {
///     Ok(ViscoelasticContact::builder(grid).geometry(&sphere).material(body.clone()).settings(settings))
/// };
/// let study = Study::new(scene, &load, 2.0).accuracy(1e-2).run()?;
/// println!("{study}");
/// assert!(study.is_converged());
///
/// let exact = viscocontact::analytic::GrowingSphere::step(10.0e-3, &body, 1.0)?.approach(2.0);
/// let error = study.measured("approach").unwrap().error().unwrap();
/// assert!((study.contact().approach() / exact - 1.0).abs() < 1e-2 && error < 1e-2);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
#[must_use = "nothing is computed until it runs"]
pub struct Study<'a> {
    scene: StudyScene<'a>,
    sides: [Side; 2],
    /// Sides that are periods of the body.
    periods: [bool; 2],
    observed: Vec<Observed<'a>>,
    fields_at: Vec<f64>,
    budget: Budget,
    cancelled: Option<Arc<AtomicBool>>,
}

/// What a study may take: cells of a mesh, bytes of a run, and work of all runs.
#[derive(Debug, Clone, Copy)]
struct Budget {
    cells: usize,
    bytes: Option<u64>,
    work: Option<f64>,
}

/// How far a study has come, after each step of its runs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StudyProgress {
    /// Number of runs that are done.
    pub runs: usize,
    /// Cells of the run under way.
    pub cells: [usize; 2],
    /// Its steps.
    pub steps: usize,
    /// Its time \[s\].
    pub time: f64,
    /// The time at its end \[s\].
    pub until: f64,
    /// Convolution equivalents so far, each times the cells of its mesh.
    pub work: f64,
    /// The run with which the study is expected to end, from what was measured so far; `None` before the second mesh.
    pub expected: Option<Cost>,
}

impl<'a> Study<'a> {
    /// A study of a scene from rest to the time `until` \[s\]: `scene` gives the contact on a grid, with these
    /// settings.
    pub fn new(
        scene: impl Fn(Grid, Settings) -> Result<Builder> + 'a,
        history: &'a dyn LoadHistory,
        until: f64,
    ) -> Study<'a> {
        Study::along_each(scene, &[history], until)
    }

    /// [`Study::new`] of several rigid bodies, each along a history of its own, in their order.
    pub fn along_each(
        scene: impl Fn(Grid, Settings) -> Result<Builder> + 'a,
        histories: &[&'a dyn LoadHistory],
        until: f64,
    ) -> Study<'a> {
        let asked = |observable: Observable| matches!(observable, Observable::Approach | Observable::Force);
        Study {
            scene: StudyScene { on: Box::new(scene), histories: histories.to_vec(), until, accuracy: DEFAULT_ACCURACY },
            sides: [Side::Found; 2],
            periods: [false; 2],
            observed: Observable::ALL.map(|observable| observable.observed(asked(observable))).into(),
            fields_at: Vec::new(),
            budget: Budget { cells: DEFAULT_CELLS, bytes: None, work: None },
            cancelled: None,
        }
    }

    /// The accuracy: the error relative to the maximum value of the run, from 1e-6 to 0.1. 1e-2 is for a first look,
    /// 1e-3, the default, for design, and 1e-4 for reference solutions.
    pub fn accuracy(mut self, accuracy: f64) -> Study<'a> {
        self.scene.accuracy = accuracy;
        self
    }

    /// Asks for the accuracy of a quantity, too. Approach and force are asked for by default; all of [`Observable`]
    /// are measured.
    pub fn ask(mut self, observable: Observable) -> Study<'a> {
        self.observed.iter_mut().filter(|own| own.name == observable.name()).for_each(|own| own.is_asked = true);
        self
    }

    /// Asks for the accuracy of a quantity of one's own, at all times relative to its maximum value.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let (punch, load) = (FlatPunch::circular(1.0e-3)?, StepLoad::new(Load::eccentric_force(1.0, [0.3e-3, 0.0]))?);
    /// let body = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
    /// let scene = |grid: Grid, settings: Settings| {
    ///     Ok(ViscoelasticContact::builder(grid).geometry(&punch).material(body.clone()).settings(settings))
    /// };
    /// let study = Study::new(scene, &load, 5.0).accuracy(3e-2);
    /// let study = study.ask_own("tilt", |fields| fields.tilt()[0]).run()?;
    /// println!("{study}");
    /// # Ok::<(), Error>(())
    /// ```
    pub fn ask_own(mut self, name: impl Into<String>, of: impl Fn(Fields<'_>) -> f64 + 'a) -> Study<'a> {
        self.observed.push(Observed { name: name.into(), is_asked: true, reading: Reading::Value(Box::new(of)) });
        self
    }

    /// Asks for the accuracy of the pressure fields at these times \[s\], in L1 over their load. Nearly all of their
    /// error is at the rim of the contact and falls with the power 3/2 of the cells, on punches with the root: they
    /// take finer meshes than approach and force.
    /// [`StudyResult::fields`] are those of the finest run.
    pub fn fields_at(mut self, times: &[f64]) -> Study<'a> {
        self.fields_at = times.to_vec();
        let is_asked = !times.is_empty();
        self.observed.retain(|own| !matches!(own.reading, Reading::Pressure));
        let pressure = || Observed { name: "pressure field".to_owned(), is_asked, reading: Reading::Pressure };
        self.observed.extend(is_asked.then(pressure));
        self
    }

    /// Both sides of the domain \[m\], where they are given with the scene, as those of a measured surface.
    pub fn domain(mut self, lengths: [f64; 2]) -> Study<'a> {
        self.sides = lengths.map(Side::Given);
        self
    }

    /// A side of the domain that is a period of the body, of this length \[m\]; the scene gives the kernel.
    pub fn period(mut self, axis: Axis, length: f64) -> Study<'a> {
        let axis = usize::from(axis == Axis::X2);
        (self.sides[axis], self.periods[axis]) = (Side::Given(length), true);
        self
    }

    /// A line contact: one cell along x2, of this length \[m\], on which the force acts; the scene gives the kernel.
    pub fn line(mut self, length: f64) -> Study<'a> {
        self.sides[1] = Side::Uniform(length);
        self
    }

    /// Most cells of a mesh (default: 2¹⁸, as of 512 × 512).
    pub fn cells(mut self, most: usize) -> Study<'a> {
        self.budget.cells = most;
        self
    }

    /// Most bytes of a run (default: what there is).
    pub fn memory(mut self, most: u64) -> Study<'a> {
        self.budget.bytes = Some(most);
        self
    }

    /// Most work of the whole study: convolution equivalents, each times the cells of its mesh (default: no limit). A
    /// run that is expected to take more than what is left is not begun; those of the first mesh are.
    pub fn work(mut self, most: f64) -> Study<'a> {
        self.budget.work = Some(most);
        self
    }

    /// Lets another thread end the step under way, as [`Run::cancelled_by`](crate::run::Run::cancelled_by).
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Study<'a> {
        self.cancelled = Some(flag);
        self
    }

    /// Runs the study.
    ///
    /// # Errors
    /// If the accuracy is not in \[1e-6, 0.1\], the end of the run or a given length is not finite and positive, a time
    /// of a field is not in the run, no cells are allowed, there is not one history for each body, no domain holds the
    /// contact, the surfaces attract each other and the domain is not given, or a run of the first mesh fails;
    /// [`Error::Cancelled`](crate::Error::Cancelled) where it was cancelled. A failure on a finer mesh ends the study
    /// with what it has ([`Ending::Failed`]).
    pub fn run(self) -> Result<StudyResult> {
        self.run_with(|_| ControlFlow::Continue(()))
    }

    /// As [`Study::run`], calling `progress` after each step of a run; it may end the study.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use viscocontact::prelude::*;
    ///
    /// let (ball, load) = (Sphere::new(10.0e-3)?, Ramp::new(Load::force(0.0), Load::force(1.0), 1.0)?);
    /// let body = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
    /// let scene = |grid: Grid, settings: Settings| {
    ///     Ok(ViscoelasticContact::builder(grid).geometry(&ball).material(body.clone()).settings(settings))
    /// };
    /// let study = Study::new(scene, &load, 5.0).accuracy(1e-2).run_with(|now| match now.expected {
    ///     // told before the dear runs
    ///     Some(cost) if cost.cells[0] > 1000 => ControlFlow::Break(()),
    ///     _ => ControlFlow::Continue(()),
    /// })?;
    /// assert!(study.cost_for(1e-4)?.unwrap().work > 3.0 * study.work);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Study::run`].
    pub fn run_with(self, mut progress: impl FnMut(StudyProgress) -> ControlFlow<()>) -> Result<StudyResult> {
        self.validate()?;
        driver::run(self, &mut progress)
    }

    fn validate(&self) -> Result<()> {
        let Study { scene, sides, periods, fields_at, budget, .. } = self;
        accuracy::check(scene.accuracy)?;
        positive("end of the run", scene.until)?;
        for (side, field) in sides.iter().zip(["side of the domain along x1", "side of the domain along x2"]) {
            if let Side::Given(length) | Side::Uniform(length) = *side {
                positive(field, length)?;
            }
        }
        for &time in fields_at {
            let inside = (0.0..=scene.until).contains(&time);
            within("time of a pressure field", time, inside, "from the start of the run to its end")?;
        }
        for (k, Observed { name, .. }) in self.observed.iter().enumerate() {
            let is_valid = !name.is_empty() && !name.contains(|c: char| ",#\"".contains(c) || c.is_control());
            if !is_valid || self.observed[..k].iter().any(|earlier| earlier.name == *name) {
                let refusal = Refusal::value("study_name", format!("the name of a quantity is {name:?}"), "");
                let allowed = "no other's, not empty, and without commas, '#', quotes and control characters";
                return Err(refusal.naming("name of a quantity").must_be(allowed).into());
            }
        }
        count_within("cells of a study", budget.cells, budget.cells > 0, "at least 1")?;
        if let Some(most) = budget.work {
            positive("work of a study", most)?;
        }
        // the scene may not allow these cells
        let Ok(builder) = (scene.on)(probe(*sides)?, accuracy::settings(scene.accuracy)) else { return Ok(()) };
        exact_length("load histories of the rigid bodies", scene.histories.len(), builder.gaps.len())?;
        let periodic = builder.kernel.as_ref().map_or([false; 2], |kernel| kernel.periodic_axes());
        let is_line = matches!(sides[1], Side::Uniform(_));
        let allowed = "that of a kernel which the scene has (Builder::kernel)";
        let parts = [
            ("period of the body along x1", 0, periods[0] && !periodic[0]),
            ("period of the body along x2", 1, periods[1] && !periodic[1]),
            ("length of a line contact", 1, is_line && builder.kernel.is_none()),
        ];
        for (field, axis, lacks) in parts {
            if let Side::Given(length) | Side::Uniform(length) = sides[axis] {
                within(field, length, !lacks, allowed)?;
            }
        }
        let is_given = !sides.contains(&Side::Found);
        coverage::FOUND_DOMAIN.refuse_if(|_| builder.attraction.is_some() && !is_given)
    }
}
