#!/bin/sh
# Writes a run and has numpy and VTK read it back, bit by bit. Takes the python3 at hand if it has both, else one in
# target/ci that is made for it.
set -eu
cd "$(dirname "$0")/.."

python=python3
if ! "$python" -c "import numpy, vtk" 2>/dev/null; then
    python=target/ci/python/bin/python
    if ! "$python" -c "import numpy, vtk" 2>/dev/null; then
        mkdir -p target/ci
        python3 -m venv target/ci/python
        "$python" -m pip install --quiet numpy vtk
    fi
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
READ_BACK_FOLDER="$folder" cargo test --quiet --all-features --test suite -- --ignored --exact io::output::a_run_for_other_readers
"$python" tests/read_back.py "$folder"
