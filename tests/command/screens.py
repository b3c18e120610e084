# Is the first screen of a command a screen, and is every number on it in the command's JSON?
#
# Called with the program and case files. Of each case run, map, compare and tune print their first
# screen: at most 24 lines of 80 columns. Each of its numbers, as far as it is printed, is then one of
# the numbers or in one of the texts of the JSON of the same command, in SI or in the unit that stands
# beside it; times of the processor differ from one call to the next and are left out. The control is
# the JSON of another case. Prints TAP.
import json
import math
import re
import subprocess
import sys

COMMANDS = {
    "run": [],
    "map": [],
    "compare": ["--steps", "20us,40us", "--schemes", "direct/staggered"],
    "tune": ["--error", "1e-2", "--schemes", "direct/staggered/impulse", "--cost", "steps"],
}
LINES, COLUMNS = 24, 80
# what SI is multiplied by, to be what is printed
SCALES = [10.0**k for k in range(-9, 10, 3)] + [100.0, 0.01, 180 / math.pi, 30 / math.pi]
TIMES = re.compile(
    r"^  Time:|processor|wall time|CPU| ms\.?$|meets it|misses it|in [0-9.]+ ms|reference.tolerance="
)
NUMBER = re.compile(r"(?<![\w./-])(\d+\.?\d*(?:e[+-]?\d+)?)(?=[ ,;:.)%]|$)")


def numbers_of(value, found):
    if isinstance(value, dict):
        for part in value.values():
            numbers_of(part, found)
    elif isinstance(value, list):
        for part in value:
            numbers_of(part, found)
    elif isinstance(value, str):
        found += [float(x) for x in re.findall(r"\d+\.?\d*(?:e[+-]?\d+)?", value)]
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        found.append(abs(float(value)))
    return found


def is_among(printed, numbers):
    digits = len(re.sub(r"e.*", "", printed).replace(".", "").lstrip("0")) or 1
    value = float(printed)
    for scale in SCALES:
        for number in numbers:
            if abs(value - number * scale) <= 0.51 * 10.0 ** (1 - digits) * abs(number * scale):
                return True
    return False


def missing(screen, numbers):
    lacks = []
    for line in screen[2:]:
        if not line.startswith("  case") and not TIMES.search(line):
            lacks += [(x, line) for x in NUMBER.findall(line) if not is_among(x, numbers)]
    return lacks


def call(words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


program, cases = sys.argv[1], sys.argv[2:]
print("1..%d" % (len(cases) * len(COMMANDS) + 1))
count = 0
first = None
for case in cases:
    for command, options in COMMANDS.items():
        words = [program, command, case, "--quiet"] + options
        screen = [line for line in call(words).split("\n") if line]
        numbers = numbers_of(json.loads(call(words + ["--json"])), [])
        wide = [line for line in screen if len(line) > COLUMNS and not line.startswith("  case")]
        lacks = missing(screen, numbers)
        count += 1
        is_good = len(screen) <= LINES and not wide and not lacks
        verdict = "ok" if is_good else "not ok"
        print("%s %d - %s of %s: %d lines" % (verdict, count, command, case, len(screen)))
        for line in wide + ["%s in: %s" % lack for lack in lacks]:
            print("# " + line)
        if first is None:
            first = screen
        last = numbers
count += 1
verdict = "ok" if missing(first, last) else "not ok"
print("%s %d - another case's numbers are not taken for these" % (verdict, count))
