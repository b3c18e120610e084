#!/bin/sh
# Does every awkward mechanism end, and with which words? Thirty of them (equal ones side by side,
# locks, change points, starts on the wall, separating ones) on the reference, in ODE at a step of
# 1 us and at a step that is chosen.
#
# tests/measure/awkward.sh BUILD [LIMIT] prints kind and seed, solver, seconds of processor time,
# exit status and message; ends with status 1 where one takes longer than LIMIT seconds (10) or fails
# without a word about when or why. Some minutes.
set -u
build=$1
limit=${2:-10}
program=$build/src/cli/jointplay
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
late=0

# run_one KIND SEED SOLVER OPTION...
run_one() {
    kind=$1 seed=$2 solver=$3
    shift 3
    bash -c 'TIMEFORMAT="%U"; time timeout -s KILL "$0" "$@" >"$OUT" 2>"$WORDS"' \
        $((limit * 6)) "$program" run "$scratch/case.yaml" --quiet "$@" 2>"$scratch/time"
    status=$?
    seconds=$(tail -n 1 "$scratch/time")
    words=$(grep -v 'jointplay: warning' "$WORDS" | sed 's/.*case.yaml[^:]*: *//' | head -n 1)
    printf '%-12s %2s  %-9s %7s  %3d  %s\n' "$kind" "$seed" "$solver" "$seconds" "$status" "$words"
    if [ "$status" -ne 0 ] && { [ "$status" -gt 4 ] || [ -z "$words" ]; } ||
        [ "${seconds%.*}" -ge "$limit" ]; then
        late=$((late + 1))
    fi
}

export OUT="$scratch/out" WORDS="$scratch/words"
printf '%-12s %2s  %-9s %7s  %3s  %s\n' kind "" solver seconds end message
for kinds in "pendula 4" "four-bars 4" "lock 8" "change-point 4" "touching 6" "separating 4"; do
    kind=${kinds% *}
    seed=0
    while [ "$seed" -lt "${kinds#* }" ]; do
        "$build/tests/measure/random_case" "$kind" "$seed" >"$scratch/case.yaml"
        run_one "$kind" "$seed" reference --backend reference
        run_one "$kind" "$seed" "ode 1 us" --backend ode
        run_one "$kind" "$seed" "ode auto" --backend ode --step auto
        seed=$((seed + 1))
    done
done
echo "$late beyond $limit s or without words"
[ "$late" -eq 0 ]
