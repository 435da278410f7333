//! The pressure of a contact on levels over the distance from its middle.

/// Number of distances from the edge at which the pressure is looked at, over the radius, and the ratio of two of them.
const PLACES: i32 = 28;
const RATIO: f64 = 0.75;
/// Number of parts between two of them beside the highest.
const FINER: i32 = 4;
/// Least height of an inner edge over the pressure around it that is looked at, as a part of the greatest pressure.
const STANDS_OUT: f64 = 1e-3;

/// What a group of levels adds to the pressure of a contact.
#[derive(Debug, Clone, Copy)]
struct Ring {
    share: f64,
    outer: f64,
}

/// The groups of a contact, by ascending radius.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    rings: Vec<Ring>,
    edge: f64,
}

/// The greatest pressure of a contact, in a unit of its own, and whether it is in the middle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Peak {
    pub(super) pressure: f64,
    /// Distance from the middle.
    pub(super) place: f64,
    pub(super) is_central: bool,
}

impl Rings {
    /// From the level, the traction and the radius of the edge of each group: q = dp/dl ∝ 1/(a √(a² − r²)), and l ∝ a³ between two
    /// levels, on a `line` 1/√(a² − x²) and a².
    pub(super) fn new(groups: impl Iterator<Item = (f64, f64, f64)>, line: bool) -> Rings {
        let power = if line { 2 } else { 3 };
        let (mut bottom, mut inner) = (0.0, 0.0_f64);
        let ring = |(level, traction, outer): (f64, f64, f64)| {
            let width = outer.powi(power) - inner.powi(power);
            let ring = Ring { share: traction * (level - bottom) / width, outer };
            (bottom, inner) = (level, outer);
            (width > 0.0).then_some(ring)
        };
        let rings: Vec<Ring> = groups.filter_map(ring).collect();
        let edge = rings.last().map_or(0.0, |last| last.outer);
        Rings { rings, edge }
    }

    /// Σ w ∫ q dl in the middle.
    pub(super) fn centre(&self) -> f64 {
        self.mean(0.0, 0.0)
    }

    /// The mean pressure over a width across the rim.
    fn mean(&self, place: f64, width: f64) -> f64 {
        let of_disc = |edge: f64| {
            if width == 0.0 {
                return (edge * edge - place * place).max(0.0).sqrt();
            }
            let integral = |place: f64| {
                let at = place.clamp(-edge, edge);
                0.5 * (at * (edge * edge - at * at).max(0.0).sqrt() + edge * edge * (at / edge).asin())
            };
            if edge > 0.0 { (integral(place + 0.5 * width) - integral(place - 0.5 * width)) / width } else { 0.0 }
        };
        let mut inner = 0.0;
        let part = |ring: &Ring| {
            let before = std::mem::replace(&mut inner, of_disc(ring.outer));
            ring.share * (inner - before)
        };
        self.rings.iter().map(part).sum()
    }

    /// The mean pressure over this width of the rim.
    pub(super) fn outermost(&self, width: f64) -> f64 {
        self.mean(self.edge - 0.5 * width, width)
    }

    /// The greatest pressure: in the middle, or as a mean over a width elsewhere. Places are looked at, nearer to each other towards the rim, and inner
    /// edges of groups that carry more than those inside them, where the pressure has a kink; then places around the highest.
    pub(super) fn peak(&self, width: f64) -> Peak {
        let of = |place: f64| (place, if place == 0.0 { self.centre() } else { self.mean(place, width) });
        let higher = |a: (f64, f64), b: (f64, f64)| if b.1 > a.1 { b } else { a };
        let places = (0..=PLACES).map(|k| self.edge * (1.0 - RATIO.powi(k)));
        let least = STANDS_OUT * self.centre();
        let stands_out = |pair: &&[Ring]| {
            let [inside, ring] = [pair[0], pair[1]];
            (ring.share - inside.share) * (ring.outer * ring.outer - inside.outer * inside.outer).sqrt() > least
        };
        // the pressure falls from a kink more slowly to the outside
        let kinks = self.rings.windows(2).filter(stands_out).map(|pair| pair[0].outer + 0.5 * width);
        let highest = places.chain(kinks).map(of).fold((0.0, 0.0), higher);
        let nearer = |part: i32| self.edge - (self.edge - highest.0) * RATIO.powf(f64::from(part) / f64::from(FINER));
        let around = (1 - FINER..FINER).map(nearer).filter(|place| *place > 0.0);
        let (place, pressure) = around.map(of).fold(highest, higher);
        Peak { pressure, place, is_central: place == 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::Rings;

    /// Hertz: p ∝ √(a² − r²); a rim that carries more is a peak beside the middle, which a wide cell blurs.
    #[test]
    fn the_greatest_pressure_is_in_the_middle_or_at_a_strong_rim() {
        let of = |rim: f64| {
            let groups = (1..=200).map(|k| f64::from(k) / 200.0);
            Rings::new(groups.map(|edge| (edge.powi(3), if edge > 0.9 { rim } else { 1.0 }, edge)), false)
        };
        let hertz = of(1.0);
        assert!(hertz.peak(0.0).is_central && (hertz.peak(0.0).pressure / hertz.centre() - 1.0).abs() < 1e-12);
        assert!((hertz.mean(0.6, 0.0) / hertz.centre() - 0.8).abs() < 1e-12);
        let strong = of(10.0);
        let (sharp, blurred) = (strong.peak(0.0), strong.peak(0.2));
        let kink = strong.mean(0.9, 0.0);
        assert!(!sharp.is_central && (sharp.pressure / kink - 1.0).abs() < 1e-12, "{} {kink}", sharp.pressure);
        assert!(blurred.pressure < 0.95 * sharp.pressure);
        assert!((strong.mean(0.5, 1e-3) / strong.mean(0.5, 0.0) - 1.0).abs() < 1e-5);
    }
}
