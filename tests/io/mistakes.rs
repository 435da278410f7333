//! What typical mistakes print: the value, its range, and the remedy.

use std::path::PathBuf;

use crate::common::bodies::{elastic, maxwell};
use crate::common::spheres::{builder_of, builder_on, sphere};
use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
use viscocontact::prelude::*;
use viscocontact::rheology::{Experiment, Units};
use viscocontact::{Result, TextFormat};

const TIMES: [f64; 5] = [0.1, 1.0, 10.0, 100.0, 1000.0];

fn grid() -> Grid {
    Grid::square(32, 4.0e-3).unwrap()
}

fn elastic_body() -> Elastic {
    Elastic::new(1.0e6).unwrap()
}

fn contact() -> Result<ViscoelasticContact> {
    builder_on(grid(), maxwell()).build()
}

fn built(rheology: impl Rheology + 'static) -> Result<ViscoelasticContact> {
    builder_on(grid(), Material::incompressible(rheology)).build()
}

fn built_with(settings: Settings) -> Result<ViscoelasticContact> {
    builder_on(grid(), maxwell()).settings(settings).build()
}

fn falling() -> Material {
    Material::incompressible(FnRheology::new(|t| 1.0e-6 / (1.0 + t)))
}

fn punch() -> Result<ViscoelasticContact> {
    builder_of(&FlatPunch::circular(1.0e-3)?, grid(), elastic()).build()
}

fn two_bodies() -> Result<ViscoelasticContact> {
    let punch = |at: f64| Shifted::new(FlatPunch::circular(0.5e-3).unwrap(), [at, 0.0]);
    builder_of(&punch(-1.0e-3)?, grid(), elastic()).another_body(&punch(1.0e-3)?).build()
}

fn flattened() -> Result<StepReport> {
    let wave = Wavy::new(1.0e-6, 4.0e-3)?;
    let kernel = InfluenceKernel::periodic(&grid())?;
    builder_of(&wave, grid(), elastic()).kernel(kernel).build()?.step(0.0, Load::approach(1.0e-5))
}

fn jump_in_a_closure() -> Result<()> {
    let mut contact = built(KelvinVoigt::new(1.0e6, 1.0e6)?)?;
    let jump = FnHistory::new(|t| Load::force(if t < 0.3 { 0.3 * t } else { 0.5 }));
    let mut run = contact.follow(&jump, Stepping::adaptive(1e-3), 1.0);
    while run.next_step()?.is_some() {}
    Ok(())
}

fn stop() -> Result<()> {
    let hold = StepLoad::new(Load::force(0.1))?;
    contact()?.follow(&hold, Stepping::fixed(0.1), 2.0).stop_at([f64::NAN]).map(drop)
}

fn beyond_the_table() -> Result<StepReport> {
    let table = Measurements::creep(&TIMES.map(|t: f64| (t, 1.0e-6 * (1.0 + 0.1 * t.ln_1p()))))?.fit()?;
    let mut contact = built(table)?;
    contact.step(0.0, Load::force(0.1))?;
    contact.step(1.0e4, Load::force(0.1))
}

fn csv(text: &str) -> Result<Measurements> {
    Measurements::from_csv_reader(Experiment::Relaxation, text.as_bytes(), Units::SI, TextFormat::default())
}

/// A file that exists, in a folder of this process.
fn path(name: &str) -> Result<PathBuf> {
    let path = folder().join(name);
    std::fs::write(&path, "").unwrap();
    Ok(path)
}

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("viscocontact-mistakes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn frames_again() -> Result<FrameSeries> {
    let (folder, metadata) = (folder().join("frames"), Metadata::new(""));
    let fields = [Field::Pressure];
    let again = |earlier| FrameSeries::create(&folder, Format::Npz, &metadata, &contact()?, &fields, earlier);
    again(Earlier::Replace)?.record(&contact()?)?;
    again(Earlier::Refuse)
}

fn resumed() -> Result<()> {
    let path = folder().join("saved.ckpt");
    contact()?.save(&path)?;
    builder_on(Grid::square(48, 4.0e-3)?, maxwell()).build()?.resume(&path)
}

