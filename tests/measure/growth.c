// How do time and memory of a step grow with the number of bodies?
//
// growth KIND PLAY SOLVER N [STEPS [INTERVAL]]
//   KIND    chain       N links in a row, hung up at one end, level at the start
//           pendula     N pendula that have nothing to do with each other
//           four-bars   N four-bars side by side
//           row         N four-bars in a row that share their uprights
//           scissor     N crossed pairs of bars
//   PLAY    ideal, or loose: every joint a pin with 50 um of play in its hole; space and
//           space-loose: likewise in space, every second axis of a chain tilted; meeting, of a
//           chain: loose, and all pins come to their walls within a step; damped and
//           space-damped, of a chain, which hangs, or a row: all pins lie on their walls, damped
//           so strongly that the reference's steps are implicit
//   INTERVAL  steps from one sample to the next, 16: mechanisms side by side take as many as that
//           before the next one goes on
//   SOLVER  direct, quick: plain steps of ODE; staggered; impulse; reference
// Prints bodies, joints, us and evaluations a step, the memory that the solver takes, KiB, and how
// many steps these are, refused ones too; of loose mechanisms under impulse once pins touch. A step
// is one of 20 us of ODE's world, or one of the reference's own; of mechanisms side by side, each
// of which has its own there, what takes all of them INTERVAL times 20 us on. Nobody looks at the
// states in between. tests/measure/growth.sh makes tables of it.
//
// Whatever N is, steps are those of the same stretch of time, and small ones are run one after the
// other until they are COPIES, no two of which are alike: how often pins bounce depends on both.
#include "base/zeroed.h"
#include "lifted.h"
#include "model/solver.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    STEPS = 200,
    SETTLING = 5,
    LOOSE_SETTLING = 400,
    MEETING = 2,
    DAMPED_SETTLING = 100, // the implicit method takes over at the first look, after 32 steps
    INTERVAL = 16,
    COPIES = 256,
};

static const double STEP_S = 2e-5;
static const double MASS = 0.1;   // kg, of each bar
static const double LENGTH = 0.1; // m, of each link
static const double PIN_RADIUS = 5e-3;
static const double PLAY = 5e-5; // m, radial
static const double WIDTH = 0.01;
static const double MEETING_SPEED = 0.05; // m/s
static const double DAMPER = 1e5;         // N s/m
static const double SUNK = 1e-8;          // m, of pins that are damped: all press at once

typedef struct Build {
    Linkage linkage;
    bool is_loose;
    bool is_damped;
    size_t first; // number of its first bar, of all copies
} Build;

// A bar from one point to another; returns its number.
static int add_bar(Build *build, Vec2 from, Vec2 to)
{
    Linkage *linkage = &build->linkage;
    const Vec2 along = vec2_sub(to, from);
    const double length = vec2_length(along);
    Body *body = &linkage->bodies[linkage->body_count];
    snprintf(body->name, sizeof body->name, "bar-%zu", linkage->body_count);
    // no two alike, so that no two contacts begin at once
    body->mass = MASS * (1.0 + 0.2 * sin(1.7 * (double)(build->first + linkage->body_count)));
    body->inertia = body->mass * length * length / 12.0;
    body->start.position = vec2_scale(0.5, vec2_add(from, to));
    body->start.angle = atan2(along.y, along.x);
    return (int)linkage->body_count++;
}

static Vec2 local(const Linkage *linkage, int body, Vec2 point)
{
    if (body == LINKAGE_GROUND) {
        return point;
    }
    const Motion *start = &linkage->bodies[body].start;
    return vec2_rotate(-start->angle, vec2_sub(point, start->position));
}

static void add_pin(Build *build, int a, int b, Vec2 at)
{
    Linkage *linkage = &build->linkage;
    Joint *joint = &linkage->joints[linkage->joint_count];
    snprintf(joint->name, sizeof joint->name, "pin-%zu", linkage->joint_count++);
    joint->kind = build->is_loose ? JOINT_CLEARANCE : JOINT_REVOLUTE;
    joint->body_a = a;
    joint->body_b = b;
    joint->anchor_a = local(linkage, a, at);
    joint->anchor_b = local(linkage, b, at);
    // no two alike, so that few contacts begin at once
    const double play =
        PLAY * (1.0 + 0.2 * sin(2.3 * (double)(build->first + linkage->joint_count)));
    if (build->is_damped) {
        joint->anchor_a = local(linkage, a, vec2_add(at, (Vec2){0.0, play + SUNK}));
    }
    joint->clearance =
        (Clearance){.hole_radius = PIN_RADIUS + play, .pin_radius = PIN_RADIUS, .width = WIDTH};
}

