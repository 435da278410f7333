//! Height maps, stresses, pictures, series of frames, and fits.

use super::*;

#[rustfmt::skip]
pub(super) fn maps(t: &mut Table) {
    let map = |cells: [usize; 2], lengths: [f64; 2], heights: &[f64]| HeightMap::new(cells, lengths, heights.to_vec());
    t.row(map([0, 2], [1.0; 2], &[]), Value, "cells along x1 = 0 → 1 or more");
    t.row(map([2, 2], [1.0, -1.0], &[0.0; 4]), Value, "length along x2 = -1.0 → finite and > 0");
    t.row(map([2, 2], [1.0; 2], &[0.0; 3]), Value, "heights: 3 given, 4 needed");
    t.row(map([2, 1], [1.0; 2], &[0.0, -2.0e300]), Value, "height 1 of the map is -2e300: …within ±1e300 m…");
    let own = || map([2, 2], [1.0e-3; 2], &[0.0, 1.0e-6, 2.0e-6, 3.0e-6]).unwrap();
    t.row(own().scaled(NAN), Value, "factor of the heights = NaN → finite");
    t.row(own().scaled(1.0e307), Value, "height 1 of the map is 9.99…e300: …within ±1e300 m…");
    let gsf = |lines: &str| {
        let mut file = format!("Gwyddion Simple Field 1.0\n{lines}").into_bytes();
        file.resize(file.len() + 4 - file.len() % 4 + 8, 0);
        HeightMap::from_gsf(&file[..], None)
    };
    let units = "XYUnits = mm\nZUnits = nm\n";
    t.row(gsf(&format!("XRes = 1\nYRes = 3\nXReal = 5\nYReal = 10\n{units}")), File, "the GSF file should hold 12 bytes of heights, but holds 8");
    t.row(gsf(&format!("XRes = 1\nYRes = two\nXReal = 5\nYReal = 10\n{units}")), File, "the GSF file has YRes = \"two\", which must be a whole number");
    t.row(gsf(&format!("XRes = 1\nYRes = 2\nYReal = 10\n{units}")), File, "the GSF file has no XReal: add it, or export the map anew");
    t.row(gsf(&format!("XRes = 1\nYRes = 2\nXReal = -5\nYReal = 10\n{units}")), File, "the GSF file has XReal = \"-5\", which must be > 0");
    t.row(gsf("XRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\nXYUnits = mm\n"), File, "the GSF file has no ZUnits, …: give it, as to HeightMap::from_gsf");
    t.row(gsf("XRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\nXYUnits = mm\nZUnits = inch\n"), File, "\"inch\" is not a known unit of length: m, cm, mm, …");
    t.row(HeightMap::from_gsf(&b"GIF89a"[..], None), File, "not a GSF file: it does not begin with…export it anew…");
    let square = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]];
    let diagonal: Vec<_> = (0..200).map(|k| [f64::from(k), f64::from(k), 0.0]).collect();
    t.row(HeightMap::from_points(&[[0.0, 0.0, 1.0], [NAN, 0.0, 1.0]]), Value, "x of the points = NaN → within ±1e30 m");
    t.row(HeightMap::from_points(&[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]), Value, "different x of the points: 1 given, at least 2 needed");
    t.row(HeightMap::from_points(&[&square[..], &[[1.0, 1.0, 2.0]]].concat()), File, "lines 4 and 5 give two heights for the point (1, 1) m: give their mean");
    t.row(HeightMap::from_points(&[&square[..], &[[2.3, 1.0, 2.0]]].concat()), File, "line 4: x = 1 m is 0.076 spacings…off the regular grid…");
    t.row(HeightMap::from_points(&diagonal), File, "200 points are too few for…200 x 200…: interpolate…");
    t.row(own().centered_at([1.0, 0.0]).unwrap().resampled(&grid()), Value, "no height is known: …take a part of the map with heights");
    t.row(own().resampled(&Grid::square(1 << 20, 1.0e-3).unwrap()), Memory, "a map on another grid needs 8796093022208 bytes…take fewer cells…");
}

