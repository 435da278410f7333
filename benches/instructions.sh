#!/usr/bin/env bash
# Counts the instructions of small scenes with callgrind, and compares them with benches/instructions.csv: each may
# differ by 3 %. Takes the build of the tests, or with `--release` that of users. With `--record` the counts are written to
# the file instead. They belong to a compiler: with another one they are shown, not judged. Needs valgrind; without it,
# says so and succeeds.
set -euo pipefail
cd "$(dirname "$0")/.."
recorded=benches/instructions.csv

if ! command -v valgrind >/dev/null; then
    echo "valgrind is not installed: instructions are not counted"
    exit 0
fi
compiler=$(rustc --version | cut -d' ' -f2)
if [[ " $* " = *" --release "* ]]; then
    build=release
    # beside the main example, so that one build of the crate serves both
    cargo build --quiet --release --features analytic,plot --example step_loaded_sphere --bin instructions
    program=${CARGO_TARGET_DIR:-target}/release/instructions
else
    build=tests
    cargo test --quiet --all-features --no-run
    program=${CARGO_TARGET_DIR:-target}/debug/instructions
fi
mkdir -p target/instructions

count() {
    valgrind --tool=callgrind --toggle-collect='instructions::measured' \
        --callgrind-out-file="target/instructions/$1.out" "$program" "$1" 2>"target/instructions/$1.log" >/dev/null || {
        cat "target/instructions/$1.log" >&2
        return 1
    }
    sed -n 's/.*Collected : //p' "target/instructions/$1.log"
}

names=(held_sphere eccentric_punch wavy_surface one_relaxation_time thirty_relaxation_times)
if [[ " $* " = *" --record "* ]]; then
    others=$(tail -n +2 "$recorded" | grep -v ",$build," || true)
    own=$(for k in "${!names[@]}"; do now=$(count "$k") || exit 1; echo "${names[$k]},$build,$now,$compiler"; done)
    { echo "scene,build,instructions,rustc"; printf '%s\n' "$others" "$own" | grep . | sort -t, -k2,2 -s; } >"$recorded"
    cat "$recorded"
    exit
fi
failed=0
counts=()
for k in "${!names[@]}"; do
    now=$(count "$k")
    counts+=("$now")
    if ! IFS=, read -r _ _ before with < <(grep "^${names[$k]},$build," "$recorded"); then
        echo "${names[$k]}: $now instructions, not recorded"
        continue
    fi
    change=$(awk -v a="$now" -v b="$before" 'BEGIN { printf "%+.2f", 100 * (a / b - 1) }')
    verdict=ok
    if [ "$with" != "$compiler" ]; then
        verdict="recorded with rustc $with, not judged"
    elif awk -v c="$change" 'BEGIN { exit !(c > 3 || c < -3) }'; then
        verdict="MORE THAN 3 % (if it is meant to be: the same with --record)"
        failed=1
    fi
    echo "${names[$k]}: $now instructions, $change %: $verdict"
done
ratio=$(awk -v a="${counts[4]}" -v b="${counts[3]}" 'BEGIN { printf "%.2f", a / b }')
echo "thirty relaxation times over one: $ratio"
if awk -v r="$ratio" 'BEGIN { exit !(r > 1.3) }'; then
    echo "MORE THAN 1.3"
    failed=1
fi
exit $failed
