//! A contact built from its parts.

use std::sync::Arc;

use crate::contact::builder::LocalGap;
use crate::contact::builder::memory::windowed;
use crate::contact::builder::shared_gap::SharedGap;
use crate::contact::read::limits::Limits;
use crate::contact::step::attraction::resolved_softening;
use crate::contact::{Builder, Computation, Frame, Memory, Scene, Settings, State, ViscoelasticContact};
use crate::equilibrium::ground::check_bodies;
use crate::equilibrium::indenter::even_axes_of;
use crate::equilibrium::{Ground, Indenter, Region};
use crate::error::{Error, Result, Special, coverage, missing};
use crate::geometry::{Gap, Missed};
use crate::hereditary::History;
use crate::parallel::{Ranks, Rows};
use crate::rheology::Material;

impl Builder {
    /// Makes the contact: undisturbed bodies at time 0, without load.
    ///
    /// # Errors
    /// If geometry or material is missing, a gap is NaN or −∞ or none is finite, a rheology is known until NaN, a
    /// setting is out of range, the kernel was made for another grid or cannot be made for its cells
    /// ([`InfluenceKernel::half_space`](crate::InfluenceKernel::half_space)).
    ///
    /// If the kernel belongs to a layer, and the material has another Poisson's ratio, or one that is not constant,
    /// or a counter body deforms.
    ///
    /// If a rheology without an exact series is given no [`Builder::times`], no series is
    /// within the tolerance, or the times span more than 50 decades.
    ///
    /// If there is not enough memory ([`Error::OutOfMemory`], before any is taken; systems that overcommit memory, as
    /// Linux does, may grant more than is free), or more than 2³² − 1 cells would be computed.
    ///
    /// If [`Builder::ranks`] share out the rows: an error of one rank is an error on all
    /// ([`RanksError::Failed`](crate::parallel::RanksError::Failed)); a scene that cannot be shared out is refused
    /// ([`Error::NotCovered`](crate::Error::NotCovered)).
    pub fn build(mut self) -> Result<ViscoelasticContact> {
        let Some(group) = &self.ranks else {
            let (scene, history, indenter) = self.parts()?;
            let folded = if self.settings.symmetry { indenter.even_axes(&self.grid) } else { [false; 2] };
            let region = scene.ground.first_region(folded, &indenter, windowed(&scene, &history));
            scene.check_memory(&history, &region, 0)?;
            return Ok(assemble(scene, &history, indenter, region));
        };
        let rows = self.agreed_rows(group)?;
        let gaps = std::mem::take(&mut self.gaps);
        rows.or_loss(|| {
            let (scene, history) = rows.agree(self.scene(1))?;
            let (gap, even, region) = self.shared_gap(&gaps, &rows)?;
            rows.agree(scene.check_memory(&history, &region, 0))?;
            let indenter = gap.on(&region, &self.grid, even).missing(self.missed(&scene));
            drop(gaps);
            Ok(assemble(scene, &history, indenter, region))
        })
    }

    /// The constants of a contact in one process, its history, and its indenter.
    pub(crate) fn parts(&mut self) -> Result<(Scene, History, Indenter)> {
        self.validate()?;
        let gaps: Vec<_> = std::mem::take(&mut self.gaps).into_iter().map(|(_, gap)| gap).collect::<Result<_>>()?;
        let bodies = gaps.len();
        let indenter = Indenter::new(Gap::new(gaps, &self.grid)?, bodies);
        let (scene, history) = self.scene(bodies)?;
        let indenter = indenter.missing(self.missed(&scene));
        Ok((scene, history, indenter))
    }

    /// What the grid misses of the waves of the shapes.
    fn missed(&self, scene: &Scene) -> Missed {
        Missed::of(&self.waves, &self.grid, scene.ground.kernel.periodic_axes())
    }

    /// The rows of the whole grid that ranks share out, after they have agreed that they can. A call of all ranks.
    fn agreed_rows(&self, group: &Arc<dyn Ranks>) -> Result<Rows> {
        // for the agreement on the grid, before there are rows to share
        let anything = Rows::of_rank([1, 1], Arc::clone(group));
        anything.or_loss(|| {
            anything.agree(self.validate().and_then(|()| self.is_covered(Special::Ranks)))?;
            let ([n1, n2], [side1, side2]) = (self.grid.cells(), self.grid.spacing());
            let Settings { tolerance, symmetry, .. } = self.settings;
            anything.same([n1 as f64, n2 as f64, side1, side2, tolerance, f64::from(u8::from(symmetry))])?;
            Ok(Rows::of_rank([n1, n2], Arc::clone(group)))
        })
    }

    /// Rejects a special scene that does not cover one of its parts.
    pub(crate) fn is_covered(&self, special: Special) -> Result<()> {
        let frame = self.settings.frame;
        let parts = [
            (self.gaps.len() > 1, coverage::SEVERAL_BODIES),
            (frame != Frame::Bodies, coverage::FRAME_OF_INDENTER),
            (self.ranks.is_some(), coverage::SHARED_ROWS),
            (self.attraction.is_some(), coverage::ATTRACTED),
            (self.temperature.is_some(), coverage::TEMPERATURES),
        ];
        parts.into_iter().try_for_each(|(has, case)| case.refuse_if(|other| has && other == special))
    }

