//! Scenes that one process or several ranks compute. Those drawn at random have every kernel, shapes that come down along
//! curves and are pulled off again, tilts, changing temperature, and steps that are given or chosen by their error.

use std::sync::Arc;

use viscocontact::parallel::Ranks;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

use super::bodies::zener;
use super::draws::Draws;
use super::random_histories::{Control, random_history};
use super::scene::random_shape;

/// Most steps of a run.
const MOST_STEPS: usize = 40;
const LENGTH: f64 = 4.0e-3;
const RADIUS: f64 = 10.0e-3;
const MODULUS: f64 = 1.0e6;

/// What is compared: reports as they print, to the last bit, and fields of the whole grid.
#[derive(Debug, PartialEq)]
pub struct Course {
    pub reports: Vec<String>,
    pub error: Option<String>,
    pub numbers: Vec<u64>,
    pub fields: [Vec<u64>; 2],
}

/// The steps of a scene.
pub(super) enum Steps {
    /// Lengths of the steps \[s\], and the loads at their ends.
    Given(Vec<(f64, Load)>),
    /// Along a history, up to a time \[s\].
    Along(Box<dyn LoadHistory>, Stepping, f64),
}

/// Takes the steps of a scene: a contact, or a run along a history.
pub enum Stepper<'a, 'b> {
    Contact(&'a mut ViscoelasticContact),
    Run(&'a mut Run<'b>),
}

impl Stepper<'_, '_> {
    pub fn contact(&self) -> &ViscoelasticContact {
        match self {
            Stepper::Contact(contact) => contact,
            Stepper::Run(run) => run.contact(),
        }
    }
}

pub struct AnyScene {
    pub name: String,
    pub(super) grid: Grid,
    pub(super) kernel: Arc<InfluenceKernel>,
    pub(super) shape: Box<dyn Geometry>,
    pub(super) material: Material,
    pub(super) temperature: Option<TemperatureHistory>,
    pub settings: Settings,
    pub(super) steps: Steps,
    /// How many ranks share out a random scene.
    pub size: usize,
    /// Whether a rank evaluates the shape on its own rows alone.
    pub on_own_rows: bool,
    /// Whether the stiffness and the state within the last step are compared, which take contact problems of their own.
    pub(super) probed: bool,
}

/// Cells of a line or a plane: of one band of rows, or of several.
fn cells(draws: &mut Draws, line: bool) -> [usize; 2] {
    let several = draws.chance(0.3);
    match (line, several) {
        (true, false) => [16 + draws.below(300), 1],
        (true, true) => [8193 + draws.below(17_000), 1],
        (false, false) => [4 + draws.below(40), 4 + draws.below(40)],
        // more than 256 columns: a band has 16 rows
        (false, true) => [17 + draws.below(60), 257 + draws.below(40)],
    }
}

fn layer(draws: &mut Draws) -> Layer {
    let (thickness, poisson) = (draws.power_of_ten(-4.0, -2.5), draws.between(0.2, 0.45));
    match draws.below(3) {
        0 => Layer::bonded_to_rigid(thickness, poisson),
        1 => Layer::frictionless_on_rigid(thickness, poisson),
        _ => Layer::bonded_to_half_space(thickness, poisson, draws.power_of_ten(-1.0, 1.0), 0.3),
    }
    .unwrap()
}

/// A kernel of one of twelve kinds, and Poisson's ratio of its body.
fn random_kernel(draws: &mut Draws, kind: u64) -> (Grid, InfluenceKernel, f64) {
    let layer = layer(draws);
    let line = matches!(kind, 4 | 9);
    let [n1, n2] = cells(draws, line);
    let grid = Grid::new([n1, n2], [LENGTH, if line { 1.0 } else { LENGTH * draws.between(0.6, 1.0) }]).unwrap();
    let axis = Axis::BOTH[kind as usize % 2];
    let datum = if layer.compliance(0.0).is_finite() { None } else { Some(1.0) };
    let kernel = match kind {
        0 => InfluenceKernel::half_space(&grid),
        1 => InfluenceKernel::periodic(&grid),
        2 | 3 => InfluenceKernel::periodic_along(&grid, axis, 1.0),
        4 => InfluenceKernel::line(&grid, 1.0),
        5 => InfluenceKernel::layer(&grid, layer),
        6 => InfluenceKernel::layer_periodic(&grid, layer),
        7 | 8 => InfluenceKernel::layer_periodic_along(&grid, layer, axis, datum),
        9 => InfluenceKernel::layer_line(&grid, layer, datum),
        10 => {
            let reach = LENGTH / n1.max(n2) as f64;
            InfluenceKernel::from_coefficients(&grid, move |i, j| reach * (-f64::hypot(i as f64, j as f64)).exp())
        }
        _ => InfluenceKernel::from_spectrum(
            &grid,
            |q1, q2| if q1 == 0.0 && q2 == 0.0 { 0.0 } else { 2.0 / q1.hypot(q2) },
        ),
    };
    let poisson = if (5..=9).contains(&kind) { layer.poisson_ratio() } else { 0.5 };
    // cells may be too coarse for the layer
    kernel.map(|kernel| (grid, kernel, poisson)).unwrap_or_else(|_| random_kernel(draws, kind))
}

fn material(draws: &mut Draws, poisson: f64) -> Material {
    let time = draws.power_of_ten(-2.0, 1.0);
    let terms: Vec<_> = (0..3).map(|k| (draws.power_of_ten(-1.0, 1.0) / MODULUS, time * 10f64.powi(k))).collect();
    // what creeps by much in the end is not known for longer than a part of some runs
    let times = [0.003, 0.01, 0.1, 1.0].map(|part| part * draws.between(0.5, 4.0));
    let rheology: Box<dyn Rheology> = match draws.below(6) {
        0 => Box::new(Elastic::new(MODULUS).unwrap()),
        1 => Box::new(Maxwell::new(MODULUS, MODULUS * time).unwrap()),
        2 => Box::new(Zener::new(MODULUS, MODULUS, MODULUS * time).unwrap()),
        3 => Box::new(KelvinVoigt::new(MODULUS, MODULUS * time).unwrap()),
        4 => Box::new(GeneralizedKelvin::new(1.0 / MODULUS, 0.0, &terms).unwrap()),
        _ => Box::new(
            Measurements::creep(&crate::pairs(&times, &[1.0e-6, 1.2e-6, 1.5e-6, 1.8e-6]))
                .and_then(|table| table.fit())
                .unwrap(),
        ),
    };
    Material::constant_poisson(rheology, poisson).unwrap()
}

/// A cylinder, a ridge that touches in the rows of few ranks, or any other shape.
fn shape(draws: &mut Draws, line: bool) -> Box<dyn Geometry> {
    let off = if draws.chance(0.5) { 0.1 * draws.between(-1.0, 1.0) * LENGTH } else { 0.0 };
    match draws.below(6) {
        _ if line => Box::new(Shifted::new(Cylinder::new(RADIUS).unwrap(), [off, 0.0]).unwrap()),
        0 => Box::new(FnGeometry::new(move |x1, x2| 50.0 * (x1 - 2.0 * off).powi(2) + 2.0 * x2 * x2)),
        _ => random_shape(draws, 0.25 * LENGTH).1,
    }
}

/// A random load history of one second with these tilts; some bodies are pressed by a force first, and held then.
fn history(draws: &mut Draws, lengths: [f64; 2], tilts: [bool; 2], line: bool, jumps: bool) -> Box<dyn LoadHistory> {
    let depth = draws.power_of_ten(-5.0, -4.2);
    let force = if line { 50.0 } else { 0.05 } * draws.power_of_ten(-1.0, 0.5);
    let at = [0, 1].map(|axis| if tilts[axis] { 0.04 * draws.between(-1.0, 1.0) * lengths[axis] } else { 0.0 });
    let control = match draws.below(6) {
        0 | 1 => Control::Approach { touch: 0.0, depth },
        2 => Control::by_spring(draws, 0.0, depth, force),
        3 => {
            let held =
                move |t: f64| if t < 0.4 { Load::force(force * (0.2 + t)) } else { Load::approach(depth * (1.2 - t)) };
            return Box::new(FnHistory::new(held).with_breakpoints(&[0.4]).unwrap());
        }
        4 if tilts != [false; 2] => {
            let tilt = [0, 1].map(|axis| if tilts[axis] { Tilt::Free { at: at[axis] } } else { Tilt::Fixed(0.0) });
            return Box::new(FnHistory::new(move |t| Load::Force { normal: force * (0.1 + t), tilt }));
        }
        _ => Control::Force(force),
    };
    random_history(draws, control, 1.0, jumps).history
}

/// A kernel of one of twelve kinds, Poisson's ratio of its body, and a shape on it.
pub fn shape_on_body(draws: &mut Draws, kind: u64) -> (Grid, InfluenceKernel, f64, Box<dyn Geometry>) {
    let (grid, kernel, poisson) = random_kernel(draws, kind);
    let shape = shape(draws, grid.cells()[1] == 1);
    (grid, kernel, poisson, shape)
}

impl AnyScene {
    /// The scene of a seed.
    pub fn new(seed: u64) -> AnyScene {
        let draws = &mut Draws::new(seed);
        let (grid, kernel, poisson) = random_kernel(draws, seed % 12);
        let (line, lengths) = (grid.cells()[1] == 1, grid.lengths());
        let (shape, material) = (shape(draws, line), material(draws, poisson));
        let periodic = kernel.periodic_axes();
        let symmetry = draws.chance(0.5);
        let tilts = [0, 1].map(|axis| !periodic[axis] && !symmetry && draws.chance(0.5));
        let history = history(draws, lengths, tilts, line, material.contact_compliance(0.0) > 0.0);
        let temperature = draws.chance(0.3).then(|| {
            let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
            let (from, by) = (draws.between(290.0, 310.0), draws.between(-8.0, 8.0));
            if draws.chance(0.5) {
                TemperatureHistory::table(law, &[(0.0, from), (0.6, from + by), (1.0, from)])
            } else {
                TemperatureHistory::function(law, move |t| from + by * t * t, &[])
            }
            .unwrap()
        });
        let stepping = if draws.chance(0.75) {
            Stepping::adaptive(draws.power_of_ten(-3.0, -1.3))
        } else {
            Stepping::fixed(draws.between(0.05, 0.2))
        };
        // one process computes the whole grid, too
        let settings = Settings::default().with_window(false).with_symmetry(symmetry).with_edge(Edge::Allow);
        let (size, on_own_rows) = (1 + draws.below(7), draws.chance(0.5));
        let name = format!("seed {seed}: {:?} cells, {kernel}, {material:?}, {stepping:?}, {size} ranks", grid.cells());
        let (kernel, steps) = (Arc::new(kernel), Steps::Along(history, stepping, 1.0));
        let plain = AnyScene::plain(&name, grid, shape, steps);
        AnyScene { kernel, material, temperature, settings, size, on_own_rows, probed: true, ..plain }
    }

