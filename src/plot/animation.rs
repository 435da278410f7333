//! Runs that move.

use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};

use crate::ViscoelasticContact;
use crate::error::{Error, Result, within};
use crate::file::{Appending, Part, failed};
use crate::output::Field;
use crate::plot::palette::Palette;
use crate::plot::quantity::drawable;
use crate::plot::{Map, Picture};

/// A run as an animated GIF, frame by frame, played over and over.
///
/// Frames are written as they are added, to a file with the number of the process and `.part` behind its name, which browsers
/// show as far as it goes; it gets its own name by [`Animation::finish`]. An animation that is dropped before leaves the part.
///
/// ```
/// use viscocontact::plot::Animation;
/// use viscocontact::{output::Field, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-animation-{}.gif", std::process::id()));
/// let mut animation = Animation::create(&path, Field::Pressure, [0.0, 0.3e6], 0.1)?;
/// for dt in [0.0, 0.1, 0.1] {
///     contact.step(dt, Load::force(0.5))?;
///     animation.add(&contact)?;
/// }
/// animation.finish()?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
pub struct Animation {
    path: PathBuf,
    part: Part,
    file: Appending<File>,
    field: Field,
    range: [f64; 2],
    /// Hundredths of a second a frame.
    delay: u16,
    palette: Palette,
    /// From the first frame on.
    encoder: Option<gif::Encoder<Vec<u8>>>,
    size: [u32; 2],
    /// The last frame, to write of the next what has changed.
    last: Vec<u8>,
    frames: usize,
}

impl Animation {
    /// An animation of `field`, whose colours go from `range[0]` to `range[1]` in SI units, the same in all frames;
    /// each frame is shown for `seconds`, to a hundredth. A file of this name is replaced when the animation is
    /// finished.
    ///
    /// # Errors
    /// If the range is not in order, `seconds` is not in \[0.02, 600\], or the file cannot be written.
    pub fn create(path: impl AsRef<Path>, field: Field, range: [f64; 2], seconds: f64) -> Result<Animation> {
        let path = path.as_ref().to_owned();
        drawable("lower end of the colour scale", range[0])?;
        let upper = "upper end of the colour scale";
        within(upper, drawable(upper, range[1])?, range[1] > range[0], "above the lower end")?;
        // players show shorter ones for a tenth of a second
        let allowed = (0.02..=600.0).contains(&seconds);
        let delay = (within("seconds a frame", seconds, allowed, "in [0.02, 600]")? * 100.0).round() as u16;
        let (part, file) = Part::create(&path)?;
        Ok(Animation {
            path,
            part,
            file: Appending::new(file),
            field,
            range,
            delay,
            palette: Palette::new(),
            encoder: None,
            size: [0; 2],
            last: Vec::new(),
            frames: 0,
        })
    }

    /// Adds the state a contact is in: the field, and a line around the cells in contact.
    ///
    /// # Errors
    /// As [`Animation::add_picture`], or if a value is beyond 1e100.
    pub fn add(&mut self, contact: &ViscoelasticContact) -> Result<()> {
        let mut map = Map::field(contact, self.field)?.outline_contact(contact)?;
        map.range = self.range;
        self.add_picture(&map.draw()?)
    }

    /// Adds a picture of your own. Its colours are the nearest of 256: those of maps and series, and greys.
    ///
    /// # Errors
    /// If it has another size than the first, or the file cannot be written; nothing of it is in the file then.
    pub fn add_picture(&mut self, picture: &Picture) -> Result<()> {
        let size = picture.size();
        let path = &self.path;
        if self.frames == 0 {
            // a picture has 16384 pixels along a side at most
            let [width, height] = size.map(|side| side as u16);
            let mut encoder = gif::Encoder::new(Vec::new(), width, height, &self.palette.bytes())
                .map_err(|error| failed(path, error))?;
            encoder.set_repeat(gif::Repeat::Infinite).map_err(|error| failed(path, error))?;
            (self.encoder, self.size) = (Some(encoder), size);
        }
        for (field, side, first) in
            [("width of a frame", size[0], self.size[0]), ("height of a frame", size[1], self.size[1])]
        {
            if side != first {
                return Err(Error::CountOutOfRange { field, value: side as usize, allowed: "that of the first frame" });
            }
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
            encoded.map_err(|error| failed(path, error))?;
            self.file.append(&piece).map_err(|error| failed(path, error))?;
        }
        self.last = pixels;
        self.frames += 1;
        Ok(())
    }

    /// Frames added.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// If there are no frames, or the file cannot be written.
    pub fn finish(mut self) -> Result<()> {
        let Some(encoder) = self.encoder.take().filter(|_| self.frames > 0) else {
            self.part.remove(); // nothing worth keeping
            return Err(Error::WrongLength { field: "frames of an animation", len: 0, expected: 1, exact: false });
        };
        let end = encoder.into_inner().map_err(|error| failed(&self.path, error))?;
        self.file.append(&end).map_err(|error| failed(&self.path, error))?;
        self.part.place(self.file.into_inner())
    }
}

/// The rectangle in which a frame differs from the one before: left, top, width and height, a pixel at least.
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

impl fmt::Debug for Animation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Animation")
            .field("path", &self.path)
            .field("field", &self.field)
            .field("size", &self.size)
            .field("frames", &self.frames)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changed_is_found() {
        let before = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let mut now = before;
        assert_eq!(changed(&before, &now, 4), [0, 0, 1, 1]);
        (now[6], now[9]) = (1, 1);
        assert_eq!(changed(&before, &now, 4), [1, 1, 2, 2]);
        assert_eq!(changed(&[], &now, 4), [0, 0, 4, 3]);
    }
}
