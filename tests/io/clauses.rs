//! Clauses under `# Errors` of the public interface, at least one of each of its parts: kind and message, with the name, the value, the allowed range,
//! and what to do. Other values of the same names are in `errors`, `mistakes`, `kernel::refusals`, `materials::refusals` and the fuzz targets.

mod outputs;

use std::error::Error as StdError;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use viscocontact::ErrorKind::{Cancelled, Convergence, File, Memory, Unsupported, Value};
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction, VanDerWaals, laws as attraction_laws};
use viscocontact::analytic::{Dmt, GrowingSphere, MaugisDugdale, RigidPunch, SlidingLimits};
use viscocontact::contact::EnergyBalance;
use viscocontact::geometry::laws as shape_laws;
use viscocontact::input::{Quantity as Read, TextTable, WantedColumn};
use viscocontact::observe::SubsurfaceStress;
use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
use viscocontact::parallel::Threads;
use viscocontact::plot::{Chart, Color, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::{
    FractionalMaxwell, Isotherm, MasterCurve, RelaxationSpectrum, SlowCreep, TemperatureHistory, TimeTemperature, laws,
    library,
};
use viscocontact::{Error, ErrorKind, TextFormat};
use viscocontact_identify::{Curve, Experiment, Identification, Law, Model, Noise, Nuisance, Protocol, tips, usual};

use crate::common::{Temporary, builder_of, builder_on, elastic, maxwell, sphere, sphere_on, zener};

/// What was provoked.
#[derive(Default)]
struct Table {
    rows: usize,
    wrong: Vec<String>,
}

impl Table {
    /// Of the message with its causes `says` has the parts, with … between, and → for "is not allowed: it must be".
    fn row<T, E: StdError + 'static>(&mut self, outcome: Result<T, E>, kind: ErrorKind, says: &str) {
        self.rows += 1;
        let Err(error) = outcome else { return self.wrong.push(format!("accepted, not {says}")) };
        let found = (&error as &dyn StdError).downcast_ref::<Error>().map_or(kind, Error::kind);
        let (mut text, mut source) = (error.to_string(), error.source());
        while let Some(cause) = source {
            text += &format!(": {cause}");
            source = cause.source();
        }
        let mut rest = &text[..];
        let is_said = says.replace('→', "is not allowed: it must be").split('…').enumerate().all(|(k, part)| {
            let at = rest.find(part).filter(|at| k > 0 || *at == 0);
            rest = at.map_or("", |at| &rest[at + part.len()..]);
            at.is_some()
        });
        if found != kind || !is_said {
            self.wrong.push(format!("{found:?}: {text}\n    not {kind:?}: {says}"));
        }
    }
}

#[test]
fn clauses_of_errors_are_kept() {
    let mut table = Table::default();
    let others = [outputs::maps, outputs::results, outputs::fits];
    for rows in
        [contacts, kernels, checkpoints, loads_and_texts, materials, temperatures, shapes].into_iter().chain(others)
    {
        rows(&mut table);
    }
    assert!(table.wrong.is_empty(), "{} of {} rows:\n{}", table.wrong.len(), table.rows, table.wrong.join("\n"));
    assert!(table.rows >= 130, "{}", table.rows);
}

const NAN: f64 = f64::NAN;

fn grid() -> Grid {
    Grid::square(16, 4.0e-3).unwrap()
}

fn contact(settings: Settings) -> ViscoelasticContact {
    sphere_on(grid(), maxwell(), settings)
}

fn pressed() -> ViscoelasticContact {
    let mut contact = contact(Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact
}

fn two() -> ViscoelasticContact {
    let ball = |at: f64| Shifted::new(sphere(), [at, 0.0]).unwrap();
    builder_of(&ball(-1.0e-3), grid(), elastic()).another_body(&ball(1.0e-3)).build().unwrap()
}

fn shared<T: Send>(job: impl Fn(ViscoelasticContact) -> T + Sync) -> T {
    Threads::run(1, |ranks| job(builder_on(grid(), maxwell()).ranks(ranks).build().unwrap())).unwrap().pop().unwrap()
}

fn by_function() -> Material {
    Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())))
}

