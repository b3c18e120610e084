// Steps an engine with the contacts of pins in holes integrated within its steps, by trials.
//
// The scheme is that of drivers/mujoco/mujoco_kernel.c, with G(q, v, f) the engine's accelerations
// of the coordinates under forces f in the rows, F = J G + J' v those of the rows:
//     A = G(q_m, v_m, 1) - G(q_m, v_m, 0),  W = J A
//     2 S = (F(v_m + e A) - F(v_m)) / e,    B = (G(v_m + e A) - G(v_m)) / e
//     a + B Q/h + A P/h = G(q_m, v_m + A Q/h, P/h)
//     v' = v + h a + h^3/24 a'' + B Q + B' (h/2 Q - R) + A P + A' (h/2 P - Q)
//     q' = q + h v + h^2/2 a - h^3/12 a' + h^4/48 a'' + B R + A Q + A' (h/2 Q - 2 R)
#include "drivers/common/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// of the velocities: what they are changed by for S
static const double NUDGE = 1e-3;

// A step of a trial, s, in which joints that are open by a rounding are closed by accelerations of
// that over its square; and rad that the fastest body may turn in it: Bullet stops at pi / 2.
static const double TRIAL_S = 1e-4;
static const double TRIAL_PHASE = 0.1;

typedef struct Trial {
    Within in;
    const Tree *tree;
    TrialAccelerate accelerate;
    void *engine;
    DriverRun *run;
    double *other;         // by coordinate; owned, as all arrays
    DriverMotion *motions; // by body
    DriverMotion *tried;   // of a trial
    DriverAction *actions; // by body
    double start_s;        // of the step under way
} Trial;

// to += scale from
static void add(double *to, const double *from, double scale, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        to[i] += scale * from[i];
    }
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// The engine's accelerations under forces in the rows; NULL: none.
static void evaluate(Trial *trial, const double *q, const double *v, const double *forces,
                     double scale, double *a)
{
    const Within *in = &trial->in;
    const DriverCase *of = in->of;
    tree_motions(trial->tree, q, v, trial->tried);
    actions_find(of, trial->tried, trial->start_s, trial->start_s + of->step_s, trial->actions);
    for (size_t i = 0; forces != NULL && i < in->kernel.contact_count; i++) {
        const DriverJoint *joint = &of->joints[in->joints[i]];
        const KernelContact *contact = &in->kernel.contacts[i];
        const double *own = forces + contact->first_row;
        for (size_t side = 0; side < 2; side++) {
            const int body = joint->bodies[side];
            const double sign = side == 0 ? -scale : scale;
            actions_add(trial->tried, body, joint->anchors[side],
                        (Vec2){sign * own[0], sign * own[1]}, trial->actions);
            if (contact->row_count > KERNEL_ROWS_PLAIN && body != DRIVER_GROUND) {
                trial->actions[body].moment += scale * own[KERNEL_ROW_TURN + side];
            }
        }
    }
    trial->accelerate(trial->engine, q, v, trial->actions, a);
    trial->run->steps++;
}

// J at the positions of the motions.
static void find_jacobian(Trial *trial)
{
    memset(trial->in.jacobian, 0, trial->in.rows * trial->in.count * sizeof *trial->in.jacobian);
    for (size_t i = 0; i < trial->in.kernel.contact_count; i++) {
        const DriverJoint *joint = &trial->in.of->joints[trial->in.joints[i]];
        const KernelContact *contact = &trial->in.kernel.contacts[i];
        double *rows = trial->in.jacobian + contact->first_row * trial->in.count;
        for (size_t k = 0; k < KERNEL_ROWS_PLAIN; k++, rows += trial->in.count) {
            const Vec2 unit = {k == 0 ? 1.0 : 0.0, k == 0 ? 0.0 : 1.0};
            tree_push(trial->tree, trial->motions, joint->bodies[1], joint->anchors[1], unit, rows);
            tree_push(trial->tree, trial->motions, joint->bodies[0], joint->anchors[0],
                      vec2_scale(-1.0, unit), rows);
        }
        for (size_t side = 0; KERNEL_ROW_TURN + side < contact->row_count; side++) {
            tree_turn(trial->tree, joint->bodies[side], 1.0, rows + side * trial->in.count);
        }
    }
}

// What the velocities alone accelerate a point of a body by.
static Vec2 bend_of(const Trial *trial, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const DriverMotion *motion = &trial->motions[body];
    const Vec2 arm = vec2_rotate(motion->angle, local);
    return vec2_sub(trial->tree->bends[body], vec2_scale(motion->omega * motion->omega, arm));
}

