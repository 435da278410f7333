//! Quadrature for references.

/// Gauss–Legendre points and weights on −1 … 1, the positive ones of ten: exact for degree 19.
const RULE: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Points and weights on an interval in equal pieces.
pub fn points(from: f64, to: f64, pieces: usize) -> impl Iterator<Item = (f64, f64)> {
    let half = 0.5 * (to - from) / pieces as f64;
    let piece = move |n: usize| {
        let middle = from + half * (2 * n + 1) as f64;
        RULE.into_iter().flat_map(move |(x, w)| [(middle + half * x, half * w), (middle - half * x, half * w)])
    };
    (0..pieces).flat_map(piece)
}
