use std::fmt;
use std::sync::{Arc, Mutex};

use crate::ascending::{Ascending, TimeTable};
use crate::error::{Error, Refusal, Result, finite, within};
use crate::numeric::root;
use crate::quadrature::GaussLegendre;
use crate::rheology::TimeTemperature;
use crate::rounded::{TIME, rounded};

/// A temperature that changes in time, the same everywhere in the bodies.
///
/// Where all relaxation times share the shift factor a_T, a body at T(t) creeps as at the reference temperature, in
/// the reduced time ξ(t) = ∫ dt′/a_T(T(t′)) (Morland & Lee, *The stress analysis of linear viscoelastic materials
/// with temperature variation*, 1960). A contact built with one
/// ([`Builder::temperature`](crate::contact::Builder::temperature)) integrates its material over ξ; loads, motions,
/// reports and power stay in t.
///
/// Not modelled: thermal expansion, heating by dissipation, temperatures that differ from place to place, and bodies
/// of which only one follows the law. Moduli that change with temperature by more than their times are refused: a law
/// with [vertical factors](TimeTemperature::with_vertical_factors) says how they are at each temperature, not how the
/// stress changes while the temperature does. At one temperature take [`TimeTemperature::at`].
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
///
/// let law = TimeTemperature::wlf(17.44, 51.6, 373.15)?;
/// let warming = TemperatureHistory::table(law, &[(0.0, 373.15), (60.0, 393.15)])?;
/// assert_eq!(warming.at(30.0), 383.15);
/// // in this minute the body creeps as in six days at the reference temperature
/// let days = warming.reduced_time(0.0, 60.0)? / 86_400.0;
/// assert!((days - 5.989).abs() < 1e-3);
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Zener::with_time(1.0e8, 1.0e6, 1.0e3)?))
///     .temperature(warming)
///     .build()?;
/// contact.step(0.0, Load::force(0.5))?;
/// let jumped = contact.approach();
/// contact.step(60.0, Load::force(0.5))?; // the retardation time of 1000 s is long over
/// assert!(contact.reduced_time() > 8_000.0 * contact.time() && contact.approach() > 20.0 * jumped);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone)]
pub struct TemperatureHistory {
    law: TimeTemperature,
    course: Temperatures,
    rule: GaussLegendre,
    /// Room for the pieces of a quadrature, kept so that steps allocate none.
    pieces: Arc<Mutex<[Vec<Piece>; 2]>>,
}

/// Start and end \[s\] of a piece, and the quadrature over it.
type Piece = (f64, f64, f64);

#[derive(Clone)]
enum Temperatures {
    /// Linear between the times.
    Table(TimeTable<f64>),
    Function {
        temperature: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
        corners: Ascending,
    },
}

/// The quadrature of the rate over a piece, chosen on the closures of tests/time/temperature.rs.
struct Refinement {
    /// A piece is halved until its halves agree with it to this part of the whole, near rounding: twice as much costs a
    /// digit where the temperature bends.
    agreement: f64,
    /// Upper limit of pieces computed, which none of them reaches, nor half of it.
    most_pieces: usize,
    /// Noise limits the agreement: where there are many pieces, the refinement ends when halving leaves more than this
    /// part of the difference. From half of it to twice as much the same is known of noise.
    noise: f64,
}

const REFINEMENT: Refinement = Refinement { agreement: 1e-13, most_pieces: 1 << 14, noise: 0.75 };

/// The error of moduli that change with temperature, which `what` does not cover.
pub(crate) fn vertical_factors(what: &str) -> Error {
    let what = format!("{what} does not cover moduli that change with temperature (vertical factors b_T)");
    let remedy = ": move each material to one temperature by TimeTemperature::at, or leave the factors out with \
        TimeTemperature::without_vertical_factors";
    Refusal::unsupported("material_vertical_factors", what, remedy).into()
}

