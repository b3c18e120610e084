// The joints of a page, the worst first: of those with play force, penetration, path and load, and
// the spikes; of the others what they bear.

const SPIKES_SHOWN = 12;
const ITEMS_PRINTED = 12; // of a large mechanism, of each kind
const IDEALS_SHOWN = 6; // whose plots are all shown; of more one is chosen

// Something of which one of several is shown, by a choice; printed, all of them. `make` returns the
// elements of one, whose plots it has given to the page.
class Chooser {
    constructor(page, words, items, make) {
        this.page = page;
        this.items = items;
        this.make = make;
        this.chosen = items[0][0];
        this.isPrintedWhole = true;
        this.body = element("div", {});
        this.element = element("div", {});
        if (items.length > 1) {
            const choice = page.choice(words, items, this.chosen, (value) => this.show(value));
            this.element.append(element("div", { className: "controls" }, choice));
        }
        this.element.append(this.body);
        this.fill([this.chosen]);
        page.choosers.push(this);
    }

    fill(values) {
        const { page } = this;
        page.plots = page.plots.filter((plot) => !this.body.contains(plot.figure));
        this.body.replaceChildren(...values.flatMap((value) => this.make(value)));
    }

    show(value) {
        this.chosen = value;
        this.fill([value]);
        this.page.watch();
    }

    showAll() {
        const all = this.items.slice(0, ITEMS_PRINTED).map(([value]) => value);
        this.fill(this.isPrintedWhole ? all : [this.chosen]);
    }
}

class Joints {
    constructor(page) {
        this.page = page;
        this.data = page.data;
        this.order = this.data.joints
            .map((joint, i) => i)
            .filter((i) => this.data.runs.some((run) => findSignal(run, "joint", i, "force")))
            .sort((a, b) => this.largest(b) - this.largest(a));
    }

    // The largest force of a joint, of the run that is the truth, or of all; torques come last.
    largest(number) {
        const { runs, joints } = this.data;
        const truth = runs.filter((run) => run.is_truth);
        const values = (truth.length > 0 ? truth : runs).flatMap((run) =>
            findPeaks(run, "joint", number, "force").map((peak) => peak.value),
        );
        return Math.max(0, ...values) * (joints[number].is_torsional ? 1e-9 : 1);
    }

    isFelt(number) {
        return this.data.joints[number].has_play;
    }

    units(number) {
        return this.data.joints[number].is_torsional
            ? { force: "torque", unit: "N m", depth: "mrad", factor: 1e3 }
            : { force: "force", unit: "N", depth: "um", factor: 1e6 };
    }

    forcePlot(number) {
        const { page } = this;
        const { force, unit } = this.units(number);
        const lines = page.lines("joint", number, "force", 1, { most: "force_max" });
        return new TimePlot(page, `${this.data.joints[number].name}: ${force}, ${unit}`, lines, {
            isSpiky: true,
            hasZero: true,
            marks: this.isFelt(number) ? page.marks("joint", number, "force", 1) : [],
        });
    }

    depthPlot(number) {
        const { page } = this;
        const { depth, factor } = this.units(number);
        const lines = page
            .lines("joint", number, "gap", -factor, { least: "gap_min" })
            .filter((line) => line !== null);
        for (const line of lines) {
            line.y = line.y.map((value) => Math.max(0, value));
        }
        const title = `${this.data.joints[number].name}: penetration, ${depth}`;
        return new TimePlot(page, title, lines, { hasZero: true });
    }

    differencePlot(number) {
        const { page } = this;
        const { force, unit } = this.units(number);
        return new TimePlot(
            page,
            `${this.data.joints[number].name}: ${force} less that of the reference, ${unit}`,
            page.lines("joint", number, "force_difference", 1),
            { isSpiky: true },
        );
    }

    // The path of a pin in its hole, of each run, and its load by direction, of all.
    roundPlots(number) {
        const { page } = this;
        const joint = this.data.joints[number];
        if (!this.data.has_plane || joint.is_torsional) {
            return [];
        }
        const all = this.data.runs.map((run) => new JointSignals(this.data, run, number));
        const paths = joint.touches === "hole" ? all.filter((one) => one.hasPath) : [];
        const loads = all.filter((one) => one.hasLoad);
        return [
            ...paths.flatMap((one) => page.addPlot(new OrbitPlot(page, one))),
            ...(joint.pivots && loads.length > 0 ? page.addPlot(new LoadPlot(page, loads)) : []),
            ...this.wearPlot(number),
        ];
    }

    wearPlot(number) {
        const joint = this.data.joints[number];
        const { runs } = this.data;
        const wearOf = (run) => {
            const result = this.data.results.runs.find((one) => one.backend === run.backend);
            return result && result.joints[joint.name] ? result.joints[joint.name].wear : undefined;
        };
        const worn = runs.filter((run) => wearOf(run) !== undefined);
        const run = worn.find((one) => one.is_truth) || worn[worn.length - 1];
        return run === undefined
            ? []
            : this.page.addPlot(new WearPlot(this.page, joint, run, wearOf(run)));
    }

