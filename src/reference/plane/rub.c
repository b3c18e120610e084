// Solves for the friction of ideal joints in the plane, which changes what presses in them.
//
// A pivot whose reaction is R, with a pin of radius r, holds a torque mu r |R| against its turning;
// a guide a force mu N, N what presses on its two ends together:
//     N = max(|Q|, 2 |M| / l)
// with Q the force across it, M the moment, l the length of the guide (l = 0: N = |Q|). Of each,
// a share s holds (kernel/bristle.h). The reactions are linear in the frictions F_j of all joints:
//     F_i = s_i k_i |p_i + sum_j D_ij F_j|,   k = mu r, or mu
// D comes from solving the equations of motion with each F_j by itself, F from Newton's method. The
// right side contracts, and has one fixed point, where the matrix k_i r_i |D_ij| has an eigenvalue
// below 1, r_i >= |s_i| (kernel/friction_answer.h). Of a single body on a fixed pivot D is about 1
// over its arm: where mu r comes up to that, friction may have no answer, or two, and is refused.
//
// Of a guide N has corners, where another of the faces Q, -Q, 2 M / l, -2 M / l presses most: those
// are events, between which the face that presses goes on by itself.
#include "reference/plane/dynamics.h"

#include "base/dense.h"
#include "base/zeroed.h"
#include "kernel/friction_answer.h"
#include "model/joint_friction.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    RUB_FACES = 4,
    RUB_SOLVES = 4,      // full solutions at most: the first has all but rounding
    RUB_ITERATIONS = 30, // of Newton's method, on the linear reactions
};

// of what acts on the bodies: what rounding leaves of a friction, and of what presses
static const double RUB_SOLVED = 8.0 * DBL_EPSILON;
static const double RUB_FACE_ROUNDING = 1e-12;

struct RubRoom {
    size_t count;
    int jammed;
    double scale;          // N, of what acts on the bodies
    ArticulatedPush *kept; // by body: the loads without friction
    double *friction;      // by bristle, like the next three
    double *tried;         //
    RubPress *pressed;     //
    RubPress *before;      //
    Vec2 *change;          // D, row by row
    double *matrix;        // likewise
    double *side;          //
    double *weight;        // two numbers each
    double *mobility;      // by coordinate and by row of a loop
};

void rub_list(const Scenario *scenario, Dynamics *dynamics)
{
    System *system = &dynamics->system;
    const Linkage *linkage = &scenario->linkage;
    system->bristle_count = 0;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_friction_is(joint)) {
            system->bristles[system->bristle_count++] = (Bristle){
                .joint = i,
                .contact = -1,
                .pair = joint_friction_pair(&scenario->contact, joint),
                .steady = joint->friction.steady,
                .arm = joint_friction_arm(joint),
                .length = joint->friction.length,
                .face = joint_slides(joint->kind) && joint->contact.has_friction ? 0 : -1,
            };
        }
    }
    dynamics->rub_count = system->bristle_count;
    for (size_t i = 0; i < system->contact_count; i++) {
        const Joint *joint = &linkage->joints[system->contacts[i].joint];
        dynamics->bristle_of[i] = -1;
        if (!joint_is_ideal(joint->kind) && joint->friction.law != BRISTLE_REGULARIZED &&
            system->contacts[i].law.friction > 0.0 &&
            !dynamics_contact_is_turn(&dynamics->sites[i])) {
            system->bristles[system->bristle_count] =
                (Bristle){.joint = system->contacts[i].joint,
                          .contact = (int)i,
                          .pair = system->contacts[i].law.bristle,
                          .face = -1};
            dynamics->bristle_of[i] = (int)system->bristle_count++;
        }
    }
}

BristlePair dynamics_contact_bristle(const Dynamics *dynamics, size_t number, double normal)
{
    const Bristle *bristle = &dynamics->system.bristles[dynamics->bristle_of[number]];
    return bristle_pressed(&bristle->pair, dynamics->system.contacts[number].law.friction * normal);
}

