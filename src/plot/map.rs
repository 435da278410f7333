//! Colour maps of fields.

use std::path::Path;

use plotters::element::BitMapElement;
use plotters::prelude::*;
use plotters::style::Color as _;

use crate::Grid;
use crate::error::{Result, exact_length, least_length};
use crate::plot::picture::{Area, DrawingError, FONT};
use crate::plot::quantity::{color_scale, drawable, numbers};
use crate::plot::{Color, Picture, Quantity};

/// Width of the tick labels beside a map in pixels.
const LABEL_WIDTH: u32 = 110;
/// Width of a colour bar with its labels in pixels.
const BAR_WIDTH: u32 = 170;
/// Height of the title above a map and the tick labels below in pixels.
const TITLE_AND_LABEL_HEIGHT: u32 = 130;
/// Least side of a map in pixels: very long maps are not drawn to scale.
const MIN_SIDE: u32 = 40;

/// A field on a grid as colours, light for small values and dark for large ones.
///
/// [`Map::pressure`], [`Map::gap`] and [`Map::displacement`] are the maps of a contact.
///
/// ```
/// use viscocontact::{Grid, plot::{Map, Quantity}};
///
/// let grid = Grid::new([2, 3], [2.0e-3, 3.0e-3])?;
/// let mut map = Map::new(&grid, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], Quantity::of("height", "m"))?;
/// map.title = "Stairs".into();
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-map-{}.png", std::process::id()));
/// map.save(&path)?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Map {
    /// The title above the map.
    pub title: String,
    /// The quantity of the colour bar.
    pub quantity: Quantity,
    /// The axes (default: x1 and x2 in metres, shown with a suitable prefix).
    pub axes: [Quantity; 2],
    /// Ends of the colour scale, in the unit of the values (default: the least and the greatest finite value). Values
    /// outside have the colour of the nearer end.
    pub range: [f64; 2],
    /// The colour of cells without a value (default: white).
    pub blank: Color,
    cells: [usize; 2],
    lengths: [f64; 2],
    values: Vec<f64>,
    /// Whether each cell lies inside the outline; empty without an outline.
    inside_outline: Vec<bool>,
}

impl Map {
    /// The map of `values`, one per cell of `grid`, x2 fastest. Cells whose value is not finite stay blank.
    ///
    /// # Errors
    /// If there is not one value per cell, or a finite one is beyond ±1e100.
    pub fn new(grid: &Grid, values: Vec<f64>, quantity: impl Into<Quantity>) -> Result<Map> {
        exact_length("values of a map", values.len(), grid.len())?;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &value in values.iter().filter(|value| value.is_finite()) {
            drawable("value of a map", value)?;
            (low, high) = (low.min(value), high.max(value));
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
            axes: [Quantity::of("x1", "m"), Quantity::of("x2", "m")],
            range,
            blank: Color::WHITE,
            cells: grid.cells(),
            lengths: grid.lengths(),
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

    /// Draws the map and writes it to a PNG file, replacing an existing one.
    ///
    /// # Errors
    /// As [`Map::draw`], or if the file cannot be written.
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

    /// Draws maps side by side as [`Map::draw_row`] and writes them to a PNG file, replacing an existing one.
    ///
    /// # Errors
    /// As [`Map::draw_row`], or if the file cannot be written.
    pub fn save_row(maps: &[Map], path: impl AsRef<Path>) -> Result<()> {
        Map::draw_row(maps)?.save(path)
    }

    /// Draws maps side by side, with one colour bar if all have the same quantity and scale, otherwise with one each.
    ///
    /// # Errors
    /// If there are none, the ends of a colour scale are not increasing or beyond ±1e100, or the row is wider than
    /// 16384 pixels.
    pub fn draw_row(maps: &[Map]) -> Result<Picture> {
        least_length("maps of a row", maps.len(), 1)?;
        maps.iter().try_for_each(|map| color_scale(map.range))?;
        let (last, alone) = (&maps[maps.len() - 1], maps.len() == 1);
        // several maps are drawn smaller
        let longest = if alone { 730.0 } else { 460.0 };
        let shared = maps.iter().all(|map| map.range == last.range && map.quantity == last.quantity);
        let sizes: Vec<[u32; 2]> = maps
            .iter()
            .map(|map| {
                let longer = map.lengths[0].max(map.lengths[1]);
                map.lengths.map(|length| ((length / longer * longest).round() as u32).max(MIN_SIDE))
            })
            .collect();
        let has_bar = |k: usize| !shared || k + 1 == maps.len();
        let widths =
            sizes.iter().enumerate().map(|(k, size)| size[0] + LABEL_WIDTH + if has_bar(k) { BAR_WIDTH } else { 0 });
        let width = widths.fold(0_u32, u32::saturating_add);
        let height = sizes.iter().map(|size| size[1]).max().unwrap_or(MIN_SIDE).max(if alone { 300 } else { 200 });
        Picture::new([width, height + TITLE_AND_LABEL_HEIGHT], |root| {
            let mut rest = root.clone();
            for (k, map) in maps.iter().enumerate() {
                let (area, right) = rest.split_horizontally(sizes[k][0] + LABEL_WIDTH);
                let (area, _) = area.split_vertically(sizes[k][1] + TITLE_AND_LABEL_HEIGHT);
                map.draw_on(&area, alone)?;
                rest = right;
                if has_bar(k) {
                    let (area, right) = rest.split_horizontally(BAR_WIDTH);
                    map.draw_bar(&area)?;
                    rest = right;
                }
            }
            Ok(())
        })
    }

    fn draw_on(&self, area: &Area, alone: bool) -> Result<(), DrawingError> {
        let shown = [0, 1].map(|axis| {
            let half = 0.5 * self.lengths[axis];
            let (label, factor) = self.axes[axis].shown(half);
            (label, half * factor)
        });
        let [h1, h2] = [shown[0].1, shown[1].1];
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, if alone { 28 } else { 24 }))
            .margin(15)
            .x_label_area_size(60)
            .y_label_area_size(80)
            .build_cartesian_2d(-h1..h1, -h2..h2)?;
        // more labels would overlap on a small map
        let labels = if alone { 10 } else { 5 };
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(labels)
            .y_labels(labels)
            .x_desc(&shown[0].0)
            .y_desc(&shown[1].0)
            .x_label_formatter(&numbers([-h1, h1]))
            .y_label_formatter(&numbers([-h2, h2]))
            .label_style((FONT, 22))
            .axis_desc_style((FONT, 26))
            .draw()?;
        let (across, down) = chart.plotting_area().get_pixel_range();
        let size = [across.len() as u32, down.len() as u32];
        if let Some(pixels) = BitMapElement::<_>::with_owned_buffer((-h1, h2), (size[0], size[1]), self.pixels(size)) {
            chart.draw_series([pixels])?;
        }
        for line in self.edges([h1, h2]) {
            chart.draw_series([PathElement::new(line.to_vec(), BLACK.stroke_width(2))])?;
        }
        chart.draw_series([Rectangle::new([(-h1, -h2), (h1, h2)], BLACK.stroke_width(1))])?;
        Ok(())
    }

