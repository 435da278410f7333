//! Indentation of layers, against the integral equation of the axisymmetric contact.
//!
//! With p̂(q) = 2π ∫ p J0(qr) r dr = ∫₀ᵃ φ(s) cos(qs) ds there is no pressure beyond a, and the displacement of a rigid
//! body of revolution in contact asks for (Lebedev & Ufliand, PMM 22, 1958)
//!
//! φ(x) + ∫₀ᵃ φ(s) [H(x − s) + H(x + s)] ds = f(x),   H(y) = (1/π) ∫ (L(qh) − 1) cos(qy) dq,
//!
//! f = 2E*δ for a flat punch and 2E*(δ − x²/R) for a paraboloid, whose pressure ends smoothly where φ(a) = 0. The
//! force is ∫₀ᵃ φ ds. L is the textbook's fraction here, nothing is shared with the crate.

use crate::common::{builder_of, figures, gauss};
use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::rolling::eliminate;
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;

/// L − 1 of a layer bonded to a rigid base, ν.
fn bonded(nu: f64) -> impl Fn(f64) -> f64 {
    let k = 3.0 - 4.0 * nu;
    move |t: f64| {
        let (sinh, cosh) = ((2.0 * t).sinh(), (2.0 * t).cosh());
        (2.0 * k * sinh - 4.0 * t) / (2.0 * k * cosh + k * k + 1.0 + 4.0 * t * t) - 1.0
    }
}

/// Of one that slides on a rigid base.
fn frictionless(t: f64) -> f64 {
    if t < 1e-6 { 0.5 * t - 1.0 } else { ((2.0 * t).cosh() - 1.0) / ((2.0 * t).sinh() + 2.0 * t) - 1.0 }
}

/// φ for several right-hand sides on a contact of radius a = 1, at the points of a rule and at its edge.
struct Equation {
    points: Vec<(f64, f64)>,
    matrix: Vec<Vec<f64>>,
}

impl Equation {
    fn new(less: impl Fn(f64) -> f64, thickness: f64) -> Equation {
        let points: Vec<(f64, f64)> = gauss::points(0.0, 1.0, 4).collect();
        let waves = gauss::points(0.0, 18.0, 80).map(|(t, w)| (t / thickness, w * less(t) / (PI * thickness)));
        let waves: Vec<(f64, f64)> = waves.collect();
        let h = |y: f64| waves.iter().map(|(q, w)| w * (q * y).cos()).sum::<f64>();
        let places: Vec<f64> = points.iter().map(|point| point.0).chain([1.0]).collect();
        let matrix = places.iter().map(|x| points.iter().map(|(s, w)| w * (h(x - s) + h(x + s))).collect()).collect();
        Equation { points, matrix }
    }

    /// Force and φ(a) for a right-hand side.
    fn solve(&self, right: impl Fn(f64) -> f64) -> [f64; 2] {
        let n = self.points.len();
        let rows = (0..n)
            .map(|i| {
                let mut row = self.matrix[i].clone();
                row[i] += 1.0;
                row.push(right(self.points[i].0));
                row
            })
            .collect();
        let phi = eliminate(rows);
        let force = self.points.iter().zip(&phi).map(|((_, w), phi)| w * phi).sum();
        let edge = right(1.0) - self.matrix[n].iter().zip(&phi).map(|(k, phi)| k * phi).sum::<f64>();
        [force, edge]
    }

    /// P/(2E*aδ) of a flat punch.
    fn punch(&self) -> f64 {
        self.solve(|_| 1.0)[0]
    }

    /// δR/a² and PR/(E*a³) of a paraboloid.
    fn paraboloid(&self) -> [f64; 2] {
        let ([one, edge_of_one], [square, edge_of_square]) = (self.solve(|_| 2.0), self.solve(|x| -2.0 * x * x));
        let depth = -edge_of_square / edge_of_one;
        [depth, depth * one + square]
    }
}

fn elastic(nu: f64) -> Material {
    Material::constant_poisson(Elastic::new(1.0e6).unwrap(), nu).unwrap()
}

fn creeping(nu: f64) -> Material {
    Material::constant_poisson(Zener::with_time(1.0e6, 1.0e6, 2.0).unwrap(), nu).unwrap()
}

/// A body pressed on a layer, E* = 1/C.
fn press(layer: Layer, shape: &dyn Geometry, cells: usize, length: f64, load: Load) -> ViscoelasticContact {
    let grid = Grid::square(cells, length).unwrap();
    let kernel = Arc::new(InfluenceKernel::layer(&grid, layer).unwrap());
    let mut contact = builder_of(shape, grid, elastic(layer.poisson_ratio()))
        .kernel(kernel)
        .settings(Settings::default().with_tolerance(1e-7))
        .build()
        .unwrap();
    contact.step(0.0, load).unwrap();
    contact
}

