use viscocontact::Error as ContactError;
use viscocontact::load::{Load, LoadHistory};
use viscocontact::prelude::*;
use viscocontact_identify::{Error, Experiment, Identification, Model, Protocol, Result, Sample};

#[test]
fn pieces_end_at_samples_and_are_divided_equally() -> Result<()> {
    let protocol = Protocol::ramp_hold_retract(3.0, [0.25, 1.0], 0.35, 0.1)?;
    let corners = [(0.0, -0.25), (1.25 / 3.0, 1.0), (1.25 / 3.0 + 0.35, 1.0), (2.5 / 3.0 + 0.35, -0.25)];
    for (time, drive) in corners {
        let at = protocol.times().iter().position(|&other| (other - time).abs() < 1e-14).expect("a corner is a sample");
        assert_eq!(protocol.drive()[at], drive);
    }
    // 5 intervals up, 4 of the hold, 5 down, none longer than asked for
    assert_eq!(protocol.times().len(), 15);
    assert!(protocol.times().windows(2).all(|pair| pair[1] - pair[0] <= 0.1 + 1e-12));
    let slope =
        |k: usize| (protocol.drive()[k + 1] - protocol.drive()[k]) / (protocol.times()[k + 1] - protocol.times()[k]);
    for (k, speed) in [(0, 3.0), (4, 3.0), (6, 0.0), (9, -3.0), (13, -3.0)] {
        assert!((slope(k) - speed).abs() < 1e-12, "piece {k}: {}", slope(k));
    }
    Ok(())
}

#[test]
fn a_tenth_is_ten_intervals() -> Result<()> {
    // 1/0.1 and 0.3/0.1 round up and down
    assert_eq!(Protocol::trapezoid(1.0, [1.0, 0.3, 0.7], 0.1)?.times().len(), 1 + 10 + 3 + 7);
    Ok(())
}

#[test]
fn an_oscillation_is_sampled_per_period_and_ends_in_the_middle() -> Result<()> {
    let protocol = Protocol::builder(0.0, 0.5).line(2.0, 1.0).hold(1.0).oscillate(0.1, 4.0, 3, 8).build()?;
    let (times, drive) = (protocol.times(), protocol.drive());
    assert_eq!(times.len(), 1 + 2 + 2 + 24);
    assert!((times[28] - 2.75).abs() < 1e-14 && drive[28] == 2.0);
    for k in 5..28 {
        let exact = 2.0 + 0.1 * (std::f64::consts::TAU * 4.0 * (times[k] - 2.0)).sin();
        assert!((drive[k] - exact).abs() < 1e-14);
    }
    Ok(())
}

#[test]
fn a_protocol_and_its_load_history_agree_between_samples() -> Result<()> {
    let protocol = Protocol::staircase(&[1.0e-6, 2.0e-6, 0.5e-6], 0.3, 0.9, 0.2)?;
    let history = Experiment::new(protocol.clone(), ElasticStates::sphere(1.0e-3)?).load_history()?;
    for k in -3..90 {
        let time = 0.05 * f64::from(k);
        let Load::Approach { approach, .. } = history.at(time) else { panic!("the depth is driven") };
        let (times, drive) = (protocol.times(), protocol.drive());
        let after = times.partition_point(|other| *other <= time).clamp(1, times.len() - 1);
        let share = ((time - times[after - 1]) / (times[after] - times[after - 1])).clamp(0.0, 1.0);
        assert!((approach - (1.0 - share) * drive[after - 1] - share * drive[after]).abs() < 1e-20);
    }
    Ok(())
}

#[test]
fn a_rough_tip_rests_where_its_highest_peak_touches() -> Result<()> {
    let grid = Grid::square(16, 1.0e-3)?;
    let shape = Rough::new(&grid, RoughSpec::new(0.5e-3, 0.2e-3, Roughness::RmsHeight(1.0e-6)).with_seed(3))?;
    let tip = Sweep::new(grid.clone(), &shape).kernel(InfluenceKernel::periodic(&grid)?).run(Reach::Level(1.0e-10))?;
    let history = Experiment::new(Protocol::trapezoid(0.2e-6, [1.0; 3], 0.5)?, tip.clone()).load_history()?;
    let mut contact = StatesContact::new(&tip, &Material::incompressible(Elastic::new(1.0e6)?))?;
    for (time, touches) in [(0.0, false), (1.0, true), (2.0, true)] {
        contact.step(time - contact.time(), history.at(time))?;
        assert_eq!(contact.force() > 0.0, touches, "at {time} s");
    }
    Ok(())
}

