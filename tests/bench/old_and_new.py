#!/usr/bin/env python3
"""Is this build faster than an older one, and at which error?

    old_and_new.py NEW_BUILD CASES OLD_BUILD [ROUNDS [WORD]]
    meson test -C build --benchmark --verbose old_and_new --test-args OLD_BUILD

Rows of which the name has the word are run by both builds in turn, in either order; printed are the
medians of the processor time of a whole command, the median of the ratios of the rounds, and the
errors: of all angular velocities, each over its own largest, against the new reference at 1e-13. Short cases
are run several times by one command, so that starting it counts for little. The library's row has
the time of its steps alone. One revolution or 20 to 50 ms."""
import csv, os, resource, statistics, subprocess, sys, tempfile

if len(sys.argv) < 4:
    print("no older build: --test-args OLD_BUILD", file=sys.stderr)
    sys.exit(77)
NEW, CASES, OLD = (os.path.abspath(path) for path in sys.argv[1:4])
ROUNDS = int(sys.argv[4]) if len(sys.argv) > 4 else 5
WORD = sys.argv[5] if len(sys.argv) > 5 else ""
BUILDS = [OLD, NEW]
os.environ["JOINTPLAY_CASES"] = CASES
os.environ.pop("LD_LIBRARY_PATH", None)
os.chdir(tempfile.mkdtemp())


# of the fastest body: what turns more slowly hardly moves, and its error is over this
LITTLE = 1e-2


def spend(words, **more):
    """Seconds of processor time of a command, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, capture_output=True, text=True, **more)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(words)}: {done.stderr.strip()}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def words_of(sets):
    return [word for one in sets for word in ("--set", one)]


def grown(kind, count):
    path = f"{kind}-{count}.yaml"
    with open(path, "w") as file:
        subprocess.run(
            [f"{NEW}/tests/measure/growing_case", kind, str(count), "1", "50"],
            stdout=file,
            check=True,
        )
    return path


def lifted():
    """The paper's case in space: its pin has a width."""
    with open(f"{CASES}/paper/impact-k66.yaml") as file, open("lifted.yaml", "w") as out:
        out.write(file.read().replace("\nfour-bar:", "\nspace: spatial\nfour-bar:", 1))
    return "lifted.yaml"


def omegas(build, case, backend, sets):
    certified = [] if "run.step=auto" in sets else ["--uncertified"]
    spend(
        [
            f"{build}/src/cli/jointplay",
            "run",
            "-q",
            *certified,
            "--backend",
            backend,
            *words_of(sets),
            "--series",
            "series.csv",
            case,
        ]
    )
    with open("series.csv") as file:
        rows = list(csv.DictReader(file))
    names = [name for name in rows[0] if name.endswith("_omega_rad_s")]
    return {name: [float(row[name]) for row in rows] for name in names}


def error_of(run, truth):
    most = 0.0
    largest = {name: max(map(abs, values)) for name, values in truth.items()}
    for name, values in truth.items():
        size = max(largest[name], LITTLE * max(largest.values()))
        most = max(most, *(abs(a - b) / size for a, b in zip(run[name], values)))
    return most


class Motion:
    """One run of a case by one backend."""

    def __init__(self, name, case, backend, sets, copies, common=()):
        self.name, self.case, self.backend, self.copies = name, case, backend, copies
        self.sets, self.common = [*common, *sets], list(common)

    def time(self, build):
        certified = [] if "run.step=auto" in self.sets else ["--uncertified"]
        return (
            spend(
                [
                    f"{build}/src/cli/jointplay",
                    "run",
                    "-q",
                    *certified,
                    "--json",
                    "--backend",
                    self.backend,
                    *words_of(self.sets),
                    *[self.case] * self.copies,
                ]
            )[0]
            / self.copies
        )

    def errors(self):
        truth = omegas(NEW, self.case, "reference", [*self.common, "reference.tolerance=1e-13"])
        return [error_of(omegas(b, self.case, self.backend, self.sets), truth) for b in BUILDS]


class Whole:
    """`run` as it is, with settled motion and certificate: its error is the one that it states."""

    def __init__(self, name, case):
        self.name, self.case = name, case

    def time(self, build):
        return spend([f"{build}/src/cli/jointplay", "run", "-q", "--json", self.case])[0]

    def errors(self):
        return [float("nan")] * 2


class Study:
    """Short runs of a study, CPU seconds a run; no errors are found in them."""

    RUNS = 1000

    def __init__(self, name, case, scheme, turns, step):
        self.name, self.file = name, name.replace(" ", "-").replace(",", "") + ".yaml"
        with open(self.file, "w") as file:
            file.write(
                f"title: Short runs\ncase: {case}\nset: {{run.revolutions: {turns}, run.samples: 60, "
                f"run.step: {step}}}\nvary: {{scheme: [{scheme}]}}\n"
                f"draw: {{count: {self.RUNS}, keys: {{drive.speed: {{uniform: [990 rpm, 1010 rpm]}}}}}}\n"
                "truth: false\n"
            )

    def time(self, build):
        store = self.file.replace(".yaml", ".sqlite")
        for name in os.listdir("."):
            if name.startswith(store):
                os.remove(name)
        return (
            spend([f"{build}/src/cli/jointplay", "study", self.file, "--jobs", "1", "-q"])[0]
            / self.RUNS
        )

    def errors(self):
        return [float("nan")] * 2


