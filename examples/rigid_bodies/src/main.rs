//! A ball and a box on a creeping floor: rigid bodies moved by the engine `rapier3d`, at 1 kHz, on a contact of this crate.
//!
//! The engine has weight, inertia and the collision of ball and box, but no floor. After each of its steps the
//! poses of the bodies are the approaches and the tilt of two indenters on one floor, which returns force and moments;
//! these act on the bodies in its next step. The floor, an incompressible standard solid, creeps to four times its
//! elastic compliance. Its pressure has no friction but that of its own loss under the moving ball; Coulomb's
//! friction is added by hand.
//!
//! The engine advances velocities by the force at the start of a step, then positions by the new velocities: a velocity
//! belongs to the middle of its step, and the exchange of poses and forces is a leapfrog, of second order and without
//! energy of its own. The energy of the bodies and all that floor and friction took from them stay constant, except that
//! the collision takes its part. One thing is neglected: the ball pushes the box by a millimetre, and the imprint of the
//! box goes with it.
//!
//! `cargo run --release --manifest-path examples/rigid_bodies/Cargo.toml`

#[path = "../../support/mod.rs"]
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
use rapier3d_f64::prelude::{ColliderBuilder, PhysicsWorld, RigidBody, RigidBodyBuilder, RigidBodyHandle, Vector};
use viscocontact::Result;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
use viscocontact::prelude::*;

/// A ball and a box on a creeping floor.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus of the incompressible floor [Pa].
    #[arg(long, default_value_t = 0.4e6)]
    modulus: f64,
    /// Its retardation time [s].
    #[arg(long, default_value_t = 0.1)]
    tau: f64,
    /// Time step of engine and contact [s].
    #[arg(long, default_value_t = 1.0e-3)]
    dt: f64,
    /// Steps.
    #[arg(long, default_value_t = 1000)]
    steps: usize,
    /// Height from which the bodies fall [m].
    #[arg(long, default_value_t = 1.0e-3)]
    drop: f64,
    /// Velocity of the ball towards the box [m/s].
    #[arg(long, default_value_t = 0.3)]
    velocity: f64,
    /// Coefficient of friction on the floor.
    #[arg(long, default_value_t = 0.5)]
    friction: f64,
    /// Cells along the box, which takes five twelfths of the grid.
    #[arg(long, default_value_t = 50)]
    cells: usize,
    /// Coarse and fast: 25 cells along the box.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/rigid_bodies")]
    output: PathBuf,
}

/// Creep of the floor after a long time over its elastic response.
const CREEP: f64 = 3.0;
/// A ball of steel, a box of aluminium [m], [kg/m³].
const RADIUS: f64 = 20.0e-3;
const BOX: [f64; 3] = [50.0e-3, 50.0e-3, 60.0e-3];
const DENSITY: [f64; 2] = [7800.0, 2700.0];
const RESTITUTION: f64 = 0.5;
const GRAVITY: f64 = 9.81;
/// Tilt at which the box falls [rad].
const TILT: f64 = 5.0e-3;
/// Where ball and box start along x1, from the middle of the grid [m].
const START: [f64; 2] = [-45.0e-3, 30.0e-3];
/// Sides of the grid over the side of the box.
const GRID: [f64; 2] = [2.4, 1.2];

fn main() {
    let mut args = Args::parse();
    if args.quick {
        args.cells = 25;
    }
    support::finish(run(&args));
}

/// A force at the centre of mass, and a torque about it.
#[derive(Clone, Copy)]
struct Push {
    force: Vector,
    torque: Vector,
}

impl Push {
    const NONE: Push = Push { force: Vector::ZERO, torque: Vector::ZERO };

    fn at(force: Vector, point: Vector, body: &RigidBody) -> Push {
        Push { force, torque: (point - body.center_of_mass()).cross(force) }
    }

    /// Coulomb's friction at a point that carries a normal force.
    fn friction(args: &Args, normal: f64, point: Vector, body: &RigidBody) -> Push {
        let sliding = body.velocity_at_point(point).with_z(0.0);
        // no more than a quarter of what would stop the body in a step: a body at rest is not shaken
        let limit = 0.25 * body.mass() * sliding.length() / args.dt;
        Push::at(-(args.friction * normal).min(limit) * sliding.normalize_or_zero(), point, body)
    }

