//! Do the folders of the crate depend on each other in one direction only?

use std::fs;
use std::path::{Path, PathBuf};

/// The modules at the top of `src`: each may use the modules above it, none below it. docs/design.md describes them.
const ORDER: &str = "\
    values axis extent guide linalg quadrature rounded sum error events ascending file input grid \
    memory parallel fft geometry motion kernel load rheology adhesion hereditary solver analytic observe \
    contact run states laws output plan plot";

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// The code of a file without comments and items of tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let mut code = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line == "#[cfg(test)]" {
            // the item ends with its brace, or on its only line
            let declaration = lines.next().unwrap_or_default();
            if !declaration.ends_with(';') {
                lines.by_ref().take_while(|line| *line != "}").for_each(drop);
            }
        } else {
            code += line.split("//").next().unwrap_or_default();
            code.push('\n');
        }
    }
    code
}

/// Names that follow `crate::`, alone or in braces.
fn names(code: &str) -> Vec<String> {
    let word = |text: &str| text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = Vec::new();
    for after in code.split("crate::").skip(1) {
        match after.strip_prefix('{') {
            Some(list) => names.extend(list.split('}').next().unwrap_or_default().split(',').map(word)),
            None => names.push(word(after)),
        }
    }
    names
}

#[test]
fn modules_use_only_those_above_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let library = fs::read_to_string(source.join("lib.rs")).unwrap();
    let modules: Vec<&str> = library
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod ")?.strip_suffix(';'))
        .collect();
    let order: Vec<&str> = ORDER.split(' ').collect();
    assert!(modules.iter().all(|module| order.contains(module)), "a module is missing in the order: {modules:?}");
    // what the crate shows at its root belongs to a module, too
    let owner = |name: &str| -> Option<usize> {
        let shown = library
            .lines()
            .filter_map(|line| line.strip_prefix("pub use "))
            .find(|shown| shown.split(|c: char| !c.is_alphanumeric()).any(|word| word == name));
        let module = shown.map_or(name, |shown| shown.split("::").next().unwrap_or(name));
        order.iter().position(|own| *own == module)
    };
    let mut all = Vec::new();
    files(&source, &mut all);
    assert!(all.len() > 250);
    let (mut wrong, mut arrows) = (Vec::new(), 0);
    for path in &all {
        let inside = path.strip_prefix(&source).unwrap();
        if inside == Path::new("lib.rs") || inside.to_string_lossy().contains("tests") {
            continue;
        }
        let module = inside.iter().next().unwrap().to_string_lossy().trim_end_matches(".rs").to_owned();
        let own = order.iter().position(|name| *name == module).unwrap_or_else(|| panic!("{module} is no module"));
        for name in names(&code(path)).into_iter().filter(|name| !name.is_empty()) {
            let Some(used) = owner(&name) else { continue };
            arrows += usize::from(used != own);
            if used > own {
                wrong.push(format!("{} uses {name}", inside.display()));
            }
        }
    }
    assert!(arrows > 450, "only {arrows} uses were found");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A program that is built to abort where it panics survives the loss of a rank: nothing in the crate is decided by unwinding.
#[test]
fn nothing_unwinds() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let mut all = Vec::new();
    files(&source, &mut all);
    let unwinds = |path: &PathBuf| {
        // threads pass a panic of their job on to their caller
        let passes_on = path.ends_with("parallel/threads.rs");
        let code = code(path);
        let words: &[&str] =
            if passes_on { &["catch_unwind", "panic_any"] } else { &["catch_unwind", "panic_any", "resume_unwind"] };
        words.iter().any(|word| code.contains(word))
    };
    all.retain(|path| unwinds(path) && !path.to_string_lossy().contains("tests"));
    assert!(all.is_empty(), "{all:?}");
}
