//! Files of results are read back bit by bit, by readers that share no code with the writers.

use crate::common::fields::gap;
use crate::common::{Temporary, contact_of, maxwell, sphere_on};
use std::fs;
use std::path::{Path, PathBuf};

use viscocontact::ErrorKind;
use viscocontact::observe::StressVolume;
use viscocontact::output::{Field, Format, Metadata};
use viscocontact::prelude::*;

/// A punch that is off the origin and of another number of cells along x1 than along x2, so that no two axes,
/// signs or orders can be mixed up unseen; there is nothing to touch off its face.
fn punch() -> ViscoelasticContact {
    let face = Shifted::new(FlatPunch::circular(0.6e-3).unwrap(), [0.2e-3, -0.1e-3]).unwrap();
    contact_of(&face, Grid::new([24, 17], [3.0e-3, 2.0e-3]).unwrap(), maxwell(), Settings::default())
}

fn scene() -> Metadata {
    Metadata::new("A \"punch\" <on> & µm, \u{1d11e}").note("line\nend", "\\ tab\t").note("operator", "-->]]>")
}

fn series(folder: impl AsRef<Path>, format: Format, contact: &ViscoelasticContact, fields: &[Field]) -> FrameSeries {
    FrameSeries::create(folder, format, &scene(), contact, fields, Earlier::Refuse).unwrap()
}

fn history(path: impl AsRef<Path>, contact: &ViscoelasticContact, additional: &[&str]) -> CsvHistory {
    CsvHistory::create(path, &scene(), contact, additional, Earlier::Refuse).unwrap()
}

/// The jump and two steps of a hold; `after` sees the state after each.
fn run(contact: &mut ViscoelasticContact, mut after: impl FnMut(&ViscoelasticContact, &StepReport)) {
    for dt in [0.0, 0.3, 0.1] {
        let report = contact.step(dt, Load::force(0.7)).unwrap();
        after(contact, &report);
    }
}

/// The contact after its run, and its stress at three depths.
fn stressed() -> (ViscoelasticContact, [f64; 3], StressVolume) {
    let mut contact = punch();
    run(&mut contact, |_, _| ());
    let side = contact.grid().spacing().into_iter().fold(0.0, f64::max);
    let depths = [0.5 * side, side, 3.0 * side];
    let volume = contact.fields().stress().unwrap().in_volume(&depths).unwrap();
    (contact, depths, volume)
}

