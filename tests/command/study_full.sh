#!/bin/sh
# Does a study that fills its disk say so, and go on when there is room again? On a small disk in
# memory, in a namespace of its own. Prints TAP.
set -u
program=$1
cases=$2
if [ "${3:-}" != inside ]; then
    exec unshare --map-root-user --mount sh "$0" "$program" "$cases" inside
fi

folder=$(mktemp -d) || exit 1
trap 'cd /; umount "$folder/disk"; rm -r "$folder"' EXIT
mkdir "$folder/disk"
mount -t tmpfs -o size=512k none "$folder/disk" || exit 1
cd "$folder" || exit 1
cat >s.yaml <<END
title: A study that fills the disk
case: $cases/paper/ideal-nominal.yaml
# long enough that a quarter of a second, which is committed at once, does not fill the disk
set: {run.samples: 36, run.step: 15 us}
vary:
  drive.speed: {from: 500 rpm, to: 1500 rpm, count: 300}
  scheme: [direct/plain, direct/staggered]
truth: false
END

number=0
check() {
    number=$((number + 1))
    if [ "$2" = 0 ]; then
        echo "ok $number - $1"
    else
        echo "not ok $number - $1"
        sed 's/^/# /' errors
    fi
}

# rows without what is never twice the same, the last column
rows() {
    "$program" study export "$1" | sed 's/,[^,]*$//'
}

echo 1..6
dd if=/dev/zero of=disk/filler bs=1k count=430 2>/dev/null
"$program" study s.yaml --store disk/s.sqlite >output 2>errors
[ $? = 5 ]
check 'a full disk ends it with status 5' $?
grep -q 'No space left on device' errors
check 'it says that there is no space left' $?
rows disk/s.sqlite >before
[ "$(wc -l <before)" -gt 1 ]
check 'what was committed is there' $?
rm disk/filler
"$program" study s.yaml --store disk/s.sqlite >output 2>errors
check 'with room it goes on to its end' $?
"$program" study s.yaml --store whole.sqlite >output 2>errors
rows disk/s.sqlite >after
rows whole.sqlite >whole
cmp after whole >errors
check 'all rows are there, and none twice' $?
grep -vxFf after before >errors
[ ! -s errors ]
check 'nothing was lost on the way' $?
