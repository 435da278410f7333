//! Constructors of the kernels of layers.

use super::constructors::{check_line, representable, strip};
use super::influence::longest_side;
use super::layer::{Layer, Remainder};
use super::{Body, InfluenceKernel, Love, Strip, magnitude, wave_number};
use crate::Grid;
use crate::axis::Axis;
use crate::error::{Error, Refusal, Result, count_within, within};
use crate::rounded::rounded;

/// Longest cell over the thickness: the coefficients have then lost as many digits.
const LONGEST_CELL: f64 = 1e3;
/// Longest cell over the thickness, for layers that yield to a pressure only by being squeezed out: the middle of a
/// long cell is not.
const LONGEST_SQUEEZED: f64 = 2.0;

impl Layer {
    /// The kernel of this layer on cells of a grid, periodic along these axes.
    pub(super) fn on_cells(
        self,
        grid: &Grid,
        periodic: [bool; 2],
        along: Option<Axis>,
        datum: Option<f64>,
    ) -> Result<InfluenceKernel> {
        match (periodic, along) {
            ([true, true], _) => InfluenceKernel::layer_periodic(grid, self),
            (_, Some(along)) => InfluenceKernel::layer_periodic_along(grid, self, along, datum),
            _ => InfluenceKernel::layer(grid, self),
        }
    }
}

impl InfluenceKernel {
    /// A [`Layer`], loaded on the grid alone: Love's coefficients of the half-space and, cell by cell, the integral
    /// of what the layer adds, smooth on the scale of its thickness; right to 1e-11 of the half-space's coefficient
    /// at the distance. The approach is measured from the surface far away.
    ///
    /// Cost: a table of Hankel integrals when the kernel is made, 1 to 31 ms, and a quadrature per cell at the first
    /// use: with 256² cells 50 to 130 ms, where a half-space takes 15 to 25. A contact on a layer then costs what one
    /// on a half-space does, except that it is not confined to a window.
    ///
    /// # Errors
    /// If a side of a cell, or their ratio, is not in \[1e-100, 1e100\] (m), or a cell is more than 1000 times as
    /// long as the layer is thick; more than twice as long if the layer is almost incompressible (ν > 0.4975) and
    /// bonded to a rigid base. A pressure uniform on such a cell does not squeeze the layer out: long waves are 1 %
    /// too soft with cells as long as the layer is thick, 9 % with cells of twice that.
    pub fn layer(grid: &Grid, layer: Layer) -> Result<InfluenceKernel> {
        representable(grid)?;
        let sides = grid.spacing();
        check_side(sides[0].max(sides[1]), layer)?;
        let (love, added) = (Love::new(sides), Remainder::of_cells(&layer, grid.lengths()[0].hypot(grid.lengths()[1])));
        let coefficient = move |at: [usize; 2]| {
            let distance = [0, 1].map(|axis| at[axis] as f64 * sides[axis]);
            love.coefficient(at) + added.on_cell(distance, sides)
        };
        Ok(InfluenceKernel::new(grid, Body::Layer(layer), [false; 2], coefficient))
    }

    /// A [`Layer`] that is periodic along both axes, the grid being one period: (2/q) L(qh) for each wave q of the
    /// pressure, exactly ([`Layer::compliance`]).
    ///
    /// On a rigid base the approach is measured from the undeformed surface, and the mean of the pressure compresses
    /// a layer that can expand to no side, by its oedometric compliance. Where that is zero, for an incompressible
    /// layer, and on a half-space, where it is undetermined, the mean displacement is zero, as in
    /// [`InfluenceKernel::periodic`]. On a grid of N × 1 cells this is the periodic contact in plane strain.
    ///
    /// ```
    /// use viscocontact::{Grid, InfluenceKernel, Layer};
    ///
    /// let grid = Grid::new([64, 1], [1.0, 1.0])?;
    /// let layer = Layer::frictionless_on_rigid(0.1, 0.3)?;
    /// let kernel = InfluenceKernel::layer_periodic(&grid, layer)?;
    /// let q = std::f64::consts::TAU;
    /// let wave: Vec<f64> = (0..64).map(|i| (q * grid.center(i, 0)[0]).cos()).collect();
    /// let mut kp = vec![0.0; 64];
    /// kernel.convolve(&wave, &mut kp, &mut kernel.workspace()?)?;
    /// assert!((kp[10] - layer.compliance(q) * wave[10]).abs() < 1e-14);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If nothing on the grid can be displaced: it has one cell, and the mean does not move. If a side of a cell, or
    /// their ratio, is not in \[1e-100, 1e100\] (m), or the compliance of a wave vanishes in `f64`.
    pub fn layer_periodic(grid: &Grid, layer: Layer) -> Result<InfluenceKernel> {
        representable(grid)?;
        let mean = if layer.is_on_rigid() { layer.mean() } else { 0.0 };
        let allowed = "2 or more: the mean of this surface is not displaced";
        count_within("cells of a periodic grid", grid.len(), mean != 0.0 || grid.len() > 1, allowed)?;
        let longest = longest_side(grid);
        if longest > 0.0 {
            let softness = layer.compliance(std::f64::consts::TAU / longest);
            let enough = "a normal number: the layer is too thin for this grid";
            within("compliance of the longest wave", softness, softness.is_normal(), enough)?;
        }
        let q = magnitude(grid, grid.cells());
        let compliance = move |k: [usize; 2]| if k == [0, 0] { mean } else { layer.compliance(q(k)) };
        Ok(InfluenceKernel::new(grid, Body::Layer(layer), [true; 2], compliance))
    }

