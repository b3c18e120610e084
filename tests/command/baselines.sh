#!/bin/sh
# Is every number that can be predicted within its band, in this very build? Prints TAP.
program=$1
root=$2
cd "$root" || exit 1
cases=$(ls cases/paper/*.yaml cases/literature/*.yaml)
set -- $cases
# each case is named, so that a baseline that is missing is an error
echo "1..$#"
number=0
for case in $cases; do
    number=$((number + 1))
    if words=$("$program" check --quick --quiet "$case" 2>&1); then
        echo "ok $number - $case"
    else
        echo "not ok $number - $case"
        echo "$words" | sed 's/^/# /'
    fi
done
