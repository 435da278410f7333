//! Checkpoints of contacts that ranks share out: on any other number of ranks the run goes on as if nothing had happened.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::common::watched_ranks::WatchedRanks;
use approx::assert_abs_diff_eq;
use viscocontact::contact::CheckpointError;
use viscocontact::parallel::{RanksError, Threads};
use viscocontact::prelude::*;

/// An empty folder of this name and process.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("viscocontact-ranks-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Takes the steps of a scene that follow the first `from`, to the end, or to the step after which it is saved to a file.
type Drive = fn(&mut ViscoelasticContact, usize, Option<(usize, &Path)>) -> Result<Vec<StepReport>, Error>;

/// What is compared: reports as they print, to the last bit, and fields of the whole grid on rank 0.
#[derive(Debug, PartialEq, Clone)]
struct Course {
    reports: Vec<String>,
    fields: [Vec<u64>; 3],
}

fn course(contact: &ViscoelasticContact, reports: &[StepReport]) -> Result<Course, Error> {
    let mut gap = vec![0.0; contact.pressure().len()];
    contact.gap_into(&mut gap)?;
    let mut fields = [const { Vec::new() }; 3];
    for (out, field) in fields.iter_mut().zip([contact.pressure(), contact.displacement(), &gap]) {
        let whole = contact.gathered(field, 0)?.unwrap_or_default();
        *out = whole.into_iter().map(f64::to_bits).collect();
    }
    Ok(Course { reports: reports.iter().map(|report| format!("{report:?}")).collect(), fields })
}

/// One process by itself, or a number of ranks, which all run `job`; what they return, in their order.
fn on<T: Send>(
    size: Option<usize>,
    build: fn() -> Result<Builder, Error>,
    job: impl Fn(ViscoelasticContact) -> Result<T, Error> + Sync,
) -> Vec<Result<T, Error>> {
    match size {
        None => vec![build().and_then(Builder::build).and_then(job)],
        Some(size) => Threads::run(size, |ranks| job(build()?.ranks(ranks).build()?)).unwrap(),
    }
}

const SIZES: [Option<usize>; 5] = [None, Some(1), Some(2), Some(3), Some(5)];

/// Saved after `after` steps by each number of ranks, resumed by each.
fn goes_on_everywhere(name: &str, build: fn() -> Result<Builder, Error>, drive: Drive, after: usize) {
    let folder = folder(name);
    let mut whole = build().unwrap().build().unwrap();
    let reports = drive(&mut whole, 0, None).unwrap();
    assert!(reports.len() > after + 1, "{} steps", reports.len());
    let expected = course(&whole, &reports[after..]).unwrap();
    assert!(expected.fields.iter().all(|field| field.iter().any(|&bits| bits != 0)));
    for (place, saved_by) in SIZES.into_iter().enumerate() {
        let path = folder.join("run.checkpoint");
        on(saved_by, build, |mut contact| drive(&mut contact, 0, Some((after, &path)))).into_iter().for_each(|done| {
            assert_eq!(done.unwrap().len(), after);
        });
        // by as many, and by others
        for resumed_by in [0, 1, 3].map(|ahead| SIZES[(place + ahead) % SIZES.len()]) {
            let courses = on(resumed_by, build, |mut contact| {
                contact.resume(&path)?;
                let reports = drive(&mut contact, after, None)?;
                course(&contact, &reports)
            });
            for (rank, found) in courses.into_iter().enumerate() {
                let found = found.unwrap();
                assert_eq!(found.reports, expected.reports, "{saved_by:?} to {resumed_by:?}, rank {rank}");
                if rank == 0 {
                    assert!(found.fields == expected.fields, "{saved_by:?} to {resumed_by:?}");
                }
            }
        }
    }
    // each save has replaced the one before
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    fs::remove_dir_all(folder).unwrap();
}

fn settings() -> Settings {
    Settings::default().with_window(false)
}

fn zener() -> Result<Material, Error> {
    Ok(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6)?))
}

/// Steps of given length, each to its load.
fn given(
    contact: &mut ViscoelasticContact,
    loads: &[(f64, Load)],
    from: usize,
    stop: Option<(usize, &Path)>,
) -> Result<Vec<StepReport>, Error> {
    let end = stop.map_or(loads.len(), |(after, _)| after);
    let reports = loads[from..end].iter().map(|&(dt, load)| contact.step(dt, load)).collect::<Result<_, _>>()?;
    if let Some((_, path)) = stop {
        contact.save(path)?;
    }
    Ok(reports)
}

