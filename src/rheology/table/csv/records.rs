//! The rows of a text: separators, quotes, lines.

use super::number::plain;

/// A row that is neither empty nor a comment.
#[derive(Debug)]
pub(super) struct Record<'a> {
    /// The line in which it begins, from 1.
    pub(super) line: u64,
    /// Without surrounding blanks and enclosing quotes.
    pub(super) fields: Vec<String>,
    /// The unparsed text.
    pub(super) raw: &'a str,
}

/// The rows of a text whose fields are separated by `separator`, or by any number of blanks. A quote that is not
/// closed, or not followed by a separator, is part of its field.
pub(super) fn records(text: &str, separator: char) -> Vec<Record<'_>> {
    let (mut records, mut rest, mut line) = (Vec::new(), text, 1);
    while !rest.is_empty() {
        let from = rest;
        let mut fields = Vec::new();
        if rest.trim_start_matches([' ', '\t']).starts_with('#') {
            rest = &rest[rest.find(['\r', '\n']).unwrap_or(rest.len())..];
        } else {
            loop {
                let (field, after) = field(rest, separator);
                if separator != ' ' || !field.is_empty() {
                    fields.push(field);
                }
                rest = after;
                match rest.strip_prefix(separator) {
                    Some(next) => rest = next,
                    None => break,
                }
            }
        }
        let raw = &from[..from.len() - rest.len()];
        rest = rest.strip_prefix("\r\n").or_else(|| rest.strip_prefix(['\r', '\n'])).unwrap_or(rest);
        if fields.iter().any(|field| !field.is_empty()) && !fields[0].starts_with('#') {
            records.push(Record { line, fields, raw });
        }
        let read = &from[..from.len() - rest.len()];
        line += (read.matches('\n').count() + read.matches('\r').count() - read.matches("\r\n").count()) as u64;
    }
    records
}

/// The field at the beginning of `text`, and the rest of the text: it begins with a separator or a line end, or is empty.
fn field(text: &str, separator: char) -> (String, &str) {
    let blank = |c: char| c != separator && " \t".contains(c);
    if let Some(quoted) = text.trim_start_matches(blank).strip_prefix('"') {
        let mut from = 0;
        while let Some(quote) = quoted[from..].find('"').map(|at| from + at) {
            let after = &quoted[quote + 1..];
            if after.starts_with('"') {
                from = quote + 2; // an escaped quote
                continue;
            }
            let after = after.trim_start_matches(blank);
            if after.is_empty() || after.starts_with([separator, '\r', '\n']) {
                return (quoted[..quote].replace("\"\"", "\"").trim().to_owned(), after);
            }
            break;
        }
    }
    let end = text.find([separator, '\r', '\n']).unwrap_or(text.len());
    (text[..end].trim().to_owned(), &text[end..])
}

/// The separator of a text: the first of semicolon, tab and comma that half of its lines contain, otherwise blanks.
/// Commas in numbers separated by blanks are decimal commas.
pub(super) fn separator(text: &str) -> char {
    let data = text.split(['\r', '\n']).map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let lines: Vec<&str> = data.collect();
    // every other piece is quoted
    let outside = |line: &str, mark: char| line.split('"').step_by(2).any(|piece| piece.contains(mark));
    let mark = [';', '\t', ','].into_iter().find(|&mark| half(&lines, &|line| outside(line, mark))).unwrap_or(' ');
    let with_comma: Vec<&str> = lines.into_iter().filter(|line| line.contains(',')).collect();
    let decimal = |line: &str| {
        let words = || line.split_whitespace().map(|word| word.trim_matches('"'));
        words().count() > 1 && words().all(|word| !word.contains(',') || plain(word))
    };
    if mark == ',' && half(&with_comma, &decimal) { ' ' } else { mark }
}

/// Whether at least half of the lines, and at least one, fit.
fn half(lines: &[&str], fits: &dyn Fn(&str) -> bool) -> bool {
    !lines.is_empty() && 2 * lines.iter().filter(|line| fits(line)).count() >= lines.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_split_into_fields() {
        let rows = |text: &str, separator| -> Vec<(u64, Vec<String>)> {
            records(text, separator).into_iter().map(|record| (record.line, record.fields)).collect()
        };
        let row = |line, fields: &[&str]| (line, fields.iter().map(|&field| field.to_owned()).collect::<Vec<_>>());
        assert_eq!(
            rows("# a, \"b\r\n\r\n 1 , 2\r\n\"x, \"\"y\"\"\" ,\r\r3,\"4\n5\"\n,,\n6", ','),
            [row(3, &["1", "2"]), row(4, &["x, \"y\"", ""]), row(6, &["3", "4\n5"]), row(9, &["6"])]
        );
        assert_eq!(rows("  1   \t2 \n 3 4", ' '), [row(1, &["1", "2"]), row(2, &["3", "4"])]);
        // quotes that enclose no field
        assert_eq!(
            rows("1,\"2\n3,G\"H\n\"4\"5,6\n", ','),
            [row(1, &["1", "\"2"]), row(2, &["3", "G\"H"]), row(3, &["\"4\"5", "6"])]
        );
    }

    #[test]
    fn separators_are_found() {
        for (text, mark) in [
            ("t;J\n1,5;2,5\n", ';'),
            ("t, s\tJ\n1,5\t2,5\n2,5\t3\n", '\t'),
            ("# a;b\nt,J\n1,2\n", ','),
            ("1, 2\n2, 3\n", ','),
            ("1,5 2,5\n2 3,5\n", ' '),
            ("t J\n1,5 a\n2 b\n", ' '),
            ("1 2\n3 4\n", ' '),
            ("\"a;b\",\"c;d\"\n", ','),
            ("", ' '),
        ] {
            assert_eq!(separator(text), mark, "{text:?}");
        }
    }
}
