//! The bytes of a text file as text.

/// The characters of the bytes 0x80 to 0x9f in Windows-1252.
const WINDOWS: &str = "€\u{81}‚ƒ„…†‡ˆ‰Š‹Œ\u{8d}Ž\u{8f}\u{90}‘’“”•–—˜™š›œ\u{9d}žŸ";

/// The text of a file with line ends of one character, and the name of its encoding; `None` if it is no text.
///
/// UTF-16 begins with a byte order mark. Lines that are not UTF-8 are Windows-1252, which includes Latin-1.
pub(super) fn decoded(bytes: &[u8]) -> Option<(String, &'static str)> {
    let (text, encoding) = match bytes {
        [0xff, 0xfe, words @ ..] => (utf16(words, u16::from_le_bytes)?, "UTF-16"),
        [0xfe, 0xff, words @ ..] => (utf16(words, u16::from_be_bytes)?, "UTF-16"),
        _ => by_lines(bytes),
    };
    if text.contains('\0') {
        return None;
    }
    Some((text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n").replace('\r', "\n"), encoding))
}

fn utf16(bytes: &[u8], word: fn([u8; 2]) -> u16) -> Option<String> {
    let (pairs, []) = bytes.as_chunks() else { return None };
    String::from_utf16(&pairs.iter().map(|&pair| word(pair)).collect::<Vec<_>>()).ok()
}

/// A text in UTF-8, or in Windows-1252 in the lines that are not UTF-8.
pub(crate) fn by_lines(bytes: &[u8]) -> (String, &'static str) {
    let (mut text, mut encoding) = (String::with_capacity(bytes.len()), "UTF-8");
    for line in bytes.split_inclusive(|byte| b"\r\n".contains(byte)) {
        if let Ok(line) = str::from_utf8(line) {
            text.push_str(line);
        } else {
            encoding = "Windows-1252";
            let character = |byte: &u8| match byte {
                0x80..0xa0 => WINDOWS.chars().nth(usize::from(byte - 0x80)).unwrap_or(char::REPLACEMENT_CHARACTER),
                _ => char::from(*byte),
            };
            text.extend(line.iter().map(character));
        }
    }
    (text, encoding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_of_instruments_are_decoded() {
        let text = "t (µs);T (°C);€\n1;2;3\n";
        let utf16 = |bytes: fn(u16) -> [u8; 2], mark: &[u8]| -> Vec<u8> {
            let words = text.replace('\n', "\r\n");
            mark.iter().copied().chain(words.encode_utf16().flat_map(bytes)).collect()
        };
        for (bytes, encoding) in [
            (text.as_bytes().to_vec(), "UTF-8"),
            (format!("\u{feff}{}", text.replace('\n', "\r")).into_bytes(), "UTF-8"),
            (b"t (\xb5s);T (\xb0C);\x80\n1;2;3\n".to_vec(), "Windows-1252"),
            (utf16(u16::to_le_bytes, &[0xff, 0xfe]), "UTF-16"),
            (utf16(u16::to_be_bytes, &[0xfe, 0xff]), "UTF-16"),
        ] {
            assert_eq!(decoded(&bytes), Some((text.to_owned(), encoding)));
        }
        for bytes in [&b"1 2\0\n"[..], &[0xff, 0xfe, 0x31], &[0xff, 0xfe, 0, 0xd8], &[0xff, 0xfe, 0, 0]] {
            assert_eq!(decoded(bytes), None, "{bytes:?}");
        }
    }
}
