//! The colour bar beside a map or a chart.

use crate::plot::sizes::SIZES;
use crate::plot::{Anchor, Canvas, Color, DrawnAxis};

/// Draws the bar of `axis` to the right of `left` from `top` to `bottom`, with triangles at its lower and upper end
/// where values lie `beyond` it; `color` is the colour at a fraction of the axis.
pub(super) fn draw(
    canvas: &mut Canvas,
    left: f64,
    [top, bottom]: [f64; 2],
    axis: &DrawnAxis,
    color: impl Fn(f64) -> Color,
    beyond: [bool; 2],
) {
    let (left, right) = (left + 10.0, left + 10.0 + SIZES.bar);
    let colors: Vec<Color> = (0..256).rev().map(|k| color(f64::from(k) / 255.0)).collect();
    canvas.cells([left, top, right, bottom], 1, &colors);
    let middle = 0.5 * (left + right);
    let mut outline = vec![vec![[left, top], [left, bottom]], vec![[right, top], [right, bottom]]];
    for (is_beyond, end, tip, fraction) in
        [(beyond[0], bottom, bottom + SIZES.triangle, 0.0), (beyond[1], top, top - SIZES.triangle, 1.0)]
    {
        if is_beyond {
            canvas.polygon(&[[left, end], [right, end], [middle, tip]], color(fraction));
            outline.push(vec![[left, end], [middle, tip], [right, end]]);
        } else {
            outline.push(vec![[left, end], [right, end]]);
        }
    }
    for (at, text) in &axis.ticks {
        let y = (bottom - at * (bottom - top)).round();
        outline.push(vec![[right, y], [right + SIZES.bar_tick, y]]);
        canvas.text(
            text,
            [right + SIZES.bar_tick + 5.0, y + 0.35 * SIZES.numbers],
            SIZES.numbers,
            Anchor::Start,
            false,
        );
    }
    canvas.lines(&outline, 2.0, Color::BLACK);
    let baseline = right + SIZES.bar_tick + axis.widest() + 10.0 + SIZES.label;
    canvas.fitted_text(&axis.label, [baseline, 0.5 * (top + bottom)], SIZES.label, bottom - top + 40.0, true);
}

#[cfg(test)]
mod tests {
    use crate::Grid;
    use crate::plot::{Color, Map};

    #[test]
    fn triangles_mark_values_beyond_the_scale() {
        let grid = Grid::square(2, 1.0).unwrap();
        let mut map = Map::new(&grid, vec![0.0, 1.0, f64::NAN, 4.0], "q").unwrap();
        // pixels of the end colours above and below the bar, to the right of the map
        let marked = |map: &Map| {
            let picture = map.draw().unwrap();
            let [width, height] = picture.size().map(|side| side as usize);
            let pixels = |rows: std::ops::Range<usize>, Color(r, g, b): Color| {
                let of = picture.rgb().chunks_exact(3).enumerate().filter(|(k, _)| rows.contains(&(k / width)));
                of.filter(|(k, pixel)| k % width > 870 && **pixel == [r, g, b]).count() > 100
            };
            [pixels(height - 80..height, Color::on_scale(0.0)), pixels(0..50, Color::on_scale(1.0))]
        };
        assert_eq!(marked(&map), [false, false], "values at the ends lie within");
        map.range = [0.0, 3.0];
        assert_eq!(marked(&map), [false, true]);
        map.range = [0.5, 4.0];
        assert_eq!(marked(&map), [true, false]);
        map.range = [0.5, 1.5];
        assert_eq!(marked(&map), [true, true]);
    }
}
