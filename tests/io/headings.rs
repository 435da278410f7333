//! Headings of columns, each with its one unit, or refused.

use viscocontact::input::{Quantity, TextTable, WantedColumn};
use viscocontact::rheology::{Experiment, Measurements, Units};
use viscocontact::{Result, TextFormat};

const HERTZ: f64 = std::f64::consts::TAU;

/// Headings by quantity, and the size of their unit in SI.
const UNITS: [(Quantity, &[(&str, f64)]); 6] = [
    (
        Quantity::FORCE,
        &[
            ("load_micro_N", 1e-6),
            ("load_milli_N", 1e-3),
            ("Load (micro N)", 1e-6),
            ("Load (micro-N)", 1e-6),
            ("Load [micro N]", 1e-6),
            ("Load / micro N", 1e-6),
            ("Load (1E-6 N)", 1e-6),
            ("load_uN", 1e-6),
            ("Load [uN]", 1e-6),
            ("load_microN", 1e-6),
            ("Load (µN)", 1e-6),
            ("Load [μN]", 1e-6),
            ("Load/mN", 1e-3),
            ("Load (millinewton)", 1e-3),
            ("Load (micronewtons)", 1e-6),
            ("Load in nN", 1e-9),
            ("Load (in mN)", 1e-3),
            ("Load [×10^-3 N]", 1e-3),
            ("Load (x 1e-6 N)", 1e-6),
            ("Load [10**-6 N]", 1e-6),
            ("Load (dyn)", 1e-5),
            ("Load On Sample (mN)", 1e-3),
            ("Force [nN] (smoothed)", 1e-9),
            ("LOAD_MICRO_N", 1e-6),
            ("load mikro N", 1e-6),
            ("Load (10^-6 * N)", 1e-6),
            ("Load (1e3 N)", 1e3),
            ("Load (10³ N)", 1e3),
            ("Max (N)", 1.0),
            ("Fx10 (N)", 1.0),
            ("Force channel 1 (N)", 1.0),
            ("F 100 (N)", 1.0),
            ("load cell 10 N (mN)", 1e-3),
        ],
    ),
    (
        Quantity::LENGTH,
        &[
            ("depth_micro_m", 1e-6),
            ("depth_nano_m", 1e-9),
            ("Depth (nanometers)", 1e-9),
            ("Depth (micrometres)", 1e-6),
            ("Depth (microns)", 1e-6),
            ("Depth (Micron)", 1e-6),
            ("depth_um", 1e-6),
            ("Depth (Å)", 1e-10),
            ("Depth [10^-9 m]", 1e-9),
            ("Depth, nm", 1e-9),
            ("h/nm", 1e-9),
            ("Displacement Into Surface (nm)", 1e-9),
            ("x1 (mm)", 1e-3),
            ("depth_microns", 1e-6),
            ("Height 10x (µm)", 1e-6),
        ],
    ),
    (
        Quantity::TIME,
        &[
            ("time_milli_s", 1e-3),
            ("time (milliseconds)", 1e-3),
            ("Time On Sample (s)", 1.0),
            ("t [micro s]", 1e-6),
            ("t/(ms)", 1e-3),
            ("Time {min}", 60.0),
            ("t_h", 3600.0),
            ("Time x 60 (s)", 1.0),
            ("time|s", 1.0),
            ("t.s", 1.0),
        ],
    ),
    (
        Quantity::MODULUS,
        &[
            ("E'_mega_Pa", 1e6),
            ("E' (mega Pa)", 1e6),
            ("G' [kilo Pa]", 1e3),
            ("G' (x10^6 Pa)", 1e6),
            ("G' (10^6 Pa)", 1e6),
            ("E'(1.000Hz)/MPa", 1e6),
            ("E'(10.000Hz) (MPa)", 1e6),
            ("E' (10 Hz) [MPa]", 1e6),
            ("E* 10 Hz [MPa]", 1e6),
            ("|E*| (GPa)", 1e9),
            ("E' in 10^6 Pa", 1e6),
            ("E'_MPa", 1e6),
            ("Storage modulus (megapascal)", 1e6),
            ("Storage modulus (kilopascals)", 1e3),
            ("G' [N/mm^2]", 1e6),
            ("G' [N/mm²]", 1e6),
            ("G' (dyn/cm^2)", 0.1),
            ("G' [bar]", 1e5),
            ("G' (mega-Pa)", 1e6),
            ("G' 10^3 Pa", 1e3),
            ("G' [Pa] at 1 % strain", 1.0),
            ("E* (MPa)", 1e6),
            ("G* [kPa]", 1e3),
            ("E' max (MPa)", 1e6),
            ("Storage Modulus, G' [Pa]", 1.0),
            ("G'(ω) in Pa", 1.0),
            ("E'[MPa](1Hz)", 1e6),
            ("E-Modulus (MPa)", 1e6),
            ("E [Pa] x", 1.0),
        ],
    ),
    (
        Quantity::COMPLIANCE,
        &[
            ("J (1/GPa)", 1e-9),
            ("J [10^-9 1/Pa]", 1e-9),
            ("J (x10^-9 1/Pa)", 1e-9),
            ("J / (10⁻⁶/Pa)", 1e-6),
            ("J [1/mega Pa]", 1e-6),
            ("J [Pa^-1]", 1.0),
            ("J [m²/N]", 1.0),
            ("J [GPa⁻¹]", 1e-9),
            ("J(t) 1/(GPa)", 1e-9),
            ("J at 5 MPa [1/GPa]", 1e-9),
            ("J (mm^2/N)", 1e-6),
        ],
    ),
    (
        Quantity::FREQUENCY,
        &[
            ("freq_kilo_Hz", 1e3 * HERTZ),
            ("Frequency [kilohertz]", 1e3 * HERTZ),
            ("omega (rad/s)", 1.0),
            ("omega [rad·s⁻¹]", 1.0),
            ("f_Hz", HERTZ),
        ],
    ),
];

