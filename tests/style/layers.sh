#!/bin/sh
# Does data flow one way? A file includes only its own folder and those above it, and each library
# shows in its own place alone. Prints TAP.
set -u
root=$1
library="base kernel model contact world casefile analytic reference ode run"
# beside these engine, whose child processes exit
layers="${library% run} engine run measure write cli commands library drivers"

# Lines 'file included' for every include of one source tree.
includes() {
    (cd "$1" && grep -r '^#include "[a-z_]*/' . --include='*.[ch]') |
        sed 's|^\./||; s|:#include "| |; s|".*||' | sort
}

# Lines 'file: what is wrong' for one source tree. Only cli/main.c, which lists the commands, looks
# down on them; commands/commands.h, which declares them, belongs to all. A report shows what
# commands measure: it includes them, and nobody includes it.
broken_layers() {
    includes "$1" | awk -v layers="$layers" '
        function room(path, parts, n) {
            n = split(path, parts, "/")
            return parts[1] == "commands" && n > 2 ? parts[1] "/" parts[2] : parts[1]
        }
        function rank(path, parts) {
            split(path, parts, "/")
            return ranks[parts[1]]
        }
        BEGIN { count = split(layers, names, " "); for (i = 1; i <= count; i++) ranks[names[i]] = i }
        # programs of their own, of which anybody could write one: they take the kernel alone
        room($1) == "drivers" && $2 !~ /^(drivers|kernel|base)\// {
            print $1 ": a driver includes " $2
            next
        }
        # what runs cases for other programs has no command line
        room($1) == "library" && $2 ~ /^cli\// {
            print $1 ": the library includes " $2
            next
        }
        $1 == "cli/main.c" || $2 == "commands/commands.h" { next }
        !rank($1) { print $1 ": folder " room($1) " is no layer" }
        !rank($2) || rank($2) > rank($1) {
            print $1 ": includes " room($2) "/, which is not above " room($1) "/"
            next
        }
        room($1) == "commands/report" { next }
        rank($2) == rank($1) && room($2) != room($1) {
            print $1 ": includes " room($2) "/, another command"
        }'
}

# Files that need each other, a header and its source taken as one.
cycles() {
    includes "$1" | sed 's|\.[ch] | |; s|\.[ch]$||' | awk '$1 != $2' | sort -u |
        tsort 2>&1 >/dev/null | sed 's|^tsort: -: ||; s|^tsort: ||'
}

# What a library must not do: speak, or end the program it is part of.
loud_library() {
    for layer in $library library; do
        [ ! -d "$1/$layer" ] || grep -nE '(^|[^a-z_])((v?printf|puts|putchar|perror|exit|_exit)\(|std(out|err)([^a-z_]|$))' \
            "$1/$layer" -r --include='*.[ch]' | grep -v '__attribute__'
    done
}

# Lines for every file outside the places allowed that includes a library's header.
broken_wall() {
    grep -rlE "^#include <$2" "$1" --include='*.[ch]' | grep -vE "$3" | sed "s|\$|: includes <$2|"
}

broken_walls() {
    broken_wall "$1" 'ode/' '/(ode|world)/'
    broken_wall "$1" 'ccd/' '/ode/plane/collider_staves\.c$'
    broken_wall "$1" 'yaml\.h' '/casefile/document\.c$'
    broken_wall "$1" 'jansson\.h' '/(engine|drivers|write|commands|library)/'
    broken_wall "$1" 'sqlite3\.h' '/(commands/study/store[a-z_]*|write/row_sqlite)\.c$'
    broken_wall "$1" 'argp\.h' '/cli/'
}

long_files() {
    find "$1" -name '*.[ch]' | xargs awk 'FNR == 1001 { print FILENAME ": more than 1000 lines" }'
}

