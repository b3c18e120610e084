// Moves a pin in space in the rows of its place.
//
// With the pin's axis a, its middle M, the end's centre O, B = M - O and P = M - (B . a) a:
//     e = P - O = B - (B . a) a,      e' . n = (v_b(P) - v_a(O)) . n  for n across a
//     r = v_b(P) - v_a(O),            (B . a)' = a . (v_M - v_O) + e . a',   a' = omega_b x a
//     r' = acc_b(P) - acc_a(O) - (B . a)' a'
// with acc the accelerations of the bodies' points. A row along n, frozen where a is at right
// angles to it, has the rate n . (r - (r . a) a), which changes by n . r' - (r . a) n . a'.
// Along the hole's axis u, with C the hole's middle and B = M - C:
//     (u . B)'' = u . (acc_M - acc_C) + 2 u' . B' + u'' . B,   u' = omega_a x u
#include "contact/pin_space_rows.h"

#include "contact/pin_axis.h"

#include <string.h>

// the rows of an end with friction, in order
enum { ROW_TURN = 2, ROW_AXIAL = 4, ROW_SIDES = 5 };

size_t pin_space_row_count(const PinSpace *place)
{
    return place->law.friction > 0.0 && place->place != PIN_SPACE_COLLAR ? PIN_SPACE_ROWS
                                                                         : PIN_SPACE_PLAIN_ROWS;
}

static SpaceRow turn_row(int body, Vec3 direction)
{
    SpaceRow row = {.body = {body, LINKAGE_GROUND}};
    if (body != LINKAGE_GROUND) {
        row.angular[0] = direction;
    }
    return row;
}

