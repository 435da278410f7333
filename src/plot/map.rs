//! Colour maps of fields.

use crate::values::Counted;
use std::path::Path;

use crate::Grid;
use crate::error::{Result, exact_length, least_length};
use crate::plot::color_bar;
use crate::plot::sizes::SIZES;
use crate::plot::{Canvas, Color, ColorScale, DrawnAxis, Frame, Picture, Quantity, Room, color_scale, drawable};

/// A field on a grid as colours, by default dark for small values and light for large ones ([`ColorScale`]).
///
/// [`Map::of`] is the map of a field of a contact.
///
/// ```
/// use viscocontact::{Grid, plot::{Map, Quantity}};
///
/// let grid = Grid::new([2, 3], [2.0e-3, 3.0e-3])?;
/// let mut map = Map::new(&grid, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], Quantity::new("height", "m"))?;
/// map.title = "Stairs".into();
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-map-{}.png", std::process::id()));
/// map.save(&path)?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct Map {
    /// The title above the map.
    pub title: String,
    /// The quantity of the colour bar.
    pub quantity: Quantity,
    /// The axes (default: x1 and x2 in metres, shown with a suitable prefix).
    pub axes: [Quantity; 2],
    /// Ends of the colour scale, in the unit of the values (default: the smallest and the largest finite value). Values
    /// outside have the colour of the nearer end, and the colour bar has a triangle at that end.
    pub range: [f64; 2],
    /// The colours of the scale (default: sequential; [`Map::of`] a traction has one that diverges about zero).
    pub colors: ColorScale,
    /// The colour of cells without a value (default: white).
    pub blank: Color,
    cells: [usize; 2],
    lengths: [f64; 2],
    /// The point in the middle.
    pub(super) middle: [f64; 2],
    /// Lines from point to point, drawn over the frame.
    pub(super) lines: Vec<[(f64, f64); 2]>,
    values: Vec<f64>,
    /// Whether each cell lies inside the outline; empty without an outline.
    inside_outline: Vec<bool>,
}

debug_by! {
    self: Map =>
    title: self.title, quantity: self.quantity, axes: self.axes, range: self.range, colors: self.colors,
    blank: self.blank, cells: self.cells, lengths: self.lengths, middle: self.middle, lines: Counted(&self.lines),
    values: Counted(&self.values), inside_outline: Counted(&self.inside_outline)
}

impl Map {
    /// The map of `values`, one per cell of `grid`, x2 fastest. Cells whose value is not finite stay blank.
    ///
    /// # Errors
    /// If there is not one value per cell, or a finite one is beyond ±1e100.
    pub fn new(grid: &Grid, values: Vec<f64>, quantity: impl Into<Quantity>) -> Result<Map> {
        exact_length("values of a map", values.len(), grid.len())?;
        let [low, high] = extremes(&values);
        if low <= high {
            [low, high].into_iter().try_for_each(|end| drawable("value of a map", end).map(drop))?;
        }
        // a uniform or empty field still needs a scale
        let range = match low.partial_cmp(&high) {
            Some(std::cmp::Ordering::Less) => [low, high],
            Some(std::cmp::Ordering::Equal) if low != 0.0 => [low.min(0.0), low.max(0.0)],
            _ => [0.0, 1.0],
        };
        Ok(Map {
            title: String::new(),
            quantity: quantity.into(),
            axes: [Quantity::new("x1", "m"), Quantity::new("x2", "m")],
            range,
            colors: ColorScale::default(),
            blank: Color::WHITE,
            cells: grid.cells(),
            lengths: grid.lengths(),
            middle: [0.0; 2],
            lines: Vec::new(),
            values,
            inside_outline: Vec::new(),
        })
    }

    /// The values, one per cell.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Outlines the cells for which `inside` holds, such as those in contact.
    ///
    /// # Errors
    /// If there is not one entry per cell.
    pub fn outline(mut self, inside: Vec<bool>) -> Result<Map> {
        exact_length("cells of an outline", inside.len(), self.values.len())?;
        self.inside_outline = inside;
        Ok(self)
    }

