// The page: controls, plots and tables of spikes around one time and one range that all share.

const TURN_PLAYS_S = 8; // how long the range that is shown, or one turn of it, takes to play
const PLOT_BODIES = 3; // whose plots are all shown; of more bodies one is chosen
const FRAMES_KEPT = 120; // of which the rate is known

class Page {
    constructor(data) {
        this.data = data;
        this.whole = { from: 0, to: data.duration_s };
        // what is not counted may be far larger than all that is
        this.counted = { ...this.whole, from: data.report_from_s || this.whole.from };
        this.view = { ...this.counted };
        this.time = this.view.from;
        this.shown = new Set(data.runs.map((run) => run.backend));
        this.unit = data.crank !== null ? "deg" : "ms";
        this.arrows = "linear";
        this.hasTrails = true;
        this.isPlaying = false;
        this.pace = 1;
        this.frames = [];
        this.plots = [];
        this.choosers = [];
    }

    // Times as people read them.

    timeWords(time) {
        const ms = `${(time * 1000).toPrecision(6)} ms`;
        return this.data.crank === null ? ms : `crank ${this.degrees(time).toFixed(2)} deg, ${ms}`;
    }

    // The columns of a time in a table.
    timeHeads() {
        return this.data.crank === null ? ["ms"] : ["crank, deg", "ms"];
    }

    timeCells(time) {
        const ms = (time * 1000).toPrecision(6);
        return this.data.crank === null ? [ms] : [this.degrees(time).toFixed(2), ms];
    }

    degrees(time) {
        return (this.data.crank.start_rad + this.data.crank.speed_rad_s * time) * DEG;
    }

    unitWords() {
        return this.unit === "deg" ? "crank angle, deg" : "time, ms";
    }

    // Ticks of the range that is shown. Their decimals follow from their distance, so that they
    // differ at any zoom.
    timeTicks(wanted) {
        const { from, to } = this.view;
        if (this.unit === "ms") {
            const { ticks, decimals } = findTicks(from * 1000, to * 1000, wanted);
            return ticks.map((tick) => ({ time: tick / 1000, words: tick.toFixed(decimals) }));
        }
        const ends = [this.degrees(from), this.degrees(to)].sort((a, b) => a - b);
        const { ticks, decimals } = this.degreeTicks(ends[0], ends[1], wanted);
        const { start_rad: start, speed_rad_s: speed } = this.data.crank;
        return ticks.map((tick) => ({
            time: (tick / DEG - start) / speed,
            words: tick.toFixed(decimals),
        }));
    }

