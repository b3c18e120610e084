#!/bin/sh
# Does each header compile alone? Prints TAP.
set -u
root=$1
generated=$2
headers=$(cd "$root/src" && find . -name '*.h' | sort)
echo "1..$(echo "$headers" | wc -l)"
number=0
for header in $headers; do
    number=$((number + 1))
    if echo "#include \"$header\"" | ${CC:-cc} -std=gnu17 -fsyntax-only -Wall -Werror \
        -I"$root/src" -I"$generated" -x c - 2>/tmp/header.$$; then
        echo "ok $number - $header compiles alone"
    else
        echo "not ok $number - $header compiles alone"
        sed 's/^/# /' /tmp/header.$$
    fi
done
rm -f /tmp/header.$$
