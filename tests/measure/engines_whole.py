#!/usr/bin/env python3
"""Prints the table of whole mechanisms in docs/engines.md: the errors of all speeds, over time, of
every engine's ways at one step, or why it does not run them.

    engines_whole.py JOINTPLAY CASES [ENGINE/WAY...]

JOINTPLAY is the program, built with its drivers; CASES the folder of cases. Without ways all of them.
"""
import json
import os
import subprocess
import sys
import tempfile

STEP = "20 us"
LIMIT_S = 300  # of a run, with its reference

# title, file, what is changed: shorter runs where a whole one takes minutes as a force, and samples so
# close that a lever which stops dead between two of them is not taken for one that has jumped
MECHANISMS = [
    ("servo with backlash", "mechanisms/servo-backlash.yaml", ["run.samples=5000"]),
    ("gears with play in a bearing and transmission error", "mechanisms/loose-gears.yaml", []),
    ("hinge with stops", "mechanisms/stop-rebound.yaml", ["run.duration=0.4 s"]),
    ("slider at 30 degrees with stops", None, []),
    ("guide", "mechanisms/slider-crank-guide.yaml", []),
    ("five-bar with two drives", "mechanisms/five-bar.yaml", []),
    ("compressor", "mechanisms/compressor.yaml", []),
    ("cam and follower", "mechanisms/cam-roller.yaml", []),
    ("planetary gear", "mechanisms/planetary-gear.yaml", ["run.duration=10 ms"]),
    ("woodpecker", "mechanisms/woodpecker.yaml", []),
    ("motor with flywheel", "mechanisms/motor-flywheel.yaml", []),
    ("pin in space", "space/overhung-pin.yaml", []),
]
SLIDER = """\
bodies:
  block: {mass: 0.5 kg, inertia: 100 kg mm^2, at: [0 mm, 0 mm]}
joints:
  line: {between: [ground, block], at: [0 mm, 0 mm], along: 30 deg, low: -20 mm, high: 30 mm,
         stiffness: 1e5 N/m, viscous-coefficient: 20 N s/m}
gravity: 9.81 m/s^2
run: {duration: 0.4 s, samples: 1000}
"""
WAYS = [
    "mujoco/native", "chipmunk/native", "bullet/native", "simbody/native",
    "mujoco/force", "chipmunk/staggered", "bullet/staggered", "simbody/force",
]


def cell(program, path, way, changes):
    """The error of a way as text, or a word for why there is none, and the whole reason."""
    engine, name = way.split("/")
    command = [program, "run", path, "--backend", f"reference,{engine}", "--json",
               "--set", f"engines.{engine}={name}", "--set", f"run.step={STEP}"]
    for change in changes:
        command += ["--set", change]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        return "takes too long", f"more than {LIMIT_S} s"
    if not ran.stdout.startswith("{"):
        return "refused", ran.stderr.strip().split("\n")[0]
    for run in json.loads(ran.stdout)["runs"]:
        if run["backend"] == engine:
            if run["status"] != "ok":
                return "failed", run["message"]
            return f"{run['error']['max']:.1e}".replace("e-0", "e-").replace("e+00", ""), ""
    return "refused", ran.stderr.strip().split("\n")[0]


def main():
    program, cases = sys.argv[1], sys.argv[2]
    ways = sys.argv[3:] or WAYS
    with tempfile.TemporaryDirectory() as folder:
        slider = os.path.join(folder, "slider.yaml")
        with open(slider, "w", encoding="utf-8") as file:
            file.write(SLIDER)
        print("| | " + " | ".join(ways) + " |")
        print("|---" * (len(ways) + 1) + "|")
        for title, name, changes in MECHANISMS:
            path = slider if name is None else os.path.join(cases, name)
            row = [cell(program, path, way, changes) for way in ways]
            print(f"| {title} | " + " | ".join(text for text, _ in row) + " |", flush=True)
            for way, (_, reason) in zip(ways, row):
                if reason:
                    print(f"{title}, {way}: {reason}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