static void build_chain(Build *build, size_t count)
{
    int before = LINKAGE_GROUND;
    Vec2 from = {0.0, 0.0};
    for (size_t i = 0; i < count; i++) {
        // level, or hanging at an angle that keeps all pins under load
        const double aside = 0.1 * sin(0.7 * (double)i + 0.5);
        const Vec2 along = build->is_damped ? (Vec2){aside * LENGTH, -LENGTH} : (Vec2){LENGTH, 0.0};
        const Vec2 to = vec2_add(from, along);
        const int bar = add_bar(build, from, to);
        add_pin(build, before, bar, from);
        before = bar;
        from = to;
    }
}

static void build_pendula(Build *build, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const Vec2 from = {2.0 * LENGTH * (double)i, 0.0};
        add_pin(build, LINKAGE_GROUND, add_bar(build, from, (Vec2){from.x + LENGTH, 0.0}), from);
    }
}

static void build_four_bars(Build *build, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double x = 4.0 * LENGTH * (double)i;
        const Vec2 points[4] = {{x, 0.0}, {x + 0.05, 0.09}, {x + 0.28, 0.12}, {x + 0.3, 0.0}};
        int before = LINKAGE_GROUND;
        for (int k = 0; k < 3; k++) {
            const int bar = add_bar(build, points[k], points[k + 1]);
            add_pin(build, before, bar, points[k]);
            before = bar;
        }
        add_pin(build, before, LINKAGE_GROUND, points[3]);
    }
}

// The uprights lean, so that gravity moves them at once.
static void build_row(Build *build, size_t count)
{
    const Vec2 up = {0.3 * LENGTH, 0.9 * LENGTH};
    int before = LINKAGE_GROUND;
    for (size_t i = 0; i <= count; i++) {
        const Vec2 foot = {LENGTH * (double)i, 0.0};
        const Vec2 head = vec2_add(foot, up);
        const int upright = add_bar(build, foot, head);
        add_pin(build, LINKAGE_GROUND, upright, foot);
        if (i > 0) {
            const int coupler = add_bar(build, vec2_sub(head, (Vec2){LENGTH, 0.0}), head);
            add_pin(build, before, coupler, vec2_sub(head, (Vec2){LENGTH, 0.0}));
            // what is damped lies on the upright's hole
            const int hole = build->is_damped ? upright : coupler;
            add_pin(build, hole, hole == upright ? coupler : upright, head);
        }
        before = upright;
    }
}

static void build_scissor(Build *build, size_t count)
{
    int low =
        LINKAGE_GROUND; // of the pair before: the bar that ends low and the one that ends high
    int high = LINKAGE_GROUND;
    for (size_t i = 0; i < count; i++) {
        const double x = LENGTH * (double)i;
        const int rising = add_bar(build, (Vec2){x, 0.0}, (Vec2){x + LENGTH, LENGTH});
        const int falling = add_bar(build, (Vec2){x, LENGTH}, (Vec2){x + LENGTH, 0.0});
        add_pin(build, rising, falling, (Vec2){x + 0.5 * LENGTH, 0.5 * LENGTH});
        add_pin(build, low, rising, (Vec2){x, 0.0});
        if (i > 0) {
            add_pin(build, high, falling, (Vec2){x, LENGTH});
        }
        low = falling;
        high = rising;
    }
}

// Moves the links of a chain so that each pin meets its wall at a time of its own in the same step,
// by turns above and below.
static void bring_to_walls(Linkage *linkage)
{
    double offset = 0.0;
    double speed = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Clearance *clearance = &linkage->joints[i].clearance;
        const double sign = i % 2 == 0 ? -1.0 : 1.0;
        const double closing = MEETING_SPEED * (1.0 + 0.2 * sin(3.1 * (double)i));
        const double left_s = STEP_S * (MEETING + 0.5 + 0.4 * sin(1.3 * (double)i));
        offset += sign * (clearance->hole_radius - clearance->pin_radius - closing * left_s);
        speed += sign * closing;
        linkage->bodies[i].start.position.y += offset;
        linkage->bodies[i].start.velocity.y = speed;
    }
}

