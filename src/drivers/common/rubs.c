// Finds what presses in ideal joints that rub.
#include "drivers/common/rubs.h"

#include "kernel/friction_answer.h"

#include <string.h>

static const DriverPlace *place_of(const Rubs *rubs, size_t rub)
{
    const DriverCase *of = rubs->tree->of;
    return &of->places[of->place_count + rub];
}

static const DriverJoint *joint_of(const Rubs *rubs, size_t rub)
{
    return &rubs->tree->of->joints[place_of(rubs, rub)->joint];
}

// Whether a drive turns a body, by whatever means: of driver_drive_of only those that the engine
// has.
static bool is_driven(const DriverCase *of, int body)
{
    bool is = of->has_drive && of->driven_body == body;
    for (size_t i = 0; i < of->drive_count; i++) {
        is = is || of->drives[i].body == body;
    }
    return is;
}

// How the two bodies of a joint accelerate against each other without any joint.
static double mobility_alone(const DriverCase *of, const DriverJoint *joint)
{
    double sum = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = joint->bodies[side];
        if (body != DRIVER_GROUND && !is_driven(of, body)) {
            sum += 1.0 / (joint->slides ? of->bodies[body].mass : of->bodies[body].inertia);
        }
    }
    return sum;
}

Rubs rubs_make(const Tree *tree, const Hold *hold, Kernel *kernel)
{
    const DriverCase *of = tree->of;
    const size_t n = of->rub_count;
    const size_t rows = kernel_rows(kernel);
    Rubs rubs = {.tree = tree, .hold = hold, .kernel = kernel, .count = n, .rows = rows};
    if (n == 0) {
        return rubs;
    }
    rubs.answers = driver_room(2 * n * rows, sizeof(double));
    rubs.turning = driver_room(2 * n * rows, sizeof(double));
    rubs.late = driver_room(2 * n * rows, sizeof(double));
    rubs.before = driver_room(2 * n, sizeof(double));
    rubs.reactions = driver_room(2 * n, sizeof(double));
    rubs.changes = driver_room(n * (n + 2), sizeof(double));
    rubs.carried = driver_room(of->body_count, sizeof *rubs.carried);
    rubs.carry = driver_room(of->body_count, sizeof *rubs.carry);
    for (size_t i = 0; i < n; i++) {
        KernelRub *rub = &kernel->rubs[i];
        rub->is_guide = joint_of(&rubs, i)->slides;
        rub->steady = of->rubs[i].is_steady ? 1.0 : 0.0;
        rub->alone = mobility_alone(of, joint_of(&rubs, i));
        rub->answers = rubs.answers + 2 * i * rows;
        rub->turning = rubs.turning + 2 * i * rows;
        rub->late = rubs.late + 2 * i * rows;
    }
    return rubs;
}

// What acts on the bodies beside the joints of the tree, taken from what they are to be given.
static void take_acting(const Rubs *rubs, const RubsInstant *at)
{
    const DriverCase *of = rubs->tree->of;
    for (size_t i = 0; i < of->body_count; i++) {
        rubs->carry[i] = at->actions[i];
    }
    for (size_t row = 0; row < rubs->hold->rows; row++) {
        hold_push(rubs->hold, row, at->motions, at->held[row], rubs->carry);
    }
}

// What the joint of each body gives it, about its centre, from the leaves on.
static void find_carried(const Rubs *rubs, const RubsInstant *at)
{
    const Tree *tree = rubs->tree;
    const DriverCase *of = tree->of;
    take_acting(rubs, at);
    // velocities are linear in the rates
    tree_motions(tree, at->q, at->a, rubs->carried);
    for (size_t i = 0; i < of->body_count; i++) {
        const DriverBody *body = &of->bodies[i];
        DriverAction *own = &rubs->carry[i];
        Vec2 a = vec2_sub(rubs->carried[i].velocity, at->gravity);
        a = at->bends != NULL ? vec2_add(a, at->bends[i]) : a;
        own->force = vec2_sub(vec2_scale(body->mass, a), own->force);
        own->moment = body->inertia * rubs->carried[i].omega - own->moment;
    }
    for (size_t k = of->body_count; k-- > 0;) {
        const size_t i = tree->order[k];
        const int parent = tree->bodies[i].parent;
        if (parent == DRIVER_GROUND || tree->bodies[i].kind == TREE_FREE) {
            continue;
        }
        const Vec2 arm = vec2_sub(at->motions[i].position, at->motions[parent].position);
        DriverAction *to = &rubs->carry[parent];
        to->force = vec2_add(to->force, rubs->carry[i].force);
        to->moment += rubs->carry[i].moment + vec2_cross(arm, rubs->carry[i].force);
    }
}

