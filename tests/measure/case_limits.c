// Random mechanisms whose joints have backlash or stops: chains of hinges, blocks on lines with a
// pendulum, trains of gears.
#include "random_case.h"
#include "random_draw.h"

enum { LINKS_MOST = 3, GEARS_MOST = 4 };

static const double DEGREES = 180.0 / M_PI;

// A stiffness at which a mass or inertia rings with 20 Hz to 2 kHz, and a restitution or a damper.
static void write_contact(Draw *draw, double inertia, bool is_angle, FILE *file)
{
    const double rate = 2.0 * M_PI * draw_log_between(draw, 20.0, 2000.0);
    const double stiffness = inertia * rate * rate;
    fprintf(file, ", stiffness: %.4g %s", stiffness, is_angle ? "N m/rad" : "N/m");
    if (draw_chance(draw, 0.3)) {
        fprintf(file, ", viscous-coefficient: %.4g %s",
                draw_log_between(draw, 0.01, 2.0) * stiffness / rate,
                is_angle ? "N m s/rad" : "N s/m");
    } else {
        fprintf(file, ", restitution: %.3g", draw_between(draw, 0.2, 0.95));
    }
}

// A backlash, mostly from its middle, in a unit of which there are so many.
static void write_backlash(Draw *draw, double gap, const char *unit, FILE *file)
{
    fprintf(file, ", backlash: %.9g %s", gap, unit);
    if (draw_chance(draw, 0.4)) {
        fprintf(file, ", start: %.6g %s", draw_between(draw, -0.499, 0.499) * gap, unit);
    }
}

// Backlash, or stops about where the coordinate starts; nothing at times.
static void write_limits(Draw *draw, double at, double size, double inertia, bool is_angle,
                         FILE *file)
{
    const char *unit = is_angle ? "deg" : "mm";
    const size_t which = draw_below(draw, 4);
    if (which == 0) {
        return;
    }
    if (which == 1) {
        write_backlash(draw, size * draw_log_between(draw, 1e-4, 0.1), unit, file);
    } else {
        const double below = size * draw_log_between(draw, 1e-3, 0.5);
        const double above = size * draw_log_between(draw, 1e-3, 0.5);
        if (which == 2 || draw_chance(draw, 0.5)) {
            fprintf(file, ", low: %.9g %s", at - below, unit);
        }
        if (which == 2 || draw_chance(draw, 0.5)) {
            fprintf(file, ", high: %.9g %s", at + above, unit);
        } else {
            fprintf(file, ", high: %.9g %s", at + 0.9 * above, unit);
        }
    }
    write_contact(draw, inertia, is_angle, file);
}

static void write_body(const char *name, size_t number, double mass, double inertia, Point at,
                       double angle, FILE *file)
{
    fprintf(file,
            "  %s-%zu: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [%.15g m, %.15g m], angle: %.12g "
            "deg",
            name, number, mass, 1e6 * inertia, at.x, at.y, angle * DEGREES);
}

static void write_ending(Draw *draw, bool is_driven, FILE *file)
{
    draw_contact(draw, file);
    draw_run(draw, is_driven ? "revolutions: 1" : "duration: 0.1 s", file);
}

// Links that hang or lie anyhow, with backlash or stops in their hinges.
static void write_chain(Draw *draw, FILE *file)
{
    const size_t count = 1 + draw_below(draw, LINKS_MOST);
    const bool is_driven = count > 1 && draw_chance(draw, 0.3);
    double angles[LINKS_MOST];
    double inertias[LINKS_MOST];
    Point pins[LINKS_MOST];
    Point at = {0.0, 0.0};
    for (size_t i = 0; i < count; i++) {
        const double length = draw_log_between(draw, 0.05, 0.4);
        const double mass = length * draw_log_between(draw, 0.3, 5.0);
        angles[i] = draw_between(draw, -M_PI, M_PI);
        inertias[i] = mass * length * length / 12.0;
        pins[i] = at;
        const Point centre = {at.x + 0.5 * length * cos(angles[i]),
                              at.y + 0.5 * length * sin(angles[i])};
        write_body("link", i, mass, inertias[i], centre, angles[i], file);
        fprintf(file, "}\n");
        at = (Point){at.x + length * cos(angles[i]), at.y + length * sin(angles[i])};
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < count; i++) {
        fprintf(file, "  hinge-%zu: {between: [", i);
        if (i == 0) {
            fprintf(file, "ground");
        } else {
            fprintf(file, "link-%zu", i - 1);
        }
        fprintf(file, ", link-%zu], at: [%.15g m, %.15g m]", i, pins[i].x, pins[i].y);
        if (i > 0 || !is_driven) {
            const double angle = angles[i] - (i > 0 ? angles[i - 1] : 0.0);
            write_limits(draw, angle * DEGREES, 60.0, inertias[i], true, file);
        }
        fprintf(file, "}\n");
    }
    if (is_driven) {
        fprintf(file, "drive: {joint: hinge-0, speed: %.5g rpm}\n", draw_speed_rpm(draw));
    } else if (draw_chance(draw, 0.5)) {
        const double end = draw_between(draw, -2.0, 2.0);
        fprintf(file, "drive: {joint: hinge-%zu, torque: [[0 s, %.4g N m], [0.1 s, %.4g N m]]}\n",
                count - 1, draw_between(draw, -2.0, 2.0), end);
    }
    write_ending(draw, is_driven, file);
}

