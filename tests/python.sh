#!/usr/bin/env bash
# The Python package: its tests, the examples of its docstrings, its stubs against the compiled module, scenes of random numbers
# in both languages, the licences of its dependencies, and a source distribution that another build could begin with. Built in the profile of the tests; tools come from an environment in the user's cache that is made for it.
set -euo pipefail
cd "$(dirname "$0")/.."
repository=$PWD

own="${XDG_CACHE_HOME:-$HOME/.cache}/viscocontact/package"
python="$own/bin/python"
tools="matplotlib maturin mypy numpy pandas pytest scipy xarray"
wanted="import ${tools// /, }"
if ! "$python" -c "$wanted" 2>/dev/null; then
    if ! { python3 -m venv "$own" && "$python" -m pip install --quiet $tools; }; then
        echo "skipped: neither a network nor $own with $tools"
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
cp pyproject.toml "$folder"
cd "$folder"
export VISCOCONTACT_SCENES_IN_RUST="$CARGO_TARGET_DIR/debug/examples/scenes" PYTHONPATH="$folder" VISCOCONTACT_REPOSITORY="$repository"
"$python" -m pytest --quiet tests
# the notebooks print what is stored, beside Tamaas and with PyTorch where these are installed; the reference needs pdoc
for more in pdoc tamaas; do
    "$python" -c "import $more" 2>/dev/null || "$python" -m pip install --quiet "$more" 2>/dev/null || echo "without $more"
done
"$python" "$repository/python/documents/execute.py"
if "$python" -c "import pdoc" 2>/dev/null; then
    "$python" "$repository/python/documents/reference.py" "$repository/target/ci/python/reference"
fi
"$python" -m mypy.stubtest viscocontact --mypy-config-file pyproject.toml
"$python" "$repository/python/licences.py" --check
# unpacked elsewhere, it has all that a build needs; a job of the forge compiles it
"$python" -m maturin sdist --manifest-path "$repository/python/Cargo.toml" --out "$folder/dist" >/dev/null 2>&1
tar xzf "$folder"/dist/*.tar.gz --strip-components 1 --one-top-level="$folder/unpacked"
(cd "$folder/unpacked" && cargo metadata --quiet --offline --format-version 1 --filter-platform "$(rustc -vV | sed -n 's/host: //p')" >/dev/null)
for text in viscocontact dependencies; do
    grep -qx "License-File: licences/$text.txt" "$folder/unpacked/PKG-INFO"
    test -s "$folder/unpacked/licences/$text.txt"
done
for example in "$repository"/python/examples/*.py; do
    "$python" "$example" --quick --output "$repository/target/ci/python"
done
