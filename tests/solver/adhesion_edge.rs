//! The force that an attraction would add beyond the edge of the grid: what steps say of it, against a wider grid.

use std::sync::Arc;

use crate::common::fields::traction;
use crate::common::sticky::{ball, elastic};
use viscocontact::adhesion::{Attraction, ExponentialAttraction, VanDerWaals};
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

/// Cells along a unit of length.
const FINENESS: f64 = 6.0;
const WIDE: f64 = 32.0;

/// A ball of radius 1 in contact.
fn pressed(law: &Arc<dyn Attraction>, side: f64, edge: Edge, folded: bool) -> Result<(f64, f64, StepReport), Error> {
    let settings = Settings::default().with_edge(edge).with_symmetry(folded);
    let cells = (FINENESS * side) as usize;
    let mut contact = ball(cells, side, elastic(), Arc::clone(law)).settings(settings).build()?;
    let report = contact.step(1.0, Load::approach(0.5))?;
    let sum: f64 = traction(contact.fields()).iter().map(|q| q.abs()).sum();
    Ok((report.force, sum * contact.grid().cell_area(), report))
}

#[test]
fn the_attraction_beyond_the_edge_is_measured() {
    let (mut refused, mut warned, mut silent) = (0, 0, 0);
    let laws: [Arc<dyn Attraction>; 3] = [
        Arc::new(ExponentialAttraction::new(1.0, 1.0).unwrap()),
        Arc::new(VanDerWaals::new(1.0, 1.0).unwrap()),
        Arc::new(VanDerWaals::new(1.0, 2.0).unwrap()),
    ];
    for (law, side) in laws.iter().flat_map(|law| [4.0, 6.0, 8.0, 10.0, 12.0, 16.0].map(|side| (law, side))) {
        let (whole, ..) = pressed(law, WIDE, Edge::Allow, true).unwrap();
        let (force, sum, report) = pressed(law, side, Edge::Allow, true).unwrap();
        assert!(!report.warnings.contains(Warnings::BEYOND_EDGE) && report.figures.beyond_edge.is_none());
        let beyond = (force - whole) / sum.max(side);
        let found = [true, false].map(|folded| match pressed(law, side, Edge::Refuse, folded) {
            Ok((.., report)) => {
                assert_eq!(report.warnings.contains(Warnings::BEYOND_EDGE), report.figures.beyond_edge.is_some());
                report.figures.beyond_edge
            }
            Err(error) if error.code() == "adhesion_beyond_edge" => error.value(),
            Err(error) => panic!("{law:?}, {side}: {error}"),
        });
        println!("{law:?}, side {side}: {beyond:.1e} beyond the edge, found {found:?}");
        let share = found[0].unwrap_or(0.0);
        assert!((share - found[1].unwrap_or(0.0)).abs() <= 5e-3 * share, "symmetry");
        match found[0] {
            Some(share) => {
                assert!((0.5..2.0).contains(&(share / beyond)), "{law:?}, {side}: {share} {beyond}");
                (refused, warned) = (refused + u32::from(share > 0.05), warned + u32::from(share <= 0.05));
            }
            None => {
                assert!(beyond < 2e-3, "{law:?}, {side}: {beyond}");
                silent += 1;
            }
        }
    }
    println!("{refused} refused, {warned} warned of, {silent} silent");
    assert!(refused > 2 && warned > 2 && silent > 2);
}
