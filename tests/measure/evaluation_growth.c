// How does the cost of an evaluation of the reference's equations of motion grow with a mechanism?
//
// evaluation_growth: microseconds of processor time and bytes for N = 1, 2, 4 ... 1024 of each
// kind, some in space, with the exponents between the first and the last four of N.
// evaluation_growth KIND N COUNT: so many evaluations, to count their instructions.
#include "base/clock.h"
#include "lifted.h"
#include "reference/system.h"

#include <assert.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST = 1024, REPEATS = 5 };

static const double MEASURED_S = 0.02;

static void add_body(Linkage *linkage, double x, double y)
{
    linkage->bodies[linkage->body_count++] =
        (Body){.mass = 1.0, .inertia = 0.1, .start.position = {x, y}};
}

// Joins two bodies at a point of the world.
static void join(Linkage *linkage, int body_a, int body_b, double x, double y, double play)
{
    const Vec2 point = {x, y};
    const Vec2 none = {0.0, 0.0};
    const Vec2 a = body_a < 0 ? none : linkage->bodies[body_a].start.position;
    const Vec2 b = body_b < 0 ? none : linkage->bodies[body_b].start.position;
    linkage->joints[linkage->joint_count++] = (Joint){
        .kind = play > 0.0 ? JOINT_CLEARANCE : JOINT_REVOLUTE,
        .body_a = body_a,
        .body_b = body_b,
        .anchor_a = vec2_sub(point, a),
        .anchor_b = vec2_sub(point, b),
        .clearance = {.hole_radius = 0.01 + play, .pin_radius = 0.01, .width = 0.01},
    };
}

static void chain(Linkage *linkage, int count, double play)
{
    for (int i = 0; i < count; i++) {
        add_body(linkage, i + 0.5, 0.0);
        join(linkage, i - 1, i, i, 0.0, play);
    }
}

static void pendula(Linkage *linkage, int count, double play)
{
    for (int i = 0; i < count; i++) {
        add_body(linkage, i, -0.5);
        join(linkage, LINKAGE_GROUND, i, i, 0.0, play);
    }
}

static void four_bars(Linkage *linkage, int count, double play)
{
    for (int i = 0; i < count; i++) {
        const double x = 4.0 * i;
        const int first = (int)linkage->body_count;
        add_body(linkage, x, 0.5);
        add_body(linkage, x + 1.0, 1.3);
        add_body(linkage, x + 2.0, 0.8);
        join(linkage, LINKAGE_GROUND, first, x, 0.0, play);
        join(linkage, first, first + 1, x, 1.0, play);
        join(linkage, first + 1, first + 2, x + 2.0, 1.6, play);
        join(linkage, LINKAGE_GROUND, first + 2, x + 2.0, 0.0, play);
    }
}

// Four-bars that share their uprights.
static void in_a_row(Linkage *linkage, int count, double play)
{
    add_body(linkage, 0.0, 0.5);
    join(linkage, LINKAGE_GROUND, 0, 0.0, 0.0, play);
    for (int i = 0; i < count; i++) {
        const int coupler = (int)linkage->body_count;
        const int before = i == 0 ? 0 : coupler - 1;
        add_body(linkage, i + 0.5, 1.1);
        add_body(linkage, i + 1.0, 0.5);
        join(linkage, LINKAGE_GROUND, coupler + 1, i + 1.0, 0.0, play);
        join(linkage, before, coupler, i, 1.0, play);
        join(linkage, coupler, coupler + 1, i + 1.0, 1.0, play);
    }
}

static void scissor(Linkage *linkage, int count, double play)
{
    for (int i = 0; i < count; i++) {
        const int left = 2 * i;
        add_body(linkage, 0.0, i + 0.5);
        add_body(linkage, 0.1, i + 0.4);
        join(linkage, left, left + 1, 0.0, i + 0.5, play);
        if (i == 0) {
            join(linkage, LINKAGE_GROUND, left, -0.5, 0.0, play);
        } else {
            join(linkage, left - 2, left + 1, 0.5, i, play);
            join(linkage, left - 1, left, -0.5, i, play);
        }
    }
}

typedef struct Kind {
    const char *name;
    void (*fill)(Linkage *linkage, int count, double play);
    double play; // m
    bool is_spatial;
} Kind;

