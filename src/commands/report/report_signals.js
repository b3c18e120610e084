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

// A line of a plot: points in the order of time, in the units of the axis. Between two samples
// stand the exact peaks that lie there; without one, the least and largest value of the steps
// between, where these go beyond both samples.
function makeLine(run, of, number, what, factor, limits) {
    const values = findSignal(run, of, number, what);
    if (values === null) {
        return null;
    }
    const peaks = findPeaks(run, of, number, what);
    const least = limits.least ? findSignal(run, of, number, limits.least) : null;
    const most = limits.most ? findSignal(run, of, number, limits.most) : null;
    const x = [];
    const y = [];
    const add = (time, value) => {
        x.push(time);
        y.push(value * factor);
    };
    let peak = 0;
    for (let i = 0; i < values.length; i++) {
        const time = run.from_s + i * run.interval_s;
        const until = time + run.interval_s;
        add(time, values[i]);
        const before = peak;
        for (; peak < peaks.length && peaks[peak].time_s < until; peak++) {
            if (peaks[peak].time_s > time) {
                add(peaks[peak].time_s, peaks[peak].value);
            }
        }
        if (peak === before && i + 1 < values.length) {
            const low = Math.min(values[i], values[i + 1]);
            const high = Math.max(values[i], values[i + 1]);
            const margin = 0.02 * (high - low);
            if (least !== null && least[i] < low - margin) {
                add(time + run.interval_s / 3, least[i]);
            }
            if (most !== null && most[i] > high + margin) {
                add(time + (2 * run.interval_s) / 3, most[i]);
            }
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
