// Random pins in slots: a loose puck in a slot of the ground, a crank's pin in the slot of a slider
// or of a rocker, driven or free, a body that hangs in the slot of a swinging lever, and a pendulum
// whose pin plays in a slot of the ground. Slots from a tenth of a millimetre long on; ends are
// reached by the loose ones.
#include "random_case.h"
#include "random_draw.h"

static const double DEGREES = 180.0 / M_PI;

typedef struct SlotCase {
    Draw draw;
    double pin;       // m, radius
    double clearance; // m
    double mass;      // kg
    double stiffness; // N/m
} SlotCase;

static SlotCase draw_slot(uint64_t seed)
{
    SlotCase slot = {.draw = draw_start(seed)};
    Draw *draw = &slot.draw;
    slot.pin = draw_log_between(draw, 0.002, 0.008);
    slot.clearance = draw_log_between(draw, 1e-5, 1e-3);
    slot.mass = draw_log_between(draw, 0.05, 2.0);
    const double rate = 2.0 * M_PI * draw_log_between(draw, 200.0, 2000.0);
    slot.stiffness = slot.mass * rate * rate;
    return slot;
}

// The slot's middle and the pin's centre, in the world, and the direction along it, rad.
static void write_slot(SlotCase *slot, Point middle, Point pin, double along, double length,
                       FILE *file)
{
    fprintf(file,
            "at-a: [%.15g m, %.15g m], at-b: [%.15g m, %.15g m],\n    normal: %.15g deg, slot: "
            "[%.9g m, %.9g m], radius: %.9g m,\n    stiffness: %.5g N/m, restitution: %.3g}\n",
            middle.x, middle.y, pin.x, pin.y, along * DEGREES - 90.0, length,
            2.0 * (slot->pin + slot->clearance), slot->pin, slot->stiffness,
            draw_between(&slot->draw, 0.2, 0.9));
}

static void write_loose_end(SlotCase *slot, FILE *file)
{
    Draw *draw = &slot->draw;
    fprintf(file, "contact: {damping: hunt-crossley");
    if (draw_chance(draw, 0.4)) {
        fprintf(file, ", friction: %.3g, friction-speed: 20 mm/s", draw_between(draw, 0.02, 0.3));
    }
    fprintf(file, "}\n");
}

static double inertia_of(double mass, double size)
{
    return 0.5e6 * mass * size * size;
}

// A body with a pin in a slot of the ground.
static void write_puck(SlotCase *slot, FILE *file)
{
    Draw *draw = &slot->draw;
    const double length = draw_log_between(draw, 1e-4, 0.03);
    const double along = draw_between(draw, -M_PI, M_PI);
    const double speed = draw_log_between(draw, 0.05, 1.0);
    const double heading = draw_between(draw, -M_PI, M_PI);
    const double arm = draw_chance(draw, 0.5) ? 0.0 : draw_between(draw, 0.002, 0.02);
    const double way = draw_between(draw, -0.4, 0.4) * length;
    const Point pin = {way * cos(along), way * sin(along)};
    fprintf(file,
            "bodies:\n  puck: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m], "
            "velocity: [%.6g m/s, %.6g m/s], spin: %.6g rad/s}\njoints:\n  play: {between: "
            "[ground, puck], ",
            slot->mass, inertia_of(slot->mass, 0.02), pin.x + arm, pin.y, speed * cos(heading),
            speed * sin(heading), draw_between(draw, -20.0, 20.0));
    write_slot(slot, (Point){0.0, 0.0}, pin, along, length, file);
    write_loose_end(slot, file);
    draw_run(draw, "duration: 0.1 s", file);
}