// Writes the rows from the points and the directions.
static void write_rows(const PinSpace *place, const SpaceMotion *motions, PinSpaceRows *rows)
{
    const int a = place->hole.body;
    const int b = place->pin.body;
    const bool is_collar = place->place == PIN_SPACE_COLLAR;
    for (size_t i = 0; i < PIN_SPACE_PLAIN_ROWS; i++) {
        rows->rows[i] = space_row_along(motions, a, rows->at_a, b, rows->at_b, rows->across[i]);
    }
    if (is_collar) {
        rows->rows[1] = (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
    }
    if (rows->count == PIN_SPACE_ROWS) {
        rows->rows[ROW_TURN] = turn_row(a, rows->axis);
        rows->rows[ROW_TURN + 1] = turn_row(b, rows->axis);
        rows->rows[ROW_AXIAL] = space_row_along(motions, a, rows->at_a, b, rows->at_b, rows->axis);
        for (size_t i = 0; i < 2; i++) {
            rows->rows[ROW_SIDES + i] = turn_row(a, rows->across[i]);
            rows->rows[ROW_SIDES + 2 + i] = turn_row(b, rows->across[i]);
        }
    }
}

void pin_space_rows_move(const PinSpace *place, const SpaceMotion *motions, PinSpaceRows *rows)
{
    if (place->place == PIN_SPACE_COLLAR) {
        rows->at_a = rows->at_b = space_point(motions, place->pin.body, place->pin.anchor);
    } else {
        const PinSpacePose pose = pin_space_pose(place, motions);
        rows->at_a = pose.at_a;
        rows->at_b = pose.at_b;
    }
    write_rows(place, motions, rows);
}

void pin_space_rows_place(const PinSpace *place, const SpaceMotion *motions, PinSpaceRows *rows)
{
    rows->count = pin_space_row_count(place);
    if (place->place == PIN_SPACE_COLLAR) {
        rows->across[0] = space_direction(motions, place->hole.body, place->hole.axis);
        rows->across[1] = vec3_normal_to(rows->across[0]);
        rows->axis = vec3_cross(rows->across[0], rows->across[1]);
    } else {
        rows->axis = space_direction(motions, place->pin.body, place->pin.axis);
        pin_axis_across(rows->axis, rows->across);
    }
    pin_space_rows_move(place, motions, rows);
}

static Vec3 omega_of(const SpaceMotion *motions, int body)
{
    return body == LINKAGE_GROUND ? (Vec3){0.0, 0.0, 0.0} : motions[body].omega;
}

static Vec3 alpha_of(const SpaceMotion *motions, int body)
{
    return body == LINKAGE_GROUND ? (Vec3){0.0, 0.0, 0.0} : motions[body].alpha;
}

// Writes a rate of the turns' rows, from those of both bodies.
static void write_turns(const PinSpaceRows *rows, Vec3 hole, Vec3 pin, double *rates)
{
    rates[ROW_TURN] = vec3_dot(rows->axis, hole);
    rates[ROW_TURN + 1] = vec3_dot(rows->axis, pin);
    for (size_t i = 0; i < 2; i++) {
        rates[ROW_SIDES + i] = vec3_dot(rows->across[i], hole);
        rates[ROW_SIDES + 2 + i] = vec3_dot(rows->across[i], pin);
    }
}

static void collar_state(const PinSpace *place, const SpaceMotion *motions, double *position,
                         double *speed)
{
    const Vec3 pin = space_point(motions, place->pin.body, place->pin.anchor);
    const Vec3 hole = space_point(motions, place->hole.body, place->hole.anchor);
    const Vec3 axis = space_direction(motions, place->hole.body, place->hole.axis);
    const Vec3 relative = vec3_sub(space_velocity_at(motions, place->pin.body, pin),
                                   space_velocity_at(motions, place->hole.body, pin));
    position[0] = vec3_dot(axis, vec3_sub(pin, hole));
    speed[0] = vec3_dot(axis, relative);
    position[1] = speed[1] = 0.0;
}

void pin_space_rows_state(const PinSpace *place, const PinSpaceRows *rows,
                          const SpaceMotion *motions, double *position, double *speed)
{
    if (place->place == PIN_SPACE_COLLAR) {
        collar_state(place, motions, position, speed);
        return;
    }
    const PinSpacePose pose = pin_space_pose(place, motions);
    const Vec3 axis = space_direction(motions, place->pin.body, place->pin.axis);
    const Vec3 relative = vec3_sub(space_velocity_at(motions, place->pin.body, pose.at_b),
                                   space_velocity_at(motions, place->hole.body, pose.at_a));
    const Vec3 across = vec3_across(relative, axis);
    for (size_t i = 0; i < 2; i++) {
        position[i] = vec3_dot(rows->across[i], pose.offset);
        speed[i] = vec3_dot(rows->across[i], across);
    }
    // the axis has turned between the two instants: the distance keeps its digits
    const double seen = vec3_length((Vec3){position[0], position[1], 0.0});
    if (seen > 0.0) {
        const double share = vec3_length(pose.offset) / seen;
        position[0] *= share;
        position[1] *= share;
    }
    if (rows->count == PIN_SPACE_ROWS) {
        speed[ROW_AXIAL] = vec3_dot(axis, relative);
        write_turns(rows, omega_of(motions, place->hole.body), omega_of(motions, place->pin.body),
                    speed);
    }
}

static void collar_drift(const PinSpace *place, const PinSpaceRows *rows,
                         const SpaceMotion *motions, double *drift)
{
    const Vec3 axis = rows->across[0];
    const int a = place->hole.body;
    const int b = place->pin.body;
    const Vec3 hole = space_point(motions, a, place->hole.anchor);
    const Vec3 omega = omega_of(motions, a);
    const Vec3 turning = vec3_cross(omega, axis);
    const Vec3 bending =
        vec3_add(vec3_cross(alpha_of(motions, a), axis), vec3_cross(omega, turning));
    const Vec3 relative =
        vec3_sub(space_velocity_at(motions, b, rows->at_b), space_velocity_at(motions, a, hole));
    const Vec3 pushed = vec3_sub(space_acceleration_at(motions, b, rows->at_b),
                                 space_acceleration_at(motions, a, hole));
    drift[0] = vec3_dot(axis, pushed) + 2.0 * vec3_dot(turning, relative) +
               vec3_dot(bending, vec3_sub(rows->at_b, hole));
    drift[1] = 0.0;
}

void pin_space_rows_drift(const PinSpace *place, const PinSpaceRows *rows,
                          const SpaceMotion *motions, double *drift)
{
    if (place->place == PIN_SPACE_COLLAR) {
        collar_drift(place, rows, motions, drift);
        return;
    }
    const int a = place->hole.body;
    const int b = place->pin.body;
    const Vec3 axis = rows->axis;
    const Vec3 turning = vec3_cross(omega_of(motions, b), axis);
    const Vec3 middle = space_point(motions, b, place->pin.anchor);
    const Vec3 hole_speed = space_velocity_at(motions, a, rows->at_a);
    const Vec3 relative = vec3_sub(space_velocity_at(motions, b, rows->at_b), hole_speed);
    const Vec3 apart = vec3_sub(space_velocity_at(motions, b, middle), hole_speed);
    const Vec3 offset = vec3_sub(rows->at_b, rows->at_a);
    const double lengthening = vec3_dot(axis, apart) + vec3_dot(offset, turning);
    const Vec3 pushed = vec3_sub(space_acceleration_at(motions, b, rows->at_b),
                                 space_acceleration_at(motions, a, rows->at_a));
    const Vec3 changing = vec3_sub(pushed, vec3_scale(lengthening, turning));
    for (size_t i = 0; i < 2; i++) {
        drift[i] = vec3_dot(rows->across[i], changing) -
                   vec3_dot(relative, axis) * vec3_dot(rows->across[i], turning);
    }
    if (rows->count == PIN_SPACE_ROWS) {
        drift[ROW_AXIAL] = vec3_dot(axis, changing) + vec3_dot(turning, relative);
        write_turns(rows, alpha_of(motions, a), alpha_of(motions, b), drift);
    }
}
