#!/bin/sh
# Does docs/kernel.md show the code that runs? Every function on the page must stand so in the source.
# Prints TAP.
#     kernel_page.sh SOURCE_ROOT PYTHON
set -u
root=$1
python=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"

# Whether every function of a page stands in the source, and at least three do.
shows() {
    "$python" - "$1" "$root/src/drivers/mujoco/mujoco_kernel.c" 2>"$log" <<'END'
import re
import sys

page, source = (open(name).read() for name in sys.argv[1:])
blocks = [b for b in re.findall(r"```c\n(.*?)```", page, re.S) if "static " in b]
other = [b.splitlines()[0] for b in blocks if b not in source]
sys.exit("\n".join(other) or (0 if len(blocks) >= 3 else "few"))
END
}

echo 1..2
shows "$root/docs/kernel.md"
report "the page shows the adapter as it is" $?
# the control: one name is another one
sed 's/mj_comVel(/mj_comPos(/' "$root/docs/kernel.md" >"$work/page.md"
! shows "$work/page.md"
report "a page that shows another is found" $?
