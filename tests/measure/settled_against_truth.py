#!/usr/bin/env python3
"""Holds the settled motions that the program finds against those of an independent integration.

    settled_against_truth.py PROGRAM GENERATOR SEED TRUTH [SETTING...]

GENERATOR is settled_random, which writes the 60 cases of the seed; TRUTH what settled_truth prints
of them. Every motion of at least a fifth of the truth's starts has to be found, with its force
within 1 %, or, where it does not repeat, with the truth's 95 % quantile inside the interval that
the program states. Prints each case that misses, and the counts; fails where they are too few.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SHARE_LEAST = 0.2
FORCE_WITHIN = 0.01
SILENT_ERROR = 0.1

# of 60 cases, in which a 95 % interval misses in three by chance
REPEATING_LEAST = 57
RANDOM_LEAST = 54


def read_truth(path):
    cases = {}
    for line in Path(path).read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        name, _, period, starts, of, force, q95, *_ = line.split()
        cases.setdefault(name, []).append(
            {"period": int(period), "share": int(starts) / int(of), "force": float(force),
             "q95": float(q95)})
    return cases


def find_settled(value):
    if isinstance(value, dict):
        if "settled" in value:
            return value["settled"]
        for member in value.values():
            found = find_settled(member)
            if found:
                return found
    return None


def force_of(motion, ends=("",)):
    joint = motion["joints"][0]
    word = "force_max{}_N" if "force_max_N" in joint else "torque_max{}_N_m"
    return [joint[word.format(end)] for end in ends]


def found_motions(program, case, settings):
    started = time.monotonic()
    run = subprocess.run(
        [program, "run", str(case), "--backend", "reference", "--json", "--quiet",
         *[word for setting in settings for word in ("--set", setting)]],
        capture_output=True, text=True, check=False)
    took_s = time.monotonic() - started
    if run.returncode != 0:
        return None, took_s, run.stderr.strip().splitlines()[-1:]
    settled = find_settled(json.loads(run.stdout))
    if settled is None:
        return None, took_s, ["starts as written"]
    return settled, took_s, None


def is_found(truth, motions):
    for motion in motions:
        force, low, high = force_of(motion, ("", "_low", "_high"))
        if truth["period"] > 0:
            if motion["period"] > 0 and abs(force / truth["force"] - 1) <= FORCE_WITHIN:
                return True
        elif motion["period"] == 0:
            if (low or 0) <= truth["q95"] <= (high if high is not None else float("inf")):
                return True
    return False


def is_wrong(motion, truths):
    """A motion that is said to repeat, and is none of the truth's."""
    force, = force_of(motion)
    return motion["period"] > 0 and all(
        abs(force / truth["force"] - 1) > SILENT_ERROR for truth in truths)


def describe(motion):
    force, low, high = force_of(motion, ("", "_low", "_high"))
    return f"p{motion['period']} {motion['starts']}: {force:.5g}" + (
        f" ({low or 0:.4g} to {high or float('inf'):.4g})" if motion["period"] == 0 else "")


def judge(program, case, truths, settings):
    """What one case misses: of what repeats, of what does not, and what it says that is wrong."""
    settled, took_s, why = found_motions(program, case, settings)
    motions = [settled, *settled["other_motions"]] if settled else []
    misses = [truth for truth in truths
              if truth["share"] >= SHARE_LEAST and not is_found(truth, motions)]
    errors = [motion for motion in motions if is_wrong(motion, truths)]
    if misses or errors or why:
        print(f"{case.stem}: truth " + "; ".join(
            f"p{t['period']} {t['share']:.0%}: {t['force']:.5g}" for t in truths) +
            " | found " + "; ".join(describe(motion) for motion in motions) +
            f" | {why or ''} {took_s:.1f} s")
    return (any(truth["period"] > 0 for truth in misses),
            any(truth["period"] == 0 for truth in misses), bool(errors), took_s)


def main():
    program, generator, seed, truth_path, *settings = sys.argv[1:]
    cases = read_truth(truth_path)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([generator, seed, folder], check=True)
        judged = [judge(program, Path(folder) / f"{name}.yaml", truths, settings)
                  for name, truths in cases.items()]
    repeating, random, wrong, times = zip(*judged)
    times = sorted(times)
    found, inside = len(cases) - sum(repeating), len(cases) - sum(random)
    print(f"{len(cases)} cases: all that repeats is found in {found}; what does not is inside its "
          f"interval in {inside}; {sum(wrong)} with a motion that is none; "
          f"{times[len(times) // 2]:.2f} s in the median, {times[-1]:.1f} s at most")
    return found < REPEATING_LEAST or inside < RANDOM_LEAST or any(wrong)


sys.exit(main())
