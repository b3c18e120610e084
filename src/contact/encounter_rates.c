// How do the forces of contacts change along the motion?
//
// Letters as in contact/encounter_force.c and contact/encounter_slopes.c, ' the derivative in time,
// a = u'' = g + W f:
//     n' = -t (t . v) / |e|,  t' = n (t . v) / |e|
//     d'' = o . a + (t . v)^2 / |e|
//     N' = k (1 + chi d' / v0) d' + (chi F_el / v0 + c) d''
//     v_t' = t . a + t' . v + R w_a' - (R - |e|) w_b' + d' w_b,   H' = mu (N tanh(v_t / v_s))'
// of the friction of a pin in space H_t and H_z likewise, with their share phi of the sliding.
#include "contact/encounter_rates.h"

#include "contact/encounter_friction.h"

#include <math.h>
#include <string.h>

// A number and its derivative in time.
typedef struct Rated {
    double value;
    double rate;
} Rated;

static inline Rated rated_times(Rated a, Rated b)
{
    return (Rated){a.value * b.value, a.rate * b.value + a.value * b.rate};
}

static inline Rated rated_plus(Rated a, Rated b)
{
    return (Rated){a.value + b.value, a.rate + b.rate};
}

static inline Rated rated_scale(double factor, Rated a)
{
    return (Rated){factor * a.value, factor * a.rate};
}

// The share of mu N that is held against a sliding.
static inline Rated rated_hold(Rated sliding, double speed)
{
    const EncounterHold hold = encounter_friction_hold(sliding.value, speed);
    return (Rated){hold.held, hold.slope * sliding.rate};
}

// What is known of a joint that touches: rows' speeds and accelerations, directions, and what
// presses.
typedef struct Moving {
    const EncounterJoint *joint;
    Rated speed[ENCOUNTER_ROWS_MOST];
    Rated normal[2];  // the direction of the force on the pin
    Rated tangent[2]; // that turned by a quarter turn
    Rated pin_arm;    // R - |e|
    Rated pressing;   // N
    double *force;    // of its rows
    double *rate;
} Moving;

static inline Rated directed(const Rated direction[2], const Rated vector[2])
{
    return rated_plus(rated_times(direction[0], vector[0]), rated_times(direction[1], vector[1]));
}

static void push_row(Moving *moving, size_t row, Rated force)
{
    moving->force[row] += force.value;
    moving->rate[row] += force.rate;
}

static Rated rows_along(const Moving *moving, const Rated direction[2], size_t row)
{
    return directed(direction, moving->speed + row);
}

// Friction of a pin in space, round its axis and along it; returns the power it takes.
static Rated rate_space_friction(Moving *moving, Rated round, Rated *held)
{
    const double hole_arm = moving->joint->hole_radius;
    const Rated by_hole =
        rated_scale(-hole_arm, rows_along(moving, moving->tangent, ENCOUNTER_ROW_HOLE));
    const Rated by_pin =
        rated_times(moving->pin_arm, rows_along(moving, moving->tangent, ENCOUNTER_ROW_PIN));
    const Rated axial = rated_plus(moving->speed[ENCOUNTER_ROW_AXIAL], rated_plus(by_hole, by_pin));
    const EncounterGrip found =
        encounter_friction_grip(hypot(round.value, axial.value), moving->joint->law.friction_speed);
    const Rated share = {found.share,
                         found.bend * (round.value * round.rate + axial.value * axial.rate)};
    const Rated grip =
        rated_times(rated_scale(moving->joint->law.friction, moving->pressing), share);
    const Rated along_axis = rated_times(grip, axial);
    *held = rated_times(grip, round);
    push_row(moving, ENCOUNTER_ROW_AXIAL, rated_scale(-1.0, along_axis));
    for (size_t i = 0; i < 2; i++) {
        const Rated part = rated_times(along_axis, moving->tangent[i]);
        push_row(moving, ENCOUNTER_ROW_HOLE + i, rated_scale(hole_arm, part));
        push_row(moving, ENCOUNTER_ROW_PIN + i,
                 rated_scale(-1.0, rated_times(moving->pin_arm, part)));
    }
    return rated_plus(rated_times(*held, round), rated_times(along_axis, axial));
}

// Adds friction to the rows; returns the power it takes.
static Rated rate_friction(Moving *moving)
{
    const EncounterJoint *joint = moving->joint;
    const Rated grip = rated_scale(joint->law.friction, moving->pressing);
    if (joint->shape == TOUCH_LINE) {
        const Rated held =
            rated_times(grip, rated_hold(moving->speed[1], joint->law.friction_speed));
        push_row(moving, 1, rated_scale(-1.0, held));
        return rated_times(held, moving->speed[1]);
    }
    const double hole_arm = joint->hole_radius;
    const Rated sliding = rated_plus(
        rated_plus(rows_along(moving, moving->tangent, 0),
                   rated_scale(hole_arm, moving->speed[ENCOUNTER_ROW_TURN])),
        rated_scale(-1.0, rated_times(moving->pin_arm, moving->speed[ENCOUNTER_ROW_TURN + 1])));
    Rated held;
    Rated power;
    if (joint->row_count == ENCOUNTER_ROWS_MOST) {
        power = rate_space_friction(moving, sliding, &held);
    } else {
        held = rated_times(grip, rated_hold(sliding, joint->law.friction_speed));
        power = rated_times(held, sliding);
    }
    for (size_t i = 0; i < 2; i++) {
        push_row(moving, i, rated_scale(-1.0, rated_times(held, moving->tangent[i])));
    }
    push_row(moving, ENCOUNTER_ROW_TURN, rated_scale(-hole_arm, held));
    push_row(moving, ENCOUNTER_ROW_TURN + 1, rated_times(moving->pin_arm, held));
    return power;
}

