//! Indenters that move: two frames that must agree, energy, roughness of either body, and steps that fail.

use crate::common::{builder_of, contact_of, elastic, sphere_on};
use approx::assert_abs_diff_eq;

use crate::common::refused::{not_covered, refused};
use crate::common::rough::self_affine;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

fn zener() -> Material {
    Material::incompressible(Zener::with_time(1.0e6, 0.4e6, 0.05).unwrap())
}

/// On a half-space, or on a line of cells.
fn builder(grid: &Grid, shape: &dyn Geometry, frame: Frame) -> Builder {
    let settings = Settings::default().with_frame(frame).with_tolerance(1e-9);
    let on = |grid: &Grid| {
        if grid.cells()[1] == 1 { InfluenceKernel::line(grid, 1.0) } else { InfluenceKernel::half_space(grid) }
    };
    builder_of(shape, grid.clone(), zener()).settings(settings).kernel(on(grid).unwrap())
}

/// The greatest difference of two pressures, relative to the greatest pressure.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    let greatest = other.iter().copied().fold(0.0, f64::max);
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest
}

/// A ball on a half-space: the moving grid takes in undisturbed bodies ahead, and keeps those behind as long as they matter.
#[test]
fn frames_agree_on_a_half_space() {
    let track = Grid::new([96, 24], [9.6e-3, 2.4e-3]).unwrap();
    let grid = Grid::new([64, 24], [6.4e-3, 2.4e-3]).unwrap();
    let at = |x1: f64| Shifted::new(Sphere::new(5.0e-3).unwrap(), [x1, 0.0]).unwrap();
    let (load, dt) = (Load::force(0.1), 2.0e-3);
    // both begin with the ball at the 20th cell from the front of the smaller grid
    let travel = Travel::new(Sphere::new(5.0e-3).unwrap(), Straight::new([-3.35e-3, 0.0], [0.1e-3 / dt, 0.0]).unwrap());
    let mut fixed = builder(&track, &travel.shape_at(0.0).unwrap(), Frame::Bodies).build().unwrap();
    let mut moving = builder(&grid, &at(1.25e-3), Frame::Indenter).build().unwrap();
    fixed.step(0.0, load).unwrap();
    moving.step(0.0, load).unwrap();
    for step in 1..=30 {
        fixed.step_along(&travel, dt, load).unwrap();
        moving.step_over([1, 0], dt, load).unwrap();
        let offset = 14 + step - 44;
        for i in 0..64_isize {
            let k = i + offset;
            let rows = |contact: &ViscoelasticContact, i: usize| contact.pressure()[i * 24..(i + 1) * 24].to_vec();
            let here = rows(&moving, i as usize);
            let there = usize::try_from(k).map_or(vec![0.0; 24], |k| rows(&fixed, k));
            let greatest = fixed.fields().max_pressure();
            assert!(here.iter().zip(&there).all(|(a, b)| (a - b).abs() < 1e-5 * greatest), "step {step}, row {i}");
        }
        assert!((fixed.approach() / moving.approach() - 1.0).abs() < 1e-7, "{step}");
    }
    assert!(moving.fields().slope_force(&at(1.25e-3))[0] > 0.01 * moving.force());
}

