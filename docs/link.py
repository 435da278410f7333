"""Links the items that guides and docs/paper.md name in brackets, [`like::this`], to the documentation on docs.rs.

A forge does not resolve names of items, rustdoc does; links of Markdown are followed by both. They stand at the end of each page. Run after
`cargo doc --no-deps --all-features`. With `--check` nothing is written; the exit is 1 where a page would change.
"""

import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).parent.parent
BUILT = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "doc" / "viscocontact"
ADDRESS = "https://docs.rs/viscocontact/latest/viscocontact/"
MARK = "<!-- docs/link.py -->"


def pages_of_items():
    """The page of each item and module, by its path in the crate."""
    pages = {}
    for file in sorted(BUILT.rglob("*.html"), key=lambda file: (len(file.parts), file)):
        folder = file.relative_to(BUILT).parent.parts
        if file.name == "index.html":
            pages[folder] = file
        elif match := re.fullmatch(r"(?:struct|enum|trait|fn|type|constant|macro)\.(\w+)\.html", file.name):
            pages[(*folder, match[1])] = file
    return pages


def address(name, pages):
    """The address of an item, or of a part of one; None if it is not documented."""
    path = tuple(name.removesuffix("()").split("::"))
    for whole, part in ((path, None), (path[:-1], path[-1])):
        # the path itself, else the shortest that ends so: the prelude is at hand on every page
        ends = [page for page in pages if whole and page[-len(whole) :] == whole]
        if not ends:
            continue
        file = pages[whole if whole in pages else ends[0]]
        relative = ADDRESS + file.relative_to(BUILT).as_posix()
        if part is None:
            return relative
        text = file.read_text(encoding="utf8")
        for kind in ("method", "tymethod", "variant", "structfield", "associatedconstant"):
            if f'id="{kind}.{part}"' in text:
                return f"{relative}#{kind}.{part}"
    return None


def main():
    pages, stale = pages_of_items(), []
    for file in [*sorted((ROOT / "docs" / "guide").glob("*.md")), ROOT / "docs" / "paper.md"]:
        text = file.read_text(encoding="utf8")
        body = text.split(MARK)[0].rstrip()
        names = sorted(set(re.findall(r"\[`([\w:]+(?:\(\))?)`\](?![(:])", body)))
        links = [f"[`{name}`]: {address(name, pages)}" for name in names]
        if missing := [link for link in links if link.endswith("None")]:
            sys.exit(f"{file.name}: not documented: {missing}")
        linked = "\n".join([body, "", MARK, "", *links, ""]) if links else body + "\n"
        if linked != text:
            stale.append(file.name)
            if "--check" not in sys.argv:
                file.write_text(linked, encoding="utf8")
    print("links to items:", f"{', '.join(stale)} changed" if stale else "all up to date")
    sys.exit("--check" in sys.argv and bool(stale))


main()
