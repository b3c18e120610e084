// What the motion is like over the revolutions: its spectrum by order, its phase plane, and its
// section, the state once a revolution. The numbers are those of `run --json`.

const PHASE_POINTS = 4000; // of a curve, which does not show more
const RESTING_RAD = 1e-9; // a range of angles that is nothing but rounding
const ROUNDED = 1e-9; // of the largest amplitude: what sums over 16 bits may leave

// Coordinates of a body: signals of the page, keys of the results, and words.
const TURNING = {
    place: "angle_rad",
    rate: "omega_rad_s",
    atPlace: "angle_rad",
    atRate: "omega_rad_s",
    factor: DEG,
    rateWords: "angular velocity",
    rateUnit: "rad/s",
    placeWords: "angle, deg",
    over: "angle",
};
const SLIDING = ["x", "y"].map((axis) => ({
    place: `${axis}_m`,
    rate: `v${axis}_m_s`,
    atPlace: `${axis}_m`,
    atRate: `velocity_${axis}_m_s`,
    factor: 1e3,
    rateWords: `velocity along ${axis}`,
    rateUnit: "m/s",
    placeWords: `${axis} of the centre, mm`,
    over: "position",
}));

class Revolutions {
    constructor(page) {
        this.page = page;
        this.data = page.data;
        this.results = new Map(page.data.results.runs.map((run) => [run.backend, run]));
    }

    // The signals that there are spectra of: a name, and where the amplitudes of a run are.
    spectra() {
        const found = new Map();
        for (const run of this.data.runs) {
            const spectrum = (this.results.get(run.backend) || {}).spectrum;
            if (!spectrum) {
                continue;
            }
            const add = (name, values) => {
                if (!found.has(name)) {
                    found.set(name, []);
                }
                found.get(name).push({ run, orders: spectrum.orders, values });
            };
            for (const [name, body] of Object.entries(spectrum.bodies)) {
                add(`${name}: angular velocity, rad/s`, body.omega_rad_s);
                add(`${name}: angular acceleration, rad/s^2`, body.alpha_rad_s2);
                add(`${name}: velocity along x, m/s`, body.velocity_x_m_s);
                add(`${name}: velocity along y, m/s`, body.velocity_y_m_s);
            }
            for (const [name, joint] of Object.entries(spectrum.joints)) {
                const key = joint.force_N ? "force_N" : "torque_N_m";
                add(`${name}: ${joint.force_N ? "force, N" : "torque, N m"}`, joint[key]);
            }
            if (spectrum.drive_torque_N_m) {
                add("drive: torque, N m", spectrum.drive_torque_N_m);
            }
        }
        // what is nothing but rounding, beside the largest in its unit, is not offered
        const largest = (runs) => Math.max(...runs.flatMap(({ values }) => values.map(Math.abs)));
        const unitOf = (title) => title.split(", ").pop();
        const most = new Map();
        for (const [title, runs] of found) {
            most.set(unitOf(title), Math.max(most.get(unitOf(title)) || 0, largest(runs)));
        }
        return [...found].filter(
            ([title, runs]) => largest(runs) > Math.max(1e-9, ROUNDED * most.get(unitOf(title))),
        );
    }

    spectrumPlot([title, runs]) {
        const series = runs.map(({ run, orders, values }) => ({
            name: run.backend,
            backend: run.backend,
            kind: "stem",
            x: orders,
            y: values.map(Math.abs),
        }));
        return new XYPlot(this.page, title, series, {
            xTitle: "order: times the speed of the drive",
            offersLog: true,
            words: "Amplitude at each order; order 0 is the mean.",
        });
    }

    // The coordinate that a body moves by, in signals, results and words: its angle, or of one that
    // does not turn the axis along which it goes farthest. Null where it rests.
    coordinateOf(body) {
        if (this.page.isTurning(body)) {
            return this.page.spread(body, "angle_rad") > RESTING_RAD ? TURNING : null;
        }
        const [x, y] = SLIDING.map((one) => this.page.spread(body, one.place));
        const isAtRest = Math.max(x, y) <= this.page.restingWay;
        return isAtRest ? null : SLIDING[y > x ? 1 : 0];
    }

