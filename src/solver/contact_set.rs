//! The set of cells in contact, and the fit of the free motions on them.

use std::ops::Range;

use super::{Bands, Gram, ModeCoefficients, Passes, Problem, RowSegments, dot};
use crate::sum::{self, greatest, sum};

/// The cells in contact under all bodies.
#[derive(Debug, Clone)]
pub(crate) struct ContactSet {
    /// Whether a cell is in contact. After changes, [`ContactSet::update`] is due.
    pub(crate) member: Vec<bool>,
    pub(crate) segments: RowSegments,
    bodies: Vec<BodyContact>,
    /// The largest |gap| in contact.
    pub(crate) greatest_gap: f64,
    /// Number of updates of the set: values that depend on the set are computed anew where this number has changed.
    pub(crate) version: u64,
}

/// The cells in contact under one body.
#[derive(Debug, Clone, Default)]
struct BodyContact {
    /// Number of cells.
    cells: usize,
    /// The products of the free modes over the cells of a body that tilts.
    gram: Gram,
    /// From the first cell to the last.
    span: Range<usize>,
}

impl ContactSet {
    pub(crate) fn new(cells: usize, bodies: usize) -> ContactSet {
        ContactSet {
            member: vec![false; cells],
            segments: RowSegments::with_capacity(cells),
            bodies: vec![BodyContact::default(); bodies],
            greatest_gap: 0.0,
            version: 0,
        }
    }

    /// Finds the segments of the members, and counts, products and the maximum gap over them.
    pub(crate) fn update(&mut self, problem: &Problem<'_>) {
        self.version += 1;
        self.segments.find(&self.member);
        self.bodies.fill(BodyContact::default());
        self.greatest_gap = 0.0;
        let tilting = matches!(problem.bodies, [only] if only.tilts());
        for piece in self.segments.inside(&(0..self.member.len()), problem.cut()) {
            let contact = &mut self.bodies[piece.body];
            if problem.bodies[piece.body].tilts() && !tilting {
                contact.gram.add_cells(&problem.modes(piece.body).line(piece.cells.start), piece.cells.len());
            }
            let first = if contact.cells == 0 { piece.cells.start } else { contact.span.start };
            contact.span = first..piece.cells.end;
            contact.cells += piece.cells.len();
            self.greatest_gap = self.greatest_gap.max(greatest(&problem.gap[piece.cells]));
        }
        let rows = problem.rows();
        if rows.are_shared() {
            let own = [self.bodies[0].cells as f64, self.greatest_gap];
            let [cells, greatest_gap] = rows.join(own, |[n, a], [m, b]| [n + m, a.max(b)]);
            (self.bodies[0].cells, self.greatest_gap) = (cells as usize, greatest_gap);
        }
        if tilting {
            self.bodies[0].gram = self.gram(problem);
        }
    }

    /// The products of the free modes over the cells in contact under a single body, band by band.
    fn gram(&self, problem: &Problem<'_>) -> Gram {
        let modes = problem.modes(0);
        let within = |band: Range<usize>| {
            let mut gram = Gram::default();
            for piece in self.segments.inside(&band, problem.cut()) {
                gram.add_cells(&modes.line(piece.cells.start), piece.cells.len());
            }
            std::array::from_fn::<f64, 9, _>(|n| gram.entries[n / 3][n % 3])
        };
        let found = problem.rows().merge(within, sum::add);
        Gram { entries: [0, 3, 6].map(|n| [found[n], found[n + 1], found[n + 2]]) }
    }

    /// Number of cells in contact under any body.
    pub(crate) fn count(&self) -> usize {
        self.bodies.iter().map(|contact| contact.cells).sum()
    }

    /// Number of cells in contact under one body.
    pub(crate) fn count_under(&self, body: usize) -> usize {
        self.bodies[body].cells
    }