/// Headings without a unit, or with one of several meanings: a factor by which the values may be multiplied or
/// divided, logarithms, words that may change the unit.
const REFUSED: [(Quantity, &[&str]); 6] = [
    (
        Quantity::FORCE,
        &[
            "Load*1e6 (N)",
            "1e6*Load (N)",
            "Load (N) x1e6",
            "load_x1e6_N",
            "kilo load (N)",
            "Load (N*1e6)",
            "Load x 10^6 (N)",
            "MICRO load_MICRO_N",
            "Load (N) [mN]",
            "Load (k N)",
            "load_k_N",
            "10 x load (N)",
            "Load (N) in thousands",
            "load_1e6_N",
            "Load (µ N)",
            "Load micro (N)",
            "load (N) micro",
            "Load (milli micro N)",
            "Load (kilo mN)",
            "Load [x10^-6] (N)",
            "Load (N / 1e6)",
            "Load (1000 N)",
            "Load (x1000 N)",
        ],
    ),
    (Quantity::LENGTH, &["Depth (femto m)"]),
    (Quantity::TIME, &["time (kilo min)", "t (millis)"]),
    (
        Quantity::MODULUS,
        &[
            "G' (log Pa)",
            "E' [log MPa]",
            "G' x10^3 (Pa)",
            "G'*1e-3 (Pa)",
            "G' (true Pa)",
            "G' (Pa x10^3)",
            "G' (Pa 10^3)",
            "10^6 G' (Pa)",
            "G' (10^6) [Pa]",
            "G'·10³ (Pa)",
            "G'×1000 (Pa)",
            "G' x1000 (Pa)",
            "G' Pa (log)",
            "lg G' [Pa]",
            "G' (ln Pa)",
            "G' (log10(Pa))",
            "log10 of G' (Pa)",
            "E' (Pa, kPa)",
            "E' Pa / kPa",
            "E' [MPa or Pa]",
            "E' x 1e6 Pa",
            "E'*1e6 Pa",
            "E' *1e6 Pa",
            "E' (M Pa)",
            "E at 5 MPa",
            "G(s)",
            "G' x10³ [Pa]",
            "G' (Pa/10^3)",
            "E'(MPa)x10",
        ],
    ),
    (Quantity::COMPLIANCE, &["J (micro 1/Pa)", "J (at 5 MPa)"]),
    (Quantity::FREQUENCY, &["omega (log rad/s)", "f (cycles/s)", "w (1/s)"]),
];

/// The size of the unit of a heading.
fn unit(heading: &str, quantity: Quantity) -> Result<f64> {
    let wanted = WantedColumn { name: "column", words: &[], others: &[], quantity, by_unit: true };
    let table = TextTable::read(format!("{heading}\tother\n1\t2\n3\t4\n5\t6\n").as_bytes(), TextFormat::default())?;
    let found = table.find(&wanted)?.ok_or_else(|| table.missing(&wanted, ""))?;
    found.unit()
}

#[test]
fn a_unit_is_the_whole_of_its_text() {
    let (mut taken, mut refused) = (0, 0);
    for (quantity, headings) in UNITS {
        for (heading, size) in headings {
            let found = unit(heading, quantity).unwrap_or_else(|error| panic!("{heading}: {error}"));
            assert!((found / size - 1.0).abs() < 1e-12, "{heading}: {found:e} for {size:e}");
            taken += 1;
        }
    }
    for (quantity, headings) in REFUSED {
        for heading in headings {
            let error = unit(heading, quantity).expect_err(heading);
            assert!(["text_unit", "text_heading"].contains(&error.code()), "{heading}: {error}");
            refused += 1;
        }
    }
    println!("{taken} taken, {refused} refused");
    assert!(taken >= 90 && refused >= 50, "{taken} {refused}");
}

/// Stated units do not hide what a heading says beside its unit.
#[test]
fn stated_units_must_agree_with_the_whole_heading() {
    let mut refused = 0;
    let moduli =
        REFUSED.iter().filter(|(quantity, _)| *quantity == Quantity::MODULUS).flat_map(|(_, headings)| *headings);
    for heading in moduli.filter(|heading| heading.starts_with("G'")) {
        let text = format!("omega (rad/s)\t{heading}\n1\t2\n3\t4\n5\t6\n7\t8\n");
        let read =
            Measurements::from_csv_reader(Experiment::Storage, text.as_bytes(), Units::SI, TextFormat::default());
        assert!(read.is_err(), "{heading}");
        refused += 1;
    }
    assert!(refused > 10, "{refused}");
}
