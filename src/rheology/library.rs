//! Published materials, by name.
//!
//! Prony series as printed, each with its reference and the source of the digits. Other specimens differ by
//! temperature, compound and ageing: take these as examples of real bodies, and measure your own.
//!
//! ```
//! use viscocontact::rheology::library;
//!
//! for material in library::all() {
//!     println!("{}: {}", material.name, material.reference);
//! }
//! let pmma = library::find("PMMA")?;
//! let body = pmma.material(0.35)?; // Poisson's ratio is not published with it
//! assert!((body.contact_compliance(0.0) * 2.23947e9 / (1.0 - 0.35 * 0.35) - 1.0).abs() < 1e-12);
//! # Ok::<(), viscocontact::Error>(())
//! ```

use crate::error::{Refusal, Result, poisson_ratio};
use crate::rheology::{GeneralizedMaxwell, Material, TimeTemperature};

/// The modulus of a published series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measured {
    /// The shear relaxation modulus G(t).
    Shear,
    /// The relaxation modulus E(t) of a rod in tension, G(t) = E(t)/(2 (1 + ν)).
    Tension,
}

/// A published material: a relaxation modulus as a Prony series.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PublishedMaterial {
    /// Its name in this library.
    pub name: &'static str,
    /// A description.
    pub description: &'static str,
    /// Whether the series describes shear or tension.
    pub measured: Measured,
    /// Modulus \[Pa\] of which the strengths of the terms are fractions.
    scale: f64,
    equilibrium: f64,
    /// Strength and relaxation time \[s\] of a term in each line.
    terms: &'static str,
    /// Temperature of the measurement \[K\], if published.
    pub temperature: Option<f64>,
    /// Poisson's ratio, if published.
    pub poisson: Option<f64>,
    wlf: Option<[f64; 2]>,
    /// The publication.
    pub reference: &'static str,
    /// The source of the digits, and remarks on their use.
    pub remark: &'static str,
}

impl PublishedMaterial {
    /// Modulus after an infinite time, as published \[Pa\].
    pub fn equilibrium(&self) -> f64 {
        self.equilibrium * self.scale
    }

    /// (Modulus \[Pa\], relaxation time \[s\]) of each term, as published.
    pub fn terms(&self) -> Vec<(f64, f64)> {
        let term = |line: &str| {
            let (strength, time) = line.split_once(' ')?;
            Some((strength.parse::<f64>().ok()? * self.scale, time.parse().ok()?))
        };
        self.terms.lines().filter_map(term).collect()
    }

    /// The time–temperature law, if published.
    pub fn time_temperature(&self) -> Option<TimeTemperature> {
        let ([c1, c2], reference) = self.wlf.zip(self.temperature)?;
        TimeTemperature::wlf(c1, c2, reference).ok()
    }

    /// Its behaviour in shear, with Poisson's ratio `nu` constant in time where the series describes tension.
    ///
    /// # Errors
    /// If `nu` is outside (−1, ½].
    pub fn rheology(&self, nu: f64) -> Result<GeneralizedMaxwell> {
        poisson_ratio("Poisson's ratio", nu)?;
        let to_shear = if self.measured == Measured::Tension { 0.5 / (1.0 + nu) } else { 1.0 };
        let terms: Vec<_> = self.terms().into_iter().map(|(modulus, time)| (to_shear * modulus, time)).collect();
        GeneralizedMaxwell::new(to_shear * self.equilibrium(), &terms)
    }

    /// The material with a constant Poisson's ratio `nu`: C = (1 − ν) J/2, which is (1 − ν²) times the creep in
    /// tension.
    ///
    /// # Errors
    /// If `nu` is outside (−1, ½].
    pub fn material(&self, nu: f64) -> Result<Material> {
        Material::constant_poisson(self.rheology(nu)?, nu)
    }
}

/// All published materials.
pub fn all() -> &'static [PublishedMaterial] {
    &MATERIALS
}

/// The material of this name; upper and lower case are equal.
///
/// # Errors
/// If there is none; the error lists the known names.
pub fn find(name: &str) -> Result<&'static PublishedMaterial> {
    MATERIALS.iter().find(|material| material.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
        let known = MATERIALS.map(|material| material.name).join(", ");
        let remedy = format!("; known are: {known}");
        Refusal::value("material_unknown", format!("there is no published material named {name:?}"), &remedy).into()
    })
}