/// A smooth influence of scattered cells hardly determines the pressure under a rigid punch; here it gives one that is known.
fn undetermined() -> ViscoelasticContact {
    let smooth = InfluenceKernel::from_coefficients(&grid(), |i, j| (-((i * i + j * j) as f64) / 6.0).exp()).unwrap();
    let is_cell = |k: usize| (k * 7 + (k / 16) * 5 + k * k) % 5 < 4;
    let given: Vec<f64> = (0..256).map(|k| if is_cell(k) { 1.0 + ((k * k) % 7) as f64 } else { 0.0 }).collect();
    let mut displacement = vec![0.0; 256];
    smooth.convolve(&given, &mut displacement, &mut smooth.workspace().unwrap()).unwrap();
    let depth = displacement.iter().copied().fold(0.0, f64::max);
    let gap = displacement.iter().zip(&given).map(|(u, p)| if *p > 0.0 { depth - u } else { NAN });
    let cells = HeightMap::new([16; 2], [4.0e-3; 2], gap.map(|gap| -gap).collect()).unwrap().masked();
    let punch = builder_of(&cells, grid(), Material::incompressible(Elastic::new(0.25).unwrap())).kernel(smooth);
    let settings = Settings::default().with_tolerance(0.1).with_edge(Edge::Allow);
    let mut punch = punch.settings(settings).build().unwrap();
    punch.step(0.0, Load::approach(depth)).unwrap();
    punch
}

#[rustfmt::skip]
fn contacts(t: &mut Table) {
    let over = Settings::default().with_frame(Frame::Indenter);
    let gap = |gap: f64| FnGeometry::new(move |x1, _| if x1 > 0.0 || gap == f64::INFINITY { gap } else { 0.0 });
    t.row(pressed().set_geometries(&[&gap(f64::NEG_INFINITY)]), Value, "the initial gap at cell [8, 0], …is -inf: it must be finite, or +inf…");
    t.row(pressed().set_geometries(&[&gap(f64::INFINITY)]), Value, "body 0 is the lowest…on none of the 256 cells…Grid::lengths");
    t.row(two().set_geometries(&[&sphere()]), Value, "geometries of the rigid bodies: 1 given, 2 needed");
    t.row(pressed().fields().traction_into(&mut [0.0; 255]), Value, "traction: 255 given, 256 needed");
    t.row(EnergyBalance::new(&pressed()), Value, "displacement where an energy balance begins = … → 0, before any step");
    t.row(EnergyBalance::new(&two()), Value, "rigid bodies of an energy balance = 2 → 1");
    t.row(shared(|contact| EnergyBalance::new(&contact)), Unsupported, "an energy balance is not covered on rows that…");
    t.row(EnergyBalance::new(&contact(over)), Unsupported, "an energy balance is not covered on a grid that…");
    t.row(shared(|contact| contact.fields().mesh_error()), Unsupported, "the error due to the mesh…ranks share out: compute the contact in one…");
    let attracted = builder_on(grid(), maxwell()).attraction(ExponentialAttraction::new(0.05, 1.0e-4).unwrap()).build().unwrap();
    t.row(attracted.fields().mesh_error(), Unsupported, "the error…attract each other: compute on a finer mesh…");
    let stiffness = undetermined().fields().stiffness_over_modulus();
    assert!(stiffness.as_ref().is_err_and(|error| error.code() == "stiffness_not_converged"));
    t.row(stiffness, Convergence, "the body hardly determines…after 500 iterations…: check its influence coefficients");
    t.row(contact(Settings::default()).fields().stress_in_counter_body(), Value, "a contact needs counter_body: call Builder::counter_body…");
    let modulus = |modulus: f64| ElasticContact::builder(grid()).geometry(&sphere()).modulus(modulus);
    let elastic = || modulus(4.0e6).build().unwrap();
    let set = AtomicBool::new(true);
    t.row(ElasticContact::builder(grid()).modulus(4.0e6).build(), Value, "a contact needs geometry…");
    t.row(ElasticContact::builder(grid()).geometry(&sphere()).build(), Value, "a contact needs modulus…");
    t.row(modulus(-1.0).build(), Value, "contact modulus = -1.0 → finite and > 0");
    t.row(modulus(1.0).kernel(InfluenceKernel::half_space(&Grid::square(8, 4.0e-3).unwrap()).unwrap()).build(), Value, "the kernel…8…16…");
    t.row(elastic().solve_unless(&set, Load::force(0.2)), Cancelled, "a step was cancelled by its caller");
    t.row(elastic().solve(Load::force(10.0)), Value, "…on 60 cells…about 0.0053 m…: enlarge the grid…");
    t.row(elastic().solve([Load::force(0.1); 2]), Value, "loads of the rigid bodies: 2 given, 1 needed");
    t.row(elastic().set_surface(&[0.0; 255]), Value, "displacement of the surface: 255 given, 256 needed");
    t.row(elastic().set_surface(&[NAN; 256]), Value, "displacement of the surface = NaN → finite");
    t.row(pressed().step_unless(&set, 0.1, [Load::force(0.2)]), Cancelled, "a step was cancelled by its caller");
    t.row(Threads::run(1025, |_| ()), Value, "ranks = … → 1 to 1024");
}

