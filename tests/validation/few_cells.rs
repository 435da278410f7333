//! Contacts of few cells, against meshes four times as fine: of one body beside others, and of the patches of rough surfaces. A
//! contact that is not warned of is as accurate as the page says; one of fewer cells is warned of. `FEW_CELLS_SCENES` of each kind.

use std::f64::consts::FRAC_PI_4;

use viscocontact::contact::Warnings;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

use crate::common::{Draws, elastic, from_environment};

/// Cells across the contact of the cells that `own` holds for, if they are few: 4/π times the mean chord, along one axis or the other, at most
/// their extent.
fn few(contact: &ViscoelasticContact, own: impl Fn([f64; 2]) -> bool) -> Option<f64> {
    let (grid, periodic) = (contact.grid(), contact.fields().kernel().periodic_axes());
    let cells = grid.cells();
    let touches =
        |cell: [usize; 2]| contact.pressure()[cell[0] * cells[1] + cell[1]] > 0.0 && own(grid.center(cell[0], cell[1]));
    let along = |axis: usize| {
        let (mut inside, mut ends, mut low, mut high) = (0, 0, usize::MAX, 0);
        for other in 0..cells[1 - axis] {
            let n = cells[axis];
            let line: Vec<bool> = (0..n).map(|k| touches(if axis == 0 { [k, other] } else { [other, k] })).collect();
            for k in (0..n).filter(|&k| line[k]) {
                let before = if k > 0 { line[k - 1] } else { periodic[axis] && line[n - 1] };
                let after = if k + 1 < n { line[k + 1] } else { periodic[axis] && line[0] };
                ends += usize::from(!before) + usize::from(!after);
                (inside, low, high) = (inside + 1, low.min(k), high.max(k));
            }
        }
        let (chord, extent) = (2.0 * inside as f64 / ends as f64 / FRAC_PI_4, (high + 1).saturating_sub(low) as f64);
        let few = ends > 0 && (extent < 8.0 || chord < 7.0 || inside < 50);
        few.then(|| chord.min(extent))
    };
    [along(0), along(1)].into_iter().flatten().reduce(f64::min)
}

/// The warning of a step and its number are those of the contact that few cells resolve.
fn assert_same(report: &StepReport, few: Option<f64>, name: &str) {
    assert_eq!(report.warnings.contains(Warnings::FEW_CELLS), few.is_some(), "{name}");
    match (report.figures.cells_across, few) {
        (Some(told), Some(few)) => assert!((told / few - 1.0).abs() < 1e-12, "{name}: {few}"),
        (told, few) => assert_eq!(told, few, "{name}"),
    }
}

/// The ratio of a value to the one on a finer mesh, less 1.
fn error(value: f64, exact: f64) -> f64 {
    (value / exact - 1.0).abs()
}

/// Balls in a row, some pressed hard, some lightly: the warning is that of the one with the fewest cells, and so is the error due to the mesh.
#[test]
fn a_body_on_few_cells_is_warned_of_beside_others() {
    let (mut warned, mut unwarned, mut compared) = (0, 0, 0);
    for number in 0..from_environment("FEW_CELLS_SCENES", 30) {
        let mut draws = Draws::new(1_100 + number);
        let (count, n) = (2 + draws.below(2), 20 + 2 * draws.below(14));
        let radii: Vec<f64> = (0..count).map(|_| draws.scale(2.0e-3, 8.0e-3)).collect();
        // the radius of each contact, in cells of the coarse mesh
        let widths: Vec<f64> = (0..count).map(|_| draws.scale(1.0, 0.4 * n as f64)).collect();
        let side = 4.0e-3;
        let at = |body: usize| (body as f64 - 0.5 * (count as f64 - 1.0)) * side + 1.0e-6;
        let ball = |body: usize| Shifted::new(Sphere::new(radii[body]).unwrap(), [at(body), 0.0]).unwrap();
        let loads: Vec<Load> = (0..count)
            .map(|body| {
                let radius = widths[body] * side / n as f64;
                Load::force(4.0 / 3.0 * 4.0e6 * radius.powi(3) / radii[body])
            })
            .collect();
        let solve = |n: usize| {
            let grid = Grid::new([count * n, n], [count as f64 * side, side]).unwrap();
            let builder = ViscoelasticContact::builder(grid).geometry(&ball(0)).material(elastic());
            let builder = (1..count).fold(builder, |builder, body| builder.another_body(&ball(body)));
            let mut contact = builder.build().unwrap();
            let report = contact.step(0.0, &loads).unwrap();
            (report, contact)
        };
        let ((report, contact), (_, fine)) = (solve(n), solve(4 * n));
        let own = |body: usize| move |[x1, _]: [f64; 2]| (x1 - at(body)).abs() < 0.5 * side;
        let fewest = (0..count).filter_map(|body| few(&contact, own(body))).reduce(f64::min);
        let name = format!("scene {number}, {widths:?} on {n}: {report}");
        assert_same(&report, fewest, &name);
        let errors = (0..count)
            .map(|body| {
                error(contact.fields().body(body).unwrap().approach, fine.fields().body(body).unwrap().approach)
            })
            .fold(0.0, f64::max);
        assert!(errors.is_finite(), "{name}");
        assert!(fewest.is_some() || errors < 5e-3, "{name}: {errors}");
        warned += u32::from(fewest.is_some());
        unwarned += u32::from(fewest.is_none());
        if let Some(measured) = contact.fields().mesh_error().unwrap() {
            assert!(errors < 4.0 * measured.approach, "{name}: {errors} for {measured}");
            compared += 1;
        }
    }
    println!("{warned} warned of, {unwarned} not, {compared} measured");
    assert!(warned > 5 && unwarned > 3 && compared > 5, "{warned} {unwarned} {compared}");
}

