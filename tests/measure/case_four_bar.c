// A random crank-rocker or drag link in the short form, with play in one to three of its joints.
#include "random_case.h"
#include "random_draw.h"

// of the transmission angle over a turn, deg: nearer to a dead centre forces have no bound
static const double LEAST_TRANSMISSION = 15.0;

typedef struct Lengths {
    double ground;
    double crank;
    double coupler;
    double follower; // mm
} Lengths;

// The angle between coupler and follower where the diagonal has a length, deg; NAN if it cannot.
static double transmission(const Lengths *l, double diagonal)
{
    const double cosine =
        (l->coupler * l->coupler + l->follower * l->follower - diagonal * diagonal) /
        (2.0 * l->coupler * l->follower);
    const double angle = acos(cosine) * 180.0 / M_PI;
    return fmin(angle, 180.0 - angle);
}

static Lengths draw_lengths(Draw *draw)
{
    for (;;) {
        const double size = draw_log_between(draw, 30.0, 600.0);
        const Lengths l = {
            .ground = size * draw_between(draw, 0.3, 1.5),
            .crank = size * draw_between(draw, 0.1, 0.9),
            .coupler = size * draw_between(draw, 0.3, 1.8),
            .follower = size * draw_between(draw, 0.3, 1.8),
        };
        const double folded = transmission(&l, fabs(l.ground - l.crank));
        const double stretched = transmission(&l, l.ground + l.crank);
        // a diagonal that cannot be has none
        if (folded >= LEAST_TRANSMISSION && stretched >= LEAST_TRANSMISSION) {
            return l;
        }
    }
}

static void write_link(Draw *draw, const char *name, double length_mm, FILE *file)
{
    // slender steel to stout aluminium
    const double mass = length_mm * draw_log_between(draw, 3e-4, 5e-3);
    const double inertia = mass * length_mm * length_mm / 12.0 * draw_between(draw, 0.6, 1.6);
    fprintf(file, "  %s: {length: %.6g mm, mass: %.5g kg, inertia: %.5g kg mm^2}\n", name,
            length_mm, mass, inertia);
}

static void write_joints(Draw *draw, FILE *file)
{
    static const char *const NAMES[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    const size_t count = 1 + draw_below(draw, 3);
    const size_t first = draw_below(draw, 3);
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < count; i++) {
        fprintf(file, "  %s: {", NAMES[(first + i) % 3]);
        draw_play(draw, file);
        fprintf(file, "}\n");
    }
}

static void write_case(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    const Lengths l = draw_lengths(&draw);
    fprintf(file, "title: Random four-bar %llu\n", (unsigned long long)seed);
    fprintf(file, "four-bar:\n  ground: {length: %.6g mm}\n", l.ground);
    write_link(&draw, "crank", l.crank, file);
    write_link(&draw, "coupler", l.coupler, file);
    write_link(&draw, "follower", l.follower, file);
    fprintf(file, "  assembly: %s\n", draw_chance(&draw, 0.5) ? "open" : "crossed");
    write_joints(&draw, file);
    const double start_deg = draw_between(&draw, 0.0, 360.0);
    fprintf(file, "drive: {speed: %.5g rpm, start: %.4g deg}\n", draw_speed_rpm(&draw), start_deg);
    draw_contact(&draw, file);
    draw_run(&draw, "revolutions: 1", file);
}

const CaseKind CASE_FOUR_BAR = {
    .name = "four-bar",
    .summary = "crank-rockers and drag links, play in 1 to 3 joints",
    .write = write_case,
};
