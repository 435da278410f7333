//! The error type of the crate.

use viscocontact::Error as ContactError;

/// Everything that can go wrong, with the numbers needed to correct it.
///
/// `Debug` prints the message, so that a program whose `main` returns [`Result`] ends with what to do.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter is outside its allowed range.
    #[error("{name} = {value:?} is not allowed: it must be {allowed}")]
    ParameterOutOfRange {
        /// Name of the parameter.
        name: String,
        /// The value given.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },

    /// A parameter that needs one value has none, or several.
    #[error("the parameter '{name}' is given {values} values: give it exactly one")]
    NotOneValue {
        /// Name of the parameter.
        name: String,
        /// The number of its values.
        values: usize,
    },

    /// There are not more data than free parameters.
    #[error(
        "{points} points in contact cannot determine {parameters} parameters: measure more points, or fix parameters"
    )]
    TooFewPoints {
        /// Points with the tip in contact.
        points: usize,
        /// Free parameters.
        parameters: usize,
    },

    /// The tip never touches the sample.
    #[error(
        "curve {curve}: the force nowhere rises above its scatter, or no more than correlated noise does, so the tip seems not to touch the sample: check the sign of the force and of the drive (both grow toward the sample), average curves against noise, or give the contact point"
    )]
    NoContact {
        /// Index of the curve.
        curve: usize,
    },

    /// The tip goes deeper than the elastic states reach.
    #[error(
        "curve {curve}: the depth of {depth:.2e} m is beyond the last elastic state of the tip: sweep it further, or check the unit of the drive"
    )]
    BeyondStates {
        /// Index of the curve.
        curve: usize,
        /// The depth \[m\].
        depth: f64,
    },

    /// The correlation of the noise is to be fitted where there are no data.
    #[error("bounds need the correlation of the noise: take Noise::AutoregressiveWith")]
    UnknownCorrelation,

    /// No values of the parameters give the measured forces even roughly.
    #[error("{}{reason}", if *.iterations > 0 { format!("the fit failed after {iterations} iterations: ") } else { String::new() })]
    NotConverged {
        /// Iterations done; 0 if the problem was not solvable to begin with.
        iterations: usize,
        /// What failed, and what to change.
        reason: &'static str,
    },

    /// A parameter has an unknown name.
    #[error("there is no parameter '{name}': the names are {names}")]
    UnknownParameter {
        /// The name given.
        name: String,
        /// All names.
        names: String,
    },

    /// A column that this reading of the curve needs was not in the file.
    #[error("the file has no column of the {column}; {remedy}")]
    NoColumn {
        /// The column.
        column: &'static str,
        /// What to do instead.
        remedy: &'static str,
    },

    /// Times in a file do not ascend.
    #[error(
        "line {line}: the time {value:?} s follows {previous:?} s: times must ascend; where the time of each segment begins anew, add the end of the segment before; drop repeated rows"
    )]
    RowsNotAscending {
        /// The line, from 1.
        line: u64,
        /// The time \[s\].
        value: f64,
        /// The time before it \[s\].
        previous: f64,
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
        /// Deflection of the spring from first touch to the maximum force \[m\].
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

    /// Fits of different data are compared.
    #[error("fits are ranked only if all are of the same curves, and none is robust: fit each model to the same data")]
    OtherData,

    /// A table of results cannot be written.
    #[error("the results cannot be written: {reason}")]
    Unwritable {
        /// The error of the writer or its format.
        reason: String,
    },

    /// An error of the contact, its tip or a file; a value or a count outside its range, or columns of other lengths.
    #[error(transparent)]
    Contact(#[from] ContactError),
}

impl std::fmt::Debug for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

/// Result with the crate's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Accepts finite values for which `inside` holds.
pub(crate) fn within(field: &'static str, value: f64, inside: bool, allowed: &'static str) -> Result<f64> {
    if value.is_finite() && inside { Ok(value) } else { Err(ContactError::OutOfRange { field, value, allowed }.into()) }
}

/// Accepts finite values above zero.
pub(crate) fn positive(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, value > 0.0, "finite and > 0")
}

/// Accepts a count for which `inside` holds.
pub(crate) fn count_within(field: &'static str, value: usize, inside: bool, allowed: &'static str) -> Result<()> {
    if inside { Ok(()) } else { Err(ContactError::CountOutOfRange { field, value, allowed }.into()) }
}

/// The error of a parameter that is none of some `names`.
pub(crate) fn unknown<'a>(name: &str, names: impl Iterator<Item = &'a String>) -> Error {
    Error::UnknownParameter { name: name.into(), names: names.cloned().collect::<Vec<_>>().join(", ") }
}

/// Accepts columns of equal length.
pub(crate) fn same_length(field: &'static str, len: usize, expected: usize) -> Result<()> {
    if len == expected { Ok(()) } else { Err(ContactError::WrongLength { field, len, expected, exact: true }.into()) }
}
