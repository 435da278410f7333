//! A step allocates nothing: every buffer is made when the contact is built.

use crate::ALLOCATOR;
use crate::common::{Draws, StepLoadedSphere, builder_of, sphere, sphere_on, zener};
use stats_alloc::Region;
use viscocontact::friction::{Coulomb, FrictionContact, Outcome, ShearHistory, ShearLoad};
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

/// Panics if the job allocates.
fn allocates_nothing(what: impl std::fmt::Debug, job: impl FnOnce()) {
    let region = Region::new(ALLOCATOR);
    job();
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{what:?}: {change:?}");
}

/// Steps of tilting bodies and of several bodies, from the third on, whatever becomes of them: warm steps, cold starts after
/// a jump of the load, and the fall-back. Returns how many steps there were with iterations of the fall-back.
fn count_tilting_steps<const N: usize>(mut contact: ViscoelasticContact, loads: impl Fn(usize) -> [Load; N]) -> usize {
    let (mut fallback, mut solved) = (0, 0);
    for step in 0..600 {
        let (dt, loads) = (if step % 5 == 0 { 0.0 } else { 0.1 }, loads(step));
        let region = Region::new(ALLOCATOR);
        let Ok(report) = contact.step(dt, loads) else { continue };
        let change = region.change();
        assert!(step < 2 || (change.allocations, change.reallocations) == (0, 0), "{step} {loads:?}: {change:?}");
        fallback += usize::from(report.fallback_iterations > 0);
        solved += usize::from(step >= 2);
    }
    assert!(solved > 300, "{solved} steps were looked at");
    fallback
}

pub fn tilting_steps_allocate_nothing() {
    let side = 4.0e-3;
    let random = |step: usize, kind: u64| Draws::new(31 * step as u64 + kind).between(0.0, 1.0);
    let rough = |x: f64, y: f64| 50.0 * (x * x + y * y) + 1.0e-6 * (9.0e3 * x + 1.0).sin() * (7.0e3 * y + 2.0).cos();
    let half = |centre: f64| {
        let own = move |x: f64| (x - centre).abs() < 0.24 * side;
        FnGeometry::new(move |x, y| if own(x) { rough(x - centre, y) } else { f64::INFINITY })
    };
    let at = |step: usize, reach: f64| [0, 1].map(|axis| reach * (random(step, axis) - 0.5) * side);
    let wandering = |step: usize| [Load::eccentric_force(1.0, [0.1e-3 + 1.0e-6 * step as f64, 0.05e-3])];
    let jumping = |step: usize| [Load::eccentric_force(10f64.powf(3.0 * random(step, 2) - 3.0), at(step, 0.4))];
    let pivoted = |step: usize| {
        let tilt = at(step, 0.6).map(|at| Tilt::Free { at });
        [Load::Approach { approach: 3.0e-5 * (random(step, 2) - 0.2), tilt }]
    };
    let beside = |step: usize| {
        [-0.25, 0.25].map(|centre| {
            let [x, y] = at(step, 0.2);
            Load::eccentric_force(0.5 + 0.4 * random(step, 3), [x + centre * side, y])
        })
    };
    let builder = || {
        ViscoelasticContact::builder(Grid::new([24, 30], [side, side]).unwrap())
            .material(zener())
            .settings(Settings::default().with_window(false).with_edge(Edge::Allow))
    };
    let punch = || builder().geometry(&FlatPunch::circular(1.4e-3).unwrap()).build().unwrap();
    let bowl = || builder().geometry(&FnGeometry::new(rough)).build().unwrap();
    let two = || builder().geometry(&half(-0.25 * side)).another_body(&half(0.25 * side)).build().unwrap();
    let fallback = [
        count_tilting_steps(punch(), wandering),
        count_tilting_steps(punch(), jumping),
        count_tilting_steps(bowl(), jumping),
        count_tilting_steps(bowl(), pivoted),
        count_tilting_steps(two(), beside),
    ];
    println!("steps with the fall-back: {fallback:?}");
    assert!(fallback.iter().sum::<usize>() > 0, "no step needs the fall-back");
}

