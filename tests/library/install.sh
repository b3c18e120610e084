#!/bin/sh
# Is the library, installed and found by pkg-config, one that a user can build with? The examples of
# docs/library.md are built by gcc, clang and g++ and print what the page says. Prints TAP.
# Usage: install.sh MESON SOURCES BUILD READELF
set -u
meson=$1
root=$2
build=$3
readelf=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$root/tests/support/tap.sh"

"$meson" install -C "$build" --no-rebuild --destdir "$work/dest" >"$log" 2>&1
report "the library is installed" $?
PKG_CONFIG_PATH=$(dirname "$(find "$work/dest" -name jointplay.pc)")
PKG_CONFIG_SYSROOT_DIR=$work/dest
export PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR
flags=$(pkg-config --cflags --libs jointplay 2>"$log")
report "pkg-config finds it" $?
folder=$(pkg-config --variable=libdir jointplay)
LD_LIBRARY_PATH=$work/dest${folder#"$work/dest"}
export LD_LIBRARY_PATH
warnings='-Wall -Wextra -Wpedantic -Werror'

# Every example: NAME.c or NAME.cpp, on the page or a file that it links, and what the page says that
# it prints: NAME.txt.
cp "$root"/docs/examples/* "$work"
awk -v folder="$work" '
    match($0, /\(examples\/[a-z]+\.(c|cpp)\)/) {
        name = substr($0, RSTART + 10, RLENGTH - 11); sub(/\..*/, "", name); is_shown = 1
    }
    /^```/ {
        if (output != "") { close(output); output = "" }
        else if (is_shown) { output = folder "/" name ".txt"; printf "" >output; is_shown = 0 }
        else if ($0 ~ /^```c(pp)?$/) { is_first = 1 }
        next
    }
    is_first {
        split($2, parts, ":"); file = parts[1]; name = file; sub(/\..*/, "", name)
        output = folder "/" file; is_first = 0; is_shown = 1
    }
    output != "" { print >output }' "$root/docs/library.md"

# An example built by a compiler with flags, and run.
builds_and_runs() {
    file=$1
    shift
    rm -f "$work/program"
    "$@" $warnings "$file" -o "$work/program" $flags -lm >"$log" 2>&1 || return 1
    "$work/program" >"$work/printed" 2>"$log" || return 1
    diff "${file%.*}.txt" "$work/printed" >"$log"
}

# what the program writes of a case with a setting, as its own first lines say
"$build/src/cli/jointplay" tune "$root/cases/paper/impact-k66.yaml" --at-step '20 us' --quiet \
    --schemes direct/staggered/impulse --set run.revolutions=0.1 --code "$work/case.c" >"$log" 2>&1
report "tune writes a case as a program" $?
for compiler in gcc clang; do
    command -v $compiler >"$log" || continue
    $compiler -std=c17 $warnings "$work/case.c" -o "$work/case" $flags -lm >"$log" 2>&1 &&
        "$work/case" >"$work/series.csv" 2>"$log" && [ "$(wc -l <"$work/series.csv")" -eq 302 ]
    report "$compiler builds it, and it runs" $?
done
rm -f "$work/case.c"

examples=0
for file in "$work"/*.c "$work"/*.cpp; do
    name=$(basename "$file")
    examples=$((examples + 1))
    for compiler in gcc clang g++ clang++; do
        case $compiler:$name in
        *++:*.cpp) standard=c++17 ;;
        *++:* | *:*.cpp) continue ;;
        *) standard=c17 ;;
        esac
        command -v $compiler >"$log" || continue
        builds_and_runs "$file" $compiler -std=$standard
        report "$compiler builds $name, which prints what the page says" $?
    done
done
[ "$examples" -ge 6 ]
report "the page has examples" $?

# the header alone, in both languages
for compiler in 'gcc -std=c17 -x c' 'g++ -std=c++17 -x c++'; do
    echo '#include <jointplay/jointplay.h>' | $compiler $warnings -fsyntax-only $flags - >"$log" 2>&1
    report "the header compiles alone: ${compiler%% -x*}" $?
done

# the library of cases, which finds those that came with it
case_flags=$(pkg-config --cflags --libs jointplay-case 2>"$log")
report "pkg-config finds the library of cases" $?
for compiler in 'gcc -std=c17' 'g++ -std=c++17 -x c++'; do
    $compiler $warnings "$root/docs/cases.c" -o "$work/cases" $case_flags >"$log" 2>&1 &&
        (cd "$work/dest" && "$work/cases" pendulum) >"$work/printed" 2>"$log" &&
        grep -q '"status": "ok"' "$work/printed"
    report "${compiler%% *} builds a program with it, which finds a case by its name" $?
done

# the static library, without the shared one
archive=$(find "$work/dest" -name libjointplay.a)
gcc -std=c17 "$work/gazebo.c" -o "$work/static" $(pkg-config --cflags jointplay) "$archive" \
    $(pkg-config --libs ode 2>/dev/null) -lm >"$log" 2>&1 &&
    LD_LIBRARY_PATH= "$work/static" >"$work/printed" && diff "$work/gazebo.txt" "$work/printed" >"$log"
report "the static library does without the shared one" $?

# Names that can be seen from outside and are not public.
strays() {
    "$@" | awk 'NF >= 3 && $NF !~ /^jp_[a-z0-9_]+$/ { print $NF }'
}
shared=$(find "$work/dest" -name 'libjointplay.so.1.*')
strays nm -D --defined-only "$shared" >"$log"
[ ! -s "$log" ]
report "the shared library shows jp_ names alone" $?
strays nm -g --defined-only "$archive" >"$log"
[ ! -s "$log" ]
report "the static library shows jp_ names alone" $?
[ -n "$(strays nm -D --defined-only "$(PKG_CONFIG_SYSROOT_DIR= pkg-config --variable=libdir ode)/libode.so")" ]
report "the control: ODE's library shows others" $?

# what it needs: libraries whose licences bind nobody who links them
"$readelf" -d "$shared" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' |
    grep -vE '^(libode\.so|libm\.so|libc\.so|ld-linux)' >"$log"
[ ! -s "$log" ]
report "it needs ODE, libm and libc alone" $?
"$readelf" -d "$shared" | grep -q 'SONAME.*libjointplay\.so\.1\]'
report "its soname has the number 1" $?
echo "1..$number"
