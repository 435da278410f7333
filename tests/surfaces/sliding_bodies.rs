//! Steady motions over strips and layers, of the same creep and of another, against dense problems whose coefficients are Fourier integrals.
//! `SLIDING_BODIES` (16) random scenes, `SLIDING_SEED` (1).

use std::f64::consts::{PI, TAU};

use crate::common::gauss::points;
use crate::common::moving_bodies::{Base, Bodies, Creep};
use crate::common::steady_sliding::{Below, SteadySliding as Dense};
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::Layer;
use viscocontact::num_complex::Complex64;
use viscocontact::prelude::*;
use viscocontact::sliding::{SlidingError, SlidingReport};

const GLASSY: f64 = 0.25e-6;

/// Compliances relative to [`GLASSY`].
fn creep(glassy: f64, terms: Vec<(f64, f64)>) -> Creep {
    Creep { glassy, terms }.times(GLASSY)
}

fn draw_creep(draws: &mut Draws, length: f64) -> Creep {
    let count = 1 + draws.below(2);
    let terms = (0..count).map(|_| (draws.scale(0.2, 30.0), draws.scale(0.3, 3.0 * length))).collect();
    creep(draws.scale(0.5, 2.0), terms)
}

#[derive(Debug, Clone)]
struct Scene {
    /// Whether bodies are periodic along the motion and aside of it.
    periodic: [bool; 2],
    cells: [usize; 2],
    spacing: [f64; 2],
    axis: usize,
    velocity: f64,
    creep: Creep,
    nu: f64,
    base_nu: f64,
    thickness: f64,
    base: Base,
    /// Whether the base creeps as the layer.
    alike: bool,
    waves: Vec<[f64; 4]>,
    radius: f64,
    force: f64,
}

impl Scene {
    /// Kinds of bodies in turn.
    fn draw(draws: &mut Draws, number: usize) -> Scene {
        let periodic = [[false, true], [true, false], [false, false], [true, true]][number % 4];
        let plane = periodic == [false, true] && draws.chance(0.4);
        let cells = [[20, 24, 30][draws.below(3)], if plane { 1 } else { [10, 12][draws.below(2)] }];
        let spacing = [draws.between(0.7, 1.4), if plane { 1.0 } else { draws.between(0.7, 1.4) }];
        let length = cells[0] as f64 * spacing[0];
        let creep = draw_creep(draws, length);
        let thickness = draws.scale(2.0, 30.0);
        let alike = draws.chance(0.3);
        let base = match if number % 8 < 4 { draws.below(3) } else { 3 } {
            0 => Base::None,
            1 => Base::Rigid,
            2 => Base::Frictionless,
            _ if alike => Base::Body(creep.times(draws.scale(0.05, 5.0))),
            _ => Base::Body(draw_creep(draws, length).times(draws.scale(0.05, 5.0))),
        };
        let wave = |draws: &mut Draws| {
            let number = |draws: &mut Draws, axis: usize| if cells[axis] == 1 { 0.0 } else { draws.below(4) as f64 };
            [number(draws, 0), number(draws, 1), draws.between(0.0, TAU), 1e-2 * draws.between(0.1, 1.0)]
        };
        let mut waves: Vec<_> = (0..4).map(|_| wave(draws)).collect();
        waves[0][0] = 1.0;
        Scene {
            periodic,
            cells,
            spacing,
            axis: draws.below(2),
            velocity: if draws.chance(0.5) { 1.0 } else { -1.0 },
            creep,
            nu: if draws.chance(0.5) { 0.5 } else { draws.between(0.1, 0.49) },
            base_nu: draws.between(0.1, 0.5),
            thickness,
            base,
            alike,
            waves,
            radius: draws.scale(60.0, 200.0) * length / 20.0,
            force: draws.scale(0.02, 0.3),
        }
    }

    fn by_axis<T>(&self, along: T, aside: T) -> [T; 2] {
        if self.axis == 0 { [along, aside] } else { [aside, along] }
    }