    // Place and velocity of a body, which a motion that repeats runs through again and again.
    phasePlot(body) {
        const { bodies, runs } = this.data;
        const coordinate = this.coordinateOf(body);
        const { place, rate, factor } = coordinate;
        const series = [];
        for (const run of runs) {
            const x = findSignal(run, "body", body, place);
            const y = findSignal(run, "body", body, rate);
            if (x === null || y === null) {
                continue;
            }
            const stride = Math.max(1, Math.ceil(x.length / PHASE_POINTS));
            const first = Math.ceil((this.page.counted.from - run.from_s) / run.interval_s - 1e-6);
            const isKept = (_, i) => i >= first && i % stride === 0;
            const pick = (values, by) => values.filter(isKept).map((value) => value * by);
            series.push({
                name: run.backend,
                backend: run.backend,
                kind: "line",
                x: pick(x, factor),
                y: pick(y, 1),
                signals: { run, x, y },
            });
        }
        const dots = this.sectionDots(body, coordinate);
        series.push(...dots);
        if (series.length === 0) {
            return null;
        }
        const title = `${bodies[body].name}: ${coordinate.rateWords} over ${coordinate.over}`;
        return new XYPlot(this.page, `${title}, ${coordinate.rateUnit}`, series, {
            xTitle: coordinate.placeWords,
            words: dots.length > 0 ? "Dots: once a revolution." : "",
            at: ({ signals }, time) =>
                signals
                    ? [
                          factor * valueAt(signals.run, signals.x, time),
                          valueAt(signals.run, signals.y, time),
                      ]
                    : null,
        });
    }

    sections(run, body) {
        const section = (this.results.get(run.backend) || {}).section;
        return section ? section.bodies[this.data.bodies[body].name] || null : null;
    }

    sectionDots(body, { atPlace, atRate, factor }) {
        return this.data.runs.flatMap((run) => {
            const of = this.sections(run, body);
            if (of === null) {
                return [];
            }
            return [
                {
                    name: run.backend,
                    backend: run.backend,
                    kind: "dots",
                    x: of[atPlace].map((value) => value * factor),
                    y: of[atRate],
                },
            ];
        });
    }

    // The state at one crank angle over the number of the revolution.
    sectionPlot(body) {
        const { atRate, rateWords, rateUnit } = this.coordinateOf(body);
        const series = this.data.runs.flatMap((run) => {
            const of = this.sections(run, body);
            return of === null || of[atRate].length < 3
                ? []
                : [
                      {
                          name: run.backend,
                          backend: run.backend,
                          kind: "dots",
                          x: of[atRate].map((_, i) => i),
                          y: of[atRate],
                      },
                  ];
        });
        return series.length === 0
            ? null
            : new XYPlot(
                  this.page,
                  `${this.data.bodies[body].name}: ${rateWords} once a revolution, ${rateUnit}`,
                  series,
                  { xTitle: "revolution", words: "A motion that repeats comes to few values." },
              );
    }

    make() {
        const spectra = this.spectra();
        const moving = this.data.bodies
            .map((body, i) => i)
            .filter((i) => !this.data.bodies[i].is_driven && this.coordinateOf(i) !== null);
        const grid = (...plots) => {
            const shown = plots.filter((plot) => plot !== null);
            return element(
                "div",
                { className: "plots" },
                ...shown.flatMap((plot) => this.page.addPlot(plot)),
            );
        };
        const parts = [];
        if (moving.length > 0) {
            const names = moving.map((i) => [String(i), this.data.bodies[i].name]);
            const make = (body) => [
                grid(this.phasePlot(Number(body)), this.sectionPlot(Number(body))),
            ];
            parts.push(new Chooser(this.page, "Body", names, make).element);
        } else {
            parts.push(element("p", {}, "No body moves but those that are driven."));
        }
        if (spectra.length > 0) {
            const names = spectra.map(([name], i) => [String(i), name]);
            const make = (i) => [grid(this.spectrumPlot(spectra[Number(i)]))];
            const chooser = new Chooser(this.page, "Spectrum of", names, make);
            chooser.isPrintedWhole = false;
            parts.push(chooser.element);
        }
        const hasTurns = [...this.results.values()].some((run) => run.section || run.spectrum);
        return [this.page.section(hasTurns ? "Over the revolutions" : "Phase plane", ...parts)];
    }
}
