// Random racks and pinions: on the ground or on a swinging frame, the pinion on a pivot or on a pin
// with play, the rack on its line or in guides with play, free, on a spring, under a torque or
// driven.
#include "random_case.h"
#include "random_draw.h"

static const double DEGREES = 180.0 / M_PI;

typedef struct RackCase {
    Draw draw;
    bool has_frame; // a body that swings about a point of the ground; else the ground
    bool is_driven;
    bool is_loose_pin;
    bool is_loose_guide;
    bool is_turned_round; // whether the joints name the frame second
    double along;         // rad, of the line
    double radius;        // m, signed: of the pinion, whose centre is to the left of the line
    double mass;          // kg, of the rack
    double inertia;       // kg m^2, of the pinion
    Point pitch;          // where both meet at time zero
    Point centre;         // of the pinion
} RackCase;

static Point beside(const RackCase *rack, Point from, double along, double across)
{
    const double c = cos(rack->along);
    const double s = sin(rack->along);
    return (Point){from.x + along * c - across * s, from.y + along * s + across * c};
}

static RackCase draw_rack(uint64_t seed)
{
    RackCase rack = {.draw = draw_start(seed)};
    Draw *draw = &rack.draw;
    rack.has_frame = draw_chance(draw, 0.4);
    rack.is_driven = !rack.has_frame && draw_chance(draw, 0.4);
    rack.is_loose_pin = !rack.is_driven && draw_chance(draw, 0.35);
    rack.is_loose_guide = draw_chance(draw, 0.35);
    rack.is_turned_round = draw_chance(draw, 0.5);
    rack.along = draw_between(draw, -M_PI, M_PI);
    rack.radius = (draw_chance(draw, 0.5) ? 1.0 : -1.0) * draw_log_between(draw, 0.008, 0.1);
    rack.mass = draw_log_between(draw, 0.05, 5.0);
    rack.inertia = rack.radius * rack.radius * draw_log_between(draw, 0.03, 3.0);
    rack.pitch = (Point){draw_between(draw, -0.05, 0.05), draw_between(draw, -0.05, 0.05)};
    rack.centre = beside(&rack, rack.pitch, 0.0, rack.radius);
    return rack;
}

static void write_bodies(RackCase *rack, FILE *file)
{
    Draw *draw = &rack->draw;
    const Point at =
        beside(rack, rack->pitch, draw_between(draw, -0.05, 0.05), draw_between(draw, -0.02, 0.02));
    const double spin = rack->has_frame || rack->is_driven ? 0.0 : draw_between(draw, -30.0, 30.0);
    const double speed = rack->has_frame || draw_chance(draw, 0.5) ? 0.0 : -spin * rack->radius;
    fprintf(file, "  rack: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [%.15g m, %.15g m]",
            rack->mass, 1e3 * rack->mass, at.x, at.y);
    fprintf(file, ", velocity: [%.12g m/s, %.12g m/s]}\n", speed * cos(rack->along),
            speed * sin(rack->along));
    fprintf(file, "  pinion: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]",
            0.5 * rack->mass, 1e6 * rack->inertia, rack->centre.x, rack->centre.y);
    if (!rack->is_driven) {
        fprintf(file, ", spin: %.6g rad/s", spin);
    }
    fprintf(file, "}\n");
    if (rack->has_frame) {
        fprintf(file, "  frame: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [0.06 m, -0.1 m]}\n",
                2.0 * rack->mass, 2e4 * rack->mass);
    }
}

static void write_between(const RackCase *rack, const char *body, Point at, FILE *file)
{
    const char *frame = rack->has_frame ? "frame" : "ground";
    fprintf(file, "{between: [%s, %s], at: [%.15g m, %.15g m]",
            rack->is_turned_round ? body : frame, rack->is_turned_round ? frame : body, at.x, at.y);
}

static void write_stiffness(Draw *draw, double mass, FILE *file)
{
    const double rate = 2.0 * M_PI * draw_log_between(draw, 100.0, 2000.0);
    fprintf(file, ", stiffness: %.5g N/m, restitution: %.3g", mass * rate * rate,
            draw_between(draw, 0.2, 0.95));
}

static void write_joints(RackCase *rack, FILE *file)
{
    Draw *draw = &rack->draw;
    if (rack->has_frame) {
        fprintf(file, "  swing: {between: [ground, frame], at: [0.05 m, 0.04 m]}\n");
    }
    fprintf(file, "  line: ");
    write_between(rack, "rack", rack->pitch, file);
    fprintf(file, ", along: %.15g deg", rack->along * DEGREES);
    if (rack->is_loose_guide) {
        fprintf(file, ", guide: 10.05 mm, block: 10 mm, length: %.5g mm",
                draw_between(draw, 15.0, 60.0));
        write_stiffness(draw, rack->mass, file);
    }
    fprintf(file, "}\n  pivot: ");
    write_between(rack, "pinion", rack->centre, file);
    if (rack->is_loose_pin) {
        fprintf(file, ", radial-clearance: %.5g um", draw_log_between(draw, 2.0, 200.0));
        write_stiffness(draw, rack->mass, file);
    }
    const double inertial = rack->inertia / (rack->radius * rack->radius);
    fprintf(file, "}\n  mesh: {rack: [line, pivot], backlash: %.6g mm",
            draw_log_between(draw, 1e-3, 0.3));
    write_stiffness(draw, inertial * rack->mass / (inertial + rack->mass), file);
    fprintf(file, "}\n");
}

static void write_springs(RackCase *rack, FILE *file)
{
    Draw *draw = &rack->draw;
    if (draw_chance(draw, 0.5)) {
        const Point from = beside(rack, rack->pitch, 0.2, 0.0);
        const double rate = 2.0 * M_PI * draw_log_between(draw, 3.0, 30.0);
        fprintf(
            file,
            "springs:\n  coil: {between: [ground, rack], at-a: [%.9g m, %.9g m], at-b: [%.9g m, "
            "%.9g m],\n    stiffness: %.5g N/m, length: %.5g m}\n",
            from.x, from.y, rack->pitch.x, rack->pitch.y, rack->mass * rate * rate,
            draw_between(draw, 0.18, 0.22));
    }
}

static void write_racks(uint64_t seed, FILE *file)
{
    RackCase rack = draw_rack(seed);
    Draw *draw = &rack.draw;
    fprintf(file, "title: Random rack %llu\nbodies:\n", (unsigned long long)seed);
    write_bodies(&rack, file);
    fprintf(file, "joints:\n");
    write_joints(&rack, file);
    write_springs(&rack, file);
    const double speed = draw_between(draw, 100.0, 600.0);
    const double torque = rack.inertia * draw_log_between(draw, 10.0, 3e3);
    if (rack.is_driven) {
        fprintf(file,
                "drive: {joint: pivot, speed: [[0 ms, %.5g rpm], [20 ms, %.5g rpm], [40 ms, %.5g "
                "rpm], [100 ms, 0 rpm]]}\n",
                speed, -speed, 0.5 * speed);
    } else if (!rack.is_loose_pin && draw_chance(draw, 0.4)) {
        fprintf(file, "drive: {joint: pivot, torque: [[0 s, %.5g N m], [20 ms, %.5g N m]]}\n",
                torque, -0.5 * torque);
    }
    fprintf(file, "contact: {damping: hunt-crossley}\n");
    draw_run(draw, "duration: 0.1 s", file);
}

const CaseKind CASE_RACKS = {
    .name = "racks",
    .summary = "racks and pinions, fixed or on a frame, with play at their pins and guides",
    .write = write_racks,
};
