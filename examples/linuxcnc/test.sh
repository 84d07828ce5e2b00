#!/usr/bin/env bash
# Runs LinuxCNC with simulated machines that have errors, a mill, a trunnion and a head with two rotary axes, without Abbe's
# compensation and with it, and judges the samples. In: this folder and ../c-controller; the program abbe and the judge of samples
# (ABBE and JUDGE, else those that cargo builds); PROFILE, that of the library, else dev; SEED, of the errors of the machines of five
# axes, else 1; KEEP, a folder for what came out. Out: status 0 where the tool errs by less than a twentieth of what it did, nothing
# jumps, and a diagnosis finds what was hidden from it; or where LinuxCNC is not to be had, which is told.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

skip() {
    echo "LinuxCNC is not run: $1"
    exit 0
}

modules=/usr/lib/linuxcnc/modules
if ! command -v linuxcnc >/dev/null 2>&1 || [ ! -e /usr/include/linuxcnc/hal.h ]; then
    [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1 || skip "it is not installed, and this is not root with apt-get"
    # What it recommends is a real-time kernel, among much else, which a test has no business to install.
    export DEBIAN_FRONTEND=noninteractive
    { apt-get update && apt-get install -y --no-install-recommends linuxcnc-uspace linuxcnc-uspace-dev; } >/dev/null 2>&1 ||
        skip "apt-get cannot install linuxcnc-uspace and linuxcnc-uspace-dev"
fi
for tool in linuxcnc halcmd halsampler tclsh cc; do
    command -v "$tool" >/dev/null 2>&1 || skip "there is no $tool beside it"
done
/usr/bin/python3 -c 'import linuxcnc' 2>/dev/null || skip "it has no module for Python"
[ -w "$modules" ] || skip "its real-time modules are loaded from $modules, where this user may not write"
# There can be one of it on a machine.
exec 9>> /tmp/abbe-linuxcnc.lock || skip "another user tests it"
flock -w 240 9 || skip "another test of it is running"
if pidof -q rtapi_app milltask; then skip "another one is running"; fi
for module in abbe plant; do
    [ ! -e "$modules/$module.so" ] || skip "there is a $modules/$module.so, which is not this test's to replace"
done

if [ -z "${ABBE:-}" ]; then
    cargo build --quiet --manifest-path ../../Cargo.toml
    ABBE="${CARGO_TARGET_DIR:-../../target}/debug/abbe"
fi
ABBE="$(realpath "$ABBE")"
if [ -z "${JUDGE:-}" ]; then
    cargo build --quiet --manifest-path ../../Cargo.toml --example linuxcnc
    JUDGE="${CARGO_TARGET_DIR:-../../target}/debug/examples/linuxcnc"
fi
JUDGE="$(realpath "$JUDGE")"
here="$PWD"
profile="${PROFILE:-dev}"
libraries="$(realpath -m "${CARGO_TARGET_DIR:-../c-controller/target}")/${profile/dev/debug}"

folder="$(mktemp -d)"
# Who runs LinuxCNC: this user; in place of root, one who may do nothing.
as_user=()
[ "$(id -u)" != 0 ] || as_user=(runuser -u nobody --)
end() {
    # What is left of it, by the folder that it was started in: nothing else of this machine is touched.
    for process in $(pidof rtapi_app milltask halsampler || true); do
        if [ "$(readlink "/proc/$process/cwd")" = "$folder" ]; then kill "$process" 2>/dev/null || true; fi
    done
    rm -f "$modules/abbe.so" "$modules/plant.so"
    rm -rf "$folder"
}
trap end EXIT
if [ -n "${KEEP:-}" ]; then trap 'cp -r "$folder" "$KEEP"; end' EXIT; fi

flags=(-Os -Wall -Wextra -Wno-unused-parameter -fPIC -shared -DRTAPI -DUSPACE -DSIM -D_GNU_SOURCE -Drealtime -D__MODULE__
    -isystem /usr/include/linuxcnc)
# Builds both components of a machine from its machine file and its header for the plant, in the place of those before.
components() {
    (cd "$here/../c-controller" && ABBE_MACHINE="$1" cargo build --quiet --profile "$profile")
    cc "${flags[@]}" -I "$here/../../c-interface/include" -o abbe.so "$here/abbe.c" "$libraries/libmill.a" \
        -Wl,--gc-sections -Wl,--exclude-libs,ALL -lpthread -ldl -lm
    cc "${flags[@]}" -I . -DMACHINE="\"$here/$2\"" -o plant.so "$here/plant.c" -lm
    install -m 644 abbe.so plant.so "$modules"
}

# Runs LinuxCNC with an INI file until its operator has left a file of this name.
run() {
    [ "$(id -u)" != 0 ] || chown -R nobody .
    timeout 150 "${as_user[@]}" env -u DISPLAY HOME="$folder" linuxcnc -r "$1" > linuxcnc.log 2>&1 || true
    if [ ! -e "$2" ]; then
        echo "LinuxCNC did not run to the end:"
        cat linuxcnc.log
        exit 1
    fi
}

cp mill.hal sampled.hal screw.hal mill.ngc mill-12.yaml drive.py screw.py five.tcl five.py "$folder"
sed "s#^CALIBRATION = .*#CALIBRATION = $folder/mill-12.yaml#" mill.ini > "$folder/mill.ini"
cd "$folder"
touch mill.tbl mill.var
components mill.yaml mill.h
run mill.ini driven

# LinuxCNC by itself with the tables that abbe writes: X of positions, Y of trims, Z with a comment at its top, which is no table.
tables="$here/../../calibrations/postech-mill.yaml"
"$ABBE" export linuxcnc "$tables" --type 0 > exported.txt
mv x.comp positions.comp
"$ABBE" export linuxcnc "$tables" --force >> exported.txt
sed -i '1i # the screw of Z' z.comp
sed -e '/^HALFILE = sampled/d' -e 's/^HALFILE = .*/HALFILE = screw.hal/' -e 's/drive\.py/screw.py/' \
    -e 's/^MAX_LIMIT = [34]00/MAX_LIMIT = 600/' -e 's/^\(MIN_\)\?FERROR = .*/\1FERROR = 1/' \
    -e 's/^\[JOINT_0\]/&\nCOMP_FILE = positions.comp\nCOMP_FILE_TYPE = 0/' \
    -e 's/^\[JOINT_1\]/&\nCOMP_FILE = y.comp\nCOMP_FILE_TYPE = 1/' \
    -e 's/^\[JOINT_2\]/&\nCOMP_FILE = z.comp\nCOMP_FILE_TYPE = 1/' mill.ini > screw.ini
run screw.ini screwed
"$JUDGE" screw screw.txt 0:positions.comp 1:y.comp 1:z.comp

# What a controller would have written down without compensation, and a calibration that knows nothing of the play of Y.
"$JUDGE" samples samples.txt recording.csv
cp "$here/mill-12.yaml" "$here/recording.yaml" "$here/../c-controller/mill.yaml" .
sed -e 's/^machine: .*/machine: mill.yaml/' -e '/^  EYY:/,/^  EAY:/{/backlash/d}' mill-12.yaml > hidden.yaml
"$ABBE" diagnose recording.yaml --quiet
"$ABBE" diagnose recording.yaml --quiet --format json > diagnosis.json
"$JUDGE" diagnosis diagnosis.json

# Writes five.ini from that of the mill: the name of the machine, its kinematics, and the letters of its joints.
five_ini() {
    sed -e '/^\[AXIS_X\]/,$d' -e 's/^HALFILE = mill.hal/HALFILE = five.tcl/' -e "s/^HALFILE = sampled.hal/HALFILE = $1.hal/" \
        -e 's/drive\.py/five.py/' -e "s#^CALIBRATION = .*#CALIBRATION = $folder/specimen.yaml\nAXES = ${3/W/}#" \
        -e "s/^KINEMATICS = .*/KINEMATICS = $2/" -e "s/^JOINTS = .*/JOINTS = ${#3}/" -e "s/^COORDINATES = .*/COORDINATES = $3/" \
        -e 's/^\(.*\)_LINEAR_VELOCITY = .*/\1_LINEAR_VELOCITY = 300\n\1_ANGULAR_VELOCITY = 180/' mill.ini
    # A following error of 0.5 um or 1.8 arcsec stops the machine.
    local joint letter type
    for ((joint = 0; joint < ${#3}; joint++)); do
        letter="${3:joint:1}" type=LINEAR
        [[ $letter != [ABC] ]] || type=ANGULAR
        local bounds="MIN_LIMIT = -1000\nMAX_LIMIT = 1000\nMAX_VELOCITY = 300\nMAX_ACCELERATION = 2000\n"
        printf "[AXIS_$letter]\n$bounds[JOINT_$joint]\nTYPE = $type\n${bounds}FERROR = 0.0005\nMIN_FERROR = 0.0005\nHOME_SEQUENCE = 0\n"
    done
}

# The simulated machine of five axes with this name, by LinuxCNC's kinematics.
five() {
    echo "$1, $2:"
    cp "$here/$1.yaml" "$here/$1.hal" .
    cp "$here/$1.yaml" machine.yaml
    cp "$here/$1.ngc" five.ngc
    rm -f fived
    "$here/draw.py" "${SEED:-1}" machine.yaml "${3/W/}"
    "$ABBE" derive machine.yaml --format json > equations.json
    components "$folder/machine.yaml" "$1.h"
    five_ini "$1" "$2" "$3" > five.ini
    run five.ini fived
    grep 'um apart$' linuxcnc.log
    "$JUDGE" five five.txt
}
five trunnion xyzac-trt-kins XYZAC
five head 5axiskins XYZBCW
