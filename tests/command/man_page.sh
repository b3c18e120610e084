#!/bin/sh
# Does the man page describe every option of every command, and none that does not exist? Options
# are those that a command's --help lists. Prints TAP.
set -u
program=$1
page=$2
. "$3"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log

# The part of the page that has a command's options; commands with few have them in the synopsis.
section() {
    case $1 in
        paper | help) heading='# SYNOPSIS' ;;
        'study slurm') heading='# OPTIONS OF STUDY SLURM' ;;
        *) heading="# OPTIONS OF $(echo "${1%% *}" | tr '[:lower:]' '[:upper:]')" ;;
    esac
    awk -v heading="$heading" '/^# / { is_in = $0 == heading } is_in' "$page"
}

# The options of a command's help, which is asked for once.
options_of_help() {
    options=$work/$(echo "$1" | tr ' ' -)
    [ -e "$options" ] || "$program" $1 --help | grep -oE '^ +(-[A-Za-z], )?--[a-z-]+' |
        grep -oE -e '--[a-z-]+' | grep -vxF -e --help >"$options"
    cat "$options"
}

# Lines for each option of a command that its part of the page lacks.
missing() {
    section "$1" >"$work/section"
    options_of_help "$1" | while read -r option; do
        grep -qF -e "*$option*" "$work/section" ||
            echo "docs/jointplay.1.scd lacks $option among the options of $1"
    done
}

# Lines for each option that the page has under a command and no command of that name has.
invented() {
    for command in "$@"; do options_of_help "$command"; done >"$work/all"
    for command in "$@"; do section "$command"; done |
        grep -oE '^\*(-[a-z]\*, \*)?--[a-z-]+' | grep -oE -e '--[a-z-]+' | sort -u |
        grep -vxF -f "$work/all" |
        sed "s|.*|docs/jointplay.1.scd has &, which $1 does not have|"
}

quiet() { [ ! -s "$log" ]; }

commands=$("$program" help | awk '/^Commands:/ { is_in = 1; next } /^$/ { is_in = 0 } is_in { print $1 }')
echo "1..$(($(echo "$commands" | wc -w) + 2))"
for command in $commands; do
    grep -qE "^\*jointplay\* \*$command\*" "$page" ||
        echo "docs/jointplay.1.scd lacks the command $command in its synopsis"
    sed -n '/^# COMMANDS/,/^# OPTIONS/p' "$page" | grep -qE "^\*$command\*" ||
        echo "docs/jointplay.1.scd lacks the command $command among its commands"
done >"$log"
quiet
report "the man page has every command" $?
for command in $commands; do
    # the words of study have options of their own
    [ "$command" != study ] || continue
    { missing "$command"; invented "$command"; } >"$log"
    quiet
    report "the man page has the options of $command" $?
done
{
    for command in study 'study status' 'study export' 'study merge' 'study plot' 'study slurm'; do
        missing "$command"
    done
    invented study 'study status' 'study export' 'study merge' 'study plot' 'study slurm'
} >"$log"
quiet
report "the man page has the options of study" $?

# the control: an option that is erased and one that is made up
sed '/^# OPTIONS OF RUN/a *--made-up*' "$page" | sed 's/\*--uncertified\*//' >"$work/page"
page=$work/page
{ missing run; invented run; } >"$log"
[ "$(wc -l <"$log")" = 2 ] && grep -q uncertified "$log" && grep -q made-up "$log"
report "an option that only the page or only the program has is found" $?
