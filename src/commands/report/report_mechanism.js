// Draws the mechanism where it is at a time: its links and what report_shapes.js has, the play
// magnified, the paths of points, and the forces in the joints; the runs over each other, side by
// side, or their difference magnified.

const GROUND = -1;
const FIT_SAMPLES = 400; // that the picture is fitted to
const TRAIL_POINTS = 12000; // of all paths, which every frame draws
const PIN_SHARE = 0.016; // of the mechanism's size: radius of a drawn pin
const PIN_LEAST = 3; // pixels
const PIN_MOST = 9;
const LINKS_SEEN = 4; // link lengths that are a mechanism's size, at most
const MARGIN = 50; // pixels: what stands below a pivot, guides and names
const NARROW = 600; // pixels: a phone
const HEIGHT_LEAST = 200;
const HEIGHT_MOST = 500;
const NAMES_MOST = 8; // joints whose names are shown unasked
const DIFFERENCE_SEEN = 0.04; // of the mechanism's size: as which the largest difference is drawn
// times: the values of a page are off by 1e-5 of their range, and more would magnify that
const DIFFERENCE_MOST = 1000;

// Of a table of places: rounding is no place.
const formatPlace = (value) => formatNumber(Math.round(value * 1e9) / 1e9);

const PLACE_HEADS = ["x, mm", "y, mm", "angle, deg"];

const rotate = ([x, y], angle) => {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [c * x - s * y, s * x + c * y];
};

// How the bodies of a run stand at a time.
class Poses {
    constructor(data, run) {
        this.data = data;
        this.run = run;
        this.bodies = data.bodies.map((body, i) => ({
            x: findSignal(run, "body", i, "x_m"),
            y: findSignal(run, "body", i, "y_m"),
            angle: findSignal(run, "body", i, "angle_rad"),
        }));
        this.joints = data.joints.map((joint, i) => jointInstants(run, i));
        const own = (what) => data.joints.map((joint, i) => findSignal(run, "joint", i, what));
        this.tilts = own("tilt_rad");
        this.coordinates = own("coordinate");
        this.count = this.bodies.length > 0 ? this.bodies[0].x.length : 0;
    }

    set(time) {
        this.time = time;
        this.now = this.bodies.map((body) => ({
            x: valueAt(this.run, body.x, time),
            y: valueAt(this.run, body.y, time),
            angle: valueAt(this.run, body.angle, time),
        }));
    }

    // What a table says of a body, for PLACE_HEADS.
    placeCells(body) {
        const { x, y, angle } = this.now[body];
        return [1000 * x, 1000 * y, angle * DEG].map(formatPlace);
    }

    angle(body) {
        return body === GROUND ? 0 : this.now[body].angle;
    }

    point(body, local) {
        if (body === GROUND) {
            return local;
        }
        const [x, y] = rotate(local, this.now[body].angle);
        return [this.now[body].x + x, this.now[body].y + y];
    }

    // A signal of a joint, 0 where it is not known.
    value(number, what) {
        const instants = this.joints[number];
        return instants[what] === null ? 0 : instantAt(instants, what, this.time) || 0;
    }

    tilt(number) {
        const values = this.tilts[number];
        return values === null ? 0 : valueAt(this.run, values, this.time) || 0;
    }

    // Of a joint with stops or backlash, rad or m; NaN where it is not known.
    coordinate(number) {
        const values = this.coordinates[number];
        return values === null ? NaN : valueAt(this.run, values, this.time);
    }

    force(number) {
        return [this.value(number, "force_x_N"), this.value(number, "force_y_N")];
    }

    // The offset of a joint's anchor on body b that its play makes, in the world, m.
    play(number) {
        const joint = this.data.joints[number];
        const [x, y] = [this.value(number, "ex_m"), this.value(number, "ey_m")];
        if (joint.touches === "hole") {
            return [x, y];
        }
        // of a block the part across its guides
        return joint.touches === "guides"
            ? rotate([0, y], this.angle(joint.body_a) + joint.direction_rad)
            : [0, 0];
    }
}