static const Kind KINDS[] = {
    {"chain", chain, 0.0, false},
    {"chain-loose", chain, 1e-4, false},
    {"pendula", pendula, 0.0, false},
    {"pendula-loose", pendula, 1e-4, false},
    {"four-bars", four_bars, 0.0, false},
    {"four-bars-loose", four_bars, 1e-4, false},
    {"row", in_a_row, 0.0, false},
    {"row-loose", in_a_row, 1e-4, false},
    {"scissor", scissor, 0.0, false},
    {"scissor-loose", scissor, 1e-4, false},
    {"space-chain", chain, 0.0, true},
    {"space-chain-loose", chain, 1e-4, true},
    {"space-four-bars", four_bars, 0.0, true},
    {"space-four-bars-loose", four_bars, 1e-4, true},
    {"space-row", in_a_row, 0.0, true},
    {"space-row-loose", in_a_row, 1e-4, true},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

typedef struct Made {
    Scenario scenario;
    System *system;
    double *y;
    double *rates;
    size_t bytes;
} Made;

static void make(const Kind *kind, int count, Made *made)
{
    const size_t most = 4 * (size_t)count + 4;
    *made = (Made){.scenario = {.contact = contact_options_default(), .gravity = {.y = -9.81}}};
    Linkage *linkage = &made->scenario.linkage;
    *linkage = linkage_create((LinkageRoom){.bodies = most, .joints = most});
    made->scenario.contact.stiffness = 1e9;
    made->scenario.contact.exponent = 1.5;
    kind->fill(linkage, count, kind->play);
    if (kind->is_spatial) {
        lifted(linkage, kind->fill == chain);
    }
    const size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
    Err err = {ERR_NONE, ""};
    made->system = kind->is_spatial ? space_system_create(&made->scenario, &err)
                                    : plane_system_create(&made->scenario, &err);
    assert(made->system != NULL);
    made->bytes = mallinfo2().uordblks + mallinfo2().hblkhd - before;
    for (size_t i = 0; i < made->system->contact_count; i++) {
        made->system->contacts[i].mode = CONTACT_PRESSING;
    }
    made->y = calloc(2 * system_size(made->system), sizeof *made->y);
    assert(made->y != NULL);
    made->rates = made->y + system_size(made->system);
    made->system->kind->start(made->system, made->y);
}

static void release(Made *made)
{
    made->system->kind->destroy(made->system);
    linkage_free(&made->scenario.linkage);
    free(made->y);
}

static void evaluate(Made *made, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        made->system->kind->rates(1e-6, made->y, made->rates, made->system);
    }
    assert(isfinite(made->rates[made->system->coordinate_count]));
}

// Processor time of an evaluation, s: the least of some.
static double cost(Made *made)
{
    size_t count = 1;
    double least_s = INFINITY;
    for (int i = 0; i < REPEATS;) {
        const double started_s = clock_processor_s();
        evaluate(made, count);
        const double spent_s = clock_processor_s() - started_s;
        if (spent_s < MEASURED_S) {
            count *= 2;
            continue;
        }
        least_s = fmin(least_s, spent_s / (double)count);
        i++;
    }
    return least_s;
}

static void tabulate(const Kind *kind)
{
    enum { MOST = 11 };
    double costs_s[MOST];
    double bytes[MOST];
    int count = 0;
    printf("%-16s", kind->name);
    for (int n = 1; n <= LARGEST; n *= 2) {
        Made made;
        make(kind, n, &made);
        costs_s[count] = cost(&made);
        bytes[count] = (double)made.bytes;
        printf(" %8.3g", 1e6 * costs_s[count++]);
        fflush(stdout);
        release(&made);
    }
    const double last = log2(costs_s[count - 1] / costs_s[count - 5]) / 4.0;
    const double all = log2(costs_s[count - 1] / costs_s[0]) / (double)(count - 1);
    const double memory = log2(bytes[count - 1] / bytes[count - 5]) / 4.0;
    printf("  %5.2f %5.2f  %8.0f %5.2f\n", all, last, bytes[count - 1], memory);
}

int main(int argc, char **argv)
{
    for (int i = 0; i < KIND_COUNT; i++) {
        if (argc == 1) {
            tabulate(&KINDS[i]);
        } else if (argc == 4 && strcmp(argv[1], KINDS[i].name) == 0) {
            Made made;
            make(&KINDS[i], atoi(argv[2]), &made);
            evaluate(&made, (size_t)atol(argv[3]));
            release(&made);
            return 0;
        }
    }
    if (argc != 1) {
        fprintf(stderr, "usage: evaluation_growth [KIND N COUNT]\n");
        return 2;
    }
    return 0;
}
