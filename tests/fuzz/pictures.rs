//! Pictures of any numbers.

use viscocontact::Grid;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Picture, Quantity, Scale, Style};

use crate::engine::{Outcome, Target, Verdict, judged};
use crate::files::{shared, text};
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![Target { name: "plot_map", short: 80, run: map }, Target { name: "plot_chart", short: 80, run: chart }]
}

/// Numbers of one size, or of any.
fn numbers(source: &mut Source, count: usize) -> Vec<f64> {
    let (size, offset) = (source.anything(), source.anything());
    let kind = source.below(6);
    (0..count)
        .map(|_| match kind {
            0 => source.anything(),
            1 => size,
            2 => size * source.unit(),
            3 => offset + size * source.unit(),
            4 if source.chance(0.3) => f64::NAN,
            _ => source.unit() - 0.5,
        })
        .collect()
}

fn quantity(source: &mut Source) -> Quantity {
    let unit = source.choose(&["m", "Pa", "m²", "m³", "1/Pa", "", "²", "µm", "N m", "rad/s"]);
    if source.chance(0.3) { Quantity::from(text(source)) } else { Quantity::new(text(source), unit) }
}

/// A picture has as many pixels as its size.
fn look(picture: &Picture) -> Result<(), String> {
    let [width, height] = picture.size();
    if picture.rgb().len() == 3 * width as usize * height as usize {
        Ok(())
    } else {
        Err("a picture of another size".to_owned())
    }
}

fn map(source: &mut Source) -> Verdict {
    let most = if source.chance(0.05) { 32 } else { 5 };
    let mut maps = Vec::new();
    for _ in 0..source.choose(&[1, 1, 1, 2, 3]) {
        let cells = [source.count(1, most), source.count(1, most)];
        let Ok(grid) = Grid::new(cells, [source.scale(1e-6, 1.0), source.scale(1e-6, 1.0)]) else {
            return Ok(Outcome::Refused);
        };
        let values = numbers(source, grid.len());
        let Ok(mut map) = Map::new(&grid, values, quantity(source)) else { return Ok(Outcome::Refused) };
        map.title = text(source);
        map.axes = [quantity(source), quantity(source)];
        if source.chance(0.3) {
            map.range = [source.anything(), source.anything()];
        }
        if source.chance(0.3) {
            let inside = (0..grid.len()).map(|_| source.chance(0.5)).collect();
            map = map.outline(inside).map_err(|error| error.to_string())?;
        }
        maps.push(map);
    }
    judged(Map::draw_row(&maps), |picture| {
        look(&picture)?;
        // a file takes longer than the picture
        if source.chance(0.02) {
            let path = shared().join("picture.png");
            picture.save(&path).map_err(|error| error.to_string())?;
        }
        Ok(())
    })
}

fn chart(source: &mut Source) -> Verdict {
    const SCALES: [Scale; 4] = [Scale::Linear, Scale::LogX, Scale::LogY, Scale::LogLog];
    const STYLES: [Style; 3] = [Style::Line, Style::Dots, Style::LineAndDots];
    let mut chart = Chart::new(text(source), quantity(source), quantity(source), Legend::LowerRight);
    chart.scale = source.choose(&SCALES);
    chart.legend = source.choose(&[Legend::UpperLeft, Legend::MiddleMiddle, Legend::LowerRight]);
    for _ in 0..source.count(0, 3) {
        let count = source.count(0, 6);
        let points = numbers(source, count).into_iter().zip(numbers(source, count)).collect();
        chart.add(text(source), source.choose(&COLORS), source.choose(&STYLES), points);
    }
    judged(chart.draw(), |picture| look(&picture))
}
