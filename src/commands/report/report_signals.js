// Finds the signals of a run and makes lines of them, with every peak in its place.

const DEG = 180 / Math.PI;

// The signals of each run by what they are; large mechanisms have thousands.
const INDEXES = new WeakMap();

function signalKey(of, number, what) {
    return `${of} ${number} ${what}`;
}

function findSignal(run, of, number, what) {
    if (!INDEXES.has(run)) {
        const entries = run.signals.map((signal) => [
            signalKey(signal.of, signal.number, signal.what),
            signal.values,
        ]);
        INDEXES.set(run, new Map(entries));
    }
    return INDEXES.get(run).get(signalKey(of, number, what)) || null;
}

// A value between samples, or NaN.
function valueAt(run, values, time) {
    const at = (time - run.from_s) / run.interval_s;
    const last = values.length - 1;
    const first = Math.max(0, Math.min(last, Math.floor(at)));
    const next = Math.min(last, first + 1);
    const share = Math.max(0, Math.min(1, at - first));
    return values[first] + share * (values[next] - values[first]);
}

// The exact peaks of a signal, in the order of time.
function findPeaks(run, of, number, what) {
    return run.peaks
        .filter((peak) => peak.of === of && peak.number === number && peak.what === what)
        .sort((a, b) => a.time_s - b.time_s);
}

// What a joint did at the samples of a run and at the marks of its contacts, in the order of time:
// `times`, and by name "ex_m", "ey_m", "force_x_N", "force_y_N" and "force", each null where the
// run does not know it.
const INSTANTS = new WeakMap();
const OF_INSTANTS = ["ex_m", "ey_m", "force_x_N", "force_y_N", "force"];

function jointInstants(run, number) {
    if (!INSTANTS.has(run)) {
        INSTANTS.set(run, new Map());
    }
    const made = INSTANTS.get(run);
    if (!made.has(number)) {
        made.set(number, makeInstants(run, number));
    }
    return made.get(number);
}

function makeInstants(run, number) {
    const columns = OF_INSTANTS.map((what) => findSignal(run, "joint", number, what));
    const grid = columns.find((values) => values !== null);
    const marks = run.marks.find((joint) => joint.joint === number);
    const instants = { times: new Float64Array(0) };
    if (grid === undefined) {
        OF_INSTANTS.forEach((what) => (instants[what] = null));
        return instants;
    }
    const times = [];
    const from = []; // the number of a sample, or less than 0 of a mark
    let mark = 0;
    for (let i = 0; i <= grid.length; i++) {
        const time = i < grid.length ? run.from_s + i * run.interval_s : Infinity;
        for (; marks && mark < marks.count && marks.times[mark] < time; mark++) {
            times.push(marks.times[mark]);
            from.push(-1 - mark);
        }
        if (i < grid.length) {
            times.push(time);
            from.push(i);
        }
    }
    instants.times = Float64Array.from(times);
    OF_INSTANTS.forEach((what, k) => {
        const values = columns[k];
        const marked = marks ? marks.values.get(what) : null;
        instants[what] =
            values === null
                ? null
                : Float64Array.from(from, (i) => (i < 0 ? marked[-1 - i] : values[i]));
    });
    return instants;
}

// A value of a joint between its instants, or NaN.
function instantAt(instants, what, time) {
    const values = instants[what];
    const first = findPoint(instants.times, time);
    const next = Math.min(values.length - 1, first + 1);
    const width = instants.times[next] - instants.times[first];
    const share = width > 0 ? Math.max(0, Math.min(1, (time - instants.times[first]) / width)) : 0;
    return values[first] + share * (values[next] - values[first]);
}

// The marks that have a signal: of a joint, or of all joints of a body its acceleration.
function markedPoints(run, of, number, what) {
    const points = [];
    const take = (joint, values) => {
        for (let i = 0; values !== undefined && i < joint.count; i++) {
            if (Number.isFinite(values[i])) {
                points.push({ time_s: joint.times[i], value: values[i] });
            }
        }
    };
    for (const joint of run.marks) {
        if (of === "joint" && joint.joint === number && (what === "force" || what === "gap")) {
            take(joint, joint.values.get(what));
        } else if (of === "body" && what === "alpha_rad_s2" && joint.body_a === number) {
            take(joint, joint.values.get("alpha_a_rad_s2"));
        } else if (of === "body" && what === "alpha_rad_s2" && joint.body_b === number) {
            take(joint, joint.values.get("alpha_b_rad_s2"));
        }
    }
    return points;
}

