// Draws the parts of a mechanism in the plane: bearings, pins in their holes, blocks, springs,
// bushings, stops, limits, cams, gears, arrows; and names and the scale, in space as well.

const NAME_HEIGHT = 14; // pixels
const LIMIT_OPENING = 0.35; // rad, that a backlash is drawn as at least
const LIMIT_REACH = 4.5; // of a pin's radius: how long a stop of an angle is

class MechanismShapes {
    constructor() {
        this.hasNames = false;
        this.scaleLeft = 12; // pixels
    }

    makeNames() {
        const act = (isOn) => {
            this.hasNames = isOn;
            this.draw();
        };
        return [this.page.check("names", this.hasNames, act)];
    }

    line(points, isClosed) {
        this.context.beginPath();
        points.forEach((point) => this.context.lineTo(...this.toScreen(point)));
        if (isClosed) {
            this.context.closePath();
        }
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

    // Blocks first, for pins are in them.
    drawJoints(poses, isMain) {
        const colour = isMain ? colourOf("ink") : colourOf(poses.run.backend);
        this.data.joints.forEach((joint, i) => {
            if (joint.slides && joint.touches !== "hole") {
                this.drawBlock(poses, joint, i, isMain, colour);
            }
        });
        this.data.joints.forEach((joint, i) => {
            if (joint.touches === "hole") {
                this.drawPin(poses, joint, i, isMain, colour);
            } else if (joint.slides) {
                return; // is there
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
        context.rect(-2.6 * pin, -1.6 * pin, 5.2 * pin, 3.2 * pin);
        context.restore();
        context.strokeStyle = colour;
        context.lineWidth = 1.8;
        if (isMain) {
            context.fillStyle = colourOf("paper");
            context.fill();
            context.fillStyle = this.bodyColour(joint.body_b);
            context.globalAlpha = 0.5;
            context.fill();
            context.globalAlpha = 1;
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
        context.lineWidth = isMain ? 2.8 : 1.2;
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

    bodyColour(body) {
        const isDriven = body !== GROUND && this.data.bodies[body].is_driven;
        return colourOf(body === GROUND ? "frame" : isDriven ? "driven" : "link" + (body % 4));
    }

    // Stops and flanks of the joints whose coordinate they limit.
    drawLimits(poses) {
        this.data.joints.forEach((joint, i) => {
            const at = joint.limit ? poses.coordinate(i) : NaN;
            if (Number.isFinite(at) && joint.pivots) {
                this.drawAngleLimits(poses, joint, at);
            } else if (Number.isFinite(at) && joint.slides) {
                this.drawWayLimits(poses, joint, at);
            }
        });
    }

    // A bar at each stop, where the hand of the second body would press it, and the arc between; a
    // backlash opened wide enough to be seen.
    drawAngleLimits(poses, joint, angle) {
        const { context } = this;
        const { low, high } = joint.limit;
        const width = high - low;
        const opened =
            joint.limit.kind === "backlash" && width > 0
                ? Math.max(1, LIMIT_OPENING / width)
                : 1;
        const hand = this.handAngle(poses, joint);
        const [x, y] = this.toScreen(poses.point(joint.body_b, joint.anchor_b_m));
        const reach = LIMIT_REACH * this.pin;
        const ends = [low, high].map((limit) =>
            limit === null ? NaN : hand + opened * (limit - angle),
        );
        context.strokeStyle = colourOf("ink");
        context.lineWidth = 2.5;
        for (const end of ends.filter((one) => Number.isFinite(one))) {
            context.beginPath();
            context.moveTo(x + 0.6 * reach * Math.cos(end), y - 0.6 * reach * Math.sin(end));
            context.lineTo(x + 1.4 * reach * Math.cos(end), y - 1.4 * reach * Math.sin(end));
            context.stroke();
        }
        if (ends.every((one) => Number.isFinite(one)) && ends[1] - ends[0] < 2 * Math.PI) {
            context.lineWidth = 1;
            context.beginPath();
            context.arc(x, y, reach, -ends[1], -ends[0]);
            context.stroke();
        }
    }

    // The direction in which a body stands out from its joint.
    handAngle(poses, joint) {
        const [x, y] = poses.point(joint.body_b, joint.anchor_b_m);
        const outline = joint.body_b === GROUND ? [] : this.outlines[joint.body_b];
        const far = (local) => {
            const point = poses.point(joint.body_b, local);
            return [point[0] - x, point[1] - y];
        };
        const best = outline
            .map(far)
            .reduce((most, one) => (Math.hypot(...one) > Math.hypot(...most) ? one : most), [0, 0]);
        return Math.hypot(...best) > 0 ? Math.atan2(best[1], best[0]) : poses.angle(joint.body_b);
    }

    // A bar across the line of a slider at each of its stops, half a block further.
    drawWayLimits(poses, joint, way) {
        const { context, pin } = this;
        const at = this.toScreen(poses.point(joint.body_b, joint.anchor_b_m));
        const angle = poses.angle(joint.body_a) + joint.direction_rad;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        context.strokeStyle = colourOf("ink");
        context.lineWidth = 2.5;
        for (const [limit, side] of [
            [joint.limit.low, -1],
            [joint.limit.high, 1],
        ]) {
            if (limit !== null) {
                const along = (limit - way) * this.scale + side * 2.6 * pin;
                const [x, y] = [at[0] + along * c, at[1] - along * s];
                context.beginPath();
                context.moveTo(x - 2 * pin * s, y - 2 * pin * c);
                context.lineTo(x + 2 * pin * s, y + 2 * pin * c);
                context.stroke();
            }
        }
    }

    // Words with a rim, so that they can be read over lines.
    words(text, x, y, align, colour) {
        const { context } = this;
        context.textAlign = align;
        context.textBaseline = "middle";
        context.strokeStyle = colourOf("panel");
        context.lineWidth = 4;
        context.lineJoin = "round";
        context.strokeText(text, x, y);
        context.fillStyle = colour;
        context.fillText(text, x, y);
    }

    // Names of bodies at their middles, and of joints, each where no other stands yet.
    drawNames(poses) {
        const taken = [];
        this.outlines.forEach((outline, i) => {
            const points = outline.map((local) => this.toScreen(poses.point(i, local)));
            const middle = [0, 1].map(
                (k) => points.reduce((sum, point) => sum + point[k], 0) / points.length,
            );
            this.drawName(taken, this.data.bodies[i].name, middle, colourOf("soft"));
        });
        for (const joint of this.data.joints) {
            const at = this.toScreen(poses.point(joint.body_b, joint.anchor_b_m));
            this.drawName(taken, joint.name, at, colourOf("ink"));
        }
    }

    drawName(taken, text, [x, y], colour) {
        const width = this.context.measureText(text).width;
        const by = 2.2 * this.pin;
        const places = [
            [x + by, y - by],
            [x + by, y + by + 4],
            [x - by - width, y - by],
            [x - by - width, y + by + 4],
            [x + by, y - by - NAME_HEIGHT],
            [x + by, y + by + 4 + NAME_HEIGHT],
            [x - width / 2, y - 2 * by - NAME_HEIGHT],
            [x - width / 2, y + 2 * by + NAME_HEIGHT],
        ];
        const isFree = ([left, top]) =>
            left > this.cell.left + 2 &&
            left + width < this.cell.left + this.size.cellWidth - 2 &&
            !taken.some(
                (other) =>
                    left < other.left + other.width + 4 &&
                    other.left < left + width + 4 &&
                    Math.abs(top - other.top) < NAME_HEIGHT,
            );
        const place = places.find(isFree);
        if (place !== undefined) {
            taken.push({ left: place[0], top: place[1], width });
            this.words(text, place[0], place[1], "left", colour);
        }
    }

    nameCell(name) {
        const colour = colourOf(name) || colourOf("ink");
        this.words(name, this.cell.left + 12, this.cell.top + 16, "left", colour);
    }

    // How long some length is that can be read, at the bottom.
    drawScale() {
        const { context } = this;
        const wanted = Math.min(120, 0.25 * this.size.cellWidth) / this.scale;
        const power = 10 ** Math.floor(Math.log10(wanted));
        const length = power * [5, 2, 1].find((number) => number * power <= wanted * 1.001);
        const [x, y] = [this.scaleLeft, this.size.height - 10];
        const end = x + length * this.scale;
        context.strokeStyle = colourOf("ink");
        context.lineWidth = 1.5;
        context.beginPath();
        context.moveTo(x, y - 5);
        context.lineTo(x, y);
        context.lineTo(end, y);
        context.lineTo(end, y - 5);
        context.stroke();
        const words =
            length >= 1 ? `${formatNumber(length)} m` : `${formatNumber(1000 * length)} mm`;
        this.words(words, end + 6, y - 3, "left", colourOf("ink"));
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
