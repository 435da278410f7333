//! How text files are written.

value! {
/// How a text file separates its fields and writes its numbers, where this is not to be found out.
///
/// Fields that contain the delimiter or a line end are quoted. Numbers have an exponent with `e`, or with `d` as in
/// Fortran, and no separators of thousands. Empty lines and lines that start with `#` or `%` are skipped. Texts are
/// UTF-8, Windows-1252 (which includes Latin-1), or UTF-16 with a byte order mark.
///
/// ```
/// use viscocontact::rheology::{Experiment, Measurements, Units};
/// use viscocontact::{Delimiter, TextFormat};
///
/// let text = "t J\n0,5 1,0e-9\n1,5 1,1e-9\n5 1,2e-9\n15 1,3e-9\n";
/// let format = TextFormat::default().with_delimiter(Delimiter::Blanks).with_decimal_comma(true);
/// let body = Measurements::from_csv_reader(Experiment::Creep, text.as_bytes(), Units::SI, format)?.fit()?;
/// assert_eq!(body.report().samples()[0].x, 0.5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TextFormat {
    /// What separates the fields of a line.
    delimiter: Delimiter, with_delimiter;
    /// Whether numbers have a decimal comma or a decimal point; `None` is found out.
    decimal_comma: Option<bool>;
    /// Number of lines at the beginning of the file that are not read.
    skipped_lines: u64, with_skipped_lines;
    /// The height that stands for a point without one, in the unit of the file: −9999, 65535. NaN: there is none, and
    /// every number is a height. By default, numbers that look like it are an error.
    missing_height: Option<f64>;
}
}

impl TextFormat {
    /// The same with decimal commas, or else decimal points.
    #[must_use]
    pub const fn with_decimal_comma(self, decimal_comma: bool) -> TextFormat {
        TextFormat { decimal_comma: Some(decimal_comma), ..self }
    }

    /// The same with a [`missing_height`](TextFormat::missing_height).
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let text = "Unit: nm\n1.0 2.0 65535\n1.5 2.5 3.5\n";
    /// let read = |format| HeightMap::from_text(text.as_bytes(), [3e-6, 2e-6], LengthUnit::Nanometre, format);
    /// assert!(read(TextFormat::default()).is_err()); // 65535 looks like a missing point
    /// let map = read(TextFormat::default().with_missing_height(65535.0))?;
    /// assert_eq!(map.missing(), 1);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    #[must_use]
    pub const fn with_missing_height(self, height: f64) -> TextFormat {
        TextFormat { missing_height: Some(height), ..self }
    }
}

/// What separates the fields of a line of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Delimiter {
    /// The mark that makes the most numbers of the lines: a semicolon, a tab, a comma, or else blanks.
    #[default]
    Detected,
    /// A comma.
    Comma,
    /// A semicolon.
    Semicolon,
    /// A tab.
    Tab,
    /// Any number of blanks and tabs.
    Blanks,
}

impl Delimiter {
    /// The characters, and their name for errors.
    pub(super) fn marks(self) -> (&'static [char], &'static str) {
        match self {
            Delimiter::Comma => (&[','], "commas"),
            Delimiter::Semicolon => (&[';'], "semicolons"),
            Delimiter::Tab => (&['\t'], "tabs"),
            Delimiter::Blanks | Delimiter::Detected => (&[' ', '\t'], "blanks"),
        }
    }
}
