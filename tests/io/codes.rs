//! Every error has a code of its own, and a test provokes it: here, or where its code is asserted.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::Arc;

use super::house::{code, files};
use crate::common::{builder_of, builder_on, elastic, maxwell, sphere_on};
use viscocontact::Result;
use viscocontact::TextFormat;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::analytic::GrowingSphere;
use viscocontact::friction::{Coulomb, FrictionContact, ShearHistory};
use viscocontact::input::TextTable;
use viscocontact::parallel::{Ranks, Threads};
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, Experiment, Isotherm, MasterCurve};

fn grid() -> Grid {
    Grid::square(16, 4.0e-3).unwrap()
}

fn contact() -> ViscoelasticContact {
    sphere_on(grid(), maxwell(), Settings::default())
}

fn states() -> Result<StatesContact> {
    StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &elastic())
}

fn sticky(range: f64) -> Result<ViscoelasticContact> {
    let settings = Settings::default().with_edge(Edge::Allow);
    let builder = builder_of(&Sphere::new(1.0)?, Grid::square(24, 8.0)?, Material::incompressible(Elastic::new(0.25)?));
    builder.attraction(ExponentialAttraction::new(1.0, range)?).settings(settings).build()
}

/// A plate on an elastic foundation, which bends away from the middle of its contact.
fn shrinking() -> Result<()> {
    let grid = Grid::square(48, 1.0)?;
    let plate = |q1: f64, q2: f64| 1.0 / (1.0 + (0.065 * f64::hypot(q1, q2)).powi(4)) + 1e-4;
    let kernel = Arc::new(InfluenceKernel::from_spectrum(&grid, plate)?);
    Sweep::new(grid, &Sphere::new(1.5)?).kernel(kernel).accuracy(1e-2).run(Reach::Level(1.5e-3)).map(drop)
}

fn followed(load: impl LoadHistory) -> Result<()> {
    let mut contact = contact();
    let mut run = contact.follow(&load, Stepping::fixed(0.2), 1.0);
    while run.next_step()?.is_some() {}
    Ok(())
}

fn ranks(job: impl Fn(usize, &mut ViscoelasticContact) -> Result<()> + Sync) -> Result<()> {
    let of_rank = |ranks: Arc<dyn Ranks>| {
        let number = ranks.rank();
        builder_on(grid(), maxwell()).ranks(ranks).build().and_then(|mut contact| job(number, &mut contact))
    };
    Threads::run(2, of_rank)?.into_iter().collect()
}

fn isotherm(experiment: Experiment, kelvin: f64, value: impl Fn(f64) -> f64) -> Result<Isotherm> {
    let rows = [0.1, 1.0, 10.0, 100.0, 1000.0].map(|t| (t, value(t)));
    let table =
        if experiment == Experiment::Creep { Measurements::creep(&rows) } else { Measurements::relaxation(&rows) };
    Isotherm::new(kelvin, table?)
}

fn map(text: &str) -> Result<()> {
    let format = TextFormat::default();
    HeightMap::from_text(text.as_bytes(), [1.0, 1.0], LengthUnit::Metre, format).map(drop)
}

fn points(text: &str) -> Result<()> {
    HeightMap::from_xyz(text.as_bytes(), LengthUnit::Metre, LengthUnit::Metre, TextFormat::default()).map(drop)
}

/// The series of another body than its creep.
#[derive(Debug)]
struct Split;

impl Rheology for Split {
    fn creep_compliance(&self, _: f64) -> f64 {
        1.0e-6
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        CreepSpectrum::new(2.0e-6, 0.0, &[]).ok()
    }
}

/// A writer without room.
struct Full;