typedef struct Kind {
    const char *name;
    void (*build)(Build *, size_t);
} Kind;

static const Kind KINDS[] = {
    {"chain", build_chain}, {"pendula", build_pendula}, {"four-bars", build_four_bars},
    {"row", build_row},     {"scissor", build_scissor},
};

// Chooses the way of stepping; returns the solver, or NULL.
static const Solver *choose(const char *name, Scenario *scenario)
{
    scenario->run.step = STEP_S;
    scenario->run.duration = 1e5 * STEP_S; // longer than anything here
    scenario->ode.stepping = ODE_PLAIN;
    scenario->ode.map = ODE_MAP_MIDPOINT;
    if (strcmp(name, "quick") == 0) {
        scenario->ode.solver = ODE_QUICK;
    } else if (strcmp(name, "staggered") == 0) {
        scenario->ode.stepping = ODE_STAGGERED;
    } else if (strcmp(name, "impulse") == 0) {
        scenario->ode.stepping = ODE_STAGGERED;
        scenario->ode.map = ODE_MAP_IMPULSE;
    } else if (strcmp(name, "reference") == 0) {
        return &REFERENCE_SOLVER;
    } else if (strcmp(name, "direct") != 0) {
        return NULL;
    }
    return &ODE_SOLVER;
}

static double processor_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static size_t in_use(void)
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

// A solver that is under way, sampled every so many steps of ODE's.
typedef struct Going {
    const Solver *solver;
    void *state;
    bool is_fixed; // whether its steps are ODE's
    size_t interval;
    double sample_s;
    double reached_s;
} Going;

// Takes steps until a number of ODE's have been taken since time zero, or that number of others.
static bool take_steps(Going *going, size_t steps, Err *err)
{
    const double end_s = ((double)steps - 0.5) * STEP_S;
    bool is_partial = false; // a step may be handed on in several records
    for (size_t i = 0; is_partial || (going->is_fixed ? going->reached_s < end_s : i < steps);) {
        if (!is_partial && going->reached_s > going->sample_s - 0.5 * STEP_S) {
            going->sample_s = going->reached_s + (double)going->interval * STEP_S;
        }
        // mechanisms side by side are each stepped to there, one by itself by a step of its own
        const double stop_s = going->is_fixed ? fmin(going->sample_s, end_s) : going->sample_s;
        if (!going->solver->step(going->state, stop_s, err)) {
            return false;
        }
        const StepRecord record = going->solver->record(going->state);
        is_partial = record.is_partial;
        if (!is_partial) {
            going->reached_s = solver_reached(&record);
            i++;
        }
    }
    return true;
}

// The steps that are measured. Valgrind can be told to count in here alone.
__attribute__((noinline)) bool growth_take(Going *going, size_t steps, Err *err);
__attribute__((noinline)) bool growth_take(Going *going, size_t steps, Err *err)
{
    return take_steps(going, steps, err);
}

// What was measured, of all copies together.
typedef struct Totals {
    size_t copies;
    double opening_s;
    double taken_s;
    double steps;
    double evaluations;
    size_t bytes;
} Totals;

typedef struct Task {
    const Kind *kind;
    const char *play;
    size_t count;
    size_t steps;
    size_t interval;
} Task;

