//! Values that users write: fields that are read and changed by methods. Values that are too many to print.

use std::fmt;

/// The values of a field, of which `Debug` prints the number.
pub(crate) struct Counted<'a, T>(pub(crate) &'a [T]);

impl<T> fmt::Debug for Counted<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} values", self.0.len())
    }
}

/// Declares a struct whose fields are read by methods named as they are, with their documentation, and changed by
/// methods `with_field(self, field) -> Self` where one is named. Such types may get more fields.
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

/// Implements a trait for a wrapper: each method calls the same method of the wrapped value.
macro_rules! forward {
    (
        $trait:path, ($(<$generic:ident>)? $self:ident: $outer:ty => $inner:expr),
        $($method:ident($($name:ident: $value:ty),*) $(-> $result:ty)?;)*
    ) => {
        impl $(<$generic: $trait + ?Sized>)? $trait for $outer {
            $(fn $method(&$self $(, $name: $value)*) $(-> $result)? {
                <_ as $trait>::$method(&$inner $(, $name)*)
            })*
        }
    };
}

/// Implements `Clone` field by field. Unlike that of a derived `Clone`, `clone_from` keeps the memory of the fields:
/// a snapshot is taken and restored without an allocation.
macro_rules! clone_by_fields {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl Clone for $type {
            fn clone(&self) -> $type {
                let $type { $($field),* } = self;
                $type { $($field: Clone::clone($field)),* }
            }

            fn clone_from(&mut self, other: &$type) {
                let $type { $($field),* } = other;
                $(self.$field.clone_from($field);)*
            }
        }
    };
}
