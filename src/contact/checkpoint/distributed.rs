//! The checkpoint of several ranks: a file with what they have in common, and beside it one for each with its rows.
//!
//! Files with rows have names of their own save. The common file names them; it is replaced when they are complete on the
//! medium, and the files of the previous save are removed after that. So whenever ranks are cut off, the common file leads to all
//! files of one save: of the last that was complete.

use std::borrow::Cow;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::format::{self, Kind, Whole};
use super::redistribution::Assembled;
use super::saved::{check, check_run};
use super::scene_fingerprint::Fingerprint;
use crate::contact::run::progress::Progress;
use crate::contact::state::State;
use crate::contact::stepper::ViscoelasticContact;
use crate::contact::window::region::Region;
use crate::error::{CheckpointError, Result};
use crate::file::{check_regular, replace};
use crate::parallel::{Ranks, Rows};

/// What the ranks have in common.
#[derive(Serialize, Deserialize)]
pub(super) struct Common<'a> {
    /// Tells the save from others of the same path: greater than theirs.
    mark: u64,
    scene: Fingerprint,
    folded: [bool; 2],
    progress: Option<Cow<'a, Progress>>,
    files: Vec<RowsFile>,
}

/// A file with rows.
#[derive(Serialize, Deserialize)]
struct RowsFile {
    rows: Range<usize>,
    checksum: u32,
}

/// What is in it.
#[derive(Serialize, Deserialize)]
struct OwnRows<'a> {
    mark: u64,
    state: Cow<'a, State>,
}

/// Saves a contact that ranks share out: a call of all of them.
pub(super) fn save(
    contact: &ViscoelasticContact,
    path: &Path,
    progress: Option<&Progress>,
    (rows, group): (&Rows, &dyn Ranks),
) -> Result<()> {
    let (state, first) = (&contact.computation.state, group.rank() == 0);
    let path = &*followed(path);
    let old = mark_at(path).filter(|_| first);
    let mark = if first { check_regular(path).map(|()| next_mark(path)) } else { Ok(0) };
    let mark = rows.greatest(rows.agree(mark)? as f64) as u64;
    rows.intact()?;

    let index = (0..group.rank()).filter(|&rank| !rows.of(rank).is_empty()).count();
    let own = name(path, mark, index);
    let written = if state.region.len() == 0 {
        Ok(0)
    } else {
        let (mut checksum, contents) = (0, OwnRows { mark, state: Cow::Borrowed(state) });
        replace(&own, |out| {
            checksum = format::write(out, Kind::Rows, &contents)?;
            Ok(())
        })
        .map(|()| checksum)
    };
    // without a rank that is lost, others may have placed the common file already
    let forget = || {
        if state.region.len() > 0 && rows.intact().is_ok() {
            _ = fs::remove_file(&own)
        }
    };
    let checksum = rows.agree(written).inspect_err(|_| forget())?;
    let Range { start, end } = state.region.computed_rows();
    let files = rows.gather(
        [start, end].map(|row| row as f64).into_iter().chain([f64::from(checksum)]),
        |_| 3,
        |all| {
            let all = all.as_chunks::<3>().0.iter();
            let files = all.map(|&[start, end, checksum]| RowsFile {
                rows: start as usize..end as usize,
                checksum: checksum as u32,
            });
            files.filter(|file| !file.rows.is_empty()).collect()
        },
    );
    // where a rank is lost, the files are not known
    let placed = if first && rows.intact().is_ok() {
        let (scene, folded) = (Fingerprint::of(&contact.scene), state.region.folded());
        let progress = progress.map(Cow::Borrowed);
        let common = Common { mark, scene, folded, progress, files };
        replace(path, |out| format::write(out, Kind::Ranks, &common).map(drop))
    } else {
        Ok(())
    };
    rows.agree(placed).inspect_err(|_| forget())?;
    old.into_iter().for_each(|old| remove_until(path, old));
    Ok(())
}

