//! docs/paper.md beside the code: every item, source, test and picture that it lists exists, and every equation and figure of
//! the source paper has its line.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use viscocontact::ViscoelasticContact;
use viscocontact::geometry::Geometry;
use viscocontact::load::Load;
use viscocontact::rheology::Rheology;

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

/// What the text between the tables has in backquotes: files, links to items, and commands, whose names
/// `commands_and_files_exist` checks.
#[test]
fn files_named_in_the_text_exist() {
    let (mut missing, mut code) = (Vec::new(), false);
    let page = page();
    for line in page.lines().filter(|line| !line.starts_with('|')) {
        code ^= line.starts_with("```");
        let names = if code { Vec::new() } else { quoted(line) };
        for name in names.iter().filter(|name| !name.contains("::") && !name.starts_with("cargo ") && !name.is_empty())
        {
            let pictures = root().join("docs/pictures");
            let found = [root().join(name), pictures.join(name)].iter().any(|path| path.exists());
            // the package comes without pictures
            if !found && (pictures.exists() || !name.ends_with("pictures") && !name.ends_with(".png")) {
                missing.push(format!("{name} in: {line}"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Names of items that the compiler resolves: what can be imported, and functions of types.
macro_rules! items {
    (import $($($import:ident)::+),+; functions $($($function:ident)::+),+) => {{
        $(const _: () = {
            #[allow(unused_imports)]
            use viscocontact::$($import)::+ as _;
        };)+
        $(let _ = viscocontact::$($function)::+;)+
        [$(stringify!($($import)::+),)+ $(stringify!($($function)::+)),+].map(|item| item.replace(' ', ""))
    }};
}

/// Rustdoc links what stands in brackets; here the compiler is asked.
#[test]
fn items_of_the_page_exist() {
    let known = items!(
        import
            analytic::GrowingSphere, analytic::Hertz, analytic::RigidPunch, contact::Solver::ActiveSet,
            contact::Solver::PolonskyKeer, contact::TimeRule, contact::TimeRule::Exponential, contact::TimeRule::Rectangle,
            geometry::Geometry, load::Sinusoid, rheology::Material, rheology::Maxwell, rheology::RelaxationSpectrum, rheology::Zener, rheology::library::find;
        functions
            InfluenceKernel::coefficient, InfluenceKernel::convolve, InfluenceKernel::half_space,
            ViscoelasticContact::contact_area, ViscoelasticContact::contact_cells, ViscoelasticContact::displacement,
            ViscoelasticContact::force, ViscoelasticContact::gap_into, ViscoelasticContact::moment,
            ViscoelasticContact::pressure, ViscoelasticContact::tilt, analytic::GrowingSphere::pressure, analytic::GrowingSphere::step,
            contact::Builder::another_body,
            contact::Settings::paper, load::Load::eccentric_force, load::Load::force,
            rheology::Material::contact_compliance, states::ElasticStates::cone, states::ElasticStates::power,
            states::ElasticStates::sphere
    );
    let _ = (<dyn Geometry>::initial_gap, <dyn Rheology>::creep_compliance);
    // generic in the loads: named by a call
    let _ = |contact: &mut ViscoelasticContact| contact.step(0.0, Load::force(1.0));
    let steps = ["ViscoelasticContact::step"].map(str::to_owned);
    let of_traits = ["geometry::Geometry::initial_gap", "rheology::Rheology::creep_compliance"].map(str::to_owned);
    let _ = |hertz: viscocontact::analytic::Hertz| [hertz.contact_radius, hertz.max_pressure];
    let fields = ["analytic::Hertz::contact_radius", "analytic::Hertz::max_pressure"].map(str::to_owned);
    let known: BTreeSet<String> = known.into_iter().chain(steps).chain(of_traits).chain(fields).collect();
    let page = page();
    let listed = page.split("[`").skip(1).map(|rest| rest.split("`]").next().unwrap().to_owned());
    assert_eq!(listed.collect::<BTreeSet<_>>(), known);
}
