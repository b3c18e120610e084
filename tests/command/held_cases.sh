# Cases that `check --expect-only` holds to what they expect, for tests in shell: sourced by them,
# with the program and the folder of the cases in variables of these names. Prints TAP.
. tests/support/tap.sh

check() {
    "$program" check --quiet --expect-only --time-limit "60 s" "$@"
}

# The cases of the names given end as they expect.
cases_hold() {
    for case in "$@"; do
        check "$folder/$case.yaml" >"$log" 2>&1
        report "$case" $?
    done
}

# The controls: a case and a setting with which it does not, in one word each.
cases_do_not_hold() {
    for setting in "$@"; do
        check "$folder/${setting% *}.yaml" --set "${setting#* }" >"$log" 2>&1
        test $? -eq 1
        report "$setting is found out" $?
    done
}