    /// A shape on a Zener half-space, all cells of which are computed.
    pub(super) fn plain(name: &str, grid: Grid, shape: impl Geometry + 'static, steps: Steps) -> AnyScene {
        AnyScene {
            name: name.into(),
            kernel: Arc::new(InfluenceKernel::half_space(&grid).unwrap()),
            grid,
            shape: Box::new(shape),
            material: zener(),
            temperature: None,
            settings: Settings::default().with_window(false),
            steps,
            size: 1,
            on_own_rows: true,
            probed: false,
        }
    }

    /// The contact of one process, or of one of `ranks`.
    pub fn contact(&self, ranks: Option<&Arc<dyn Ranks>>) -> Result<ViscoelasticContact, Error> {
        let mut builder = ViscoelasticContact::builder(self.grid.clone());
        if let (Some(ranks), true) = (ranks, self.on_own_rows) {
            builder = builder.ranks(Arc::clone(ranks));
        }
        builder = builder.geometry(&self.shape).material(self.material.clone());
        builder = builder.kernel(Arc::clone(&self.kernel)).settings(self.settings);
        if let Some(temperature) = &self.temperature {
            builder = builder.temperature(temperature.clone());
        }
        if let (Some(ranks), false) = (ranks, self.on_own_rows) {
            builder = builder.ranks(Arc::clone(ranks));
        }
        builder.build()
    }

