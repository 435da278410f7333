//! A contact stepper of its own: dense matrices, an interior-point method, and the hereditary integral over the whole past.
//! Slow, for a hundred cells or two, and sure.

use crate::common::love::love;
use crate::common::quadratic;
use viscocontact::prelude::*;

use super::hereditary_integral::HereditaryIntegral;
use super::scenes::Body;

/// What is known of one rigid body in a step.
#[derive(Debug, Clone)]
struct Motion {
    /// Functions of the cell that are free to it, with the sums of pressure that they ask for.
    modes: Vec<(Vec<f64>, f64)>,
    /// Prescribed lowering of each cell.
    prescribed: Vec<f64>,
    released: bool,
}

/// The state of the reference.
pub struct Reference {
    grid: Grid,
    /// K(i, j) from cell to cell.
    influence: Vec<f64>,
    /// Gap, and the body that each cell belongs to.
    gap: Vec<f64>,
    owner: Vec<usize>,
    bodies: usize,
    past: HereditaryIntegral,
    pub pressure: Vec<f64>,
    /// Approach at the origin and tilts of each body; NaN where nothing determines them.
    pub motions: Vec<[f64; 3]>,
}

impl Reference {
    pub fn new(grid: &Grid, shapes: &[Box<dyn Geometry>], body: &Body, rule: TimeRule) -> Reference {
        let cells = grid.len();
        let centre = |k: usize| grid.center(k / grid.cells()[1], k % grid.cells()[1]);
        // of the bodies over a cell the lowest
        let over = |k: usize| {
            let [x1, x2] = centre(k);
            let heights = shapes.iter().enumerate().map(|(body, shape)| (shape.initial_gap(x1, x2), body));
            heights.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };
        let influence = (0..cells * cells).map(|at| {
            let (a, b) = (centre(at / cells), centre(at % cells));
            love([a[0] - b[0], a[1] - b[1]], grid.spacing())
        });
        Reference {
            influence: influence.collect(),
            gap: (0..cells).map(|k| over(k).0).collect(),
            owner: (0..cells).map(|k| over(k).1).collect(),
            bodies: shapes.len(),
            past: HereditaryIntegral::new(body, rule, cells, grid.spacing()[0].min(grid.spacing()[1])),
            pressure: vec![0.0; cells],
            motions: vec![[f64::NAN; 3]; shapes.len()],
            grid: grid.clone(),
        }
    }

    /// Displaces the surface before any pressure.
    pub fn displace(&mut self, displacement: &[f64]) {
        self.gap.iter_mut().zip(displacement).for_each(|(gap, u)| *gap += u);
    }

    /// One step; false if the interior-point method finds no answer.
    pub fn step(&mut self, dt: f64, loads: &[Load]) -> bool {
        let (c, past) = self.past.predict(dt);
        let motions: Vec<Motion> = loads.iter().enumerate().map(|(body, load)| self.motion(body, load)).collect();
        let Some((pressure, found)) = self.solve(c, &past, &motions) else { return false };
        self.pressure = pressure;
        for (body, load) in loads.iter().enumerate() {
            self.motions[body] = physical(load, &found[body], motions[body].released);
        }
        let n = self.grid.len();
        let end = (0..n).map(|k| {
            let kp: f64 = (0..n).map(|l| self.influence[k * n + l] * self.pressure[l]).sum();
            past[k] + c * kp
        });
        self.past.commit(end.collect());
        true
    }

    pub fn force(&self, body: usize) -> f64 {
        let own = self.pressure.iter().zip(&self.owner).filter(|(_, owner)| **owner == body);
        own.map(|(p, _)| p).sum::<f64>() * self.grid.cell_area()
    }

    pub fn total_force(&self) -> f64 {
        (0..self.bodies).map(|body| self.force(body)).sum()
    }

    /// The greatest displacement.
    pub fn deepest(&self) -> f64 {
        self.past.displacement().iter().copied().fold(0.0, f64::max)
    }

