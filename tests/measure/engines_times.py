#!/usr/bin/env python3
"""Prints the table of times of other mechanisms in docs/engines.md: the wall time, in ms, of each
engine's cheapest step for an error, with contacts within the step / in any other way.

    engines_times.py JOINTPLAY CASES

JOINTPLAY is the program, built with its drivers; CASES the folder of cases. Times compare only where
the machine does nothing else.
"""

import json
import os
import subprocess
import sys

ENGINES = ["ode", "mujoco", "chipmunk", "bullet", "simbody"]
STEPS = "100 us, 50 us, 25 us, 10 us, 5 us, 2 us"
ERRORS = [1e-2, 1e-3, 1e-4, 1e-5]
MECHANISMS = [
    ("half a millimetre of play", "hard/play-5e-4.yaml"),
    ("slider-crank", "mechanisms/slider-crank-pin.yaml"),
    ("three clearances", "literature/three-clearances.yaml"),
]


def engine_of(scheme):
    """The engine of a scheme of `compare`, and whether its contacts are within the step."""
    name = scheme.split("/")[0]
    if name in ENGINES[1:]:
        return name, scheme.endswith("/kernel")
    if name in ("direct", "quick"):
        return "ode", scheme.endswith("/impulse")
    return None, False


def points(program, path):
    """Of each engine, with contacts within the step and without: errors and wall times, s."""
    command = [program, "compare", path, "--backends", ",".join(ENGINES), "--steps", STEPS,
               "--jobs", "1", "--json", "--quiet"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if not ran.stdout.startswith("{"):
        sys.exit(ran.stderr.strip())
    found = {}
    for scheme in json.loads(ran.stdout)["schemes"]:
        engine, is_within = engine_of(scheme["scheme"])
        for point in scheme["points"]:
            if engine and point["status"] == "ok":
                found.setdefault((engine, is_within), []).append(
                    (point["error_max"], point["wall_median_s"]))
    return found


def cheapest(of_way, error):
    """The least time, ms, of those that meet an error."""
    times = [time for is_off, time in of_way if is_off <= error]
    return f"{float(f'{1e3 * min(times):.2g}'):g}" if times else "-"


def main():
    program, cases = sys.argv[1:3]
    print("| |", " | ".join(["ODE", "MuJoCo", "Chipmunk", "Bullet", "Simbody"]), "|")
    print("|---" * (1 + len(ENGINES)) + "|")
    for title, file in MECHANISMS:
        found = points(program, os.path.join(cases, file))
        for error in ERRORS:
            cells = [" / ".join(cheapest(found.get((engine, is_within), []), error)
                                for is_within in (True, False)) for engine in ENGINES]
            shown = f"{error:.0e}".replace("e-0", "e-")
            head = f"[{title}](../cases/{file}), {shown}" if error == ERRORS[0] else shown
            print(f"| {head} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
