#!/bin/sh
# Makes one source and one header of the contact kernel, for programs of other people: compile the
# source with such a program and link libm.
#     amalgamate.sh ROOT VERSION OUT.c OUT.h HEADER FILE...
# ROOT is the folder that includes are relative to, HEADER the public header, FILE... the sources.
# Every file of ours stands once, where it is first included; those of the system stand at the top.
# Fails where a file includes one of ours outside of kernel/ and base/.
set -eu
root=$1
version=$2
source_out=$3
header_out=$4
shift 4

# What both files begin with.
announce() {
    echo "// The contact kernel of jointplay $version, made from its sources; do not edit this."
    echo "//"
    sed 's|^|// |; s| *$||' "$root/../LICENSE"
    echo
}

# Writes the text of files with what they include, from a line `before` to a line `after`; leaves
# out what the file SKIP names, which has been written elsewhere.
join() {
    skip=$1
    before=$2
    after=$3
    shift 3
    awk -v root="$root" -v skip="$skip" -v before="$before" -v after="$after" '
    function take(path,    line, inner) {
        if (path in taken) {
            return
        }
        if (path !~ /^(kernel|base)\//) {
            print path " is neither of the kernel nor of base" >"/dev/stderr"
            exit 1
        }
        taken[path] = 1
        text = text "\n// ---- " path "\n"
        while ((getline line < (root "/" path)) > 0) {
            if (line ~ /^#include "/) {
                inner = line
                gsub(/^#include "|".*$/, "", inner)
                take(inner)
            } else if (line ~ /^#include </) {
                top = index(top, line "\n") > 0 ? top : top line "\n"
            } else if (line !~ /^#pragma once/) {
                text = text line "\n"
            }
        }
        close(root "/" path)
    }
    BEGIN {
        while ((getline line < skip) > 0) {
            taken[line] = 1
        }
        for (i = 1; i < ARGC; i++) {
            take(ARGV[i])
        }
        printf "%s\n%s\n%s\n%s\n", top, before, text, after
    }' "$@"
}

# the paths from the root, however they were given
count=$#
while [ "$count" -gt 0 ]; do
    set -- "$@" "$(realpath --relative-to="$root" "$1")"
    shift
    count=$((count - 1))
done
header=$1
shift

extern=$(printf '#ifdef __cplusplus\nextern "C" {\n#endif')
close=$(printf '#ifdef __cplusplus\n}\n#endif')
{
    announce
    printf '#ifndef JOINTPLAY_KERNEL_H\n#define JOINTPLAY_KERNEL_H\n\n'
    join /dev/null "$extern" "$close" "$header"
    printf '\n#endif\n'
} >"$header_out"

written=$(mktemp)
trap 'rm -f "$written"' EXIT
sed -n 's|^// ---- ||p' "$header_out" >"$written"
{
    announce
    printf '#ifndef _DEFAULT_SOURCE\n#define _DEFAULT_SOURCE // for M_PI\n#endif\n'
    printf '#include "%s"\n\n' "$(basename "$header_out")"
    # of some headers it takes only a part
    join "$written" '#pragma GCC diagnostic ignored "-Wunused-function"' '' "$@"
} >"$source_out"
