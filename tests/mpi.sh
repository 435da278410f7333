#!/usr/bin/env bash
# Contacts on 1 to 4 ranks over MPI against one process, bit by bit, and ranks that fail. Installs nothing: without
# mpirun it says so, and succeeds. mpi/README.md names the packages.
set -euo pipefail
cd "$(dirname "$0")/../mpi"

if ! command -v mpirun >/dev/null; then
    echo "skipped: no mpirun"
    exit 0
fi
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$(cd .. && pwd)/target}"
cargo build --quiet --example check
cargo test --quiet --lib
check=$CARGO_TARGET_DIR/debug/examples/check
# longest time that a failure of one rank may keep the others [s]
limit=60

run() {
    local size=$1
    shift
    local as_root=()
    [ "$(id -u)" != 0 ] || as_root=(--allow-run-as-root)
    timeout "$limit" mpirun -n "$size" --oversubscribe "${as_root[@]}" "$check" "$@"
}

alone=$("$check" alone scenes)
for size in 1 2 3 4; do
    together=$(run "$size" scenes)
    [ "$together" = "$alone" ] || { echo "$size ranks: $together instead of $alone"; exit 1; }
done
echo "1, 2, 3 and 4 ranks give the bits of one process: $alone"
together=$(run 3 short 5000 scenes)
[ "$together" = "$alone" ] || { echo "in short messages: $together instead of $alone"; exit 1; }
echo "so they do in messages of 5000 numbers"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$check" alone files "$folder/alone"
for size in 1 4; do
    run "$size" files "$folder/$size"
    diff -r "$folder/alone" "$folder/$size" || { echo "$size ranks write other files"; exit 1; }
done
echo "4 ranks write the files of one process"

whole=$("$check" alone hold)
run 4 save "$folder/run"
for size in 1 2 3 4; do
    resumed=$(run "$size" resume "$folder/run")
    [ "$resumed" = "$whole" ] || { echo "4 ranks resumed on $size: $resumed instead of $whole"; exit 1; }
done
resumed=$("$check" alone resume "$folder/run")
[ "$resumed" = "$whole" ] || { echo "4 ranks resumed by one process: $resumed instead of $whole"; exit 1; }
"$check" alone save "$folder/run"
[ "$(find "$folder" -maxdepth 1 -type f | wc -l)" = 1 ] || { echo "other files are left"; exit 1; }
resumed=$(run 2 resume "$folder/run")
[ "$resumed" = "$whole" ] || { echo "one process resumed on 2 ranks: $resumed instead of $whole"; exit 1; }
echo "a run goes on on another number of ranks: $whole"

run 3 errs
echo "an error of one rank is that of all"
run 3 leaves
echo "a rank that leaves is missed"
status=0
run 3 panics >/dev/null 2>&1 || status=$?
[ "$status" != 0 ] && [ "$status" != 124 ] || { echo "a panic left others waiting, or passed unnoticed: $status"; exit 1; }
echo "a panic ends all"

log=$(mktemp)
run 3 waits >"$log" 2>&1 &
waiting=$!
for _ in $(seq 100); do grep -q '^pid' "$log" && break; sleep 0.1; done
kill -9 "$(sed -n 's/^pid //p' "$log")"
status=0
wait "$waiting" || status=$?
rm -f "$log"
[ "$status" != 0 ] && [ "$status" != 124 ] || { echo "a killed rank left others waiting: $status"; exit 1; }
echo "a rank that is killed ends all"