// u'' = J a + J' v at the middle's positions and velocities like those there.
static void find_row_accelerations(Trial *trial, const double *v, const double *a, double *rows)
{
    tree_motions(trial->tree, trial->in.q_middle, v, trial->motions);
    tree_bends(trial->tree, trial->motions, v, trial->tree->bends);
    for (size_t i = 0; i < trial->in.rows; i++) {
        rows[i] = dot(trial->in.jacobian + i * trial->in.count, a, trial->in.count);
    }
    for (size_t i = 0; i < trial->in.kernel.contact_count; i++) {
        const DriverJoint *joint = &trial->in.of->joints[trial->in.joints[i]];
        const Vec2 bend = vec2_sub(bend_of(trial, joint->bodies[1], joint->anchors[1]),
                                   bend_of(trial, joint->bodies[0], joint->anchors[0]));
        double *own = rows + trial->in.kernel.contacts[i].first_row;
        own[0] = bend.x + own[0];
        own[1] = bend.y + own[1];
    }
}

// A and W, from a trial with a force in each row: one that does as much as all that acts.
static void find_response(Trial *trial)
{
    within_age_responses(&trial->in);
    const double size = 1.0 + sqrt(dot(trial->in.free, trial->in.free, trial->in.count));
    for (size_t k = 0; k < trial->in.rows; k++) {
        double *response = trial->in.responses[0] + k * trial->in.count;
        memset(trial->in.work, 0, trial->in.rows * sizeof *trial->in.work);
        trial->in.work[k] = 1.0;
        evaluate(trial, trial->in.q_middle, trial->in.v_middle, trial->in.work, size, response);
        for (size_t i = 0; i < trial->in.count; i++) {
            response[i] = (response[i] - trial->in.free[i]) / size;
        }
    }
    for (size_t i = 0; i < trial->in.rows; i++) {
        for (size_t k = 0; k < trial->in.rows; k++) {
            *kernel_mobility(&trial->in.kernel, i, k) =
                dot(trial->in.jacobian + i * trial->in.count,
                    trial->in.responses[0] + k * trial->in.count, trial->in.count);
        }
    }
}

// S and B, by a velocity that is a little different for each row.
static void find_drift(Trial *trial)
{
    const size_t count = trial->in.count;
    const double speed = sqrt(dot(trial->in.v_middle, trial->in.v_middle, count));
    for (size_t k = 0; k < trial->in.rows; k++) {
        const double *response = trial->in.responses[0] + k * count;
        const double size = sqrt(dot(response, response, count));
        if (!(size > 0.0)) {
            continue; // a turn of the ground: nothing follows it
        }
        const double nudge = NUDGE * (speed > 0.0 ? speed : 1.0) / size;
        memcpy(trial->in.nudged, trial->in.v_middle, count * sizeof *trial->in.nudged);
        add(trial->in.nudged, response, nudge, count);
        evaluate(trial, trial->in.q_middle, trial->in.nudged, NULL, 0.0, trial->other);
        find_row_accelerations(trial, trial->in.nudged, trial->other, trial->in.work);
        for (size_t i = 0; i < count; i++) {
            trial->in.bend[k * count + i] = (trial->other[i] - trial->in.free[i]) / nudge;
        }
        for (size_t i = 0; i < trial->in.rows; i++) {
            trial->in.drift[i * trial->in.rows + k] =
                (trial->in.work[i] - trial->in.kernel.free[i]) / (2.0 * nudge);
        }
    }
}

// The engine at mid-step under the contacts' mean force.
static void find_accelerations(Trial *trial, double step_s)
{
    Within *in = &trial->in;
    const double per_s = 1.0 / step_s;
    memcpy(in->nudged, in->v_middle, in->count * sizeof *in->nudged);
    within_add_rows(in, in->responses[0], in->sums.moment, per_s, in->nudged);
    evaluate(trial, in->q_middle, in->nudged, in->sums.impulse, per_s, trial->other);
    within_take_accelerations(in, trial->other, step_s);
}

static void take_step(Trial *trial, double step_s)
{
    Within *in = &trial->in;
    within_find_middle(in, step_s);
    within_keep_free(in);
    tree_motions(trial->tree, in->q_middle, in->v_middle, trial->motions);
    find_jacobian(trial);
    evaluate(trial, in->q_middle, in->v_middle, NULL, 0.0, in->free);
    find_response(trial);
    within_find_rate(in, step_s);
    find_row_accelerations(trial, in->v_middle, in->free, in->kernel.free);
    find_drift(trial);
    within_find_free_rate(in, step_s);
    tree_motions(trial->tree, in->q, in->v, trial->motions);
    within_find_rows(in, trial->motions);
    within_integrate(in, step_s);
    find_accelerations(trial, step_s);
    within_find_end(in, step_s);
}

