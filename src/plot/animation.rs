//! Animations of a run.

use std::fs::File;
use std::io;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result, count_within, within};
use crate::fields::Fields;
use crate::file::{Appending, Part, failed};
use crate::output::Field;
use crate::plot::palette::Palette;
use crate::plot::picture::check_extension;
use crate::plot::{ColorScale, Map, Picture, color_scale};

/// A run as an animated GIF that repeats endlessly.
///
/// Frames are written as they are recorded, to a file whose name ends in the process ID and `.part`; browsers show it
/// as far as it is written. [`Animation::finish`] gives it its final name. An animation that is dropped before that
/// leaves the partial file.
///
/// ```
/// use viscocontact::plot::Animation;
/// use viscocontact::{output::Field, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-animation-{}.gif", std::process::id()));
/// let mut animation = Animation::create(&path, Field::Pressure, [0.0, 0.3e6], 0.1)?;
/// for dt in [0.0, 0.1, 0.1] {
///     contact.step(dt, Load::force(0.5))?;
///     animation.record(&contact)?;
/// }
/// animation.finish()?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
pub struct Animation {
    path: PathBuf,
    /// Left where it is if the animation is dropped.
    part: ManuallyDrop<Part>,
    file: Appending<File>,
    field: Field,
    range: [f64; 2],
    /// Duration of a frame in hundredths of a second.
    delay: u16,
    palette: Palette,
    /// `None` before the first frame.
    encoder: Option<gif::Encoder<Vec<u8>>>,
    size: [u32; 2],
    /// Palette indices of the last frame: of the next one only what differs is written.
    last: Vec<u8>,
    frames: usize,
}

impl Animation {
    /// An animation of `field` with a colour scale from `range[0]` to `range[1]` in SI units in all frames. Each frame
    /// is shown for `seconds`, rounded to hundredths. An existing file of this name is replaced when the animation is
    /// finished.
    ///
    /// # Errors
    /// If the extension is not `.gif`, the range is not increasing, `seconds` is not in \[0.02, 600\], or the file
    /// cannot be written.
    pub fn create(path: impl AsRef<Path>, field: Field, range: [f64; 2], seconds: f64) -> Result<Animation> {
        let path = path.as_ref().to_owned();
        check_extension(&path, &["gif"])?;
        color_scale(range)?;
        // players show shorter frames for a tenth of a second
        let allowed = (0.02..=600.0).contains(&seconds);
        let delay = (within("seconds per frame", seconds, allowed, "in [0.02, 600]")? * 100.0).round() as u16;
        let (part, file) = Part::create(&path)?;
        Ok(Animation {
            path,
            part: ManuallyDrop::new(part),
            file: Appending::new(file),
            field,
            range,
            delay,
            palette: Palette::new(ColorScale::of(field)),
            encoder: None,
            size: [0; 2],
            last: Vec::new(),
            frames: 0,
        })
    }

    /// Records the current state of a contact as a frame: the field, with the contact outlined.
    ///
    /// # Errors
    /// As [`Animation::record_picture`], or if a value exceeds 1e100 in magnitude.
    pub fn record<'a>(&mut self, contact: impl Into<Fields<'a>>) -> Result<()> {
        let contact = contact.into();
        let mut map = Map::field(contact, self.field)?.outline_contact(contact)?;
        map.range = self.range;
        self.record_picture(&map.draw()?)
    }

    /// Records any picture as a frame. Its colours are mapped to the nearest of 256: the colours of maps and curves,
    /// and greys.
    ///
    /// # Errors
    /// If its size differs from the first picture's, or the file cannot be written. The file then contains nothing of
    /// it.
    pub fn record_picture(&mut self, picture: &Picture) -> Result<()> {
        let size = picture.size();
        let refused = |error| failed(&self.path, io::Error::other(error));
        if self.frames == 0 {
            // a picture has at most 16384 pixels per side
            let [width, height] = size.map(|side| side as u16);
            let mut encoder = gif::Encoder::new(Vec::new(), width, height, &self.palette.bytes()).map_err(refused)?;
            encoder.set_repeat(gif::Repeat::Infinite).map_err(refused)?;
            (self.encoder, self.size) = (Some(encoder), size);
        }
        for (axis, field) in ["width of a frame", "height of a frame"].into_iter().enumerate() {
            count_within(field, size[axis] as usize, size[axis] == self.size[axis], "that of the first frame")?;
        }
        let pixels = self.palette.indexed(picture.rgb());
        let [left, top, width, height] = changed(&self.last, &pixels, size[0] as usize);
        let rows = pixels.chunks_exact(size[0] as usize).skip(top).take(height);
        let frame = gif::Frame {
            delay: self.delay,
            left: left as u16,
            top: top as u16,
            width: width as u16,
            height: height as u16,
            buffer: rows.flat_map(|row| &row[left..left + width]).copied().collect(),
            ..gif::Frame::default()
        };
        if let Some(encoder) = &mut self.encoder {
            let encoded = encoder.write_frame(&frame);
            let piece = std::mem::take(encoder.get_mut());
            encoded.map_err(refused)?;
            self.file.append(&piece).map_err(|error| failed(&self.path, error))?;
        }
        self.last = pixels;
        self.frames += 1;
        Ok(())
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Completes the file and gives it its final name.
    ///
    /// # Errors
    /// If there are no frames, or the file cannot be written.
    pub fn finish(mut self) -> Result<()> {
        let Some(encoder) = self.encoder.take().filter(|_| self.frames > 0) else {
            drop(ManuallyDrop::into_inner(self.part)); // without frames the file is useless
            return Err(Error::WrongLength { field: "frames of an animation", len: 0, expected: 1, exact: false });
        };
        let end = encoder.into_inner().map_err(io::Error::other);
        end.and_then(|end| self.file.append(&end)).map_err(|error| failed(&self.path, error))?;
        self.part.place(self.file.into_inner())
    }
}

/// Bounding box of the pixels that differ from the previous frame: left, top, width and height, at least one pixel.
fn changed(before: &[u8], now: &[u8], width: usize) -> [usize; 4] {
    if before.len() != now.len() {
        return [0, 0, width, now.len() / width];
    }
    let (mut left, mut right, mut top, mut bottom) = (width, 0, usize::MAX, 0);
    for (y, (old, new)) in before.chunks_exact(width).zip(now.chunks_exact(width)).enumerate() {
        for x in (0..width).filter(|&x| old[x] != new[x]) {
            (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
        }
    }
    if top == usize::MAX { [0, 0, 1, 1] } else { [left, top, right - left + 1, bottom - top + 1] }
}

debug_by!(self: Animation => path: self.path, field: self.field, size: self.size, frames: self.frames);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounding_box_of_changes_is_found() {
        let before = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let mut now = before;
        assert_eq!(changed(&before, &now, 4), [0, 0, 1, 1]);
        (now[6], now[9]) = (1, 1);
        assert_eq!(changed(&before, &now, 4), [1, 1, 2, 2]);
        assert_eq!(changed(&[], &now, 4), [0, 0, 4, 3]);
    }
}
