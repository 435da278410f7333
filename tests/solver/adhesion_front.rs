//! Does every step end while the edge of a contact runs? A flat punch is pulled off a thin bonded layer, which holds it until the edge runs over all
//! cells within a step. `ADHESION_FRONT` (512) chooses the number of cells.

use crate::common::environment::from_environment;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::prelude::*;

const SIDE: f64 = 3.0;
const WORK: f64 = 0.1;
/// Cells in the zone in which the attraction acts, E* ρ²/w.
const IN_ZONE: f64 = 6.0;

/// The approach at which the punch is apart, and the iterations and the work of each step, sorted.
fn pull_off(
    cells: usize,
    kernel: &dyn Fn(&Grid, Layer) -> Result<InfluenceKernel, Error>,
) -> (f64, Vec<usize>, Vec<f64>) {
    let grid = Grid::new([cells, 1], [SIDE, 1.0]).unwrap();
    let layer = Layer::bonded_to_rigid(0.2, 0.0).unwrap();
    let range = (IN_ZONE * SIDE / cells as f64 * WORK).sqrt();
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&FlatPunch::rectangular([2.0, 1.0]).unwrap())
        .kernel(kernel(&grid, layer).unwrap())
        .material(Material::constant_poisson(Elastic::new(0.5).unwrap(), 0.0).unwrap())
        .attraction(ExponentialAttraction::new(WORK, range).unwrap())
        .build()
        .unwrap();
    contact.step(1.0, Load::approach(0.0)).unwrap();
    let (mut passes, mut work) = (Vec::new(), Vec::new());
    loop {
        let approach = contact.approach() - 0.002;
        let report = contact.step(1.0, Load::approach(approach)).unwrap();
        passes.push(contact.passes().unwrap().passes);
        work.push(report.convolution_equivalents());
        if report.contact_cells == 0 {
            passes.sort_unstable();
            work.sort_by(f64::total_cmp);
            return (approach, passes, work);
        }
        assert!(approach > -0.3, "{cells} cells still touch at {approach}");
    }
}

#[test]
fn an_edge_that_runs_ends() {
    let cells = from_environment("ADHESION_FRONT", 512) as usize;
    let line = |grid: &Grid, layer: Layer| InfluenceKernel::layer_line(grid, layer, None);
    let periodic = |grid: &Grid, layer: Layer| InfluenceKernel::layer_periodic(grid, layer);
    for (name, (apart, passes, work)) in [("periodic", pull_off(cells, &periodic)), ("line", pull_off(cells, &line))] {
        let most = passes[passes.len() - 1];
        println!(
            "{cells} cells, {name}: apart at {apart:.3}; passes: median {}, most {most}; equivalents: all {:.0}, most {}",
            passes[passes.len() / 2],
            work.iter().sum::<f64>(),
            work[work.len() - 1]
        );
        assert!((-0.21..-0.19).contains(&apart), "{name}: {apart}");
    }
}
