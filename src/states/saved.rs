//! The state of a contact on elastic states in a file.

use std::borrow::Cow;
use std::io::{Cursor, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::checkpoint::fingerprint::{of_debug_text, of_rule};
use crate::contact::checkpoint::format::damaged;
use crate::contact::checkpoint::format::{CheckpointReader, CheckpointWriter};
use crate::contact::checkpoint::{NO_RUN, check_clocks, malformed};
use crate::error::{Error, Refusal, Result};
use crate::file::{in_memory, replace};
use crate::run::doubled::SavedRun;
use crate::states::contact::StatesContact;
use crate::states::control::OnLevels;
use crate::states::curve::ElasticStates;
use crate::states::levels::Levels;

/// The contents of a file.
#[derive(Serialize, Deserialize)]
struct Saved<'a> {
    /// Time, reduced time, and the reduced time until which the bodies were undisturbed.
    times: [f64; 3],
    /// Approach that the last step prescribed.
    prescribed: Option<f64>,
    levels: Cow<'a, Levels>,
    run: Option<SavedRun<OnLevels>>,
}

impl StatesContact {
    /// Saves the whole state to a file, from which a contact of the same states, material and time rule continues
    /// ([`StatesContact::resume`]) by the same steps, bitwise, with exact states to the tolerance of the solver. The
    /// file is complete when this returns; until then, what was there before is not touched.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be written, or there is something other than a file at `path`.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_with(path.as_ref(), None)
    }

    /// [`StatesContact::save`] with a run that continues from there.
    pub(super) fn save_with(&self, path: &Path, run: Option<SavedRun<OnLevels>>) -> Result<()> {
        let times = [self.time, self.reduced_time, self.undisturbed_until];
        let saved = Saved { times, prescribed: self.prescribed, levels: Cow::Borrowed(&self.levels), run };
        replace(path, |out| CheckpointWriter::begin(out, &self.parts(), &saved)?.finish())
    }

    /// What [`StatesContact::save`] writes, in memory: for pickles, and for messages between processes.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the numbers cannot be written.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let times = [self.time, self.reduced_time, self.undisturbed_until];
        let saved = Saved { times, prescribed: self.prescribed, levels: Cow::Borrowed(&self.levels), run: None };
        in_memory(|out| CheckpointWriter::begin(out, &self.parts(), &saved)?.finish())
    }

    /// Puts a saved state in the place of this one. The contact must be made of the same states and material, with
    /// the same time rule and temperature. A run that saved it ([`Run::autosave_to`](crate::run::Run::autosave_to))
    /// goes on with the next
    /// [`Contact::follow`](crate::run::Contact::follow) of the same stepping, by the same steps.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, of another format or of another contact ([`Error::Checkpoint`]); the
    /// contact is then as it was.
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        self.resume_from(path, CheckpointReader::open(path))
    }

    /// [`StatesContact::resume`] from the bytes of [`StatesContact::to_bytes`], or of a file.
    ///
    /// Needs the feature `checkpoint`.
    ///
    /// # Errors
    /// As [`StatesContact::resume`].
    pub fn resume_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.resume_from(Path::new("bytes in memory"), CheckpointReader::begin(Cursor::new(bytes)))
    }

    fn resume_from(&mut self, path: &Path, file: Result<CheckpointReader<impl Read + Seek>, Refusal>) -> Result<()> {
        let saved = file.and_then(|file| self.read(file));
        let saved = saved.map_err(|cause| Error::Checkpoint { path: path.to_owned(), cause })?;
        [self.time, self.reduced_time, self.undisturbed_until] = saved.times;
        (self.prescribed, self.levels) = (saved.prescribed, saved.levels.into_owned());
        self.saved_run = saved.run.map(|run| Arc::new(run) as _);
        Ok(())
    }

    fn read(&self, mut file: CheckpointReader<impl Read + Seek>) -> Result<Saved<'static>, Refusal> {
        if !file.is_intact() {
            return Err(damaged());
        }
        let saved: Saved<'static> = file.contents(&self.parts())?;
        let [time, reduced, undisturbed_until] = saved.times;
        if undisturbed_until > reduced
            || !saved.levels.fits(&self.levels)
            || !saved.times.iter().all(|time| time.is_finite() && *time >= 0.0)
            || saved.prescribed.is_some_and(|approach| !approach.is_finite())
        {
            return Err(malformed("levels that no contact has"));
        }
        if saved.run.as_ref().is_some_and(|(progress, record)| !progress.fits() || !record.fits() || !record.own.fits())
        {
            return Err(malformed(NO_RUN));
        }
        check_clocks(time, reduced, self.scene.temperature.as_ref())?;
        Ok(saved)
    }

    /// What tells its scene from others.
    fn parts(&self) -> [(&'static str, Vec<f64>); 6] {
        let ElasticStates { states, rest, tilt, .. } = &*self.scene.swept;
        [
            ("kind of contact", of_debug_text(&"on elastic states")),
            ("elastic states", of_debug_text(&(states, rest, tilt))),
            ("time rule", of_debug_text(&self.scene.interpolant)),
            ("material", of_rule(self.levels.history.rule())),
            ("temperature", of_debug_text(&self.scene.temperature)),
            ("friction", of_debug_text(&self.scene.friction.as_ref().map(|friction| friction.numbers()))),
        ]
    }
}
