//! What `tests/mpi.sh` runs: prints a hash of scenes, the same on any number of ranks; or fails on purpose.
//!
//! Arguments: `scenes`, or `alone` without ranks; `errs`, `leaves`, `panics`, `waits` for failures of rank 1.

use std::sync::Arc;

use viscocontact::prelude::*;
use viscocontact::ranks::{Ranks, RanksError};
use viscocontact_mpi::Mpi;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let what = std::env::args().nth(1).unwrap_or_default();
    if what == "alone" {
        println!("{:016x}", hash_of_scenes(None)?);
        return Ok(());
    }
    let most = std::env::args().nth(2).map_or(Ok(usize::MAX), |most| most.parse())?;
    let ranks: Arc<dyn Ranks> = Mpi::start_with_messages(most)?;
    let rank = ranks.rank();
    match what.as_str() {
        "scenes" => {
            let hash = hash_of_scenes(Some(Arc::clone(&ranks)))?;
            if rank == 0 {
                println!("{hash:016x}");
            }
        }
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
        other => return Err(format!("no such check: {other:?}").into()),
    }
    Ok(())
}

fn sphere(ranks: Option<Arc<dyn Ranks>>) -> Result<ViscoelasticContact, Error> {
    let builder = ViscoelasticContact::builder(Grid::new([203, 178], [4.0e-3, 3.6e-3])?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6)?))
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
        add(&mut hash, &[contact.force(), contact.approach(), contact.max_pressure()]);
    }
    add(&mut hash, &contact.gathered(contact.pressure(), 0)?.unwrap_or_default());
    let settings = Settings::default().with_symmetry(false).with_window(false);
    let punch = ViscoelasticContact::builder(Grid::new([170, 160], [1.2e-3, 1.0e-3])?)
        .geometry(&FlatPunch::rectangular([0.8e-3, 0.6e-3])?)
        .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
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
    add(&mut hash, &contact.gathered(contact.pressure(), 0)?.unwrap_or_default());
    Ok(hash)
}

/// FNV-1a over the bits.
fn add(hash: &mut u64, values: &[f64]) {
    for byte in values.iter().flat_map(|value| value.to_bits().to_le_bytes()) {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
}
