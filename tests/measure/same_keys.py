#!/usr/bin/env python3
"""Do two builds of jointplay tell other programs the same, key by key?

    same_keys.py OLD NEW [--but PATTERN]...

Runs ten commands on ten named cases by both programs and compares JSON by key and CSV by column,
wherever they stand; times of the machine and versions aside. Prints each key that one of them has
alone or whose value differs, with how often and an example, and ends with status 1 where there is
any but those that match a pattern."""
import argparse, csv, hashlib, io, json, os, re, subprocess, sys, tempfile

CASES = [
    "paper/impact-k66", "paper/ideal-stackup", "literature/three-clearances",
    "literature/pin-in-hole-drop", "mechanisms/gear-pair", "mechanisms/slider-crank-both",
    "mechanisms/servo-backlash", "mechanisms/bouncing-ball", "mechanisms/run-up", "space/overhung-pin",
]
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
BASELINES = os.path.join(ROOT, "results", "baseline")
MACHINE = re.compile(r"wall|^store$|^study$|_cpu|cpu_|version|^tool$|per_s$|us_per_step"
                     r"|real_time_factor|processor|inside|on_frontier|cheapest|^build$|^created"
                     r"|^machine")


def flatten(value, path, into):
    if isinstance(value, dict):
        for key, inner in value.items():
            if not MACHINE.search(key):
                flatten(inner, path + (key,), into)
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            name = inner.get("metric", inner.get("name", i)) if isinstance(inner, dict) else i
            flatten(inner, path + (str(name),), into)
        into[path + ("count",)] = len(value)
    else:
        into[path] = value


def of_csv(text, into):
    rows = list(csv.reader(io.StringIO(text)))
    for key, *values in zip(*rows):
        if not MACHINE.search(key):
            into[("csv", key)] = "%d cells, %s" % (
                len(values), hashlib.sha256("\n".join(values).encode()).hexdigest()[:8])


def commands(case, work):
    study = os.path.join(work, "small.yaml")
    with open(study, "w") as file:
        file.write(f"title: small\ncase: {case}\nvary:\n  run.samples: [180, 360]\n")
    store = os.path.join(work, "small.sqlite")
    return [
        ("run", ["run", "-q", "--json", "--budget=none", case]),
        ("series", ["run", "-q", "--budget=none", "--backend=ode", "--series=-", case]),
        ("contacts", ["run", "-q", "--budget=none", "--backend=ode", "--contacts=-", case]),
        ("auto", ["run", "-q", "--json", "--budget=none", "--backend=ode", "--step=auto", case]),
        ("map", ["map", "-q", "--json", case]),
        ("map csv", ["map", "-q", "--csv=-", case]),
        ("check", ["check", "--quick", "-q", "--json", "--baselines=" + BASELINES, case]),
        ("study", ["study", "-q", "--json", "--jobs=1", study, "--store=" + store]),
        ("study csv", ["study", "export", store]),
        ("compare", ["compare", "-q", "--json", "--fresh", "--steps=100 us, 50 us",
                     "--schemes=direct/staggered", "--csv=" + os.path.join(work, "c.csv"), case]),
    ]


def told(program, case):
    """What a program tells of a case, by command and key."""
    keys = {}
    with tempfile.TemporaryDirectory() as work:
        for name, words in commands(case, work):
            try:
                done = subprocess.run([program, *words], capture_output=True, text=True,
                                      timeout=300, cwd=work)
            except subprocess.TimeoutExpired:
                keys[(name, "status")] = "longer than 300 s"
                continue
            found = {}
            try:
                flatten(json.loads(done.stdout), (), found)
            except ValueError:
                of_csv(done.stdout, found)
            keys[(name, "status")] = done.returncode
            keys.update({(name,) + path: value for path, value in found.items()})
    return keys


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--but", action="append", default=[])
    parser.add_argument("cases", nargs="*", default=CASES)
    asked = parser.parse_args()
    compared = 0
    found = {}
    for name in asked.cases:
        case = os.path.abspath(os.path.join(ROOT, "cases", name + ".yaml"))
        old, new = (told(os.path.abspath(p), case) for p in (asked.old, asked.new))
        print(f"{name}: {len(old)} and {len(new)} values", file=sys.stderr, flush=True)
        for path in old.keys() | new.keys():
            compared += 1
            if path in old and path in new and old[path] == new[path]:
                continue
            how = "new" if path not in old else "gone" if path not in new else "other"
            words = ".".join(word for word in path if not word.isdigit() and "/" not in word)
            if not any(re.search(pattern, words) for pattern in asked.but):
                example = f"{name}: {old.get(path)!r} -> {new.get(path)!r}"
                found.setdefault((how, path[0], path[-1]), []).append((words, example))
    for (how, command, key), places in sorted(found.items()):
        words, example = places[0]
        print(f"{how:5} {command:9} {key:40} {len(places):5} times, as {words} of {example}")
    print(f"{compared} values of {len(asked.cases)} cases compared, {len(found)} keys differ")
    return 1 if found else 0


sys.exit(main())
