//! The extension against its definition.

use super::*;

fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// E by its definition, cell by cell.
fn dense(member: &[bool], values: &[f64], cells: [usize; 2], periodic: [bool; 2], attenuation: [f64; 2]) -> Vec<f64> {
    pull(&member.iter().map(|&m| f64::from(u8::from(m))).collect::<Vec<_>>(), values, cells, periodic, attenuation)
}

/// The extension is attenuated `levels_to_go` levels above this one.
fn pull(
    weight: &[f64],
    mean: &[f64],
    [n1, n2]: [usize; 2],
    periodic: [bool; 2],
    [levels_to_go, remains]: [f64; 2],
) -> Vec<f64> {
    if [n1, n2] == [1, 1] {
        return mean.to_vec();
    }
    let [m1, m2] = [n1.div_ceil(2), n2.div_ceil(2)];
    let (mut sums, mut weights) = (vec![0.0; m1 * m2], vec![0.0; m1 * m2]);
    for k in 0..n1 * n2 {
        let block = k / n2 / 2 * m2 + k % n2 / 2;
        sums[block] += weight[k] * mean[k];
        weights[block] += weight[k];
    }
    let means: Vec<f64> = sums.iter().zip(&weights).map(|(s, w)| if *w > 0.0 { s / w } else { 0.0 }).collect();
    let trusts: Vec<f64> = weights.iter().map(|w| TRUST * 0.25 * w / (1.0 + (TRUST - 1.0) * 0.25 * w)).collect();
    let mut coarse = pull(&trusts, &means, [m1, m2], periodic, [levels_to_go - 1.0, remains]);
    if levels_to_go == 0.0 {
        coarse.iter_mut().for_each(|x| *x *= remains);
    }
    let along = |k: usize, m: usize, periodic: bool| {
        let side = if k.is_multiple_of(2) { -1 } else { 1 };
        let far = (k / 2) as isize + side;
        let far = if periodic { far.rem_euclid(m as isize) } else { far.clamp(0, m as isize - 1) };
        [(k / 2, 0.75), (far as usize, 0.25)]
    };
    let value = |k: usize| {
        let mut up = 0.0;
        for (i, a) in along(k / n2, m1, periodic[0]) {
            up += along(k % n2, m2, periodic[1]).map(|(j, b)| a * b * coarse[i * m2 + j]).iter().sum::<f64>();
        }
        weight[k] * mean[k] + (1.0 - weight[k]) * up
    };
    (0..n1 * n2).map(value).collect()
}

#[test]
fn extension_matches_its_definition_and_has_an_exact_transpose() {
    let mut seed = 1;
    let sizes =
        [[16, 16], [13, 31], [20, 9], [32, 32], [1, 17], [17, 1], [1, 1], [2, 3], [64, 5], [370, 361], [5, 30000]];
    for cells in sizes {
        for periodic in [[true; 2], [false; 2], [true, false], [false, true]] {
            for share in [0.02, 0.3, 0.9, 1.0] {
                check(cells, periodic, share, &mut seed);
            }
        }
    }
}

fn check(cells: [usize; 2], periodic: [bool; 2], share: f64, seed: &mut u64) {
    let count = cells[0] * cells[1];
    let mut member: Vec<bool> = (0..count).map(|_| noise(seed) + 0.5 < share).collect();
    member[count / 2] = true;
    let mut extension = Extension::new(&Rows::all(cells), periodic, None);
    extension.fit(&member);
    let only = |value: &mut dyn FnMut() -> f64| -> Vec<f64> {
        member.iter().map(|&m| if m { value() } else { 0.0 }).collect()
    };
    let mut ones = only(&mut || 1.0);
    extension.extend(&mut ones, &member);
    assert!(ones.iter().all(|x| (x - 1.0).abs() < 1e-14), "constants are reproduced");

    let values = only(&mut || noise(seed));
    let mut extended = values.clone();
    extension.extend(&mut extended, &member);
    let expected = dense(&member, &values, cells, periodic, [-1.0, 1.0]);
    for (k, (a, b)) in extended.iter().zip(&expected).enumerate() {
        assert!((a - b).abs() < 1e-14, "{cells:?} {periodic:?}: {a} instead of {b} at {k}");
    }
    has_transpose(&mut extension, &member, &values, ExtensionKind::Unbounded, seed);

    // from blocks of two cells at least
    for (reach, level) in [(0.3, 0.0), (2.0, 0.0), (4.0, 1.0), (5.9, 1.0), (1e9, 28.0)] {
        let mut extension = Extension::new(&Rows::all(cells), periodic, Some(Attenuation { reach, remains: -0.3 }));
        extension.fit(&member);
        let mut extended = values.clone();
        extension.extend(&mut extended, &member);
        let expected = dense(&member, &values, cells, periodic, [level, -0.3]);
        for (k, (a, b)) in extended.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 1e-14, "{cells:?} {periodic:?}, {reach}: {a} instead of {b} at {k}");
        }
        has_transpose(&mut extension, &member, &values, ExtensionKind::Attenuated, seed);
    }
}

fn has_transpose(extension: &mut Extension, member: &[bool], values: &[f64], kind: ExtensionKind, seed: &mut u64) {
    let mut extended = values.to_vec();
    extension.extend(&mut extended, member);
    let field: Vec<f64> = values.iter().map(|_| noise(seed)).collect();
    let mut gathered = field.clone();
    extension.gather(&mut gathered, member, kind);
    let terms = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
    let [there, back] = [terms(&extended, &field), terms(values, &gathered)];
    let rounding: f64 = there.iter().chain(&back).map(|term| 1e-15 * term.abs()).sum();
    let [there, back] = [there, back].map(|terms| terms.iter().sum::<f64>());
    assert!((there - back).abs() < 2.0 * rounding, "{there} {back}");
    assert!(member.iter().zip(&gathered).all(|(&m, &x)| m || x == 0.0));
    // the unbounded extension keeps the sum, with and without an attenuation
    let mut kept = field.clone();
    extension.gather(&mut kept, member, ExtensionKind::Unbounded);
    let [before, after] = [field.iter().sum::<f64>(), kept.iter().sum()];
    assert!((before - after).abs() < 1e-12 * (1.0 + field.len() as f64).sqrt(), "{before} {after}");
}