// Where the bodies are at equal intervals of all runs.
function placesTable(page, runs, heads) {
    return valuesTable(["run", ...page.timeHeads(), "body", ...heads], () => {
        const { bodies } = page.data;
        const times = Math.max(2, Math.floor(TABLE_ROWS / (runs.length * bodies.length)));
        const rows = [];
        for (const poses of runs) {
            const { run } = poses;
            for (let k = 0; k < times && poses.count > 0; k++) {
                const share = Math.round((k * (poses.count - 1)) / (times - 1));
                const time = run.from_s + share * run.interval_s;
                poses.set(time);
                bodies.forEach((body, i) =>
                    rows.push([
                        run.backend,
                        ...page.timeCells(time),
                        body.name,
                        ...poses.placeCells(i),
                    ]),
                );
            }
        }
        const all = runs.reduce((sum, poses) => sum + poses.count * bodies.length, 0);
        return { rows, more: all - rows.length };
    });
}

class Mechanism extends MechanismShapes {
    constructor(page) {
        super();
        this.page = page;
        this.data = page.data;
        this.canvas = element("canvas", { tabIndex: 0, className: "mechanism" });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute(
            "aria-label",
            "The mechanism moving. Space plays and pauses, the " +
                "arrow keys step, Home and End go to both ends.",
        );
        this.canvas.addEventListener("keydown", (event) => page.onKey(event));
        this.poses = page.data.runs.map((run) => new Poses(page.data, run));
        this.findPoints();
        this.findSize();
        this.findForces();
        this.findDifference();
        this.way = "over";
        this.hasNames = page.data.joints.length <= NAMES_MOST;
        this.trails = this.poses.map((poses) => this.tracePoints(poses));
        this.table = placesTable(page, this.poses, PLACE_HEADS);
    }

    // The points that a body's outline goes through, in its own frame.
    findPoints() {
        this.outlines = this.data.bodies.map(() => []);
        // the joints with play at which a body has the pin or the block
        this.played = this.data.bodies.map(() => []);
        this.data.joints.forEach((joint, i) => {
            if (joint.has_play && joint.body_b !== GROUND) {
                this.played[joint.body_b].push(i);
            }
        });
        const add = (body, point) => {
            const isNew =
                body !== GROUND &&
                !this.outlines[body].some(
                    (other) => Math.hypot(other[0] - point[0], other[1] - point[1]) < 1e-9,
                );
            if (isNew) {
                this.outlines[body].push(point);
            }
        };
        for (const joint of this.data.joints) {
            if (joint.touches === "teeth") {
                continue;
            }
            if (joint.touches !== "disc" || !joint.is_disc) {
                add(joint.body_a, joint.anchor_a_m);
            }
            add(joint.body_b, joint.anchor_b_m);
        }
        for (const spring of this.data.springs) {
            add(spring.body_a, spring.anchor_a_m);
            add(spring.body_b, spring.anchor_b_m);
        }
        for (const bushing of this.data.bushings) {
            add(bushing.body_a, bushing.anchor_a_m);
            add(bushing.body_b, bushing.anchor_b_m);
        }
        for (const point of this.data.points) {
            add(point.body, point.at_m);
        }
        this.outlines.forEach((outline, i) => {
            if (outline.length < 2) {
                add(i, [0, 0]);
            }
            // what turns about its centre is shown by a hand; a block and a gear are shapes
            const isShape = this.data.joints.some(
                (joint) =>
                    (joint.touches === "teeth" && (joint.body_a === i || joint.body_b === i)) ||
                    (joint.slides && joint.body_b === i),
            );
            if (outline.length < 2 && !isShape) {
                add(i, [this.data.bodies[i].gyration_m, 0]);
            }
        });
        // traced points, or the centres of the bodies that are not driven
        this.traced =
            this.data.points.length > 0
                ? this.data.points.map((point) => [point.body, point.at_m])
                : this.data.bodies.flatMap((body, i) => (body.is_driven ? [] : [[i, [0, 0]]]));
    }

