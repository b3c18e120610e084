// Random mechanisms with something that slides or stops: slider-cranks, blocks on levers, balls.
#include "random_case.h"
#include "random_draw.h"

enum { BALLS_MOST = 4 };

// A stiffness of a block or a stop, which has no law.
static void write_stiffness(Draw *draw, FILE *file)
{
    if (draw_chance(draw, 0.5)) {
        fprintf(file, ", stiffness: %.4g N/m", draw_log_between(draw, 1e5, 1e9));
    } else {
        fprintf(file, ", stiffness: %.4g N/m^1.5", draw_log_between(draw, 1e7, 1e11));
    }
    if (draw_chance(draw, 0.3)) {
        fprintf(file, ", restitution: %.3g", draw_between(draw, 0.2, 0.95));
    }
}

// The play of a block between guides, or of a sleeve round a rod: mostly centred.
static void write_guide(Draw *draw, double size, FILE *file)
{
    const double opening = 1e3 * size * draw_between(draw, 0.1, 0.5);
    const double play = 1e-3 * draw_log_between(draw, 2.0, 500.0);
    const bool is_sleeve = draw_chance(draw, 0.3);
    const double length = 1e3 * size * draw_between(draw, 0.1, 0.8);
    fprintf(file, ",\n          guide: %.9g mm, block: %.9g mm, length: %.6g mm", opening,
            opening + (is_sleeve ? 2.0 : -2.0) * play, length);
    if (draw_chance(draw, 0.3)) {
        // half of the play each
        const double tilt = 0.4 * 2.0 * play / length * 180.0 / M_PI;
        const double turned = draw_between(draw, -1.0, 1.0) * tilt;
        fprintf(file, ", start: [%.6g mm, %.6g deg]", draw_between(draw, -0.5, 0.5) * play, turned);
    }
    write_stiffness(draw, file);
}

static void write_body(Draw *draw, const char *name, Point at, double size, double angle_deg,
                       FILE *file)
{
    const double mass = size * draw_log_between(draw, 0.3, 5.0);
    fprintf(file,
            "  %s: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [%.15g m, %.15g m], angle: %.12g "
            "deg}\n",
            name, mass, 1e6 * mass * size * size * draw_between(draw, 0.04, 0.15), at.x, at.y,
            angle_deg);
}

static void write_pin(Draw *draw, const char *name, const char *between, Point at, bool has_play,
                      FILE *file)
{
    fprintf(file, "  %s: {between: [%s], at: [%.15g m, %.15g m]", name, between, at.x, at.y);
    if (has_play) {
        fprintf(file, ", ");
        draw_play(draw, file);
    }
    fprintf(file, "}\n");
}

// By a speed, a torque at the crank or a force along the line; or by gravity alone.
static void write_drive(Draw *draw, bool has_ideal_line, FILE *file)
{
    const size_t which = draw_below(draw, 6);
    if (which == 0) {
        fprintf(file, "drive: {joint: main, torque: %.4g N m}\n",
                draw_log_between(draw, 0.01, 5.0));
    } else if (which == 1 && has_ideal_line) {
        fprintf(file, "drive: {joint: slide, force: [[0 s, %.4g N], [20 ms, 0 N]]}\n",
                draw_between(draw, -100.0, 100.0));
    } else if (which != 2) {
        fprintf(file, "drive: {joint: main, speed: %.5g rpm}\n", draw_speed_rpm(draw));
        draw_contact(draw, file);
        draw_run(draw, "revolutions: 1", file);
        return;
    }
    draw_contact(draw, file);
    draw_run(draw, "duration: 0.2 s", file);
}

// One point further along a line.
static Point along(Point from, double length, double angle)
{
    return (Point){from.x + length * cos(angle), from.y + length * sin(angle)};
}

static void write_slider_crank(Draw *draw, FILE *file)
{
    const double crank = draw_log_between(draw, 0.02, 0.2);
    const double rod = crank * draw_between(draw, 1.4, 4.0);
    const double offset = crank * (draw_chance(draw, 0.5) ? draw_between(draw, -0.3, 0.3) : 0.0);
    const double incline = draw_chance(draw, 0.5) ? draw_between(draw, -M_PI, M_PI) : 0.0;
    const double turned = draw_between(draw, -M_PI, M_PI);
    const Point pivot = {draw_between(draw, -0.3, 0.3), draw_between(draw, -0.3, 0.3)};
    const Point pin = along(pivot, crank, incline + turned);
    // across the line the wrist is off by the offset
    const double lift = asin((offset - crank * sin(turned)) / rod);
    const Point wrist = along(pin, rod, incline + lift);
    const bool has_guide = draw_chance(draw, 0.6);
    const bool has_wrist = draw_chance(draw, 0.4);
    const double degrees = 180.0 / M_PI;
    write_body(draw, "crank", along(pivot, 0.5 * crank, incline + turned), crank,
               (incline + turned) * degrees, file);
    write_body(draw, "rod", along(pin, draw_between(draw, 0.3, 0.6) * rod, incline + lift), rod,
               (incline + lift) * degrees, file);
    const double slider_deg = draw_between(draw, -90.0, 90.0);
    write_body(draw, "slider", along(wrist, draw_between(draw, -0.2, 0.2) * crank, incline), crank,
               slider_deg, file);
    fprintf(file, "joints:\n");
    write_pin(draw, "main", "ground, crank", pivot, false, file);
    write_pin(draw, "big", "crank, rod", pin, !has_guide && !has_wrist, file);
    write_pin(draw, "wrist", "rod, slider", wrist, has_wrist, file);
    const bool is_swapped = draw_chance(draw, 0.3);
    fprintf(file, "  slide: {between: [%s], at: [%.15g m, %.15g m], along: %.12g deg",
            is_swapped ? "slider, ground" : "ground, slider", wrist.x, wrist.y, incline * degrees);
    if (has_guide) {
        write_guide(draw, crank, file);
    }
    fprintf(file, "}\n");
    if (draw_chance(draw, 0.3)) {
        // a buffer beyond where the slider stands, which it meets or does not
        const Point buffer = along(wrist, crank * draw_between(draw, 0.01, 2.0), incline);
        fprintf(file,
                "  buffer: {between: [ground, slider], at-a: [%.15g m, %.15g m],\n"
                "           at-b: [%.15g m, %.15g m], normal: %.12g deg",
                buffer.x, buffer.y, wrist.x, wrist.y,
                remainder(incline + M_PI, 2.0 * M_PI) * degrees);
        write_stiffness(draw, file);
        fprintf(file, "}\n");
    }
    write_drive(draw, !has_guide, file);
}

