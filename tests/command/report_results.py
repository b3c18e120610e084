# Do pages of 'jointplay report' of a comparison, a map, a tune, a check and a study show the numbers
# of what they are made of, as text whatever that holds, without asking another place?
# Usage: report_results.py PROGRAM CASE. Prints TAP.
import cmath, csv, html, io, json, math, os, re, statistics, subprocess, sys

from report_reading import Page, check_claims, check_policy, check_requests, unpack

program, case = sys.argv[1:3]
HOSTILE = "</script></title><img src=x onerror=\"document.title='x'\">&lt;b&gt; \u9023 'q'"
SETS = ["--set", "run.revolutions=0.1", "--set", "run.start=centred"]
STUDY = """title: A ball on a shaken plate
case: ball.yaml
growth: true
vary:
  drive.speed: {from: 63.5 rad/s, to: 65.5 rad/s, count: 9}
  contact.restitution: [0.45, 0.5]
"""
# a ball on a plate that an eccentric moves, see tests/physics/test_ball_on_a_plate.c
BALL = """title: Ball on a plate
bodies:
  eccentric: {mass: 1 kg, inertia: 1000 kg mm^2, at: [0 mm, 0 mm]}
  ball: {mass: 0.1 kg, inertia: 10 kg mm^2, at: [0 mm, 12.6 mm], velocity: [0 m/s, 0.49 m/s]}
joints:
  pivot: {between: [ground, eccentric], at: [0 mm, 0 mm]}
  guide: {between: [ground, ball], at: [0 mm, 12.6 mm], along: 90 deg}
  plate: {between: [ball, eccentric], at-a: [0 mm, 12.6 mm], at-b: [2.6 mm, 2.5 mm],
          normal: -90 deg, radius: 10 mm}
drive: {joint: pivot, speed: 62.8 rad/s}
contact: {stiffness: 1e8 N/m, damping: exact, restitution: 0.5}
run: {revolutions: 8, samples: 60, start: settled, settle-starts: 1, backends: [reference]}
"""


def run(*words, folder=None):
    done = subprocess.run([program, *words], capture_output=True, text=True, cwd=folder)
    return done.returncode, done.stdout, done.stderr


MADE = {}


def result(work, name):
    """The path of a result, and what it holds; made once."""
    commands = {
        "compare": ["compare", case, *SETS, "--schemes", "direct/plain", "--steps", "20 us, 10 us"],
        "map": ["map", case, "--steps", "20 us, 5 us", *SETS],
        "tune": ["tune", case, "--error", "0.3", *SETS, "--schemes", "direct/staggered"],
        "check": ["check", case, "--quick", "--baselines",
                  os.path.join(os.path.dirname(case), "../../results/baseline")],
        "paper": ["paper"],
    }
    if name not in MADE:
        quiet = [] if name == "paper" else ["--quiet"]
        status, output, errors = run(*commands[name], "--json", *quiet)
        assert status in (0, 1), errors
        path = f"{work}/{name}.json"
        open(path, "w").write(output)
        MADE[name] = path, json.loads(output)
    return MADE[name]


def make(path, *of):
    status, _, errors = run("report", *of, "--quiet", "--out", path)
    assert status == 0, errors
    return open(path, encoding="utf-8").read()


PAGES = {}


def page_of(work, name):
    """The page of a result, taken apart once."""
    if name not in PAGES:
        PAGES[name] = Page(make(f"{work}/{name}.html", result(work, name)[0]))
    return PAGES[name]


def store(work):
    path = work + "/study.sqlite"
    if not os.path.exists(path):
        open(work + "/ball.yaml", "w").write(BALL)
        open(work + "/study.yaml", "w").write(STUDY)
        status, _, errors = run("study", "study.yaml", "--store", path, "--quiet", folder=work)
        assert status == 0, errors
    return path


KINDS = ["compare", "map", "tune", "check", "paper"]


def with_unit(value, unit):
    """Three digits with a prefix, as people read them."""
    power = 3 * math.floor(math.log10(float(f"{value:.2e}")) / 3)
    digits = value / 10.0**power
    shown = f"{digits:.{2 - math.floor(math.log10(float(f'{digits:.2e}')))}f}"
    return f"{shown} {dict(zip([-6, -3, 0, 3], ['u', 'm', '', 'k']))[power]}{unit}"


