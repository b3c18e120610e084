// How does a mechanism in space move, in position, quaternion and angular velocity of every body?
//
// With q the turn of a body, w its angular velocity in the world, R(q) and I its inertia there:
//     x' = v,   q' = (0, w) q / 2,   m v' = F,   I w' + w x I w = M
// With W = diag(1/m, I^-1) of the bodies that nothing drives, rows J of the ideal joints and their
// bias g (J a + g = 0):
//     (J W J') l = -(J a0 + g),   a = a0 + W J' l,
// a0 the accelerations by gravity, turning and contacts, and of the driven body those of its path.
// Rows of a hinge, d from its point on body a to that on body b, e and f across its axis on body a,
// u its axis on body b:
//     d = 0,   e . u = 0,   f . u = 0
// Gap, direction and point of a pin's contact are those of contact/pin_space.h, of a limited angle
// those of contact/stop_space.h; their equations are written here again, in long double.
#include "maximal.h"

#include "base/zeroed.h"
#include "contact/pin_space.h"
#include "contact/stop_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CLOSINGS = 4,
    SPACE_ROW_MOST = 5, // of a joint
    PLACED = 7,         // numbers of a body's position and quaternion
    MOVED = 6,          // of its velocity and angular velocity
};

typedef struct Real3 {
    Real x;
    Real y;
    Real z;
} Real3;

typedef struct Turn {
    Real w;
    Real x;
    Real y;
    Real z;
} Turn;

typedef struct Matrix {
    Real3 row[3];
} Matrix;

// A body as it stands and moves; of the ground at rest in the world's frame.
typedef struct Stand {
    Real3 position;
    Matrix turn;
    Real3 velocity;
    Real3 omega;
    Matrix inverse; // of the inertia in the world; zero of what is driven, like the next
    Real light;     // 1/kg
} Stand;

// What a body or a row has of linear and of angular numbers.
typedef struct Wrench {
    Real3 linear;
    Real3 angular;
} Wrench;

typedef struct SpaceLine {
    int body[2];
    Wrench of[2];
    Real value; // how far it is open, m or 1
    Real bias;
} SpaceLine;

typedef struct Space {
    Maximal shared;
    const Linkage *linkage;
    size_t pin_count; // contacts: the pins' first, then the stops'
    PinSpace *pins;
    StopSpace *stops;
    int driven;
    Vec3 gravity;
    double *masses;
    Matrix *inertias; // in the bodies' frames
    Matrix *inverses;
} Space;

static const Space *space_of(const Maximal *maximal)
{
    return (const Space *)maximal;
}

static Real3 real3(Vec3 a)
{
    return (Real3){a.x, a.y, a.z};
}

