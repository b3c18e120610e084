#!/bin/bash
# Do bash and zsh offer the options that --help lists, the words that the program allows, and the files
# that a command takes? Bash is asked as it asks the script itself; of zsh's script the specifications
# are looked at that it hands to _arguments. The control is a script without an option.
# Usage: completion.sh PROGRAM TAP [ZSH]. Prints TAP.
set -u
program=$1
. "$2"
zsh=${3:-}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log
: >"$log"
mkdir "$work/in" && cd "$work/in" || exit 1
mkdir sub
touch 'a case.yaml' b.json c.txt d.sqlite

"$program" help --completion bash >"$work/jointplay" && . "$work/jointplay" 2>"$log"
report "bash reads its script" $?

# What bash offers for the words of a command line, of which the last is being written.
offered() {
    COMP_WORDS=(jointplay "$@")
    COMP_CWORD=$#
    _jointplay 2>/dev/null
    printf '%s\n' "${COMPREPLY[@]}" | sort
}

# Whether what is offered for the words behind -- is what stands before it, a line each.
expect() {
    local expected=$1
    shift
    diff <(printf '%s\n' $expected | sort) <(offered "$@") >"$log"
}

options_of_help() {
    "$program" "$@" --help | grep -oE '^ +(-[A-Za-z], )?--[a-z-]+' | grep -oE -e '--[a-z-]+' | sort -u
}

commands=$("$program" help | awk '/^Commands:/ { is_in = 1; next } /^$/ { is_in = 0 } is_in { print $1 }')
all=()
for command in $commands; do all+=("$command"); done
for part in status export merge plot slurm; do all+=("study $part"); done

expect "--help --version $commands" ''
report "bash offers the commands" $?
for command in "${all[@]}"; do
    expect "$(options_of_help $command)" $command --
    report "bash offers the options of $command" $?
done

# the words of a choice are those that the program names when it refuses another
allowed=$("$program" new --kind nothing 2>&1 | sed 's/.*allowed: //; s/,//g')
expect "$allowed" new --kind ''
report "bash offers the words of a choice" $?
expect "$allowed" new --kind = ''
report "bash offers them behind --option= as well" $?
expect "analytic,reference" run --backend analytic,ref
report "bash offers one more of a list" $?
expect "contact.damping=" run --set contact.damp
report "bash offers the keys of a case" $?
expect "status" study st
report "bash offers the commands of study" $?
expect "run report" help r
report "bash offers topics of help" $?
IFS=$'\n'
expect $'a case.yaml\nb.json\nsub' run ''
report "bash offers cases, and folders" $?
expect $'a case.yaml\nb.json\nd.sqlite\nsub' study export ''
report "bash offers stores where one may stand" $?
expect sub run --out ''
report "bash offers folders alone for --out" $?
unset IFS

sed -i 's/--uncertified //' "$work/jointplay"
. "$work/jointplay"
! expect "$(options_of_help run)" run -- && grep -q uncertified "$log"
report "the control: an option that is missing is found" $?

if [ -n "$zsh" ]; then
    "$program" help --completion zsh >"$work/_jointplay" && "$zsh" -fn "$work/_jointplay" >"$log" 2>&1
    report "zsh reads its script" $?
    cat >"$work/ask.zsh" <<'END'
_arguments() { print -rl -- "$@" }
_describe() { : }
compadd() { : }
script=$1
shift
words=(jointplay "$@" '')
CURRENT=$#words
. $script
END
    for command in "${all[@]}"; do
        "$zsh" -f "$work/ask.zsh" "$work/_jointplay" $command >"$work/specs" 2>"$log"
        diff <(options_of_help $command) \
            <(grep -oE -e '^(\(-. --[a-z-]+\)|\*)?--[a-z-]+' "$work/specs" | grep -oE -e '--[a-z-]+' |
                sort -u) >>"$log" && [ ! -s "$log" ]
        report "zsh offers the options of $command" $?
    done
    "$zsh" -f "$work/ask.zsh" "$work/_jointplay" new >"$work/specs" 2>"$log"
    grep -qF -e ":KIND:($allowed)" "$work/specs"
    report "zsh offers the words of a choice" $?
fi
echo "1..$number"
