//! What a step of surfaces that attract each other costs. `ADHESION_CELLS` (64) and `ADHESION_WAVE` choose others.

use crate::common::environment::from_environment;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

#[test]
fn work_a_step() {
    let cells = from_environment("ADHESION_CELLS", 64) as usize;
    let rough = from_environment("ADHESION_ROUGH", 0) == 1;
    let force = from_environment("ADHESION_FORCE", 0) == 1;
    let creeping = from_environment("ADHESION_CREEP", 0) == 1;
    let side = from_environment("ADHESION_SIDE", 100) as f64 / 10.0;
    let mus = [1.0, 2.0, 3.0];
    let only = from_environment("ADHESION_ONLY", 0) as usize;
    for (i, mu) in mus.into_iter().enumerate() {
        if only > 0 && i + 1 != only {
            continue;
        }
        let shape = Sum::new(Sphere::new(1.0).unwrap(), Wavy::new(if rough { 0.1 } else { 1e-9 }, 2.0).unwrap());
        let material = if creeping {
            Material::incompressible(GeneralizedMaxwell::new(0.025, &[(0.225, 1.0)]).unwrap())
        } else {
            Material::incompressible(Elastic::new(0.25).unwrap())
        };
        let mut contact = ViscoelasticContact::builder(Grid::square(cells, side).unwrap())
            .geometry(&shape)
            .material(material)
            .attraction(ExponentialAttraction::new(1.0, 1.0 / mu).unwrap())
            .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(false))
            .build()
            .unwrap();
        let down = (0..=12).map(|k| -1.0 + 0.25 * f64::from(k));
        let path: Vec<f64> = down.chain((1..=48).map(|k| 2.0 - 0.125 * f64::from(k))).collect();
        let (mut work, mut passes) = (Vec::new(), Vec::new());
        for d in path {
            let load = if force { Load::force(3.0 * d) } else { Load::approach(d) };
            match contact.step(0.2, load) {
                Ok(report) => {
                    work.push(report.convolution_equivalents());
                    let own = contact.passes().unwrap();
                    passes.push(own.passes as f64);
                    println!(
                        "{d:.3} {:.4} {} eq {} passes {} rejected {} iterations {} jump {:.2}",
                        report.force, report.contact_cells, report.convolution_equivalents(), own.passes, own.rejected, report.iterations, own.response
                    );
                }
                Err(error) => {
                    println!("{d}: {error}");
                    break;
                }
            }
        }
        let total = work.iter().sum::<f64>();
        work.sort_by(f64::total_cmp);
        passes.sort_by(f64::total_cmp);
        println!(
            "μ {mu}: median {} 90 % {} total {total}; passes median {} 90% {}",
            work[work.len() / 2], work[work.len() * 9 / 10], passes[passes.len() / 2], passes[work.len() * 9 / 10]
        );
    }
}