/// A ball on cells: depths that count from its apex have the force of Hertz, with few cells in contact as well.
#[test]
fn the_depth_of_a_swept_tip_may_count_from_its_apex() -> Result<()> {
    let radius = 5.0e-6;
    let tip = Sweep::new(Grid::square(64, 6.0e-6)?, &Sphere::new(radius)?).run(Reach::Approach(0.6e-6))?;
    let protocol = Protocol::builder(0.0, 0.01).line(0.5e-6, 1.0).build()?;
    let first_cell = Experiment::new(protocol, tip);
    let worst = |experiment: &Experiment, from: f64| -> Result<f64> {
        let samples = Identification::new(Model::Elastic).respond(experiment, &[("E", 1.0)])?;
        let error = |s: &Sample| (s.force / (4.0 / 3.0 * radius.sqrt() * s.depth.powf(1.5)) - 1.0).abs();
        Ok(samples.iter().filter(|sample| sample.depth > from).map(error).fold(0.0, f64::max))
    };
    let apex = first_cell.clone().with_surface(0.0)?;
    let errors = [(&first_cell, 1.0e-7), (&apex, 1.0e-7), (&apex, 1.0e-9)].map(|(of, from)| worst(of, from));
    let [first, deep, all] = [errors[0].clone()?, errors[1].clone()?, errors[2].clone()?];
    println!("from the first cell {first:.1e}, from the apex {deep:.1e}, with few cells {all:.1e}");
    assert!(first > 5e-3 && deep < 2e-3 && all < 3e-2, "{first:e} {deep:e} {all:e}");
    assert!(matches!(first_cell.with_surface(1.0e-6), Err(Error::Contact(ContactError::OutOfRange { .. }))));
    Ok(())
}

#[test]
fn nonsense_is_refused_with_the_field_and_its_range() -> Result<()> {
    let refused = [
        (Protocol::trapezoid(-1.0, [1.0; 3], 0.1), "depth"),
        (Protocol::trapezoid(1.0, [0.0, 1.0, 1.0], 0.1), "duration of a line"),
        (Protocol::trapezoid(1.0, [1.0, -1.0, 1.0], 0.1), "duration of a line"),
        (Protocol::trapezoid(1.0, [1.0; 3], 0.0), "interval of samples"),
        (Protocol::trapezoid(1.0, [1.0; 3], 1.0e-12), "samples of a piece"),
        (Protocol::ramp_hold_retract(0.0, [0.0, 1.0], 1.0, 0.1), "speed"),
        (Protocol::ramp_hold_retract(1.0, [-1.0, 1.0], 1.0, 0.1), "distance above the surface"),
        (Protocol::staircase(&[1.0, f64::NAN], 1.0, 1.0, 0.1), "drive"),
        (Protocol::staircase(&[], 1.0, 1.0, 0.1), "depths of the staircase"),
        (Protocol::new(vec![0.0], vec![1.0]), "times of the protocol"),
        (Protocol::new(vec![f64::NAN, 1.0], vec![1.0; 2]), "time"),
        (Protocol::builder(0.0, 0.1).oscillate(0.0, 1.0, 3, 8).build(), "amplitude"),
        (Protocol::builder(0.0, 0.1).oscillate(1.0, 1.0, 0, 8).build(), "periods"),
        (Protocol::builder(0.0, 0.1).oscillate(1.0, 1.0, 3, 3).build(), "samples of a period"),
        (Protocol::builder(0.0, 0.1).every(-1.0).hold(1.0).build(), "interval of samples"),
        (Protocol::builder(f64::INFINITY, 0.1).hold(1.0).build(), "start of the drive"),
    ];
    for (outcome, expected) in refused {
        match outcome {
            Err(Error::Contact(ContactError::OutOfRange { field, .. }))
            | Err(Error::Contact(ContactError::CountOutOfRange { field, .. })) => assert_eq!(field, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    Ok(())
}
