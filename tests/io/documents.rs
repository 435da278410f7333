//! The documents beside the code: links lead somewhere, pictures are shown, commands name what there is, formulas are
//! text.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The Markdown files of the repository, with their text.
fn documents() -> Vec<(PathBuf, String)> {
    let files = files_of(root(), "md");
    assert!(files.len() >= 12, "{files:?}");
    files.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The files under a folder with an extension, without what was built or written there.
fn files_of(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let entries = entries.filter(|path| !["target", "out", ".git"].iter().any(|name| path.ends_with(name)));
    let files = entries.flat_map(|path| if path.is_dir() { files_of(&path, extension) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|found| found == extension)).collect()
}

/// The anchors of a page: its headings in lower case, hyphens for blanks, without punctuation, as forges make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter_map(|line| line.strip_prefix('#')?.trim_start_matches('#').strip_prefix(' '));
    let kept = |c: &char| c.is_alphanumeric() || "-_ ".contains(*c);
    headings.map(|heading| heading.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
}

/// What follows each `start` up to `end`.
fn between<'a>(text: &'a str, start: &'a str, end: char) -> impl Iterator<Item = &'a str> {
    text.split(start).skip(1).map(move |rest| rest.split(end).next().unwrap_or(rest))
}

#[test]
fn links_lead_somewhere() {
    let (mut broken, mut shown) = (Vec::new(), BTreeSet::new());
    for (path, text) in documents() {
        for link in between(&text, "](", ')').filter(|link| !link.contains("://") && !link.starts_with("mailto:")) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let there = || anchor.is_empty() || anchors(&fs::read_to_string(&target).unwrap()).contains(anchor);
            match target.canonicalize() {
                Ok(target) if there() => _ = shown.insert(target),
                _ => broken.push(format!("{}: {link}", path.display())),
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

/// What `--example`, `--test`, `--bench` and `--bin` name, and where it is found.
const OPTIONS: [(&str, &str); 4] =
    [("--example ", "examples"), ("--test ", "tests"), ("--bench ", "benches"), ("--bin ", "examples/coupling")];

/// The name at the start of what follows an option.
fn name_in(rest: &str) -> &str {
    rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or("")
}

/// The source file of an example, test, bench or program.
fn source_of(folder: &str, name: &str) -> Option<PathBuf> {
    let files = [format!("{name}.rs"), format!("{name}/main.rs")].map(|file| root().join(folder).join(file));
    files.into_iter().find(|file| file.exists())
}

/// The features that an example requires, by the manifest.
fn features_of(example: &str) -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let entry = format!("[[example]]\nname = \"{example}\"\nrequired-features = [");
    let list = manifest.split_once(&entry).map_or("", |(_, rest)| rest.split(']').next().unwrap());
    list.split('"').skip(1).step_by(2).map(String::from).collect()
}

/// What programs name, and the feature that it needs.
const ROOMS: [(&str, &[&str]); 17] = [
    ("adhesion", &["adhesion::", ".attraction("]),
    ("analytic", &["analytic::"]),
    ("checkpoint", &[".save(", "autosave_to", "resume("]),
    ("contacts", &["impl Contact for"]),
    ("data", &["Measurements", "MasterCurve", "library::"]),
    ("energies", &["EnergyBalance"]),
    ("laws", &["laws::"]),
    ("layers", &["Layer::"]),
    ("motion", &["step_along", "step_over", "set_geometr", "Travel::"]),
    ("observe", &[".profile(", ".patches(", "stiffness_over_modulus", "mesh_error("]),
    ("output", &["CsvHistory", "FrameSeries", "output::"]),
    ("plot", &["plot::"]),
    ("sliding", &["build_sliding", "SlidingSweep"]),
    ("states", &["ElasticStates", "StatesContact", "Sweep::new", "fields_to"]),
    ("study", &["Study::"]),
    ("surfaces", &["HeightMap", "Rough::", "RoughSpec"]),
    ("temperature", &["TimeTemperature", "TemperatureHistory"]),
];

/// Every page of the guides names the features of its programs, as the README does.
#[test]
fn pages_name_the_features_of_their_programs() {
    let (mut missing, mut found) = (Vec::new(), 0);
    let guides = files_of(&root().join("docs/guide"), "md");
    for path in guides.into_iter().chain([root().join("README.md")]) {
        let text = fs::read_to_string(&path).unwrap();
        let programs: Vec<&str> = text.split("```").skip(1).step_by(2).collect();
        for (feature, names) in ROOMS {
            // pictures and tables are saved, too
            let uses = |program: &str| {
                names.iter().any(|name| program.contains(name))
                    && (feature != "checkpoint" || program.contains("resume"))
            };
            if programs.iter().any(|program| uses(program)) {
                found += 1;
                if !text.contains(&format!("`{feature}`")) {
                    missing.push(format!("{}: {feature}", path.display()));
                }
            }
        }
    }
    assert!(missing.is_empty() && found > 15, "{found} {missing:#?}");
}

/// Options name what there is, manifests and files in backquotes are there, and commands ask for the features of their example.
#[test]
fn commands_and_files_exist() {
    let mut missing = Vec::new();
    let examples =
        sources(&root().join("examples")).into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap()));
    for (path, text) in documents().into_iter().chain(examples) {
        for (option, folder) in OPTIONS {
            for name in between(&text, option, '\n').map(name_in).filter(|name| !name.is_empty()) {
                // crates of their own have examples, too
                let is_there = |folder: &str| source_of(folder, name).is_some();
                let of_other =
                    option == "--example " && ["identify/examples", "mpi/examples"].into_iter().any(is_there);
                if !is_there(folder) && !of_other {
                    missing.push(format!("{}: {option}{name}", path.display()));
                }
            }
        }
        for command in between(&text, "cargo run ", '\n') {
            let Some((options, rest)) = command.split_once("--example ") else { continue };
            let asked: Vec<&str> =
                options.split_once("--features ").map_or("", |(_, features)| features.trim()).split(',').collect();
            let needed = features_of(name_in(rest)).into_iter().filter(|_| !asked.contains(&"full"));
            missing.extend(
                needed
                    .filter(|feature| !asked.contains(&&**feature))
                    .map(|feature| format!("{}: {feature} in {command}", path.display())),
            );
        }
        for manifest in between(&text, "--manifest-path ", '\n') {
            let manifest = manifest.split([' ', '`']).next().unwrap_or(manifest);
            if !root().join(manifest).exists() {
                missing.push(format!("{}: {manifest}", path.display()));
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

/// Every filter of `cargo test --test suite`, in documents, comments of tests and the workflow, is part of the name of a
/// test that there is.
#[test]
fn tests_that_are_named_exist() {
    let list = Command::new(std::env::current_exe().unwrap()).args(["--list", "--format", "terse"]).output().unwrap();
    let list = String::from_utf8(list.stdout).unwrap();
    let names: Vec<&str> = list.lines().filter_map(|line| line.strip_suffix(": test")).collect();
    assert!(names.contains(&"io::documents::tests_that_are_named_exist"), "{list}");
    let (mut missing, mut found) = (Vec::new(), 0);
    let comments = sources(&root().join("tests")).into_iter().filter(|path| !path.ends_with("documents.rs"));
    let comments = comments.chain([root().join(".github/workflows/ci.yml")]);
    let comments = comments.map(|path| (path.clone(), fs::read_to_string(path).unwrap()));
    for (path, text) in documents().into_iter().chain(comments) {
        let commands = between(&text, "--test suite ", '\n').map(|rest| rest.split(['`', ';']).next().unwrap_or(rest));
        for name in commands.flat_map(|rest| rest.split(' ').filter(|word| !word.is_empty() && !word.starts_with('-')))
        {
            found += 1;
            if !names.iter().any(|test| test.contains(name)) {
                missing.push(format!("{}: {name}", path.display()));
            }
        }
    }
    assert!(missing.is_empty() && found > 20, "{found} {missing:#?}");
}

/// Figures between marks are written by programs: each mark ends, has a program that names it, and begins no line, which would
/// not be text of the line any more.
#[test]
fn figures_have_their_programs() {
    let programs = [sources(&root().join("tests")), sources(&root().join("examples"))].concat();
    let programs: String = programs.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let page_of_the_crate = root().join("src/lib.rs");
    let text_of_the_crate = fs::read_to_string(&page_of_the_crate).unwrap();
    let (mut wrong, mut found) = (Vec::new(), 0);
    for (path, text) in documents().into_iter().chain([(page_of_the_crate, text_of_the_crate)]) {
        for part in text.split("<!-- figures ").skip(1) {
            let (name, after) = part.split_once(" -->").unwrap();
            found += 1;
            if name == "NAME" {
                continue; // how marks are written
            }
            if !after.contains("<!-- end -->") || !programs.contains(&format!("(\"{name}\", ")) {
                wrong.push(format!("{}: {name}", path.display()));
            }
        }
        let lines = text.lines().map(|line| line.trim_start_matches("//! "));
        wrong.extend(
            lines.filter(|line| line.starts_with("<!-- figures ") && line.contains("end -->")).map(str::to_owned),
        );
    }
    assert!(wrong.is_empty() && found > 20, "{found} {wrong:#?}");
}

/// Every example has its place in the gallery and the README, packages of their own included.
#[test]
fn examples_are_shown() {
    let folders = ["examples", "examples/coupling"].map(|folder| fs::read_dir(root().join(folder)).unwrap());
    let examples = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
    let is_example = |path: &PathBuf| {
        let parts = ["main.rs", "src/main.rs"].iter().any(|main| path.join(main).exists());
        parts || path.extension().is_some_and(|e| e == "rs")
    };
    let names = examples.filter(is_example);
    let names: Vec<String> = names.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    assert!(names.len() >= 20, "{names:?}");
    let gallery = fs::read_to_string(root().join("docs/gallery.md")).unwrap();
    for name in &names {
        assert!(gallery.contains(name.as_str()), "docs/gallery.md does not name {name}");
    }
}

/// The first program of the README is the example `quickstart`, and no program shows lines that only tests should see.
#[test]
fn programs_of_the_readme_are_complete() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let quickstart = fs::read_to_string(root().join("examples/quickstart.rs")).unwrap();
    let program = quickstart.lines().filter(|line| !line.starts_with("//!")).collect::<Vec<_>>().join("\n");
    assert!(readme.contains(program.trim()), "the README does not show examples/quickstart.rs");
    for (path, text) in documents() {
        let programs = text.split("```rust\n").skip(1).filter_map(|rest| rest.split("```").next());
        for line in programs.flat_map(str::lines) {
            assert!(line != "#" && !line.starts_with("# "), "{}: {line}", path.display());
        }
    }
}

/// The Rust files under a folder, without what was built there.
fn sources(folder: &Path) -> Vec<PathBuf> {
    files_of(folder, "rs")
}

/// TeX needs a script, and Markdown removes backslashes: formulas are plain text, which every viewer shows right.
#[test]
fn formulas_need_no_script() {
    let comments = |path: PathBuf| {
        let text = fs::read_to_string(&path).unwrap();
        let lines = text.lines().map(str::trim_start);
        let docs: Vec<&str> = lines.filter_map(|l| l.strip_prefix("///").or(l.strip_prefix("//!"))).collect();
        (path, docs.join("\n"))
    };
    let mut tex = Vec::new();
    for (path, text) in documents().into_iter().chain(sources(&root().join("src")).into_iter().map(comments)) {
        let mut code = false;
        for line in text.lines() {
            code ^= line.trim_start().starts_with("```");
            let prose: String = line.split('`').step_by(2).collect();
            // `\[` and `\|` are brackets and bars
            let command =
                |at: usize| prose[at + 1..].starts_with(|c: char| c.is_ascii_alphabetic() || ",;:! ".contains(c));
            let commands = || prose.match_indices('\\').any(|(at, _)| command(at));
            if !code && (prose.contains('$') || prose.contains("<script") || commands()) {
                tex.push(format!("{}: {line}", path.display()));
            }
        }
    }
    assert!(tex.is_empty(), "{tex:#?}");
    assert!(!fs::read_to_string(root().join("Cargo.toml")).unwrap().contains("html-in-header"));
}