static bool measure(const Task *task, const Scenario *scenario, const Solver *solver,
                    size_t settling, Totals *totals)
{
    Err err = {ERR_NONE, ""};
    Going going = {
        .solver = solver, .is_fixed = solver != &REFERENCE_SOLVER, .interval = task->interval};
    const size_t before = in_use();
    const double opening_s = processor_s();
    // the first steps find the contacts
    if (!solver->open(scenario, &going.state, &err) || !take_steps(&going, settling, &err)) {
        fprintf(stderr, "growth: %s\n", err.text);
        return false;
    }
    const SolverModel start = solver->model(going.state);
    const double begun_s = processor_s();
    if (!growth_take(&going, (going.is_fixed ? settling : 0) + task->steps, &err)) {
        fprintf(stderr, "growth: %s\n", err.text);
        return false;
    }
    totals->taken_s += processor_s() - begun_s;
    const SolverModel end = solver->model(going.state);
    totals->copies++;
    totals->opening_s += begun_s - opening_s;
    totals->steps += (double)(end.steps - start.steps);
    totals->evaluations += (double)(end.evaluations - start.evaluations);
    totals->bytes += in_use() - before;
    solver->close(going.state);
    return true;
}

static void print_totals(const Linkage *linkage, const Totals *totals)
{
    printf("%zu bodies %zu joints %.3f us a step %.1f evaluations a step %zu KiB %.3f ms to open, "
           "%.0f steps in all\n",
           linkage->body_count, linkage->joint_count, 1e6 * totals->taken_s / totals->steps,
           totals->evaluations / totals->steps, totals->bytes / totals->copies / 1024,
           1e3 * totals->opening_s / (double)totals->copies, totals->steps);
}

// Builds and runs the number asked for, of bars from a number on, and moves that on.
static bool run_copy(const Task *task, const Solver *solver, Scenario *scenario, size_t *first,
                     Totals *totals)
{
    const bool is_meeting = strcmp(task->play, "meeting") == 0;
    const bool is_damped = strstr(task->play, "damped") != NULL;
    Build build = {
        .is_loose = is_meeting || is_damped || strstr(task->play, "loose") != NULL,
        .is_damped = is_damped,
        .linkage = linkage_create(
            (LinkageRoom){.bodies = 3 * task->count + 1, .joints = 4 * task->count + 1}),
        .first = *first,
    };
    task->kind->build(&build, task->count);
    if (is_meeting) {
        bring_to_walls(&build.linkage);
    }
    if (strncmp(task->play, "space", strlen("space")) == 0) {
        lifted(&build.linkage, task->kind->build == build_chain);
    }
    *first += build.linkage.body_count;
    scenario->linkage = build.linkage;
    if (is_damped) {
        scenario->run.duration = 1e3; // steps are long
        scenario->contact.damping = DAMPING_VISCOUS;
        scenario->contact.viscous_coefficient = DAMPER;
    }
    // pins fall through their play in 160 steps
    const bool has_contacts = build.is_loose && scenario->ode.map == ODE_MAP_IMPULSE;
    const size_t settling = is_meeting     ? MEETING
                            : has_contacts ? LOOSE_SETTLING
                            : is_damped    ? DAMPED_SETTLING
                                           : SETTLING;
    const bool is_done = measure(task, scenario, solver, settling, totals);
    if (is_done && totals->copies * task->count >= COPIES) {
        print_totals(&build.linkage, totals);
    }
    linkage_free(&build.linkage);
    return is_done;
}

int main(int argc, char **argv)
{
    Task task = {.play = argc >= 3 ? argv[2] : "", .steps = STEPS, .interval = INTERVAL};
    for (size_t i = 0; argc >= 5 && i < sizeof KINDS / sizeof *KINDS; i++) {
        task.kind = strcmp(argv[1], KINDS[i].name) == 0 ? &KINDS[i] : task.kind;
    }
    Scenario scenario = scenario_default();
    const Solver *solver = argc >= 5 ? choose(argv[3], &scenario) : NULL;
    task.count = argc >= 5 ? strtoul(argv[4], NULL, 10) : 0;
    task.steps = argc >= 6 ? strtoul(argv[5], NULL, 10) : STEPS;
    task.interval = argc >= 7 ? strtoul(argv[6], NULL, 10) : INTERVAL;
    if (task.kind == NULL || solver == NULL || task.count == 0 || task.steps == 0 || argc > 7) {
        fprintf(stderr, "usage: growth KIND PLAY SOLVER N [STEPS [INTERVAL]]\n");
        return 2;
    }
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    Totals totals = {0};
    size_t first = 0;
    while (totals.copies * task.count < COPIES) {
        if (!run_copy(&task, solver, &scenario, &first, &totals)) {
            return 4;
        }
    }
    return 0;
}
