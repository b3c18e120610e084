# Does Gazebo's own parser load the worlds that tune writes, without a word, as the mechanism of the
# case? Ten cases of seeded sizes; what stands for truth are the places and masses that they were
# written with. The controls: a world with an element that SDF has not, and one whose joint lacks its
# child.
# Usage: sdf_loads.py PROGRAM SDF_PARSE. Prints TAP.
import math
import pathlib
import random
import subprocess
import sys
import tempfile

program, parser = sys.argv[1:3]


def report(number, what, passed, why=""):
    print(f"{'ok' if passed else 'not ok'} {number} - {what}", flush=True)
    if not passed and why:
        print("# " + why.replace("\n", "\n# "), flush=True)


def turned(angle, x, y):
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


def case_of(seed):
    """A slider-crank whose line is turned, with play in its crank pin: its text, places and masses."""
    draw = random.Random(seed)
    crank, rod, phase = draw.uniform(0.03, 0.06), draw.uniform(0.12, 0.2), draw.uniform(0, 6.28)
    line = math.radians(draw.uniform(-180, 180))
    pin = crank * math.cos(phase), crank * math.sin(phase)
    wrist = pin[0] + math.sqrt(rod**2 - pin[1]**2), 0.0
    where = {"crank": turned(line, pin[0] / 2, pin[1] / 2),
             "rod": turned(line, (pin[0] + wrist[0]) / 2, pin[1] / 2),
             "slider": turned(line, wrist[0] + 0.005, 0.002)}
    at = {"ground-crank": (0.0, 0.0), "crank-rod": turned(line, *pin), "rod-slider": turned(line, *wrist),
          "slide": turned(line, *wrist)}
    masses = {name: draw.uniform(0.1, 1.0) for name in where}

    def place(point):
        return f"[{1e3 * point[0]:.15g} mm, {1e3 * point[1]:.15g} mm]"

    lines = ["title: slider-crank in any direction", "bodies:"]
    for name in where:
        lines.append(f"  {name}: {{mass: {masses[name]:.15g} kg, inertia: 200 kg mm^2, at: {place(where[name])}}}")
    lines += ["joints:",
              f"  ground-crank: {{between: [ground, crank], at: {place(at['ground-crank'])}}}",
              f"  crank-rod: {{between: [crank, rod], at: {place(at['crank-rod'])}, hole: 10.1 mm, pin: 10 mm, "
              "stiffness: 1e7 N/m}",
              f"  rod-slider: {{between: [rod, slider], at: {place(at['rod-slider'])}}}",
              f"  slide: {{between: [ground, slider], at: {place(at['slide'])}, along: {math.degrees(line):.15g} deg}}",
              "drive: {joint: ground-crank, speed: 300 rpm}",
              "contact: {restitution: 0.5}",
              "run: {revolutions: 0.02, samples: 500, start: centred}", ""]
    return "\n".join(lines), where, at, masses, line


def parse(file):
    done = subprocess.run([parser, file], capture_output=True, text=True, check=False)
    return done.returncode, [line.split() for line in done.stdout.splitlines()], done.stdout + done.stderr


def is_near(words, values):
    return all(abs(float(word) - value) < 1e-9 for word, value in zip(words, values))


def fits(rows, where, at, masses, line):
    """Whether links and joints are where the case has them."""
    links = {row[1]: row[2:] for row in rows if row[0] == "link"}
    joints = {row[1]: row[2:] for row in rows if row[0] == "joint"}
    for name, point in where.items():
        if not is_near(links[name][:2], point) or not is_near(links[name][3:5], (masses[name], 2e-4)):
            return f"link {name}: {links[name]}"
    if set(joints) != {"ground-crank", "rod-slider", "slide"}:  # what plays is no joint
        return f"joints {sorted(joints)}"
    for name, row in joints.items():
        if not is_near(row[6:8], at[name]):
            return f"joint {name}: {row}"
    along = [float(word) for word in joints["slide"][3:5]]
    if abs(along[0] * math.sin(line) - along[1] * math.cos(line)) > 1e-9:
        return f"the line of the slider: {along}"
    return ""


SEEDS = range(10)
text = ""
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for seed in SEEDS:
        (folder / "case.yaml").write_text((case := case_of(seed))[0])
        file = folder / f"world-{seed}.sdf"
        done = subprocess.run([program, "tune", folder / "case.yaml", "--error", "0.5", "--schemes",
                               "direct/plain/corrected", "--sdf", file, "--quiet"],
                              capture_output=True, text=True, check=False)
        status, rows, said = parse(file) if file.exists() else (-1, [], done.stderr)
        why = fits(rows, *case[1:]) if status == 0 else said or f"status {status}"
        report(seed + 1, f"the world of seed {seed} is that of the case", not why, why)
    text = file.read_text()
    file.write_text(text.replace("<max_step_size>", "<longest_step>1</longest_step><max_step_size>"))
    report(len(SEEDS) + 1, "control: an element that SDF has not is an error", parse(file)[0] == 1)
    file.write_text(text.replace("<child>", "<!-- <child>").replace("</child>", "</child> -->"))
    report(len(SEEDS) + 2, "control: a joint without its child is an error", parse(file)[0] == 1)
print(f"1..{len(SEEDS) + 2}")