/// Steps on elastic states, of given length and adaptive, under forces, approaches and springs, as long as there is room for the groups of
/// levels; and snapshots.
pub fn steps_on_states_allocate_nothing() {
    let terms: Vec<(f64, f64)> = (0..12).map(|k| (1.0e5, 10f64.powf(0.3 * f64::from(k) - 3.0))).collect();
    let body = Material::incompressible(GeneralizedMaxwell::new(1.0e5, &terms).unwrap());
    let states = ElasticStates::sphere(10.0e-3).unwrap();
    let mut contact = StatesContact::new(&states, &body).unwrap();
    let mut snapshot = contact.clone();
    allocates_nothing("steps on states", || {
        for step in 0..150 {
            let wave = 1.0 + (0.7 * f64::from(step)).sin();
            let load = match step % 3 {
                0 => Load::force(wave),
                1 => Load::approach(2.0e-4 * wave),
                _ => Load::spring(1.0e4, 2.0e-4 * wave),
            };
            contact.step(if step % 5 == 0 { 0.0 } else { 0.02 }, load).unwrap();
            if step % 7 == 0 {
                snapshot.restore(&contact).unwrap();
            }
            if step % 11 == 0 {
                contact.restore(&snapshot).unwrap();
            }
        }
    });
    let ramp = Ramp::new(Load::force(0.1), Load::force(1.0), 1.0).unwrap();
    for stepping in [Stepping::fixed(0.02), Stepping::adaptive(1.0e-4)] {
        let mut contact = StatesContact::new(&states, &body).unwrap();
        let mut run = contact.follow(&ramp, stepping, 2.0);
        // an adaptive run looks at its history before the first step
        run.next_step().unwrap();
        allocates_nothing(stepping, || while run.next_step().unwrap().is_some() {});
    }
}

pub fn steps_allocate_nothing() {
    let scene = StepLoadedSphere::zener();
    for (cells, symmetry) in [(32, true), (32, false), (45, true)] {
        let whole = Settings::default().with_symmetry(symmetry).with_window(false);
        let mut contact = scene.contact(cells, whole).unwrap();
        allocates_nothing(cells, || {
            contact.step(0.0, Load::force(1.0)).unwrap();
            (0..80).for_each(|k| _ = contact.step(0.02, Load::force(1.0 - 0.01 * f64::from(k))).unwrap());
        });

        // a window takes memory while it grows, and then no more
        let wide = Grid::square(3 * cells, 3.0 * scene.grid(cells).unwrap().lengths()[0]).unwrap();
        let mut contact = scene.contact_on(wide, Settings::default().with_symmetry(symmetry)).unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        allocates_nothing(cells, || {
            (0..80).for_each(|k| _ = contact.step(0.02, Load::force(1.0 - 0.012 * f64::from(k))).unwrap());
        });
    }

    // nor, after the first two, do steps of runs
    for stepping in [Stepping::fixed(0.05), Stepping::adaptive(1.0e-4)] {
        let mut contact = scene.contact(48, Settings::default().with_window(false)).unwrap();
        let ramp = Ramp::new(Load::force(0.1), Load::force(1.0), 1.0).unwrap();
        let mut run = contact.follow(&ramp, stepping, 2.0);
        (0..2).for_each(|_| _ = run.next_step().unwrap());
        allocates_nothing(stepping, || while run.next_step().unwrap().is_some() {});
    }

    // nor do steps over the bodies, on any kernel, with several relaxation times
    let body = || {
        let terms = [(1.0e6, 0.1), (1.0e6, 1.0), (1.0e6, 10.0)];
        Material::incompressible(GeneralizedMaxwell::new(1.0e6, &terms).unwrap())
    };
    let (line, plane) = (Grid::new([256, 1], [8.0e-3, 1.0]).unwrap(), Grid::square(48, 8.0e-3).unwrap());
    let sheet = Layer::bonded_to_rigid(2.0e-3, 0.5).unwrap();
    let kernels = [
        (InfluenceKernel::line(&line, 1.0), 100.0),
        (InfluenceKernel::half_space(&plane), 0.5),
        (InfluenceKernel::periodic(&plane), 0.5),
        (InfluenceKernel::periodic_along(&plane, Axis::X1, 1.0), 0.5),
        (InfluenceKernel::layer(&plane, sheet), 0.5),
        (InfluenceKernel::layer_periodic_along(&plane, sheet, Axis::X1, None), 0.5),
    ];
    for (kernel, force) in kernels {
        let kernel = std::sync::Arc::new(kernel.unwrap());
        let settings = Settings::default().with_frame(Frame::Indenter).with_symmetry(false);
        let builder = builder_of(&Ellipsoid::new(10.0e-3, 10.0e-3).unwrap(), kernel.grid().clone(), body());
        let mut contact = builder.kernel(kernel).settings(settings).build().unwrap();
        allocates_nothing(contact.fields().kernel().to_string(), || {
            contact.step(0.0, Load::force(force)).unwrap();
            (0..40).for_each(|_| _ = contact.step_over([1, 0], 0.02, Load::force(force)).unwrap());
        });
    }

    // nor do steps at a temperature that changes, unless it changes the rate of creep by many decades within a step
    let law = TimeTemperature::wlf(17.44, 51.6, 373.15).unwrap();
    let courses = [
        TemperatureHistory::table(law.clone(), &[(0.0, 373.15), (30.0, 393.15), (40.0, 383.15)]),
        TemperatureHistory::function(law, |t| 380.0 + 5.0 * (0.2 * t).sin(), &[]),
    ];
    for course in courses.map(Result::unwrap) {
        let builder = builder_of(&sphere(), plane.clone(), body()).settings(Settings::default().with_window(false));
        let mut contact = builder.temperature(course.clone()).build().unwrap();
        contact.step(0.0, Load::force(0.5)).unwrap();
        allocates_nothing(&course, || (0..40).for_each(|_| _ = contact.step(0.5, Load::force(0.5)).unwrap()));
        let load = StepLoad::new(Load::force(0.6)).unwrap();
        let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 60.0);
        (0..2).for_each(|_| _ = run.next_step().unwrap());
        allocates_nothing(&course, || while run.next_step().unwrap().is_some() {});
    }

    // nor do snapshots, taken into the memory of one before, and restored
    for frame in [Frame::Bodies, Frame::Indenter] {
        let mut contact = sphere_on(plane.clone(), body(), Settings::default().with_window(false).with_frame(frame));
        contact.step(0.0, Load::force(0.5)).unwrap();
        let mut snapshot = contact.snapshot();
        allocates_nothing(frame, || {
            for _ in 0..20 {
                contact.step(0.01, Load::force(0.5)).unwrap();
                contact.snapshot_into(&mut snapshot);
                contact.step(0.01, Load::force(0.4)).unwrap();
                contact.restore(&snapshot).unwrap();
            }
        });
    }
}

