#!/bin/sh
# Is every file there that an option asks for, if the exit status is 0? Every option that names a
# file, taken from the help of the commands, over several kinds of case, quiet: a file that is not
# there needs another status and a reason, and one that is refused is not begun. Prints TAP.
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
program=$1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"
cd "$work" || exit 1
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME

pin='bodies: {pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}}
joints:
  hole: {between: [ground, pin], at: [0 mm, 0 mm], radial-clearance: 0.1 mm, pin: 10 mm, width: 15 mm}'
run='run: {duration: 6 ms, samples: 60, step: 5 us}'
mkdir cases
printf '%s\n' "$pin" 'contact: {stiffness: 1e8 N/m, restitution: 0.9}' "$run" >cases/play.yaml
cat >cases/poisson.yaml <<'END'
four-bar:
  ground:   {length: 254 mm}
  crank:    {length: 108 mm, mass: 0.12 kg, inertia: 173.92 kg mm^2}
  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}
  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}
joints: {crank-coupler: {hole: 10.015 mm, pin: 9.986 mm}}
drive: {speed: 1000 rpm}
contact: {model: poisson}
run: {revolutions: 0.05, samples: 360, step: 5 us}
END
cat >cases/ideal.yaml <<END
bodies: {arm: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [10 mm, 0 mm]}}
joints: {hinge: {between: [ground, arm], at: [0 mm, 0 mm]}}
$run
END
cat >cases/gears.yaml <<END
bodies:
  pinion: {mass: 0.2 kg, inertia: 40 kg mm^2, at: [0 mm, 0 mm], spin: 30 rad/s}
  wheel:  {mass: 1 kg, inertia: 900 kg mm^2, at: [80 mm, 0 mm]}
joints:
  a: {between: [ground, pinion], at: [0 mm, 0 mm]}
  b: {between: [ground, wheel], at: [80 mm, 0 mm]}
  mesh: {gears: [a, b], teeth: [20, 60], backlash: 0.1 mm, stiffness: 1e7 N/m}
$run
END
cat >cases/limits.yaml <<END
bodies: {lever: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 mm, 0 mm], spin: 10 rad/s}}
joints:
  hinge: {between: [ground, lever], at: [0 mm, 0 mm], low: -1 deg, high: 1 deg,
          stiffness: 1e4 N m/rad, viscous-coefficient: 1 N m s/rad}
$run
END
cat >cases/space.yaml <<END
space: spatial
bodies: {pin: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [0 mm, 0 mm], spin: 5 rad/s}}
joints:
  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.1 mm, pin: 10 mm, width: 10 mm}
contact: {stiffness: 2.0e7 N/m}
$run
END

words_of() {
    case $1 in
    run) echo "run $2" ;;
    report) echo "report $2 --step 20us" ;;
    compare) echo "compare $2 --schemes direct/plain --steps 20us" ;;
    map) echo "map $2 --steps 20us" ;;
    tune) echo "tune $2 --schemes direct/plain --error 0.4 --cost steps --time-limit 2s" ;;
    check) echo "check $2 --quick --baselines b" ;;
    esac
}

# "option kind" of every output of a command, from its help.
outputs_of() {
    "$program" help "$1" | awk '
        match($0, /^ +(-[a-zA-Z], )?--[a-z-]+=(FILE[^ ]*|DIR)/) {
            option = substr($0, RSTART, RLENGTH)
            sub(/^ +(-[a-zA-Z], )?/, "", option)
            split(option, parts, "=")
            print parts[1], parts[2]
        }' | grep -v -e '^--baselines ' -e '^--replay '
}

# Files under a name: itself, or one a backend (x-ode.csv), or those in a folder.
written() {
    find "$1" "${1%.*}"-* -type f -size +0 2>/dev/null | wc -l
}

# Whether a file that is XML by its name is one document, where xmllint is there to say.
is_document() {
    case $1 in
    *.sdf | *.xml | *.svg)
        [ ! -f "$1" ] || ! command -v xmllint >/dev/null || xmllint --noout "$1" 2>"$log"
        ;;
    esac
}

# What a status says of a file is true.
is_honest() {
    if [ "$1" = 0 ]; then
        [ "$(written "$2")" -gt 0 ] && is_document "$2"
    else
        [ -s "$log" ] && { [ "$1" != 2 ] || [ "$(written "$2")" -eq 0 ]; }
    fi
}

"$program" check cases --bless --baselines b --quiet >/dev/null 2>"$log"
report "the baselines are there" $?

# The control: a status of 0 without the file, and a refusal without a word, are seen.
: >"$log"
! is_honest 0 nowhere.csv
report "a missing file behind a status of 0 is seen" $?
! is_honest 2 nowhere.csv
report "a refusal without a reason is seen" $?
mkdir out
printf '<a></a>\n<b></b>\n' >out/two.xml
! command -v xmllint >/dev/null || ! is_honest 0 out/two.xml
report "two elements at the top are seen" $?

tried=0
for command in run report compare map tune check; do
    outputs_of "$command" >outputs
    while read -r option kind; do
        for case in cases/*.yaml; do
            rm -rf out && mkdir out
            name=out/x$(echo "$kind" | sed -n 's/^[A-Z]*\(\.[a-z]*\)$/\1/p')
            tried=$((tried + 1))
            timeout 60 "$program" $(words_of "$command" "$case") "$option" "$name" --quiet \
                >/dev/null 2>"$log"
            status=$?
            is_honest $status "$name"
            report "$command $option $kind of $(basename "$case" .yaml): status $status" $?
        done
    done <outputs
done
[ $tried -ge 60 ]
report "the help names outputs" $?
echo 1..$number
