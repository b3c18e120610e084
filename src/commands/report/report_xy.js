// Plots whose x axis is no time: amplitudes by order, the phase plane of a body, and its state once
// a revolution. Each has a hidden table with what it shows.

const XY_HEIGHT = 240;

class XYPlot {
    // A series: {name, backend, x, y, kind: "stem" | "line" | "dots"}. Of the options `xTitle` and
    // `yTitle` have the units, `isLog` is the axis of values at first, `offersLog` a switch for it,
    // `at(series, time)` gives the point of a time, and `words` what is said below.
    constructor(page, title, series, options) {
        this.page = page;
        this.title = title;
        this.series = series;
        this.options = options;
        this.isLog = options.isLog === true;
        this.canvas = element("canvas", { tabIndex: 0, className: "plot xy" });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute("aria-label", this.describe());
        this.canvas.addEventListener("keydown", (event) => page.onKey(event));
        const frame = element("div", { className: "frame" }, this.canvas);
        if (options.at) {
            this.overlay = element("canvas", { className: "plot xy overlay" });
            this.overlay.setAttribute("aria-hidden", "true");
            frame.append(this.overlay);
        }
        const caption = element("figcaption", {}, title);
        if (options.offersLog) {
            caption.append(this.makeLogSwitch());
        }
        this.figure = element(
            "figure",
            {},
            caption,
            frame,
            this.makeLegend(),
            this.makeTable(),
        );
    }

    makeLogSwitch() {
        const box = element("input", { type: "checkbox", checked: this.isLog });
        box.addEventListener("change", () => {
            this.isLog = box.checked;
            this.draw();
        });
        return element("label", { className: "switch" }, box, " log");
    }

    makeLegend() {
        const names = new Map(this.series.map((one) => [one.name, one.backend]));
        const keys = [...names].map(([name, backend]) =>
            element(
                "span",
                { className: "key" },
                element("span", { className: "swatch " + backend }),
                name,
            ),
        );
        return element("div", { className: "legend" }, ...keys, this.options.words || "");
    }

    makeTable() {
        return valuesTable(["run", this.options.xTitle, this.title], () => {
            const most = Math.floor(TABLE_ROWS / Math.max(1, this.series.length));
            const rows = this.series.flatMap((one) => {
                const numbers =
                    one.kind === "line" ? thinned(one.y, most) : Array.from(one.y.keys());
                const cells = (i) => [one.name, formatNumber(one.x[i]), formatNumber(one.y[i])];
                return numbers.map(cells);
            });
            const all = this.series.reduce((count, one) => count + one.y.length, 0);
            const shown = rows.slice(0, TABLE_ROWS);
            return { rows: shown, more: all - shown.length };
        });
    }

    describe() {
        const parts = this.series.map((one) => {
            const [low, high] = limitsOf(one.y);
            return `${one.name} from ${formatNumber(low)} to ${formatNumber(high)}`;
        });
        return `${this.title} over ${this.options.xTitle}: ${parts.join("; ")}`;
    }

    visible() {
        return this.series.filter((one) => this.page.shown.has(one.backend));
    }

    // Fits both axes to what is seen.
    fit() {
        const [left, right] = limitsOf(...this.visible().map((one) => one.x));
        let [low, high] = limitsOf(...this.visible().map((one) => one.y));
        const isStem = this.series.some((one) => one.kind === "stem");
        if (isStem && !this.isLog) {
            [low, high] = [Math.min(0, low), Math.max(0, high)];
        }
        if (this.isLog) {
            // six decades are enough: below is rounding
            high = Math.max(Math.abs(low), high) || 1;
            low = 1e-6 * high;
        }
        const spread = (from, to) => {
            const least = 1e-9 * Math.max(Math.abs(from), Math.abs(to)) || 1;
            const margin = to - from > least ? 0.05 * (to - from) : Math.max(least, 0.05);
            return [from - margin, to + margin];
        };
        [this.left, this.right] = spread(left, right);
        [this.bottom, this.top] = spread(this.scale(low), this.scale(high));
    }

    scale(value) {
        return this.isLog ? Math.log10(Math.max(Math.abs(value), 1e-300)) : value;
    }

    toX(x) {
        return PLOT_LEFT + ((x - this.left) / (this.right - this.left)) * this.width;
    }

    toY(y) {
        return PLOT_TOP + ((this.top - this.scale(y)) / (this.top - this.bottom)) * this.height;
    }

    drawGrid(context, ticks, toLine, toWords) {
        for (const tick of ticks) {
            context.strokeStyle = colourOf(tick === 0 ? "zero" : "grid");
            context.beginPath();
            toLine(tick);
            context.stroke();
            toWords(tick);
        }
    }

