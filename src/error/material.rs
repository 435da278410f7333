use crate::rounded::{TIME, rounded};

/// What is wrong with a rheology or a material.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// An exponential series of the creep compliance is needed, and the rheology has no exact one
    /// ([`Rheology::creep_spectrum`](crate::rheology::Rheology::creep_spectrum) is `None`). One is fitted over the
    /// times that [`Builder::times`](crate::contact::Builder::times) or
    /// [`Builder::times_of`](crate::contact::Builder::times_of) names; a material is fitted beforehand by
    /// [`Material::fitted`](crate::rheology::Material::fitted).
    #[error(
        "{what} needs an exponential series, and {rheology} has no exact one: name the times to fit one over, \
        with Builder::times (first and last) or Builder::times_of (a load history and its end), or fit one with \
        Rheology::series or Material::fitted"
    )]
    NoExponentialSeries {
        /// What needs it.
        what: &'static str,
        /// The rheology, as its `Debug` prints it.
        rheology: String,
    },

    /// The exponential series of a rheology of the user is that of another creep compliance: they differ by more than
    /// 1e-3. The law
    /// [`spectrum_reproduces_creep`](crate::rheology::laws::spectrum_reproduces_creep) tests it.
    #[error(
        "Rheology::creep_spectrum is the series of another body: J({} s) = {} 1/Pa by the series, but {} 1/Pa by \
        Rheology::creep_compliance; return the series of the same function, or \
        None", rounded(*.time, 5), rounded(*.series, 5), rounded(*.creep, 5)
    )]
    OtherSeries {
        /// Time at which both were evaluated \[s\].
        time: f64,
        /// The creep compliance \[1/Pa\].
        creep: f64,
        /// The value of the series \[1/Pa\].
        series: f64,
    },

    /// A creep compliance returned a value that no body can have: negative, not finite, or less than at an earlier
    /// time; or, where a series is fitted, 0 after t = 0.
    #[error(
        "creep compliance J({} s) = {} 1/Pa is not allowed: it must be finite, ≥ 0 (> 0 after t = 0) and \
        non-decreasing (J was {} before)", rounded(*.time, 5), rounded(*.value, 5), rounded(*.previous, 5)
    )]
    InvalidCompliance {
        /// Time at which it was evaluated \[s\].
        time: f64,
        /// The value \[1/Pa\].
        value: f64,
        /// Its value at an earlier time \[1/Pa\].
        previous: f64,
    },

    /// No exponential series with positive coefficients approximates the material function within the tolerance. Allow
    /// a greater error, or shorten the [times](crate::contact::Builder::times) of the fit.
    #[error(
        "no exponential series was found within {tolerance:e}: the error of the best is {misfit:.1e}, at {} s; \
        raise the tolerance (Settings::series_tolerance) to at least that, 0.1 at most, or fit over shorter times",
        rounded(*.at, 3)
    )]
    PoorFit {
        /// Maximum relative error of the best series found.
        misfit: f64,
        /// Where it is \[s\].
        at: f64,
        /// The error allowed.
        tolerance: f64,
    },

    /// A temperature given by a closure changes so roughly that the reduced time between two times is less accurate
    /// than five digits: it jumps or bends at many times that are not named as corners, or is noisy. Name the
    /// corners, or give a [table](crate::rheology::TemperatureHistory::table), whose corners are known.
    #[error(
        "the temperature between {} s and {} s is too rough for its reduced time, which is known to \
        {accuracy:.0e}: name its corners, or give it as a table (TemperatureHistory::table)",
        rounded(*.from, TIME), rounded(*.to, TIME)
    )]
    RoughTemperature {
        /// Start of the piece between corners \[s\].
        from: f64,
        /// Its end \[s\].
        to: f64,
        /// Relative accuracy reached.
        accuracy: f64,
    },

    /// Moduli that change with temperature
    /// ([`TimeTemperature::with_vertical_factors`](crate::rheology::TimeTemperature::with_vertical_factors)) are not
    /// modelled in this scene: where the temperature changes, and in sweeps of steady motions with a second body or a
    /// bulk that does not follow the law.
    #[error(
        "{what} does not cover moduli that change with temperature (vertical factors b_T): move each material to \
        one temperature by TimeTemperature::at, or leave the factors out with \
        TimeTemperature::without_vertical_factors"
    )]
    VerticalFactors {
        /// What does not cover them.
        what: &'static str,
    },

    /// No published material has this name.
    #[error("there is no published material named {name:?}; known are: {known}")]
    Unknown {
        /// The requested name.
        name: String,
        /// The known names.
        known: String,
    },

    /// Poisson's ratio of a body changes while it creeps
    /// ([`Material::elastic_bulk`](crate::rheology::Material::elastic_bulk)), so that the stress below its surface
    /// depends on the pressures of the past, which a contact does not keep. Give the pressures of the past to a
    /// [`StressHistory`](crate::contact::StressHistory) while the contact is stepped.
    #[error(
        "Poisson's ratio of body {body} changes as it creeps (elastic bulk): the stress below its surface depends \
        on pressures of the past, which the contact does not keep; follow the run with contact::StressHistory"
    )]
    ChangingPoisson {
        /// 0 for the body of [`Builder::material`](crate::contact::Builder::material), 1 for the counter body.
        body: usize,
    },
}