    fn gap(&self, along: f64, aside: f64) -> f64 {
        let x = [along, aside];
        let unit = [0, 1].map(|k| TAU / (self.cells[k] as f64 * self.spacing[k]));
        let waves = self.waves.iter().map(|[a, b, phase, h]| {
            let damped = if self.periodic == [true; 2] { 1.0 } else { 0.1 };
            damped * h * (1.0 - (unit[0] * a * along + unit[1] * b * aside + phase).cos())
        });
        let ball = (0..2).filter(|&k| !self.periodic[k]).map(|k| x[k] * x[k] / (2.0 * self.radius)).sum::<f64>();
        waves.sum::<f64>() + ball
    }

    fn force(&self) -> f64 {
        // so that a part of the grid is in contact
        let [length, width] = [0, 1].map(|k| self.cells[k] as f64 * self.spacing[k]);
        let height = if self.periodic == [true; 2] { 2e-2 } else { length * length / (8.0 * self.radius) };
        self.force * height / (2.0 * self.creep.relaxed()) * width
    }

    fn layer(&self) -> Option<Layer> {
        let made = match &self.base {
            Base::None => return None,
            Base::Rigid => Layer::bonded_to_rigid(self.thickness, self.nu),
            Base::Frictionless => Layer::frictionless_on_rigid(self.thickness, self.nu),
            Base::Body(base) => {
                Layer::bonded_to_material(self.thickness, &self.creep.material(self.nu), &base.material(self.base_nu))
            }
        };
        Some(made.unwrap())
    }

    fn grid(&self) -> Grid {
        let [n, m] = self.cells;
        Grid::new(self.by_axis(n, m), self.by_axis(n as f64 * self.spacing[0], m as f64 * self.spacing[1])).unwrap()
    }

    fn shape(&self) -> impl Geometry + 'static {
        let scene = self.clone();
        FnGeometry::new(move |x1: f64, x2: f64| {
            let [along, aside] = scene.by_axis(x1, x2);
            scene.gap(along, aside)
        })
    }

    fn datum(&self) -> f64 {
        300.0
    }

    fn build(&self) -> SteadySliding {
        let grid = self.grid();
        let along = || if self.by_axis(self.periodic[0], self.periodic[1])[0] { Axis::X1 } else { Axis::X2 };
        let kernel = match (self.layer(), self.periodic) {
            (None, [true, true]) => InfluenceKernel::periodic(&grid),
            (None, [false, false]) => InfluenceKernel::half_space(&grid),
            (None, _) => InfluenceKernel::periodic_along(&grid, along(), self.datum()),
            (Some(layer), [true, true]) => InfluenceKernel::layer_periodic(&grid, layer),
            (Some(layer), [false, false]) => InfluenceKernel::layer(&grid, layer),
            (Some(layer), _) => {
                let datum = matches!(self.base, Base::Body(_)).then(|| self.datum());
                InfluenceKernel::layer_periodic_along(&grid, layer, along(), datum)
            }
        };
        let builder = builder_of(&self.shape(), grid, self.creep.material(self.nu))
            .kernel(kernel.unwrap())
            .settings(Settings::default().with_tolerance(1e-9));
        match &self.base {
            // the recursion of layers whose base creeps as they do
            Base::Body(_) if self.alike => builder.build_sliding(),
            Base::Body(base) => builder.build_sliding_on(base.material(self.base_nu)),
            _ => builder.build_sliding(),
        }
        .unwrap()
    }

    /// Coefficients at the distances −(n − 1) to n − 1 along the motion, in rows aside.
    fn table(&self) -> Vec<Vec<f64>> {
        let Scene { periodic, cells, spacing, nu, base_nu, thickness, .. } = *self;
        let (creep, base, datum) = (self.creep.clone(), self.base.clone(), self.datum());
        let bodies = Bodies { periodic, cells, spacing, creep, nu, base, base_nu, thickness, datum };
        bodies.influence([1.0, 0.0]).rows()
    }

    fn dense(&self) -> Dense {
        let [n, m] = self.cells;
        let at = |k: usize, shift: f64| {
            let x = |k: usize, axis: usize| (k as f64 + 0.5 - 0.5 * self.cells[axis] as f64) * self.spacing[axis];
            self.gap(self.velocity * (x(k / m, 0) + shift), x(k % m, 1))
        };
        let half = 0.5 * self.spacing[0];
        Dense {
            below: Below::HalfSpace,
            cells: self.cells,
            spacing: self.spacing,
            glassy: self.creep.glassy,
            terms: self.creep.terms.clone(),
            gap: (0..n * m).map(|k| at(k, 0.0)).collect(),
            rise: (0..n * m).map(|k| at(k, half) - at(k, -half)).collect(),
            force: self.force(),
        }
    }
}

