//! Loads that are none, wherever a run looks at its history.

use crate::common::watched_runs::seen;
use crate::common::{builder_of, elastic, maxwell, sphere_on};
use std::sync::{Arc, Mutex};

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::prelude::*;

const UNTIL: f64 = 2.0;

/// Invalid loads, and the names of their values.
const WRONG: [(Load, &str); 7] = [
    (wrong_force(f64::NAN), "normal force"),
    (wrong_force(f64::INFINITY), "normal force"),
    (wrong_force(-1.0e-3), "normal force"),
    (Load::Force { normal: 0.1, tilt: [Tilt::Fixed(f64::NAN), Tilt::Fixed(0.0)] }, "tilt along x1"),
    (Load::Force { normal: 0.1, tilt: [Tilt::Fixed(0.0), Tilt::Free { at: f64::NAN }] }, "load point along x2"),
    (Load::Approach { approach: f64::NAN, tilt: [Tilt::Fixed(0.0); 2] }, "approach"),
    (Load::Approach { approach: f64::NEG_INFINITY, tilt: [Tilt::Fixed(0.0); 2] }, "approach"),
];

const fn wrong_force(normal: f64) -> Load {
    Load::Force { normal, tilt: [Tilt::Fixed(0.0); 2] }
}

/// Where a history is wrong: in a window, from a time on, or at one time alone, which may be a corner.
#[derive(Debug, Clone, Copy)]
enum Where {
    Window(f64, f64),
    At(f64),
}

/// A history that is wrong somewhere, and notes each time that it is asked for.
#[derive(Debug, Clone)]
struct Recorded {
    smooth: bool,
    corner: Option<f64>,
    place: Where,
    wrong: Load,
    asked: Arc<Mutex<Vec<(f64, bool)>>>,
}

impl Recorded {
    fn is_wrong(&self, t: f64) -> bool {
        match self.place {
            Where::Window(from, width) => t >= from && t < from + width,
            Where::At(time) => t == time,
        }
    }
}

impl LoadHistory for Recorded {
    fn at(&self, t: f64) -> Load {
        self.asked.lock().unwrap().push((t, self.is_wrong(t)));
        if self.is_wrong(t) {
            return self.wrong;
        }
        Load::force(if self.smooth { 0.2 + 0.1 * (3.0 * t).sin() } else { 0.1 + 0.1 * t })
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.corner.filter(|&corner| corner > after)
    }
}

fn recorded() -> impl Strategy<Value = Recorded> {
    let corner = prop::option::of(0.1..1.9_f64);
    let windows = (0.0..2.0_f64, -4.0..0.3_f64).prop_map(|(from, width)| Where::Window(from, 10f64.powf(width)));
    let place = prop_oneof![4 => windows.prop_map(Some), 1 => Just(Some(Where::At(0.0))), 2 => Just(None)];
    (any::<bool>(), corner, place, 0..WRONG.len()).prop_map(|(smooth, corner, place, wrong)| Recorded {
        smooth,
        corner,
        place: place.unwrap_or(Where::At(corner.unwrap_or(UNTIL))),
        wrong: WRONG[wrong].0,
        asked: Arc::default(),
    })
}