#[rustfmt::skip]
pub(super) fn results(t: &mut Table) {
    let grid = Grid::square(8, 8.0e-3).unwrap();
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let layer = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(1.0e-3, 0.5).unwrap()).unwrap();
    let (field, short) = (vec![1.0; 64], vec![1.0; 63]);
    let below = |kernel: &InfluenceKernel, pressure: &[f64]| SubsurfaceStress::new(kernel, pressure, 0.3);
    t.row(below(&layer, &field), Unsupported, "the stress…(layer of 1e-3 m, …): it must be a half-space, …");
    t.row(below(&half_space, &short), Value, "pressure: 63 given, 64 needed");
    t.row(below(&half_space, &[f64::INFINITY; 64]), Value, "pressure = inf → finite and at most 1e150 Pa…");
    let stress = SubsurfaceStress::new(&half_space, &field, 0.3).unwrap();
    for (depth, says) in [(0.4e-3, "depth = 0.0004 → at least half the longest side of a cell…min_depth…"), (1.0e101, "depth = 1e101 → at most 1e100 m")] {
        t.row(stress.on_plane(depth), Value, says);
        t.row(stress.at(&[[0.0, 0.0, 1.0e-3], [0.0, 0.0, depth]]), Value, says);
        t.row(stress.on_section(Axis::X1, 0.0, &[depth]), Value, says);
    }
    t.row(stress.at(&[[0.0, 1.0e40, 1.0e-3]]), Value, "coordinate x2 of a point = 1e40 → finite and… the depth of the point");
    let section = |at: f64, depths: &[f64]| stress.on_section(Axis::X2, at, depths);
    t.row(section(5.0e-3, &[1.0e-3]), Value, "coordinate of the section = 0.005 → inside the grid");
    t.row(section(0.0, &[]), Value, "depths: 0 given, at least 1 needed");
    t.row(section(0.0, &[2.0e-3, 1.0e-3]), Value, "depths[1] = 0.001 may not follow 0.002: the values must rise");

    let contact = sphere_on(grid.clone(), elastic(), Settings::default());
    let (folder, metadata) = (Temporary::folder("clauses"), Metadata::new("clauses"));
    let create = |path: &str, fields: &[Field], earlier| FrameSeries::create(folder.join(path), Format::Npz, &metadata, &contact, fields, earlier);
    std::fs::write(folder.join("file"), "").unwrap();
    t.row(create("file", &[Field::Pressure], Earlier::Refuse), File, "… cannot be written: it is a file, and frames need a folder");
    t.row(create("twice", &[Field::Gap; 2], Earlier::Refuse), File, "… cannot be written: the field gap is requested twice");
    create("frames", &[Field::Pressure], Earlier::Refuse).unwrap().record(&contact).unwrap();
    std::fs::write(folder.join("frames").join("frame_000000.npz"), "no frame").unwrap();
    t.row(create("frames", &[Field::Pressure], Earlier::Continue), File, "…frame_000000.npz cannot be written: it is no frame to continue from…");

    let chart = |points: Vec<(f64, f64)>, name: &str| {
        let mut chart = Chart::new("title", Quantity::new("time", "s"), Quantity::new("force", "N"), Legend::UpperLeft);
        chart.add("", Color(190, 190, 190), Style::Line, points);
        chart.save(folder.join(name))
    };
    t.row(chart(vec![], "a.png"), Value, "points to draw in the chart: 0 given, at least 1 needed");
    t.row(chart(vec![(0.0, 1.0), (1.0, 1.0e101)], "a.png"), Value, "y of a point in a chart = 1e101 → finite and at most 1e100…");
    t.row(chart(vec![(0.0, 1.0), (1.0, 2.0)], "a.jpg"), File, "…: the extension must be .png or .svg");
    t.row(chart(vec![(0.0, 1.0), (1.0, 2.0)], "none/a.png"), File, "… cannot be written: the folder …does not exist: create it first");
    t.row(Chart::profile(&contact, Axis::X1, 5.0e-3), Value, "coordinate of the profile = … → inside the grid");
    let map = |range: [f64; 2]| {
        let mut map = Map::new(&grid, field.clone(), Quantity::new("pressure", "Pa")).unwrap();
        map.range = range;
        map
    };
    for (range, says) in [([1.0, 1.0], "upper end of the colour scale = 1.0 → above the lower end"), ([NAN, 1.0], "lower end of the colour scale = NaN → finite and at most 1e100…")] {
        t.row(map(range).save(folder.join("a.png")), Value, says);
        t.row(Map::draw_row(&[map([0.0, 1.0]), map(range)]), Value, says);
    }
    t.row(Map::draw_row(&[]), Value, "maps of a row: 0 given, at least 1 needed");
    t.row(Map::draw_row(&(0..40).map(|_| map([0.0, 1.0])).collect::<Vec<_>>()), Value, "pixels along a side of a picture = 23955 → in [1, 16384]");
}

const ZENER: [(&str, f64); 3] = [("E0", 2.0e3), ("Einf", 5.0e2), ("tau", 0.2)];

/// A curve of these forces, while the drive moves straight from one position to another.
fn curve(drive: [f64; 2], force: Vec<f64>, tip: Arc<ElasticStates>) -> Curve {
    let last = (force.len() - 1) as f64;
    let times: Vec<f64> = (0..force.len()).map(|k| 0.01 * k as f64).collect();
    let drive = (0..force.len()).map(|k| drive[0] + (drive[1] - drive[0]) * k as f64 / last).collect();
    Curve::new(Experiment::new(Protocol::new(times, drive).unwrap(), tip), force).unwrap()
}

