//! Spectrum, coefficients and approximate inverse of a body, from its response.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use super::even_spectrum::{Symbol, even_spectrum};
use super::layout::{is_fast, waves_at};
use super::line_load::uniform;
use super::{Ends, InfluenceKernel, Layer, Layout, Shares, wave_number};
use crate::Grid;

/// The response \[m\] at two indices, one for each axis: a wave number of the grid along a periodic axis, a distance
/// in cells along an axis that ends. So it is the influence of a cell on another, the compliance of a wave, or, of a
/// body periodic along one axis, the influence of a cell on another across it for a wave along it.
pub(super) type Response = Arc<dyn Fn([usize; 2]) -> f64 + Send + Sync>;

/// Least compliance of a wave in the approximate inverse, relative to the largest of all waves.
pub(super) const LEAST_COMPLIANCE: f64 = 1e-8;

/// What lies below the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Body {
    HalfSpace,
    Layer(Layer),
    /// Given by the user.
    User,
}

/// How the load of a half-space continues beyond the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum HalfSpace {
    /// Not at all.
    LoadedOnGrid,
    /// The grid is a period along both axes.
    Periodic,
    /// Uniform along one axis, and only on the grid along the axis `across`: plane strain.
    Line { across: usize },
}

impl InfluenceKernel {
    /// The axis across a load that is periodic along the other one.
    fn across(&self) -> Option<usize> {
        if self.periodic[0] == self.periodic[1] { None } else { self.periodic.iter().position(|&periodic| !periodic) }
    }

    /// Whether the load is uniform along its periodic axis.
    fn is_plane(&self) -> bool {
        self.across().is_some_and(|across| self.grid.cells()[1 - across] == 1)
    }

    /// How the load continues beyond the grid, if the body is a half-space whose inside is known.
    pub(crate) fn half_space_below(&self) -> Option<HalfSpace> {
        match (self.body, self.across()) {
            (Body::HalfSpace, None) if self.periodic[0] => Some(HalfSpace::Periodic),
            (Body::HalfSpace, None) => Some(HalfSpace::LoadedOnGrid),
            (Body::HalfSpace, Some(across)) if self.is_plane() => Some(HalfSpace::Line { across }),
            _ => None,
        }
    }

    /// The layer, if the body is one: its Poisson's ratio must equal the material's.
    pub(crate) fn layer_of(&self) -> Option<&Layer> {
        if let Body::Layer(layer) = &self.body { Some(layer) } else { None }
    }

    pub(super) fn ends(&self) -> [Ends; 2] {
        self.periodic.map(|periodic| if periodic { Ends::Periodic } else { Ends::Free })
    }

    /// The factor by which the operator multiplies each wave of the layout; of local columns k2, where ranks share it
    /// out.
    pub(super) fn symbol(&self, layout: Layout, shares: Option<&Shares>) -> Symbol {
        if self.periodic == [true; 2] {
            let response = Arc::clone(&self.response);
            return Box::new(move |k1, k2| response([k1, k2]));
        }
        even_spectrum(layout, shares, &*self.response)
    }

