#!/usr/bin/env python3
"""Writes licences/dependencies.txt: the licence texts of the crates that are compiled into the package, each once. `--check` compares instead."""

import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TEXTS = re.compile(r"(licen[cs]e|copying|notice|unlicense|ofl|ufl)", re.IGNORECASE)


def packages():
    """The crates that are linked on this system."""
    host = re.search(r"host: (.*)", subprocess.run(["rustc", "-vV"], check=True, capture_output=True, text=True).stdout).group(1)
    command = ["cargo", "metadata", "--format-version", "1", "--filter-platform", host, "--manifest-path", str(HERE / "Cargo.toml")]
    graph = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    nodes = {node["id"]: node for node in graph["resolve"]["nodes"]}
    root = next(package["id"] for package in graph["packages"] if package["name"] == "viscocontact-python")
    found, next_ones = set(), [root]
    while next_ones:
        one = next_ones.pop()
        if one not in found:
            found.add(one)
            needed = nodes[one]["deps"]
            next_ones += [dep["pkg"] for dep in needed if any(kind["kind"] is None for kind in dep["dep_kinds"])]
    all_ones = (package for package in graph["packages"] if package["id"] in found and package["source"])
    return sorted(all_ones, key=lambda package: (package["name"], package["version"]))


def text():
    texts, without = {}, []
    for package in packages():
        folder = pathlib.Path(package["manifest_path"]).parent
        files = [file for file in sorted(folder.rglob("*")) if file.is_file() and TEXTS.match(file.name) and file.suffix not in (".rs", ".toml")]
        name = f"{package['name']} {package['version']} ({package['license'] or 'see the text'})"
        for file in files:
            words = file.read_text(encoding="utf-8", errors="replace").replace("\r\n", "\n").strip()
            texts.setdefault(words, []).append(name)
        if not files:
            without.append(name)
    parts = ["The package viscocontact has parts of these crates, under the licences below."]
    parts += ["\n".join(dict.fromkeys(names)) + "\n\n" + words for words, names in sorted(texts.items(), key=lambda item: item[1])]
    if without:
        parts.append("Under the licence that each names, whose text it does not carry:\n" + "\n".join(without))
    return ("\n\n" + 100 * "-" + "\n\n").join(parts) + "\n"


if __name__ == "__main__":
    path = HERE / "licences" / "dependencies.txt"
    if sys.argv[1:] == ["--check"]:
        if path.read_text(encoding="utf-8") != text():
            sys.exit(f"{path} is not that of the dependencies: run python/licences.py")
    else:
        path.write_text(text(), encoding="utf-8")
