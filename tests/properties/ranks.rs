//! A contact that ranks share out is the same as in one process that computes the whole grid, bit by bit and whatever their number: its steps, its fields,
//! its files, and the steps after a checkpoint. `RANKS_SCENES` (16) and `RANKS_SEED` (1) choose random scenes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::any_scene::{AnyScene, Course, Stepper};
use std::sync::Arc;

use crate::common::{Draws, Temporary, builder_of, chosen_scenes, from_environment, zener};
use viscocontact::output::{CsvHistory, Earlier, Field, Format, FrameSeries, Metadata};
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
    let (scenes, first) = (from_environment("RANKS_SCENES", 10), 1000 * from_environment("RANKS_SEED", 1));
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

/// What is promised under the settings that users have: a random contact is the same on any number of ranks, and as in one process without a window; with its
/// window it is the same to ten tolerances, and its file is refused where the window is not the whole grid.
#[test]
fn default_settings_keep_the_promises_of_ranks() {
    let (scenes, first) = (from_environment("RANKS_SCENES", 16), from_environment("RANKS_SEED", 1));
    let (mut windows, mut wholes, mut worst) = (0, 0, 0.0_f64);
    let folder = Temporary::folder("ranks-default");
    for seed in 1000 * first..1000 * first + scenes / 3 {
        let draws = &mut Draws::new(seed);
        let cells = [0, 1].map(|_| 2 * (40 + draws.below(32)));
        let side = draws.power_of_ten(-5.0, -3.0);
        let grid = Grid::new(cells, cells.map(|cells| cells as f64 * side)).unwrap();
        let half = 0.5 * side * cells[0].min(cells[1]) as f64;
        let radius = draws.scale(3.0, 30.0) * half;
        // from a contact of a few cells to one of nearly the whole grid
        let reach = if seed % 2 == 0 { draws.between(0.1, 0.4) } else { draws.between(0.75, 0.85) } * half;
        let room = 0.8 * (half - reach);
        let shift = [0, 1].map(|_| if draws.chance(0.5) { 0.0 } else { draws.between(-room, room) });
        let shape = Shifted::new(Sphere::new(radius).unwrap(), shift).unwrap();
        let loads: Vec<f64> = (0..4).map(|_| draws.between(0.9, 1.0) * reach * reach / radius).collect();
        let builder = || builder_of(&shape, grid.clone(), zener());
        let course = |contact: &mut ViscoelasticContact, loads: &[f64]| {
            let steps =
                loads.iter().map(|&depth| contact.step(0.3, Load::approach(depth)).map(|report| format!("{report:?}")));
            let reports: Vec<String> = steps.collect::<Result<_, _>>().unwrap();
            let fields = [contact.pressure(), contact.fields().displacement()]
                .map(|field| contact.fields().gathered(field, 0).unwrap());
            (reports, contact.force().to_bits(), contact.fields().max_pressure().to_bits(), fields)
        };
        let whole = |builder: Builder| builder.settings(Settings::default().with_window(false)).build().unwrap();
        let alone = course(&mut whole(builder()), &loads);
        let (file, by_ranks) = (folder.join("of-one"), folder.join("of-ranks"));
        let mut by_default = builder().build().unwrap();
        course(&mut by_default, &loads[..2]);
        by_default.save(&file).unwrap();
        let on_from_file = course(&mut by_default, &loads[2..]).0;
        let size = 1 + draws.below(3);
        let shared = Threads::run(size, |ranks| {
            let build = || builder().ranks(Arc::clone(&ranks)).build().unwrap();
            let mut contact = build();
            course(&mut contact, &loads[..2]);
            contact.save(&by_ranks).unwrap();
            let mut of_one = build();
            let resumed = of_one.resume(&file).map(|()| course(&mut of_one, &loads[2..]));
            (course(&mut build(), &loads), resumed)
        })
        .unwrap();
        let has_window = shared[0].1.is_err();
        for (rank, (own, resumed)) in shared.iter().enumerate() {
            let what = format!("seed {seed}, rank {rank} of {size}");
            assert_eq!((&own.0, own.1, own.2), (&alone.0, alone.1, alone.2), "{what}");
            assert!(rank > 0 || own.3 == alone.3, "{what}: fields");
            match resumed {
                Err(error) => {
                    assert!(has_window && format!("{error:?}").contains("Settings::window"), "{what}: {error}")
                }
                Ok(rest) => assert!(!has_window && rest.0 == on_from_file, "{what}: its file"),
            }
        }
        let mut of_ranks = builder().build().unwrap();
        of_ranks.resume(&by_ranks).unwrap();
        assert_eq!(course(&mut of_ranks, &loads[2..]).0, alone.0[2..], "seed {seed}: the file of ranks");
        let force = f64::from_bits(alone.1);
        worst = worst.max((by_default.force() / force - 1.0).abs());
        *if has_window { &mut windows } else { &mut wholes } += 1;
    }
    println!("{windows} with a window, {wholes} without; the force differs by {worst:.1e} at most");
    assert!(
        windows > 1 && wholes > 1 && worst < 10.0 * Settings::default().tolerance(),
        "{windows} {wholes} {worst:e}"
    );
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
    use chosen_scenes::{adaptive, punch, rough};

    const SIZES: [Option<usize>; 5] = [None, Some(1), Some(2), Some(3), Some(5)];
    let root = Temporary::folder("same-checkpoints");
    let path = root.join("run.checkpoint");
    for (scene, after) in [(adaptive(), 5), (rough(), 3), (punch(), 2)] {
        let mut expected = scene.course(None).unwrap();
        expected.reports.drain(..after);
        assert!(expected.error.is_none() && expected.reports.len() > 1, "{:?}", expected.error);
        for (place, &saved_by) in SIZES.iter().enumerate() {
            on(saved_by, &scene, |mut contact| save_after(after, &scene, &mut contact, &path));
            for ahead in [0, 2] {
                assert_continues(SIZES[(place + ahead) % SIZES.len()], &scene, after, &path, &expected);
            }
        }
    }
    // each save has replaced all files of the one before
    assert!(root.names().len() <= 6, "{:?}", root.names());
}
