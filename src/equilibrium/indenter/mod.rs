//! The rigid bodies that press on the creeping body: their gap, its symmetry, and the hulls where loads may act.

pub(crate) mod hull;
pub(crate) mod slope;

use std::sync::OnceLock;

use self::slope::Slopes;
use crate::Grid;
use crate::equilibrium::Hull;
use crate::equilibrium::window::region::Region;
use crate::geometry::{Gap, Missed};
use crate::solver::{HaloRows, RigidMotion};

/// The indenters of a contact where they are. Replaced whole when one of them moves or changes.
#[derive(Debug, Default)]
pub(crate) struct Indenter {
    gap: Gap,
    /// Axes about whose middle the gap is even, bitwise.
    even: OnceLock<[bool; 2]>,
    /// Where loads may act on each body; computed when a body is first free to tilt.
    hulls: Vec<OnceLock<Hull>>,
    /// Slopes on the whole grid; computed when a step is first accepted, or on ranks when the contact is built.
    slopes: OnceLock<Slopes>,
    /// The rows of the gap beyond the local rows of a rank.
    beyond: HaloRows,
    /// Whether the gap covers only the local rows of a rank.
    is_local: bool,
    /// What the grid misses of the waves of the shapes.
    pub(crate) missed: Missed,
}

impl Indenter {
    pub(crate) fn new(gap: Gap, bodies: usize) -> Indenter {
        let hulls = (0..bodies).map(|_| OnceLock::new()).collect();
        Indenter {
            gap,
            even: OnceLock::new(),
            hulls,
            slopes: OnceLock::new(),
            beyond: HaloRows::default(),
            is_local: false,
            missed: Missed::default(),
        }
    }

    /// The same of shapes with waves of which the grid misses something.
    pub(crate) fn missing(mut self, missed: Missed) -> Indenter {
        self.missed = missed;
        self
    }

    /// The indenter of a rank: the gap of a single body on the computed cells of the local rows, which are `region`;
    /// symmetry and hull of all rows. A call of all ranks.
    pub(crate) fn shared(gap: Gap, even: [bool; 2], hull: Hull, region: &Region) -> Indenter {
        let hulls = vec![OnceLock::from(hull)];
        Indenter { even: OnceLock::from(even), hulls, is_local: true, ..Indenter::new(gap, 0) }.with_rows_beyond(region)
    }

    /// The gap on the whole grid, or on the computed cells of the local rows where ranks share out the grid.
    pub(crate) fn gap(&self) -> &Gap {
        &self.gap
    }

    /// Number of rigid bodies.
    pub(crate) fn bodies(&self) -> usize {
        self.hulls.len()
    }

    /// Axes about whose middle the gap is even, bitwise.
    pub(crate) fn even_axes(&self, grid: &Grid) -> [bool; 2] {
        let gap = &self.gap;
        let alike = |k: usize, mirror: usize| gap.above[k] == gap.above[mirror] && gap.owner(k) == gap.owner(mirror);
        *self.even.get_or_init(|| even_axes(grid.cells(), alike))
    }

    /// The folded axes of a region along which the gap is even.
    pub(crate) fn keeps_folded(&self, folded: [bool; 2], grid: &Grid) -> [bool; 2] {
        // the gap is searched only for a symmetry that the region uses
        let even = if folded == [false; 2] { folded } else { self.even_axes(grid) };
        [0, 1].map(|axis| folded[axis] && even[axis])
    }

    /// The convex hull of the cells that a body may touch.
    pub(crate) fn hull(&self, body: usize, grid: &Grid) -> &Hull {
        let touchable = |k: usize| self.gap.owner(k) == body && self.gap.above[k].is_finite();
        self.hulls[body].get_or_init(|| Hull::new(grid, touchable))
    }

    /// The motion at which each body just touches the undeformed surface, upright.
    pub(crate) fn first_touch(&self) -> Vec<RigidMotion> {
        let lowest = |body: usize| {
            let own = self.gap.above.iter().enumerate().filter(|(k, _)| self.gap.owner(*k) == body);
            own.map(|(_, &h)| h).fold(f64::INFINITY, f64::min)
        };
        // a single body touches at the datum, which all ranks have
        let height = |body: usize| if self.is_local { 0.0 } else { lowest(body) };
        let at = |body: usize| RigidMotion { approach: self.gap.datum + height(body), tilt: [0.0; 2] };
        (0..self.bodies()).map(at).collect()
    }
}

/// Axes of an even number of cells about whose middle every cell is `alike` its mirror image.
pub(crate) fn even_axes([n1, n2]: [usize; 2], alike: impl Fn(usize, usize) -> bool) -> [bool; 2] {
    let rows = |i: usize| (0..n2).all(|j| alike(i * n2 + j, (n1 - 1 - i) * n2 + j));
    let columns = |i: usize| (0..n2 / 2).all(|j| alike(i * n2 + j, i * n2 + n2 - 1 - j));
    [n1.is_multiple_of(2) && (0..n1 / 2).all(rows), n2.is_multiple_of(2) && (0..n1).all(columns)]
}

/// Axes about whose middle the gap of all bodies together is even, bitwise.
pub(crate) fn even_axes_of(gaps: &[&Vec<f64>], cells: [usize; 2]) -> [bool; 2] {
    // the lowest body, and the first of several as low
    let lowest = |k: usize| {
        let own = gaps.iter().map(|gap| gap[k]).enumerate();
        own.fold((0, f64::INFINITY), |lowest, (body, h)| if h < lowest.1 { (body, h) } else { lowest })
    };
    let datum = gaps.iter().flat_map(|gap| gap.iter()).copied().fold(f64::INFINITY, f64::min);
    even_axes(cells, |k, mirror| {
        let (own, image) = (lowest(k), lowest(mirror));
        own.0 == image.0 && own.1 - datum == image.1 - datum
    })
}

impl Indenter {
    /// The index in the gap of the cell `k` of a region.
    pub(crate) fn index(&self, grid: &Grid, region: &Region, k: usize) -> usize {
        let [i, j] = region.cell(k);
        if self.is_local { k } else { i * grid.cells()[1] + j }
    }
}
