//! docs/paper.md beside the code: every source, test and picture that it lists exists, and every equation and figure of the source paper has
//! its line. Items are links, which rustdoc resolves.

use std::fs;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn page() -> String {
    fs::read_to_string(root().join("docs/paper.md")).unwrap()
}

/// A line of a table that has a column of sources.
struct Line {
    name: String,
    sources: Vec<String>,
    tests: Vec<String>,
    pictures: Vec<String>,
}

/// What is in backquotes.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn lines(page: &str) -> Vec<Line> {
    let (mut lines, mut header) = (Vec::new(), Vec::new());
    for line in page.lines() {
        let Some(row) = line.strip_prefix('|') else {
            header.clear();
            continue;
        };
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        if header.is_empty() {
            header = cells;
        } else if !cells[0].starts_with("---") && header.contains(&"source") {
            let of = |column: &str| header.iter().position(|name| *name == column).map_or("", |at| cells[at]);
            let [sources, tests, pictures] = ["source", "test", "picture"].map(|column| quoted(of(column)));
            lines.push(Line { name: cells[0].to_owned(), sources, tests, pictures });
        }
    }
    lines
}

/// Whether a test of the library, given as arguments of `cargo test`, exists; `documents` looks for the tests of the suite.
fn exists(arguments: &str) -> bool {
    let Some(path) = arguments.strip_prefix("--lib ") else { return arguments.starts_with("--test ") };
    let Some((modules, function)) = path.rsplit_once("::") else { return false };
    let module = modules.strip_suffix("::tests").unwrap_or(modules).replace("::", "/");
    let files = ["", "/mod"].map(|part| root().join(format!("src/{module}{part}.rs")));
    let is_test = format!("#[test]\nfn {function}(");
    let text = files.iter().find_map(|file| fs::read_to_string(file).ok()).unwrap_or_default();
    text.replace("    ", "").contains(&is_test)
}

#[test]
fn every_equation_and_figure_has_its_line() {
    let page = page();
    let lines = lines(&page);
    let numbered = |kind: &str, last: usize| (1..=last).map(|n| format!("{kind} {n}")).collect::<Vec<_>>();
    for name in [numbered("Eq.", 12), numbered("Fig.", 6), numbered("Table", 1)].concat() {
        let line = lines.iter().find(|line| line.name == name).unwrap_or_else(|| panic!("no line of {name}"));
        assert!(!line.sources.is_empty() && !line.tests.is_empty(), "{name}");
    }
    for reference in (1..=16).map(|number| format!("\\[{number}\\]")) {
        assert!(lines.iter().any(|line| line.name == reference), "{reference}");
    }
}

#[test]
fn sources_tests_and_pictures_of_the_page_exist() {
    let mut missing = Vec::new();
    for Line { name, sources, tests, pictures } in lines(&page()) {
        for source in sources {
            let text = fs::read_to_string(root().join(&source)).unwrap_or_default();
            // the source of an equation names its number
            let numbered = !name.starts_with("Eq.")
                || text
                    .match_indices(&name)
                    .any(|(at, _)| !text[at + name.len()..].starts_with(|c: char| c.is_ascii_digit()));
            if text.is_empty() || !numbered {
                missing.push(format!("{name}: {source}"));
            }
        }
        missing.extend(tests.into_iter().filter(|test| !exists(test)));
        // the package comes without pictures
        let folder = root().join("docs/pictures");
        missing.extend(pictures.iter().filter(|file| folder.exists() && !folder.join(file).exists()).cloned());
    }
    assert!(missing.is_empty(), "{missing:#?}");
}
