#!/usr/bin/env python3
"""How long a stranger waits for the first screen of his own mechanism.

    first_screen.py PROGRAM [OTHER PROGRAM] [--seed N] [--count N] [--keep DIR]

Seeded random slider-cranks, four-bars and six-bars (N of each), with one to three worn pins of
steel, friction of 0 to 0.2 and 60 to 3000 rpm, all else by default. Of each the processor time is
read from the system when the first screen's table and what is said below it are there, and once
more at the end; beside it that of another program on the same cases, whose first screen may come
at its end. Prints a row a case, then medians and the worst.
"""
import argparse
import math
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time

TICKS = os.sysconf("SC_CLK_TCK")
LIMIT_S = 120.0


def body(name, mass, inertia, center):
    return f"  {name}: {{mass: {mass:.4g} kg, inertia: {inertia:.4g} kg m^2, at: [{center[0]:.5f} m, {center[1]:.5f} m]}}\n"


def bar(name, a, b, rng):
    """A bar between two points, of steel, with its centre of mass in the middle."""
    length = math.dist(a, b)
    mass = length * rng.uniform(1.0, 4.0)
    center = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    return body(name, mass, mass * length**2 / 12 * rng.uniform(1.0, 1.5), center)


def meet(a, b, ra, rb, side):
    """The point at two distances from two points."""
    d = math.dist(a, b)
    x = (d * d + ra * ra - rb * rb) / (2 * d)
    y2 = ra * ra - x * x
    if y2 <= 0:
        return None
    y = side * math.sqrt(y2)
    ux, uy = (b[0] - a[0]) / d, (b[1] - a[1]) / d
    return (a[0] + x * ux - y * uy, a[1] + x * uy + y * ux)


def four_bar_lengths(rng):
    """A crank-rocker well inside Grashof's condition."""
    while True:
        crank, ground, coupler, rocker = (rng.uniform(*r) for r in ((.03, .08), (.15, .3), (.12, .3), (.1, .25)))
        lengths = sorted((crank, ground, coupler, rocker))
        if lengths[0] == crank and lengths[0] + lengths[3] < .92 * (lengths[1] + lengths[2]):
            return crank, ground, coupler, rocker


def pin(at, bodies, rng, worn):
    text = f"between: [{bodies[0]}, {bodies[1]}], at: [{at[0]:.6f} m, {at[1]:.6f} m]"
    if worn:
        size = rng.choice((8, 10, 12, 16, 20, 30))
        clearance = 10 ** rng.uniform(-2.0, -.7)
        text += f", hole: {size + clearance:.4f} mm, pin: {size} mm, width: {rng.uniform(.8, 2) * size:.2f} mm"
    return "{" + text + "}"


