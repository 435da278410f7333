//! Line charts as PNG files, with a font of their own: no system library is needed.
#![allow(dead_code, reason = "each example takes what it needs")]

use std::error::Error;
use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
pub use plotters::prelude::{SeriesLabelPosition, WHITE};
use plotters::style::register_font;

/// Okabe & Ito's palette, told apart by colour-blind readers.
pub const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

const FONT: &str = "viscocontact";
const SIZE: (u32, u32) = (1200, 800);

/// Which axes are logarithmic.
#[derive(Clone, Copy, PartialEq)]
pub enum Scale {
    Linear,
    LogX,
    LogLog,
}

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Style {
    Line,
    Dots,
    LineAndDots,
}

pub struct Series {
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub color: RGBColor,
    pub style: Style,
}

pub struct Chart {
    pub title: String,
    pub x: String,
    pub y: String,
    pub scale: Scale,
    /// Where the legend leaves the curves free.
    pub legend: SeriesLabelPosition,
    pub series: Vec<Series>,
}

impl Chart {
    pub fn new(title: &str, x: &str, y: &str, legend: SeriesLabelPosition) -> Chart {
        Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Linear, legend, series: Vec::new() }
    }

    pub fn add(&mut self, label: impl Into<String>, color: RGBColor, style: Style, points: Vec<(f64, f64)>) {
        self.series.push(Series { label: label.into(), points, color, style });
    }

    /// Writes the chart to a PNG file.
    pub fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        register();
        let root = BitMapBackend::new(path, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut builder = ChartBuilder::on(&root);
        builder
            .caption(&self.title, (FONT, 30))
            .margin(20)
            .margin_right(40)
            .x_label_area_size(65)
            .y_label_area_size(95);
        let log_x = self.scale != Scale::Linear;
        let [x0, x1] = self.range(log_x, |point| point.0);
        let [y0, y1] = self.range(self.scale == Scale::LogLog, |point| point.1);
        let power = |v: &f64| if (0.01..1e4).contains(v) { plain(v) } else { format!("{v:.0e}") };
        match self.scale {
            Scale::Linear => self.draw(&mut builder.build_cartesian_2d(x0..x1, y0..y1)?, &plain, &plain)?,
            Scale::LogX => self.draw(&mut builder.build_cartesian_2d((x0..x1).log_scale(), y0..y1)?, &power, &plain)?,
            Scale::LogLog => {
                let mut chart = builder.build_cartesian_2d((x0..x1).log_scale(), (y0..y1).log_scale())?;
                self.draw(&mut chart, &power, &power)?;
            }
        }
        root.present()?;
        Ok(())
    }

    /// The extent of a coordinate over all series, with some room.
    fn range(&self, logarithmic: bool, of: impl Fn(&(f64, f64)) -> f64) -> [f64; 2] {
        let values = || self.series.iter().flat_map(|series| &series.points).map(&of).filter(|v| v.is_finite());
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if logarithmic {
            [low / 1.5, high * 1.5]
        } else {
            let room = 0.04 * (high - low).max(f64::MIN_POSITIVE);
            [if low == 0.0 { 0.0 } else { low - room }, high + room]
        }
    }

    fn draw<'a, X, Y>(
        &self,
        chart: &mut ChartContext<'a, BitMapBackend<'a>, Cartesian2d<X, Y>>,
        x_label: &dyn Fn(&f64) -> String,
        y_label: &dyn Fn(&f64) -> String,
    ) -> Result<(), Box<dyn Error>>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .axis_desc_style((FONT, 26))
            .label_style((FONT, 22))
            .x_label_formatter(x_label)
            .y_label_formatter(y_label)
            .light_line_style(RGBColor(240, 240, 240))
            .bold_line_style(RGBColor(215, 215, 215))
            .draw()?;
        for series in &self.series {
            let color = series.color;
            let line = series.style != Style::Dots;
            if line {
                let drawn = chart.draw_series(LineSeries::new(series.points.iter().copied(), color.stroke_width(3)))?;
                if !series.label.is_empty() {
                    drawn
                        .label(&series.label)
                        .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 28, y)], color.stroke_width(3)));
                }
            }
            if series.style != Style::Line {
                let dots = series.points.iter().map(|&point| Circle::new(point, 5, color.filled()));
                let drawn = chart.draw_series(dots)?;
                if !line && !series.label.is_empty() {
                    drawn.label(&series.label).legend(move |(x, y)| Circle::new((x + 14, y), 5, color.filled()));
                }
            }
        }
        if self.series.iter().all(|series| series.label.is_empty()) {
            return Ok(());
        }
        chart
            .configure_series_labels()
            .position(self.legend.clone())
            .label_font((FONT, 22))
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(180, 180, 180))
            .draw()?;
        Ok(())
    }
}

/// A number as short as it is.
fn plain(v: &f64) -> String {
    format!("{}", (v * 1e6).round() / 1e6 + 0.0) // no minus before a zero
}

/// Makes the font known to plotters, once.
fn register() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let known = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
        assert!(known.is_ok(), "the font that is compiled in is a font");
    });
}

