"use strict";
// Reads the data that the page carries: base64 of a deflated JSON text with the signals behind it
// (report_pack.h has the layout).

const PACK_NONE = 65535;

// The values of a signal, SI; NaN where there is none.
function unpackSignal(signal, bytes) {
    const count = signal.count;
    const values = new Float64Array(count);
    let code = 0;
    for (let i = 0; i < count; i++) {
        const low = bytes[signal.offset + i];
        const high = bytes[signal.offset + count + i];
        code = (code + low + 256 * high) & 0xffff;
        values[i] = code === PACK_NONE ? NaN : signal.low + signal.slope * i + signal.step * code;
    }
    return values;
}

// Gives the marks of a joint their times, s.
function timeMarks(run, joint) {
    const of = new Map(joint.signals.map((signal) => [signal.what, signal.values]));
    const count = joint.count;
    joint.values = of;
    joint.times = new Float64Array(count);
    for (let i = 0; i < count; i++) {
        const at = Math.round(of.get("sample")[i]) + of.get("share")[i];
        joint.times[i] = run.from_s + at * run.interval_s;
    }
}

// What scrolls can be reached by the keyboard, and what does not is no stop on its way.
function setStops() {
    for (const box of document.querySelectorAll(".wide, pre[role=group]")) {
        const isScrolled =
            box.scrollWidth > box.clientWidth || box.scrollHeight > box.clientHeight;
        box.tabIndex = isScrolled ? 0 : -1;
    }
}

// From now on, also of what is opened later.
function followStops() {
    setStops();
    addEventListener("resize", setStops);
    document.addEventListener("toggle", setStops, true);
}

async function readData() {
    const base64 = document.getElementById("data").content.textContent.replace(/\s/g, "");
    const text = atob(base64);
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) {
        packed[i] = text.charCodeAt(i);
    }
    const inflated = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(inflated).arrayBuffer());
    const length = new DataView(bytes.buffer).getUint32(0, true);
    const data = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
    const signals = bytes.subarray(4 + length);
    for (const run of data.runs) {
        const marked = run.marks.flatMap((joint) => joint.signals);
        for (const signal of [...run.signals, ...marked]) {
            signal.values = unpackSignal(signal, signals);
        }
        run.marks.forEach((joint) => {
            const { body_a, body_b } = data.joints[joint.joint];
            Object.assign(joint, { body_a, body_b });
            timeMarks(run, joint);
        });
    }
    return data;
}

// What is saved: all that the page carries, with the values themselves.
function dataAsJson(data) {
    const isPacking = new Set(["offset", "low", "slope", "step"]);
    return JSON.stringify(data, (key, value) =>
        isPacking.has(key) || value instanceof Map
            ? undefined
            : value instanceof Float64Array
              ? Array.from(value)
              : value,
    );
}

function csvCell(text) {
    return /[",\n\r]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
}

// One row a sample and run; a cell is empty where a run lacks the column.
function dataAsCsv(data) {
    const names = [];
    for (const run of data.runs) {
        for (const signal of run.signals) {
            if (signal.name !== "" && !names.includes(signal.name)) {
                names.push(signal.name);
            }
        }
    }
    const lines = [["backend", "time_s", ...names].map(csvCell).join(",")];
    for (const run of data.runs) {
        const columns = names.map((name) => run.signals.find((signal) => signal.name === name));
        const count = run.signals.length > 0 ? run.signals[0].count : 0;
        for (let i = 0; i < count; i++) {
            const cells = columns.map((signal) =>
                signal && Number.isFinite(signal.values[i]) ? String(signal.values[i]) : "",
            );
            lines.push([run.backend, String(run.from_s + i * run.interval_s), ...cells].join(","));
        }
    }
    return lines.join("\n") + "\n";
}

function saveFile(name, type, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
