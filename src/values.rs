//! Values that users write: fields that are read and changed by methods. Values that are too many to print.

use std::fmt;

/// Prints the number of values of a field in its place.
#[expect(clippy::ptr_arg, reason = "derived code passes the field as it is")]
pub(crate) fn counted<T>(values: &Vec<T>, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "{} values", values.len())
}

/// Declares a struct whose fields are read by methods named as they are, with their documentation, and changed by methods
/// `with_field(self, field) -> Self` where one is named. Such types may get more fields.
macro_rules! value {
    ($(#[$about:meta])* pub struct $type:ident { $($(#[$doc:meta])* $field:ident: $value:ty $(, $with:ident)?;)* }) => {
        $(#[$about])*
        pub struct $type {
            $($(#[$doc])* pub(crate) $field: $value,)*
        }

        impl $type {
            $(
                $(#[$doc])*
                pub const fn $field(&self) -> $value {
                    self.$field
                }

                $(
                    #[doc = concat!("The same with another [`", stringify!($field), "`](", stringify!($type), "::", stringify!($field), ").")]
                    #[must_use]
                    pub const fn $with(self, $field: $value) -> $type {
                        $type { $field, ..self }
                    }
                )?
            )*
        }
    };
}

/// Implements `Debug` for a type by some of its values: the others are large, or cannot be printed.
macro_rules! debug_by {
    ($self:ident: $type:ident$(<$generic:ident>)? => $($name:ident: $value:expr),*) => {
        impl$(<$generic>)? std::fmt::Debug for $type$(<$generic>)? {
            fn fmt(&$self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($type))$(.field(stringify!($name), &$value))*.finish_non_exhaustive()
            }
        }
    };
}