    /// Takes the steps after the first `from`, until `after` returns false. Returns the error budget and the number of rejected
    /// steps of a run, and the error that ends it.
    pub fn drive(
        &self,
        contact: &mut ViscoelasticContact,
        from: usize,
        after: &mut dyn FnMut(Stepper, StepReport) -> Result<bool, Error>,
    ) -> ([f64; 3], Option<Error>) {
        match &self.steps {
            Steps::Given(steps) => {
                let mut take = |&(dt, load): &(f64, Load)| {
                    let report = contact.step(dt, load)?;
                    after(Stepper::Contact(contact), report)
                };
                let ended = steps[from..].iter().map(&mut take).find(|taken| !matches!(taken, Ok(true)));
                ([0.0; 3], ended.and_then(Result::err))
            }
            Steps::Along(history, stepping, until) => {
                let mut run = contact.follow(history, *stepping, *until);
                let ended = loop {
                    let step = run.next_step();
                    match step.and_then(|step| step.map_or(Ok(false), |report| after(Stepper::Run(&mut run), report))) {
                        Ok(true) => {}
                        ended => break ended.err(),
                    }
                };
                let budget = run.error_budget();
                ([budget.time.unwrap_or(-1.0), budget.solver, run.rejected_steps() as f64], ended)
            }
        }
    }