    /// A layout without padding, and the factor by which an approximate inverse of the operator multiplies each of
    /// its waves. Axes that end are mirrored at their ends: on a period, a field that differs from one end to the
    /// other would jump. Where zeros follow because the transform would be slow without, it is a period: mirrored,
    /// the field would jump twice.
    ///
    /// The compliance of a half-space for the wave q is 2/|q| (Westergaard 1939), whatever its boundaries. Its
    /// approximate inverse is |q|/2, except for the mean, whose stiffness is that against a uniform pressure; layers
    /// have the compliance of their own waves. Other bodies are inverted wave by wave, on the grid taken as periodic
    /// (G. Strang, Stud. Appl. Math. 74, 1986).
    pub(super) fn inverse(&self, cells: [usize; 2], folded: [bool; 2]) -> (Layout, Symbol) {
        // a user's coefficients are known within the grid alone: too few for the period of its mirror image
        let mirrors = |axis: usize| self.body != Body::User && !self.periodic[axis] && is_fast(cells[axis]);
        let mirrored = [0, 1].map(|axis| folded[axis] || mirrors(axis));
        let layout = Layout { cells, ends: self.ends(), folded: mirrored }.wrapped();
        let (grid, count) = (&self.grid, [0, 1].map(|axis| cells[axis] * if folded[axis] { 2 } else { 1 }));
        let lengths = [0, 1].map(|axis| grid.spacing()[axis] * count[axis] as f64);
        let period = [layout.period(0), layout.period(1)];
        let q = magnitude(grid, period);
        let longest = (0..2).map(|axis| wave_number(1, period[axis], grid.spacing()[axis])).fold(f64::MAX, f64::min);
        let at_mean = |k1: usize, k2: usize| (k1, k2) == (0, 0);
        let symbol: Symbol = match (self.body, self.across()) {
            (Body::HalfSpace, across) => {
                let mean = match across {
                    Some(across) => 1.0 / uniform(lengths[across], self.datum.unwrap_or(f64::NAN)),
                    // the mean displacement is fixed at zero: the mean gets the stiffness of the longest wave
                    None if self.periodic[0] => 0.5 * longest,
                    // a uniform pressure p on a square of side L displaces it by 0.95 L p on average (Love)
                    None => 1.05 / (lengths[0] * lengths[1]).sqrt(),
                };
                Box::new(move |k1, k2| if at_mean(k1, k2) { mean } else { 0.5 * q([k1, k2]) })
            }
            (Body::Layer(layer), across) if self.periodic != [true; 2] => {
                let mean = if let Some(across) = across {
                    let n = count[across];
                    let at = |i: usize| (self.response)(if across == 0 { [i, 0] } else { [0, i] });
                    at(0) + (1..n).map(|i| 2.0 * (1.0 - i as f64 / n as f64) * at(i)).sum::<f64>()
                } else {
                    // 0.95 L is the compliance of the wave 2.1/L; no stiffer than the longest wave, where long ones are
                    // the stiffest
                    layer.compliance(2.1 / (lengths[0] * lengths[1]).sqrt()).max(layer.compliance(longest))
                };
                Box::new(move |k1, k2| 1.0 / if at_mean(k1, k2) { mean } else { layer.compliance(q([k1, k2])) })
            }
            _ => {
                let symbol = self.symbol(layout, None);
                let most = waves(layout).map(|[k1, k2]| symbol(k1, k2)).fold(0.0, f64::max);
                Box::new(move |k1, k2| {
                    let compliance = symbol(k1, k2);
                    // a mean of zero compliance is fixed, not infinitely stiff
                    let fixed = at_mean(k1, k2) && compliance == 0.0;
                    1.0 / if fixed { most } else { compliance.abs().max(LEAST_COMPLIANCE * most) }
                })
            }
        };
        (layout, symbol)
    }

    /// All values of the response of a grid, and how many belong to an index along x1.
    pub(super) fn table(&self) -> (impl Iterator<Item = f64>, usize) {
        let cells = self.grid.cells();
        let count = [0, 1].map(|axis| if self.periodic[axis] { cells[axis] / 2 + 1 } else { cells[axis] });
        (indices(count).map(|at| (self.response)(at)), count[1])
    }

    /// The compliance \[m\] of the wave with these absolute numbers of a body that is periodic along both axes.
    pub(crate) fn of_wave(&self, k: [usize; 2]) -> f64 {
        (self.response)(k)
    }

    /// The maximum compliance of a wave \[m\], if the mean has none.
    pub(crate) fn softest_wave_if_mean_is_held(&self) -> Option<f64> {
        *self.facts.softest.get_or_init(|| match self.body {
            _ if self.periodic != [true; 2] || (self.response)([0, 0]) != 0.0 => None,
            // the longest wave: 2/q = L/π
            Body::HalfSpace => Some(longest_side(&self.grid) / PI),
            _ => Some(self.table().0.fold(0.0, f64::max)),
        })
    }

    /// Whether the mean displacement is fixed: then the approach cannot exceed the approach of full contact.
    pub(crate) fn mean_is_held(&self) -> bool {
        self.softest_wave_if_mean_is_held().is_some()
    }