    /// The cells of a band in contact under one body, in pieces along which its modes are affine.
    fn pieces(
        &self,
        problem: &Problem<'_>,
        body: usize,
        band: Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> + Clone {
        let span = &self.bodies[body].span;
        let start = band.start.max(span.start);
        let pieces = self.segments.inside(&(start..band.end.min(span.end).max(start)), problem.cut());
        pieces.filter(move |piece| piece.body == body).map(|piece| piece.cells)
    }

    /// Σ f over the cells in contact under one body.
    pub(crate) fn sum_of(&self, problem: &Problem<'_>, body: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
        problem.rows().sum_of(|band| self.pieces(problem, body, band).flatten().map(&f).sum())
    }

    /// Σ f over all cells in contact.
    pub(crate) fn sum_over_all(&self, problem: &Problem<'_>, f: impl Fn(usize) -> f64 + Sync) -> f64 {
        problem
            .rows()
            .sum_of(|band| self.segments.inside(&band, problem.cut()).flat_map(|piece| piece.cells).map(&f).sum())
    }

    /// The cells in contact under one body.
    pub(crate) fn cells(&self, problem: &Problem<'_>, body: usize) -> impl Iterator<Item = usize> + Clone {
        self.pieces(problem, body, 0..self.member.len()).flatten()
    }

    /// Σ values over the cells in contact under one body.
    pub(crate) fn sum(&self, problem: &Problem<'_>, body: usize, values: &[f64]) -> f64 {
        problem.rows().sum_of(|band| self.pieces(problem, body, band).map(|piece| sum(&values[piece])).sum())
    }

    /// The cells in contact under one body, and the value of a motion on each of them.
    pub(crate) fn displacements(
        &self,
        problem: &Problem<'_>,
        body: usize,
        motion: ModeCoefficients,
    ) -> impl Iterator<Item = (usize, f64)> {
        let modes = problem.modes(body);
        self.pieces(problem, body, 0..self.member.len()).flat_map(move |piece| {
            let [start, slope] = modes.line(piece.start).of(motion);
            piece.enumerate().map(move |(j, k)| (k, start + slope * j as f64))
        })
    }

    /// The motion of a body that fits a field best on its cells in contact, from Σ B f over them; zero for modes that
    /// they do not determine.
    pub(crate) fn fit(&self, problem: &Problem<'_>, body: usize, sums: [f64; 3]) -> ModeCoefficients {
        let (BodyContact { cells, gram, .. }, freedom) = (&self.bodies[body], problem.bodies[body]);
        if freedom.tilts() {
            return ModeCoefficients(gram.solve(sums));
        }
        ModeCoefficients([if freedom.translation { sums[0] / (*cells).max(1) as f64 } else { 0.0 }, 0.0, 0.0])
    }

    /// The cells of a problem for one pass.
    pub(crate) fn passes<'a>(&'a self, problem: &'a Problem<'a>, bands: &'a mut Bands) -> Passes<'a> {
        Passes { problem, segments: &self.segments, bands }
    }

    /// Finds y such that the pressures max(0, base + weight · B y) on the cells in contact under one body carry the
    /// force and moments of its load: the minimum of the convex ½ Σ weight (base/weight + B y)₊² − b·y, by Newton's
    /// method with step halving. `None` if there is none, because the load does not act inside the convex hull of the
    /// cells; zero for a body whose motion is given.
    pub(crate) fn balance(
        &self,
        problem: &Problem<'_>,
        body: usize,
        base: impl Fn(usize) -> f64 + Sync,
        weight: impl Fn(usize) -> f64 + Sync,
    ) -> Option<ModeCoefficients> {
        if !problem.bodies[body].moves() {
            return Some(ModeCoefficients::default());
        }
        let (rows, modes) = (problem.rows(), problem.modes(body));
        let wanted = modes.load().map(|share| share * modes.freedom.total);
        let evaluate = |y: [f64; 3]| {
            let found = rows.merge(|band| self.clipped(problem, body, band, y, &base, &weight), sum::add);
            let gram = Gram { entries: [0, 3, 6].map(|n| [found[n], found[n + 1], found[n + 2]]) };
            (gram, [0, 1, 2].map(|m| found[9 + m] - wanted[m]), found[12] - dot(wanted, y))
        };
        // in these units a moment is at most the moment of the whole force at the end of the grid
        let size = self.sum_of(problem, body, |k| base(k).abs()).max(wanted[0].abs());
        if size == 0.0 {
            return Some(ModeCoefficients::default());
        }
        let mut y = [0.0; 3];
        let (mut gram, mut sums, mut value) = evaluate(y);
        // one iteration is needed where nothing is clipped
        for _ in 0..60 {
            if sums.iter().all(|sum| sum.abs() <= 4.0 * f64::EPSILON * size) {
                return Some(ModeCoefficients(y));
            }
            let step = gram.solve(sums);
            let descent = dot(step, sums);
            let lengths = std::iter::successors(Some(1.0), |length| Some(0.5 * length)).take_while(|&a| a >= 1e-6);
            let mut trials = lengths.map(|length| {
                let next = [0, 1, 2].map(|m| y[m] - length * step[m]);
                (length, next, evaluate(next))
            });
            // near the minimum the value is rounded, but the gradient still falls
            let next = trials.find(|(length, _, (_, next_sums, next_value))| {
                *next_value <= value - 1e-4 * length * descent
                    || dot(*next_sums, *next_sums).sqrt() <= 0.5 * dot(sums, sums).sqrt()
            });
            // if no trial falls, rounding hides any further descent: the balance decides
            let Some((_, next, state)) = next else { break };
            (y, (gram, sums, value)) = (next, state);
        }
        sums.iter().all(|sum| sum.abs() <= 1e-12 * size).then_some(ModeCoefficients(y))
    }

    /// The products of the modes, the loads, and the convex value of the pressures max(0, base + weight · B y) on the
    /// cells of a band: 9, 3 and 1 sums.
    fn clipped(
        &self,
        problem: &Problem<'_>,
        body: usize,
        band: Range<usize>,
        y: [f64; 3],
        base: impl Fn(usize) -> f64,
        weight: impl Fn(usize) -> f64,
    ) -> [f64; 13] {
        let (modes, mut gram, mut sums, mut value) = (problem.modes(body), Gram::default(), [0.0; 3], 0.0);
        // piece by piece, so that rounding does not grow with the number of cells
        for piece in self.pieces(problem, body, band) {
            let middle = 0.5 * (piece.len() - 1) as f64;
            let line = modes.line(piece.start).from(middle);
            let [start, slope] = line.of(ModeCoefficients(y));
            let (mut weights, mut pressures) = ([0.0; 3], [0.0; 2]);
            for (j, k) in piece.enumerate() {
                let (j, w) = (j as f64 - middle, weight(k));
                let moved = start + slope * j;
                let p = base(k) + w * moved;
                if p > 0.0 {
                    weights = [weights[0] + w, weights[1] + w * j, weights[2] + w * j * j];
                    pressures = [pressures[0] + p, pressures[1] + p * j];
                    // without weight p does not depend on y
                    value += if w > 0.0 { 0.5 * p * p / w } else { p * moved };
                }
            }
            let ([weight, moment, square], [p, p_moment]) = (weights, pressures);
            gram.add(&line, weight, moment, square);
            let part = line.sums(p, p_moment);
            (0..3).for_each(|m| sums[m] += part[m]);
        }
        let [a, b, c] = gram.entries;
        [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], sums[0], sums[1], sums[2], value]
    }

    /// Sets the contact to the cells with positive pressure.
    pub(crate) fn find_pressed(&mut self, problem: &Problem<'_>, pressure: &[f64]) {
        self.member.iter_mut().zip(pressure).for_each(|(member, &p)| *member = p > 0.0);
        self.update(problem);
    }

    /// Adds all cells that a body may touch.
    pub(crate) fn press_possible(&mut self, problem: &Problem<'_>, body: usize) {
        for (k, member) in self.member.iter_mut().enumerate() {
            *member |= problem.gap[k].is_finite() && problem.owner(k) == body;
        }
        self.update(problem);
    }

    /// Removes the cells of a body without positive pressure.
    pub(crate) fn keep_pressed(&mut self, problem: &Problem<'_>, body: usize, pressure: &[f64]) {
        let own = self.member.iter_mut().enumerate().filter(|(k, _)| problem.owner(*k) == body);
        own.for_each(|(k, member)| *member &= pressure[k] > 0.0);
        self.update(problem);
    }
}