    /// The power on a body at a velocity and an angular velocity [W].
    fn power(&self, [linear, angular]: [Vector; 2]) -> f64 {
        self.force.dot(linear) + self.torque.dot(angular)
    }
}

fn velocities(body: &RigidBody) -> [Vector; 2] {
    [body.linvel(), body.angvel()]
}

/// A state of both bodies, ball first.
#[derive(Clone, Copy)]
struct Moment {
    time: f64,
    approach: [f64; 2],
    force: [f64; 2],
    /// Position of the bodies along x1 [m], tilt of the box [rad].
    position: [f64; 2],
    tilt: f64,
    /// Energy of the bodies, relative to rest on the undeformed floor; taken by the floor; by friction [J].
    energy: [f64; 3],
}

/// Engine and floor; of each body, ball first: pressure, friction.
struct Scene {
    world: PhysicsWorld,
    bodies: [RigidBodyHandle; 2],
    floor: ViscoelasticContact,
    face: Shifted,
    pressure: [Push; 2],
    friction: [Push; 2],
    /// Energy that pressure and friction took from the bodies [J].
    taken: [f64; 2],
    /// Time spent in the engine, in the contact, and in its longest step.
    spent: [Duration; 3],
}

impl Scene {
    fn new(args: &Args) -> Result<Scene, Box<dyn Error>> {
        let mut world = PhysicsWorld { gravity: -GRAVITY * Vector::Z, ..PhysicsWorld::default() };
        let parameters = &mut world.integration_parameters;
        // one force per step: the force at its start
        (parameters.dt, parameters.num_solver_iterations, parameters.length_unit) = (args.dt, 1, RADIUS);
        let ball = RigidBodyBuilder::dynamic()
            .translation(Vector::new(START[0], 0.0, RADIUS + args.drop))
            .linvel(args.velocity * Vector::X);
        let block = RigidBodyBuilder::dynamic()
            .translation(Vector::new(START[1], 0.0, 0.5 * BOX[2] + 0.5 * BOX[0] * TILT + args.drop))
            .rotation(TILT * Vector::Y);
        let [x, y, z] = BOX.map(|side| 0.5 * side);
        let shapes = [ColliderBuilder::ball(RADIUS), ColliderBuilder::cuboid(x, y, z)];
        let [ball_shape, block_shape] = shapes.map(|shape| shape.restitution(RESTITUTION));
        let bodies = [
            world.insert(ball.can_sleep(false), ball_shape.density(DENSITY[0])).0,
            world.insert(block.can_sleep(false), block_shape.density(DENSITY[1])).0,
        ];

        let kelvin = args.modulus / CREEP;
        let body = Zener::with_time(args.modulus, kelvin, args.tau)?;
        let cells = GRID.map(|sides| (sides * args.cells as f64).round() as usize);
        let grid = Grid::new(cells, [0, 1].map(|axis| cells[axis] as f64 * BOX[axis] / args.cells as f64))?;
        let face = Shifted::new(FlatPunch::rectangular([BOX[0], BOX[1]])?, [START[1], 0.0])?;
        let floor = ViscoelasticContact::builder(grid)
            .geometry(&ball_at([START[0], 0.0]))
            .another_body(&face)
            .material(Material::incompressible(body))
            .build()?;
        let ([pressure, friction], spent) = ([[Push::NONE; 2]; 2], [Duration::ZERO; 3]);
        Ok(Scene { world, bodies, floor, face, pressure, friction, taken: [0.0; 2], spent })
    }

    fn body(&self, k: usize) -> &RigidBody {
        &self.world.bodies[self.bodies[k]]
    }

    /// One step of the engine under the forces of the floor, and one of the floor.
    fn step(&mut self, args: &Args) -> Result<()> {
        let before = [0, 1].map(|k| velocities(self.body(k)));
        let start = Instant::now();
        self.world.step();
        self.spent[0] += start.elapsed();
        for (k, [linear, angular]) in before.into_iter().enumerate() {
            let [new_linear, new_angular] = velocities(self.body(k));
            let mean = [0.5 * (linear + new_linear), 0.5 * (angular + new_angular)];
            self.taken[0] -= self.pressure[k].power(mean) * args.dt;
            self.taken[1] -= self.friction[k].power(mean) * args.dt;
        }

        let start = Instant::now();
        self.press(args)?;
        let took = start.elapsed();
        (self.spent[1], self.spent[2]) = (self.spent[1] + took, self.spent[2].max(took));
        for (k, handle) in self.bodies.into_iter().enumerate() {
            let body = &mut self.world.bodies[handle];
            body.reset_forces(true);
            body.reset_torques(true);
            body.add_force(self.pressure[k].force + self.friction[k].force, true);
            body.add_torque(self.pressure[k].torque + self.friction[k].torque, true);
        }
        Ok(())
    }

