//! Resistance to an indenter that slides without friction over a creeping body, against closed forms.
//!
//! With w = K p, an indenter that moves steadily along x1 at v finds the surface at
//! u(x) = C(0) w(x) + ∫ C′(s) w(x + v s) ds over s > 0, x measured from the indenter, and is resisted by F = −∫ p u′ dA, as
//! u′ = −h_i′ in contact. Elasticity alone does not resist: ∫ p w′ dA = 0, K being symmetric. μ is F over the normal force W.

use std::f64::consts::{PI, TAU};

use viscocontact::Result;
use viscocontact::analytic::{HertzEllipse, PerssonFriction, RollingCylinder, SlidingLimits};
use viscocontact::geometry::{Rough, RoughSpec, Roughness};
use viscocontact::plot::Legend;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};
use crate::elastic::between;

/// J(0) \[1/Pa\], and three retarded compliances with their times \[s\].
const GLASSY: f64 = 1.0e-6;
const TERMS: [(f64, f64); 3] = [(0.6e-6, 0.3), (0.5e-6, 1.0), (0.4e-6, 2.0)];
/// C over J, incompressible.
const SHARE: f64 = 0.25;
const RADIUS: f64 = 10.0e-3;

/// C(0).
fn at_once() -> f64 {
    SHARE * GLASSY
}

/// C after a long time.
fn relaxed() -> f64 {
    SHARE * (GLASSY + TERMS.iter().map(|(c, _)| c).sum::<f64>())
}

/// C′(0).
fn rate_at_once() -> f64 {
    SHARE * TERMS.iter().map(|(c, tau)| c / tau).sum::<f64>()
}

fn rubber() -> Result<Material> {
    Ok(Material::incompressible(GeneralizedKelvin::new(GLASSY, 0.0, &TERMS)?))
}

fn builder(grid: &Grid, shape: &dyn Geometry) -> Result<Builder> {
    // the effect sought is a small part of the pressure
    let settings = Settings::default().with_frame(Frame::Indenter).with_tolerance(1e-11);
    Ok(ViscoelasticContact::builder(grid.clone()).geometry(shape).material(rubber()?).settings(settings))
}

/// A cylinder in line contact, or a paraboloid of radii along x1 and x2.
#[derive(Clone, Copy)]
enum Slider {
    Line,
    Paraboloid([f64; 2]),
}

impl Slider {
    fn load(self) -> Load {
        Load::force(if matches!(self, Slider::Line) { 500.0 } else { 1.0 })
    }

    fn limits(self) -> Result<SlidingLimits> {
        match self {
            Slider::Line => SlidingLimits::cylinder(RADIUS, &rubber()?, 500.0),
            Slider::Paraboloid(radii) => SlidingLimits::ellipsoid(radii, &rubber()?, 1.0),
        }
    }

    /// Semi-axes of its contact with an elastic body of this compliance.
    fn hertz(self, compliance: f64) -> Result<[f64; 2]> {
        match self {
            Slider::Line => Ok([(4.0 * 500.0 * RADIUS * compliance / PI).sqrt(), 0.5]),
            Slider::Paraboloid(radii) => Ok(HertzEllipse::new(radii, 1.0 / compliance, 1.0)?.semi_axes),
        }
    }

    fn shape(self) -> Result<Box<dyn Geometry>> {
        Ok(match self {
            Slider::Line => Box::new(Cylinder::new(RADIUS)?),
            Slider::Paraboloid([radius1, radius2]) => Box::new(Ellipsoid::new(radius1, radius2)?),
        })
    }

    /// A contact on square cells, so many on the semi-axis a along the motion, with so many lengths a behind the axis and 1.3 ahead.
    /// The axis is on the border between two cells, about which shape and mesh are symmetric: elasticity does not resist.
    fn contact(self, compliance: f64, cells: usize, behind: f64) -> Result<(ViscoelasticContact, Shifted)> {
        let [a1, a2] = self.hertz(compliance)?;
        let side = a1 / cells as f64;
        let lengths = [0.5 * (behind + 1.3), 1.3 * a2 / a1];
        let counts = lengths.map(|length| 2 * (length * cells as f64).ceil() as usize);
        let ahead = (1.3 * cells as f64).round();
        let axis = (0.5 * counts[0] as f64 - ahead) * side;
        let shape = Shifted::new(self.shape()?, [axis, 0.0])?;
        let line = matches!(self, Slider::Line);
        let grid = if line {
            Grid::new([counts[0], 1], [counts[0] as f64 * side, 1.0])?
        } else {
            Grid::new(counts, counts.map(|count| count as f64 * side))?
        };
        let builder = builder(&grid, &shape)?;
        let builder = if line { builder.kernel(InfluenceKernel::line(&grid, 1.0)?) } else { builder };
        Ok((builder.build()?, shape))
    }

