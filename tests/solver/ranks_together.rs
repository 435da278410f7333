//! Ranks stay together: what travels between them, ranks without rows, and ranks that fail or leave.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::refused::{not_covered, refused};
use crate::common::watched_ranks::{Call, WatchedRanks, with_calls_left};
use crate::common::{builder_on, elastic, zener};
use viscocontact::ErrorKind;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::parallel::{Ranks, RanksError, Threads};
use viscocontact::prelude::*;

fn sphere(cells: usize, ranks: Arc<dyn Ranks>) -> Result<ViscoelasticContact, Error> {
    let settings = Settings::default().with_symmetry(false);
    builder_on(Grid::square(cells, 4.0e-3)?, zener()).settings(settings).ranks(ranks).build()
}

/// Fails, and does not hang, if ranks wait for each other for ever.
fn within_a_minute<T: Send + 'static>(job: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = channel();
    std::thread::spawn(move || sender.send(catch_unwind(AssertUnwindSafe(job))));
    match receiver.recv_timeout(Duration::from_secs(60)).expect("ranks wait for each other") {
        Ok(done) => done,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// Two exchanges a convolution: tiles of 8 × 8 complex numbers, of rows that are not zero and half of the waves, which are
/// 32 (1 − 1/R) bytes a cell.
#[test]
fn bytes_on_the_wire_are_those_of_the_formula() {
    let (cells, size) = (256, 4);
    let sent = Threads::run(size, |ranks| {
        // numbers that go to other ranks, exchange by exchange
        let sent = Arc::new(Mutex::new(Vec::new()));
        let noted = Arc::clone(&sent);
        let watched = WatchedRanks::around(ranks, move |call| {
            if let Call::Exchange(to_others) = call {
                noted.lock().unwrap().push(to_others);
            }
            Ok(())
        });
        let mut contact = sphere(cells, watched).unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        sent.lock().unwrap().clear();
        let report = contact.step(0.2, Load::force(1.0)).unwrap();
        let exchanged = sent.lock().unwrap().clone();
        (report, contact.fields().rows().len(), exchanged)
    })
    .unwrap();
    // transforms along x2 of 512 cells, padded; and of 256, mirrored, two rows of which are as many numbers as one
    let panels = |waves: usize| (0..size).map(move |rank| part(waves.div_ceil(8), rank, size)).collect::<Vec<_>>();
    let mut convolutions = 0;
    for (waves, high, times) in [(257, 8, sent[0].0.convolutions), (256, 16, sent[0].0.preconditioner_applications)] {
        assert!(times > 0);
        for (rank, (_, rows, exchanged)) in sent.iter().enumerate() {
            let (own, all) = (panels(waves)[rank], panels(waves).iter().sum::<usize>());
            let out = 2 * 64 * (rows / high) * (all - own);
            let back = 2 * 64 * own * (cells / high - rows / high);
            for expected in [out, back] {
                let calls = exchanged.iter().filter(|&&count| count == expected).count();
                // where rows and columns are shared out alike, both ways are as long
                assert_eq!(calls, if out == back { 2 * times } else { times }, "{rank} {waves}");
            }
            convolutions += if waves == 257 { 8 * (out + back) } else { 0 };
        }
    }
    let a_cell = convolutions as f64 / (cells * cells) as f64;
    let formula = 32.0 * (1.0 - 1.0 / size as f64);
    assert!((a_cell / formula - 1.0).abs() < 8.0 / cells as f64 + 0.01, "{a_cell} {formula}");
    // all else is rows of neighbours and of blocks: five for each preconditioner, and one for the edge
    for (_, _, exchanged) in &sent {
        let transforms = 2 * (sent[0].0.convolutions + sent[0].0.preconditioner_applications);
        let mut rest = exchanged.clone();
        rest.sort_unstable();
        let rest: usize = rest[..rest.len() - transforms].iter().sum();
        let rows = 5 * (sent[0].0.preconditioner_applications + sent[0].0.iterations) + 1;
        assert!(rest <= rows * 2 * cells, "{rest} numbers");
    }
}

fn part(n: usize, rank: usize, size: usize) -> usize {
    n * (rank + 1) / size - n * rank / size
}

/// All ranks get the profile that one process sees, across own rows and along a row of another, folded or not.
#[test]
fn profiles_are_those_of_one_process() {
    for symmetry in [true, false] {
        let build = || {
            let settings = Settings::default().with_symmetry(symmetry).with_window(false);
            builder_on(Grid::new([384, 200], [4.0e-3, 3.0e-3]).unwrap(), zener()).settings(settings)
        };
        let lines = [(Axis::X1, 0.3e-3), (Axis::X2, -0.5e-3), (Axis::X2, 0.1e-3), (Axis::X1, -1.5e-3)];
        let look = |mut contact: ViscoelasticContact| {
            contact.step(0.0, Load::force(1.0)).unwrap();
            assert_eq!(contact.fields().profile(Axis::X1, 1.6e-3).unwrap_err().kind(), ErrorKind::Value);
            lines.map(|(axis, at)| contact.fields().profile(axis, at).unwrap())
        };
        let alone = look(build().build().unwrap());
        assert!(alone[..3].iter().all(|profile| profile.pressure.iter().any(|&p| p > 0.0)));
        for size in [1, 3, 5] {
            for seen in Threads::run(size, |ranks| look(build().ranks(ranks).build().unwrap())).unwrap() {
                assert_eq!(seen, alone);
            }
        }
    }
}

/// A step that one rank asks for wrongly fails on all, and leaves the contact as it was.
#[test]
fn an_error_of_one_rank_is_that_of_all() {
    let errors = within_a_minute(|| {
        Threads::run(3, |ranks| {
            let rank = ranks.rank();
            let mut contact = sphere(128, ranks).unwrap();
            let first = contact.step(if rank == 1 { f64::NAN } else { 0.0 }, Load::force(1.0)).unwrap_err();
            let other = contact.step(0.0, Load::force(1.0 + rank as f64)).unwrap_err();
            let all = contact.step(-1.0, Load::force(1.0)).unwrap_err();
            let report = contact.step(0.0, Load::force(1.0)).unwrap();
            (first, other, all, report)
        })
        .unwrap()
    });
    for (first, other, all, report) in &errors {
        let Error::Ranks(RanksError::Failed { rank: 1, message }) = first else { panic!("{first}") };
        assert!(message.contains("time step"), "{message}");
        assert_eq!(*other, Error::Ranks(RanksError::Apart));
        // where all fail alike, the error keeps its type
        assert!(matches!(all, Error::OutOfRange { field: "time step", .. }), "{all}");
        assert_eq!((first, report), (&errors[0].0, &errors[0].3));
    }
}

/// A gap that is not a number in rows of one rank: all get the error of one process.
#[test]
fn a_bad_gap_is_found_where_one_process_finds_it() {
    let scenes: [fn(f64, f64) -> f64; 3] = [
        |x1, x2| if x1 > 3.0e-4 && x2 > 1.0e-4 { f64::NAN } else { x1 * x1 + x2 * x2 },
        |x1, _| if x1 > -1.0e-4 { f64::NEG_INFINITY } else { 0.0 },
        |_, _| f64::INFINITY,
    ];
    let builder = |grid: &Grid| ViscoelasticContact::builder(grid.clone());
    for gap in scenes {
        let grid = Grid::square(192, 1.0e-3).unwrap();
        let alone = builder(&grid).geometry(&FnGeometry::new(gap)).material(elastic()).build().unwrap_err();
        let errors = Threads::run(3, |ranks| {
            builder(&grid).ranks(ranks).geometry(&FnGeometry::new(gap)).material(elastic()).build().unwrap_err()
        });
        for error in errors.unwrap() {
            // NaN is not equal to itself
            assert_eq!(format!("{error:?}"), format!("{alone:?}"));
        }
    }
}

/// A part that is missing on one rank alone.
#[test]
fn a_contact_that_one_rank_cannot_build_is_built_by_none() {
    let errors = within_a_minute(|| {
        Threads::run(3, |ranks| {
            let (sphere, bad) = (Sphere::new(1.0e-2).unwrap(), ranks.rank() == 2);
            let builder = ViscoelasticContact::builder(Grid::square(32, 1.0e-3).unwrap()).ranks(ranks);
            let builder = if bad { builder } else { builder.material(elastic()) };
            builder.geometry(&sphere).build().unwrap_err()
        })
        .unwrap()
    });
    for error in &errors {
        assert!(matches!(error, Error::Ranks(RanksError::Failed { rank: 2, .. })), "{error}");
        assert_eq!(error, &errors[0]);
    }
}

/// One of very many ranks, played alone: all others bring what it brings.
#[derive(Debug)]
struct OneOf(usize);

impl Ranks for OneOf {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        self.0
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        let mut rest = all;
        for &count in counts {
            let (part, others) = rest.split_at_mut(count);
            part.iter_mut().zip(own).for_each(|(part, &value)| *part = value);
            rest = others;
        }
        Ok(())
    }

    fn exchange(&self, _: &[f64], _: &[usize], _: &mut [f64], _: &[usize]) -> Result<(), RanksError> {
        Ok(())
    }
}

