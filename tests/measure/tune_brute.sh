#!/bin/sh
# Is what `jointplay tune` finds as cheap as what can be found by running everything?
#
# Usage: tune_brute.sh PROGRAM CASE ERROR [compare and tune options, such as --set ...]
# Runs tune, then compare with all usual schemes over a ladder twice as fine as tune's grid, coarse
# enough to begin before anything meets the error and fine enough to end where every scheme costs
# more than what tune found, a step being 1.1 us at the least. Prints the setting of tune, the cheapest of the ladder by wall time and
# by world steps, and the ratios. Times of both are those of compare, so that they are of one kind.
# Not part of the tests: minutes.
set -eu
program=$1
case=$2
error=$3
shift 3
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
export XDG_CACHE_HOME="$work"

for cost in time steps; do
    "$program" tune "$case" --error "$error" --cost "$cost" --quiet "$@" >"$work/$cost.txt" || true
done

# setting COST: scheme, step in us, world steps and wall time in ms of what tune found
setting() {
    awk '/^  setting/ { sub(/^ *setting */, ""); sub(/, step /, " "); sub(/ us$/, ""); one = $0 }
         /^  cost/ { print one, $2, $5; exit }' "$work/$1.txt"
}
finest=$({ setting time; setting steps; } | awk '
    { step = $2 * $3 * 1.1e-3 / $4; if (NR == 2) step = $2; if (best == "" || step < best) best = step }
    END { print best }')

# compare takes 32 steps at most: ladders of R20
all="500 450 400 355 315 280 250 224 200 180 160 140 125 112 100 90 80 71 63 56 50 45 40 35.5 31.5 28 \
25 22.4 20 18 16 14 12.5 11.2 10 9 8 7.1 6.3 5.6 5 4.5 4 3.55 3.15 2.8 2.5 2.24 2 1.8 1.6 1.4 1.25 \
1.12 1 0.9 0.8 0.71 0.63 0.56 0.5 0.45 0.4 0.355 0.315 0.28 0.25 0.224 0.2 0.18 0.16 0.14 0.125"
steps=$(echo "$all" | tr ' ' '\n' | awk -v finest="$finest" '$1 >= 0.999 * finest')
ladder=
count=0
for step in $steps end; do
    if [ "$step" = end ] || [ "$count" -eq 32 ]; then
        "$program" compare "$case" --quiet --jobs 1 --steps "$ladder" --csv "$work/part.csv" "$@" >/dev/null
        tail -n +2 "$work/part.csv" >>"$work/all.csv"
        ladder=
        count=0
    fi
    ladder="$ladder${ladder:+, }$step us"
    count=$((count + 1))
done

for cost in time steps; do
    found=$(setting "$cost")
    scheme=${found%% *}
    step=$(echo "$found" | cut -d' ' -f2)
    awk -F, -v scheme="$scheme" -v step="$step" -v target="$error" -v cost="$cost" '
        # the first time through the file the rates of the schemes
        $3 != "ok" || $1 == "reference" || $1 == "analytic" { next }
        { work = $4 + $5 / 20 + 900 }
        NR == FNR {
            if (!($1 in rate) || $13 / work < rate[$1]) { rate[$1] = $13 / work }
            next
        }
        { value = cost == "time" ? 1e3 * work * rate[$1] : $4 + 0 }
        $1 == scheme && $2 * 1e6 > 0.999 * step && $2 * 1e6 < 1.001 * step { found = value; e = $6 }
        $6 != "" && $6 + 0 <= target && (best == "" || value < best) {
            best = value; name = $1; at = $2 * 1e6; be = $6
        }
        END {
            unit = cost == "time" ? "ms" : "steps"
            printf "%-5s tune: %s at %s us, error %.2e, %.4g %s; brute force: %s at %g us, error %.2e, %.4g %s; ratio %.2f\n",
                cost, scheme, step, e, found, unit, name, at, be, best, unit, found / best
        }' "$work/all.csv" "$work/all.csv"
done
