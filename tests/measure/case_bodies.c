// A random linkage of bodies, with play in one to three joints: a hanging chain without a drive, a
// driven crank that drags a chain, a four-bar, a four-bar that carries a further pair of links (a
// six-bar), or two four-bars on one crank.
#include "random_case.h"
#include "random_draw.h"

#include <string.h>

enum { BODY_MAX = 8, JOINT_MAX = 12, TURN_PARTS = 360 };

// a pair of links is not stretched or folded further than this share of its lengths over a turn
static const double STRETCH_MOST = 0.96;

typedef enum BodiesKind {
    BODIES_PLAIN,
    BODIES_SPRUNG,
    BODIES_RUN_UP,
    BODIES_SERVO,
} BodiesKind;

typedef struct Pin {
    int body_a; // -1: the ground
    int body_b;
    Point at;
    bool has_play;
} Pin;

typedef struct Sketch {
    Draw draw;
    size_t body_count;
    Point ends[BODY_MAX][2]; // m
    size_t pin_count;
    Pin pins[JOINT_MAX];
    bool is_driven;
    double length_s; // of a run without a drive
} Sketch;

static int add_link(Sketch *sketch, Point from, Point to)
{
    sketch->ends[sketch->body_count][0] = from;
    sketch->ends[sketch->body_count][1] = to;
    return (int)sketch->body_count++;
}

static void add_pin(Sketch *sketch, int body_a, int body_b, Point at)
{
    sketch->pins[sketch->pin_count++] = (Pin){body_a, body_b, at, false};
}

static Point reach(Point from, double length, double angle)
{
    return (Point){from.x + length * cos(angle), from.y + length * sin(angle)};
}

// A chain of links that hangs or lies anyhow, from a point of a body or the ground.
static void add_chain(Sketch *sketch, int from, Point at, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double length = draw_log_between(&sketch->draw, 0.03, 0.4);
        const Point end = reach(at, length, draw_between(&sketch->draw, -M_PI, M_PI));
        const int link = add_link(sketch, at, end);
        add_pin(sketch, from, link, at);
        from = link;
        at = end;
    }
}

typedef struct Loop {
    Point crank_pivot;
    Point pivot;
    double crank;
    double coupler;
    double follower;
    bool is_left;
} Loop;

static bool loop_at(const Loop *loop, double angle, Point *elbow, Point *wrist)
{
    *elbow = reach(loop->crank_pivot, loop->crank, angle);
    const double apart = hypot(loop->pivot.x - elbow->x, loop->pivot.y - elbow->y);
    const double most = loop->coupler + loop->follower;
    const double least = fabs(loop->coupler - loop->follower);
    return apart < STRETCH_MOST * most && STRETCH_MOST * apart > least &&
           draw_meet(*elbow, loop->coupler, loop->pivot, loop->follower, loop->is_left, wrist);
}

static bool turns_fully(const Loop *loop)
{
    for (int i = 0; i < TURN_PARTS; i++) {
        Point elbow;
        Point wrist;
        if (!loop_at(loop, 2.0 * M_PI * i / TURN_PARTS, &elbow, &wrist)) {
            return false;
        }
    }
    return true;
}

static Loop draw_loop(Draw *draw, Point crank_pivot, double crank)
{
    for (;;) {
        const double ground = crank * draw_between(draw, 0.2, 6.0);
        const Loop loop = {
            .crank_pivot = crank_pivot,
            .pivot = reach(crank_pivot, ground, draw_between(draw, -M_PI, M_PI)),
            .crank = crank,
            .coupler = crank * draw_between(draw, 0.8, 6.0),
            .follower = crank * draw_between(draw, 0.8, 6.0),
            .is_left = draw_chance(draw, 0.5),
        };
        if (turns_fully(&loop)) {
            return loop;
        }
    }
}

// Coupler and follower of a loop on a crank that is there; returns the follower.
static int add_loop(Sketch *sketch, const Loop *loop, int crank, double angle)
{
    Point elbow;
    Point wrist;
    loop_at(loop, angle, &elbow, &wrist);
    const int coupler = add_link(sketch, elbow, wrist);
    const int follower = add_link(sketch, wrist, loop->pivot);
    add_pin(sketch, crank, coupler, elbow);
    add_pin(sketch, coupler, follower, wrist);
    add_pin(sketch, -1, follower, loop->pivot);
    return follower;
}

