//! The files of a contact that ranks share out are those that one process writes, byte by byte.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use viscocontact::output::{CsvHistory, Field, Format, FrameSeries, Metadata, write_field_npy};
use viscocontact::parallel::{RanksError, Threads};
use viscocontact::prelude::*;

/// A folder of this name and process, which is not there yet.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("viscocontact-files-of-ranks-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// Takes steps under these loads, and writes all kinds of files after each.
fn write(mut contact: ViscoelasticContact, loads: &[Load], folder: &Path) -> Result<Vec<f64>, Error> {
    fs::create_dir_all(folder).unwrap();
    let metadata = || Metadata::new("Ranks").note("batch", "7");
    let mut npz = FrameSeries::create(folder.join("npz"), Format::Npz, &metadata(), &Field::ALL)?;
    let mut vtk =
        FrameSeries::create_or_replace(folder.join("vtk"), Format::Vtk, &metadata(), &[Field::Gap, Field::Pressure])?;
    let mut csv = CsvHistory::create(folder.join("history.csv"), &metadata(), &contact, &["twice [N]"])?;
    let mut areas = Vec::new();
    for (step, &load) in loads.iter().enumerate() {
        let report = contact.step(if step == 0 { 0.0 } else { 0.3 }, load)?;
        npz.write(&contact)?;
        vtk.write(&contact)?;
        csv.write(&contact, &report, &[2.0 * report.force])?;
        areas.push(contact.contact_area());
    }
    assert_eq!((npz.frames(), vtk.frames()), (loads.len(), loads.len()));
    write_field_npy(folder.join("gap.npy"), &contact, Field::Gap)?;
    Ok(areas)
}

/// All files below a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, fs::read(path).unwrap());
        }
    }
    found
}

fn same_files(name: &str, build: fn() -> Result<Builder, Error>, loads: &[Load]) {
    let root = folder(name);
    let areas = write(build().unwrap().build().unwrap(), loads, &root).unwrap();
    assert!(areas.iter().all(|&area| area > 0.0));
    let expected = files(&root);
    assert_eq!(expected.len(), 2 * loads.len() + 3, "{:?}", expected.keys());
    for size in [1, 2, 3, 4, 5, 9] {
        fs::remove_dir_all(&root).unwrap();
        let written = Threads::run(size, |ranks| write(build()?.ranks(ranks).build()?, loads, &root)).unwrap();
        for of_rank in written {
            assert_eq!(of_rank.unwrap(), areas, "{size} ranks");
        }
        let found = files(&root);
        assert!(found.keys().eq(expected.keys()), "{:?}", found.keys());
        for (file, bytes) in &found {
            assert!(*bytes == expected[file], "{file} of {size} ranks");
        }
    }
    fs::remove_dir_all(&root).unwrap();
}

fn zener() -> Result<Material, Error> {
    Ok(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6)?))
}

fn settings() -> Settings {
    Settings::default().with_window(false)
}

#[test]
fn folded_along_both_axes() {
    let build = || {
        let grid = Grid::square(384, 4.0e-3)?;
        Ok(ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings()))
    };
    same_files("folded", build, &[1.0, 1.2, 0.4].map(Load::force));
}

/// Off the middle along x2, so that the rows are folded and the columns are not; odd columns.
#[test]
fn folded_along_rows() {
    let build = || {
        let grid = Grid::new([384, 201], [4.0e-3, 2.1e-3])?;
        let sphere = Shifted::new(Sphere::new(10.0e-3)?, [0.0, 0.1e-3])?;
        Ok(ViscoelasticContact::builder(grid).geometry(&sphere).material(zener()?).settings(settings()))
    };
    same_files("rows", build, &[0.15, 0.2].map(Load::force));
}

/// Where there is nothing to touch beside the punch, and of more ranks than bands.
#[test]
fn tilting_punch() {
    let build = || {
        let grid = Grid::new([170, 161], [1.2e-3, 1.0e-3])?;
        let (punch, settings) = (FlatPunch::rectangular([0.8e-3, 0.6e-3])?, settings().with_symmetry(false));
        Ok(ViscoelasticContact::builder(grid).geometry(&punch).material(zener()?).settings(settings))
    };
    same_files("punch", build, &[0.1e-3, 0.25e-3].map(|at| Load::eccentric_force(1.0, [at, 0.05e-3])));
}

