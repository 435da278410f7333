//! Balls that stick, in units of R, w and the relaxed E*, against theory and axisymmetric computations.

use std::f64::consts::PI;

use viscocontact::Result;
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction};
use viscocontact::analytic::{Jkr, MaugisDugdale, OpeningEdge};
use viscocontact::plot::Legend;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};
use crate::elastic::between;

fn ball(
    cells: usize,
    side: f64,
    body: impl Rheology + 'static,
    law: impl Attraction + 'static,
) -> Result<ViscoelasticContact> {
    ViscoelasticContact::builder(Grid::square(cells, side)?)
        .geometry(&Sphere::new(1.0)?)
        .material(Material::incompressible(body))
        .attraction(law)
        .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(true))
        .build()
}

/// Approaches and forces while the ball is pulled up to an approach, in `count` equal steps over `time`.
fn pulled(contact: &mut ViscoelasticContact, to: f64, time: f64, count: usize) -> Result<Vec<(f64, f64)>> {
    let from = contact.approach();
    let approaches = (1..=count).map(|k| from + (to - from) * k as f64 / count as f64);
    approaches
        .map(|approach| Ok((approach, contact.step(time / count as f64, Load::approach(approach))?.force)))
        .collect()
}

/// The greatest pull of a path, by a parabola through three points.
fn greatest_pull(path: &[(f64, f64)]) -> f64 {
    let three = path.windows(3).min_by(|a, b| a[1].1.total_cmp(&b[1].1));
    let Some(&[(x0, y0), (x1, y1), (x2, y2)]) = three else { return f64::NAN };
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let bend = (second - first) / (x2 - x0);
    let x = 0.5 * (x0 + x1) - 0.5 * first / bend;
    -(y0 + first * (x - x0) + bend * (x - x0) * (x - x1))
}

/// Forces on an elastic body from contact to pull-off, Tabor's number 1.
fn elastic(cells: usize, law: impl Attraction + 'static) -> Result<Vec<(f64, f64)>> {
    let mut contact = ball(cells, 8.0, Elastic::new(0.25)?, law)?;
    contact.step(1.0, Load::approach(1.0))?;
    pulled(&mut contact, -1.4, 1.0, 24)
}

pub fn exponential() -> Outcome {
    let found = greatest_pull(&elastic(96, ExponentialAttraction::new(1.0, 1.0)?)?);
    let rows = [("maximum pull over π w R", found / PI, 1.664_076_85, 1e-3)];
    Ok(Checked::new("sphere, exponential attraction, 12 cells in the zone", "axisymmetric computation, below", &rows))
}

pub fn dugdale() -> Outcome {
    let exact = MaugisDugdale::new(1.0, 1.0, 1.0, 1.0)?;
    let path = elastic(64, Dugdale::new(1.0, 1.0)?)?;
    let rows = [("maximum pull over π w R", greatest_pull(&path) / PI, -exact.pull_off()[0] / PI, 3e-3)];
    let line = between(0.3, 2.05).map(|a| exact.state(a)).map(|[force, approach]| (approach, force)).collect();
    Ok(Checked::new("sphere, Dugdale's attraction, 8 cells in the zone", "Maugis 1992", &rows).drawn(
        ["approach / (R w² / E*²)^(1/3)", "force / w R"],
        Legend::LowerRight,
        line,
        path,
    ))
}

/// A contact that has relaxed on E = 1 + 9 exp(−t/τ) at a = 3, and is pulled off. Tabor's number is 2, relaxed.
pub fn creeping() -> Outcome {
    let body = GeneralizedMaxwell::new(0.25, &[(2.25, 1.0)])?;
    let mut relaxed = ball(144, 12.0, body, ExponentialAttraction::new(1.0, 0.5)?)?;
    let start = 5.320_309_8;
    // the contact grows for much longer than the body relaxes
    for _ in 0..4 {
        relaxed.step(1.0e4, Load::approach(start))?;
    }
    let pull = |speed: f64, time: f64, count: usize| pulled(&mut relaxed.clone(), start - speed * time, time, count);
    let (slow, fast) = (pull(1.0, 4.924, 50)?, pull(1000.0, 6.0e-3, 60)?);
    let rows = [
        ("force at rest", relaxed.force(), 12.847_194, 2e-3),
        ("pull after 0.4924 τ at V = 1", -slow[4].1, 9.458, 1e-2),
        ("maximum pull at V = 1", greatest_pull(&slow), 26.958, 1e-2),
        ("maximum pull at V = 1000", greatest_pull(&fast), 33.078, 1e-2),
    ];
    Ok(Checked::new("sphere pulled off a creeping body, 144² cells", "axisymmetric computation, below", &rows))
}

/// The same body, pulled off slowly by Dugdale's attraction, against the theory of an opening edge. Both are divided by the pull-off force of the relaxed
/// body, of a range and of none. Tabor's number is 2, relaxed.
pub fn opening_edge() -> Outcome {
    let (law, start) = (Dugdale::new(1.0, 0.5)?, 3.0);
    let body = GeneralizedMaxwell::new(0.25, &[(2.25, 1.0)])?;
    let edge = OpeningEdge::new(&Material::incompressible(body.clone()), 1.0, 0.5)?;
    let mut relaxed = ball(128, 10.0, body, law)?;
    for _ in 0..4 {
        relaxed.step(1.0e4, Load::approach(start))?;
    }
    let [of_range, of_none] =
        [MaugisDugdale::new(1.0, 1.0, 1.0, 2.0)?.pull_off()[0], Jkr::new(1.0, 1.0, 1.0)?.pull_off_force()];
    let row = |speed: f64| {
        let theory = edge.pull_off(1.0, start, speed)?;
        let to = theory.approach - 0.3;
        let path = pulled(&mut relaxed.clone(), to, (start - to) / speed, 80)?;
        Ok::<_, viscocontact::Error>([-greatest_pull(&path) / of_range, theory.force / of_none])
    };
    let [slow, faster] = [row(0.01)?, row(0.03)?];
    let rows = [
        ("maximum pull at V = 0.01 over the relaxed one", slow[0], slow[1], 4e-2),
        ("maximum pull at V = 0.03 over the relaxed one", faster[0], faster[1], 4e-2),
    ];
    Ok(Checked::new(
        "sphere pulled off a creeping body, 128² cells",
        "theory of an opening edge (Schapery 1975, Greenwood 2004)",
        &rows,
    ))
}