// A pair of links from the coupler-follower pin of a loop to a further pivot that never lets go.
static void add_pair(Sketch *sketch, const Loop *loop, double angle)
{
    Draw *draw = &sketch->draw;
    for (;;) {
        const double size = loop->follower;
        const double direction = draw_between(draw, -M_PI, M_PI);
        const Point pivot = reach(loop->pivot, size * draw_between(draw, 0.5, 2.0), direction);
        const double first = size * draw_between(draw, 0.6, 2.0);
        const double second = size * draw_between(draw, 0.6, 2.0);
        bool is_whole = true;
        Point elbow;
        Point wrist;
        for (int i = 0; i < TURN_PARTS && is_whole; i++) {
            loop_at(loop, 2.0 * M_PI * i / TURN_PARTS, &elbow, &wrist);
            const double apart = hypot(pivot.x - wrist.x, pivot.y - wrist.y);
            is_whole = apart < STRETCH_MOST * (first + second) &&
                       STRETCH_MOST * apart > fabs(first - second);
        }
        Point met;
        loop_at(loop, angle, &elbow, &wrist);
        if (is_whole && draw_meet(wrist, first, pivot, second, draw_chance(draw, 0.5), &met)) {
            const int follower = (int)sketch->body_count - 1;
            const int connecting = add_link(sketch, wrist, met);
            const int rocker = add_link(sketch, met, pivot);
            add_pin(sketch, follower, connecting, wrist);
            add_pin(sketch, connecting, rocker, met);
            add_pin(sketch, -1, rocker, pivot);
            return;
        }
    }
}

static void sketch_driven(Sketch *sketch, size_t which)
{
    Draw *draw = &sketch->draw;
    const Point origin = {draw_between(draw, -0.5, 0.5), draw_between(draw, -0.5, 0.5)};
    const double length = draw_log_between(draw, 0.02, 0.2);
    const double angle = draw_between(draw, -M_PI, M_PI);
    const int crank = add_link(sketch, origin, reach(origin, length, angle));
    add_pin(sketch, -1, crank, origin);
    sketch->is_driven = true;
    if (which == 0) {
        add_chain(sketch, crank, sketch->ends[0][1], 1 + draw_below(draw, 2));
        return;
    }
    const Loop loop = draw_loop(draw, origin, length);
    add_loop(sketch, &loop, crank, angle);
    if (which == 2) {
        add_pair(sketch, &loop, angle);
    } else if (which == 3) {
        const Loop other = draw_loop(draw, origin, length);
        add_loop(sketch, &other, crank, angle);
    }
}

static void write_body(Sketch *sketch, size_t body, FILE *file)
{
    Draw *draw = &sketch->draw;
    const Point *ends = sketch->ends[body];
    const double length = hypot(ends[1].x - ends[0].x, ends[1].y - ends[0].y);
    const double mass = length * draw_log_between(draw, 0.3, 5.0);
    const double inertia = mass * length * length / 12.0 * draw_between(draw, 0.6, 1.6);
    // the centre of mass anywhere along the link, the frame turned anyhow
    const double share = draw_between(draw, 0.3, 0.7);
    fprintf(file, "  body-%zu: {mass: %.6g kg, inertia: %.6g kg mm^2, ", body, mass, 1e6 * inertia);
    fprintf(file, "at: [%.15g m, %.15g m], angle: %.6g deg}\n",
            ends[0].x + share * (ends[1].x - ends[0].x),
            ends[0].y + share * (ends[1].y - ends[0].y), draw_between(draw, -180.0, 180.0));
}

static void write_pin(Sketch *sketch, size_t number, FILE *file)
{
    const Pin *pin = &sketch->pins[number];
    fprintf(file, "  joint-%zu: {between: [", number);
    if (pin->body_a < 0) {
        fprintf(file, "ground");
    } else {
        fprintf(file, "body-%d", pin->body_a);
    }
    fprintf(file, ", body-%d], at: [%.15g m, %.15g m]", pin->body_b, pin->at.x, pin->at.y);
    if (pin->has_play) {
        fprintf(file, ", ");
        draw_play(&sketch->draw, file);
    }
    fprintf(file, "}\n");
}

// Gives play to one to three joints, not to the driven one.
static void loosen(Sketch *sketch)
{
    const size_t first = sketch->is_driven ? 1 : 0;
    const size_t free = sketch->pin_count - first;
    const size_t count = 1 + draw_below(&sketch->draw, free < 3 ? free : 3);
    for (size_t i = 0; i < count;) {
        Pin *pin = &sketch->pins[first + draw_below(&sketch->draw, free)];
        i += pin->has_play ? 0 : 1;
        pin->has_play = true;
    }
}

