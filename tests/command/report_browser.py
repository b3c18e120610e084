# Does a page of 'jointplay report' work in a browser? Chromium opens it, is told over its debugging
# pipe to click, drag and type, and says what it then shows.
# Usage: report_browser.py PROGRAM CASE CHROMIUM [FOLDER-FOR-SCREENSHOTS]. Prints TAP.
import base64, json, os, select, shutil, subprocess, sys, tempfile, time

program, case, chromium = sys.argv[1:4]
pictures = sys.argv[4] if len(sys.argv) > 4 else None
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--remote-debugging-pipe"]
PATIENCE_S = 60
HOSTILE = "</script><img src=x onerror=\"document.title='x'\">"


class Browser:
    """Chromium at the other end of two pipes: messages end in a zero byte."""

    def __init__(self, folder):
        to_browser, self.send_end = os.pipe()
        self.receive_end, from_browser = os.pipe()

        def take_pipes():
            # away from 3 and 4 first, where one of them may stand already
            first, second = os.dup(to_browser), os.dup(from_browser)
            high = [os.dup2(first, 103), os.dup2(second, 104)]
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        self.process = subprocess.Popen(
            [chromium, *FLAGS, "--user-data-dir=" + folder], preexec_fn=take_pipes, close_fds=False,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.rest, self.number, self.session, self.events = b"", 0, None, []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.ask(domain + ".enable")

    def receive(self):
        until = time.monotonic() + PATIENCE_S
        while b"\0" not in self.rest:
            ready = select.select([self.receive_end], [], [], max(0, until - time.monotonic()))[0]
            part = os.read(self.receive_end, 1 << 20) if ready else b""
            if part == b"":
                raise RuntimeError("the browser does not answer")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session is not None:
            message["sessionId"] = self.session
        os.write(self.send_end, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def end(self):
        try:
            self.session = None
            self.ask("Browser.close")
            self.process.wait(PATIENCE_S)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()

    def value(self, expression):
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def wait_for(self, expression):
        until = time.monotonic() + PATIENCE_S
        while not self.value(expression):
            assert time.monotonic() < until, "waited in vain for " + expression
            time.sleep(0.05)

    def open(self, path, width=1200, dark=False, script=True, still=True):
        self.events = []
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1,
                 mobile=False)
        self.ask("Emulation.setScriptExecutionDisabled", value=not script)
        motion = "reduce" if still else "no-preference"
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
                    {"name": "prefers-reduced-motion", "value": motion}]
        self.ask("Emulation.setEmulatedMedia", media="", features=features)
        self.ask("Page.navigate", url="file://" + path)
        if script:
            self.wait_for("document.readyState === 'complete' && window.jointplay !== undefined")
        else:
            self.wait_for("document.readyState === 'complete'")

    def mouse(self, kind, x, y, count=1):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1,
                 clickCount=count)

    def click(self, x, y):
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)

    def key(self, key, code=0, text=None):
        more = {"text": text} if text is not None else {}
        for kind in ["keyDown", "keyUp"]:
            self.ask("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code,
                     **(more if kind == "keyDown" else {}))

    # The middle of what a selector finds, scrolled into view.
    def place(self, selector):
        return self.value(f"""(() => {{
            const found = document.querySelector({json.dumps(selector)});
            found.scrollIntoView({{block: "center"}});
            const box = found.getBoundingClientRect();
            return [box.left, box.top, box.width, box.height];
        }})()""")

    def picture(self, name):
        if pictures is not None:
            shot = self.ask("Page.captureScreenshot", captureBeyondViewport=False)["data"]
            with open(os.path.join(pictures, name + ".png"), "wb") as stream:
                stream.write(base64.b64decode(shot))

    def check_silence(self):
        for event in self.events:
            method, parameters = event.get("method"), event.get("params", {})
            assert method not in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown"), parameters
            assert method != "Log.entryAdded", parameters
        asked = [event["params"]["request"]["url"] for event in self.events
                 if event.get("method") == "Network.requestWillBeSent"]
        # the page itself, and what it makes in memory
        assert [url[:5] for url in asked if not url.startswith("blob:")] == ["file:"], asked