# Sources whose first line is no sentence that says what the file does: none, or a question.
unopened_sources() {
    find "$1" -name '*.c' -empty
    find "$1" -name '*.c' | xargs awk 'FNR == 1 && !/^\/\/ [A-Z][^?]*$/ { print FILENAME }'
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
mkdir -p "$control/model" "$control/run" "$control/walls/commands/study"
printf '#include "run/run.h"\n#include <ode/ode.h>\n' >"$control/model/bad.c"
mkdir -p "$control/inside/ode/plane"
for name in collider_staves collider_convex; do
    printf '#include <ccd/ccd.h>\n' >"$control/inside/ode/plane/$name.c"
done
# and only the one of two files that is outside the library's place
for name in sweep store_rows; do
    printf '#include <sqlite3.h>\n' >"$control/walls/commands/study/$name.c"
done

mkdir -p "$control/rooms/commands/tune" "$control/rooms/commands/report" "$control/rooms/cli"
printf '#include "commands/map/map.h"\n' >"$control/rooms/commands/report/page.c"
printf '#include "commands/map/map.h"\n' >"$control/rooms/commands/tune/tune.c"
printf '#include "commands/commands.h"\n' >"$control/rooms/commands/tune/cmd_tune.c"
printf '#include "commands/map/map.h"\n' >"$control/rooms/cli/main.c"
mkdir -p "$control/program/drivers/mine"
printf '#include "kernel/kernel.h"\n#include "model/linkage.h"\n' >"$control/program/drivers/mine/a.c"
mkdir -p "$control/circle/run"
printf '#include "run/b.h"\n' >"$control/circle/run/a.c"
printf '#include "run/a.h"\n' >"$control/circle/run/b.h"
mkdir -p "$control/loud/base"
printf 'void f(void) { printf("%%d", 1); }\n' >"$control/loud/base/f.c"
printf 'void g(void) { fputs("1", stderr); }\n' >"$control/loud/base/g.c"

caught() {
    if [ -n "$1" ]; then echo ''; else echo 'nothing was found'; fi
}

mkdir -p "$control/opening"
printf '// Where does it stand?\n' >"$control/opening/a.c"
printf '#include <stdio.h>\n' >"$control/opening/b.c"
printf '' >"$control/opening/d.c"
mkdir -p "$control/long"
yes ';' | head -n 1001 >"$control/long/long.c"
yes ';' | head -n 1000 >"$control/long/short.c"
printf '// Finds where it stands.\n' >"$control/opening/c.c"

echo 1..18
report "a file includes only its own folder and those above it" "$(broken_layers "$root/src")"
report "each library is included in its own place alone" "$(broken_walls "$root/src")"
report "no two files need each other" "$(cycles "$root/src")"
report "the library prints nothing and ends nothing" "$(loud_library "$root/src")"
report "no file has more than 1000 lines" "$(long_files "$root/src")"
report "every source opens with what it does" "$(unopened_sources "$root/src")"
report "every header guards itself" "$(unguarded_headers "$root/src")"
report "a file that includes a lower layer is caught" "$(caught "$(broken_layers "$control")")"
found=$(broken_layers "$control/rooms")
report "a command that includes another is caught, and nothing else" \
    "$([ "$found" = 'commands/tune/tune.c: includes commands/map/, another command' ] || echo "found: $found")"
found=$(broken_layers "$control/program")
report "a driver that includes more than the kernel is caught" \
    "$([ "$found" = 'drivers/mine/a.c: a driver includes model/linkage.h' ] || echo "found: $found")"
report "a library outside its place is caught" "$(caught "$(broken_walls "$control")")"
found=$(broken_walls "$control/walls" | sed 's|.*/||')
report "SQLite is caught outside its places alone" \
    "$([ "$found" = 'sweep.c: includes <sqlite3.h' ] || echo "found: $found")"
found=$(broken_walls "$control/inside" | sed 's|.*/ode/plane/||')
report "libccd is caught in any file but one" \
    "$([ "$found" = 'collider_convex.c: includes <ccd/' ] || echo "found: $found")"
report "two files that need each other are caught" "$(caught "$(cycles "$control/circle")")"
found=$(loud_library "$control/loud" | grep -o '[fg]\.c' | sort | tr -d '\n')
report "a library that prints is caught" "$([ "$found" = f.cg.c ] || echo "found: $found")"
found=$(unopened_sources "$control/opening" | sed 's|.*/||' | sort | tr -d '\n')
report "a source that opens with a question, or with nothing, is caught" \
    "$([ "$found" = a.cb.cd.c ] || echo "found: $found")"
found=$(long_files "$control/long" | sed 's|.*/||')
report "a file of more than 1000 lines is caught" \
    "$([ "$found" = 'long.c: more than 1000 lines' ] || echo "found: $found")"
report "files without a circle are not caught" "$(cycles "$control/rooms")"