    /// The colours of `size` pixels, top row first.
    fn pixels(&self, size: [u32; 2]) -> Vec<u8> {
        let [least, most] = self.range;
        let [n1, n2] = self.cells;
        // the cell at the centre of a pixel
        let cell = |pixel: u32, pixels: u32, cells: usize| {
            (((f64::from(pixel) + 0.5) / f64::from(pixels) * cells as f64) as usize).min(cells - 1)
        };
        let mut rgb = Vec::with_capacity(3 * size[0] as usize * size[1] as usize);
        for row in (0..size[1]).rev() {
            let j = cell(row, size[1], n2);
            for column in 0..size[0] {
                let value = self.values[cell(column, size[0], n1) * n2 + j];
                let known = value.is_finite();
                let color = if known { Color::on_scale((value - least) / (most - least)) } else { self.blank };
                rgb.extend([color.0, color.1, color.2]);
            }
        }
        rgb
    }

    /// The outline on axes from −`half` to `half`: the sides between cells inside and outside, collinear ones joined.
    fn edges(&self, half: [f64; 2]) -> Vec<[(f64, f64); 2]> {
        if self.inside_outline.is_empty() {
            return Vec::new();
        }
        let [n1, n2] = self.cells;
        let x = |i: usize| half[0] * (2.0 * i as f64 / n1 as f64 - 1.0);
        let y = |j: usize| half[1] * (2.0 * j as f64 / n2 as f64 - 1.0);
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

    fn draw_bar(&self, area: &Area) -> Result<(), DrawingError> {
        let (label, factor) = self.quantity.shown(self.range[0].abs().max(self.range[1].abs()));
        let [least, most] = self.range.map(|end| end * factor);
        let step = 0.01 * (most - least);
        let mut bar = ChartBuilder::on(area)
            .margin(15)
            .margin_top(50)
            .margin_right(20)
            .x_label_area_size(60)
            .y_label_area_size(85)
            .build_cartesian_2d(0.0..1.0, least..most)?;
        bar.configure_mesh()
            .disable_mesh()
            .x_labels(0)
            .y_labels(6)
            .y_desc(&label)
            .axis_desc_style((FONT, 24))
            .label_style((FONT, 22))
            .y_label_formatter(&numbers([least, most]))
            .draw()?;
        bar.draw_series((0..100).map(|k| {
            let low = least + f64::from(k) * step;
            let color = Color::on_scale(0.01 * f64::from(k)).rgb();
            Rectangle::new([(0.0, low), (1.0, low + step)], color.filled())
        }))?;
        Ok(())
    }
}

/// The half-open ranges of indices below `n` for which `holds`.
fn runs(n: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in (0..n).filter(|&k| holds(k)) {
        match found.last_mut() {
            Some(last) if last.1 == k => last.1 = k + 1,
            _ => found.push((k, k + 1)),
        }
    }
    found
}
