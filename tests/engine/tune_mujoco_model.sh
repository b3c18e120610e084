#!/bin/sh
# Is the model that tune writes for MuJoCo whole, and does its tendon push as the spring and damper
# that the file names? It is run from the file by MuJoCo alone, and held against the reference of that
# linear law. Prints TAP.
#     tune_mujoco_model.sh PROGRAM PLAYER PYTHON
set -u
program=$1
player=$2
python=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"
case=$JOINTPLAY_CASES/paper/impact-k66.yaml
cd "$work" || exit 1
set -- --set run.start=centred --set run.revolutions=0.05

"$program" tune "$case" --error 0.3 --schemes direct/staggered/impulse --mjcf model.xml -q "$@" \
    >out 2>"$log"
grep -q 'key name' model.xml && grep -q 'its error is' model.xml &&
    grep -q 'run in MuJoCo' out 2>/dev/null || grep -q '<tendon>' model.xml
report "a whole model is written, with its error" $?
spring=$(sed -n 's/.*spring \([^ ]*\) N.*/\1/p' model.xml)
damper=$(sed -n 's/.*damper \([^ ]*\) N.*/\1/p' model.xml)
"$program" run "$case" --backend reference "$@" --set "contact.stiffness=$spring N/m" \
    --set contact.damping=viscous --set "contact.viscous-coefficient=$damper N s/m" --json -q \
    >truth.json 2>"$log"
truth=$("$python" -c "
import json
print(json.load(open('truth.json'))['runs'][0]['joints']['crank-coupler']['penetration_max_m'])" 2>>"$log")
depth=$("$player" model.xml 0.003 2>>"$log")
"$python" -c "import sys; sys.exit(0 if abs($depth / $truth - 1) < .03 else 1)" 2>>"$log"
report "run by MuJoCo alone its pin goes as deep as the law's, $truth m" $?
# the control: a limit that is not scaled by this model's own inverse weight
sed 's/solreflimit=.\(-[0-9.]*\) \(-[0-9.]*\)./solreflimit="-8e8 -2.2e3"/' model.xml >other.xml
other=$("$player" other.xml 0.003 2>>"$log")
"$python" -c "import sys; sys.exit(0 if abs($other / $truth - 1) > .2 else 1)" 2>>"$log"
report "with another scale it does not" $?
JOINTPLAY_DRIVERS="$work/none" "$program" tune "$case" --error 0.3 --mjcf pair.xml -q --full \
    --schemes direct/staggered/impulse "$@" >out 2>"$log"
grep -q 'not run here' pair.xml && grep -q "There is no whole model: there is no driver" out
report "without the driver it is said that it was not run" $?
own=$(dirname "$(realpath "$program")")/../drivers/jointplay-mujoco
JOINTPLAY_DRIVERS="$work/none" "$program" tune "$case" --error 0.3 --mjcf named.xml -q \
    --schemes direct/staggered/impulse --driver "mujoco=$own" "$@" >out 2>"$log"
cmp -s model.xml named.xml
report "with a driver that is named the same model is written" $?
"$program" tune "$JOINTPLAY_CASES/mechanisms/run-up.yaml" --error 0.5 --mjcf sprung.xml -q \
    --schemes direct/staggered/impulse --set run.duration='5 ms' >out 2>"$log"
grep -q "springlength='0.08" sprung.xml && grep -q " damping='0.002'" sprung.xml &&
    grep -q "left out: the load 'drive', which is not constant" sprung.xml &&
    grep -q "mjcf leaves out: the load 'drive', which is not constant" "$log"
report "springs and dampers are in it, and what is not is named" $?
! "$program" tune "$case" --error 0.3 --driver "toy=$own" -q "$@" >out 2>"$log" && grep -q 'toy=.* is not used' "$log"
report "and one of another engine is refused" $?
echo 1..$number
