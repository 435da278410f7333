//! What kernels refuse: a table of bodies and cells, and of the materials that a layer takes.

use std::sync::Arc;

use super::{convolve, noise};
use crate::common::builder_of;
use crate::common::refused::{field, refused, says};
use viscocontact::prelude::*;

#[test]
fn kernels_refuse_by_name() {
    let long = "longer side of a cell over the thickness of the layer";
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e301] {
        refused([(Layer::bonded_to_rigid(bad, 0.3).err(), "thickness of a layer")]);
    }
    for bad in [-1.0, 0.51, f64::NAN] {
        let base = Layer::bonded_to_half_space(1.0, 0.3, 1.0, bad);
        refused([
            (Layer::frictionless_on_rigid(1.0, bad).err(), "Poisson's ratio of a layer"),
            (base.err(), "Poisson's ratio of the base"),
        ]);
    }
    for bad in [0.0, 1e-7, 1e7, f64::NAN] {
        let ratio = Layer::bonded_to_half_space(1.0, 0.3, bad, 0.3);
        refused([(ratio.err(), "shear modulus of a layer over that of its base")]);
    }
    let rigid = |thickness, nu| Layer::bonded_to_rigid(thickness, nu).unwrap();
    let on_half_space = Layer::bonded_to_half_space(1.0, 0.3, 5.0, 0.3).unwrap();
    let (grid, line) = (Grid::square(8, 1.0).unwrap(), Grid::new([8, 1], [1.0, 1.0]).unwrap());
    let few = Grid::new([12, 8], [1.0, 1.0]).unwrap();
    let dozen = Grid::new([12, 1], [1.0, 1.0]).unwrap();
    let flat = Grid::new([4, 1], [4.0e-2, 1.0e-6]).unwrap();
    let datum = "datum of a line load";
    refused([
        (InfluenceKernel::layer_line(&line, rigid(1.0, 0.3), Some(2.0)).err(), "is 2 m"),
        (InfluenceKernel::layer_line(&line, on_half_space, None).err(), "is absent"),
        (InfluenceKernel::layer_line(&line, on_half_space, Some(0.5)).err(), datum),
        (InfluenceKernel::layer_line(&grid, rigid(1.0, 0.3), None).err(), "cells along x2 of a line contact"),
        (InfluenceKernel::layer(&grid, rigid(1e-5, 0.3)).err(), long),
        (InfluenceKernel::layer_line(&flat, rigid(5e-6, 0.3), None).err(), long),
        (InfluenceKernel::layer_line(&flat, rigid(20e-6, 0.5), None).err(), long),
        // an incompressible layer under cells that do not squeeze it out
        (InfluenceKernel::layer(&grid, rigid(0.06, 0.5)).err(), long),
        (InfluenceKernel::layer(&grid, rigid(0.06, 0.498)).err(), long),
        (InfluenceKernel::line(&few, 2.0).err(), "cells along x2 of a line contact"),
        (InfluenceKernel::line(&dozen, 0.5).err(), datum),
        (InfluenceKernel::line(&dozen, f64::NAN).err(), datum),
        (InfluenceKernel::line(&Grid::new([4, 1], [1.0, 1.0]).unwrap(), 1.0e121).err(), datum),
        (InfluenceKernel::periodic(&Grid::square(1, 1.0).unwrap()).err(), "cells of a periodic grid"),
    ]);
    // one that slides flows from crest to trough; in line contact nothing varies along the line: a metre of it is no long cell
    let of_a_metre = Grid::new([400, 1], [4.0e-3, 1.0]).unwrap();
    for nu in [0.3, 0.49, 0.498, 0.5] {
        assert!(InfluenceKernel::layer(&grid, Layer::frictionless_on_rigid(0.06, nu).unwrap()).is_ok(), "{nu}");
        assert!(InfluenceKernel::layer(&grid, rigid(0.063, nu)).is_ok(), "{nu}");
        assert!(InfluenceKernel::layer_line(&of_a_metre, rigid(20e-6, nu), None).is_ok(), "{nu}");
    }
    assert!(InfluenceKernel::layer(&grid, rigid(0.06, 0.49)).is_ok());
}

