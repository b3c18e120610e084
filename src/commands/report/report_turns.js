// What the motion is like over the revolutions: its spectrum by order, its phase plane, and its
// section, the state once a revolution. The numbers are those of `run --json`.

const PHASE_POINTS = 4000; // of a curve, which does not show more

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
        // what is nothing but rounding is not offered
        return [...found].filter(([, runs]) =>
            runs.some(({ values }) => Math.max(...values.map(Math.abs)) > 1e-9),
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

    // Angle and angular velocity of a body, which a motion that repeats runs through again and
    // again; of one that only moves its place and velocity along x.
    phasePlot(body) {
        const { bodies, runs } = this.data;
        const isTurning = this.page.isTurning(body);
        const [place, rate] = isTurning ? ["angle_rad", "omega_rad_s"] : ["x_m", "vx_m_s"];
        const factor = isTurning ? DEG : 1e3;
        const series = [];
        for (const run of runs) {
            const x = findSignal(run, "body", body, place);
            const y = findSignal(run, "body", body, rate);
            if (x === null || y === null) {
                continue;
            }
            const stride = Math.max(1, Math.ceil(x.length / PHASE_POINTS));
            const pick = (values, by) => values.filter((_, i) => i % stride === 0).map((v) => v * by);
            series.push({
                name: run.backend,
                backend: run.backend,
                kind: "line",
                x: pick(x, factor),
                y: pick(y, 1),
                signals: { run, x, y },
            });
        }
        series.push(...this.sectionDots(body, isTurning, factor));
        if (series.length === 0) {
            return null;
        }
        const name = bodies[body].name;
        const title = isTurning
            ? `${name}: angular velocity over angle, rad/s`
            : `${name}: velocity along x over place, m/s`;
        return new XYPlot(this.page, title, series, {
            xTitle: isTurning ? "angle, deg" : "x of the centre, mm",
            words: "Dots: once a revolution.",
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

    sectionDots(body, isTurning, factor) {
        return this.data.runs.flatMap((run) => {
            const of = this.sections(run, body);
            if (of === null) {
                return [];
            }
            const x = isTurning ? of.angle_rad : of.x_m;
            const y = isTurning ? of.omega_rad_s : of.velocity_x_m_s;
            return [
                {
                    name: run.backend,
                    backend: run.backend,
                    kind: "dots",
                    x: x.map((value) => value * factor),
                    y,
                },
            ];
        });
    }

    // The state at one crank angle over the number of the revolution.
    sectionPlot(body) {
        const series = this.data.runs.flatMap((run) => {
            const of = this.sections(run, body);
            return of === null || of.omega_rad_s.length < 3
                ? []
                : [
                      {
                          name: run.backend,
                          backend: run.backend,
                          kind: "dots",
                          x: of.omega_rad_s.map((_, i) => i),
                          y: of.omega_rad_s,
                      },
                  ];
        });
        return series.length === 0
            ? null
            : new XYPlot(
                  this.page,
                  `${this.data.bodies[body].name}: angular velocity once a revolution, rad/s`,
                  series,
                  { xTitle: "revolution", words: "A motion that repeats comes to few values." },
              );
    }

    make() {
        const spectra = this.spectra();
        const moving = this.data.bodies
            .map((body, i) => i)
            .filter((i) => !this.data.bodies[i].is_driven);
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
        }
        if (spectra.length > 0) {
            const names = spectra.map(([name], i) => [String(i), name]);
            const make = (i) => [grid(this.spectrumPlot(spectra[Number(i)]))];
            const chooser = new Chooser(this.page, "Spectrum of", names, make);
            chooser.isPrintedWhole = false;
            parts.push(chooser.element);
        }
        return parts.some((part) => part.querySelector("figure") !== null)
            ? [this.page.section("Over the revolutions", ...parts)]
            : [];
    }
}
