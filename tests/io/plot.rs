//! Pictures: what they show, and that files are whole. Fuzz targets hold that no data make them fail otherwise than by an error.

use crate::common::refused::{field, refused};
use crate::common::{Temporary, builder_of, contact_of, maxwell, sphere};
use approx::assert_abs_diff_eq;
use std::fs;

use viscocontact::ErrorKind;
use viscocontact::observe::Stress;
use viscocontact::output::Field;
use viscocontact::plot::{Animation, COLORS, Chart, ColorScale, Legend, Map, Picture, Quantity, Scale, Style, measure};
use viscocontact::prelude::*;

/// A ball on a Maxwell body under force; on 32 × 24 cells, so that axes are not mixed up.
fn ball() -> ViscoelasticContact {
    let aside = Shifted::new(sphere(), [0.5e-3, -0.3e-3]).unwrap();
    let grid = Grid::new([32, 24], [4.0e-3, 3.0e-3]).unwrap();
    let mut contact = contact_of(&aside, grid, maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.3)).unwrap();
    contact
}

type Pixel = ([usize; 2], [u8; 3]);

/// Column, row and colour of each pixel.
fn pixels(picture: &Picture) -> impl Iterator<Item = Pixel> {
    let width = picture.size()[0] as usize;
    picture.rgb().as_chunks().0.iter().enumerate().map(move |(k, &rgb)| ([k % width, k / width], rgb))
}

/// How many pixels have one of these colours, and the least and greatest of their columns and rows.
fn bounds(pixels: impl Iterator<Item = Pixel>, colors: &[[u8; 3]]) -> (f64, [[f64; 2]; 2]) {
    let places = pixels.filter(|(_, rgb)| colors.contains(rgb)).map(|(at, _)| at.map(|x| x as f64));
    places.fold((0.0, [[f64::INFINITY; 2], [0.0; 2]]), |(count, [low, high]), at| {
        let [low, high] = [[0, 1].map(|axis| at[axis].min(low[axis])), [0, 1].map(|axis| at[axis].max(high[axis]))];
        (count + 1.0, [low, high])
    })
}

const BLUE: [u8; 3] = [0, 114, 178];

#[test]
fn a_map_shows_each_cell_where_it_is() {
    // one cell of the greatest value, to the right and above
    let grid = Grid::new([8, 4], [8.0, 4.0]).unwrap();
    let (dark, light) = ([68, 1, 84], [254, 232, 37]);
    for (cell, at) in [([6, 3], [0.8125, 0.125]), ([0, 0], [0.0625, 0.875])] {
        let mut values = vec![0.0; 32];
        values[cell[0] * 4 + cell[1]] = 1.0;
        let picture = Map::new(&grid, values, "q").unwrap().draw().unwrap();
        // the colour bar has pixels of the light end too: it stands to the right of 870
        let on_map = || pixels(&picture).filter(|([column, _], _)| *column < 860);
        let (count, [low, high]) = bounds(on_map(), &[light]);
        // a cell is an eighth of 730 pixels wide
        assert_abs_diff_eq!(count / (730.0_f64 / 8.0).powi(2), 1.0, epsilon = 0.1);
        // the dark end of the scale fills the rest of the map
        let (_, [first, last]) = bounds(on_map(), &[dark, light]);
        for axis in 0..2 {
            let share = (0.5 * (low[axis] + high[axis]) - first[axis]) / (last[axis] - first[axis]);
            assert!((share - at[axis]).abs() < 0.01, "{share:?}, not {at:?}");
        }
    }
}

