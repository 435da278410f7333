//! The rigid bodies that press on the creeping one: their gap, and what follows from it.

pub(in crate::contact) mod hull;
pub(in crate::contact) mod replacement;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::Grid;
use crate::contact::indenter::hull::Hull;
#[cfg(feature = "checkpoint")]
use crate::contact::window::region::Region;
use crate::error::Result;
use crate::geometry::Gap;
use crate::solver::RigidMotion;

/// The indenters of a contact where they are. Replaced whole when one of them moves or changes.
#[derive(Debug)]
pub(crate) struct Indenter {
    gap: Gap,
    bodies: usize,
    /// What distinguishes it from every other indenter of this process.
    id: u64,
    /// Axes about whose middle the gap is even, bitwise.
    even: OnceLock<[bool; 2]>,
    /// Where loads may act on each body; found when one is first free to tilt.
    hulls: Vec<OnceLock<Hull>>,
    /// Whether the gap is known on the rows of a rank only.
    on_own_rows: bool,
}

impl Indenter {
    pub(crate) fn new(gap: Gap, bodies: usize) -> Indenter {
        let hulls = (0..bodies).map(|_| OnceLock::new()).collect();
        Indenter { gap, bodies, id: next_id(), even: OnceLock::new(), hulls, on_own_rows: false }
    }

    /// The indenter of a rank: the gap of a single body on the computed cells of own rows, and what follows from all rows.
    pub(crate) fn shared(gap: Gap, even: [bool; 2], hull: Hull) -> Indenter {
        let hulls = vec![OnceLock::from(hull)];
        Indenter { gap, bodies: 1, id: next_id(), even: OnceLock::from(even), hulls, on_own_rows: true }
    }

    /// On the whole grid, or, where ranks share it out, the computed cells of own rows.
    pub(crate) fn gap(&self) -> &Gap {
        &self.gap
    }

    /// Number of rigid bodies.
    pub(crate) fn bodies(&self) -> usize {
        self.bodies
    }

    pub(crate) fn id(&self) -> u64 {
        self.id
    }

    /// Axes about whose middle the gap is even, bitwise.
    pub(crate) fn even_axes(&self, grid: &Grid) -> [bool; 2] {
        let gap = &self.gap;
        let alike = |k: usize, mirror: usize| gap.above[k] == gap.above[mirror] && gap.owner(k) == gap.owner(mirror);
        *self.even.get_or_init(|| even_axes(grid.cells(), alike))
    }

    /// The folded axes of a region that stay so under it.
    pub(crate) fn keeps_folded(&self, folded: [bool; 2], grid: &Grid) -> [bool; 2] {
        // nothing to look up where there is no symmetry to lose
        let even = if folded == [false; 2] { folded } else { self.even_axes(grid) };
        [0, 1].map(|axis| folded[axis] && even[axis])
    }

    /// The convex hull of the cells that a body may touch.
    pub(crate) fn hull(&self, body: usize, grid: &Grid) -> &Hull {
        let touchable = |k: usize| self.gap.owner(k) == body && self.gap.above[k].is_finite();
        self.hulls[body].get_or_init(|| Hull::new(grid, touchable))
    }

    /// The indenter of a rank with a gap that rounds otherwise, on own rows of the region of another state.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn with_gap_on(&self, region: &Region, gap: Gap) -> Indenter {
        let built = self.even.get().copied().unwrap_or_default();
        let even = OnceLock::from([0, 1].map(|axis| built[axis] || region.folded()[axis]));
        Indenter { gap, bodies: self.bodies, id: next_id(), even, hulls: self.hulls.clone(), on_own_rows: true }
    }

    /// The motion at which each body just touches the undeformed surface, upright.
    pub(crate) fn first_touch(&self) -> Vec<RigidMotion> {
        let of_body = |body: usize| {
            if self.on_own_rows {
                // a single body touches where its gap is least
                return RigidMotion { approach: self.gap.datum, tilt: [0.0; 2] };
            }
            let own = self.gap.above.iter().enumerate().filter(|(k, _)| self.gap.owner(*k) == body);
            let approach = self.gap.datum + own.map(|(_, &h)| h).fold(f64::INFINITY, f64::min);
            RigidMotion { approach, tilt: [0.0; 2] }
        };
        (0..self.bodies).map(of_body).collect()
    }

    /// Takes the heights of a single body, and leaves its own in their place: another indenter without reallocating.
    ///
    /// # Errors
    /// If they are no gap; the indenter is then as it was.
    pub(crate) fn refill(&mut self, heights: &mut Vec<f64>, grid: &Grid) -> Result<()> {
        self.gap.exchange(heights, grid)?;
        self.id = next_id();
        self.even.take();
        self.hulls.iter_mut().for_each(|hull| _ = hull.take());
        Ok(())
    }
}

/// Axes of an even number of cells about whose middle every cell is `alike` its mirror image.
pub(crate) fn even_axes([n1, n2]: [usize; 2], alike: impl Fn(usize, usize) -> bool) -> [bool; 2] {
    let rows = |i: usize| (0..n2).all(|j| alike(i * n2 + j, (n1 - 1 - i) * n2 + j));
    let columns = |i: usize| (0..n2 / 2).all(|j| alike(i * n2 + j, i * n2 + n2 - 1 - j));
    [n1.is_multiple_of(2) && (0..n1 / 2).all(rows), n2.is_multiple_of(2) && (0..n1).all(columns)]
}

fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// Indenters in checkpoints: their gap without its heights, and how many bodies there are.
#[cfg(feature = "checkpoint")]
pub(crate) mod saved {
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{Gap, Indenter};

    pub(crate) fn serialize<S: Serializer>(indenter: &Arc<Indenter>, serializer: S) -> Result<S::Ok, S::Error> {
        (&indenter.gap, indenter.bodies as u16).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<Indenter>, D::Error> {
        let (gap, bodies) = <(Gap, u16)>::deserialize(deserializer)?;
        Ok(Arc::new(Indenter::new(gap, bodies.into())))
    }
}
