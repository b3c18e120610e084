// Plots that are no functions of time: the path of a pin's centre in its hole, coloured by the
// force, and the load of the pin on the hole by direction. Both are in the axes of the body that
// has the hole, over the part of the run that the other plots show.

const ROUND_BINS = 24; // of the colours of a path

// From weak to strong, readable by the colour-blind: a part of the palette viridis, whose dark end
// is cut for dark pages and whose light end for light ones.
function heatColour(share) {
    const stops = [
        [68, 1, 84],
        [59, 82, 139],
        [33, 145, 140],
        [94, 201, 98],
        [253, 231, 37],
    ];
    const isDark = colourOf("scheme") === "dark";
    const at = (isDark ? 0.25 + 0.75 * share : 0.88 * share) * (stops.length - 1);
    const first = Math.min(stops.length - 2, Math.floor(at));
    const mixed = stops[first].map((value, i) =>
        Math.round(value + (at - first) * (stops[first + 1][i] - value)),
    );
    return `rgb(${mixed.join(",")})`;
}

// What a joint did at its instants, in the axes of its body a.
class JointSignals {
    constructor(data, run, number) {
        const joint = data.joints[number];
        const instants = jointInstants(run, number);
        this.run = run;
        this.number = number;
        this.joint = joint;
        this.instants = instants;
        this.times = instants.times;
        this.count = instants.times.length;
        this.force = instants.force;
        this.hasPath = instants.ex_m !== null && instants.force !== null;
        this.hasLoad = instants.force_x_N !== null && instants.force_y_N !== null;
        this.angles = joint.body_a < 0 ? null : findSignal(run, "body", joint.body_a, "angle_rad");
    }

    turned(x, y, time) {
        const angle = this.angles === null ? 0 : valueAt(this.run, this.angles, time);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        return [c * x + s * y, c * y - s * x];
    }

    offset(i) {
        return this.turned(this.instants.ex_m[i], this.instants.ey_m[i], this.times[i]);
    }

    offsetAt(time) {
        const at = (what) => instantAt(this.instants, what, time);
        return this.turned(at("ex_m"), at("ey_m"), time);
    }

    // The force of the pin on the hole, which points to where on the wall it presses.
    load(i) {
        const { force_x_N: x, force_y_N: y } = this.instants;
        return this.turned(-x[i], -y[i], this.times[i]);
    }

    loadAt(time) {
        const at = (what) => -instantAt(this.instants, what, time);
        return this.turned(at("force_x_N"), at("force_y_N"), time);
    }

    loadSize(i) {
        return Math.hypot(this.instants.force_x_N[i], this.instants.force_y_N[i]);
    }

    // The numbers of the first and the last instant in a range of time.
    within({ from, to }) {
        const first = findPoint(this.times, from);
        return [this.times[first] < from ? first + 1 : first, findPoint(this.times, to)];
    }
}

class RoundPlot {
    constructor(page, title, words, backend) {
        this.page = page;
        this.backend = backend;
        this.canvas = element("canvas", { tabIndex: 0, className: "round" });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute("aria-label", title + ". " + words);
        this.canvas.addEventListener("keydown", (event) => page.onKey(event));
        this.overlay = element("canvas", { className: "round overlay" });
        this.overlay.setAttribute("aria-hidden", "true");
        const frame = element("div", { className: "frame" }, this.canvas, this.overlay);
        this.note = element("div", { className: "legend" }, words);
        this.figure = element(
            "figure",
            { className: "square" },
            element("figcaption", {}, title),
            frame,
            this.note,
        );
    }

    // Rows of some of all signals: run, time, and what `vector` gives of a sample, largest and least
    // of `size` among them.
    addTable(heads, all, size, vector) {
        const table = valuesTable(["run", ...this.page.timeHeads(), ...heads], () => {
            const most = Math.floor(TABLE_ROWS / all.length);
            const rows = all.flatMap((signals) => {
                const { run } = signals;
                const sizes = Float64Array.from(signals.times, (_, i) => size(signals, i));
                return thinned(sizes, most).map((i) => [
                    run.backend,
                    ...this.page.timeCells(signals.times[i]),
                    ...vector(signals, i).map(formatNumber),
                ]);
            });
            const count = all.reduce((sum, signals) => sum + signals.count, 0);
            return { rows, more: count - rows.length };
        });
        this.figure.append(table);
    }

    begin() {
        this.size = this.canvas.clientWidth;
        this.context = prepareCanvas(this.canvas, this.size, this.size);
        this.middle = this.size / 2;
    }

    // Rings at round values up to the reach.
    drawRings(context, scale, most) {
        context.lineWidth = 1;
        context.strokeStyle = colourOf("grid");
        context.beginPath();
        context.moveTo(this.middle, 0);
        context.lineTo(this.middle, this.size);
        context.moveTo(0, this.middle);
        context.lineTo(this.size, this.middle);
        context.stroke();
        for (const tick of findTicks(0, most, 3).ticks) {
            if (tick > 0) {
                context.beginPath();
                context.arc(this.middle, this.middle, tick * scale, 0, 2 * Math.PI);
                context.stroke();
            }
        }
    }

