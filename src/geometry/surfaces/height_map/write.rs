//! Maps written to files.

use std::io::Write;

use crate::error::{Error, Refusal, Result};
use crate::geometry::HeightMap;
use crate::geometry::surfaces::height_map::read::gsf;

impl HeightMap {
    /// Writes the map as a Gwyddion Simple Field 1.0, in single precision and in m; see [`HeightMap::from_gsf`].
    ///
    /// ```
    /// use viscocontact::geometry::HeightMap;
    ///
    /// let map = HeightMap::new([2, 2], [1e-3, 1e-3], vec![0.0, 0.5, 0.25, f64::NAN])?;
    /// let mut file = Vec::new();
    /// map.write_gsf(&mut file)?;
    /// assert!(file.starts_with(b"Gwyddion Simple Field 1.0\nXRes = 2\n"));
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a height exceeds the range of single precision, or writing fails.
    pub fn write_gsf(&self, writer: impl Write) -> Result<()> {
        let [n1, n2] = self.cells;
        let [l1, l2] = [n1 as f64 * self.spacing[0], n2 as f64 * self.spacing[1]];
        let sizes = format!("XRes = {n1}\nYRes = {n2}\nXReal = {l1:e}\nYReal = {l2:e}\nXYUnits = m\nZUnits = m\n");
        let mut file = [gsf::MAGIC, &sizes].concat().into_bytes();
        file.resize(file.len() + 4 - file.len() % 4, 0);
        for j in (0..n2).rev() {
            for i in 0..n1 {
                let value = self.heights[i * n2 + j];
                let single = value as f32;
                if single.is_infinite() {
                    let allowed = "within the range of single precision";
                    return Err(Error::OutOfRange { field: "height", value, allowed });
                }
                file.extend(single.to_le_bytes());
            }
        }
        save(writer, "GSF", &file)
    }

    /// Writes the map as a surface data file of ISO 25178-71, as text (`aISO-1.0`), in m and with all digits:
    /// [`HeightMap::from_sdf`] reads it back bitwise.
    ///
    /// The dates are unknown and written as zeros.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write_sdf(&self, writer: impl Write) -> Result<()> {
        let [n1, n2] = self.cells;
        let [d1, d2] = self.spacing;
        let mut file = format!(
            "aISO-1.0\r\nManufacID = viscocont\r\nCreateDate = 000000000000\r\nModDate = 000000000000\r\n\
             NumPoints = {n1}\r\nNumProfiles = {n2}\r\nXscale = {d1:e}\r\nYscale = {d2:e}\r\nZscale = 1\r\n\
             Zresolution = -1\r\nCompression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n"
        );
        for j in 0..n2 {
            for i in 0..n1 {
                let end = if i + 1 == n1 { "\r\n" } else { " " };
                let height = self.heights[i * n2 + j];
                file += &if height.is_nan() { format!("BAD{end}") } else { format!("{height:e}{end}") };
            }
        }
        file += "*\r\n*\r\n";
        save(writer, "SDF", file.as_bytes())
    }

    /// Writes the heights in m as a NumPy array in double precision, little endian, with x1 as the first axis and x2 as
    /// the second. The lengths of the map are not in the file.
    ///
    /// Needs the feature `npy`.
    ///
    /// ```
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let map = HeightMap::new([1, 2], [1e-3, 2e-3], vec![1e-6, 3e-6])?;
    /// let mut file = Vec::new();
    /// map.write_npy(&mut file)?;
    /// assert_eq!(HeightMap::from_npy(&file[..], [1e-3, 2e-3], LengthUnit::Metre)?, map);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If writing fails.
    #[cfg(feature = "npy")]
    pub fn write_npy(&self, writer: impl Write) -> Result<()> {
        let mut file = crate::file::npy::header("<f8", &self.cells);
        file.extend(self.heights.iter().flat_map(|height| height.to_le_bytes()));
        save(writer, "NPY", &file)
    }
}

fn save(mut writer: impl Write, format: &'static str, file: &[u8]) -> Result<()> {
    let written = writer.write_all(file).and_then(|()| writer.flush());
    written.map_err(|error| {
        let what = format!("the {format} file could not be written: {error}");
        Refusal::file("map_unwritable", what, "").of_system(error.kind()).into()
    })
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    /// Different along both axes, with a missing point, a negative zero and values of many digits.
    fn map() -> HeightMap {
        let mut heights: Vec<f64> = (0..35).map(|k| (f64::from(k) * 0.37).sin() * 1e-6 / 3.0).collect();
        (heights[3], heights[20], heights[30]) = (f64::NAN, -0.0, 5e-324);
        HeightMap::new([5, 7], [1.0 / 3.0, 0.1], heights).unwrap()
    }

    fn bits(map: &HeightMap) -> Vec<u64> {
        let all = map.spacing.iter().chain(&map.heights);
        all.map(|value| if value.is_nan() { u64::MAX } else { value.to_bits() }).collect()
    }

    #[test]
    fn sdf_is_read_back_bitwise() {
        let (map, mut file) = (map(), Vec::new());
        map.write_sdf(&mut file).unwrap();
        let back = HeightMap::from_sdf(&file[..]).unwrap();
        assert_eq!((back.cells, bits(&back)), (map.cells, bits(&map)));
    }

    #[cfg(feature = "npy")]
    #[test]
    fn npy_is_read_back_bitwise() {
        let (map, mut file) = (map(), Vec::new());
        map.write_npy(&mut file).unwrap();
        assert_eq!((file.len() - 35 * 8) % 64, 0);
        let back = HeightMap::from_npy(&file[..], [1.0 / 3.0, 0.1], crate::geometry::LengthUnit::Metre).unwrap();
        assert_eq!((back.cells, bits(&back)), (map.cells, bits(&map)));
    }

    #[test]
    fn gsf_is_read_back_in_single_precision() {
        let (map, mut file) = (map(), Vec::new());
        map.write_gsf(&mut file).unwrap();
        let back = HeightMap::from_gsf(&file[..], None).unwrap();
        let single = map.heights.iter().map(|&height| f64::from(height as f32)).collect();
        let expected = HeightMap { heights: single, ..map };
        assert_eq!(bits(&back)[2..], bits(&expected)[2..]);
        for axis in 0..2 {
            assert_abs_diff_eq!(back.spacing[axis] / expected.spacing[axis], 1.0, epsilon = 1e-15);
        }
    }

    #[test]
    fn writing_errors_are_reported() {
        let high = HeightMap::new([1, 1], [1.0, 1.0], vec![1e39]).unwrap();
        assert!(matches!(high.write_gsf(Vec::new()), Err(Error::OutOfRange { field: "height", .. })));
        let mut short = [0; 5];
        let error = map().write_sdf(&mut short[..]).unwrap_err();
        assert!(error.to_string().starts_with("the SDF file could not be written"), "{error}");
    }
}