    /// All steps in one process, or as one of `ranks`.
    pub fn course(&self, ranks: Option<Arc<dyn Ranks>>) -> Result<Course, Error> {
        let mut contact = self.contact(ranks.as_ref())?;
        self.course_from(&mut contact, 0)
    }

    /// The steps after the first `from`.
    pub fn course_from(&self, contact: &mut ViscoelasticContact, from: usize) -> Result<Course, Error> {
        let (mut reports, mut length) = (Vec::new(), 0.0);
        let (budget, error) = self.drive(contact, from, &mut |_, report| {
            length = report.dt;
            reports.push(format!("{report:?}"));
            Ok(reports.len() < MOST_STEPS)
        });
        let bits = |field: Vec<f64>| field.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let whole = |field: &[f64]| Ok::<_, Error>(bits(contact.fields().gathered(field, 0)?.unwrap_or_default()));
        let ([moment1, moment2], [tilt1, tilt2]) = (contact.fields().moment(), contact.tilt());
        let [force1, force2] = contact.fields().slope_force(&self.shape);
        let mut probes = [-1.0; 3];
        if self.probed {
            // after a step that failed, the state before it is not kept
            let inside = contact.time() - if error.is_none() { 0.4 * length } else { 0.0 };
            let last = contact.within_step(inside)?;
            probes = [contact.fields().stiffness_over_modulus().unwrap_or(-1.0), last.force(), last.approach()];
        }
        let state =
            [contact.force(), contact.approach(), contact.fields().max_pressure(), contact.contact_area(), probes[0]];
        let turned = [moment1, moment2, tilt1, tilt2, force1, force2, probes[1], probes[2]];
        let numbers = state.into_iter().chain(turned).chain(budget).collect();
        let fields = [whole(contact.pressure())?, whole(contact.fields().displacement())?];
        Ok(Course { reports, error: error.map(|error| error.to_string()), numbers: bits(numbers), fields })
    }
}
