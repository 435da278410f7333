//! Kernels of layers: limits, sums over cells, waves, and invalid layers.

use crate::common::builder_of;
use std::sync::Arc;

use super::{assert_answers_waves, convolve};
use crate::common::refused::field;
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;
use viscocontact::{Error, KernelError};

fn coefficients(kernel: &InfluenceKernel) -> Vec<f64> {
    let [n1, n2] = kernel.grid().cells();
    let at = |i: usize, j: usize| kernel.coefficient(i as isize, j as isize).unwrap();
    (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
}

/// Greatest difference, relative to the coefficient of the half-space.
fn difference(found: &InfluenceKernel, exact: &InfluenceKernel) -> f64 {
    let pairs = coefficients(found).into_iter().zip(coefficients(exact));
    pairs.map(|(found, exact)| ((found - exact) / exact).abs()).fold(0.0, f64::max)
}

fn layers(thickness: f64, nu: f64) -> [Layer; 3] {
    [
        Layer::bonded_to_rigid(thickness, nu).unwrap(),
        Layer::frictionless_on_rigid(thickness, nu).unwrap(),
        Layer::bonded_to_half_space(thickness, nu, 5.0, 0.3).unwrap(),
    ]
}

#[test]
fn a_layer_of_the_material_of_its_base_is_a_half_space() {
    let (grid, line) = (Grid::new([24, 17], [2.0, 3.0]).unwrap(), Grid::new([40, 1], [2.0, 1.0]).unwrap());
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let periodic = InfluenceKernel::periodic(&grid).unwrap();
    let of_line = InfluenceKernel::line(&line, 30.0).unwrap();
    for thickness in [0.2, 1.0, 30.0] {
        let same = Layer::bonded_to_half_space(thickness, 0.3, 1.0, 0.3).unwrap();
        assert!(difference(&InfluenceKernel::layer(&grid, same).unwrap(), &half_space) < 1e-12);
        assert!(difference(&InfluenceKernel::layer_periodic(&grid, same).unwrap(), &periodic) < 1e-12);
        assert!(difference(&InfluenceKernel::layer_line(&line, same, Some(30.0)).unwrap(), &of_line) < 1e-12);
    }
    let nearly = Layer::bonded_to_half_space(0.5, 0.3, 1.0 + 1e-12, 0.3).unwrap();
    let found = difference(&InfluenceKernel::layer(&grid, nearly).unwrap(), &half_space);
    assert!(found < 1e-11, "{found:e}");
}

#[test]
fn thick_layers_are_half_spaces() {
    let (grid, line) = (Grid::new([24, 17], [2.0, 3.0]).unwrap(), Grid::new([40, 1], [2.0, 1.0]).unwrap());
    let half_space = InfluenceKernel::half_space(&grid).unwrap();
    let of_line = InfluenceKernel::line(&line, 30.0).unwrap();
    for nu in [0.0, 0.5] {
        for thickness in [1e14, 1e30, 1e100] {
            for layer in layers(thickness, nu) {
                let found = difference(&InfluenceKernel::layer(&grid, layer).unwrap(), &half_space);
                assert!(found < 1e-12, "{layer}: {found:e}");
            }
            let layer = layers(thickness, nu)[2];
            let found = difference(&InfluenceKernel::layer_line(&line, layer, Some(30.0)).unwrap(), &of_line);
            assert!(found < 1e-12, "{layer}: {found:e}");
        }
        // and at first order in 1/h before that
        let error = |thickness| {
            let kernel = InfluenceKernel::layer(&grid, layers(thickness, nu)[0]).unwrap();
            difference(&kernel, &half_space)
        };
        let order = (error(1e3) / error(1e4)).log10();
        assert!((order - 1.0).abs() < 1e-2, "{order}");
    }
}

/// A pressure on all cells of a large grid compresses the middle by the mean of long waves; cells much longer than the
/// layer is thick do so by themselves.
#[test]
fn uniform_pressure_compresses_a_layer_as_long_waves_do() {
    let grid = Grid::square(121, 60.5).unwrap();
    for layer in &layers(1.0, 0.2)[..2] {
        let kernel = InfluenceKernel::layer(&grid, *layer).unwrap();
        let (found, exact) = (convolve(&kernel, &vec![1.0; grid.len()])[60 * 122], layer.compliance(1e-7));
        assert!((found / exact - 1.0).abs() < 1e-11, "{layer}: {found:e} {exact:e}");
        let coarse = Grid::square(3, 3.0 * 80.0).unwrap();
        let kernel = InfluenceKernel::layer(&coarse, *layer).unwrap();
        let own = kernel.coefficient(0, 0).unwrap();
        assert!((own / exact - 1.0).abs() < 1e-10, "{layer}: {own:e} {exact:e}");
        assert_abs_diff_eq!(kernel.coefficient(1, 0).unwrap(), 0.0, epsilon = 1e-10 * own);
    }
    // bonded, long waves and the mean are the same; by Hooke's law
    let bonded = layers(1.0, 0.2)[0];
    assert_abs_diff_eq!(bonded.compliance(0.0), 0.6 / 0.64, epsilon = 1e-15);
    assert_abs_diff_eq!(bonded.compliance(1e-7), bonded.compliance(0.0), epsilon = 1e-12);
}

#[test]
fn periodic_layers_answer_every_wave() {
    for cells in [[16, 24], [15, 22], [32, 1]] {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        for layer in layers(0.4, 0.3).into_iter().chain(layers(0.4, 0.5)) {
            let kernel = InfluenceKernel::layer_periodic(&grid, layer).unwrap();
            assert_answers_waves(&kernel, |q| layer.compliance(q));
        }
    }
}

#[test]
fn layers_periodic_along_one_axis_have_their_limits() {
    let grid = Grid::new([24, 10], [2.0, 1.0]).unwrap();
    let half_space = InfluenceKernel::periodic_along(&grid, Axis::X2, 7.0).unwrap();
    let same = Layer::bonded_to_half_space(0.3, 0.3, 1.0, 0.3).unwrap();
    for layer in [same, Layer::bonded_to_half_space(1e15, 0.3, 4.0, 0.4).unwrap()] {
        let kernel = InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, Some(7.0)).unwrap();
        assert!(difference(&kernel, &half_space) < 1e-12, "{layer}");
    }
    let rigid = Layer::bonded_to_rigid(0.3, 0.3).unwrap();
    let along = |layer, datum| field(InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, datum));
    assert_eq!(along(same, Some(1.9)), "datum of a line load");
    let thin = Layer::bonded_to_rigid(1e-5, 0.3).unwrap();
    assert_eq!(along(thin, None), "longer side of a cell over the thickness of the layer");
    let datum = |layer, datum| {
        let refused = InfluenceKernel::layer_periodic_along(&grid, layer, Axis::X2, datum);
        matches!(refused, Err(Error::Kernel(KernelError::LayerDatum { .. })))
    };
    assert!(datum(rigid, Some(7.0)) && datum(same, None));
}

