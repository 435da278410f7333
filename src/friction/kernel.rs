//! The displacement along the surface under tractions along it.
//!
//! A half-space of the constant Poisson's ratio ν and the contact compliance C = (1 − ν)/2G displaces along its
//! surface by C K τ, wave by wave
//!
//! K(q) = (2/|q|) (I − ν q̂ q̂ᵀ)/(1 − ν),
//!
//! which is K(x) = (1/π) ((1/r) I + ν/(1 − ν) x xᵀ/r³) in space (Cerruti; K. L. Johnson, Contact Mechanics, 1985,
//! section 3.6). With ν = 0 it is the kernel of the normal displacement times I. The integrals over a cell are
//! differences of corner functions: y ln(x + r) has the derivative ∂²/∂x∂y = x²/r³, −r has xy/r³. All spectra are real:
//! those of x² and y² are even along both axes, that of xy is odd along both.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::Grid;
use crate::error::{Error, Refusal, Result};
use crate::fft::RealPlane;
use crate::friction::operator::Operator;
use crate::friction::preconditioner::Preconditioner;
use crate::friction::problem::Cell;
use crate::kernel::{HalfSpace, InfluenceKernel, fast_length, wave_number};
use crate::quadrature::GaussLegendre;

/// From so many sides of a cell on, six points along each side integrate its influence to rounding.
const FAR: f64 = 8.0;

/// What a traction on a cell displaces, at any distance in cells.
#[derive(Debug, Clone)]
pub(super) struct TangentialResponse {
    grid: Grid,
    body: HalfSpace,
    pub(super) poisson: f64,
    normal: InfluenceKernel,
    rule: GaussLegendre,
}

/// The error of bodies whose response along the surface is not known, or depends on the pressure.
pub(super) fn other_bodies() -> Error {
    let what = "friction in space covers half-spaces, periodic bodies and line contacts of a constant Poisson's ratio \
        that do not couple loads along the surface and normal to it";
    let remedy = ": Poisson's ratio 1/2 on a rigid body, or two bodies of one material";
    Refusal::unsupported("friction_other_bodies", what, remedy).into()
}

impl TangentialResponse {
    /// Of the body of a normal kernel, of this Poisson's ratio; a load that is periodic along one axis of several
    /// cells, layers and other kernels have none here.
    pub(super) fn new(normal: &InfluenceKernel, poisson: f64) -> Result<TangentialResponse> {
        let body = normal.half_space_below().ok_or_else(other_bodies)?;
        let rule = GaussLegendre::new(6);
        Ok(TangentialResponse { grid: normal.grid().clone(), body, poisson, normal: normal.clone(), rule })
    }

    /// The influence of a cell on itself, along the stiffer axis \[m\].
    pub(super) fn self_influence(&self) -> f64 {
        self.normal.self_influence()
    }

    /// Axes along which the body is periodic.
    pub(super) fn periodic(&self) -> [bool; 2] {
        self.normal.periodic_axes()
    }

    /// Influences xx, yy and xy \[m\] of the cell `at` cells away.
    fn coefficients(&self, at: [usize; 2]) -> [f64; 3] {
        let normal = self.normal.coefficient_at(at);
        let share = self.poisson / (1.0 - self.poisson);
        if let HalfSpace::Line { across } = self.body {
            // in plane strain the in-plane part equals the normal one; the other is that of a membrane
            let anti_plane = normal / (1.0 - self.poisson);
            return if across == 0 { [normal, anti_plane, 0.0] } else { [anti_plane, normal, 0.0] };
        }
        let [squares, product] = self.second_moments(at);
        let along = [share * squares, share * (PI * normal - squares)];
        [normal + along[0] / PI, normal + along[1] / PI, share * product / PI]
    }

    /// ∬ x²/r³ and ∬ xy/r³ over the cell `at` cells away.
    fn second_moments(&self, at: [usize; 2]) -> [f64; 2] {
        let sides = self.grid.spacing();
        let [x, y] = [0, 1].map(|axis| at[axis] as f64 * sides[axis]);
        let [a, b] = sides.map(|side| 0.5 * side);
        if x.hypot(y) > FAR * sides[0].max(sides[1]) {
            let sum = |of: fn(f64, f64) -> f64| {
                let at = |s: f64, t: f64| (x + a * s, y + b * t);
                a * b
                    * self
                        .rule
                        .sum(|s| self.rule.sum(|t| of(at(s, t).0, at(s, t).1) / at(s, t).0.hypot(at(s, t).1).powi(3)))
            };
            return [sum(|x, _| x * x), sum(|x, y| x * y)];
        }
        let square = |x: f64, y: f64| if y == 0.0 { 0.0 } else { y * (x / y.abs()).asinh() };
        let product = |x: f64, y: f64| -x.hypot(y);
        [square, product]
            .map(|corner| corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b))
    }

    /// (2/|q|) (I − ν q̂ q̂ᵀ)/(1 − ν) of a wave, xx, yy and xy.
    fn of_wave(&self, q: [f64; 2]) -> [f64; 3] {
        let size = q[0].hypot(q[1]);
        if size == 0.0 {
            return [0.0; 3];
        }
        let [e1, e2] = q.map(|q| q / size);
        let [whole, part] = [1.0, self.poisson].map(|share| 2.0 * share / (size * (1.0 - self.poisson)));
        [whole - part * e1 * e1, whole - part * e2 * e2, -part * e1 * e2]
    }

    /// The inverse, (|q|/2) ((1 − ν) I + ν q̂ q̂ᵀ).
    fn inverse_of_wave(&self, q: [f64; 2]) -> [f64; 3] {
        let size = q[0].hypot(q[1]);
        let [e1, e2] = q.map(|q| q / size);
        let [whole, part] = [1.0 - self.poisson, self.poisson].map(|share| 0.5 * share * size);
        [whole + part * e1 * e1, whole + part * e2 * e2, part * e1 * e2]
    }
}