/// In the middle of a run of steps chosen by their error: a past of two relaxation times with both differences, the control of
/// the length. Ranks begin within a block of the past, and of five one has no rows.
#[test]
fn adaptive_loading_and_unloading() {
    let build = || {
        let grid = Grid::new([384, 340], [4.0e-3, 3.6e-3])?;
        let body = Material::incompressible(GeneralizedMaxwell::new(1.0e6, &[(1.0e6, 0.3), (0.5e6, 2.0)])?);
        Ok(ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(body).settings(settings()))
    };
    let drive: Drive = |contact, _, stop| {
        let table = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.3)].map(|(time, force)| (time, Load::force(force)));
        let history = PiecewiseLinear::new(&table)?;
        let mut run = contact.follow(&history, Stepping::adaptive(3.0e-3), 2.0);
        let mut reports = Vec::new();
        while let Some(report) = run.next_step()? {
            reports.push(report);
            if let Some((after, path)) = stop
                && reports.len() == after
            {
                run.save(path)?;
                break;
            }
        }
        Ok(reports)
    };
    goes_on_everywhere("adaptive", build, drive, 5);
}

/// A few waves of different lengths and directions, periodic on the grid.
fn waves(x1: f64, x2: f64) -> f64 {
    let wave = |k1: f64, k2: f64, phase: f64| (TAU * (k1 * x1 + k2 * x2) / 1.0e-3 + phase).cos();
    1.0e-6 * (wave(1.0, 0.0, 0.3) + 0.6 * wave(2.0, 3.0, 1.1) + 0.3 * wave(-5.0, 7.0, 2.0) + 0.2 * wave(11.0, 4.0, 0.7))
}

#[test]
fn rough_periodic() {
    let build = || {
        let grid = Grid::new([176, 192], [1.0e-3, 1.0e-3])?;
        let kernel = Arc::new(InfluenceKernel::periodic(&grid)?);
        let surface = FnGeometry::new(waves);
        Ok(ViscoelasticContact::builder(grid).geometry(&surface).material(zener()?).kernel(kernel).settings(settings()))
    };
    let drive: Drive = |contact, from, stop| {
        let loads = [0.0, 0.4, 0.3, 0.4, 0.2].map(|dt| (dt, Load::force(2.0e-3 + 2.0e-3 * dt)));
        given(contact, &loads, from, stop)
    };
    goes_on_everywhere("rough", build, drive, 3);
}

/// A grid of four bands: of five ranks one has no rows.
#[test]
fn tilting_punch() {
    let build = || {
        let grid = Grid::new([170, 160], [1.2e-3, 1.0e-3])?;
        let (punch, settings) = (FlatPunch::rectangular([0.8e-3, 0.6e-3])?, settings().with_symmetry(false));
        Ok(ViscoelasticContact::builder(grid).geometry(&punch).material(zener()?).settings(settings))
    };
    let drive: Drive = |contact, from, stop| {
        let load = |at: f64| Load::eccentric_force(1.0, [at, 0.05e-3]);
        let loads = [(0.0, load(0.1e-3)), (0.2, load(0.13e-3)), (0.2, load(0.16e-3)), (0.2, load(0.25e-3))];
        given(contact, &loads, from, stop)
    };
    goes_on_everywhere("punch", build, drive, 2);
}

/// More ranks than bands, and one process that has given up a symmetry before it saved: ranks go on without it.
#[test]
fn broken_symmetry() {
    let build = || {
        let grid = Grid::square(128, 1.2e-3)?;
        let punch = FlatPunch::rectangular([0.8e-3, 0.6e-3])?;
        Ok(ViscoelasticContact::builder(grid).geometry(&punch).material(zener()?).settings(settings()))
    };
    let loads = [
        (0.0, Load::force(1.0)),
        (0.2, Load::eccentric_force(1.0, [0.1e-3, 0.0])),
        (0.2, Load::eccentric_force(1.0, [0.12e-3, 0.0])),
        (0.2, Load::eccentric_force(1.0, [0.05e-3, 0.0])),
    ];
    let folder = folder("broken");
    let path = folder.join("run.checkpoint");
    let mut whole = build().unwrap().build().unwrap();
    given(&mut whole, &loads, 0, Some((2, &path))).unwrap();
    let reports = given(&mut whole, &loads, 2, None).unwrap();
    let expected = course(&whole, &reports).unwrap();
    let courses = on(Some(3), build, |mut contact| {
        contact.resume(&path)?;
        let reports = given(&mut contact, &loads, 2, None)?;
        course(&contact, &reports)
    });
    let courses: Vec<_> = courses.into_iter().map(Result::unwrap).collect();
    assert!(courses[0] == expected);
    assert!(courses.iter().all(|course| course.reports == expected.reports));
    fs::remove_dir_all(folder).unwrap();
}

