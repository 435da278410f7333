"""Halves and doubles the tuned numbers of a mechanism, and prints what that changes in a population of runs.

    python3 tests/tuned_numbers.py src/states adaptive_runs_on_states_err STATES=40

copies the repository to target/tuned, where each scalar f64 constant of the source is a function, and each number of a
struct of a mechanism a value, that the environment variable TUNED="src/states/control.rs:AIMS.aim=0.5" multiplies,
builds the suite once, and runs one of its tests with every number of the files that begin with the first argument
halved and doubled. What is printed are the lines of the test that differ. docs/maintainers/tuned_numbers.md has the
results.
"""

import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).parent.parent
TO = ROOT / "target" / "tuned"
CONSTANT = re.compile(r"^([ \t]*)(pub(?:\([^)]*\))?\s+)?const\s+([A-Z][A-Z0-9_]*)\s*:\s*f64\s*=\s*([^;]+);", re.M)
# numbers of a mechanism: a struct of them alone
GATHERED = re.compile(r"^(pub(?:\([^)]*\))?\s+)?const\s+([A-Z][A-Z0-9_]*)\s*:\s*([A-Z]\w*)\s*=\s*\3\s*\{([^{}]*)\};", re.M)
FIELD = re.compile(r"(\w+):\s*(\[[^\]]*\]|[^,\[\]]+)(?:,|$)")
# what is no expression: uses, comments, characters and texts
OTHER = re.compile(r"""^[ \t]*(?:pub(?:\([^)]*\))?\s+)?use\s+[^;]+;|//[^\n]*|'(?:[^'\\\n]|\\[^\n])'|r#"(?:[^"]|"(?!#))*"#|"(?:[^"\\]|\\[\s\S])*\"""", re.M)
CHOICE = """//! Numbers that an environment variable multiplies.

static CHOSEN: std::sync::LazyLock<Option<(String, f64)>> = std::sync::LazyLock::new(|| {
    let text = std::env::var("TUNED").ok()?;
    let (name, factor) = text.split_once('=')?;
    Some((name.to_owned(), factor.parse().ok()?))
});

pub(crate) fn number(name: &str, value: f64) -> f64 {
    match &*CHOSEN {
        Some((chosen, factor)) if chosen == name => value * factor,
        _ => value,
    }
}
"""


def unchangeable(texts):
    """Names in constants that are not scalars, in patterns and in texts: a function cannot stand there."""
    names = set()
    for text in texts.values():
        for kind, value in re.findall(r"(?:const|static)\s+[A-Z]\w*\s*:\s*([^=;]+(?:;[^=]+)?)=\s*((?:[^;]|;(?=[^\n]*\]))+);", text):
            if kind.strip() != "f64":
                names |= set(re.findall(r"\b[A-Z][A-Z0-9_]+\b", value))
        names |= set(re.findall(r"(?:=>|\|)\s*([A-Z][A-Z0-9_]+)\s*=>", text))
        names |= set(re.findall(r"const\s+([A-Z][A-Z0-9_]*)\s*:\s*f64;", text))
        names |= set(re.findall(r"\{([A-Z][A-Z0-9_]+)[:}]", text))
    return names


def constants(texts):
    """Of each file the names of its numbers."""
    fixed = unchangeable(texts)
    return {path: {found[3] for found in CONSTANT.finditer(text)} - fixed for path, text in texts.items()}


def of_other_kinds(texts):
    """Names of constants of any other type."""
    return {name for text in texts.values() for name in re.findall(r"\bconst\s+([A-Z][A-Z0-9_]*)\s*:(?!\s*f64\s*=)", text)}


def of_module(module, shown):
    """The numbers that a module shows."""
    return set().union(*(shown[path] for path in shown if path.endswith((f"/{module}.rs", f"/{module}/mod.rs"))))


def taken_by(text, shown, names):
    """The numbers that a file takes from others."""
    uses = re.findall(r"(\w+)::(?:\{([^{}]*)\}|([A-Z][A-Z0-9_]+)\b)", " ".join(re.findall(r"\buse\s+([^;]+);", text)))
    taken = [(module, name) for module, group, one in uses for name in re.findall(r"\b[A-Z][A-Z0-9_]+\b", group + one)]
    return {name for module, name in taken if name in names or name in of_module(module, shown)}