RubRoom *rub_create(const Dynamics *dynamics)
{
    const size_t n = dynamics->rub_count;
    const size_t bodies = dynamics->tree.linkage->body_count;
    RubRoom *room = zeroed(1, sizeof *room);
    room->count = n;
    room->jammed = -1;
    room->kept = zeroed(bodies, sizeof *room->kept);
    room->friction = zeroed(5 * n + n * n, sizeof *room->friction);
    room->tried = room->friction + n;
    room->side = room->friction + 2 * n;
    room->weight = room->friction + 3 * n;
    room->matrix = room->friction + 5 * n;
    room->pressed = zeroed(2 * n, sizeof *room->pressed);
    room->before = room->pressed + n;
    room->change = zeroed(n * n, sizeof *room->change);
    room->mobility = zeroed(dynamics->tree.coordinate_count + 2 * dynamics->tree.loop_count,
                            sizeof *room->mobility);
    return room;
}

void rub_destroy(RubRoom *room)
{
    if (room != NULL) {
        free(room->kept);
        free(room->friction);
        free(room->pressed);
        free(room->change);
        free(room->mobility);
        free(room);
    }
}

int rub_jammed(const Dynamics *dynamics)
{
    return dynamics->rub->jammed;
}

// The direction in which body b of a guide goes along the line of body a.
static Vec2 rub_along(const Tree *tree, const TreeState *state, int joint)
{
    const Vec2 normal = tree_normal(tree, state, joint);
    return (Vec2){normal.y, -normal.x};
}

static double turning_of(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->motions[body].omega;
}

// How fast it slides: body b against body a.
static double rub_speed(const Tree *tree, const TreeState *state, int joint)
{
    if (tree->measures[joint] == TREE_LINE) {
        return vec2_dot(rub_along(tree, state, joint), tree_pair_velocity(tree, state, joint));
    }
    return turning_of(state, tree->end_bodies[2 * joint + 1]) -
           turning_of(state, tree->end_bodies[2 * joint]);
}

// Adds a friction against a sliding forth.
static void rub_load(const Tree *tree, const TreeState *state, int joint, double friction,
                     Loads *loads)
{
    if (tree->measures[joint] == TREE_LINE) {
        const Vec2 force = vec2_scale(-friction, rub_along(tree, state, joint));
        // at the anchor on body b, on both
        dynamics_load_end(tree, state, 2 * joint + 1, (Vec2){0.0, 0.0}, force, loads);
        dynamics_load_end(tree, state, 2 * joint, tree_pair_gap(tree, state, joint),
                          vec2_scale(-1.0, force), loads);
        return;
    }
    dynamics_load_couple(tree, state, tree->end_bodies[2 * joint + 1], -friction, loads);
    dynamics_load_couple(tree, state, tree->end_bodies[2 * joint], friction, loads);
}

// What one of the faces of a guide has.
static double face_value(Vec2 pressed, int face)
{
    const double of = face < 2 ? pressed.x : pressed.y;
    return face % 2 == 0 ? of : -of;
}

static double press_of(const Bristle *bristle, Vec2 pressed)
{
    return bristle->face < 0 ? vec2_length(pressed) : face_value(pressed, bristle->face);
}

// What presses in a joint, from the reactions of a state.
static RubPress rub_press(const Dynamics *dynamics, const DynamicsState *state,
                          const Bristle *bristle)
{
    RubPress press = {.of = state->reactions[bristle->joint]};
    if (bristle->face >= 0) {
        const Vec2 normal = tree_normal(&dynamics->tree, &state->tree, bristle->joint);
        const double moment =
            bristle->length > 0.0 ? 2.0 * state->couples[bristle->joint] / bristle->length : 0.0;
        press.of = (Vec2){vec2_dot(normal, press.of), moment};
    }
    press.most = press_of(bristle, press.of);
    return press;
}

// Puts the loads back to those without friction, and adds one.
static void put_loads(const Dynamics *dynamics, const Loads *bare, const double *friction,
                      const DynamicsState *state, Loads *loads)
{
    const System *system = &dynamics->system;
    ArticulatedPush *pushes = loads->pushes;
    memcpy(pushes, dynamics->rub->kept,
           dynamics->tree.linkage->body_count * sizeof *dynamics->rub->kept);
    *loads = *bare;
    loads->pushes = pushes;
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        rub_load(&dynamics->tree, &state->tree, system->bristles[i].joint, friction[i], loads);
    }
}