    // All points of the mechanism at the time that is set.
    *points(poses) {
        for (const { body_a, body_b, anchor_a_m, anchor_b_m } of [
            ...this.data.springs,
            ...this.data.bushings,
        ]) {
            yield poses.point(body_a, anchor_a_m);
            yield poses.point(body_b, anchor_b_m);
        }
        for (let i = 0; i < this.outlines.length; i++) {
            for (const local of this.outlines[i]) {
                yield poses.point(i, local);
            }
        }
        for (const joint of this.data.joints) {
            const [x, y] = poses.point(joint.body_a, joint.anchor_a_m);
            const profile = joint.profile_m || [];
            const reach = Math.max(
                Math.abs(joint.radius_a_m || joint.pin_radius_m || 0) + (joint.slot_m || 0) / 2,
                ...profile.map((point) => Math.hypot(...point)),
            );
            yield [x - reach, y - reach];
            yield [x + reach, y + reach];
            if (joint.touches === "disc" || joint.touches === "teeth") {
                const other = poses.point(joint.body_b, joint.anchor_b_m);
                const radius = Math.abs(joint.radius_b_m || 0);
                yield [other[0] - radius, other[1] - radius];
                yield [other[0] + radius, other[1] + radius];
            }
        }
    }

    // The box that the mechanism stays in, and how far its sliders go.
    findSize() {
        const box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
        const ways = this.data.joints.map(() => [Infinity, -Infinity]);
        for (const poses of this.poses.slice(-1)) {
            const stride = Math.max(1, Math.floor(poses.count / FIT_SAMPLES));
            for (let i = 0; i < poses.count; i += stride) {
                poses.set(poses.run.from_s + i * poses.run.interval_s);
                for (const [x, y] of this.points(poses)) {
                    box.left = Math.min(box.left, x);
                    box.right = Math.max(box.right, x);
                    box.low = Math.min(box.low, y);
                    box.high = Math.max(box.high, y);
                }
                this.data.joints.forEach((joint, k) => {
                    const at = this.alongLine(poses, joint);
                    ways[k] = [Math.min(ways[k][0], at), Math.max(ways[k][1], at)];
                });
            }
        }
        this.box = box;
        this.ways = ways;
        this.extent = Math.hypot(box.right - box.left, box.high - box.low) || 0.1;
        // pins, play and arrows are drawn by the size of a link, where there are many
        const links = this.outlines.map(([a, b]) =>
            a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0,
        );
        const middle = links.sort((a, b) => a - b)[links.length >> 1] || 0;
        this.part = middle > 0 ? Math.min(this.extent, LINKS_SEEN * middle) : this.extent;
        const plays = this.data.joints.map((joint) => joint.clearance_m).filter((play) => play > 0);
        this.play = plays.length > 0 ? Math.max(...plays) : 0;
        // so that the largest play is seen beside its pin
        this.usualMagnification = this.play > 0 ? Math.max(1, (0.02 * this.part) / this.play) : 1;
    }

    // How many times the difference of the runs that have play is magnified, so that it is seen, up
    // to where they can be predicted; 1 where it is seen as it is, or not told from rounding.
    findDifference() {
        const [first, ...others] = this.poses.filter(({ run }) => run.backend !== "analytic");
        let most = 0;
        for (const other of others) {
            const until = this.data.horizon_s === null ? Infinity : this.data.horizon_s;
            const stride = Math.max(1, Math.floor(first.count / FIT_SAMPLES));
            for (let i = 0; i < first.count; i += stride) {
                const time = first.run.from_s + i * first.run.interval_s;
                [first, other].forEach((poses) => poses.set(Math.min(time, until)));
                first.now.forEach((body, k) => {
                    const by = other.now[k];
                    most = Math.max(most, Math.hypot(by.x - body.x, by.y - body.y));
                    most = Math.max(most, Math.abs(by.angle - body.angle) * 0.3 * this.part);
                });
            }
        }
        const wanted = most > 0 ? (DIFFERENCE_SEEN * this.part) / most : 1;
        const power = 10 ** Math.floor(Math.log10(wanted));
        const lead = [5, 2, 1].find((number) => number * power <= wanted) || 1;
        this.difference = wanted <= DIFFERENCE_MOST ? Math.max(1, lead * power) : 1;
    }