    /// Moves on by so many cells at v, and returns the friction.
    fn slide(self, contact: &mut ViscoelasticContact, shape: &Shifted, cells: usize, velocity: f64) -> Result<f64> {
        for _ in 0..cells {
            contact.step_over([1, 0], contact.grid().spacing()[0] / velocity, self.load())?;
        }
        Ok(contact.fields().slope_force(shape)[0] / contact.force())
    }
}

/// For v τ ≪ a, u = C∞ w + v m₁ w′ and F = −v m₁ ∫ p w″ dA, where w″ = −h_i″/C∞ in contact: μ = v m₁/C∞ times the mean of
/// h_i″, weighted by the pressure. That is 1/R for any paraboloid of radius R along the motion. The pressure must vanish at the rim,
/// as it does without an edge.
///
/// The next term is of the order v τ/a, far below the tolerance here. The contact moves by less than a cell, which errs
/// in the first order of the mesh: each value is extrapolated from two meshes.
pub fn slow() -> Outcome {
    let friction = |slider: Slider, cells: usize| -> Result<[f64; 2]> {
        let a = slider.hertz(relaxed())?[0];
        let velocity = 1e-4 * a;
        let once = |cells: usize| {
            let (mut contact, shape) = slider.contact(relaxed(), cells, 1.3)?;
            contact.step(1.0e9, slider.load())?;
            slider.slide(&mut contact, &shape, 4, velocity)
        };
        Ok([2.0 * once(2 * cells)? - once(cells)?, slider.limits()?.slow(velocity)])
    };
    let line = friction(Slider::Line, 128)?;
    let sphere = friction(Slider::Paraboloid([RADIUS; 2]), 48)?;
    let ellipsoid = friction(Slider::Paraboloid([RADIUS, 3.0 * RADIUS]), 32)?;
    let rows = [
        ("friction of a cylinder", line[0], line[1], 1e-3),
        ("friction of a sphere", sphere[0], sphere[1], 5e-3),
        ("friction of an ellipsoid, R along the motion, 3R across", ellipsoid[0], ellipsoid[1], 5e-3),
    ];
    Ok(Checked::new("slow sliding, three retardation times", "SlidingLimits", &rows))
}

/// For v τ ≫ a, all that creeps behind the contact does so at the rate C′(0) p of its passage. After a slide of length L ≪ v τ
/// from where the indenter was put down, u = C(0) w + (C′(0)/v) ∫ w(x + y) dy over 0 < y < L, and
/// F = (C′(0)/v) ∫ p(x) [w(x) − w(x + L)] dA, with p and w of Hertz for C(0):
///
/// * Sphere: ∫ p w dA = (W/C(0)) ⟨a²/R − r²/2R⟩ = (4/5) (a²/R) W/C(0), and w = (W/πx) (1 + …) far away, W = 4a³/(3RC(0)), so that
///   μ = (a²/Rv) C′(0)/C(0) [4/5 − (4a/3πL) (1 + a²/5L² + …)].
/// * Cylinder: w = −(2P/π) ln|x| + …, and over two semicircles of pressure ⟨ln|x − y|⟩ = ln(a/2) − 1/4, ⟨(x − y)²⟩ = a²/2, so that
///   μ = (a²/2Rv) C′(0)/C(0) [ln(2L/a) + 1/4 − a²/4L² − …].
///
/// The contact moves by less than a cell. For the cylinder that errs in the first order of the mesh, and the value is extrapolated;
/// for the sphere it depends on how its rim lies in the cells, and the value is a mean over eight meshes.
pub fn fast() -> Outcome {
    let lengths = 6; // L/a
    let friction = |slider: Slider, cells: usize| -> Result<f64> {
        let velocity = 1e5 * slider.hertz(at_once())?[0]; // in 1 s, and the shortest time is 0.3 s
        let (mut contact, shape) = slider.contact(at_once(), cells, lengths as f64 + 1.3)?;
        contact.step(0.0, slider.load())?;
        slider.slide(&mut contact, &shape, lengths * cells, velocity)
    };
    let scale = |slider: Slider| -> Result<f64> {
        Ok(slider.hertz(at_once())?[0] / (1e5 * RADIUS) * rate_at_once() / at_once())
    };
    let (line, sphere) = (Slider::Line, Slider::Paraboloid([RADIUS; 2]));
    let [coarse, fine] = [friction(line, 64)?, friction(line, 128)?];
    let meshes = (12..20).map(|cells| friction(sphere, cells)).collect::<Result<Vec<_>>>()?;
    let mean = meshes.iter().sum::<f64>() / meshes.len() as f64;
    let length = lengths as f64;
    let exact_line = 0.5 * scale(line)? * ((2.0 * length).ln() + 0.25 - 0.25 / (length * length));
    let exact_sphere = scale(sphere)? * (0.8 - 4.0 / (3.0 * PI * length) * (1.0 + 0.2 / (length * length)));
    let rows = [
        ("friction of a cylinder after 6 a", 2.0 * fine - coarse, exact_line, 1e-3),
        ("friction of a sphere after 6 a", mean, exact_sphere, 5e-3),
    ];
    Ok(Checked::new("fast sliding, three retardation times", "first order in C′(0)/v, derived below", &rows))
}