// The reaction of a slider of the tree: across its line, and the couple about anchor b.
static Vec2 of_slider(const Rubs *rubs, const RubsInstant *at, size_t rub, int body)
{
    const DriverJoint *joint = joint_of(rubs, rub);
    const double length = rubs->tree->of->rubs[rub].length;
    const int a = joint->bodies[0];
    const double turned = a == DRIVER_GROUND ? 0.0 : at->motions[a].angle;
    const Vec2 across = vec2_perp(vec2_rotate(turned + joint->direction, (Vec2){1.0, 0.0}));
    const Vec2 point = driver_point(at->motions, joint->bodies[1], joint->anchors[1]);
    const DriverAction *given = &rubs->carry[body];
    const Vec2 arm = vec2_sub(at->motions[body].position, point);
    const double couple = given->moment + vec2_cross(arm, given->force);
    return (Vec2){vec2_dot(across, given->force), length > 0.0 ? 2.0 * couple / length : 0.0};
}

// The reaction of a joint that closes a loop.
static Vec2 of_loop(const Rubs *rubs, const RubsInstant *at, int joint)
{
    size_t loop = 0;
    while (rubs->hold->joints[loop] != joint) {
        loop++;
    }
    return (Vec2){at->held[2 * loop], at->held[2 * loop + 1]};
}

void rubs_react(Rubs *rubs, const RubsInstant *at, double *reactions)
{
    const Tree *tree = rubs->tree;
    find_carried(rubs, at);
    for (size_t i = 0; i < rubs->count; i++) {
        const int number = place_of(rubs, i)->joint;
        const DriverJoint *joint = joint_of(rubs, i);
        const int side =
            joint->bodies[1] != DRIVER_GROUND && tree->bodies[joint->bodies[1]].joint == number ? 1
                                                                                                : 0;
        const int body = joint->bodies[side];
        const Vec2 is = tree->is_left[number] ? of_loop(rubs, at, number)
                        : joint->slides       ? of_slider(rubs, at, i, body)
                                              : rubs->carry[body].force;
        reactions[2 * i] = is.x;
        reactions[2 * i + 1] = is.y;
    }
}

void rubs_take(const Rubs *rubs, size_t row, const double *reactions, double *by_row)
{
    for (size_t i = 0; i < rubs->count; i++) {
        double *own = by_row + 2 * (i * rubs->rows + row);
        own[0] = reactions[2 * i];
        own[1] = reactions[2 * i + 1];
    }
}

static void check_answer(Rubs *rubs)
{
    const int failed = friction_answer_of_rubs_fails(rubs->kernel, rubs->changes);
    if (failed >= 0) {
        Err err = {0};
        friction_answer_refuse(joint_of(rubs, (size_t)failed)->name, &err);
        driver_fail("%s", err.text);
    }
}

void rubs_fill(Rubs *rubs, const double *reactions, double since_s)
{
    check_answer(rubs);
    for (size_t i = 0; i < rubs->count; i++) {
        KernelRub *rub = &rubs->kernel->rubs[i];
        for (size_t k = 0; k < 2; k++) {
            const double change = reactions[2 * i + k] - rubs->before[2 * i + k];
            rub->reaction[k] = reactions[2 * i + k];
            rub->rate[k] = since_s > 0.0 ? change / since_s : 0.0;
        }
    }
}

void rubs_keep(Rubs *rubs, const double *impulses)
{
    for (size_t i = 0; i < rubs->count; i++) {
        for (size_t k = 0; k < 2; k++) {
            double *before = &rubs->before[2 * i + k];
            *before = rubs->kernel->rubs[i].reaction[k];
            for (size_t row = 0; row < rubs->rows; row++) {
                *before += rubs->late[2 * (i * rubs->rows + row) + k] * impulses[row];
            }
        }
    }
}
