//! Balls that stick, in units of the relaxed E*, R and w.

use viscocontact::adhesion::Attraction;
use viscocontact::prelude::*;

pub fn elastic() -> Material {
    Material::incompressible(Elastic::new(0.25).unwrap())
}

/// A ball on a square of side `side`.
pub fn ball(cells: usize, side: f64, material: Material, law: impl Attraction + 'static) -> Builder {
    ViscoelasticContact::builder(Grid::square(cells, side).unwrap())
        .geometry(&Sphere::new(1.0).unwrap())
        .material(material)
        .attraction(law)
        .settings(Settings::default().with_edge(Edge::Allow))
}

/// The least force of a path of approaches and forces, by a parabola through the lowest three.
pub fn least(path: &[(f64, f64)]) -> f64 {
    let k = (1..path.len() - 1).min_by(|&i, &j| path[i].1.total_cmp(&path[j].1)).unwrap();
    let [(x0, y0), (x1, y1), (x2, y2)] = [path[k - 1], path[k], path[k + 1]];
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let bend = (second - first) / (x2 - x0);
    let x = 0.5 * (x0 + x1) - 0.5 * first / bend;
    y0 + first * (x - x0) + bend * (x - x0) * (x - x1)
}