/// What force and lateral force do at a contact is what the pressure does at the surface: Σ p Δu = W Δω + F Δs, to second
/// order in the step.
#[test]
fn the_work_of_the_loads_is_the_work_at_the_surface() {
    let grid = Grid::new([128, 1], [8.0e-3, 1.0]).unwrap();
    let errors = [16, 32, 64].map(|steps: usize| {
        let (load, dt) = (Load::force(150.0), 0.016 / steps as f64);
        let path = FnPath::new(|t: f64| [1.0e-3 * (200.0 * t).sin(), 0.0]);
        let travel = Travel::new(Cylinder::new(8.0e-3).unwrap(), path);
        let mut contact = builder(&grid, &travel.shape_at(0.0).unwrap(), Frame::Bodies).build().unwrap();
        contact.step(0.0, load).unwrap();
        let (mut inside, mut outside) = (0.0, 0.0);
        let state =
            |contact: &ViscoelasticContact| (contact.pressure().to_vec(), contact.fields().displacement().to_vec());
        for _ in 0..steps {
            let (p, u) = state(&contact);
            let before = (contact.fields().slope_force(&travel.shape_at(contact.time()).unwrap()), contact.approach());
            let from = travel.position(contact.time()).unwrap();
            let report = contact.step_along(&travel, dt, load).unwrap();
            let (q, w) = state(&contact);
            let pairs = p.iter().zip(&q).zip(u.iter().zip(&w));
            inside += pairs.map(|((p, q), (u, w))| 0.5 * (p + q) * (w - u)).sum::<f64>() * grid.cell_area();
            outside += 150.0 * (contact.approach() - before.1)
                + 0.5 * (report.lateral_force[0] + before.0[0]) * (report.position[0] - from[0]);
        }
        assert!(outside > 0.0);
        (inside / outside - 1.0).abs()
    });
    println!("{errors:?}");
    assert!(errors[0] < 0.05 && errors[2] < 0.35 * errors[1] && errors[1] < 0.4 * errors[0], "{errors:?}");
}

/// Elastic bodies give back what they take, cell by cell or in between: over a period of the track the lateral force is zero
/// on average, and the state where it was.
#[test]
fn elastic_bodies_dissipate_nothing() {
    let grid = Grid::square(48, 1.0e-3).unwrap();
    let spec = self_affine(0.5e-3, 0.1e-3, 3);
    let slider = Rough::new(&grid, spec).unwrap();
    let travel = Travel::new(slider.clone(), Straight::new([0.0; 2], [1.0e-3, 0.0]).unwrap());
    let track = Rough::new(&grid, spec.with_seed(4)).unwrap();
    let mut contact = builder_of(&Sum::new(slider, track.clone()), grid.clone(), elastic())
        .kernel(InfluenceKernel::periodic(&grid).unwrap())
        .build()
        .unwrap();
    let travel = travel.over(track);
    contact.step(0.0, Load::force(0.02)).unwrap();
    let (approach, pressure) = (contact.approach(), contact.pressure().to_vec());
    let (mut sum, mut greatest) = (0.0, 0.0_f64);
    for _ in 0..100 {
        let report = contact.step_along(&travel, 0.01, Load::force(0.02)).unwrap();
        sum += report.lateral_force[0];
        greatest = greatest.max(report.lateral_force[0].abs());
    }
    assert!(greatest > 1e-4, "the surfaces are rough: {greatest}");
    assert!((sum / 100.0).abs() < 0.02 * greatest, "{sum} {greatest}");
    assert_abs_diff_eq!(contact.approach() / approach, 1.0, epsilon = 1e-6);
    assert!(apart(contact.pressure(), &pressure) < 1e-3);
}

