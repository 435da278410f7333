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

use crate::error::poisson_ratio;
use crate::error::{MaterialError, Result};
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
    terms: Terms,
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
        let [strengths, times] = self.terms;
        strengths.iter().zip(times).map(|(strength, &time)| (strength * self.scale, time)).collect()
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
        MaterialError::Unknown { name: name.to_owned(), known }.into()
    })
}

/// Strengths and relaxation times \[s\] of the terms, one for one.
type Terms = [&'static [f64]; 2];

/// The columns of a published table, of the same length.
const fn columns<const N: usize>(strengths: &'static [f64; N], times: &'static [f64; N]) -> Terms {
    [strengths, times]
}

static MATERIALS: [PublishedMaterial; 5] = [PMMA, EPOXY, ADHESIVE, POLYISOBUTYLENE, POLYSTYRENE_RINGS];

const PMMA: PublishedMaterial = PublishedMaterial {
    name: "PMMA",
    description: "polymethyl methacrylate",
    measured: Measured::Tension,
    scale: 1.0e6,
    equilibrium: 2.24,
    terms: columns(
        &[1.94e2, 2.83e2, 5.54e2, 6.02e2, 3.88e2, 1.56e2, 4.1e1, 1.38e1, 3.68e0, 7.9e-1, 9.6e-1],
        &[2.0e-2, 2.0e-1, 2.0e0, 2.0e1, 2.0e2, 2.0e3, 2.0e4, 2.0e5, 2.0e6, 2.0e7, 2.0e8],
    ),
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
    terms: columns(
        &[
            2.15e-2, 2.15e-2, 2.15e-2, 2.15e-2, 2.67e-2, 2.67e-2, 3.75e-2, 4.05e-2, 6.3e-2, 6.3e-2, 1.054e-1, 1.16e-1,
            1.16e-1, 1.653e-1, 5.61e-2, 5.61e-2, 1.99e-2, 1.19e-2, 5.5e-3, 2.8e-3, 8.0e-4, 2.0e-4, 3.0e-4, 3.0e-4,
        ],
        &[
            1.0e-7, 3.1623e-7, 1.0e-6, 3.1623e-6, 1.0e-5, 3.1623e-5, 1.0e-4, 3.1623e-4, 1.0e-3, 3.1623e-3, 1.0e-2,
            3.1623e-2, 1.0e-1, 3.1623e-1, 1.0e0, 3.1623e0, 1.0e1, 3.1623e1, 1.0e2, 3.1623e2, 1.0e3, 3.1623e3, 1.0e4,
            1.0e5,
        ],
    ),
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
    terms: columns(
        &[
            4.117658e-2,
            1.553623e-2,
            1.842653e-2,
            1.777279e-2,
            1.66776e-2,
            1.41939e-2,
            1.394684e-2,
            1.669666e-2,
            1.403274e-2,
            2.121446e-2,
            2.113702e-2,
            2.585145e-2,
            3.07685e-2,
            3.03654e-2,
            3.333614e-2,
            3.694363e-2,
            4.254108e-2,
            4.613635e-2,
            5.217609e-2,
            5.58741e-2,
            6.258372e-2,
            6.662379e-2,
            7.106892e-2,
            6.725932e-2,
            5.814158e-2,
            4.188188e-2,
            2.436555e-2,
            1.059265e-2,
            4.097021e-3,
            1.11176e-2,
        ],
        &[
            1.0e-10, 1.0e-9, 1.0e-8, 1.0e-7, 1.0e-6, 1.0e-5, 1.0e-4, 1.0e-3, 1.0e-2, 1.0e-1, 1.0e0, 1.0e1, 1.0e2,
            1.0e3, 1.0e4, 1.0e5, 1.0e6, 1.0e7, 1.0e8, 1.0e9, 1.0e10, 1.0e11, 1.0e12, 1.0e13, 1.0e14, 1.0e15, 1.0e16,
            1.0e17, 1.0e18, 1.0e19,
        ],
    ),
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
    terms: columns(
        &[
            1.86e6, 5.62e7, 1.29e8, 3.21e8, 4.13e8, 8.23e8, 6.31e8, 3.61e8, 1.53e8, 4.52e7, 2.23e7, 6.1e6, 2.61e6,
            1.11e6, 2.82e5, 1.29e5, 6.35e4, 7.21e3, 1.34e4, 9.28e4, 4.57e4, 1.31e5, 8.11e4, 1.39e5, 1.07e5, 1.28e5,
            6.26e4, 3.09e4,
        ],
        &[
            3.22e-12, 1.36e-11, 5.65e-11, 2.34e-10, 1.17e-9, 4.85e-9, 2.25e-8, 9.65e-8, 3.83e-7, 1.67e-6, 7.2e-6,
            2.89e-5, 1.48e-4, 5.87e-4, 2.36e-3, 9.36e-3, 4.03e-2, 1.8e-1, 8.16e-1, 3.29e0, 1.3e1, 5.85e1, 2.97e2,
            1.05e3, 5.28e3, 2.64e4, 8.8e4, 4.12e5,
        ],
    ),
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
    terms: columns(
        &[3.814512e5, 5.154208e5, 2.180057e5, 7.856716e4, 3.546649e4, 1.822482e4, 1.133953e4, 5.671307e3],
        &[6.92318e-6, 2.943798e-5, 2.080151e-4, 1.486046e-3, 8.315544e-3, 5.212831e-2, 2.093194e-1, 1.109871e0],
    ),
    temperature: None,
    poisson: None,
    wlf: None,
    reference: "M. Kapnistos et al., Nat. Mater. 7 (2008) 997; spectrum: S. Shanbhag, Macromol. Theory Simul. (2019) 1900005",
    remark: "digits as in the data of S. Shanbhag, J. Rheol. 67 (2023) 965 (github.com/shane5ul/psi, tests/g3.dat); the temperature is \
             not given there",
};
