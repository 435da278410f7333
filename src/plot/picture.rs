//! Pictures in memory, and as PNG and SVG files.

use std::io;
use std::path::Path;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use crate::error::{Refusal, Result, count_within, least_length};
use crate::file::{in_memory, replace};
use crate::plot::Canvas;
use crate::plot::canvas::{Element, png_file};

/// Maximum width of a picture in pixels.
const MAX_SIDE: usize = 16_384;
/// The font of the pixels, then fonts that most systems have.
const FONTS: &str = "'Ubuntu Light', Ubuntu, Arial, Helvetica, 'Liberation Sans', sans-serif";

/// A picture in memory: three bytes per pixel, red, green and blue, row by row from the top; and the same shapes as
/// elements of an SVG document.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    size: [u32; 2],
    rgb: Vec<u8>,
    /// The elements of pictures side by side, and where they begin.
    drawn: Vec<(u32, Vec<Element>)>,
}

impl Picture {
    /// The picture drawn on a canvas of this size.
    pub(super) fn new(canvas: Canvas) -> Picture {
        let size = canvas.size();
        let (rgb, elements) = canvas.finish();
        Picture { size, rgb, drawn: vec![(0, elements)] }
    }

    /// Pictures side by side from left to right; white fills the space below the lower pictures.
    ///
    /// # Errors
    /// If there are none, or they are wider than 16384 pixels together.
    pub fn beside(pictures: &[Picture]) -> Result<Picture> {
        least_length("pictures", pictures.len(), 1)?;
        let width = pictures.iter().map(|picture| picture.size[0] as usize).sum();
        count_within("pixels along a side of a picture", width, (1..=MAX_SIDE).contains(&width), "in [1, 16384]")?;
        let height = pictures.iter().map(|picture| picture.size[1]).max().unwrap_or(1);
        let mut rgb = vec![255; 3 * width * height as usize];
        let mut drawn = Vec::new();
        let mut left = 0;
        for picture in pictures {
            drawn.extend(picture.drawn.iter().map(|(at, elements)| (left as u32 / 3 + at, elements.clone())));
            let row = 3 * picture.size[0] as usize;
            for (to, from) in rgb.chunks_exact_mut(3 * width).zip(picture.rgb.chunks_exact(row)) {
                to[left..left + row].copy_from_slice(from);
            }
            left += row;
        }
        Ok(Picture { size: [width as u32, height], rgb, drawn })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels, row by row from the top: red, green and blue of each.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Writes the picture to a file in the format of its extension, `.png` or `.svg`. SVG files have the same size
    /// and sharp lines at any magnification; their texts are texts, in a similar font of the reader's system. Maps
    /// are images in them, of a pixel for each cell. An existing file is replaced when the new one is complete.
    ///
    /// # Errors
    /// If the extension is another, or if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        match check_extension(path, &["png", "svg"])? {
            0 => replace(path, |out| png_file(out, self.size, &self.rgb)),
            _ => replace(path, |out| self.write_svg(out)),
        }
    }

    /// The bytes of the PNG file, in memory: for notebooks and servers.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        in_memory(|out| png_file(out, self.size, &self.rgb))
    }

    /// Writes the SVG document. Cells are an image of a pixel each: a map takes as much as in a PNG file, where
    /// rectangles would take a hundred bytes for each cell.
    fn write_svg(&self, out: &mut impl io::Write) -> io::Result<()> {
        let [width, height] = self.size;
        writeln!(
            out,
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\" font-family=\"{FONTS}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        )?;
        for (left, elements) in &self.drawn {
            writeln!(out, "<g transform=\"translate({left} 0)\">")?;
            for element in elements {
                match element {
                    Element::Xml(xml) => writeln!(out, "{xml}")?,
                    Element::Cells { attributes, size, rgb } => {
                        let mut png = Vec::new();
                        png_file(&mut png, *size, rgb)?;
                        let png = BASE64_STANDARD.encode(png);
                        writeln!(out, "<image {attributes} xlink:href=\"data:image/png;base64,{png}\"/>")?;
                    }
                }
            }
            writeln!(out, "</g>")?;
        }
        writeln!(out, "</svg>")
    }
}

