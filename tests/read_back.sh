#!/bin/sh
# Writes a run and has numpy and VTK read it back, bit by bit. Takes the python3 at hand if it has both, else one in the
# user's cache that is made for it: 700 MB, the same for every clone.
set -eu
cd "$(dirname "$0")/.."

python=python3
if ! "$python" -c "import numpy, vtk" 2>/dev/null; then
    own="${XDG_CACHE_HOME:-$HOME/.cache}/viscocontact/python"
    python="$own/bin/python"
    if ! "$python" -c "import numpy, vtk" 2>/dev/null; then
        python3 -m venv "$own"
        # without what VTK wants for plots
        "$python" -m pip install --quiet --no-deps numpy vtk
    fi
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
READ_BACK_FOLDER="$folder" cargo test --quiet --all-features --test suite -- --ignored --exact io::output::a_run_for_other_readers
"$python" tests/read_back.py "$folder"
