//! Memory is requested before it is filled, so that lack of memory is a typed error and does not abort the process.
//!
//! An allocation that fails inside `vec!` aborts the process. Moreover, most systems overcommit memory: on Linux, by
//! default, an allocation fails only if it alone exceeds all memory and swap of the machine, and a process that writes
//! to more pages than exist is killed. So the bytes of all fields of a scene are added up before and requested in
//! one piece, which is returned at once, before any field is filled. This detects every scene larger than the machine.
//! It does not detect a scene that fits the machine but not beside the other processes on it, a limit of a container
//! (cgroup), or any lack of memory where the system overcommits without bounds (`vm.overcommit_memory` = 1). Where
//! memory is committed when it is granted (Windows, `vm.overcommit_memory` = 2, `ulimit -v`) the check is exact.

use std::hint::black_box;

use crate::error::{Error, Result};

/// Checks that `bytes` can be allocated in one piece, and frees them.
pub(crate) fn check(what: &'static str, bytes: u128) -> Result<()> {
    let granted = usize::try_from(bytes).is_ok_and(|bytes| {
        let mut probe = Vec::<u8>::new();
        let granted = probe.try_reserve_exact(bytes).is_ok();
        // without this the compiler may remove the unused allocation
        black_box(probe.as_ptr());
        granted
    });
    if granted { Ok(()) } else { Err(refused(what, bytes)) }
}

/// A field of `len` copies of `value`.
pub(crate) fn field<T: Clone>(what: &'static str, len: usize, value: T) -> Result<Vec<T>> {
    let mut field = with_capacity(what, len)?;
    field.resize(len, value);
    Ok(field)
}

/// A field of the `len` values of an iterator.
pub(crate) fn collect<T>(what: &'static str, len: usize, values: impl Iterator<Item = T>) -> Result<Vec<T>> {
    let mut field = with_capacity(what, len)?;
    field.extend(values);
    Ok(field)
}

/// An empty field with the capacity for `len` values.
fn with_capacity<T>(what: &'static str, len: usize) -> Result<Vec<T>> {
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
    fn memory_that_no_machine_has_is_refused_with_its_bytes() {
        for bytes in [1_u128 << 62, (1 << 63) + 8, 1 << 64, u128::MAX] {
            let Err(Error::OutOfMemory { what: "a test", bytes: reported }) = check("a test", bytes) else { panic!() };
            assert_eq!(u128::from(reported), bytes.min(u64::MAX.into()));
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
    fn available_memory_is_granted() {
        for bytes in [0, 1, 8, 1 << 20] {
            check("a test", bytes).unwrap();
        }
        assert_eq!(field("a test", 3, 2.0).unwrap(), [2.0; 3]);
        assert_eq!(collect("a test", 3, 0..3).unwrap(), [0, 1, 2]);
    }
}
