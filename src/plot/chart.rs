//! Line charts.

use std::path::Path;

use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::Color as _;

use crate::error::{Error, Result};
use crate::plot::picture::{DrawingError, FONT};
use crate::plot::quantity::{drawable, drawable_as_power, numbers, powers};
use crate::plot::{Color, Picture, Quantity};

/// Width and height of a chart in pixels.
const SIZE: [u32; 2] = [1200, 800];

/// Which axes of a chart are logarithmic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::exhaustive_enums, reason = "there are two axes")]
pub enum Scale {
    /// Neither.
    #[default]
    Linear,
    /// The horizontal axis.
    LogX,
    /// The vertical axis.
    LogY,
    /// Both.
    LogLog,
}

impl Scale {
    /// Whether the horizontal and the vertical axis are logarithmic.
    fn is_logarithmic(self) -> [bool; 2] {
        [matches!(self, Scale::LogX | Scale::LogLog), matches!(self, Scale::LogY | Scale::LogLog)]
    }
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Style {
    /// A line through its points.
    Line,
    /// A dot at each point.
    Dots,
    /// Both.
    LineAndDots,
}

/// Position of the legend in a chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are self-explanatory")]
#[expect(clippy::exhaustive_enums, reason = "there are nine positions")]
pub enum Legend {
    UpperLeft,
    UpperMiddle,
    UpperRight,
    MiddleLeft,
    MiddleMiddle,
    MiddleRight,
    LowerLeft,
    LowerMiddle,
    LowerRight,
}

#[derive(Debug, Clone, PartialEq)]
struct Curve {
    label: String,
    points: Vec<(f64, f64)>,
    color: Color,
    style: Style,
}

/// A chart of curves over two axes.
///
/// Points with a coordinate that is not finite, or not positive on a logarithmic axis, are left out and interrupt the
/// line.
///
/// ```
/// use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
///
/// let mut chart =
///     Chart::new("Creep", Quantity::of("time", "s"), Quantity::of("approach", "m"), Legend::LowerRight);
/// chart.add("ball", COLORS[0], Style::Line, (0..50).map(|k| (f64::from(k), 1e-5 * f64::from(k).sqrt())).collect());
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-chart-{}.png", std::process::id()));
/// chart.save(&path)?; // the vertical axis is in µm
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Chart {
    /// The title above the chart.
    pub title: String,
    /// The horizontal axis.
    pub x: Quantity,
    /// The vertical axis.
    pub y: Quantity,
    /// Which axes are logarithmic (default: none).
    pub scale: Scale,
    /// Position of the legend.
    pub legend: Legend,
    curves: Vec<Curve>,
}

/// An axis as drawn: its label, the factor from SI to its unit, and its ends and the format of numbers in that unit.
struct ScaledAxis {
    label: String,
    factor: f64,
    ends: [f64; 2],
    format: Box<dyn Fn(&f64) -> String>,
}

impl Chart {
    /// A chart without curves.
    pub fn new(title: impl Into<String>, x: impl Into<Quantity>, y: impl Into<Quantity>, legend: Legend) -> Chart {
        let (title, x, y) = (title.into(), x.into(), y.into());
        Chart { title, x, y, scale: Scale::Linear, legend, curves: Vec::new() }
    }

    /// Adds a curve through `points`, in the units of the quantities of the axes. With an empty label it is not in the
    /// legend.
    pub fn add(&mut self, label: impl Into<String>, color: Color, style: Style, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { label: label.into(), points, color, style });
    }

