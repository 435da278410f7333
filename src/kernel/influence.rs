//! The displacement under a unit pressure, for each kind of body.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use super::even_spectrum::{EvenLine, EvenSpectrum};
use super::layer::{Layer, Remainder};
use super::layout::{Ends, Layout, waves_at};
use super::line_load::{Strip, wave_number};
use super::love::Love;
use super::transform::Shares;
use crate::Grid;
use crate::kernel::layout::is_fast;

/// A real even function of wave numbers.
pub(super) type Symbol = Box<dyn Fn(usize, usize) -> f64>;

/// Least compliance of a wave in the approximate inverse, relative to the greatest of all waves.
const LEAST_COMPLIANCE: f64 = 1e-8;

/// The influence of a cell on another, or of a wave on itself.
#[derive(Debug, Clone)]
pub(super) enum Influence {
    /// A half-space, loaded on cells.
    HalfSpace(Love),
    /// A half-space, periodic along both axes: Westergaard's 2/|q|, the mean displacement being the datum.
    Periodic,
    /// A half-space, periodic along one axis; of a single cell along it: a line contact.
    Strip { periodic: usize, strip: Strip },
    /// A layer, loaded on cells: what it adds to the half-space.
    Layer { layer: Layer, love: Love, remainder: Arc<Remainder> },
    /// A layer, periodic along both axes.
    LayerPeriodic(Layer),
    /// A layer in plane strain.
    LayerLine { layer: Layer, strip: Strip, remainder: Arc<Remainder> },
    /// A layer, periodic along one axis: the strip of the half-space, and what the layer adds to each wave that reaches the base.
    LayerStrip { layer: Layer, periodic: usize, strip: Strip, remainders: Arc<[Remainder]> },
    /// User-defined coefficients, for the distances of the grid.
    Coefficients { values: Arc<[f64]>, columns: usize },
    /// User-defined compliance of each wave, for the independent wave numbers of the period.
    Waves { values: Arc<[f64]>, columns: usize },
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

impl Influence {
    /// How the load continues, if the body is a half-space whose inside is known.
    pub(super) fn half_space(&self, grid: &Grid) -> Option<HalfSpace> {
        match self {
            Influence::HalfSpace(_) => Some(HalfSpace::LoadedOnGrid),
            Influence::Periodic => Some(HalfSpace::Periodic),
            Influence::Strip { periodic, .. } if grid.cells()[*periodic] == 1 => {
                Some(HalfSpace::Line { across: 1 - periodic })
            }
            _ => None,
        }
    }

    pub(super) fn layer(&self) -> Option<&Layer> {
        match self {
            Influence::Layer { layer, .. }
            | Influence::LayerPeriodic(layer)
            | Influence::LayerLine { layer, .. }
            | Influence::LayerStrip { layer, .. } => Some(layer),
            _ => None,
        }
    }

    pub(super) fn ends(&self) -> [Ends; 2] {
        match self {
            Influence::Periodic | Influence::LayerPeriodic(_) | Influence::Waves { .. } => [Ends::Periodic; 2],
            Influence::LayerLine { .. } => [Ends::Free, Ends::Periodic],
            Influence::Strip { periodic, .. } | Influence::LayerStrip { periodic, .. } => {
                [0, 1].map(|axis| if axis == *periodic { Ends::Periodic } else { Ends::Free })
            }
            Influence::HalfSpace(_) | Influence::Layer { .. } | Influence::Coefficients { .. } => [Ends::Free; 2],
        }
    }

