#!/bin/sh
# Do the tests see small faults in the sources? Puts seeded random faults into src/, one at a time,
# builds, and runs the tests until one fails: a comparison turned round or made strict, a sign, a
# factor, a condition that always holds, a result 'true' for 'false', a statement left out.
#
# tests/measure/faults.sh [COUNT [FIRST [PROCESSES]]]
#   COUNT      faults (default 100)
#   FIRST      the first seed (default 1)
#   PROCESSES  tests at a time (default 2)
# Prints each fault with its seed, place, what saw it and how (on a busy machine, repeat what only a
# TIMEOUT saw), and at the end the share that was seen.
# A fault that nothing sees either does not matter (say why) or needs a test. A minute a fault.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
count=${1:-100}
first=${2:-1}
processes=${3:-2}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/tree
mkdir "$tree"
git -C "$root" archive HEAD | tar -x -C "$tree"
meson setup "$work/build" "$tree" -Dtests=enabled >/dev/null || exit 2
ninja -C "$work/build" --quiet >/dev/null || exit 2
cd "$tree" || exit 2
find src -name '*.c' | sort | xargs grep -nE '[;{)]' |
    grep -vE ':[0-9]+: *(//|assert|#|static const|enum|const [A-Za-z]+ [A-Z_]+ =)' >"$work/lines"

# Writes the changed line of the fault of a seed, after its file and number; nothing where the line
# has nothing to change.
draw() {
    awk -v seed="$1" '
        function next_number() { # Lehmer, modulus 2^31 - 1
            state = state * 48271 % 2147483647
            return state
        }
        { lines[NR] = $0 }
        END {
            state = seed * 7919 % 2147483647
            for (i = 0; i < 5; i++) next_number()
            split(lines[next_number() % NR + 1], parts, ":")
            text = lines[state % NR + 1]
            sub(/^[^:]*:[0-9]*:/, "", text)
            count = split("return false;|return true;~return true;|return false;~ < | <= ~ <= | < ~ > | < ~ >= | > ~ == | != ~ != | == ~ [+] | - ~ - | + ~ [*] | / ~ && | || ~ [|][|] | \\&\\& ~0[.]5|0.6~fmin[(]|fmax(~fmax[(]|fmin(~[+][+]|--~if [(]!|if (~if [(]|if (!~^ +[a-z_>.-]+([[][a-z]+[]])? [+-]?= .*;$|;~^ +[a-z_]+[(].*[)];$|;", kinds, "~")
            start = next_number() % count
            for (i = 0; i < count; i++) {
                kind = kinds[(start + i) % count + 1]
                at = match(kind, /[^[][|][^]]/)
                pattern = substr(kind, 1, at)
                changed = text
                if (sub(pattern, substr(kind, at + 2), changed) && changed != text) {
                    print parts[1]
                    print parts[2]
                    print changed
                    exit
                }
            }
        }' "$work/lines"
}

# Runs tests until one fails; false then, with the result in the log.
run_tests() {
    meson test -C "$work/build" --no-rebuild --num-processes "$processes" --maxfail 1 "$@" \
        >"$work/log" 2>&1
}

# Whether the reference is made of a file: tests of its truth need not be asked about others.
is_of_reference() {
    case $1 in
    src/base/* | src/kernel/* | src/model/* | src/contact/* | src/reference/* | src/run/* | src/measure/*) true ;;
    *) false ;;
    esac
}

# The first test that fails with a fault in a file, or nothing. Those that take less time come first.
find_witness() {
    groups="0 1 2 3"
    ! is_of_reference "$1" || groups="$groups truth"
    for group in $groups; do
        # shellcheck disable=SC2046 # the names are words
        if ! run_tests $(cat "$work/tests.$group"); then
            sed -n 's/^ *[0-9]*\/[0-9]* [^ ]* *[^ ]* *\/ *\([a-z_0-9]*\) *\(FAIL\|ERROR\|TIMEOUT\).*/\1 \2/p' \
                "$work/log" | head -n 1
            return
        fi
    done
}

# without a fault no test fails; its times give the order
if ! run_tests --no-suite cluster; then
    cat "$work/log"
    exit 1
fi
for group in 0 1 2 3; do
    sed -n 's/^{"name": "[^"]* \([a-z_0-9]*\)".*"duration": \([0-9.e-]*\),.*/\1 \2/p' \
        "$work/build/meson-logs/testlog.json" |
        awk -v group=$group '{ at = $2 < 0.2 ? 0 : $2 < 1 ? 1 : $2 < 5 ? 2 : 3 }
            at == group && $1 !~ /^truth|against_truth|stated_uncertainty/ && !named[$1]++ { print $1 }' >"$work/tests.$group"
done
echo "--suite truth" >"$work/tests.truth"

tried=0
seen=0
seed=$first
while [ "$tried" -lt "$count" ]; do
    draw "$seed" >"$work/fault"
    file=$(sed -n 1p "$work/fault")
    number=$(sed -n 2p "$work/fault")
    sed -n 3p "$work/fault" >"$work/line"
    if [ -n "$file" ]; then
        cp "$file" "$work/kept"
        sed "${number}{r $work/line
            d}" "$work/kept" >"$file"
        # what does not compile is no fault
        if ninja -C "$work/build" --quiet >/dev/null 2>&1; then
            tried=$((tried + 1))
            witness=$(find_witness "$file")
            [ -z "$witness" ] || seen=$((seen + 1))
            printf '%d %s:%d: %s -> %s: %s\n' "$seed" "$file" "$number" \
                "$(sed -n "${number}s/^ *//p" "$work/kept")" "$(sed 's/^ *//' "$work/line")" \
                "${witness:-NOT SEEN}"
        fi
        cp "$work/kept" "$file"
    fi
    seed=$((seed + 1))
done
echo "$seen of $tried faults seen"