    /// Moves the indenters to the poses of the bodies, and finds what the floor does to them.
    fn press(&mut self, args: &Args) -> Result<()> {
        let [ball, block] = [0, 1].map(|k| &self.world.bodies[self.bodies[k]]);
        let (center, up) = (ball.translation(), block.rotation() * Vector::Z);
        let face = block.translation() - 0.5 * BOX[2] * up;
        // the load has the approach of the middle of the grid
        let tilt = [up.x / up.z, up.y / up.z];
        let loads = [Load::approach(RADIUS - center.z), Load::approach_and_tilt(-face.z - tilt[0] * START[1], tilt)];
        let cap = ball_at([center.x, center.y]);
        self.floor.set_geometries(&[&cap, &self.face])?;
        self.floor.step(args.dt, &loads)?;

        let [(ball_force, _), (block_force, moment)] = self.forces();
        let [x, y] = self.floor.fields().slope_force(&cap);
        // all pressure under the ball acts towards its centre
        self.pressure[0] = Push { force: Vector::new(-x, -y, ball_force), torque: Vector::ZERO };
        self.pressure[1] = Push::at(block_force * Vector::Z, face, block);
        self.pressure[1].torque += Vector::new(moment[1], START[1] * block_force - moment[0], 0.0);
        self.friction[0] = Push::friction(args, ball_force, center - RADIUS * Vector::Z, ball);
        self.friction[1] = Push::friction(args, block_force, face, block);
        Ok(())
    }

    /// Forces of the floor on ball and box [N], and moments about the middle of the grid [N·m].
    fn forces(&self) -> [(f64, [f64; 2]); 2] {
        [0, 1].map(|k| self.floor.fields().body(k).map_or((0.0, [0.0; 2]), |body| (body.force, body.moment)))
    }

    fn weights(&self) -> [f64; 2] {
        [0, 1].map(|k| self.body(k).mass() * GRAVITY)
    }

    fn moment(&self, args: &Args) -> Moment {
        let (heights, up) = ([RADIUS, 0.5 * BOX[2]], self.body(1).rotation() * Vector::Z);
        let above = |k: usize| heights[k] - self.body(k).translation().z;
        // the engine takes both energies in the middle of its last step
        let energy = |k: usize| {
            let body = self.body(k);
            let potential = body.gravitational_potential_energy(args.dt, self.world.gravity);
            body.kinetic_energy() + potential - self.weights()[k] * heights[k]
        };
        Moment {
            time: self.floor.time(),
            approach: [above(0), above(1)],
            force: self.forces().map(|(force, _)| force),
            position: [0, 1].map(|k| self.body(k).translation().x),
            tilt: up.x / up.z,
            energy: [energy(0) + energy(1), self.taken[0], self.taken[1]],
        }
    }
}

/// The ball as far as its radius, above the point `at`.
fn ball_at(at: [f64; 2]) -> impl Geometry {
    FnGeometry::new(move |x1: f64, x2: f64| {
        let square = (x1 - at[0]).powi(2) + (x2 - at[1]).powi(2);
        if square < RADIUS * RADIUS { 0.5 * square / RADIUS } else { f64::INFINITY }
    })
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let mut scene = Scene::new(args)?;
    let mut all = vec![scene.moment(args)];
    for _ in 0..args.steps {
        scene.step(args)?;
        all.push(scene.moment(args));
    }
    println!("{:>6} {:>19} {:>17} {:>9} {:>9} {:>29}", "t", "approach [mm]", "force [N]", "gap", "tilt", "energy [mJ]");
    println!(
        "{:>6} {:>9} {:>9} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "[ms]", "ball", "box", "ball", "box", "[mm]", "[mrad]", "bodies", "floor", "friction"
    );
    let mut table = csv::Writer::from_path(args.output.join("rigid_bodies.csv"))?;
    table.write_record([
        "t",
        "approach_ball",
        "approach_box",
        "force_ball",
        "force_box",
        "ball_x1",
        "box_x1",
        "tilt_box",
    ])?;
    for (k, m) in all.iter().enumerate() {
        table.serialize((m.time, m.approach, m.force, m.position, m.tilt))?;
        if k % 100 == 0 || [10, 20, 30, 50].contains(&k) {
            let ([a, b], [f, g], [e, w, r]) = (m.approach, m.force, m.energy);
            let apart = m.position[1] - m.position[0] - RADIUS - 0.5 * BOX[0];
            let [t, a, b, x, tilt, e, w, r] = [m.time, a, b, apart, m.tilt, e, w, r].map(|value| 1e3 * value);
            println!("{t:6.0} {a:9.4} {b:9.4} {f:8.3} {g:8.3} {x:9.3} {tilt:9.4} {e:9.3} {w:9.3} {r:9.3}");
        }
    }
    table.flush()?;
    pictures(args, &all, scene.weights())?;
    costs(args, &scene);
    println!("tables and pictures are in {}", args.output.display());
    check(args, &all, scene.weights())
}

