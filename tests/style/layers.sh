#!/bin/sh
# Does data flow one way? A file includes only its own folder and those above it, and each library
# shows in its own place alone. Prints TAP.
set -u
root=$1
layers="base model casefile contact analytic reference ode run compare study paper report cli"

rank_of() {
    rank=0
    for layer in $layers; do
        rank=$((rank + 1))
        [ "$layer" != "$1" ] || { echo "$rank"; return; }
    done
    echo 0
}

# Lines 'file: what is wrong' for one source tree.
broken_layers() {
    for file in $(find "$1" -name '*.[ch]' | sort); do
        own=$(basename "$(dirname "$file")")
        own_rank=$(rank_of "$own")
        [ "$own_rank" != 0 ] || echo "$file: folder $own is no layer"
        for name in $(sed -n 's/^#include "\([a-z_]*\)\/.*/\1/p' "$file" | sort -u); do
            rank=$(rank_of "$name")
            if [ "$rank" = 0 ] || [ "$rank" -gt "$own_rank" ]; then
                echo "$file: includes $name/, which is not above $own/"
            fi
        done
    done
}

# Lines for every file outside the places allowed that includes a library's header.
broken_wall() {
    grep -rlE "^#include <$2" "$1" --include='*.[ch]' | grep -vE "$3" | sed "s|\$|: includes <$2|"
}

broken_walls() {
    broken_wall "$1" 'ode/' '/ode/'
    broken_wall "$1" 'ccd/' '/ode/'
    broken_wall "$1" 'gsl/' '/base/(normal|root)\.c$'
    broken_wall "$1" 'yaml\.h' '/casefile/document\.c$'
    broken_wall "$1" 'jansson\.h' '/report/'
    broken_wall "$1" 'sqlite3\.h' '/study/store[a-z_]*\.c$'
    broken_wall "$1" 'argp\.h' '/cli/'
}

long_files() {
    find "$1" -name '*.[ch]' -exec awk 'END { if (NR > 400) print FILENAME ": " NR " lines" }' {} \;
}

unguarded_headers() {
    find "$1" -name '*.h' | xargs grep -L '^#pragma once'
}

number=0
report() {
    number=$((number + 1))
    if [ -z "$2" ]; then
        echo "ok $number - $1"
    else
        echo "not ok $number - $1"
        echo "$2" | sed 's/^/# /'
    fi
}

# the control: a tree with one fault of each kind must be caught
control=$(mktemp -d)
trap 'rm -rf "$control"' EXIT
mkdir -p "$control/model" "$control/run" "$control/walls/study"
printf '#include "run/run.h"\n#include <ode/ode.h>\n' >"$control/model/bad.c"
# and only the one of two files that is outside the library's place
for name in sweep store_rows; do
    printf '#include <sqlite3.h>\n' >"$control/walls/study/$name.c"
done

caught() {
    if [ -n "$1" ]; then echo ''; else echo 'nothing was found'; fi
}

echo 1..7
report "a file includes only its own folder and those above it" "$(broken_layers "$root/src")"
report "each library is included in its own place alone" "$(broken_walls "$root/src")"
report "no file has more than 400 lines" "$(long_files "$root/src")"
report "every header guards itself" "$(unguarded_headers "$root/src")"
report "a file that includes a lower layer is caught" "$(caught "$(broken_layers "$control")")"
report "a library outside its place is caught" "$(caught "$(broken_walls "$control")")"
found=$(broken_walls "$control/walls" | sed 's|.*/||')
report "SQLite is caught outside the store alone" \
    "$([ "$found" = 'sweep.c: includes <sqlite3.h' ] || echo "found: $found")"
