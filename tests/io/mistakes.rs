//! What typical mistakes print: the value, its range, and the cure.

use std::path::PathBuf;

use crate::common::bodies::{elastic, maxwell};
use crate::common::spheres::{builder_of, builder_on, sphere};
use viscocontact::output::{Field, Format, FrameSeries, Metadata};
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
    contact()?.follow(&hold, Stepping::fixed(0.1), 2.0).stop_at(&[f64::NAN]).map(drop)
}

fn beyond_the_table() -> Result<StepReport> {
    let table = Measurements::creep(&TIMES, &TIMES.map(|t: f64| 1.0e-6 * (1.0 + 0.1 * t.ln_1p())))?.fit()?;
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
    FrameSeries::create_or_replace(&folder, Format::Npz, &metadata, &fields)?.write(&contact()?)?;
    FrameSeries::create(&folder, Format::Npz, &metadata, &fields)
}

fn resumed() -> Result<()> {
    let path = folder().join("saved.ckpt");
    contact()?.save(&path)?;
    builder_on(Grid::square(48, 4.0e-3)?, maxwell()).build()?.resume(&path)
}

/// A mistake, what it returns, and what it prints.
type Mistake = (&'static str, fn() -> Result<()>, &'static str);

#[rustfmt::skip]
const MISTAKES: &[Mistake] = &[
("a negative modulus",
    || Maxwell::new(-1.0e6, 1.0e6).map(drop),
    ""),
("a Poisson's ratio above 1/2",
    || Material::constant_poisson(elastic_body(), 0.7).map(drop),
    ""),
("a radius that is not a number",
    || Sphere::new(f64::NAN).map(drop),
    ""),
("a grid without cells",
    || Grid::square(0, 4.0e-3).map(drop),
    ""),
("a grid of more cells than memory",
    || builder_on(Grid::square(1_000_000, 4.0e-3)?, elastic()).build().map(drop),
    ""),
("a length of zero",
    || Grid::new([64, 64], [4.0e-3, 0.0]).map(drop),
    ""),
("no shape",
    || ViscoelasticContact::builder(grid()).material(elastic()).build().map(drop),
    ""),
("no material",
    || ViscoelasticContact::builder(grid()).geometry(&sphere()).build().map(drop),
    ""),
("a body beside the grid",
    || builder_of(&Shifted::new(FlatPunch::circular(1.0e-3)?, [1.0, 0.0])?, grid(), elastic()).build().map(drop),
    ""),
("a shape by a root of negative numbers",
    || builder_of(&FnGeometry::new(|x1: f64, x2: f64| (x1 - x2).sqrt()), grid(), elastic()).build().map(drop),
    ""),
("a closure of compliance without times",
    || builder_on(grid(), Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())))).build().map(drop),
    ""),
("a compliance that falls",
    || builder_on(grid(), falling()).times(1e-2..=1e2).build().map(drop),
    ""),
("a jump of a body without elastic response",
    || built(KelvinVoigt::new(1.0e6, 1.0e6)?)?.step(0.0, Load::force(0.1)).map(drop),
    ""),
("a tensile force",
    || contact()?.step(0.0, Load::force(-0.1)).map(drop),
    ""),
("a step back in time",
    || contact()?.step(-0.1, Load::force(0.1)).map(drop),
    ""),
("a load too great for the grid",
    || contact()?.step(0.0, Load::force(20.0)).map(drop),
    ""),
("a load beside the punch",
    || punch()?.step(0.0, Load::eccentric_force(1.0, [1.5e-3, 0.0])).map(drop),
    ""),
("one load for two bodies",
    || two_bodies()?.step(0.0, Load::force(0.1)).map(drop),
    ""),
("a motion over the bodies on a grid that stays on them",
    || contact()?.step_over([1, 0], 0.1, Load::force(0.1)).map(drop),
    ""),
