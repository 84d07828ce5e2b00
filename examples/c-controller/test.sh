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

# A machine with motors, and one whose head leans, from their machine files to their commands: by abbe.h, and by the component of LinuxCNC
# on pins that are numbers in a process. In: the machine file, its calibration, `motors` where it has some; the table's positions.
follow() {
    "$ABBE" compensate "$2" --quiet < "$folder/positions.csv" > "$folder/table.csv"
    ABBE_MACHINE="$1" cargo build --quiet
    local hal sanitized=(-fsanitize=address,undefined -fno-sanitize-recover=all)
    for hal in "" HAL; do
        cc "${flags[@]}" -Wno-unused-function ${hal:+-DHAL -D_GNU_SOURCE -Wno-unused-parameter -I tests/hal} "${sanitized[@]}" -o "$folder/follow" tests/follow.c \
            "$libraries/libmill.a" "${system[@]}"
        echo "$1, ${hal:-abbe.h}:"
        "$folder/follow" "$2" "$folder/table.csv" "$3"
    done
}
awk 'function sign(of) { return of < 0 ? -1 : 1 }
BEGIN {
    print "t,x,y,z,a,b,dir_x,dir_y,dir_z,dir_a,dir_b,T_frame"
    for (row = 0; row < 2000; row++) {
        t = row * 0.002
        x = sprintf("%.6f", 150 - 140 * cos(1.3 * t)); dx = 1.3 * 140 * sin(1.3 * t)
        y = sprintf("%.6f", 120 + 110 * sin(2.1 * t)); dy = 2.1 * 110 * cos(2.1 * t)
        printf "%.3f,%s,%s,%.6f,%.6f,%.6f,%d,%d,%d,%d,%d,%.4f\n", t, x, y, 60 + 50 * sin(3.7 * t), x + y, x - y,
            sign(dx), sign(dy), sign(cos(3.7 * t)), sign(dx + dy), sign(dx - dy), 20 + 2 * t
    }
}' > "$folder/positions.csv"
follow corexy.yaml corexy-3.yaml motors
awk 'function sign(of) { return of < 0 ? -1 : 1 }
BEGIN {
    print "t,x,y,z,b,c,dir_x,dir_y,dir_z,dir_b,dir_c,T_head"
    for (row = 0; row < 2000; row++) {
        t = row * 0.002
        printf "%.3f,%.6f,%.6f,%.6f,%.6f,%.6f,%d,%d,%d,%d,%d,%.4f\n", t,
            200 * sin(1.3 * t), 150 * sin(2.1 * t), 100 * sin(3.7 * t), 90 - 85 * cos(0.9 * t), 170 * sin(0.7 * t),
            sign(cos(1.3 * t)), sign(cos(2.1 * t)), sign(cos(3.7 * t)), sign(sin(0.9 * t)), sign(cos(0.7 * t)), 20 + t
    }
}' > "$folder/positions.csv"
follow ../../machines/nutating-head-5axis.yaml nutating-5.yaml plain

echo "the header is C++ too"
c++ -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I ../../c-interface/include -include abbe.h /dev/null