impl std::io::Write for Full {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(std::io::Error::other("the disk is full"))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

type Provoked = (&'static str, fn() -> Result<()>);

#[rustfmt::skip]
const PROVOKED: &[Provoked] = &[
    ("cancelled", || contact().step_unless(&true.into(), 0.0, Load::force(0.1)).map(drop)),
    ("checkpoint_unreadable", || contact().resume("no/such/file")),
    ("friction_other_load", || {
        let spring = StepLoad::new(Load::spring(1.0, 0.1))?;
        let contact = FrictionContact::new(builder_on(grid(), elastic()), Coulomb::new(0.5)?)?;
        let mut contact = contact.sheared_by(ShearHistory::new(spring, spring));
        contact.follow(&StepLoad::new(Load::force(0.1))?, Stepping::fixed(0.5), 1.0).next_step().map(drop)
    }),
    ("load_out_of_range", || followed(FnHistory::new(|t| Load::force(0.1 - t)))),
    ("load_wrong_kind", || GrowingSphere::new(1.0, &elastic(), StepLoad::new(Load::approach(0.1))?).map(drop)),
    ("map_duplicate", || points("0 0 1\n1 0 1\n0 1 1\n1 1 1\n1 1 2\n")),
    ("map_not_finite", || HeightMap::new([2, 1], [1.0, 1.0], vec![0.0, f64::INFINITY]).map(drop)),
    ("map_nothing_known", || HeightMap::new([2, 1], [1.0, 1.0], vec![f64::NAN; 2])?.filled().map(drop)),
    ("map_stand_in", || map("1 2 3\n4 -9999 6\n")),
    ("map_unwritable", || HeightMap::new([2, 2], [1.0, 1.0], vec![0.0; 4])?.write_gsf(Full)),
    ("material_other_series", || builder_on(grid(), Material::incompressible(Split)).build().map(drop)),
    ("out_of_order", || PiecewiseLinear::new(&[(0.0, Load::force(1.0)), (-1.0, Load::force(1.0))]).map(drop)),
    ("overflow", || contact().step(0.0, Load::force(1.0e308)).map(drop)),
    ("pulled_off", || sticky(1.0)?.step(1.0, Load::force(-20.0)).map(drop)),
    ("rank_failed", || ranks(|_, contact| contact.save("no/such/folder/file"))),
    ("rank_left", || ranks(|rank, contact| if rank == 0 { Ok(()) } else { contact.step(0.1, Load::force(0.1)).map(drop) })),
    ("ranks_apart", || ranks(|rank, contact| contact.step(0.1, Load::force(0.1 + 0.1 * rank as f64)).map(drop))),
    ("shrinks", shrinking),
    ("slides", || {
        let mut contact = states()?.with_estimated_friction(0.5)?;
        contact.step_sheared(0.1, Load::force(0.1), Load::force(0.2)).map(drop)
    }),
    ("states_other_tilt", || states()?.step(0.1, Load::eccentric_force(0.1, [1.0e-4, 0.0])).map(drop)),
    ("study_name", || {
        let (load, scene) = (StepLoad::new(Load::force(0.1))?, |grid, _| Ok(builder_on(grid, elastic())));
        Study::new(scene, &load, 1.0).ask_own("a, b", |_| 0.0).run().map(drop)
    }),
    ("table_mixed_isotherms", || {
        let moduli = isotherm(Experiment::Relaxation, 300.0, |t| 1.0e6 / (1.0 + t))?;
        let compliances = isotherm(Experiment::Creep, 320.0, |t| 1.0e-6 * (1.0 + t))?;
        MasterCurve::new(300.0, vec![moduli, compliances]).map(drop)
    }),
    ("table_no_overlap", || {
        let [cold, warm] = [(300.0, 1.0e9), (330.0, 1.0e3)].map(|(kelvin, modulus)| {
            isotherm(Experiment::Relaxation, kelvin, |t| modulus * (2.0 - 0.1 * t.log10()))
        });
        MasterCurve::new(300.0, vec![cold?, warm?]).map(drop)
    }),
    ("table_nothing_to_shift", || {
        let [cold, warm] = [300.0, 330.0].map(|kelvin| isotherm(Experiment::Relaxation, kelvin, |_| 1.0e6));
        MasterCurve::new(300.0, vec![cold?, warm?]).map(drop)
    }),
    ("text_preamble", || TextTable::read(&b"1;2\n3;4\nt;J\n1;2\n3;4\n5;6\n"[..], TextFormat::default()).map(drop)),
    ("through_layer", || {
        let kernel = InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(1.0e-4, 0.3)?)?;
        let body = Material::constant_poisson(Elastic::new(1.0e6)?, 0.3)?;
        let mut contact = builder_of(&Sphere::new(1.0e-3)?, grid(), body).kernel(kernel).build()?;
        contact.step(0.0, Load::approach(2.0e-4)).map(drop)
    }),
    ("tilt_of_periodic", || {
        let kernel = InfluenceKernel::periodic(&grid())?;
        let mut contact = builder_of(&Wavy::new(1.0e-6, 4.0e-3)?, grid(), elastic()).kernel(kernel).build()?;
        contact.step(0.0, Load::approach_and_tilt(1.0e-7, [1.0e-3, 0.0])).map(drop)
    }),
    ("user", || followed(FnHistory::fallible(|_| "half a newton".parse().map(Load::force)))),
    ("zone_not_resolved", || sticky(0.01).map(drop)),
];

/// Guards, of which no scene is known that they refuse, and what needs more than a call.
const NOT_PROVOKED: [(&str, &str); 6] = [
    ("adhesion_not_converged", "rounds of the near field of a part of a grid converge in all scenes tried"),
    ("checkpoint_malformed", "needs a file with a right checksum: checkpoint::ranks and common::sealed forge some"),
    ("friction_not_converged", "the second start finds the tractions of all scenes tried"),
    ("map_not_filled", "conjugate gradients end at rounding on all maps tried"),
    ("states_beyond_friction", "held on every history tried, but is not proved"),
    ("states_out_of_order", "held on every history tried, but is not proved"),
];

/// The codes of errors in src: the first argument of a refusal, and those of variants.
fn codes() -> BTreeMap<String, usize> {
    let (mut all, mut found) = (Vec::new(), BTreeMap::new());
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    files(&source, &mut all);
    let until_quote = |text: &str| text.split('"').next().unwrap_or_default().to_owned();
    let mut count = |name: String| *found.entry(name).or_insert(0) += 1;
    for text in all.iter().map(|path| code(path)) {
        for refusal in ["value", "file", "search", "unsupported"] {
            for after in text.split(&format!("Refusal::{refusal}(")).skip(1) {
                after.trim_start().strip_prefix('"').map(until_quote).into_iter().for_each(&mut count);
            }
        }
    }
    let variants = code(&source.join("error/kind.rs"));
    let named = |of: &str| of.split_once(", \"").map(|(_, rest)| until_quote(rest));
    let variants: BTreeSet<_> = variants.split("=> (").skip(1).filter_map(named).collect();
    variants.into_iter().for_each(&mut count);
    found
}

#[test]
fn every_code_is_provoked() {
    let codes = codes();
    assert!(codes.len() > 100, "{codes:?}");
    let several: Vec<_> = codes.iter().filter(|(_, times)| **times > 1).collect();
    assert!(several.is_empty(), "codes of several errors: {several:?}");
    let mut wrong = Vec::new();
    for (code, provoke) in PROVOKED {
        match provoke() {
            Err(error) if error.code() == *code => {}
            other => wrong.push(format!("{code}: {other:?}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let mut asserted = String::new();
    for folder in ["", "../src"] {
        let mut all = Vec::new();
        files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut all);
        for path in all.iter().filter(|path| !path.ends_with("io/codes.rs")) {
            let text = fs::read_to_string(path).unwrap();
            let is_test = folder.is_empty() || path.ends_with("tests.rs");
            asserted += if is_test { &text } else { text.split("#[cfg(test)]\nmod").nth(1).unwrap_or_default() };
        }
    }
    let of_table: BTreeSet<&str> = PROVOKED.iter().map(|row| row.0).chain(NOT_PROVOKED.map(|row| row.0)).collect();
    let is_known = |code: &str| of_table.contains(code) || asserted.contains(&format!("\"{code}\""));
    let lacking: Vec<_> = codes.keys().filter(|code| !is_known(code)).collect();
    assert!(lacking.is_empty(), "neither provoked nor excused: {lacking:?}");
    let gone: Vec<_> = of_table.iter().filter(|code| !codes.contains_key(**code)).collect();
    assert!(gone.is_empty(), "of no error: {gone:?}");
}
