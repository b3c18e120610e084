#!/bin/sh
# Writes a case of N four-bars in a row: problem A02 of the IFToMM benchmark library. Uniform links
# of 1 m and 1 kg, started upright with 1 m/s at their tips. While the branch of parallelograms is
# kept all uprights stand at one angle theta from the vertical, for every N:
#     theta'' = k sin theta,   k = 9.81 * 3 (3 N + 1) / (2 (4 N + 1)),   theta(0) = 0, theta'(0) = 1
#     usage: many_four_bars.sh N [DURATION]
set -eu
count=${1:?usage: many_four_bars.sh N [DURATION]}
duration=${2:-10 s}

cat <<END
# N four-bars in a row, N = $count: problem A02 of the IFToMM benchmark library of multibody dynamics;
# written by tests/measure/many_four_bars.sh. While the parallelograms are kept all uprights stand at
# one angle theta from the vertical, theta'' = 9.81 * 3 (3 N + 1) / (2 (4 N + 1)) sin theta. At a
# change point ideal joints leave open how the motion goes on: perturbed runs, whose lengths differ
# in the last digit, go other ways there, so that the reference is exact and cannot be certified.
END
echo "title: N = $count four-bars in a row, through their change points"
echo "bodies:"
i=0
while [ "$i" -le "$count" ]; do
    echo "  upright-$i: {mass: 1 kg, inertia: 0.083333333333333333 kg m^2, at: [$i m, 0.5 m]," \
        "angle: 90 deg,"
    echo "              velocity: [0.5 m/s, 0 m/s], spin: -1 rad/s}"
    if [ "$i" -lt "$count" ]; then
        echo "  coupler-$i: {mass: 1 kg, inertia: 0.083333333333333333 kg m^2, at: [$i.5 m, 1 m]," \
            "velocity: [1 m/s, 0 m/s]}"
    fi
    i=$((i + 1))
done
echo "joints:"
i=0
while [ "$i" -le "$count" ]; do
    echo "  foot-$i:  {between: [ground, upright-$i], at: [$i m, 0 m]}"
    if [ "$i" -lt "$count" ]; then
        echo "  left-$i:  {between: [upright-$i, coupler-$i], at: [$i m, 1 m]}"
        echo "  right-$i: {between: [coupler-$i, upright-$((i + 1))], at: [$((i + 1)) m, 1 m]}"
    fi
    i=$((i + 1))
done
echo "gravity: 9.81 m/s^2"
echo "run: {duration: $duration, samples: 1000, step: 0.5 ms}"
echo "ode: {stepping: extrapolated}"
