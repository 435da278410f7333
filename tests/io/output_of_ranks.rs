//! A file that one rank cannot write is an error on all ranks, and no rank waits for ever.

use std::fs;
use std::sync::Arc;

use crate::common::{Temporary, builder_on, zener};
use viscocontact::output::{CsvHistory, Earlier, Field, Format, FrameSeries, Metadata};
use viscocontact::parallel::{RanksError, Threads};
use viscocontact::prelude::*;

/// A file that cannot be written can be tried again.
#[test]
fn a_file_that_one_rank_cannot_write_is_an_error_on_all() {
    let root = Temporary::folder("files-of-ranks");
    fs::write(root.join("old.csv"), "old").unwrap();
    let metadata = || Metadata::new("Ranks");
    let errors = Threads::run(3, |ranks| {
        let mut contact = builder_on(Grid::square(128, 4.0e-3)?, zener()).ranks(Arc::clone(&ranks)).build()?;
        let report = contact.step(0.0, Load::force(1.0))?;
        let mut errors = Vec::new();
        errors.push(CsvHistory::create(root.join("old.csv"), &metadata(), &contact, &[], Earlier::Refuse).err());
        let bad = if ranks.rank() == 1 { "a # b" } else { "ab" };
        errors.push(CsvHistory::create(root.join("new.csv"), &metadata(), &contact, &[bad], Earlier::Refuse).err());
        let mut csv = CsvHistory::create(root.join("new.csv"), &metadata(), &contact, &[], Earlier::Refuse)?;
        errors.push(csv.record(&contact, &report, if ranks.rank() == 2 { &[1.0] } else { &[] }).err());
        csv.record(&contact, &report, &[])?;
        let series = root.join("series");
        let mut npz =
            FrameSeries::create(&series, Format::Npz, &metadata(), &contact, &[Field::Pressure], Earlier::Refuse)?;
        let mut vtk =
            FrameSeries::create(&series, Format::Vtk, &metadata(), &contact, &[Field::Pressure], Earlier::Refuse)?;
        // all have made theirs
        contact.fields().moment();
        if ranks.rank() == 0 {
            fs::remove_dir_all(&series).unwrap();
        }
        contact.fields().moment();
        errors.push(npz.record(&contact).err());
        errors.push(vtk.record(&contact).err());
        if ranks.rank() == 0 {
            fs::create_dir(&series).unwrap();
        }
        contact.fields().moment();
        assert!(
            npz.record(&contact)?.ends_with("frame_000000.npz") && vtk.record(&contact)?.ends_with("frame_000000.vti")
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
        assert_eq!(failed.iter().map(|(rank, _)| *rank).collect::<Vec<_>>(), [0, 1, 2, 0, 0]);
        for ((_, message), expected) in
            failed.iter().zip(["exists", "column name", "additional columns", "does not exist", "does not exist"])
        {
            assert!(message.contains(expected), "{message}");
        }
    }
    assert_eq!(fs::read_to_string(root.join("old.csv")).unwrap(), "old");
    assert_eq!(fs::read_to_string(root.join("new.csv")).unwrap().lines().count(), 2);
}
