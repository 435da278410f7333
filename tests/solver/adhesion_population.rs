//! Random scenes of surfaces that attract each other: every step ends, its energy falls from pass to pass, and its state satisfies the equations,
//! found from its fields alone. `ADHESION_SCENES` (20), `ADHESION_SEED` (1) and `ADHESION_TABOR` (12, tenths of the greatest Tabor number)
//! choose others.

use std::sync::Arc;

use crate::common::{Draws, builder_of, fields, from_environment};
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction, LinearSoftening, VanDerWaals};
use viscocontact::contact::StepError;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

pub(super) const SIDE: f64 = 8.0;

pub(super) fn law(draws: &mut Draws, range: f64) -> Arc<dyn Attraction> {
    match draws.below(4) {
        0 | 1 => Arc::new(ExponentialAttraction::new(1.0, range).unwrap()),
        2 => Arc::new(VanDerWaals::new(1.0, range).unwrap()),
        _ if draws.chance(0.5) => Arc::new(LinearSoftening::new(1.0, range).unwrap()),
        _ => Arc::new(Dugdale::new(1.0, range).unwrap().with_width(0.5).unwrap()),
    }
}

/// Six waves of up to `most` periods along each axis of the side, with heights between two.
pub(super) fn rough(draws: &mut Draws, side: f64, most: usize, [low, high]: [f64; 2]) -> impl Geometry + use<> {
    let waves: Vec<[f64; 4]> = (0..6)
        .map(|_| {
            let [a, b] = [0, 1].map(|_| draws.below(2 * most + 1) as f64 - most as f64);
            [a, b, draws.between(low, high), draws.between(0.0, 6.0)]
        })
        .collect();
    FnGeometry::new(move |x: f64, y: f64| {
        let turn = std::f64::consts::TAU / side;
        waves.iter().map(|[a, b, height, phase]| height * (turn * (a * x + b * y) + phase).cos()).sum::<f64>()
    })
}

/// Another shape than a ball, in most scenes; `low` are waves that periodic bodies close over.
fn shape(draws: &mut Draws, low: bool) -> Option<Box<dyn Geometry>> {
    match draws.below(5) {
        _ if low => Some(Box::new(rough(draws, SIDE, 2, [0.01, 0.06]))),
        0 | 1 => None,
        2 => Some(Box::new(FlatPunch::circular(draws.between(1.0, 2.5)).unwrap())),
        _ => Some(Box::new(rough(draws, SIDE, 2, [0.1, 0.5]))),
    }
}

/// A body that creeps in such a share of all draws, and whether it does.
fn material(draws: &mut Draws, share: f64) -> (bool, Material) {
    let creeping = draws.chance(share);
    let terms: Vec<_> = (0..1 + draws.below(3)).map(|_| (draws.scale(0.05, 2.0), draws.scale(0.1, 10.0))).collect();
    let rheology: Box<dyn Rheology> = match creeping {
        false => Box::new(Elastic::new(0.25).unwrap()),
        true => Box::new(GeneralizedMaxwell::new(0.25, &terms).unwrap()),
    };
    (creeping, Material::incompressible(rheology))
}

/// Ranges and shares of scenes.
pub(super) struct Drawn {
    pub side: f64,
    pub tabor: [f64; 2],
    /// Of the waves on half of the balls: their heights, and how many there are along the side.
    pub heights: [f64; 2],
    pub waves: [f64; 2],
    pub creeping: f64,
    pub periodic: f64,
}

/// A ball on a mesh that resolves the zone of its attraction, before its load.
pub(super) struct Scene {
    pub name: String,
    pub law: Arc<dyn Attraction>,
    pub shape: Box<dyn Geometry>,
    pub material: Material,
    pub creeping: bool,
    pub kernel: Arc<InfluenceKernel>,
    pub periodic: bool,
}

impl Scene {
    pub fn draw(draws: &mut Draws, drawn: &Drawn) -> Scene {
        let Drawn { side, tabor, heights, waves, .. } = *drawn;
        let mu = draws.scale(tabor[0], tabor[1]);
        let law = law(draws, 1.0 / mu);
        let (creeping, material) = material(draws, drawn.creeping);
        let wavy = Wavy::new(draws.between(heights[0], heights[1]), side / draws.between(waves[0], waves[1])).unwrap();
        let sphere = Sphere::new(1.0).unwrap();
        let shape: Box<dyn Geometry> =
            if draws.chance(0.5) { Box::new(sphere) } else { Box::new(Sum::new(sphere, wavy)) };
        let cells = (2.0 * (2.2 * side * mu * mu).ceil()).max(24.0) as usize;
        let (grid, periodic) = (Grid::square(cells, side).unwrap(), draws.chance(drawn.periodic));
        let kernel = if periodic { InfluenceKernel::periodic(&grid) } else { InfluenceKernel::half_space(&grid) };
        let name = format!("μ = {mu:.2}, {cells}², {law:?}, creeping {creeping}, periodic {periodic}");
        Scene { name, law, shape, material, creeping, kernel: Arc::new(kernel.unwrap()), periodic }
    }

