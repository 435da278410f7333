//! Closed forms to compare with.

use std::ffi::CString;

use pyo3::exceptions::PyUserWarning;
use viscocontact::analytic as an;
use viscocontact::load::LoadHistory as Load;

use crate::arrays::check;
use crate::prelude::*;
use crate::sliding::complex;

/// Closed forms as dicts: a function of each, of what `new` of the crate takes, and the fields that it gives.
macro_rules! forms {
    ($($(#[$meta:meta])* $name:ident($($given:ident: $type:ty),*) = $form:ident { $($field:ident),* };)*) => {$(
        #[pyfunction]
        $(#[$meta])*
        pub fn $name<'py>(py: Python<'py>, $($given: $type),*) -> PyResult<Dict<'py>> {
            let of = an::$form::new($($given),*).or_raise()?;
            Ok(dict! { py; of { $($field),* } })
        }
    )*};
}

forms! {
    /// Hertz: a sphere of `radius` [m] on a body of contact `modulus` E* [Pa] under `force` [N]: "contact_radius" [m], "max_pressure" [Pa]
    /// and "approach" [m].
    ///
    /// >>> round(hertz(10e-3, 4e6, 1.0)["contact_radius"], 6)
    /// 0.001233
    hertz(radius: f64, modulus: f64, force: f64) = Hertz { contact_radius, max_pressure, approach };

    /// Hertz: a paraboloid of `radii` of curvature along x1 and x2 [m]: "semi_axes" of the contact [m], "max_pressure" [Pa] and "approach" [m].
    ///
    /// >>> round(hertz_ellipse((10e-3, 10e-3), 4e6, 1.0)["semi_axes"][0], 6)     # as hertz
    /// 0.001233
    hertz_ellipse(radii: [f64; 2], modulus: f64, force: f64) = HertzEllipse { semi_axes, max_pressure, approach };

    /// A rigid flat circular punch of `radius` [m] under `force` [N] at the point (`eccentricity`, 0) [m]: "approach" [m] and "tilt" [rad].
    ///
    /// >>> rigid_punch(1e-3, 1e6, 1.0)["approach"]
    /// 0.0005
    #[pyo3(signature = (radius, modulus, force, eccentricity=0.0))]
    rigid_punch(radius: f64, modulus: f64, force: f64, eccentricity: f64) = RigidPunch { approach, tilt };

    /// Hunter: a cylinder of `radius` [m] that rolls or slides on a body of one retardation time under `force` on a unit of its length [N/m]:
    /// "half_width" and "center" of the contact [m], and "friction". `compliances` are C₀ at once and C₁ delayed [1/Pa], `reach` the velocity
    /// times the retardation time [m].
    ///
    /// >>> 0 < rolling_cylinder(10e-3, (1e-7, 1e-7), 100.0, 1e-3)["friction"] < 0.1
    /// True
    rolling_cylinder(radius: f64, compliances: [f64; 2], force: f64, reach: f64) = RollingCylinder { half_width, center, friction };
}

/// A sphere on a viscoelastic half-space under a force for which the contact never shrinks (Lee and Radok).
///
/// >>> ball = GrowingSphere(10e-3, Material(Rheology.maxwell(1e6, 1.0)), Load.force(1.0))
/// >>> round(ball.contact_radius(0.0), 6)
/// 0.001233
#[pyclass(frozen, module = "viscocontact")]
pub struct GrowingSphere {
    sphere: an::GrowingSphere,
    load: Arc<dyn Load>,
    recipe: Recipe,
}

#[pymethods]
impl GrowingSphere {
    #[new]
    fn new(radius: f64, material: Bound<'_, Material>, load: &Object<'_>) -> PyResult<GrowingSphere> {
        let (py, given) = (load.py(), LoadHistory::any(load)?);
        let load = Arc::clone(&given.get().history);
        let sphere = an::GrowingSphere::new(radius, &material.get().material, Arc::clone(&load));
        nothing_raised(load.failure())?;
        let recipe = Recipe::new(py, "", (radius, material, given))?;
        Ok(GrowingSphere { sphere: sphere.or_raise()?, load, recipe })
    }