def pages(work):
    for name in KINDS:
        yield name, make(f"{work}/{name}.html", result(work, name)[0])
    yield "study", make(work + "/study.html", store(work))
    paths = [result(work, name)[0] for name in KINDS]
    yield "all", make(work + "/all.html", *paths)


# The claims.


def policies_and_requests_are_those_of_a_run(work):
    for name, text in pages(work):
        check_policy(Page(text))
        check_requests(text)


def pictures_need_no_style_sheet(work):
    for name, text in pages(work):
        pictures = re.findall(r'<div class="wide picture"[^>]*>.*?</div>', text, re.DOTALL)
        # of a check that found nothing moved there is none
        assert pictures or name == "check", name
        for picture in pictures:
            assert "<style" not in picture and picture.count("class=") == 1, name
        # a name would be that of one in another picture
        assert " id=" not in "".join(pictures), name


def answers_are_those_of_the_results(work):
    cells = lambda name: page_of(work, name).texts["td"]
    compare = result(work, "compare")[1]
    for row in compare["cheapest"]:
        if row["scheme"]:
            assert row["scheme"] in cells("compare")
            assert f"{row['error_max']:.2e}" in cells("compare")
    contact = result(work, "map")[1]["contacts"][0]
    for row in contact["rows"]:
        if row["erp"] is not None:
            assert f"{row['erp']:.4g}" in cells("map"), row
            mean = row["delivered"]["restitution"]["mean"]
            assert f"{mean:.3g}" in cells("map"), row
    tune = result(work, "tune")[1]
    words = page_of(work, "tune").text("li")
    assert f"{tune['cheapest']['scheme']}, step" in words, words
    assert f"error {tune['cheapest']['error_max']:.3g}" in words, words
    check = result(work, "check")[1]
    assert str(check["cases"][0]["within"]) in cells("check")
    names = page_of(work, "check").texts["th"]
    for metric in check["cases"][0]["metrics"]:
        assert metric["metric"] in names, metric


def figures_of_the_paper_go_with_the_powers_that_its_text_has(work):
    page = page_of(work, "paper")
    # F = k n^2; P = 949 sqrt(F); an approach of F^(2/3)
    words = page.text("li")
    for power in ["2", "1", "1.33"]:
        assert f"crank-coupler goes with the power {power} of the speed" in words, words
    assert "90 of 90 cells of Tables I to III come out as they are printed" in words
    assert "-78.6973" in page.texts["td"] or "78.6973" in page.texts["td"], page.texts["td"]


def linkage(crank_deg, ground, crank, coupler, follower):
    """omega and alpha of coupler and follower of the open four-bar at 1000 rpm clockwise: the links
    as complex numbers, r2 + r3 = r1 + r4, once and twice differentiated."""
    speed = -1000 * math.pi / 30
    r2 = crank * cmath.exp(-1j * math.radians(crank_deg))
    gap = ground - r2  # coupler - follower
    reach = abs(gap)
    angle = math.acos((coupler**2 + reach**2 - follower**2) / (2 * coupler * reach))
    r3 = coupler * gap / reach * cmath.exp(1j * angle)
    r4 = r3 - gap

    def solve(right):  # x i r3 - y i r4 = right
        det = (r3 * r4.conjugate()).imag
        return ((-1j * right * r4.conjugate()).imag / det, (-1j * right * r3.conjugate()).imag / det)

    w3, w4 = solve(-1j * speed * r2)
    a3, a4 = solve(speed**2 * r2 + w3**2 * r3 - w4**2 * r4)
    return w3, w4, a3, a4