    // What the rings mean, over all that is drawn, with a rim so that it can be read there.
    nameRings(context, scale, most, unit) {
        context.fillStyle = colourOf("ink");
        context.strokeStyle = colourOf("paper");
        context.lineWidth = 3;
        context.textAlign = "left";
        context.textBaseline = "bottom";
        for (const tick of findTicks(0, most, 3).ticks) {
            if (tick > 0) {
                const words = `${formatNumber(tick)} ${unit}`;
                const [x, y] = [this.middle + 4, this.middle - tick * scale - 2];
                context.strokeText(words, x, y);
                context.fillText(words, x, y);
            }
        }
    }
}

// The path of a pin's centre in its hole.
class OrbitPlot extends RoundPlot {
    constructor(page, signals) {
        const { joint, run } = signals;
        super(
            page,
            `Pin in its hole: ${joint.name}, ${run.backend}`,
            "The circle is how far the pin's centre can go before it touches. Colour: force.",
            run.backend,
        );
        this.signals = signals;
        this.note.append(this.makeScale());
        this.fit();
        const force = (of, i) => of.force[i] || 0;
        this.addTable(["x, um", "y, um", "force, N"], [signals], force, (of, i) => [
            ...of.offset(i).map((value) => 1e6 * value),
            force(of, i),
        ]);
    }

    // Finds how far the path goes and how large the force is.
    fit() {
        const { signals } = this;
        const { ex_m: x, ey_m: y } = signals.instants;
        this.reach = signals.joint.clearance_m;
        this.most = 0;
        const [first, last] = signals.within(this.page.fitted());
        for (let i = first; i <= last; i++) {
            this.reach = Math.max(this.reach, Math.hypot(x[i], y[i]));
            this.most = Math.max(this.most, signals.force[i] || 0);
        }
        const unit = signals.joint.is_torsional ? "N m" : "N";
        this.largest.textContent = ` ${formatNumber(this.most)} ${unit}`;
    }

    // A bar with the colours and the largest force.
    makeScale() {
        this.bar = element("canvas", { className: "bar" });
        this.bar.setAttribute("aria-hidden", "true");
        this.largest = element("span", {});
        return element("span", { className: "key" }, "0 ", this.bar, this.largest);
    }

    drawBar() {
        const context = prepareCanvas(this.bar, 120, 10);
        for (let i = 0; i < ROUND_BINS; i++) {
            context.fillStyle = heatColour(i / (ROUND_BINS - 1));
            context.fillRect((120 * i) / ROUND_BINS, 0, 120 / ROUND_BINS + 1, 10);
        }
    }

    place([x, y]) {
        return [this.middle + x * this.scale, this.middle - y * this.scale];
    }

    draw() {
        this.begin();
        this.fit();
        this.drawBar();
        const { signals, context } = this;
        this.scale = (0.44 * this.size) / this.reach;
        this.drawRings(context, this.scale * 1e-6, this.reach * 1e6);
        context.strokeStyle = colourOf("frame");
        context.lineWidth = 1.5;
        context.beginPath();
        context.arc(
            this.middle,
            this.middle,
            signals.joint.clearance_m * this.scale,
            0,
            2 * Math.PI,
        );
        context.stroke();
        this.drawPath(context);
        this.nameRings(context, this.scale * 1e-6, this.reach * 1e6, "um");
        this.showTime();
    }

    // Pieces of one colour are one path each: a browser draws few paths fast. A piece has the
    // colour of its stronger end.
    drawPath(context) {
        const { signals } = this;
        const [first, last] = signals.within(this.page.view);
        const paths = Array.from({ length: ROUND_BINS }, () => new Path2D());
        let before = this.place(signals.offset(Math.min(first, last)));
        for (let i = first + 1; i <= last; i++) {
            const after = this.place(signals.offset(i));
            const force = Math.max(signals.force[i - 1] || 0, signals.force[i] || 0);
            const share = this.most > 0 ? force / this.most : 0;
            const bin = Math.max(0, Math.min(ROUND_BINS - 1, Math.floor(share * ROUND_BINS)));
            paths[bin].moveTo(before[0], before[1]);
            paths[bin].lineTo(after[0], after[1]);
            before = after;
        }
        context.lineWidth = 1.8;
        context.lineCap = "round";
        paths.forEach((path, i) => {
            context.strokeStyle = heatColour(i / (ROUND_BINS - 1));
            context.stroke(path);
        });
    }

    showTime() {
        const context = prepareCanvas(this.overlay, this.size, this.size);
        const [x, y] = this.place(this.signals.offsetAt(this.page.time));
        context.beginPath();
        context.arc(x, y, 5, 0, 2 * Math.PI);
        context.fillStyle = colourOf("cursor");
        context.fill();
        context.strokeStyle = colourOf("paper");
        context.stroke();
    }
}