#[test]
fn invalid_layers_are_refused_by_name() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e301] {
        assert_eq!(field(Layer::bonded_to_rigid(bad, 0.3)), "thickness of a layer");
    }
    for bad in [-1.0, 0.51, f64::NAN] {
        assert_eq!(field(Layer::frictionless_on_rigid(1.0, bad)), "Poisson's ratio of a layer");
        assert_eq!(field(Layer::bonded_to_half_space(1.0, 0.3, 1.0, bad)), "Poisson's ratio of the base");
    }
    for bad in [0.0, 1e-7, 1e7, f64::NAN] {
        let refused = Layer::bonded_to_half_space(1.0, 0.3, bad, 0.3);
        assert_eq!(field(refused), "shear modulus of a layer over that of its base");
    }
    let [bonded, _, on_half_space] = layers(1.0, 0.3);
    let (grid, line) = (Grid::square(8, 1.0).unwrap(), Grid::new([8, 1], [1.0, 1.0]).unwrap());
    let datum = |result: Result<InfluenceKernel, Error>| match result.unwrap_err() {
        Error::Kernel(KernelError::LayerDatum { datum, .. }) => datum,
        other => panic!("unexpected {other}"),
    };
    assert_eq!(datum(InfluenceKernel::layer_line(&line, bonded, Some(2.0))), Some(2.0));
    assert_eq!(datum(InfluenceKernel::layer_line(&line, on_half_space, None)), None);
    assert_eq!(field(InfluenceKernel::layer_line(&line, on_half_space, Some(0.5))), "datum of a line load");
    assert!(matches!(InfluenceKernel::layer_line(&grid, bonded, None), Err(Error::CountOutOfRange { value: 8, .. })));
    let thin = Layer::bonded_to_rigid(1e-5, 0.3).unwrap();
    assert_eq!(field(InfluenceKernel::layer(&grid, thin)), "longer side of a cell over the thickness of the layer");
    // in line contact nothing varies along the line: a metre of it is no long cell
    let of_a_metre = Grid::new([400, 1], [4.0e-3, 1.0]).unwrap();
    for nu in [0.3, 0.5] {
        let sheet = Layer::bonded_to_rigid(20e-6, nu).unwrap();
        assert!(InfluenceKernel::layer_line(&of_a_metre, sheet, None).is_ok(), "{nu}");
        let coarse = Grid::new([4, 1], [4.0e-2, 1.0e-6]).unwrap();
        let long = if nu == 0.5 { sheet } else { Layer::bonded_to_rigid(5e-6, nu).unwrap() };
        let refused = field(InfluenceKernel::layer_line(&coarse, long, None));
        assert_eq!(refused, "longer side of a cell over the thickness of the layer", "{nu}");
    }
    // an incompressible layer under cells that do not squeeze it out; one that slides flows from crest to trough
    for (nu, refused) in [(0.5, true), (0.498, true), (0.49, false)] {
        let coarse = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(0.06, nu).unwrap());
        assert_eq!(coarse.is_err(), refused, "{nu}");
        assert!(InfluenceKernel::layer(&grid, Layer::frictionless_on_rigid(0.06, nu).unwrap()).is_ok());
        assert!(InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(0.063, nu).unwrap()).is_ok());
    }
}