    /// Contact radius [m] at times [s].
    fn contact_radius<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.sphere.contact_radius(t), || self.load.failure())
    }

    /// Approach [m] at times [s].
    fn approach<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.sphere.approach(t), || self.load.failure())
    }

    /// Pressure [Pa] at distances from the centre [m] and one time [s].
    fn pressure<'py>(&self, r: &Object<'py>, t: f64) -> PyResult<Object<'py>> {
        check("t", t, FROM_ZERO)?;
        mapped("r", r, FROM_ZERO, |r| self.sphere.pressure(r, t), || self.load.failure())
    }
}

made_by_calls!(GrowingSphere);

/// The lag of the bulk up to which a pull is within 7 %.
const MOST_LAG: f64 = 0.1;

/// Closed forms of bodies that stick: a class of each, its getters, and its functions of a number.
macro_rules! sticking {
    ($(
        $(#[$about:meta])*
        $class:ident($($given:ident),*) {
            $($(#[$doc:meta])* $name:ident: $type:ty = |$of:ident| $value:expr;)*
        }
        [$(#[$told:meta] $function:ident($at:ident) -> $result:ty)?]
    )*) => {$(
        $(#[$about])*
        #[pyclass(frozen, module = "viscocontact")]
        pub struct $class {
            of: an::$class,
            recipe: Recipe,
        }

        #[pymethods]
        impl $class {
            #[new]
            fn new(py: Python<'_>, $($given: f64),*) -> PyResult<$class> {
                let of = an::$class::new($($given),*).or_raise()?;
                Ok($class { of, recipe: Recipe::new(py, "", ($($given,)*))? })
            }

            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self) -> $type {
                    let $of = &self.of;
                    $value
                }
            )*

            $(
                #[$told]
                fn $function(&self, $at: f64) -> PyResult<$result> {
                    check(stringify!($at), $at, FROM_ZERO)?;
                    Ok(self.of.$function($at).into())
                }
            )?
        }

        made_by_calls!($class);
    )*};
}

sticking! {
    /// Johnson, Kendall and Roberts: a sphere of `radius` [m] that sticks to a body of contact `modulus` E* [Pa] by an attraction of vanishing
    /// range, with the `work` of separation [J/m²].
    ///
    /// >>> gel = Jkr(1e-3, 1e5, 0.05)
    /// >>> force, approach = gel.state(gel.radius_at_pull_off)
    /// >>> abs(force / gel.pull_off_force - 1) < 1e-12 and approach < 0
    /// True
    Jkr(radius, modulus, work) {
        /// The minimum force [N]: negative, a pull.
        pull_off_force: f64 = |of| of.pull_off_force();
        /// The contact radius at the minimum force [m].
        radius_at_pull_off: f64 = |of| of.radius_at_pull_off();
        /// The contact radius at the minimum approach [m].
        radius_at_min_approach: f64 = |of| of.radius_at_min_approach();
    }
    [
        /// Force [N] and approach [m] at a contact radius [m].
        state(contact_radius) -> (f64, f64)
    ]

    /// Derjaguin, Muller and Toporov: a sphere of `radius` [m] that sticks to a stiff body of contact `modulus` E* [Pa] by an attraction of long
    /// range, with the `work` of separation [J/m²].
    ///
    /// >>> round(Dmt(1e-3, 1e9, 0.05).pull_off_force * 1e6, 2)     # µN: negative, a pull
    /// -314.16
    Dmt(radius, modulus, work) {
        /// The minimum force [N]: negative, a pull.
        pull_off_force: f64 = |of| of.pull_off_force();
    }
    [
        /// Force [N] and approach [m] at a contact radius [m].
        state(contact_radius) -> (f64, f64)
    ]

    /// Maugis: a sphere of `radius` [m] that sticks to a body of contact `modulus` E* [Pa] by a constant `traction` [Pa], with the `work` of
    /// separation [J/m²].
    ///
    /// >>> sphere = MaugisDugdale(1e-3, 1e9, 0.05, 1e7)
    /// >>> Dmt(1e-3, 1e9, 0.05).pull_off_force < sphere.pull_off[0] < Jkr(1e-3, 1e9, 0.05).pull_off_force
    /// True
    MaugisDugdale(radius, modulus, work, traction) {
        /// Maugis' parameter λ: `Dmt` is 0, `Jkr` infinity.
        parameter: f64 = |of| of.parameter();
        /// The minimum force [N], negative, a pull; and the contact radius there [m].
        pull_off: (f64, f64) = |of| of.pull_off().into();
    }
    [
        /// Force [N] and approach [m] at a contact radius [m].
        state(contact_radius) -> (f64, f64)
    ]

    /// Kendall: a rigid flat circular punch of `radius` [m] that sticks to a body of contact `modulus` E* [Pa] with the `work` of separation
    /// [J/m²].
    ///
    /// >>> punch = AdhesivePunch(1e-3, 1e6, 0.05)
    /// >>> punch.pull_off_force < 0 and punch.approach_at_pull_off < 0
    /// True
    AdhesivePunch(radius, modulus, work) {
        /// The minimum force [N]: negative, a pull.
        pull_off_force: f64 = |of| of.pull_off_force();
        /// The approach at the minimum force [m].
        approach_at_pull_off: f64 = |of| of.approach_at_pull_off();
    } []

    /// Barquins: a cylinder of `radius` [m] that sticks to a body of contact `modulus` E* [Pa] in plane strain, with the `work` of separation
    /// [J/m²].
    ///
    /// >>> roll = AdhesiveCylinder(1e-2, 1e6, 0.05)
    /// >>> abs(roll.force(roll.width_at_pull_off) / roll.pull_off_force - 1) < 1e-12
    /// True
    AdhesiveCylinder(radius, modulus, work) {
        /// The minimum force on a unit of length [N/m]: negative, a pull.
        pull_off_force: f64 = |of| of.pull_off_force();
        /// The half-width of the contact at the minimum force [m].
        width_at_pull_off: f64 = |of| of.width_at_pull_off();
    }
    [
        /// The force on a unit of length [N/m] at a half-width of the contact [m].
        force(half_width) -> f64
    ]

    /// Johnson: a wavy surface of `amplitude` and `wavelength` [m] that sticks to a body of contact `modulus` E* [Pa] in plane strain, with the
    /// `work` of separation [J/m²].
    ///
    /// >>> wave = AdhesiveWave(1e-6, 1e-4, 1e6, 1e-4)
    /// >>> 0 < wave.strength < 0.57 and wave.pull_off_pressure < 0
    /// True
    AdhesiveWave(amplitude, wavelength, modulus, work) {
        /// The strength α of the attraction: from 0.57 on the surfaces jump into full contact without load.
        strength: f64 = |of| of.strength();
        /// The half-width of the contacts at the minimum mean pressure [m].
        width_at_pull_off: f64 = |of| of.width_at_pull_off();
        /// The minimum mean pressure [Pa].
        pull_off_pressure: f64 = |of| of.pull_off_pressure();
    }
    [
        /// The mean pressure [Pa] at a half-width of the contacts [m].
        mean_pressure(half_width) -> f64
    ]
}

made! {
    /// The edge of a contact that opens on a creeping body (Schapery, Greenwood) under an attraction of `work` [J/m²] and `range` [m].
    ///
    /// `zone` is the length of the zone of the attraction over E*ρ²/w: π/4 of a constant traction, about 1.4 of an exponential one. The theory holds
    /// while the bulk of the body is relaxed: with the relaxation time τ, for speeds V τ ≤ 0.03 R^⅓ (w/E*)^⅔ of a sphere of radius R (4 %; 7 % at 0.1).
    ///
    /// >>> edge = OpeningEdge(Material(Rheology.relaxing(4e6, 1e6, 0.1)), 0.05, 1e-7)
    /// >>> edge.work(1e-9) < edge.work(1e-4) < 4.1 * 0.05      # from w to w times the ratio of the moduli
    /// True
    #[pyclass(frozen, module = "viscocontact")]
    OpeningEdge(edge: an::OpeningEdge)
}

#[pymethods]
impl OpeningEdge {
    #[new]
    #[pyo3(signature = (material, work, range, *, zone=None))]
    fn new(
        py: Python<'_>,
        material: Bound<'_, Material>,
        work: f64,
        range: f64,
        zone: Option<f64>,
    ) -> PyResult<OpeningEdge> {
        let edge = an::OpeningEdge::new(&material.get().material, work, range).or_raise()?;
        let edge = zone.map_or(Ok(edge.clone()), |zone| edge.with_zone(zone)).or_raise()?;
        let keywords = dict! { py; "zone": zone };
        let recipe = Recipe::new(py, "", (material, work, range))?.with_keywords(Some(&keywords))?;
        Ok(OpeningEdge::by(recipe, edge))
    }

    /// The work that opens a unit of area [J/m²] at a speed of the edge [m/s].
    fn work(&self, speed: f64) -> PyResult<f64> {
        self.edge.work(speed).or_raise()
    }

    /// A sphere of `radius` [m] drawn back from an `approach` [m] at a `speed` [m/s], at the maximum pull: a dict of "force" [N], "approach" and
    /// "contact_radius" [m], "edge_speed" [m/s], "work" [J/m²] and "lag", V τ/(R^⅓ (w/E*)^⅔) with the longest relaxation time: beyond the range of the
    /// theory, where it exceeds 0.1, the force is too large, and a UserWarning says so.
    fn pull_off<'py>(&self, py: Python<'py>, radius: f64, approach: f64, speed: f64) -> PyResult<Dict<'py>> {
        let of = free(py, || self.edge.pull_off(radius, approach, speed)).or_raise()?;
        if of.lag > MOST_LAG {
            let lag = of.lag;
            let text = format!("the bulk lags by {lag:.3}, which must be at most {MOST_LAG}: the pull is too large");
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(text)?, 1)?;
        }
        Ok(dict! { py; of { force, approach, contact_radius, edge_speed, work, lag } })
    }
}

getters! {OpeningEdge.edge, of:
    /// The length E*ρ²/w of the relaxed body [m].
    length: f64 = of.length();
}

/// Persson's theory of a rubber that slides on a rough surface: the coefficient of friction and the share of the surface in contact.
///
/// Parameters
/// ----------
/// grid : Grid
///     One period of the surface.
/// surface : Shape
/// modulus : function
///     The complex contact modulus E* [Pa] at frequencies ≥ 0 [rad/s]: 4 G* if incompressible.
/// pressure : float
///     The mean pressure [Pa].
/// velocity : (float, float)
///     [m/s]
/// gamma : float
///     The number γ of the theory, 0 to 1.
///
/// Returns a dict of the coefficient of "friction" and the "contact_share" of the surface.
///
/// >>> grid = Grid(32, 1e-3)
/// >>> road = HeightMap.rough(grid, 0.5e-3, 0.1e-3, rms_slope=0.1)
/// >>> rubber = Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)])
/// >>> theory = persson_friction(grid, road, lambda w: 4 * rubber.complex_modulus(w), 1e5, (1.0, 0.0), 0.5)
/// >>> 0 < theory["friction"] < 1 and 0 < theory["contact_share"] < 1
/// True
#[pyfunction]
pub fn persson_friction<'py>(
    py: Python<'py>,
    grid: &Grid,
    surface: &Shape,
    modulus: Function,
    pressure: f64,
    velocity: &Object<'py>,
    gamma: f64,
) -> PyResult<Dict<'py>> {
    let velocity = crate::sliding::velocity(velocity)?;
    let surface = Arc::clone(&surface.geometry);
    let kept = Kept::default();
    let modulus = |omega| complex(&modulus, omega, &kept);
    let theory = free(py, || an::PerssonFriction::new(&grid.0, &*surface, modulus, pressure, velocity, gamma));
    let theory = kept.raise_or(theory.or_raise())?;
    Ok(dict! { py; theory { friction, contact_share } })
}
