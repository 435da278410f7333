//! Sizes in pictures, in pixels, and of letters in pixels per em.

pub(super) struct Sizes {
    /// Letters of titles, of the labels of axes, and of the numbers along them.
    pub(super) title: f64,
    pub(super) label: f64,
    pub(super) numbers: f64,
    /// Length of the ticks of a frame, the distance from there to the numbers, and from the labels to the edge of the
    /// picture.
    pub(super) tick: f64,
    pub(super) to_numbers: f64,
    pub(super) edge: f64,
    /// Length by which title and label may exceed a frame, half of it at each end.
    pub(super) title_beyond: f64,
    /// Height of the numbers and the label below a frame.
    pub(super) below: f64,
    /// Width and height of a chart; the width right of its axes, the least left of them, and the height above.
    pub(super) chart: [u32; 2],
    pub(super) chart_right: f64,
    pub(super) chart_left: f64,
    pub(super) chart_top: f64,
    /// The width left and right of a map, the height above, and its least side: very long maps are not to scale.
    pub(super) map_left: u32,
    pub(super) map_right: u32,
    pub(super) map_top: f64,
    pub(super) least_map: u32,
    /// Width of lines over a map.
    pub(super) mark: f64,
    /// Width of a colour bar with its numbers and label, and of the bar; the height of the triangles at its ends,
    /// the length of its ticks, and its least height.
    pub(super) beside_bar: u32,
    pub(super) bar: f64,
    pub(super) triangle: f64,
    pub(super) bar_tick: f64,
    pub(super) least_bar: u32,
    /// Width of the lines and radius of the dots of curves.
    pub(super) line: f64,
    pub(super) dot: f64,
    /// Height of an entry of a legend, the length of its line, and the space around entries; the distance of the
    /// legend from the axes, and of the points as which it sees curves.
    pub(super) entry: f64,
    pub(super) entry_line: f64,
    pub(super) around_entries: f64,
    pub(super) legend_inset: f64,
    pub(super) curve_points: f64,
}

pub(super) const SIZES: Sizes = Sizes {
    title: 29.0,
    label: 27.0,
    numbers: 24.0,
    tick: 8.0,
    to_numbers: 6.0,
    edge: 10.0,
    title_beyond: 40.0,
    below: 85.0,
    chart: [1200, 800],
    chart_right: 40.0,
    chart_left: 115.0,
    chart_top: 56.0,
    map_left: 115,
    map_right: 20,
    map_top: 54.0,
    least_map: 40,
    mark: 9.0,
    beside_bar: 155,
    bar: 30.0,
    triangle: 26.0,
    bar_tick: 7.0,
    least_bar: 200,
    line: 3.0,
    dot: 5.5,
    entry: 34.0,
    entry_line: 40.0,
    around_entries: 12.0,
    legend_inset: 14.0,
    curve_points: 5.0,
};