/// More cells than one process can number, of which a rank takes its share of memory.
#[test]
fn a_grid_of_65536_by_65536_cells_is_accepted() {
    let cells = 1 << 16;
    let memory = |ranks: usize| {
        let grid = Grid::square(cells, 1.0e-3).unwrap();
        let body = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
        let settings = Settings::default().with_symmetry(false);
        let builder = ViscoelasticContact::builder(grid).settings(settings).ranks(Arc::new(OneOf(ranks)));
        builder.geometry(&FnGeometry::new(|x1, x2| x1 + x2)).material(body).memory().unwrap()
    };
    for ranks in [512, 1024] {
        let own = memory(ranks);
        assert_eq!(own.computed_cells, cells * cells / ranks);
        // and what each rank has of all: two numbers for each block of 16 × 16 cells or more
        let of_all = 16.0 / 256.0 * 4.0 / 3.0 * (cells * cells) as f64;
        let a_cell = (own.total() as f64 - of_all) / own.computed_cells as f64;
        assert!((165.0..190.0).contains(&a_cell), "{a_cell} bytes a cell on {ranks} ranks");
    }
}

/// Who returns early, or panics, leaves no one waiting.
#[test]
fn no_rank_waits_for_one_that_has_left() {
    let left = within_a_minute(|| {
        Threads::run(3, |ranks| {
            let rank = ranks.rank();
            let mut contact = sphere(128, ranks).unwrap();
            if rank == 0 {
                return None;
            }
            Some(contact.step(0.0, Load::force(1.0)).unwrap_err())
        })
        .unwrap()
    });
    assert_eq!(left[0], None);
    assert!(left[1..].iter().all(|error| *error == Some(Error::Ranks(RanksError::Left { rank: 0 }))), "{left:?}");

    // a run looks ahead before its first step
    for stepping in [Stepping::fixed(0.1), Stepping::adaptive(1.0e-2)] {
        let left = within_a_minute(move || {
            Threads::run(3, |ranks| {
                let rank = ranks.rank();
                let mut contact = sphere(128, ranks).unwrap();
                let ramp = Ramp::new(Load::force(0.0), Load::force(1.0), 1.0).unwrap();
                let mut run = contact.follow(&ramp, stepping, 1.0);
                (rank > 0).then(|| run.next_step().unwrap_err())
            })
            .unwrap()
        });
        assert!(left[1..].iter().all(|error| *error == Some(Error::Ranks(RanksError::Left { rank: 0 }))), "{left:?}");
    }

    let (panic, others) = within_a_minute(|| {
        let others = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&others);
        let panic = catch_unwind(AssertUnwindSafe(|| {
            Threads::run(3, |ranks| {
                let rank = ranks.rank();
                let mut contact = sphere(128, ranks).unwrap();
                contact.step(0.0, Load::force(1.0)).unwrap();
                assert!(rank != 1, "on purpose");
                let error = contact.step(0.1, Load::force(1.0)).unwrap_err();
                others.lock().unwrap().push((error, contact.time()));
            })
        }));
        let seen = seen.lock().unwrap().clone();
        (panic.unwrap_err(), seen)
    });
    assert_eq!(panic.downcast_ref::<&str>(), Some(&"on purpose"));
    assert_eq!(others, vec![(Error::Ranks(RanksError::Left { rank: 1 }), 0.0); 2]);
}