def curves_of_the_paper_are_those_of_the_loop(work):
    lengths = {"Ideal Nominal": (254, 108, 279.4, 270.5), "Ideal Stack-up": (254.5, 108, 279.9, 271)}
    rows = {row["row"]: row for row in result(work, "paper")[1]["extremes"]}

    def furthest(name, of):
        curve = dict(rows[name]["curve"])
        degrees = curve.pop("crank_deg")
        assert degrees == list(range(361))
        off = 0.0
        for k, values in enumerate(curve.values()):
            size = max(map(abs, values))
            off = max(off, *(abs(value - linkage(degree, *lengths[of])[k]) / size
                             for degree, value in zip(degrees, values)))
        return off

    for name in lengths:
        # printed to six digits
        assert furthest(name, name) <= 5e-6, (name, furthest(name, name))
    # the control: the other lengths give another curve
    assert furthest("Ideal Nominal", "Ideal Stack-up") > 1e-3
    page = page_of(work, "paper")
    for number in range(2, 9):
        assert f"Figure {number}: " in page.text("h2"), number
    # how far play moves the velocity in the paper's first band
    for name in ["Stack-up, POISSON", "Stack-up, IMPACT"]:
        off = [max(abs(rows[name]["curve"][key][k] - rows["Ideal Nominal"]["curve"][key][k])
                   for k in range(120, 131))
               for key in ["coupler_omega_rad_s", "follower_omega_rad_s"]]
        words = f"at most {off[0]:.3g} rad/s (coupler) and {off[1]:.3g} rad/s (follower) from 120"
        assert words in page.text("li"), words


def a_number_that_left_its_band_stands_first(work):
    path, check = result(work, "check")
    check = json.loads(json.dumps(check))
    moved = check["cases"][0]["metrics"][7]
    moved.update(verdict="out", bands_off=40.0)
    open(work + "/out.json", "w").write(json.dumps(check))
    text = make(work + "/out.html", work + "/out.json")
    table = text[text.index("<caption>Numbers") :]
    first = html.unescape(re.search(r'<th scope="row">(.*?)</th>', table).group(1))
    assert first == moved["metric"], first
    assert "<details open>" in text
    assert "Each number in its band" in text
    # the control: in the page of the check as it is nothing is out, or has moved far
    inside = make(work + "/in.html", path)
    assert "<details open>" not in inside
    assert "Each number in its band" not in inside
    assert "No number has moved" in inside


def what_is_saved_is_what_was_given(work):
    for name in KINDS:
        assert unpack(page_of(work, name))["results"] == result(work, name)[1], name


def texts_of_a_result_are_shown_as_text(work):
    def spoil(value):
        if isinstance(value, dict):
            return {key: spoil(one) for key, one in value.items()}
        if isinstance(value, list):
            return [spoil(one) for one in value]
        # words that say what to do stay
        kept = ("ok", "failed", "within", "out", "reference")
        return HOSTILE + value if isinstance(value, str) and value not in kept else value

    for name in KINDS:
        spoiled = spoil(result(work, name)[1])
        open(f"{work}/bad-{name}.json", "w").write(json.dumps(spoiled))
        text = make(f"{work}/bad-{name}.html", f"{work}/bad-{name}.json")
        page = Page(text)
        assert "img" not in page.tags and page.tags.count("script") == 1, name
        check_policy(page)
        assert "onerror" in page.text("td") + page.text("th") + page.text("h1"), name


def members_that_lack_or_are_of_another_kind_do_no_harm(work):
    others = [None, 7, "words", [], {}, [None, 3, "x", [], {}]]
    paths = [f"{work}/odd{number}.json" for number in range(len(others))]
    for name in KINDS:
        whole = result(work, name)[1]
        for key in whole:
            if key in ("tool", "tables"):
                continue
            for path, other in zip(paths, others):
                open(path, "w").write(json.dumps({**whole, key: other}))
            # all in one page, or where one is refused each in its own
            status, _, errors = run("report", *paths, "--quiet", "--out", work + "/odd.html")
            assert status in (0, 2), (name, key, errors)
            for path in paths if status == 2 else []:
                status, _, errors = run("report", path, "--quiet", "--out", work + "/odd.html")
                assert status in (0, 2), (name, key, path, errors)


