#!/usr/bin/env bash
# Writes a run and has numpy and VTK read it back, bit by bit, and runs the programs of docs/guide/results.md on it. Takes the python3
# at hand if it has all packages, else one in the user's cache that is made for it: 1 GB, the same for every clone.
set -eu
cd "$(dirname "$0")/.."

python=python3
wanted="import numpy, pandas, pyvista, vtk"
if ! "$python" -c "$wanted" 2>/dev/null; then
    own="${XDG_CACHE_HOME:-$HOME/.cache}/viscocontact/python"
    python="$own/bin/python"
    if ! "$python" -c "$wanted" 2>/dev/null; then
        python3 -m venv "$own"
        "$python" -m pip install --quiet numpy pandas pyvista vtk
    fi
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# the suite as the test command builds it: alone, dependencies would have other features and the crate be compiled again
suite=$(cargo test --all-features --no-run 2>&1 | sed -n 's/.*Executable suite\.rs (\(.*\))$/\1/p')
suite=$(realpath "${suite:?no suite was built}")
(cd tests && READ_BACK_FOLDER="$folder" "$suite" --ignored --exact io::output::a_run_for_other_readers)
"$python" tests/read_back.py "$folder"
