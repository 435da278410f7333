//! Is what goes in checked, and what comes out whole: errors, warnings, saved states, files, pictures, documents?

mod absurd_sizes;
mod checkpoint;
mod clauses;
mod codes;
mod diagnosis;
mod documents;
mod errors;
mod exports;
mod headings;
mod house;
mod interface;
mod invalid_loads;
mod layouts;
mod mistakes;
mod output;
mod output_of_ranks;
mod outside;
mod paper;
mod plot;
mod snapshot;
mod tracing;

/// Runs an ignored test in a process of its own, in which files end at 32 KiB.
#[cfg(unix)]
fn with_room_for_32_kib(test: &str, folder: &std::path::Path) -> std::process::Output {
    // writes beyond 64 blocks of 512 bytes fail in the child, which is not killed for them
    let limited = format!("trap '' XFSZ; ulimit -f 64; exec \"$0\" --exact {test} --ignored --nocapture");
    let mut command = std::process::Command::new("sh");
    command.args(["-c", &limited]).arg(std::env::current_exe().unwrap()).env("FULL_FOLDER", folder);
    command.output().unwrap()
}

/// The numbers of a field in an archive of NumPy.
pub(super) fn numbers_of(path: &std::path::Path, name: &str) -> Vec<f64> {
    let (mut archive, mut bytes) = (zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap(), Vec::new());
    std::io::Read::read_to_end(&mut archive.by_name(&format!("{name}.npy")).unwrap(), &mut bytes).unwrap();
    npy(&bytes).1
}

/// Shape and numbers of an array of NumPy, which itself reads such files in `tests/read_back.py`.
fn npy(bytes: &[u8]) -> (Vec<usize>, Vec<f64>) {
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    let (header, numbers) = bytes[10..].split_at(usize::from(u16::from_le_bytes([bytes[8], bytes[9]])));
    let header = std::str::from_utf8(header).unwrap();
    assert!(header.contains("'descr': '<f8'") && header.contains("'fortran_order': False"), "{header}");
    let shape = header.split(['(', ')']).nth(1).unwrap();
    let shape = shape.split(',').filter_map(|count| count.trim().parse().ok()).collect();
    let numbers = numbers.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap()));
    (shape, numbers.collect())
}