fn contact(material: usize) -> ViscoelasticContact {
    let material = match material {
        0 => elastic(),
        1 => Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 0.5).unwrap()),
        _ => maxwell(),
    };
    sphere_on(Grid::square(16, 5.0e-3).unwrap(), material, Settings::default())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7202), ..ProptestConfig::with_cases(300) })]

    /// A run ends with an error at the first invalid load that it evaluates, and leaves the contact as after the last step.
    #[test]
    fn a_run_ends_at_the_first_invalid_load(history in recorded(), material in 0..3_usize, steps in 0..5_usize) {
        let stepping = match steps {
            0 => Stepping::fixed(0.07),
            1 => Stepping::fixed(0.5),
            k => Stepping::adaptive([1e-2, 1e-3, 1e-4][k - 2]),
        };
        let mut contact = contact(material);
        let mut run = contact.follow(&history, stepping, UNTIL);
        let mut before = seen(run.contact());
        let error = loop {
            match run.next_step() {
                Ok(Some(_)) => before = seen(run.contact()),
                Ok(None) => break None,
                Err(error) => break Some(error),
            }
        };
        prop_assert!(seen(run.contact()) == before, "the contact changed");
        let asked = history.asked.lock().unwrap().clone();
        let wrong: Vec<f64> = asked.iter().filter(|asked| asked.1).map(|asked| asked.0).collect();
        let named = WRONG.iter().find(|wrong| format!("{:?}", wrong.0) == format!("{:?}", history.wrong)).unwrap().1;
        match error {
            None => prop_assert!(wrong.is_empty(), "looked at {wrong:?}"),
            Some(Error::LoadOutOfRange { time, field, .. }) => {
                prop_assert_eq!(field, named);
                prop_assert_eq!(&wrong, &[time], "the first is the last that is looked at");
                prop_assert_eq!(asked.last().unwrap().0, time);
                // the next call returns the same error, and the contact stays
                let again = run.next_step();
                prop_assert!(matches!(again, Err(Error::LoadOutOfRange { .. })), "{again:?}");
                prop_assert!(seen(run.contact()) == before, "the contact changed");
            }
            Some(other) => prop_assert!(false, "{other}"),
        }
    }
}

/// The case that was missed: a window of NaN that a step of the whole run leaps over, both of its ends being loads.
#[test]
fn no_step_skips_an_invalid_interval() {
    let history = FnHistory::new(|t: f64| Load::force(if (0.9..1.1).contains(&t) { f64::NAN } else { 0.2 }));
    let mut contact = contact(0);
    let mut run = contact.follow(&history, Stepping::adaptive(1e-3), UNTIL);
    let error = loop {
        match run.next_step() {
            Ok(Some(_)) => assert!(run.contact().time() < 0.9),
            Ok(None) => panic!("leapt over"),
            Err(error) => break error,
        }
    };
    let Error::LoadOutOfRange { time, field: "normal force", value, .. } = error else { panic!("{error}") };
    assert!((0.9..1.1).contains(&time) && value.is_nan());
    assert!(error.to_string().contains(&format!("normal force = NaN at t = {time}")), "{error}");
}

/// Other functions that evaluate closures name the value, or return NaN.
#[test]
fn nan_is_named_or_returned_elsewhere() {
    let nan = FnHistory::new(|t: f64| Load::force(if (0.9..1.1).contains(&t) { f64::NAN } else { 0.2 }));
    let (sphere, body) =
        (Sphere::new(10.0e-3).unwrap(), Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 0.5).unwrap()));
    let scene = |grid, settings| {
        Ok(ViscoelasticContact::builder(grid).geometry(&sphere).material(body.clone()).settings(settings))
    };
    let study = Study::new(scene, &nan, UNTIL).accuracy(1e-2).run();
    assert!(matches!(study, Err(Error::LoadOutOfRange { field: "normal force", .. })));
    let broken = viscocontact::load::laws::all(&nan, &[0.0, 2.0]).unwrap_err();
    assert_eq!((broken.law, broken.quantity), ("every load is one that a step accepts", "normal force"));

    let mut contact = contact(1);
    contact.step(0.0, Load::force(0.2)).unwrap();
    let hole = FnGeometry::new(|x1, _| if x1 > 0.0 { f64::NAN } else { 0.0 });
    assert!(contact.fields().slope_force(&hole)[0].is_nan());

    #[derive(Debug)]
    struct Unknown(f64);
    impl Rheology for Unknown {
        fn creep_compliance(&self, t: f64) -> f64 {
            1.0e-6 * (1.0 + t.sqrt())
        }
        fn known_until(&self) -> f64 {
            self.0
        }
    }
    for until in [f64::NAN, 0.0, -1.0] {
        let contact = builder_of(&sphere, Grid::square(8, 4.0e-3).unwrap(), Material::incompressible(Unknown(until)));
        assert!(matches!(contact.build(), Err(Error::OutOfRange { field: "Rheology::known_until", .. })), "{until}");
    }
}
