//! Grids that no machine has memory for: every call returns an error with the bytes, before anything is filled.

use crate::common::{Draws, builder_of, maxwell};
use std::hint::black_box;
use std::sync::Arc;

use viscocontact::Result;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// Whether this machine grants so many bytes in one piece.
fn granted(bytes: u128) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| {
        let mut room = Vec::<u8>::new();
        let granted = room.try_reserve_exact(bytes).is_ok();
        black_box(room.as_ptr());
        granted
    })
}

/// The grids that may be of those in question, none of which this machine has a field for: the rest of a test would take
/// what there is.
fn grids() -> Vec<Grid> {
    let draws = &mut Draws::new(11);
    let one = |exponent: usize| 1_usize << exponent;
    let mut sizes = vec![
        [1, one(40)],
        [one(40), 1],
        [one(20), one(20)],
        [65535, 65535],
        [65536, 65536],
        [one(31), 2],
        [2, one(31)],
        [one(59), 1],
        [1, one(60) - 1],
        [one(30) - 1, one(30)],
        [usize::MAX, usize::MAX],
        [one(32), one(32)],
        [one(60), 1],
        [usize::MAX, 1],
    ];
    for _ in 0..300 {
        let all = 32 + draws.below(36);
        let first = draws.below(all.min(60));
        sizes.push([first, (all - first).min(62)].map(|exponent| one(exponent) + draws.below(one(exponent))));
    }
    let mut grids = Vec::new();
    for cells in sizes {
        let bytes = (cells[0] as u128 * cells[1] as u128).saturating_mul(8);
        match Grid::new(cells, [1.0, 1.0]) {
            Ok(grid) => {
                assert!(bytes <= isize::MAX as u128, "{cells:?}");
                assert_eq!(8 * grid.len() as u128, bytes, "{cells:?}");
                if !granted(bytes) {
                    grids.push(grid);
                }
            }
            Err(Error::CountOutOfRange { field: "cells of the grid", .. }) => {
                assert!(bytes > isize::MAX as u128, "{cells:?}");
            }
            Err(error) => panic!("{cells:?}: {error}"),
        }
    }
    grids
}

/// The error has at least the bytes of one field of 8 bytes per cell, divided by `share`.
fn refused<T>(result: Result<T>, grid: &Grid, share: u128, what: &str) {
    match result.map(|_| ()) {
        Err(Error::OutOfMemory { bytes, .. }) => {
            let least = (8 * grid.len() as u128 / share).min(u64::MAX.into());
            assert!(u128::from(bytes) >= least, "{what} on {:?}: {bytes} bytes", grid.cells());
        }
        Err(error) => panic!("{what} on {:?}: {error}", grid.cells()),
        Ok(()) => panic!("{what} on {:?} was made", grid.cells()),
    }
}

/// A shape that is not to be looked at.
fn unseen() -> impl Geometry {
    FnGeometry::new(|_, _| panic!("a gap was filled"))
}

#[test]
fn kernels_are_refused_before_they_are_filled() {
    let [mut made, mut lines] = [0, 0];
    for grid in grids() {
        let kernels = [
            ("half-space", InfluenceKernel::half_space(&grid)),
            ("periodic", InfluenceKernel::periodic(&grid)),
            ("periodic along x1", InfluenceKernel::periodic_along(&grid, Axis::X1, 10.0)),
            ("periodic along x2", InfluenceKernel::periodic_along(&grid, Axis::X2, 10.0)),
            ("line", InfluenceKernel::line(&grid, 10.0)),
        ];
        for (name, kernel) in kernels {
            let Ok(kernel) = kernel else {
                assert!(name == "line" && grid.cells()[1] > 1, "{name} on {:?}", grid.cells());
                continue;
            };
            made += 1;
            lines += usize::from(name == "line");
            // a periodic kernel keeps a quarter of its waves, and works in half of them
            refused(kernel.workspace(), &grid, 1, name);
        }
        let coefficients = InfluenceKernel::from_coefficients(&grid, |_, _| panic!("a coefficient was asked for"));
        refused(coefficients, &grid, 1, "coefficients");
        // a quarter of the waves is independent
        if !granted(2 * grid.len() as u128) {
            let waves = InfluenceKernel::from_spectrum(&grid, |_, _| panic!("a wave was asked for"));
            refused(waves, &grid, 4, "waves");
        }
    }
    assert!(made > 400 && lines > 1, "{made} {lines}");
}

#[test]
fn surfaces_are_refused_before_they_are_filled() {
    let map = HeightMap::new([3, 2], [1.0, 1.0], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let spec = RoughSpec::new(1.0, 0.1, Roughness::RmsHeight(1.0e-6)).with_seed(1);
    for grid in grids() {
        refused(map.resampled(&grid), &grid, 1, "a map");
        refused(map.clone().periodic().resampled(&grid), &grid, 1, "a periodic map");
        let few = HeightMap::new(grid.cells(), grid.lengths(), vec![0.0; 7]);
        assert!(matches!(few, Err(Error::WrongLength { len: 7, .. })), "{:?}", grid.cells());
        // few cells along an axis do not resolve the spectrum, which is looked at first
        if (0..2).all(|axis| grid.cells()[axis] == 1 || grid.spacing()[axis] <= 0.05) {
            refused(Rough::new(&grid, spec), &grid, 1, "a rough surface");
            let part = Grid::new([4, 1], [4.0 * grid.spacing()[0], grid.spacing()[1]]).unwrap();
            if grid.cells()[0] >= 4 {
                refused(Rough::windowed(&part, spec, [1.0, 1.0]), &grid, 1, "a part of a rough surface");
            }
        }
    }
}

#[test]
fn contacts_are_refused_before_they_are_filled() {
    let map = HeightMap::new([3, 2], [0.1, 0.1], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let repeated = Repeated::new(map.clone(), [0.1, f64::INFINITY]).unwrap();
    let rough = Sum::new(map.periodic(), Wavy::new(1.0e-6, 1.0e-3).unwrap());
    let moved = Shifted::new(rough.clone(), [0.2, 0.1]).unwrap();
    let shapes: [&dyn Geometry; 5] = [&unseen(), &Wavy::new(1.0e-6, 1.0e-3).unwrap(), &repeated, &rough, &moved];
    for grid in grids() {
        for shape in shapes {
            for window in [true, false] {
                let settings = Settings::default().with_window(window);
                let builder = ViscoelasticContact::builder(grid.clone())
                    .settings(settings)
                    .geometry(shape)
                    .another_body(&unseen())
                    .material(maxwell());
                let memory = builder.memory().unwrap();
                // state, solver and kernel of the whole grid
                assert!(u128::from(memory.total()) >= (150 * grid.len() as u128).min(u64::MAX.into()), "{memory}");
                refused(builder.build(), &grid, 1, "a contact");
            }
        }
        let kernel = Arc::new(InfluenceKernel::periodic(&grid).unwrap());
        let builder = builder_of(&unseen(), grid.clone(), maxwell()).kernel(kernel);
        assert_eq!(builder.memory().unwrap().computed_cells, grid.len());
        refused(builder.build(), &grid, 1, "a periodic contact");
    }
}
