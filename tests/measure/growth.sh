#!/bin/sh
# How do time and memory of a step grow with the number of bodies? A table for each way of solving:
# us a step, KiB, and the exponents of time and memory from each N to the next.
#     usage: growth.sh BUILD [MOST [SOLVER...]]
set -eu
build=${1:?usage: growth.sh BUILD [MOST [SOLVER...]]}
most=${2:-1024}
[ "$#" -lt 2 ] && shift 1 || shift 2
[ "$#" -gt 0 ] || set -- direct quick staggered impulse reference

for solver in "$@"; do
    for kind in chain pendula four-bars row scissor; do
        plays="ideal loose space space-loose"
        case "$solver-$kind" in
        reference-chain | reference-row) plays="$plays damped space-damped" ;;
        esac
        for play in $plays; do
            echo "$solver, $kind, $play"
            echo "       N     us/step  evaluations      KiB   time^  memory^"
            count=1
            while [ "$count" -le "$most" ]; do
                line=$("$build/tests/measure/growth" "$kind" "$play" "$solver" "$count" 2>&1) ||
                    { echo "$count: $line" && break; }
                echo "$count $line"
                count=$((count * 4))
            done | awk '
                / us a step / {
                    if (n > 0) {
                        printf "%8d %11.2f %12.1f %8d %7.2f %8.2f\n", $1, $6, $10, $14,
                               log($6 / us) / log($1 / n), log($14 / kib) / log($1 / n)
                    } else {
                        printf "%8d %11.2f %12.1f %8d\n", $1, $6, $10, $14
                    }
                    n = $1; us = $6; kib = $14
                    next
                }
                { print }'
        done
    done
done