fn values(contact: &ViscoelasticContact, field: Field) -> Vec<f64> {
    match field {
        // nothing attracts here
        Field::Pressure | Field::Traction => contact.pressure().to_vec(),
        Field::Displacement => contact.fields().displacement().to_vec(),
        _ => gap(contact.fields()),
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn text_of(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

mod npy {
    use std::io::Read;

    use crate::io::npy;
    use viscocontact::output::write_npy;

    use super::*;

    /// Archives of frames are compared bit by bit by `tests/read_back.py`.
    struct Archive(zip::ZipArchive<fs::File>);

    impl Archive {
        fn numbers(&mut self, name: &str) -> (Vec<usize>, Vec<f64>) {
            let mut bytes = Vec::new();
            self.0.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
            npy(&bytes)
        }
    }

    #[test]
    fn an_archive_of_the_stress() {
        use viscocontact::output::write_stress;

        let folder = Temporary::folder("npz-stress");
        let (contact, depths, volume) = stressed();
        let path = folder.join("stress.npz");
        write_stress(&path, Format::Npz, &contact, &volume, &scene()).unwrap();
        let mut archive = Archive(zip::ZipArchive::new(fs::File::open(&path).unwrap()).unwrap());
        assert_eq!(archive.0.len(), 14);
        assert_eq!(archive.numbers("x3"), (vec![3], depths.to_vec()));
        assert_eq!(archive.numbers("pressure"), (vec![24, 17], contact.pressure().to_vec()));
        for (which, name) in ["s11", "s22", "s33", "s12", "s13", "s23", "von_mises", "tresca"].into_iter().enumerate() {
            let (shape, found) = archive.numbers(name);
            assert_eq!(shape, [24, 17, 3]);
            for k in 0..3 {
                for (cell, stress) in volume.plane(k).unwrap().iter().enumerate() {
                    let all = [&stress.components()[..], &[stress.von_mises(), stress.tresca()]].concat();
                    assert_eq!(found[3 * cell + k].to_bits(), all[which].to_bits(), "{name} {cell} {k}");
                }
            }
        }
        let smaller = sphere_on(Grid::square(8, 1.0e-3).unwrap(), maxwell(), Settings::default());
        let error = write_stress(&path, Format::Npz, &smaller, &volume, &scene()).unwrap_err();
        assert!(matches!(error, Error::WrongLength { field: "stress in a volume", .. }), "{error}");
    }

    #[test]
    fn a_frame_that_fails_is_not_there_and_not_counted() {
        let folder = Temporary::folder("npz-fails");
        let (inside, fields) = (folder.join("run"), [Field::Pressure]);
        let mut series = series(inside, Format::Npz, &punch(), &fields);
        fs::remove_dir_all(folder.join("run")).unwrap();
        let error = series.record(&punch()).unwrap_err();
        assert!(matches!(&error, Error::Output(error) if error.path().ends_with("frame_000000.npz")), "{error}");
        assert_eq!(series.frames(), 0);
        fs::create_dir(folder.join("run")).unwrap();
        assert!(series.record(&punch()).unwrap().ends_with("frame_000000.npz"));
    }

    #[test]
    fn single_fields_are_read_back_bit_by_bit() {
        let folder = Temporary::folder("npy");
        let path = folder.join("field.npy");
        let grid = Grid::new([2, 3], [1.0, 1.0]).unwrap();
        let field = [0.1, -0.0, f64::INFINITY, 5e-324, f64::MAX, f64::NAN];
        write_npy(&path, &grid, &field).unwrap();
        let (shape, numbers) = npy(&fs::read(&path).unwrap());
        assert_eq!(shape, [2, 3]);
        assert_eq!(bits(&numbers), bits(&field));
        assert!(matches!(write_npy(&path, &grid, &[0.0; 5]), Err(Error::WrongLength { expected: 6, .. })));
        assert!(matches!(write_npy(folder.join("no/field.npy"), &grid, &field), Err(Error::Output(_))));
    }
}

mod vtk {
    use super::*;

    /// The collection is complete after every frame. What images hold, `tests/read_back.py` compares bit by bit.
    #[test]
    fn fields_are_chosen() {
        let folder = Temporary::folder("vtk-few");
        let (contact, infinity) = (punch(), f64::INFINITY.to_le_bytes());
        let mut series = series(&folder, Format::Vtk, &contact, &[Field::Gap]);
        for frames in 1..4 {
            let image = fs::read(series.record(&contact).unwrap()).unwrap();
            let text = String::from_utf8_lossy(&image);
            assert!(text.contains("gap [m]") && !text.contains("pressure [Pa]"));
            assert!(image.windows(8).any(|bytes| bytes == infinity));
            let collection = text_of(&folder.join("series.pvd"));
            assert!(collection.ends_with("</VTKFile>\n") && collection.matches("<DataSet ").count() == frames);
        }
    }
}

mod csv {
    use super::*;

    #[test]
    fn histories_hold_a_row_a_step() {
        let folder = Temporary::folder("csv");
        let path = folder.join("history.csv");
        let mut contact = punch();
        let mut history = history(&path, &contact, &["energy, total [J]", "odd"]);
        let mut steps = 0;
        run(&mut contact, |contact, report| {
            history.record(contact, report, &[0.1 * report.force, f64::NAN]).unwrap();
            steps += 1;
            // read while the writer is still at work
            let text = text_of(&path);
            let json = text_of(&folder.join("history.csv.json"));
            assert_eq!(json, scene().json(contact) + "\n");
            let mut table = ::csv::Reader::from_reader(text.as_bytes());
            let names = table.headers().unwrap().clone();
            let rows: Vec<_> = table.records().map(Result::unwrap).collect();
            assert_eq!(rows.len(), steps);
            let value = |name: &str| -> f64 {
                let column = names.iter().position(|other| other == name).unwrap();
                rows[steps - 1][column].parse().unwrap()
            };
            assert_eq!(value("time [s]"), contact.time());
            assert_eq!(value("step length [s]"), report.dt);
            assert_eq!(value("force [N]"), contact.force());
            assert_eq!(value("approach [m]"), contact.approach());
            assert_eq!([value("tilt 1 [rad]"), value("tilt 2 [rad]")], contact.tilt());
            assert_eq!([value("moment 1 [N m]"), value("moment 2 [N m]")], contact.fields().moment());
            assert_eq!(value("contact area [m2]"), contact.contact_area());
            assert_eq!(value("contact cells"), contact.contact_cells() as f64);
            assert_eq!(value("mean pressure [Pa]"), contact.mean_pressure());
            assert_eq!(value("max pressure [Pa]"), contact.fields().max_pressure());
            assert_eq!(value("iterations"), report.iterations as f64);
            assert_eq!(value("convolutions"), report.convolutions as f64);
            assert_eq!(value("preconditioner applications"), report.preconditioner_applications as f64);
            assert_eq!(value("residual"), report.residual);
            assert_eq!(Some(value("time error")), report.time_error);
            assert_eq!(value("energy, total [J]"), 0.1 * report.force);
            assert!(value("odd").is_nan());
        });
        let report = contact.step(0.1, Load::force(0.7)).unwrap();
        assert!(matches!(history.record(&contact, &report, &[]), Err(Error::WrongLength { expected: 2, .. })));
        assert_eq!(text_of(&path).lines().count(), 4);
    }

    #[test]
    fn bad_histories_are_refused() {
        let folder = Temporary::folder("csv-bad");
        let (path, contact) = (folder.join("history.csv"), punch());
        for names in [&["a", "a"][..], &["time [s]"], &[""], &["a#b"], &["a\nb"], &["\"a\""]] {
            let error = CsvHistory::create(&path, &scene(), &contact, names, Earlier::Refuse).unwrap_err();
            assert!(error.code() == "output" && format!("{error:?}").contains("column"), "{error:?}");
        }
        assert!(folder.names().is_empty());
        fs::write(&path, "years of work").unwrap();
        let refused = CsvHistory::create(&path, &scene(), &contact, &[], Earlier::Refuse).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::File);
        assert_eq!(text_of(&path), "years of work");
        assert_eq!(folder.names(), ["history.csv"]);
        // without a place for the scene there is no table of it
        let beside = folder.join("other.csv");
        fs::create_dir(folder.join("other.csv.json")).unwrap();
        let refused = CsvHistory::create(&beside, &scene(), &contact, &[], Earlier::Refuse).unwrap_err();
        assert!(refused.to_string().contains("other.csv.json") && !beside.exists(), "{refused}");
    }
}

/// Writes a run, and beside it the same values as bare numbers, for `tests/read_back.py`.
#[test]
#[ignore = "tests/read_back.sh runs it"]
fn a_run_for_other_readers() {
    use viscocontact::observe::Stress;
    use viscocontact::output::{write_npy, write_stress};

    let folder = PathBuf::from(std::env::var_os("READ_BACK_FOLDER").expect("READ_BACK_FOLDER names a folder"));
    let mut contact = punch();
    let mut archives = series(&folder, Format::Npz, &contact, &Field::ALL);
    let mut images = series(&folder, Format::Vtk, &contact, &Field::ALL);
    let mut history = history(folder.join("history.csv"), &contact, &["twice, force [N]"]);
    let mut frame = 0;
    run(&mut contact, |contact, report| {
        archives.record(contact).unwrap();
        images.record(contact).unwrap();
        history.record(contact, report, &[2.0 * report.force]).unwrap();
        let dump = |name: &str, values: &[f64]| {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            fs::write(folder.join(format!("frame_{frame:06}.{name}.raw")), bytes).unwrap();
        };
        for field in Field::ALL {
            dump(field.name(), &values(contact, field));
        }
        dump("time", &[contact.time()]);
        dump("approach", &[contact.approach()]);
        dump("force", &[contact.force()]);
        dump("tilt", &contact.tilt());
        dump("contact_area", &[contact.contact_area()]);
        let ([n1, n2], grid) = (contact.grid().cells(), contact.grid());
        dump("x1", &(0..n1).map(|i| grid.center(i, 0)[0]).collect::<Vec<_>>());
        dump("x2", &(0..n2).map(|j| grid.center(0, j)[1]).collect::<Vec<_>>());
        write_npy(folder.join(format!("frame_{frame:06}.npy")), grid, &values(contact, Field::Gap)).unwrap();
        fs::write(folder.join("scene.json"), scene().json(contact)).unwrap();
        let depths = [1.0, 1.5, 3.5].map(|sides| sides * contact.grid().spacing()[0].max(contact.grid().spacing()[1]));
        let volume = contact.fields().stress().unwrap().in_volume(&depths).unwrap();
        write_stress(folder.join(format!("frame_{frame:06}.vtr")), Format::Vtk, contact, &volume, &scene()).unwrap();
        dump("depths", &depths);
        let components: Vec<f64> = volume.values.iter().flat_map(Stress::components).collect();
        dump("stress", &components);
        dump("von_mises", &volume.values.iter().map(Stress::von_mises).collect::<Vec<_>>());
        dump("tresca", &volume.values.iter().map(Stress::tresca).collect::<Vec<_>>());
        frame += 1;
    });
    fs::write(
        folder.join("shape.txt"),
        format!("{} {} {frame}\n", contact.grid().cells()[0], contact.grid().cells()[1]),
    )
    .unwrap();
}

/// What the test below runs with room for 32 KiB in a file: rows and frames until one is refused.
#[cfg(unix)]
#[test]
#[ignore = "full_disks_leave_whole_files_and_print_nothing runs it"]
fn a_run_without_room() {
    use viscocontact::output::write_npy;

    let folder = PathBuf::from(std::env::var_os("FULL_FOLDER").expect("FULL_FOLDER names a folder"));
    let mut contact = sphere_on(Grid::square(96, 4.0e-3).unwrap(), maxwell(), Settings::default());
    let mut history = history(folder.join("history.csv"), &contact, &[]);
    let report = contact.step(0.0, Load::force(0.1)).unwrap();
    let rows = (0..1000).take_while(|_| history.record(&contact, &report, &[]).is_ok()).count();
    for _ in 0..20 {
        assert!(matches!(history.record(&contact, &report, &[]), Err(Error::Output(_))));
    }
    drop(history);
    fs::write(folder.join("rows"), rows.to_string()).unwrap();
    // all fields of 73 KB, and none, which is small enough
    let mut archives = series(folder.join("npz"), Format::Npz, &contact, &Field::ALL);
    let mut images = series(folder.join("vtk"), Format::Vtk, &contact, &Field::ALL);
    for _ in 0..2 {
        assert!(matches!(archives.record(&contact), Err(Error::Output(_))));
        assert!(matches!(images.record(&contact), Err(Error::Output(_))));
        let written = write_npy(folder.join("field.npy"), contact.grid(), contact.pressure());
        assert!(matches!(written, Err(Error::Output(_))));
    }
    assert_eq!((archives.frames(), images.frames()), (0, 0));
    let mut few = series(folder.join("few"), Format::Npz, &contact, &[]);
    few.record(&contact).unwrap();
}

/// On a full disk: each row that was reported as written is whole in the file and no other is there at all, no part of a frame
/// is left, and nothing is printed.
#[cfg(unix)]
#[test]
fn full_disks_leave_whole_files_and_print_nothing() {
    let folder = Temporary::folder("full");
    let child = super::with_room_for_32_kib("io::output::a_run_without_room", &folder);
    let told = String::from_utf8_lossy(&child.stderr);
    assert!(child.status.success() && told.is_empty(), "{told}");
    let (text, rows) = (text_of(&folder.join("history.csv")), text_of(&folder.join("rows")).parse::<usize>().unwrap());
    assert!(rows > 50 && text.len() <= 32768, "{rows} rows, {} bytes", text.len());
    let lines: Vec<_> = text.lines().skip(1).collect();
    assert_eq!(lines.len(), rows);
    assert!(text.starts_with("time [s],") && text.ends_with('\n') && lines.iter().all(|line| *line == lines[0]));
    assert_eq!(folder.names(), ["few", "history.csv", "history.csv.json", "npz", "rows", "vtk"]);
    assert_eq!(
        fs::read_dir(folder.join("npz")).unwrap().count() + fs::read_dir(folder.join("vtk")).unwrap().count(),
        0
    );
    assert_eq!(fs::read_dir(folder.join("few")).unwrap().count(), 1);
}
