//! What callers rely on besides numbers: errors that differ, outputs that replace earlier ones on request, names
//! that do not collide, values that can be stored.

use std::error::Error as _;
use std::io;

use crate::common::{maxwell, sphere_on};
use viscocontact::TextFormat;
use viscocontact::rheology::{Experiment, Units};

/// Names that the prelude leaves to others: an ambiguous one would not compile.
mod names {
    pub struct Path;
    pub struct Sum;
    pub struct Form;
    pub type Result = Path;
}

mod with_prelude {
    use super::names::*;
    use viscocontact::prelude::*;

    #[test]
    fn the_prelude_leaves_common_names_alone() {
        let (_, _, path): (Sum, Form, Result) = (Sum, Form, Path);
        assert_eq!(size_of_val(&path), 0);
        let _ = Load::force(1.0);
    }
}

use viscocontact::ErrorKind;
use viscocontact::prelude::*;

fn contact() -> ViscoelasticContact {
    sphere_on(Grid::square(16, 4.0e-3).unwrap(), maxwell(), Settings::default())
}

/// The messages of an error and of its sources.
fn messages(error: &Error) -> Vec<String> {
    let mut messages = vec![error.to_string()];
    let mut source = error.source();
    while let Some(error) = source {
        messages.push(error.to_string());
        source = error.source();
    }
    messages
}

/// No message of an error contains a message of its sources; errors of files name the file.
#[test]
fn no_message_repeats_its_source() {
    let missing = "no/such/folder/file";
    let errors = [
        (false, Maxwell::new(-1.0, 1.0).unwrap_err()),
        (false, Ramp::new(Load::force(0.0), Load::approach(0.0), 1.0).unwrap_err()),
        (true, HeightMap::read(format!("{missing}.sdf")).unwrap_err()),
        (true, Measurements::from_csv(Experiment::Creep, missing, Units::SI, TextFormat::default()).unwrap_err()),
        (true, contact().resume(missing).unwrap_err()),
        (true, contact().save(missing).unwrap_err()),
        (true, viscocontact::output::write_npy(missing, contact().grid(), &[0.0; 256]).unwrap_err()),
    ];
    for (of_file, error) in errors {
        let messages = messages(&error);
        for (k, message) in messages.iter().enumerate() {
            assert!(messages[..k].iter().all(|outer| !outer.contains(message)), "{messages:?}");
        }
        assert_eq!(error.io_kind(), of_file.then_some(io::ErrorKind::NotFound), "{messages:?}");
        assert!(!of_file || messages[0].contains(missing), "{messages:?}");
    }
}

#[test]
fn a_report_prints_round_times() {
    let mut contact = contact();
    contact.step(0.0, Load::force(0.5)).unwrap();
    let mut report = contact.step(0.05, Load::force(0.5)).unwrap();
    for _ in 0..2 {
        report = contact.step(0.05, Load::force(0.5)).unwrap();
    }
    assert!(report.time != 0.15, "the sum of three steps is not rounded: {:?}", report.time);
    assert!(report.to_string().starts_with("t = 0.15 s: force 0.5 N, approach "), "{report}");
}

/// On a grid that follows the indenter no error is estimated, and the report states that.
#[test]
fn steps_over_the_bodies_have_no_estimate() {
    let settings = Settings::default().with_frame(Frame::Indenter);
    let mut contact = sphere_on(Grid::square(16, 4.0e-3).unwrap(), maxwell(), settings);
    let report = contact.step(0.0, Load::force(0.1)).unwrap();
    assert_eq!(report.time_error, Some(0.0));
    let report = contact.step_over([1, 0], 0.1, Load::force(0.1)).unwrap();
    assert_eq!(report.time_error, None);
    assert!(report.to_string().contains("error in time not estimated"), "{report}");
}

/// References stand for what they refer to, overridden methods included.
#[expect(clippy::needless_borrows_for_generic_args, reason = "it is about references")]
#[test]
fn references_implement_the_traits() {
    fn compliance(body: impl Rheology) -> (f64, bool) {
        (body.creep_compliance(1.0), body.creep_spectrum().is_some())
    }
    fn gap(shape: impl Geometry) -> f64 {
        shape.initial_gap(1.0e-3, 0.0)
    }
    fn corner(history: impl LoadHistory) -> Option<f64> {
        history.next_breakpoint(0.0)
    }
    let (body, shape) = (Maxwell::with_time(1.0e6, 1.0).unwrap(), Sphere::new(10.0e-3).unwrap());
    assert_eq!(compliance(&body), (body.creep_compliance(1.0), true));
    assert_eq!(gap(&shape), shape.initial_gap(1.0e-3, 0.0));
    assert_eq!(corner(&Ramp::new(Load::force(0.0), Load::force(0.5), 1.0).unwrap()), Some(1.0));
}

mod outputs {
    use std::fs;
    use std::io::ErrorKind::AlreadyExists;

    use viscocontact::output::{CsvHistory, Earlier, Field, Format, FrameSeries, Metadata};

    use super::*;
    use crate::common::temporary::Temporary;

