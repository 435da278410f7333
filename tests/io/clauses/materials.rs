//! Rheologies, temperature and closed forms of contacts.

use viscocontact::ErrorKind::Value;
use viscocontact::analytic::{GrowingSphere, SlidingLimits};
use viscocontact::prelude::*;
use viscocontact::rheology::{
    FractionalMaxwell, Isotherm, MasterCurve, RelaxationSpectrum, SlowCreep, TemperatureHistory, TimeTemperature, laws,
    library,
};

use super::Table;
use crate::common::{maxwell, zener};

fn closure() -> impl Rheology {
    FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt()))
}

fn isotherm(temperature: f64, slow: f64) -> Isotherm {
    let rows: Vec<_> =
        (-6..=6).map(|k| 10f64.powf(0.25 * f64::from(k))).map(|t| (t, 1.0e-9 * (1.0 + (t / slow).powf(0.3)))).collect();
    Isotherm::new(temperature, Measurements::creep(&rows).unwrap()).unwrap()
}

pub fn rows(t: &mut Table) {
    let fluid = Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0).unwrap());
    let by_function = Material::incompressible(closure());
    for (radius, material, force, says) in [
        (0.0, maxwell(), 1.0, "sphere radius = 0.0 → in [1e-100, 1e100] m"),
        (2.0e100, maxwell(), 1.0, "sphere radius = 2e100 → in [1e-100, 1e100] m"),
        (1.0e-2, maxwell(), 0.0, "force = 0.0 → finite and > 0"),
        (1.0e-2, maxwell(), 2.0e100, "force = 2e100 → at most 1e100 N"),
        (1.0e-2, by_function.clone(), 1.0, "the solution for a growing contact needs an exponential series…"),
        (1.0e-2, fluid.clone(), 1.0, "…growing contact needs an elastic response…ramp the load…"),
    ] {
        t.row("GrowingSphere::step", GrowingSphere::step(radius, &material, force), Value, says);
        let load = StepLoad::new(Load::force(force)).unwrap();
        if (0.1..10.0).contains(&force) {
            t.row("GrowingSphere::new", GrowingSphere::new(radius, &material, load), Value, says);
        }
    }
    let approach = StepLoad::new(Load::approach(1.0e-6)).unwrap();
    t.row(
        "GrowingSphere::new",
        GrowingSphere::new(1.0e-2, &maxwell(), approach),
        Value,
        "the growing sphere needs a force, not an approach",
    );
    for (radius, material, force, says) in [
        (0.0, zener(), 1.0, "cylinder radius = 0.0 → finite and > 0"),
        (1.0e-2, zener(), f64::NAN, "force = NaN → finite and > 0"),
        (1.0e-2, by_function.clone(), 1.0, "a limit of steady motion needs an exponential series…"),
        (1.0e-2, maxwell(), 1.0, "fluidity of the contact = 2.5e-7 → 0"),
    ] {
        t.row("SlidingLimits::cylinder", SlidingLimits::cylinder(radius, &material, force), Value, says);
    }
    for ([modulus, time, exponent], says) in [
        ([0.0, 1.0, 0.5], "shear modulus = 0.0 → finite and > 0"),
        ([1.0, -1.0, 0.5], "time = -1.0 → finite and > 0"),
        ([1.0, 1.0, 0.0], "exponent = 0.0 → in (0, 1)"),
        ([1.0, 1.0, 1.0], "exponent = 1.0 → in (0, 1)"),
        ([1.0, f64::NAN, 0.5], "time = NaN → finite and > 0"),
    ] {
        t.row("FractionalMaxwell::with_time", FractionalMaxwell::with_time(modulus, time, exponent), Value, says);
    }
    for (modulus, time, says) in [
        (0.0, 1.0, "shear modulus = 0.0 → finite and > 0"),
        (f64::INFINITY, 1.0, "shear modulus = inf → finite and > 0"),
        (1.0, 0.0, "re…ation time = 0.0 → finite and > 0"),
        (1.0, f64::NAN, "re…ation time = NaN → finite and > 0"),
    ] {
        t.row("KelvinVoigt::with_time", KelvinVoigt::with_time(modulus, time), Value, says);
        t.row("Maxwell::with_time", Maxwell::with_time(modulus, time), Value, says);
    }
    for (compliance, says) in [
        (f64::NAN, "creep is finite and not negative: …t = 2.37… s is NaN…"),
        (-1.0e-6, "creep is finite and not negative: …t = 2.37… s is -1e-6…"),
        (0.0, "creep is positive after t = 0: …is 0.0, expected more than 0.0"),
    ] {
        let rheology = FnRheology::new(move |t| if t < 2.0 { 1.0e-6 } else { compliance });
        t.row("laws::non_negative", laws::non_negative(&rheology, &laws::log_times(0.1, 10.0)), Value, says);
    }
    for nu in [-1.0, 0.6, f64::NAN] {
        t.row(
            "PublishedMaterial::material",
            library::all()[0].material(nu),
            Value,
            "Poisson's ratio = … → in (-1, 0.5]",
        );
    }
    t.row(
        "library::find",
        library::find("rubber"),
        Value,
        "there is no published material named \"rubber\"; known are: PMMA…",
    );
    for bulk in [0.0, f64::NAN] {
        t.row(
            "Material::elastic_bulk",
            Material::elastic_bulk(Elastic::new(1.0e6).unwrap(), bulk),
            Value,
            "bulk modulus = … → finite and > 0",
        );
    }
    t.row(
        "Material::elastic_bulk",
        Material::elastic_bulk(closure(), 1.0e9),
        Value,
        "an elastic bulk needs an exponential series…Rheology::series…",
    );
    let tiny = Material::constant_poisson(Elastic::new(1.0e100).unwrap(), 0.5).unwrap();
    let sums = tiny.contact_spectrum();
    t.row("Material::contact_spectrum", sums, Value, "glassy compliance = 2.5e-101 → 0, or in [1e-100, 1e100]");
    for ([glassy, strength, time, exponent], says) in [
        ([0.0, 1.0, 1.0, 0.5], "glassy compliance = 0.0 → finite and > 0"),
        ([1.0, -1.0, 1.0, 0.5], "strength of the creep = -1.0 → finite and > 0"),
        ([1.0, 1.0, f64::NAN, 0.5], "onset of logarithmic creep = NaN → finite and > 0"),
        ([1.0, 1.0, 1.0, 0.0], "exponent = 0.0 → in (0, 1]"),
        ([1.0, 1.0, 1.0, 1.1], "exponent = 1.1 → in (0, 1]"),
    ] {
        t.row("SlowCreep::new", SlowCreep::new(glassy, strength, time, exponent), Value, says);
    }
    let creep = Maxwell::with_time(1.0e6, 1.0).unwrap().creep_spectrum().unwrap();
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        t.row("CreepSpectrum::scaled", creep.scaled(factor), Value, "factor of a creep spectrum = … → finite and > 0");
    }
    for (equilibrium, viscosity, terms, says) in [
        (-1.0, 0.0, vec![], "equilibrium modulus = -1.0 → 0, or in [1e-100, 1e100]"),
        (1.0e101, 0.0, vec![], "equilibrium modulus = 1e101 → 0, or in [1e-100, 1e100]"),
        (1.0, f64::NAN, vec![], "immediate viscosity = NaN → 0, or in [1e-100, 1e100]"),
        (1.0, 0.0, vec![(-1.0, 1.0)], "relaxing modulus = -1.0 → 0, or in [1e-100, 1e100]"),
        (1.0, 0.0, vec![(1.0, 0.0)], "relaxation time = 0.0 → in [1e-100, 1e100]"),
        (1.0, 0.0, vec![(1.0, 1.0e101)], "relaxation time = 1e101 → in [1e-100, 1e100]"),
        (0.0, 0.0, vec![], "relaxation spectrum: 0 given, at least 1 needed"),
        (0.0, 0.0, vec![(0.0, 1.0)], "relaxation spectrum: 0 given, at least 1 needed"),
    ] {
        t.row("RelaxationSpectrum::new", RelaxationSpectrum::new(equilibrium, viscosity, &terms), Value, says);
    }
    let relaxing =
        Isotherm::new(310.0, Measurements::relaxation(&[(0.1, 3.0), (1.0, 2.0), (10.0, 1.0), (100.0, 0.8)]).unwrap())
            .unwrap();
    let far = isotherm(330.0, 1.0e-12);
    for (reference, isotherms, says) in [
        (300.0, vec![], "isotherms: 0 given, at least 1 needed"),
        (
            300.0,
            vec![isotherm(300.0, 1.0), isotherm(300.0, 0.1)],
            "temperatures of the isotherms[1] = 300.0 …must differ",
        ),
        (300.0, vec![isotherm(300.0, 1.0), relaxing], "a creep table and a relaxation table cannot be joined…"),
        (
            305.0,
            vec![isotherm(300.0, 1.0), isotherm(310.0, 0.1)],
            "reference temperature = 305.0 → …of the isotherms, within 0.5 K",
        ),
        (
            f64::NAN,
            vec![isotherm(300.0, 1.0), isotherm(310.0, 0.1)],
            "reference temperature = NaN → …of the isotherms, within 0.5 K",
        ),
    ] {
        t.row("MasterCurve::new", MasterCurve::new(reference, isotherms.clone()), Value, says);
        t.row(
            "MasterCurve::with_vertical_shifts",
            MasterCurve::with_vertical_shifts(reference, isotherms),
            Value,
            says,
        );
    }
    let apart = MasterCurve::new(300.0, vec![isotherm(300.0, 1.0), far]);
    t.row("MasterCurve::new", apart, Value, "the isotherms at 300 K and 330 K do not overlap…with_law");
    let alone = MasterCurve::new(300.0, vec![isotherm(300.0, 1.0)]).unwrap();
    t.row(
        "MasterCurve::arrhenius",
        alone.arrhenius(),
        Value,
        "temperatures besides the reference: 0 given, at least 1 needed",
    );
    let rising = MasterCurve::new(300.0, vec![isotherm(300.0, 1.0), isotherm(310.0, 10.0)]).unwrap();
    t.row(
        "MasterCurve::arrhenius",
        rising.arrhenius(),
        Value,
        "activation energy of the shift factors = -178046… → > 0: …",
    );
    for (rows, says) in [
        (vec![], "table of storage moduli: 0 given, at least 4 needed"),
        (
            vec![(1.0, 1.0e6), (1.0, 2.0e6), (2.0, 3.0e6)],
            "table of storage moduli: entry 1 and entry 0 give two values for…",
        ),
        (vec![(0.0, 1.0e6), (1.0, 2.0e6), (2.0, 3.0e6)], "table of storage moduli, entry 0: angular frequency = 0.0 …"),
        (
            vec![(1.0, 1.0e6), (2.0, -2.0e6), (3.0, 3.0e6)],
            "table of storage moduli, entry 1: storage modulus = -2000000.0 …",
        ),
        (
            vec![(1.0, 1.0e6), (2.0, f64::NAN), (3.0, 3.0e6)],
            "table of storage moduli, entry 1: storage modulus = NaN …",
        ),
    ] {
        t.row("Measurements::storage", Measurements::storage(&rows), Value, says);
    }
    let wlf = || TimeTemperature::wlf(17.44, 51.6, 300.0).unwrap();
    for (temperature, says) in [
        (0.0, "temperature = 0.0 → finite and > 0"),
        (f64::NAN, "temperature = NaN → finite and > 0"),
        (20.0, "temperature = 20.0 → above T_ref - C2, …kelvin…"),
        (248.5, "shift factor = inf → in [1e-60, 1e60]: …kelvin…"),
    ] {
        t.row("TemperatureHistory::constant", TemperatureHistory::constant(wlf(), temperature), Value, says);
        t.row("TimeTemperature::shift_factor", wlf().shift_factor(temperature), Value, says);
    }
    let by_table = || TimeTemperature::table(&[(290.0, 10.0), (300.0, 1.0)], 300.0).unwrap();
    t.row(
        "TimeTemperature::shift_factor",
        by_table().shift_factor(310.0),
        Value,
        "temperature = 310.0 → in the table of shift factors…extrapolated)",
    );
    t.row(
        "TimeTemperature::shift_factor",
        TimeTemperature::arrhenius(3.0e5, 300.0).unwrap().shift_factor(20.0),
        Value,
        "temperature = 20.0 → from a third to three times that of an Arrhenius law: …kelvin…",
    );
    let constant = || TemperatureHistory::constant(wlf(), 300.0).unwrap();
    for ([rate, reference, start], says) in [
        ([-0.1, 1.0, 1.0], "shift rate of ageing = -0.1 → in [0, 2]"),
        ([2.1, 1.0, 1.0], "shift rate of ageing = 2.1 → in [0, 2]"),
        ([1.0, 0.0, 1.0], "reference age = 0.0 → finite and > 0"),
        ([1.0, 1.0, f64::NAN], "age at the start = NaN → finite and > 0"),
    ] {
        t.row("TemperatureHistory::ageing", constant().ageing(rate, reference, start), Value, says);
    }
    for (rows, reference, says) in [
        (vec![(300.0, 1.0)], 300.0, "rows of shift factors: 1 given, at least 2 needed"),
        (vec![(300.0, 1.0), (290.0, 10.0)], 300.0, "temperatures of shift factors[1] = 290.0 …must ascend"),
        (vec![(290.0, 0.0), (300.0, 1.0)], 300.0, "shift factor = 0.0 → finite and > 0"),
        (vec![(-290.0, 10.0), (300.0, 1.0)], 300.0, "temperature = -290.0 → finite and > 0"),
        (
            vec![(290.0, 10.0), (300.0, 1.1)],
            300.0,
            "reference temperature = 300.0 → …of the table at which the factor is 1",
        ),
        (vec![(290.0, 10.0), (300.0, f64::NAN)], 300.0, "shift factor = NaN → finite and > 0"),
    ] {
        t.row("TimeTemperature::table", TimeTemperature::table(&rows, reference), Value, says);
    }
    for (law, temperature, energy, says) in [
        (wlf(), 280.0, 0.0, "activation energy = 0.0 → finite and > 0"),
        (wlf(), f64::NAN, 1.0e5, "upper end of an Arrhenius law = NaN → at most the reference…"),
        (wlf(), -5.0, 1.0e5, "temperature = -5.0 → finite and > 0"),
        (wlf(), 310.0, 1.0e5, "upper end of an Arrhenius law = 310.0 → at most the reference…"),
        (wlf(), 240.0, 1.0e5, "temperature = 240.0 → above T_ref - C2, …kelvin…"),
        (
            wlf().with_arrhenius_below(270.0, 1.0e5).unwrap(),
            280.0,
            1.0e5,
            "upper end of an Arrhenius law = 280.0 → …below those given before",
        ),
        (by_table(), 280.0, 1.0e5, "temperature = 280.0 → in the table of shift factors…extrapolated)"),
    ] {
        t.row("TimeTemperature::with_arrhenius_below", law.with_arrhenius_below(temperature, energy), Value, says);
    }
    for ([glassy, rubbery, time], says) in [
        ([0.0, 1.0, 1.0], "glassy modulus = 0.0 → finite, and greater than the rubbery modulus"),
        ([2.0, f64::NAN, 1.0], "rubbery modulus = NaN → finite and > 0"),
        ([2.0, 1.0, 0.0], "relaxation time = 0.0 → finite and > 0"),
        ([1.0, 2.0, 1.0], "glassy modulus = 1.0 → finite, and greater than the rubbery modulus"),
        ([1.0, 1.0, 1.0], "glassy modulus = 1.0 → finite, and greater than the rubbery modulus"),
    ] {
        t.row("Zener::relaxing", Zener::relaxing(glassy, rubbery, time), Value, says);
    }
}
