//! The domain of a study: found by elastic contacts as large as those of the run.

use crate::Grid;
use crate::contact::Builder;
use crate::elastic::{ElasticBuilder, ElasticContact};
use crate::error::{Error, Refusal, Result, StepError};
use crate::extent::Extent;
use crate::fields::Fields;
use crate::load::Load;
use crate::states::{as_elastic, greatest, sampled};
use crate::study::scene::StudyScene;

/// Cells along a side of the contacts that find the domain.
const CELLS: usize = 24;

/// How the domain is sought, on the scenes of [`TUNING`](super::tuning::TUNING).
struct DomainSearch {
    /// Number of loads of a run whose tilt or load point changes that give a contact.
    of_turning: usize,
    /// Maximum number of domains tried.
    most_domains: usize,
    /// A domain is accepted if the contact spans a part of it in this range.
    filled: [f64; 2],
    /// How many times as long the next one is where the contact reaches the edge, which is the most that any grows by;
    /// where nothing touches; and at least.
    longer: f64,
    shorter: f64,
    least: f64,
    /// Ratio of a domain that was found to the rectangle of the contact, and of the next one tried to it.
    to_contact: f64,
    next_to_contact: f64,
    /// How many times as long a domain becomes where a run reaches its edge.
    growth: f64,
}

const DOMAIN_SEARCH: DomainSearch = DomainSearch {
    of_turning: 16,
    most_domains: 60,
    filled: [0.45, 0.92],
    longer: 1.7,
    shorter: 0.3,
    least: 0.1,
    to_contact: 1.12,
    next_to_contact: 1.3,
    growth: 1.2,
};

/// A side of the domain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum Side {
    /// As long as the contact needs.
    #[default]
    Found,
    /// A length \[m\] that is given, as a period.
    Given(f64),
    /// One cell \[m\], along which nothing changes.
    Uniform(f64),
}

impl Side {
    /// Its length, if it is not to be found.
    fn given(self) -> Option<f64> {
        match self {
            Side::Found => None,
            Side::Given(length) | Side::Uniform(length) => Some(length),
        }
    }
}

/// The domain and the contact in it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Domain {
    pub(super) sides: [Side; 2],
    /// Half sides of the rectangle about the origin that contained the contact.
    pub(super) reach: [f64; 2],
    /// Maximum widths of the contact at any one time.
    pub(super) width: [f64; 2],
}

impl Domain {
    /// No contact yet.
    pub(super) fn empty(sides: [Side; 2]) -> Domain {
        Domain { sides, ..Domain::default() }
    }

    /// Includes the contact at one time.
    pub(super) fn include(&mut self, fields: Fields<'_>) {
        let (grid, Some(Extent { low, high })) = (fields.grid(), fields.extent_of_contact()) else { return };
        let (first, last) = (grid.center(low[0], low[1]), grid.center(high[0], high[1]));
        for axis in 0..2 {
            let side = grid.spacing()[axis];
            self.reach[axis] = self.reach[axis].max(first[axis].abs().max(last[axis].abs()) + 0.5 * side);
            self.width[axis] = self.width[axis].max((high[axis] + 1 - low[axis]) as f64 * side);
        }
    }

    /// Whether a contact was found.
    pub(super) fn has_contact(&self) -> bool {
        self.width != [0.0; 2]
    }

    /// Larger, for a contact that reaches the edge.
    pub(super) fn grown(&self) -> Domain {
        Domain { reach: self.reach.map(|half| DOMAIN_SEARCH.growth * half), ..*self }
    }

    /// Whether all sides are given, so that there is nothing to find.
    pub(super) fn is_given(&self) -> bool {
        !self.sides.contains(&Side::Found)
    }

    /// Whether contacts of this one are narrower by so much along a side that is found.
    pub(super) fn is_narrower(&self, than: &Domain, factor: f64) -> bool {
        let narrow = |axis: usize| self.sides[axis] == Side::Found && self.width[axis] < factor * than.width[axis];
        self.has_contact() && (0..2).any(narrow)
    }

