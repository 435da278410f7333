//! `Debug` of the errors: the message and its causes.

use std::error::Error as _;
use std::fmt;

use super::Error;

/// The message and its causes: a `main` that returns a [`Result`](crate::Result) prints errors so. `{:#?}` prints the fields.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if f.alternate() {
            return self.fmt_fields(f);
        }
        write!(f, "{self}")?;
        let mut next = self.source();
        while let Some(cause) = next {
            write!(f, ": {cause}")?;
            next = cause.source();
        }
        Ok(())
    }
}

/// Implements `Error::fmt_fields`, which prints as a derived `Debug` does.
macro_rules! fmt_fields {
    ($($tuple:ident)*; $($(#[$cfg:meta])? $variant:ident { $($field:ident)* })*) => {
        impl Error {
            fn fmt_fields(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Error::$tuple(error) => f.debug_tuple(stringify!($tuple)).field(error).finish(),)*
                    $($(#[$cfg])? Error::$variant { $($field),* } => {
                        f.debug_struct(stringify!($variant))$(.field(stringify!($field), $field))*.finish()
                    })*
                }
            }
        }
    };
}

fmt_fields! {
    Adhesion File Kernel Load Map Material Output Ranks Sliding States Step Table Text User;
    Cancelled { what }
    #[cfg(feature = "checkpoint")]
    Checkpoint { path source }
    CountOutOfRange { field value allowed }
    InvalidGap { cell position value }
    Missing { part }
    NoDomain { length }
    NotCovered { special what cure }
    NothingToTouch { body cells }
    OtherContact {}
    OutOfMemory { what bytes }
    OutOfOrder { field index value previous rule }
    OutOfRange { field value allowed }
    WrongFrame { what }
    WrongLength { field len expected exact }
}
