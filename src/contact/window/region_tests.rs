use super::*;

fn grid(cells: [usize; 2]) -> Grid {
    Grid::new(cells, cells.map(|n| n as f64)).unwrap()
}

#[test]
fn edge_cells_are_counted_once() {
    for (cells, expected) in
        [([3, 3], 8), ([1, 4], 4), ([4, 1], 4), ([1, 1], 1), ([2, 5], 10), ([4, 6], 16), ([2, 2], 4)]
    {
        for folded in [[false, false], [true, false], [false, true], [true, true]] {
            if (0..2).any(|axis| folded[axis] && cells[axis] % 2 == 1) {
                continue;
            }
            let region = Region::whole(&grid(cells), folded);
            assert_eq!(region.positive_on_edge(&vec![1.0; region.len()], [false; 2]), expected, "{cells:?} {folded:?}");
        }
    }
    let inside = Region::around(&grid([64, 64]), [false; 2], Extent { low: [20, 30], high: [25, 35] }, 0.1);
    assert_eq!(inside.positive_on_edge(&vec![1.0; inside.len()], [false; 2]), 0);
    let aside = Region::around(&grid([64, 64]), [false; 2], Extent { low: [0, 30], high: [5, 35] }, 0.1);
    assert_eq!(aside.positive_on_edge(&vec![1.0; aside.len()], [false; 2]), aside.cells()[1]);
}

/// What is cut out and spread again is the same, on every cell and its images.
#[test]
fn regions_know_their_cells() {
    let whole = grid([20, 30]);
    for folded in [[false, false], [true, false], [false, true], [true, true]] {
        for region in [
            Region::whole(&whole, folded),
            Region::around(&whole, folded, Extent { low: [8, 12], high: [11, 16] }, 0.2),
            Region::around(&whole, folded, Extent { low: [0, 29], high: [19, 29] }, 0.2),
        ] {
            let even = |cell: [usize; 2]| {
                let [x, y] = [0, 1].map(|axis| whole.coordinate(axis, cell[axis]));
                [x, y].iter().zip(folded).fold(0.0, |sum, (x, folded)| 10.0 * sum + if folded { x.abs() } else { *x })
            };
            let field: Vec<f64> = (0..600).map(|k| even([k / 30, k % 30])).collect();
            let own: Vec<f64> = region.cut(&field).collect();
            for (k, &value) in own.iter().enumerate() {
                assert_eq!(
                    region.grid().center(k / region.cells()[1], k % region.cells()[1]),
                    whole.center(region.cell(k)[0], region.cell(k)[1])
                );
                assert_eq!((region.find(region.cell(k)), value), (Some(k), even(region.cell(k))));
            }
            let mut spread = vec![f64::NAN; 600];
            region.show(&own, &mut spread);
            for k in 0..600 {
                let cell = [k / 30, k % 30];
                assert!(if region.find(cell).is_some() { spread[k] == field[k] } else { spread[k].is_nan() });
            }
            assert_eq!(region.covers(), spread.iter().all(|x| !x.is_nan()));
            let cell = [region.cell(0), region.cell(region.len() - 1)];
            for k in [0, region.len() - 1] {
                let mut one = vec![0.0; region.len()];
                one[k] = 1.0;
                let mut images = vec![0.0; 600];
                region.show(&one, &mut images);
                let of = |axis: usize| {
                    let along = |k: usize| [k / 30, k % 30][axis];
                    let touched = || (0..600).filter(|&k| images[k] > 0.0).map(along);
                    (touched().min().unwrap(), touched().max().unwrap())
                };
                let Extent { low, high } = region.reach(&one).unwrap();
                assert_eq!([(low[0], high[0]), (low[1], high[1])], [of(0), of(1)], "{cell:?} {folded:?}");
            }
            assert_eq!(region.reach(&vec![0.0; region.len()]), None);
            let transferred = region.transfer(&own, &Region::whole(&whole, [false; 2]), |_| f64::NAN);
            assert!(transferred.iter().zip(&spread).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())));
        }
    }
}

#[test]
fn sizes_grow_by_a_quarter_at_most() {
    let sizes: Vec<usize> = (1..200).map(suitable).collect();
    assert!(sizes.iter().zip(1..).all(|(&size, wanted)| size >= wanted && (wanted < 4 || 4 * size <= 5 * wanted + 3)));
    assert_eq!(suitable(129), 160);
}