("too few iterations",
    || built_with(Settings::default().with_max_iterations(2).with_tolerance(1e-12))?.step(0.0, Load::force(0.1)).map(drop),
    ""),
("a tolerance of 1",
    || built_with(Settings::default().with_tolerance(1.0)).map(drop),
    ""),
("a kernel of another grid",
    || builder_on(grid(), elastic()).kernel(InfluenceKernel::half_space(&Grid::square(32, 5.0e-3)?)?).build().map(drop),
    ""),
("a snapshot of another contact",
    || contact()?.restore(&contact()?.snapshot()).map(drop),
    ""),
("a periodic wave pressed deeper than flat",
    || flattened().map(drop),
    ""),
("a ramp from a force to an approach",
    || Ramp::new(Load::force(0.1), Load::approach(1.0e-5), 1.0).map(drop),
    ""),
("a jump inside a closure",
    || jump_in_a_closure().map(drop),
    ""),
("a stop that is not a number",
    || stop().map(drop),
    ""),
("an accuracy in per cent",
    || Accuracy::new(5.0).map(drop),
    ""),
("times that are not sorted",
    || Measurements::creep(&[1.0, 2.0, 4.0, 3.0], &[1.0e-6, 1.1e-6, 1.3e-6, 1.2e-6]).map(drop),
    ""),
("columns of different lengths",
    || Measurements::creep(&TIMES, &[1.0e-6, 1.1e-6]).map(drop),
    ""),
("a relaxation table read as creep",
    || Measurements::creep(&TIMES, &TIMES.map(|t: f64| 1.0e6 / (1.0 + t)))?.fit().map(drop),
    ""),
("a step beyond the table",
    || beyond_the_table().map(drop),
    ""),
("a table in a file that is not there",
    || Measurements::from_csv(Experiment::Creep, "no/such.csv", Units::SI, TextFormat::default()).map(drop),
    ""),
("a table in MPa read as Pa",
    || csv("time [s],G [MPa]\n1,3\n2,2\n3,1\n").map(drop),
    ""),
("decimal commas",
    || csv("1,0;3,5\n2,0;2,5\n3,0;1,5\n").map(drop),
    ""),
("a material that is not in the library",
    || viscocontact::rheology::library::find("nylon").map(drop),
    ""),
("an image as a height map",
    || HeightMap::read("surface.png").map(drop),
    ""),
("a map with missing points",
    || builder_of(&HeightMap::new([2, 2], [1e-3; 2], vec![0.0, 1e-6, f64::NAN, 0.0])?, grid(), elastic()).build().map(drop),
    ""),
("a roughness finer than the mesh",
    || Rough::new(&grid(), RoughSpec::new(4.0e-3, 1.0e-6, Roughness::RmsHeight(1.0e-6))).map(drop),
    ""),
("a history in a file that exists",
    || CsvHistory::create(path("taken.csv")?, &Metadata::new(""), &contact()?, &[]).map(drop),
    ""),
("frames in a folder that holds frames",
    || frames_again().map(drop),
    ""),
("a history in a folder that is not there",
    || CsvHistory::create("no/such/history.csv", &Metadata::new(""), &contact()?, &[]).map(drop),
    ""),
("a picture in a format that is not drawn",
    || viscocontact::plot::Map::pressure(&contact()?)?.save("pressure.pdf").map(drop),
    ""),
("a checkpoint of another scene",
    || resumed().map(drop),
    ""),
];

#[test]
fn typical_mistakes_print_value_range_and_cure() {
    let place = folder().display().to_string();
    let mut others = Vec::new();
    for (mistake, make, expected) in MISTAKES {
        let printed = match make() {
            Ok(()) => "nothing".to_owned(),
            Err(error) => format!("{error:?}").replace(&place, "FOLDER"),
        };
        if printed != *expected {
            others.push(format!("{mistake}\n\t{printed}"));
        }
    }
    let _ = std::fs::remove_dir_all(folder());
    assert!(others.is_empty(), "{}", others.join("\n"));
}
