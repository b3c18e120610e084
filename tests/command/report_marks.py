# Can what the answer says be read off the pictures? The largest force and depth of every joint with
# play, the largest acceleration of every body and the largest torque of every drive, to 1 %, in the
# data that a page of 'jointplay report' draws and in the path of a pin's load in its picture, which
# is that of 'jointplay run --plot'; in space as well, and where the wall of a hole wears most; the
# largest force of joints without play and of bushings. What run.report-from leaves out is not read.
# The samples are few, so that contacts lie between them: read off these alone, as a control, they
# must be missed.
# Usage: report_marks.py PROGRAM RANDOM_CASE CASE... Prints TAP.
import json, math, random, re, subprocess, sys

from report_reading import Page, check_claims, unpack

program, random_case = sys.argv[1:3]
NEAR = 0.01
# kind and seed of random cases that impacts make up; nobody chose them for their numbers
SEEDS = [("four-bar", 11), ("four-bar", 12), ("bodies", 12), ("sprung", 12), ("sprung", 11),
         ("limits", 2), ("limits", 3), ("gears", 1), ("space", 3)]
# seeds of weights beside their holes in space, which tilt and knock at both ends
SPACE_SEEDS = [1, 2, 3]
WORDS = ["--quiet", "--uncertified", "--set", "run.samples=180", "--set", "run.start=centred",
         "--backend", "reference", "--backend", "ode", "--step", "20 us"]


def weight_in_space(seed):
    rng = random.Random(seed)
    width = rng.uniform(6, 30)
    return f"""title: Weight in space {seed}
space: spatial
bodies:
  pin: {{mass: {rng.uniform(.05, 1):.3f} kg, inertia: 20 kg mm^2, inertia-x: 40 kg mm^2,
        inertia-y: 40 kg mm^2, at: [0 mm, 0 mm], offset: {rng.uniform(5, 40):.2f} mm,
        spin: {rng.uniform(-100, 100):.2f} rad/s}}
joints:
  hole: {{between: [ground, pin], at: [0 mm, 0 mm], hole: {10 + rng.uniform(.05, .3):.4f} mm, pin: 10 mm,
         width: {width:.2f} mm, axial-clearance: 200 um}}
contact: {{stiffness: 1e9 N/m, restitution: {rng.uniform(.2, .8):.2f}, friction: {rng.uniform(.05, .3):.2f}}}
run: {{duration: 30 ms}}
"""


def cases(work):
    paths = list(sys.argv[3:])
    for seed in SPACE_SEEDS:
        path = f"{work}/weight-{seed}.yaml"
        open(path, "w").write(weight_in_space(seed))
        paths.append(path)
    for kind, seed in SEEDS:
        path = f"{work}/{kind}-{seed}.yaml"
        done = subprocess.run([random_case, kind, str(seed)], capture_output=True, text=True)
        open(path, "w").write(done.stdout)
        paths.append(path)
    return paths


MADE = {}


