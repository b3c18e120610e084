// Random hole patterns: two to eight pins between two plates, each hole and each pin off its place
// by what the play allows. The plate with the pins is on the ground, on a plate that turns about a
// pivot, or both are on pivots of their own; free, driven, or under a torque.
#include "random_case.h"
#include "random_draw.h"

enum { HOLES_LEAST = 2, HOLES_MOST = 8, PLACE_TRIES = 1000 };

// m, from one hole to the next at least
static const double APART_LEAST = 4e-3;

// 1: of the play, how far a pin begins off its hole's centre at most
static const double OFF_MOST = 0.95;

// What holds the plates.
typedef enum Held { HELD_ON_GROUND, HELD_ON_PLATE, HELD_ON_DRIVEN, HELD_COUPLED, HELD_COUNT } Held;

typedef struct Pattern {
    Draw draw;
    Held held;
    size_t count;
    double radius; // m, of the pattern
    Point centre;  // m, of the pattern, from the plates' centre
    Point places[HOLES_MOST];
} Pattern;

static bool is_clear(const Pattern *pattern, Point at)
{
    for (size_t i = 0; i < pattern->count; i++) {
        const Point other = pattern->places[i];
        if (hypot(other.x - at.x, other.y - at.y) < APART_LEAST) {
            return false;
        }
    }
    return true;
}

static void draw_places(Pattern *pattern)
{
    Draw *draw = &pattern->draw;
    const size_t count = HOLES_LEAST + draw_below(draw, HOLES_MOST - HOLES_LEAST + 1);
    const bool is_circle = draw_chance(draw, 0.6);
    const double turned = draw_between(draw, 0.0, 2.0 * M_PI);
    pattern->radius = draw_between(draw, 10e-3, 60e-3);
    pattern->centre = (Point){draw_between(draw, -10e-3, 10e-3), draw_between(draw, -10e-3, 10e-3)};
    for (int i = 0; i < PLACE_TRIES && pattern->count < count; i++) {
        const double at = turned + 2.0 * M_PI * (double)pattern->count / (double)count;
        const double angle = is_circle ? at : draw_between(draw, 0.0, 2.0 * M_PI);
        const double distance =
            pattern->radius * (is_circle ? 1.0 : sqrt(draw_between(draw, 0.0, 1.0)));
        const Point place = {pattern->centre.x + distance * cos(angle),
                             pattern->centre.y + distance * sin(angle)};
        if (is_circle || is_clear(pattern, place)) {
            pattern->places[pattern->count++] = place;
        }
    }
}

static void write_plate(Pattern *pattern, const char *name, bool moves, FILE *file)
{
    Draw *draw = &pattern->draw;
    const double mass = draw_log_between(draw, 0.1, 5.0);
    const double gyration = pattern->radius * draw_between(draw, 0.6, 1.5);
    fprintf(file, "  %s: {mass: %.6g kg, inertia: %.6g kg mm^2, at: [0 m, 0 m]", name, mass,
            1e6 * mass * gyration * gyration);
    if (moves) {
        fprintf(file, ", velocity: [%.5g m/s, %.5g m/s], spin: %.5g rad/s",
                draw_between(draw, -0.1, 0.1), draw_between(draw, -0.1, 0.1),
                draw_between(draw, -2.0, 2.0));
    }
    fprintf(file, "}\n");
}

static void write_pins(Pattern *pattern, FILE *file)
{
    Draw *draw = &pattern->draw;
    const double play = draw_log_between(draw, 5e-6, 200e-6);
    const bool is_one_play = draw_chance(draw, 0.5);
    for (size_t i = 0; i < pattern->count; i++) {
        const double own = is_one_play ? play : play * draw_between(draw, 0.5, 2.0);
        const double off = OFF_MOST * own * sqrt(draw_between(draw, 0.0, 1.0));
        const double towards = draw_between(draw, 0.0, 2.0 * M_PI);
        const double share = draw_between(draw, 0.0, 1.0); // of the hole, the pin the rest
        const Point by = {off * cos(towards), off * sin(towards)};
        const Point place = pattern->places[i];
        fprintf(file,
                "  pin-%zu: {between: [%s, plate], at-a: [%.15g m, %.15g m],\n"
                "          at-b: [%.15g m, %.15g m], radial-clearance: %.9g um, pin: 6 mm, width: "
                "10 mm}\n",
                i, pattern->held == HELD_ON_GROUND ? "ground" : "carrier", place.x + share * by.x,
                place.y + share * by.y, place.x - (1.0 - share) * by.x,
                place.y - (1.0 - share) * by.y, 1e6 * own);
    }
}

static void write_holes(uint64_t seed, FILE *file)
{
    Pattern pattern = {.draw = draw_start(seed)};
    Draw *draw = &pattern.draw;
    pattern.held = (Held)draw_below(draw, HELD_COUNT);
    draw_places(&pattern);
    const bool is_driven = pattern.held == HELD_ON_DRIVEN || pattern.held == HELD_COUPLED;
    fprintf(file, "title: Random hole pattern %llu\nbodies:\n", (unsigned long long)seed);
    write_plate(&pattern, "plate", !is_driven, file);
    if (pattern.held != HELD_ON_GROUND) {
        write_plate(&pattern, "carrier", false, file);
    }
    fprintf(file, "joints:\n");
    if (pattern.held != HELD_ON_GROUND) {
        fprintf(file, "  shaft: {between: [ground, carrier], at: [0 m, 0 m]}\n");
    }
    if (pattern.held == HELD_COUPLED) {
        fprintf(file, "  axle: {between: [ground, plate], at: [0 m, 0 m]}\n");
    }
    write_pins(&pattern, file);
    fprintf(file, "loads:\n  twist: {body: plate, torque: %.5g N m}\n",
            draw_between(draw, -20.0, 20.0));
    if (is_driven) {
        fprintf(file, "drive: {joint: shaft, speed: %.6g rpm}\n", draw_speed_rpm(draw));
    }
    draw_contact(draw, file);
    draw_run(draw, is_driven ? "revolutions: 0.1" : "duration: 20 ms", file);
}

const CaseKind CASE_HOLES = {
    .name = "holes",
    .summary = "two to eight pins between two plates, holes and pins off their places",
    .write = write_holes,
};