DRAWN = """(() => {
    const blank = (canvas) => {
        const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        return !data.some((value) => value !== 0);
    };
    return [...document.querySelectorAll("canvas")].filter(blank).map((canvas) =>
        canvas.getAttribute("aria-label") || canvas.className);
})()"""
SEE_ALL = "for (const plot of jointplay.plots) plot.isSeen = true; jointplay.redraw();"


# The claims: each of a browser and a page.


def every_plot_is_drawn_and_the_console_is_silent(browser, page):
    browser.open(page)
    browser.value(SEE_ALL)
    assert browser.value("jointplay.plots.length") >= 10
    assert browser.value(DRAWN) == []
    browser.picture("light")
    browser.check_silence()


def dark_and_narrow_pages_fit(browser, page):
    colours = []
    for dark in [False, True]:
        for width in [390, 1200]:
            browser.open(page, width=width, dark=dark)
            browser.value(SEE_ALL)
            assert browser.value("document.documentElement.scrollWidth") <= width
            assert browser.value(DRAWN) == []
            browser.picture(f"{'dark' if dark else 'light'}-{width}")
            browser.check_silence()
        colours.append(browser.value("getComputedStyle(document.body).backgroundColor"))
    assert colours[0] != colours[1], colours


def without_script_answer_and_picture_are_there(browser, page):
    browser.open(page, script=False)
    assert browser.value("document.querySelectorAll('#answer td').length") > 5
    shown = "document.querySelector('#picture svg').getBoundingClientRect().width"
    assert browser.value(shown) > 300
    assert browser.value("document.getElementById('live').getBoundingClientRect().height") == 0
    browser.picture("no-script")
    browser.check_silence()


def it_plays_and_pauses(browser, page):
    browser.open(page, still=False)
    assert browser.value("jointplay.isPlaying")
    before = browser.value("jointplay.time")
    browser.wait_for("jointplay.frames.length > 60")
    assert browser.value("jointplay.time") != before
    frames = sorted(browser.value("jointplay.frames"))
    print(f"# {1000 * len(frames) / sum(frames):.0f} frames a second")
    left, top, width, height = browser.place(".playing button")
    browser.click(left + width / 2, top + height / 2)
    assert not browser.value("jointplay.isPlaying")
    still = browser.value("jointplay.time")
    time.sleep(0.2)
    assert browser.value("jointplay.time") == still
    browser.check_silence()


def keys_move_the_time(browser, page):
    browser.open(page)
    browser.value("document.querySelector('canvas.plot').focus()")
    browser.key("Home", 36)
    assert browser.value("jointplay.time") == 0
    browser.key("ArrowRight", 39)
    one = browser.value("jointplay.time")
    assert one > 0
    browser.key("End", 35)
    assert browser.value("jointplay.time === jointplay.view.to")
    browser.key(" ", 32, " ")
    assert browser.value("jointplay.isPlaying")
    browser.key(" ", 32, " ")
    assert not browser.value("jointplay.isPlaying")


def a_click_and_the_slider_move_the_time(browser, page):
    browser.open(page)
    left, top, width, height = browser.place("canvas.plot")
    browser.click(left + width / 2, top + height / 2)
    share = browser.value("jointplay.time / jointplay.whole.to")
    assert 0.4 < share < 0.6, share
    browser.value("document.querySelector('input.time').focus()")
    browser.key("ArrowLeft", 37)
    assert browser.value("jointplay.time / jointplay.whole.to") < share
    # the cursor of every plot that is seen stands there
    cursors = browser.value("""(() => {
        const left = (one) => one.getBoundingClientRect().left;
        return jointplay.plots.filter((plot) => plot.isSeen && plot.cursor).map((plot) =>
            Math.abs(left(plot.cursor) - left(plot.canvas) - plot.toX(jointplay.time)));
    })()""")
    assert cursors and max(cursors) < 2, cursors


