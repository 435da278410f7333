//! A contact that ranks share out is the same as in one process, bit by bit and whatever their number: its steps, its fields,
//! its files, and the steps after a checkpoint. `RANKS_SCENES` (16) and `RANKS_SEED` (1) choose random scenes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::any_scene::{AnyScene, Course, Stepper};
use crate::common::{Temporary, chosen_scenes, from_environment};
use viscocontact::output::{CsvHistory, Earlier, Field, Format, FrameSeries, Metadata, write_field_npy};
use viscocontact::parallel::Threads;
use viscocontact::prelude::*;

fn assert_same_on(size: usize, scene: &AnyScene, alone: &Course) {
    let courses = Threads::run(size, |ranks| scene.course(Some(ranks))).unwrap();
    for (rank, course) in courses.into_iter().enumerate() {
        let what = format!("{}, rank {rank} of {size}", scene.name);
        assert_same(&course.unwrap_or_else(|error| panic!("{what}: {error}")), alone, rank, &what);
    }
}

/// Fields are on rank 0 alone.
fn assert_same(course: &Course, alone: &Course, rank: usize, what: &str) {
    let pairs = course.reports.iter().zip(&alone.reports);
    assert_eq!(pairs.enumerate().find(|(_, (own, alone))| own != alone), None, "{what}");
    assert_eq!((course.reports.len(), &course.error), (alone.reports.len(), &alone.error), "{what}");
    assert_eq!(course.numbers, alone.numbers, "{what}");
    assert!(rank > 0 || course.fields == alone.fields, "{what}: fields differ");
}

/// On fewer and on more ranks than there are bands of rows, two numbers of ranks for each scene in turn; on three, each rank evaluates the shape on the whole grid. The greatest
/// slope is found over all rows, the rows at the ends of ranks included, whatever is folded; so is flatness.
#[test]
fn chosen_scenes_are_the_same_on_all_ranks() {
    let sloped = chosen_scenes::sloped().map(|(scene, warning)| (scene, Some(warning)));
    let scenes = chosen_scenes::all().into_iter().map(|scene| (scene, None)).chain(sloped);
    for (number, (mut scene, warning)) in scenes.enumerate() {
        let alone = scene.course(None).unwrap();
        assert!(alone.error.is_none() && alone.reports.len() > 1, "{}: {:?}", scene.name, alone.error);
        assert!(alone.fields.iter().all(|field| field.iter().any(|&bits| bits != 0)), "{}", scene.name);
        let warned = |report: &String| warning.is_none_or(|warning| report.contains(warning));
        assert!(alone.reports.iter().all(warned), "{}: {:?}", scene.name, alone.reports);
        for size in [[2, 3], [3, 8], [8, 2]][number % 3] {
            scene.on_own_rows = size != 3;
            assert_same_on(size, &scene, &alone);
        }
    }
}

#[test]
fn random_scenes_are_the_same_on_all_ranks() {
    let (scenes, first) = (from_environment("RANKS_SCENES", 16), 1000 * from_environment("RANKS_SEED", 1));
    let (mut pressed, mut steps, mut failed) = (0, 0, 0);
    for seed in first..first + scenes {
        let scene = AnyScene::new(seed);
        let alone = scene.course(None).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        assert_same_on(scene.size, &scene, &alone);
        pressed += usize::from(alone.reports.iter().any(|report| !report.contains("contact_cells: 0,")));
        (steps, failed) = (steps + alone.reports.len(), failed + usize::from(alone.error.is_some()));
    }
    println!("{scenes} scenes, {steps} steps, {pressed} scenes with contact, {failed} end with the same error");
    assert!(2 * pressed > scenes as usize && 3 * failed < scenes as usize, "{pressed} pressed, {failed} failed");
}

/// Snapshots go back on all ranks alike.
#[test]
fn restored_snapshots_are_the_same_on_all_ranks() {
    let scene = chosen_scenes::folded();
    let detour = |mut contact: ViscoelasticContact| {
        contact.step(0.0, Load::force(1.0)).unwrap();
        let snapshot = contact.snapshot();
        contact.step(0.3, Load::force(2.0)).unwrap();
        contact.restore(&snapshot).unwrap();
        scene.course_from(&mut contact, 1).unwrap()
    };
    let alone = detour(scene.contact(None).unwrap());
    for (rank, course) in
        Threads::run(3, |ranks| detour(scene.contact(Some(&ranks)).unwrap())).unwrap().iter().enumerate()
    {
        assert_same(course, &alone, rank, "after a detour");
    }
}

