#include "rocker.h"

#include "kept.h"

#include "casefile/casefile.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

static const double CRANK = 0.05; // m
static const double ROD = 0.12;   // m
static const double START = 1.0;  // rad, of the crank

typedef struct Writer {
    const RockerView *view;
    Text text;
} Writer;

static void write_length(Writer *writer, double length)
{
    const bool is_small = writer->view->in_millimetres;
    text_append(&writer->text, "%.17g %s", is_small ? 1e3 * length : length, is_small ? "mm" : "m");
}

static void write_point(Writer *writer, Vec2 point)
{
    const Vec2 there = vec2_add(vec2_rotate(writer->view->turn, point), writer->view->shift);
    text_append(&writer->text, "at: [");
    write_length(writer, there.x);
    text_append(&writer->text, ", ");
    write_length(writer, there.y);
    text_append(&writer->text, "]");
}

static void write_body(Writer *writer, const char *name, double mass, double inertia, Vec2 centre,
                       double angle)
{
    const bool is_small = writer->view->in_millimetres;
    text_append(&writer->text, "  %s: {mass: %.17g %s, inertia: %.17g %s, angle: %.17g rad, ", name,
                is_small ? 1e3 * mass : mass, is_small ? "g" : "kg",
                is_small ? 1e9 * inertia : inertia, is_small ? "g mm^2" : "kg m^2",
                remainder(angle + writer->view->turn, 2.0 * M_PI));
    write_point(writer, centre);
    text_append(&writer->text, "}\n");
}

static void write_joint(Writer *writer, const char *name, const char *between, Vec2 point)
{
    text_append(&writer->text, "  %s: {between: [%s], ", name, between);
    write_point(writer, point);
}

Scenario rocker_make(RockerView view)
{
    const Vec2 elbow = vec2_rotate(START, (Vec2){CRANK, 0.0});
    const Vec2 pin = {elbow.x + sqrt(ROD * ROD - elbow.y * elbow.y), 0.0};
    const Vec2 rod = vec2_sub(pin, elbow);
    Writer writer = {.view = &view};
    text_init(&writer.text);
    text_append(&writer.text, "bodies:\n");
    write_body(&writer, "crank", 0.3, 1e-4, (Vec2){0.0, 0.0}, START + view.frames);
    write_body(&writer, "rod", 0.21, 2.52e-4, vec2_add(elbow, vec2_scale(0.5, rod)),
               atan2(rod.y, rod.x) + 2.0 * view.frames);
    write_body(&writer, "rocker", 0.14, 1e-5, pin, 0.5 * M_PI + 3.0 * view.frames);
    text_append(&writer.text, "joints:\n");
    write_joint(&writer, "main", "ground, crank", (Vec2){0.0, 0.0});
    text_append(&writer.text, "}\n");
    write_joint(&writer, "elbow", "crank, rod", elbow);
    text_append(&writer.text, "}\n");
    write_joint(&writer, "pin", "rod, rocker", pin);
    text_append(&writer.text, ", radial-clearance: ");
    write_length(&writer, 0.5e-3);
    text_append(&writer.text, ", width: ");
    write_length(&writer, 15e-3);
    text_append(&writer.text, "}\n");
    write_joint(&writer, "far", "ground, rocker", (Vec2){pin.x, -view.length});
    text_append(&writer.text, "}\n"
                              "drive: {joint: main, speed: 5000 rpm}\n"
                              "gravity: 0 m/s^2\n"
                              "contact: {stiffness: 6.6e10 N/m^1.5, damping: lankarani-nikravesh, "
                              "restitution: 0.9, resting-speed: none}\n"
                              "run: {start: centred, revolutions: 1, samples: 3600, step: 1 us, "
                              "backends: [reference, ode]}\n"
                              "ode: {map: impulse, stepping: staggered}\n");
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    const bool is_made = casefile_load_text("rocker", writer.text.data, writer.text.length, NULL, 0,
                                            &scenario, &err);
    if (!is_made) {
        fprintf(stderr, "%s\n", err.text);
    }
    assert(is_made);
    text_finish(&writer.text);
    return kept_instead(&scenario);
}