/// Whichever call of the group fails, what needed it returns the error, and the contact is as it was: the step then succeeds,
/// with the same bits.
#[test]
fn a_loss_at_any_call_is_an_error_and_leaves_the_contact_as_it_was() {
    let failed = within_a_minute(|| {
        Threads::run(2, |ranks| {
            // all ranks lose the same call, so that none waits
            let rank = ranks.rank();
            let (lossy, calls_left) = with_calls_left(ranks, 1);
            // calls `job` without its first call, then without its second, and so on until it succeeds
            let losing = |job: &mut dyn FnMut() -> Result<(), Error>| {
                for at in 0.. {
                    calls_left.store(at, Ordering::Relaxed);
                    let done = job();
                    let used_up = calls_left.swap(usize::MAX, Ordering::Relaxed) == 0;
                    match done {
                        Ok(()) => return at,
                        Err(error) => assert_eq!((error, used_up), (Error::Ranks(RanksError::Left { rank: 1 }), true)),
                    }
                }
                unreachable!("some number of calls is enough");
            };
            let mut built = None;
            let building = losing(&mut || sphere(96, Arc::clone(&lossy)).map(|contact| built = Some(contact)));
            let mut contact = built.unwrap();
            contact.step(0.0, Load::force(1.0)).unwrap();
            let mut ahead = contact.clone();
            let expected = ahead.step(0.2, Load::force(1.1)).unwrap();
            let seen = |contact: &ViscoelasticContact| {
                (contact.time(), contact.approach(), contact.contact_cells(), contact.pressure().to_vec())
            };
            let (before, mut report) = (seen(&contact), None);
            let stepping = losing(&mut || {
                assert!(report.is_none() && seen(&contact) == before, "rank {rank}");
                contact.step(0.2, Load::force(1.1)).map(|done| report = Some(done))
            });
            assert_eq!((report.unwrap(), seen(&contact)), (expected, seen(&ahead)));

            let ramp = Ramp::new(Load::force(1.1), Load::force(2.0), 1.0).unwrap();
            let (mut run, time) = (contact.follow(&ramp, Stepping::adaptive(1.0e-2), 1.0), before.0);
            let running = losing(&mut || {
                assert_eq!(run.contact().time(), 0.2 + time);
                run.next_step().map(|_| ())
            });
            let looking = losing(&mut || contact.fields().stiffness_over_modulus().map(|_| ()))
                + losing(&mut || contact.fields().profile(Axis::X1, 0.0).map(|_| ()))
                + losing(&mut || contact.fields().gathered(contact.pressure(), 1).map(|_| ()));
            // what returns no error is NaN, and the next call returns it
            calls_left.store(0, Ordering::Relaxed);
            assert!(contact.fields().max_pressure().is_nan() && contact.contact_area().is_nan());
            calls_left.store(usize::MAX, Ordering::Relaxed);
            assert_eq!(contact.step(0.1, Load::force(1.0)), Err(Error::Ranks(RanksError::Left { rank: 1 })));
            contact.step(0.1, Load::force(1.0)).unwrap();
            [building, stepping, running, looking]
        })
        .unwrap()
    });
    assert_eq!(failed[0], failed[1]);
    assert!(failed[0].iter().zip([10, 100, 50, 20]).all(|(calls, least)| *calls >= least), "{failed:?}");
}

