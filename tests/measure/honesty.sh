#!/bin/sh
# Is the reference as right as it says, on mechanisms that nobody tuned for? Holds it against 128-bit
# integration on seeded random cases, each shortened to its first contacts, and prints the quantiles of
# error over stated uncertainty: all of them, by law, by damping and by decade of speed; the worst cases
# with their seeds; and how many cases had no truth, with reasons. Status 1 where an uncertainty is 0 or
# more than one case in a hundred has an error above three uncertainties.
#
# tests/measure/honesty.sh BUILD [KIND:FIRST:LAST...]
#   KIND  of build/tests/measure/random_case (default four-bar:1:500 bodies:1:200: some 40 minutes)
# SECONDS_EACH of processor time bound each truth (default 8); LINES=FILE keeps a line of each case.
set -eu
build=$(cd "$1" && pwd)
[ -x "$build/tests/truth/measure_honesty" ] || {
    echo "honesty.sh: $build has no tests/truth/measure_honesty: build it with gcc and -Dtests=enabled" >&2
    exit 2
}
shift
[ $# -gt 0 ] || set -- four-bar:1:500 bodies:1:200
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
lines=${LINES:-$work/lines}
: >"$lines"

for range in "$@"; do
    kind=${range%%:*}
    seeds=${range#*:}
    for seed in $(seq "${seeds%:*}" "${seeds#*:}"); do
        name=$kind-$seed
        "$build/tests/measure/random_case" "$kind" "$seed" >"$work/$name"
        # the tool bounds the truth; what else may take long is the reference
        (cd "$work" && timeout $((10 * ${SECONDS_EACH:-8})) \
            "$build/tests/truth/measure_honesty" "$name" 1e-15 "${SECONDS_EACH:-8}") \
            >"$work/line" 2>"$work/words" ||
            echo "$name - - - 0 0 0 0 0 0 0 0 0 0 0 failed: $(head -c 120 "$work/words" | tr '\n' ' ')" \
                >"$work/line"
        cat "$work/line" >>"$lines"
        rm "$work/$name"
    done
done

awk '
function quantiles(group, name,    n, i, j, x, values) {
    n = split(group, values, " ")
    for (i = 2; i <= n; i++) {
        x = values[i] + 0
        for (j = i - 1; j >= 1 && values[j] + 0 > x; j--) values[j + 1] = values[j]
        values[j + 1] = x
    }
    printf "%-24s %5d  %8.3g %8.3g %8.3g %8.3g\n", name, n, values[1 + int(0.05 * (n - 1))],
        values[1 + int(0.5 * (n - 1))], values[1 + int(0.95 * (n - 1))], values[n]
}
$16 !~ /^(ok|truth-stopped)$/ { why = $0; sub(/^([^ ]+ +){15}/, "", why); failed[$1] = why; none++; next }
$9 == 0 || $8 == 0 { idle++; if ($11 == 0) zero++; next }
{
    count++
    if ($11 == 0) zero++
    if ($16 == "truth-stopped") stopped++
    ratio = $11 > 0 ? $12 / $11 : 1e300
    if (ratio > 3) above++
    all = all " " ratio
    law["law " $3] = law["law " $3] " " ratio
    damping["damping " $4] = damping["damping " $4] " " ratio
    rpm = $6 == 0 ? "no drive" : $6 < 100 ? "30 to 100 rpm" : $6 < 1000 ? "100 to 1000 rpm" : "1000 to 3000 rpm"
    speed[rpm] = speed[rpm] " " ratio
    if (ratio > worst) { worst = ratio; where = $0 }
}
END {
    printf "%d cases: %d measured (%d of them up to where the truth stopped), %d without a contact, %d without a truth\n",
        count + idle + none, count, stopped, idle, none
    printf "uncertainty 0: %d; error above 3 uncertainties: %d (%.2g %%)\n", zero, above, count ? 100 * above / count : 0
    print "worst, by error over uncertainty: " where
    print ""
    print "error over uncertainty     cases       5 %   median     95 %    worst"
    if (count) {
        quantiles(all, "all")
        for (name in law) quantiles(law[name], name)
        for (name in damping) quantiles(damping[name], name)
        for (name in speed) quantiles(speed[name], name)
    }
    for (name in failed) print "no truth: " name ": " failed[name]
    exit zero > 0 || above > 0.01 * count
}' "$lines"