static MATERIALS: [PublishedMaterial; 5] = [PMMA, EPOXY, ADHESIVE, POLYISOBUTYLENE, POLYSTYRENE_RINGS];

const PMMA: PublishedMaterial = PublishedMaterial {
    name: "PMMA",
    description: "polymethyl methacrylate",
    measured: Measured::Tension,
    scale: 1.0e6,
    equilibrium: 2.24,
    terms: include_str!("library/pmma.txt"),
    temperature: None,
    poisson: None,
    wlf: None,
    reference: "R. A. Schapery, GALCIT SM 61-23A, California Institute of Technology, 1962; S. W. Park, R. A. Schapery, \
                Int. J. Solids Struct. 36 (1999) 1653, doi:10.1016/S0020-7683(98)00055-9",
    remark: "digits as in the data of S. Shanbhag, J. Rheol. 67 (2023) 965 (github.com/shane5ul/psi, tests/g2.dat); \
             neither temperature nor Poisson's ratio is given there",
};

const EPOXY: PublishedMaterial = PublishedMaterial {
    name: "epoxy",
    description: "commercial epoxy, cured",
    measured: Measured::Shear,
    // the printed weights are fractions of the drop from 891 MPa to 4.9 MPa
    scale: 886.1e6,
    equilibrium: 4.9 / 886.1,
    terms: include_str!("library/epoxy.txt"),
    temperature: None,
    poisson: None,
    wlf: None,
    reference: "S. L. Simon, G. B. McKenna, O. Sindt, J. Appl. Polym. Sci. 76 (2000) 495",
    remark: "digits as in github.com/ealopez/TappingMode_Simulations (Data_Prony_Materials/Epoxy_Data); the weights add up \
             to 1, the last time leaves out half a decade, the temperature is not given there",
};

const ADHESIVE: PublishedMaterial = PublishedMaterial {
    name: "adhesive",
    description: "electrically conductive adhesive E1 of photovoltaic modules, unexposed",
    measured: Measured::Shear,
    // E(0) = 9115.8 MPa and nu = 0.35 as published: G(0) = E/(2 (1 + nu))
    scale: 9115.80e6 / 2.7,
    equilibrium: 1.7463879e-2,
    terms: include_str!("library/adhesive.txt"),
    temperature: Some(268.0),
    poisson: Some(0.35),
    wlf: Some([199.73, 933.5]),
    reference: "M. Springer, N. Bosco, Prog. Photovolt. 28 (2020) 659, doi:10.1002/pip.3257",
    remark: "digits as in the material card of the author's package pyvisco 2.1.3 (tests/data/E1_WLF.USER_MPL), which refers to \
             \"Springer, 2020\"; the longest times are extrapolated by shifting",
};

const POLYISOBUTYLENE: PublishedMaterial = PublishedMaterial {
    name: "polyisobutylene",
    description: "polyisobutylene at 25 degrees Celsius, 1e-11 s to 1e6 s",
    measured: Measured::Tension,
    scale: 1.0,
    equilibrium: 0.0,
    terms: include_str!("library/polyisobutylene.txt"),
    temperature: Some(298.15),
    poisson: None,
    wlf: None,
    reference: "E. Catsiff, A. V. Tobolsky (1955), fitted by H. F. Brinson, L. C. Brinson, Polymer Engineering Science and \
                Viscoelasticity, Springer, figures 7.18 and 7.19",
    remark: "digitised from the figure in github.com/ealopez/TappingMode_Simulations, rounded to three digits here, two \
             terms of 0.1 Pa left out; reproduces the data within a factor of 0.81 to 1.12",
};

const POLYSTYRENE_RINGS: PublishedMaterial = PublishedMaterial {
    name: "polystyrene rings",
    description: "melt of polystyrene rings of 198 kg/mol, a fluid",
    measured: Measured::Shear,
    scale: 1.0,
    equilibrium: 0.0,
    terms: include_str!("library/polystyrene_rings.txt"),
    temperature: None,
    poisson: None,
    wlf: None,
    reference: "M. Kapnistos et al., Nat. Mater. 7 (2008) 997; spectrum: S. Shanbhag, Macromol. Theory Simul. \
        (2019) 1900005",
    remark: "digits as in the data of S. Shanbhag, J. Rheol. 67 (2023) 965 (github.com/shane5ul/psi, tests/g3.dat); the temperature is \
             not given there",
};
