#!/bin/sh
# Is the amalgamation of the contact kernel a library by itself? Compiles it with a program that
# bounces a mass on a wall, links both with libm only, and runs that by each compiler that there is;
# and takes its header into C++. Prints TAP.
#     kernel_alone.sh SOURCE_ROOT jointplay_kernel.c jointplay_kernel.h
set -u
root=$1
source=$2
header=$3
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
cp "$source" "$header" "$here"
warnings="-Wall -Wextra -Werror"

number=0
report() {
    number=$((number + 1))
    if [ "$1" = 0 ]; then
        echo "ok $number - $2"
    else
        echo "not ok $number - $2"
        sed 's/^/# /' "$here/log"
    fi
}

# Whether there is a compiler; says so where there is none.
has() {
    command -v "$1" >/dev/null && return 0
    number=$((number + 1))
    echo "ok $number - $1 # SKIP it is not installed"
    return 1
}

for name in gcc clang; do
    has "$name" || continue
    # shellcheck disable=SC2086 # several words
    "$name" -std=c17 -O1 $warnings -I "$here" -o "$here/bounce" "$here/jointplay_kernel.c" \
        "$root/tests/unit/kernel_alone.c" -lm >"$here/log" 2>&1 && "$here/bounce" >"$here/log"
    report $? "by $name the kernel alone bounces a mass as closed forms have it"
done

printf '#include "jointplay_kernel.h"\nint main() { return kernel_start(0.1).contact_count; }\n' \
    >"$here/user.cc"
for name in g++ clang++; do
    has "$name" || continue
    # shellcheck disable=SC2086 # several words
    "$name" $warnings -I "$here" -fsyntax-only "$here/user.cc" >"$here/log" 2>&1
    report $? "$name takes the header into C++"
done

# the control: a source of the kernel that needs a mechanism is refused
mkdir -p "$here/far/src/kernel"
cp "$root/LICENSE" "$here/far"
printf '#include "model/linkage.h"\n' >"$here/far/src/kernel/far.c"
! sh "$root/src/kernel/amalgamate.sh" "$here/far/src" 1 "$here/far.c" "$here/far.h" \
    "$here/far/src/kernel/far.c" "$here/far/src/kernel/far.c" >"$here/log" 2>&1 &&
    grep -q 'model/linkage.h is neither' "$here/log"
report $? "a kernel that needs the model is refused"
echo "1..$number"