def a_drag_zooms_and_ticks_stay_apart(browser, page):
    browser.open(page)
    left, top, width, height = browser.place("canvas.plot")
    for _ in range(3):
        browser.mouse("mousePressed", left + 0.4 * width, top + 60)
        browser.mouse("mouseMoved", left + 0.5 * width, top + 60)
        browser.mouse("mouseReleased", left + 0.5 * width, top + 60)
    share = browser.value("(jointplay.view.to - jointplay.view.from) / jointplay.whole.to")
    assert share < 0.01, share
    ticks = browser.value("jointplay.timeTicks(5).map((tick) => tick.words)")
    assert len(ticks) >= 3 and len(set(ticks)) == len(ticks), ticks
    browser.picture("zoomed")
    browser.mouse("mousePressed", left + 0.5 * width, top + 60, 2)
    browser.mouse("mouseReleased", left + 0.5 * width, top + 60, 2)
    browser.wait_for("jointplay.view.to - jointplay.view.from === jointplay.whole.to")


def a_listed_spike_is_zoomed_to(browser, page):
    browser.open(page)
    left, top, width, height = browser.place("td button")
    browser.click(left + width / 2, top + height / 2)
    assert browser.value("jointplay.view.to - jointplay.view.from < 0.1 * jointplay.whole.to")
    found = browser.value("""(() => {
        const run = jointplay.data.runs.find((one) => one.is_truth);
        const most = Math.max(...run.spikes.map((spike) => spike.force));
        const plot = jointplay.plots.find((one) => one.title.includes("force"));
        const line = plot.lines.find((one) => one.run === run);
        const isAtSpike = run.spikes.some((spike) => spike.peak_s === jointplay.time);
        return [most, Math.max(...line.y), isAtSpike];
    })()""")
    assert found[2] and found[0] == found[1], found
    browser.picture("spike")


def check_places(browser, names, units):
    """The mechanism's table ends with the last places of the last run's bodies."""
    found = browser.value("""(() => {
        const { run, data } = jointplay.mechanism.poses[jointplay.mechanism.poses.length - 1];
        const rows = [...document.querySelectorAll(".moving .values tbody tr")].slice(-data.bodies.length);
        return data.bodies.map((body, i) => {
            const cells = [...rows[i].cells].map((cell) => cell.textContent);
            const last = %s.map(([name, unit]) => {
                const values = findSignal(run, "body", i, name);
                return formatPlace(values[values.length - 1] * unit);
            });
            return [cells.slice(cells.indexOf(body.name)), [body.name, ...last]];
        });
    })()""" % ("[" + ", ".join(f'["{name}", {unit}]' for name, unit in zip(names, units)) + "]"))
    assert found and all(shown[:len(last)] == last for shown, last in found), found


def every_plot_has_a_table_with_its_peaks(browser, page):
    browser.open(page)
    bare = browser.value("""[...document.querySelectorAll("canvas[role=img]")].filter((canvas) =>
        !canvas.closest("figure, .moving").querySelector("details.values")).map((canvas) => canvas.ariaLabel)""")
    assert bare == [], bare
    # made when it is opened, and not before
    assert browser.value("document.querySelectorAll('.values table').length") == 0
    browser.value("for (const details of document.querySelectorAll('.values')) details.open = true")
    browser.wait_for("[...document.querySelectorAll('.values')].every((one) => one.querySelector('table'))")
    found = browser.value("""(() => {
        const plot = jointplay.plots.find((one) => one.title.includes("force"));
        const rows = [...plot.figure.querySelectorAll(".values tbody tr")];
        const shown = rows.map((row) => row.cells[row.cells.length - 1].textContent);
        return plot.lines.map((line) => formatNumber(Math.max(...line.y))).map((most) =>
            [most, shown.includes(most), rows.length]);
    })()""")
    assert found and all(has and 10 < count <= 64 for _, has, count in found), found
    check_places(browser, ["x_m", "y_m", "angle_rad"], [1000, 1000, "DEG"])
    assert browser.value("document.documentElement.scrollWidth") <= 1200
    browser.picture("tables")
    browser.check_silence()


