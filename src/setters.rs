//! Methods that change one field of a value.

/// Methods `with_field(self, field) -> Self`, for types that may get more fields.
macro_rules! setters {
    ($type:ident { $($method:ident: $field:ident, $value:ty;)* }) => {
        impl $type {
            $(
                #[doc = concat!("The same with another [`", stringify!($field), "`](", stringify!($type), "::", stringify!($field), ").")]
                #[must_use]
                pub const fn $method(self, $field: $value) -> $type {
                    $type { $field, ..self }
                }
            )*
        }
    };
}
