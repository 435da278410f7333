//! The documents beside the code: links lead somewhere, pictures are shown, commands name what there is.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The Markdown files of the repository, with their text.
fn documents() -> Vec<(PathBuf, String)> {
    let markdown = |folder: PathBuf| {
        let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        files.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect::<Vec<_>>()
    };
    let files = [markdown(root().to_path_buf()), markdown(root().join("docs"))].concat();
    assert!(files.len() >= 8, "{files:?}");
    files.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// What follows each `start` up to `end`.
fn between<'a>(text: &'a str, start: &'a str, end: char) -> impl Iterator<Item = &'a str> {
    text.split(start).skip(1).map(move |rest| rest.split(end).next().unwrap_or(rest))
}

#[test]
fn links_lead_somewhere() {
    let (mut broken, mut shown) = (Vec::new(), BTreeSet::new());
    for (path, text) in documents() {
        for link in between(&text, "](", ')').filter(|link| !link.contains("://") && !link.starts_with('#')) {
            let target = path.parent().unwrap().join(link.split('#').next().unwrap());
            match target.canonicalize() {
                Ok(target) => _ = shown.insert(target),
                Err(_) => broken.push(format!("{}: {link}", path.display())),
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
    // the package comes without pictures
    let Ok(pictures) = fs::read_dir(root().join("docs/pictures")) else { return };
    let unused: Vec<PathBuf> = pictures
        .map(|entry| entry.unwrap().path().canonicalize().unwrap())
        .filter(|path| !shown.contains(path))
        .collect();
    assert!(unused.is_empty(), "no document shows {unused:?}");
}

/// `--example`, `--test` and `--bench` name what there is, and what is a file in backquotes is there.
#[test]
fn commands_and_files_exist() {
    let mut missing = Vec::new();
    for (path, text) in documents() {
        for (option, folder) in [("--example ", "examples"), ("--test ", "tests"), ("--bench ", "benches")] {
            for rest in between(&text, option, '\n') {
                let name: String = rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
                let [file, with_parts] =
                    [format!("{name}.rs"), format!("{name}/main.rs")].map(|f| root().join(folder).join(f));
                if !name.is_empty() && !file.exists() && !with_parts.exists() {
                    missing.push(format!("{}: {option}{name}", path.display()));
                }
            }
        }
        for word in text.split('`').skip(1).step_by(2) {
            let is_file =
                ["src/", "tests/", "docs/", "examples/", "benches/"].iter().any(|start| word.starts_with(start));
            if is_file && !word.contains(' ') && !root().join(word).exists() {
                missing.push(format!("{}: {word}", path.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Every example has its place in the gallery and the README.
#[test]
fn examples_are_shown() {
    let examples = fs::read_dir(root().join("examples")).unwrap().map(|entry| entry.unwrap().path());
    let names = examples.filter(|path| path.extension().is_some_and(|e| e == "rs") || path.join("main.rs").exists());
    let names: Vec<String> = names.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    assert!(names.len() >= 14, "{names:?}");
    for document in ["README.md", "docs/gallery.md"] {
        let text = fs::read_to_string(root().join(document)).unwrap();
        for name in &names {
            assert!(text.contains(name.as_str()), "{document} does not name {name}");
        }
    }
}