#[test]
fn what_is_not_shared_is_refused_by_name() {
    const RANKS: &str = "is not covered on rows that ranks share out: compute the contact in one process";
    let built = |settings: fn() -> Settings| {
        Threads::run(2, move |ranks| {
            builder_on(Grid::square(32, 4.0e-3).unwrap(), zener()).settings(settings()).ranks(ranks).build().err()
        })
        .unwrap()
    };
    for error in built(|| Settings::default().with_frame(Frame::Indenter)) {
        not_covered([(error, RANKS)]);
    }
    let attracted = Threads::run(2, |ranks| {
        let law = ExponentialAttraction::new(0.05, 1.0e-5).unwrap();
        builder_on(Grid::square(32, 4.0e-3).unwrap(), elastic()).ranks(ranks).attraction(law).build().err()
    });
    for error in attracted.unwrap() {
        not_covered([(error, "where surfaces attract each other: compute it in one process")]);
    }
    Threads::run(2, |ranks| {
        let mut contact = builder_on(Grid::square(32, 4.0e-3).unwrap(), zener()).ranks(ranks).build().unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        not_covered([
            (contact.fields().patches().err(), RANKS),
            (contact.fields().stress().err(), RANKS),
            (contact.set_geometries(&[&Sphere::new(1.0).unwrap()]).err(), RANKS),
            (contact.fields().mesh_error().err(), RANKS),
            // the load would have to unfold the fields
            (contact.step(0.1, Load::eccentric_force(1.0, [1.0e-4, 0.0])).err(), RANKS),
        ]);
        contact.step(0.1, Load::force(1.0)).unwrap();
    })
    .unwrap();
}

#[test]
fn the_number_of_threads_is_checked() {
    refused([0, 1025].map(|size| (Threads::run(size, |_| ()).err(), "ranks")));
}