    /// The factor by which the operator multiplies each wave of the layout; of own columns k2, where ranks share it out.
    pub(super) fn symbol(&self, grid: &Grid, layout: Layout, shares: Option<&Shares>) -> Symbol {
        let spectrum = |coefficient: &dyn Fn(usize, usize) -> f64| -> Symbol {
            let spectrum = EvenSpectrum::of(layout, shares, coefficient);
            Box::new(move |k1, k2| spectrum.at(k1, k2))
        };
        match self {
            Influence::HalfSpace(love) => spectrum(&|i, j| love.coefficient(i, j)),
            Influence::Coefficients { values, columns } => spectrum(&|i, j| values[i * columns + j]),
            Influence::Layer { .. } | Influence::LayerLine { .. } => spectrum(&|i, j| self.coefficient(grid, [i, j])),
            Influence::Waves { values, columns } => {
                let (values, columns) = (Arc::clone(values), *columns);
                Box::new(move |k1, k2| values[k1 * columns + k2])
            }
            Influence::Periodic => {
                let q = magnitude(grid, layout);
                Box::new(move |k1, k2| if (k1, k2) == (0, 0) { 0.0 } else { 2.0 / q(k1, k2) })
            }
            Influence::LayerPeriodic(layer) => {
                let (q, layer) = (magnitude(grid, layout), *layer);
                let mean = layer.compliance_of_period();
                Box::new(move |k1, k2| if (k1, k2) == (0, 0) { mean } else { layer.compliance(q(k1, k2)) })
            }
            Influence::Strip { periodic, .. } | Influence::LayerStrip { periodic, .. } => {
                // for each wave along the periodic axis, a convolution along the other
                let (periodic, free) = (*periodic, 1 - periodic);
                let (mut line, mut values) = (EvenLine::new(layout.period(free)), Vec::new());
                let columns = shares.map_or(layout.all_columns(), |shares| shares.columns(&layout));
                let all = [0..layout.period(0) / 2 + 1, columns];
                let (waves, wanted) = (all[periodic].clone(), all[free].clone());
                for k in waves.clone() {
                    let known = layout.cells[free] * if layout.folded[free] { 2 } else { 1 };
                    let line = line.transform((0..known).map(|i| self.across(grid, i, k)));
                    values.extend(line.skip(wanted.start).take(wanted.len()));
                }
                Box::new(move |k1, k2| {
                    let k = [k1, k2];
                    values[(k[periodic] - waves.start) * wanted.len() + (k[free] - wanted.start)]
                })
            }
        }
    }

    /// A layout without padding, and the factor by which an approximate inverse of the operator multiplies each of its
    /// waves. Axes that end are mirrored at their ends: on a period, a field that differs from one end to the other would jump.
    /// Where zeros follow because the transform would be slow without, it is a period: mirrored, the field would jump twice.
    ///
    /// The compliance of a half-space for the wave q is 2/|q| (Westergaard 1939), whatever its boundaries. Its
    /// approximate inverse is |q|/2, except for the mean, whose stiffness is that against a uniform pressure; layers
    /// have the compliance of their own waves. Other bodies are inverted wave by wave, on the grid taken as periodic (G.
    /// Strang, Stud. Appl. Math. 74, 1986).
    pub(super) fn inverse(&self, grid: &Grid, cells: [usize; 2], folded: [bool; 2]) -> (Layout, Symbol) {
        let ends = self.ends();
        // coefficients are known within the grid alone: too few for the period of its mirror image
        let mirrors = !matches!(self, Influence::Coefficients { .. });
        let mirrored = [0, 1].map(|axis| folded[axis] || mirrors && ends[axis] == Ends::Free && is_fast(cells[axis]));
        let layout = Layout { cells, ends, folded: mirrored }.wrapped();
        let lengths = [0, 1].map(|axis| grid.spacing()[axis] * (cells[axis] * if folded[axis] { 2 } else { 1 }) as f64);
        let westergaard = |mean: f64| -> Symbol {
            let q = magnitude(grid, layout);
            Box::new(move |k1, k2| if (k1, k2) == (0, 0) { mean } else { 0.5 * q(k1, k2) })
        };
        let layered = |layer: Layer, mean: f64| -> Symbol {
            let q = magnitude(grid, layout);
            Box::new(move |k1, k2| 1.0 / if (k1, k2) == (0, 0) { mean } else { layer.compliance(q(k1, k2)) })
        };
        let longest =
            || (0..2).map(|axis| wave_number(1, layout.period(axis), grid.spacing()[axis])).fold(f64::MAX, f64::min);
        let symbol = match self {
            // a uniform pressure p on a square of side L displaces it by 0.95 L p on average (Love)
            Influence::HalfSpace(_) => westergaard(1.05 / (lengths[0] * lengths[1]).sqrt()),
            Influence::Strip { periodic, strip } => westergaard(1.0 / strip.uniform(lengths[1 - periodic])),
            // the mean displacement is fixed at zero: the mean gets the stiffness of the longest wave
            Influence::Periodic => westergaard(0.5 * longest()),
            Influence::Layer { layer, .. } => {
                // 0.95 L is the compliance of the wave 2.1/L; no stiffer than the longest wave, where long ones are
                // the stiffest
                let mean = layer.compliance(2.1 / (lengths[0] * lengths[1]).sqrt());
                layered(*layer, mean.max(layer.compliance(longest())))
            }
            Influence::LayerLine { layer, .. } => {
                let (count, at) = (cells[0] * if folded[0] { 2 } else { 1 }, |i| self.coefficient(grid, [i, 0]));
                let far = (1..count).map(|i| 2.0 * (1.0 - i as f64 / count as f64) * at(i)).sum::<f64>();
                layered(*layer, at(0) + far)
            }
            Influence::LayerStrip { layer, periodic, .. } => {
                let count = cells[1 - periodic] * if folded[1 - periodic] { 2 } else { 1 };
                let at = |i| self.across(grid, i, 0);
                let far = (1..count).map(|i| 2.0 * (1.0 - i as f64 / count as f64) * at(i)).sum::<f64>();
                layered(*layer, at(0) + far)
            }
            Influence::LayerPeriodic(_) | Influence::Coefficients { .. } | Influence::Waves { .. } => {
                let symbol = self.symbol(grid, layout, None);
                let waves =
                    (0..=layout.period(0) / 2).flat_map(|k1| (0..=layout.period(1) / 2).map(move |k2| (k1, k2)));
                let most = waves.map(|(k1, k2)| symbol(k1, k2)).fold(0.0, f64::max);
                Box::new(move |k1, k2| {
                    let compliance = symbol(k1, k2);
                    // a mean of zero compliance is fixed, not infinitely stiff
                    let fixed = (k1, k2) == (0, 0) && compliance == 0.0;
                    1.0 / if fixed { most } else { compliance.abs().max(LEAST_COMPLIANCE * most) }
                })
            }
        };
        (layout, symbol)
    }

