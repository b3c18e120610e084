#!/usr/bin/env python3
"""Do two builds of jointplay give the same results, bit for bit?

    same_results.py OLD NEW [CASE...]

Runs every case with every backend and every scheme by both programs, and compares the JSON, with
every number, the texts of `run` and the series, times of the machine and versions aside. Prints
every difference, and how many were compared."""
import concurrent.futures, glob, itertools, json, os, re, subprocess, sys, tempfile

OLD, NEW = sys.argv[1:3]
CASES = sys.argv[3:] or sorted(glob.glob("cases/*/*.yaml"))
CASES = [c for c in CASES if "/studies/" not in c]
MACHINE = re.compile(r"wall|_cpu|cpu_|version|^tool$|per_s$|us_per_step|real_time_factor")
SCHEMES = [("reference", []), ("analytic", [])] + [
    ("ode", [f"ode.solver={s}", f"ode.stepping={t}"] + ([f"ode.map={m}"] if m else []))
    for s in ("direct", "quick") for t, m in
    [("plain", m) for m in ("textbook", "corrected", "exact", None)]
    + [("staggered", m) for m in ("midpoint", "impulse", "exact", None)] + [("extrapolated", None)]]
SECONDS = 60

def without_machine(value):
    if isinstance(value, dict):
        return {k: without_machine(v) for k, v in value.items() if not MACHINE.search(k)}
    if isinstance(value, list):
        return [without_machine(v) for v in value]
    return value

def call(program, words, case):
    try:
        done = subprocess.run([program, *words, case], capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return None
    words = [line for line in done.stderr.splitlines() if "at its present pace" not in line]
    return done.returncode, done.stdout, words

def json_of(program, case, backend, sets):
    words = ["run", "-q", "--json", "--backend", backend]
    for one in sets:
        words += ["--set", one]
    done = call(program, words, case)
    if done is None:
        return "longer than %d s" % SECONDS
    try:
        return done[0], without_machine(json.loads(done[1])), done[2]
    except ValueError:
        return done

def text_of(program, case):
    done = call(program, ["run", "-q", "--full", "--wide"], case)
    if done is None:
        return "longer than %d s" % SECONDS
    # the cost of the machine
    text = re.sub(r"(?ms)^Cost[^\n]*\n.*?(?=^\S|\Z)", "", done[1])
    text = re.sub(r"(?m)^  Time: .*\n", "", text)
    return done[0], text, done[2]

def compare(job):
    case, backend, sets = job
    ask = (lambda p: text_of(p, case)) if backend == "text" else (lambda p: json_of(p, case, backend, sets))
    return job, ask(OLD) == ask(NEW)

jobs = [(c, b, s) for c in CASES for b, s in SCHEMES] + [(c, "text", []) for c in CASES]
different = 0
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for (case, backend, sets), same in pool.map(compare, jobs):
        if not same:
            different += 1
            print("different:", case, backend, *sets, flush=True)
print(f"{len(jobs)} compared, {different} different")
sys.exit(different > 0)