/// Pull is blue and pressure red, equally strong at equal magnitudes, whatever the ends of the scale.
#[test]
fn tractions_diverge_about_zero() {
    let grid = Grid::new([4, 1], [4.0, 1.0]).unwrap();
    let shown = |range: [f64; 2]| {
        let mut map = Map::new(&grid, vec![-1.0, 0.0, 0.5, 2.0], "q").unwrap();
        (map.colors, map.range) = (ColorScale::Diverging, range);
        let picture = map.draw().unwrap();
        let row = 54 + 182 / 2; // the middle of the cells
        [0, 1, 2, 3]
            .map(|cell| picture.rgb().as_chunks::<3>().0[row * picture.size()[0] as usize + 115 + 91 + cell * 182])
    };
    let [pull, zero, half, twice] = shown([-1.0, 2.0]);
    assert_eq!([zero, twice], [[247, 247, 247], [103, 0, 31]]);
    assert!(pull[2] > pull[0] + 50 && half[0] > half[2] + 50, "{pull:?} {half:?}");
    let [pull, zero, half, beyond] = shown([-1.0, 1.0]);
    assert_eq!([pull, zero, beyond], [[5, 48, 97], [247, 247, 247], [103, 0, 31]]);
    // half of the scale above zero: between white and red, as far as its mirror image below
    let [mirror, ..] = shown([-2.0, 2.0]);
    assert!(mirror[2] > mirror[0] && half[0] > half[2], "{mirror:?} {half:?}");

    let mut contact = builder_of(
        &Sphere::new(1.0e-3).unwrap(),
        Grid::square(48, 0.8e-3).unwrap(),
        Material::incompressible(Elastic::new(0.25e5).unwrap()),
    )
    .attraction(viscocontact::adhesion::ExponentialAttraction::new(0.1, 10.0e-6).unwrap())
    .build()
    .unwrap();
    contact.step(0.0, Load::approach(20.0e-6)).unwrap();
    let map = Map::of(&contact, Field::Traction).unwrap();
    assert_eq!(
        (map.colors, Map::of(&contact, Field::Pressure).unwrap().colors),
        (ColorScale::Diverging, ColorScale::Sequential)
    );
    assert!(map.range[0] < 0.0 && map.range[1] > 0.0, "{:?}", map.range);
}

/// The colour of each member is its place on the bar, on a logarithmic one if the parameter spans decades.
#[test]
fn families_are_coloured_by_their_parameter() {
    let drawn = |parameters: [f64; 3]| {
        let mut chart = Chart::new("", "x", "y", Legend::UpperLeft);
        // far from zero, where the axis would begin otherwise
        let level = |value: f64| 100.0 + value.log10();
        let levels = parameters.map(|value| (value, vec![(0.0, level(value)), (1.0, level(value))]));
        chart.add_family(Quantity::new("speed", "m/s"), Style::Line, levels.to_vec());
        let picture = chart.draw().unwrap();
        // the curves across the column in the middle of the axes, from the top
        let at = pixels(&picture).filter(|([column, row], _)| *column == 580 && (60..710).contains(row));
        let mut colors: Vec<[u8; 3]> = at.map(|(_, rgb)| rgb).filter(|rgb| rgb.iter().any(|&c| c < 150)).collect();
        colors.dedup();
        let bar = pixels(&picture).filter(|([column, _], rgb)| *column > 1060 && colors.contains(rgb)).count();
        (colors, bar, picture.size())
    };
    let (colors, bar, size) = drawn([1e-8, 1e-6, 1e-4]);
    assert_eq!([colors.len(), size[0] as usize], [3, 1200], "{colors:?}");
    let (least, greatest) = (colors[2], colors[0]);
    assert_eq!(least, [68, 1, 84]);
    assert!(bar > 30, "{bar} pixels of the bar");
    // in the middle of a logarithmic bar, and near the lower end of a linear one
    assert_eq!(drawn([1e-8, 1e-5, 1e-2]).0[1], colors[1]);
    let (linear, ..) = drawn([1.0, 2.0, 20.0]);
    assert_eq!([linear[2], linear[0]], [least, greatest]);
    assert_ne!(linear[1], colors[1]);
    // a single value has no bar; no value is refused by name
    let mut chart = Chart::new("", "x", "y", Legend::UpperLeft);
    chart.add_family("p", Style::Line, vec![(1.0, vec![(0.0, 0.0), (1.0, 1.0)])]);
    chart.draw().unwrap();
    chart.add_family("p", Style::Line, vec![(1.0, vec![(0.0, 0.0)]), (1e101, vec![(1.0, 1.0)])]);
    assert_eq!(field(chart.draw()), "parameter of a family of curves");
    assert_eq!([measure(1.8e-7, "m/s"), measure(0.4e-6, "m²")], ["180 nm/s", "0.4 mm²"]);
}