    /// The coefficient \[m\] of a body that is periodic along one axis: of the `i`-th cell across it, for its `k`-th wave.
    fn across(&self, grid: &Grid, i: usize, k: usize) -> f64 {
        let wave = |periodic: usize| wave_number(k, grid.cells()[periodic], grid.spacing()[periodic]);
        match self {
            Influence::Strip { periodic, strip } => strip.coefficient(i, wave(*periodic)),
            Influence::LayerStrip { periodic, strip, remainders, .. } => {
                let side = grid.spacing()[1 - periodic];
                let added = remainders.get(k).map_or(0.0, |remainder| remainder.on_line(i as f64 * side, side));
                strip.coefficient(i, wave(*periodic)) + added
            }
            _ => 0.0,
        }
    }

    /// The greatest compliance of a wave, if the mean has none.
    pub(super) fn softest_wave_if_mean_is_held(&self, grid: &Grid) -> Option<f64> {
        match self {
            // the longest wave: 2/q = L/π
            Influence::Periodic => {
                let lengths = (0..2).filter(|&axis| grid.cells()[axis] > 1).map(|axis| grid.lengths()[axis]);
                Some(lengths.fold(0.0, f64::max) / PI)
            }
            Influence::LayerPeriodic(layer) if layer.compliance_of_period() == 0.0 => {
                let whole = Layout { cells: grid.cells(), ends: self.ends(), folded: [false; 2] };
                let symbol = self.symbol(grid, whole, None);
                let waves = (0..=grid.cells()[0] / 2).flat_map(|k1| (0..=grid.cells()[1] / 2).map(move |k2| (k1, k2)));
                Some(waves.map(|(k1, k2)| symbol(k1, k2)).fold(0.0, f64::max))
            }
            Influence::Waves { values, .. } if values[0] == 0.0 => Some(values.iter().copied().fold(0.0, f64::max)),
            _ => None,
        }
    }

