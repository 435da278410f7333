//! Stresses, pictures, series of frames and ranks.

use viscocontact::ErrorKind::{File, Unsupported, Value};
use viscocontact::observe::SubsurfaceStress;
use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
use viscocontact::parallel::Threads;
use viscocontact::plot::{Chart, Color, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

use super::Table;
use crate::common::{Temporary, elastic, sphere_on};

pub fn rows(t: &mut Table) {
    let grid = Grid::square(8, 8.0e-3).unwrap();
    let (half_space, periodic) =
        (InfluenceKernel::half_space(&grid).unwrap(), InfluenceKernel::periodic(&grid).unwrap());
    let layer = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(1.0e-3, 0.5).unwrap()).unwrap();
    let (field, short) = (vec![1.0; 64], vec![1.0; 63]);
    let endless = vec![f64::INFINITY; 64];
    let changing = SubsurfaceStress::with_changing_poisson;
    for (stress, kind, says) in [
        (changing(&layer, &field, &field), Unsupported, "the stress…(layer of 1e-3 m, …): it must be a half-space, …"),
        (
            changing(&periodic, &field, &field),
            Unsupported,
            "…it must be of a constant Poisson's ratio where it is periodic",
        ),
        (changing(&half_space, &short, &field), Value, "pressure: 63 given, 64 needed"),
        (changing(&half_space, &field, &short), Value, "reduced pressure: 63 given, 64 needed"),
        (changing(&half_space, &field, &endless), Value, "reduced pressure = inf → finite and at most 1e150 Pa…"),
    ] {
        t.row("SubsurfaceStress::with_changing_poisson", stress, kind, says);
    }
    let stress = SubsurfaceStress::new(&half_space, &field, 0.3).unwrap();
    for (depth, says) in [
        (0.4e-3, "depth = 0.0004 → at least half the longest side of a cell…least_depth…"),
        (-1.0, "depth = -1.0 → at least half the longest side of a cell…least_depth…"),
        (f64::NAN, "depth = NaN → at least half the longest side of a cell…least_depth…"),
        (1.0e101, "depth = 1e101 → at most 1e100 m"),
    ] {
        t.row("SubsurfaceStress::on_plane", stress.on_plane(depth), Value, says);
        t.row("SubsurfaceStress::at", stress.at(&[[0.0, 0.0, 1.0e-3], [0.0, 0.0, depth]]), Value, says);
        t.row("SubsurfaceStress::on_section", stress.on_section(Axis::X1, 0.0, &[depth]), Value, says);
    }
    for ([x1, x2], says) in [
        ([f64::NAN, 0.0], "coordinate x1 of a point = NaN → finite and… the depth of the point"),
        ([0.0, 1.0e40], "coordinate x2 of a point = 1e40 → finite and… the depth of the point"),
    ] {
        t.row("SubsurfaceStress::at", stress.at(&[[x1, x2, 1.0e-3]]), Value, says);
    }
    let section = |at: f64, depths: &[f64]| stress.on_section(Axis::X2, at, depths);
    for (section, says) in [
        (section(5.0e-3, &[1.0e-3]), "coordinate of the section = 0.005 → inside the grid"),
        (section(f64::NAN, &[1.0e-3]), "coordinate of the section = NaN → inside the grid"),
        (section(0.0, &[]), "depths: 0 given, at least 1 needed"),
        (section(0.0, &[2.0e-3, 1.0e-3]), "depths[1] = 0.001 may not follow 0.002: the values must rise"),
    ] {
        t.row("SubsurfaceStress::on_section", section, Value, says);
    }

    let mut contact = sphere_on(grid.clone(), elastic(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let (folder, metadata) = (Temporary::folder("clauses"), Metadata::new("clauses"));
    let create = |path: &str, fields: &[Field], earlier| {
        FrameSeries::create(folder.join(path), Format::Npz, &metadata, &contact, fields, earlier)
    };
    std::fs::write(folder.join("file"), "").unwrap();
    let (one, twice) = ([Field::Pressure], [Field::Gap; 2]);
    for (path, fields, says) in [
        ("file", &one[..], "… cannot be written: it is a file, and frames need a folder"),
        ("twice", &twice[..], "… cannot be written: the field gap is requested twice"),
    ] {
        t.row("FrameSeries::create", create(path, fields, Earlier::Refuse), File, says);
    }
    create("frames", &one, Earlier::Refuse).unwrap().record(&contact).unwrap();
    let again = create("frames", &one, Earlier::Refuse);
    t.row(
        "FrameSeries::create",
        again,
        File,
        "…the folder contains frame_000000.npz of another run: Earlier::Replace…",
    );
    std::fs::write(folder.join("frames").join("frame_000000.npz"), "no frame").unwrap();
    let on = create("frames", &one, Earlier::Continue);
    t.row("FrameSeries::create", on, File, "…frame_000000.npz cannot be written: it is no frame to continue from…");

    for size in [0, 1025] {
        t.row("Threads::run", Threads::run(size, |_| ()), Value, "ranks = … → 1 to 1024");
    }
    let chart = |points: Vec<(f64, f64)>| {
        let mut chart = Chart::new("title", Quantity::new("time", "s"), Quantity::new("force", "N"), Legend::UpperLeft);
        chart.add("", Color::GREY, Style::Line, points);
        chart
    };
    let picture = |name: &str| folder.join(name);
    let two = |last: f64| chart(vec![(0.0, 1.0), (1.0, last)]);
    for (saved, kind, says) in [
        (chart(vec![]).save(picture("a.png")), Value, "points to draw in the chart: 0 given, at least 1 needed"),
        (two(1.0e101).save(picture("a.png")), Value, "y of a point in a chart = 1e101 → finite and at most 1e100…"),
        (two(2.0).save(picture("a.jpg")), File, "…: the extension must be .png or .svg"),
        (
            two(2.0).save(picture("none/a.png")),
            File,
            "… cannot be written: the folder …does not exist: create it first",
        ),
    ] {
        t.row("Chart::save", saved, kind, says);
    }
    for at in [5.0e-3, f64::NAN] {
        let profile = Chart::profile(&contact, Axis::X1, at);
        t.row("Chart::profile", profile, Value, "coordinate of the profile = … → inside the grid");
    }
    let map = |range: [f64; 2]| {
        let mut map = Map::new(&grid, field.clone(), Quantity::new("pressure", "Pa")).unwrap();
        map.range = range;
        map
    };
    for (range, says) in [
        ([1.0, 1.0], "upper end of the colour scale = 1.0 → above the lower end"),
        ([1.0, 0.0], "upper end of the colour scale = 0.0 → above the lower end"),
        ([0.0, 1.0e101], "upper end of the colour scale = 1e101 → finite and at most 1e100…"),
        ([f64::NAN, 1.0], "lower end of the colour scale = NaN → finite and at most 1e100…"),
    ] {
        t.row("Map::save", map(range).save(picture("a.png")), Value, says);
        t.row("Map::save_row", Map::save_row(&[map([0.0, 1.0]), map(range)], picture("a.png")), Value, says);
    }
    t.row("Map::save", map([0.0, 1.0]).save(picture("a.gif")), File, "…: the extension must be .png or .svg");
    t.row("Map::save_row", Map::save_row(&[], picture("a.png")), Value, "maps of a row: 0 given, at least 1 needed");
    let many: Vec<Map> = (0..40).map(|_| map([0.0, 1.0])).collect();
    let wide = Map::save_row(&many, picture("a.png"));
    t.row("Map::save_row", wide, Value, "pixels along a side of a picture = 23955 → in [1, 16384]");
}
