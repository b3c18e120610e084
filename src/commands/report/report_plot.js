// A plot of lines over time or the crank angle, on a canvas. Own code and no library: the lines
// carry their peaks in columns of pixels, all plots share one range and one cursor, and the same
// colours serve the round plots and the mechanism.

const PLOT_HEIGHT = 220;
const PLOT_LEFT = 58;
const PLOT_RIGHT = 16;
const PLOT_TOP = 8;
const PLOT_BOTTOM = 30;

function element(tag, properties, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(properties || {})) {
        if (name in made) {
            made[name] = value;
        } else {
            made.setAttribute(name, value);
        }
    }
    made.append(...children);
    return made;
}

// A colour of the style sheet, as it is in light or dark; asked for once until that changes.
const COLOURS = new Map();

function colourOf(name) {
    if (!COLOURS.has(name)) {
        const style = getComputedStyle(document.documentElement);
        COLOURS.set(name, style.getPropertyValue("--" + name).trim());
    }
    return COLOURS.get(name);
}

// A short piece of a line, in the colour of a backend and with the dashes of the line.
function swatchOf(backend, dash) {
    const swatch = element("span", { className: "swatch " + backend });
    const [on, off] = dash || [];
    if (on !== undefined) {
        const ends = `#000 0 ${on}px, transparent ${on}px ${on + off}px`;
        swatch.style.maskImage = `repeating-linear-gradient(90deg, ${ends})`;
        swatch.style.width = "25px";
    }
    return swatch;
}

const TABLE_ROWS = 60; // of a plot's table, at most

// The numbers of a plot, for those who do not see it and those who want them: a table that is made
// when it is opened. `makeRows` returns its rows; what there is more of is in the data.
function valuesTable(heads, makeRows) {
    const cells = (row, tag) => element("tr", {}, ...row.map((cell) => element(tag, {}, cell)));
    const details = element(
        "details",
        { className: "values" },
        element("summary", {}, "Values"),
    );
    details.addEventListener(
        "toggle",
        () => {
            const { rows, more } = makeRows();
            const head = element("thead", {}, cells(heads, "th"));
            const body = element("tbody", {}, ...rows.map((row) => cells(row, "td")));
            const table = element("table", {}, head, body);
            details.append(element("div", { className: "wide", tabIndex: 0, role: "group", ariaLabel: "Scrolls" }, table));
            details.append(more > 0 ? `${more} more are in the data.` : "");
        },
        { once: true },
    );
    return details;
}

// Of so many values the numbers of the first, the last, and the least and the largest of equal
// parts between, at most `most`, so that no peak is lost.
function thinned(values, most) {
    const last = values.length - 1;
    const parts = Math.max(1, Math.floor((most - 2) / 2));
    const kept = new Set([0, last]);
    for (let part = 0; part < parts; part++) {
        const first = Math.floor((part * values.length) / parts);
        const end = Math.floor(((part + 1) * values.length) / parts);
        let [low, high] = [first, first];
        for (let i = first; i < end; i++) {
            low = values[i] < values[low] ? i : low;
            high = values[i] > values[high] ? i : high;
        }
        if (first < end) {
            kept.add(low).add(high);
        }
    }
    return [...kept].sort((a, b) => a - b);
}

// Makes a canvas as sharp as the screen; returns its context, in CSS pixels.
function prepareCanvas(canvas, width, height) {
    const ratio = window.devicePixelRatio || 1;
    if (
        canvas.width !== Math.round(width * ratio) ||
        canvas.height !== Math.round(height * ratio)
    ) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = "12px system-ui, sans-serif";
    return context;
}

class TimePlot {
    // `lines` as of makeLine; `title` has the unit. Of the options `isSpiky` offers a logarithmic
    // axis, `hasZero` keeps zero in sight, `least` is the shortest axis, `marks` are those of
    // spikes.
    constructor(page, title, lines, options) {
        this.page = page;
        this.title = title;
        this.lines = lines.filter((line) => line !== null);
        this.options = options || {};
        this.isLog = false;
        this.canvas = element("canvas", { tabIndex: 0, className: "plot" });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute("aria-label", this.describe());
        this.cursor = element("div", { className: "cursor" });
        this.drag = element("div", { className: "drag", hidden: true });
        this.legend = element("div", { className: "legend" });
        const caption = element("figcaption", {}, title);
        if (this.options.isSpiky) {
            caption.append(this.makeLogSwitch());
        }
        const frame = element("div", { className: "frame" }, this.canvas, this.cursor, this.drag);
        this.figure = element("figure", {}, caption, frame, this.legend, this.makeTable());
        this.fillLegend();
        this.listen();
    }