def case(kind, rng):
    bodies, joints, names = "", {}, []

    def add(name, at, of):
        joints[name] = (at, of)
        if "ground" not in of or name != "drive":
            names.append(name)

    origin = (0.0, 0.0)
    if kind == "slider-crank":
        crank, rod = rng.uniform(.03, .08), rng.uniform(.15, .3)
        angle = rng.uniform(0, 2 * math.pi)
        a = (crank * math.cos(angle), crank * math.sin(angle))
        b = (a[0] + math.sqrt(rod**2 - a[1] ** 2), 0.0)
        bodies += bar("crank", origin, a, rng) + bar("rod", a, b, rng)
        bodies += body("slider", rng.uniform(.5, 3.0), 1e-3, b)
        add("drive", origin, ("ground", "crank"))
        add("crank-rod", a, ("crank", "rod"))
        add("rod-slider", b, ("rod", "slider"))
        extra = f"  slide: {{between: [ground, slider], at: [{b[0]:.6f} m, 0 m], along: 0 deg}}\n"
    else:
        crank, ground, coupler, rocker = four_bar_lengths(rng)
        angle = rng.uniform(0, 2 * math.pi)
        a = (crank * math.cos(angle), crank * math.sin(angle))
        g = (ground, 0.0)
        b = meet(a, g, coupler, rocker, 1.0)
        bodies += bar("crank", origin, a, rng) + bar("coupler", a, b, rng) + bar("rocker", g, b, rng)
        add("drive", origin, ("ground", "crank"))
        add("crank-coupler", a, ("crank", "coupler"))
        add("coupler-rocker", b, ("coupler", "rocker"))
        add("rocker-ground", g, ("ground", "rocker"))
        extra = ""
        if kind == "six-bar":
            # a slider that the rocker drives by a rod
            rod = 2 * rocker + rng.uniform(.05, .15)
            c = (b[0] + math.sqrt(rod**2 - (b[1]) ** 2), 0.0)
            bodies += bar("rod", b, c, rng) + body("slider", rng.uniform(.5, 3.0), 1e-3, c)
            add("rocker-rod", b, ("rocker", "rod"))
            add("rod-slider", c, ("rod", "slider"))
            extra = f"  slide: {{between: [ground, slider], at: [{c[0]:.6f} m, 0 m], along: 0 deg}}\n"
    worn = set(rng.sample(names, min(len(names), rng.randint(1, 3))))
    rpm = 60 * 50 ** rng.uniform(0, 1)
    lines = "".join(f"  {n}: {pin(at, of, rng, n in worn)}\n" for n, (at, of) in joints.items())
    return (f"title: {kind}\nbodies:\n{bodies}joints:\n{lines}{extra}"
            f"drive: {{joint: drive, speed: {rpm:.1f} rpm}}\n"
            f"contact: {{restitution: {rng.uniform(.3, .8):.2f}, friction: {rng.uniform(0, .2):.3f}}}\n"
            "gravity: 9.81 m/s^2\n")


def processor_s(pid):
    fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12]) + int(fields[13]) + int(fields[14])) / TICKS


def wait_for(program, path, folder):
    """Seconds of the processor to the first screen and to the end, the first row, the status."""
    output = os.path.join(folder, "screen")
    with open(output, "w") as stream:
        process = subprocess.Popen([program, "run", path, "--quiet"], stdout=stream, stderr=subprocess.PIPE)
    first, spent, began = math.nan, 0.0, time.monotonic()
    while process.poll() is None:
        try:
            spent = processor_s(process.pid)
        except (OSError, ValueError):
            break
        text = open(output).read()
        if math.isnan(first) and "Assumed:" in text:
            first = spent
        if time.monotonic() - began > LIMIT_S:
            process.kill()
        time.sleep(.01)
    process.wait()
    text = open(output).read()
    first = spent if math.isnan(first) and text else first
    lines = text.splitlines()
    at = next((i for i, line in enumerate(lines) if line.startswith("  ---")), None)
    row = " ".join(lines[at + 1].split()[:3]) if at is not None else process.stderr.read().decode()[:100]
    return first, spent, row, process.returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--keep")
    asked = parser.parse_args()
    rng = random.Random(asked.seed)
    times = {program: [] for program in asked.programs}
    with tempfile.TemporaryDirectory() as folder:
        for kind in ("slider-crank", "four-bar", "six-bar"):
            for number in range(asked.count):
                path = os.path.join(asked.keep or folder, f"{kind}-{number}.yaml")
                with open(path, "w") as stream:
                    stream.write(case(kind, rng))
                for program in asked.programs:
                    first, whole, row, status = wait_for(program, path, folder)
                    times[program].append((first, whole))
                    print(f"{kind}-{number:<2d} first {first:7.2f} s  whole {whole:7.2f} s  status {status}  {row}", flush=True)
    for program, of in times.items():
        for name, k in (("first screen", 0), ("whole", 1)):
            found = [t[k] for t in of if not math.isnan(t[k])]
            print(f"{program}: {name}: median {statistics.median(found or [math.nan]):.2f} s, "
                  f"worst {max(found, default=math.nan):.2f} s, of {len(found)}")


if __name__ == "__main__":
    sys.exit(main())
