//! What the error in time of a step depends on, besides the step.

/// How bodies may meet again, on a surface that recovers.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Meeting {
    /// The depth below first touch to which they may come back; 0 if they do not.
    pub(crate) depth: f64,
    /// The response of v to an error of u soon after they meet, if the approach is given.
    pub(crate) stiffness: f64,
    /// The compliance in series with the bodies: 0 where the approach is given, infinite where the force is.
    pub(crate) give: f64,
}

impl Meeting {
    /// Bodies that do not come back.
    pub(crate) const NONE: Meeting = Meeting { depth: 0.0, stiffness: 0.0, give: f64::INFINITY };

    /// The deepest and stiffest of two.
    pub(crate) fn worst(self, other: Meeting) -> Meeting {
        Meeting {
            depth: self.depth.max(other.depth),
            stiffness: self.stiffness.max(other.stiffness),
            give: self.give.min(other.give),
        }
    }
}

/// Data of a run besides the step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outlook {
    /// Mean displacement and v that are to be expected of the maximum loads.
    pub(crate) expected: [f64; 2],
    /// How the bodies may meet again.
    pub(crate) meeting: Meeting,
    /// The mean errors of u that earlier steps have left, in contact and outside.
    pub(crate) lasting: [f64; 2],
    /// Where a given approach is to follow a given force: the errors of u at that moment, each over the glassy
    /// compliance, that a unit of a defect of v leaves in this step and in all steps; 0 where none is to follow.
    pub(crate) on_switch: [f64; 2],
    /// The mean v of the maximum loads, to which the error at that moment is relative; 0 where none is to follow.
    pub(crate) greatest_on_switch: f64,
    /// Whether the load has a corner or jumps at the end of the step, which no step then puts right.
    pub(crate) is_last: bool,
    /// How far the defects of the run agree in sign, 0 … 1.
    pub(crate) agreement: f64,
    /// Steps so far, this one included.
    pub(crate) steps: f64,
    /// Events that take less time than this do not matter: an immediate dashpot presses on a body that meets a cell
    /// with a finite pressure at once, however short the step.
    pub(crate) resolution: f64,
    /// Steps of at most this length have no estimated error on a body without elastic response, which hardly moves in
    /// them.
    pub(crate) beginning: f64,
    /// Whether the length of the step is given: the first step after a jump or a corner is then not chosen by its
    /// error.
    pub(crate) length_is_given: bool,
}

/// A step of given length, beside which nothing is known.
impl Default for Outlook {
    fn default() -> Outlook {
        Outlook {
            expected: [0.0; 2],
            meeting: Meeting::default(),
            lasting: [0.0; 2],
            on_switch: [0.0; 2],
            greatest_on_switch: 0.0,
            is_last: false,
            agreement: 1.0,
            steps: f64::INFINITY,
            resolution: 0.0,
            beginning: 0.0,
            length_is_given: true,
        }
    }
}