    makeLogSwitch() {
        const box = element("input", { type: "checkbox" });
        box.addEventListener("change", () => {
            this.isLog = box.checked;
            this.draw();
        });
        return element("label", { className: "switch" }, box, " log");
    }

    makeTable() {
        return valuesTable(["run", ...this.page.timeHeads(), this.title], () => {
            const most = Math.floor(TABLE_ROWS / Math.max(1, this.lines.length));
            const rows = this.lines.flatMap((line) =>
                thinned(line.y, most).map((i) => [
                    line.name || line.backend,
                    ...this.page.timeCells(line.x[i]),
                    formatNumber(line.y[i]),
                ]),
            );
            const all = this.lines.reduce((count, line) => count + line.y.length, 0);
            return { rows, more: all - rows.length };
        });
    }

    // What a reader who does not see the plot is told of it.
    describe() {
        const parts = this.lines.map((line) => {
            let low = Infinity;
            let high = -Infinity;
            for (const value of line.y) {
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
            return `${line.name || line.backend} from ${formatNumber(low)} to ${formatNumber(high)}`;
        });
        return `${this.title}: ${parts.join("; ")}`;
    }

    fillLegend() {
        this.readings = this.lines.map((line) => {
            const reading = element("span", { className: "reading" });
            this.legend.append(
                element(
                    "span",
                    { className: "key" },
                    swatchOf(line.backend, line.dash),
                    (line.name || line.backend) + " ",
                    reading,
                ),
            );
            return reading;
        });
    }

    // Where a time stands, pixels, and back.
    toX(time) {
        const { from, to } = this.page.view;
        return PLOT_LEFT + ((time - from) / (to - from)) * this.width;
    }

    toTime(x) {
        const { from, to } = this.page.view;
        return from + ((x - PLOT_LEFT) / this.width) * (to - from);
    }

    // The axis of values: linear, or logarithmic on both sides of zero beyond a threshold.
    scale(value) {
        return this.isLog ? Math.asinh(value / this.threshold) : value;
    }

    toY(value) {
        return PLOT_TOP + ((this.top - this.scale(value)) / (this.top - this.bottom)) * this.height;
    }

    visibleLines() {
        return this.lines.filter((line) => this.page.shown.has(line.backend));
    }

    // Fits the axis to what is seen.
    fit() {
        const { from, to } = this.page.view;
        let low = Infinity;
        let high = -Infinity;
        for (const line of this.visibleLines()) {
            const last = findPoint(line.x, to);
            for (let i = findPoint(line.x, from); i <= last; i++) {
                low = line.y[i] < low ? line.y[i] : low;
                high = line.y[i] > high ? line.y[i] : high;
            }
        }
        if (!(low <= high)) {
            [low, high] = [0, 1];
        }
        if (this.options.hasZero) {
            low = Math.min(low, 0);
        }
        // a range that is nothing but rounding is not spread over the axis
        const spread = (this.options.least || 0) - (high - low);
        if (spread > 0) {
            [low, high] = [low - spread / 2, high + spread / 2];
        }
        const size = Math.max(Math.abs(low), Math.abs(high));
        if (high - low <= 1e-9 * size || high === low) {
            // what does not change, but for rounding, is drawn as a straight line
            const margin = size > 0 ? 0.1 * size : 1;
            [low, high] = [low - margin, high + margin];
        }
        this.threshold = size > 0 ? size / 1000 : 1;
        const [bottom, top] = [this.scale(low), this.scale(high)];
        const margin = 0.06 * (top - bottom);
        this.top = top + margin;
        this.bottom = this.options.hasZero && low === 0 ? bottom : bottom - margin;
        this.low = low;
        this.high = high;
    }

    valueTicks() {
        if (!this.isLog) {
            return findTicks(this.bottom, this.top, Math.max(3, this.height / 40));
        }
        const ticks = [0];
        for (let power = -9; power <= 15; power++) {
            for (const tick of [10 ** power, -(10 ** power)]) {
                if (
                    10 ** power > 2 * this.threshold &&
                    this.scale(tick) <= this.top &&
                    this.scale(tick) >= this.bottom
                ) {
                    ticks.push(tick);
                }
            }
        }
        return { ticks, decimals: 0 };
    }

    drawAxes(context) {
        context.lineWidth = 1;
        context.fillStyle = colourOf("ink");
        context.textBaseline = "middle";
        context.textAlign = "right";
        const values = this.valueTicks();
        for (const tick of values.ticks) {
            const y = Math.round(this.toY(tick)) + 0.5;
            context.strokeStyle = colourOf(tick === 0 ? "zero" : "grid");
            context.beginPath();
            context.moveTo(PLOT_LEFT, y);
            context.lineTo(PLOT_LEFT + this.width, y);
            context.stroke();
            context.fillText(formatTick(tick, values.decimals), PLOT_LEFT - 6, y);
        }
        context.textAlign = "center";
        context.textBaseline = "top";
        const times = this.page.timeTicks(Math.max(3, this.width / 70));
        for (const tick of times) {
            const x = Math.round(this.toX(tick.time)) + 0.5;
            context.strokeStyle = colourOf("grid");
            context.beginPath();
            context.moveTo(x, PLOT_TOP);
            context.lineTo(x, PLOT_TOP + this.height);
            context.stroke();
            context.fillText(tick.words, x, PLOT_TOP + this.height + 5);
        }
        context.strokeStyle = colourOf("frame");
        context.strokeRect(PLOT_LEFT + 0.5, PLOT_TOP + 0.5, this.width - 1, this.height - 1);
    }

    // When the crank is in a band of its angles, in each of the revolutions that are seen.
    bandTimes() {
        const { crank } = this.page.data;
        if (crank === null || !this.options.bands) {
            return [];
        }
        const ends = [this.page.view.from, this.page.view.to].map((t) => this.page.degrees(t));
        const first = Math.floor(Math.min(...ends) / 360);
        const last = Math.floor(Math.max(...ends) / 360);
        const timeOf = (degrees) => (degrees / DEG - crank.start_rad) / crank.speed_rad_s;
        const found = [];
        for (let turn = first; turn <= last && found.length < 400; turn++) {
            for (const band of this.options.bands) {
                const times = band.map((degrees) => timeOf(degrees + 360 * turn));
                found.push(times.sort((a, b) => a - b));
            }
        }
        return found;
    }

    // Shades what is not counted, and what cannot be predicted.
    drawShades(context) {
        const { from, to } = this.page.view;
        const { report_from_s: counted, horizon_s: horizon } = this.page.data;
        const shade = (begin, end, colour, words) => {
            const left = Math.max(PLOT_LEFT, this.toX(begin));
            const right = Math.min(PLOT_LEFT + this.width, this.toX(end));
            if (right > left) {
                context.fillStyle = colourOf(colour);
                context.fillRect(left, PLOT_TOP, right - left, this.height);
                if (right - left > 110) {
                    context.fillStyle = colourOf("soft");
                    context.textAlign = "right";
                    context.textBaseline = "top";
                    context.fillText(words, right - 5, PLOT_TOP + 4);
                }
            }
        };
        for (const [begin, end] of this.bandTimes()) {
            shade(begin, end, "uncounted", "");
        }
        if (counted > from) {
            shade(from, counted, "uncounted", "not counted");
        }
        if (horizon !== null && horizon < to) {
            shade(horizon, to, "beyond", "beyond prediction");
        }
    }

    // A line; where several points share a column of pixels the column has the least and the
    // largest of them.
    drawLine(context, line) {
        const { from, to } = this.page.view;
        const first = Math.max(0, findPoint(line.x, from) - 1);
        const last = Math.min(line.x.length - 1, findPoint(line.x, to) + 1);
        context.strokeStyle = colourOf(line.backend);
        context.lineWidth = line.backend === "analytic" ? 3.5 : line.run.is_truth ? 2.2 : 1.3;
        context.lineJoin = "round";
        context.setLineDash(line.dash || []);
        context.beginPath();
        let column = NaN;
        let low = 0;
        let high = 0;
        let isOpen = false;
        const close = () => {
            if (high - low > 0.5) {
                context.lineTo(column, low);
                context.lineTo(column, high);
            }
        };
        let y = 0;
        for (let i = first; i <= last; i++) {
            if (!Number.isFinite(line.y[i])) {
                isOpen = false;
                continue;
            }
            const x = Math.round(2 * this.toX(line.x[i])) / 2;
            y = this.toY(line.y[i]);
            if (x === column && isOpen) {
                low = Math.min(low, y);
                high = Math.max(high, y);
                continue;
            }
            if (isOpen) {
                close();
                context.lineTo(x, y);
            } else {
                context.moveTo(x, y);
            }
            isOpen = true;
            column = x;
            low = y;
            high = y;
        }
        close();
        context.stroke();
        context.setLineDash([]);
    }

    // The size of the part with the lines, pixels.
    measure() {
        this.width = this.canvas.clientWidth - PLOT_LEFT - PLOT_RIGHT;
        this.height = PLOT_HEIGHT - PLOT_TOP - PLOT_BOTTOM;
    }

    draw() {
        const width = this.canvas.clientWidth;
        if (width === 0) {
            return;
        }
        this.measure();
        const context = prepareCanvas(this.canvas, width, PLOT_HEIGHT);
        this.fit();
        this.drawShades(context);
        this.drawAxes(context);
        context.save();
        context.beginPath();
        context.rect(PLOT_LEFT, PLOT_TOP, this.width, this.height);
        context.clip();
        for (const line of this.visibleLines()) {
            this.drawLine(context, line);
        }
        context.restore();
        this.drawMarks(context);
        context.fillStyle = colourOf("soft");
        context.textAlign = "right";
        context.textBaseline = "bottom";
        context.fillText(this.page.unitWords(), PLOT_LEFT + this.width, PLOT_HEIGHT);
        this.showTime();
    }

    // Triangles above the spikes that are listed.
    drawMarks(context) {
        context.fillStyle = colourOf("ink");
        for (const mark of this.options.marks || []) {
            const x = this.toX(mark.time);
            if (
                this.page.shown.has(mark.backend) &&
                x >= PLOT_LEFT &&
                x <= PLOT_LEFT + this.width
            ) {
                const y = Math.max(PLOT_TOP + 9, this.toY(mark.value) - 3);
                context.beginPath();
                context.moveTo(x, y);
                context.lineTo(x - 4, y - 7);
                context.lineTo(x + 4, y - 7);
                context.fill();
            }
        }
    }

    // The cursor, and the values there.
    showTime() {
        const x = this.toX(this.page.time);
        const isIn = x >= PLOT_LEFT - 1 && x <= PLOT_LEFT + this.width + 1;
        this.cursor.hidden = !isIn;
        this.cursor.style.transform = `translateX(${x}px)`;
        this.lines.forEach((line, i) => {
            const at = findPoint(line.x, this.page.time);
            const next = Math.min(line.x.length - 1, at + 1);
            const width = line.x[next] - line.x[at];
            const share = width > 0 ? Math.min(1, (this.page.time - line.x[at]) / width) : 0;
            this.readings[i].textContent = formatNumber(
                line.y[at] + share * (line.y[next] - line.y[at]),
            );
        });
    }

    listen() {
        const canvas = this.canvas;
        const timeOf = (event) => this.toTime(event.clientX - canvas.getBoundingClientRect().left);
        let start = null;
        canvas.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) {
                return;
            }
            canvas.setPointerCapture(event.pointerId);
            this.measure();
            start = {
                x: event.clientX,
                time: timeOf(event),
                isTouch: event.pointerType === "touch",
            };
            this.page.stop();
        });
        canvas.addEventListener("pointermove", (event) => {
            if (start === null) {
                return;
            }
            if (start.isTouch) {
                this.page.setTime(timeOf(event));
            } else if (Math.abs(event.clientX - start.x) > 4) {
                const left = canvas.getBoundingClientRect().left;
                this.drag.hidden = false;
                this.drag.style.left = Math.min(event.clientX, start.x) - left + "px";
                this.drag.style.width = Math.abs(event.clientX - start.x) + "px";
            }
        });
        canvas.addEventListener("pointerup", (event) => {
            if (start === null) {
                return;
            }
            const end = timeOf(event);
            if (!start.isTouch && Math.abs(event.clientX - start.x) > 4) {
                this.page.zoom(Math.min(start.time, end), Math.max(start.time, end));
            } else {
                this.page.setTime(end);
            }
            this.drag.hidden = true;
            start = null;
        });
        canvas.addEventListener("pointercancel", () => {
            this.drag.hidden = true;
            start = null;
        });
        canvas.addEventListener("dblclick", () => this.page.zoomOut());
        canvas.addEventListener("keydown", (event) => this.page.onKey(event));
    }
}