// A spring with a damper from the ground to the end of every other link, and one at a joint.
static void write_springs(Sketch *sketch, FILE *file)
{
    Draw *draw = &sketch->draw;
    fprintf(file, "springs:\n");
    for (size_t i = 0; i < sketch->body_count; i += 2) {
        const Point end = sketch->ends[i][1];
        const double above = end.y + draw_between(draw, -0.3, 0.3);
        fprintf(file, "  spring-%zu: {between: [ground, body-%zu], at-a: [%.6g m, %.6g m],\n", i, i,
                end.x + draw_between(draw, 0.05, 0.3), above);
        fprintf(file, "            at-b: [%.15g m, %.15g m], stiffness: %.4g N/m,\n", end.x, end.y,
                draw_log_between(draw, 10.0, 1e4));
        const double damping = draw_log_between(draw, 0.01, 30.0);
        fprintf(file, "            length: %.4g m, damping: %.4g N s/m}\n",
                draw_between(draw, 0.02, 0.3), damping);
    }
    const double stiffness = draw_log_between(draw, 0.01, 10.0);
    fprintf(file, "torsion-springs:\n  coil: {joint: joint-%zu, stiffness: %.4g N m/rad,\n",
            draw_below(draw, sketch->pin_count), stiffness);
    fprintf(file, "         damping: %.4g N m s/rad}\n", draw_log_between(draw, 1e-4, 0.1));
}

// A motor that starts, runs and brakes or turns back: its speed, or its torque beside a bearing
// that brakes it.
static void write_run_up(Sketch *sketch, FILE *file)
{
    Draw *draw = &sketch->draw;
    const bool is_torque = draw_chance(draw, 0.5);
    const char *unit = is_torque ? "N m" : "rpm";
    const double size = is_torque ? draw_log_between(draw, 0.01, 5.0) : draw_speed_rpm(draw);
    const double top = !is_torque || draw_chance(draw, 0.5) ? size : -size;
    const double start = draw_chance(draw, 0.5) ? 0.0 : draw_between(draw, -0.5, 0.5) * top;
    const double end = draw_between(draw, -0.5, 0.8) * top;
    const double rise_ms = draw_log_between(draw, 2.0, 30.0);
    const double hold_ms = rise_ms + draw_between(draw, 0.5, 20.0);
    const double fall_ms = hold_ms + draw_log_between(draw, 1.0, 30.0);
    if (is_torque) {
        fprintf(file, "torsion-springs:\n  bearing: {joint: joint-0, damping: %.4g N m s/rad}\n",
                draw_log_between(draw, 1e-4, 0.1));
    }
    fprintf(file,
            "drive: {joint: joint-0, %s: [[0 s, %.5g %s], [%.4g ms, %.5g %s], [%.4g ms, %.5g %s], "
            "[%.4g ms, %.5g %s]]}\n",
            is_torque ? "torque" : "speed", start, unit, rise_ms, top, unit, hold_ms, top, unit,
            fall_ms, end, unit);
}

// A sinusoid about a mean, in a unit.
static void write_wave(Draw *draw, double mean, double amplitude, const char *unit, FILE *file)
{
    fprintf(file, "{mean: %.4g %s, amplitude: %.4g %s, frequency: %.4g Hz, phase: %.4g deg}", mean,
            unit, amplitude, unit, draw_log_between(draw, 4.0, 120.0),
            draw_between(draw, -180.0, 180.0));
}

// What a drive follows or prescribes: a speed, or an angle about the start.
static void write_swing(Draw *draw, bool may_hold, FILE *file)
{
    const size_t which = draw_below(draw, may_hold ? 4 : 2);
    const double speed = draw_between(draw, -300.0, 300.0);
    switch (which) {
    case 0:
        fprintf(file, "speed: ");
        write_wave(draw, speed, draw_between(draw, 0.05, 1.2) * speed, "rpm", file);
        break;
    case 1:
        fprintf(file, "angle: {amplitude: %.4g deg, frequency: %.4g Hz, phase: %.4g deg}",
                draw_log_between(draw, 0.5, 15.0), draw_log_between(draw, 3.0, 40.0),
                draw_between(draw, -180.0, 180.0));
        break;
    case 2:
        fprintf(file, "angle: %.4g deg", draw_between(draw, -40.0, 40.0));
        break;
    default:
        fprintf(file, "speed: %.4g rpm", speed);
    }
}

