//! Figures of the documents, written and compared by the programs that measure them.
//!
//! A document has a figure between `<!-- figures NAME -->` and `<!-- end -->`: a word in a line, or a table. The program that
//! measures NAME compares it if the environment has `FIGURES=check`, and writes it if `FIGURES=write`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A figure: its name, and its text in the documents.
pub type Outcome = Result<(), String>;

/// Compares or writes the whole of a figure. A decimal may differ by one in its last place or by 1e-6;
/// counts and words are compared exactly.
pub fn figure(name: &str, text: &str) -> Outcome {
    update(name, text, true, |_| text.to_owned())
}

/// As [`figure`], for one row of a table that several tests fill: the row that begins with `key`.
pub fn row(name: &str, key: &str, rest: &str) -> Outcome {
    update(name, key, true, |table| with_row(table, key, rest))
}

/// As [`figure`], for the lines of `page` that begin with `key`; the others stay.
pub fn lines(name: &str, page: &str, key: &str) -> Outcome {
    update(name, page, true, |old| {
        let mut fresh = page.lines().filter(|line| line.starts_with(key));
        let merged =
            old.lines().map(|line| if line.starts_with(key) { fresh.next().unwrap_or_default() } else { line });
        merged.collect::<Vec<_>>().join("\n")
    })
}

/// As [`figure`], for times and what else differs between machines: written, never compared.
pub fn timed(name: &str, text: &str) -> Outcome {
    update(name, text, false, |_| text.to_owned())
}

fn with_row(table: &str, key: &str, rest: &str) -> String {
    let row = format!("{key} {rest}");
    let mut rows: Vec<&str> = table.lines().collect();
    match rows.iter().position(|line| line.starts_with(key)) {
        Some(at) => rows[at] = &row,
        None => rows.push(&row),
    }
    rows.join("\n")
}

/// One test at a time reads and writes the documents.
static DOCUMENTS: Mutex<()> = Mutex::new(());

fn update(name: &str, what: &str, comparable: bool, new: impl Fn(&str) -> String) -> Outcome {
    let writes = match std::env::var("FIGURES").as_deref() {
        Ok("write") => true,
        Ok("check") if comparable => false,
        _ => return Ok(()),
    };
    let _alone = DOCUMENTS.lock().map_err(|error| error.to_string())?;
    let begin = format!("<!-- figures {name} -->");
    let mut found = false;
    for path in documents()? {
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut parts = text.split(&begin);
        let mut written = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            found = true;
            let (old, after) =
                part.split_once("<!-- end -->").ok_or(format!("{}: {name} has no end", path.display()))?;
            let text = new(old.trim());
            if !writes && !agree(old.trim(), text.trim()) {
                let place = path.display();
                return Err(format!("{place}: {name} is\n{}\nmeasured:\n{text}\nFIGURES=write writes it", old.trim()));
            }
            let space = &old[..old.len() - old.trim_start().len()];
            let end = &old[old.trim_end().len()..];
            written += &format!("{begin}{space}{}{end}<!-- end -->{after}", text.trim());
        }
        if writes && written != text {
            fs::write(&path, written).map_err(|error| format!("{}: {error}", path.display()))?;
        }
    }
    if found { Ok(()) } else { Err(format!("no document has figures {name}: {what}")) }
}

/// The pages of the repository, and the page of the crate.
fn documents() -> Result<Vec<PathBuf>, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.ancestors().find(|folder| folder.join("docs/accuracy.md").is_file()).ok_or("no documents")?;
    let mut files = vec![root.join("src/lib.rs")];
    for folder in [".", "docs", "docs/guide", "docs/maintainers"] {
        for entry in fs::read_dir(root.join(folder)).map_err(|error| error.to_string())? {
            let path = entry.map_err(|error| error.to_string())?.path();
            files.extend(path.extension().is_some_and(|ending| ending == "md").then_some(path));
        }
    }
    Ok(files)
}

/// Whether two texts agree but for the last place of decimals, 1e-6 of them, and for numbers that are rounding alone.
fn agree(one: &str, other: &str) -> bool {
    let (one, other) = (words(one), words(other));
    let alike = |(a, b): (&String, &String)| {
        a == b
            || decimal(a).zip(decimal(b)).is_some_and(|((x, place), (y, other))| {
                let greatest = x.abs().max(y.abs());
                (x - y).abs() <= (1.01 * place.max(other)).max(1e-6 * greatest) || greatest < 1e-11
            })
    };
    one.len() == other.len() && one.iter().zip(&other).all(alike)
}

/// Numbers, and what stands between them.
fn words(text: &str) -> Vec<String> {
    let text: Vec<char> = text.chars().collect();
    let is_digit = |at: usize| text.get(at).is_some_and(char::is_ascii_digit);
    let (mut words, mut at) = (vec![String::new()], 0);
    while at < text.len() {
        let start = at;
        if is_digit(at) {
            while is_digit(at) || text.get(at) == Some(&'.') && is_digit(at + 1) {
                at += 1;
            }
            if text.get(at) == Some(&'e') && (is_digit(at + 1) || text.get(at + 1) == Some(&'-') && is_digit(at + 2)) {
                at += 2;
                while is_digit(at) {
                    at += 1;
                }
            }
            words.push(text[start..at].iter().collect());
            words.push(String::new());
        } else {
            if let Some(word) = words.last_mut().filter(|_| !text[at].is_whitespace()) {
                word.push(text[at]);
            }
            at += 1;
        }
    }
    words
}

/// A number with a point or an exponent, and its last place; `None` for counts and words.
fn decimal(word: &str) -> Option<(f64, f64)> {
    let value = word.parse::<f64>().ok().filter(|_| word.contains(['.', 'e']))?;
    let (digits, exponent) = word.split_once('e').unwrap_or((word, "0"));
    let places = digits.split_once('.').map_or(0, |(_, after)| after.len() as i32);
    Some((value, 10_f64.powi(exponent.parse::<i32>().ok()? - places)))
}
