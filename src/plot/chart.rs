//! Line charts.

use std::path::Path;

use crate::error::{Error, Result};
use crate::plot::axis::round_step;
use crate::plot::color_bar;
use crate::plot::curve::Curve;
use crate::plot::frame::width_beside;
use crate::plot::legend::{self, points_along};
use crate::plot::map::extremes;
use crate::plot::quantity::drawable_as_power;
use crate::plot::sizes::SIZES;
use crate::plot::{Canvas, Color, DrawnAxis, Frame, Legend, Picture, Quantity, Room, Style, drawable};

/// Which axes of a chart are logarithmic. Numbers far from 1 are powers of ten there, in units without a prefix.
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

/// A chart of curves over two axes.
///
/// Points with a coordinate that is not finite, or not positive on a logarithmic axis, are left out and interrupt the
/// line. A linear axis of positive values begins at zero unless that makes it more than twice as long.
///
/// ```
/// use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
///
/// let mut chart =
///     Chart::new("Creep", Quantity::new("time", "s"), Quantity::new("approach", "m"), Legend::LowerRight);
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
    /// Preferred position of the legend.
    pub legend: Legend,
    curves: Vec<Curve>,
    bar: Option<Bar>,
}

/// The colour bar of a family of curves.
#[derive(Debug, Clone, PartialEq)]
struct Bar {
    quantity: Quantity,
    range: [f64; 2],
    logarithmic: bool,
}

/// The maximum fraction of the colour scale that curves have: its light end would vanish on white.
const LIGHTEST: f64 = 0.9;
/// The colour bar is logarithmic if the values differ by more than this factor.
const LOGARITHMIC_FROM: f64 = 30.0;

impl Chart {
    /// A chart without curves.
    pub fn new(title: impl Into<String>, x: impl Into<Quantity>, y: impl Into<Quantity>, legend: Legend) -> Chart {
        let (title, x, y) = (title.into(), x.into(), y.into());
        Chart { title, x, y, scale: Scale::Linear, legend, curves: Vec::new(), bar: None }
    }