    fn lengths(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.sides[axis].given().unwrap_or(2.0 * DOMAIN_SEARCH.to_contact * self.reach[axis]))
    }

    /// The grid with so many cells across the widest contact, or the longer side where both are given.
    pub(super) fn grid(&self, across: f64) -> Result<Grid> {
        let lengths = self.lengths();
        let cells = [0, 1].map(|axis| match self.sides[axis] {
            Side::Uniform(_) => 1,
            _ => smooth_size((across * lengths[axis] / self.width[axis]).ceil() as usize),
        });
        Grid::new(cells, lengths)
    }

    /// A domain whose sides are all given, as wide as the contact may be.
    pub(super) fn given(sides: [Side; 2]) -> Option<Domain> {
        let length = |side: Side| if let Side::Given(length) = side { length } else { 0.0 };
        let width = length(sides[0]).max(length(sides[1]));
        (!sides.contains(&Side::Found)).then_some(Domain { sides, width: [width; 2], ..Domain::default() })
    }

    /// Finds the elastic contacts under the maximum loads on domains of several sizes until they fill one well.
    pub(super) fn find(scene: &StudyScene<'_>, sides: [Side; 2]) -> Result<Domain> {
        let is_found = sides.map(|side| side == Side::Found);
        let (first, loads) = first_length(scene, sides)?;
        let mut lengths = sides.map(|side| side.given().unwrap_or(first));
        for _ in 0..DOMAIN_SEARCH.most_domains {
            let builder = scene.builder(grid_of(sides, lengths)?)?;
            let factors = match greatest_contacts(&builder, &loads, sides) {
                Err(Error::Step(StepError::ContactAtEdge { .. } | StepError::LoadOutsideHull { .. })) => {
                    [DOMAIN_SEARCH.longer; 2]
                }
                Err(Error::NothingToTouch { .. }) => [DOMAIN_SEARCH.shorter; 2],
                Err(error) => return Err(error),
                Ok(domain) => {
                    let filled = [0, 1].map(|axis| 2.0 * domain.reach[axis] / lengths[axis]);
                    let fits =
                        |axis: usize| (DOMAIN_SEARCH.filled[0]..=DOMAIN_SEARCH.filled[1]).contains(&filled[axis]);
                    if (0..2).all(|axis| !is_found[axis] || fits(axis)) && domain.has_contact() {
                        return Ok(domain);
                    }
                    filled.map(|filled| {
                        (filled.max(2.0 / CELLS as f64) * DOMAIN_SEARCH.next_to_contact)
                            .clamp(DOMAIN_SEARCH.least, DOMAIN_SEARCH.longer)
                    })
                }
            };
            lengths = [0, 1].map(|axis| if is_found[axis] { lengths[axis] * factors[axis] } else { lengths[axis] });
        }
        Err(no_domain(lengths[0].max(lengths[1])))
    }
}

/// A grid of few cells, on which the parts of a scene are seen.
pub(super) fn probe(sides: [Side; 2]) -> Result<Grid> {
    grid_of(sides, sides.map(|side| side.given().unwrap_or(1.0)))
}

fn grid_of(sides: [Side; 2], lengths: [f64; 2]) -> Result<Grid> {
    Grid::new(sides.map(|side| if matches!(side, Side::Uniform(_)) { 1 } else { CELLS }), lengths)
}

/// Loads of the bodies at one time, as those of an elastic body of unit compliance under which the contact is as
/// large as ever.
fn greatest_loads(scene: &StudyScene<'_>, compliance: f64) -> Result<Vec<Vec<Load>>> {
    let all: Vec<Vec<Load>> =
        scene.histories.iter().map(|history| sampled(*history, [0.0, scene.until])).collect::<Result<_>>()?;
    let mut loads: Vec<Vec<Load>> = all.iter().map(|all| greatest(all, compliance).collect()).collect();
    // where the tilt or the load point changes, the contact is somewhere else
    for (all, loads) in
        all.iter().zip(&mut loads).filter(|(all, _)| all.iter().any(|load| load.tilt() != all[0].tilt()))
    {
        loads.extend(
            all.iter().step_by(all.len().div_ceil(DOMAIN_SEARCH.of_turning)).map(|load| as_elastic(*load, compliance)),
        );
    }
    let most = loads.iter().map(Vec::len).max().unwrap_or_default();
    Ok((0..most).map(|k| loads.iter().map(|own| own[k.min(own.len() - 1)]).collect()).collect())
}

