// Random mechanisms in space: bodies of any inertia, hinges and pins about axes of any direction.
// Undriven chains of pins, with collars or without; driven ones: a crank that drags such a chain, a
// planar four-bar whose weights lie beside its plane, Bennett's linkage and the spherical four-bar.
#include "random_case.h"
#include "random_draw.h"

enum { SPACE_BODY_MAX = 4, SPACE_PIN_MAX = 4 };

static const double SPACE_DEGREES = 180.0 / M_PI;

typedef struct Point3 {
    double x;
    double y;
    double z;
} Point3;

typedef struct SpacePin {
    int body_a; // -1: the ground
    int body_b;
    Point3 at;
    Point3 axis;
    bool has_play;
} SpacePin;

typedef struct SpaceSketch {
    Draw draw;
    size_t body_count;
    Point3 ends[SPACE_BODY_MAX][2]; // m
    size_t pin_count;
    SpacePin pins[SPACE_PIN_MAX];
    bool is_upright; // all axes are z
} SpaceSketch;

static Point3 point3_sub(Point3 a, Point3 b)
{
    return (Point3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static double point3_dot(Point3 a, Point3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static Point3 point3_times(double factor, Point3 a)
{
    return (Point3){factor * a.x, factor * a.y, factor * a.z};
}

static Point3 point3_cross(Point3 a, Point3 b)
{
    return (Point3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static Point3 draw_point3(Draw *draw, double most)
{
    const double x = draw_between(draw, -most, most);
    const double y = draw_between(draw, -most, most);
    return (Point3){x, y, draw_between(draw, -most, most)};
}

static Point3 draw_direction(Draw *draw)
{
    for (;;) {
        const Point3 point = draw_point3(draw, 1.0);
        const double size = sqrt(point3_dot(point, point));
        if (size > 0.1 && size < 1.0) {
            return point3_times(1.0 / size, point);
        }
    }
}

static int add_body(SpaceSketch *sketch, Point3 from, Point3 to)
{
    sketch->ends[sketch->body_count][0] = from;
    sketch->ends[sketch->body_count][1] = to;
    return (int)sketch->body_count++;
}

static void add_pin(SpaceSketch *sketch, int body_a, int body_b, Point3 at, Point3 axis)
{
    sketch->pins[sketch->pin_count++] = (SpacePin){body_a, body_b, at, axis, false};
}

// What a sum of three masses at any places makes of the moments: some body has them.
static void write_inertia(Draw *draw, double mass, double size, FILE *file)
{
    double second[6] = {0.0}; // xx, yy, zz, xy, xz, yz
    for (int i = 0; i < 3; i++) {
        const Point3 at = draw_point3(draw, size);
        const double terms[6] = {at.x * at.x, at.y * at.y, at.z * at.z,
                                 at.x * at.y, at.x * at.z, at.y * at.z};
        for (int k = 0; k < 6; k++) {
            second[k] += 1e6 * mass / 3.0 * (terms[k] + (k < 3 ? 0.02 * size * size : 0.0));
        }
    }
    fprintf(file,
            "inertia: %.9g kg mm^2, inertia-x: %.9g kg mm^2,\n    inertia-y: %.9g kg mm^2, "
            "product-xy: %.9g kg mm^2, product-xz: %.9g kg mm^2, product-yz: %.9g kg mm^2",
            second[0] + second[1], second[1] + second[2], second[0] + second[2], second[3],
            second[4], second[5]);
}

static void write_body(SpaceSketch *sketch, size_t number, bool is_thrown, FILE *file)
{
    Draw *draw = &sketch->draw;
    const Point3 *ends = sketch->ends[number];
    const Point3 along = point3_sub(ends[1], ends[0]);
    const double length = sqrt(point3_dot(along, along));
    const double mass = length * draw_log_between(draw, 0.3, 5.0);
    const Point3 beside = draw_point3(draw, 0.15 * length);
    fprintf(file, "  body-%zu: {mass: %.6g kg, ", number, mass);
    write_inertia(draw, mass, 0.5 * length, file);
    fprintf(file, ",\n    at: [%.15g m, %.15g m], offset: %.15g m, angle: %.6g deg",
            0.5 * (ends[0].x + ends[1].x) + beside.x, 0.5 * (ends[0].y + ends[1].y) + beside.y,
            0.5 * (ends[0].z + ends[1].z) + beside.z, draw_between(draw, -180.0, 180.0));
    if (is_thrown) {
        const Point3 velocity = draw_point3(draw, 0.2);
        const Point3 spin = draw_point3(draw, 2.0);
        fprintf(file,
                ",\n    velocity: [%.6g m/s, %.6g m/s], velocity-z: %.6g m/s, spin: %.6g rad/s, "
                "spin-x: %.6g rad/s, spin-y: %.6g rad/s",
                velocity.x, velocity.y, velocity.z, spin.z, spin.x, spin.y);
    }
    fprintf(file, "}\n");
}

static void write_play(SpaceSketch *sketch, FILE *file)
{
    Draw *draw = &sketch->draw;
    const double clearance_um = draw_log_between(draw, 2.0, 500.0);
    fprintf(file, ",\n    radial-clearance: %.9g um, pin: 10 mm, width: %.4g mm", clearance_um,
            draw_between(draw, 5.0, 30.0));
    if (draw_chance(draw, 0.75)) {
        fprintf(file, ", axial-clearance: %.6g um", draw_log_between(draw, 5.0, 1000.0));
    }
    if (sketch->is_upright && draw_chance(draw, 0.3)) {
        const double share = draw_between(draw, 0.0, 0.99);
        const double angle = draw_between(draw, 0.0, 2.0 * M_PI);
        fprintf(file, ", start: [%.9g um, %.9g um]", share * clearance_um * cos(angle),
                share * clearance_um * sin(angle));
    }
}

// Backlash of a hinge at times, with a stiffness at which its link rings with 20 Hz to 1 kHz.
static void write_backlash(SpaceSketch *sketch, FILE *file)
{
    Draw *draw = &sketch->draw;
    const double rate = 2.0 * M_PI * draw_log_between(draw, 20.0, 1000.0);
    const double restitution = draw_between(draw, 0.2, 0.95);
    fprintf(file, ",\n    backlash: %.6g deg, stiffness: %.5g N m/rad, restitution: %.3g",
            draw_log_between(draw, 0.01, 5.0), 1e-4 * rate * rate, restitution);
}

static void write_pin(SpaceSketch *sketch, size_t number, bool may_limit, FILE *file)
{
    const SpacePin *pin = &sketch->pins[number];
    fprintf(file, "  joint-%zu: {between: [", number);
    if (pin->body_a < 0) {
        fprintf(file, "ground");
    } else {
        fprintf(file, "body-%d", pin->body_a);
    }
    fprintf(file, ", body-%d], at: [%.16g m, %.16g m], offset: %.16g m", pin->body_b, pin->at.x,
            pin->at.y, pin->at.z);
    if (!sketch->is_upright) {
        fprintf(file, ",\n    axis: [%.17g, %.17g, %.17g]", pin->axis.x, pin->axis.y, pin->axis.z);
    }
    if (pin->has_play) {
        write_play(sketch, file);
    } else if (may_limit && draw_chance(&sketch->draw, 0.25)) {
        write_backlash(sketch, file);
    }
    fprintf(file, "}\n");
}

// Gives play to one or two joints, not to those before `first`.
static void loosen(SpaceSketch *sketch, size_t first)
{
    const size_t free = sketch->pin_count - first;
    const size_t count = 1 + draw_below(&sketch->draw, free < 2 ? free : 2);
    for (size_t i = 0; i < count;) {
        SpacePin *pin = &sketch->pins[first + draw_below(&sketch->draw, free)];
        i += pin->has_play ? 0 : 1;
        pin->has_play = true;
    }
}

static void add_chain(SpaceSketch *sketch, int from, Point3 at, size_t count)
{
    const Point3 z = {0.0, 0.0, 1.0};
    for (size_t i = 0; i < count; i++) {
        const Point3 direction = draw_direction(&sketch->draw);
        const Point3 along = point3_times(draw_log_between(&sketch->draw, 0.03, 0.3), direction);
        const Point3 end = {at.x + along.x, at.y + along.y, at.z + along.z};
        const int body = add_body(sketch, at, end);
        add_pin(sketch, from, body, at, sketch->is_upright ? z : draw_direction(&sketch->draw));
        from = body;
        at = end;
    }
}

static void write_scene(SpaceSketch *sketch, const char *title, uint64_t seed, bool is_thrown,
                        bool may_limit, FILE *file)
{
    fprintf(file, "title: %s %llu\nspace: spatial\nbodies:\n", title, (unsigned long long)seed);
    for (size_t i = 0; i < sketch->body_count; i++) {
        write_body(sketch, i, is_thrown, file);
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < sketch->pin_count; i++) {
        write_pin(sketch, i, may_limit, file);
    }
}

static void write_undriven(uint64_t seed, FILE *file)
{
    SpaceSketch sketch = {.draw = draw_start(seed)};
    Draw *draw = &sketch.draw;
    sketch.is_upright = draw_chance(draw, 0.25);
    const Point3 pivot = draw_point3(draw, 0.2);
    add_chain(&sketch, -1, pivot, 1 + draw_below(draw, 3));
    loosen(&sketch, 0);
    bool is_all_loose = true;
    for (size_t i = 0; i < sketch.pin_count; i++) {
        is_all_loose = is_all_loose && sketch.pins[i].has_play;
    }
    write_scene(&sketch, "Random chain in space", seed, is_all_loose && draw_chance(draw, 0.7),
                true, file);
    draw_contact(draw, file);
    draw_run(draw, "duration: 0.5 s", file);
}

// A planar four-bar whose crank is the shortest and whose sum with the longest is less than that of
// the others.
static void sketch_four_bar(SpaceSketch *sketch)
{
    Draw *draw = &sketch->draw;
    const Point3 z = {0.0, 0.0, 1.0};
    const double crank = draw_log_between(draw, 0.03, 0.1);
    const double ground = crank * draw_between(draw, 2.0, 2.6);
    const double coupler = crank * draw_between(draw, 2.0, 2.6);
    const double follower = crank * draw_between(draw, 2.0, 2.6);
    const double angle = draw_between(draw, -M_PI, M_PI);
    const Point elbow = {crank * cos(angle), crank * sin(angle)};
    Point wrist = {0.0, 0.0};
    draw_meet(elbow, coupler, (Point){ground, 0.0}, follower, draw_chance(draw, 0.5), &wrist);
    const Point3 at[4] = {
        {0.0, 0.0, 0.0}, {elbow.x, elbow.y, 0.0}, {wrist.x, wrist.y, 0.0}, {ground, 0.0, 0.0}};
    sketch->is_upright = true;
    for (int i = 0; i < 3; i++) {
        add_body(sketch, at[i], at[i + 1]);
    }
    add_pin(sketch, -1, 0, at[0], z);
    add_pin(sketch, 0, 1, at[1], z);
    add_pin(sketch, 1, 2, at[2], z);
    add_pin(sketch, -1, 2, at[3], z);
}

// A frame whose columns are x, y and z.
typedef struct Frame3 {
    Point3 at;
    Point3 x;
    Point3 y;
    Point3 z;
} Frame3;

static Point3 point3_mix(double a, Point3 first, double b, Point3 second)
{
    return (Point3){a * first.x + b * second.x, a * first.y + b * second.y,
                    a * first.z + b * second.z};
}

// Turns by an angle about z, goes along x and turns by a twist about x (Denavit and Hartenberg).
static Frame3 frame_next(Frame3 from, double angle, double length, double twist)
{
    const Point3 x = point3_mix(cos(angle), from.x, sin(angle), from.y);
    const Point3 y = point3_mix(-sin(angle), from.x, cos(angle), from.y);
    return (Frame3){
        .at = point3_mix(1.0, from.at, length, x),
        .x = x,
        .y = point3_mix(cos(twist), y, sin(twist), from.z),
        .z = point3_mix(-sin(twist), y, cos(twist), from.z),
    };
}

// Bennett's linkage: lengths a and b, twists with a / b = sin(alpha) / sin(beta), and angles with
// tan(first / 2) tan(second / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2).
static void sketch_bennett(SpaceSketch *sketch)
{
    Draw *draw = &sketch->draw;
    const double alpha = draw_between(draw, 0.4, 0.9);
    const double beta = alpha + draw_between(draw, 0.3, 0.6);
    const double a = draw_log_between(draw, 0.05, 0.2);
    const double b = a * sin(beta) / sin(alpha);
    const double first = draw_between(draw, 0.3, 2.6);
    const double second =
        2.0 * atan(sin(0.5 * (beta + alpha)) / sin(0.5 * (beta - alpha)) / tan(0.5 * first));
    const double turns[3] = {first, second, 2.0 * M_PI - first};
    const double lengths[3] = {a, b, a};
    const double twists[3] = {alpha, beta, alpha};
    Frame3 frame = {.x = {1.0, 0.0, 0.0}, .y = {0.0, 1.0, 0.0}, .z = {0.0, 0.0, 1.0}};
    for (int i = 0; i < 3; i++) {
        const Frame3 next = frame_next(frame, turns[i], lengths[i], twists[i]);
        add_pin(sketch, i - 1, i, frame.at, frame.z);
        add_body(sketch, frame.at, next.at);
        frame = next;
    }
    add_pin(sketch, -1, 2, frame.at, frame.z);
}

static double arc_between(Point3 a, Point3 b)
{
    return SPACE_DEGREES * acos(point3_dot(a, b));
}

// A spherical four-bar: all four axes meet in one point.
static void sketch_spherical(SpaceSketch *sketch)
{
    Draw *draw = &sketch->draw;
    Point3 axes[4] = {draw_direction(draw)};
    Point3 at[4];
    for (;;) {
        axes[1] = draw_direction(draw);
        axes[2] = draw_direction(draw);
        axes[3] = draw_direction(draw);
        const double crank = arc_between(axes[0], axes[1]);
        const double coupler = arc_between(axes[1], axes[2]);
        const double follower = arc_between(axes[2], axes[3]);
        const double ground = arc_between(axes[3], axes[0]);
        const double volume = point3_dot(axes[1], point3_cross(axes[2], axes[3]));
        if (crank > 12.0 && crank < 35.0 && coupler > 60.0 && coupler < 110.0 && follower > 60.0 &&
            follower < 110.0 && ground > 70.0 && ground < 110.0 && fabs(volume) > 0.5) {
            break;
        }
    }
    for (int i = 0; i < 4; i++) {
        at[i] = point3_times(draw_between(draw, 0.05, 0.2), axes[i]);
    }
    for (int i = 0; i < 3; i++) {
        add_body(sketch, at[i], at[i + 1]);
        add_pin(sketch, i - 1, i, at[i], axes[i]);
    }
    add_pin(sketch, -1, 2, at[3], axes[3]);
}

static void write_driven(uint64_t seed, FILE *file)
{
    SpaceSketch sketch = {.draw = draw_start(seed)};
    Draw *draw = &sketch.draw;
    const size_t which = draw_below(draw, 4);
    if (which == 0) {
        sketch.is_upright = draw_chance(draw, 0.25);
        const size_t count = 2 + draw_below(draw, 2);
        add_chain(&sketch, -1, draw_point3(draw, 0.2), count);
    } else if (which == 1) {
        sketch_four_bar(&sketch);
    } else if (which == 2) {
        sketch_bennett(&sketch);
    } else {
        sketch_spherical(&sketch);
    }
    if (!draw_chance(draw, 0.15)) {
        loosen(&sketch, 1);
    }
    write_scene(&sketch, "Random driven mechanism in space", seed, false, false, file);
    fprintf(file, "drive: {joint: joint-0, speed: %.5g rpm}\n", draw_speed_rpm(draw));
    draw_contact(draw, file);
    draw_run(draw, "revolutions: 1", file);
}

const CaseKind CASE_SPACE = {
    .name = "space",
    .summary = "chains in space that hang or lie anyhow, pins with collars, hinges with backlash",
    .write = write_undriven,
};

const CaseKind CASE_SPACE_DRIVEN = {
    .name = "space-driven",
    .summary = "a crank with a chain, four-bars, Bennett's and spherical linkages in space",
    .write = write_driven,
};