    // Over a turn and more at parts of a turn.
    degreeTicks(low, high, wanted) {
        const step = [30, 45, 60, 90, 180, 360].find((one) => (high - low) / one <= wanted);
        if (high - low < 150 || step === undefined) {
            return findTicks(low, high, wanted);
        }
        const ticks = [];
        for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i++) {
            ticks.push(i * step);
        }
        return { ticks, decimals: 0 };
    }

    // What all parts share.

    setTime(time) {
        this.time = Math.max(this.whole.from, Math.min(this.whole.to, time));
        this.showTime();
    }

    showTime() {
        const share = (this.time - this.view.from) / (this.view.to - this.view.from);
        this.slider.value = String(Math.round(1000 * share));
        const words = this.timeWords(this.time);
        this.slider.setAttribute("aria-valuetext", words);
        this.clock.textContent = words;
        this.mechanism.draw();
        for (const plot of this.plots) {
            if (plot.isSeen) {
                plot.showTime();
            }
        }
    }

    zoom(from, to) {
        const least = 1e-9 * (this.whole.to - this.whole.from);
        if (to - from > least) {
            this.view = {
                from: Math.max(this.whole.from, from),
                to: Math.min(this.whole.to, to),
            };
            if (this.time < this.view.from || this.time > this.view.to) {
                this.time = this.view.from;
            }
            this.outButton.disabled =
                this.view.from === this.whole.from && this.view.to === this.whole.to;
            this.redraw();
        }
    }

    // The range that round plots fit: what is counted, where no more is shown.
    fitted() {
        return this.view.from < this.counted.from ? this.whole : this.counted;
    }

    zoomOut() {
        this.zoom(this.whole.from, this.whole.to);
    }

    // Puts a spike into the middle, with some of what is around it.
    zoomTo(spike) {
        this.stop();
        const width = Math.max(
            6 * (spike.end_s - spike.onset_s),
            1e-4 * (this.whole.to - this.whole.from),
        );
        this.time = spike.peak_s;
        this.zoom(spike.peak_s - width / 2, spike.peak_s + width / 2);
        this.setTime(spike.peak_s);
    }

    redraw() {
        for (const plot of this.plots) {
            plot.isStale = true;
        }
        this.drawSeen();
        this.showTime();
    }

    // Plots are drawn when they come into view.
    drawSeen() {
        for (const plot of this.plots) {
            if (plot.isSeen && plot.isStale) {
                plot.isStale = false;
                plot.draw();
            }
        }
    }

    onKey(event) {
        const step = (this.view.to - this.view.from) / (event.shiftKey ? 20 : 400);
        const actions = {
            " ": () => this.toggle(),
            ArrowRight: () => this.setTime(this.time + step),
            ArrowLeft: () => this.setTime(this.time - step),
            Home: () => this.setTime(this.view.from),
            End: () => this.setTime(this.view.to),
            "+": () => this.zoom(this.time - 100 * step, this.time + 100 * step),
            "-": () => this.zoomOut(),
            Escape: () => this.zoomOut(),
        };
        if (actions[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
            event.preventDefault();
            if (event.key !== " ") {
                this.stop();
            }
            actions[event.key]();
        }
    }

    // Playing.

    toggle() {
        if (this.isPlaying) {
            this.stop();
        } else {
            this.play();
        }
    }

    play() {
        this.isPlaying = true;
        this.playButton.textContent = "Pause";
        this.before = null;
        if (this.time >= this.view.to) {
            this.time = this.view.from;
        }
        requestAnimationFrame((now) => this.step(now));
    }

    stop() {
        this.isPlaying = false;
        this.playButton.textContent = "Play";
    }

    // Seconds of the run in a second of playing.
    rate() {
        const width = this.view.to - this.view.from;
        const crank = this.data.crank;
        const turn = crank === null ? width : (2 * Math.PI) / Math.abs(crank.speed_rad_s);
        return (this.pace * Math.min(width, turn)) / TURN_PLAYS_S;
    }

    step(now) {
        if (!this.isPlaying) {
            return;
        }
        if (this.before !== null) {
            this.frames.push(now - this.before);
            this.frames.splice(0, this.frames.length - FRAMES_KEPT);
            // after a while in the background go on from here
            const passed = Math.min(now - this.before, 100) / 1000;
            let time = this.time + passed * this.rate();
            if (time > this.view.to || time < this.view.from) {
                time = this.view.from;
            }
            this.time = time;
            this.showTime();
        }
        this.before = now;
        requestAnimationFrame((next) => this.step(next));
    }

    // Controls.

    button(words, act) {
        const made = element("button", { type: "button" }, words);
        made.addEventListener("click", act);
        return made;
    }

    choice(words, choices, chosen, act) {
        const select = element("select", {});
        for (const [value, shown] of choices) {
            select.append(element("option", { value, selected: value === chosen }, shown));
        }
        select.addEventListener("change", () => act(select.value));
        return element("label", {}, words + " ", select);
    }

    check(words, isOn, act) {
        const box = element("input", { type: "checkbox", checked: isOn });
        box.addEventListener("change", () => act(box.checked));
        return element("label", { className: "switch" }, box, " ", words);
    }

    makeControls() {
        this.playButton = this.button("Play", () => this.toggle());
        this.outButton = this.button("Whole run", () => this.zoomOut());
        this.outButton.disabled = this.view.from === this.whole.from;
        this.slider = element("input", {
            type: "range",
            min: "0",
            max: "1000",
            value: "0",
            className: "time",
        });
        this.slider.setAttribute("aria-label", "Time");
        this.slider.addEventListener("input", () => {
            this.stop();
            const share = Number(this.slider.value) / 1000;
            this.setTime(this.view.from + share * (this.view.to - this.view.from));
        });
        this.clock = element("output", { className: "clock" });
        return element(
            "div",
            { className: "controls playing" },
            this.playButton,
            this.slider,
            this.clock,
            this.outButton,
        );
    }

    // How it is played, and in which unit time is shown.
    makeTimeControls() {
        const paces = [
            ["0.1", "1/10"],
            ["0.25", "1/4"],
            ["0.5", "1/2"],
            ["1", "1"],
            ["2", "2"],
            ["4", "4"],
        ];
        const parts = [
            this.choice("Speed", paces, "1", (pace) => {
                this.pace = Number(pace);
            }),
        ];
        if (this.data.crank !== null) {
            parts.push(
                this.choice(
                    "Axis",
                    [
                        ["deg", "degrees"],
                        ["ms", "ms"],
                    ],
                    this.unit,
                    (unit) => {
                        this.unit = unit;
                        this.redraw();
                    },
                ),
            );
        }
        return parts;
    }

    makeMechanismControls() {
        const row = element("div", { className: "controls" });
        for (const run of this.data.runs) {
            const box = this.check(run.backend, true, (isOn) => {
                this.shown[isOn ? "add" : "delete"](run.backend);
                this.redraw();
            });
            box.append(element("span", { className: "swatch " + run.backend }));
            row.append(box);
        }
        row.append(
            ...this.makeTimeControls(),
            this.check("paths", true, (isOn) => {
                this.hasTrails = isOn;
                this.mechanism.draw();
            }),
        );
        row.append(...this.mechanism.makeNames());
        if (!this.data.is_spatial) {
            row.append(...this.mechanism.makeWays());
        }
        if (this.mechanism.forceMost > 0) {
            const choices = [
                ["linear", "linear"],
                ["log", "logarithmic"],
                ["off", "off"],
            ];
            row.append(
                this.choice("Forces", choices, this.arrows, (arrows) => {
                    this.arrows = arrows;
                    this.mechanism.draw();
                }),
            );
        }
        if (this.mechanism.play > 0) {
            row.append(this.makeMagnifier());
        }
        if (this.data.is_spatial) {
            row.append(...this.mechanism.makeTurning());
        }
        return row;
    }

    // From as it is to three times what is usual, on a logarithmic scale.
    makeMagnifier() {
        const most = Math.log10(3 * this.magnification);
        const slider = element("input", {
            type: "range",
            min: "0",
            max: "1000",
            className: "short",
        });
        slider.value = String(Math.round((1000 * Math.log10(this.magnification)) / most));
        const words = element("output", {});
        const show = () => {
            this.magnification = 10 ** ((most * Number(slider.value)) / 1000);
            words.textContent = `${formatNumber(Number(this.magnification.toPrecision(2)))} times`;
        };
        slider.addEventListener("input", () => {
            show();
            this.mechanism.draw();
        });
        show();
        return element("label", {}, "Play magnified ", slider, " ", words);
    }

    // Sections.

    section(title, ...children) {
        return element("section", {}, element("h2", {}, title), ...children);
    }

    addPlot(plot) {
        if (plot.lines === undefined || plot.lines.length > 0) {
            this.plots.push(plot);
            return [plot.figure];
        }
        return [];
    }

    lines(of, number, what, factor, limits, runs) {
        return (runs || this.data.runs).map((run) =>
            makeLine(run, of, number, what, factor, limits || {}),
        );
    }

    marks(of, number, what, factor) {
        return this.data.runs
            .filter((run) => run.is_truth)
            .flatMap((run) =>
                findPeaks(run, of, number, what).map((peak) => ({
                    time: peak.time_s,
                    value: peak.value * factor,
                    backend: run.backend,
                })),
            );
    }

    // The runs whose difference from the reference is the solver's own: with play the closed form,
    // which has none, would show the play.
    comparable() {
        const hasPlay = this.data.joints.some((joint) => joint.has_play);
        return this.data.runs.filter((run) => !hasPlay || run.backend !== "analytic");
    }

    bodyPlots(body) {
        const name = this.data.bodies[body].name;
        if (
            this.data.runs.some(
                (run) => findSignal(run, "body", body, "acceleration_m_s2") !== null,
            )
        ) {
            return this.slidingPlots(body);
        }
        const between = { least: "alpha_min_rad_s2", most: "alpha_max_rad_s2" };
        const plots = [
            new TimePlot(this, `${name}: angle, deg`, this.lines("body", body, "angle_rad", DEG)),
            new TimePlot(
                this,
                `${name}: angular velocity, rad/s`,
                this.lines("body", body, "omega_rad_s", 1),
            ),
            new TimePlot(
                this,
                `${name}: angular acceleration, rad/s^2`,
                this.lines("body", body, "alpha_rad_s2", 1, between),
                { isSpiky: true },
            ),
            new TimePlot(
                this,
                `${name}: angular velocity less that of the reference, rad/s`,
                this.lines("body", body, "omega_difference_rad_s", 1, {}, this.comparable()),
                { isSpiky: true },
            ),
        ];
        return plots.flatMap((plot) => this.addPlot(plot));
    }

    // The largest range of a signal of a body over all runs, or 0.
    spread(body, what) {
        const ranges = this.data.runs.map((run) => {
            const [low, high] = limitsOf(findSignal(run, "body", body, what) || [0]);
            return high - low;
        });
        return Math.max(0, ...ranges);
    }

    // m: a millionth of the mechanism, below which a way is none
    get restingWay() {
        return 1e-6 * this.mechanism.extent;
    }

    // Of a body that does not turn: where its centre is, along each axis that it moves along.
    slidingPlots(body) {
        const name = this.data.bodies[body].name;
        const axes = ["x", "y"].filter((axis) => this.spread(body, `${axis}_m`) > this.restingWay);
        const plots = axes.map(
            (axis) =>
                new TimePlot(
                    this,
                    `${name}: ${axis} of the centre, mm`,
                    this.lines("body", body, `${axis}_m`, 1e3),
                ),
        );
        plots.push(
            new TimePlot(
                this,
                `${name}: size of the centre's acceleration, m/s^2`,
                this.lines("body", body, "acceleration_m_s2", 1, { most: "acceleration_max_m_s2" }),
                { isSpiky: true, hasZero: true },
            ),
        );
        return plots.flatMap((plot) => this.addPlot(plot));
    }

    // Velocities and accelerations of all bodies on one set of axes, as papers show them; each body
    // has its own dashes.
    togetherPlots(bodies) {
        const moving = bodies.filter((body) => this.isTurning(body));
        if (moving.length < 2) {
            return [];
        }
        const bands = this.paperBands();
        const dashes = [[], [7, 4], [2, 3]];
        const of = (what, limits) =>
            moving.flatMap((body, i) =>
                this.lines("body", body, what, 1, limits)
                    .filter((line) => line !== null)
                    .map((line) => ({
                        ...line,
                        dash: dashes[i],
                        name: `${this.data.bodies[body].name}, ${line.backend}`,
                    })),
            );
        const words = moving.map((i) => this.data.bodies[i].name).join(", ");
        const plots = [
            new TimePlot(this, `${words}: angular velocity, rad/s`, of("omega_rad_s", {}), { bands }),
            new TimePlot(
                this,
                `${words}: angular acceleration, rad/s^2`,
                of("alpha_rad_s2", { least: "alpha_min_rad_s2", most: "alpha_max_rad_s2" }),
                { isSpiky: true, bands },
            ),
        ];
        return [
            element("div", { className: "plots" }, ...plots.flatMap((plot) => this.addPlot(plot))),
            ...this.paperWords(bands),
        ];
    }

    isTurning(body) {
        return !this.data.runs.some(
            (run) => findSignal(run, "body", body, "acceleration_m_s2") !== null,
        );
    }

    // Of the paper's own mechanism the bands of the crank angle in which it saw its spikes, deg.
    paperBands() {
        const run = this.data.results.runs.find((one) => one.spike_bands);
        return run ? run.spike_bands.bands_deg : [];
    }

    // What the paper says of the same axes, beside what is found here.
    paperWords(bands) {
        if (bands.length === 0) {
            return [];
        }
        const counts = this.data.results.runs.flatMap((run) =>
            Object.entries((run.spike_bands || { bodies: {} }).bodies).map(
                ([name, of]) =>
                    `${run.backend}, ${name}: ${of.inside} inside, ${of.outside} outside`,
            ),
        );
        return [
            element(
                "p",
                {},
                "These are the axes of the paper's Figures 5 to 8: angular velocity (5 without " +
                    "play, 6 with its restitution model, 7 with its impact model) and angular " +
                    "acceleration (8) of coupler and follower. It says that play makes the " +
                    "velocities larger at first, and that small spikes stand between 120 and 130 " +
                    "and between 290 and 300 deg of the crank, which are shaded. Spikes of the " +
                    `acceleration that are found here: ${counts.join("; ")}.`,
            ),
        ];
    }

    // All moving bodies; of many the one that is chosen.
    makeBodies() {
        const moving = this.data.bodies
            .map((body, i) => i)
            .filter((i) => !this.data.bodies[i].is_driven);
        const grid = element("div", { className: "plots" });
        const section = this.section("Motion");
        if (moving.length > 1 && moving.length <= PLOT_BODIES) {
            section.append(...this.togetherPlots(moving));
        }
        if (moving.length <= PLOT_BODIES) {
            moving.forEach((body) => grid.append(...this.bodyPlots(body)));
        } else {
            const names = moving.map((i) => [String(i), this.data.bodies[i].name]);
            const chooser = new Chooser(this, "Body", names, (body) => [
                element("div", { className: "plots" }, ...this.bodyPlots(Number(body))),
            ]);
            section.append(chooser.element);
        }
        section.append(grid);
        return section;
    }

    // The torque of each drive: the crank's, and those beside it.
    makeDrive() {
        const figures = [];
        const named = (number) =>
            this.data.runs
                .flatMap((run) => run.signals)
                .find((one) => one.what === "drive_torque_N_m" && one.number === number);
        for (let number = 0; named(number) !== undefined; number++) {
            const { drives } = this.data.results.overview;
            figures.push(
                ...this.addPlot(
                    new TimePlot(
                        this,
                        drives === undefined
                            ? "Torque of the drive, N m"
                            : `Torque of the drive at ${drives[number].name}, N m`,
                        this.lines("run", number, "drive_torque_N_m", 1),
                        { isSpiky: true },
                    ),
                ),
            );
        }
        return figures.length > 0
            ? [this.section("Drive", element("div", { className: "plots" }, ...figures))]
            : [];
    }

    // Which samples are left out, of all runs alike or of each.
    strideWords() {
        const strides = this.data.runs.map((run) => run.stride);
        const words = (run, of) =>
            `One in ${run.stride} of the samples of ${of} is here, with the peaks between them.`;
        return strides.every((stride) => stride === strides[0])
            ? strides[0] > 1
                ? words(this.data.runs[0], "each run")
                : ""
            : this.data.runs
                  .filter((run) => run.stride > 1)
                  .map((run) => words(run, run.backend))
                  .join(" ");
    }

    makeSaving() {
        const stem =
            (this.data.case.split("/").pop() || "report").replace(/\.[^.]*$/, "") || "report";
        const words =
            "The values on this page, rounded to 1/131068 of each signal's range, with the exact " +
            "results and peaks. " +
            this.strideWords();
        const section = this.section(
            "Save the data",
            element("p", {}, words),
            element(
                "div",
                { className: "controls" },
                this.button("Save as JSON", () =>
                    saveFile(stem + ".json", "application/json", dataAsJson(this.data)),
                ),
                this.button("Save as CSV", () =>
                    saveFile(stem + ".csv", "text/csv", dataAsCsv(this.data)),
                ),
            ),
        );
        section.className = "screen";
        return section;
    }

    // Draws plots that come into view, and marks those that are.
    watch() {
        this.observer.disconnect();
        for (const plot of this.plots) {
            plot.isStale = true;
            this.observer.observe(plot.figure);
        }
    }

    build(live) {
        this.mechanism = this.data.is_spatial ? new SpaceMechanism(this) : new Mechanism(this);
        this.magnification = this.mechanism.usualMagnification;
        const hint =
            "Click a plot to go to a time, drag over it to zoom, double-click for the whole run. " +
            "Keys: space plays, arrows step, + and - zoom.";
        const spatial = this.data.is_spatial ? " Drag the mechanism to turn it." : "";
        live.append(
            element(
                "section",
                { className: "moving" },
                element("h2", {}, "The mechanism"),
                this.mechanism.canvas,
                this.mechanism.table,
            ),
            this.makeControls(),
            this.makeMechanismControls(),
            element("p", { className: "note" }, hint + spatial),
            ...new Joints(this).make(),
            this.makeBodies(),
            ...this.makeDrive(),
            ...new Revolutions(this).make(),
            this.makeSaving(),
        );
        this.observer = new IntersectionObserver(
            (entries) => {
                for (const entry of entries) {
                    this.plots
                        .filter((plot) => plot.figure === entry.target)
                        .forEach((plot) => {
                            plot.isSeen = entry.isIntersecting;
                        });
                }
                this.drawSeen();
            },
            { rootMargin: "200px" },
        );
        this.watch();
    }

    // Draws anew where colours or sizes change, and all of it for print.
    follow() {
        const anew = () => {
            COLOURS.clear();
            this.redraw();
        };
        for (const query of ["(prefers-color-scheme: dark)", "print"]) {
            matchMedia(query).addEventListener("change", anew);
        }
        addEventListener("resize", anew);
        addEventListener("beforeprint", () => {
            this.stop();
            this.choosers.forEach((chooser) => chooser.showAll());
            this.plots.forEach((plot) => (plot.isSeen = true));
            anew();
        });
        addEventListener("afterprint", () => {
            this.choosers.forEach((chooser) => chooser.show(chooser.chosen));
            anew();
        });
    }
}

async function showPage() {
    followStops();
    const live = document.getElementById("live");
    let data = null;
    try {
        data = await readData();
    } catch (error) {
        // an old browser: what is there without script stays
        live.hidden = false;
        live.append(
            element(
                "p",
                {},
                "This browser cannot unpack the data of the page (DecompressionStream).",
            ),
        );
        return;
    }
    if (data.runs.length === 0) {
        return;
    }
    const page = new Page(data);
    live.hidden = false;
    document.getElementById("picture").hidden = true;
    page.build(live);
    page.follow();
    page.showTime();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) {
        page.play();
    }
    // for tests, and for those who look into the page
    window.jointplay = page;
}

showPage();
