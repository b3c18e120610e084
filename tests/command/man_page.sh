#!/bin/sh
# Do the manual pages have every option of every command, as --help lists them, and are they pages that
# groff sets without a warning? The control is a page without one of its options, and one with a
# request that is none.
# Usage: man_page.sh PROGRAM TAP. Prints TAP.
set -u
program=$1
. "$2"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log
: >"$log"

options_of_help() {
    "$program" $1 --help | grep -oE '^ +(-[A-Za-z], )?--[a-z-]+' | grep -oE -e '--[a-z-]+' | sort -u
}

# The options of a page between a heading and the next one.
options_of_page() {
    awk -v heading="$2" '/^\.SH/ { is_in = $0 == heading } is_in' "$1" |
        grep -oE '^(\\fB\\-[A-Za-z]\\fR, )?\\fB\\-\\-[a-z\\-]+\\fR' | sed 's/.*\\-\\-/--/; s/\\fR//; s/\\//g' | sort
}

# Whether the options of a page and those of --help are the same ones.
are_same() {
    options_of_help "$1" >"$work/help"
    options_of_page "$2" "$3" >"$work/page"
    [ -s "$work/help" ] && diff "$work/help" "$work/page" >"$log"
}

# Whether groff has nothing to say; true where there is none.
is_clean() {
    command -v groff >/dev/null || return 0
    groff -man -Tutf8 -ww -z "$1" >"$log" 2>&1 && [ ! -s "$log" ]
}

commands=$("$program" help | awk '/^Commands:/ { is_in = 1; next } /^$/ { is_in = 0 } is_in { print $1 }')
for command in $commands; do
    page=$work/$command.1
    "$program" help "$command" --man >"$page" && are_same "$command" "$page" '.SH OPTIONS'
    report "the page of $command has its options" $?
    is_clean "$page"
    report "the page of $command is set without a warning" $?
done
for part in status export merge plot slurm; do
    are_same "study $part" "$work/study.1" ".SH STUDY $(echo $part | tr '[:lower:]' '[:upper:]')"
    report "the page of study has the options of study $part" $?
done

"$program" help --man >"$work/all.1" && is_clean "$work/all.1"
report "the page of the program is set without a warning" $?
for command in $commands; do
    grep -qxF "\\fB$command\\fR" "$work/all.1" || echo "it lacks $command"
done >"$log"
[ ! -s "$log" ]
report "the page of the program has every command" $?

sed '/uncertified/d' "$work/run.1" >"$work/less.1"
! are_same run "$work/less.1" '.SH OPTIONS' && grep -q uncertified "$log"
report "the control: an option that is missing is found" $?
if command -v groff >/dev/null; then
    { cat "$work/run.1"; echo '.NOSUCH request'; } >"$work/wrong.1"
    ! is_clean "$work/wrong.1"
    report "the control: a request that is none is found" $?
fi
echo 1..$number