// The bodies at a time in the step that has been taken.
static void read_inside(void *adapter, double since_s, const KernelSums *sums,
                        DriverMotion *motions)
{
    Trial *trial = adapter;
    within_find_inside(&trial->in, since_s, trial->in.of->step_s, sums, trial->in.nudged,
                       trial->other);
    tree_motions(trial->tree, trial->in.nudged, trial->other, motions);
}

static void *room(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (made == NULL) {
        driver_fail("there is no memory");
    }
    return made;
}

static Trial make(const Tree *tree, TrialAccelerate accelerate, void *engine, DriverRun *run)
{
    const DriverCase *of = tree->of;
    if (tree->left_count > 0) {
        driver_refuse("contacts within the step beside a loop of ideal joints");
    }
    Trial trial = {.tree = tree,
                   .accelerate = accelerate,
                   .engine = engine,
                   .run = run,
                   .other = within_numbers(tree->coordinates),
                   .motions = room(of->body_count, sizeof *trial.motions),
                   .tried = room(of->body_count, sizeof *trial.tried),
                   .actions = room(of->body_count, sizeof *trial.actions)};
    within_open(of, tree->coordinates, &trial.in);
    return trial;
}

void trial_run(const Tree *tree, TrialAccelerate accelerate, void *engine, DriverRun *run)
{
    Trial trial = make(tree, accelerate, engine, run);
    const double step_s = tree->of->step_s;
    DriverContact *states = room(tree->of->joint_count, sizeof *states);
    KernelSums sums = kernel_sums(trial.in.rows);
    const WithinStep still = {.kernel = &trial.in.kernel,
                              .joints = trial.in.joints,
                              .states = states,
                              .step_s = step_s,
                              .motions = read_inside,
                              .adapter = &trial,
                              .room = room(tree->of->body_count, sizeof(DriverMotion)),
                              .sums = &sums};
    for (size_t i = 0; i < tree->of->joint_count; i++) {
        states[i].state = tree->of->joints[i].contact;
    }
    driver_run_begin(run);
    tree_start(tree, trial.in.v);
    evaluate(&trial, trial.in.q, trial.in.v, NULL, 0.0, trial.in.a);
    while (!driver_run_is_full(run)) {
        WithinStep step = still;
        step.start_s = step_s * (double)trial.in.steps;
        trial.start_s = step.start_s;
        take_step(&trial, step_s);
        trial.in.steps++;
        within_look(&step, run);
        within_go_on(&trial.in);
    }
    driver_run_write(run);
}

// Engines whose coordinates are those of bodies.

double trial_step(const DriverCase *of)
{
    double fastest = 0.0;
    for (size_t i = 0; i < of->body_count; i++) {
        fastest = fmax(fastest, fabs(of->bodies[i].start.omega));
    }
    return fastest > 0.0 ? fmin(TRIAL_S, TRIAL_PHASE / fastest) : TRIAL_S;
}

void trial_place(const Tree *tree, const double *q, const double *v, const DriverAction *given,
                 DriverMotion *motions, DriverAction *actions)
{
    tree_motions(tree, q, v, motions);
    tree_bends(tree, motions, v, tree->bends);
    for (size_t i = 0; i < tree->of->body_count; i++) {
        actions[i] = given[i];
        actions[i].force =
            vec2_sub(given[i].force, vec2_scale(tree->of->bodies[i].mass, tree->bends[i]));
    }
}

static Vec2 gained(const DriverMotion *before, const DriverMotion *after, double step_s)
{
    return vec2_scale(1.0 / step_s, vec2_sub(after->velocity, before->velocity));
}

void trial_read(const Tree *tree, const DriverMotion *before, const DriverMotion *after,
                double step_s, double *a)
{
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const TreeBody *body = &tree->bodies[i];
        const bool has_parent = body->parent != DRIVER_GROUND;
        const double turning = (after[i].omega - before[i].omega) / step_s;
        const double carried =
            has_parent ? (after[body->parent].omega - before[body->parent].omega) / step_s : 0.0;
        const Vec2 going = gained(&before[i], &after[i], step_s);
        double *own = a + body->first;
        if (body->kind == TREE_FREE) {
            own[0] = going.x;
            own[1] = going.y;
            own[2] = turning;
        } else if (body->kind == TREE_TURNS) {
            own[0] = turning - carried;
        } else {
            Vec2 held = {0.0, 0.0};
            Vec2 from = {0.0, 0.0};
            if (has_parent) {
                held = gained(&before[body->parent], &after[body->parent], step_s);
                from = before[body->parent].position;
            }
            const Vec2 arm = vec2_sub(before[i].position, from);
            const Vec2 moved = vec2_add(held, vec2_scale(carried, vec2_perp(arm)));
            own[0] = vec2_dot(vec2_rotate(before[i].angle, body->axis), vec2_sub(going, moved));
        }
    }
}