    // Puts a run further away from another than it is.
    magnify(poses, main) {
        poses.now = poses.now.map((body, i) => {
            const from = main.now[i];
            const away = (what) => from[what] + this.difference * (body[what] - from[what]);
            return { x: away("x"), y: away("y"), angle: away("angle") };
        });
    }

    // In which ways several runs can be drawn.
    makeWays() {
        const count = this.poses.length;
        if (count < 2) {
            return [];
        }
        const ways = [
            ["over", "over each other"],
            ["beside", "side by side"],
        ];
        if (this.difference > 1) {
            const times = formatNumber(this.difference);
            ways.push(["magnified", `their difference magnified ${times} times`]);
        }
        const act = (way) => {
            this.way = way;
            this.draw();
        };
        return [this.page.choice("Runs", ways, this.way, act)];
    }

    // Where a slider is along its line, m.
    alongLine(poses, joint) {
        const angle = poses.angle(joint.body_a) + joint.direction_rad;
        const from = poses.point(joint.body_a, joint.anchor_a_m);
        const to = poses.point(joint.body_b, joint.anchor_b_m);
        return (to[0] - from[0]) * Math.cos(angle) + (to[1] - from[1]) * Math.sin(angle);
    }

    // Arrows are those of joints with play, or of all where none has any.
    hasArrow(poses, number) {
        const joint = this.data.joints[number];
        const isOne = joint.has_play || !this.data.joints.some((one) => one.has_play);
        return isOne && !joint.is_torsional && poses.joints[number].force_x_N !== null;
    }

    findForces() {
        this.forceMost = 0;
        for (const poses of this.poses) {
            poses.joints.forEach(({ force_x_N: x, force_y_N: y }, i) => {
                for (let k = 0; this.hasArrow(poses, i) && k < x.length; k++) {
                    const size = Math.hypot(x[k], y[k]);
                    this.forceMost = size > this.forceMost ? size : this.forceMost;
                }
            });
        }
    }

    tracePoints(poses) {
        const most = Math.max(150, Math.min(3000, Math.round(TRAIL_POINTS / this.traced.length)));
        const count = Math.min(poses.count, most);
        const stride = (poses.count - 1) / Math.max(1, count - 1);
        const trail = this.traced.map(() => []);
        const times = [];
        for (let i = 0; i < count; i++) {
            const time = poses.run.from_s + Math.round(i * stride) * poses.run.interval_s;
            poses.set(time);
            times.push(time);
            this.traced.forEach(([body, local], k) => trail[k].push(poses.point(body, local)));
        }
        return { times, trail };
    }

    toScreen([x, y]) {
        return [this.offsetX + x * this.scale, this.offsetY - y * this.scale];
    }

    // Sets the scale so that the box fills the canvas, or one of so many cells of it: side by side,
    // or on a narrow screen below each other.
    layOut(cells) {
        const width = this.canvas.clientWidth;
        const { box } = this;
        const isNarrow = width < NARROW;
        const columns = isNarrow ? 1 : cells;
        const cellWidth = width / columns;
        const margin = Math.min(MARGIN, 0.12 * cellWidth);
        const [wide, high] = [box.right - box.left, box.high - box.low];
        const room = cellWidth - 2 * margin;
        const wanted = 2 * MARGIN + (high / (wide || high || 1)) * room;
        const cellHeight = Math.round(Math.max(HEIGHT_LEAST, Math.min(HEIGHT_MOST, wanted)));
        const height = isNarrow ? cells * cellHeight : cellHeight;
        this.canvas.style.height = height + "px";
        this.scale = Math.min(room / (wide || 1e-9), (cellHeight - 2 * MARGIN) / (high || 1e-9));
        this.size = { width, height, columns, cellWidth, cellHeight };
        this.pin = Math.max(PIN_LEAST, Math.min(PIN_MOST, PIN_SHARE * this.part * this.scale));
        this.context = prepareCanvas(this.canvas, width, height);
        this.enterCell(0);
    }