// Solves with given frictions, and finds what presses then.
static bool try_friction(const Dynamics *dynamics, const Loads *bare, const double *friction,
                         DynamicsState *state, Loads *loads, RubPress *pressed)
{
    const System *system = &dynamics->system;
    put_loads(dynamics, bare, friction, state, loads);
    if (!dynamics_react(dynamics, true, state, loads)) {
        return false;
    }
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        pressed[i] = rub_press(dynamics, state, &system->bristles[i]);
    }
    return true;
}

// N, of all that acts on the bodies.
static double rub_scale(const Dynamics *dynamics, const DynamicsState *state)
{
    const Linkage *linkage = dynamics->tree.linkage;
    double scale = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        scale += linkage->bodies[i].mass * vec2_length(state->tree.motions[i].acceleration) +
                 vec2_length(dynamics->weights[i]);
    }
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        scale += vec2_length(dynamics->rub->before[i].of);
    }
    return scale > 0.0 ? scale : 1.0;
}

// Fills in how each friction changes what presses.
static bool find_changes(const Dynamics *dynamics, const Loads *bare, DynamicsState *state,
                         Loads *loads)
{
    const System *system = &dynamics->system;
    RubRoom *room = dynamics->rub;
    const size_t n = room->count;
    for (size_t j = 0; j < n; j++) {
        const double arm = system->bristles[j].arm;
        if (!(arm > 0.0)) {
            continue;
        }
        const double steady = room->tried[j];
        const double unit = arm * room->scale;
        room->tried[j] += unit;
        if (!try_friction(dynamics, bare, room->tried, state, loads, room->pressed)) {
            return false;
        }
        room->tried[j] = steady;
        for (size_t i = 0; i < n; i++) {
            room->change[i * n + j] =
                vec2_scale(1.0 / unit, vec2_sub(room->pressed[i].of, room->before[i].of));
        }
    }
    return true;
}

// Whether the frictions have one answer: by a bound of the eigenvalue.
static bool has_answer(const Dynamics *dynamics)
{
    const System *system = &dynamics->system;
    RubRoom *room = dynamics->rub;
    const size_t n = room->count;
    for (size_t i = 0; i < n; i++) {
        const Bristle *bristle = &system->bristles[i];
        for (size_t j = 0; j < n; j++) {
            const Vec2 change = room->change[i * n + j];
            room->matrix[i * n + j] =
                bristle->arm * bristle->pair.ratio *
                (bristle->face < 0 ? vec2_length(change) : fmax(fabs(change.x), fabs(change.y)));
        }
    }
    const int failed = friction_answer_fails(n, room->matrix, room->weight);
    room->jammed = failed < 0 ? -1 : system->bristles[failed].joint;
    return failed < 0;
}

// Newton's method for the frictions, with what presses linear in them from a solution on. The
// shares are those of the state's rubs.
static bool solve_linear(const Dynamics *dynamics, const DynamicsState *state,
                         const RubPress *pressed, double *friction)
{
    const System *system = &dynamics->system;
    RubRoom *room = dynamics->rub;
    const size_t n = room->count;
    for (int iteration = 0; iteration < RUB_ITERATIONS; iteration++) {
        double moved = 0.0;
        double size = 0.0;
        for (size_t i = 0; i < n; i++) {
            const Bristle *bristle = &system->bristles[i];
            Vec2 of = pressed[i].of;
            for (size_t j = 0; j < n; j++) {
                of =
                    vec2_add(of, vec2_scale(friction[j] - room->tried[j], room->change[i * n + j]));
            }
            const double held = state->rubs[i].share * bristle->arm;
            const double press = press_of(bristle, of);
            const Vec2 way = press > 0.0 ? vec2_scale(1.0 / press, of) : (Vec2){0.0, 0.0};
            for (size_t j = 0; j < n; j++) {
                const Vec2 change = room->change[i * n + j];
                const double slope =
                    bristle->face < 0 ? vec2_dot(way, change) : face_value(change, bristle->face);
                room->matrix[i * n + j] = (i == j ? 1.0 : 0.0) - held * slope;
            }
            room->side[i] = bristle->arm > 0.0 ? held * press - friction[i] : 0.0;
        }
        if (!dense_solve(n, room->matrix, room->side)) {
            return false;
        }
        for (size_t i = 0; i < n; i++) {
            friction[i] += room->side[i];
            moved += fabs(room->side[i]);
            size += fabs(friction[i]);
        }
        if (!(moved > RUB_SOLVED * size)) {
            return true;
        }
    }
    return true; // as near as rounding lets it come
}

