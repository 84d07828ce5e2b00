#!/usr/bin/env bash
# Instructions of one call, for every contestant: what callgrind counts inside the passes, divided by their calls. Setting
# up is not counted; the loop around the calls is, for all alike. In: nothing; `ABBE_BENCH_FILTER` keeps the lines that hold it. Out: a table
# on standard output, with each contestant's share of ours.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
cargo build --release --bin count >&2
count="${CARGO_TARGET_DIR:-target}/release/count"
passes=4 states=512

instructions() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*Contestant*pass*' "$count" "$@" 2>&1 |
        sed -n 's/.*Collected : //p'
}

printf '%-16s %-10s %-22s %14s %8s\n' machine group contestant 'instructions' 'of ours'
"$count" | grep -- "${ABBE_BENCH_FILTER:-}" | while IFS=$'\t' read -r machine group number name; do
    all="$(instructions "$machine" "$group" "$number" "$passes")"
    each="$(awk -v a="$all" -v n="$((passes * states))" 'BEGIN { printf "%.1f", a / n }')"
    [ "$number" = 0 ] && ours="$each"
    awk -v m="$machine" -v g="$group" -v c="$name" -v e="$each" -v o="$ours" \
        'BEGIN { printf "%-16s %-10s %-22s %14.1f %8.2f\n", m, g, c, e, e / o }'
done
