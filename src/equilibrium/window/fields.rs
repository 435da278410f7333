//! Fields on a region, on the whole grid, and transferred to other regions.

use crate::equilibrium::{Region, Window};
use crate::extent::Extent;
use crate::geometry::Gap;
use crate::hereditary::{Field, Role};

impl Region {
    /// The part of a field on the whole grid that belongs to the region.
    pub(crate) fn cut<V: Copy>(&self, whole: &[V]) -> impl Iterator<Item = V> {
        let n2 = self.whole.cells()[1];
        (0..self.len()).map(|k| self.cell(k)).map(move |[i, j]| whole[i * n2 + j])
    }

    /// Writes the part of a gap that belongs to the region over `own`; `None` if that is all of it.
    pub(crate) fn cut_gap(&self, gap: &Gap, own: &mut Option<Gap>) {
        // on ranks the gap is given on local rows
        if self.is_whole() || self.is_shared() {
            *own = None;
            return;
        }
        let Gap { datum, above, owner } = own.get_or_insert_with(Gap::default);
        *datum = gap.datum;
        above.clear();
        above.extend(self.cut(&gap.above));
        if let Some(all) = &gap.owner {
            let owner = owner.get_or_insert_default();
            owner.clear();
            owner.extend(self.cut(all));
        }
    }

    /// Writes a field of the region, and its mirror images, over the cells that are shown; others stay as they are.
    pub(crate) fn show(&self, own: &[f64], shown: &mut [f64]) {
        let ([n1, n2], [_, m2], rows) = (self.whole.cells(), self.cells(), self.shown_rows());
        for (i, row) in own.chunks_exact(m2).enumerate() {
            let i = self.first[0] + i;
            // of shared rows no rank has the images
            let images = [Some(i), (self.folded[0] && !self.is_shared()).then_some(n1 - 1 - i)];
            for i in images.into_iter().flatten() {
                let line = &mut shown[(i - rows.start) * n2..][..n2];
                line[self.first[1]..self.first[1] + m2].copy_from_slice(row);
                if self.folded[1] {
                    let start = n2 - self.first[1] - m2;
                    line[start..start + m2].iter_mut().rev().zip(row).for_each(|(out, &value)| *out = value);
                }
            }
        }
    }

    /// A field of the region on another one of the same grid; `elsewhere` gives its values on cells that are neither
    /// in this region nor mirror images of it.
    pub(crate) fn transfer(&self, own: &[f64], other: &Region, elsewhere: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..other.len()).map(|k| self.find(other.cell(k)).map_or_else(|| elsewhere(k), |own_k| own[own_k])).collect()
    }

    /// Whether a field is positive anywhere, in the rows of any rank.
    pub(crate) fn is_positive_anywhere(&self, own: &[f64]) -> bool {
        self.rows().any(own.iter().any(|&value| value > 0.0))
    }

    /// The smallest rectangle of the whole grid that holds all cells, mirror images included, with a positive value
    /// in `own`; `None` if there is none.
    pub(crate) fn reach(&self, own: &[f64]) -> Option<Extent> {
        let rows = own.chunks_exact(self.cells()[1]).enumerate().filter_map(|(i, row)| {
            let first = row.iter().position(|&value| value > 0.0)?;
            let last = row.iter().rposition(|&value| value > 0.0)?;
            Some(Extent { low: [i, first], high: [i, last] })
        });
        self.reach_of(Extent::hull(rows))
    }

    /// The smallest rectangle of the whole grid that holds a rectangle of its cells on each rank, mirror images
    /// included.
    pub(crate) fn reach_of(&self, own: Option<Extent>) -> Option<Extent> {
        self.hull_of_all_ranks(own.map(|own| self.on_whole(own))).map(|found| self.with_images(found))
    }

    /// A rectangle of its cells, as cells of the whole grid.
    fn on_whole(&self, Extent { low, high }: Extent) -> Extent {
        let [low, high] = [low, high].map(|cell| [0, 1].map(|axis| cell[axis] + self.first[axis]));
        Extent { low, high }
    }

    /// The smallest rectangle of the whole grid that holds a rectangle and its mirror images.
    fn with_images(&self, Extent { mut low, high }: Extent) -> Extent {
        for axis in (0..2).filter(|&axis| self.folded[axis]) {
            low[axis] = low[axis].min(self.whole.cells()[axis] - 1 - high[axis]);
        }
        Extent { low, high }
    }

    /// The smallest rectangle of the whole grid that holds a rectangle of its cells and their mirror images, in one
    /// process.
    pub(crate) fn shown_extent(&self, own: Extent) -> Extent {
        self.with_images(self.on_whole(own))
    }

    /// The hull of what all ranks have found.
    fn hull_of_all_ranks(&self, own: Option<Extent>) -> Option<Extent> {
        if !self.is_shared() {
            return own;
        }
        let numbers = own.map_or([f64::INFINITY; 4], |Extent { low, high }| {
            [low[0] as f64, low[1] as f64, -(high[0] as f64), -(high[1] as f64)]
        });
        let least = self.rows().join(numbers, |a, b| std::array::from_fn(|n| a[n].min(b[n])));
        let [a, b, c, d] = least.map(|value| value.abs() as usize);
        least[0].is_finite().then_some(Extent { low: [a, b], high: [c, d] })
    }

    /// Number of cells on the edge of the whole grid with a positive value in `own`; periodic axes have no edge.
    pub(crate) fn positive_on_edge(&self, own: &[f64], periodic: [bool; 2]) -> usize {
        let [m1, m2] = self.cells();
        if m1 == 0 {
            return self.images() * self.rows().count(0);
        }
        let ends = |axis: usize, count: usize| {
            let last = self.first[axis] + count == self.whole.cells()[axis];
            let outermost = [self.first[axis] == 0, last].map(|at_end| at_end && !periodic[axis]);
            [outermost[0].then_some(0), outermost[1].then_some(count - 1).filter(|&last| last > 0 || !outermost[0])]
        };
        let (rows, columns) = (ends(0, m1), ends(1, m2));
        let positive = |row: &[f64]| row.iter().filter(|&&value| value > 0.0).count();
        let across: usize = rows.into_iter().flatten().map(|i| positive(&own[i * m2..(i + 1) * m2])).sum();
        let inner = (0..m1).filter(|i| !rows.contains(&Some(*i)));
        let down = inner.map(|i| columns.into_iter().flatten().filter(|j| own[i * m2 + j] > 0.0).count());
        self.images() * self.rows().count(across + down.sum::<usize>())
    }
}

/// Fields of the region `from` on the region of a `window`, by their roles. With u = K U, a displacement outside the
/// old region is the convolution of its source; nothing is unknown where the images of the region cover the grid.
pub(crate) fn transfer_by_role<'a>(
    from: &'a Region,
    to: &'a Region,
    window: &'a mut Window,
) -> impl FnMut(Field<'_>) -> Vec<f64> + 'a {
    let (kernel, work, cells) = (&window.kernel, &mut window.work, to.len());
    let mut one = move |own: &[f64], source: Option<&[f64]>| {
        let source = source.filter(|source| !from.covers() && source.iter().any(|&s| s != 0.0));
        let Some(source) = source else { return from.transfer(own, to, |_| 0.0) };
        let mut far = vec![0.0; cells];
        kernel.apply(&from.transfer(source, to, |_| 0.0), &mut far, work);
        from.transfer(own, to, |k| far[k])
    };
    move |field| match field.role {
        Role::Lasting { source } => field.transferred(source, cells, &mut one),
        Role::OfStep | Role::Work => vec![0.0; cells * field.per_cell],
    }
}
