#!/usr/bin/env bash
# What `machine!("...")` adds to the build of a crate. In: nothing. Out: a table on standard output: for each machine the
# median of ten builds of a crate that has the macro and of one that has the same code pasted in, in the development
# profile, each after a touch of its only file, in turns; and once the build from nothing, dependencies and all.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
cargo build --release --bin derive >&2
derive="${CARGO_TARGET_DIR:-$PWD/target}/release/derive"
root="$(cd .. && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR="$work/target" CARGO_INCREMENTAL=1

# crate NAME DEPENDENCIES: an empty crate.
crate() {
    mkdir -p "$work/$1/src"
    printf '[workspace]\n[package]\nname = "%s"\nversion = "0.1.0"\nedition = "2024"\n[dependencies]\nabbe-runtime = { path = "%s/runtime" }\n%s\n' \
        "$1" "$root" "$2" > "$work/$1/Cargo.toml"
}

# built NAME: milliseconds of a build.
built() {
    local from till
    from="$(date +%s%N)"
    cargo build --quiet --manifest-path "$work/$1/Cargo.toml"
    till="$(date +%s%N)"
    echo "$(((till - from) / 1000000))"
}

crate macro "abbe-macros = { path = \"$root/macros\" }"
crate pasted ""
echo "from nothing, ms (dependencies are fetched before):"
for crate in macro pasted; do
    cp "$root/machines/trunnion-5axis.yaml" "$work/$crate/machine.yaml"
    printf '#![allow(dead_code)]\n' > "$work/$crate/src/lib.rs"
    cargo fetch --quiet --manifest-path "$work/$crate/Cargo.toml"
    rm -rf "$CARGO_TARGET_DIR"
    all="$(built "$crate")"
    printf '  %-8s %6d\n' "$crate" "$all"
done

printf '%-16s %10s %10s %10s\n' 'machine' 'macro, ms' 'pasted, ms' 'more, ms'
for machine in excello-921 xyfz-mill trunnion-5axis; do
    cp "$root/machines/$machine.yaml" "$work/macro/machine.yaml"
    printf '//! A machine.\n#![allow(dead_code)]\nabbe_macros::machine!("machine.yaml");\n' > "$work/macro/src/lib.rs"
    "$derive" expand "$root/machines/$machine.yaml" | { printf '//! A machine.\n#![allow(dead_code)]\n'; cat; } > "$work/pasted/src/lib.rs"
    for crate in macro pasted; do
        built "$crate" > /dev/null
        : > "$work/$crate.times"
    done
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        for crate in macro pasted; do
            touch "$work/$crate/src/lib.rs"
            built "$crate" >> "$work/$crate.times"
        done
    done
    median() { sort -n "$work/$1.times" | awk '{ t[NR] = $1 } END { print (t[5] + t[6]) / 2 }'; }
    awk -v m="$machine" -v a="$(median macro)" -v b="$(median pasted)" \
        'BEGIN { printf "%-16s %10.0f %10.0f %10.0f\n", m, a, b, a - b }'
done