    fn motion(&self, body: usize, load: &Load) -> Motion {
        let n2 = self.grid.cells()[1];
        let own = |k: usize| self.owner[k] == body;
        let field = |f: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
            (0..self.grid.len()).map(|k| if own(k) { f(self.grid.center(k / n2, k % n2)) } else { 0.0 }).collect()
        };
        let mut modes = Vec::new();
        let mut lowered = [0.0; 3];
        let mut released = false;
        match *load {
            Load::Force { normal, .. } => {
                released = normal == 0.0;
                modes.push((field(&|_| 1.0), normal / self.grid.cell_area()));
            }
            Load::Approach { approach, .. } => lowered[0] = approach,
            _ => unreachable!(),
        }
        for (axis, tilt) in load.tilt().into_iter().enumerate() {
            match tilt {
                // in millimetres, so that all modes are of like size
                Tilt::Free { at } => modes.push((field(&|x| (x[axis] - at) / 1.0e-3), 0.0)),
                Tilt::Fixed(angle) => lowered[1 + axis] = angle,
                _ => unreachable!("{tilt:?}"),
            }
        }
        let prescribed = field(&|x| lowered[0] + lowered[1] * x[0] + lowered[2] * x[1]);
        Motion { modes, prescribed, released }
    }

    /// Pressure, and the coefficient of each mode of each body.
    fn solve(&self, c: f64, past: &[f64], motions: &[Motion]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let n = self.grid.len();
        let cells: Vec<usize> =
            (0..n).filter(|&k| self.gap[k].is_finite() && !motions[self.owner[k]].released).collect();
        let gap: Vec<f64> =
            cells.iter().map(|&k| self.gap[k] + past[k] - motions[self.owner[k]].prescribed[k]).collect();
        let modes: Vec<&(Vec<f64>, f64)> =
            motions.iter().filter(|motion| !motion.released).flat_map(|motion| &motion.modes).collect();
        let mut pressure = vec![0.0; n];
        let mut found: Vec<Vec<f64>> = motions.iter().map(|motion| vec![f64::NAN; motion.modes.len()]).collect();
        if cells.is_empty() {
            return Some((pressure, found));
        }
        // in units of the load, and of what it does to a cell
        let load: f64 = modes.iter().map(|mode| mode.1).sum();
        let own = c * self.influence[0];
        let deepest = gap.iter().copied().fold(0.0, |deepest, h: f64| f64::max(deepest, -h));
        let unit = if load > 0.0 { load / cells.len() as f64 } else { deepest / own };
        if unit <= 0.0 {
            return Some((pressure, found)); // nothing reaches the surface
        }
        let h = own * unit;
        let m = cells.len();
        let stiff = |a: usize, b: usize| self.influence[cells[a] * n + cells[b]] / self.influence[0];
        let matrix: Vec<f64> = (0..m * m).map(|at| stiff(at / m, at % m)).collect();
        let gap: Vec<f64> = gap.iter().map(|g| g / h).collect();
        let columns: Vec<Vec<f64>> = modes.iter().map(|mode| cells.iter().map(|&k| mode.0[k]).collect()).collect();
        let right: Vec<f64> = modes.iter().map(|mode| mode.1 / unit).collect();
        let (p, y) = quadratic::minimum(&matrix, &gap, &columns, &right)?;
        cells.iter().zip(&p).for_each(|(&k, p)| pressure[k] = unit * p);
        let mut y = y.iter().map(|y| h * y);
        for (found, _) in found.iter_mut().zip(motions).filter(|(_, motion)| !motion.released) {
            found.iter_mut().for_each(|found| *found = y.next().unwrap());
        }
        Some((pressure, found))
    }
}

/// Approach at the origin and tilts.
fn physical(load: &Load, modes: &[f64], released: bool) -> [f64; 3] {
    if released {
        return [f64::NAN; 3];
    }
    let mut modes = modes.iter();
    let mut motion = [0.0; 3];
    motion[0] = match *load {
        Load::Approach { approach, .. } => approach,
        _ => *modes.next().unwrap(),
    };
    for (axis, tilt) in load.tilt().into_iter().enumerate() {
        match tilt {
            Tilt::Fixed(angle) => motion[1 + axis] = angle,
            Tilt::Free { at } => {
                motion[1 + axis] = modes.next().unwrap() / 1.0e-3;
                motion[0] -= motion[1 + axis] * at;
            }
            _ => unreachable!("{tilt:?}"),
        }
    }
    motion
}