fn respond(model: Model, values: &[(&str, f64)], experiment: &Experiment) -> Curve {
    let force = Identification::new(model).respond(experiment, values).unwrap();
    Curve::new(experiment.clone(), force.iter().map(|sample| sample.force).collect()).unwrap()
}

#[rustfmt::skip]
pub(super) fn fits(t: &mut Table) {
    let tip = || ElasticStates::sphere(5.0e-6).unwrap();
    let experiment = Experiment::new(Protocol::ramp_hold_retract(5.0e-6, [0.5e-6, 1.0e-6], 1.0, 0.01).unwrap(), tip());
    let zener = Identification::new(Model::Zener);
    // a law whose instantaneous modulus is beyond the range of a material
    let steep = Model::PowerLaw { cutoff: 1.0e-300 };
    let loaded = respond(steep, &[("E1", 1.0e3), ("alpha", 0.5)], &experiment);
    t.row(Identification::new(steep).fit(&[loaded]).unwrap().material(), Value, "relaxing modulus = …e152 → 0, or in [1e-100, 1e100]");
    let infinite = Law { name: "infinite", parameters: &["E0", "tau"], modulus: |of, t| of[0] * (t / of[1]).powf(-0.3) };
    let of_infinite = Identification::new(Model::Custom(infinite)).respond(&experiment, &[("E0", 1.0e3), ("tau", 1.0)]);
    t.row(of_infinite, Value, "modulus of the law = -inf → finite at all times from t = 0 on");
    let maps = [respond(Model::Zener, &ZENER, &experiment), curve([0.0, 1.0e-6], vec![0.0; 100], tip())];
    let lists = zener.clone().contact_point(vec![Nuisance::Fitted; 3]).fit_each(&maps, |_| {});
    t.row(lists.into_iter().last().unwrap(), Value, "contact point: 3 given, 2 needed");
    let [first, second] = <[_; 2]>::try_from(zener.fit_each(&maps, |_| {})).unwrap();
    assert!(first.is_ok());
    t.row(second, Value, "curve 0: the force nowhere rises…: check the sign of the force…");
    let bounds = |of: &Identification, values: &[(&str, f64)], sigma: f64| of.bounds(std::slice::from_ref(&experiment), values, sigma);
    for (values, says) in [
        (vec![("E0", -4.0e3), ZENER[1], ZENER[2]], "E0 = -4000.0 → finite and > 0"),
        (vec![("E0", 1.0e2), ZENER[1], ZENER[2]], "Einf = 500.0 → at most E0"),
        (vec![ZENER[0], ZENER[1]], "the parameter 'tau' is given 0 values: give it exactly one"),
        (vec![ZENER[0], ZENER[1], ("lambda", 0.2)], "there is no parameter 'lambda': the names are E0, Einf, tau"),
    ] {
        t.row(bounds(&zener, &values, 1.0e-11), Value, says);
        t.row(zener.respond(&experiment, &values), Value, says);
    }
    t.row(bounds(&zener, &ZENER, 0.0), Value, "standard deviation of the noise = 0.0 → finite and > 0");
    t.row(bounds(&zener.clone().noise(Noise::Autoregressive), &ZENER, 1.0e-11), Value, "bounds need the correlation…take Noise::AutoregressiveWith");
    let table = ElasticStates::from_table(&[(1e-15, 1e-9, 1e-7, 1e-14), (1e-12, 1e-7, 1e-6, 1e-12)]).unwrap();
    let shallow = Experiment::new(experiment.protocol().clone(), table.clone());
    t.row(zener.bounds(&[shallow], &ZENER, 1.0e-11), Value, "curve 0: the depth of 1.50e-7 m is beyond…: sweep it further…");
    t.row(curve([1.0e-6, 0.0], vec![1.0e-9; 50], tip()).approach(), Value, "samples of the segment = 1 → 2 or more");
    t.row(tips::sphere(1.0e200), Value, "sphere radius = 1e200 → in [1e-100, 1e100] m");
    let rising = |count: i32, sign: f64| (0..count).map(|k| sign * 1.0e-9 * f64::from(k)).collect::<Vec<_>>();
    let modulus = |count: i32, sign: f64, tip, part| usual::loading_modulus(&curve([0.0, 1.0e-6], rising(count, sign), tip), part);
    t.row(modulus(4, 1.0, tip(), None), Value, "points that are read = 4 → 5 or more: measure at a higher rate");
    t.row(modulus(50, 1.0, table, Some(0.0)), Value, "curve 0: the depth of 1.00e-6 m is beyond…: sweep it further…");
    t.row(modulus(50, -1.0, tip(), None), Value, "curve 0: the force nowhere rises…: check the sign of the force…");
}