    /// Whether a pressure raises the surface somewhere, as beside the load on a layer that bulges, or to keep the mean.
    pub(super) fn raises(&self, grid: &Grid) -> bool {
        let cells = grid.cells();
        let beside = |along: [usize; 2]| self.coefficient(grid, along) < 0.0;
        match self {
            Influence::HalfSpace(_) | Influence::Strip { .. } => false,
            Influence::Coefficients { values, .. } => values.iter().any(|&value| value < 0.0),
            // the same in all directions
            Influence::Layer { .. } | Influence::LayerLine { .. } => {
                (0..cells[0]).any(|i| beside([i, 0])) || (0..cells[1]).any(|j| beside([0, j]))
            }
            Influence::LayerStrip { periodic, .. } => {
                let across = |i: usize, j: usize| if *periodic == 0 { [j, i] } else { [i, j] };
                (0..cells[1 - periodic]).any(|i| beside(across(i, 0)) || beside(across(i, cells[*periodic] / 2)))
            }
            Influence::Periodic | Influence::LayerPeriodic(_) | Influence::Waves { .. } => true,
        }
    }

    /// The coefficient \[m\] of the cell `at` cells away along each axis of the grid.
    pub(super) fn coefficient(&self, grid: &Grid, at: [usize; 2]) -> f64 {
        match self {
            Influence::HalfSpace(love) => love.coefficient(at[0], at[1]),
            Influence::Coefficients { values, columns } => values[at[0] * columns + at[1]],
            Influence::Layer { love, remainder, .. } => {
                let spacing = grid.spacing();
                let distance = [0, 1].map(|axis| at[axis] as f64 * spacing[axis]);
                love.coefficient(at[0], at[1]) + remainder.on_cell(distance, spacing)
            }
            Influence::LayerLine { strip, remainder, .. } => {
                let side = grid.spacing()[0];
                strip.coefficient(at[0], 0.0) + remainder.on_line(at[0] as f64 * side, side)
            }
            Influence::Strip { periodic, .. } | Influence::LayerStrip { periodic, .. } => {
                let cells = grid.cells()[*periodic];
                let across = |k: usize| self.across(grid, at[1 - periodic], k);
                let waves = (0..=cells / 2).map(|k| waves_at(at[*periodic], k, cells) * across(k));
                waves.sum::<f64>() / cells as f64
            }
            Influence::Periodic | Influence::LayerPeriodic(_) | Influence::Waves { .. } => {
                let layout = Layout { cells: grid.cells(), ends: self.ends(), folded: [false; 2] };
                layout.coefficient(at, self.symbol(grid, layout, None))
            }
        }
    }
}

/// |q| \[1/m\] of the wave numbers of a layout.
fn magnitude(grid: &Grid, layout: Layout) -> impl Fn(usize, usize) -> f64 + 'static {
    let (spacing, period) = (grid.spacing(), [layout.period(0), layout.period(1)]);
    let q = move |axis: usize, k: usize| wave_number(k, period[axis], spacing[axis]);
    move |k1, k2| q(0, k1).hypot(q(1, k2))
}

impl fmt::Display for Influence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Influence::HalfSpace(_) => write!(f, "half-space"),
            Influence::Periodic => {
                write!(f, "half-space, periodic along x1 and x2, the mean of the surface being the datum")
            }
            Influence::Strip { periodic, strip } => {
                write!(f, "half-space, periodic along x{}, datum {:e} m", periodic + 1, strip.datum)
            }
            Influence::Layer { layer, .. } => write!(f, "{layer}"),
            Influence::LayerPeriodic(layer) => write!(f, "{layer}, periodic along x1 and x2"),
            Influence::LayerLine { layer, .. } if layer.is_on_rigid() => write!(f, "{layer}, in plane strain"),
            Influence::LayerLine { layer, strip, .. } => {
                write!(f, "{layer}, in plane strain, datum {:e} m", strip.datum)
            }
            Influence::LayerStrip { layer, periodic, .. } if layer.is_on_rigid() => {
                write!(f, "{layer}, periodic along x{}", periodic + 1)
            }
            Influence::LayerStrip { layer, periodic, strip, .. } => {
                write!(f, "{layer}, periodic along x{}, datum {:e} m", periodic + 1, strip.datum)
            }
            Influence::Coefficients { .. } => write!(f, "user-defined coefficients"),
            Influence::Waves { .. } => write!(f, "user-defined waves, periodic along x1 and x2"),
        }
    }
}
