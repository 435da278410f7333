//! The drive over time, measured or planned.

use std::f64::consts::TAU;

use viscocontact::Error as ContactError;

use crate::error::{Error, Result, count_within, positive, same_length, within};

/// The drive over time: a depth, or the position of a base that carries the tip on a spring.
///
/// Between two times the drive is linear. It grows toward the sample, and is 0 where the tip touches first.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Protocol {
    pub(crate) times: Vec<f64>,
    pub(crate) drive: Vec<f64>,
}

impl Protocol {
    /// A drive \[m\] at ascending `times` \[s\].
    ///
    /// # Errors
    /// If the lengths differ, there are fewer than two times, a value is not finite, or times do not ascend.
    pub fn new(times: Vec<f64>, drive: Vec<f64>) -> Result<Protocol> {
        same_length("drive", drive.len(), times.len())?;
        count_within("times of the protocol", times.len(), times.len() > 1, "2 or more")?;
        for (field, values) in [("drive", &drive), ("time", &times)] {
            values.iter().try_for_each(|&value| within(field, value, true, "finite").map(drop))?;
        }
        if let Some((index, pair)) = times.windows(2).enumerate().find(|(_, pair)| pair[1] <= pair[0]) {
            let rule = "ascend: sort the rows, and drop repeated ones";
            let (index, previous, value) = (index + 1, pair[0], pair[1]);
            return Err(ContactError::OutOfOrder { field: "time", index, value, previous, rule }.into());
        }
        Ok(Protocol { times, drive })
    }

    /// Plans a protocol piece by piece, from the drive `start` \[m\] at the time 0; each piece is sampled at equal
    /// intervals of `interval` \[s\] or a little less, so that its corners are samples.
    ///
    /// ```
    /// use viscocontact_identify::Protocol;
    ///
    /// // a relaxation, a step further, and an oscillation of 2 Hz about it
    /// let protocol = Protocol::builder(0.0, 0.1)
    ///     .line(1.0e-6, 0.5)
    ///     .hold(10.0)
    ///     .line(1.2e-6, 0.1)
    ///     .hold(5.0)
    ///     .oscillate(10.0e-9, 2.0, 5, 40)
    ///     .line(0.0, 0.5)
    ///     .build()?;
    /// assert_eq!(protocol.times().last(), Some(&18.6));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    pub fn builder(start: f64, interval: f64) -> ProtocolBuilder {
        let checked = within("start of the drive", start, true, "finite");
        let error = checked.and_then(|_| positive("interval of samples", interval)).err();
        ProtocolBuilder { interval, times: vec![0.0], drive: vec![start], error }
    }

    /// A trapezoid: from 0 to `depth` \[m\], held there, and back to 0, in the `durations` \[s\] of rise, hold and fall;
    /// a duration of hold of 0 makes a triangle.
    ///
    /// ```
    /// use viscocontact_identify::Protocol;
    ///
    /// let protocol = Protocol::trapezoid(1.0e-6, [1.0, 1.0, 1.0], 0.5)?;
    /// assert_eq!(protocol.drive(), [0.0, 0.5e-6, 1.0e-6, 1.0e-6, 1.0e-6, 0.5e-6, 0.0]);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the depth, the rise, the fall or the interval is not finite and positive, or the hold negative.
    pub fn trapezoid(depth: f64, [rise, hold, fall]: [f64; 3], interval: f64) -> Result<Protocol> {
        positive("depth", depth)?;
        Protocol::builder(0.0, interval).line(depth, rise).hold(hold).line(0.0, fall).build()
    }

    /// A ramp at `speed` \[m/s\] from `distance` \[m\] above the surface to the drive `depth` \[m\], a hold of `hold` \[s\], and the
    /// way back at the same speed: the force curve of an atomic force microscope, where the drive is the position of the base.
    ///
    /// ```
    /// use viscocontact_identify::Protocol;
    ///
    /// let protocol = Protocol::ramp_hold_retract(2.0e-6, [1.0e-6, 3.0e-6], 5.0, 0.01)?;
    /// assert_eq!(protocol.drive()[0], -1.0e-6);
    /// assert_eq!(protocol.times().last(), Some(&9.0));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// If speed, depth or interval is not finite and positive, or distance or hold negative.
    pub fn ramp_hold_retract(speed: f64, [distance, depth]: [f64; 2], hold: f64, interval: f64) -> Result<Protocol> {
        positive("speed", speed)?;
        positive("depth", depth)?;
        within("distance above the surface", distance, distance >= 0.0, "finite and >= 0")?;
        let ramp = (distance + depth) / speed;
        Protocol::builder(-distance, interval).line(depth, ramp).hold(hold).line(-distance, ramp).build()
    }

    /// A staircase: each of the `depths` \[m\] is approached in the time `rise` \[s\] and held for `dwell` \[s\]. Depths may fall.
    ///
    /// # Errors
    /// If there are no depths, one is not finite, rise or interval is not finite and positive, or the dwell negative.
    pub fn staircase(depths: &[f64], rise: f64, dwell: f64, interval: f64) -> Result<Protocol> {
        count_within("depths of the staircase", depths.len(), !depths.is_empty(), "1 or more")?;
        let start = Protocol::builder(0.0, interval);
        depths.iter().fold(start, |stairs, &depth| stairs.line(depth, rise).hold(dwell)).build()
    }

    /// The times \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The drive at each time \[m\].
    pub fn drive(&self) -> &[f64] {
        &self.drive
    }
}