impl TemperatureHistory {
    /// The temperature through a `table` of times \[s\] and temperatures \[K\]: linear in between, constant before the
    /// first and after the last. Two entries at the same time are a jump. A ramp is a table of two, and a temperature
    /// that never changes of one.
    ///
    /// # Errors
    /// If there is no entry, a time is not finite or earlier than the one before, for a temperature as
    /// [`TimeTemperature::shift_factor`], or if the law has vertical factors.
    pub fn table(law: TimeTemperature, table: &[(f64, f64)]) -> Result<TemperatureHistory> {
        let checked = TimeTable::new(["temperature table", "temperature table times"], table, 1)?;
        table.iter().try_for_each(|&(_, temperature)| law.shift_factor(temperature).map(drop))?;
        TemperatureHistory::new(law, Temperatures::Table(checked))
    }

    /// The temperature \[K\] by a closure of the time \[s\], smooth but for `corners` \[s\], in any order: adaptive
    /// steps end there. The returned temperatures are checked when they are used.
    ///
    /// # Errors
    /// If a corner is not finite, or the law has vertical factors.
    pub fn function(
        law: TimeTemperature,
        temperature: impl Fn(f64) -> f64 + Send + Sync + 'static,
        corners: &[f64],
    ) -> Result<TemperatureHistory> {
        let mut sorted = Ascending::default();
        sorted.add("corner of the temperature", corners)?;
        TemperatureHistory::new(law, Temperatures::Function { temperature: Arc::new(temperature), corners: sorted })
    }

    fn new(law: TimeTemperature, course: Temperatures) -> Result<TemperatureHistory> {
        if law.has_vertical_factors() {
            return Err(vertical_factors("a history of the temperature"));
        }
        let pieces = Arc::new(Mutex::new([(); 2].map(|()| Vec::with_capacity(32))));
        Ok(TemperatureHistory { law, course, rule: GaussLegendre::new(12), pieces })
    }

    /// dξ/dt.
    fn rate(&self, time: f64) -> Result<f64> {
        Ok(1.0 / self.law.shift_factor(self.at(time))?)
    }

    /// The slowest rate at which the reduced time passes until `last`, at 64 temperatures.
    pub(crate) fn slowest(&self, last: f64) -> Result<f64> {
        (0..=64).try_fold(f64::INFINITY, |least: f64, k| Ok(least.min(self.rate(last * f64::from(k) / 64.0)?)))
    }

    /// The time–temperature law.
    pub fn law(&self) -> &TimeTemperature {
        &self.law
    }

    /// The temperature at `time` \[K\]; where it jumps, the one after.
    pub fn at(&self, time: f64) -> f64 {
        match &self.course {
            Temperatures::Table(table) => table.at(time, |from, to, share| from + share * (to - from)),
            Temperatures::Function { temperature, .. } => temperature(time),
        }
    }

    /// The reduced time \[s\] that passes between two times: ∫ dt/a_T(T(t)), to thirteen digits where the temperature
    /// is smooth between its corners, and to five at least.
    ///
    /// # Errors
    /// If a time is not finite, `to` is before `from`, the reduced time overflows, a closure is too rough, or for a
    /// temperature
    /// in between as [`TimeTemperature::shift_factor`].
    pub fn reduced_time(&self, from: f64, to: f64) -> Result<f64> {
        finite("start of the reduced time", from)?;
        finite("end of the reduced time", to)?;
        within("end of the reduced time", to, to >= from, "at or after its start")?;
        let (mut start, mut sum) = (from, 0.0);
        while start < to {
            let end = self.next_corner(start).map_or(to, |corner| corner.min(to));
            sum += self.piece(start, end)?;
            start = end;
        }
        finite("reduced time", sum)
    }

    /// The first corner or jump of the temperature after a time.
    pub(crate) fn next_corner(&self, after: f64) -> Option<f64> {
        match &self.course {
            Temperatures::Table(table) => table.after(after),
            Temperatures::Function { corners, .. } => corners.after(after),
        }
    }

    /// Whether the temperature jumps at a corner, within the resolution of a time.
    pub(crate) fn jumps_at(&self, corner: f64) -> bool {
        let before = self.at(corner.next_down());
        (self.at(corner) - before).abs() > 1e-9 * before.abs()
    }