    /// Adds a curve through `points`, in the units of the quantities of the axes. With an empty label it is not in the
    /// legend.
    pub fn add(&mut self, label: impl Into<String>, color: Color, style: Style, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { label: label.into(), points, color, style });
    }

    /// Adds curves that a parameter orders, such as a speed, each with its value in the unit of the quantity. Their
    /// colours show the value, with a colour bar beside the chart in place of a legend. The bar is logarithmic if the
    /// values are positive and differ by more than a factor of 30. A chart has the bar of its last family.
    ///
    /// ```
    /// use viscocontact::plot::{Chart, Legend, Quantity, Style};
    ///
    /// let mut chart = Chart::new("Creep", Quantity::new("time", "s"), "approach / 1 µm", Legend::LowerRight);
    /// let curve = |tau: f64| (tau, (0..50).map(|k| f64::from(k)).map(|t| (t, 1.0 - (-t / tau).exp())).collect());
    /// chart.add_family(Quantity::new("relaxation time", "s"), Style::Line, [1.0, 3.0, 10.0, 30.0].map(curve).to_vec());
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-family-{}.png", std::process::id()));
    /// chart.save(&path)?;
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn add_family(&mut self, parameter: impl Into<Quantity>, style: Style, curves: Vec<(f64, Vec<(f64, f64)>)>) {
        let range @ [low, high] = extremes(curves.iter().map(|curve| &curve.0));
        let logarithmic = low > 0.0 && high > LOGARITHMIC_FROM * low;
        let place = |value: f64| if logarithmic { value.ln() } else { value };
        for (value, points) in curves {
            let share = (place(value) - place(low)) / (place(high) - place(low));
            self.add("", Color::on_scale(LIGHTEST * share), style, points);
        }
        // a single value needs no scale
        self.bar = (low < high).then(|| Bar { quantity: parameter.into(), range, logarithmic });
    }

    /// Draws the chart and writes it to a file as [`Picture::save`].
    ///
    /// # Errors
    /// As [`Chart::draw`] and [`Picture::save`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.draw()?.save(path)
    }

    /// Draws the chart.
    ///
    /// # Errors
    /// If there is no point to draw, or a coordinate exceeds 1e100 in magnitude (or, on a logarithmic axis, is below
    /// 1e-100).
    pub fn draw(&self) -> Result<Picture> {
        let entries: Vec<_> = self.curves.iter().filter(|curve| !curve.label.is_empty()).collect();
        // the vertical axis grows until a legend hides nothing, at most to twice its length
        let mut frame = self.frame(0.0)?;
        for above in (0..=10).map(|tenths| 0.1 * f64::from(tenths)) {
            let larger = self.frame(above)?;
            if legend::covered(&entries, self.legend, &larger, &self.points(&larger)) == 0 {
                frame = larger;
                break;
            }
        }
        let mut canvas = Canvas::new(SIZES.chart)?;
        frame.draw_grid(&mut canvas);
        frame.draw(&mut canvas, &self.title); // below the curves: those at zero stay visible
        for curve in &self.curves {
            let pieces = self.placed(curve, &frame);
            curve.style.draw(&mut canvas, &pieces, &pieces.concat(), curve.color);
        }
        legend::draw(&mut canvas, &entries, self.legend, &frame, &self.points(&frame));
        if let Some(bar) = &self.bar {
            let color = |at: f64| Color::on_scale(LIGHTEST * at);
            let axis = bar.axis(frame.bottom - SIZES.chart_top)?;
            color_bar::draw(&mut canvas, frame.right, [SIZES.chart_top, frame.bottom], &axis, color, [false; 2]);
        }
        Ok(Picture::new(canvas))
    }

    /// The axes around all points, the vertical one longer by the share `above` of the height of the points.
    fn frame(&self, above: f64) -> Result<Frame> {
        let [width, height] = SIZES.chart.map(f64::from);
        let bar = self.bar.as_ref().map_or(0.0, |_| f64::from(SIZES.beside_bar));
        let [right, bottom] = [width - SIZES.chart_right.max(bar), height - SIZES.below];
        let horizontal = |left: f64| self.axis(0, Room { length: right - left, horizontal: true }, 0.0);
        horizontal(SIZES.chart_left)?; // names a wrong x before a wrong y
        let y = self.axis(1, Room { length: bottom - SIZES.chart_top, horizontal: false }, above)?;
        // the horizontal axis is as long as the numbers of the vertical one leave
        let left = width_beside(&y).max(SIZES.chart_left);
        Ok(Frame { left, top: SIZES.chart_top, right, bottom, axes: [horizontal(left)?, y] })
    }

    /// The pieces of a curve in pixels.
    fn placed(&self, curve: &Curve, frame: &Frame) -> Vec<Vec<[f64; 2]>> {
        self.pieces(curve).map(|piece| piece.iter().map(|&(x, y)| frame.at(x, y)).collect()).collect()
    }

    /// Points in pixels that a legend should not cover: points of the curves, and points between them along lines.
    fn points(&self, frame: &Frame) -> Vec<[f64; 2]> {
        let of = |curve: &Curve| -> Vec<[f64; 2]> {
            let pieces = self.placed(curve, frame);
            let between = pieces.iter().filter(|_| curve.style != Style::Dots).flat_map(|piece| points_along(piece));
            between.chain(pieces.iter().flatten().copied()).collect()
        };
        self.curves.iter().flat_map(of).collect()
    }

    /// The uninterrupted runs of points that can be drawn.
    fn pieces<'a>(&'a self, curve: &'a Curve) -> impl Iterator<Item = &'a [(f64, f64)]> {
        let logarithmic = self.scale.is_logarithmic();
        let drawn = move |value: f64, log: bool| value.is_finite() && (!log || value > 0.0);
        let both = move |&(x, y): &(f64, f64)| drawn(x, logarithmic[0]) && drawn(y, logarithmic[1]);
        curve.points.split(move |point| !both(point)).filter(|piece| !piece.is_empty())
    }

    /// The axis that contains all points, with a margin, and longer by the share `above` at its upper end.
    fn axis(&self, axis: usize, room: Room, above: f64) -> Result<DrawnAxis> {
        let (field, quantity) = [("x of a point in a chart", &self.x), ("y of a point in a chart", &self.y)][axis];
        let logarithmic = self.scale.is_logarithmic()[axis];
        let points = self.curves.iter().flat_map(|curve| self.pieces(curve)).flatten();
        let [low, high] = extremes(points.map(|point| if axis == 0 { &point.0 } else { &point.1 }));
        if low > high {
            let field = "points to draw in the chart";
            return Err(Error::WrongLength { field, len: 0, expected: 1, exact: false });
        }
        let check = if logarithmic { drawable_as_power } else { drawable };
        let (low, high) = (check(field, low)?, check(field, high)?);
        if logarithmic {
            let [low, high] = if high < 10.0 * low {
                // from number to number, which else might lie outside
                [0.99 / round_step(1.1 / low), 1.01 * round_step(1.1 * high)]
            } else {
                [low / 1.5, high * 1.5]
            };
            return Ok(DrawnAxis::logarithmic(quantity, [low, high * (high / low).powf(above)], room));
        }
        let greatest = low.abs().max(high.abs());
        // values that are all equal get a range around them
        let span = (high - low).max(1e-9 * greatest);
        let margin = 0.04 * if span > 0.0 { span } else { 1.0 };
        // zero is shown where it makes the axis at most twice as long
        let (low, high) = (if 0.0 <= low && low < 0.5 * high { 0.0 } else { low - margin }, high + margin);
        Ok(DrawnAxis::linear(quantity, greatest, [low, high + above * (high - low)], room))
    }
}

impl Bar {
    /// The numbers of a bar of this height in pixels.
    fn axis(&self, length: f64) -> Result<DrawnAxis> {
        let [low, high] = self.range;
        let check = if self.logarithmic { drawable_as_power } else { drawable };
        [low, high].into_iter().try_for_each(|end| check("parameter of a family of curves", end).map(drop))?;
        let room = Room { length, horizontal: false };
        Ok(if self.logarithmic {
            DrawnAxis::logarithmic(&self.quantity, self.range, room)
        } else {
            DrawnAxis::linear(&self.quantity, low.abs().max(high.abs()), self.range, room)
        })
    }
}
