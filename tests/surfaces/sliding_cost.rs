//! What a steady motion costs, in pairs of transforms, and how it converges with the mesh. `SLIDING_COSTS` (8) random scenes of each kind, `SLIDING_ROAD` (256) the finest
//! mesh of a road, from an eighth or at least 64 cells a side on, `SLIDING_SEED` (1).

use std::f64::consts::TAU;

use crate::common::{Draws, Ratios, builder_of, figures, from_environment};
use viscocontact::geometry::{Rough, RoughSpec, Roughness};
use viscocontact::prelude::*;

/// A rough ball on a half-space of 128² cells, or a wavy cylinder on 512, of tan δ up to 4, or up to 10: cold, and then at speeds of a quarter of a decade from
/// one to the next.
#[test]
fn balls_and_cylinders_cost_few_transforms() {
    let (scenes, seed) = (from_environment("SLIDING_COSTS", 8), from_environment("SLIDING_SEED", 1));
    for (line, strongest) in [(false, 65.0), (true, 65.0), (false, 420.0), (true, 420.0)] {
        let (mut cold, mut warm) = (Ratios::default(), Ratios::default());
        for number in 0..scenes {
            let mut draws = Draws::new(11_000_000 * seed + number);
            let cells = if line { [512, 1] } else { [128, 128] };
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let waves: Vec<[f64; 4]> = (0..4)
                .map(|_| {
                    [draws.scale(2.0, 12.0), draws.between(-8.0, 8.0), draws.between(0.0, TAU), draws.scale(1e-5, 1e-3)]
                })
                .collect();
            let shape = FnGeometry::new(move |x1: f64, x2: f64| {
                let aside = if line { 0.0 } else { x2 };
                let wave = |[a, b, phase, h]: &[f64; 4]| h * (1.0 - (TAU * (a * x1 + b * aside) + phase).cos());
                0.05 * (x1 * x1 + aside * aside) + waves.iter().map(wave).sum::<f64>()
            });
            let count = 1 + draws.below(8);
            // C∞/C0 = 66 has tan δ = 4 with a single term, 420 has 10
            let strength = draws.scale(1.0, strongest);
            let terms: Vec<_> = (0..count).map(|_| (strength / count as f64 * 1e-6, draws.scale(1e-3, 1e3))).collect();
            let kernel =
                if line { InfluenceKernel::line(&grid, 1e4) } else { InfluenceKernel::half_space(&grid) }.unwrap();
            let relaxed = 0.25e-6 * (1.0 + strength);
            let load = Load::force(draws.scale(0.03, 0.3) * 5e-3 / relaxed);
            let mut sliding =
                builder_of(&shape, grid, Material::incompressible(GeneralizedKelvin::new(1e-6, 0.0, &terms).unwrap()))
                    .kernel(kernel)
                    .build_sliding()
                    .unwrap();
            let speed = draws.scale(1e-3, 1e2);
            for step in 0..3 {
                let velocity = [speed * 10_f64.powf(0.25 * f64::from(step)), 0.0];
                let report = match sliding.at(velocity, load) {
                    Ok(report) => report,
                    Err(Error::Step(StepError::ContactAtEdge { .. })) => break,
                    Err(error) => panic!("{number} line {line}: {error}"),
                };
                if step == 0 { &mut cold } else { &mut warm }.push(report.transforms as f64, "");
            }
        }
        assert!(2 * cold.count() as u64 >= scenes, "{}", cold.count());
        let [cold, warm] = [cold.median(), warm.median()];
        println!("line {line}, {strongest}: medians {cold} cold, {warm} warm");
        assert!(strongest > 65.0 || cold <= 150.0 && warm <= 60.0, "line {line}: {cold} {warm}");
    }
}

/// A rubber of 17 terms on a periodic road, the shortest wave eight cells long on the coarsest mesh: friction converges with the mesh in the second order or faster, and
/// the finest mesh costs at most twice the pairs of the coarsest.
#[test]
fn the_friction_of_a_road_converges_with_the_mesh() {
    let finest = from_environment("SLIDING_ROAD", 256) as usize;
    let times = (0..17).map(|k| 10_f64.powf(-7.0 + 0.5 * f64::from(k)));
    let all: f64 = times.clone().map(|time| time.powf(-0.25)).sum();
    let terms: Vec<_> = times.map(|time: f64| (99e6 * time.powf(-0.25) / all, time)).collect();
    let coarsest = (finest / 8).max(64);
    let spec = RoughSpec::new(5e-4, 8e-3 / coarsest as f64, Roughness::RmsSlope(0.2)).with_seed(1);
    // one surface on all meshes: its waves are those of the coarsest
    let road = Rough::new(&Grid::square(64, 1e-3).unwrap(), spec).unwrap();
    let mut results: Vec<(usize, Vec<(f64, usize)>)> = Vec::new();
    let mut cells = coarsest;
    while cells <= finest {
        let grid = Grid::square(cells, 1e-3).unwrap();
        let mut sliding =
            builder_of(&road, grid.clone(), Material::incompressible(GeneralizedMaxwell::new(1e6, &terms).unwrap()))
                .kernel(InfluenceKernel::periodic(&grid).unwrap())
                .build_sliding()
                .unwrap();
        let speeds = (0..9).map(|k| 100.0 * 10_f64.powi(-k));
        let at = |speed: f64| {
            let report = sliding.at([speed, 0.0], Load::force(0.1)).unwrap();
            (report.friction(), report.transforms)
        };
        results.push((cells, speeds.map(at).collect()));
        println!("{cells}²: {:?}", results[results.len() - 1].1);
        cells *= 2;
    }
    let warm = |own: &[(f64, usize)]| own[1..].iter().map(|(_, pairs)| *pairs as f64).collect::<Ratios>().median();
    let (first, last) = (warm(&results[0].1), warm(&results[results.len() - 1].1));
    let most = results.iter().map(|(_, own)| warm(own)).fold(0.0, f64::max);
    println!("pairs a speed, warm: {first} on the coarsest mesh, {last} on the finest, at most {most}");
    assert!(most <= 300.0 && last <= 2.0 * first, "{first} {last} {most}");
    let changes: Vec<f64> = results
        .windows(2)
        .map(|two| {
            let each = two[0].1.iter().zip(&two[1].1).map(|((coarse, _), (fine, _))| (fine / coarse - 1.0).abs());
            each.sum::<f64>() / 9.0
        })
        .collect();
    let order = (changes[0] / changes[changes.len() - 1]).log2() / (changes.len() - 1) as f64;
    println!("friction changes by {changes:?} from mesh to mesh, order {order}");
    assert!(
        changes.len() > 1 && changes.windows(2).all(|two| two[1] < (0.7 * two[0]).max(1e-3)) && order > 2.0,
        "{changes:?} {order}"
    );
    if finest == 1024 {
        let each: Vec<_> = changes.iter().map(|change| format!("{:.3}", 100.0 * change)).collect();
        figures::figure("friction of a road over the mesh", &format!("{} %", each.join(", "))).unwrap();
    }
}