#[test]
fn axes_begin_at_zero_where_it_is_near_and_at_a_number_where_there_are_few() {
    // the places of two dots along the vertical axis, which lies in the rows from 715 to 56
    let places = |scale: Scale, values: [f64; 2]| {
        let mut chart = Chart::new("", "x", "y", Legend::UpperLeft);
        chart.scale = scale;
        chart.add("", COLORS[0], Style::Dots, values.map(|value| (value, value)).to_vec());
        let (_, [first, last]) = bounds(pixels(&chart.draw().unwrap()), &[BLUE]);
        [last[1] - 5.0, first[1] + 5.0].map(|row| (715.0 - row) / (715.0 - 56.0))
    };
    let decade = (202.0_f64 / 19.8).ln();
    for (scale, values, exact) in [
        (Scale::Linear, [1.0, 3.0], [1.0 / 3.08, 3.0 / 3.08]),
        (Scale::Linear, [2.0, 3.0], [0.04 / 1.08, 1.04 / 1.08]),
        (Scale::LogLog, [30.0, 108.0], [30.0, 108.0].map(|value: f64| (value / 19.8).ln() / decade)),
    ] {
        let found = places(scale, values);
        assert!((0..2).all(|k| (found[k] - exact[k]).abs() < 0.01), "{scale:?} {values:?}: {found:?} {exact:?}");
    }
}

#[test]
fn pressure_is_blank_out_of_contact() {
    let contact = ball();
    let map = Map::of(&contact, Field::Pressure).unwrap();
    let known = map.values().iter().filter(|p| p.is_finite()).count();
    assert_eq!(known, contact.contact_cells());
    assert_eq!(map.range, [0.0, contact.fields().max_pressure()]);
    assert_eq!(map.title, "t = 0 s");
    let gap = Map::of(&contact, Field::Gap).unwrap();
    assert_eq!([gap.range[0], gap.values().len() as f64], [0.0, 768.0]);
    // the outline: black pixels about the contact, which lies to the right of the middle and below it
    let plain = Map::of(&contact, Field::Displacement).unwrap().outline(Vec::new());
    assert!(matches!(plain, Err(Error::WrongLength { field: "cells of an outline", len: 0, expected: 768, .. })));
    let outlined = Map::of(&contact, Field::Displacement).unwrap().draw().unwrap();
    let without = Map::of(&contact, Field::Displacement).unwrap().outline(vec![false; 768]).unwrap().draw().unwrap();
    let changed = pixels(&outlined).zip(pixels(&without)).filter(|(one, other)| one != other);
    let columns: Vec<f64> = changed.map(|(([column, _], _), _)| column as f64).collect();
    let mean = columns.iter().sum::<f64>() / columns.len() as f64;
    let scale = 730.0 / 4.0e-3;
    let cell = 0.125e-3 * scale;
    // 115 pixels are left of the map; its middle is 365 further
    assert_abs_diff_eq!(mean, 115.0 + 365.0 + 0.5e-3 * scale, epsilon = cell);
    assert!(columns.len() > 200);
}

#[test]
fn profiles_and_histories_hold_the_state() {
    let mut contact = ball();
    let empty = Chart::history("", &[], "q", &[("", &[])]).unwrap();
    assert_eq!(empty.draw().unwrap_err().kind(), ErrorKind::Value, "nothing to draw yet");
    let (mut times, mut areas) = (Vec::new(), Vec::new());
    for _ in 0..3 {
        times.push(contact.time());
        areas.push(contact.contact_area());
        contact.step(0.5, Load::force(0.3)).unwrap();
    }
    Chart::history("", &times, Quantity::new("contact area", "m²"), &[("", &areas)]).unwrap().draw().unwrap();
    let short = Chart::history("", &times, "q", &[("a", &[1.0, 2.0])]);
    assert!(matches!(short, Err(Error::WrongLength { field: "column of a history", len: 2, expected: 3, .. })));
    Chart::profile(&contact, Axis::X2, 0.5e-3).unwrap().draw().unwrap();
    assert!(matches!(Chart::profile(&contact, Axis::X2, 1.0), Err(Error::OutOfRange { .. })));
}

