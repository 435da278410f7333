#!/usr/bin/env bash
# The page in a real browser, where there are the target for it, Node and Chromium; what is missing is said.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
[ -d "$(rustc --print target-libdir --target $target 2>/dev/null)" ] || { echo "$target is not installed: a job of the forge runs the page"; exit; }
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ] || [ -z "$(command -v node || true)" ]; then
    echo "no Node or no Chromium: a job of the forge runs the page"
    exit
fi

folder=${CARGO_TARGET_DIR:-target}
mkdir -p "$folder/page"
command cargo build --quiet --profile page --package viscocontact-page --target $target
command cargo run --quiet --release --package viscocontact-page --example values >"$folder/page/values.json"
node page/browser.mjs "$folder/page/values.json" "$folder/$target/page/viscocontact_page.wasm" "$folder/page" "$browser"