    /// Draws the chart and writes it to a PNG file, replacing an existing one.
    ///
    /// # Errors
    /// As [`Chart::draw`], or if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.draw()?.save(path)
    }

    /// Draws the chart.
    ///
    /// # Errors
    /// If there is no point to draw, or a coordinate exceeds 1e100 in magnitude (or, on a logarithmic axis, is below
    /// 1e-100).
    pub fn draw(&self) -> Result<Picture> {
        let axes = [self.scaled(0)?, self.scaled(1)?];
        Picture::new(SIZE, |root| {
            let mut builder = ChartBuilder::on(root);
            builder
                .caption(&self.title, (FONT, 30))
                .margin(20)
                .margin_right(40)
                .x_label_area_size(65)
                .y_label_area_size(95);
            let [across, up] = axes.each_ref().map(|axis| axis.ends[0]..axis.ends[1]);
            match self.scale {
                Scale::Linear => self.fill(builder.build_cartesian_2d(across, up)?, &axes),
                Scale::LogX => self.fill(builder.build_cartesian_2d(across.log_scale(), up)?, &axes),
                Scale::LogY => self.fill(builder.build_cartesian_2d(across, up.log_scale())?, &axes),
                Scale::LogLog => self.fill(builder.build_cartesian_2d(across.log_scale(), up.log_scale())?, &axes),
            }
        })
    }

    /// The uninterrupted runs of points that can be drawn.
    fn pieces<'a>(&'a self, curve: &'a Curve) -> impl Iterator<Item = &'a [(f64, f64)]> {
        let logarithmic = self.scale.is_logarithmic();
        let drawn = move |value: f64, log: bool| value.is_finite() && (!log || value > 0.0);
        let both = move |&(x, y): &(f64, f64)| drawn(x, logarithmic[0]) && drawn(y, logarithmic[1]);
        curve.points.split(move |point| !both(point)).filter(|piece| !piece.is_empty())
    }

    /// The axis that contains all points, with a margin.
    fn scaled(&self, axis: usize) -> Result<ScaledAxis> {
        let (field, quantity) = [("x of a point in a chart", &self.x), ("y of a point in a chart", &self.y)][axis];
        let logarithmic = self.scale.is_logarithmic()[axis];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in self.curves.iter().flat_map(|curve| self.pieces(curve)).flatten() {
            let value = [point.0, point.1][axis];
            let value = if logarithmic { drawable_as_power(field, value) } else { drawable(field, value) }?;
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            let field = "points to draw in the chart";
            return Err(Error::WrongLength { field, len: 0, expected: 1, exact: false });
        }
        let (label, factor) = quantity.shown(low.abs().max(high.abs()));
        let [low, high] = [low * factor, high * factor];
        let ends = if logarithmic && high < 10.0 * low {
            // whole decades and a little more: otherwise no tick would have a number
            [0.99 * 10_f64.powf((low / 1.1).log10().floor()), 1.01 * 10_f64.powf((high * 1.1).log10().ceil())]
        } else if logarithmic {
            [low / 1.5, high * 1.5]
        } else {
            // values that are all equal get a range around them
            let span = (high - low).max(1e-9 * high.abs().max(low.abs()));
            let margin = 0.04 * if span > 0.0 { span } else { 1.0 };
            [if low == 0.0 { 0.0 } else { low - margin }, high + margin]
        };
        let format: Box<dyn Fn(&f64) -> String> = if logarithmic { Box::new(powers) } else { Box::new(numbers(ends)) };
        Ok(ScaledAxis { label, factor, ends, format })
    }

    fn fill<'a, X, Y>(
        &self,
        mut chart: ChartContext<'a, BitMapBackend<'a>, Cartesian2d<X, Y>>,
        [x, y]: &[ScaledAxis; 2],
    ) -> Result<(), DrawingError>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .x_desc(&x.label)
            .y_desc(&y.label)
            .axis_desc_style((FONT, 26))
            .label_style((FONT, 22))
            .x_label_formatter(&*x.format)
            .y_label_formatter(&*y.format)
            .light_line_style(RGBColor(240, 240, 240))
            .bold_line_style(RGBColor(215, 215, 215))
            .draw()?;
        for curve in &self.curves {
            let color = curve.color.rgb();
            let at = |point: &(f64, f64)| (point.0 * x.factor, point.1 * y.factor);
            let mut label = Some(&curve.label).filter(|label| !label.is_empty());
            for piece in self.pieces(curve) {
                if curve.style != Style::Dots {
                    // segment by segment: plotters draws spikes where a thick line reverses direction
                    let segments = piece
                        .windows(2)
                        .map(|ends| PathElement::new(ends.iter().map(at).collect::<Vec<_>>(), color.stroke_width(3)));
                    let drawn = chart.draw_series(segments)?;
                    if let Some(label) = label.take() {
                        drawn
                            .label(label)
                            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 28, y)], color.stroke_width(3)));
                    }
                }
                if curve.style != Style::Line {
                    let dots = piece.iter().map(|point| Circle::new(at(point), 5, color.filled()));
                    let drawn = chart.draw_series(dots)?;
                    if let Some(label) = label.take() {
                        drawn.label(label).legend(move |(x, y)| Circle::new((x + 14, y), 5, color.filled()));
                    }
                }
            }
        }
        if self.curves.iter().all(|curve| curve.label.is_empty()) {
            return Ok(());
        }
        chart
            .configure_series_labels()
            .position(self.legend.position())
            .label_font((FONT, 22))
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(180, 180, 180))
            .draw()?;
        Ok(())
    }
}

impl Legend {
    fn position(self) -> SeriesLabelPosition {
        match self {
            Legend::UpperLeft => SeriesLabelPosition::UpperLeft,
            Legend::UpperMiddle => SeriesLabelPosition::UpperMiddle,
            Legend::UpperRight => SeriesLabelPosition::UpperRight,
            Legend::MiddleLeft => SeriesLabelPosition::MiddleLeft,
            Legend::MiddleMiddle => SeriesLabelPosition::MiddleMiddle,
            Legend::MiddleRight => SeriesLabelPosition::MiddleRight,
            Legend::LowerLeft => SeriesLabelPosition::LowerLeft,
            Legend::LowerMiddle => SeriesLabelPosition::LowerMiddle,
            Legend::LowerRight => SeriesLabelPosition::LowerRight,
        }
    }
}