    enterCell(cell) {
        const { box, size } = this;
        this.cell = {
            left: (cell % size.columns) * size.cellWidth,
            top: Math.floor(cell / size.columns) * size.cellHeight,
        };
        const middle = [(box.left + box.right) / 2, (box.low + box.high) / 2];
        this.offsetX = this.cell.left + size.cellWidth / 2 - middle[0] * this.scale;
        this.offsetY = this.cell.top + size.cellHeight / 2 + middle[1] * this.scale;
    }

    draw() {
        if (this.canvas.clientWidth === 0) {
            return;
        }
        const shown = this.poses
            .map((poses, i) => ({ poses, trail: this.trails[i] }))
            .filter(({ poses }) => this.page.shown.has(poses.run.backend));
        const isBeside = this.way === "beside" && shown.length > 1;
        this.layOut(isBeside ? shown.length : 1);
        shown.forEach(({ poses }) => poses.set(this.page.time));
        if (isBeside) {
            shown.forEach((one, cell) => {
                this.enterCell(cell);
                this.drawRuns([one]);
                this.nameCell(one.poses.run.backend);
            });
        } else if (shown.length > 0) {
            this.drawRuns(shown);
        }
        this.drawScale();
    }

    // One run in colours, the others as lines over it.
    drawRuns(shown) {
        const main = shown.find(({ poses }) => poses.run.is_truth) || shown[shown.length - 1];
        const others = shown.filter((one) => one !== main);
        if (this.way === "magnified") {
            others
                .filter(({ poses }) => poses.run.backend !== "analytic")
                .forEach(({ poses }) => this.magnify(poses, main.poses));
        }
        if (this.page.hasTrails) {
            // the closed form's path is seen only where no other run's is
            shown
                .filter((one) => one === main || one.poses.run.backend !== "analytic")
                .forEach((one) => this.drawTrail(one));
        }
        this.drawRails(main.poses);
        this.drawBodies(main.poses, true);
        others.forEach(({ poses }) => this.drawBodies(poses, false));
        this.drawSprings(main.poses);
        this.drawBushings(main.poses);
        this.drawJoints(main.poses, true);
        this.drawLimits(main.poses);
        others
            .filter((one) => one.poses.run.backend !== "analytic")
            .forEach(({ poses }) => this.drawJoints(poses, false));
        if (this.page.arrows !== "off") {
            shown.forEach(({ poses }) => this.drawArrows(poses));
        }
        if (this.hasNames) {
            this.drawNames(main.poses);
        }
    }

    drawTrail({ poses, trail }) {
        const { context } = this;
        const end = findPoint(trail.times, this.page.time);
        trail.trail.forEach((points) => {
            context.strokeStyle = colourOf(poses.run.backend);
            context.lineWidth = 1;
            context.globalAlpha = 0.3;
            this.line(points, false);
            context.stroke();
            context.globalAlpha = 1;
            context.lineWidth = 2;
            this.line(points.slice(Math.max(0, end - trail.times.length / 6), end + 1), false);
            context.stroke();
        });
    }