def runs_can_be_hidden_and_the_axis_changed(browser, page):
    browser.open(page)
    shown = browser.value("[...jointplay.shown].length")
    browser.value("[...document.querySelectorAll('.switch input')].find((box) => "
                  "box.parentElement.textContent.trim() === 'ode').click()")
    assert browser.value("[...jointplay.shown].length") == shown - 1
    browser.value("""(() => {
        const select = [...document.querySelectorAll("select")].find((one) =>
            one.parentElement.textContent.startsWith("Axis"));
        select.value = "ms";
        select.dispatchEvent(new Event("change"));
    })()""")
    assert browser.value("jointplay.unitWords()") == "time, ms"
    browser.value("for (const box of document.querySelectorAll('figcaption input')) box.click()")
    browser.value(SEE_ALL)
    assert browser.value(DRAWN) == []
    browser.check_silence()


def the_data_can_be_saved(browser, page):
    browser.open(page)
    data = json.loads(browser.value("dataAsJson(jointplay.data)"))
    assert len(data["runs"][0]["signals"][0]["values"]) == data["runs"][0]["signals"][0]["count"]
    lines = browser.value("dataAsCsv(jointplay.data)").splitlines()
    assert lines[0].startswith("backend,time_s,"), lines[0]
    assert {line.count(",") for line in lines} == {lines[0].count(",")}
    count = sum(run["signals"][0]["count"] for run in data["runs"])
    assert len(lines) == count + 1, (len(lines), count)


def canvases_have_roles_and_names(browser, page):
    browser.open(page)
    nameless = browser.value("""[...document.querySelectorAll("canvas")].filter((canvas) =>
        canvas.getAttribute("aria-hidden") !== "true" &&
        (canvas.getAttribute("role") !== "img" || !canvas.getAttribute("aria-label"))).length""")
    assert nameless == 0
    unlabelled = browser.value("""[...document.querySelectorAll("input, select")].filter((one) =>
        one.labels.length === 0 && !one.getAttribute("aria-label")).length""")
    assert unlabelled == 0


def pages_of_results_fit_and_are_silent(browser, page):
    folder = os.path.dirname(page)
    words = ["--set", "run.revolutions=0.1", "--set", "run.start=centred", "--quiet", "--json"]
    made = {
        "compare": ["--schemes", "direct/plain", "--steps", "20 us, 10 us"],
        "map": ["--steps", "20 us, 5 us"],
        "tune": ["--error", "0.3", "--schemes", "direct/staggered"],
    }
    for name, more in made.items():
        path = os.path.join(folder, name + ".json")
        with open(path, "w") as stream:
            subprocess.run([program, name, case, *words, *more], check=True, stdout=stream)
    paths = [os.path.join(folder, name + ".json") for name in made]
    results = os.path.join(folder, "results.html")
    subprocess.run([program, "report", *paths, "--quiet", "--out", results], check=True)
    for dark in [False, True]:
        for width in [390, 1200]:
            browser.open(results, width=width, dark=dark)
            assert browser.value("document.documentElement.scrollWidth") <= width
            browser.picture(f"results-{'dark' if dark else 'light'}-{width}")
            browser.wait_for("document.querySelectorAll('#saving button').length === 2")
            browser.check_silence()
    assert browser.value("document.querySelectorAll('svg').length") >= 4
    saved = json.loads(browser.value("JSON.stringify(jointplay.data.results)"))
    assert [one["case"] for one in saved] == [case] * 3
    lines = browser.value("tablesAsCsv()").splitlines()
    assert any(line.startswith("direct/plain") for line in lines), lines[:5]
    # without script all but saving is there
    browser.open(results, script=False)
    assert browser.value("document.querySelectorAll('td').length") > 40
    assert browser.value("document.querySelector('svg').getBoundingClientRect().width") > 300
    browser.picture("results-no-script")
    browser.check_silence()


def a_hostile_title_stays_text(browser, page):
    hostile = os.path.join(os.path.dirname(page), "hostile.html")
    make(hostile, "--set", "title=" + HOSTILE)
    browser.open(hostile)
    assert browser.value("document.querySelectorAll('img').length") == 0
    assert browser.value("document.querySelector('h1').textContent") == HOSTILE
    assert browser.value("document.title") == HOSTILE
    browser.check_silence()