    /// Approximate time after `from` in which the reduced time grows by `reduced`; at most `most`.
    pub(crate) fn length_of(&self, from: f64, reduced: f64, most: f64) -> Result<f64> {
        let guess = (reduced / self.rate(from)?).min(most);
        if guess == 0.0 {
            return Ok(guess);
        }
        let excess = |log: f64| {
            let length = guess * log.exp();
            match (self.reduced_time(from, from + length), self.rate(from + length)) {
                (Ok(grown), Ok(rate)) => [grown - reduced, rate * length],
                // temperatures beyond the range of the law are too far
                _ => [f64::INFINITY, 0.0],
            }
        };
        // to a thousandth, since only the order of magnitude matters; exp(700) is finite
        Ok((guess * root([-60.0, (most / guess).ln().min(700.0)], 0.0, 1e-3, excess).exp()).min(most))
    }

    /// ξ over a piece without corners inside.
    fn piece(&self, from: f64, to: f64) -> Result<f64> {
        if let Temperatures::Table(table) = &self.course
            && table.is_constant_after(from)
        {
            return Ok((to - from) * self.rate(from)?);
        }
        self.halved(from, to)
    }

    /// The quadrature over a piece, which is halved where halves do not agree with it.
    fn halved(&self, from: f64, to: f64) -> Result<f64> {
        let whole = finite("reduced time", self.quadrature(from, to)?)?;
        // a second thread takes room of its own
        let (mut shared, mut own) = (self.pieces.try_lock(), Default::default());
        let [pieces, finer] = shared.as_deref_mut().unwrap_or(&mut own);
        pieces.clear();
        pieces.push((from, to, whole));
        let (mut sum, mut all, mut computed) = (0.0, whole, 0);
        let (mut apart, mut before) = (0.0, f64::INFINITY);
        let most = REFINEMENT.most_pieces;
        while !pieces.is_empty() && computed < most && (pieces.len() < most / 32 || apart <= REFINEMENT.noise * before)
        {
            computed += pieces.len();
            (apart, before) = (0.0, apart);
            for (from, to, whole) in pieces.drain(..) {
                let middle = from + 0.5 * (to - from);
                if middle <= from || middle >= to {
                    sum += whole; // as short as the resolution of a time
                    continue;
                }
                let (first, second) = (self.quadrature(from, middle)?, self.quadrature(middle, to)?);
                all = all.max(first + second);
                let difference = (first + second - whole).abs();
                if difference <= REFINEMENT.agreement * all {
                    sum += first + second;
                } else {
                    apart += difference;
                    finer.extend([(from, middle, first), (middle, to, second)]);
                }
            }
            std::mem::swap(pieces, finer);
        }
        let sum = sum + pieces.iter().map(|(_, _, part)| part).sum::<f64>();
        if !pieces.is_empty() && apart > 1e-5 * sum {
            let what = format!(
                "the temperature between {} s and {} s is too rough for its reduced time, which is known to {:.0e}",
                rounded(from, TIME),
                rounded(to, TIME),
                apart / sum
            );
            let remedy = ": name its corners, or give it as a table (TemperatureHistory::table)";
            return Err(Refusal::value("material_rough_temperature", what, remedy)
                .naming("accuracy of the reduced time")
                .valued(apart / sum)
                .into());
        }
        Ok(sum)
    }

    fn quadrature(&self, from: f64, to: f64) -> Result<f64> {
        let mut invalid = None;
        let sum = self.rule.integrate(from, to, |time| match self.rate(time) {
            Ok(rate) => rate,
            Err(error) => {
                invalid.get_or_insert(error);
                0.0
            }
        });
        invalid.map_or(Ok(sum), Err)
    }

    /// The times and temperatures of a table, or the corners of a function.
    pub(crate) fn course(&self) -> std::result::Result<&[(f64, f64)], &[f64]> {
        match &self.course {
            Temperatures::Table(table) => Ok(table.as_slice()),
            Temperatures::Function { corners, .. } => Err(corners.as_slice()),
        }
    }
}

impl fmt::Debug for TemperatureHistory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TemperatureHistory");
        debug.field("law", &self.law);
        match &self.course {
            Temperatures::Table(table) => debug.field("table", table).finish(),
            Temperatures::Function { corners, .. } => {
                debug.field("corners", &corners.as_slice()).finish_non_exhaustive()
            }
        }
    }
}
