//! Checkpoints of contacts that ranks share out: which files are refused, and which file remains when a rank is lost. That the
//! steps after a checkpoint are the same on any number of ranks is in `properties::ranks`.

use std::fs;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use crate::common::sealed::seal;
use crate::common::watched_ranks::with_calls_left;
use crate::common::{Temporary, builder_on, zener};
use approx::assert_abs_diff_eq;
use viscocontact::load::Tilt;
use viscocontact::parallel::{RanksError, Threads};
use viscocontact::prelude::*;

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

fn sphere() -> Result<Builder, Error> {
    let settings = Settings::default().with_symmetry(false).with_window(false);
    Ok(builder_on(Grid::square(128, 4.0e-3)?, zener()).settings(settings))
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
    let folder = Temporary::folder("ranks-torn");
    let (path, other) = (folder.join("run.checkpoint"), folder.join("other"));
    for saved_by in [None, Some(2)] {
        save(saved_by, &path, 1.0);
        let sound = fs::read(&path).unwrap();
        let damaged = |at: usize| [&sound[..at], &[sound[at] ^ 4], &sound[at + 1..]].concat();
        for size in [None, Some(2), Some(3)] {
            let cause = |bytes: &[u8]| {
                fs::write(&other, bytes).unwrap();
                refused(size, &other).code()
            };
            // cut short, longer, foreign
            for length in [10, 30, sound.len() / 2, sound.len() - 9] {
                assert_eq!(cause(&sound[..length]), "checkpoint_damaged");
            }
            assert_eq!(cause(&[&sound[..], &[0; 8]].concat()), "checkpoint_damaged");
            assert_eq!(cause(b"something else"), "checkpoint_foreign");
            // damaged in the part of any rank, or in a number of values
            for at in [21, 40, sound.len() / 4, sound.len() / 2, 3 * sound.len() / 4, sound.len() - 1] {
                assert_eq!(cause(&damaged(at)), "checkpoint_damaged", "{at}");
            }
            // a value of one rank that no contact has, and a right checksum
            let mut forged = sound.clone();
            let last = forged.len() - 8;
            forged[last..].copy_from_slice(&f64::NAN.to_le_bytes());
            seal(&mut forged);
            fs::write(&other, &forged).unwrap();
            let error = refused(size, &other);
            let message = match &error {
                Error::Checkpoint { cause, .. } => cause.to_string(),
                Error::Ranks(RanksError::Failed { message, .. }) => message.clone(),
                other => panic!("unexpected {other:?}"),
            };
            assert!(message.contains("negative"), "{error:?}");
            let error = refused(size, &folder.join("nowhere"));
            assert_eq!(error.io_kind(), Some(std::io::ErrorKind::NotFound), "{error:?}");
        }
    }
}

#[test]
fn checkpoints_that_ranks_cannot_resume_are_refused_by_name() {
    let folder = Temporary::folder("ranks-other");
    let path = folder.join("run.checkpoint");
    let what = |error: Error| {
        assert_eq!(error.code(), "checkpoint_other_scene", "{error:?}");
        error.name().unwrap().to_owned()
    };
    // another scene, from files of ranks
    let cone = || Ok(sphere()?.geometry(&Cone::new(0.1)?));
    for done in on(Some(2), cone, |contact| contact.save(&path)) {
        done.unwrap();
    }
    for size in [None, Some(1), Some(3)] {
        assert_eq!(what(refused(size, &path)), "geometry");
    }
    // a window of the grid, and a symmetry that a load has broken
    let tilted = Load::Approach { approach: 1.0e-5, tilt: [Tilt::Fixed(1.0e-3), Tilt::Fixed(0.0)] };
    let windowed: fn() -> Result<Builder, Error> = || Ok(sphere()?.settings(Settings::default()));
    let symmetric: fn() -> Result<Builder, Error> = || Ok(sphere()?.settings(Settings::default().with_window(false)));
    for (builder, load) in [(windowed, Load::force(0.1)), (symmetric, tilted)] {
        let mut contact = builder().unwrap().build().unwrap();
        contact.step(0.0, load).unwrap();
        contact.save(&path).unwrap();
        for error in on(Some(2), builder, |mut contact| Ok(contact.resume(&path).unwrap_err())) {
            assert!(what(error.unwrap()).starts_with("computed region"));
        }
    }
    // an indenter that has moved
    let mut contact = sphere().unwrap().build().unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.set_geometries(&[&Shifted::new(Sphere::new(10.0e-3).unwrap(), [1.0e-4, 0.0]).unwrap()]).unwrap();
    contact.save(&path).unwrap();
    assert!(what(refused(Some(2), &path)).starts_with("computed region"));
    sphere().unwrap().build().unwrap().resume(&path).unwrap();
}

/// A path that cannot be written is refused on all ranks alike; the old file stays, and nothing else is left.
#[test]
fn failed_saves_leave_the_old_one() {
    let folder = Temporary::folder("ranks-failed");
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
}

/// Whenever a rank is lost in the middle of a save, the file leads to the save before or to this one, whole.
#[test]
fn a_rank_that_is_lost_during_a_save_spoils_nothing() {
    let folder = Temporary::folder("ranks-lost");
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
                let (leaving, calls_left) = with_calls_left(ranks, rank);
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
}

/// Saved on its way by ranks whose clocks differ.
#[test]
fn runs_are_saved_on_their_way() {
    let folder = Temporary::folder("ranks-autosave");
    let path = folder.join("run.checkpoint");
    let load = StepLoad::new(Load::force(1.0)).unwrap();
    let run = |contact: &mut ViscoelasticContact, until: f64, steps: usize| {
        let every = Duration::from_secs(if contact.fields().rows().start == 0 { 3600 } else { 0 });
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
}