/// Takes the first steps of a scene, and writes all kinds of files after each. Returns the contact areas.
fn write(scene: &AnyScene, mut contact: ViscoelasticContact, folder: &Path) -> Result<Vec<f64>, Error> {
    fs::create_dir_all(folder).unwrap();
    let metadata = || Metadata::new("Ranks").note("batch", "7");
    let mut npz =
        FrameSeries::create(folder.join("npz"), Format::Npz, &metadata(), &contact, &Field::ALL, Earlier::Refuse)?;
    let mut vtk = FrameSeries::create(
        folder.join("vtk"),
        Format::Vtk,
        &metadata(),
        &contact,
        &[Field::Gap, Field::Pressure],
        Earlier::Replace,
    )?;
    let mut csv =
        CsvHistory::create(folder.join("history.csv"), &metadata(), &contact, &["twice [N]"], Earlier::Refuse)?;
    let mut areas = Vec::new();
    let (_, error) = scene.drive(&mut contact, 0, &mut |stepper, report| {
        let contact = stepper.contact();
        npz.record(contact)?;
        vtk.record(contact)?;
        csv.record(contact, &report, &[2.0 * report.force])?;
        areas.push(contact.contact_area());
        Ok(areas.len() < 2)
    });
    write_field_npy(folder.join("gap.npy"), &contact, Field::Gap)?;
    error.map_or(Ok(areas), Err)
}

/// All files below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| if path.is_dir() { files(&path) } else { [(path.clone(), fs::read(path).unwrap())].into() })
        .collect()
}

#[test]
fn files_of_ranks_are_those_of_one_process() {
    use chosen_scenes::{beside, folded, line, punch, rough};

    let root = Temporary::file("same-files");
    for scene in [folded(), beside(1), punch(), rough(), line()] {
        let areas = write(&scene, scene.contact(None).unwrap(), &root).unwrap();
        assert!(areas.len() == 2 && areas.iter().all(|&area| area > 0.0), "{}", scene.name);
        let expected = files(&root);
        assert_eq!(expected.len(), 7, "{:?}", expected.keys());
        for size in [1, 3, 9] {
            fs::remove_dir_all(&root).unwrap();
            let written = Threads::run(size, |ranks| write(&scene, scene.contact(Some(&ranks))?, &root)).unwrap();
            written.into_iter().for_each(|of_rank| assert_eq!(of_rank.unwrap(), areas, "{}, {size} ranks", scene.name));
            let found = files(&root);
            assert!(found.keys().eq(expected.keys()), "{:?}", found.keys());
            for (file, bytes) in &found {
                assert!(*bytes == expected[file], "{}: {} of {size} ranks", scene.name, file.display());
            }
        }
        fs::remove_dir_all(&root).unwrap();
    }
}

/// One process by itself, or a number of ranks, which all run `job`; what they return, in their order.
fn on<T: Send>(
    size: Option<usize>,
    scene: &AnyScene,
    job: impl Fn(ViscoelasticContact) -> Result<T, Error> + Sync,
) -> Vec<T> {
    let results = match size {
        None => vec![scene.contact(None).and_then(&job)],
        Some(size) => Threads::run(size, |ranks| job(scene.contact(Some(&ranks))?)).unwrap(),
    };
    results.into_iter().map(Result::unwrap).collect()
}

/// Takes the first steps of a scene, and saves it.
fn save_after(steps: usize, scene: &AnyScene, contact: &mut ViscoelasticContact, path: &Path) -> Result<(), Error> {
    let mut taken = 0;
    let (_, error) = scene.drive(contact, 0, &mut |stepper, _| {
        taken += 1;
        if taken == steps {
            match stepper {
                Stepper::Contact(contact) => contact.save(path)?,
                Stepper::Run(run) => run.save(path)?,
            }
        }
        Ok(taken < steps)
    });
    error.map_or(Ok(()), Err)
}

/// Resumed by `size` ranks, the scene takes the steps that one process would have taken.
fn assert_continues(size: Option<usize>, scene: &AnyScene, after: usize, path: &Path, expected: &Course) {
    let courses = on(size, scene, |mut contact| {
        contact.resume(path)?;
        scene.course_from(&mut contact, after)
    });
    for (rank, course) in courses.iter().enumerate() {
        assert_same(course, expected, rank, &format!("{} resumed by {size:?}, rank {rank}", scene.name));
    }
}

/// Saved in the middle by each number of ranks, resumed by each.
#[test]
fn checkpoints_of_ranks_continue_on_any_other_number() {
    use chosen_scenes::{adaptive, punch, punch_that_loses_symmetry, rough};

    const SIZES: [Option<usize>; 5] = [None, Some(1), Some(2), Some(3), Some(5)];
    let root = Temporary::folder("same-checkpoints");
    let path = root.join("run.checkpoint");
    for (scene, after) in [(adaptive(), 5), (rough(), 3), (punch(), 2), (punch_that_loses_symmetry(), 2)] {
        let mut expected = scene.course(None).unwrap();
        expected.reports.drain(..after);
        assert!(expected.error.is_none() && expected.reports.len() > 1, "{:?}", expected.error);
        // ranks do not take the step that gives up a symmetry; they continue after it
        let sizes = if scene.name == "punch that loses symmetry" { &SIZES[..1] } else { &SIZES };
        for (place, &saved_by) in sizes.iter().enumerate() {
            on(saved_by, &scene, |mut contact| save_after(after, &scene, &mut contact, &path));
            for ahead in [0, 2] {
                assert_continues(SIZES[(place + ahead) % SIZES.len()], &scene, after, &path, &expected);
            }
        }
    }
    // each save has replaced all files of the one before
    assert!(root.names().len() <= 6, "{:?}", root.names());
}
