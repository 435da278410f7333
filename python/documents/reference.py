"""Writes the HTML reference of the package that is installed: `pip install pdoc`, then `python reference.py FOLDER`."""

import pathlib
import sys

import pdoc.doc
import pdoc.render


def with_calls(module):
    """A module in which each class begins with the call that makes its objects, which pdoc does not find where it is compiled."""
    for of in module.own_members:
        signature = getattr(of.obj, "__text_signature__", None)
        if of.kind == "class" and signature:
            of.docstring = f"```python\n{of.name}{signature}\n```\n\n{of.docstring}"
    return module


def main(folder):
    names = ["viscocontact", "viscocontact.gradients"]
    modules = {name: with_calls(pdoc.doc.Module.from_name(name)) for name in names}
    pdoc.render.configure(docformat="numpy")
    pages = {f"{name.replace('.', '/')}.html": pdoc.render.html_module(module, modules) for name, module in modules.items()}
    pages |= {"index.html": pdoc.render.html_index(modules), "search.js": pdoc.render.search_index(modules)}
    for name, page in pages.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(page, encoding="utf-8")
    missing = [name for name in modules["viscocontact"].obj.__all__ if f'id="{name}"' not in pages["viscocontact.html"]]
    if missing:
        sys.exit(f"without a place in the reference: {', '.join(missing)}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