def a_spectrum_and_a_phase_plane_are_those_of_the_results(browser, page):
    browser.open(page)
    found = browser.value("""(() => {
        const plot = jointplay.plots.find((one) => one.series && one.series[0].kind === "stem");
        const run = jointplay.data.results.runs.find((one) => one.backend === "reference");
        const name = jointplay.data.bodies.find((body) => !body.is_driven).name;
        const stem = plot.series.find((one) => one.backend === "reference");
        return [stem.y, run.spectrum.bodies[name].omega_rad_s.map(Math.abs)];
    })()""")
    assert found[0] == found[1] and max(found[0]) > 1, found
    # another signal is another plot, and no plot is left behind
    count = browser.value("jointplay.plots.length")
    browser.value("""(() => {
        const select = [...document.querySelectorAll("select")].find((one) =>
            one.parentElement.textContent.startsWith("Spectrum"));
        select.selectedIndex = 1;
        select.dispatchEvent(new Event("change"));
    })()""")
    browser.value(SEE_ALL)
    assert browser.value("jointplay.plots.length") == count
    assert browser.value(DRAWN) == []
    phase = browser.value("""(() => {
        const plot = jointplay.plots.find((one) => one.series && one.options.at);
        const line = plot.series.find((one) => one.kind === "line");
        const [x, y] = plot.options.at(line, jointplay.time);
        return [Math.min(...line.x) <= x && x <= Math.max(...line.x),
                Math.min(...line.y) <= y && y <= Math.max(...line.y)];
    })()""")
    assert phase == [True, True], phase
    browser.check_silence()


def print_has_every_joint_and_nothing_over_it(browser, page):
    plays = os.path.join(os.path.dirname(page), "plays.html")
    three = os.path.join(os.path.dirname(case), "../hard/three-plays.yaml")
    words = ["--set", "run.samples=200", "--backend", "reference", "--uncertified"]
    subprocess.run([program, "report", three, "--quiet", "--out", plays, *words], check=True)
    browser.open(plays)
    names = """[...document.querySelectorAll("figcaption")].map((one) => one.textContent)
        .filter((one) => one.startsWith("Pin in its hole"))"""
    forces = """(() => {
        const joints = jointplay.data.results.runs[0].joints;
        return Object.entries(joints).filter(([, one]) => one.has_play)
            .sort(([, a], [, b]) => b.force_max_N - a.force_max_N).map(([name]) => name);
    })()"""
    assert len(browser.value(names)) == 1
    shown = browser.value("jointplay.plots.length")
    # on paper all joints with play, the most loaded first, each drawn
    browser.value("dispatchEvent(new Event('beforeprint'))")
    printed = browser.value(names)
    assert [one.split(": ")[1].split(",")[0] for one in printed] == browser.value(forces), printed
    # an unloaded pin has no line at the cursor, which is not printed
    assert [one for one in browser.value(DRAWN) if "overlay" not in one] == []
    browser.ask("Emulation.setEmulatedMedia", media="print", features=[])
    overlays = browser.value("""[...document.querySelectorAll(".overlay")].map((one) =>
        getComputedStyle(one).display)""")
    assert overlays and set(overlays) == {"none"}, overlays
    scrolled = browser.value("""[...document.querySelectorAll(".wide")].filter((one) =>
        getComputedStyle(one).overflowX !== "visible").length""")
    assert scrolled == 0, scrolled
    # and on the screen one again
    browser.value("dispatchEvent(new Event('afterprint'))")
    assert len(browser.value(names)) == 1
    assert browser.value("jointplay.plots.length") == shown


def runs_are_drawn_in_three_ways(browser, page):
    browser.open(page)
    pixels = """(() => {
        const { canvas } = jointplay.mechanism;
        jointplay.mechanism.draw();
        return canvas.toDataURL();
    })()"""
    ways = browser.value("jointplay.mechanism.makeWays().length")
    assert ways == 1
    seen = [browser.value(f"jointplay.mechanism.way = '{way}'; " + pixels)
            for way in ["over", "beside"]]
    assert seen[0] != seen[1], seen
    # names can be left out
    named = browser.value("jointplay.mechanism.way = 'over'; jointplay.mechanism.hasNames = true; "
                          + pixels)
    bare = browser.value("jointplay.mechanism.hasNames = false; " + pixels)
    assert named != bare
    browser.check_silence()


