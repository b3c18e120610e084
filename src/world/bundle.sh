#!/bin/sh
# Makes the static library: one object of all, in which only what is public can be seen from outside.
# Usage: bundle.sh LD OBJCOPY AR OUTPUT ARCHIVE
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1" -r -o "$work/jointplay.o" --whole-archive "$5"
"$2" --localize-hidden "$work/jointplay.o"
rm -f "$4"
"$3" rcs "$4" "$work/jointplay.o"