// A crank whose pin moves a slider across its way, or a rocker.
static void write_crank(SlotCase *slot, bool is_rocker, FILE *file)
{
    Draw *draw = &slot->draw;
    const double radius = draw_log_between(draw, 0.01, 0.06);
    const double start = draw_between(draw, -M_PI, M_PI);
    const double speed = draw_log_between(draw, 50.0, 800.0);
    const size_t drive = draw_below(draw, 3);
    slot->stiffness *= 10.0; // what a drive pushes is stopped by no inertia of the pin's own
    const Point pin = {radius * cos(start), radius * sin(start)};
    const double depth = radius * draw_between(draw, 1.5, 3.0); // of the rocker's pivot
    const double to_pin = hypot(pin.x, pin.y + depth);
    const double along = is_rocker ? atan2(pin.y + depth, pin.x) : 0.5 * M_PI;
    const Point middle = {is_rocker ? pin.x * depth / to_pin : pin.x,
                          is_rocker ? (pin.y + depth) * depth / to_pin - depth : 0.0};
    fprintf(file, "bodies:\n  crank: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [0 m, 0 m]",
            slot->mass, inertia_of(slot->mass, 3.0 * radius));
    if (drive == 2) {
        fprintf(file, ", spin: %.6g rad/s", speed * M_PI / 30.0);
    }
    fprintf(file, "}\n");
    fprintf(file, "  moved: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]}\n",
            0.5 * slot->mass, inertia_of(slot->mass, radius), is_rocker ? 0.0 : middle.x,
            is_rocker ? -depth : 0.0);
    fprintf(file, "joints:\n  pivot: {between: [ground, crank], at: [0 m, 0 m]}\n");
    if (is_rocker) {
        fprintf(file, "  guide: {between: [ground, moved], at: [0 m, %.15g m]}\n", -depth);
    } else {
        fprintf(file, "  guide: {between: [ground, moved], at: [%.15g m, 0 m], along: 0 deg}\n",
                middle.x);
    }
    fprintf(file, "  play: {between: [moved, crank], ");
    write_slot(slot, middle, pin, along, radius * draw_between(draw, 2.1, 2.6), file);
    if (drive == 0) {
        fprintf(file, "drive: {joint: pivot, speed: %.6g rpm}\n", speed);
    } else if (drive == 1) {
        fprintf(file,
                "drive: {joint: pivot, speed: [[0 ms, 0 rpm], [20 ms, %.6g rpm], [60 ms, %.6g "
                "rpm]]}\n",
                speed, -0.3 * speed);
    }
    write_loose_end(slot, file);
    draw_run(draw, drive == 0 ? "revolutions: 1" : "duration: 0.1 s", file);
}

// A body that hangs in the slot of a lever that swings.
static void write_lever(SlotCase *slot, FILE *file)
{
    Draw *draw = &slot->draw;
    const double reach = draw_between(draw, 0.05, 0.15);
    const double length = draw_log_between(draw, 1e-3, 0.03);
    const double along = draw_between(draw, -M_PI, M_PI);
    const double lean = draw_between(draw, -M_PI, M_PI);
    const Point middle = {reach * cos(along), reach * sin(along)};
    const double way = draw_between(draw, -0.4, 0.4) * length;
    const Point pin = {middle.x + way * cos(lean), middle.y + way * sin(lean)};
    fprintf(file,
            "bodies:\n  lever: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [0 m, 0 m], spin: %.6g "
            "rad/s}\n",
            slot->mass, inertia_of(slot->mass, reach), draw_between(draw, -10.0, 10.0));
    fprintf(file,
            "  weight: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]}\n"
            "joints:\n  pivot: {between: [ground, lever], at: [0 m, 0 m]}\n  play: {between: "
            "[lever, weight], ",
            0.7 * slot->mass, inertia_of(slot->mass, 0.02), pin.x, pin.y - 0.01);
    write_slot(slot, middle, pin, lean, length, file);
    write_loose_end(slot, file);
    draw_run(draw, "duration: 0.1 s", file);
}

// A pendulum whose pin plays in a slot of the ground.
static void write_pendulum(SlotCase *slot, FILE *file)
{
    Draw *draw = &slot->draw;
    const double reach = draw_between(draw, 0.03, 0.15);
    const double length = draw_log_between(draw, 1e-3, 0.03);
    const double stands = draw_between(draw, -M_PI, M_PI);
    const double along = stands + 0.5 * M_PI + draw_between(draw, -0.3, 0.3);
    const Point pin = {reach * cos(stands), reach * sin(stands)};
    fprintf(file,
            "bodies:\n  arm: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [0 m, 0 m], spin: %.6g "
            "rad/s}\njoints:\n  pivot: {between: [ground, arm], at: [0 m, 0 m]}\n  play: {between: "
            "[ground, arm], ",
            slot->mass, inertia_of(slot->mass, reach), draw_between(draw, -20.0, 20.0));
    write_slot(slot, pin, pin, along, length, file);
    write_loose_end(slot, file);
    draw_run(draw, "duration: 0.1 s", file);
}

static void write_slots(uint64_t seed, FILE *file)
{
    SlotCase slot = draw_slot(seed);
    fprintf(file, "title: Random slot %llu\n", (unsigned long long)seed);
    switch (draw_below(&slot.draw, 5)) {
    case 0:
        write_puck(&slot, file);
        break;
    case 1:
        write_crank(&slot, false, file);
        break;
    case 2:
        write_crank(&slot, true, file);
        break;
    case 3:
        write_lever(&slot, file);
        break;
    default:
        write_pendulum(&slot, file);
    }
}

const CaseKind CASE_SLOTS = {
    .name = "slots",
    .summary = "pins in slots with ends: pucks, cranks, levers and pendula",
    .write = write_slots,
};