    pub fn build(&self, settings: Settings) -> ViscoelasticContact {
        builder_of(&*self.shape, self.kernel.grid().clone(), self.material.clone())
            .kernel(Arc::clone(&self.kernel))
            .attraction(Arc::clone(&self.law))
            .settings(settings.with_edge(Edge::Allow))
            .build()
            .unwrap()
    }
}

/// The state satisfies the equations of a step.
pub(super) fn check(name: &str, contact: &ViscoelasticContact, law: &dyn Attraction, elastic: bool) {
    let cells = contact.grid().len();
    let (traction, gap) = (fields::traction(contact.fields()), fields::gap(contact.fields()));
    let (greatest, range) = (law.traction(0.0), law.range());
    for k in (0..cells).filter(|&k| gap[k].is_finite()) {
        let (z, h) = (contact.pressure()[k], gap[k]);
        assert!(z >= 0.0 && h > -1e-3 * range, "{name}, cell {k}: pressure {z}, gap {h}");
        assert!(z == 0.0 || h.abs() < 1e-3 * range, "{name}, cell {k}: pressure {z}, gap {h}");
        let s = law.traction(if z > 0.0 { 0.0 } else { h.max(0.0) });
        assert!((z - traction[k] - s).abs() < 1e-3 * greatest, "{name}, cell {k}: {} in place of {s}", z - traction[k]);
    }
    let force = traction.iter().sum::<f64>() * contact.grid().cell_area();
    assert!((force - contact.force()).abs() < 1e-9 * (greatest * SIDE * SIDE), "{name}: {force} {}", contact.force());
    if let Load::Spring { stiffness, drive, .. } = contact.fields().load() {
        let (balance, scale) =
            (stiffness * (drive - contact.approach()), traction.iter().map(|q| q.abs()).sum::<f64>());
        let rounding = 1e-14 * stiffness * (drive.abs() + contact.approach().abs());
        let off = (force - balance).abs();
        assert!(off < 1e-9 * scale * contact.grid().cell_area() + rounding, "{name}: {force} {balance}");
    }
    if elastic {
        let mut image = vec![0.0; cells];
        contact
            .fields()
            .kernel()
            .convolve(&traction, &mut image, &mut contact.fields().kernel().workspace().unwrap())
            .unwrap();
        let most = image.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        for (v, u) in image.iter().zip(contact.fields().displacement()) {
            // bodies apart keep the rounding of earlier steps
            assert!((v - u).abs() < 1e-4 * most + 1e-12, "{name}: {v} {u}");
        }
    }
}

#[test]
fn random_scenes() {
    let scenes = from_environment("ADHESION_SCENES", 20);
    let (seed, tabor) = (from_environment("ADHESION_SEED", 1), from_environment("ADHESION_TABOR", 12) as f64 / 10.0);
    let (mut passes, mut most, mut worst, mut work) = (0, 0, 0.0f64, Vec::new());
    let (mut pulled, mut apart, mut full) = (0, 0, 0);
    for number in 0..scenes {
        let mut draws = Draws::new(1000 * seed + number);
        let closes = number % 5 == 0;
        let periodic = if closes { 1.0 } else { 0.4 };
        let (heights, waves) = ([0.05, 0.5], [3.0, 6.0]);
        let drawn = Drawn { side: SIDE, tabor: [0.1, tabor], heights, waves, creeping: 0.6, periodic };
        let scene = Scene::draw(&mut draws, &drawn);
        let scene = match shape(&mut draws, closes) {
            Some(shape) => Scene { shape, ..scene },
            None => scene,
        };
        let (kind, step, stiffness) = (number % 3, draws.scale(0.05, 5.0), draws.scale(0.5, 1e5));
        let name = format!("scene {number}: {:?}, {}, load {kind} ({stiffness:.1})", scene.shape, scene.name);
        let mut contact = scene.build(Settings::default());
        let touch = contact.approach();
        for k in 0..16 {
            let course = f64::from(k) / 15.0;
            let down = if course < 0.3 { course / 0.3 } else { 1.0 - 2.5 * (course - 0.3) };
            let load = match kind {
                0 => Load::approach(touch + 0.8 * down - 0.2),
                1 => Load::spring(stiffness, touch + 1.5 * down - 0.3),
                _ => Load::force(if down > 0.0 { 4.0 * down } else { 10.0 * down }),
            };
            match contact.step(step, load) {
                Ok(report) => {
                    let own = contact.passes().unwrap();
                    check(&format!("{name}, step {k}"), &contact, &*scene.law, !scene.creeping);
                    (passes, most, worst) = (passes + own.passes, most.max(own.passes), worst.max(own.rise));
                    work.push(report.convolution_equivalents());
                    apart += usize::from(report.contact_cells == 0);
                    full += usize::from(report.contact_cells == contact.grid().len());
                    assert!(own.rise < 1e-6, "{name}, step {k}: {own:?}");
                }
                Err(Error::PulledOff { .. }) if kind == 2 && down < 0.0 => {
                    pulled += 1;
                    break;
                }
                // full contact of a periodic body has no greater approach
                Err(Error::Step(StepError::BeyondFullContact { .. })) if scene.periodic => break,
                Err(error) => panic!("{name}, step {k}: {error}"),
            }
        }
    }
    work.sort_by(f64::total_cmp);
    let quantile = |part: f64| work[(part * (work.len() - 1) as f64) as usize];
    println!(
        "{scenes} scenes, {} steps, {apart} apart, {full} in full contact, {pulled} pulled off; {passes} passes, at most {most} in a step; energy rises {worst:.1e}; \
         convolution equivalents of a step: median {}, 90 % {}, most {}",
        work.len(),
        quantile(0.5),
        quantile(0.9),
        quantile(1.0)
    );
    assert!(pulled > 0 && apart > 0 && full > 0, "{pulled} {apart} {full}");
}

