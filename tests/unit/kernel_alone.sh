#!/bin/sh
# Is the contact kernel a library of its own? Compiles its sources with a program that bounces a
# mass on a wall, where no other folder than src/base can be included, links them with libm only,
# and runs that by each compiler that there is. Prints TAP.
#     kernel_alone.sh SOURCE_ROOT FILE...    files: the kernel's sources, and what they need of base
set -u
root=$1
shift
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir "$here/src" "$here/far"
ln -s "$root/src/kernel" "$here/src/kernel"
ln -s "$root/src/base" "$here/src/base"

# Compiles and links a program with the kernel's files, by one compiler.
build() {
    compiler=$1
    shift
    "$compiler" -std=gnu17 -O0 -Wall -Werror -I "$here/src" -o "$here/bounce" "$@" -lm \
        >"$here/log" 2>&1
}

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

for name in gcc clang; do
    if ! command -v "$name" >/dev/null; then
        number=$((number + 1))
        echo "ok $number - $name # SKIP it is not installed"
        continue
    fi
    build "$name" "$root/tests/unit/kernel_alone.c" "$@" && "$here/bounce" >"$here/log"
    report $? "by $name the kernel alone bounces a mass as Hertz has it"
done

# the control: a program that includes a linkage must not compile there
printf '#include "model/linkage.h"\nint main(void) { return 0; }\n' >"$here/far/far.c"
! cc -std=gnu17 -I "$here/src" -fsyntax-only "$here/far/far.c" >"$here/log" 2>&1
report $? "a program that needs the model is refused"
echo "1..$number"