    drawAxes(context) {
        const bottom = PLOT_TOP + this.height;
        context.lineWidth = 1;
        context.fillStyle = colourOf("ink");
        context.textAlign = "center";
        context.textBaseline = "top";
        const across = findTicks(this.left, this.right, Math.max(3, this.width / 70));
        this.drawGrid(
            context,
            across.ticks,
            (tick) => {
                const x = Math.round(this.toX(tick)) + 0.5;
                context.moveTo(x, PLOT_TOP);
                context.lineTo(x, bottom);
            },
            (tick) =>
                context.fillText(formatTick(tick, across.decimals), this.toX(tick), bottom + 5),
        );
        context.textAlign = "right";
        context.textBaseline = "middle";
        const up = this.isLog
            ? { ticks: decadesBetween(this.bottom, this.top), decimals: 0 }
            : findTicks(this.bottom, this.top, Math.max(3, this.height / 40));
        this.drawGrid(
            context,
            up.ticks,
            (tick) => {
                const y = Math.round(this.toY(tick)) + 0.5;
                context.moveTo(PLOT_LEFT, y);
                context.lineTo(PLOT_LEFT + this.width, y);
            },
            (tick) => {
                const words = this.isLog ? formatNumber(tick) : formatTick(tick, up.decimals);
                context.fillText(words, PLOT_LEFT - 6, this.toY(tick));
            },
        );
        context.strokeStyle = colourOf("frame");
        context.strokeRect(PLOT_LEFT + 0.5, PLOT_TOP + 0.5, this.width - 1, this.height - 1);
    }

    drawSeries(context, one, number, count) {
        context.strokeStyle = colourOf(one.backend);
        context.fillStyle = colourOf(one.backend);
        context.lineWidth = one.kind === "stem" ? 3 : one.backend === "analytic" ? 3 : 1.4;
        if (one.kind === "line") {
            context.lineJoin = "round";
            context.beginPath();
            for (let i = 0; i < one.x.length; i++) {
                context.lineTo(this.toX(one.x[i]), this.toY(one.y[i]));
            }
            context.stroke();
            return;
        }
        // the stems of several runs stand side by side
        const shift = one.kind === "stem" ? 4 * (number - (count - 1) / 2) : 0;
        const base = this.isLog ? PLOT_TOP + this.height : this.toY(0);
        for (let i = 0; i < one.x.length; i++) {
            const [x, y] = [this.toX(one.x[i]) + shift, this.toY(one.y[i])];
            context.beginPath();
            if (one.kind === "stem") {
                context.moveTo(x, base);
                context.lineTo(x, y);
                context.stroke();
            } else {
                context.arc(x, y, one.backend === "reference" ? 3.5 : 2.5, 0, 2 * Math.PI);
                context.fill();
            }
        }
    }

    draw() {
        const width = this.canvas.clientWidth;
        if (width === 0) {
            return;
        }
        this.width = width - PLOT_LEFT - PLOT_RIGHT;
        this.height = XY_HEIGHT - PLOT_TOP - PLOT_BOTTOM;
        const context = prepareCanvas(this.canvas, width, XY_HEIGHT);
        this.fit();
        this.drawAxes(context);
        context.save();
        context.beginPath();
        context.rect(PLOT_LEFT, PLOT_TOP, this.width, this.height);
        context.clip();
        const shown = this.visible();
        shown.forEach((one, i) => this.drawSeries(context, one, i, shown.length));
        context.restore();
        context.fillStyle = colourOf("soft");
        context.textAlign = "right";
        context.textBaseline = "bottom";
        context.fillText(this.options.xTitle, PLOT_LEFT + this.width, XY_HEIGHT);
        this.showTime();
    }

    // Where each run is at the time of the cursor.
    showTime() {
        if (!this.options.at || this.width === undefined) {
            return;
        }
        const context = prepareCanvas(this.overlay, this.canvas.clientWidth, XY_HEIGHT);
        for (const one of this.visible()) {
            const point = this.options.at(one, this.page.time);
            if (point !== null) {
                context.beginPath();
                context.arc(this.toX(point[0]), this.toY(point[1]), 5, 0, 2 * Math.PI);
                context.fillStyle = colourOf("cursor");
                context.fill();
                context.strokeStyle = colourOf("paper");
                context.stroke();
            }
        }
    }
}

function limitsOf(...lists) {
    let [low, high] = [Infinity, -Infinity];
    for (const list of lists) {
        for (const value of list) {
            if (Number.isFinite(value)) {
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        }
    }
    return low <= high ? [low, high] : [0, 1];
}

// The powers of ten between two logarithms.
function decadesBetween(bottom, top) {
    const ticks = [];
    for (let power = Math.ceil(bottom); power <= top; power++) {
        ticks.push(10 ** power);
    }
    return ticks;
}