/// Random scenes against dense problems; under the approach that a force finds, the same state.
#[test]
fn strips_and_layers_are_those_of_a_dense_problem() {
    let (scenes, seed) = (from_environment("SLIDING_BODIES", 16), from_environment("SLIDING_SEED", 1));
    let (mut compared, mut worst, mut kinds, mut drags) = (0, [0.0_f64; 4], [0; 8], Ratios::default());
    for number in 0..scenes {
        let scene = Scene::draw(&mut Draws::new(7_000_000 * seed + number), number as usize);
        let velocity = scene.by_axis(scene.velocity, 0.0);
        let mut sliding = scene.build();
        let report = match sliding.at(velocity, Load::force(scene.force())) {
            Ok(report) => report,
            Err(Error::Step(StepError::ContactAtEdge { .. })) => continue,
            Err(error) => panic!("{number} {scene:?}: {error}"),
        };
        let exact = scene.dense().solve_by(&scene.table()).expect("the dense problem has a solution");
        let contact = sliding.fields();
        let [_, n2] = contact.grid().cells();
        let ([n, m], pressure) = (scene.cells, contact.pressure());
        let own = |k: usize| {
            let place = if scene.velocity > 0.0 { k / m } else { n - 1 - k / m };
            let [i, j] = scene.by_axis(place, k % m);
            pressure[i * n2 + j]
        };
        let cell = scene.spacing[0] * scene.spacing[1];
        let differ: f64 = exact.pressure.iter().enumerate().map(|(k, p)| (own(k) - p).abs()).sum::<f64>() * cell;
        let depth = exact.approach.abs().max(scene.gap(0.0, 0.0).abs()).max(1e-3);
        let (force, moved) = (report.force, report.approach);
        let again = scene.build().at(velocity, Load::approach(moved)).map(|again| (again.force / force - 1.0).abs());
        let lateral = scene.velocity * contact.lateral_force(&scene.shape())[scene.axis];
        let drag = scene.velocity * report.lateral_force[scene.axis];
        drags.push((drag - lateral).abs() / force, "");
        let by_waves = scene.periodic == [true, false];
        assert!(!by_waves || (drag / lateral - 1.0).abs() < 0.5, "{number}: {drag:e} by energy, {lateral:e} by slope");
        let errors = [
            differ / force,
            (moved - exact.approach).abs() / depth,
            (lateral / force - exact.friction).abs(),
            again.unwrap_or_else(|error| panic!("{number} {scene:?}: {error}")),
        ];
        println!(
            "{number}: {errors:?} {drag:e} {lateral:e} {:?} {:?} {report}, {} sets, {} pairs",
            scene.periodic, scene.base, report.sets, report.transforms
        );
        compared += 1;
        kinds[2 * usize::from(scene.periodic[0])
            + usize::from(scene.periodic[1])
            + if matches!(scene.base, Base::Body(_)) { 4 } else { 0 }] += 1;
        (0..4).for_each(|k| worst[k] = worst[k].max(errors[k]));
    }
    drags.print("by energy and by slope", 0);
    println!("{compared} scenes, {kinds:?} of each kind, worst {worst:?}");
    assert!(10 * compared >= 9 * scenes && kinds.iter().all(|count| *count > 0), "{compared} {kinds:?}");
    for (error, most) in worst.into_iter().zip([1e-6, 1e-7, 1e-7, 1e-6]) {
        assert!(error < most, "{worst:?}");
    }
}

/// A builder of a ball or a wavy indenter on a grid of 1 m.
fn pressed(kernel: impl Fn(&Grid) -> viscocontact::Result<InfluenceKernel>, grid: &Grid) -> Builder {
    let kernel = kernel(grid).unwrap();
    let periodic = kernel.periodic_axes();
    let shape = FnGeometry::new(move |x1: f64, x2: f64| {
        let along = |axis: usize, x: f64| if periodic[axis] { 2e-3 * (1.0 - (TAU * x).cos()) } else { 0.05 * x * x };
        along(0, x1) + along(1, x2)
    });
    ViscoelasticContact::builder(grid.clone())
        .geometry(&shape)
        .kernel(kernel)
        .settings(Settings::default().with_tolerance(1e-11))
}