/// The same limits by one state a velocity: reaches v τ of a thousandth of the contact, of a hundred contacts for the cylinder, whose remainder is of the second order,
/// and of 10⁵ for the sphere.
pub fn limits() -> Outcome {
    let found = |slider: Slider, fast: bool, reach: f64| -> Result<[f64; 2]> {
        let (compliance, time, length) = if fast { (at_once(), 0.3, 4.0) } else { (relaxed(), 2.0, 2.6) };
        let half = slider.hertz(compliance)?[0];
        let line = matches!(slider, Slider::Line);
        let (cells, width) = if line { ([2048, 1], 1.0) } else { ([192; 2], length * half) };
        let grid = Grid::new(cells, [length * half, width])?;
        let shape = slider.shape()?;
        let builder = ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(rubber()?);
        let builder = if line { builder.kernel(InfluenceKernel::line(&grid, 1.0)?) } else { builder };
        let mut sliding = builder.settings(Settings::default().with_tolerance(1e-9)).build_sliding()?;
        let (speed, limits) = (reach * half / time, slider.limits()?);
        let exact = if fast { limits.fast(speed) } else { limits.slow(speed) };
        Ok([sliding.at([speed, 0.0], slider.load())?.friction(), exact])
    };
    let row = |name, slider, fast, reach, allowed| -> Result<_> {
        let [found, exact] = found(slider, fast, reach)?;
        Ok((name, found, exact, allowed))
    };
    let (line, sphere) = (Slider::Line, Slider::Paraboloid([RADIUS; 2]));
    let rows = [
        row("cylinder, slow", line, false, 1e-3, 1e-3)?,
        row("sphere, slow", sphere, false, 1e-3, 5e-3)?,
        row("cylinder, fast", line, true, 100.0, 2e-4)?,
        row("sphere, fast", sphere, true, 1e5, 1e-3)?,
    ];
    Ok(Checked::new("steady sliding, three retardation times", "SlidingLimits", &rows))
}

/// A wave h cos(q·x) in full contact, sliding along x1: p = ½ |q| h Re[e^(i q·x)/C*(−i q₁ v)] and the mean, so that on a unit of
/// area F = ¼ |q| q₁ h² Im[1/C*(i q₁ v)], with C*(iω) = C(0) + Σ C_k/(1 + iω τ_k); ¼ q² h² Im[1/C*] with crests across the motion.
pub fn wave() -> Outcome {
    let (length, height) = (1.0e-3, 1.0e-6);
    let wave_number = |periods: f64| TAU * periods / length;
    // the lateral force on a unit of area of a wave of so many periods along x1 and x2
    let slide = |grid: Grid, periods: [f64; 2], velocity: f64| -> Result<f64> {
        let [q1, q2] = periods.map(wave_number);
        let wave = FnGeometry::new(move |x1, x2| height * (1.0 - (q1 * x1 + q2 * x2).cos()));
        let (area, side) = (grid.lengths()[0] * grid.lengths()[1], grid.spacing()[0]);
        let mut contact = builder(&grid, &wave)?.kernel(InfluenceKernel::periodic(&grid)?).build()?;
        // twice the amplitude of the pressure on the glassy body
        let load = Load::force(q1.hypot(q2) * height / at_once() * area);
        contact.step(0.0, load)?;
        // twelve of the longest retardation times, and three periods at least
        let distance = (24.0 * velocity).max(3.0 * length);
        for _ in 0..(distance / side) as usize {
            contact.step_over([1, 0], side / velocity, load)?;
        }
        Ok(contact.fields().slope_force(&wave)[0] / area)
    };
    let exact = |periods: [f64; 2], velocity: f64| {
        let [q1, q2] = periods.map(wave_number);
        let omega = q1 * velocity;
        let (storage, loss) = TERMS.iter().fold((at_once(), 0.0), |(storage, loss), (c, tau)| {
            let share = SHARE * c / (1.0 + (omega * tau).powi(2));
            (storage + share, loss + share * omega * tau)
        });
        0.25 * q1.hypot(q2) * q1 * height * height * loss / (storage * storage + loss * loss)
    };
    let across = |velocity: f64| slide(Grid::new([256, 1], [length, length])?, [1.0, 0.0], velocity);
    let (velocity, oblique) = (1.5e-4, [1.0, 2.0]);
    let rows = [
        ("lateral force, crests across the motion", across(velocity)?, exact([1.0, 0.0], velocity), 1e-3),
        (
            "lateral force, crests oblique to it",
            slide(Grid::square(64, length)?, oblique, velocity)?,
            exact(oblique, velocity),
            2e-3,
        ),
    ];
    // over 2.5 decades of speed, lg of q v
    let frequency = |k: i32| -1.5 + 0.25 * f64::from(k);
    let at = |exponent: f64| 10_f64.powf(exponent) / wave_number(1.0);
    let line = between(frequency(0), frequency(10)).map(|x| (x, exact([1.0, 0.0], at(x)))).collect();
    let dots = (0..=10).map(|k| Ok((frequency(k), across(at(frequency(k)))?))).collect::<Result<Vec<_>>>()?;
    Ok(Checked::new("wave sliding in full contact, three retardation times", "closed form below", &rows).drawn(
        ["lg of q v [1/s]", "lateral force per area [Pa]"],
        Legend::UpperLeft,
        line,
        dots,
    ))
}