def with_functions(path, text, own, shown, names):
    """A file whose numbers, and those that it takes from others, are functions."""
    here = set(re.findall(r"\bconst\s+([A-Z][A-Z0-9_]*)\s*:", text))
    known = own | taken_by(text, shown, names) - (here - own)
    skip = [found.span() for found in OTHER.finditer(text)] + [found.span(3) for found in CONSTANT.finditer(text)]
    parts, last = [], 0
    for found in re.finditer(r"(?:(\w+)::)?\b([A-Z][A-Z0-9_]+)\b(?!\s*[(:]\s*[A-Z&\[(]|\()", text):
        module, name = found.groups()
        is_known = name in (known if module is None else own if module == "Self" else of_module(module, shown))
        if is_known and not any(a <= found.start(2) < b for a, b in skip):
            parts.append(text[last:found.end()] + "()")
            last = found.end()
    text = "".join(parts) + text[last:]

    def function(found):
        indent, visible, name, value = found.groups()
        if name not in own:
            return found[0]
        number = f'std::sync::LazyLock::new(|| crate::tuned::number("{path}:{name}", {value}))'
        body = f"static V: std::sync::LazyLock<f64> = {number}; *V"
        return f"{indent}#[allow(non_snake_case)]\n{indent}{visible or ''}fn {name}() -> f64 {{ {body} }}"

    return CONSTANT.sub(function, with_statics(path, text))


def fields(found):
    """Names and values of the numbers of a struct; none where it holds anything else."""
    pairs = FIELD.findall(" ".join(found[4].split()))
    return pairs if all(re.fullmatch(r"[\[\]\d\s.,e*/+()<_-]+|.*\b(?:EPSILON|PENETRATION_SLACK)\b.*", value.strip()) for _, value in pairs) else []


def with_statics(path, text):
    """A file whose structs of numbers are computed at the first use."""

    def static(found):
        visible, name, kind, _ = found.groups()
        number = lambda field, value: f'crate::tuned::number("{path}:{name}.{field}", ({value.strip()}) as f64) as _'
        each = lambda field, value: "[" + ", ".join(number(field, one) for one in value.strip("[] ").split(",")) + "]"
        values = [f"{field}: {(each if value.startswith('[') else number)(field, value)}" for field, value in fields(found)]
        if not values:
            return found[0]
        lock = f"std::sync::LazyLock<{kind}>"
        return f"{visible or ''}static {name}: {lock} = std::sync::LazyLock::new(|| {kind} {{ {', '.join(values)} }});"

    return GATHERED.sub(static, text)


def rewrite():
    """The copy of the repository, and the names of all its numbers."""
    wanted = lambda folder, names: [name for name in names if name in ("target", ".git")]
    shutil.rmtree(TO / "src", ignore_errors=True)
    shutil.copytree(ROOT, TO, ignore=wanted, dirs_exist_ok=True)
    files = [path for path in sorted((TO / "src").rglob("*.rs")) if "tests" not in path.parts and path.name != "tests.rs"]
    texts = {str(path.relative_to(TO)): path.read_text() for path in files}
    found = constants(texts)
    names = set().union(*found.values()) - of_other_kinds(texts)
    shown = found
    for _ in range(3):
        shown = {path: shown[path] | taken_by(text, shown, names) for path, text in texts.items()}
    for path, text in texts.items():
        (TO / path).write_text(with_functions(path, text, found[path], shown, names))
    lib = re.sub(r"#!\[(?:forbid|deny|warn)\([^\]]*\)\]", "", (TO / "src/lib.rs").read_text())
    first = re.search(r"^(?:pub )?mod ", lib, re.M).start()
    first = lib.rfind("\n\n", 0, first) + 2
    (TO / "src/lib.rs").write_text(lib[:first] + "mod tuned;\n" + lib[first:])
    (TO / "src/tuned.rs").write_text(CHOICE)
    gathered = [f"{path}:{found[2]}.{field}" for path, text in texts.items() for found in GATHERED.finditer(text) for field, _ in fields(found)]
    return [f"{path}:{name}" for path in found for name in sorted(found[path])] + gathered


def main():
    where, test, *settings = sys.argv[1:]
    names = [name for name in rewrite() if name.startswith(where)]
    cargo = ["cargo", "test", "--all-features", "-p", "viscocontact-tests", "--test", "suite"]
    subprocess.run([*cargo, "--no-run"], cwd=TO, check=True)

    def outcome(tuned):
        env = os.environ | dict(setting.split("=") for setting in settings) | ({"TUNED": tuned} if tuned else {})
        run = subprocess.run([*cargo, test, "--", "--nocapture"], cwd=TO, env=env, capture_output=True, text=True)
        lines = [line for line in run.stdout.splitlines() if not re.search(r"finished in|^test |^running|^\s*$", line)]
        return lines + ([] if run.returncode == 0 else ["the test fails"])

    base = outcome(None)
    print(*base, sep="\n")
    for name in names:
        for factor in ("0.5", "2"):
            found = outcome(f"{name}={factor}")
            print(f"{name} x {factor}: " + ("no change" if found == base else "changed"), flush=True)
            changes = [line for line in difflib.ndiff(base, found) if line[0] == "+"]
            print(*changes, sep="\n", flush=True)


if __name__ == "__main__":
    main()