/// The cell or wave at fault, and what is not.
#[test]
fn influences_that_no_body_has_are_refused() {
    let grid = Grid::new([12, 8], [1.0, 1.0]).unwrap();
    let coefficient = |f: &dyn Fn(isize, isize) -> f64| InfluenceKernel::from_coefficients(&grid, f).unwrap_err();
    let wave = |f: fn(f64, f64) -> f64| InfluenceKernel::from_spectrum(&grid, f).unwrap_err();
    for (error, what, cell) in [
        (coefficient(&|_, _| f64::NAN), "coefficient", [0, 0]),
        (coefficient(&|i, j| (-(i * i + j * j) as f64).exp() + 1e-3 * i as f64), "coefficient", [-1, 0]),
        (coefficient(&|i, j| if i == 0 && j == 0 { 1e101 } else { 0.0 }), "coefficient", [0, 0]),
        (wave(|_, _| -1.0), "wave", [0, 0]),
        (wave(|q1, _| 7.0 - q1), "wave", [2, 0]),
        (wave(|_, _| 1e101), "wave", [0, 0]),
    ] {
        says(&error, "kernel_invalid_influence", &format!("the influence {what} {cell:?} is "));
    }
    // the neighbours sink in more than the loaded cell
    let unstable = coefficient(&|i, j| if (i, j) == (0, 0) { 1.0 } else { 2.0 / (1 + i * i + j * j) as f64 });
    says(&unstable, "kernel_not_positive_definite", "the influence coefficients are not positive definite");
    let named = (unstable.name(), unstable.allowed(), unstable.remedy().is_some());
    assert_eq!(named, (Some("influence coefficients"), Some("positive definite"), true));
    // eigenvalues 1 + 2a cos(kπ/13), of which the least is 0 at a = 0.51496, while the embedding has a negative one
    for (a, is_positive) in [(0.514, true), (0.516, false)] {
        let of_neighbours = |i: isize, j: isize| match (i.abs(), j) {
            (0, 0) => 1.0,
            (1, 0) => a,
            _ => 0.0,
        };
        assert_eq!(InfluenceKernel::from_coefficients(&grid, of_neighbours).is_ok(), is_positive, "{a}");
    }
    // positive though its embedding in a period is not: the half-space, which many a grid has
    assert!(InfluenceKernel::from_coefficients(&grid, |i, j| 1.0 / (1.0 + (i * i + j * j) as f64)).is_ok());
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
        let error = build(material, counter).unwrap_err();
        says(&error, "kernel_layer_material", "the layer was made for a Poisson's ratio of 0.3 at all times, and ");
        refused([(Some(error), word)]);
    }
}

/// Cells whose coefficients `f64` cannot represent are refused with the reason; below that K p is a number.
#[test]
fn cells_beyond_numbers_are_refused() {
    type Make = fn(&Grid) -> Result<InfluenceKernel, Error>;
    let kernels: [Make; 4] = [
        InfluenceKernel::half_space,
        InfluenceKernel::periodic,
        |grid| InfluenceKernel::periodic_along(grid, Axis::X1, grid.lengths()[1]),
        |grid| InfluenceKernel::periodic_along(grid, Axis::X2, 1.0e120),
    ];
    let sides = |d1: f64, d2: f64| Grid::new([4, 3], [4.0 * d1, 3.0 * d2]).unwrap();
    for make in kernels {
        refused([
            (make(&sides(1.0e-101, 1.0)).err(), "cell side along x1"),
            (make(&sides(1.0, 1.0e110)).err(), "cell side along x2"),
            (make(&sides(1.0e-60, 1.0e60)).err(), "aspect ratio of the cells"),
        ]);
        for (d1, d2) in [(1.0e-99, 1.0), (1.0, 1.0e-99), (1.0e-40, 1.0e40), (1.0e99, 1.0e99), (1.0e-99, 1.0e-99)] {
            let kernel = make(&sides(d1, d2)).unwrap();
            let found = convolve(&kernel, &noise(12));
            assert!(found.iter().all(|value| value.is_finite()), "{d1:e} {d2:e} {kernel}: {found:?}");
        }
    }
}

/// Pressures that are not numbers are refused before they are transformed, products that leave the range of `f64` after it; fields of
/// another length at once.
#[test]
fn products_beyond_numbers_are_refused() {
    for cells in [[4, 3], [1, 12], [2, 1], [12, 1], [17, 1]] {
        let grid = Grid::new(cells, [1.0e3, 1.0e3]).unwrap();
        let line = (cells[1] == 1).then(|| InfluenceKernel::line(&grid, 1.0e4));
        let kernels = [InfluenceKernel::half_space(&grid), InfluenceKernel::periodic_along(&grid, Axis::X2, 1.0e9)];
        for kernel in kernels.into_iter().chain(line) {
            let kernel = kernel.unwrap();
            let named = |pressure: &[f64]| {
                let mut out = vec![0.0; grid.len()];
                field(kernel.convolve(pressure, &mut out, &mut kernel.workspace().unwrap()))
            };
            assert_eq!(named(&vec![1e308; grid.len()]), "K p");
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut pressure = vec![1.0; grid.len()];
                pressure[grid.len() / 2] = bad;
                assert_eq!([named(&pressure), named(&vec![bad; grid.len()])], ["pressure"; 2]);
            }
        }
    }
    let kernel = |cells: usize| InfluenceKernel::half_space(&Grid::square(cells, 1.0).unwrap()).unwrap();
    let (eight, nine) = (kernel(8), kernel(9));
    for (pressure, displacement, of, named) in
        [(63, 64, &eight, "pressure"), (64, 60, &eight, "displacement"), (64, 64, &nine, "workspace")]
    {
        let mut work = of.workspace().unwrap();
        let product = eight.convolve(&vec![0.0; pressure], &mut vec![0.0; displacement], &mut work);
        refused([(product.err(), named)]);
    }
}
