"""The examples of docstrings, and what every public item must have."""

import doctest
import inspect
import os
import pathlib
import re

import pytest
import viscocontact

FLAGS = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL
ITEMS = [getattr(viscocontact, name) for name in viscocontact.__all__]


def documented():
    yield "viscocontact", viscocontact.__doc__
    for item in ITEMS:
        yield item.__name__, item.__doc__
        if inspect.isclass(item):
            for name, member in vars(item).items():
                if not name.startswith("_"):
                    yield f"{item.__name__}.{name}", member.__doc__


def test_every_item_says_what_it_is():
    missing = [name for name, text in documented() if not text]
    assert not missing
    assert sum(1 for _ in documented()) > 300


def test_every_class_and_function_has_an_example():
    missing = [item.__name__ for item in ITEMS if ">>>" not in (item.__doc__ or "")]
    assert not missing


def test_examples_of_docstrings():
    finder, names = doctest.DocTestParser(), {name: getattr(viscocontact, name) for name in viscocontact.__all__}
    examples = [(name, text) for name, text in documented() if text and ">>>" in text]
    assert len(examples) > 25
    failed = []
    for name, text in examples:
        test = finder.get_doctest(text, dict(names), name, None, 0)
        runner = doctest.DocTestRunner(optionflags=FLAGS, verbose=False)
        report = []
        runner.run(test, out=report.append)
        if runner.summarize(verbose=False).failed:
            failed.append("".join(report))
    assert not failed, "\n".join(failed)


@pytest.mark.parametrize("item", [item for item in ITEMS if inspect.isclass(item)], ids=lambda item: item.__name__)
def test_a_repr_is_one_line(item):
    assert "\n" not in repr(item)


@pytest.fixture
def repository():
    path = pathlib.Path(os.environ.get("VISCOCONTACT_REPOSITORY", pathlib.Path(__file__).parents[2]))
    if not (path / "docs" / "guide" / "results.md").exists():
        pytest.skip("the crate is not beside")
    return path


def test_the_version_is_that_of_the_crate(repository):
    version = re.search(r'^version = "(.*)"', (repository / "Cargo.toml").read_text(), re.MULTILINE)
    assert viscocontact.__version__ == version.group(1)


def test_the_licence_is_that_of_the_crate(repository):
    assert (repository / "python/licences/viscocontact.txt").read_text() == (repository / "LICENSE").read_text()


@pytest.mark.parametrize("page, fence", [("README.md", "python"), ("../docs/guide/results.md", "py")])
def test_programs_of_the_pages(repository, page, fence, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs = re.findall(rf"```{fence}\n(.*?)```", (repository / "python" / page).read_text(encoding="utf-8"), re.DOTALL)
    assert programs
    for program in programs:
        exec(program, {})


def test_the_page_of_a_package_index_has_no_relative_links(repository):
    links = re.findall(r"\]\(([^)]*)\)", (repository / "python/README.md").read_text(encoding="utf-8"))
    assert links and all(link.startswith("https://") for link in links)


def test_renamed_messages_are_messages(repository):
    table = (repository / "python/src/errors.rs").read_text(encoding="utf-8").split("const NAMES")[1].split("];")[0]
    named = re.findall(r'\(\s*"((?:[^"\\]|\\.)*)",', table)
    crates = [repository / "src", repository / "identify/src"]
    source = "".join(path.read_text(encoding="utf-8") for crate in crates for path in crate.rglob("*.rs"))
    # messages may go on in the next line of the source
    source = re.sub(r"\\\n\s*", "", source)
    # one message names any part of a contact
    parts = re.findall(r".*\{part\}.*", source)
    source += "".join(message.replace("{part}", part) for message in parts for part in ["material", "counter_body"])
    assert len(named) >= 9
    for name in named:
        assert name in source, name