/// Roughness of the creeping body stays in place, roughness of a slider moves: on a body that does not creep the gap is that of the shapes shifted
/// by hand, and the scenes are not equal.
#[test]
fn roughness_moves_with_the_body_that_has_it() {
    let grid = Grid::new([128, 1], [8.0e-3, 1.0]).unwrap();
    let waves = || Wavy::new(2.0e-6, 1.0e-3).unwrap();
    let cylinder = || Cylinder::new(10.0e-3).unwrap();
    let path = Straight::new([-1.0e-3, 0.0], [0.1, 0.0]).unwrap();
    let sliding = Travel::new(Sum::new(cylinder(), waves()), path);
    let rolling = Travel::new(cylinder(), path).over(waves());
    for (travel, off) in [(&sliding, 3.3e-4), (&rolling, 0.0)] {
        // at a place where the waves of both lie differently
        let time = 1.33e-2;
        let shape = Sum::new(
            Shifted::new(cylinder(), [-1.0e-3 + 0.1 * time, 0.0]).unwrap(),
            Shifted::new(waves(), [off, 0.0]).unwrap(),
        );
        let start = Sum::new(Shifted::new(cylinder(), [-1.0e-3, 0.0]).unwrap(), waves());
        let pressed = |start: &dyn Geometry| {
            builder_of(start, grid.clone(), elastic())
                .kernel(InfluenceKernel::line(&grid, 1.0).unwrap())
                .settings(Settings::default().with_tolerance(1e-9))
                .build()
                .unwrap()
        };
        let (mut moved, mut by_hand) = (pressed(&start), pressed(&shape));
        moved.step_along(travel, time, Load::force(60.0)).unwrap();
        by_hand.step(0.0, Load::force(60.0)).unwrap();
        assert!(apart(moved.pressure(), by_hand.pressure()) < 1e-6, "{off}");
    }
    let end = |travel: &Travel| {
        let start = Sum::new(Shifted::new(cylinder(), [-1.0e-3, 0.0]).unwrap(), waves());
        let mut contact = builder(&grid, &start, Frame::Bodies).build().unwrap();
        contact.step(0.0, Load::force(60.0)).unwrap();
        // to a place where the waves of both lie alike again
        for _ in 0..40 {
            contact.step_along(travel, 5.0e-4, Load::force(60.0)).unwrap();
        }
        contact
    };
    let (sliding, rolling) = (end(&sliding), end(&rolling));
    let apart = apart(sliding.pressure(), rolling.pressure());
    assert!(apart > 0.01, "{apart}");
}

#[test]
fn steps_that_fail_leave_the_indenter_where_it_was() {
    let grid = Grid::square(32, 4.0e-3).unwrap();
    let sphere = || Sphere::new(5.0e-3).unwrap();
    let load = Load::force(0.1);
    let travel = Travel::new(sphere(), Straight::new([0.0; 2], [0.01, 0.0]).unwrap());
    let mut contact = builder(&grid, &sphere(), Frame::Bodies).build().unwrap();
    contact.step(0.0, load).unwrap();
    contact.step_along(&travel, 0.01, load).unwrap();
    let mut twin = contact.clone();
    // over the edge, and nowhere
    assert!(matches!(contact.step_along(&travel, 0.2, load), Err(Error::Step(StepError::ContactAtEdge { .. }))));
    let lost = Travel::new(sphere(), FnPath::new(|_| [f64::NAN, 0.0]));
    assert!(matches!(contact.step_along(&lost, 0.01, load), Err(Error::OutOfRange { field: "position along x1", .. })));
    contact.step(0.01, load).unwrap();
    twin.step(0.01, load).unwrap();
    assert!(apart(contact.pressure(), twin.pressure()) < 1e-6);

    not_covered([(contact.step_over([1, 0], 0.01, load).err(), "on a grid that is fixed to the bodies")]);
    let mut moving = builder(&grid, &sphere(), Frame::Indenter).build().unwrap();
    not_covered([(moving.step_along(&travel, 0.01, load).err(), "on a grid that is fixed to the indenter")]);
    moving.step(0.0, load).unwrap();
    moving.step_over([2, 0], 0.01, load).unwrap();
    let mut twin = moving.clone();
    refused([
        (moving.step_over([2, 0], 0.01, Load::eccentric_force(0.1, [1.0, 0.0])).err(), "outside the convex hull"),
        (moving.step_over([2, 0], 0.01, Load::force(30.0)).err(), "touches the edge of the grid"),
    ]);
    moving.step_over([1, 0], 0.01, load).unwrap();
    twin.step_over([1, 0], 0.01, load).unwrap();
    assert!(apart(moving.pressure(), twin.pressure()) < 1e-6);
}

/// A step along a path costs what a step in place does, and a guess that goes on is worth having.
#[test]
fn steps_along_a_path_cost_as_much_as_steps_in_place() {
    let grid = Grid::new([192, 64], [12.0e-3, 4.0e-3]).unwrap();
    let travel = Travel::new(Sphere::new(10.0e-3).unwrap(), Straight::new([-4.0e-3, 0.0], [0.1, 0.0]).unwrap());
    let mut contact = contact_of(&travel.shape_at(0.0).unwrap(), grid.clone(), zener(), Settings::default());
    contact.step(0.0, Load::force(0.5)).unwrap();
    let mut work = 0;
    for _ in 0..60 {
        work += contact.step_along(&travel, 0.7 * grid.spacing()[0] / 0.1, Load::force(0.5)).unwrap().step.convolutions;
    }
    println!("{} convolutions per step", f64::from(work as u32) / 60.0);
    assert!(work < 60 * 9, "{work}");
}