/// A layer on a rigid base and its equation, the contact being `ratio` times as wide as the layer is thick.
fn layer(h: f64, nu: f64, ratio: f64, is_bonded: bool) -> (Layer, Equation) {
    if is_bonded {
        (Layer::bonded_to_rigid(h, nu).unwrap(), Equation::new(bonded(nu), 1.0 / ratio))
    } else {
        (Layer::frictionless_on_rigid(h, nu).unwrap(), Equation::new(frictionless, 1.0 / ratio))
    }
}

#[test]
fn the_reference_has_the_published_values() {
    for (nu, ratio, published) in [(0.5, 0.2, 1.28064), (0.5, 1.0, 3.61874), (0.5, 2.0, 9.14945), (0.3, 1.0, 2.48352)] {
        let found = Equation::new(bonded(nu), 1.0 / ratio).punch();
        assert!((found - published).abs() < 1e-5, "ν = {nu}, a/h = {ratio}: {found}");
    }
    let [depth, force] = Equation::new(bonded(0.5), 1.0).paraboloid();
    assert!((depth.sqrt() - 0.747941).abs() < 1e-6 && (0.75 * force - 1.410500).abs() < 1e-6, "{depth} {force}");
    // thick: Hertz, and a punch
    let thick = Equation::new(bonded(0.3), 1e6);
    let [depth, force] = thick.paraboloid();
    assert_abs_diff_eq!([depth, 0.75 * force, thick.punch()][..], [1.0; 3][..], epsilon = 1e-5);
}

#[test]
fn flat_punches_on_layers_agree_with_the_integral_equation() {
    let radius = 1.0e-3;
    let cases =
        [(0.5, 0.2, true), (0.5, 1.0, true), (0.5, 2.0, true), (0.3, 1.0, true), (0.0, 3.0, true), (0.4, 1.0, false)];
    for (nu, ratio, is_bonded) in cases {
        let h = radius / ratio;
        let (layer, equation) = layer(h, nu, ratio, is_bonded);
        let punch = FlatPunch::circular(radius).unwrap();
        let contact = press(layer, &punch, 256, 2.04 * radius, Load::approach(1.0e-6));
        let modulus = 1.0 / elastic(nu).contact_compliance(0.0);
        let error = contact.force() / (2.0 * modulus * radius * 1.0e-6) / equation.punch() - 1.0;
        println!("punch, ν = {nu}, a/h = {ratio}: {error:e}");
        assert!(error.abs() < 5e-3, "ν = {nu}, a/h = {ratio}: {error:e}");
    }
}

#[test]
fn balls_on_layers_agree_with_the_integral_equation() {
    let (radius, a) = (10.0e-3, 0.2e-3);
    for (nu, ratio, is_bonded) in
        [(0.5, 1.0, true), (0.5, 0.1, true), (0.5, 3.0, true), (0.3, 2.0, true), (0.2, 1.0, false)]
    {
        let h = a / ratio;
        let (layer, equation) = layer(h, nu, ratio, is_bonded);
        let [depth, force] = equation.paraboloid();
        let ball = Sphere::new(radius).unwrap();
        let contact = press(layer, &ball, 128, 2.3 * a, Load::approach(depth * a * a / radius));
        let modulus = 1.0 / elastic(nu).contact_compliance(0.0);
        let error = contact.force() / (force * modulus * a * a * a / radius) - 1.0;
        let area = contact.contact_area() / (PI * a * a) - 1.0;
        println!("ball, ν = {nu}, a/h = {ratio}: {error:e}, area {area:e}");
        assert!(error.abs() < 1e-3 && area.abs() < 1e-2, "ν = {nu}, a/h = {ratio}: {error:e} {area:e}");
    }
}

