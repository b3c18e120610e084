# What does it cost to run a case from Python? N runs of the paper's case at N plays, by the reference at
# a tolerance of 1e-5: by the module, by the same calls in C, and as a study. Processor times are taken
# in turns of a few seconds, so that what else the machine does falls on all of them, each way in a
# process that keeps the memory it has had (C alone gives it back after every run, which costs it up to
# a third). The ratio is the median of those within one turn.
# Usage: python_runs.py PROGRAM C_PROGRAM CASES [RUNS]
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import jointplay as jp

TURN = 500  # runs
PLAY = "joints.crank-coupler.radial-clearance"
program, in_c = map(os.path.abspath, sys.argv[1:3])
asked = int(sys.argv[4]) if sys.argv[4:] and sys.argv[4].isdigit() else 10000
runs, turns = min(asked, TURN), max(1, asked // TURN)
folder = tempfile.TemporaryDirectory()
paper = os.path.join(folder.name, "paper.yaml")
with open(os.path.join(sys.argv[3], "paper/impact-k66.yaml"), encoding="utf-8") as file:
    # without what it says of ODE, so that the study is made by the reference, too
    text = re.sub(r"step: 1 us, |^ode: .*$", "", file.read(), flags=re.M)
with open(paper, "w", encoding="utf-8") as file:
    file.write(text)


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
spent = {name: [] for name in ways}
forces = {name: [] for name in ways}
for _ in range(turns):
    for name, way in ways.items():
        one, force = way()
        spent[name].append(one)
        forces[name].append(force)
for name, times in spent.items():
    ratio = statistics.median(one / in_c for one, in_c in zip(times, spent["in C"]))
    total, count = sum(times), runs * turns
    print(f"{name:11} {count} runs, {total:7.2f} s, {count / total:6.0f} runs/s, {ratio:.3f} of C")
print(f"the same forces in Python as in C: {forces['in Python'] == forces['in C']}")