def a_mechanism_in_space_turns(browser, page):
    space = os.path.join(os.path.dirname(page), "space.html")
    bennett = os.path.join(os.path.dirname(case), "../space/bennett.yaml")
    words = ["--set", "run.samples=200", "--backend", "reference", "--uncertified"]
    subprocess.run([program, "report", bennett, "--quiet", "--out", space, *words], check=True)
    browser.open(space)
    browser.value(SEE_ALL)
    assert browser.value(DRAWN) == []
    # joints hold in every picture: both sides of an ideal one are at one place
    apart = browser.value("""(() => {
        const poses = jointplay.mechanism.poses[0];
        let most = 0;
        for (const share of [0, 0.3, 0.7, 1]) {
            poses.set(share * jointplay.whole.to);
            for (const joint of jointplay.data.joints.filter((one) => !one.has_play)) {
                const a = poses.point(joint.body_a, joint.space_a_m);
                const b = poses.point(joint.body_b, joint.space_b_m);
                most = Math.max(most, Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
            }
        }
        return most / jointplay.mechanism.extent;
    })()""")
    assert apart < 1e-4, apart
    before = browser.value("jointplay.mechanism.yaw")
    left, top, width, height = browser.place("canvas.mechanism")
    browser.mouse("mousePressed", left + 0.4 * width, top + 60)
    browser.mouse("mouseMoved", left + 0.6 * width, top + 90)
    browser.mouse("mouseReleased", left + 0.6 * width, top + 90)
    assert browser.value("jointplay.mechanism.yaw") != before
    assert browser.value("jointplay.mechanism.pitch") > 0.45
    browser.value("document.querySelector('.moving .values').open = true")
    browser.wait_for("document.querySelector('.moving .values table') !== null")
    check_places(browser, ["x_m", "y_m", "height_m"], [1000, 1000, 1000])
    browser.picture("space")
    browser.check_silence()


def shipped(name):
    return os.path.join(os.path.dirname(case), "..", name)


def make_of(name, page, *words):
    """The page of another case, beside a page."""
    path = os.path.join(os.path.dirname(page), os.path.basename(name) + ".html")
    command = [program, "report", shipped(name), "--quiet", "--quick", "--out", path, *words]
    subprocess.run(command, check=True)
    return path


PHASE = """(() => {
    const plot = jointplay.plots.find((one) => one.series && one.options.at);
    const [low, high] = limitsOf(...plot.series.map((one) => one.x));
    return [plot.title, high - low];
})()"""


def a_phase_plane_is_of_the_axis_that_a_body_moves_along(browser, page):
    # a follower that goes up and down by 8 mm, on which x is rounding
    browser.open(make_of("mechanisms/cam-roller.yaml", page, "--backend", "reference"))
    title, way = browser.value(PHASE)
    assert title == "follower: velocity along y over position, m/s", title
    assert 7.5 < way < 9, way
    flat = "jointplay.plots.some((one) => (one.title || '').includes('x of the centre'))"
    assert browser.value(flat) is False
    # the control: a table that goes to and fro along x
    browser.open(make_of("mechanisms/rack-and-pinion.yaml", page, "--backend", "reference"))
    title, way = browser.value(PHASE)
    assert title == "table: velocity along x over position, m/s" and way > 30, (title, way)
    browser.check_silence()


