"""Runs the notebooks beside this file, each in one process, without Jupyter.

    python execute.py [--write] [name ...]

Without `--write` their text must come out as it is stored, in the digits that they print; with it text and pictures are stored, and pictures are
written into `pictures` as well, for the gallery. A cell with the tag of a package, as `tamaas`, is left out where this package is not installed.
"""

import argparse
import ast
import base64
import contextlib
import importlib.util
import io
import json
import pathlib
import sys
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from PIL import Image

FOLDER = pathlib.Path(__file__).parent
MOST_BYTES = 60_000


def pictures():
    """The figures that are open, as PNG files, which closes them."""
    for number in plt.get_fignums():
        whole, file = io.BytesIO(), io.BytesIO()
        plt.figure(number).savefig(whole, format="png", dpi=90)
        plt.close(number)
        # a palette is a third of the size
        Image.open(whole).convert("RGB").quantize(128, dither=Image.Dither.NONE).save(file, format="png", optimize=True)
        if file.tell() > MOST_BYTES:
            sys.exit(f"a picture of {file.tell()} bytes: at most {MOST_BYTES}")
        yield file.getvalue()


def outputs(source, names):
    """What a cell prints and draws; the value of an expression at its end is printed."""
    tree, text = ast.parse(source), io.StringIO()
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(text):
        exec(compile(tree, "<cell>", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)
            if value is not None:
                print(repr(value))
    found = [{"name": "stdout", "output_type": "stream", "text": text.getvalue().splitlines(True)}] if text.getvalue() else []
    for picture in pictures():
        data = {"image/png": base64.b64encode(picture).decode()}
        found.append({"data": data, "metadata": {}, "output_type": "display_data"})
    return found


def words(found):
    return ["".join(output["text"]) for output in found if output["output_type"] == "stream"]


def run(path, write):
    notebook, names, drawn = json.loads(path.read_text(encoding="utf-8")), {"__name__": "__main__"}, []
    plt.show = lambda *_, **__: None
    for number, cell in enumerate(notebook["cells"]):
        missing = [tag for tag in cell["metadata"].get("tags", []) if importlib.util.find_spec(tag) is None]
        if cell["cell_type"] != "code" or missing:
            missing and print(f"{path.name}: cell {number} is left out, {missing[0]} is not installed")
            continue
        found = outputs("".join(cell["source"]), names)
        if not write and words(found) != words(cell["outputs"]):
            sys.exit(f"{path.name}, cell {number}: {words(found)} where {words(cell['outputs'])} is stored")
        drawn += [base64.b64decode(output["data"]["image/png"]) for output in found if "data" in output]
        cell["outputs"] = found
    if write:
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n", encoding="utf-8")
        (FOLDER / "pictures").mkdir(exist_ok=True)
        for number, picture in enumerate(drawn):
            (FOLDER / "pictures" / f"{path.stem}_{number}.png").write_bytes(picture)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--write", action="store_true")
    arguments.add_argument("names", nargs="*")
    arguments = arguments.parse_args()
    for path in sorted(FOLDER.glob("*.ipynb")):
        if not arguments.names or path.stem in arguments.names:
            start = time.process_time()
            run(path, arguments.write)
            print(f"{path.name}: {time.process_time() - start:.1f} s of processor time")


if __name__ == "__main__":
    main()
