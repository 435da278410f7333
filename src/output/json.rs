//! A minimal JSON writer for [`Metadata`](crate::output::Metadata).

/// An object under construction.
#[derive(Debug, Default)]
pub(super) struct Object(String);

impl Object {
    /// Adds a string.
    pub(super) fn text(self, key: &str, text: &str) -> Object {
        let value = quoted(text);
        self.value(key, &value)
    }

    /// Adds finite numbers with enough digits to be read back bitwise.
    pub(super) fn numbers(self, key: &str, numbers: [f64; 2]) -> Object {
        self.value(key, &format!("{numbers:?}"))
    }

    /// Adds a JSON value.
    pub(super) fn value(mut self, key: &str, json: &str) -> Object {
        self.0.push_str(if self.0.is_empty() { "{" } else { ", " });
        self.0.push_str(&quoted(key));
        self.0.push_str(": ");
        self.0.push_str(json);
        self
    }

    /// The object as text.
    pub(super) fn finish(mut self) -> String {
        self.0.push_str(if self.0.is_empty() { "{}" } else { "}" });
        self.0
    }
}

/// A JSON string, in which line breaks and other control characters are escaped.
fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => out.push_str(&format!("\\u{:04x}", c as u32)),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(quoted("a \"b\" \\ c\nd\te\r\u{1}\u{85} µm"), r#""a \"b\" \\ c\nd\te\u000d\u0001\u0085 µm""#);
    }

    #[test]
    fn objects_nest() {
        let inner = Object::default().numbers("spacing", [1e-30, 0.5]).finish();
        assert_eq!(inner, r#"{"spacing": [1e-30, 0.5]}"#);
        let outer = Object::default().text("a", "b").value("grid", &inner).value("empty", &Object::default().finish());
        assert_eq!(outer.finish(), r#"{"a": "b", "grid": {"spacing": [1e-30, 0.5]}, "empty": {}}"#);
    }
}
