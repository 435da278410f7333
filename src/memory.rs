//! Memory is asked for before it is filled: what cannot be had is a typed error, not the end of the process.
//!
//! An allocation that fails inside `vec!` ends the process. And most systems promise more memory than there is: on Linux, by
//! default, a field is refused only if it alone exceeds all memory and swap of the machine, and a process that fills
//! promised pages which do not exist is killed. So the bytes of all fields of a scene are added up by formula and asked
//! for in one piece, which is given back at once, before any field is filled: that finds every scene larger than the
//! machine. It cannot find one that fits the machine, but not beside what else runs on it, nor a limit of a container
//! (cgroup), nor any where the system promises without bounds (`vm.overcommit_memory` = 1). Where memory is committed
//! when it is granted (Windows, `vm.overcommit_memory` = 2, `ulimit -v`) the answer is exact.

use std::hint::black_box;

use crate::error::{Error, Result};

/// Finds out whether so many bytes can be had in one piece; takes none.
pub(crate) fn check(what: &'static str, bytes: u128) -> Result<()> {
    let granted = usize::try_from(bytes).is_ok_and(|bytes| {
        let mut room = Vec::<u8>::new();
        let granted = room.try_reserve_exact(bytes).is_ok();
        // else the compiler may leave out an allocation that nobody looks at
        black_box(room.as_ptr());
        granted
    });
    if granted { Ok(()) } else { Err(refused(what, bytes)) }
}

/// A field of `len` times `value`.
pub(crate) fn field<T: Clone>(what: &'static str, len: usize, value: T) -> Result<Vec<T>> {
    let mut field = room(what, len)?;
    field.resize(len, value);
    Ok(field)
}

/// A field of `len` values, all that `values` has.
pub(crate) fn collect<T>(what: &'static str, len: usize, values: impl Iterator<Item = T>) -> Result<Vec<T>> {
    let mut field = room(what, len)?;
    field.extend(values);
    Ok(field)
}

/// An empty field with room for `len` values.
fn room<T>(what: &'static str, len: usize) -> Result<Vec<T>> {
    let mut field = Vec::new();
    field.try_reserve_exact(len).map_err(|_| refused(what, len as u128 * size_of::<T>() as u128))?;
    Ok(field)
}

fn refused(what: &'static str, bytes: u128) -> Error {
    Error::OutOfMemory { what, bytes: u64::try_from(bytes).unwrap_or(u64::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More than any machine has: 4 EB, 16 EB, more than can be addressed.
    #[test]
    fn what_no_machine_has_is_refused_with_its_bytes() {
        for bytes in [1_u128 << 62, (1 << 63) + 8, 1 << 64, u128::MAX] {
            let Err(Error::OutOfMemory { what: "a test", bytes: told }) = check("a test", bytes) else { panic!() };
            assert_eq!(u128::from(told), bytes.min(u64::MAX.into()));
        }
        let refused = |result: Result<Vec<f64>>| match result.unwrap_err() {
            Error::OutOfMemory { bytes, .. } => bytes,
            other => panic!("{other}"),
        };
        assert_eq!(refused(field("a test", 1 << 59, 0.0)), 1 << 62);
        assert_eq!(refused(field("a test", 1 << 62, 0.0)), u64::MAX);
        assert_eq!(refused(collect("a test", 1 << 59, std::iter::repeat(0.0))), 1 << 62);
    }

    #[test]
    fn what_there_is_is_granted() {
        for bytes in [0, 1, 8, 1 << 20] {
            check("a test", bytes).unwrap();
        }
        assert_eq!(field("a test", 3, 2.0).unwrap(), [2.0; 3]);
        assert_eq!(collect("a test", 3, 0..3).unwrap(), [0, 1, 2]);
    }
}