fn sphere() -> Result<Builder, Error> {
    let grid = Grid::square(128, 4.0e-3)?;
    let settings = Settings::default().with_symmetry(false).with_window(false);
    Ok(ViscoelasticContact::builder(grid).geometry(&Sphere::new(10.0e-3)?).material(zener()?).settings(settings))
}

/// The error of each of the ranks, which is the same, and leaves the contacts as they were.
fn refused(size: Option<usize>, path: &Path) -> Error {
    let errors = on(size, sphere, |mut contact| {
        let before = contact.step(0.0, Load::force(0.5))?;
        let error = contact.resume(path).unwrap_err();
        assert_eq!((contact.time(), contact.force()), (before.time, before.force));
        contact.step(0.1, Load::force(0.5))?;
        Ok(error)
    });
    let errors: Vec<_> = errors.into_iter().map(Result::unwrap).collect();
    assert!(errors.iter().all(|error| *error == errors[0]), "{errors:?}");
    errors.into_iter().next().unwrap()
}

fn save(size: Option<usize>, path: &Path, force: f64) {
    let saved = on(size, sphere, |mut contact| {
        contact.step(0.0, Load::force(force))?;
        contact.save(path)
    });
    saved.into_iter().for_each(Result::unwrap);
}

/// Whoever wrote the file and whoever reads it: all ranks see the same cause.
#[test]
fn files_that_are_not_whole_are_refused_by_all_ranks_alike() {
    let folder = folder("torn");
    let (path, other) = (folder.join("run.checkpoint"), folder.join("other"));
    for saved_by in [None, Some(2)] {
        save(saved_by, &path, 1.0);
        let sound = fs::read(&path).unwrap();
        let damaged = |at: usize| [&sound[..at], &[sound[at] ^ 4], &sound[at + 1..]].concat();
        for size in [None, Some(2), Some(3)] {
            let cause = |bytes: &[u8]| {
                fs::write(&other, bytes).unwrap();
                match refused(size, &other) {
                    Error::Checkpoint { source, .. } => source,
                    other => panic!("unexpected {other:?}"),
                }
            };
            // cut short, longer, foreign
            for length in [10, 30, sound.len() / 2, sound.len() - 9] {
                assert!(matches!(cause(&sound[..length]), CheckpointError::Size { .. }));
            }
            assert!(matches!(cause(&[&sound[..], &[0; 8]].concat()), CheckpointError::Size { .. }));
            assert_eq!(cause(b"something else"), CheckpointError::Foreign);
            // damaged in the part of any rank
            for at in [21, 40, sound.len() / 4, sound.len() / 2, 3 * sound.len() / 4, sound.len() - 1] {
                assert!(matches!(cause(&damaged(at)), CheckpointError::Damaged { .. }), "{at}");
            }
            // a value of one rank that no contact has, and a right checksum
            let mut forged = sound.clone();
            let last = forged.len() - 8;
            forged[last..].copy_from_slice(&(-1.0_f64).to_le_bytes());
            let checksum = super::crc(forged[..20].iter().chain(&forged[24..]).copied());
            forged[20..24].copy_from_slice(&checksum.to_le_bytes());
            fs::write(&other, &forged).unwrap();
            let error = refused(size, &other);
            let message = match &error {
                Error::Checkpoint { source, .. } => source.to_string(),
                Error::Ranks(RanksError::Failed { message, .. }) => message.clone(),
                other => panic!("unexpected {other:?}"),
            };
            assert!(message.contains("negative"), "{error:?}");
            let error = refused(size, &folder.join("nowhere"));
            assert_eq!(error.io_kind(), Some(std::io::ErrorKind::NotFound), "{error:?}");
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_ranks_cannot_go_on_from_is_refused_by_name() {
    let folder = folder("other");
    let path = folder.join("run.checkpoint");
    let what = |error: Error| match error {
        Error::Checkpoint { source: CheckpointError::OtherScene { what, .. }, .. } => what,
        other => panic!("unexpected {other:?}"),
    };
    // another scene, from files of ranks
    let cone = || Ok(sphere()?.geometry(&Cone::new(0.1)?));
    for done in on(Some(2), cone, |contact| contact.save(&path)) {
        done.unwrap();
    }
    for size in [None, Some(1), Some(3)] {
        assert_eq!(what(refused(size, &path)), "geometry");
    }
    // a window of the grid
    let windowed = || Ok(sphere()?.settings(Settings::default()));
    let mut contact = windowed().unwrap().build().unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.save(&path).unwrap();
    for error in on(Some(2), windowed, |mut contact| Ok(contact.resume(&path).unwrap_err())) {
        assert_eq!(what(error.unwrap()), "computed region");
    }
    // an indenter that has moved
    let mut contact = sphere().unwrap().build().unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.set_geometry(&Shifted::new(Sphere::new(10.0e-3).unwrap(), [1.0e-4, 0.0]).unwrap()).unwrap();
    contact.save(&path).unwrap();
    assert_eq!(what(refused(Some(2), &path)), "indenter");
    sphere().unwrap().build().unwrap().resume(&path).unwrap();
    fs::remove_dir_all(folder).unwrap();
}

/// A path that cannot be written is refused on all ranks alike; the old file stays, and nothing else is left.
#[test]
fn failed_saves_leave_the_old_one() {
    let folder = folder("failed");
    let path = folder.join("run.checkpoint");
    fs::create_dir(&path).unwrap();
    let errors = on(Some(3), sphere, |contact| Ok(contact.save(&path).unwrap_err()));
    for error in errors {
        assert!(
            matches!(error.unwrap(), Error::Ranks(RanksError::Failed { rank: 0, message }) if message.contains("folder"))
        );
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    let errors = on(Some(3), sphere, |contact| Ok(contact.save(folder.join("none/run")).unwrap_err()));
    errors.into_iter().for_each(|error| assert!(matches!(error.unwrap(), Error::Ranks(RanksError::Failed { .. }))));
    fs::remove_dir_all(folder).unwrap();
}

/// Whenever a rank is lost in the middle of a save, the file leads to the save before or to this one, whole.
#[test]
fn a_rank_that_is_lost_during_a_save_spoils_nothing() {
    let folder = folder("lost");
    let path = folder.join("run.checkpoint");
    save(Some(3), &path, 1.0);
    let force_saved = || {
        let mut contact = sphere().unwrap().build().unwrap();
        contact.resume(&path).unwrap();
        contact.force()
    };
    let (mut cut_off, mut done) = (0, false);
    for at in 0.. {
        for lost in 0..3 {
            let saved = Threads::run(3, |ranks| {
                let rank = ranks.rank();
                // a rank leaves when no more calls are left to it
                let calls_left = Arc::new(AtomicUsize::new(usize::MAX));
                let left = Arc::clone(&calls_left);
                let leaving = WatchedRanks::around(ranks, move |_| {
                    let next = |left: usize| left.checked_sub(1);
                    let calls = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, next);
                    calls.map(|_| ()).map_err(|_| RanksError::Left { rank })
                });
                let mut contact = sphere().unwrap().ranks(leaving).build().unwrap();
                contact.step(0.0, Load::force(1.5)).unwrap();
                if rank == lost {
                    calls_left.store(at, Ordering::Relaxed);
                }
                contact.save(&path)
            })
            .unwrap();
            done = saved[lost].is_ok();
            cut_off += usize::from(!done);
            let force = force_saved();
            assert!(saved.iter().any(Result::is_ok) == done || force == 1.5, "{at} {lost} {saved:?}");
            assert!((force - 1.0).abs() < 1e-12 || (force - 1.5).abs() < 1e-12, "{force}");
            assert!(!done || (force - 1.5).abs() < 1e-12);
            save(Some(3), &path, 1.0);
            assert_abs_diff_eq!(force_saved(), 1.0, epsilon = 1e-12);
        }
        if done {
            break;
        }
    }
    assert!(cut_off > 9, "{cut_off}");
    // nothing is left of the saves that were cut off
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    fs::remove_dir_all(folder).unwrap();
}

/// Saved on its way by ranks whose clocks differ.
#[test]
fn runs_are_saved_on_their_way() {
    let folder = folder("autosave");
    let path = folder.join("run.checkpoint");
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let run = |contact: &mut ViscoelasticContact, until: f64, steps: usize| {
        let every = Duration::from_secs(if contact.rows().start == 0 { 3600 } else { 0 });
        let mut run = contact.follow(&load, Stepping::fixed(0.1), until).autosave_to(&path, every);
        let mut reports = Vec::new();
        while reports.len() < steps {
            let Some(report) = run.next_step()? else { break };
            reports.push(format!("{report:?}"));
        }
        Ok(reports)
    };
    let mut alone = sphere().unwrap().build().unwrap();
    let expected = run(&mut alone, 0.5, 99).unwrap();
    on(Some(2), sphere, |mut contact| run(&mut contact, 0.5, 3)).into_iter().for_each(|done| _ = done.unwrap());
    for reports in on(Some(3), sphere, |mut contact| {
        contact.resume(&path)?;
        run(&mut contact, 0.5, 99)
    }) {
        assert_eq!(reports.unwrap(), expected[3..]);
    }
    fs::remove_dir_all(folder).unwrap();
}
