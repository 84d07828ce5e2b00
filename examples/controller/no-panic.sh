#!/usr/bin/env bash
# Looks for ways to panic, and for an allocator, in the code of a servo cycle. In: this crate, over numbers of 64 and of 32 bits. Out:
# status 0 where its library has none; else the functions found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# In: a type of numbers in C, and how the library is built with it.
check() {
    local real="$1" library symbols found
    cargo build --release --quiet "${@:2}"
    library="${CARGO_TARGET_DIR:-target}/release/libcontroller.so"
    symbols="$(nm --demangle "$library")"
    found="$(grep -E 'panic|unwind|unwrap|expect_failed|slice_index|__rust_alloc|__rg_| (malloc|calloc|realloc|free)\b' <<< "$symbols" || true)"
    if [ -n "$found" ]; then
        echo "a servo cycle over $real could reach:"
        echo "$found"
        exit 1
    fi
    # A cycle that stopped before it did anything would have nothing in it to be found.
    cc -D REAL="$real" -o "$folder/once" -x c - -x none "$library" -Wl,-rpath,"$(dirname "$(realpath "$library")")" <<'C'
REAL cycle(REAL time_step, REAL temperature);
REAL cycle_compiled(REAL time_step, REAL bed, REAL column);
int main(void) { return cycle(0.001, 21.0) > 0.0 && cycle_compiled(0.001, 21.0, 22.0) > 0.0 ? 0 : 1; }
C
    "$folder/once" || { echo "the cycle over $real corrects nothing"; exit 1; }
    echo "no way to panic and no allocation in $(grep -c ' [tT] ' <<< "$symbols") functions of a servo cycle over $real"
}

check float --features f32
check double
