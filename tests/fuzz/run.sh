#!/usr/bin/env bash
# Runs one of libFuzzer's targets for some time: a corpus is made from the project's own cases,
# broken cases, studies, baselines and a comparison, and mutated. Ends with status 1 at a finding,
# whose input it keeps and names; the target run with that file alone shows it again.
#
# tests/fuzz/run.sh TARGET [SECONDS [SEED [BUILD [CORPUS]]]]
#   TARGET   case, study, baseline, journal or store
#   SECONDS  (default 60)
#   SEED     (default 1)
#   BUILD    a build folder, made with clang where it is not there (default build-fuzz)
#   CORPUS   a folder in which inputs that reach new code are kept (default: a temporary one)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${1:?a target: case, study, baseline, journal or store}
seconds=${2:-60}
seed=${3:-1}
build=$(realpath -m "${4:-$root/build-fuzz}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
corpus=$(realpath -m "${5:-$work/corpus}")

if [ ! -f "$build/build.ninja" ]; then
    CC=clang meson setup "$build" "$root" -Dtests=enabled -Dfuzzers=true \
        -Dbuildtype=debugoptimized -Db_sanitize=address,undefined -Db_lundef=false >/dev/null
fi
ninja -C "$build" --quiet "tests/fuzz/fuzz_$target" >/dev/null

mkdir -p "$work/seeds" "$corpus"
copy() { # the files, each under a name of its own
    local file
    for file in "$@"; do
        cp "$file" "$work/seeds/$(echo "${file#"$root"/}" | tr / _)"
    done
}
bad() { # the documents of a table of bad ones
    ninja -C "$build" --quiet "tests/unit/test_bad_$1" >/dev/null
    (cd "$root" && "$build/tests/unit/test_bad_$1" --files "$work/seeds")
}
case $target in
case)
    copy "$root"/cases/{paper,literature,hard,mechanisms,space}/*.yaml
    bad cases
    {
        cat "$root/cases/paper/impact-k66.yaml"
        printf '#--set run.step=2 us\n#--set joints.crank-coupler.hole=10.1 mm\n'
    } >"$work/seeds/overrides"
    ;;
study)
    copy "$root"/cases/studies/*.yaml
    bad studies
    # the broken ones name cases of other folders
    sed -i -E 's|^case: .*/(paper)/|case: ../\1/|' "$work"/seeds/*
    ;;
baseline) copy "$root"/results/baseline/*.json ;;
journal) copy "$root"/tests/fuzz/journal/* ;;
store)
    ninja -C "$build" --quiet src/cli/jointplay >/dev/null
    cat >"$work/study.yaml" <<STUDY
case: $root/cases/paper/impact-k66.yaml
vary: {run.step: [20 us, 50 us]}
STUDY
    "$build/src/cli/jointplay" study "$work/study.yaml" --store="$work/store" >"$work/log" 2>&1 || {
        cat "$work/log"
        exit 1
    }
    cp "$work/store" "$work/seeds/store"
    # with the journal of a write that was cut short: SQLite's magic, a page count, the page size
    {
        cat "$work/store"
        printf '<journal>\331\325\005\371\040\241\143\327\000\000\000\001\000\000\000\000'
        printf '\000\000\000\005\000\000\002\000\000\000\020\000'
        head -c 484 /dev/zero
        printf '\000\000\000\001'
        head -c 4096 "$work/store"
        head -c 4 /dev/zero
    } >"$work/seeds/hot"
    ;;
*)
    echo "$0: no target $target" >&2
    exit 2
    ;;
esac

# words of the format, so that mutations hit upon keys
grep -oE '[A-Za-z][A-Za-z0-9.^/-]{2,30}' "$root/docs/case-format.md" "$root/docs/study-format.md" -h |
    sort -u | sed 's/.*/"&"/' >"$work/words"
if [ "$target" = baseline ] || [ "$target" = journal ]; then
    grep -ohE '"[A-Za-z_-]{2,30}"' "$root"/results/baseline/ideal-nominal.json \
        "$root"/tests/fuzz/journal/* | sort -u >"$work/words"
fi

export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=$root/tests/support/lsan.supp:print_suppressions=0
status=0
"$build/tests/fuzz/fuzz_$target" "$corpus" "$work/seeds" -dict="$work/words" -seed="$seed" \
    -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2000 -max_len=20000 -print_final_stats=1 \
    -artifact_prefix="$PWD/finding-$target-" >"$work/log" 2>&1 || status=1
grep -E 'stat::(number_of_executed_units|peak_rss)|^Done' "$work/log" || true
if [ "$status" != 0 ]; then
    grep -vE '^#|^(INFO|NEW|REDUCE)' "$work/log" | tail -n 40
    echo "a finding of target $target, seed $seed"
    exit 1
fi
