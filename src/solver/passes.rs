//! The passes of the active set over its fields, for a single body that does not tilt: the common scene.
//!
//! Cells in contact come in runs, pieces of rows; each pass reads and writes whole pieces of memory, does all
//! there is to do with what it has read, and sums in eight lanes, so that additions need not wait for each other.

/// Lanes of the sums.
const LANES: usize = 8;

/// Cells looked at together in search of runs.
const BLOCK: usize = 32;

/// Does `$body` for each entry of slices of equal length; `$lane` counts 0 … 7 round.
macro_rules! each {
    ($lane:ident; read $($input:ident),*; write $($output:ident),*; $body:block) => {{
        $(let $input = $input.as_chunks::<LANES>();)*
        $(let $output = $output.as_chunks_mut::<LANES>();)*
        let chunks = 0 $(.max($input.0.len()))* $(.max($output.0.len()))*;
        for chunk in 0..chunks {
            $(let $input = &$input.0[chunk];)*
            $(let $output = &mut $output.0[chunk];)*
            for $lane in 0..LANES {
                $(let $input = $input[$lane];)*
                $(let $output = &mut $output[$lane];)*
                $body
            }
        }
        let rest = 0 $(.max($input.1.len()))* $(.max($output.1.len()))*;
        for $lane in 0..rest {
            $(let $input = $input.1[$lane];)*
            $(let $output = &mut $output.1[$lane];)*
            $body
        }
    }};
}

/// Cells in contact, as first and last-but-one of pieces of rows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Runs(Vec<[u32; 2]>);

impl Runs {
    pub(crate) fn with_capacity(cells: usize) -> Runs {
        Runs(Vec::with_capacity(cells.div_ceil(2)))
    }

    /// Finds the runs of members.
    pub(crate) fn find(&mut self, member: &[bool]) {
        self.0.clear();
        let mut start = None;
        for (block, values) in member.chunks(BLOCK).enumerate() {
            // most blocks are all of one kind, the kind at hand
            let inside = start.is_some();
            if values.iter().fold(true, |same, &m| same & (m == inside)) {
                continue;
            }
            for (k, &m) in values.iter().enumerate() {
                let k = (block * BLOCK + k) as u32;
                match start {
                    None if m => start = Some(k),
                    Some(first) if !m => {
                        self.0.push([first, k]);
                        start = None;
                    }
                    _ => {}
                }
            }
        }
        self.0.extend(start.map(|first| [first, member.len() as u32]));
    }

    pub(crate) fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        self.0.iter().map(|[start, end]| *start as usize..*end as usize)
    }
}

/// What [`survey`] finds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Survey {
    /// Σ r, Σ r², Σ (c v)², Σ min(p, 0)² over the cells in contact.
    pub(crate) residual: f64,
    pub(crate) square: f64,
    pub(crate) displacement: f64,
    pub(crate) negative: f64,
    /// The greatest |gap| of them.
    pub(crate) height: f64,
    /// The greatest −(c v + gap) of all others.
    pub(crate) depth: f64,
}

/// The fields that [`survey`] goes through.
pub(crate) struct Fields<'a> {
    pub(crate) gap: &'a [f64],
    pub(crate) direction: &'a [f64],
    pub(crate) image: &'a [f64],
    pub(crate) pressure: &'a mut [f64],
    pub(crate) potential: &'a mut [f64],
    pub(crate) residual: &'a mut [f64],
}

/// p += a d, v += a K d, and r = motion − (c v + gap) on the cells in contact, with all sums that follow from them.
pub(crate) fn survey(runs: &Runs, a: f64, c: f64, motion: f64, fields: Fields<'_>) -> Survey {
    let Fields { gap, direction, image, pressure, potential, residual } = fields;
    let (mut sum, mut square, mut displacement, mut negative) =
        ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let (mut height, mut depth) = ([0.0; LANES], [f64::NEG_INFINITY; LANES]);
    let mut outside = 0;
    for run in runs.ranges().chain(std::iter::once(gap.len()..gap.len())) {
        let apart = outside..run.start;
        outside = run.end;
        let (v, kd, h) = (&mut potential[apart.clone()], &image[apart.clone()], &gap[apart]);
        each!(lane; read kd, h; write v; {
            *v += a * kd;
            let below = -(c * *v + h);
            if below > depth[lane] {
                depth[lane] = below;
            }
        });
        let (v, kd, h) = (&mut potential[run.clone()], &image[run.clone()], &gap[run.clone()]);
        let (p, d, r) = (&mut pressure[run.clone()], &direction[run.clone()], &mut residual[run]);
        each!(lane; read kd, h, d; write v, p, r; {
            *v += a * kd;
            *p += a * d;
            let u = c * *v;
            let below = motion - (u + h);
            *r = below;
            sum[lane] += below;
            square[lane] += below * below;
            displacement[lane] += u * u;
            let under = if *p < 0.0 { *p } else { 0.0 };
            negative[lane] += under * under;
            let high = h.abs();
            if high > height[lane] {
                height[lane] = high;
            }
        });
    }
    Survey {
        residual: total(sum),
        square: total(square),
        displacement: total(displacement),
        negative: total(negative),
        height: height.into_iter().fold(0.0, f64::max),
        depth: depth.into_iter().fold(f64::NEG_INFINITY, f64::max),
    }
}

/// z = r − mean in contact, where z is zero elsewhere; returns Σ z².
pub(crate) fn center(runs: &Runs, mean: f64, residual: &mut [f64], z: &mut [f64]) -> f64 {
    z.fill(0.0);
    let mut square = [0.0; LANES];
    for run in runs.ranges() {
        let (r, z) = (&mut residual[run.clone()], &mut z[run]);
        each!(lane; read; write r, z; {
            *r -= mean;
            *z = *r;
            square[lane] += *r * *r;
        });
    }
    total(square)
}