/// Punches with wavy faces that tilt freely, under forces, approaches and springs: every step ends in a state that satisfies the equations, and
/// its moment about the point where the load acts vanishes. `ADHESION_TILTS` (15) chooses the number of scenes.
#[test]
fn bodies_that_tilt_freely_are_in_balance() {
    let (scenes, seed) = (from_environment("ADHESION_TILTS", 15), from_environment("ADHESION_SEED", 1));
    let (mut steps, mut pulled, mut turned) = (0, 0, 0);
    for number in 0..scenes {
        let mut draws = Draws::new(91_000 * seed + number);
        let drawn = Drawn {
            side: 4.0,
            tabor: [0.5, 1.2],
            heights: [0.01, 0.1],
            waves: [2.0, 4.0],
            creeping: 0.5,
            periodic: 0.0,
        };
        let scene = Scene::draw(&mut draws, &drawn);
        let wave = Wavy::new(draws.scale(0.005, 0.1), draws.between(1.0, 2.0)).unwrap();
        let shape = Box::new(Sum::new(FlatPunch::circular(draws.between(0.9, 1.5)).unwrap(), wave));
        let scene = Scene { shape, ..scene };
        let at = [0, 1].map(|_| draws.between(-0.25, 0.25));
        let tilt = at.map(|at| Tilt::Free { at });
        let (kind, step, stiffness) = (number % 3, draws.scale(0.05, 5.0), draws.scale(2.0, 50.0));
        let name = format!("scene {number}: {:?}, {}, load {kind} ({stiffness:.1}) at {at:?}", scene.shape, scene.name);
        let mut contact = scene.build(Settings::default());
        let touch = contact.approach();
        for k in 0..12 {
            let down = if k < 5 { f64::from(k) / 4.0 } else { 1.0 - 0.3 * f64::from(k - 4) };
            let load = match kind {
                0 => Load::Approach { approach: touch + 0.4 * down, tilt },
                1 => Load::Spring { stiffness, drive: touch + 0.4 * down, tilt },
                _ => Load::Force { normal: 2.0 * down, tilt },
            };
            match contact.step(step, load) {
                Ok(report) => {
                    let name = format!("{name}, step {k}");
                    // the spring pulls where the load acts
                    let by_spring = contact.approach() + (0..2).map(|axis| report.tilt[axis] * at[axis]).sum::<f64>();
                    if kind == 1 {
                        let off = stiffness * (touch + 0.4 * down - by_spring) - report.force;
                        assert!(off.abs() < 1e-6, "{name}: {off:e}");
                    } else {
                        check(&name, &contact, &*scene.law, !scene.creeping);
                    }
                    if kind == 0 && !report.warnings.contains(viscocontact::contact::Warnings::NO_CONTACT) {
                        assert!((by_spring - (touch + 0.4 * down)).abs() < 1e-9, "{name}: {by_spring}");
                    }
                    let moment = contact.fields().moment();
                    let off = [0, 1].map(|axis| (moment[axis] - report.force * at[axis]).abs());
                    assert!(off.iter().all(|off| *off < 1e-5), "{name}: {off:?}");
                    turned += usize::from(report.tilt.iter().all(|tilt| tilt.abs() > 1e-4));
                    steps += 1;
                }
                Err(Error::PulledOff { .. }) if kind == 2 && down < 0.0 => {
                    pulled += 1;
                    break;
                }
                Err(error) => panic!("{name}, step {k}: {error}"),
            }
        }
    }
    println!("{scenes} scenes, {steps} steps, {turned} turned, {pulled} pulled off");
    assert!(steps as u64 > 8 * scenes && 2 * turned > steps && pulled > 0, "{steps} {turned} {pulled}");
}