// The load of a pin on its hole by direction, of every run.
class LoadPlot extends RoundPlot {
    constructor(page, all) {
        const { joint } = all[0];
        super(
            page,
            `Load of the pin: ${joint.name}`,
            "Force of the pin on its hole, by direction in the axes of the hole's body.",
            null,
        );
        this.all = all;
        for (const signals of all) {
            this.note.append(
                element(
                    "span",
                    { className: "key" },
                    element("span", { className: "swatch " + signals.run.backend }),
                    signals.run.backend,
                ),
            );
        }
        const size = (of, i) => of.loadSize(i);
        this.addTable(["force in x, N", "in y, N"], all, size, (of, i) => of.load(i));
    }

    // Finds how large the load is.
    fit() {
        this.most = 0;
        for (const signals of this.all) {
            const [first, last] = signals.within(this.page.fitted());
            for (let i = first; i <= last; i++) {
                const size = signals.loadSize(i);
                this.most = size > this.most ? size : this.most;
            }
        }
    }

    shownSignals() {
        return this.all.filter((signals) => this.page.shown.has(signals.run.backend));
    }

    draw() {
        this.begin();
        this.fit();
        const { context } = this;
        this.scale = (0.44 * this.size) / (this.most || 1);
        this.drawRings(context, this.scale, this.most);
        for (const signals of this.shownSignals()) {
            const [first, last] = signals.within(this.page.view);
            context.beginPath();
            for (let i = first; i <= last; i++) {
                const [x, y] = signals.load(i);
                context.lineTo(this.middle + x * this.scale, this.middle - y * this.scale);
            }
            context.strokeStyle = colourOf(signals.run.backend);
            context.lineWidth = signals.run.is_truth ? 2 : 1.2;
            context.lineJoin = "round";
            context.stroke();
        }
        this.nameRings(context, this.scale, this.most, "N");
        this.showTime();
    }

    showTime() {
        const context = prepareCanvas(this.overlay, this.size, this.size);
        for (const signals of this.shownSignals()) {
            const [x, y] = signals.loadAt(this.page.time);
            context.beginPath();
            context.moveTo(this.middle, this.middle);
            context.lineTo(this.middle + x * this.scale, this.middle - y * this.scale);
            context.strokeStyle = colourOf("cursor");
            context.lineWidth = 2;
            context.stroke();
        }
    }
}

// Where on the wall of its hole a pin wears: the share of each sector of force times sliding
// distance, of the run that is the truth, or the last.
class WearPlot extends RoundPlot {
    constructor(page, joint, run, wear) {
        super(
            page,
            `Where the hole wears: ${joint.name}, ${run.backend}`,
            "Share of all wear (force times sliding distance) in each 15 deg of the wall, in the " +
                "axes of the hole's body.",
            run.backend,
        );
        this.overlay.remove(); // it is of the whole run, and has no cursor
        this.sectors = wear.sectors;
        this.most = Math.max(...wear.sectors);
        const rows = () => ({
            rows: wear.sectors.map((share, i) => [
                `${15 * i} to ${15 * (i + 1)}`,
                formatNumber(100 * share),
            ]),
            more: 0,
        });
        this.figure.append(valuesTable(["wall, deg", "share, %"], rows));
    }

    draw() {
        this.begin();
        const { context, middle } = this;
        const width = (2 * Math.PI) / this.sectors.length;
        const wall = 0.26 * this.size;
        const scale = (0.18 * this.size) / (100 * this.most || 1);
        context.strokeStyle = colourOf("grid");
        context.lineWidth = 1;
        const rings = findTicks(0, 100 * this.most, 3).ticks.filter((tick) => tick > 0);
        for (const tick of rings) {
            context.beginPath();
            context.arc(middle, middle, wall + tick * scale, 0, 2 * Math.PI);
            context.stroke();
        }
        context.fillStyle = colourOf(this.backend);
        this.sectors.forEach((share, i) => {
            const reach = wall + 100 * share * scale;
            context.beginPath();
            context.arc(middle, middle, reach, -i * width, -(i + 1) * width, true);
            context.arc(middle, middle, wall, -(i + 1) * width, -i * width);
            context.closePath();
            context.fill();
        });
        context.strokeStyle = colourOf("frame");
        context.lineWidth = 1.5;
        context.beginPath();
        context.arc(middle, middle, wall, 0, 2 * Math.PI);
        context.stroke();
        context.fillStyle = colourOf("ink");
        context.strokeStyle = colourOf("paper");
        context.lineWidth = 3;
        context.textAlign = "left";
        context.textBaseline = "bottom";
        for (const tick of rings) {
            const [x, y] = [middle + 4, middle - wall - tick * scale - 2];
            context.strokeText(`${formatNumber(tick)} %`, x, y);
            context.fillText(`${formatNumber(tick)} %`, x, y);
        }
    }

    showTime() {}
}