#[rustfmt::skip]
fn kernels(t: &mut Table) {
    let coefficients = |of: &dyn Fn(isize, isize) -> f64| InfluenceKernel::from_coefficients(&grid(), of);
    let of_middle = |i: isize, j: isize, value: f64| if i == 0 && j == 0 { value } else { 0.0 };
    let huge = Grid::square(1 << 20, 1.0).unwrap();
    t.row(coefficients(&|i, j| of_middle(i, j, 2.0e100)), Value, "…[0, 0] is 2e100: …at most 1e100 m…");
    t.row(coefficients(&|i, j| (1.0 + 0.1 * (i as f64).signum()) / (1.0 + (i * i + j * j) as f64)), Value, "the influence coefficient [-1, 0] is 0.45: …mirror images");
    t.row(coefficients(&|i, j| of_middle(i, j, -1.0)), Value, "…not positive definite: …check their signs…");
    t.row(InfluenceKernel::from_coefficients(&huge, |_, _| 1.0), Memory, "a kernel of coefficients needs 43980…");
    t.row(InfluenceKernel::half_space(&huge).unwrap().workspace(), Memory, "the workspace of a kernel needs 35185…bytes…take fewer cells…");
    t.row(Layer::bonded_to_half_space(1.0, 0.5, 1.25e-11, 0.3), Value, "shear modulus of a layer over that of its base = 1.25e-11 → in [1e-6, 1e6]");
}