/// K on cells of layers thick and thin passes the check of user-defined coefficients.
#[test]
fn operators_of_layers_are_positive_definite() {
    let grid = Grid::new([12, 9], [1.2, 0.9]).unwrap();
    let mut compared = 0;
    for thickness in [0.002, 0.02, 0.05, 0.1, 0.5, 5.0] {
        for layer in layers(thickness, 0.5).into_iter().chain(layers(thickness, 0.48)).chain(layers(thickness, -0.5)) {
            let Ok(kernel) = InfluenceKernel::layer(&grid, layer) else { continue };
            let own = coefficients(&kernel);
            let checked =
                InfluenceKernel::from_coefficients(&grid, |i, j| own[i.unsigned_abs() * 9 + j.unsigned_abs()]);
            assert!(checked.is_ok(), "{layer}: {checked:?}");
            compared += 1;
        }
    }
    // two of 54 are too thin for the cells
    assert_eq!(compared, 52);
}

#[test]
fn contacts_refuse_materials_that_are_not_the_layers() {
    let grid = Grid::square(8, 1.0e-3).unwrap();
    let kernel = Arc::new(InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(1.0e-3, 0.3).unwrap()).unwrap());
    let build = |material: Material, counter: Option<Material>| {
        let builder = builder_of(&Sphere::new(1.0e-2).unwrap(), grid.clone(), material).kernel(Arc::clone(&kernel));
        if let Some(other) = counter { builder.counter_body(other).build() } else { builder.build() }
    };
    let creeping = || Maxwell::with_time(1.0e6, 1.0).unwrap();
    let right = || Material::constant_poisson(creeping(), 0.3).unwrap();
    assert!(build(right(), None).is_ok());
    let steel = Material::constant_poisson(Elastic::new(80.0e9).unwrap(), 0.3).unwrap();
    let bulk = Material::elastic_bulk(creeping(), 1.0e9).unwrap();
    for (material, counter, word) in [
        (Material::incompressible(creeping()), None, "0.5"),
        (bulk, None, "elastic bulk"),
        (right(), Some(steel.clone()), "counter body"),
        (right().against(steel), None, "counter body"),
    ] {
        let refused = build(material, counter).unwrap_err();
        assert!(matches!(refused, Error::Kernel(KernelError::LayerMaterial { layer: 0.3, .. })), "{refused}");
        assert!(refused.to_string().contains(word), "{refused}");
    }
}
