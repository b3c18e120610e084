# Does the page of 'jointplay report' keep its word? Its policy and the hashes in it, nothing that
# asks another place, texts of a user's shown as text, and data that decode to what 'jointplay run'
# writes.
# Usage: report.py PROGRAM CASE. Prints TAP.
import csv, json, math, os, re, subprocess, sys

from report_reading import Page, check_claims, check_policy, check_requests, unpack

program, case = sys.argv[1:3]
HOSTILE = "</script></title><img src=x onerror=\"document.title='x'\">&lt;b&gt; \u9023 'q'"
# what is no column of a series
OWN = ["omega_difference_rad_s", "force_difference", "acceleration_m_s2",
       "acceleration_max_m_s2", "vx_m_s"]


def run(*words):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


MADE = {}


def make(path, *words):
    """A page that these words make, made once."""
    if words in MADE:
        return MADE[words]
    # few samples where a claim does not need more; the last value of a key counts
    more = ["--set", "run.samples=400", *words]
    status, _, errors = run("report", case, "--quiet", "--quick", "--out", path, *more)
    assert status == 0, errors
    MADE[words] = open(path, encoding="utf-8").read()
    return MADE[words]


def series(folder, *words):
    status, _, errors = run("run", case, "--quiet", "--out", folder, *words)
    assert status == 0, errors
    stem = os.path.splitext(os.path.basename(case))[0]
    result = json.load(open(f"{folder}/{stem}.json"))
    tables = {}
    for one in result["runs"]:
        with open(f"{folder}/{stem}-{one['backend']}.csv") as stream:
            rows = list(csv.reader(stream))
        tables[one["backend"]] = dict(zip(rows[0], zip(*rows[1:])))
    return result, tables


def numbers_of(column):
    return [float(cell) if cell else math.nan for cell in column]


# The claims.


def the_policy_allows_one_script_and_one_style_sheet(work):
    check_policy(Page(make(work + "/a.html")))


def nothing_in_it_asks_another_place(work):
    check_requests(make(work + "/b.html"))
    # the control: a page that asks is found
    try:
        check_requests("<img src='http://x'>")
    except AssertionError:
        return
    raise AssertionError("a page that asks another place was not found")


def the_picture_needs_no_style_sheet(work):
    text = make(work + "/c.html")
    picture = text[text.index("<svg") : text.index("</svg>\n</div>")]
    assert "<path" in picture and "<style" not in picture and "class=" not in picture


def extent(values):
    numbers = [float(one) for one in values]
    return min(numbers), max(numbers), numbers[-1]


def strokes(svg):
    """Each path's steps, with steps up and down in one column as their least, most and last."""
    found = []
    for data in re.findall(r' d="([^"]*)"', svg):
        steps = []
        for letter, numbers in re.findall(r"([A-Za-z])([^A-Za-z]*)", data):
            if letter == "V" and steps and steps[-1][0] == "V":
                steps[-1][1].append(float(numbers))
            else:
                steps.append((letter, re.findall(r"[-.0-9]+", numbers)))
        found.append([(letter, *extent(of)) if letter == "V" else (letter, of)
                      for letter, of in steps])
    return found


def the_picture_has_the_strokes_of_run(work):
    words = ["--set", "run.samples=400", "--backend", "reference", "--uncertified"]
    text = make(work + "/k.html", *words)
    status, _, errors = run("run", case, "--quiet", "--plot", work + "/k.svg", *words)
    assert status == 0, errors
    ours = strokes(text[text.index("<svg") : text.index("</svg>\n</div>")])
    theirs = strokes(open(work + "/k.svg", encoding="utf-8").read())
    assert len(ours) > 10 and ours == theirs
    # the control: a stroke that goes further is another
    assert strokes(" d=\"M0 0V1V3V2\"") != strokes(" d=\"M0 0V1V4V2\"")


def a_title_is_shown_as_text(work):
    text = make(work + "/d.html", "--set", "title=" + HOSTILE)
    page = Page(text)
    assert "img" not in page.tags and page.tags.count("script") == 1
    assert page.text("h1") == HOSTILE, page.text("h1")
    assert "onerror" in page.text("title")
    assert unpack(page)["title"] == HOSTILE


def the_answer_is_that_of_run(work):
    page = Page(make(work + "/e.html"))
    result, _ = series(work + "/e", "--set", "run.samples=400")
    answer = page.text("li") + page.text("td") + page.text("th")
    for row in result["overview"]["joints"] + result["overview"]["bodies"]:
        assert row["name"] in answer
    force = result["overview"]["joints"][0]["force_max_N"]
    assert f"{force / 1000:.3g}" in answer or f"{force:.3g}" in answer, answer
    assert f"right to {result['truth']['uncertainty']:.2g}" in page.text("li"), page.text("li")
    assert "Assumed:" in page.text("li")


def energy_and_orders_need_no_script(work):
    words = ["--set", "run.samples=400", "--set", "run.revolutions=2", "--uncertified",
             "--backend", "reference"]
    page = Page(make(work + "/j.html", *words))
    status, output, errors = run("run", case, "--quiet", "--json", *words)
    assert status == 0, errors
    result = json.loads(output)
    cells = page.texts["td"]
    for one in result["runs"]:
        orders = one["spectrum"]["bodies"]["follower"]["omega_rad_s"]
        step = round(1 / one["spectrum"]["orders"][1])
        assert f"{orders[step]:.4g}" in cells, (orders[step], cells)
        share = one["energy"]["residual_share"]
        assert f"{share:.5g}" in cells, share
        assert 0 < share <= abs(one["energy"]["residual_J"]) / max(
            abs(one["energy"][key]) for key in ["drive_work_J", "dissipated_J", "change_J"])
    growth = result["settled"]["growth_per_revolution"]
    assert f"becomes {growth:.3g} of itself" in page.text("li"), page.text("li")
    assert "reference repeats every revolution" in page.text("li"), page.text("li")