static Real3 real3_add(Real3 a, Real3 b)
{
    return (Real3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static Real3 real3_sub(Real3 a, Real3 b)
{
    return (Real3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static Real3 real3_times(Real factor, Real3 a)
{
    return (Real3){factor * a.x, factor * a.y, factor * a.z};
}

static Real real3_dot(Real3 a, Real3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static Real3 real3_cross(Real3 a, Real3 b)
{
    return (Real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static Real real3_length(Real3 a)
{
    return sqrtl(real3_dot(a, a));
}

static Real3 real3_unit(Real3 a)
{
    return real3_times(1.0L / real3_length(a), a);
}

static Real3 real3_normal_to(Real3 unit)
{
    const Real3 axis =
        fabsl(unit.x) < 0.75L ? (Real3){1.0L, 0.0L, 0.0L} : (Real3){0.0L, 1.0L, 0.0L};
    return real3_unit(real3_sub(axis, real3_times(real3_dot(axis, unit), unit)));
}

static Real3 matrix_times(const Matrix *m, Real3 a)
{
    return (Real3){real3_dot(m->row[0], a), real3_dot(m->row[1], a), real3_dot(m->row[2], a)};
}

static Real3 matrix_back(const Matrix *m, Real3 a)
{
    return real3_add(real3_times(a.x, m->row[0]),
                     real3_add(real3_times(a.y, m->row[1]), real3_times(a.z, m->row[2])));
}

static Matrix matrix_inverse(const Matrix *m)
{
    const Real3 *r = m->row;
    const Real3 a = real3_cross(r[1], r[2]);
    const Real3 b = real3_cross(r[2], r[0]);
    const Real3 c = real3_cross(r[0], r[1]);
    const Real scale = 1.0L / real3_dot(r[0], a);
    return (Matrix){{{scale * a.x, scale * b.x, scale * c.x},
                     {scale * a.y, scale * b.y, scale * c.y},
                     {scale * a.z, scale * b.z, scale * c.z}}};
}

// R A R' of a symmetric A.
static Matrix matrix_turned(const Matrix *turn, const Matrix *own)
{
    Matrix world;
    for (int i = 0; i < 3; i++) {
        world.row[i] = matrix_times(turn, matrix_times(own, turn->row[i]));
    }
    return world;
}

static Turn turn_product(Turn a, Turn b)
{
    return (Turn){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

static Turn turn_about(Real3 unit, Real angle)
{
    const Real s = sinl(0.5L * angle);
    return (Turn){cosl(0.5L * angle), s * unit.x, s * unit.y, s * unit.z};
}

static Matrix turn_matrix(Turn q)
{
    return (Matrix){{
        {1.0L - 2.0L * (q.y * q.y + q.z * q.z), 2.0L * (q.x * q.y - q.w * q.z),
         2.0L * (q.x * q.z + q.w * q.y)},
        {2.0L * (q.x * q.y + q.w * q.z), 1.0L - 2.0L * (q.x * q.x + q.z * q.z),
         2.0L * (q.y * q.z - q.w * q.x)},
        {2.0L * (q.x * q.z - q.w * q.y), 2.0L * (q.y * q.z + q.w * q.x),
         1.0L - 2.0L * (q.x * q.x + q.y * q.y)},
    }};
}

// A state: position and quaternion of each body, then velocity and angular velocity of each, then
// the angle of each stop.
static Real3 position_in(const Real *y, int body)
{
    const Real *at = y + PLACED * body;
    return (Real3){at[0], at[1], at[2]};
}

static Turn turn_in(const Real *y, int body)
{
    const Real *at = y + PLACED * body + 3;
    return (Turn){at[0], at[1], at[2], at[3]};
}

static void put_placed(Real *y, int body, Real3 position, Turn turn)
{
    const Real size = sqrtl(turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    Real *at = y + PLACED * body;
    at[0] = position.x;
    at[1] = position.y;
    at[2] = position.z;
    at[3] = turn.w / size;
    at[4] = turn.x / size;
    at[5] = turn.y / size;
    at[6] = turn.z / size;
}

static Wrench wrench_in(const Real *speeds, int body)
{
    const Real *at = speeds + MOVED * body;
    return (Wrench){{at[0], at[1], at[2]}, {at[3], at[4], at[5]}};
}

static void put_wrench(Real *speeds, int body, Wrench wrench)
{
    Real *at = speeds + MOVED * body;
    at[0] = wrench.linear.x;
    at[1] = wrench.linear.y;
    at[2] = wrench.linear.z;
    at[3] = wrench.angular.x;
    at[4] = wrench.angular.y;
    at[5] = wrench.angular.z;
}

static size_t speeds_at(const Space *space)
{
    return PLACED * space->linkage->body_count;
}

static size_t angles_at(const Space *space)
{
    return (PLACED + MOVED) * space->linkage->body_count;
}

static Stand stand_of(const Space *space, const Real *y, int body)
{
    static const Stand GROUND = {
        .turn = {{{1.0L, 0.0L, 0.0L}, {0.0L, 1.0L, 0.0L}, {0.0L, 0.0L, 1.0L}}}};
    if (body == LINKAGE_GROUND) {
        return GROUND;
    }
    const Wrench moving = wrench_in(y + speeds_at(space), body);
    Stand stand = {
        .position = position_in(y, body),
        .turn = turn_matrix(turn_in(y, body)),
        .velocity = moving.linear,
        .omega = moving.angular,
    };
    if (body != space->driven) {
        stand.inverse = matrix_turned(&stand.turn, &space->inverses[body]);
        stand.light = 1.0L / space->masses[body];
    }
    return stand;
}

// All of them, the ground first, for free().
static Stand *stands_of(const Space *space, const Real *y)
{
    const int count = (int)space->linkage->body_count;
    Stand *stands = zeroed((size_t)count + 1, sizeof *stands);
    for (int i = -1; i < count; i++) {
        stands[i + 1] = stand_of(space, y, i);
    }
    return stands;
}

static Real3 point_velocity(const Stand *stand, Real3 arm)
{
    return real3_add(stand->velocity, real3_cross(stand->omega, arm));
}

static void rows_of(const Space *space, const Stand *stands, size_t number,
                    SpaceLine rows[SPACE_ROW_MOST])
{
    static const Real3 WORLD[3] = {{1.0L, 0.0L, 0.0L}, {0.0L, 1.0L, 0.0L}, {0.0L, 0.0L, 1.0L}};
    const Joint *joint = &space->linkage->joints[number];
    const SpaceEnd ends[2] = {space_end(space->linkage, number, 0),
                              space_end(space->linkage, number, 1)};
    const Stand *on[2] = {&stands[joint->body_a + 1], &stands[joint->body_b + 1]};
    Real3 arms[2];
    Real3 axes[2];
    Real3 pulls[2];
    for (int side = 0; side < 2; side++) {
        const Real3 omega = on[side]->omega;
        arms[side] = matrix_times(&on[side]->turn, real3(ends[side].anchor));
        axes[side] = matrix_times(&on[side]->turn, real3_unit(real3(ends[side].axis)));
        pulls[side] = real3_cross(omega, real3_cross(omega, arms[side]));
    }
    const Vec2 start = joint->kind == JOINT_CLEARANCE ? joint->clearance.start : (Vec2){0.0, 0.0};
    const Real3 open = real3_sub(
        real3_sub(real3_add(on[1]->position, arms[1]), real3_add(on[0]->position, arms[0])),
        (Real3){start.x, start.y, 0.0L});
    const Real3 bias = real3_sub(pulls[1], pulls[0]);
    const Real3 relative = real3_sub(on[1]->omega, on[0]->omega);
    Real3 across[2] = {real3_normal_to(axes[0])};
    across[1] = real3_cross(axes[0], across[0]);
    for (int i = 0; i < SPACE_ROW_MOST; i++) {
        SpaceLine *row = &rows[i];
        *row = (SpaceLine){.body = {joint->body_a, joint->body_b}};
        if (i < 3) {
            for (int side = 0; side < 2; side++) {
                const Real sign = side == 0 ? -1.0L : 1.0L;
                row->of[side].linear = real3_times(sign, WORLD[i]);
                row->of[side].angular = real3_times(sign, real3_cross(arms[side], WORLD[i]));
            }
            row->value = real3_dot(open, WORLD[i]);
            row->bias = real3_dot(bias, WORLD[i]);
            continue;
        }
        const Real3 e = across[i - 3];
        const Real3 turning = real3_cross(axes[1], e);
        row->of[0].angular = real3_times(-1.0L, turning);
        row->of[1].angular = turning;
        row->value = real3_dot(e, axes[1]);
        row->bias =
            real3_dot(relative, real3_add(real3_cross(real3_cross(on[1]->omega, axes[1]), e),
                                          real3_cross(axes[1], real3_cross(on[0]->omega, e))));
    }
}

static bool is_held(const Space *space, const Joint *joint, bool with_play)
{
    const bool is_asked =
        joint->kind == JOINT_REVOLUTE || (with_play && joint->kind == JOINT_CLEARANCE);
    const bool is_fixed_a = joint->body_a == LINKAGE_GROUND || joint->body_a == space->driven;
    const bool is_fixed_b = joint->body_b == LINKAGE_GROUND || joint->body_b == space->driven;
    return is_asked && !(is_fixed_a && is_fixed_b);
}

// All rows that hold bodies that nothing drives, of ideal joints or also of those with play.
static size_t list_rows(const Space *space, const Stand *stands, bool with_play, SpaceLine *rows)
{
    size_t count = 0;
    for (size_t i = 0; i < space->linkage->joint_count; i++) {
        if (is_held(space, &space->linkage->joints[i], with_play)) {
            rows_of(space, stands, i, rows + count);
            count += SPACE_ROW_MOST;
        }
    }
    return count;
}

static Real wrench_dot(Wrench a, Wrench b)
{
    return real3_dot(a.linear, b.linear) + real3_dot(a.angular, b.angular);
}

static Wrench wrench_by(const Stand *stand, Wrench of)
{
    return (Wrench){real3_times(stand->light, of.linear),
                    matrix_times(&stand->inverse, of.angular)};
}

// J W J' of two rows, the second one with W.
static Real rows_share(const SpaceLine *a, const SpaceLine *b, const Wrench by[2])
{
    Real sum = 0.0L;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            if (a->body[i] == b->body[k] && a->body[i] != LINKAGE_GROUND) {
                sum += wrench_dot(a->of[i], by[k]);
            }
        }
    }
    return sum;
}

// Changes six numbers a body by W J' l so that the rows of them become -right.
static void meet_rows(const Stand *stands, size_t count, const SpaceLine *rows, Real *right,
                      Real *of)
{
    Real *matrix = zeroed(count * count, sizeof *matrix);
    for (size_t i = 0; i < count; i++) {
        const SpaceLine *row = &rows[i];
        const Wrench by[2] = {wrench_by(&stands[row->body[0] + 1], row->of[0]),
                              wrench_by(&stands[row->body[1] + 1], row->of[1])};
        right[i] = -right[i];
        for (int side = 0; side < 2; side++) {
            if (row->body[side] != LINKAGE_GROUND) {
                right[i] -= wrench_dot(row->of[side], wrench_in(of, row->body[side]));
            }
        }
        for (size_t k = 0; k <= i; k++) {
            matrix[k * count + i] = rows_share(&rows[k], row, by);
            matrix[i * count + k] = matrix[k * count + i];
        }
    }
    maximal_solve(count, matrix, right);
    for (size_t i = 0; i < count; i++) {
        for (int side = 0; side < 2; side++) {
            const int body = rows[i].body[side];
            if (body == LINKAGE_GROUND) {
                continue;
            }
            const Wrench by = wrench_by(&stands[body + 1], rows[i].of[side]);
            const Wrench was = wrench_in(of, body);
            put_wrench(of, body,
                       (Wrench){real3_add(was.linear, real3_times(right[i], by.linear)),
                                real3_add(was.angular, real3_times(right[i], by.angular))});
        }
    }
    free(matrix);
}

// Puts the driven body on its path.
static void put_driven(const Space *space, Real time_s, Real *y)
{
    static const Real3 Z = {0.0L, 0.0L, 1.0L};
    const Driver *driver = &space->linkage->driver;
    if (space->driven == LINKAGE_GROUND) {
        return;
    }
    const SpaceEnd ends[2] = {space_end(space->linkage, (size_t)driver->joint, 0),
                              space_end(space->linkage, (size_t)driver->joint, 1)};
    const Real3 axis = real3_unit(real3(ends[0].axis));
    const Turn turn =
        turn_product(turn_about(axis, driver->speed * time_s),
                     turn_about(Z, space->linkage->bodies[space->driven].start.angle));
    const Matrix matrix = turn_matrix(turn);
    const Real3 arm = real3_times(-1.0L, matrix_times(&matrix, real3(ends[1].anchor)));
    const Real3 omega = real3_times(driver->speed, axis);
    put_placed(y, space->driven, real3_add(real3(ends[0].anchor), arm), turn);
    put_wrench(y + speeds_at(space), space->driven, (Wrench){real3_cross(omega, arm), omega});
}

// How far the joint of a stop has turned, of all angles that differ by turns the nearest to one.
static Real stop_angle_near(const Space *space, const Real *y, const StopSpace *stop, Real near)
{
    const Linkage *linkage = space->linkage;
    const Joint *joint = &linkage->joints[stop->joint];
    const Real3 start[2] = {real3_unit(real3(joint->space.axis)),
                            real3_normal_to(real3_unit(real3(joint->space.axis)))};
    const int bodies[2] = {joint->body_a, joint->body_b};
    Real3 carried[2][2]; // by side: axis and side direction
    for (int side = 0; side < 2; side++) {
        const Stand stand = stand_of(space, y, bodies[side]);
        const Real angle =
            bodies[side] == LINKAGE_GROUND ? 0.0L : linkage->bodies[bodies[side]].start.angle;
        const Matrix first = turn_matrix(turn_about((Real3){0.0L, 0.0L, 1.0L}, angle));
        for (int k = 0; k < 2; k++) {
            carried[side][k] = matrix_times(&stand.turn, matrix_back(&first, start[k]));
        }
    }
    const Real sine = real3_dot(carried[0][0], real3_cross(carried[0][1], carried[1][1]));
    const Real turned = atan2l(sine, real3_dot(carried[0][1], carried[1][1]));
    const Real angle =
        space_coordinate_start(linkage, stop->joint) + coordinate_sense(joint) * turned;
    return near + remainderl(angle - near, 4.0L * acosl(0.0L));
}

static void settle_stops(const Space *space, Real *y)
{
    Real *angles = y + angles_at(space);
    for (size_t i = 0; i < space->shared.contact_count - space->pin_count; i++) {
        angles[i] = stop_angle_near(space, y, &space->stops[i], angles[i]);
    }
}

static void close_joints(const Space *space, bool with_play, SpaceLine *rows, Real *right, Real *y)
{
    const int bodies = (int)space->linkage->body_count;
    Stand *stands = stands_of(space, y);
    Real *change = zeroed(MOVED * (size_t)bodies, sizeof *change);
    const size_t count = list_rows(space, stands, with_play, rows);
    for (size_t i = 0; i < count; i++) {
        right[i] = rows[i].value;
    }
    meet_rows(stands, count, rows, right, change);
    for (int i = 0; i < bodies; i++) {
        const Wrench by = wrench_in(change, i);
        const Real angle = real3_length(by.angular);
        const Turn turn = turn_in(y, i);
        const Turn more = angle > 0.0L ? turn_about(real3_times(1.0L / angle, by.angular), angle)
                                       : (Turn){1.0L, 0.0L, 0.0L, 0.0L};
        put_placed(y, i, real3_add(position_in(y, i), by.linear), turn_product(more, turn));
    }
    free(change);
    free(stands);
}

static void project(const Maximal *maximal, Real time_s, Real *y)
{
    const Space *space = space_of(maximal);
    const Linkage *linkage = space->linkage;
    const bool is_start = time_s < 0.0L;
    const bool with_play = is_start && linkage->driver.is_present;
    SpaceLine *rows = zeroed(SPACE_ROW_MOST * linkage->joint_count, sizeof *rows);
    Real *right = zeroed(SPACE_ROW_MOST * linkage->joint_count, sizeof *right);
    put_driven(space, is_start ? 0.0L : time_s, y);
    for (int round = 0; round < (is_start ? 2 * CLOSINGS : 2); round++) {
        close_joints(space, with_play, rows, right, y);
    }
    Stand *stands = stands_of(space, y);
    const size_t count = list_rows(space, stands, false, rows);
    memset(right, 0, count * sizeof *right);
    meet_rows(stands, count, rows, right, y + speeds_at(space));
    settle_stops(space, y);
    free(stands);
    free(rows);
    free(right);
}

// A pin at one of its places.
typedef struct Pose {
    MaximalGap gap;
    Real3 outward; // from the hole's middle to its wall; 0 of a pin in the middle
    Real3 offset;
    Real3 at_a; // m, in the world
    Real3 at_b;
} Pose;

static Real3 real3_across(Real3 a, Real3 unit)
{
    return real3_sub(a, real3_times(real3_dot(a, unit), unit));
}

static Pose pose_of(const PinSpace *place, const Stand *a, const Stand *b)
{
    const bool is_collar = place->place == PIN_SPACE_COLLAR;
    const Real3 hole = real3_add(a->position, matrix_times(&a->turn, real3(place->hole.anchor)));
    const Real3 pin = real3_add(b->position, matrix_times(&b->turn, real3(place->pin.anchor)));
    const Real3 axis = is_collar ? matrix_times(&a->turn, real3_unit(real3(place->hole.axis)))
                                 : matrix_times(&b->turn, real3_unit(real3(place->pin.axis)));
    const Real3 apart = real3_sub(pin, hole);
    Pose pose = {.at_a = hole};
    if (is_collar) {
        pose.offset = real3_times(real3_dot(axis, apart), axis);
        pose.at_a = pin;
        pose.at_b = pin;
    } else {
        pose.offset = real3_across(apart, axis);
        pose.at_b = real3_add(hole, pose.offset);
    }
    const Real3 relative = real3_sub(point_velocity(b, real3_sub(pose.at_b, b->position)),
                                     point_velocity(a, real3_sub(pose.at_a, a->position)));
    const Real size = real3_length(pose.offset);
    pose.gap.depth = size - place->clearance;
    if (size > 0.0L) {
        pose.outward = real3_times(1.0L / size, pose.offset);
        pose.gap.closing = real3_dot(pose.outward, relative);
    } else {
        pose.gap.closing = is_collar ? fabsl(real3_dot(axis, relative))
                                     : real3_length(real3_across(relative, axis));
    }
    return pose;
}

static Real3 stop_axis(const Space *space, const StopSpace *stop, const Stand *a)
{
    const SpaceEnd end = space_end(space->linkage, (size_t)stop->joint, 0);
    const Real sense = coordinate_sense(&space->linkage->joints[stop->joint]);
    return real3_times(sense, matrix_times(&a->turn, real3_unit(real3(end.axis))));
}

static MaximalGap gap(const Maximal *maximal, size_t contact, const Real *y)
{
    const Space *space = space_of(maximal);
    if (contact < space->pin_count) {
        const PinSpace *place = &space->pins[contact];
        const Stand a = stand_of(space, y, place->hole.body);
        const Stand b = stand_of(space, y, place->pin.body);
        return pose_of(place, &a, &b).gap;
    }
    const size_t number = contact - space->pin_count;
    const StopSpace *stop = &space->stops[number];
    const Joint *joint = &space->linkage->joints[stop->joint];
    const Stand a = stand_of(space, y, joint->body_a);
    const Stand b = stand_of(space, y, joint->body_b);
    const Real rate = real3_dot(stop_axis(space, stop, &a), real3_sub(b.omega, a.omega));
    return (MaximalGap){-stop->sign * (y[angles_at(space) + number] - stop->limit),
                        -stop->sign * rate};
}

static void push(const Stand *stands, int body, Real3 at, Real3 force, Real3 moment,
                 Real *accelerations)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    const Stand *stand = &stands[body + 1];
    const Real3 arm = real3_sub(at, stand->position);
    const Wrench by = wrench_by(stand, (Wrench){force, real3_add(real3_cross(arm, force), moment)});
    const Wrench was = wrench_in(accelerations, body);
    put_wrench(accelerations, body,
               (Wrench){real3_add(was.linear, by.linear), real3_add(was.angular, by.angular)});
}

static void add_pin(const Space *space, size_t number, const Stand *stands, Real *accelerations)
{
    static const Real3 NONE = {0.0L, 0.0L, 0.0L};
    const ContactOptions *options = &space->shared.scenario->contact;
    const PinSpace *place = &space->pins[number];
    const Stand *a = &stands[place->hole.body + 1];
    const Stand *b = &stands[place->pin.body + 1];
    Pose pose = pose_of(place, a, b);
    const Real normal = maximal_press(&space->shared.contacts[number], pose.gap);
    Real3 force = real3_times(-normal, pose.outward);
    if (options->friction > 0.0 && place->place != PIN_SPACE_COLLAR) {
        // both bodies are rubbed at the wall
        const double radius = space->linkage->joints[place->joint].clearance.hole_radius;
        pose.at_a = real3_add(pose.at_a, real3_times(radius, pose.outward));
        pose.at_b = pose.at_a;
        const Real3 sliding =
            real3_across(real3_sub(point_velocity(b, real3_sub(pose.at_b, b->position)),
                                   point_velocity(a, real3_sub(pose.at_a, a->position))),
                         pose.outward);
        const Real speed = real3_length(sliding);
        const Real scale = options->friction_speed;
        const Real share = speed > 1e-12L * scale ? tanhl(speed / scale) / speed : 1.0L / scale;
        force = real3_sub(force, real3_times(options->friction * normal * share, sliding));
    }
    push(stands, place->pin.body, pose.at_b, force, NONE, accelerations);
    push(stands, place->hole.body, pose.at_a, real3_times(-1.0L, force), NONE, accelerations);
}

static void add_contacts(const Space *space, const Real *y, const Stand *stands,
                         Real *accelerations)
{
    static const Real3 NONE = {0.0L, 0.0L, 0.0L};
    for (size_t i = 0; i < space->shared.contact_count; i++) {
        const MaximalContact *contact = &space->shared.contacts[i];
        if (contact->mode != MAXIMAL_PRESSED) {
            continue;
        }
        if (i < space->pin_count) {
            add_pin(space, i, stands, accelerations);
            continue;
        }
        const StopSpace *stop = &space->stops[i - space->pin_count];
        const Joint *joint = &space->linkage->joints[stop->joint];
        const Stand *a = &stands[joint->body_a + 1];
        const Real torque = stop->sign * maximal_press(contact, gap(&space->shared, i, y));
        const Real3 moment = real3_times(torque, stop_axis(space, stop, a));
        push(stands, joint->body_b, NONE, NONE, moment, accelerations);
        push(stands, joint->body_a, NONE, NONE, real3_times(-1.0L, moment), accelerations);
    }
}

// The accelerations without joints and contacts.
static void begin_accelerations(const Space *space, const Stand *stands, Real *accelerations)
{
    for (int i = 0; i < (int)space->linkage->body_count; i++) {
        const Stand *stand = &stands[i + 1];
        Wrench by = {{space->gravity.x, space->gravity.y, space->gravity.z}, {0.0L, 0.0L, 0.0L}};
        if (i == space->driven) {
            by.linear = real3_cross(stand->omega, stand->velocity);
        } else {
            const Real3 own = matrix_back(&stand->turn, stand->omega);
            const Real3 spin = matrix_times(
                &stand->turn, real3_cross(own, matrix_times(&space->inertias[i], own)));
            by.angular = matrix_times(&stand->inverse, real3_times(-1.0L, spin));
        }
        put_wrench(accelerations, i, by);
    }
}

static void rates(const Maximal *maximal, double since_s, Real time_s, const Real *y, Real *out)
{
    const Space *space = space_of(maximal);
    const Linkage *linkage = space->linkage;
    Stand *stands = stands_of(space, y);
    Real *accelerations = out + speeds_at(space);
    (void)since_s;
    (void)time_s;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        const Stand *stand = &stands[i + 1];
        const Turn omega = {0.0L, stand->omega.x, stand->omega.y, stand->omega.z};
        const Turn turning = turn_product(omega, turn_in(y, i));
        Real *to = out + PLACED * i;
        to[0] = stand->velocity.x;
        to[1] = stand->velocity.y;
        to[2] = stand->velocity.z;
        to[3] = 0.5L * turning.w;
        to[4] = 0.5L * turning.x;
        to[5] = 0.5L * turning.y;
        to[6] = 0.5L * turning.z;
    }
    for (size_t i = space->pin_count; i < space->shared.contact_count; i++) {
        const StopSpace *stop = &space->stops[i - space->pin_count];
        out[angles_at(space) + i - space->pin_count] = -stop->sign * gap(maximal, i, y).closing;
    }
    begin_accelerations(space, stands, accelerations);
    add_contacts(space, y, stands, accelerations);
    SpaceLine *rows = zeroed(SPACE_ROW_MOST * linkage->joint_count, sizeof *rows);
    Real *right = zeroed(SPACE_ROW_MOST * linkage->joint_count, sizeof *right);
    const size_t count = list_rows(space, stands, false, rows);
    for (size_t i = 0; i < count; i++) {
        right[i] = rows[i].bias;
    }
    meet_rows(stands, count, rows, right, accelerations);
    free(rows);
    free(right);
    free(stands);
}

static Vec3 rounded(Real3 a)
{
    return (Vec3){(double)a.x, (double)a.y, (double)a.z};
}

static void sample(const Maximal *maximal, const Real *y, Trajectory *trajectory, size_t number)
{
    const Space *space = space_of(maximal);
    for (int i = 0; i < (int)space->linkage->body_count; i++) {
        const size_t at = number * trajectory->body_count + (size_t)i;
        const Turn turn = turn_in(y, i);
        const Wrench moving = wrench_in(y + speeds_at(space), i);
        const SpaceMotion motion = {
            .position = rounded(position_in(y, i)),
            .turn = {(double)turn.w, (double)turn.x, (double)turn.y, (double)turn.z},
            .velocity = rounded(moving.linear),
            .omega = rounded(moving.angular),
        };
        trajectory->space_motions[at] = motion;
        trajectory->motions[at] = space_planar(&motion);
    }
}

static Real fastest(const Maximal *maximal, const Real *y)
{
    const Space *space = space_of(maximal);
    const size_t from = speeds_at(space);
    Real largest = 0.0L;
    for (size_t i = 0; i < space->linkage->body_count; i++) {
        const Wrench moving = wrench_in(y + from, (int)i);
        const Real arm = maximal->arms[from + MOVED * i + 3];
        largest = fmaxl(largest, real3_length(moving.linear) + arm * real3_length(moving.angular));
    }
    return largest;
}

static void destroy(Maximal *maximal)
{
    Space *space = (Space *)maximal;
    maximal_finish(maximal);
    free(space->pins);
    free(space->stops);
    free(space->masses);
    free(space->inertias);
    free(space->inverses);
    free(space);
}

static const MaximalKind SPACE = {
    .rates = rates,
    .gap = gap,
    .project = project,
    .sample = sample,
    .fastest = fastest,
    .destroy = destroy,
};

static void set_body(Space *space, int number, double factor)
{
    static const Real3 Z = {0.0L, 0.0L, 1.0L};
    Maximal *shared = &space->shared;
    const Body *body = &space->linkage->bodies[number];
    const Mat3 own = space_inertia(body);
    const Real reach = linkage_reach(space->linkage, number);
    const size_t speeds = speeds_at(space);
    space->masses[number] = factor * body->mass;
    for (int i = 0; i < 3; i++) {
        space->inertias[number].row[i] = real3_times(factor, real3(own.row[i]));
    }
    space->inverses[number] = matrix_inverse(&space->inertias[number]);
    put_placed(shared->start, number,
               (Real3){body->start.position.x, body->start.position.y, body->space.height},
               turn_about(Z, body->start.angle));
    put_wrench(shared->start + speeds, number,
               (Wrench){{body->start.velocity.x, body->start.velocity.y, body->space.velocity_z},
                        {body->space.omega_x, body->space.omega_y, body->start.omega}});
    for (int k = 0; k < PLACED; k++) {
        // a quaternion changes by half of an angle
        shared->arms[PLACED * number + k] = (double)(k < 3 ? 1.0L : 2.0L * reach);
    }
    for (int k = 0; k < MOVED; k++) {
        shared->arms[speeds + MOVED * (size_t)number + (size_t)k] = (double)(k < 3 ? 1.0L : reach);
        shared->is_speed[speeds + MOVED * (size_t)number + (size_t)k] = true;
    }
}

static void set_bodies(Space *space, const MaximalFlaw *flaw)
{
    const size_t n = space->linkage->body_count;
    bool is_flawed = false;
    space->masses = zeroed(n, sizeof *space->masses);
    space->inertias = zeroed(n, sizeof *space->inertias);
    space->inverses = zeroed(n, sizeof *space->inverses);
    for (int i = 0; i < (int)n; i++) {
        const bool is_free = i != space->driven;
        set_body(space, i, !is_flawed && is_free ? flaw->mass : 1.0);
        is_flawed = is_flawed || is_free;
    }
}

static void set_contacts(Space *space)
{
    const Linkage *linkage = space->linkage;
    Maximal *shared = &space->shared;
    for (size_t i = 0; i < shared->contact_count; i++) {
        if (i < space->pin_count) {
            shared->contacts[i] =
                (MaximalContact){.law = space->pins[i].law, .flight = space->pins[i].clearance};
            continue;
        }
        const size_t number = i - space->pin_count;
        const StopSpace *stop = &space->stops[number];
        const Joint *joint = &linkage->joints[stop->joint];
        const double play = coordinate_play(joint);
        shared->contacts[i] =
            (MaximalContact){.law = stop->law, .flight = isfinite(play) ? play : 0.0};
        shared->start[angles_at(space) + number] = space_coordinate_start(linkage, stop->joint);
        shared->arms[angles_at(space) + number] =
            linkage_reach(linkage, joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b);
    }
}

Maximal *maximal_space_create(const Scenario *scenario, const MaximalFlaw *flaw, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    size_t pin_count = 0;
    size_t stop_count = 0;
    if (scenario->contact.model != CONTACT_IMPACT) {
        err_set(err, ERR_CASE, "the velocity-level model is not among these equations");
        return NULL;
    }
    PinSpace *pins = pin_space_list(scenario, &pin_count, err);
    StopSpace *stops = pins == NULL ? NULL : stop_space_list(scenario, &stop_count, err);
    if (stops == NULL) {
        free(pins);
        return NULL;
    }
    Space *space = zeroed(1, sizeof *space);
    space->linkage = linkage;
    space->pin_count = pin_count;
    space->pins = pins;
    space->stops = stops;
    space->driven = linkage_driven_body(linkage);
    space->gravity = vec3_scale(flaw->gravity, scenario->gravity);
    maximal_init(&space->shared, (PLACED + MOVED) * linkage->body_count + stop_count,
                 pin_count + stop_count);
    space->shared.kind = &SPACE;
    space->shared.scenario = scenario;
    set_bodies(space, flaw);
    set_contacts(space);
    // at the start pins stand where the case puts them
    project(&space->shared, -1.0L, space->shared.start);
    return &space->shared;
}
