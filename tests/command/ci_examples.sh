#!/bin/sh
# Do the lines of the examples for CI do what they say, on a folder of somebody else's? Takes the lines
# of the step that checks out of each example, and runs them where there is a case and a baseline, and
# then where the case has changed. Prints TAP.
program=$1
root=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# the program, as an installed one is found
mkdir "$work/bin"
ln -s "$program" "$work/bin/jointplay"
PATH=$work/bin:$PATH

# The lines of `run: |` under `- name: Check`.
github_lines() {
    awk '/^      - / { inside = ($0 ~ /- name: Check$/); next }
         inside && /^          / { print substr($0, 11) }' "$root/docs/ci/github-actions.yml"
}

# The list under `script:`.
gitlab_lines() {
    awk '/^  [a-z_]+:/ { inside = ($1 == "script:"); next }
         inside && /^    - / { print substr($0, 7) }' "$root/docs/ci/gitlab-ci.yml"
}

log=$work/log
. "$(dirname "$0")/../support/tap.sh"

# A repository with one case and its baseline.
make_folder() {
    mkdir -p "$1/cases"
    cat >"$1/cases/pin.yaml" <<'CASE'
bodies:
  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}
joints:
  hole: {between: [ground, pin], at: [0 mm, 0 mm], radial-clearance: 0.1 mm, pin: 10 mm, width: 15 mm}
contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}
run: {duration: 6 ms, samples: 20, step: 50 us, backends: [reference, ode]}
CASE
    (cd "$1" && jointplay check --quiet --bless --baselines baselines cases/*.yaml) >"$work/log" 2>&1
}

# Runs lines as a CI system does: a shell that ends at the first that fails.
run_lines() {
    (cd "$1" && GITHUB_STEP_SUMMARY=$1/summary sh -e "$work/lines") >"$work/log" 2>&1
}

echo 1..12
for system in github gitlab; do
    folder=$work/$system
    ${system}_lines >"$work/lines"
    [ -s "$work/lines" ]
    report "$system: the example has lines" $?
    make_folder "$folder"
    report "$system: a baseline is made" $?
    run_lines "$folder"
    report "$system: an unchanged case passes" $?
    sed -i 's/restitution: 0.9/restitution: 0.89/' "$folder/cases/pin.yaml"
    run_lines "$folder"
    [ $? = 1 ] && grep -q '<failure message="setting contact.restitution was 0.9, is 0.89"' \
        "$folder/jointplay.xml" && grep -q 'cases out of their bands' "$folder/jointplay.md"
    report "$system: a changed case fails, and its reports say why" $?
    cp "$folder/cases/pin.yaml" "$folder/cases/new.yaml"
    run_lines "$folder"
    [ $? = 5 ]
    report "$system: a case without a baseline fails" $?
    if [ $system = github ]; then
        grep -q '### jointplay check' "$folder/summary"
    else
        grep -q 'junit: jointplay.xml' "$root/docs/ci/gitlab-ci.yml"
    fi
    report "$system: the report goes where it is shown" $?
done