/// A ball on a layer much thinner than the contact is wide: on springs, δ = a²/2R and P = π R δ²/(C K) with the
/// compliance K of long waves; on an incompressible one bonded to its base the layer is squeezed out, u = −(4/3) C h³
/// ∇²p, p ∝ (a² − r²)², and P = π R² δ³/(2 C h³).
#[test]
fn thin_layers_are_springs_or_squeezed() {
    let (radius, a) = (10.0e-3, 0.2e-3);
    let force = |layer: Layer, cells: usize, depth: f64| {
        let ball = Sphere::new(radius).unwrap();
        let contact = press(layer, &ball, cells, 2.6 * a, Load::approach(depth));
        contact.force() * elastic(layer.poisson_ratio()).contact_compliance(0.0)
    };
    let springs = |ratio: f64| {
        let (layer, depth) = (Layer::bonded_to_rigid(a / ratio, 0.2).unwrap(), 0.5 * a * a / radius);
        force(layer, 128, depth) * layer.compliance(0.0) / (PI * radius * depth * depth) - 1.0
    };
    let squeezed = |ratio: f64| {
        let (h, depth) = (a / ratio, 0.25 * a * a / radius);
        let exact = PI * radius * radius * depth.powi(3) / (2.0 * h.powi(3));
        force(Layer::bonded_to_rigid(h, 0.5).unwrap(), 128, depth) / exact - 1.0
    };
    let (few, many) = ([springs(5.0), springs(10.0), springs(20.0)], [squeezed(5.0), squeezed(10.0), squeezed(20.0)]);
    println!("springs {few:?}, squeezed {many:?}");
    for errors in [few, many] {
        let order = (errors[1] / errors[2]).log2();
        assert!(errors[2].abs() < errors[1].abs() && (1.6..2.3).contains(&order), "{errors:?}: {order}");
    }
}

/// As the contact grows, the approach at any time equals the approach of an elastic layer with the compliance of that time (Lee
/// & Radok 1960), of any thickness; on a thin compressible layer δ² ∝ C(t).
#[test]
fn a_ball_sinks_into_a_creeping_layer() {
    let (radius, a, nu) = (10.0e-3, 0.2e-3, 0.3);
    let material = creeping(nu);
    for ratio in [1.0, 20.0] {
        let layer = Layer::bonded_to_rigid(a / ratio, nu).unwrap();
        let grid = Grid::square(128, 2.8 * a).unwrap();
        let kernel = Arc::new(InfluenceKernel::layer(&grid, layer).unwrap());
        let builder = builder_of(&Sphere::new(radius).unwrap(), grid, material.clone()).kernel(kernel);
        let contact = |material: Material| builder.clone().material(material).build().unwrap();
        let force = {
            let modulus = 1.0 / material.contact_compliance(0.0);
            Equation::new(bonded(nu), 1.0 / ratio).paraboloid()[1] * modulus * a * a * a / radius
        };
        let mut creeping = contact(material.clone());
        creeping.step(0.0, Load::force(force)).unwrap();
        let first = creeping.approach();
        for _ in 0..40 {
            creeping.step(0.05, Load::force(force)).unwrap();
        }
        let ratio_of_compliances = material.contact_compliance(2.0) / material.contact_compliance(0.0);
        let mut elastic = contact(elastic(nu));
        let softer = force * material.contact_compliance(2.0) / self::elastic(nu).contact_compliance(0.0);
        elastic.step(0.0, Load::force(softer)).unwrap();
        let error = creeping.approach() / elastic.approach() - 1.0;
        println!("a/h = {ratio}: {error:e}, δ(t)/δ(0) {}", creeping.approach() / first);
        assert!(error.abs() < 1e-3, "a/h = {ratio}: {error:e}");
        if ratio > 10.0 {
            let springs = creeping.approach() / first / ratio_of_compliances.sqrt() - 1.0;
            assert!(springs.abs() < 1e-2, "{springs:e}");
        }
    }
}

