// Random gears with play in their bearings: trains of two or three on the ground or on a swinging
// frame, or a pinion in a ring; on pivots or on pins with play, free, under a torque or driven.
#include "random_case.h"
#include "random_draw.h"

#include <stdlib.h>

enum { GEAR_MOST = 3 };

typedef struct GearCase {
    Draw draw;
    size_t count;
    bool has_frame; // a body that swings about a point of the ground; else the ground
    bool is_driven;
    bool has_ring; // the second gear is round the first
    bool is_loose[GEAR_MOST];
    int teeth[GEAR_MOST];
    double module; // m, pitch diameter over teeth
    double mass[GEAR_MOST];
    double inertia[GEAR_MOST];
    double spin[GEAR_MOST]; // rad/s
    Point centre[GEAR_MOST];
} GearCase;

static double radius_of(const GearCase *gears, size_t number)
{
    return 0.5 * gears->module * abs(gears->teeth[number]);
}

// Each gear at a random angle from the one before, at the distance of their pitch circles.
static void place_gears(GearCase *gears)
{
    Draw *draw = &gears->draw;
    for (size_t i = 1; i < gears->count; i++) {
        const double angle = draw_between(draw, -M_PI, M_PI);
        const double distance = fabs(0.5 * gears->module * (gears->teeth[i - 1] + gears->teeth[i]));
        gears->centre[i].x = gears->centre[i - 1].x + distance * cos(angle);
        gears->centre[i].y = gears->centre[i - 1].y + distance * sin(angle);
    }
}

static GearCase draw_gears(uint64_t seed)
{
    GearCase gears = {.draw = draw_start(seed)};
    Draw *draw = &gears.draw;
    gears.has_ring = draw_chance(draw, 0.25);
    gears.count = gears.has_ring ? 2 : 2 + draw_below(draw, 2);
    gears.has_frame = draw_chance(draw, 0.35);
    gears.is_driven = !gears.has_frame && draw_chance(draw, 0.5);
    gears.module = draw_log_between(draw, 5e-4, 4e-3);
    const double density = draw_log_between(draw, 50.0, 300.0); // kg/m^2
    bool is_any = false;
    for (size_t i = 0; i < gears.count; i++) {
        gears.teeth[i] = 15 + (int)draw_below(draw, 50);
        gears.is_loose[i] = (i > 0 || !gears.is_driven) && draw_chance(draw, 0.6);
        is_any = is_any || gears.is_loose[i];
    }
    gears.is_loose[1] = gears.is_loose[1] || !is_any;
    if (gears.has_ring) {
        gears.teeth[1] = -(gears.teeth[0] + 20 + (int)draw_below(draw, 40));
    }
    for (size_t i = 0; i < gears.count; i++) {
        const double radius = radius_of(&gears, i);
        gears.mass[i] = density * M_PI * radius * radius;
        gears.inertia[i] = gears.mass[i] * radius * radius * draw_between(draw, 0.4, 0.9);
        const bool turns = !gears.has_frame && (i == 0 ? !gears.is_driven : draw_chance(draw, 0.7));
        gears.spin[i] = turns ? draw_between(draw, -20.0, 20.0) : 0.0;
    }
    place_gears(&gears);
    return gears;
}

static void write_bodies(const GearCase *gears, FILE *file)
{
    for (size_t i = 0; i < gears->count; i++) {
        fprintf(file, "  gear-%zu: {mass: %.6g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]",
                i, gears->mass[i], 1e6 * gears->inertia[i], gears->centre[i].x, gears->centre[i].y);
        if (gears->spin[i] != 0.0) {
            fprintf(file, ", spin: %.6g rad/s", gears->spin[i]);
        }
        fprintf(file, "}\n");
    }
    if (gears->has_frame) {
        fprintf(file, "  frame: {mass: %.5g kg, inertia: %.5g kg mm^2, at: [0.03 m, -0.05 m]}\n",
                2.0 * gears->mass[0], 2e4 * gears->mass[0]);
    }
}

static void write_stiffness(Draw *draw, double mass, FILE *file)
{
    const double rate = 2.0 * M_PI * draw_log_between(draw, 300.0, 2000.0);
    fprintf(file, ", stiffness: %.5g N/m, restitution: %.3g", mass * rate * rate,
            draw_between(draw, 0.2, 0.95));
}