/// Σ z, Σ z·Kd, Σ Kd and Σ d in contact.
pub(crate) fn overlaps(runs: &Runs, z: &[f64], image: &[f64], direction: &[f64]) -> [f64; 4] {
    let mut sums = [[0.0; LANES]; 4];
    for run in runs.ranges() {
        let (z, kd, d) = (&z[run.clone()], &image[run.clone()], &direction[run]);
        each!(lane; read z, kd, d; write; {
            sums[0][lane] += z;
            sums[1][lane] += z * kd;
            sums[2][lane] += kd;
            sums[3][lane] += d;
        });
    }
    sums.map(total)
}

/// d ← scale (z + β d + shift) in contact, 0 elsewhere.
pub(crate) fn redirect(runs: &Runs, [scale, beta, shift]: [f64; 3], z: &[f64], direction: &mut [f64]) {
    let mut outside = 0;
    for run in runs.ranges() {
        direction[outside..run.start].fill(0.0);
        outside = run.end;
        let (z, d) = (&z[run.clone()], &mut direction[run]);
        each!(_lane; read z; write d; {
            *d = scale * (z + beta * *d + shift);
        });
    }
    direction[outside..].fill(0.0);
}

/// Σ r·d and Σ d·Kd in contact.
pub(crate) fn slope_and_curvature(runs: &Runs, residual: &[f64], direction: &[f64], image: &[f64]) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    for run in runs.ranges() {
        let (r, d, kd) = (&residual[run.clone()], &direction[run.clone()], &image[run]);
        each!(lane; read r, d, kd; write; {
            sums[0][lane] += r * d;
            sums[1][lane] += d * kd;
        });
    }
    sums.map(total)
}

fn total(lanes: [f64; LANES]) -> f64 {
    lanes.into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_the_members() {
        for (cells, period, length) in [(1, 1, 1), (100, 7, 3), (96, 48, 40), (97, 97, 97), (64, 33, 32), (200, 1, 0)] {
            let member: Vec<bool> = (0..cells).map(|k| k % period < length).collect();
            let mut runs = Runs::with_capacity(cells);
            runs.find(&member);
            let mut found = vec![false; cells];
            runs.ranges().for_each(|run| found[run].fill(true));
            assert_eq!(found, member);
            assert!(runs.0.windows(2).all(|pair| pair[0][1] < pair[1][0]), "runs do not touch");
        }
    }

    /// Every pass against its definition, cell by cell.
    #[test]
    fn passes_match_their_definitions() {
        let n = 77;
        let field = |seed: f64| (0..n).map(|k| (seed * k as f64 + seed).sin()).collect::<Vec<f64>>();
        let member: Vec<bool> = (0..n).map(|k| (10..40).contains(&k) || k == 50 || k > 70).collect();
        let mut runs = Runs::default();
        runs.find(&member);
        let (gap, d, kd, c, motion, a) = (field(0.3), field(0.7), field(1.1), 0.8, 0.2, 0.4);
        let (mut p, mut v, mut r) = (field(1.3), field(1.7), vec![0.0; n]);
        let (p0, v0) = (p.clone(), v.clone());
        let fields =
            Fields { gap: &gap, direction: &d, image: &kd, pressure: &mut p, potential: &mut v, residual: &mut r };
        let found = survey(&runs, a, c, motion, fields);
        let (mut sums, mut deepest, mut highest) = ([0.0; 4], f64::NEG_INFINITY, 0.0_f64);
        for k in 0..n {
            let u = c * (v0[k] + a * kd[k]);
            assert_eq!(v[k], v0[k] + a * kd[k]);
            assert_eq!(p[k], if member[k] { p0[k] + a * d[k] } else { p0[k] });
            if !member[k] {
                deepest = deepest.max(-(u + gap[k]));
                continue;
            }
            let residual = motion - (u + gap[k]);
            assert_eq!(r[k], residual);
            highest = highest.max(gap[k].abs());
            let parts = [residual, residual * residual, u * u, p[k].min(0.0).powi(2)];
            (0..4).for_each(|m| sums[m] += parts[m]);
        }
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-13, "{a} {b}");
        near(found.residual, sums[0]);
        near(found.square, sums[1]);
        near(found.displacement, sums[2]);
        near(found.negative, sums[3]);
        assert_eq!((found.height, found.depth), (highest, deepest));

        let mut z = field(2.0);
        let square = center(&runs, 0.1, &mut r, &mut z);
        near(square, z.iter().map(|z| z * z).sum());
        assert!((0..n).all(|k| z[k] == if member[k] { r[k] } else { 0.0 }));
        let inside = |f: &dyn Fn(usize) -> f64| (0..n).filter(|&k| member[k]).map(f).sum::<f64>();
        let z = field(2.2);
        let sums = overlaps(&runs, &z, &kd, &d);
        near(sums[0], inside(&|k| z[k]));
        near(sums[1], inside(&|k| z[k] * kd[k]));
        near(sums[2], inside(&|k| kd[k]));
        near(sums[3], inside(&|k| d[k]));
        let [slope, curvature] = slope_and_curvature(&runs, &r, &d, &kd);
        near(slope, inside(&|k| r[k] * d[k]));
        near(curvature, inside(&|k| d[k] * kd[k]));
        let mut turned = d.clone();
        redirect(&runs, [2.0, 0.5, 0.1], &z, &mut turned);
        assert!((0..n).all(|k| turned[k] == if member[k] { 2.0 * (z[k] + 0.5 * d[k] + 0.1) } else { 0.0 }));
    }
}