    /// Every output that grows refuses an earlier one, leaves it as it is, and replaces it on request.
    #[test]
    fn earlier_outputs_are_replaced_when_told_so() {
        let folder = Temporary::folder("replaced");
        let mut contact = contact();
        let report = contact.step(0.0, Load::force(0.5)).unwrap();
        let metadata = Metadata::new("Ball on rubber");
        let count = |name: &str| fs::read_dir(folder.join(name)).unwrap().count();

        let (archives, images, table) = (folder.join("npz"), folder.join("vtk"), folder.join("history.csv"));
        let series = |format: Format, fields: &[Field], earlier: Earlier| {
            let folder = if format == Format::Npz { &archives } else { &images };
            FrameSeries::create(folder, format, &metadata, &contact, fields, earlier)
        };
        let history =
            |names: &[&str], earlier: Earlier| CsvHistory::create(&table, &metadata, &contact, names, earlier);
        let [mut first, mut second] =
            [Format::Npz, Format::Vtk].map(|format| series(format, &[Field::Pressure], Earlier::Refuse).unwrap());
        let mut third = history(&[], Earlier::Refuse).unwrap();
        for _ in 0..3 {
            first.record(&contact).unwrap();
            second.record(&contact).unwrap();
            third.record(&contact, &report, &[]).unwrap();
        }
        fs::write(archives.join("notes.txt"), "kept").unwrap();
        let before = fs::read(&table).unwrap();
        for (named, error) in [
            ("frame_000000.npz", series(Format::Npz, &[Field::Pressure], Earlier::Refuse).unwrap_err()),
            ("vtk", series(Format::Vtk, &[Field::Pressure], Earlier::Refuse).unwrap_err()),
            ("history.csv", history(&[], Earlier::Refuse).unwrap_err()),
        ] {
            assert_eq!(error.io_kind(), Some(AlreadyExists), "{error:?}");
            assert!(messages(&error).concat().contains(named), "{:?}", messages(&error));
        }
        assert_eq!(fs::read(&table).unwrap(), before);
        assert_eq!([count("npz"), count("vtk")], [4, 4]);

        // an invalid request removes nothing
        let twice = series(Format::Npz, &[Field::Gap; 2], Earlier::Replace).unwrap_err();
        assert!(messages(&twice).concat().contains("gap is requested twice"), "{:?}", messages(&twice));
        assert_eq!(history(&["a", "a"], Earlier::Replace).unwrap_err().kind(), ErrorKind::File);
        assert_eq!(fs::read(&table).unwrap(), before);
        assert_eq!(count("npz"), 4);

        let replaced = [Format::Npz, Format::Vtk].map(|format| series(format, &[Field::Pressure], Earlier::Replace));
        history(&[], Earlier::Replace).unwrap();
        assert_eq!([count("npz"), count("vtk")], [1, 0]);
        for series in replaced {
            series.unwrap().record(&contact).unwrap();
        }
        assert_eq!([count("npz"), count("vtk")], [2, 2]);
        assert_eq!(fs::read_to_string(&table).unwrap().lines().count(), 1);
        assert_eq!(fs::read_to_string(archives.join("notes.txt")).unwrap(), "kept");

        let error = CsvHistory::create(&archives, &metadata, &contact, &[], Earlier::Replace).unwrap_err();
        assert!(error.code() == "not_a_file", "{error}");
    }
}

/// Fields, maps and tables print in a line, however many values they have.
#[test]
fn many_values_are_counted_not_printed() {
    let map = HeightMap::new([40, 50], [4.0e-5, 5.0e-5], vec![1.0e-9; 2000]).unwrap();
    let times: Vec<f64> = (1..=100).map(f64::from).collect();
    let table = Measurements::creep(&times.iter().map(|&t| (t, 1.0e-9 * (2.0 + t.ln()))).collect::<Vec<_>>()).unwrap();
    let fitted = table.fit().unwrap();
    for text in [format!("{map:?}"), format!("{table:?}"), format!("{:?}", fitted.report())] {
        assert!(text.contains(" values") && text.len() < 400 && !text.contains('\n'), "{text}");
    }
    assert_eq!(map.to_string(), "40 × 50 heights from 1.000e-9 m to 1.000e-9 m on 4.000e-5 m × 5.000e-5 m");
}

/// The description of a scene has numbers, and nothing as Rust prints it.
#[test]
fn metadata_are_values() {
    use viscocontact::output::Metadata;

    let polymer = Material::elastic_bulk(Zener::with_time(1.0e9, 1.0e8, 2.0).unwrap(), 3.0e9).unwrap();
    let steel = Material::constant_poisson(Elastic::young(210.0e9, 0.3).unwrap(), 0.3).unwrap();
    let contact = sphere_on(Grid::square(16, 4.0e-3).unwrap(), polymer.against(steel), Settings::default());
    let json = Metadata::new("values").json(&contact);
    for part in [
        r#""settings": {"tolerance": 1e-6, "max_iterations": 1000, "time_rule": "Exponential""#,
        r#""material": [{"bulk_modulus": 3000000000.0, "contact_creep": {"glassy": "#,
        r#"{"poisson": 0.3, "contact_creep": {"glassy": "#,
        r#""fluidity": 0.0, "terms": []}"#,
    ] {
        assert!(json.contains(part), "{part} in {json}");
    }
    // braces, brackets and quotes pair up
    let count = |c: char| json.matches(c).count();
    assert_eq!((count('{'), count('['), count('"') % 2), (count('}'), count(']'), 0));
    assert!(!json.contains("Spectrum") && !json.contains("Some("), "{json}");
}
