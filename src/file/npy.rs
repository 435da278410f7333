//! The header of an array in the NPY format of NumPy.

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// The numbers of an array that [`header`] describes as `<f8`; `None` for others.
pub(crate) fn numbers(file: &[u8]) -> Option<Vec<f64>> {
    let rest = file.strip_prefix(MAGIC)?.strip_prefix(&[1, 0])?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (text, data) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
    let is_plain = text.starts_with(b"{'descr': '<f8', 'fortran_order': False,") && data.len().is_multiple_of(8);
    is_plain.then(|| data.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
}

/// The header of an array of elements of the type `descr`, which follow it in row-major order.
pub(crate) fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({sides}), }}");
    // magic number, version, length and text together have a multiple of 64 bytes and end with a line feed
    let before = MAGIC.len() + 4;
    let length = (before + text.len() + 1).next_multiple_of(64) - before;
    let text = format!("{text:<0$}\n", length - 1);
    [MAGIC, &[1, 0], &(length as u16).to_le_bytes(), text.as_bytes()].concat()
}