// A crank whose pin carries a block that slides on a lever: the quick return of a shaper.
static void write_lever(Draw *draw, FILE *file)
{
    const double crank = draw_log_between(draw, 0.02, 0.2);
    const double ground = crank * draw_between(draw, 1.5, 4.0);
    const double turned = draw_between(draw, -M_PI, M_PI);
    const Point origin = {0.0, 0.0};
    const Point pivot = {ground, 0.0};
    const Point pin = along(pivot, crank, turned);
    const double angle = atan2(pin.y, pin.x);
    const bool has_guide = draw_chance(draw, 0.5);
    const bool has_pin = !has_guide || draw_chance(draw, 0.3);
    const double degrees = 180.0 / M_PI;
    write_body(draw, "crank", along(pivot, 0.5 * crank, turned), crank, turned * degrees, file);
    write_body(draw, "lever", along(origin, 0.5 * ground, angle), ground + crank, angle * degrees,
               file);
    write_body(draw, "block", pin, 0.3 * crank, draw_between(draw, -90.0, 90.0), file);
    fprintf(file, "joints:\n");
    write_pin(draw, "main", "ground, crank", pivot, false, file);
    write_pin(draw, "heel", "ground, lever", origin, false, file);
    write_pin(draw, "pin", "crank, block", pin, has_pin, file);
    fprintf(file, "  slide: {between: [%s], at: [%.15g m, %.15g m], along: %.12g deg",
            draw_chance(draw, 0.3) ? "block, lever" : "lever, block", pin.x, pin.y,
            angle * degrees);
    if (has_guide) {
        write_guide(draw, crank, file);
    }
    fprintf(file, "}\n");
    write_drive(draw, !has_guide, file);
}

static void write_sliders(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    fprintf(file, "title: Random sliders %llu\nbodies:\n", (unsigned long long)seed);
    if (draw_chance(&draw, 0.6)) {
        write_slider_crank(&draw, file);
    } else {
        write_lever(&draw, file);
    }
}

// Balls that fall on a floor, one above the other or side by side, between them discs that touch.
static void write_balls(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    const size_t count = 1 + draw_below(&draw, BALLS_MOST);
    double radii[BALLS_MOST];
    Point at[BALLS_MOST];
    double height = 0.0;
    fprintf(file, "title: Random balls %llu\nbodies:\n", (unsigned long long)seed);
    for (size_t i = 0; i < count; i++) {
        radii[i] = draw_log_between(&draw, 2e-3, 0.05);
        height += radii[i] + draw_log_between(&draw, 1e-5, 0.01);
        at[i] = (Point){draw_between(&draw, -0.3, 0.3) * radii[i], height};
        height += radii[i];
        const double mass = 3e4 * radii[i] * radii[i] * radii[i];
        const double spin = draw_between(&draw, -20.0, 20.0);
        const double rising = draw_between(&draw, -1.0, 0.5);
        fprintf(file,
                "  ball-%zu: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [%.15g m, %.15g m],\n"
                "           velocity: [%.5g m/s, %.5g m/s], spin: %.5g rad/s}\n",
                i, mass, 0.4e6 * mass * radii[i] * radii[i], at[i].x, at[i].y,
                draw_between(&draw, -0.2, 0.2), rising, spin);
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || draw_chance(&draw, 0.5)) {
            fprintf(file,
                    "  floor-%zu: {between: [ground, ball-%zu], at-a: [0 m, 0 m],\n"
                    "            at-b: [%.15g m, %.15g m], normal: %.6g deg, radius: %.9g m",
                    i, i, at[i].x, at[i].y, 90.0 + (i == 0 ? draw_between(&draw, -3.0, 3.0) : 0.0),
                    radii[i]);
            write_stiffness(&draw, file);
            fprintf(file, "}\n");
        }
        if (i > 0) {
            fprintf(file,
                    "  discs-%zu: {between: [ball-%zu, ball-%zu], at-a: [%.15g m, %.15g m],\n"
                    "            at-b: [%.15g m, %.15g m], discs: [%.9g m, %.9g m]",
                    i, i - 1, i, at[i - 1].x, at[i - 1].y, at[i].x, at[i].y, 2.0 * radii[i - 1],
                    2.0 * radii[i]);
            write_stiffness(&draw, file);
            fprintf(file, "}\n");
        }
    }
    draw_contact(&draw, file);
    draw_run(&draw, "duration: 0.2 s", file);
}

const CaseKind CASE_SLIDERS = {
    .name = "sliders",
    .summary = "slider-cranks and blocks on levers, play in guides and pins, buffers",
    .write = write_sliders,
};

const CaseKind CASE_BALLS = {
    .name = "balls",
    .summary = "one to four balls that fall on a floor and on each other",
    .write = write_balls,
};
