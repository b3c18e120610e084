// Draws a mechanism in space, which can be turned: its bodies as rods between their joints, pins
// along their axes with the play magnified, the paths of the bodies' centres, the forces, names and
// the scale, which holds for what is across the line of sight.

const SPACE_YAW = -0.6; // rad, at first
const SPACE_PITCH = 0.45;
const SPACE_HEIGHT = 420; // pixels, as the next
const SPACE_MARGIN = 56; // for names, arrows and pins

const SPACE_PLACE_HEADS = ["x, mm", "y, mm", "z, mm", "tilt of its axis, deg"];

// A vector turned by a quaternion: v + 2 q x (q x v + w v).
function turned([w, qx, qy, qz], [x, y, z]) {
    const cross = ([ax, ay, az], [bx, by, bz]) => [
        ay * bz - az * by,
        az * bx - ax * bz,
        ax * by - ay * bx,
    ];
    const q = [qx, qy, qz];
    const inner = cross(q, [x, y, z]);
    const outer = cross(q, [inner[0] + w * x, inner[1] + w * y, inner[2] + w * z]);
    return [x + 2 * outer[0], y + 2 * outer[1], z + 2 * outer[2]];
}

const added = (a, b, factor) => a.map((value, i) => value + factor * b[i]);

// How the bodies of a run stand in space at a time.
class SpacePoses {
    constructor(data, run) {
        this.data = data;
        this.run = run;
        const of = (kind, number, names) =>
            names.map((name) => findSignal(run, kind, number, name));
        this.bodies = data.bodies.map((_, i) => ({
            place: of("body", i, ["x_m", "y_m", "height_m"]),
            turn: of("body", i, ["turn_w", "turn_x", "turn_y", "turn_z"]),
        }));
        this.joints = data.joints.map((_, i) => ({
            offset: of("joint", i, ["ex_m", "ey_m", "offset_z_m"]),
            force: of("joint", i, ["force_x_N", "force_y_N", "load_z_N"]),
        }));
        this.count = this.bodies.length > 0 ? this.bodies[0].place[0].length : 0;
    }

    set(time) {
        this.time = time;
        const now = (values) => (values === null ? 0 : valueAt(this.run, values, time) || 0);
        this.now = this.bodies.map(({ place, turn }) => {
            const quaternion = turn.map(now);
            const size = Math.hypot(...quaternion) || 1;
            return { place: place.map(now), turn: quaternion.map((value) => value / size) };
        });
        this.offsets = this.joints.map(({ offset }) => offset.map(now));
        this.forces = this.joints.map(({ force }) => force.map(now));
    }

    // What a table says of a body, for SPACE_PLACE_HEADS.
    placeCells(body) {
        const { place, turn } = this.now[body];
        const [x, y, z] = turned(turn, [0, 0, 1]);
        const tilt = Math.atan2(Math.hypot(x, y), z);
        return [...place.map((value) => 1000 * value), tilt * DEG].map(formatPlace);
    }

    point(body, local) {
        return body === GROUND
            ? local
            : added(turned(this.now[body].turn, local), this.now[body].place, 1);
    }

    direction(body, local) {
        return body === GROUND ? local : turned(this.now[body].turn, local);
    }
}

class SpaceMechanism extends MechanismShapes {
    constructor(page) {
        super();
        this.hasNames = page.data.joints.length <= NAMES_MOST;
        this.scaleLeft = 96; // beside the axes
        this.page = page;
        this.data = page.data;
        this.yaw = SPACE_YAW;
        this.pitch = SPACE_PITCH;
        this.canvas = element("canvas", { tabIndex: 0, className: "mechanism" });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute(
            "aria-label",
            "The mechanism moving in space. Space plays and pauses, the arrow keys step, Home " +
                "and End go to both ends; the sliders Turn and Tilt turn it.",
        );
        this.canvas.addEventListener("keydown", (event) => page.onKey(event));
        this.poses = page.data.runs.map((run) => new SpacePoses(page.data, run));
        this.findOutlines();
        this.findSize();
        this.trails = this.poses.map((poses) => this.tracePoints(poses));
        this.table = placesTable(page, this.poses, SPACE_PLACE_HEADS);
        this.listen();
    }