/// A field on a grid as colours.
pub struct Map {
    pub title: String,
    /// What the colour bar shows.
    pub unit: String,
    /// The axes, with their unit.
    pub axes: [String; 2],
    pub cells: [usize; 2],
    /// Sides of the grid, in the unit of the axes.
    pub lengths: [f64; 2],
    /// Ends of the colour scale.
    pub range: [f64; 2],
    /// One value a cell, x2 fastest; NaN for cells that stay blank.
    pub values: Vec<f64>,
    /// The colour of those.
    pub blank: RGBColor,
}

/// For cells where nothing is known.
pub const GREY: RGBColor = RGBColor(190, 190, 190);
/// Width of the space for the numbers beside a map, and of its colour bar with its numbers, in pixels.
const SIDE: u32 = 110;
const BAR: u32 = 170;
/// Height of the space for the title above a map and the numbers below.
const ENDS: u32 = 130;

impl Map {
    /// Writes the map to a PNG file.
    pub fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        Map::save_row(std::slice::from_ref(self), path)
    }

    /// Writes maps of like sides next to each other to a PNG file: with one colour bar if their scales are the same, else
    /// with one each.
    pub fn save_row(maps: &[Map], path: &Path) -> Result<(), Box<dyn Error>> {
        register();
        let last = maps.last().ok_or("no map to draw")?;
        // a map as large as legible; several are smaller
        let side = if maps.len() == 1 { 730.0 } else { 460.0 };
        let scale = side / last.lengths[0].max(last.lengths[1]);
        let [wide, high] = last.lengths.map(|length| (length * scale).round() as u32);
        let shared = maps.iter().all(|map| map.range == last.range);
        let bars = if shared { 1 } else { maps.len() as u32 };
        let width = maps.len() as u32 * (wide + SIDE) + bars * BAR;
        let root = BitMapBackend::new(path, (width, high + ENDS)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut rest = root.clone();
        for (k, map) in maps.iter().enumerate() {
            let (area, right) = rest.split_horizontally(wide + SIDE);
            map.draw(&area, if maps.len() == 1 { 28 } else { 24 })?;
            rest = right;
            if !shared || k + 1 == maps.len() {
                let (area, right) = rest.split_horizontally(BAR);
                map.draw_bar(&area)?;
                rest = right;
            }
        }
        root.present()?;
        Ok(())
    }

    fn draw(&self, area: &DrawingArea<BitMapBackend, Shift>, font: u32) -> Result<(), Box<dyn Error>> {
        let [h1, h2] = self.lengths.map(|length| 0.5 * length);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, font))
            .margin(15)
            .x_label_area_size(60)
            .y_label_area_size(80)
            .build_cartesian_2d(-h1..h1, -h2..h2)?;
        // numbers would run into each other on a small map
        let labels = if font > 24 { 10 } else { 5 };
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(labels)
            .y_labels(labels)
            .x_desc(&self.axes[0])
            .y_desc(&self.axes[1])
            .x_label_formatter(&plain)
            .y_label_formatter(&plain)
            .label_style((FONT, 22))
            .axis_desc_style((FONT, 26))
            .draw()?;
        if self.blank != WHITE {
            chart.draw_series([Rectangle::new([(-h1, -h2), (h1, h2)], self.blank.filled())])?;
        }
        let [n1, n2] = self.cells;
        let [d1, d2] = [self.lengths[0] / n1 as f64, self.lengths[1] / n2 as f64];
        let [least, most] = self.range;
        chart.draw_series(self.values.iter().enumerate().filter(|(_, v)| !v.is_nan()).map(|(k, &v)| {
            let (x, y) = (-h1 + (k / n2) as f64 * d1, -h2 + (k % n2) as f64 * d2);
            Rectangle::new([(x, y), (x + d1, y + d2)], color((v - least) / (most - least)).filled())
        }))?;
        chart.draw_series([Rectangle::new([(-h1, -h2), (h1, h2)], BLACK.stroke_width(1))])?;
        Ok(())
    }

    fn draw_bar(&self, area: &DrawingArea<BitMapBackend, Shift>) -> Result<(), Box<dyn Error>> {
        let [least, most] = self.range;
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
            .y_desc(&self.unit)
            .axis_desc_style((FONT, 24))
            .label_style((FONT, 22))
            .y_label_formatter(&plain)
            .draw()?;
        bar.draw_series((0..100).map(|k| {
            let low = least + f64::from(k) * step;
            Rectangle::new([(0.0, low), (1.0, low + step)], color(0.01 * f64::from(k)).filled())
        }))?;
        Ok(())
    }
}

/// Light to dark, even in brightness and legible without colour vision: straight lines through points of the
/// viridis scale, reversed.
fn color(value: f64) -> RGBColor {
    const POINTS: [[f64; 3]; 5] =
        [[253.0, 231.0, 37.0], [94.0, 201.0, 98.0], [33.0, 145.0, 140.0], [59.0, 82.0, 139.0], [68.0, 1.0, 84.0]];
    let position = value.clamp(0.0, 1.0) * 4.0;
    let k = (position as usize).min(3);
    let mix = |m: usize| (POINTS[k][m] + (position - k as f64) * (POINTS[k + 1][m] - POINTS[k][m])).round() as u8;
    RGBColor(mix(0), mix(1), mix(2))
}