static void write_pivot(GearCase *gears, size_t number, FILE *file)
{
    Draw *draw = &gears->draw;
    const char *frame = gears->has_frame ? "frame" : "ground";
    const bool is_turned_round = !gears->is_driven && draw_chance(draw, 0.4);
    char gear[16];
    snprintf(gear, sizeof gear, "gear-%zu", number);
    fprintf(file, "  pivot-%zu: {between: [%s, %s], at: [%.15g m, %.15g m]", number,
            is_turned_round ? gear : frame, is_turned_round ? frame : gear, gears->centre[number].x,
            gears->centre[number].y);
    if (gears->is_loose[number]) {
        fprintf(file, ", radial-clearance: %.5g um",
                draw_log_between(draw, 2.0, 1e5 * gears->module));
        write_stiffness(draw, gears->mass[number], file);
    }
    fprintf(file, "}\n");
}

static void write_table(GearCase *gears, const char *key, bool is_of_teeth, int repeats, FILE *file)
{
    Draw *draw = &gears->draw;
    const int points = 6 + (int)draw_below(draw, 5);
    const double size = gears->module * draw_log_between(draw, 1e-3, is_of_teeth ? 0.01 : 0.05);
    const double phase = draw_between(draw, -M_PI, M_PI);
    fprintf(file, ",\n    %s: [", key);
    for (int i = 0; i < points; i++) {
        const double angle = 2.0 * M_PI * i / points;
        fprintf(file, "%s[%.12g deg, %.6g um]", i == 0 ? "" : ", ", 360.0 * i / points / repeats,
                1e6 * size * (sin(angle + phase) + 0.3 * sin(2.0 * angle)));
    }
    fprintf(file, "]");
}

// Of the whole gear, or from tooth to tooth.
static void write_tables(GearCase *gears, size_t number, FILE *file)
{
    const bool is_of_teeth = draw_chance(&gears->draw, 0.6);
    const bool has_relief = draw_chance(&gears->draw, 0.5);
    const int repeats = is_of_teeth ? abs(gears->teeth[number]) : 1;
    fprintf(file, ", repeats: %d", repeats);
    if (has_relief) {
        write_table(gears, "relief", is_of_teeth, repeats, file);
    }
    if (!has_relief || draw_chance(&gears->draw, 0.7)) {
        write_table(gears, "transmission-error", is_of_teeth, repeats, file);
    }
}

static void write_meshes(GearCase *gears, FILE *file)
{
    static const double ANGLES[] = {14.5, 20.0, 25.0};
    Draw *draw = &gears->draw;
    const double angle = ANGLES[draw_below(draw, 3)];
    for (size_t i = 0; i + 1 < gears->count; i++) {
        const double before = gears->inertia[i] / pow(radius_of(gears, i), 2.0);
        const double after = gears->inertia[i + 1] / pow(radius_of(gears, i + 1), 2.0);
        fprintf(file,
                "  mesh-%zu: {gears: [pivot-%zu, pivot-%zu], teeth: [%d, %d],\n    pressure-angle: "
                "%g deg, backlash: %.6g mm",
                i, i, i + 1, gears->teeth[i], gears->teeth[i + 1], angle,
                1e3 * gears->module * draw_log_between(draw, 0.05, 0.3));
        write_stiffness(draw, before * after / (before + after), file);
        if (draw_chance(draw, 0.5)) {
            write_tables(gears, i, file);
        }
        fprintf(file, "}\n");
    }
}

static void write_gears(uint64_t seed, FILE *file)
{
    GearCase gears = draw_gears(seed);
    Draw *draw = &gears.draw;
    fprintf(file, "title: Random gears %llu\nbodies:\n", (unsigned long long)seed);
    write_bodies(&gears, file);
    fprintf(file, "joints:\n");
    if (gears.has_frame) {
        fprintf(file, "  swing: {between: [ground, frame], at: [0.02 m, 0.03 m]}\n");
    }
    for (size_t i = 0; i < gears.count; i++) {
        write_pivot(&gears, i, file);
    }
    write_meshes(&gears, file);
    const double speed = draw_between(draw, 100.0, 600.0);
    const double torque = gears.inertia[0] * draw_log_between(draw, 30.0, 3e3);
    if (gears.is_driven) {
        fprintf(file,
                "drive: {joint: pivot-0, speed: [[0 ms, %.5g rpm], [20 ms, %.5g rpm], [40 ms, %.5g "
                "rpm], [100 ms, 0 rpm]]}\n",
                speed, 0.9 * speed, -0.5 * speed);
    } else if (!gears.is_loose[0] && draw_chance(draw, 0.5)) {
        fprintf(file, "drive: {joint: pivot-0, torque: [[0 s, %.5g N m], [20 ms, %.5g N m]]}\n",
                torque, -0.5 * torque);
    }
    fprintf(file, "contact: {damping: hunt-crossley}\n");
    draw_run(draw, "duration: 0.1 s", file);
}

const CaseKind CASE_GEARS = {
    .name = "gears",
    .summary = "gears whose bearings have play, fixed or on a frame, and pinions in rings",
    .write = write_gears,
};