/// A protocol that is planned piece by piece, see [`Protocol::builder`]. The first piece that is not allowed makes
/// [`ProtocolBuilder::build`] fail.
#[derive(Clone, Debug)]
#[must_use = "a builder plans nothing until it is built"]
pub struct ProtocolBuilder {
    interval: f64,
    times: Vec<f64>,
    drive: Vec<f64>,
    error: Option<Error>,
}

/// A piece is this much longer than a whole number of intervals by rounding alone.
const ROUNDING: f64 = 1e-9;
/// Upper limit of the samples of a protocol: more are a wrong unit of time.
const MOST_SAMPLES: f64 = 1e8;

impl ProtocolBuilder {
    /// `count` equal intervals over a `duration`, with the drive as a function of the share of it, unless a value was refused.
    fn extend(mut self, checked: Result<impl Sized>, count: f64, duration: f64, drive: impl Fn(f64) -> f64) -> Self {
        let allowed = "at most 1e8: check the unit of time";
        let checked = checked.and_then(|_| within("samples of a piece", count, count <= MOST_SAMPLES, allowed));
        self.error = self.error.or(checked.err());
        let ([start, _], count) = (self.end(), if self.error.is_none() { count } else { 0.0 });
        for share in (1..=count as usize).map(|k| k as f64 / count) {
            self.times.push(start + share * duration);
            self.drive.push(drive(share));
        }
        self
    }

    /// Time and drive at the end.
    fn end(&self) -> [f64; 2] {
        [&self.times, &self.drive].map(|column| column.last().copied().unwrap_or_default())
    }

    /// The number of intervals in a duration.
    fn intervals(&self, duration: f64) -> f64 {
        (duration / self.interval - ROUNDING).ceil().max(1.0)
    }

    /// Samples the pieces that follow at another `interval` \[s\].
    pub fn every(mut self, interval: f64) -> ProtocolBuilder {
        self.interval = interval;
        self.extend(positive("interval of samples", interval), 0.0, 0.0, |_| 0.0)
    }

    /// On a straight line to `drive` \[m\] within `duration` \[s\].
    pub fn line(self, drive: f64, duration: f64) -> ProtocolBuilder {
        let (from, count) = (self.end()[1], self.intervals(duration));
        let checked = within("drive", drive, true, "finite").and_then(|_| positive("duration of a line", duration));
        let at = |share: f64| if share == 1.0 { drive } else { from + share * (drive - from) };
        self.extend(checked, count, duration, at)
    }

    /// At the same drive for `duration` \[s\]; 0 is no hold.
    pub fn hold(self, duration: f64) -> ProtocolBuilder {
        let drive = self.end()[1];
        if duration == 0.0 { self } else { self.line(drive, duration) }
    }

    /// A sine of `amplitude` \[m\] about the present drive for a number of whole `periods` of the `frequency` \[Hz\], each of so
    /// many `samples`, whatever the interval of other pieces. Between samples the drive is linear: its amplitude as a sine is
    /// lower by (π/samples)²/3.
    pub fn oscillate(self, amplitude: f64, frequency: f64, periods: usize, samples: usize) -> ProtocolBuilder {
        let (middle, count) = (self.end()[1], periods as f64 * samples as f64);
        let checked = positive("amplitude", amplitude)
            .and_then(|_| positive("frequency", frequency))
            .and_then(|_| count_within("periods", periods, periods > 0, "1 or more"))
            .and_then(|()| count_within("samples of a period", samples, samples >= 4, "4 or more"));
        let sine = |share: f64| if share == 1.0 { 0.0 } else { (TAU * periods as f64 * share).sin() };
        let duration = periods as f64 / frequency;
        self.extend(checked, count, duration, |share| middle + amplitude * sine(share))
    }

    /// The protocol.
    ///
    /// # Errors
    /// If a value of a piece is outside its range, or there is no piece.
    pub fn build(self) -> Result<Protocol> {
        self.error.map_or_else(|| Protocol::new(self.times, self.drive), Err)
    }
}
