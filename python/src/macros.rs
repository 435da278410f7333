//! What many classes repeat.

/// Getters of a class: documentation, name, type and value, of what the class wraps, of a field, or of what a method of it
/// gives (`by`).
macro_rules! getters {
    (by $get:ident $class:ident, $of:ident: $($(#[$doc:meta])* $name:ident: $type:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self) -> PyResult<$type> {
                    let $of = self.$get()?;
                    Ok($value)
                }
            )*
        }
    };
    ($class:ident, $of:ident: $($rest:tt)*) => {
        getters! {$class.0, $of: $($rest)*}
    };
    ($class:ident.$field:tt, $of:ident: $($(#[$doc:meta])* $name:ident: $type:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self) -> $type {
                    let $of = &self.$field;
                    $value
                }
            )*
        }
    };
}

/// Static methods that make objects: documentation, name, arguments, and what the crate makes of them, of which the class makes an object by
/// `by`. They run with `$py` attached.
macro_rules! makers {
    ($class:ident, $py:ident: $($(#[$meta:meta])* $name:ident($($arg:ident: $type:ty),*) = $made:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$meta])*
                #[staticmethod]
                pub fn $name($py: Python<'_>, $($arg: $type),*) -> PyResult<$class> {
                    let made = $made.or_raise()?;
                    Ok($class::by(crate::recipe::Recipe::new($py, stringify!($name), ($($arg,)*))?, made))
                }
            )*
        }
    };
}

/// A dict of names and values.
macro_rules! dict {
    ($py:expr; $($name:literal: $value:expr),* $(,)?) => {{
        let all = pyo3::types::PyDict::new($py);
        $(all.set_item($name, $value)?;)*
        all
    }};
}

/// The methods of a class whose objects are made again by the call that made them.
macro_rules! made_by_calls {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
                slf.get().recipe.repr(&slf.get_type())
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<crate::recipe::Reduced<'py>> {
                slf.get().recipe.reduce(slf.get_type())
            }
        }
    };
}
