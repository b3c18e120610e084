# What does it cost to run a case from Python? N runs of the paper's case at N plays, by the reference at
# a tolerance of 1e-5: by the module, by the same calls in C, and as a study. Processor times are taken
# in turns, each way in a process that keeps the memory it has had (C alone gives it back after every
# run, which costs it up to a third), and of less than 10,000 runs the least of ROUNDS counts.
# Usage: python_runs.py PROGRAM C_PROGRAM CASES [RUNS]
import os
import re
import resource
import subprocess
import sys
import tempfile
import time

import jointplay as jp

ROUNDS = 3
PLAY = "joints.crank-coupler.radial-clearance"
program, in_c = map(os.path.abspath, sys.argv[1:3])
runs = int(sys.argv[4]) if sys.argv[4:] and sys.argv[4].isdigit() else 10000
folder = tempfile.TemporaryDirectory()
paper = os.path.join(folder.name, "paper.yaml")
with open(os.path.join(sys.argv[3], "paper/impact-k66.yaml"), encoding="utf-8") as file:
    # without what it says of ODE, so that the study is made by the reference, too
    text = re.sub(r"step: 1 us, |^ode: .*$", "", file.read(), flags=re.M)
with open(paper, "w", encoding="utf-8") as file:
    file.write(text)
rounds = ROUNDS if runs < 10000 else 1


def by_module():
    case = jp.Case(sys.argv[-1])
    case.set({"run.start": "centred", "reference.tolerance": "1e-5", "run.samples": 360})
    begin, total = time.process_time(), 0.0
    for i in range(runs):
        case[PLAY] = 10e-6 + 10e-6 * i / runs
        run = case.run("reference", certified=False, contacts=False, threads=1, progress=False)
        total += run.joints["crank-coupler"].force_max
        run.close()  # before the next, as in C
    return time.process_time() - begin, total


KEEPS = {**os.environ, "MALLOC_TOP_PAD_": str(1 << 26), "MALLOC_TRIM_THRESHOLD_": str(1 << 28)}


def told(words):
    """What a process prints of itself: processor time and the sum of the forces."""
    said = subprocess.run(words, capture_output=True, text=True, check=True, env=KEEPS).stdout
    return tuple(map(float, said.split()))


def by_c():
    return told([in_c, paper, str(runs)])


def by_study():
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "s.yaml"), "w", encoding="utf-8") as file:
            file.write(
                f"title: Plays\ncase: {paper}\ntruth: false\n"
                "set: {run.start: centred, reference.tolerance: 1e-5, run.samples: 360}\n"
                f"vary:\n  {PLAY}: {{from: 10 um, to: 20 um, count: {runs}}}\n"
            )
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [program, "study", "s.yaml", "--jobs", "1", "--quiet"],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            check=True,
            env=KEEPS,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, None


def by_python():
    return told([sys.executable, *sys.argv, "--module", paper])


if "--module" in sys.argv:
    print(*map(repr, by_module()))
    sys.exit(0)
ways = {"in C": by_c, "in Python": by_python, "as a study": by_study}
best = {name: (float("inf"), None) for name in ways}
for _ in range(rounds):
    for name, way in ways.items():
        best[name] = min(best[name], way(), key=lambda one: one[0])
for name, (spent, _) in best.items():
    print(
        f"{name:11} {runs} runs, {spent:7.2f} s, {runs / spent:6.0f} runs/s, {spent / best['in C'][0]:.3f} of C"
    )
print(f"the same forces in Python as in C: {best['in Python'][1] == best['in C'][1]}")