#[test]
fn charts_draw_series_in_their_colours() {
    let mut chart = Chart::new("", "x", "y", Legend::UpperLeft);
    chart.add("", COLORS[0], Style::Line, vec![(0.0, 0.0), (1.0, 1.0), (f64::NAN, 0.0), (3.0, 1.0), (4.0, 0.0)]);
    chart.add("", COLORS[1], Style::Dots, vec![(4.0, 1.0)]);
    let picture = chart.draw().unwrap();
    let (line, _) = bounds(pixels(&picture), &[BLUE]);
    let (dot, [[x, _], [_, y]]) = bounds(pixels(&picture), &[[213, 94, 0]]);
    assert!(line > 500.0 && (60.0..130.0).contains(&dot), "{line} {dot}");
    assert!(x > 1000.0 && y < 100.0, "the dot is in the upper right corner, not at {x}, {y}");
    // the line is broken: nothing of it crosses the middle
    let middle = 115 + (picture.size()[0] as usize - 155) / 2;
    assert_eq!(pixels(&picture).filter(|&([column, _], rgb)| column == middle && rgb == BLUE).count(), 0);
}

/// A thick line that turns back sharply has no spike out of the axes.
#[test]
fn lines_that_turn_back_stay_where_they_are() {
    let mut chart = Chart::new("", "x", "y", Legend::UpperLeft);
    chart.add("", COLORS[0], Style::Line, vec![(0.0, 0.0), (0.2, 0.5), (1.0, 0.50), (0.1, 0.503), (1.0, 1.0)]);
    let picture = chart.draw().unwrap();
    let (_, [[left, _], _]) = bounds(pixels(&picture), &[BLUE]);
    assert!(left >= 110.0, "a pixel of the line stands left of the axis");
}

/// A logarithmic axis has numbers, however little its values differ: the strip left of it is not empty.
#[test]
fn narrow_logarithmic_axes_have_numbers() {
    for y in [2.8e-3, 1.0, 0.97e5] {
        let mut chart = Chart::new("", "x", "", Legend::UpperLeft);
        chart.scale = Scale::LogY;
        chart.add("", COLORS[0], Style::Line, vec![(0.0, y), (1.0, 1.01 * y)]);
        let picture = chart.draw().unwrap();
        let dark = pixels(&picture).filter(|([column, _], rgb)| *column < 105 && rgb.iter().all(|&c| c < 100));
        let rows: std::collections::BTreeSet<usize> = dark.map(|([_, row], _)| row).collect();
        let [low, high] = [*rows.first().unwrap(), *rows.last().unwrap()];
        assert!(high - low > 300, "{y}: numbers from row {low} to row {high}");
    }
}

/// What maps and charts refuse when they are saved is in `clauses`.
#[test]
fn bad_pictures_are_refused_by_name() {
    let grid = Grid::square(2, 1.0).unwrap();
    assert_eq!(Map::new(&grid, vec![1.0, 2.0, f64::NAN, 4.0], "q").unwrap().range, [1.0, 4.0]);
    let contact = |side: f64| contact_of(&sphere(), Grid::square(8, side).unwrap(), maxwell(), Settings::default());
    let section = contact(1.0).fields().stress().unwrap().on_section(Axis::X1, 0.0, &[0.1, 0.2]).unwrap();
    assert!(Map::section(&contact(1.0), &section, Stress::tresca, "q").is_ok());
    refused([
        (Map::section(&contact(2.0), &section, Stress::tresca, "q").err(), "position of a section"),
        (Map::new(&grid, vec![0.0; 3], "q").err(), "values of a map"),
        (Map::new(&grid, vec![1e101; 4], "q").err(), "value of a map"),
    ]);
}

