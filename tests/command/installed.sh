#!/bin/sh
# Is the installed program whole? Its cases, baselines and pages are there and found from an empty
# folder, links between pages lead somewhere, and nothing is left when it is uninstalled. The control is
# the program alone, without its data.
# Usage: installed.sh MESON BUILD TAP PYTHON. Prints TAP.
set -u
meson=$1
build=$2
python=$4
. "$3"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log
dest=$work/dest

"$meson" install -C "$build" --no-rebuild --destdir "$dest" >"$log" 2>&1
report "it is installed" $?
prefix=$(dirname "$(dirname "$(find "$dest" -path '*/bin/jointplay')")")
program=$prefix/bin/jointplay
mkdir "$work/empty" && cd "$work/empty" || exit 1

"$program" run cases/paper/ideal-nominal.yaml >"$log" 2>&1 && grep -q ideal-nominal "$log"
report "a case is found by its path" $?
"$program" run ideal-nominal -q --json >"$log" 2>&1 && grep -q '"ok"' "$log"
report "a case is found by its name" $?
"$program" study cases/studies/mapping.yaml --dry-run >"$log" 2>&1 && grep -q '2400 runs' "$log"
report "a study is found, and its case" $?
"$program" check cases/paper/ideal-nominal.yaml --shipped --quick >"$log" 2>&1 && grep -q "1 within" "$log"
report "a baseline is found" $?
"$program" check --quick >"$log" 2>&1
[ $? = 5 ] && grep -q "baseline is not there" "$log"
report "a check without baselines of one's own fails" $?
"$program" check cases/hard/grashof-limit.yaml --expect-only >"$log" 2>&1
report "a hard case is found" $?

mkdir -p cases/paper && echo 'title: Mine' >cases/paper/ideal-nominal.yaml
! "$program" run cases/paper/ideal-nominal.yaml >"$log" 2>&1
report "a file of that path in the current folder goes first" $?
rm -r cases
! "$program" run ideal-nominal.yaml >"$log" 2>&1 && grep -q 'ideal-nominal.yaml: cannot be read' "$log"
report "the name of a file that is missing is an error" $?
before=$(cksum "$prefix"/share/jointplay/results/baseline/*.json | cksum)
"$program" check --bless ideal-nominal >"$log" 2>&1 && [ -s results/baseline/ideal-nominal.json ] &&
    [ "$before" = "$(cksum "$prefix"/share/jointplay/results/baseline/*.json | cksum)" ]
report "a baseline is written into the current folder, and not over the program's own" $?

for page in jointplay $("$program" help | awk '/^Commands:/ { is_in = 1; next } /^$/ { is_in = 0 } is_in { print "jointplay-" $1 }'); do
    [ -s "$prefix/share/man/man1/$page.1" ] || echo "there is no manual page $page.1"
done >"$log"
[ ! -s "$log" ]
report "every command has its manual page" $?
for file in share/bash-completion/completions/jointplay.bash share/zsh/site-functions/_jointplay; do
    [ -s "$prefix/$file" ] || echo "there is no $file"
done >"$log"
[ ! -s "$log" ]
report "completion stands where the shells look for it" $?

pages=$prefix/share/doc/jointplay
for page in "$pages"/*.md "$pages"/docs/*.md; do
    grep -oE '\]\([^)#:]+[)#]' "$page" | sed 's/^](//; s/[)#]$//' | sort -u | while read -r link; do
        [ -e "$(dirname "$page")/$link" ] || echo "$page: $link is not there"
    done
done | grep -vE ': (\.\./)?(tests|cases|include|src|CONTRIBUTING.md)' >"$log"
[ ! -s "$log" ]
report "links between pages lead to what is installed" $?

module=$(dirname "$(dirname "$(find "$prefix" -path '*/jointplay/__init__.py')")")
PYTHONPATH=$module PYTHONDONTWRITEBYTECODE=1 "$python" -c "
import jointplay as jp
assert jp.__file__.startswith('$module')
assert jp.Case('ideal-nominal').run('analytic').status == 'ok'
assert len(jp.Case('ideal-nominal').run('analytic').series['time_s']) == 3601
" >"$log" 2>&1
report "the Python module finds its library and the cases" $?

cp "$program" "$work/alone" && ! "$work/alone" run ideal-nominal >"$log" 2>&1
report "the control: the program without its data finds no case" $?

# meson takes away what stands in its log
mkdir -p "$work/log-of/meson-logs" && cp "$build/meson-logs/install-log.txt" "$work/log-of/meson-logs" &&
    (cd "$work/log-of" && "$meson" --internal uninstall) >"$log" 2>&1
find "$work" -path "$dest*" -type f >"$log"
[ ! -s "$log" ]
report "nothing is left once it is uninstalled" $?
echo "1..$number"