// The exact peaks of a signal and its marks, in the order of time. A mark is rounded: where a peak
// is at its time that one counts.
function findPoints(run, of, number, what) {
    const near = 1e-3 * run.interval_s;
    const peaks = findPeaks(run, of, number, what);
    const times = Float64Array.from(peaks, (peak) => peak.time_s);
    const isPeak = (point) => {
        const at = findPoint(times, point.time_s + near);
        return times.length > 0 && Math.abs(times[at] - point.time_s) <= near;
    };
    const marks = markedPoints(run, of, number, what).filter((point) => !isPeak(point));
    return [...peaks, ...marks].sort((a, b) => a.time_s - b.time_s);
}

// A line of a plot: points in the order of time, in the units of the axis. Between two samples
// stand the exact peaks and the marks that lie there, and the least and largest value of the steps
// between, where these go beyond all of them.
function makeLine(run, of, number, what, factor, limits) {
    const values = findSignal(run, of, number, what);
    if (values === null) {
        return null;
    }
    const points = findPoints(run, of, number, what);
    const least = limits.least ? findSignal(run, of, number, limits.least) : null;
    const most = limits.most ? findSignal(run, of, number, limits.most) : null;
    const x = [];
    const y = [];
    let next = 0;
    for (let i = 0; i < values.length; i++) {
        const time = run.from_s + i * run.interval_s;
        const isLast = i + 1 === values.length;
        const between = [];
        for (; next < points.length && points[next].time_s < time + run.interval_s; next++) {
            if (points[next].time_s > time) {
                between.push(points[next]);
            }
        }
        const known = [values[i], ...(isLast ? [] : [values[i + 1]])];
        known.push(...between.map((point) => point.value));
        const [low, high] = [Math.min(...known), Math.max(...known)];
        const margin = 0.02 * (high - low);
        if (!isLast && least !== null && least[i] < low - margin) {
            between.push({ time_s: time + run.interval_s / 3, value: least[i] });
        }
        if (!isLast && most !== null && most[i] > high + margin) {
            between.push({ time_s: time + (2 * run.interval_s) / 3, value: most[i] });
        }
        x.push(time);
        y.push(values[i] * factor);
        for (const point of between.sort((a, b) => a.time_s - b.time_s)) {
            x.push(point.time_s);
            y.push(point.value * factor);
        }
    }
    return { run, backend: run.backend, x: Float64Array.from(x), y: Float64Array.from(y) };
}

// The number of the last point that is not after a time, or 0.
function findPoint(x, time) {
    let low = 0;
    let high = x.length - 1;
    while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (x[middle] <= time) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

// Numbers for people: four digits, without an exponent where there is room.
function formatNumber(value) {
    if (!Number.isFinite(value)) {
        return "-";
    }
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e7 || size < 1e-3)) {
        return value.toExponential(2).replace("e+", "e");
    }
    return String(
        Number(value.toPrecision(size >= 1000 ? Math.max(4, Math.ceil(Math.log10(size))) : 4)),
    );
}

// Ticks at 1, 2 or 5 times a power of ten, some `wanted` of them, and how many decimals tell them
// apart.
function findTicks(low, high, wanted) {
    const raw = (high - low) / wanted;
    const power = 10 ** Math.floor(Math.log10(raw));
    const lead = [1, 2, 5, 10].find((number) => number * power >= raw * 0.999);
    const step = lead * power;
    const ticks = [];
    for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i++) {
        ticks.push(i * step);
    }
    return { ticks, decimals: Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9))) };
}

// A tick's words: with a prefix where numbers are long, with an exponent where they are small, and
// as many digits as tell ticks apart.
function formatTick(value, decimals) {
    const size = Math.abs(value);
    if (size === 0) {
        return "0";
    }
    if (decimals > 4) {
        return value.toExponential(Math.max(0, decimals + Math.floor(Math.log10(size) + 1e-9)));
    }
    if (size >= 1e6) {
        return formatNumber(value / 1e6) + "M";
    }
    if (size >= 1e4) {
        return formatNumber(value / 1e3) + "k";
    }
    return size < 1e-4 ? value.toExponential(0) : value.toFixed(decimals);
}