// How the frictions are short of what presses, over what acts: 1.
static double shortfall(const Dynamics *dynamics, const DynamicsState *state)
{
    const System *system = &dynamics->system;
    const RubRoom *room = dynamics->rub;
    double most = 0.0;
    for (size_t i = 0; i < room->count; i++) {
        const Bristle *bristle = &system->bristles[i];
        if (bristle->arm > 0.0) {
            const double held = state->rubs[i].share * bristle->arm * room->pressed[i].most;
            most = fmax(most, fabs(held - room->friction[i]) / (bristle->arm * room->scale));
        }
    }
    return most;
}

// What holds in each joint, with the friction that no reaction changes. Returns whether there is
// other friction.
static bool find_shares(const Dynamics *dynamics, const double *y, DynamicsState *state)
{
    const System *system = &dynamics->system;
    bool has_other = false;
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        const Bristle *bristle = &system->bristles[i];
        RubState *rub = &state->rubs[i];
        rub->speed = rub_speed(&dynamics->tree, &state->tree, bristle->joint);
        const BristleHold hold = bristle_hold(&bristle->pair, bristle->mode,
                                              y[system_bristle_index(system, i)], rub->speed);
        rub->share = hold.share;
        rub->bending = hold.bending;
        dynamics->rub->tried[i] = bristle->steady * hold.share;
        has_other = has_other || bristle->arm > 0.0;
    }
    return has_other;
}

bool rub_solve(const Dynamics *dynamics, const double *y, bool are_closed, DynamicsState *state,
               Loads *loads)
{
    const System *system = &dynamics->system;
    RubRoom *room = dynamics->rub;
    const size_t n = dynamics->rub_count;
    const Loads bare = *loads;
    room->jammed = -1;
    memcpy(room->kept, loads->pushes, dynamics->tree.linkage->body_count * sizeof *room->kept);
    const bool has_other = find_shares(dynamics, y, state);
    memcpy(room->friction, room->tried, n * sizeof *room->friction);
    if (has_other) {
        put_loads(dynamics, &bare, room->tried, state, loads);
        if (!dynamics_react(dynamics, are_closed, state, loads)) {
            return false;
        }
        for (size_t i = 0; i < n; i++) {
            room->before[i] = rub_press(dynamics, state, &system->bristles[i]);
        }
        room->scale = rub_scale(dynamics, state);
        if (!find_changes(dynamics, &bare, state, loads) || !has_answer(dynamics)) {
            return false;
        }
        memcpy(room->pressed, room->before, n * sizeof *room->pressed);
        for (int i = 0; i < RUB_SOLVES; i++) {
            if (!solve_linear(dynamics, state, room->pressed, room->friction) ||
                !try_friction(dynamics, &bare, room->friction, state, loads, room->pressed)) {
                return false;
            }
            if (shortfall(dynamics, state) <= RUB_SOLVED) {
                break;
            }
            memcpy(room->tried, room->friction, n * sizeof *room->tried);
        }
    }
    put_loads(dynamics, &bare, room->friction, state, loads);
    for (size_t i = 0; i < n; i++) {
        state->rubs[i].friction = room->friction[i];
        state->rubs[i].press = room->pressed[i].of;
        state->rubs[i].pressing = system->bristles[i].arm > 0.0
                                      ? system->bristles[i].arm * room->pressed[i].most
                                      : system->bristles[i].steady;
    }
    return has_other || dynamics_solve(dynamics, are_closed, state, loads);
}