def page_of(work, case):
    """The data of the page of a case, and its picture; made once."""
    if case not in MADE:
        page = f"{work}/{len(MADE)}.html"
        done = subprocess.run([program, "report", case, "--out", page, *WORDS],
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        text = open(page, encoding="utf-8").read()
        picture = text[text.index("<svg") : text.index("</svg>\n</div>")]
        data = unpack(Page(text))
        for run in data["runs"]:
            run["report_from_s"] = data["report_from_s"] or 0.0
        MADE[case] = data, picture
    return MADE[case]


def number_of(row, stem):
    """The largest of a joint, a force or a torque, a length or an angle."""
    return next(row[key] for key in row if key.startswith(stem) and not key.endswith("_s")
                and "crank" not in key and "time" not in key)


def samples(run, of, number, what):
    """Of the time that counts."""
    values = next((one["values"] for one in run["signals"]
                   if (one["of"], one["number"], one["what"]) == (of, number, what)), [])
    first = math.ceil((run["report_from_s"] - run["from_s"]) / run["interval_s"] - 1e-6)
    return values[first:]


def marks(run, number, what):
    return next((values_of(run, joint, signal) for joint in run["marks"] if joint["joint"] == number
                 for signal in joint["signals"] if signal["what"] == what), [])


def values_of(run, joint, signal):
    of = {one["what"]: one["values"] for one in joint["signals"]}
    times = [run["from_s"] + run["interval_s"] * (round(at) + share)
             for at, share in zip(of["sample"], of["share"])]
    near = 1e-3 * run["interval_s"]
    return [value for time, value in zip(times, signal["values"])
            if time >= run["report_from_s"] - near]


def peaks(run, of, number, what):
    return [abs(peak["value"]) for peak in run["peaks"]
            if (peak["of"], peak["number"], peak["what"]) == (of, number, what)]


def known(values):
    return [value for value in values if not math.isnan(value)]


def joint_values(run, number, has_marks):
    """What the plots of a joint draw at most: its force, the force of its load, its depth and how
    far its pin comes."""
    def all_of(what):
        return samples(run, "joint", number, what) + (marks(run, number, what) if has_marks else [])
    load = [math.hypot(x, y) for x, y in zip(all_of("force_x_N"), all_of("force_y_N"))]
    path = [math.hypot(x, y) for x, y in zip(all_of("ex_m"), all_of("ey_m"))]
    return {"force": max(all_of("force")), "load": max(load), "path": max(path),
            "depth": -min(known(all_of("gap")))}


def missed(data, has_marks):
    """What cannot be read off the pictures of a page."""
    found, count = [], 0
    results = {one["backend"]: one for one in data["results"]["runs"]}
    for run in data["runs"]:
        result = results[run["backend"]]
        for number, joint in enumerate(data["joints"]):
            row = result["joints"][joint["name"]]
            if not joint["has_play"] or not samples(run, "joint", number, "gap"):
                continue
            shown = joint_values(run, number, has_marks)
            force, depth = number_of(row, "force_max"), number_of(row, "penetration_max")
            asked = {"force": force, "depth": depth}
            # in space both ends press, and the path is that of the pin's middle
            if joint["touches"] == "hole" and not data["is_spatial"]:
                asked["load"] = force
                asked["path"] = joint["clearance_m"] + depth
            for name, value in asked.items():
                count += 1
                # 16 bits of a signal's range are all that a page has of it
                rounding = 1e-5 * max(map(abs, samples(run, "joint", number, "gap"))) \
                    if name == "depth" else 0
                if not abs(shown[name] - value) <= NEAR * abs(value) + rounding:
                    found.append((run["backend"], joint["name"], name, value, shown[name]))
    return found, count


def every_joint_can_be_read_off_the_page(work):
    count = 0
    for case in cases(work):
        found, asked = missed(page_of(work, case)[0], True)
        assert found == [], (case, found)
        count += asked
    assert count > 60, count


def samples_alone_miss_the_peaks(work):
    # the control: without marks most cases lose some, and of all numbers a quarter
    lost = [missed(page_of(work, case)[0], False) for case in cases(work)]
    lost = [(found, count) for found, count in lost if count > 0]
    assert sum(len(found) > 0 for found, _ in lost) > 0.7 * len(lost), lost
    assert sum(len(found) for found, _ in lost) > 0.25 * sum(count for _, count in lost), lost


def bodies_and_drives_can_be_read_off_the_page(work):
    for case in cases(work):
        data, _ = page_of(work, case)
        results = {one["backend"]: one for one in data["results"]["runs"]}
        for run in data["runs"]:
            for number, body in enumerate(data["bodies"]):
                if body["is_driven"]:
                    continue
                row = results[run["backend"]]["bodies"][body["name"]]
                drawn = samples(run, "body", number, "alpha_rad_s2") + [
                    peak["value"] for peak in run["peaks"]
                    if (peak["of"], peak["number"], peak["what"]) == ("body", number, "alpha_rad_s2")]
                for key, most in [("alpha_max_rad_s2", max(drawn)), ("alpha_min_rad_s2", min(drawn))]:
                    assert abs(most - row[key]) <= NEAR * abs(row[key]), (case, body["name"], key)
        overview = data["results"]["overview"]
        if overview["drive"] is not None:
            run = next(one for one in data["runs"] if one["backend"] == overview["backend"])
            drawn = [abs(peak["value"]) for peak in run["peaks"]
                     if peak["what"] == "drive_torque_N_m"]
            most = number_of(overview["drive"], "torque_max")
            assert abs(max(drawn) - most) <= NEAR * most, (case, most, drawn)


def joints_without_play_and_bushings_can_be_read_off_the_page(work):
    count = {"joint": 0, "bushing": 0}
    for case in cases(work):
        data, _ = page_of(work, case)
        overview = data["results"]["overview"]
        run = next(one for one in data["runs"] if one["backend"] == overview["backend"])
        for of, rows in [("joint", overview["ideal_joints"]), ("bushing", overview.get("bushings", []))]:
            names = [one["name"] for one in data[of + "s"]]
            for row in rows:
                number = names.index(row["name"])
                drawn = samples(run, of, number, "force") + peaks(run, of, number, "force")
                most = number_of(row, "force_max")
                assert abs(max(drawn) - most) <= NEAR * most, (case, row, max(drawn))
                count[of] += 1
    assert count["joint"] > 20 and count["bushing"] > 0, count


def what_does_not_count_is_larger(work):
    """The control of the time that counts: with the rest of it a force is misread."""
    case = next(case for case in cases(work) if "loose-gears" in case)
    data, _ = page_of(work, case)
    run = data["runs"][0]
    assert run["report_from_s"] > 0.0
    counted = max(samples(run, "joint", 0, "force"))
    whole = max(max(one["values"]) for one in run["signals"]
                if (one["of"], one["number"], one["what"]) == ("joint", 0, "force"))
    assert whole > 1.1 * counted, (whole, counted)


def instants_are_whole(work):
    """At the mark of the largest force of a pin its force, its depth and where it is agree with
    those of the contact: they are of one instant."""
    count = 0
    for case in cases(work):
        data, _ = page_of(work, case)
        for run in data["runs"] if not data["is_spatial"] else []:
            for joint in run["marks"]:
                of = {one["what"]: one["values"] for one in joint["signals"]}
                shape = data["joints"][joint["joint"]]
                span = max(map(math.hypot, of["ex_m"], of["ey_m"]))
                for i in range(joint["count"]):
                    if shape["touches"] != "hole" or math.isnan(of["gap"][i]):
                        continue
                    gap = shape["clearance_m"] - math.hypot(of["ex_m"][i], of["ey_m"][i])
                    # three signals of 16 bits
                    assert abs(gap - of["gap"][i]) < 1e-4 * span, (case, shape["name"], i)
                    count += 1
    assert count > 1000, count


def load_in(picture, of):
    """The farthest that a path of the panel of loads goes from its middle, N; NAN without one."""
    start = picture.find("Force on the pin, seen from its hole")
    if start < 0:
        return math.nan
    panel = picture[start:]
    circles = [tuple(map(float, one)) for one in re.findall(
        r'<ellipse fill="none" stroke-linejoin="round" cx="([-.\d]+)" cy="([-.\d]+)" rx="([-.\d]+)"', panel)]
    left, top = circles[0][:2]
    circles = [radius for x, y, radius in circles if (x, y) == (left, top)]
    labels = re.findall(r'<text x="([-.\d]+)" y="([-.\d]+)"[^>]*>([-.e+\d]+) N</text>', panel)
    x, y, force = map(float, labels[-1])
    radius = min(circles, key=lambda one: abs(one - math.hypot(x - left, y - 4.0 - top)))
    # to where the next panel begins
    drawn = re.findall(r'<path fill="none" stroke-linejoin="round" d="(M[^"]*)"([^>]*)>',
                       panel[: panel.find('font-weight="bold"', 60)])
    # the spokes are grey
    lines = [data for data, style in drawn if "#e4e4e4" not in style and "#b0b0b0" not in style]
    far = 0.0
    for data in lines:
        at = [0.0, 0.0]
        for letter, words in re.findall(r"([MLVH])([^MLVH]*)", data):
            numbers = [float(one) for one in re.findall(r"[-.\d]+", words)]
            for k in range(0, len(numbers), 2 if letter in "ML" else 1):
                at = (numbers[k : k + 2] if letter in "ML" else
                      [at[0], numbers[k]] if letter == "V" else [numbers[k], at[1]])
                far = max(far, math.hypot(at[0] - left, at[1] - top))
    return far * force / radius


def the_picture_shows_the_largest_load(work):
    count = 0
    for case in cases(work):
        data, picture = page_of(work, case)
        holes = [joint["name"] for joint in data["joints"]
                 if joint["touches"] == "hole" and joint["has_play"]]
        rows = [one["joints"][name] for one in data["results"]["runs"] for name in holes]
        shown = load_in(picture, holes)
        if holes and not math.isnan(shown) and not data["is_spatial"]:
            most = max(number_of(row, "force_max") for row in rows)
            assert abs(shown - most) <= NEAR * most, (case, shown, most)
            count += 1
    assert count >= 5, count


def wear_can_be_read_off_the_page(work):
    """The tallest sector of the wall is the one that the numbers name, and all are the whole."""
    count = {True: 0, False: 0}
    for case in cases(work):
        data, _ = page_of(work, case)
        for result in data["results"]["runs"]:
            for joint in result["joints"].values():
                wear = joint.get("wear")
                if wear is None or wear["share"] is None:
                    continue
                shares = wear["sectors"]
                most = max(range(len(shares)), key=lambda i: shares[i])
                middle = 2 * math.pi * (most + 0.5) / len(shares)
                assert abs(sum(shares) - 1.0) < 1e-9, (case, sum(shares))
                assert abs(shares[most] - wear["share"]) <= NEAR * wear["share"], (case, wear)
                assert abs(middle - wear["angle_rad"]) < 1e-9, (case, wear)
                count[data["is_spatial"]] += 1
    assert count[False] > 10 and count[True] > 2, count


check_claims([
    every_joint_can_be_read_off_the_page,
    samples_alone_miss_the_peaks,
    bodies_and_drives_can_be_read_off_the_page,
    joints_without_play_and_bushings_can_be_read_off_the_page,
    what_does_not_count_is_larger,
    instants_are_whole,
    the_picture_shows_the_largest_load,
    wear_can_be_read_off_the_page,
])
