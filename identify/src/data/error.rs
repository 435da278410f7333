/// What is wrong with a measured curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A column that this reading of the curve needs was not in the file.
    #[error("the file has no column of the {column}; {cure}")]
    NoColumn {
        /// The column.
        column: &'static str,
        /// What to do instead.
        cure: &'static str,
    },

    /// Times in a file do not ascend.
    #[error(
        "line {line}: the time {value:?} s follows {previous:?} s: times must ascend; where the time of each segment begins anew, add the end of the segment before; drop repeated rows"
    )]
    TimesNotAscending {
        /// The line, from 1.
        line: u64,
        /// The time \[s\].
        value: f64,
        /// The time before it \[s\].
        previous: f64,
    },

    /// A curve has too few points to tell a contact from scatter.
    #[error("a curve of {points} points is too short: at least {least} are needed; measure at a higher rate")]
    TooFewPoints {
        /// Points of the curve.
        points: usize,
        /// Points needed.
        least: usize,
    },

    /// The force falls where the tip goes deeper.
    #[error(
        "the force falls by {fall:.2e} N from the shallow to the deep end of the curve: forces that press are positive; use Recording::flip_force"
    )]
    ForceFlipped {
        /// The fall \[N\].
        fall: f64,
    },

    /// The force changes where the drive is low and stays where it is high.
    #[error(
        "the force changes by {shallow:.2e} N in the lower half of the drive, and by {deep:.2e} N in the upper half: the drive grows toward the sample; use Recording::flip_drive"
    )]
    DriveFlipped {
        /// Range of the force in the lower half of the drive \[N\].
        shallow: f64,
        /// Range of the force in the upper half of the drive \[N\].
        deep: f64,
    },

    /// The spring would give way by more than the drive moves.
    #[error(
        "the force deflects the spring by {deflection:.2e} m while the drive moves by {travel:.2e} m: check the stiffness of the spring, and the units of force and drive"
    )]
    SpringTooSoft {
        /// Deflection of the spring from first touch to the greatest force \[m\].
        deflection: f64,
        /// Motion of the drive in this time \[m\].
        travel: f64,
    },

    /// The depth is larger than the contact.
    #[error(
        "the depth reaches {depth:.2e} m, more than the contact radius of {radius:.2e} m there: check the unit of the drive and the size of the tip (a thousandth would be plausible)"
    )]
    DepthTooLarge {
        /// The depth \[m\].
        depth: f64,
        /// Radius of a circle of the contact area of this tip at this depth \[m\].
        radius: f64,
    },

    /// Force and depth give a modulus that no material has.
    #[error(
        "force and depth give a contact modulus of about {modulus:.2e} Pa: no material is outside 1 Pa to 10 TPa; check the units of force and drive, and the size of the tip"
    )]
    Modulus {
        /// Force over the elastic level of the tip \[Pa\].
        modulus: f64,
    },
}