// A block on a line, of which a pendulum hangs.
static void write_block(Draw *draw, FILE *file)
{
    const double length = draw_log_between(draw, 0.05, 0.3);
    const double mass = draw_log_between(draw, 0.05, 2.0);
    const double along = draw_between(draw, -M_PI, M_PI);
    const double angle = draw_between(draw, -M_PI, M_PI);
    const Point centre = {0.5 * length * cos(angle), 0.5 * length * sin(angle)};
    const double inertia = 0.3 * mass * length * length;
    const double speed = draw_between(draw, -1.0, 1.0);
    write_body("block", 0, mass, 1e-3 * mass, (Point){0.0, 0.0}, 0.0, file);
    fprintf(file, ", velocity: [%.12g m/s, %.12g m/s]}\n", speed * cos(along), speed * sin(along));
    write_body("bob", 0, mass, inertia, centre, angle, file);
    fprintf(file, ", velocity: [%.12g m/s, %.12g m/s]}\njoints:\n", speed * cos(along),
            speed * sin(along));
    fprintf(file, "  line: {between: [ground, block-0], at: [0 m, 0 m], along: %.12g deg",
            along * DEGREES);
    write_limits(draw, 0.0, 50.0, mass, false, file);
    fprintf(file, "}\n  pin: {between: [block-0, bob-0], at: [0 m, 0 m]");
    write_limits(draw, angle * DEGREES, 60.0, inertia, true, file);
    fprintf(file, "}\n");
    if (draw_chance(draw, 0.3)) {
        fprintf(file, "drive: {joint: line, force: [[0 s, %.4g N], [50 ms, 0 N]]}\n",
                draw_between(draw, -50.0, 50.0));
    }
    write_ending(draw, false, file);
}

// Wheels in a row that turn one another.
static void write_gears(Draw *draw, FILE *file)
{
    const size_t count = 2 + draw_below(draw, GEARS_MOST - 1);
    const bool is_driven = draw_chance(draw, 0.5);
    int teeth[GEARS_MOST];
    double inertias[GEARS_MOST];
    double at[GEARS_MOST];
    const double module = draw_log_between(draw, 5e-4, 4e-3);
    for (size_t i = 0; i < count; i++) {
        teeth[i] = 12 + (int)draw_below(draw, 60);
        const double radius = 0.5 * module * teeth[i];
        const double mass = 7800.0 * M_PI * radius * radius * 0.01;
        inertias[i] = 0.5 * mass * radius * radius * draw_log_between(draw, 0.5, 5.0);
        at[i] = i == 0 ? 0.0 : at[i - 1] + 0.5 * module * (teeth[i] + teeth[i - 1]);
        write_body("wheel", i, mass, inertias[i], (Point){at[i], 0.0}, 0.0, file);
        if (is_driven) {
            fprintf(file, "}\n");
        } else {
            fprintf(file, ", spin: %.5g rad/s}\n", draw_between(draw, -20.0, 20.0));
        }
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < count; i++) {
        fprintf(file, "  pivot-%zu: {between: [ground, wheel-%zu], at: [%.15g m, 0 m]}\n", i, i,
                at[i]);
    }
    for (size_t i = 0; i + 1 < count; i++) {
        const double radius = 0.5 * module * teeth[i];
        fprintf(file, "  mesh-%zu: {gears: [pivot-%zu, pivot-%zu], teeth: [%d, %d]", i, i, i + 1,
                teeth[i], teeth[i + 1]);
        write_backlash(draw, 1e3 * module * draw_log_between(draw, 1e-3, 0.3), "mm", file);
        write_contact(draw, inertias[i] / (radius * radius), false, file);
        fprintf(file, "}\n");
    }
    if (is_driven) {
        fprintf(file, "drive: {joint: pivot-0, speed: %.5g rpm}\n", draw_speed_rpm(draw));
    } else if (draw_chance(draw, 0.5)) {
        fprintf(file, "drive: {joint: pivot-0, torque: %.4g N m}\n", draw_between(draw, -1.0, 1.0));
    }
    if (draw_chance(draw, 0.5)) {
        fprintf(file, "torsion-springs:\n  brake: {joint: pivot-%zu, damping: %.4g N mm s/rad}\n",
                count - 1, draw_log_between(draw, 0.01, 10.0));
    }
    write_ending(draw, is_driven, file);
}

static void write_case(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    fprintf(file, "title: Random limits %llu\nbodies:\n", (unsigned long long)seed);
    switch (draw_below(&draw, 3)) {
    case 0:
        write_chain(&draw, file);
        break;
    case 1:
        write_block(&draw, file);
        break;
    default:
        write_gears(&draw, file);
    }
}

const CaseKind CASE_LIMITS = {
    .name = "limits",
    .summary = "chains of hinges, blocks on lines and gears with backlash and stops",
    .write = write_case,
};
