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
    t.row(
        "SubsurfaceStress::with_changing_poisson",
        changing(&layer, &field, &field),
        Unsupported,
        "the stress below the surface is…ntact of half-spaces",
    );
    t.row(
        "SubsurfaceStress::with_changing_poisson",
        changing(&periodic, &field, &field),
        Unsupported,
        "the stress below the surface is…where it is periodic",
    );
    t.row(
        "SubsurfaceStress::with_changing_poisson",
        changing(&half_space, &short, &field),
        Value,
        "pressure: 63 given, 64 needed",
    );
    t.row(
        "SubsurfaceStress::with_changing_poisson",
        changing(&half_space, &field, &short),
        Value,
        "reduced pressure: 63 given, 64 needed",
    );
    t.row(
        "SubsurfaceStress::with_changing_poisson",
        changing(&half_space, &field, &endless),
        Value,
        "reduced pressure = inf → finite and at most 1e150 Pa in magnitude",
    );
    let stress = SubsurfaceStress::new(&half_space, &field, 0.3).unwrap();
    for (depth, says) in [
        (0.4e-3, "depth = 0.0004 → at least half the longest… varies within a cell"),
        (-1.0, "depth = -1.0 → at least half the longest side… varies within a cell"),
        (f64::NAN, "depth = NaN → at least half the longest side… varies within a cell"),
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
    t.row(
        "SubsurfaceStress::on_section",
        section(5.0e-3, &[1.0e-3]),
        Value,
        "coordinate of the section = 0.005 → inside the grid",
    );
    t.row(
        "SubsurfaceStress::on_section",
        section(f64::NAN, &[1.0e-3]),
        Value,
        "coordinate of the section = NaN → inside the grid",
    );
    t.row("SubsurfaceStress::on_section", section(0.0, &[]), Value, "depths: 0 given, at least 1 needed");
    t.row(
        "SubsurfaceStress::on_section",
        section(0.0, &[2.0e-3, 1.0e-3]),
        Value,
        "depths[1] = 0.001 may not follow…the values must rise",
    );

    let mut contact = sphere_on(grid.clone(), elastic(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let (folder, metadata) = (Temporary::folder("clauses"), Metadata::new("clauses"));
    let create = |path: &str, fields: &[Field], earlier| {
        FrameSeries::create(folder.join(path), Format::Npz, &metadata, &contact, fields, earlier)
    };
    std::fs::write(folder.join("file"), "").unwrap();
    t.row(
        "FrameSeries::create",
        create("file", &[Field::Pressure], Earlier::Refuse),
        File,
        "…cannot be written: it is a file, and frames need a folder",
    );
    t.row(
        "FrameSeries::create",
        create("twice", &[Field::Gap, Field::Gap], Earlier::Refuse),
        File,
        "… cannot be written: the field gap is requested twice",
    );
    create("frames", &[Field::Pressure], Earlier::Refuse).unwrap().record(&contact).unwrap();
    t.row(
        "FrameSeries::create",
        create("frames", &[Field::Pressure], Earlier::Refuse),
        File,
        "… cannot be written: the folder contains… removes it",
    );
    std::fs::write(folder.join("frames").join("frame_000000.npz"), "no frame").unwrap();
    t.row(
        "FrameSeries::create",
        create("frames", &[Field::Pressure], Earlier::Continue),
        File,
        "… cannot be written: it is no frame to… removes it",
    );

    for size in [0, 1025] {
        t.row("Threads::run", Threads::run(size, |_| ()), Value, "ranks = … → 1 to 1024");
    }
    let chart = |points: Vec<(f64, f64)>| {
        let mut chart = Chart::new("title", Quantity::new("time", "s"), Quantity::new("force", "N"), Legend::UpperLeft);
        chart.add("", Color::GREY, Style::Line, points);
        chart
    };
    let picture = |name: &str| folder.join(name);
    t.row(
        "Chart::save",
        chart(vec![]).save(picture("a.png")),
        Value,
        "points to draw in the chart: 0 given, at least 1 needed",
    );
    t.row(
        "Chart::save",
        chart(vec![(0.0, 1.0), (1.0, 1.0e101)]).save(picture("a.png")),
        Value,
        "y of a point in a chart = 1e101 → finite and at most 1e100 in magnitude",
    );
    t.row(
        "Chart::save",
        chart(vec![(0.0, 1.0), (1.0, 2.0)]).save(picture("a.jpg")),
        File,
        "…: the extension must be .png or .svg",
    );
    t.row(
        "Chart::save",
        chart(vec![(0.0, 1.0), (1.0, 2.0)]).save(picture("none/a.png")),
        File,
        "…ist: create it first",
    );
    for at in [5.0e-3, f64::NAN] {
        t.row(
            "Chart::profile",
            Chart::profile(&contact, Axis::X1, at),
            Value,
            "coordinate of the profile = … → inside the grid",
        );
    }
    let map = |range: [f64; 2]| {
        let mut map = Map::new(&grid, field.clone(), Quantity::new("pressure", "Pa")).unwrap();
        map.range = range;
        map
    };
    for (range, says) in [
        ([1.0, 1.0], "upper end of the colour scale = 1.0 → above the lower end"),
        ([1.0, 0.0], "upper end of the colour scale = 0.0 → above the lower end"),
        ([0.0, 1.0e101], "upper end of the colour scale = 1e101 →… most 1e100 in magnitude"),
        ([f64::NAN, 1.0], "lower end of the colour scale = NaN → finite… most 1e100 in magnitude"),
    ] {
        t.row("Map::save", map(range).save(picture("a.png")), Value, says);
        t.row("Map::save_row", Map::save_row(&[map([0.0, 1.0]), map(range)], picture("a.png")), Value, says);
    }
    t.row("Map::save", map([0.0, 1.0]).save(picture("a.gif")), File, "…: the extension must be .png or .svg");
    t.row("Map::save_row", Map::save_row(&[], picture("a.png")), Value, "maps of a row: 0 given, at least 1 needed");
    let many: Vec<Map> = (0..40).map(|_| map([0.0, 1.0])).collect();
    t.row(
        "Map::save_row",
        Map::save_row(&many, picture("a.png")),
        Value,
        "pixels along a side of a picture = 23955 → in [1, 16384]",
    );
}