/// The index of the extension of a file among those allowed, in upper or lower case.
pub(super) fn check_extension(path: &Path, allowed: &'static [&'static str]) -> Result<usize> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let unknown = || {
        let what = format!("{}: the extension must be .{}", path.display(), allowed.join(" or ."));
        Refusal::file("extension", what, "").into()
    };
    allowed.iter().position(|allowed| *allowed == extension).ok_or_else(unknown)
}

debug_by!(self: Picture => size: self.size);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::plot::Color;

    fn plain(size: [u32; 2], value: u8) -> Picture {
        let mut canvas = Canvas::new(size).unwrap();
        canvas.rectangle([0.0, 0.0, f64::from(size[0]), f64::from(size[1])], Color(value, value, value), 100);
        Picture::new(canvas)
    }

    fn file(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("viscocontact-picture-{}-{name}", std::process::id()))
    }

    #[test]
    fn pictures_are_placed_side_by_side() {
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
        let picture = Picture::beside(&[plain([31, 17], 200), plain([3, 17], 20)]).unwrap();
        let path = file("a.PNG");
        picture.save(&path).unwrap();
        let mut decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut read = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut read).unwrap();
        assert_eq!(read, picture.rgb());
        assert_eq!(read[..3], [200, 200, 200]);
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(picture.save("/no/such/folder/a.png"), Err(Error::Output(_))));
    }

    #[test]
    fn the_extension_determines_the_format() {
        for name in ["a.jpg", "png", "a", "a.svg.gz"] {
            let refused = plain([2, 2], 0).save(file(name)).unwrap_err();
            assert_eq!(refused.code(), "extension", "{name}: {refused}");
            assert!(refused.to_string().ends_with(&format!("{name}: the extension must be .png or .svg")), "{refused}");
            assert!(!file(name).exists());
        }
    }

    #[cfg(feature = "x3p")] // which reads XML
    #[test]
    fn svg_files_are_well_formed_and_hold_the_texts() {
        use crate::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
        use base64::Engine as _;
        use base64::prelude::BASE64_STANDARD;
        let mut chart = Chart::new("A < B & \u{1} > \"τ\"", Quantity::new("time", "s"), "q", Legend::UpperLeft);
        chart.add("measured <τ>", COLORS[0], Style::LineAndDots, vec![(0.0, 0.0), (f64::NAN, 1.0), (2.0e-3, 5.0e-6)]);
        let grid = crate::Grid::new([2, 3], [1.0, 1.5]).unwrap();
        let map = Map::new(&grid, vec![0.0, 1.0, 2.0, 3.0, f64::NAN, 5.0], "height").unwrap();
        let path = file("both.svg");
        Picture::beside(&[chart.draw().unwrap(), map.draw().unwrap()]).unwrap().save(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("width"), Some("1977"));
        let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).map(str::trim).collect();
        for label in ["A < B & \u{fffd} > \"τ\"", "time [ms]", "q [10⁻⁶]", "measured <τ>", "1.5", "x1 [mm]", "height"]
        {
            assert!(texts.contains(&label), "{label} is not in {texts:?}");
        }
        let of = |name| document.descendants().filter(move |node| node.has_tag_name(name)).collect::<Vec<_>>();
        // two points and the one in the legend; background and legend; cells and colour bar
        assert_eq!(["circle", "rect", "image"].map(|name| of(name).len()), [3, 2, 2]);
        let source = of("image")[0].attribute(("http://www.w3.org/1999/xlink", "href")).unwrap();
        let png = BASE64_STANDARD.decode(source.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(png));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        // top row first: x2 grows upwards
        let colors = [2.0, 5.0, 1.0, f64::NAN, 0.0, 3.0]
            .map(|value| if value.is_nan() { Color::WHITE } else { Color::on_scale(value / 5.0) });
        assert_eq!(pixels, colors.map(|Color(red, green, blue)| [red, green, blue]).concat());
    }
}