def what_does_not_count_is_shown_when_asked_for(browser, page):
    browser.open(make_of("mechanisms/loose-gears.yaml", page, "--backend", "reference"))
    browser.value(SEE_ALL)
    largest = """(() => {
        const plot = jointplay.plots.find((one) => one.title === "motor: force, N");
        const load = jointplay.plots.find((one) => one.all && one.all[0].joint.name === "motor");
        return [plot.high, load.most];
    })()"""
    counted = browser.value(largest)
    browser.value("jointplay.zoomOut()")
    browser.value(SEE_ALL)
    whole = browser.value(largest)
    result = browser.value("""jointplay.data.results.overview.ideal_joints
        .find((row) => row.name === "motor").force_max_N""")
    assert all(abs(one - result) < 0.01 * result for one in counted), (counted, result)
    assert all(one > 1.1 * result for one in whole), (whole, result)


def a_key_stops_only_at_what_scrolls(browser, page):
    stops = """[...document.querySelectorAll(".wide, pre[role=group]")].filter((one) =>
        one.getClientRects().length > 0).map((one) =>
        [one.tabIndex === 0, one.scrollWidth > one.clientWidth || one.scrollHeight > one.clientHeight])"""
    count = []
    for width in [1200, 390]:
        browser.open(page, width=width)
        found = browser.value(stops)
        assert all(is_stop == is_scrolled for is_stop, is_scrolled in found), (width, found)
        count.append(sum(is_stop for is_stop, _ in found))
    assert count[0] < count[1], count


def a_legend_has_the_dashes_of_its_lines(browser, page):
    browser.open(page)
    dashed = browser.value("""(() => {
        const plot = jointplay.plots.find((one) => one.lines && one.lines.some((line) =>
            line.dash && line.dash.length > 0));
        const masks = [...plot.legend.querySelectorAll(".swatch")].map((one) =>
            one.style.maskImage !== "");
        return [plot.lines.map((line) => line.dash.length > 0), masks];
    })()""")
    assert dashed[0] == dashed[1] and True in dashed[0] and False in dashed[0], dashed


def on_a_phone_each_number_of_the_answer_is_seen(browser, page):
    cells = """[...document.querySelectorAll("#answer td")].filter((one) => one.textContent !== "")
        .map((one) => one.getBoundingClientRect().right)"""
    browser.open(page, width=390)
    assert max(browser.value(cells)) <= 390
    # the control: the tables of numbers are wider, and scroll
    assert max(browser.value(cells.replace("#answer", "#numbers"))) > 390


CLAIMS = [
    every_plot_is_drawn_and_the_console_is_silent,
    dark_and_narrow_pages_fit,
    without_script_answer_and_picture_are_there,
    it_plays_and_pauses,
    keys_move_the_time,
    a_click_and_the_slider_move_the_time,
    a_drag_zooms_and_ticks_stay_apart,
    a_listed_spike_is_zoomed_to,
    every_plot_has_a_table_with_its_peaks,
    runs_can_be_hidden_and_the_axis_changed,
    the_data_can_be_saved,
    canvases_have_roles_and_names,
    a_spectrum_and_a_phase_plane_are_those_of_the_results,
    print_has_every_joint_and_nothing_over_it,
    runs_are_drawn_in_three_ways,
    a_mechanism_in_space_turns,
    a_phase_plane_is_of_the_axis_that_a_body_moves_along,
    what_does_not_count_is_shown_when_asked_for,
    a_key_stops_only_at_what_scrolls,
    a_legend_has_the_dashes_of_its_lines,
    on_a_phone_each_number_of_the_answer_is_seen,
    pages_of_results_fit_and_are_silent,
    a_hostile_title_stays_text,
]


def make(path, *words):
    subprocess.run([program, "report", case, "--quiet", "--out", path, *words], check=True)


print(f"1..{len(CLAIMS)}")
folder = tempfile.mkdtemp()
browser = None
try:
    page = os.path.join(folder, "page.html")
    make(page)
    browser = Browser(os.path.join(folder, "user"))
    for number, claim in enumerate(CLAIMS, 1):
        try:
            claim(browser, page)
            print(f"ok {number} - {claim.__name__}")
        except AssertionError as error:
            print(f"not ok {number} - {claim.__name__}")
            print("# " + str(error)[:800].replace("\n", "\n# "))
        sys.stdout.flush()
finally:
    if browser is not None:
        browser.end()
    shutil.rmtree(folder, ignore_errors=True)