    // A point of a body as it is drawn: at a joint with play moved by the magnified play.
    drawn(poses, body, local) {
        const point = poses.point(body, local);
        for (const i of body === GROUND ? [] : this.played[body]) {
            const anchor = this.data.joints[i].anchor_b_m;
            if (Math.hypot(anchor[0] - local[0], anchor[1] - local[1]) < 1e-9) {
                const [x, y] = poses.play(i);
                point[0] += x * (this.page.magnification - 1);
                point[1] += y * (this.page.magnification - 1);
            }
        }
        return point;
    }

    drawBodies(poses, isMain) {
        const { context } = this;
        this.outlines.forEach((outline, i) => {
            const points = outline.map((local) => this.drawn(poses, i, [...local]));
            this.line(hull(points), points.length > 2);
            context.lineJoin = "round";
            context.lineCap = "round";
            if (isMain) {
                context.strokeStyle = this.bodyColour(i);
                context.lineWidth = 1.1 * this.pin;
                context.globalAlpha = 0.75;
                context.stroke();
                if (points.length > 2) {
                    context.fillStyle = context.strokeStyle;
                    context.fill();
                }
                context.globalAlpha = 1;
            } else {
                context.strokeStyle = colourOf(poses.run.backend);
                context.lineWidth = 1.6;
                context.setLineDash(poses.run.backend === "analytic" ? [3, 4] : []);
                context.stroke();
                context.setLineDash([]);
            }
        });
    }

    // Guides, and the ground below pivots that stand on it.
    drawRails(poses) {
        const { context } = this;
        this.data.joints.forEach((joint, i) => {
            if (joint.slides) {
                const angle = poses.angle(joint.body_a) + joint.direction_rad;
                const from = poses.point(joint.body_a, joint.anchor_a_m);
                const reach = 0.03 * this.extent;
                const sides =
                    joint.touches === "guides"
                        ? this.pin / this.scale + joint.clearance_m * this.page.magnification
                        : 0;
                for (const side of sides > 0 ? [-sides, sides] : [0]) {
                    const ends = [this.ways[i][0] - reach, this.ways[i][1] + reach].map((way) => {
                        const [x, y] = rotate([way, side], angle);
                        return [from[0] + x, from[1] + y];
                    });
                    context.strokeStyle = colourOf("frame");
                    context.lineWidth = 2;
                    this.line(ends, false);
                    context.stroke();
                }
            } else if (joint.pivots) {
                const grounded =
                    joint.body_a === GROUND
                        ? joint.anchor_a_m
                        : joint.body_b === GROUND
                          ? joint.anchor_b_m
                          : null;
                if (grounded !== null) {
                    this.drawGround(this.toScreen(grounded));
                }
            }
        });
    }

    // The force on body b of each joint with play, from its pin; logarithmic over three decades.
    drawArrows(poses) {
        poses.joints.forEach((joint, i) => {
            const of = this.data.joints[i];
            if (!this.hasArrow(poses, i) || this.forceMost === 0) {
                return;
            }
            const force = poses.force(i);
            const size = Math.hypot(...force);
            const share =
                this.page.arrows === "linear"
                    ? size / this.forceMost
                    : size > 0
                      ? Math.max(0, 1 + Math.log10(size / this.forceMost) / 3)
                      : 0;
            const length = 0.26 * this.part * this.scale * share;
            if (length > 2) {
                const [x, y] = this.toScreen(this.drawn(poses, of.body_b, [...of.anchor_b_m]));
                this.arrow(
                    x,
                    y,
                    (force[0] / size) * length,
                    (-force[1] / size) * length,
                    colourOf(poses.run.backend),
                );
            }
        });
    }
}

// The convex outline of points, in turn; of two points both.
function hull(points) {
    if (points.length < 3) {
        return points;
    }
    const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const half = (list) => {
        const kept = [];
        for (const point of list) {
            while (
                kept.length > 1 &&
                turn(kept[kept.length - 2], kept[kept.length - 1], point) <= 0
            ) {
                kept.pop();
            }
            kept.push(point);
        }
        return kept.slice(0, -1);
    };
    return [...half(sorted), ...half(sorted.reverse())];
}