#[rustfmt::skip]
fn checkpoints(t: &mut Table) {
    let path = Temporary::file("clauses");
    let resume = |path: &std::path::Path| contact(Settings::default()).resume(path);
    t.row(resume(&path.join("none")), File, "no run can be resumed from …: it cannot be read: …");
    std::fs::write(&path, "no checkpoint").unwrap();
    t.row(resume(&path), File, "…: not a checkpoint: the magic number is missing");
    pressed().save(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for (change, says) in [(8, "…: the checkpoint is of format 122, this version reads format…"), (bytes.len() - 3, "…: the checkpoint is damaged or truncated: its checksum is not that of…")] {
        let mut changed = bytes.clone();
        changed[change] ^= 99;
        std::fs::write(&path, changed).unwrap();
        t.row(resume(&path), File, says);
    }
    std::fs::write(&path, &bytes).unwrap();
    t.row(sphere_on(grid(), zener(), Settings::default()).resume(&path), File, "…: the checkpoint is of another scene: its material differs…");
    t.row(shared(|mut contact| contact.resume(&path)), File, "…computed region (ranks need the whole grid…: save with Settings::window…");
}

#[rustfmt::skip]
fn loads_and_texts(t: &mut Table) {
    const FORCE: WantedColumn = WantedColumn { name: "force", words: &["force"], others: &[], quantity: Read::FORCE, by_unit: false };
    let text = |text: &str| TextTable::read(text.as_bytes(), TextFormat::default()).unwrap();
    let rows = |of: TextTable| of.rows(&[of.find(&FORCE).unwrap().unwrap()]);
    t.row(rows(text("time [s],force [N]\n0,1\n1,2\n2,3,4\n")), File, "line 4: 3 columns separated by commas, but 2 are needed…");
    t.row(rows(text("time [s],force [N]\n0,1\n1,2\n2,high\n")), File, "line 4, column 2: \"high\" is not a number; leave the line out…");
    let both = text("force [N],force [mN]\n0,1\n1,2\n");
    t.row(both.find(&FORCE), File, "line 1: …1 \"force [N]\", 2 \"force [mN]\"…choose by TextTable::only…");
    t.row(both.clone().with_heading(3, "force [N]"), File, "there is no column …, or its number from 1 on");
    t.row(both.only(&["depth"]), File, "there is no column depth (headings: force [N], force [mN])…");
    let at = |time: f64, force: f64| (time, Load::force(force));
    t.row(Periodic::new(&[at(0.0, 1.0)]), Value, "load table: 1 given, at least 2 needed");
    t.row(Periodic::new(&[at(1.0, 1.0), at(1.0, 2.0)]), Value, "period = 0.0 → finite and > 0");
    t.row(Periodic::new(&[at(0.0, 1.0), at(-1.0, 1.0)]), Value, "load table times[1] = -1.0 may not follow 0.0: …not decrease");
    t.row(Periodic::new(&[at(0.0, 1.0), (1.0, Load::approach(1.0))]), Value, "the load table mixes…(a force…; an approach…: take loads of one kind…");
    let force = Load::force;
    t.row(Sinusoid::new(force(0.0), force(1.0), 0.0), Value, "frequency = 0.0 → finite and > 0");
    t.row(Sinusoid::new(force(0.0), Load::approach(1.0), 1.0), Value, "the sinusoid mixes loads…(a force…: take loads of one kind…");
    t.row(Sinusoid::new(force(2.0), force(1.0), 1.0), Value, "sinusoid from low to high[1] = 1.0 may not follow 2.0: …`Sinusoid::about`…");
}

#[rustfmt::skip]
fn materials(t: &mut Table) {
    let fluid = Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0).unwrap());
    t.row(GrowingSphere::step(2.0e100, &maxwell(), 1.0), Value, "sphere radius = 2e100 → in [1e-100, 1e100] m");
    t.row(GrowingSphere::step(1.0e-2, &maxwell(), 2.0e100), Value, "force = 2e100 → at most 1e100 N");
    t.row(GrowingSphere::step(1.0e-2, &by_function(), 1.0), Value, "the solution for a growing contact needs an exponential series…");
    t.row(GrowingSphere::step(1.0e-2, &fluid, 1.0), Value, "…growing contact needs an elastic response…ramp the load…");
    t.row(GrowingSphere::new(1.0e-2, &maxwell(), StepLoad::new(Load::approach(1.0e-6)).unwrap()), Value, "the growing sphere needs a force, not an approach");
    t.row(SlidingLimits::cylinder(0.0, &zener(), 1.0), Value, "cylinder radius = 0.0 → finite and > 0");
    t.row(SlidingLimits::cylinder(1.0e-2, &by_function(), 1.0), Value, "a limit of steady motion needs an exponential series…");
    t.row(SlidingLimits::cylinder(1.0e-2, &maxwell(), 1.0), Value, "fluidity of the contact = 2.5e-7 → 0");
    t.row(FractionalMaxwell::with_time(1.0, -1.0, 0.5), Value, "time = -1.0 → finite and > 0");
    t.row(FractionalMaxwell::with_time(1.0, 1.0, 1.0), Value, "exponent = 1.0 → in (0, 1)");
    let falls_to = |compliance: f64| FnRheology::new(move |t| if t < 2.0 { 1.0e-6 } else { compliance });
    for (to, says) in [(-1.0e-6, "creep is finite and not negative: …t = 2.37… s is -1e-6…"), (0.0, "creep is positive after t = 0: …is 0.0, expected more than 0.0")] {
        t.row(laws::all(&falls_to(to), &laws::log_times(0.1, 10.0)), Value, says);
    }
    t.row(library::all()[0].material(0.6), Value, "Poisson's ratio = … → in (-1, 0.5]");
    t.row(Material::elastic_bulk(Elastic::new(1.0e6).unwrap(), NAN), Value, "bulk modulus = … → finite and > 0");
    t.row(Material::elastic_bulk(FnRheology::new(|t| 1.0e-6 * (1.0 + t)), 1.0e9), Value, "an elastic bulk needs an exponential series…Rheology::series…");
    t.row(Material::constant_poisson(Elastic::new(1.0e100).unwrap(), 0.5).unwrap().contact_spectrum(), Value, "glassy compliance = 2.5e-101 → 0, or in [1e-100, 1e100]");
    t.row(SlowCreep::new(1.0, -1.0, 1.0, 0.5), Value, "strength of the creep = -1.0 → finite and > 0");
    t.row(SlowCreep::new(1.0, 1.0, NAN, 0.5), Value, "onset of logarithmic creep = NaN → finite and > 0");
    t.row(SlowCreep::new(1.0, 1.0, 1.0, 1.1), Value, "exponent = 1.1 → in (0, 1]");
    t.row(Maxwell::with_time(1.0e6, 1.0).unwrap().creep_spectrum().unwrap().scaled(0.0), Value, "factor of a creep spectrum = … → finite and > 0");
    t.row(RelaxationSpectrum::new(1.0e101, 0.0, &[]), Value, "equilibrium modulus = 1e101 → 0, or in [1e-100, 1e100]");
    t.row(RelaxationSpectrum::new(1.0, 0.0, &[(1.0, 0.0)]), Value, "relaxation time = 0.0 → in [1e-100, 1e100]");
    t.row(RelaxationSpectrum::new(0.0, 0.0, &[(0.0, 1.0)]), Value, "relaxation spectrum: 0 given, at least 1 needed");
    t.row(Zener::relaxing(1.0, 2.0, 1.0), Value, "glassy modulus = 1.0 → finite, and greater than the rubbery modulus");
    let storage = |rows: [(f64, f64); 3]| Measurements::storage(&rows);
    t.row(Measurements::storage(&[]), Value, "table of storage moduli: 0 given, at least 4 needed");
    t.row(storage([(1.0, 1.0e6), (1.0, 2.0e6), (2.0, 3.0e6)]), Value, "table of storage moduli: entry 1 and entry 0 give two values for…");
    t.row(storage([(0.0, 1.0e6), (1.0, 2.0e6), (2.0, 3.0e6)]), Value, "table of storage moduli, entry 0: angular frequency = 0.0 …");
    t.row(storage([(1.0, 1.0e6), (2.0, -2.0e6), (3.0, 3.0e6)]), Value, "table of storage moduli, entry 1: storage modulus = -2000000.0 …");
}