/// Solutions of an elastic contact, warm and after jumps of the load, from the third on; bytes are what the builder announces.
pub fn elastic_solutions_allocate_nothing() {
    for (cells, symmetry, window) in [(64, true, true), (64, false, false), (96, true, false), (150, false, false)] {
        let settings = Settings::default().with_symmetry(symmetry).with_window(window).with_edge(Edge::Allow);
        let grid = Grid::square(cells, 4.0e-3).unwrap();
        let kernel = std::sync::Arc::new(InfluenceKernel::half_space(&grid).unwrap());
        let builder = ElasticContact::builder(grid).geometry(&sphere()).modulus(4.0e6).kernel(kernel);
        let builder = builder.settings(settings);
        let announced = builder.memory().unwrap() as f64;
        let region = Region::new(ALLOCATOR);
        let mut contact = builder.build().unwrap();
        contact.solve(Load::force(1.0)).unwrap();
        let change = region.change();
        let taken = change.bytes_allocated as f64 - change.bytes_deallocated as f64;
        // the gap is evaluated before
        let gap = 8.0 * (cells * cells) as f64;
        let off = (taken + gap - announced).abs();
        assert!(window || off < 0.05 * announced + 16.0e3, "{cells} {settings:?}: {taken} of {announced}");
        contact.solve(Load::force(0.5)).unwrap();
        for step in 0..20 {
            let load = Load::force(10f64.powi(-(step % 4)));
            let region = Region::new(ALLOCATOR);
            contact.solve(load).unwrap();
            let change = region.change();
            assert_eq!((change.allocations, change.reallocations), (0, 0), "{cells} {step}: {change:?}");
        }
    }
}

/// Steps of contacts with friction, once the rectangle of cells that it works on no longer grows.
pub fn sheared_steps_allocate_nothing() {
    let grid = Grid::square(40, 4.0e-3).unwrap();
    let kernels = [InfluenceKernel::half_space(&grid), InfluenceKernel::periodic(&grid)].map(Result::unwrap);
    for kernel in kernels {
        let name = format!("{kernel:?}");
        let ball = builder_of(&sphere(), grid.clone(), zener()).kernel(kernel);
        let mut contact = FrictionContact::new(ball, Coulomb::new(0.5).unwrap()).unwrap();
        let mut step = |k: u32| {
            let (part, normal) = (0.02 * f64::from(k % 10), Load::force(1.0 - 0.003 * f64::from(k)));
            let shear = ShearLoad::force([part, 0.1 - part]).with_torque(1.0e-5 * part);
            let shear = if k % 7 == 6 { ShearLoad::motion([1.0e-6 * part, 0.0]) } else { shear };
            let outcome = contact.step(if k.is_multiple_of(4) { 0.0 } else { 0.1 }, normal, shear).unwrap();
            assert!(matches!(outcome, Outcome::Holds(_)), "{name}: {outcome:?}");
        };
        (0..3).for_each(&mut step);
        allocates_nothing(&name, || (3..40).for_each(&mut step));
        let along = Ramp::new(Load::force(0.0), Load::force(0.3), 1.0).unwrap();
        contact = contact.sheared_by(ShearHistory::new(along, StepLoad::new(Load::force(0.0)).unwrap()));
        let mut run = contact.into_follow(StepLoad::new(Load::force(0.8)).unwrap(), Stepping::adaptive(1.0e-2), 6.0);
        (0..4).for_each(|_| _ = run.next_step().unwrap());
        allocates_nothing(&name, || while run.next_step().unwrap().is_some() {});
    }
}
