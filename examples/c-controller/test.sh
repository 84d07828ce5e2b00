#!/usr/bin/env bash
# Runs a controller in C against the library of one machine. In: this crate, and the program abbe (ABBE, else the one that
# cargo builds). Out: status 0 where all that abbe.h says holds: with sanitizers, under valgrind, shared and static.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
if [ -z "${ABBE:-}" ]; then
    cargo build --quiet --manifest-path ../../Cargo.toml
    ABBE="${CARGO_TARGET_DIR:-../../target}/debug/abbe"
fi
ABBE="$(realpath "$ABBE")"
cargo build --quiet
libraries="$(realpath "${CARGO_TARGET_DIR:-target}/debug")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# A path through the workspace, there and back on every axis, while the machine warms up; compensated by the program. The
# calibration is the same without what only a servo cycle has, which is tested by itself.
cp mill.yaml "$folder"
sed 's/^limits: .*/limits: {compensation: 0.3 mm, fade: 0.000001 s}/' mill-7.yaml > "$folder/numbers.yaml"
awk 'function sign(of) { return of < 0 ? -1 : 1 }
BEGIN {
    print "t,x,y,z,dir_x,dir_y,dir_z,T_column,T_table"
    for (row = 0; row < 3000; row++) {
        t = row * 0.002
        printf "%.3f,%.6f,%.6f,%.6f,%d,%d,%d,%.4f,%.4f\n", t,
            250 - 240 * cos(1.3 * t), 150 + 140 * sin(2.1 * t), -100 - 90 * sin(3.7 * t + 1),
            sign(sin(1.3 * t)), sign(cos(2.1 * t)), sign(-cos(3.7 * t + 1)),
            20 + 0.4 * t, 20 + 1.5 * sin(0.5 * t)
    }
}' > "$folder/positions.csv"
"$ABBE" compensate "$folder/numbers.yaml" --quiet < "$folder/positions.csv" > "$folder/table.csv"

run() {
    "$@" numbers "$folder/numbers.yaml" "$folder/table.csv"
    "$@" statuses mill-7.yaml
    "$@" hostile mill-7.yaml
    "$@" threads mill-7.yaml
}
flags=(-std=c11 -Wall -Wextra -Wpedantic -Werror -g -I ../../c-interface/include)
system=(-lpthread -ldl -lm)
wrapped=(malloc calloc realloc posix_memalign)

echo "static, with every allocation counted"
cc "${flags[@]}" -DCOUNTED -o "$folder/static" tests/controller.c "$libraries/libmill.a" "${system[@]}" "${wrapped[@]/#/-Wl,--wrap=}"
run "$folder/static"

echo "shared, with AddressSanitizer, LeakSanitizer and UndefinedBehaviorSanitizer"
cc "${flags[@]}" -fsanitize=address,undefined -fno-sanitize-recover=all -o "$folder/sanitized" tests/controller.c \
    -L "$libraries" -lmill -Wl,-rpath,"$libraries" "${system[@]}"
run "$folder/sanitized"

if command -v valgrind >/dev/null 2>&1; then
    echo "static, under valgrind"
    cc "${flags[@]}" -o "$folder/plain" tests/controller.c "$libraries/libmill.a" "${system[@]}"
    run valgrind --quiet --error-exitcode=1 --leak-check=full --show-leak-kinds=all "$folder/plain"
else
    echo "no valgrind: not run under it"
fi

echo "the header is C++ too"
c++ -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I ../../c-interface/include -include abbe.h /dev/null
