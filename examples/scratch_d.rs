use viscocontact::contact::Warnings;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
fn main() -> viscocontact::Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let seeds: u64 = args.get(1).map_or(2, |s| s.parse().unwrap());
    let fine: usize = args.get(2).map_or(512, |s| s.parse().unwrap());
    let period = 1.0e-3;
    for seed in 0..seeds {
        for waves in [4.0, 8.0, 16.0] {
            for kind in 0..2 {
                for pbar in [0.003, 0.01, 0.03, 0.1] {
                    let mut rows = Vec::new();
                    for n in [fine, fine / 2, 16, 24, 32, 48, 64, 96, 128] {
                        if (n as f64) < 2.0 * waves {
                            continue;
                        }
                        let grid = Grid::square(n, period)?;
                        let spec = RoughSpec::new(period, period / waves, Roughness::RmsSlope(0.1)).with_seed(seed);
                        let rough = Rough::new(&grid, spec)?;
                        let body = Material::incompressible(Elastic::new(1.0e6)?);
                        let shape: Box<dyn Geometry> =
                            if kind == 0 { Box::new(rough) } else { Box::new(Sum::new(Sphere::new(2.0e-3)?, rough)) };
                        let builder = ViscoelasticContact::builder(grid.clone()).geometry(&*shape).material(body);
                        let builder = if kind == 0 {
                            builder.kernel(InfluenceKernel::periodic(&grid)?)
                        } else {
                            builder.settings(Settings::default().with_edge(Edge::Allow))
                        };
                        let mut contact = builder.build()?;
                        let area = if kind == 0 { period * period } else { 0.3 * period * period };
                        let r = contact.step(0.0, Load::force(pbar * 4.0e6 * 0.1 * area))?;
                        let patches = contact.patches()?.all;
                        let mut sizes: Vec<usize> = patches.iter().map(|p| p.cells).collect();
                        sizes.sort();
                        let mut by_cells: Vec<usize> = sizes.iter().flat_map(|&s| std::iter::repeat_n(s, s)).collect();
                        by_cells.sort();
                        rows.push((
                            n,
                            contact.contact_area(),
                            contact.approach(),
                            contact.contact_cells(),
                            sizes.len(),
                            sizes[sizes.len() / 2],
                            by_cells[by_cells.len() / 2],
                            r.figures.cells_across,
                            r.warnings.contains(Warnings::FEW_CELLS),
                            contact.mesh_error()?,
                            contact.max_pressure(),
                        ));
                    }
                    let (a, w, p) = (rows[0].1, rows[0].2, rows[0].10);
                    for (n, area, approach, cells, count, median, weighted, across, few, mesh, pm) in
                        rows.iter().skip(1)
                    {
                        println!(
                            "{seed} {waves} k{kind} {pbar} n {n} cells/wave {:.1} patches {count} cells {cells} median {median} weighted {weighted} across {:.2} few {few} | area {:+.4} approach {:+.4} peak {:+.3} | est {:.1e} {:.1e}",
                            *n as f64 / waves,
                            across.unwrap_or(99.0),
                            area / a - 1.0,
                            approach / w - 1.0,
                            pm / p - 1.0,
                            mesh.map_or(9.0, |m| m.area),
                            mesh.map_or(9.0, |m| m.approach)
                        );
                    }
                }
            }
        }
    }
    Ok(())
}