fn body(factor: f64, nu: f64) -> Material {
    creep(factor, vec![(2.0 * factor, 0.05), (4.0 * factor, 1.0)]).material(nu)
}

/// The kernels of a body, without a layer and with one.
type Kernels = dyn Fn(&Grid, Option<Layer>) -> viscocontact::Result<InfluenceKernel>;

/// Friction and approach over two bases are the same to 1e-8.
fn same(what: &str, found: &SlidingReport, exact: &SlidingReport) {
    let errors = [found.friction() / exact.friction() - 1.0, found.approach / exact.approach - 1.0];
    println!("{what}: {errors:?}");
    assert!(errors.iter().all(|error| error.abs() < 1e-8), "{what}: {errors:?}");
}

/// The general layer on a base of its own material, on one as stiff in proportion, and on ever stiffer ones is the half-space, the layer whose base creeps as it
/// does, and the layer on a rigid base.
#[test]
fn bases_that_are_equal_elastic_or_rigid_are_limits() {
    let thickness = 0.1;
    let grids = [Grid::square(16, 1.0).unwrap(), Grid::new([48, 1], [1.0, 1.0]).unwrap()];
    let bodies: [(&Grid, &Kernels); 4] = [
        (&grids[0], &|grid, layer| {
            layer.map_or_else(|| InfluenceKernel::half_space(grid), |layer| InfluenceKernel::layer(grid, layer))
        }),
        (&grids[0], &|grid, layer| {
            layer.map_or_else(|| InfluenceKernel::periodic(grid), |layer| InfluenceKernel::layer_periodic(grid, layer))
        }),
        (&grids[0], &|grid, layer| match layer {
            Some(layer) => {
                let datum = format!("{layer}").contains("half-space").then_some(40.0);
                InfluenceKernel::layer_periodic_along(grid, layer, Axis::X2, datum)
            }
            None => InfluenceKernel::periodic_along(grid, Axis::X2, 40.0),
        }),
        (&grids[1], &|grid, layer| match layer {
            Some(layer) => {
                let datum = format!("{layer}").contains("half-space").then_some(40.0);
                InfluenceKernel::layer_line(grid, layer, datum)
            }
            None => InfluenceKernel::line(grid, 40.0),
        }),
    ];
    for (number, (grid, kernel)) in bodies.into_iter().enumerate() {
        // the mean of a compressible layer counts on a rigid base alone
        let nu = if number == 1 { 0.5 } else { 0.4 };
        for velocity in [[0.3, 0.0], [0.0, -0.3]] {
            if number == 3 && velocity[0] == 0.0 {
                continue;
            }
            let at = |sliding: viscocontact::Result<SteadySliding>| {
                sliding.unwrap().at(velocity, Load::force(20.0)).unwrap()
            };
            let half_space = at(pressed(|grid| kernel(grid, None), grid).material(body(1.0, nu)).build_sliding());
            let on = |base: Material| {
                let layer = Layer::bonded_to_material(thickness, &body(1.0, nu), &base).unwrap();
                let builder = || pressed(|grid| kernel(grid, Some(layer)), grid).material(body(1.0, nu));
                [at(builder().build_sliding_on(base)), at(builder().build_sliding())]
            };
            same(&format!("{number} equal"), &on(body(1.0, nu))[0], &half_space);
            let [general, own] = on(body(0.2, 0.3));
            same(&format!("{number} in proportion"), &general, &own);
            // linear in the compliance of the base but for its square
            let [stiff, stiffer] = [4e-6, 2e-6].map(|part| on(body(part, 0.3))[0]);
            let rigid = at(pressed(|grid| kernel(grid, Some(Layer::bonded_to_rigid(thickness, nu)?)), grid)
                .material(body(1.0, nu))
                .build_sliding());
            let limit = [
                (stiffer.friction(), stiff.friction(), rigid.friction()),
                (stiffer.approach, stiff.approach, rigid.approach),
            ];
            let errors = limit.map(|(stiffer, stiff, rigid)| (2.0 * stiffer - stiff) / rigid - 1.0);
            println!("{number} rigid: {errors:?}");
            assert!(errors.iter().all(|error| error.abs() < 1e-8), "{number}: {errors:?}");
        }
    }
}