    // The points of each body that its rods go through, in its frame.
    findOutlines() {
        this.outlines = this.data.bodies.map(() => []);
        this.data.joints.forEach((joint, i) => {
            for (const [body, anchor, isPin] of [
                [joint.body_a, joint.space_a_m, false],
                [joint.body_b, joint.space_b_m, joint.has_play],
            ]) {
                if (body !== GROUND) {
                    this.outlines[body].push({ local: anchor, joint: isPin ? i : null });
                }
            }
        });
        this.outlines.forEach((outline) => {
            if (outline.length < 2) {
                outline.push({ local: [0, 0, 0], joint: null });
            }
        });
    }

    findSize() {
        const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
        this.forceMost = 0;
        const take = (point) =>
            point.forEach((value, i) => {
                low[i] = Math.min(low[i], value);
                high[i] = Math.max(high[i], value);
            });
        for (const poses of this.poses) {
            const stride = Math.max(1, Math.floor(poses.count / FIT_SAMPLES));
            for (let k = 0; k < poses.count; k += stride) {
                poses.set(poses.run.from_s + k * poses.run.interval_s);
                this.outlines.forEach((outline, i) =>
                    outline.forEach(({ local }) => take(poses.point(i, local))),
                );
                for (const force of poses.forces) {
                    this.forceMost = Math.max(this.forceMost, Math.hypot(...force));
                }
            }
        }
        this.data.joints
            .filter((joint) => joint.body_a === GROUND)
            .forEach((joint) => take(joint.space_a_m));
        this.centre = low.map((value, i) => (value + high[i]) / 2 || 0);
        this.half = low.map((value, i) => (high[i] - value) / 2 || 0);
        this.extent = 2 * Math.hypot(...this.half) || 0.1;
        const plays = this.data.joints.map((joint) => joint.clearance_m).filter((play) => play > 0);
        this.play = plays.length > 0 ? Math.max(...plays) : 0;
        this.usualMagnification = this.play > 0 ? Math.max(1, (0.03 * this.extent) / this.play) : 1;
    }

    tracePoints(poses) {
        const count = Math.min(poses.count, 1500);
        const stride = (poses.count - 1) / Math.max(1, count - 1);
        const moving = this.data.bodies.flatMap((body, i) => (body.is_driven ? [] : [i]));
        const trail = moving.map(() => []);
        for (let i = 0; i < count; i++) {
            poses.set(poses.run.from_s + Math.round(i * stride) * poses.run.interval_s);
            moving.forEach((body, k) => trail[k].push(poses.point(body, [0, 0, 0])));
        }
        return trail;
    }

    // Turning by hand: a drag, and two sliders for the keyboard.
    listen() {
        let start = null;
        this.canvas.addEventListener("pointerdown", (event) => {
            this.canvas.setPointerCapture(event.pointerId);
            start = { x: event.clientX, y: event.clientY, yaw: this.yaw, pitch: this.pitch };
        });
        this.canvas.addEventListener("pointermove", (event) => {
            if (start !== null) {
                this.turnTo(
                    start.yaw + 0.01 * (event.clientX - start.x),
                    start.pitch + 0.01 * (event.clientY - start.y),
                );
            }
        });
        for (const name of ["pointerup", "pointercancel"]) {
            this.canvas.addEventListener(name, () => {
                start = null;
            });
        }
    }