/// The work of the solver on layers, thick and thin, compressible or not, against that on a half-space.
#[test]
fn layers_take_at_most_half_as_many_convolutions_again_as_a_half_space() {
    let (radius, a) = (10.0e-3, 0.2e-3);
    let work = |kernel: fn(&Grid, f64) -> Result<InfluenceKernel, Error>, nu: f64, h: f64, wavy: bool| {
        let grid = Grid::square(128, 2.6 * a).unwrap();
        let ball = Sphere::new(radius).unwrap();
        let ripples = FnGeometry::new(move |x1: f64, x2: f64| {
            (x1 * x1 + x2 * x2) / (2.0 * radius) + 2e-8 * ((x1 / a * 9.0).cos() * (x2 / a * 11.0).cos() + 1.0)
        });
        let shape: &dyn Geometry = if wavy { &ripples } else { &ball };
        let kernel = kernel(&grid, h).unwrap();
        let mut contact = builder_of(shape, grid, creeping(nu)).kernel(kernel).build().unwrap();
        // to the same contact, wherever the layer ends
        let loads = (0..12).map(|k| Load::approach(a * a / radius * (0.25 + 0.01 * f64::from(k))));
        loads.map(|load| contact.step(0.05, load).unwrap().convolution_equivalents()).sum::<f64>()
    };
    // thick and medium layers; thin layers on rigid and stiff bases; thin layers on soft bases
    let mut ranges = [[f64::INFINITY, 0.0]; 3];
    for wavy in [false, true] {
        let half_space = work(|grid, _| InfluenceKernel::half_space(grid), 0.5, 1.0, wavy);
        println!("half-space {half_space}");
        for (name, nu, make) in [
            (
                "bonded",
                0.5,
                (|grid, h| InfluenceKernel::layer(grid, Layer::bonded_to_rigid(h, 0.5)?)) as fn(&Grid, f64) -> _,
            ),
            ("bonded", 0.3, |grid, h| InfluenceKernel::layer(grid, Layer::bonded_to_rigid(h, 0.3)?)),
            ("frictionless", 0.5, |grid, h| InfluenceKernel::layer(grid, Layer::frictionless_on_rigid(h, 0.5)?)),
            ("stiff base", 0.5, |grid, h| {
                InfluenceKernel::layer(grid, Layer::bonded_to_half_space(h, 0.5, 0.05, 0.3)?)
            }),
            ("soft base", 0.3, |grid, h| InfluenceKernel::layer(grid, Layer::bonded_to_half_space(h, 0.3, 20.0, 0.3)?)),
        ] {
            for ratio in [0.2, 1.0, 3.0, 10.0] {
                let found = work(make, nu, a / ratio, wavy) / half_space;
                println!("{name}, ν = {nu}, a/h = {ratio}, wavy {wavy}: {found:.2}");
                assert!(found < 1.5, "{name}, ν = {nu}, a/h = {ratio}, wavy {wavy}: {found:.2}");
                let [least, most] = &mut ranges[if ratio <= 3.0 { 0 } else { 1 + usize::from(name == "soft base") }];
                (*least, *most) = (least.min(found), most.max(found));
            }
        }
    }
    let [thick, thin, soft] = ranges.map(|[least, most]| format!("{least:.2} to {most:.2}"));
    figures::figure("work on layers", &thick).unwrap();
    figures::figure("work on thin layers", &thin).unwrap();
    figures::figure("work on thin layers on soft bases", &soft).unwrap();
}

/// A wave pressed flat onto a creeping layer, the grid being its period: ω = A + C(t) K̄ p̄, and the pressure swings by
/// A R(t)/K̂(q) about its mean, R being the relaxation that belongs to C.
#[test]
fn a_wave_in_full_contact_with_a_creeping_layer_is_the_closed_form() {
    let (length, amplitude, mean) = (1.0e-3, 1.0e-7, 2.0e3);
    let grid = Grid::new([64, 4], [length, length / 16.0]).unwrap();
    let q = 2.0 * PI / length;
    for layer in [Layer::bonded_to_rigid(0.3e-3, 0.3).unwrap(), Layer::frictionless_on_rigid(0.3e-3, 0.3).unwrap()] {
        let material = Material::constant_poisson(Zener::with_time(1.0e6, 0.5e6, 1.0).unwrap(), 0.3).unwrap();
        let mut contact = builder_of(&Wavy::new(amplitude, length).unwrap(), grid.clone(), material.clone())
            .kernel(InfluenceKernel::layer_periodic(&grid, layer).unwrap())
            .settings(Settings::default().with_tolerance(1e-10))
            .build()
            .unwrap();
        let area = grid.lengths()[0] * grid.lengths()[1];
        let load = StepLoad::new(Load::force(mean * area)).unwrap();
        let mut run = contact.follow(&load, Stepping::adaptive(1e-6), 2.0);
        while let Some(report) = run.next_step().unwrap() {
            let c = material.contact_compliance(report.time);
            let approach = amplitude + c * layer.compliance(0.0) * mean;
            let what = format!("{layer} at {} s", report.time);
            assert!((report.approach / approach - 1.0).abs() < 3e-6, "{what}: {:e}", report.approach);
            // C₀ = 0.35, C∞ = 1.05 per MPa, λ = 1 s: the relaxation time is λ C₀/C∞
            let relaxed = (1.0 + 2.0 * (-3.0 * report.time).exp()) / 1.05e-6;
            // the cells next to the crest lie half a cell off it
            let crest = mean + amplitude * relaxed / layer.compliance(q) * (0.5 * q * grid.spacing()[0]).cos();
            let pressure = run.contact().fields().max_pressure();
            assert!((pressure / crest - 1.0).abs() < 3e-6, "{what}: {pressure:e}, expected {crest:e}");
            assert_eq!(report.contact_cells, grid.len());
        }
    }
}