/// The steady states themselves, without steps: a cylinder that rolls, against S. C. Hunter (J. Appl. Mech. 28, 1961), with reaches l = vτ from a
/// twentieth of the relaxed half width w to a thousand.
pub fn rolling_cylinder() -> Outcome {
    let (c0, c1, force) = (0.25e-6, 2.25e-6, 5.0e3);
    let half = (4.0 * (c0 + c1) * force / PI).sqrt();
    let found = |cells: usize, over_half: f64| -> Result<f64> {
        let grid = Grid::new([cells, 1], [3.0 * half, 1.0])?;
        let mut sliding = ViscoelasticContact::builder(grid.clone())
            .geometry(&Cylinder::new(1.0)?)
            .material(Material::incompressible(GeneralizedKelvin::new(4.0 * c0, 0.0, &[(4.0 * c1, 1.0)])?))
            .kernel(InfluenceKernel::line(&grid, 100.0)?)
            .settings(Settings::default().with_tolerance(1e-9))
            .build_sliding()?;
        Ok(sliding.at([over_half * half, 0.0], Load::force(force))?.friction())
    };
    let exact =
        |over_half: f64| -> Result<f64> { Ok(RollingCylinder::new(1.0, [c0, c1], force, over_half * half)?.friction) };
    let row = |name, over_half| -> Result<_> { Ok((name, found(2048, over_half)?, exact(over_half)?, 2e-5)) };
    let rows = [row("friction, l = w/20", 0.05)?, row("friction, l = w", 1.0)?, row("friction, l = 1000 w", 1e3)?];
    let at = |exponent: f64| 10_f64.powf(exponent);
    let line = between(-2.0, 3.0).map(|x| Ok((x, exact(at(x))?))).collect::<Result<Vec<_>>>()?;
    let dots = (0..=10).map(|k| 0.5 * f64::from(k) - 2.0).map(|x| Ok((x, found(512, at(x))?)));
    let dots = dots.collect::<Result<Vec<_>>>()?;
    Ok(Checked::new("cylinder that rolls steadily, 2048 cells", "Hunter 1961", &rows).drawn(
        ["lg of l/w", "coefficient of friction"],
        Legend::UpperRight,
        line,
        dots,
    ))
}

/// A random surface in full contact, where Persson's integral is exact: against contact problems, at three speeds.
pub fn rough_full_contact() -> Outcome {
    let grid = Grid::square(64, 1.0e-3)?;
    let road = Rough::new(&grid, RoughSpec::new(5.0e-4, 6.0e-5, Roughness::RmsSlope(0.05)).with_seed(1))?;
    let spectrum = rubber()?.contact_spectrum()?.unwrap_or_else(|| unreachable!());
    let mut sliding = ViscoelasticContact::builder(grid.clone())
        .geometry(&road)
        .material(rubber()?)
        .kernel(InfluenceKernel::periodic(&grid)?)
        .settings(Settings::default().with_tolerance(1e-11))
        .build_sliding()?;
    let pressure = 1.0e8;
    let mut row = |name, speed: f64| -> Result<_> {
        let velocity = [0.8 * speed, 0.6 * speed];
        let found = sliding.at(velocity, Load::force(pressure * 1.0e-6))?.friction();
        let modulus = |omega: f64| spectrum.complex_modulus(omega.max(1e-30));
        Ok((name, PerssonFriction::new(&grid, &road, modulus, pressure, velocity, 0.5)?.friction, found, 1e-7))
    };
    let rows =
        [row("friction at 10 µm/s", 1.0e-5)?, row("friction at 1 mm/s", 1.0e-3)?, row("friction at 0.1 m/s", 0.1)?];
    Ok(Checked::new("Persson's integral in full contact, 64² cells", "contact problems in steady motion", &rows))
}