fn isotherm(temperature: f64, slow: f64) -> Isotherm {
    let row = |k: i32| 10f64.powf(0.25 * f64::from(k));
    let rows: Vec<_> = (-6..=6).map(row).map(|t| (t, 1.0e-9 * (1.0 + (t / slow).powf(0.3)))).collect();
    Isotherm::new(temperature, Measurements::creep(&rows).unwrap()).unwrap()
}

#[rustfmt::skip]
fn temperatures(t: &mut Table) {
    let relaxing = Measurements::relaxation(&[(0.1, 3.0), (1.0, 2.0), (10.0, 1.0), (100.0, 0.8)]).unwrap();
    let pair = |other: Isotherm| vec![isotherm(300.0, 1.0), other];
    for (reference, isotherms, says) in [
        (300.0, vec![], "isotherms: 0 given, at least 1 needed"),
        (300.0, pair(isotherm(300.0, 0.1)), "temperatures of the isotherms[1] = 300.0 …must differ"),
        (300.0, pair(Isotherm::new(310.0, relaxing).unwrap()), "a creep table and a relaxation table cannot be joined…"),
        (305.0, pair(isotherm(310.0, 0.1)), "reference temperature = 305.0 → …of the isotherms, within 0.5 K"),
    ] {
        t.row(MasterCurve::new(reference, isotherms.clone()), Value, says);
        t.row(MasterCurve::with_vertical_shifts(reference, isotherms), Value, says);
    }
    t.row(MasterCurve::new(300.0, pair(isotherm(330.0, 1.0e-12))), Value, "the isotherms at 300 K and 330 K do not overlap…with_law");
    t.row(MasterCurve::new(300.0, vec![isotherm(300.0, 1.0)]).unwrap().arrhenius(), Value, "temperatures besides the reference: 0 given, at least 1 needed");
    t.row(MasterCurve::new(300.0, pair(isotherm(310.0, 10.0))).unwrap().arrhenius(), Value, "activation energy of the shift factors = -178046… → > 0: …");
    let wlf = || TimeTemperature::wlf(17.44, 51.6, 300.0).unwrap();
    let by_table = || TimeTemperature::table(&[(290.0, 10.0), (300.0, 1.0)], 300.0).unwrap();
    for (temperature, says) in [(0.0, "temperature = 0.0 → finite and > 0"), (20.0, "temperature = 20.0 → above T_ref - C2, …kelvin…"), (248.5, "shift factor = inf → in [1e-60, 1e60]: …kelvin…")] {
        t.row(TemperatureHistory::table(wlf(), &[(0.0, temperature)]), Value, says);
        t.row(wlf().shift_factor(temperature), Value, says);
    }
    t.row(by_table().shift_factor(310.0), Value, "temperature = 310.0 → in the table of shift factors…extrapolated)");
    t.row(TimeTemperature::arrhenius(3.0e5, 300.0).unwrap().shift_factor(20.0), Value, "temperature = 20.0 → from a third to three times that of an Arrhenius law: …kelvin…");
    let table = |rows: &[(f64, f64)]| TimeTemperature::table(rows, 300.0);
    t.row(table(&[(300.0, 1.0)]), Value, "rows of shift factors: 1 given, at least 2 needed");
    t.row(table(&[(300.0, 1.0), (290.0, 10.0)]), Value, "temperatures of shift factors[1] = 290.0 …must ascend");
    t.row(table(&[(290.0, 0.0), (300.0, 1.0)]), Value, "shift factor = 0.0 → finite and > 0");
    t.row(table(&[(290.0, 10.0), (300.0, 1.1)]), Value, "reference temperature = 300.0 → …of the table at which the factor is 1");
    t.row(wlf().with_arrhenius_below(280.0, 0.0), Value, "activation energy = 0.0 → finite and > 0");
    t.row(wlf().with_arrhenius_below(310.0, 1.0e5), Value, "upper end of an Arrhenius law = 310.0 → at most the reference…");
    t.row(wlf().with_arrhenius_below(270.0, 1.0e5).unwrap().with_arrhenius_below(280.0, 1.0e5), Value, "upper end of an Arrhenius law = 280.0 → …below those given before");
    t.row(by_table().with_arrhenius_below(280.0, 1.0e5), Value, "temperature = 280.0 → in the table of shift factors…extrapolated)");
}

