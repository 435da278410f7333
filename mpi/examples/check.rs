//! What `tests/mpi.sh` runs: prints a hash of scenes, the same on any number of ranks; writes files; goes on from a
//! checkpoint; or fails on purpose.
//!
//! Arguments: `scenes`, `files FOLDER`, `save PATH`, `resume PATH`, and `alone` before any of these without ranks; `errs`,
//! `leaves`, `panics`, `waits` for failures of rank 1. `short N` before all has messages of at most N numbers.

use std::path::Path;
use std::sync::Arc;

use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
use viscocontact::parallel::{Ranks, RanksError};
use viscocontact::prelude::*;
use viscocontact_mpi::Mpi;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut words = std::env::args().skip(1).peekable();
    let most = if words.next_if_eq("short").is_some() { words.next().unwrap_or_default().parse()? } else { usize::MAX };
    if words.next_if_eq("alone").is_some() {
        return succeed(&words.next().unwrap_or_default(), words.next().as_deref(), None);
    }
    let what = words.next().unwrap_or_default();
    let ranks: Arc<dyn Ranks> = Mpi::start_with_messages(most)?;
    let rank = ranks.rank();
    match what.as_str() {
        "errs" => {
            let mut contact = sphere(Some(Arc::clone(&ranks)))?;
            let dt = if rank == 1 { f64::NAN } else { 0.0 };
            let error = contact.step(dt, Load::force(1.0)).err();
            assert!(matches!(error, Some(Error::Ranks(RanksError::Failed { rank: 1, .. }))), "{error:?}");
            contact.step(0.0, Load::force(1.0))?;
        }
        "leaves" => {
            let mut contact = sphere(Some(Arc::clone(&ranks)))?;
            if rank == 1 {
                return Ok(());
            }
            let error = contact.step(0.0, Load::force(1.0)).err();
            assert_eq!(error, Some(Error::Ranks(RanksError::Left { rank: 1 })));
        }
        "panics" | "waits" => {
            let mut contact = sphere(Some(Arc::clone(&ranks)))?;
            assert!(what == "waits" || rank != 1, "on purpose");
            if rank == 1 {
                println!("pid {}", std::process::id()); // to be killed
                std::thread::sleep(std::time::Duration::from_secs(600));
            }
            contact.step(0.0, Load::force(1.0))?;
        }
        other => succeed(other, words.next().as_deref(), Some(ranks))?,
    }
    Ok(())
}

/// What gives the same on any number of ranks, and without.
fn succeed(what: &str, place: Option<&str>, ranks: Option<Arc<dyn Ranks>>) -> Result<(), Failure> {
    let first = ranks.as_ref().is_none_or(|ranks| ranks.rank() == 0);
    let hash = match (what, place) {
        ("scenes", None) => hash_of_scenes(ranks)?,
        ("files", Some(folder)) => return Ok(write_files(Path::new(folder), ranks)?),
        ("save", Some(path)) => return Ok(hold(ranks, None, Some(path)).map(drop)?),
        ("resume", Some(path)) => hold(ranks, Some(path), None)?,
        ("hold", None) => hold(ranks, None, None)?,
        _ => return Err(format!("no such check: {what:?}").into()),
    };
    if first {
        println!("{hash:016x}");
    }
    Ok(())
}

/// Two frames of a contact, with all fields.
fn write_files(folder: &Path, ranks: Option<Arc<dyn Ranks>>) -> Result<(), Error> {
    let mut contact = sphere(ranks)?;
    let (scene, refuse) = (Metadata::new("check"), Earlier::Refuse);
    let mut npz = FrameSeries::create(folder.join("npz"), Format::Npz, &scene, &contact, &Field::ALL, refuse)?;
    let mut vtk = FrameSeries::create(folder.join("vtk"), Format::Vtk, &scene, &contact, &Field::ALL, refuse)?;
    for dt in [0.0, 0.3] {
        contact.step(dt, Load::force(1.0))?;
        npz.record(&contact)?;
        vtk.record(&contact)?;
    }
    Ok(())
}

/// A run by steps chosen by their error, which is saved in the middle, goes on from there, or does neither: a hash of its end.
fn hold(ranks: Option<Arc<dyn Ranks>>, from: Option<&str>, to: Option<&str>) -> Result<u64, Error> {
    let mut contact = sphere(ranks)?;
    if let Some(path) = from {
        contact.resume(path)?;
    }
    let history = PiecewiseLinear::new(&[(0.0, Load::force(0.0)), (1.0, Load::force(1.0)), (2.0, Load::force(0.4))])?;
    let mut run = contact.follow(&history, Stepping::adaptive(1.0e-2), 2.0);
    let mut hash = 0xcbf2_9ce4_8422_2325;
    while let Some(report) = run.next_step()? {
        if let (Some(path), true) = (to, report.time > 0.5) {
            run.save(path)?;
            return Ok(hash);
        }
    }
    add(&mut hash, &[contact.force(), contact.approach(), contact.contact_area()]);
    add(&mut hash, &contact.fields().gathered(contact.pressure(), 0)?.unwrap_or_default());
    add(&mut hash, &contact.fields().gathered(contact.fields().displacement(), 0)?.unwrap_or_default());
    Ok(hash)
}

fn sphere(ranks: Option<Arc<dyn Ranks>>) -> Result<ViscoelasticContact, Error> {
    let builder = ViscoelasticContact::builder(Grid::new([203, 178], [4.0e-3, 3.6e-3])?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))
        .settings(Settings::default().with_symmetry(false).with_window(false));
    match ranks {
        Some(ranks) => builder.ranks(ranks).build(),
        None => builder.build(),
    }
}

/// Of steps under force and approach on a half-space, and of a tilting punch.
fn hash_of_scenes(ranks: Option<Arc<dyn Ranks>>) -> Result<u64, Error> {
    let mut contact = sphere(ranks.clone())?;
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for (dt, load) in [(0.0, Load::force(1.0)), (0.3, Load::force(1.5)), (0.5, Load::approach(2.0e-4))] {
        contact.step(dt, load)?;
        add(&mut hash, &[contact.force(), contact.approach(), contact.fields().max_pressure()]);
    }
    add(&mut hash, &contact.fields().gathered(contact.pressure(), 0)?.unwrap_or_default());
    let settings = Settings::default().with_symmetry(false).with_window(false);
    let punch = ViscoelasticContact::builder(Grid::new([170, 160], [1.2e-3, 1.0e-3])?)
        .geometry(&FlatPunch::rectangular([0.8e-3, 0.6e-3])?)
        .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
        .settings(settings);
    let mut contact = match ranks {
        Some(ranks) => punch.ranks(ranks).build()?,
        None => punch.build()?,
    };
    for step in 0..3 {
        contact
            .step(0.2 * f64::from(step), Load::eccentric_force(1.0, [0.1e-3 + 0.03e-3 * f64::from(step), 0.05e-3]))?;
        add(&mut hash, &contact.tilt());
    }
    add(&mut hash, &contact.fields().gathered(contact.pressure(), 0)?.unwrap_or_default());
    Ok(hash)
}

/// FNV-1a over the bits.
fn add(hash: &mut u64, values: &[f64]) {
    for byte in values.iter().flat_map(|value| value.to_bits().to_le_bytes()) {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
}
