//! Do the folders of the crate depend on each other in one direction only?

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules at the top of `src`: each may use the modules above it, none below it. docs/maintainers/design.md describes them.
const ORDER: &str = "\
    values axis extent guide linalg dense quadrature numeric rounded sum error traced ascending attraction file input \
    grid memory parallel fft geometry motion kernel load rheology adhesion hereditary solver analytic equilibrium \
    fields elastic observe contact sliding run friction states study laws output plot";

pub fn files(folder: &Path, found: &mut Vec<PathBuf>) {
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
pub fn code(path: &Path) -> String {
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

/// The names that a `use` brings: their paths, and what they are called here.
fn expand(tree: &str, prefix: &[String], found: &mut Vec<(Vec<String>, String)>) {
    let (path, list) = tree.split_once('{').unwrap_or((tree, ""));
    let (path, alias) = path.split_once(" as ").map_or((path, None), |(path, alias)| (path, Some(alias.trim())));
    let mut own = prefix.to_vec();
    own.extend(path.split("::").map(str::trim).filter(|part| !part.is_empty() && *part != "self").map(String::from));
    if list.is_empty() {
        let name = alias.unwrap_or(own.last().map_or("", String::as_str)).to_owned();
        return found.push((own, name));
    }
    let (mut depth, mut start) = (0, 0);
    for (at, c) in list.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if depth < 0 || depth == 0 && c == ',' {
            if !list[start..at].trim().is_empty() {
                expand(list[start..at].trim(), &own, found);
            }
            start = at + 1;
        }
    }
}

/// The modules of a crate by their paths, and which file each names in its `use` lines, followed through `pub use`.
#[derive(Default)]
struct Modules {
    files: BTreeMap<Vec<String>, PathBuf>,
    exports: BTreeMap<(Vec<String>, String), Vec<String>>,
    uses: Vec<(Vec<String>, Vec<String>)>,
}

impl Modules {
    fn read(source: &Path) -> Modules {
        let (mut all, mut modules) = (Vec::new(), Modules::default());
        files(source, &mut all);
        for path in all {
            let inside = path.strip_prefix(source).unwrap().with_extension("");
            if inside.to_string_lossy().contains("tests") {
                continue;
            }
            let mut name: Vec<String> = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            name.retain(|part| part != "mod" && part != "lib");
            modules.files.insert(name, path);
        }
        for (module, path) in &modules.files {
            let code = code(path);
            for statement in code.split(';') {
                let (before, tree) = match statement.rfind("use ") {
                    Some(at) => (&statement[..at], &statement[at + 4..]),
                    None => continue,
                };
                let line = before.rsplit('\n').next().unwrap_or_default().trim();
                if !line.is_empty() && !line.starts_with("pub") {
                    continue;
                }
                let mut names = Vec::new();
                expand(tree, &[], &mut names);
                for (path, name) in names {
                    let Some(path) = modules.absolute(module, path) else { continue };
                    if line.starts_with("pub") {
                        modules.exports.insert((module.clone(), name), path);
                    } else {
                        modules.uses.push((module.clone(), path));
                    }
                }
            }
        }
        modules
    }

    fn absolute(&self, module: &[String], path: Vec<String>) -> Option<Vec<String>> {
        let ups = path.iter().take_while(|part| *part == "super").count();
        let from = |here: &[String], rest: &[String]| Some([here, rest].concat());
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "super" => from(&module[..module.len().checked_sub(ups)?], &path[ups..]),
            first => {
                let child = [module, &[first.to_owned()]].concat();
                if self.files.contains_key(&child) { from(module, &path) } else { None }
            }
        }
    }

    /// The module that holds what a path names.
    fn owner(&self, path: &[String], depth: usize) -> Option<&Vec<String>> {
        let known = (0..=path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        let shown = path.get(known).and_then(|name| self.exports.get(&(path[..known].to_vec(), name.clone())));
        match shown.filter(|_| depth < 8) {
            Some(shown) => self.owner(&[shown, &path[known + 1..]].concat(), depth + 1),
            None => self.files.get_key_value(&path[..known]).map(|(module, _)| module),
        }
    }

    /// Files that lead back to themselves; a child may take from the modules that hold it.
    fn circular(&self) -> (usize, BTreeSet<String>) {
        let mut edges: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> = BTreeMap::new();
        for (user, path) in &self.uses {
            let owner = self.owner(path, 0);
            let holds = |owner: &Vec<String>| {
                user.starts_with(owner) && (owner.is_empty() || self.files[owner].ends_with("mod.rs"))
            };
            if let Some(owner) = owner.filter(|&owner| owner != user && !holds(owner)) {
                edges.entry(user).or_default().insert(owner);
            }
        }
        let comes_back = |start: &Vec<String>| {
            let (mut seen, mut next) = (BTreeSet::new(), vec![start]);
            while let Some(module) = next.pop() {
                next.extend(edges.get(module).into_iter().flatten().filter(|used| seen.insert(**used)));
            }
            seen.contains(start)
        };
        let circular = edges.keys().filter(|module| comes_back(module)).map(|module| module.join("/"));
        (edges.values().map(BTreeSet::len).sum(), circular.collect())
    }
}

/// No file uses another one that uses it in turn, at whatever distance.
#[test]
fn files_do_not_use_each_other_in_a_circle() {
    for (source, least) in [("../src", 900), ("../identify/src", 80)] {
        let (arrows, circular) = Modules::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(source)).circular();
        assert!(arrows > least && circular.is_empty(), "{source}: {arrows} uses, {circular:?}");
    }
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
