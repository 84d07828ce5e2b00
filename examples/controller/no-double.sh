#!/usr/bin/env bash
# Looks for numbers of 64 bits in the code of a servo cycle over numbers of 32 bits, compiled for a Cortex-M4F, whose processor knows no
# others. In: this crate. Out: status 0 where there are none; else the lines of code found. Where Rust's library for that processor is not
# installed and cannot be, the code is that for the processor which runs this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

target=thumbv7em-none-eabihf
if ! rustup target add "$target" >/dev/null 2>&1 && ! rustup target list --installed 2>/dev/null | grep -qx "$target"; then
    target="$(rustc -vV | sed -n 's/^host: //p')"
    echo "no Rust for thumbv7em-none-eabihf: the code is for $target"
fi

# The whole code, the runtime's and libm's with it, as LLVM has it in the end. In: a name for it, and how it is built.
code() {
    cargo rustc --release --quiet --target "$target" --crate-type staticlib "${@:2}" -- \
        --emit="llvm-ir=$folder/$1.ll,obj=$folder/$1.o"
}
code single --features f32
code double

# Numbers of 64 bits are doubles there; what a processor without them calls has names such as __aeabi_dadd.
if grep -nw double "$folder/single.ll" || nm --undefined-only "$folder/single.o" | grep -E '__aeabi_(d|[a-z]+2d)'; then
    echo "a cycle over numbers of 32 bits has these of 64"
    exit 1
fi
# The same cycles over numbers of 64 bits show that they would be found.
grep -qw double "$folder/double.ll" || { echo "no doubles are found where there are some"; exit 1; }
for numbers in single double; do
    echo "$numbers: $(size "$folder/$numbers.o" | awk 'NR == 2 { print $1 }') bytes of code and constants for $target"
done