    /// Gap, its symmetry and the region of a contact whose rows ranks share out. A call of all ranks.
    fn shared_gap<'a>(&self, gaps: &'a [LocalGap], rows: &Rows) -> Result<(SharedGap<'a>, [bool; 2], Region)> {
        let gap = SharedGap::new(rows.agree(local_gap(gaps, rows))?, &self.grid, rows)?;
        let even = gap.even_axes();
        let region = Region::shared(&self.grid, even.map(|even| even && self.settings.symmetry), rows);
        Ok((gap, even, region))
    }

    /// The memory that the contact will take; no field is allocated to find out. The cells that are computed follow
    /// from the symmetry of the gap ([`Settings::symmetry`](crate::contact::Settings::symmetry)); with
    /// [`Settings::window`](crate::contact::Settings::window) the figure holds for the largest window. A load that
    /// breaks the symmetry makes the contact compute the mirror images too: the memory for these is returned with
    /// symmetry set to false. A gap for which there is no memory counts as asymmetric.
    ///
    /// A series of the material over [`Builder::times`] is fitted for this, in a tenth of a second. The pool of the
    /// call gives the threads. For a contact that [ranks](crate::parallel) share out, the local rows count; all ranks
    /// must call.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let scene = |cells: usize| {
    ///     Ok::<_, Error>(ViscoelasticContact::builder(Grid::square(cells, 4.0e-3)?)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?)))
    /// };
    /// let memory = scene(256)?.memory()?;
    /// assert_eq!(memory.computed_cells, 128 * 128);
    /// assert!(memory.total() < 6_000_000, "{memory}");
    /// // more than any machine has: reported, and rejected
    /// assert!(scene(1 << 25)?.memory()?.total() > 1 << 57);
    /// assert!(matches!(scene(1 << 25)?.build(), Err(Error::OutOfMemory { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Builder::build`], except for invalid gaps, memory, and more than 2³² − 1 cells.
    pub fn memory(&self) -> Result<Memory> {
        if let Some(group) = &self.ranks {
            let rows = self.agreed_rows(group)?;
            return rows.or_loss(|| {
                let (scene, history) = rows.agree(self.scene(1))?;
                let (_, _, region) = self.shared_gap(&self.gaps, &rows)?;
                Ok(scene.memory_on(&history, &region))
            });
        }
        self.validate()?;
        let ((scene, history), cells) = (self.scene(self.gaps.len())?, self.grid.cells());
        let gaps: Option<Vec<_>> = self.gaps.iter().map(|(_, gap)| gap.as_ref().ok()).collect();
        let folded = gaps.filter(|_| self.settings.symmetry).map_or([false; 2], |gaps| even_axes_of(&gaps, cells));
        Ok(scene.most_memory(&history, folded))
    }

    /// Rejects settings out of range, and no rigid body or too many.
    pub(crate) fn validate(&self) -> Result<()> {
        self.settings.validate()?;
        check_bodies(self.gaps.len())?;
        let specials = [
            (self.attraction.is_some(), Special::Attraction),
            (self.settings.frame == Frame::Indenter, Special::FixedToIndenter),
        ];
        specials.into_iter().filter(|(is, _)| *is).try_for_each(|(_, special)| self.is_covered(special))
    }

    /// The scene with so many rigid bodies, and the history, on no cells yet.
    pub(crate) fn scene(&self, bodies: usize) -> Result<(Scene, History)> {
        let mut material = self.material.clone().ok_or_else(|| missing("material"))?;
        if let Some(other) = self.counter_body.clone() {
            material = material.against(other);
        }
        material.validate()?;
        let ground = Ground::of(&self.grid, self.kernel.as_ref(), self.settings, bodies)?;
        let kernel = &ground.kernel;
        if let Some(layer) = kernel.layer_of() {
            material.check_ratio_of(layer.poisson_ratio())?;
        }
        if let Some(times) = &self.times {
            material = times.fit(&material, self.temperature.as_ref(), self.settings.series_tolerance)?;
        }
        let is_left = kernel.periodic_axes() != [true; 2] && self.settings.frame == Frame::Indenter;
        let creep = if is_left { material.contact_spectrum()? } else { None };
        let history = history_in(self.settings.frame, &material, kernel.periodic_axes())?;
        let softening =
            self.attraction.as_deref().map(|law| resolved_softening(law, &material, &self.grid)).transpose()?;
        let attraction = self.attraction.clone();
        let ground = Ground { softening: softening.unwrap_or(0.0), attraction, ..ground };
        let scene =
            Scene { creep, ground, limits: Limits::of(&material), material, temperature: self.temperature.clone() };
        Ok((scene, history))
    }
}

/// The gap on the local rows of the whole grid.
fn local_gap<'a>(gaps: &'a [LocalGap], rows: &Rows) -> Result<&'a [f64]> {
    let Some((has, gap)) = gaps.first() else { return Err(missing("geometry")) };
    let (gap, own, [n1, n2]) = (gap.as_ref().map_err(Error::clone)?, rows.own(), rows.cells());
    let is_of_all = *has == (0..n1);
    coverage::OTHER_ROWS.refuse_if(|_| !is_of_all && *has != own)?;
    Ok(if is_of_all { &gap[own.start * n2..own.end * n2] } else { gap })
}

/// The contact of a scene; nothing here can fail. A call of all ranks that share out the region.
fn assemble(scene: Scene, history: &History, indenter: Indenter, region: Region) -> ViscoelasticContact {
    let attracts = scene.ground.attraction.is_some();
    let computation = Computation::new(&scene, State::at_rest(Arc::new(indenter), region, history, attracts));
    ViscoelasticContact::new(scene, computation)
}

/// The history of bodies of `material` in a frame, on no cells yet.
fn history_in(frame: Frame, material: &Material, periodic: [bool; 2]) -> Result<History> {
    material.glassy_compliance()?;
    let creep = material.spectrum_for("a contact")?;
    Ok(match frame {
        Frame::Bodies => History::exponential(&creep),
        Frame::Indenter => History::moving_frame(&creep, periodic),
    })
}
