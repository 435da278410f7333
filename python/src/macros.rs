//! What many classes repeat.

/// Getters of a class: documentation, name, type and value, of what the class wraps, of a field, or of what a method of it
/// gives (`by`). Those that make objects of Python name it after the value.
macro_rules! getters {
    (by $get:ident $class:ident, $of:ident, $py:ident: $($(#[$doc:meta])* $name:ident: $type:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name<'py>(slf: crate::used::Shared<'_, Self>, $py: Python<'py>) -> PyResult<$type> {
                    let _ = $py;
                    let $of = slf.$get()?;
                    Ok($value)
                }
            )*
        }
    };
    ($class:ident.$field:tt, $of:ident, $py:ident: $($(#[$doc:meta])* $name:ident: $type:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name<'py>(&self, $py: Python<'py>) -> $type {
                    let _ = $py;
                    let $of = &self.$field;
                    $value
                }
            )*
        }
    };
    (by $get:ident $class:ident, $of:ident: $($rest:tt)*) => {
        getters! {by $get $class, $of, _py: $($rest)*}
    };
    ($class:ident.$field:tt, $of:ident: $($rest:tt)*) => {
        getters! {$class.$field, $of, _py: $($rest)*}
    };
    ($class:ident, $($rest:tt)*) => {
        getters! {$class.0, $($rest)*}
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
                    let recipe = crate::recipe::Recipe::new($py, stringify!($name), ($($arg,)*))?;
                    Ok($class::by(recipe, made))
                }
            )*
        }
    };
}

/// Methods that make another object of one: documentation, name, arguments, and what the crate makes of the object `$slf` and them.
macro_rules! changes {
    ($class:ident, $slf:ident: $($(#[$meta:meta])* $name:ident($($arg:ident: $type:ty),*) = $made:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$meta])*
                pub fn $name($slf: Bound<'_, Self>, $($arg: $type),*) -> PyResult<$class> {
                    let made = $made.or_raise()?;
                    let recipe = crate::recipe::Recipe::new($slf.py(), stringify!($name), ($slf.clone(), $($arg,)*))?;
                    Ok($class::by(recipe, made))
                }
            )*
        }
    };
}

/// A dict of names and values; those of an object that have the names of its fields are its fields alone.
macro_rules! dict {
    ($py:expr; $($name:literal: $value:expr),* $(,)?) => {{
        let all = pyo3::types::PyDict::new($py);
        $(all.set_item($name, $value)?;)*
        all
    }};
    ($py:expr; $of:ident { $($field:ident),* } $(, $name:literal: $value:expr)* $(,)?) => {{
        let all = pyo3::types::PyDict::new($py);
        $(all.set_item(stringify!($field), $of.$field)?;)*
        $(all.set_item($name, $value)?;)*
        all
    }};
}

/// A class whose objects are made again by the call that made them: its documentation and properties, its name, and what of the crate it
/// has, by what `by` takes and makes of it.
macro_rules! made {
    ($(#[$meta:meta])* $class:ident($seen:vis $field:ident: $type:ty)) => {
        made! {$(#[$meta])* $class($seen $field: $type) of $type => std::convert::identity}
    };
    ($(#[$meta:meta])* $class:ident($seen:vis $field:ident: $type:ty) of $given:ty => $make:expr) => {
        $(#[$meta])*
        pub struct $class {
            $seen $field: $type,
            recipe: crate::recipe::Recipe,
        }

        impl $class {
            pub fn by(recipe: crate::recipe::Recipe, given: $given) -> $class {
                $class { $field: $make(given), recipe }
            }
        }

        made_by_calls! {$class}
    };
}

/// The methods of a class whose objects are made again by the call that made them, which the field `recipe` has.
macro_rules! made_by_calls {
    ($class:ident) => {
        impl $class {
            fn recipe(&self, _py: Python<'_>) -> PyResult<&crate::recipe::Recipe> {
                Ok(&self.recipe)
            }
        }

        calls! {$class}

        #[pymethods]
        impl $class {
            fn __traverse__(&self, visit: pyo3::gc::PyVisit<'_>) -> crate::used::Traversed {
                self.recipe.traverse(&visit)
            }
        }
    };
}

/// The same by a method `recipe`.
macro_rules! calls {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
                slf.get().recipe(slf.py())?.repr(&slf.get_type())
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<crate::recipe::Reduced<'py>> {
                slf.get().recipe(slf.py())?.reduce(slf.get_type())
            }

            fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
                let key = slf.get().recipe(slf.py())?.key(slf.get_type())?;
                let Ok(other) = other.cast::<Self>() else { return Ok(false) };
                key.eq(other.get().recipe(slf.py())?.key(other.get_type())?)
            }

            fn __hash__(slf: &Bound<'_, Self>) -> PyResult<isize> {
                slf.get().recipe(slf.py())?.key(slf.get_type())?.hash()
            }
        }
    };
}

/// The methods of a class whose objects are numbers: pickled as bytes, and equal if their numbers are.
macro_rules! numbers {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// The numbers of a pickle.
            #[staticmethod]
            fn _of_bytes(bytes: &[u8]) -> PyResult<$class> {
                postcard::from_bytes(bytes)
                    .map($class)
                    .map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))
            }

            #[allow(clippy::type_complexity)]
            fn __reduce__<'py>(
                slf: &Bound<'py, Self>,
            ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, pyo3::types::PyBytes>,))> {
                let bytes = postcard::to_allocvec(&slf.get().0);
                let bytes = bytes.map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))?;
                Ok((slf.get_type().getattr("_of_bytes")?, (pyo3::types::PyBytes::new(slf.py(), &bytes),)))
            }

            fn __eq__(&self, other: &$class) -> bool {
                self.0 == other.0
            }
        }
    };
}
