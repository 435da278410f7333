//! The edge of a line contact that runs over many cells within a step.
//!
//! An iteration in the gap moves a running edge by about the zone in which the attraction acts. Where cells were lost
//! the profile beside the edge is tried further on: by the cells just lost, after each success by twice as many, and
//! each edge by at most a sixteenth of the longest part in contact, since it may stop. The trial is kept where the
//! energy falls.

/// How the edge has moved so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Front {
    /// Whether there are edges to move: of a line contact, whose cells begin at its middle where it is folded.
    is_line: bool,
    folded: bool,
    touching: usize,
    span: usize,
}

/// Where the profile of a contact was before it moved.
pub(super) struct Moved {
    by: usize,
    /// The middles of the parts in contact.
    middles: Vec<f64>,
}

impl Front {
    pub(super) fn new(cells: [usize; 2], folded: [bool; 2]) -> Front {
        let (is_line, folded) = (cells.contains(&1), folded[usize::from(cells[0] == 1)]);
        Front { is_line, folded, touching: 0, span: 1 }
    }

    /// Looks at which cells touch; returns how the profile is to be moved.
    pub(super) fn look(&mut self, cells: usize, touches: impl Fn(usize) -> bool) -> Option<Moved> {
        if !self.is_line {
            return None;
        }
        let in_contact = || (0..cells).filter(|&k| touches(k));
        let touching = in_contact().count();
        let lost = std::mem::replace(&mut self.touching, touching).saturating_sub(touching);
        if lost == 0 {
            return None;
        }
        let mut parts: Vec<(usize, usize)> = Vec::new();
        for k in in_contact() {
            match parts.last_mut() {
                Some((_, end)) if *end == k => *end += 1,
                _ => parts.push((k, k + 1)),
            }
        }
        let at_mirror = |first: usize| self.folded && first == 0;
        let of_part = |&(first, end): &(usize, usize)| if at_mirror(first) { 2 * end } else { end - first };
        let longest = parts.iter().map(of_part).max()?;
        let middle = |&(first, end): &(usize, usize)| if at_mirror(first) { -0.5 } else { 0.5 * (first + end) as f64 };
        let by = (lost.div_ceil(2 * parts.len()) * self.span).min(longest / 16).max(1);
        Some(Moved { by, middles: parts.iter().map(middle).collect() })
    }

    /// Adapts how far the next trial goes, by whether the last one was kept.
    pub(super) fn learn(&mut self, kept: bool) {
        self.span = if kept { 2 * self.span } else { (self.span / 2).max(1) };
    }
}

impl Moved {
    /// The cell whose value cell `k` of so many takes.
    pub(super) fn source(&self, k: usize, cells: usize) -> usize {
        let off = |middle: &f64| k as f64 - middle;
        let nearest = self.middles.iter().map(off).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        if nearest < 0.0 { k.saturating_sub(self.by) } else { (k + self.by).min(cells - 1) }
    }
}
