#!/bin/sh
# Does jointplay build and pass its tests of other engines with none of them, with each alone and
# with all, and say which there are? Prints a table; some minutes.
#     engines_alone.sh SOURCE_ROOT WORK_FOLDER
set -u
root=$1
work=$2
all='mujoco chipmunk bullet simbody'
status=0

# Builds with these engines alone, and tests.
try() {
    build=$work/$1
    shift
    options=
    for engine in $all; do
        case " $* " in
        *" $engine "*) options="$options -D$engine=enabled" ;;
        *) options="$options -D$engine=disabled" ;;
        esac
    done
    [ -d "$build" ] || meson setup "$build" "$root" -Dtests=enabled $options >"$build.log" 2>&1
    targets='src/cli/jointplay tests/engine/test_driver'
    for engine in "$@"; do
        targets="$targets src/drivers/jointplay-$engine tests/engine/test_$engine"
    done
    nice ninja -C "$build" $targets >>"$build.log" 2>&1 || status=1
    said=$("$build/src/cli/jointplay" --version | sed -n 's/^drivers of other engines: //p')
    wanted=$(printf '%s\n' "$@" | sort | paste -sd, | sed 's/,/, /g')
    [ "$said" = "${wanted:-none}" ] || status=1
    tests='engines_as_backends driver compare_engines kernel_page'
    (cd "$build" && nice meson test --no-rebuild $tests "$@") >>"$build.log" 2>&1 || status=1
    passed=$(sed -n 's/^Ok: *\([0-9]*\).*/\1/p' "$build.log" | tail -1)
    failed=$(sed -n 's/^Fail: *\([0-9]*\).*/\1/p' "$build.log" | tail -1)
    size=$(stat -c %s "$build/src/cli/jointplay")
    printf '%-40s says: %-36s ok %s, failed %s, program %s bytes\n' "${*:-none}" "$said" "$passed" \
        "$failed" "$size"
}

mkdir -p "$work"
try none
for engine in $all; do
    try "$engine" "$engine"
done
try all $all
exit $status
