#!/bin/sh
# Is a kind of joint what its row of the table says? Only the files below name one, none of them
# compares it, and a switch over kinds or their traits has no default. Prints TAP.
#     kinds.sh SOURCE_ROOT
set -u
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"

table=model/joint.h
# who names kinds beside the table, and why
permitted='
casefile/joint_kind.c          which keys make which kind, in the order in which they count
commands/map/map_inverse.c     makes a pin in a hole
commands/tune/tune_world_lacks.c  a switch: what the library lacks of each kind, in a sentence
engine/request.c               a switch: the word of the protocol for each kind, or what it lacks
measure/mapping_contact.c      makes a pin in a hole, or a stop
'

# Lines 'file:line: text' for every name of a kind, or comparison of a trait, that is out of place.
misplaced() {
    names=$(sed -n 's/^ *member(with, \(JOINT_[A-Z_]*\),.*/\1/p' "$1/$table" | paste -sd '|')
    traits='JOINT_(HOLDS|TOUCHES|COORDINATE)_[A-Z]+'
    [ -n "$names" ] || echo "$table: no kinds"
    (cd "$1" && grep -rnEw "$names" . --include='*.[ch]' --include='*.inc') | sed 's|^\./||' |
        while IFS= read -r line; do
            file=${line%%:*}
            case "$permitted" in
            *"
$file "*) ;;
            *) [ "$file" = "$table" ] || echo "$line" ;;
            esac
        done
    (cd "$1" && grep -rnE "[=!]= *(($names)\>|$traits)|(\<($names)|\<$traits) *[=!]=" . \
        --include='*.[ch]' --include='*.inc') | sed 's|^\./||' | grep -v "^$table:"
    # a default beside the case of a kind or of a trait, by the depth of the braces
    (cd "$1" && grep -rlE "case ($names|$traits):" . --include='*.[ch]') | sed 's|^\./||' |
        while IFS= read -r file; do
            awk -v kinds="case ($names|$traits):" -v file="$file" '
                /switch \(/ { depth++; is_kinds[depth] = 0; indent[depth] = match($0, /[^ ]/) }
                $0 ~ kinds { is_kinds[depth] = 1 }
                /^ *default:/ && is_kinds[depth] { print file ":" NR ": default beside kinds" }
                /^ *}$/ && depth > 0 && match($0, /[^ ]/) == indent[depth] { depth-- }' \
                "$1/$file"
        done
}

misplaced "$root/src" >"$log"
! [ -s "$log" ]
report "no file names a kind of joint or compares a trait out of place" $?
: >"$log"
echo "$permitted" | while read -r file reason; do
    [ -z "$file" ] || grep -q 'JOINT_[A-Z]' "$root/src/$file" || echo "$file names no kind" >>"$log"
done
! [ -s "$log" ]
report "every file that may name a kind does" $?

# controls: one of each fault in a tree of its own
faulty() {
    rm -rf "$work/src"
    mkdir -p "$work/src/model" "$work/src/engine"
    cp "$root/src/$table" "$work/src/model"
    printf '%s\n' "$2" >"$work/src/$1"
    misplaced "$work/src" >"$log"
    [ -s "$log" ]
    report "$3 is found" $?
}
faulty model/other.c '    made.kind = JOINT_GUIDE;' "a kind in another file"
faulty engine/request.c '    return joint->kind != JOINT_GUIDE;' "a comparison of a kind"
faulty model/other.c '    return joint_touches(kind) == JOINT_TOUCHES_HOLE;' "a comparison of a trait"
faulty model/other.c '    switch (joint_touches(kind)) {
    case JOINT_TOUCHES_HOLE:
        return true;
    default:
        return false;
    }' "a default beside a trait"
echo "1..$number"