/// A ball on a half-space that flows: the pressure is steady, from coefficients that are integrals over the whole way.
#[test]
fn a_half_space_may_flow() {
    let (n, m, fluidity, speed, force) = (32, 16, 2e-6, 1.5, 30.0);
    let grid = Grid::new([n, m], [2.0, 1.0]).unwrap();
    let d = grid.spacing()[0];
    let shape = FnGeometry::new(|x1: f64, x2: f64| 0.05 * (x1 * x1 + x2 * x2));
    let rheology = || GeneralizedKelvin::new(4.0 * GLASSY, 4.0 * fluidity, &[(8.0 * GLASSY, 0.2)]).unwrap();
    let builder = || builder_of(&shape, grid.clone(), Material::incompressible(rheology()));
    let mut sliding = builder().settings(Settings::default().with_tolerance(1e-10)).build_sliding().unwrap();
    let report = sliding.at([speed, 0.0], Load::force(force)).unwrap();
    let at = |k: usize, shift: f64| {
        let [x1, x2] = grid.center(k / m, k % m);
        0.05 * ((x1 + shift).powi(2) + x2 * x2)
    };
    let dense = Dense {
        below: Below::HalfSpace,
        cells: [n, m],
        spacing: grid.spacing(),
        glassy: GLASSY,
        terms: vec![(2.0 * GLASSY, 0.2 * speed)],
        gap: (0..n * m).map(|k| at(k, 0.0)).collect(),
        rise: (0..n * m).map(|k| at(k, 0.5 * d) - at(k, -0.5 * d)).collect(),
        force,
    };
    let mut table = dense.coefficients();
    for (j, row) in table.iter_mut().enumerate() {
        let love = |x: f64| dense.influence(x, j);
        // over a way of S, less what a point has done from the length of the grid on
        let (mut tail, mut from) = (0.0, n as f64 * d);
        while from < 1e7 {
            tail += points(from, 2.0 * from, 4).map(|(x, w)| w * love(x)).sum::<f64>();
            from *= 2.0;
        }
        let mut sum = tail - d * d / PI * (from / 2.0).ln();
        for i in (0..2 * n - 1).rev() {
            let x = (i as f64 - (n - 1) as f64) * d;
            sum +=
                points(x, x + 0.5 * d, 8).chain(points(x + 0.5 * d, x + d, 8)).map(|(x, w)| w * love(x)).sum::<f64>();
            row[i] += fluidity / speed * sum;
        }
    }
    let exact = dense.solve_by(&table).unwrap();
    let lateral = sliding.fields().lateral_force(&shape)[0] / force;
    let errors = [report.approach / exact.approach - 1.0, lateral / exact.friction - 1.0];
    println!("{errors:?} {report}");
    assert!(errors.iter().all(|error| error.abs() < 1e-6), "{errors:?}");
    for (velocity, load) in [([speed, 0.0], Load::approach(0.01)), ([0.0, 0.0], Load::force(force))] {
        assert!(sliding.at(velocity, load).unwrap_err().to_string().contains("flows"));
    }
}

/// A modulus over frequency that is the series' finds the same state; where it gives energy away, it is refused.
#[test]
fn a_modulus_over_frequency_is_its_series() {
    let grid = Grid::square(32, 1.0).unwrap();
    let builder = || pressed(InfluenceKernel::periodic, &grid);
    let series = body(1.0, 0.5).contact_spectrum().unwrap().unwrap();
    let modulus = move |omega: f64| series.complex_modulus(omega);
    let mut by_series = builder().material(body(1.0, 0.5)).build_sliding().unwrap();
    let mut by_modulus = builder().build_sliding_by(modulus).unwrap();
    for velocity in [[0.01, 0.0], [0.3, -2.0], [-40.0, 0.0]] {
        let [found, exact] = [&mut by_modulus, &mut by_series].map(|own| own.at(velocity, Load::force(20.0)).unwrap());
        same("modulus", &found, &exact);
    }
    let mut active = builder().build_sliding_by(|omega| Complex64::new(1e6 - 1e5 * omega, 1e5)).unwrap();
    assert!(active.at([1e-3, 0.0], Load::force(20.0)).is_ok());
    let refused = active.at([1.0, 0.0], Load::force(20.0)).unwrap_err();
    assert!(matches!(refused, Error::Sliding(SlidingError::NotPassive { .. })), "{refused}");
}