#[test]
fn animations_play_back() {
    let folder = Temporary::folder("animation");
    let path = folder.join("run.gif");
    let mut contact = ball();
    let mut animation = Animation::create(&path, Field::Pressure, [0.0, 0.4e6], 0.05).unwrap();
    let mut last = None;
    for _ in 0..4 {
        animation.record(&contact).unwrap();
        let pressed = contact.pressure().iter().map(|p| *p > 0.0).collect();
        let mut map = Map::of(&contact, Field::Pressure).unwrap().outline(pressed).unwrap();
        map.range = [0.0, 0.4e6];
        last = Some(map.draw().unwrap());
        contact.step(0.2, Load::force(0.3)).unwrap();
    }
    let other =
        Map::draw_row(&[Map::of(&contact, Field::Pressure).unwrap(), Map::of(&contact, Field::Gap).unwrap()]).unwrap();
    let refused = animation.record_picture(&other).unwrap_err();
    assert!(matches!(refused, Error::CountOutOfRange { field: "width of a frame", .. }));
    assert_eq!(animation.frames(), 4);
    assert!(!path.exists(), "it is not there before it is whole");
    animation.finish().unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);

    // put together again, frame by frame, the last is what was drawn, but for the nearest colours
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(fs::File::open(&path).unwrap()).unwrap();
    let palette = decoder.global_palette().unwrap().to_vec();
    let width = usize::from(decoder.width());
    let last = last.unwrap();
    assert_eq!([u32::from(decoder.width()), u32::from(decoder.height())], last.size());
    let (mut screen, mut frames) = (vec![0_u8; last.rgb().len()], 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!(frame.delay, 5);
        for (k, &index) in frame.buffer.iter().enumerate() {
            let (across, down) = (usize::from(frame.left), usize::from(frame.top));
            let (x, y) = (across + k % usize::from(frame.width), down + k / usize::from(frame.width));
            let color = 3 * usize::from(index);
            screen[3 * (y * width + x)..][..3].copy_from_slice(&palette[color..color + 3]);
        }
        frames += 1;
    }
    assert_eq!(frames, 4);
    let off = screen.iter().zip(last.rgb()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / screen.len() as f64;
    assert!(off < 0.5, "mean distance of a colour {off}");

    for (range, seconds) in [([1.0, 0.0], 0.1), ([0.0, 1.0], 0.001), ([0.0, 1.0], f64::NAN), ([f64::NAN, 1.0], 0.1)] {
        let refused = Animation::create(folder.join("b.gif"), Field::Gap, range, seconds);
        assert!(matches!(refused, Err(Error::OutOfRange { .. })));
    }
    let empty = Animation::create(folder.join("b.gif"), Field::Gap, [0.0, 1.0], 0.1).unwrap();
    assert!(matches!(empty.finish(), Err(Error::WrongLength { .. })));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// What the test below runs with room for 32 KiB in a file.
#[cfg(unix)]
#[test]
#[ignore = "a_frame_without_room_leaves_no_trace runs it"]
fn frames_until_there_is_no_room() {
    let folder = std::path::PathBuf::from(std::env::var_os("FULL_FOLDER").expect("FULL_FOLDER names a folder"));
    let mut contact = ball();
    let mut animation = Animation::create(folder.join("run.gif"), Field::Pressure, [0.0, 0.4e6], 0.05).unwrap();
    let length = || fs::read_dir(&folder).unwrap().next().unwrap().unwrap().metadata().unwrap().len();
    let mut before = length();
    for _ in 0..1000 {
        contact.step(0.2, Load::force(0.1 + 0.2 * (contact.time() % 0.7))).unwrap();
        match animation.record(&contact) {
            Ok(()) => before = length(),
            Err(error) => {
                assert!(matches!(error, Error::Output(_)), "{error}");
                assert!(animation.frames() > 0 && length() == before && before <= 32768);
                return;
            }
        }
    }
    panic!("{} frames in {before} bytes", animation.frames());
}

/// A frame that the disk has no room for leaves nothing in the file.
#[cfg(unix)]
#[test]
fn a_frame_without_room_leaves_no_trace() {
    let folder = Temporary::folder("full-animation");
    let child = super::with_room_for_32_kib("io::plot::frames_until_there_is_no_room", &folder);
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stderr));
    assert!(String::from_utf8_lossy(&child.stdout).contains("1 passed"), "the test above has run");
}