def the_command_makes_the_page_again(work):
    text = make(work + "/f.html", "--set", "title=a b", "--backend", "reference")
    command = unpack(Page(text))["command"]
    # as a shell takes it apart
    script = "for word in " + command + '; do printf "%s\\n" "$word"; done'
    done = subprocess.run(["sh", "-c", script], capture_output=True, text=True)
    words = done.stdout.splitlines()
    assert words[0] == "jointplay", words
    status, _, errors = run(*words[1:], "--quiet")
    assert status == 0, errors
    again = open(work + "/f.html", encoding="utf-8").read()
    same = lambda page: [one["signals"] for one in unpack(Page(page))["runs"]]
    assert same(again) == same(text)


def check_values(data, tables, stride):
    compared = 0
    for one in data["runs"]:
        table = tables[one["backend"]]
        assert one["stride"] == stride, one["stride"]
        for signal in one["signals"]:
            column = table.get(signal["name"])
            if column is None:
                assert signal["what"] in OWN, signal["what"]
                continue
            column = numbers_of(column)
            # half a step, and what rounding adds to it
            size = max((abs(value) for value in column if value == value), default=0.0)
            allowed = 0.5 * signal["step"] + 1e-11 * size
            count = signal["count"]
            for i, value in enumerate(signal["values"]):
                first = i * stride
                behind = len(column) if i + 1 == count else first + stride
                part = column[first:behind]
                if signal["what"].split("_")[1:2] == ["min"]:
                    expected = min(part)
                elif signal["what"].split("_")[1:2] == ["max"]:
                    expected = max(part)
                else:
                    expected = part[0]
                assert abs(value - expected) <= allowed, (signal["name"], i, value, expected)
            compared += 1
    assert compared > 20, compared


def check_peaks(data, result):
    for one in data["runs"]:
        whole = next(other for other in result["runs"] if other["backend"] == one["backend"])
        peaks = one["peaks"]
        largest = lambda *key: max(
            abs(one["value"]) for one in peaks if (one["of"], one["number"], one["what"]) == key)
        for number, body in enumerate(data["bodies"]):
            known = whole["bodies"].get(body["name"])
            if known is not None:
                sizes = [abs(known["alpha_max_rad_s2"]), abs(known["alpha_min_rad_s2"])]
                assert largest("body", number, "alpha_rad_s2") == max(sizes)
        for number, joint in enumerate(data["joints"]):
            if joint["has_play"] and one["backend"] != "analytic":
                known = whole["joints"][joint["name"]]
                assert largest("joint", number, "force") == known["force_max_N"]
                assert largest("joint", number, "gap") == known["penetration_max_m"]


def the_data_are_the_samples_and_the_peaks_of_run(work):
    words = ["--set", "run.samples=900"]
    data = unpack(Page(make(work + "/g.html", *words)))
    result, tables = series(work + "/g", *words)
    check_values(data, tables, 1)
    check_peaks(data, result)
    # the control: one value that is off by a step is found
    signal = next(one for one in data["runs"][0]["signals"] if one["step"] > 1e-6)
    signal["values"][7] += signal["step"]
    try:
        check_values(data, tables, 1)
    except AssertionError:
        return
    raise AssertionError("a value that is off was not found")


def no_peak_is_lost_where_samples_are_left_out(work):
    words = ["--set", "run.samples=7000", "--set", "run.backends=[reference, ode]"]
    text = make(work + "/h.html", *words)
    data = unpack(Page(text))
    result, tables = series(work + "/h", *words)
    assert data["runs"][0]["stride"] > 1
    check_values(data, tables, data["runs"][0]["stride"])
    check_peaks(data, result)
    assert len(text) < 1e6, len(text)


def a_file_of_another_kind_is_not_replaced(work):
    path = work + "/own.html"
    open(path, "w").write("<!DOCTYPE html>\n<title>mine</title>\n")
    status, _, errors = run("report", case, "--quiet", "--out", path)
    assert status == 5, status
    assert "page of jointplay report" in errors, errors
    assert "mine" in open(path).read()


def without_a_name_the_page_is_in_the_folder(work):
    words = ["report", os.path.abspath(case), "--quiet", "--backend", "analytic"]
    status = subprocess.run([program, *words], cwd=work).returncode
    stem = os.path.splitext(os.path.basename(case))[0]
    assert status == 0 and os.path.exists(f"{work}/{stem}.html")


def a_run_that_fails_is_in_the_page(work):
    path = work + "/i.html"
    # a step in which the pin goes through its wall
    status, _, errors = run("report", case, "--quiet", "--out", path, "--step", "2 ms", "--set",
                            "run.start=centred", "--set", "run.backends=[analytic, ode]")
    assert status == 4, errors
    page = Page(open(path, encoding="utf-8").read())
    assert "ode FAILED: " in page.text("li"), page.text("li")
    assert [one["backend"] for one in unpack(page)["runs"]] == ["analytic"]


CLAIMS = [
    the_policy_allows_one_script_and_one_style_sheet,
    nothing_in_it_asks_another_place,
    the_picture_needs_no_style_sheet,
    the_picture_has_the_strokes_of_run,
    a_title_is_shown_as_text,
    the_answer_is_that_of_run,
    energy_and_orders_need_no_script,
    the_command_makes_the_page_again,
    the_data_are_the_samples_and_the_peaks_of_run,
    no_peak_is_lost_where_samples_are_left_out,
    a_file_of_another_kind_is_not_replaced,
    without_a_name_the_page_is_in_the_folder,
    a_run_that_fails_is_in_the_page,
]

check_claims(CLAIMS)