    /// Whether a pressure raises the surface somewhere, as beside the load on a layer that bulges, or to keep the mean.
    /// Costs a line of coefficients, more where each is a sum over waves: computed at the first call.
    pub(crate) fn raises(&self) -> bool {
        let [n1, n2] = self.grid.cells();
        let negative = |at: [usize; 2]| self.coefficient_at(at) < 0.0;
        *self.facts.raises.get_or_init(|| match (self.body, self.periodic) {
            (_, [true, true]) => true,
            (Body::HalfSpace, _) => false,
            (Body::User, _) => self.table().0.any(|value| value < 0.0),
            // the same in all directions
            (_, [false, false]) => (0..n1).any(|i| negative([i, 0])) || (0..n2).any(|j| negative([0, j])),
            (_, [false, true]) => (0..n1).any(|i| negative([i, 0]) || negative([i, n2 / 2])),
            (_, [true, false]) => (0..n2).any(|j| negative([0, j]) || negative([n1 / 2, j])),
        })
    }

    /// The influence of a cell on itself \[m\].
    pub(crate) fn self_influence(&self) -> f64 {
        *self.facts.on_itself.get_or_init(|| self.coefficient_at([0; 2]))
    }

    /// The coefficient \[m\] of the cell `at` cells away along each axis of the grid: along periodic axes the mean of
    /// the waves.
    pub(crate) fn coefficient_at(&self, at: [usize; 2]) -> f64 {
        let periods = [0, 1].map(|axis| if self.periodic[axis] { self.grid.cells()[axis] } else { 1 });
        let terms = |axis: usize| if self.periodic[axis] { 0..=periods[axis] / 2 } else { at[axis]..=at[axis] };
        let weight =
            |axis: usize, k: usize| if self.periodic[axis] { waves_at(at[axis], k, periods[axis]) } else { 1.0 };
        let row = |k1: usize| terms(1).map(|k2| weight(1, k2) * (self.response)([k1, k2])).sum::<f64>();
        terms(0).map(|k1| weight(0, k1) * row(k1)).sum::<f64>() / (periods[0] * periods[1]) as f64
    }
}

/// The body: "half-space, periodic along x2, datum 1e0 m".
impl fmt::Display for InfluenceKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.body {
            Body::HalfSpace => write!(f, "half-space")?,
            Body::Layer(layer) => write!(f, "{layer}")?,
            Body::User if self.periodic[0] => write!(f, "user-defined waves")?,
            Body::User => write!(f, "user-defined coefficients")?,
        }
        match (self.periodic, self.across()) {
            (_, Some(_)) if self.is_plane() => write!(f, ", in plane strain")?,
            (_, Some(across)) => write!(f, ", periodic along x{}", 2 - across)?,
            ([true, _], _) => write!(f, ", periodic along x1 and x2")?,
            _ => {}
        }
        if self.half_space_below() == Some(HalfSpace::Periodic) {
            write!(f, ", the mean of the surface being the datum")?;
        }
        self.datum.map_or(Ok(()), |datum| write!(f, ", datum {datum:e} m"))
    }
}

debug_by!(self: InfluenceKernel => grid: self.grid, body: self.to_string());

/// |q| \[1/m\] of the wave numbers of periods \[cells\].
pub(super) fn magnitude(grid: &Grid, period: [usize; 2]) -> impl Fn([usize; 2]) -> f64 + 'static {
    let spacing = grid.spacing();
    let q = move |axis: usize, k: usize| wave_number(k, period[axis], spacing[axis]);
    move |[k1, k2]| q(0, k1).hypot(q(1, k2))
}

/// The length of the longest wave of a periodic grid \[m\]: 0 on a single cell.
pub(super) fn longest_side(grid: &Grid) -> f64 {
    (0..2).filter(|&axis| grid.cells()[axis] > 1).map(|axis| grid.lengths()[axis]).fold(0.0, f64::max)
}

/// The independent waves of a layout.
pub(super) fn waves(layout: Layout) -> impl Iterator<Item = [usize; 2]> {
    indices([0, 1].map(|axis| layout.period(axis) / 2 + 1))
}

/// All pairs of indices below the `count` of each axis.
pub(super) fn indices([n1, n2]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    (0..n1).flat_map(move |k1| (0..n2).map(move |k2| [k1, k2]))
}