    turnTo(yaw, pitch) {
        this.yaw = Math.atan2(Math.sin(yaw), Math.cos(yaw));
        this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, pitch));
        for (const [slider, angle] of this.sliders || []) {
            slider.value = String(Math.round(this[angle] * DEG));
        }
        this.draw();
    }

    makeTurning() {
        const make = (words, angle, most) => {
            const slider = element("input", {
                type: "range",
                min: String(-most),
                max: String(most),
                className: "short",
            });
            slider.value = String(Math.round(this[angle] * DEG));
            slider.addEventListener("input", () => {
                const value = Number(slider.value) / DEG;
                this.turnTo(
                    angle === "yaw" ? value : this.yaw,
                    angle === "pitch" ? value : this.pitch,
                );
            });
            return [slider, angle, element("label", {}, words + " ", slider)];
        };
        this.sliders = [make("Turn", "yaw", 180), make("Tilt", "pitch", 90)];
        return this.sliders.map(([, , label]) => label);
    }

    // A point of the world on the screen: x to the right and y up, turned about y, then tilted.
    project(point) {
        const [x, y, z] = added(point, this.centre, -1);
        const [c, s] = [Math.cos(this.yaw), Math.sin(this.yaw)];
        const [right, away] = [c * x + s * z, c * z - s * x];
        const [cp, sp] = [Math.cos(this.pitch), Math.sin(this.pitch)];
        return [
            this.middle[0] + right * this.scale,
            this.middle[1] - (cp * y - sp * away) * this.scale,
            sp * y + cp * away,
        ];
    }

    // How wide and high the box about the motion is as it is turned, m.
    seenSize() {
        const [x, y, z] = this.half;
        const [c, s] = [Math.cos(this.yaw), Math.sin(this.yaw)].map(Math.abs);
        const [cp, sp] = [Math.cos(this.pitch), Math.sin(this.pitch)].map(Math.abs);
        return [2 * (c * x + s * z), 2 * (cp * y + sp * (c * z + s * x))];
    }

    layOut() {
        const width = this.canvas.clientWidth;
        this.canvas.style.height = SPACE_HEIGHT + "px";
        this.canvas.style.touchAction = "none";
        const [wide, high] = this.seenSize();
        const least = 0.2 * this.extent; // where the mechanism is seen along itself
        this.scale = Math.min(
            (width - 2 * SPACE_MARGIN) / Math.max(least, wide),
            (SPACE_HEIGHT - 2 * SPACE_MARGIN) / Math.max(least, high),
        );
        this.middle = [width / 2, SPACE_HEIGHT / 2];
        this.pin = Math.max(PIN_LEAST, Math.min(PIN_MOST, PIN_SHARE * this.extent * this.scale));
        this.context = prepareCanvas(this.canvas, width, SPACE_HEIGHT);
        this.cell = { left: 0, top: 0 };
        this.size = { cellWidth: width, height: SPACE_HEIGHT };
    }

    draw() {
        if (this.canvas.clientWidth === 0) {
            return;
        }
        this.layOut();
        const shown = this.poses.filter((poses) => this.page.shown.has(poses.run.backend));
        shown.forEach((poses) => poses.set(this.page.time));
        const main = shown.find((poses) => poses.run.is_truth) || shown[shown.length - 1];
        this.drawAxes();
        this.drawScale();
        if (main === undefined) {
            return;
        }
        if (this.page.hasTrails) {
            this.poses.forEach((poses, i) => {
                if (shown.includes(poses)) {
                    this.trails[i].forEach((points) =>
                        this.path(points, colourOf(poses.run.backend), 1, 0.45),
                    );
                }
            });
        }
        this.drawBodies(main, true);
        shown.filter((poses) => poses !== main).forEach((poses) => this.drawBodies(poses, false));
        this.drawJoints(main);
        if (this.page.arrows !== "off") {
            shown.forEach((poses) => this.drawArrows(poses));
        }
        if (this.hasNames) {
            this.drawNames(main);
        }
    }

    // Names of joints at their places, and of bodies in the middle of their rods.
    drawNames(poses) {
        const taken = [];
        const onScreen = (point) => this.project(point).slice(0, 2);
        this.data.joints.forEach((joint) => {
            const at = onScreen(poses.point(joint.body_a, joint.space_a_m));
            this.drawName(taken, joint.name, at, colourOf("ink"));
        });
        this.outlines.forEach((outline, i) => {
            const points = outline.map((point) => onScreen(this.drawn(poses, i, point)));
            const middle = [0, 1].map(
                (k) => points.reduce((sum, point) => sum + point[k], 0) / points.length,
            );
            this.drawName(taken, this.data.bodies[i].name, middle, colourOf("soft"));
        });
    }

    path(points, colour, width, opacity) {
        const { context } = this;
        context.globalAlpha = opacity;
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.lineCap = "round";
        context.lineJoin = "round";
        context.beginPath();
        points.forEach((point) => context.lineTo(...this.project(point).slice(0, 2)));
        context.stroke();
        context.globalAlpha = 1;
    }

    // Where a point of an outline is drawn: a pin moved by its magnified play.
    drawn(poses, body, { local, joint }) {
        const point = poses.point(body, local);
        return joint === null
            ? point
            : added(point, poses.offsets[joint], this.page.magnification - 1);
    }

    // Rods from the middle of a body's joints to each of them, those behind first.
    drawBodies(poses, isMain) {
        const rods = this.outlines.map((outline, i) => {
            const points = outline.map((point) => this.drawn(poses, i, point));
            const middle = [0, 1, 2].map(
                (k) => points.reduce((sum, point) => sum + point[k], 0) / points.length,
            );
            return { body: i, points, middle, depth: this.project(middle)[2] };
        });
        rods.sort((a, b) => a.depth - b.depth);
        for (const { body, points, middle } of rods) {
            const colour = isMain
                ? colourOf(this.data.bodies[body].is_driven ? "driven" : "link" + (body % 4))
                : colourOf(poses.run.backend);
            points.forEach((point) =>
                this.path([middle, point], colour, isMain ? 1.3 * this.pin : 1.6, isMain ? 0.8 : 1),
            );
        }
    }

    // Each joint along its axis; a hole with play as an open ring, with its pin inside.
    drawJoints(poses) {
        const { context } = this;
        this.data.joints.forEach((joint, i) => {
            const at = poses.point(joint.body_a, joint.space_a_m);
            const axis = poses.direction(joint.body_a, joint.axis_a);
            const half = Math.max(0.5 * (joint.width_m || 0), 0.03 * this.extent);
            this.path(
                [added(at, axis, -half), added(at, axis, half)],
                colourOf("frame"),
                joint.body_a === GROUND || joint.body_b === GROUND ? 5 : 3,
                0.9,
            );
            if (joint.has_play) {
                const pin = added(at, poses.offsets[i], this.page.magnification);
                const [x, y] = this.project(pin);
                context.beginPath();
                context.arc(x, y, 0.7 * this.pin, 0, 2 * Math.PI);
                context.fillStyle = colourOf(poses.run.backend);
                context.fill();
                const [hx, hy] = this.project(at);
                context.beginPath();
                context.arc(
                    hx,
                    hy,
                    0.7 * this.pin + joint.clearance_m * this.scale * this.page.magnification,
                    0,
                    2 * Math.PI,
                );
                context.strokeStyle = colourOf("ink");
                context.lineWidth = 1.6;
                context.stroke();
            }
        });
    }

    drawArrows(poses) {
        this.data.joints.forEach((joint, i) => {
            const size = Math.hypot(...poses.forces[i]);
            const share =
                this.page.arrows === "linear"
                    ? size / this.forceMost
                    : size > 0
                      ? Math.max(0, 1 + Math.log10(size / this.forceMost) / 3)
                      : 0;
            if (!(share > 0.01)) {
                return;
            }
            const from = poses.point(joint.body_a, joint.space_a_m);
            const to = added(from, poses.forces[i], (0.26 * this.extent * share) / size);
            this.path([from, to], colourOf(poses.run.backend), 2.5, 1);
            const [x, y] = this.project(to);
            this.context.fillStyle = colourOf(poses.run.backend);
            this.context.beginPath();
            this.context.arc(x, y, 4, 0, 2 * Math.PI);
            this.context.fill();
        });
    }

    // The world's axes, in a corner.
    drawAxes() {
        const { context } = this;
        const corner = [44, SPACE_HEIGHT - 44];
        const zero = this.project(this.centre);
        ["x", "y", "z"].forEach((name, i) => {
            const axis = [0, 1, 2].map((k) => (k === i ? 30 / this.scale : 0));
            const end = this.project(added(this.centre, axis, 1));
            const [x, y] = [corner[0] + end[0] - zero[0], corner[1] + end[1] - zero[1]];
            context.strokeStyle = colourOf("soft");
            context.fillStyle = colourOf("soft");
            context.lineWidth = 1.5;
            context.beginPath();
            context.moveTo(...corner);
            context.lineTo(x, y);
            context.stroke();
            context.textAlign = "center";
            context.textBaseline = "middle";
            context.fillText(name, x + 0.25 * (x - corner[0]), y + 0.25 * (y - corner[1]));
        });
    }
}
