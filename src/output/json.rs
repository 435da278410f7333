//! The little JSON that a scene needs.

/// An object under construction.
#[derive(Debug, Default)]
pub(super) struct Object(String);

impl Object {
    /// Adds a text.
    pub(super) fn text(self, key: &str, text: &str) -> Object {
        let value = quoted(text);
        self.value(key, &value)
    }

    /// Adds finite numbers, in as many digits as make them the same when read back.
    pub(super) fn numbers(self, key: &str, numbers: [f64; 2]) -> Object {
        self.value(key, &format!("{numbers:?}"))
    }

    /// Adds what is JSON already.
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

/// A JSON string: no line ends or other control characters are left in it.
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
