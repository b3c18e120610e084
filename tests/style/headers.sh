#!/bin/sh
# Does each header compile alone? One that its own source includes before all else has been compiled
# alone with that; the others are compiled here. Prints TAP.
set -u
root=$1
generated=$2

# Whether the build has shown it: the first line of the source that includes anything.
is_first_in_source() {
    [ -f "$root/src/${1%.h}.c" ] &&
        [ "$(grep -m 1 '^ *# *include' "$root/src/${1%.h}.c")" = "#include \"$1\"" ]
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
for header in $headers; do
    : >"$log"
    is_first_in_source "$header" || compiles "$root/src" "$header"
    report "$header compiles alone" $?
done

# the controls: a header that needs another, and one that its source includes too late
mkdir -p "$work/src/base"
echo 'size_t needy(void);' >"$work/src/base/needy.h"
printf '#include <stddef.h>\n#include "base/needy.h"\n' >"$work/src/base/needy.c"
! compiles "$work/src" base/needy.h
report "a header that needs another is found" $?
root=$work
! is_first_in_source base/needy.h
report "so is one that its source includes behind that" $?
echo "1..$number"
