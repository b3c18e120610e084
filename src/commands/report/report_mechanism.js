// Draws the mechanism where it is at a time: links, guides, springs, bushings, gears, pins in their
// holes with the play magnified, the paths of points, and the forces in the joints.

const GROUND = -1;
const FIT_SAMPLES = 400; // that the picture is fitted to
const TRAIL_POINTS = 12000; // of all paths, which every frame draws
const PIN_SHARE = 0.016; // of the mechanism's size: radius of a drawn pin
const PIN_LEAST = 3; // pixels
const PIN_MOST = 9;
const LINKS_SEEN = 4; // link lengths that are a mechanism's size, at most
const MARGIN = 50; // pixels: what stands below a pivot, and guides

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
        this.tilts = data.joints.map((joint, i) => findSignal(run, "joint", i, "tilt_rad"));
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

class Mechanism {
    constructor(page) {
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
            // what turns about its centre is shown by a hand
            const isGear = this.data.joints.some(
                (joint) => joint.touches === "teeth" && (joint.body_a === i || joint.body_b === i),
            );
            if (outline.length < 2 && !isGear) {
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
        for (let i = 0; i < this.outlines.length; i++) {
            for (const local of this.outlines[i]) {
                yield poses.point(i, local);
            }
        }
        for (const joint of this.data.joints) {
            const [x, y] = poses.point(joint.body_a, joint.anchor_a_m);
            const reach =
                Math.abs(joint.radius_a_m || joint.pin_radius_m || 0) + (joint.slot_m || 0) / 2;
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

    layOut() {
        const width = this.canvas.clientWidth;
        const { box } = this;
        const margin = MARGIN;
        const [wide, high] = [box.right - box.left, box.high - box.low];
        const height = Math.round(
            Math.max(
                220,
                Math.min(460, 2 * margin + (high / (wide || high || 1)) * (width - 2 * margin)),
            ),
        );
        this.canvas.style.height = height + "px";
        this.scale = Math.min(
            (width - 2 * margin) / (wide || 1e-9),
            (height - 2 * margin) / (high || 1e-9),
        );
        this.offsetX = width / 2 - ((box.left + box.right) / 2) * this.scale;
        this.offsetY = height / 2 + ((box.low + box.high) / 2) * this.scale;
        this.pin = Math.max(PIN_LEAST, Math.min(PIN_MOST, PIN_SHARE * this.part * this.scale));
        this.context = prepareCanvas(this.canvas, width, height);
    }

    draw() {
        if (this.canvas.clientWidth === 0) {
            return;
        }
        this.layOut();
        const shown = this.poses
            .map((poses, i) => ({ poses, trail: this.trails[i] }))
            .filter(({ poses }) => this.page.shown.has(poses.run.backend));
        shown.forEach(({ poses }) => poses.set(this.page.time));
        // one run in colours, the others as lines over it
        const main = shown.find(({ poses }) => poses.run.is_truth) || shown[shown.length - 1];
        if (main === undefined) {
            return;
        }
        if (this.page.hasTrails) {
            // the closed form's path is seen only where no other run's is
            shown
                .filter((one) => one === main || one.poses.run.backend !== "analytic")
                .forEach((one) => this.drawTrail(one));
        }
        this.drawRails(main.poses);
        this.drawBodies(main.poses, true);
        shown.filter((one) => one !== main).forEach(({ poses }) => this.drawBodies(poses, false));
        this.drawSprings(main.poses);
        this.drawBushings(main.poses);
        this.drawJoints(main.poses, true);
        shown
            .filter((one) => one !== main && one.poses.run.backend !== "analytic")
            .forEach(({ poses }) => this.drawJoints(poses, false));
        if (this.page.arrows !== "off") {
            shown.forEach(({ poses }) => this.drawArrows(poses));
        }
    }

    line(points, isClosed) {
        this.context.beginPath();
        points.forEach((point) => this.context.lineTo(...this.toScreen(point)));
        if (isClosed) {
            this.context.closePath();
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
                context.strokeStyle = colourOf(
                    this.data.bodies[i].is_driven ? "driven" : "link" + (i % 4),
                );
                context.lineWidth = 1.1 * this.pin;
                context.globalAlpha = 0.55;
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

    drawGround([x, y]) {
        const { context, pin } = this;
        context.strokeStyle = colourOf("frame");
        context.fillStyle = colourOf("grid");
        context.lineWidth = 1.2;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(x - 1.6 * pin, y + 2.6 * pin);
        context.lineTo(x + 1.6 * pin, y + 2.6 * pin);
        context.closePath();
        context.fill();
        context.stroke();
        context.beginPath();
        for (let i = -2; i <= 2; i++) {
            context.moveTo(x + i * 0.8 * pin, y + 2.6 * pin);
            context.lineTo(x + (i * 0.8 - 0.6) * pin, y + 3.4 * pin);
        }
        context.stroke();
    }

    drawSprings(poses) {
        const { context } = this;
        context.strokeStyle = colourOf("ink");
        context.lineWidth = 1.4;
        for (const spring of this.data.springs) {
            const from = this.toScreen(poses.point(spring.body_a, spring.anchor_a_m));
            const to = this.toScreen(poses.point(spring.body_b, spring.anchor_b_m));
            const length = Math.hypot(to[0] - from[0], to[1] - from[1]) || 1;
            const across = [-(to[1] - from[1]) / length, (to[0] - from[0]) / length];
            context.beginPath();
            context.moveTo(...from);
            for (let i = 1; i < 14; i++) {
                const side = i < 2 || i > 12 ? 0 : (i % 2 === 0 ? 1 : -1) * 0.8 * this.pin;
                context.lineTo(
                    from[0] + ((to[0] - from[0]) * i) / 14 + across[0] * side,
                    from[1] + ((to[1] - from[1]) * i) / 14 + across[1] * side,
                );
            }
            context.lineTo(...to);
            context.stroke();
        }
    }

    // A ring of rubber on the first body, and the pin of the second in it.
    drawBushings(poses) {
        const { context } = this;
        for (const bushing of this.data.bushings) {
            const ring = this.toScreen(poses.point(bushing.body_a, bushing.anchor_a_m));
            const pin = this.toScreen(poses.point(bushing.body_b, bushing.anchor_b_m));
            context.strokeStyle = colourOf("ink");
            context.lineWidth = 3.2;
            context.globalAlpha = 0.45;
            context.beginPath();
            context.arc(...ring, 1.5 * this.pin, 0, 2 * Math.PI);
            context.stroke();
            context.globalAlpha = 1;
            context.lineWidth = 1.4;
            context.beginPath();
            context.arc(...pin, 0.6 * this.pin, 0, 2 * Math.PI);
            context.stroke();
        }
    }

    drawJoints(poses, isMain) {
        const colour = isMain ? colourOf("ink") : colourOf(poses.run.backend);
        this.data.joints.forEach((joint, i) => {
            if (joint.touches === "hole") {
                this.drawPin(poses, joint, i, isMain, colour);
            } else if (joint.slides) {
                this.drawBlock(poses, joint, i, isMain, colour);
            } else if (joint.touches === "disc") {
                this.drawStop(poses, joint, isMain, colour);
            } else if (joint.touches === "teeth" && joint.is_rack) {
                this.drawRack(poses, joint, colour);
            } else if (joint.touches === "teeth") {
                this.drawGear(
                    poses,
                    joint.body_a,
                    joint.anchor_a_m,
                    joint.radius_a_m,
                    joint.teeth_a,
                    colour,
                );
                this.drawGear(
                    poses,
                    joint.body_b,
                    joint.anchor_b_m,
                    joint.radius_b_m,
                    joint.teeth_b,
                    colour,
                );
            } else if (isMain && joint.pivots) {
                this.drawPivot(this.toScreen(poses.point(joint.body_a, joint.anchor_a_m)));
            }
        });
    }

    circle([x, y], radius) {
        this.context.beginPath();
        this.context.arc(x, y, radius, 0, 2 * Math.PI);
    }

    drawPivot(at) {
        const { context } = this;
        this.circle(at, 0.5 * this.pin);
        context.fillStyle = colourOf("paper");
        context.fill();
        context.strokeStyle = colourOf("ink");
        context.lineWidth = 1.5;
        context.stroke();
    }

    // A pin in its hole, the play magnified.
    drawPin(poses, joint, number, isMain, colour) {
        const { context } = this;
        const hole = this.toScreen(poses.point(joint.body_a, joint.anchor_a_m));
        const [x, y] = poses.play(number);
        const scale = this.scale * this.page.magnification;
        if (isMain) {
            this.circle(hole, this.pin + joint.clearance_m * scale);
            context.fillStyle = colourOf("paper");
            context.fill();
            context.strokeStyle = colourOf("ink");
            context.lineWidth = 2;
            context.stroke();
        }
        this.circle([hole[0] + x * scale, hole[1] - y * scale], this.pin);
        if (isMain) {
            context.fillStyle = colourOf(poses.run.backend);
            context.globalAlpha = 0.85;
            context.fill();
            context.globalAlpha = 1;
        } else {
            context.strokeStyle = colour;
            context.lineWidth = 2;
            context.stroke();
        }
    }

    drawBlock(poses, joint, number, isMain, colour) {
        const { context, pin } = this;
        const at = this.toScreen(this.drawn(poses, joint.body_b, [...joint.anchor_b_m]));
        const tilt =
            poses.tilt(number) *
            (joint.touches === "guides" ? this.page.magnification : 0);
        const angle =
            poses.angle(joint.body_a) + joint.direction_rad + Math.max(-0.5, Math.min(0.5, tilt));
        context.save();
        context.translate(...at);
        context.rotate(-angle);
        context.beginPath();
        context.rect(-1.9 * pin, -pin, 3.8 * pin, 2 * pin);
        context.restore();
        context.strokeStyle = colour;
        context.lineWidth = 1.8;
        if (isMain) {
            context.fillStyle = colourOf("paper");
            context.fill();
        }
        context.stroke();
    }

    // The profile of a cam, and the flat that rides on it.
    drawCam(poses, joint, colour) {
        const { context } = this;
        const place = (body, anchor, angle, point) => {
            const from = poses.point(body, anchor);
            const [x, y] = rotate(point, angle);
            return [from[0] + x, from[1] + y];
        };
        const turned = poses.angle(joint.body_a);
        this.line(
            [...joint.profile_m, joint.profile_m[0]].map((point) =>
                place(joint.body_a, joint.anchor_a_m, turned, point),
            ),
            false,
        );
        context.stroke();
        if (joint.is_flat) {
            const along = poses.angle(joint.body_b) + joint.facing_rad + Math.PI / 2;
            const half = 0.12 * this.extent;
            context.strokeStyle = colour;
            this.line(
                [-half, half].map((at) =>
                    place(joint.body_b, joint.anchor_b_m, along, [at, 0]),
                ),
                false,
            );
            context.stroke();
        }
    }

    // The wall of a slot: two straight lines across its normal, and an arc at each end.
    drawSlot(poses, joint) {
        const from = poses.point(joint.body_a, joint.anchor_a_m);
        const angle = poses.angle(joint.body_a) + joint.direction_rad;
        const points = [];
        const steps = 24;
        for (let i = 0; i <= 2 * steps + 1; i++) {
            const isFirst = i <= steps;
            const turn = ((isFirst ? i : i - 1) * Math.PI) / steps;
            const [x, y] = rotate(
                [
                    joint.radius_a_m * Math.cos(turn),
                    joint.radius_a_m * Math.sin(turn) + (isFirst ? 0.5 : -0.5) * joint.slot_m,
                ],
                angle,
            );
            points.push([from[0] + x, from[1] + y]);
        }
        this.line([...points, points[0]], false);
        this.context.stroke();
    }

    drawStop(poses, joint, isMain, colour) {
        const { context } = this;
        const from = poses.point(joint.body_a, joint.anchor_a_m);
        context.strokeStyle = colour;
        context.lineWidth = 2;
        if (joint.profile_m) {
            this.drawCam(poses, joint, colour);
        } else if (joint.slot_m > 0) {
            this.drawSlot(poses, joint);
        } else if (joint.is_disc) {
            this.circle(this.toScreen(from), joint.radius_a_m * this.scale);
            context.stroke();
        } else if (isMain) {
            const angle = poses.angle(joint.body_a) + joint.direction_rad + Math.PI / 2;
            const [x, y] = rotate([0.1 * this.extent, 0], angle);
            this.line(
                [
                    [from[0] - x, from[1] - y],
                    [from[0] + x, from[1] + y],
                ],
                false,
            );
            context.stroke();
        }
        this.circle(
            this.toScreen(poses.point(joint.body_b, joint.anchor_b_m)),
            Math.max(2, joint.radius_b_m * this.scale),
        );
        context.stroke();
    }

    drawGear(poses, body, anchor, radius, teeth, colour) {
        const { context } = this;
        const at = this.toScreen(poses.point(body, anchor));
        const size = Math.abs(radius) * this.scale;
        const count = Math.max(6, Math.min(120, Math.round(Math.abs(teeth))));
        context.strokeStyle = colour;
        context.lineWidth = 1.2;
        this.circle(at, size);
        context.stroke();
        context.beginPath();
        for (let i = 0; i < count; i++) {
            const angle = -poses.angle(body) + (2 * Math.PI * i) / count;
            const inner = i === 0 ? 0.2 : 0.92;
            context.moveTo(
                at[0] + inner * size * Math.cos(angle),
                at[1] + inner * size * Math.sin(angle),
            );
            context.lineTo(at[0] + size * Math.cos(angle), at[1] + size * Math.sin(angle));
        }
        context.stroke();
    }

    // The pitch line of a rack with as many teeth as the pinion has that is drawn on it, two turns
    // long.
    drawRack(poses, joint, colour) {
        const { context } = this;
        const count = 24;
        const radius = Math.abs(joint.radius_b_m);
        const pitch = (2 * Math.PI * radius) / count;
        const angle = poses.angle(joint.body_a) + joint.direction_rad;
        const from = poses.point(joint.body_a, joint.anchor_a_m);
        const at = (along, across) => {
            const [x, y] = rotate([along, across], angle);
            return [from[0] + x, from[1] + y];
        };
        this.drawGear(poses, joint.body_b, joint.anchor_b_m, radius, count, colour);
        context.strokeStyle = colour;
        context.lineWidth = 1.2;
        this.line([at(-count * pitch, 0), at(count * pitch, 0)], false);
        context.stroke();
        for (let i = -count; i <= count; i++) {
            const depth = -0.08 * joint.radius_b_m;
            this.line([at(i * pitch, 0), at(i * pitch, depth)], false);
            context.stroke();
        }
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

    arrow(x, y, dx, dy, colour) {
        const { context } = this;
        const angle = Math.atan2(dy, dx);
        const head = Math.min(10, Math.hypot(dx, dy));
        context.strokeStyle = colour;
        context.fillStyle = colour;
        context.lineWidth = 2.5;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(
            x + dx - 0.7 * head * Math.cos(angle),
            y + dy - 0.7 * head * Math.sin(angle),
        );
        context.stroke();
        context.beginPath();
        context.moveTo(x + dx, y + dy);
        for (const side of [-0.4, 0.4]) {
            context.lineTo(
                x + dx - head * Math.cos(angle + side),
                y + dy - head * Math.sin(angle + side),
            );
        }
        context.closePath();
        context.fill();
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