    /// Draws the map and writes it to a file as [`Picture::save`].
    ///
    /// # Errors
    /// As [`Map::draw`] and [`Picture::save`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.draw()?.save(path)
    }

    /// Draws the map, to scale unless one side is more than about twenty times as long as the other.
    ///
    /// # Errors
    /// If the ends of the colour scale are not increasing, or beyond ±1e100.
    pub fn draw(&self) -> Result<Picture> {
        Map::draw_row(std::slice::from_ref(self))
    }

    /// Draws maps side by side, with one colour bar if all have the same quantity and scale, otherwise with one each.
    ///
    /// # Errors
    /// If there are none, the ends of a colour scale are not increasing or beyond ±1e100, or the row is wider than
    /// 16384 pixels.
    pub fn draw_row(maps: &[Map]) -> Result<Picture> {
        least_length("maps of a row", maps.len(), 1)?;
        maps.iter().try_for_each(|map| color_scale(map.range))?;
        let last = &maps[maps.len() - 1];
        let scale = |map: &Map| (map.range, map.quantity.clone(), map.colors);
        let shared = maps.iter().all(|map| scale(map) == scale(last));
        // several maps are drawn smaller
        let longest = if maps.len() == 1 { 730.0 } else { 460.0 };
        let size_of = |map: &Map| {
            let longer = map.lengths[0].max(map.lengths[1]);
            map.lengths.map(|length| ((length / longer * longest).round() as u32).max(SIZES.least_map))
        };
        let tallest = maps.iter().map(|map| size_of(map)[1]).max().unwrap_or(SIZES.least_map);
        let draw = |(k, map): (usize, &Map)| {
            let [width, height] = size_of(map);
            let bar = if !shared || k + 1 == maps.len() { SIZES.beside_bar } else { 0 };
            let side = SIZES.map_left + width + SIZES.map_right;
            let mut canvas =
                Canvas::new([side + bar, tallest.max(SIZES.least_bar) + (SIZES.map_top + SIZES.below) as u32])?;
            map.draw_on(&mut canvas, [width, height].map(f64::from));
            if bar > 0 {
                let of = if shared { maps } else { &maps[k..=k] };
                let [low, high] = extremes(of.iter().flat_map(|map| &map.values));
                let beyond = [low < map.range[0], high > map.range[1]];
                let bottom = SIZES.map_top + f64::from(if shared { tallest } else { height }.max(SIZES.least_bar));
                let greatest = map.range[0].abs().max(map.range[1].abs());
                let room = Room { length: bottom - SIZES.map_top, horizontal: false };
                let axis = DrawnAxis::linear(&map.quantity, greatest, map.range, room);
                let color = |at: f64| map.colors.color(map.range[0] + at * (map.range[1] - map.range[0]), map.range);
                color_bar::draw(&mut canvas, f64::from(side), [SIZES.map_top, bottom], &axis, color, beyond);
            }
            Ok(Picture::new(canvas))
        };
        let pictures: Result<Vec<Picture>> = maps.iter().enumerate().map(draw).collect();
        Picture::beside(&pictures?)
    }

    /// Draws the map with its axes.
    fn draw_on(&self, canvas: &mut Canvas, size: [f64; 2]) {
        let [width, height] = size;
        let half = self.lengths.map(|length| 0.5 * length);
        let axis = |k: usize, length: f64| {
            let [low, high] = [-half[k], half[k]].map(|end| self.middle[k] + end);
            DrawnAxis::linear(
                &self.axes[k],
                low.abs().max(high.abs()),
                [low, high],
                Room { length, horizontal: k == 0 },
            )
        };
        let left = f64::from(SIZES.map_left);
        let axes = [axis(0, width), axis(1, height)];
        let frame = Frame { left, top: SIZES.map_top, right: left + width, bottom: SIZES.map_top + height, axes };
        canvas.cells([left, SIZES.map_top, left + width, SIZES.map_top + height], self.cells[0], &self.colors());
        let placed = |lines: &[[(f64, f64); 2]]| -> Vec<_> {
            lines.iter().map(|ends| ends.map(|(x, y)| frame.at(x, y)).to_vec()).collect()
        };
        let outline = placed(&self.edges(half));
        // black alone would vanish on the dark end of the scale
        canvas.lines(&outline, 5.0, Color::WHITE);
        canvas.lines(&outline, 2.0, Color::BLACK);
        frame.draw(canvas, &self.title);
        canvas.lines(&placed(&self.lines), SIZES.mark, Color::BLACK);
    }

    /// The colours of the cells, top row first.
    fn colors(&self) -> Vec<Color> {
        let [n1, n2] = self.cells;
        let color = |value: f64| {
            let known = value.is_finite();
            if known { self.colors.color(value, self.range) } else { self.blank }
        };
        let rows = (0..n2).rev().flat_map(|j| (0..n1).map(move |i| i * n2 + j));
        rows.map(|cell| color(self.values[cell])).collect()
    }

    /// The outline on axes from −`half` to `half`: the sides between cells inside and outside, collinear ones joined.
    fn edges(&self, half: [f64; 2]) -> Vec<[(f64, f64); 2]> {
        if self.inside_outline.is_empty() {
            return Vec::new();
        }
        let [n1, n2] = self.cells;
        let x = |i: usize| self.middle[0] + half[0] * (2.0 * i as f64 / n1 as f64 - 1.0);
        let y = |j: usize| self.middle[1] + half[1] * (2.0 * j as f64 / n2 as f64 - 1.0);
        let inside = |i: usize, j: usize| self.inside_outline[i * n2 + j];
        let mut edges = Vec::new();
        for i in 1..n1 {
            for (from, to) in runs(n2, |j| inside(i - 1, j) != inside(i, j)) {
                edges.push([(x(i), y(from)), (x(i), y(to))]);
            }
        }
        for j in 1..n2 {
            for (from, to) in runs(n1, |i| inside(i, j - 1) != inside(i, j)) {
                edges.push([(x(from), y(j)), (x(to), y(j))]);
            }
        }
        edges
    }
}

/// The smallest and the largest finite value; +∞ and −∞ if there is none.
pub(super) fn extremes<'a>(values: impl IntoIterator<Item = &'a f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(*value), high.max(*value)])
}

/// The half-open ranges of indices below `n` for which `holds`.
pub(super) fn runs(n: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in (0..n).filter(|&k| holds(k)) {
        match found.last_mut() {
            Some(last) if last.1 == k => last.1 = k + 1,
            _ => found.push((k, k + 1)),
        }
    }
    found
}