/// A step of no length under the same load changes nothing, however stiff it is beside the hold before it: what the solver
/// left over in the hold is laid on the rigid body, in both frames.
#[test]
fn a_jump_to_the_same_load_changes_nothing() {
    for stiff in [1e2, 1e3, 1e4, 1e5] {
        for (frame, force, hold) in
            [(Frame::Bodies, 0.02, 1.0e6), (Frame::Indenter, 0.02, 1.0e6), (Frame::Bodies, 1.0, 10.0)]
        {
            let (soft, time) = if force < 1.0 { (1.0e5, 0.01) } else { (1.0e6, 1.0) };
            let body = Material::incompressible(Zener::new(soft * stiff, soft, soft * time).unwrap());
            let mut contact = sphere_on(Grid::square(64, 4.0e-3).unwrap(), body, Settings::default().with_frame(frame));
            contact.step(0.0, Load::force(force)).unwrap();
            contact.step(hold, Load::force(force)).unwrap();
            let before = contact.pressure().to_vec();
            contact.step(0.0, Load::force(force)).unwrap();
            let apart = apart(&before, contact.pressure());
            assert!(apart < 1e-4, "{frame:?} {stiff}: {apart}");
        }
    }
}

/// What presses on the rim of a face has no slope, but does work all the same.
#[test]
fn power_counts_the_rim_of_a_punch() {
    let grid = Grid::new([256, 1], [16.0e-3, 1.0]).unwrap();
    let punch = || FlatPunch::rectangular([3.0e-3, 3.0]).unwrap();
    let travel = Travel::new(punch(), Straight::new([-3.0e-3, 0.0], [0.05, 0.0]).unwrap());
    let mut contact = builder(&grid, &travel.shape_at(0.0).unwrap(), Frame::Bodies).build().unwrap();
    contact.step(0.0, Load::force(100.0)).unwrap();
    let (mut along, mut inside, start) = (0.0, 0.0, contact.approach());
    for _ in 0..40 {
        let (p, u) = (contact.pressure().to_vec(), contact.fields().displacement().to_vec());
        let dt = grid.spacing()[0] / 0.05;
        let report = contact.step_along(&travel, dt, Load::force(100.0)).unwrap();
        along += report.power * dt;
        let ends = p.iter().zip(contact.pressure()).zip(u.iter().zip(contact.fields().displacement()));
        inside += ends.map(|((p, q), (u, w))| 0.5 * (p + q) * (w - u)).sum::<f64>() * grid.cell_area();
        assert_eq!(report.lateral_force[0], 0.0);
    }
    let pressed = 100.0 * (contact.approach() - start);
    assert!(along > 0.05 * inside && ((along + pressed) / inside - 1.0).abs() < 1e-9, "{along} {pressed} {inside}");
}

#[test]
fn several_bodies_move_together() {
    let grid = Grid::new([128, 1], [8.0e-3, 1.0]).unwrap();
    let at = |x: f64| Shifted::new(Cylinder::new(5.0e-3).unwrap(), [x, 0.0]).unwrap();
    let mut two = builder(&grid, &at(-1.0e-3), Frame::Indenter).another_body(&at(2.0e-3)).build().unwrap();
    let loads = [Load::force(15.0), Load::force(10.0)];
    for _ in 0..40 {
        two.step_over([1, 0], 1.0e-3, loads).unwrap();
    }
    assert_abs_diff_eq!(two.fields().body(1).unwrap().force / 10.0, 1.0, epsilon = 1e-9);
    assert!(matches!(two.step_over([1, 0], 1.0e-3, loads[0]), Err(Error::WrongLength { .. })));
}