/// Patches that go on across the ends of the period.
#[test]
fn rough_periodic() {
    let build = || {
        let grid = Grid::new([176, 192], [1.0e-3, 1.0e-3])?;
        let wave = |k1: f64, k2: f64, x: [f64; 2]| (TAU * (k1 * x[0] + k2 * x[1]) / 1.0e-3).cos();
        let surface = FnGeometry::new(move |x1, x2| {
            let x = [x1, x2];
            1.0e-6 * (wave(1.0, 0.0, x) + 0.6 * wave(2.0, 3.0, x) + 0.3 * wave(-5.0, 7.0, x) + 0.2 * wave(11.0, 4.0, x))
        });
        let kernel = Arc::new(InfluenceKernel::periodic(&grid)?);
        Ok(ViscoelasticContact::builder(grid).geometry(&surface).material(zener()?).kernel(kernel).settings(settings()))
    };
    same_files("rough", build, &[4.0e-3, 9.0e-3].map(Load::force));
}

#[test]
fn line() {
    let build = || {
        let grid = Grid::new([25_000, 1], [4.0e-3, 1.0])?;
        let kernel = Arc::new(InfluenceKernel::line(&grid, 1.0)?);
        let builder = ViscoelasticContact::builder(grid).geometry(&Cylinder::new(10.0e-3)?).material(zener()?);
        Ok(builder.kernel(kernel).settings(settings()))
    };
    same_files("line", build, &[100.0, 110.0].map(Load::force));
}

/// What one rank cannot write, none can: the same error on all, nobody waits, and it can be repeated.
#[test]
fn errors_are_those_of_all() {
    let root = folder("errors");
    fs::create_dir_all(&root).unwrap();
    fs::write(root.join("old.csv"), "old").unwrap();
    let metadata = || Metadata::new("Ranks");
    let errors = Threads::run(3, |ranks| {
        let grid = Grid::square(128, 4.0e-3)?;
        let builder = ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?);
        let mut contact = builder.ranks(Arc::clone(&ranks)).build()?;
        let report = contact.step(0.0, Load::force(1.0))?;
        let mut errors = Vec::new();
        errors.push(CsvHistory::create(root.join("old.csv"), &metadata(), &contact, &[]).err());
        let bad = if ranks.rank() == 1 { "a # b" } else { "ab" };
        errors.push(CsvHistory::create(root.join("new.csv"), &metadata(), &contact, &[bad]).err());
        errors.push(write_field_npy(root.join("none/gap.npy"), &contact, Field::Gap).err());
        let mut csv = CsvHistory::create(root.join("new.csv"), &metadata(), &contact, &[])?;
        errors.push(csv.write(&contact, &report, if ranks.rank() == 2 { &[1.0] } else { &[] }).err());
        csv.write(&contact, &report, &[])?;
        let series = root.join("series");
        let mut npz = FrameSeries::create(&series, Format::Npz, &metadata(), &[Field::Pressure])?;
        let mut vtk = FrameSeries::create(&series, Format::Vtk, &metadata(), &[Field::Pressure])?;
        // all have made theirs
        contact.moment();
        if ranks.rank() == 0 {
            fs::remove_dir_all(&series).unwrap();
        }
        contact.moment();
        errors.push(npz.write(&contact).err());
        errors.push(vtk.write(&contact).err());
        if ranks.rank() == 0 {
            fs::create_dir(&series).unwrap();
        }
        contact.moment();
        assert!(
            npz.write(&contact)?.ends_with("frame_000000.npz") && vtk.write(&contact)?.ends_with("frame_000000.vti")
        );
        Ok::<_, Error>(errors)
    });
    let errors: Vec<_> = errors.unwrap().into_iter().map(Result::unwrap).collect();
    for of_rank in &errors {
        assert_eq!(of_rank, &errors[0]);
        let failed = of_rank.iter().map(|error| match error {
            Some(Error::Ranks(RanksError::Failed { rank, message })) => (*rank, message.clone()),
            other => panic!("{other:?}"),
        });
        let failed: Vec<_> = failed.collect();
        assert_eq!(failed.iter().map(|(rank, _)| *rank).collect::<Vec<_>>(), [0, 1, 0, 2, 0, 0]);
        for ((_, message), expected) in failed.iter().zip([
            "exists",
            "column name",
            "No such file",
            "additional columns",
            "No such file",
            "No such file",
        ]) {
            assert!(message.contains(expected), "{message}");
        }
    }
    assert_eq!(fs::read_to_string(root.join("old.csv")).unwrap(), "old");
    assert_eq!(fs::read_to_string(root.join("new.csv")).unwrap().lines().count(), 3);
    fs::remove_dir_all(&root).unwrap();
}