impl Common<'_> {
    /// The state, if a contact of this scene can go on from it, on the rows that it has.
    pub(super) fn state_for(
        self,
        contact: &ViscoelasticContact,
        path: &Path,
    ) -> Result<(State, Option<Progress>), CheckpointError> {
        self.scene.require(&Fingerprint::of(&contact.scene))?;
        let grid = &contact.scene.grid;
        if (0..2).any(|axis| self.folded[axis] && !grid.cells()[axis].is_multiple_of(2)) {
            return Err(CheckpointError::Malformed { what: "a symmetry that its grid cannot have".into() });
        }
        let Range { start: mut next, end } = Region::whole(grid, self.folded).computed_rows();
        for RowsFile { rows, .. } in &self.files {
            if rows.start != next || rows.is_empty() || rows.end > end {
                break;
            }
            next = rows.end;
        }
        if next != end || self.files.is_empty() {
            return Err(CheckpointError::Malformed { what: "rows that are not those of its grid".into() });
        }
        let path = &*followed(path);
        let mut own: Option<Assembled> = None;
        for (index, file) in self.files.iter().enumerate() {
            if own.as_ref().is_some_and(|own| !own.wants(&file.rows)) {
                continue;
            }
            let found = name(path, self.mark, index);
            let read = || {
                let state = file.read(&found, self.mark)?;
                let region = Region::of_rows(grid, self.folded, file.rows.clone());
                check(&state, contact, Some(&region))?;
                check_run(&state.clock, self.progress.as_deref(), &contact.scene)?;
                Ok(state)
            };
            let state =
                read().map_err(|source| CheckpointError::Rows { file: found.clone(), source: Box::new(source) })?;
            let own = own.get_or_insert_with(|| Assembled::on_rows_of(contact, &state));
            own.copy(&state, &state.indenter.gap().above);
        }
        let own = own.ok_or(CheckpointError::Foreign)?;
        Ok((own.finish(contact), self.progress.map(Cow::into_owned)))
    }
}

impl RowsFile {
    fn read(&self, path: &Path, mark: u64) -> Result<State, CheckpointError> {
        let file = Whole::open(path)?;
        if file.kind != Kind::Rows {
            return Err(CheckpointError::Foreign);
        }
        let checksum = file.checksum;
        let OwnRows { mark: found, state } = file.contents()?;
        if found != mark || checksum != self.checksum {
            return Err(CheckpointError::OtherSave);
        }
        Ok(state.into_owned())
    }
}

/// The file that a link leads to: others are beside that.
fn followed(path: &Path) -> Cow<'_, Path> {
    match path.is_symlink().then(|| fs::canonicalize(path)) {
        Some(Ok(path)) => Cow::Owned(path),
        _ => Cow::Borrowed(path),
    }
}

/// The name of a file with rows.
fn name(path: &Path, mark: u64, index: usize) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{mark:014x}.{index}"));
    path.with_file_name(name)
}

/// The files with rows beside a path, of any save, and their marks.
fn files_beside(path: &Path) -> Vec<(u64, PathBuf)> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let prefix = format!("{}.", path.file_name().unwrap_or_default().to_string_lossy());
    let mark_of = |name: &str| {
        let (mark, index) = name.strip_prefix(&prefix)?.split_once('.')?;
        let digits = mark.len() == 14 && index.bytes().all(|byte| byte.is_ascii_digit()) && !index.is_empty();
        u64::from_str_radix(mark, 16).ok().filter(|_| digits)
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| Some((mark_of(&entry.file_name().to_string_lossy())?, entry.path()))).collect()
}

/// The time in microseconds, as long as that is later than any save before.
fn next_mark(path: &Path) -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_micros() as u64);
    files_beside(path).into_iter().map(|(mark, _)| mark + 1).fold(now, u64::max)
}

/// The mark of the save that a path leads to, if ranks have saved there.
pub(super) fn mark_at(path: &Path) -> Option<u64> {
    if format::kind_at(path) != Some(Kind::Ranks) {
        return None;
    }
    let common: Common<'_> = Whole::open(path).ok()?.contents().ok()?;
    Some(common.mark)
}

/// Removes the files of a save that has been replaced, and what was left by any before it that were cut off. Errors are those
/// of files that nobody needs.
pub(super) fn remove_until(path: &Path, mark: u64) {
    let path = followed(path);
    files_beside(&path).iter().filter(|(other, _)| *other <= mark).for_each(|(_, file)| _ = fs::remove_file(file));
}