// A controller with or without a limit, a torque or a prescribed motion by sinusoids, and loads.
static void write_servo(Sketch *sketch, FILE *file)
{
    Draw *draw = &sketch->draw;
    const size_t which = draw_below(draw, 4);
    if (which == 0) {
        const double torque = draw_log_between(draw, 0.01, 5.0);
        fprintf(file, "torsion-springs:\n  bearing: {joint: joint-0, damping: %.4g N m s/rad}\n",
                draw_log_between(draw, 1e-3, 0.1));
        fprintf(file, "drive: {joint: joint-0, torque: ");
        write_wave(draw, draw_between(draw, -1.0, 1.0) * torque, torque, "N m", file);
        fprintf(file, "}\n");
    } else {
        fprintf(file, "drive: {joint: joint-0, ");
        write_swing(draw, which > 1, file);
        if (which > 1) {
            const double stiffness = draw_log_between(draw, 0.2, 100.0);
            fprintf(file, ", stiffness: %.4g N m/rad, damping: %.4g N m s/rad", stiffness,
                    stiffness * draw_log_between(draw, 1e-3, 5e-2));
            if (draw_chance(draw, 0.8)) {
                fprintf(file, ", torque-limit: %.4g N m",
                        stiffness * draw_log_between(draw, 0.01, 0.5));
            }
        }
        fprintf(file, "}\n");
    }
    fprintf(file, "loads:\n");
    for (size_t i = 0; i < sketch->body_count; i += 1 + draw_below(draw, 3)) {
        const bool is_force = draw_chance(draw, 0.5);
        fprintf(file, "  load-%zu: {body: body-%zu, ", i, i);
        if (is_force) {
            fprintf(file,
                    "direction: %.4g deg, frame: %s, force: ", draw_between(draw, -180.0, 180.0),
                    draw_chance(draw, 0.5) ? "body" : "world");
        } else {
            fprintf(file, "torque: ");
        }
        const double size = draw_log_between(draw, 0.01, is_force ? 5.0 : 0.3);
        write_wave(draw, draw_between(draw, -1.0, 1.0) * size, size, is_force ? "N" : "N m", file);
        fprintf(file, "}\n");
    }
}

static void write_case(uint64_t seed, FILE *file, BodiesKind kind)
{
    Sketch sketch = {.draw = draw_start(seed)};
    const bool is_sprung = kind == BODIES_SPRUNG;
    const size_t which = draw_below(&sketch.draw, kind >= BODIES_RUN_UP ? 4 : 5);
    if (which == 4) {
        const Point pivot = {draw_between(&sketch.draw, -0.5, 0.5), 0.0};
        add_chain(&sketch, -1, pivot, 1 + draw_below(&sketch.draw, 4));
    } else {
        sketch_driven(&sketch, which);
    }
    loosen(&sketch);
    fprintf(file, "title: Random bodies %llu\nbodies:\n", (unsigned long long)seed);
    for (size_t i = 0; i < sketch.body_count; i++) {
        write_body(&sketch, i, file);
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < sketch.pin_count; i++) {
        write_pin(&sketch, i, file);
    }
    if (is_sprung) {
        write_springs(&sketch, file);
        if (sketch.is_driven && draw_chance(&sketch.draw, 0.5)) {
            sketch.is_driven = false;
            const double torque = draw_log_between(&sketch.draw, 0.01, 5.0);
            fprintf(file,
                    "drive: {joint: joint-0, torque: [[0 s, 0 N m], [50 ms, %.4g N m], [0.2 s, "
                    "%.4g N m]]}\n",
                    torque, -0.5 * torque);
        }
    }
    if (kind == BODIES_SERVO) {
        write_servo(&sketch, file);
        draw_contact(&sketch.draw, file);
        draw_run(&sketch.draw, "duration: 0.5 s", file);
        return;
    }
    if (kind == BODIES_RUN_UP) {
        write_run_up(&sketch, file);
        sketch.is_driven = false;
    } else if (sketch.is_driven) {
        fprintf(file, "drive: {joint: joint-0, speed: %.5g rpm}\n", draw_speed_rpm(&sketch.draw));
    }
    draw_contact(&sketch.draw, file);
    draw_run(&sketch.draw, sketch.is_driven ? "revolutions: 1" : "duration: 0.5 s", file);
}

static void write_bodies(uint64_t seed, FILE *file)
{
    write_case(seed, file, BODIES_PLAIN);
}

static void write_sprung(uint64_t seed, FILE *file)
{
    write_case(seed, file, BODIES_SPRUNG);
}

static void write_run_ups(uint64_t seed, FILE *file)
{
    write_case(seed, file, BODIES_RUN_UP);
}

static void write_servos(uint64_t seed, FILE *file)
{
    write_case(seed, file, BODIES_SERVO);
}

const CaseKind CASE_SERVOS = {
    .name = "servos",
    .summary = "driven ones by controllers with and without a limit, and by sinusoids, under loads",
    .write = write_servos,
};

const CaseKind CASE_BODIES = {
    .name = "bodies",
    .summary = "chains, six-bars and the like, as bodies, play in 1 to 3 joints",
    .write = write_bodies,
};

const CaseKind CASE_SPRUNG = {
    .name = "sprung",
    .summary = "the same with springs, dampers and, one in two, a torque as the drive",
    .write = write_sprung,
};

const CaseKind CASE_RUN_UPS = {
    .name = "run-ups",
    .summary = "driven ones whose speed or torque rises, holds and falls over time",
    .write = write_run_ups,
};