class Library:
    """The paper's case in steps of the library, by the library of either build."""

    name = "library, 20 us"
    error = [float("nan")] * 2

    def time(self, build):
        library = {**os.environ, "LD_PRELOAD": f"{build}/src/world/libjointplay.so.1"}
        spent, error = spend([f"{NEW}/tests/bench/library_steps", "5"], env=library)[1].split()
        self.error[BUILDS.index(build)] = float(error)
        return float(spent) / 5

    def errors(self):
        return self.error


def make_rows():
    paper, impulse = f"{CASES}/paper/impact-k66.yaml", ["ode.stepping=staggered", "ode.map=impulse"]
    centred = ["run.start=centred"]
    yield from (
        Motion(
            f"paper, reference {t}", paper, "reference", [f"reference.tolerance={t}"], 10, centred
        )
        for t in ("1e-5", "1e-9", "3e-13")
    )
    yield from (
        Motion(f"paper, impulse {h}", paper, "ode", [*impulse, f"run.step={h}"], 10, centred)
        for h in ("240 us", "120 us", "80 us", "40 us", "20 us")
    )
    yield Motion(
        "paper, auto 1e-4",
        paper,
        "ode",
        [*impulse, "run.step=auto", "run.tolerance=1e-4"],
        5,
        centred,
    )
    yield Library()
    clearances, guide = (
        f"{CASES}/literature/three-clearances.yaml",
        f"{CASES}/mechanisms/slider-crank-guide.yaml",
    )
    for name, case, short in (
        ("three clearances", clearances, [*centred, "run.revolutions=0.25"]),
        ("guide", guide, []),
    ):
        yield Motion(f"{name}, reference", case, "reference", [], 3, short)
        yield Motion(f"{name}, impulse 20 us", case, "ode", [*impulse, "run.step=20 us"], 3, short)
    for count, copies in ((8, 5), (24, 2), (64, 1), (256, 1)):
        row, short = grown("four-bars", count), ["run.duration=20 ms", "run.samples=100"]
        yield Motion(
            f"row of {count}, reference 1e-9",
            row,
            "reference",
            ["reference.tolerance=1e-9"],
            copies,
            short,
        )
        yield Motion(
            f"row of {count}, impulse 0.1 ms",
            row,
            "ode",
            [*impulse, "run.step=0.1 ms"],
            copies,
            short,
        )
    for count, copies in ((64, 3), (512, 1)):
        chain, short = grown("chain", count), ["run.samples=100"]
        yield Motion(f"chain of {count}, reference", chain, "reference", [], copies, short)
        yield Motion(
            f"chain of {count}, impulse 0.1 ms",
            chain,
            "ode",
            [*impulse, "run.step=0.1 ms"],
            copies,
            short,
        )
    space = lifted()
    yield Motion("in space, reference", space, "reference", [], 3, centred)
    yield Motion("in space, impulse 20 us", space, "ode", [*impulse, "run.step=20 us"], 3, centred)
    yield Whole("run, whole", paper)
    yield Study("study, ideal", f"{CASES}/paper/ideal-nominal.yaml", "direct/plain", 1, "1 ms")
    yield Study("study, textbook", paper, "direct/plain/textbook", 0.1, "100 us")
    yield Study("study, impulse", paper, "direct/staggered/impulse", 0.1, "100 us")


def print_row(row):
    """Times of a row by turns; a build that cannot run it has none."""
    times = {build: [] for build in BUILDS}
    for turn in range(ROUNDS):
        for build in BUILDS if turn % 2 == 0 else BUILDS[::-1]:
            times[build].append(row.time(build))
    old, new = (statistics.median(times[build]) for build in BUILDS)
    ratio = statistics.median(a / b for a, b in zip(times[OLD], times[NEW]))
    errors = "  ".join(f"{error:9.1e}" if error == error else f"{'-':>9}" for error in row.errors())
    print(f"{row.name:32} {1e3 * old:10.2f} {1e3 * new:10.2f} {ratio:7.2f}  {errors}", flush=True)


print(f"{'':32} {'old, ms':>10} {'new, ms':>10} {'ratio':>7}  {'old error':>9}  {'new error':>9}")
for row in make_rows():
    if WORD in row.name:
        try:
            print_row(row)
        except (RuntimeError, OSError, ValueError) as problem:
            print(f"{row.name:32} {problem}", flush=True)