/// At rest the floor carries the weights; nothing gains energy.
fn check(args: &Args, all: &[Moment], weights: [f64; 2]) -> Result<(), Box<dyn Error>> {
    let last = &all[all.len() - all.len() / 20..];
    let mut worst = 0.0_f64;
    for (k, name) in ["ball", "box"].into_iter().enumerate() {
        let mean = last.iter().map(|m| m.force[k]).sum::<f64>() / last.len() as f64;
        let swing = last.iter().map(|m| (m.force[k] / mean - 1.0).abs()).fold(0.0, f64::max);
        let error = mean / weights[k] - 1.0;
        worst = worst.max(error.abs());
        println!(
            "{name}: at rest {mean:.4} N, weight {:.4} N, error {error:.1e}, still swinging by {swing:.1e}",
            weights[k]
        );
    }
    let whole = |m: &Moment| m.energy.iter().sum::<f64>();
    let first = all[0].energy[0];
    let (mut least, mut gain) = (f64::INFINITY, f64::NEG_INFINITY);
    for m in all {
        least = least.min(whole(m));
        gain = gain.max((whole(m) - least) / first);
    }
    let lost = (first - whole(&all[all.len() - 1])) / first;
    let above = all.iter().map(|m| m.energy[0] / first - 1.0).fold(f64::NEG_INFINITY, f64::max);
    println!("energy of the bodies never above its first value by more than {above:.1e} of it");
    println!("energy with that of floor and friction: grows by {gain:.1e} at most, the collision took {lost:.3}");
    if worst > 1e-2 || gain > 1e-2 || above > 1e-2 {
        return Err(
            format!("forces at rest err by {worst:.1e}, energy grows by {gain:.1e} (steps of {} s)", args.dt).into()
        );
    }
    Ok(())
}

/// Wall-clock time of a step.
fn costs(args: &Args, scene: &Scene) {
    let [n1, n2] = scene.floor.grid().cells();
    let [engine, floor, longest] = scene.spent.map(|spent| spent.as_secs_f64() * 1e3);
    let [engine, floor] = [engine, floor].map(|spent| spent / args.steps as f64);
    println!("floor of {n1} × {n2} cells: {floor:.2} ms per step of {} ms, {longest:.1} ms the longest", args.dt * 1e3);
    println!("engine: {engine:.3} ms per step");
}

fn pictures(args: &Args, all: &[Moment], weights: [f64; 2]) -> Result<()> {
    let time = || Quantity::new("time", "s");
    let mut approaches =
        Chart::new("A ball and a box on a creeping floor", time(), Quantity::new("approach", "m"), Legend::LowerRight);
    let mut forces = Chart::new("Force of the floor", time(), Quantity::new("force", "N"), Legend::UpperRight);
    let end = all[all.len() - 1].time;
    for (label, weight) in ["weights", ""].into_iter().zip(weights) {
        forces.add(label, COLORS[6], Style::Line, vec![(0.0, weight), (end, weight)]);
    }
    for (k, name) in ["ball", "box"].into_iter().enumerate() {
        let curve = |of: fn(&Moment) -> [f64; 2]| all.iter().map(|m| (m.time, of(m)[k])).collect();
        approaches.add(name, COLORS[k], Style::Line, curve(|m| m.approach));
        forces.add(name, COLORS[k], Style::Line, curve(|m| m.force));
    }
    approaches.save(args.output.join("approach.png"))?;
    forces.save(args.output.join("force.png"))
}
