use viscocontact::Error as ContactError;
use viscocontact::prelude::*;
use viscocontact_identify::{Error, Experiment, Identification, Model, Nuisance, Protocol, Result};

/// A pyramid on a layer, through a spring, with an unknown contact point: on the grid of the sweep the stepper gives the forces of the fit
/// up to the interpolation between states and the error of both time rules; on another tip it does not.
#[test]
fn the_stepper_gives_the_forces_of_a_fit_and_shows_a_wrong_tip() -> Result<()> {
    let grid = Grid::square(32, 2.4e-6)?;
    let pyramid = |slope: f64| FnGeometry::new(move |x1: f64, x2: f64| slope * x1.abs().max(x2.abs()));
    for poisson in [0.5, 0.45] {
        let kernel = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(2.0e-6, poisson)?)?;
        let tip = Sweep::new(grid.clone(), &pyramid(1.4))
            .kernel(kernel.clone())
            .accuracy(1e-4)
            .run(Reach::Approach(1.2e-6))?;
        let protocol = Protocol::ramp_hold_retract(2.0e-6, [0.2e-6, 0.9e-6], 1.0, 0.02)?;
        let experiment = Experiment::new(protocol, tip).with_spring(0.05)?;
        let zener = Identification::new(Model::Zener);
        let body = [("E0", 4.0e3), ("Einf", 1.5e3), ("tau", 0.3)];
        let curve = crate::random::exact(&zener, experiment, &body);
        let fit = zener.contact_point(Nuisance::Fitted).fit(&[curve])?;
        let scene =
            |slope: f64| ViscoelasticContact::builder(grid.clone()).geometry(&pyramid(slope)).kernel(kernel.clone());
        let [same, other] = [fit.verify(0, &scene(1.4))?, fit.verify(0, &scene(1.3))?];
        println!("{:.2e} {:.2e}", same.difference, other.difference);
        assert!(same.difference < 2e-3 && other.difference > 0.02, "{:e} {:e}", same.difference, other.difference);
        assert_eq!(same.force.len(), fit.samples(0).len());
        assert!(matches!(
            fit.verify(1, &scene(1.4)),
            Err(Error::Contact(ContactError::CountOutOfRange { value: 1, .. }))
        ));
    }
    Ok(())
}