    /// A [`Layer`] in line contact, in plane strain: a grid of N × 1 cells, and pressures that do not depend on x2,
    /// as [`InfluenceKernel::line`]. On a rigid base the displacement under a line load is bounded, and the approach
    /// is measured from the undeformed surface: `datum` is `None`. On a half-space it is not: `datum` is the distance
    /// \[m\] from a line load at which the displacement is zero.
    ///
    /// # Errors
    /// If the grid has more than one cell along x2. If a datum is given on a rigid base, or none on a half-space, or
    /// it is not finite, or less than the length of the grid along x1, or more than 1e120 m. As
    /// [`InfluenceKernel::layer`], of the sides along x1.
    pub fn layer_line(grid: &Grid, layer: Layer, datum: Option<f64>) -> Result<InfluenceKernel> {
        check_line(grid)?;
        InfluenceKernel::layer_periodic_along(grid, layer, Axis::X2, datum)
    }

    /// A [`Layer`] that is periodic along `axis` (0 is x1, 1 is x2), the grid being one period, and loaded on the
    /// grid only along the other, as [`InfluenceKernel::periodic_along`]: for each wave κ along the axis the
    /// coefficients of cells across it: the half-space's, and the layer's addition to them. Approach and `datum` are
    /// as in
    /// [`InfluenceKernel::layer_line`], which this is where the pressure is uniform along the axis.
    ///
    /// Cost: a table of integrals for each wave longer than a third of the thickness, when the kernel is made. With
    /// 256 cells along the axis all of them take 5 ms if the layer is as thick as the period is long, 0.15 s with a
    /// tenth of that, and 1 s with a hundredth.
    ///
    /// # Errors
    /// As [`InfluenceKernel::layer_line`], of lengths and sides along the other axis.
    pub fn layer_periodic_along(grid: &Grid, layer: Layer, along: Axis, datum: Option<f64>) -> Result<InfluenceKernel> {
        let (axis, across) = along.and_other();
        let strip = layer_strip(grid, layer, across, datum)?;
        let (last, cells, side) = (grid.lengths()[across], grid.cells()[axis], grid.spacing()[axis]);
        let mut added = vec![Remainder::of_lines(&layer, last, datum)];
        let waves = (1..=cells / 2).map(|k| Remainder::of_wave(&layer, last, wave_number(k, cells, side)));
        added.extend(waves.map_while(|remainder| remainder));
        let added = move |k: usize, x: f64| added.get(k).map_or(0.0, |remainder| remainder.on_line(x, strip.side));
        Ok(InfluenceKernel::strips(grid, Body::Layer(layer), axis, (strip, datum), added))
    }
}

/// The strips of the half-space on cells along `axis`, with the datum to which the remainders of lines belong.
fn layer_strip(grid: &Grid, layer: Layer, axis: usize, datum: Option<f64>) -> Result<Strip> {
    representable(grid)?;
    // along the line nothing varies, or waves do: its cells may be long
    let side = grid.spacing()[axis];
    check_side(side, layer)?;
    match datum {
        None if layer.is_on_rigid() => Ok(Strip { side, datum: 2.0 * layer.thickness() }),
        Some(datum) if !layer.is_on_rigid() => strip(grid, axis, datum),
        None => {
            let allowed = "a distance: that at which the displacement of the half-space is zero";
            Err(layer_datum("absent".into(), allowed))
        }
        Some(datum) => {
            let allowed = "absent: far from a load a layer on a rigid base is at rest";
            Err(layer_datum(format!("{} m", rounded(datum, 5)), allowed))
        }
    }
}

fn layer_datum(datum: String, allowed: &'static str) -> Error {
    let what = format!("the datum of a load along a line on a layer is {datum}");
    Refusal::value("kernel_layer_datum", what, "").naming("datum").must_be(allowed).into()
}

/// Rejects cells that are too long for the layer.
fn check_side(side: f64, layer: Layer) -> Result<()> {
    let longest = side / layer.thickness();
    let field = "longer side of a cell over the thickness of the layer";
    within(field, longest, longest <= LONGEST_CELL, "at most 1000: a thinner layer is a foundation of springs")?;
    let allowed = "at most 2 for an almost incompressible layer bonded to a rigid base, which is squeezed out or does not \
                   yield: refine the mesh, or make a line contact by InfluenceKernel::layer_line";
    within(field, longest, longest <= LONGEST_SQUEEZED || !layer.is_squeezed(), allowed).map(drop)
}
