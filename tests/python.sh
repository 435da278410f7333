#!/usr/bin/env bash
# The Python package: its tests, the examples of its docstrings, its stubs against the compiled module, and scenes of random numbers
# in both languages. Built in the profile of the tests; tools come from an environment in the user's cache that is made for it.
set -euo pipefail
cd "$(dirname "$0")/.."
repository=$PWD

own="${XDG_CACHE_HOME:-$HOME/.cache}/viscocontact/package"
python="$own/bin/python"
wanted="import matplotlib, mypy, numpy, pytest, scipy"
if ! "$python" -c "$wanted" 2>/dev/null; then
    if ! { python3 -m venv "$own" && "$python" -m pip install --quiet matplotlib mypy numpy pytest scipy; }; then
        echo "skipped: neither a network nor $own with matplotlib, mypy, numpy, pytest and scipy"
        exit 0
    fi
fi
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$repository/target}"
# with the tests, so that it shares their build of the crate
cargo build --quiet --all-features --package viscocontact --package viscocontact-identify --package viscocontact-tests --package viscocontact-python \
    --lib --example quickstart --example scenes
cd python
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r viscocontact "$folder"
cp "$CARGO_TARGET_DIR/debug/lib_native.so" "$folder/viscocontact/_native.abi3.so"
cp -r tests "$folder"
cp pyproject.toml LICENSE "$folder"
cd "$folder"
export VISCOCONTACT_SCENES_IN_RUST="$CARGO_TARGET_DIR/debug/examples/scenes" PYTHONPATH="$folder" VISCOCONTACT_REPOSITORY="$repository"
"$python" -m pytest --quiet tests
"$python" -m mypy.stubtest viscocontact
# the notebooks print what is stored, beside Tamaas and with PyTorch where these are installed; the reference needs pdoc
for more in pdoc tamaas; do
    "$python" -c "import $more" 2>/dev/null || "$python" -m pip install --quiet "$more" 2>/dev/null || echo "without $more"
done
"$python" "$repository/python/documents/execute.py"
if "$python" -c "import pdoc" 2>/dev/null; then
    "$python" "$repository/python/documents/reference.py" "$repository/target/ci/python/reference"
fi
for example in "$repository"/python/examples/*.py; do
    "$python" "$example" --quick --output "$repository/target/ci/python"
done