// What a joint presses with, from how it is and its closing speed, and the part of it that is lost.
static Rated rate_pressing(const EncounterJoint *joint, const EncounterTouch *touch, Rated closing,
                           Rated *lost)
{
    const ForceLaw *law = &joint->law;
    const double factor = law->hysteresis / fmax(joint->impact_speed, law->impact_speed_floor);
    // at no depth the slope of a law of exponent below 1 is infinite
    const double slope = touch->tangent < INFINITY ? touch->tangent : 0.0;
    const Rated elastic = {touch->elastic, slope * closing.value};
    const Rated damping = rated_plus(rated_times(rated_scale(factor, elastic), closing),
                                     rated_scale(law->viscous, closing));
    const Rated sum = rated_plus(elastic, damping);
    if (sum.value < 0.0 || (touch->pose.penetration <= 0.0 && closing.value <= 0.0)) {
        *lost = rated_scale(-1.0, elastic);
        return (Rated){0.0, 0.0};
    }
    *lost = damping;
    return sum;
}

// Directions, arms and pressing of a joint from its pose.
static Rated find_pressing(Moving *moving, const EncounterTouch *touch)
{
    const PinHole *pose = &touch->pose;
    const Rated *v = moving->speed;
    const double n[2] = {pose->normal.x, pose->normal.y};
    const double t[2] = {-n[1], n[0]};
    const double round = t[0] * v[0].value + t[1] * v[1].value;
    const double turning = round / pose->eccentricity_size;
    for (size_t i = 0; i < 2; i++) {
        moving->normal[i] = (Rated){n[i], -turning * t[i]};
        moving->tangent[i] = (Rated){t[i], turning * n[i]};
    }
    const Rated closing = {
        pose->approach_speed,
        round * turning - n[0] * v[0].rate - n[1] * v[1].rate,
    };
    moving->pin_arm =
        (Rated){moving->joint->hole_radius - pose->eccentricity_size, -pose->approach_speed};
    Rated lost;
    moving->pressing = rate_pressing(moving->joint, touch, closing, &lost);
    return rated_times(lost, closing);
}

// Adds what a joint that touches presses and rubs with to its rows, which are empty.
static void rate_joint(Moving *moving, const EncounterTouch *touch, EncounterPoint *point)
{
    const Rated damped = find_pressing(moving, touch);
    point->powers[0] += damped.value;
    point->power_rates[0] += damped.rate;
    if (moving->joint->shape == TOUCH_LINE) {
        push_row(moving, 0, moving->pressing);
    } else {
        push_row(moving, 0, rated_times(moving->pressing, moving->normal[0]));
        push_row(moving, 1, rated_times(moving->pressing, moving->normal[1]));
    }
    if (moving->joint->has_friction) {
        const Rated rubbed = rate_friction(moving);
        point->powers[1] += rubbed.value;
        point->power_rates[1] += rubbed.rate;
    }
}

// How a joint's rows move under the forces.
static void find_moving(const Encounter *encounter, const EncounterPoint *point,
                        const double *forces, const EncounterTouch *touch, Moving *moving)
{
    const size_t first = moving->joint->first_row;
    for (size_t k = 0; k < moving->joint->row_count; k++) {
        const double acceleration = encounter_motion_acceleration(
            encounter, first + k, point->time_s, point->impulse, forces);
        moving->speed[k] = (Rated){touch->speed[k], acceleration};
    }
}

void encounter_rates_find(Encounter *encounter, EncounterPoint *point)
{
    const size_t rows = encounter->row_count;
    const EncounterTouch *touching = encounter->work->touching;
    double *forces = encounter->work->forces;
    encounter_force_find_touching(encounter, point, forces, point->powers,
                                  encounter->work->touching);
    memset(point->force, 0, rows * sizeof *point->force);
    memset(point->rate, 0, rows * sizeof *point->rate);
    memset(point->powers, 0, sizeof point->powers);
    memset(point->power_rates, 0, sizeof point->power_rates);
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        if (joint->is_touching) {
            Moving moving = {
                .joint = joint,
                .force = point->force + joint->first_row,
                .rate = point->rate + joint->first_row,
            };
            find_moving(encounter, point, forces, &touching[i], &moving);
            rate_joint(&moving, &touching[i], point);
        }
    }
}