/// The code of an error, a mistake, what it returns, and what it prints.
type Mistake = (&'static str, &'static str, fn() -> Result<()>, &'static str);

#[rustfmt::skip]
const MISTAKES: &[Mistake] = &[
("out_of_range", "a negative modulus", || Maxwell::new(-1.0e6, 1.0e6).map(drop), "shear modulus = -1000000.0 is not allowed: it must be finite and > 0"),
("out_of_range", "a Poisson's ratio above 1/2", || Material::constant_poisson(elastic_body(), 0.7).map(drop), "Poisson's ratio = 0.7 is not allowed: it must be in (-1, 0.5]"),
("out_of_range", "a radius that is not a number", || Sphere::new(f64::NAN).map(drop), "sphere radius = NaN is not allowed: it must be finite, > 0 and at most 1e300 m"),
("count_out_of_range", "a grid without cells", || Grid::square(0, 4.0e-3).map(drop), "cells along x1 = 0 is not allowed: it must be 1 or more"),
("out_of_memory", "a grid of more cells than memory", || builder_on(Grid::square(1_000_000, 4.0e-3)?, elastic()).build().map(drop), "gap and pressure of a contact needs 16000000000000 bytes (16000.0 GB), more than is available: take fewer cells; a contact computes fewer of them with Settings::symmetry and Settings::window"),
("out_of_range", "a length of zero", || Grid::new([64, 64], [4.0e-3, 0.0]).map(drop), "length along x2 = 0.0 is not allowed: it must be finite and > 0"),
("missing", "no shape", || ViscoelasticContact::builder(grid()).material(elastic()).build().map(drop), "a contact needs geometry: call Builder::geometry before build"),
("missing", "no material", || ViscoelasticContact::builder(grid()).geometry(&sphere()).build().map(drop), "a contact needs material: call Builder::material before build"),
("nothing_to_touch", "a body beside the grid", || builder_of(&Shifted::new(FlatPunch::circular(1.0e-3)?, [1.0, 0.0])?, grid(), elastic()).build().map(drop), "body 0 is the lowest body with a finite gap on none of the 1024 cells of the grid: it can touch nothing; compare its position and size with Grid::lengths"),
("invalid_gap", "a shape by a root of negative numbers", || builder_of(&FnGeometry::new(|x1: f64, x2: f64| (x1 - x2).sqrt()), grid(), elastic()).build().map(drop), "the initial gap at cell [0, 1], x = (-0.0019375, -0.0018125) m, is NaN: it must be finite, or +inf where there is no body; points of a map that were not measured are filled by HeightMap::filled or left out by HeightMap::masked"),
("material_no_exponential_series", "a closure of compliance without times", || builder_on(grid(), Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())))).build().map(drop), "a contact needs an exponential series, and FnRheology { .. } has no exact one: name the times to fit one over, with Builder::times (first and last) or Builder::times_of (a load history and its end), or fit one with Rheology::series or Material::fitted"),
("material_invalid_compliance", "a compliance that falls", || builder_on(grid(), falling()).times(1e-2..=1e2).build().map(drop), "creep compliance J(0.01 s) = 9.90099e-7 1/Pa is not allowed: it must be finite, ≥ 0 (> 0 after t = 0) and non-decreasing (J was 1e-6 before)"),
("no_elastic_response", "a jump of a body without elastic response", || built(KelvinVoigt::new(1.0e6, 1.0e6)?)?.step(0.0, Load::force(0.1)).map(drop), "at t = 0 s: a jump of the load that changes the pressure needs an elastic response, but the material has none (its compliance at t = 0 is zero); ramp the load over a short time or add a glassy compliance"),
("out_of_range", "a tensile force", || contact()?.step(0.0, Load::force(-0.1)).map(drop), "normal force = -0.1 is not allowed: it must be finite and >= 0"),
("out_of_range", "a step back in time", || contact()?.step(-0.1, Load::force(0.1)).map(drop), "time step = -0.1 is not allowed: it must be finite and >= 0"),
("contact_at_edge", "a load too great for the grid", || contact()?.step(0.0, Load::force(20.0)).map(drop), "at t = 0 s the contact touches the edge of the grid on 124 cells; the grid is 0.004 m × 0.004 m, the load needs about 0.0065 m × 0.0065 m: enlarge the grid, give a surface that repeats a periodic body (InfluenceKernel::periodic), or set Settings::edge to Edge::Allow if the body ends there"),
("load_outside_hull", "a load beside the punch", || punch()?.step(0.0, Load::eccentric_force(1.0, [1.5e-3, 0.0])).map(drop), "at t = 0 s the load acts at (0.0015, 0) m, outside the convex hull of the cells that body 0 may touch: it would tip over; move it inside, or prescribe the tilt"),
("wrong_length", "one load for two bodies", || two_bodies()?.step(0.0, Load::force(0.1)).map(drop), "loads of the rigid bodies: 1 given, 2 needed"),
("not_covered", "a motion over the bodies on a grid that stays on them", || contact()?.step_over([1, 0], 0.1, Load::force(0.1)).map(drop), "a step over the bodies is not covered on a grid that is fixed to the bodies: choose the other Frame with Settings::with_frame"),
("not_converged", "too few iterations", || built_with(Settings::default().with_max_iterations(2).with_tolerance(1e-12))?.step(0.0, Load::force(0.1)).map(drop), "at t = 0 s (step of 0 s): residual 8.10e-6 after 2 iterations, above the tolerance 1e-12; it may fall further: raise Settings::max_iterations"),
("out_of_range", "a tolerance of 1", || built_with(Settings::default().with_tolerance(1.0)).map(drop), "Settings::tolerance = 1.0 is not allowed: it must be in [1e-13, 0.1]"),
("kernel_wrong_grid", "a kernel of another grid", || builder_on(grid(), elastic()).kernel(InfluenceKernel::half_space(&Grid::square(32, 5.0e-3)?)?).build().map(drop), "the kernel was made for 32 × 32 cells of 1.5625e-4 m × 1.5625e-4 m, the contact has 32 × 32 of 1.25e-4 m × 1.25e-4 m: make it for the grid of the contact"),
("other_contact", "a snapshot of another contact", || contact()?.restore(&contact()?.snapshot()).map(drop), "the snapshot was taken of another contact: only snapshots of the contact or of a clone can be restored"),
("beyond_full_contact", "a periodic wave pressed deeper than flat", || flattened().map(drop), "at t = 0 s the approach 1e-5 m is not below 1e-6 m, that of full contact, which no pressure can exceed on a periodic body: prescribe the force"),
("load_mixed_kinds", "a ramp from a force to an approach", || Ramp::new(Load::force(0.1), Load::approach(1.0e-5), 1.0).map(drop), "the load table mixes loads of different kinds (a force, tilts prescribed; an approach, tilts prescribed), which cannot be interpolated: take loads of one kind, and a run for each kind"),
("step_too_short", "a jump inside a closure", || jump_in_a_closure().map(drop), "at t = 0.3 s no step that f64 resolves keeps the error in time below 1e-3: name the time of a jump inside a closure with FnHistory::with_breakpoints, ramp the load, allow a greater error, or approach a body that resists rates alone by a spring"),
("out_of_range", "a stop that is not a number", || stop().map(drop), "time to stop at or to sample = NaN is not allowed: it must be between the start and the end of the run"),
("out_of_range", "an accuracy in per cent", || Study::new(|grid, settings| Ok(builder_on(grid, elastic()).settings(settings)), &StepLoad::new(Load::force(0.1))?, 1.0).accuracy(5.0).run().map(drop), "accuracy = 5.0 is not allowed: it must be in [1e-6, 0.1]"),
("table_out_of_range", "a negative compliance", || Measurements::creep(&[(0.1, 1.0e-6), (1.0, 1.1e-6), (10.0, -1.2e-6), (100.0, 1.3e-6)]).map(drop), "creep table, entry 2: creep compliance = -1.2e-6 is not allowed: it must be finite and > 0; leave out rows without a value"),
("wrong_length", "a table of two rows", || Measurements::creep(&[(0.1, 1.0e-6), (1.0, 1.1e-6)]).map(drop), "creep table: 2 given, at least 4 needed"),
("table_wrong_way", "a relaxation table read as creep", || Measurements::creep(&TIMES.map(|t: f64| (t, 1.0e6 / (1.0 + t))))?.fit().map(drop), "creep table, entry 0: creep compliance = 909091 deviates by 200.84 % from the nearest monotone curve, where the scatter of the data explains 10.00 %: compliances rise, moduli of relaxation fall (Experiment); Measurements::with_scatter states more scatter"),
("beyond_material", "a step beyond the table", || beyond_the_table().map(drop), "at t = 10000 s the loading time 10000 s exceeds the range in which the material is known, 1000 s: fit its series over longer times (Builder::times), or extrapolate its table (CreepSeries::extrapolated)"),
("unreadable", "a table in a file that is not there", || Measurements::from_csv(Experiment::Creep, "no/such.csv", Units::SI, TextFormat::default()).map(drop), "no/such.csv cannot be read: No such file or directory (os error 2)"),
("table_unit", "a table in MPa read as Pa", || csv("time [s],G [MPa]\n1,3\n2,2\n3,1\n").map(drop), "line 1, column 2: the heading \"G [MPa]\" says MPa, but Units::value = 1 means Pa; of MPa it is 1e6"),
("text_decimal_mark", "decimal commas", || csv("1,000;3,500\n2,000;2,500\n3,000;1,500\n").map(drop), "line 1, column 1: \"1,000\" is not a number with TextFormat::with_decimal_comma = false: state the other value, or remove separators of thousands"),
("material_unknown", "a material that is not in the library", || viscocontact::rheology::library::find("nylon").map(drop), "there is no published material named \"nylon\"; known are: PMMA, epoxy, adhesive, polyisobutylene, polystyrene rings"),
("map_extension", "an image as a height map", || HeightMap::read("surface.png").map(drop), "surface.png: the extension must be gsf, sdf, sur, pro or x3p; other formats do not store the side lengths of a map: use HeightMap::from_npy, from_text or from_xyz; instrument formats (.opd, .ibw, .spm, .tif) are exported as GSF by Gwyddion"),
("invalid_gap", "a map with missing points", || builder_of(&HeightMap::new([2, 2], [1e-3; 2], vec![0.0, 1e-6, f64::NAN, 0.0])?, grid(), elastic()).build().map(drop), "the initial gap at cell [12, 12], x = (-4.375e-4, -4.375e-4) m, is NaN: it must be finite, or +inf where there is no body; points of a map that were not measured are filled by HeightMap::filled or left out by HeightMap::masked"),
("map_too_fine", "a roughness finer than the mesh", || Rough::new(&grid(), RoughSpec::new(4.0e-3, 1.0e-6, Roughness::RmsHeight(1.0e-6))).map(drop), "shortest wavelength = 1e-6 m is not allowed: it must be at least two cells of the grid, which are 2.5e-4 m along x1: take a longer wavelength, or 8000 cells along x1"),
("output", "a history in a file that exists", || CsvHistory::create(path("taken.csv")?, &Metadata::new(""), &contact()?, &[], Earlier::Refuse).map(drop), "FOLDER/taken.csv cannot be written: it exists: Earlier::Replace replaces it"),
("output", "frames in a folder that holds frames", || frames_again().map(drop), "FOLDER/frames cannot be written: the folder contains frame_000000.npz of another run: Earlier::Replace removes it"),
("output", "a history in a folder that is not there", || CsvHistory::create("no/such/history.csv", &Metadata::new(""), &contact()?, &[], Earlier::Refuse).map(drop), "no/such/history.csv cannot be written: the folder no/such does not exist: create it first"),
("extension", "a picture in a format that is not drawn", || viscocontact::plot::Map::of(&contact()?, Field::Pressure)?.save("pressure.pdf").map(drop), "pressure.pdf: the extension must be .png or .svg"),
("checkpoint_other_scene", "a checkpoint of another scene", || resumed().map(drop), "no run can be resumed from FOLDER/saved.ckpt: the checkpoint is of another scene: its grid differs from that of the contact: build the contact as it was saved"),
];

#[test]
fn typical_mistakes_print_value_range_and_cure() {
    let place = folder().display().to_string();
    let mut others = Vec::new();
    for (code, mistake, make, expected) in MISTAKES {
        let (found, printed) = match make() {
            Ok(()) => ("no error", "nothing".to_owned()),
            Err(error) => (error.code(), format!("{error:?}").replace(&place, "FOLDER")),
        };
        if found != *code || printed != *expected {
            others.push(format!("{mistake}\n\t{found}: {printed}"));
        }
    }
    let _ = std::fs::remove_dir_all(folder());
    assert!(others.is_empty(), "{}", others.join("\n"));
}
