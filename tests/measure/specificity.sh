#!/usr/bin/env bash
# Does a check cry wolf? Builds the sources with gcc and clang, at -O0, -O2 and -O3, without FMA, with
# FMA instructions allowed but no contraction (as the project has it), and with contraction, and runs
# `jointplay check` against the committed baselines with the inputs rounded anew, seed by seed. Nothing
# has changed, so every difference is a false alarm. Prints their rate and its 95 % upper bound.
# Ends with status 1 where there was one.
#
# ODE and libccd are those of the system: only our own code is built in other ways.
#
# tests/measure/specificity.sh [SEEDS [FULL [FOLDER]]]
#   SEEDS   quick checks a build (default 20)
#   FULL    full checks a build (default 0)
#   FOLDER  where to build, kept; else a temporary one
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
seeds=${1:-20}
full=${2:-0}
if [ $# -gt 2 ]; then
    mkdir -p "$3"
    work=$(cd "$3" && pwd)
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
cd "$root" || exit 1

# the sources as they are now, so that they may be worked on meanwhile
rm -rf "$work/tree"
mkdir -p "$work/tree"
for part in meson.build meson_options.txt README.md CHANGELOG.md LICENSE include src cases results docs tests; do
    cp -r "$part" "$work/tree/"
done

builds=0
quick_checks=0
full_checks=0
alarms=0
broken=0

# One check; status 1 is a false alarm, anything else but 0 a failure of the measurement.
one() {
    local name=$1
    shift
    (cd "$work/tree" && "$program" check --quiet "$@" >"$work/out" 2>"$work/errors")
    local status=$?
    if [ "$status" = 1 ]; then
        alarms=$((alarms + 1))
        echo "false alarm: $name, $*: $(head -n 1 "$work/errors")"
    elif [ "$status" != 0 ]; then
        broken=$((broken + 1))
        echo "not checked: $name, $*: $(head -n 1 "$work/errors")"
    fi
}

fma=""
grep -qw fma /proc/cpuinfo && fma="off on"
for compiler in gcc clang; do
    for level in 0 2 3; do
        for contraction in none $fma; do
            flags="-O$level"
            [ "$contraction" = none ] || flags="$flags -mfma -ffp-contract=$contraction"
            # gcc's word for it is fast; clang's on stays within an expression
            [ "$contraction" != on ] || [ "$compiler" = clang ] || flags="-O$level -mfma -ffp-contract=fast"
            name="$compiler $flags"
            folder="$work/$compiler-$level-$contraction"
            rm -rf "$folder"
            CC=$compiler meson setup "$folder" "$work/tree" -Dtests=disabled \
                --buildtype=plain -Dc_args="$flags" >"$work/log" 2>&1
            if ! nice ninja -C "$folder" src/cli/jointplay >"$work/log" 2>&1; then
                echo "not built: $name"
                tail -n 5 "$work/log"
                broken=$((broken + 1))
                continue
            fi
            program=$folder/src/cli/jointplay
            builds=$((builds + 1))
            one "$name" --quick
            # a processor without fused multiplications: the mathematical library has other digits
            without='glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4'
            GLIBC_TUNABLES=$without one "$name, another mathematical library" --quick
            quick_checks=$((quick_checks + 2))
            for seed in $(seq 1 "$seeds"); do
                # every build other machines: without contraction all builds give the same bits
                one "$name" --quick --shake $((seed + 1000 * builds))
                quick_checks=$((quick_checks + 1))
            done
            for seed in $(seq 1 "$full"); do
                one "$name" --shake $((seed + 1000 * builds + 500))
                full_checks=$((full_checks + 1))
            done
            fused=$(objdump -d "$program" 2>/dev/null | grep -c vfmadd)
            echo "$name: $fused FMA instructions, checks so far $quick_checks quick," \
                "$full_checks full, $alarms false alarms"
        done
    done
done

python3 - "$((quick_checks + full_checks))" "$alarms" <<'EOF'
import sys
n, k = int(sys.argv[1]), int(sys.argv[2])
# Clopper and Pearson's one-sided bound: the rate at which k or fewer alarms have a chance of 5 %
def chance(p):
    total, term = 0.0, (1.0 - p) ** n
    for i in range(k + 1):
        total += term
        term *= (n - i) / (i + 1.0) * p / (1.0 - p)
    return total
low, high = 0.0, 1.0 - 1e-12
for _ in range(100):
    middle = 0.5 * (low + high)
    low, high = (middle, high) if chance(middle) > 0.05 else (low, middle)
print("%d false alarms in %d checks: rate %.4f, with 95 %% confidence below %.4f" % (k, n, k / n, high))
EOF
[ "$alarms" = 0 ] && [ "$broken" = 0 ]
