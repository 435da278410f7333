//! Elastic states as archives in the NPZ format of NumPy.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Cursor, Read, Seek, Write};
use std::path::Path;
use std::sync::Arc;

use zip::ZipArchive;

use crate::Grid;
use crate::contact::Warnings;
use crate::error::{Error, Result, poisson_ratio};
use crate::file::{in_memory, npy, open, replace};
use crate::load::Tilt;
use crate::output::Metadata;
use crate::output::npz::Archive;
use crate::solver::RigidMotion;
use crate::states::{ElasticState, ElasticStates, Pressed};

/// An array with a number for each state: its name, and how the number is read from the state and put into it.
type Column = (&'static str, fn(&ElasticState) -> f64, fn(&mut ElasticState, f64));

const COLUMNS: [Column; 13] = [
    ("level", |state| state.level, |state, x| state.level = x),
    ("approach", |state| state.approach, |state, x| state.approach = x),
    ("stiffness", |state| state.stiffness, |state, x| state.stiffness = x),
    ("load_stiffness", |state| state.load_stiffness, |state, x| state.load_stiffness = x),
    ("area", |state| state.area, |state, x| state.area = x),
    ("cells", |state| state.cells as f64, |state, x| state.cells = x as usize),
    ("patches", |state| state.patches as f64, |state, x| state.patches = x as usize),
    (
        "warnings",
        |state| state.warnings.bits().into(),
        |state, x| state.warnings = Warnings::from_bits_truncate(x as u32),
    ),
    ("max_slope", |state| number(state.figures.max_slope), |state, x| state.figures.max_slope = figure(x)),
    ("compression", |state| number(state.figures.compression), |state, x| state.figures.compression = figure(x)),
    ("cells_across", |state| number(state.figures.cells_across), |state, x| state.figures.cells_across = figure(x)),
    ("cells_in_wave", |state| number(state.figures.cells_in_wave), |state, x| state.figures.cells_in_wave = figure(x)),
    ("periods", |state| number(state.figures.periods), |state, x| state.figures.periods = figure(x)),
];

/// A figure of a state as a number: NaN where there is none.
fn number(figure: Option<f64>) -> f64 {
    figure.unwrap_or(f64::NAN)
}

fn figure(number: f64) -> Option<f64> {
    Some(number).filter(|number| !number.is_nan())
}

/// Writes elastic states as an NPZ archive, so that a [`Sweep`](crate::states::Sweep) is made once:
/// `numpy.load(path)["level"]` and so on, arrays named as the fields of an [`ElasticState`], and the pressures if they
/// were kept. An existing file is replaced.
///
/// Needs the feature `npy`.
///
/// ```
/// use viscocontact::output::{Metadata, read_states, write_states};
/// use viscocontact::prelude::*;
/// use viscocontact::states::{Reach, Sweep};
///
/// let states = Sweep::new(Grid::square(16, 4.0e-3)?, &Sphere::new(10.0e-3)?).run(Reach::Level(5.0e-7))?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-states-{}.npz", std::process::id()));
/// write_states(&path, &states, &Metadata::new("A ball"))?;
/// assert_eq!(read_states(&path)?.states(), states.states());
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// If the file cannot be written.
pub fn write_states(path: impl AsRef<Path>, states: &ElasticStates, metadata: &Metadata) -> Result<()> {
    replace(path.as_ref(), |out| archive(out, states, metadata))
}

/// What [`write_states`] writes, in memory: for pickles, and for messages between processes.
///
/// Needs the feature `npy`.
///
/// # Errors
/// If the archive cannot be written: if it is too large for its format.
pub fn states_to_bytes(states: &ElasticStates) -> Result<Vec<u8>> {
    in_memory(|out| archive(out, states, &Metadata::new("")))
}

fn archive(out: impl Write + Seek, states: &ElasticStates, metadata: &Metadata) -> io::Result<()> {
    let table = states.states();
    let count = table.len();
    let [tilts, tilt_rates] = [|state: &ElasticState| state.tilt, |state: &ElasticState| state.tilt_rate]
        .map(|of| table.iter().flat_map(of).collect::<Vec<f64>>());
    let RigidMotion { approach, tilt: [tilt1, tilt2] } = states.rest;
    let given = states.tilt.map(|tilt| match tilt {
        Tilt::Fixed(angle) => [0.0, angle],
        Tilt::Free { at } => [1.0, at],
    });
    let sizes = [states.error, states.first_level, states.poisson.unwrap_or(f64::NAN)];
    let mut archive = Archive::empty(out);
    for (name, value, _) in COLUMNS {
        archive.add(name, &[count], &table.iter().map(value).collect::<Vec<f64>>())?;
    }
    archive.add("tilt", &[count, 2], &tilts)?;
    archive.add("tilt_rate", &[count, 2], &tilt_rates)?;
    archive.add("rest", &[3], &[approach, tilt1, tilt2])?;
    archive.add("given_tilt", &[2, 2], given.as_flattened())?;
    archive.add("error_first_level_poisson", &[3], &sizes)?;
    if let Some(grid) = states.grid() {
        let ([n1, n2], [l1, l2]) = (grid.cells(), grid.lengths());
        archive.add("grid", &[2, 2], &[n1 as f64, n2 as f64, l1, l2])?;
    }
    if !states.pressures.is_empty() {
        let counts: Vec<f64> = states.pressures.iter().map(|pressed| pressed.cells.len() as f64).collect();
        let cells: Vec<f64> =
            states.pressures.iter().flat_map(|pressed| pressed.cells.iter().map(|&k| k.into())).collect();
        let pressures: Vec<f64> =
            states.pressures.iter().flat_map(|pressed| pressed.pressures.iter().copied()).collect();
        archive.add("pressed_cells_of_state", &[count], &counts)?;
        archive.add("pressed_cells", &[cells.len()], &cells)?;
        archive.add("pressure", &[pressures.len()], &pressures)?;
    }
    archive.finish(&metadata.brief())
}

/// Reads elastic states that [`write_states`] has written. They hold no surface:
/// [`StatesContact::fields`](crate::states::StatesContact::fields) needs the states of a sweep of this process.
///
/// Needs the feature `npy`.
///
/// # Errors
/// If the file cannot be read, or its arrays are no elastic states
/// ([`Error::Unreadable`]).
pub fn read_states(path: impl AsRef<Path>) -> Result<Arc<ElasticStates>> {
    let path = path.as_ref();
    let opened = open(path)?;
    let length = opened.metadata().map_err(|error| refused(path, &error))?.len();
    states_of(path, &read_arrays(path, BufReader::new(opened), length)?)
}

/// The states of the bytes of [`states_to_bytes`], or of a file.
///
/// Needs the feature `npy`.
///
/// # Errors
/// As [`read_states`].
pub fn states_from_bytes(bytes: &[u8]) -> Result<Arc<ElasticStates>> {
    let path = Path::new("bytes in memory");
    states_of(path, &read_arrays(path, Cursor::new(bytes), bytes.len() as u64)?)
}

fn states_of(path: &Path, arrays: &BTreeMap<String, Vec<f64>>) -> Result<Arc<ElasticStates>> {
    let refused = |reason: String| refused(path, &reason);
    let array = |name: &str, length: usize| match arrays.get(name) {
        Some(values) if values.len() == length => Ok(&values[..]),
        Some(values) => Err(refused(format!("the array {name} has {} numbers, not {length}", values.len()))),
        None => Err(refused(format!("there is no array {name}"))),
    };
    let count = arrays.get("level").map_or(0, Vec::len);
    let mut table = vec![ElasticState::default(); count];
    for (name, _, set) in COLUMNS {
        table.iter_mut().zip(array(name, count)?).for_each(|(state, &value)| set(state, value));
    }
    let [tilts, tilt_rates] = [array("tilt", 2 * count)?, array("tilt_rate", 2 * count)?];
    for (k, state) in table.iter_mut().enumerate() {
        state.tilt.copy_from_slice(&tilts[2 * k..][..2]);
        state.tilt_rate.copy_from_slice(&tilt_rates[2 * k..][..2]);
    }
    let rest = array("rest", 3)?;
    let rest = RigidMotion { approach: rest[0], tilt: [rest[1], rest[2]] };
    let given = array("given_tilt", 4)?;
    if given.iter().any(|value| !value.is_finite()) {
        return Err(refused("a tilt or a load point is no number".into()));
    }
    let tilt =
        [0, 2].map(|k| if given[k] == 1.0 { Tilt::Free { at: given[k + 1] } } else { Tilt::Fixed(given[k + 1]) });
    let mut states = ElasticStates::new(table, rest, tilt);
    let sizes = array("error_first_level_poisson", 3)?;
    if sizes[..2].iter().any(|size| size.is_nan() || *size < 0.0) {
        return Err(refused("the error or the first level is not 0 or more".into()));
    }
    (states.error, states.first_level) = (sizes[0], sizes[1]);
    let poisson = Some(sizes[2]).filter(|poisson| !poisson.is_nan());
    let checked = poisson.map(|poisson| poisson_ratio("Poisson's ratio of the states", poisson)).transpose();
    states.poisson = checked.map_err(|error| refused(error.to_string()))?;
    if arrays.contains_key("grid") {
        let grid = array("grid", 4)?;
        states.grid = Some(Grid::new([grid[0] as usize, grid[1] as usize], [grid[2], grid[3]])?);
    }
    if arrays.contains_key("pressure") {
        let counts = array("pressed_cells_of_state", count)?;
        let all = counts.iter().sum::<f64>() as usize;
        let (mut cells, mut pressures) = (array("pressed_cells", all)?.iter(), array("pressure", all)?.iter());
        let pressed = counts.iter().map(|&count| Pressed {
            cells: cells.by_ref().take(count as usize).map(|&cell| cell as u32).collect(),
            pressures: pressures.by_ref().take(count as usize).copied().collect(),
        });
        states.pressures = pressed.collect();
    }
    states.validated().map(Arc::new).map_err(|error| refused(error.to_string()))
}

fn refused(path: &Path, reason: &dyn ToString) -> Error {
    Error::Unreadable { file: path.display().to_string(), reason: reason.to_string(), kind: None }
}

/// The arrays of real numbers in an archive, by their names.
fn read_arrays(path: &Path, file: impl Read + Seek, length: u64) -> Result<BTreeMap<String, Vec<f64>>> {
    let mut archive = ZipArchive::new(file).map_err(|error| refused(path, &error))?;
    let mut arrays = BTreeMap::new();
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|error| refused(path, &error))?;
        let name = entry.name().map_err(|error| refused(path, &error))?.trim_end_matches(".npy").to_owned();
        let mut bytes = Vec::new();
        // arrays are not compressed
        entry.take(length).read_to_end(&mut bytes).map_err(|error| refused(path, &error))?;
        if let Some(values) = npy::numbers(&bytes) {
            arrays.insert(name, values);
        }
    }
    Ok(arrays)
}
