//! What rheologies and materials refuse, by the name of the value.

use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, PronyTerm, RelaxationSpectrum, Tension};

use crate::common::refused::refused;

/// A share of the glassy modulus with its time.
fn share(share: f64, time: f64) -> PronyTerm {
    PronyTerm { share, time }
}

fn elastic(modulus: f64) -> Elastic {
    Elastic::new(modulus).unwrap()
}

#[test]
fn rheologies_refuse_by_name() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused([
            (Elastic::new(bad).err(), "shear modulus"),
            (Maxwell::new(bad, 1.0).err(), "shear modulus"),
            (Maxwell::new(1.0, bad).err(), "shear viscosity"),
            (KelvinVoigt::new(bad, 1.0).err(), "shear modulus"),
            (KelvinVoigt::new(1.0, bad).err(), "shear viscosity"),
            (Zener::new(1.0, bad, 1.0).err(), "Kelvin–Voigt modulus"),
            (Zener::new(1.0, 1.0, bad).err(), "Kelvin–Voigt viscosity"),
            (Burgers::new(1.0, bad, 1.0, 1.0).err(), "shear viscosity"),
            (GeneralizedKelvin::new(1.0, 0.0, &[(1.0, bad)]).err(), "retardation time"),
            (GeneralizedMaxwell::new(1.0, &[(1.0, bad)]).err(), "relaxation time"),
        ]);
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        refused([
            (GeneralizedKelvin::new(bad, 0.0, &[]).err(), "glassy compliance"),
            (GeneralizedKelvin::new(1.0, bad, &[]).err(), "fluidity"),
            (GeneralizedKelvin::new(1.0, 0.0, &[(bad, 1.0)]).err(), "retarded compliance"),
            (GeneralizedMaxwell::new(bad, &[(1.0, 1.0)]).err(), "equilibrium modulus"),
            (RelaxationSpectrum::new(1.0, bad, &[]).err(), "immediate viscosity"),
        ]);
    }
    // a fit costs the fourth power of its decades: too many are not begun
    let power_law = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap();
    for times in [1e-90..=1e90, 1e-26..=1e25, 1e-10..=1.1e40] {
        refused([(power_law.series(times, 1e-2).err(), "decades of a series")]);
    }
    refused([
        // reciprocals and products stay numbers
        (Maxwell::new(1e-150, 1e170).err(), "glassy compliance"),
        (GeneralizedMaxwell::new(1e-310, &[(1.0, 1.0)]).err(), "equilibrium modulus"),
        (GeneralizedKelvin::new(1.0, 0.0, &[(1.0, 1e-200)]).err(), "retardation time"),
        (CreepSpectrum::new(0.0, 0.0, &[(0.0, 1.0)]).err(), "creep spectrum"),
        (GeneralizedMaxwell::new(1.0, &[]).err(), "Maxwell elements"),
        (GeneralizedMaxwell::new(0.0, &[(0.0, 1.0)]).err(), "relaxation spectrum"),
        // constructors by times
        (Maxwell::with_time(1.0e6, 0.0).err(), "relaxation time"),
        (KelvinVoigt::with_time(1.0e6, f64::NAN).err(), "retardation time"),
        (Zener::relaxing(1.0e6, 1.0e6, 1.0).err(), "glassy modulus"),
        (Zener::relaxing(1.0e6, -1.0, 1.0).err(), "rubbery modulus"),
        (FractionalZener::relaxing(1.0e6, 2.0e6, 1.0, 0.5).err(), "glassy modulus"),
        (FractionalZener::relaxing(2.0e6, 1.0e6, 1.0, 1.5).err(), "exponent"),
        (Burgers::with_times((1.0, 1.0), (1.0, 0.0)).err(), "retardation time"),
        (GeneralizedMaxwell::prony(1.0, &[share(0.6, 1.0), share(0.6, 2.0)]).err(), "sum of the shares"),
        (GeneralizedMaxwell::prony(1.0, &[share(3.0e6, 1.0)]).err(), "share of the glassy modulus"),
        (GeneralizedMaxwell::prony_long_term(0.0, &[share(1.0, 1.0)]).err(), "rubbery modulus"),
        (Elastic::young(1.0, 0.6).err(), "Poisson's ratio"),
        (Elastic::young(0.0, 0.3).err(), "Young's modulus"),
        (FractionalMaxwell::new(1e-310, 1.0, 0.5).err(), "compliance 1/G"),
    ]);
}

#[test]
fn materials_refuse_by_name() {
    for nu in [-1.0, 0.51, f64::NAN] {
        refused([(Material::constant_poisson(elastic(1.0), nu).err(), "Poisson's ratio")]);
    }
    for ratio in [-0.1, 1.0, f64::NAN] {
        let material = Material::relaxing_bulk(elastic(1.0), 1.0, ratio);
        refused([(material.err(), "ratio of the relaxation in bulk to that in shear")]);
    }
    let dashpot = || KelvinVoigt::new(1.0e6, 1.0e6).unwrap();
    refused([
        (Material::relaxing_bulk(dashpot(), 1.0e9, 0.5).err(), "elastic compliance of the rheology"),
        (Material::from_tension(Tension(elastic(1.0)), -1.0).err(), "Poisson's ratio"),
        (Material::from_tension_elastic_bulk(Tension(elastic(9.0e9)), 1.0e9).err(), "bulk modulus"),
        (Material::from_tension_elastic_bulk(Tension(dashpot()), 1.0e9).err(), "bulk modulus"),
    ]);
}