    // All of a joint with play, under its name where there are several.
    feltParts(number) {
        const { page } = this;
        const plots = [this.forcePlot(number), this.depthPlot(number), this.differencePlot(number)];
        const figures = plots.flatMap((plot) => page.addPlot(plot));
        const round = this.roundPlots(number);
        return [
            element("div", { className: "plots" }, ...figures),
            ...(round.length > 0 ? [element("div", { className: "plots" }, ...round)] : []),
            ...this.data.runs.flatMap((run) => this.spikeTable(run, number)),
        ];
    }

    // The spikes of a joint, the strongest first; a contact that is a spike of the force, too,
    // stands there once.
    spikesOf(run, number) {
        const own = run.spikes.filter((spike) => spike.joint === number);
        const contacts = own.filter((spike) => spike.kind === "contact");
        const isBoth = (spike) =>
            contacts.some((contact) => Math.abs(contact.peak_s - spike.peak_s) < 1e-9);
        return own
            .filter((spike) => spike.kind === "contact" || !isBoth(spike))
            .sort((a, b) => b.force - a.force)
            .slice(0, SPIKES_SHOWN);
    }

    // A click on one zooms to it.
    spikeRow(spike) {
        const { page } = this;
        const cell = (...words) => element("td", {}, ...words);
        const crank = () => (((page.degrees(spike.peak_s) % 360) + 360) % 360).toFixed(1);
        return element(
            "tr",
            {},
            cell(page.button("Zoom", () => page.zoomTo(spike))),
            cell(spike.kind === "spike" ? "spike of the force" : "contact"),
            ...(this.data.crank === null ? [] : [cell(crank())]),
            cell((1000 * spike.peak_s).toPrecision(6)),
            cell(formatNumber(spike.force)),
            cell(formatNumber(1e6 * (spike.end_s - spike.onset_s))),
            cell(formatNumber(spike.impulse)),
        );
    }

    spikeTable(run, number) {
        const { name } = this.data.joints[number];
        const { unit } = this.units(number);
        const rows = this.spikesOf(run, number).map((spike) => this.spikeRow(spike));
        if (rows.length === 0) {
            return [];
        }
        const heads = [
            "go to",
            "what",
            ...(this.data.crank === null ? [] : ["crank, deg"]),
            "peak at, ms",
            `largest, ${unit}`,
            "lasts, us",
            `impulse, ${unit} s`,
        ];
        const head = heads.map((words) => element("th", { scope: "col" }, words));
        const table = element(
            "table",
            { className: "numbers spikes" },
            element("caption", {}, `Strongest spikes and contacts of ${name}, ${run.backend}`),
            element("thead", {}, element("tr", {}, ...head)),
            element("tbody", {}, ...rows),
        );
        return [
            element(
                "details",
                { open: run.is_truth },
                element("summary", {}, `Spikes of ${name}, ${run.backend}: ${rows.length}`),
                element("div", { className: "wide", tabIndex: 0, role: "group", ariaLabel: "Scrolls sideways" }, table),
            ),
        ];
    }

    names(numbers) {
        return numbers.map((i) => [String(i), this.data.joints[i].name]);
    }

    makeFelt() {
        const numbers = this.order.filter((i) => this.isFelt(i));
        if (numbers.length === 0) {
            return [];
        }
        const make = (value) => this.feltParts(Number(value));
        const chooser = new Chooser(this.page, "Joint", this.names(numbers), make);
        return [this.page.section("Joints with play", chooser.element)];
    }

    // What joints bear, over time and by direction, each on rows of its own.
    idealParts(numbers) {
        const rows = [
            numbers.flatMap((i) => this.page.addPlot(this.forcePlot(i))),
            numbers.flatMap((i) => this.roundPlots(i)),
        ];
        return rows
            .filter((row) => row.length > 0)
            .map((row) => element("div", { className: "plots" }, ...row));
    }

    // What joints without play bear: by it their bearings are sized.
    makeIdeal() {
        const numbers = this.order.filter((i) => !this.isFelt(i) && this.largest(i) > 0);
        if (numbers.length === 0) {
            return [];
        }
        const title = numbers.length < this.order.length ? "Joints without play" : "Joints";
        if (numbers.length <= IDEALS_SHOWN) {
            return [this.page.section(title, ...this.idealParts(numbers))];
        }
        const make = (value) => this.idealParts([Number(value)]);
        const chooser = new Chooser(this.page, "Joint", this.names(numbers), make);
        return [this.page.section(title, chooser.element)];
    }

    // What bushings bear.
    makeBushings() {
        const { page } = this;
        const figures = this.data.bushings.flatMap((bushing, i) => {
            const lines = page.lines("bushing", i, "force", 1);
            const title = `${bushing.name}: force, N`;
            return page.addPlot(new TimePlot(page, title, lines, { isSpiky: true, hasZero: true }));
        });
        return figures.length > 0
            ? [page.section("Bushings", element("div", { className: "plots" }, ...figures))]
            : [];
    }

    make() {
        return [...this.makeFelt(), ...this.makeIdeal(), ...this.makeBushings()];
    }
}