def quantiles_of_a_study_are_those_of_its_rows(work):
    path = store(work)
    page = Page(make(work + "/study.html", path))
    status, output, _ = run("study", "export", path, "--csv", "-")
    assert status == 0
    rows = list(csv.DictReader(io.StringIO(output)))
    values = sorted(float(row["plate_force_max_N"]) for row in rows)
    assert len(values) == 18
    # the standard library's inclusive method is number 7 of Hyndman and Fan: every twentieth
    inner = statistics.quantiles(values, n=20, method="inclusive")
    for at in [values[0], inner[0], inner[9], inner[18], values[17]]:
        assert f"{at:.4g}" in page.texts["td"], at
        assert with_unit(at, "N") in page.texts["td"], (at, page.texts["td"])
    # the title, the keys and the units are those of the study file
    assert page.text("h1") == "A ball on a shaken plate", page.text("h1")
    text = open(work + "/study.html", encoding="utf-8").read()
    map_part = text[text.index("Median over both keys") :]
    for row in rows:
        force, speed = float(row["plate_force_max_N"]), float(row["drive_speed_rad_s"])
        cell = f"{with_unit(force, 'N')} at "
        assert cell in map_part and with_unit(speed, "rad/s") in map_part, (cell, speed)
    # the page of the study file is that of its store, but for its own command
    run("report", "study.yaml", "--quiet", "--out", "file.html", folder=work)
    other = Page(open(work + "/file.html", encoding="utf-8").read())
    assert other.texts["td"] == page.texts["td"] and other.text("h1") == page.text("h1")
    # where the period has doubled there are two values of the section
    doubled = [row for row in rows if row["section_period"] == "2"]
    single = [row for row in rows if row["section_period"] == "1"]
    assert doubled and single
    # a change dies out, slowest where the period is about to double
    growths = [float(row["settled_growth"]) for row in rows]
    assert 0.4 < min(growths) and max(growths) < 1.02, growths
    for at in [statistics.median(growths), max(growths)]:
        assert f"{at:.4g}" in page.texts["td"], at
    bifurcation = text[text.index("<h2>Bifurcation") : text.index("<h2>All results")]
    # and one in the legend
    assert bifurcation.count("<circle") == 1 + sum(
        row[f"ball_section_{k}_m_s"] != "" for row in rows for k in range(1, 7))


def a_case_may_come_from_a_pipe(work):
    # nothing of it is read before the case is
    text = open(case).read()
    words = [program, "report", "/dev/stdin", *SETS, "--backend", "analytic", "--quiet", "--out"]
    done = subprocess.run([*words, work + "/pipe.html"], input=text, text=True, capture_output=True)
    assert done.returncode == 0, done.stderr
    done = subprocess.run([*words, work + "/pipe.html"], input="{}", text=True, capture_output=True)
    assert done.returncode == 3, done.stderr


def what_is_no_result_is_refused(work):
    status, output, _ = run("run", case, *SETS, "--backend", "reference", "--json", "--quiet")
    open(work + "/run.json", "w").write(output)
    for content, expected, words in [
        (output, 2, "jointplay report CASE makes the page of a run"),
        ('{"tool": {}, "other": 1}', 2, "is no result of jointplay compare, map, tune, check or paper"),
        ('{"tool": {', 5, "this is no JSON"),
    ]:
        open(work + "/no.json", "w").write(content)
        status, _, errors = run("report", work + "/no.json", "--quiet", "--out", work + "/no.html")
        assert status == expected and words in errors, (status, errors)
        assert not os.path.exists(work + "/no.html")
    compare = result(work, "compare")[0]
    for words, expected in [
        ([compare, "--set", "title=x"], "are for a case that is run"),
        ([store(work), compare], "report takes one study"),
        ([case, compare], "report takes one case, or results"),
    ]:
        status, _, errors = run("report", *words, "--quiet", "--out", work + "/no.html")
        assert status == 2 and expected in errors, errors
    # a store that was cut short
    whole = open(store(work), "rb").read()
    open(work + "/cut.sqlite", "wb").write(whole[: len(whole) // 2])
    status, _, errors = run("report", work + "/cut.sqlite", "--quiet", "--out", work + "/no.html")
    assert status == 5, (status, errors)
    assert not os.path.exists(work + "/no.html")


check_claims([
    policies_and_requests_are_those_of_a_run,
    pictures_need_no_style_sheet,
    answers_are_those_of_the_results,
    figures_of_the_paper_go_with_the_powers_that_its_text_has,
    curves_of_the_paper_are_those_of_the_loop,
    a_number_that_left_its_band_stands_first,
    what_is_saved_is_what_was_given,
    texts_of_a_result_are_shown_as_text,
    members_that_lack_or_are_of_another_kind_do_no_harm,
    quantiles_of_a_study_are_those_of_its_rows,
    a_case_may_come_from_a_pipe,
    what_is_no_result_is_refused,
])