/// K on a rectangle of cells, and an approximate inverse of it.
#[derive(Debug, Clone)]
pub(super) struct TangentialKernel {
    pub(super) operator: Operator,
    preconditioner: Preconditioner,
    /// Axes along which the body ends.
    ends: [bool; 2],
    /// Number of applications of each so far.
    pub(super) applications: [usize; 2],
}

/// The signed wave number of an index.
fn signed(k: usize, period: usize, side: f64) -> f64 {
    let number = wave_number(k.min(period - k), period, side);
    if 2 * k > period { -number } else { number }
}

impl TangentialKernel {
    pub(super) fn new(response: &TangentialResponse, cells: [usize; 2]) -> TangentialKernel {
        let (periodic, spacing) = (response.periodic(), response.grid.spacing());
        let waves = |periods: [usize; 2], of: &dyn Fn([f64; 2]) -> [f64; 3]| -> Vec<[f64; 3]> {
            let indices = (0..=periods[1] / 2).flat_map(|k2| (0..periods[0]).map(move |k1| [k1, k2]));
            let symbol = indices.map(|k| {
                let [xx, yy, xy] = of([0, 1].map(|axis| signed(k[axis], periods[axis], spacing[axis])));
                // a wave of two cells has no sign
                let is_shortest = (0..2).any(|axis| 2 * k[axis] == periods[axis]);
                [xx, yy, if is_shortest { 0.0 } else { xy }]
            });
            symbol.collect()
        };
        let ends = |axis: usize| !periodic[axis];
        let padded = [0, 1].map(|axis| if ends(axis) { fast_length(2 * cells[axis] - 1) } else { cells[axis] });
        let operator = Operator::new(cells, RealPlane::new(padded), |plane| {
            if response.body == HalfSpace::Periodic {
                return waves(padded, &|q| response.of_wave(q));
            }
            let mut fields = [(); 3].map(|()| vec![0.0; padded[0] * padded[1]]);
            for (i, j) in (0..cells[0]).flat_map(|i| (0..cells[1]).map(move |j| (i, j))) {
                let [xx, yy, xy] = response.coefficients([i, j]);
                for (at1, sign1) in [(i, 1.0), ((padded[0] - i) % padded[0], -1.0)] {
                    for (at2, sign2) in [(j, 1.0), ((padded[1] - j) % padded[1], -1.0)] {
                        let at = at1 * padded[1] + at2;
                        let odd = if i == 0 || j == 0 { 0.0 } else { sign1 * sign2 * xy };
                        (fields[0][at], fields[1][at], fields[2][at]) = (xx, yy, odd);
                    }
                }
            }
            let mut spectrum = vec![[0.0; 3]; plane.coefficients()];
            let mut coefficients = vec![Complex64::ZERO; plane.coefficients()];
            for (component, field) in fields.iter().enumerate() {
                plane.forward(field.chunks_exact(padded[1]), &mut coefficients);
                spectrum.iter_mut().zip(&coefficients).for_each(|(entry, value)| entry[component] = value.re);
            }
            spectrum
        });
        let closed = [0, 1].map(|axis| if periodic[axis] { cells[axis] } else { fast_length(cells[axis]) });
        let inverse = Operator::new(closed, RealPlane::new(closed), |_| {
            // the mean is as stiff as half of the longest wave, along both axes alike
            let longest =
                (0..2).filter(|&axis| closed[axis] > 1).map(|axis| wave_number(1, closed[axis], spacing[axis]));
            let mean = 0.25 * longest.fold(4.0 / response.self_influence(), f64::min);
            waves(closed, &|q| if q == [0.0; 2] { [mean, mean, 0.0] } else { response.inverse_of_wave(q) })
        });
        let preconditioner = Preconditioner::new(inverse, cells);
        TangentialKernel { operator, preconditioner, ends: [0, 1].map(ends), applications: [0; 2] }
    }

    /// out ← K traction.
    pub(super) fn apply(&mut self, traction: &[f64], out: &mut [f64]) {
        self.applications[0] += 1;
        self.operator.apply(traction, out);
    }

    /// Fits the preconditioner to a Newton step.
    pub(super) fn fit(&mut self, cells: &[Cell], curvature: &[f64], compliance: f64) {
        self.preconditioner.fit(cells, curvature, compliance);
    }

    /// out ← what the preconditioner makes of a residual.
    pub(super) fn precondition(&mut self, residual: &[f64], out: &mut [f64], cells: &[Cell], normals: &[[f64; 2]]) {
        self.applications[1] += 1;
        self.preconditioner.apply(residual, out, cells, normals);
    }

    /// The work of all applications, in convolutions of one component on a grid of so many cells.
    pub(super) fn equivalents(&self, cells: [usize; 2]) -> f64 {
        let periods = [0, 1].map(|axis| if self.ends[axis] { fast_length(2 * cells[axis] - 1) } else { cells[axis] });
        let whole = periods.iter().product::<usize>() as f64;
        let each = [self.operator.plane.periods().iter().product(), self.preconditioner.values()].map(|n| n as f64);
        2.0 * (0..2).map(|k| self.applications[k] as f64 * each[k] / whole).sum::<f64>()
    }
}