fn greatest_contacts(builder: &Builder, loads: &[Vec<Load>], sides: [Side; 2]) -> Result<Domain> {
    let (mut contact, mut domain): (ElasticContact, _) =
        (ElasticBuilder::of(builder).modulus(1.0).build()?, Domain::empty(sides));
    for loads in loads {
        contact.solve(loads)?;
        domain.include(contact.fields());
    }
    Ok(domain)
}

/// The first length L to try, of 1e-12 m to 1e9 m, and the maximum loads. A contact of half width L/4 has an approach
/// of about the rise of the gap from its middle to its edge, and at unit compliance a force of about L times that: L is
/// the least for which this holds all loads.
fn first_length(scene: &StudyScene<'_>, sides: [Side; 2]) -> Result<(f64, Vec<Vec<Load>>)> {
    let line = sides.iter().find_map(|side| if let Side::Uniform(length) = side { Some(*length) } else { None });
    let (mut failed, mut known) = (None, None);
    for length in (-24..=18).map(|k| 10f64.powf(0.5 * f64::from(k))) {
        let lengths = sides.map(|side| side.given().unwrap_or(length));
        // a kernel may not allow cells of all sizes
        let built = grid_of(sides, lengths).and_then(|grid| scene.builder(grid));
        match built.and_then(|builder| Ok((rise(&builder, sides)?, builder.compliance_until(scene.until)?))) {
            Err(error) => failed = Some(error),
            Ok((rise, compliance)) => {
                // the bodies, and so the loads, are the same on all grids
                let loads = match known.take() {
                    Some(loads) => loads,
                    None => greatest_loads(scene, compliance)?,
                };
                let depth = loads.iter().flatten().map(|load| match *load {
                    Load::Force { normal, .. } => normal / line.unwrap_or(length),
                    Load::Approach { approach, .. } | Load::Spring { drive: approach, .. } => approach,
                });
                if rise >= depth.fold(0.0, f64::max) || rise.is_nan() {
                    return Ok((length, loads));
                }
                known = Some(loads);
            }
        }
    }
    Err(failed.unwrap_or_else(|| no_domain(1e9)))
}

/// The error of a study of which no domain up to this length \[m\] holds the contact.
pub(super) fn no_domain(length: f64) -> Error {
    let what = format!("no domain was found that holds the contact (the last one tried was {length:.1e} m wide)");
    Refusal::value("no_domain", what, ": check geometry and load").into()
}

/// The least rise of the surfaces from the middle to a quarter of the sides that are found.
fn rise(builder: &Builder, sides: [Side; 2]) -> Result<f64> {
    let [n1, n2] = builder.grid.cells();
    let gaps = builder.gaps.iter().map(|(_, gap)| gap.as_ref().map_err(Clone::clone)).collect::<Result<Vec<_>>>()?;
    let gap = |[i, j]: [usize; 2]| gaps.iter().map(|gap| gap[i * n2 + j]).fold(f64::INFINITY, f64::min);
    let middle = [n1 / 2, n2 / 2];
    let mut least = f64::INFINITY;
    for axis in (0..2).filter(|&axis| sides[axis] == Side::Found) {
        for at in [CELLS / 4, 3 * CELLS / 4] {
            let mut cell = middle;
            cell[axis] = at;
            least = least.min(gap(cell));
        }
    }
    Ok(least - gap(middle))
}

/// The next even number of cells without prime factors above 5, for fast transforms.
pub(super) fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least.max(2)..).find(|&n| n.is_multiple_of(2) && smooth(n)).unwrap_or(least)
}
