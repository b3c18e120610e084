#!/bin/sh
# Does each header compile alone? One that its own source includes before all else has been compiled
# alone with that; the others are compiled here. Prints TAP.
set -u
root=$1
generated=$2

# Headers of a source tree that the build has shown: the first line of the source that includes
# anything includes them.
first_in_source() {
    (cd "$1" && find . -name '*.c' | sed 's|^\./||' | xargs awk '
        FNR == 1 { is_open = 1 }
        is_open && /^ *# *include/ {
            is_open = 0
            header = FILENAME
            sub(/c$/, "h", header)
            if ($0 == "#include \"" header "\"") print header
        }')
}

# Whether a header of that source tree compiles.
compiles() {
    echo "#include \"$2\"" | ${CC:-cc} -std=gnu17 -fsyntax-only -Wall -Werror \
        -I"$1" -I"$generated" -x c - 2>"$work/log"
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"
headers=$(cd "$root/src" && find . -name '*.h' | sed 's|^\./||' | sort)
shown=" $(first_in_source "$root/src" | tr '\n' ' ')"
for header in $headers; do
    : >"$log"
    case $shown in
    *" $header "*) true ;;
    *) compiles "$root/src" "$header" ;;
    esac
    report "$header compiles alone" $?
done

# the controls: a header that needs another, and one that its source includes too late
mkdir -p "$work/src/base"
echo 'size_t needy(void);' >"$work/src/base/needy.h"
printf '#include <stddef.h>\n#include "base/needy.h"\n' >"$work/src/base/needy.c"
! compiles "$work/src" base/needy.h
report "a header that needs another is found" $?
[ -z "$(first_in_source "$work/src")" ]
report "so is one that its source includes behind that" $?
echo "1..$number"