/// An attraction that grows with the gap.
#[derive(Debug)]
struct Growing;

impl Attraction for Growing {
    fn traction(&self, gap: f64) -> f64 {
        1.0e3 * (1.0 + gap / 1.0e-4)
    }
    fn energy(&self, _: f64) -> f64 {
        0.1
    }
}

/// A shape that counts how often it is evaluated.
#[derive(Debug)]
struct Restless(std::sync::atomic::AtomicU32);

impl Geometry for Restless {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        x1 * x1 + x2 * x2 + f64::from(self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
    }
}

#[rustfmt::skip]
fn shapes(t: &mut Table) {
    t.row(Dugdale::new(0.1, 1.0e-6).unwrap().with_width(2.1), Value, "width of the end of Dugdale's law = 2.1 → in [0.01, 2]");
    t.row(attraction_laws::all(&Growing), Value, "the traction does not grow with the gap: …is 1000…, expected 1000.0");
    t.row(VanDerWaals::new(0.1, NAN), Value, "range of the attraction = NaN → finite, > 0 and at most 1e300 m");
    t.row(VanDerWaals::new(1.0e300, 1.0e-300), Value, "maximum traction of the attraction = inf → finite and > 0");
    t.row(MaugisDugdale::new(1.0e-3, 1.0e6, 0.05, 0.0), Value, "traction = … → finite and > 0");
    t.row(Dmt::new(1.0e-3, NAN, 0.05), Value, "contact modulus = … → finite and > 0");
    t.row(RigidPunch::new(1.0e-3, 1.0e6, -1.0, 0.0), Value, "force = -1.0 → finite and >= 0");
    t.row(RigidPunch::new(1.0e-3, 1.0e6, 1.0, -0.4e-3), Value, "eccentricity = -0.0004 → in [-R/3, R/3], otherwise the contact opens");
    let grid = Grid::square(8, 1.0e-3).unwrap();
    t.row(shape_laws::all(&Restless(0.into()), &grid), Value, "repeated evaluations give the same gap: gap on cell [0, 0] …");
    t.row(Shifted::new(Sphere::new(1.0).unwrap(), [0.0, f64::INFINITY]), Value, "shift along x… → finite");
    t.row(ElasticStates::punch(1.0e200), Value, "punch radius = … → in [1e-100, 1e100]");
    let state = (1.0e-12, 1.0e-6, 1.0e-6, 1.0e-12);
    let table = |other| ElasticStates::from_table(&[state, other]);
    t.row(ElasticStates::from_table(&[state]), Value, "elastic states: 1 given, at least 2 needed");
    t.row(table((2.0e-12, 2.0e-6, NAN, 1.0e-12)), Value, "stiffness of an elastic state = NaN → finite and > 0");
    t.row(table((2.0e-12, 1.0e-6, 1.0e-6, 1.0e-12)), Value, "approaches of elastic states[1] = 1e-6 …must ascend");
    t.row(table((0.5e-12, 2.0e-6, 1.0e-6, 1.0e-12)), Value, "levels of elastic states[1] = 5e-13 …must ascend");
    t.row(table((2.0e-12, 2.0e-6, 1.0e-6, 0.0)), Value, "area of an elastic state = 0.0 → finite and > 0");
    let sweep = || Sweep::new(grid.clone(), &Sphere::new(1.0e-3).unwrap());
    let run = |sweep: Sweep, to: f64| sweep.run_with(Reach::Approach(to), |_| std::ops::ControlFlow::Continue(()));
    t.row(run(sweep().accuracy(0.5), 1.0e-6), Value, "accuracy of a sweep = 0.5 → in [1e-8, 0.1]");
    t.row(run(sweep().max_states(2), 1.0e-6), Value, "states of a sweep = 2 → 3 or more");
    t.row(run(sweep(), 0.0), Value, "reach of a sweep = 0.0 → finite and > 0");
    t.row(run(sweep(), 1.0e-3), Value, "at t = 0 s the contact touches the edge…: enlarge the grid…");
}