/// Rough surfaces, periodic and on a ball, from few cells in a patch to many.
#[test]
fn patches_of_few_cells_on_average_are_warned_of() {
    // number, greatest and sum of the errors of area and approach: below 4 cells across, few, and enough
    let mut found = [(0, [0.0_f64; 2], [0.0; 2]); 3];
    for number in 0..from_environment("FEW_CELLS_SCENES", 30) {
        let mut draws = Draws::new(2_200 + number);
        let (length, n, waves) = (1.0e-3, 16 + 2 * draws.below(30), draws.between(3.0, 8.0));
        let (periodic, share, seed) = (draws.chance(0.5), draws.scale(0.01, 0.2), draws.below(1000) as u64);
        let solve = |n: usize| {
            let grid = Grid::square(n, length).unwrap();
            let spec = RoughSpec::new(length, length / waves, Roughness::RmsSlope(0.05)).with_seed(seed);
            let rough = Rough::new(&grid, spec).unwrap();
            let shape: Box<dyn Geometry> =
                if periodic { Box::new(rough) } else { Box::new(Sum::new(Sphere::new(4.0e-3).unwrap(), rough)) };
            let builder = ViscoelasticContact::builder(grid.clone()).geometry(&*shape).material(elastic());
            let builder = match periodic {
                true => builder.kernel(InfluenceKernel::periodic(&grid).unwrap()),
                false => builder.settings(Settings::default().with_edge(Edge::Allow)),
            };
            let mut contact = builder.build().unwrap();
            let area = length * length * if periodic { 1.0 } else { 0.3 };
            let report = contact.step(0.0, Load::force(share * 4.0e6 * 0.05 * area)).unwrap();
            (report, contact)
        };
        let ((report, contact), (_, fine)) = (solve(n), solve(4 * n));
        let cells = few(&contact, |_| true);
        let name = format!("scene {number}: {report}");
        assert_same(&report, cells, &name);
        let errors = [error(contact.contact_area(), fine.contact_area()), error(contact.approach(), fine.approach())];
        let (count, greatest, sum) = &mut found[cells.map_or(2, |cells| usize::from(cells >= 4.0))];
        *count += 1;
        (0..2).for_each(|k| (greatest[k], sum[k]) = (greatest[k].max(errors[k]), sum[k] + errors[k]));
        assert!(errors.iter().all(|error| error.is_finite()), "{name}");
    }
    println!("below 4, few, enough: number, greatest and sum of the errors of area and approach: {found:?}");
    let [few, some, many] = found;
    assert!(few.0 > 3 && some.0 > 3 && many.0 > 3);
    // what the page says of eight cells, and of four
    assert!(many.1[0] < 0.05 && many.1[1] < 0.03 && some.1[0] < 0.1 && some.1[1] < 0.1, "{found:?}");
    let mean = |(count, _, sum): (i32, [f64; 2], [f64; 2])| sum.map(|sum| sum / f64::from(count));
    assert!((0..2).all(|k| mean(few)[k] > 3.0 * mean(many)[k]), "{found:?}");
}
