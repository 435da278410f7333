//! Pictures in memory, and as PNG files.

use std::fmt;
use std::io;
use std::path::Path;
use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::{BitMapBackend, DrawingArea, IntoDrawingArea};
use plotters::style::{FontStyle, WHITE, register_font};

use crate::error::{Error, Result, count_within, least_length};
use crate::file::{failed, replace};

/// Name under which the font of all texts is registered.
pub(super) const FONT: &str = "viscocontact";
/// Greatest width or height of a picture in pixels.
const MAX_SIDE: usize = 16_384;

/// The drawing area of a picture.
pub(super) type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// A picture in memory, three bytes per pixel: red, green and blue, row by row from the top.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    size: [u32; 2],
    rgb: Vec<u8>,
}

impl Picture {
    /// A white picture of `width` × `height` pixels, drawn on by `draw`.
    pub(super) fn new(size: [u32; 2], draw: impl FnOnce(&Area) -> Result<(), DrawingError>) -> Result<Picture> {
        register_font_once()?;
        size.iter().try_for_each(|&side| check_side(side as usize))?;
        let mut rgb = vec![255; 3 * size[0] as usize * size[1] as usize];
        let area = BitMapBackend::with_buffer(&mut rgb, (size[0], size[1])).into_drawing_area();
        let drawn = area.fill(&WHITE).map_err(DrawingError::from).and_then(|()| draw(&area));
        drawn
            .and_then(|()| area.present().map_err(DrawingError::from))
            .map_err(|DrawingError(what)| drawing_failed(what))?;
        drop(area);
        Ok(Picture { size, rgb })
    }

    /// Pictures side by side from left to right; white below those that are lower than others.
    ///
    /// # Errors
    /// If there are none, or they are wider than 16384 pixels together.
    pub fn beside(pictures: &[Picture]) -> Result<Picture> {
        least_length("pictures", pictures.len(), 1)?;
        let width = pictures.iter().map(|picture| picture.size[0] as usize).sum();
        check_side(width)?;
        let height = pictures.iter().map(|picture| picture.size[1]).max().unwrap_or(1);
        let mut rgb = vec![255; 3 * width * height as usize];
        let mut left = 0;
        for picture in pictures {
            let row = 3 * picture.size[0] as usize;
            for (to, from) in rgb.chunks_exact_mut(3 * width).zip(picture.rgb.chunks_exact(row)) {
                to[left..left + row].copy_from_slice(from);
            }
            left += row;
        }
        Ok(Picture { size: [width as u32, height], rgb })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels, row by row from the top: red, green and blue of each.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Writes the picture to a PNG file, whatever the extension. An existing file is replaced when the new one is
    /// complete.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        replace(path.as_ref(), |out| {
            let mut encoder = png::Encoder::new(out, self.size[0], self.size[1]);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_compression(png::Compression::High);
            let mut writer = encoder.write_header().map_err(io::Error::other)?;
            writer.write_image_data(&self.rgb).map_err(io::Error::other)?;
            writer.finish().map_err(io::Error::other)
        })
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Picture").field("size", &self.size).finish_non_exhaustive()
    }
}

/// Accepts a width or height in pixels.
fn check_side(value: usize) -> Result<()> {
    count_within("pixels along a side of a picture", value, (1..=MAX_SIDE).contains(&value), "in [1, 16384]")
}

/// The message of a drawing error.
#[derive(Debug)]
pub(super) struct DrawingError(String);

impl<E: std::error::Error> From<E> for DrawingError {
    fn from(error: E) -> DrawingError {
        DrawingError(error.to_string())
    }
}

fn drawing_failed(what: impl fmt::Display) -> Error {
    failed(Path::new("a picture"), what)
}

/// Registers the compiled-in font once: no system font is needed.
fn register_font_once() -> Result<()> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        REGISTERED.get_or_init(|| register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok());
    if *registered { Ok(()) } else { Err(drawing_failed("the font cannot be read")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_placed_side_by_side() {
        let plain = |size: [u32; 2], value: u8| Picture { size, rgb: vec![value; 3 * (size[0] * size[1]) as usize] };
        let both = Picture::beside(&[plain([2, 1], 7), plain([1, 2], 9)]).unwrap();
        assert_eq!(both.size(), [3, 2]);
        let red: Vec<u8> = both.rgb().iter().step_by(3).copied().collect();
        assert_eq!(red, [7, 7, 9, 255, 255, 9]);
        assert!(matches!(Picture::beside(&[]), Err(Error::WrongLength { field: "pictures", .. })));
        let wide = plain([10_000, 1], 0);
        assert!(matches!(Picture::beside(&[wide.clone(), wide]), Err(Error::CountOutOfRange { value: 20_000, .. })));
    }

    #[test]
    fn files_hold_the_pixels() {
        let picture = Picture::new([31, 17], |area| Ok(area.fill(&plotters::style::RED)?)).unwrap();
        let path = std::env::temp_dir().join(format!("viscocontact-picture-{}.png", std::process::id()));
        picture.save(&path).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut read = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut read).unwrap();
        assert_eq!(read, picture.rgb());
        assert_eq!(read[..3], [255, 0, 0]);
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(picture.save("/no/such/folder/a.png"), Err(Error::Output { .. })));
        assert!(Picture::new([0, 5], |_| Ok(())).is_err());
    }
}