// The same of a contact.
static BristleAt contact_at(const Dynamics *dynamics, size_t number, double since_s,
                            const double *y)
{
    const Tree *tree = &dynamics->tree;
    const size_t contact = (size_t)dynamics->system.bristles[number].contact;
    const ContactForce force = dynamics_contact(dynamics, contact, since_s, y);
    const TreeState *state = &dynamics->room.state->tree;
    const int end = 2 * dynamics->sites[contact].pair;
    return (BristleAt){
        .bend = y[system_bristle_index(&dynamics->system, number)],
        .speed = force.sliding,
        .rounding = 4.0 * DBL_EPSILON *
                    (vec2_length(tree_end_velocity(tree, state, end)) +
                     vec2_length(tree_end_velocity(tree, state, end + 1))),
        .damping = dynamics_contact_bristle(dynamics, contact, force.press.normal).damping,
        .is_idle = dynamics->system.contacts[contact].mode != CONTACT_PRESSING,
    };
}

BristleAt rub_bristle(const Dynamics *dynamics, size_t number, double since_s, const double *y)
{
    const Tree *tree = &dynamics->tree;
    const System *system = &dynamics->system;
    const int joint = system->bristles[number].joint;
    if (system->bristles[number].contact >= 0) {
        return contact_at(dynamics, number, since_s, y);
    }
    TreeState *state = &dynamics->room.state->tree;
    tree_evaluate_pair(tree, joint, since_s, y, y + tree->coordinate_count, state);
    double size = 0.0;
    for (int side = 0; side < 2; side++) {
        size += tree->measures[joint] == TREE_LINE
                    ? vec2_length(tree_end_velocity(tree, state, 2 * joint + side))
                    : fabs(turning_of(state, tree->end_bodies[2 * joint + side]));
    }
    return (BristleAt){
        .bend = y[system_bristle_index(system, number)],
        .speed = rub_speed(tree, state, joint),
        .rounding = 4.0 * DBL_EPSILON * size,
        .damping = system->bristles[number].pair.damping,
    };
}

BristleFace rub_face(const Dynamics *dynamics, size_t number, double since_s, const double *y)
{
    const Bristle *bristle = &dynamics->system.bristles[number];
    DynamicsState *state = dynamics->room.state;
    BristleFace face = {.margin = NAN, .next = bristle->face};
    if (!dynamics_evaluate(dynamics, since_s, y, state, NULL)) {
        return face;
    }
    const Vec2 press = state->rubs[number].press;
    double most = -INFINITY;
    for (int i = 0; i < RUB_FACES; i++) {
        const double value = face_value(press, i);
        if (i != bristle->face && value > most) {
            most = value;
            face.next = i;
        }
    }
    face.margin = face_value(press, bristle->face) - most;
    face.rounding = RUB_FACE_ROUNDING * dynamics->rub->scale;
    return face;
}

// How the sliding of a joint accelerates under its own friction, 1/kg or 1/(kg m^2); 0 where what
// drives the mechanism determines it.
static double mobility_of(const Dynamics *dynamics, int joint, const TreeState *state)
{
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    double *rates = dynamics->rub->mobility;
    Loads loads = {.pushes = dynamics->rub->kept};
    memset(loads.pushes, 0, tree->linkage->body_count * sizeof *loads.pushes);
    rub_load(tree, state, joint, -1.0, &loads);
    if (!articulated_factor(dynamics->articulated, state)) {
        return 0.0;
    }
    articulated_solve(dynamics->articulated, loads.pushes, NULL, rates);
    const bool slides = tree->measures[joint] == TREE_LINE;
    double moved = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = tree->end_bodies[2 * joint + side];
        if (body != LINKAGE_GROUND && tree_drive_of(tree, body) < 0) {
            const int column = tree->angle_column[body];
            moved += slides || column < 0 ? 0.0 : (side == 0 ? -1.0 : 1.0) * rates[column];
        }
    }
    if (slides) {
        Vec2 *row = dynamics->room.row;
        const Vec2 along = rub_along(tree, state, joint);
        memset(row, 0, n * sizeof *row);
        loops_pair_row(tree, state, joint, row);
        for (size_t i = 0; i < n; i++) {
            moved += vec2_dot(along, row[i]) * rates[i];
        }
    }
    const double own = joint_friction_mobility(tree->linkage, &tree->linkage->joints[joint]);
    return moved > BRISTLE_MOBILITY * own ? moved : 0.0;
}

void rub_stick(Dynamics *dynamics, size_t number, const double *y)
{
    Bristle *bristle = &dynamics->system.bristles[number];
    DynamicsState *state = dynamics->room.state;
    bristle->pair.damping = 0.0;
    if (bristle->contact >= 0 || bristle->pair.law == BRISTLE_REGULARIZED ||
        !dynamics_evaluate(dynamics, 0.0, y, state, NULL)) {
        return;
    }
    const double mobility = mobility_of(dynamics, bristle->joint, &state->tree);
    if (mobility > 0.0) {
        bristle->pair.damping = bristle_damping(&bristle->pair, bristle->pair.zeta,
                                                state->rubs[number].pressing, 1.0 / mobility);
    }
}

// Of joints that stand and stick: each in turn is bent by what its acceleration asks for, until
// none is. What friction cannot hold is left at its end.

enum { HOLD_SWEEPS = 1000 }; // of joints that hardly hold each other: what is left starts a swing

static const double HOLD_SETTLED = 1e-14; // of the presliding

// of the speed that uses friction up in the bristle's damper: what slides no faster stands
static const double HOLD_SPEED = 0.01;

static double rub_acceleration(const Tree *tree, const TreeState *state, int joint)
{
    const int *bodies = tree->end_bodies + 2 * joint;
    if (tree->measures[joint] != TREE_LINE) {
        return tree_alpha(state, bodies[1]) - tree_alpha(state, bodies[0]);
    }
    const double omega = turning_of(state, bodies[0]);
    const Vec2 carried = vec2_scale(omega * omega, tree_pair_gap(tree, state, joint));
    return vec2_dot(rub_along(tree, state, joint),
                    vec2_add(tree_pair_acceleration(tree, state, joint), carried));
}

// Bends one. Returns by how much, over its presliding.
static double hold_one(Dynamics *dynamics, size_t number, const bool *is_bent, double *y)
{
    const System *system = &dynamics->system;
    const Bristle *bristle = &system->bristles[number];
    DynamicsState *state = dynamics->room.state;
    const BristleAt at = rub_bristle(dynamics, number, 0.0, y);
    if (bristle->pair.law != BRISTLE_STICK || is_bent[number] ||
        fabs(at.speed) * at.damping > HOLD_SPEED ||
        !dynamics_evaluate(dynamics, 0.0, y, state, NULL)) {
        return 0.0;
    }
    const RubState *rub = &state->rubs[number];
    const double mobility = mobility_of(dynamics, bristle->joint, &state->tree);
    if (!(mobility > 0.0 && rub->pressing > 0.0)) {
        return 0.0;
    }
    const double needed =
        rub->friction + rub_acceleration(&dynamics->tree, &state->tree, bristle->joint) / mobility;
    const double share = needed / (bristle->pair.ratio * rub->pressing);
    double *bend = &y[system_bristle_index(system, number)];
    const double before = *bend;
    *bend = bristle->pair.limit * fmax(-1.0, fmin(share, 1.0));
    return fabs(*bend - before) / bristle->pair.limit;
}

void rub_hold(Dynamics *dynamics, double *y)
{
    double most = 1.0;
    bool *is_bent = zeroed(dynamics->rub_count, sizeof *is_bent); // by another run
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        is_bent[i] = y[system_bristle_index(&dynamics->system, i)] != 0.0;
    }
    for (int sweep = 0; sweep < HOLD_SWEEPS && most > HOLD_SETTLED; sweep++) {
        most = 0.0;
        for (size_t i = 0; i < dynamics->rub_count; i++) {
            most = fmax(most, hold_one(dynamics, i, is_bent, y));
        }
    }
    free(is_bent);
}
