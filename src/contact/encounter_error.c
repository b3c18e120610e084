// Which error of an implicit step is allowed?
//
// The fourth power of the phase, as an explicit step of that phase has on a spring:
//     along the normal    of the depth and of what the pin closes in the step
//     along the wall      of that, and of the way that it slides in the step
// for an error of position, and of speed times the length of the step. So a depth that has hardly
// begun to grow is followed as well as a deep one: the damping of what comes next depends on it.
#include "contact/encounter_error.h"

#include <math.h>

static const double ROUNDINGS = 8.0 * 0x1p-52; // of what a depth is the difference of

// By how much impulses move the rows of a joint.
static void move_rows(const Encounter *encounter, size_t joint, const double *impulse,
                      double *moved)
{
    const size_t first = encounter->joints[joint].first_row;
    const size_t own = encounter->joints[joint].row_count;
    for (size_t i = 0; i < own; i++) {
        const double *mobility = encounter_mobility(encounter, first + i, 0);
        const EncounterSpan span = encounter_span(encounter, first + i);
        moved[i] = 0.0;
        for (size_t k = span.first; k < span.end; k++) {
            moved[i] += mobility[k] * impulse[k];
        }
    }
}

// The size of what rows do along the wall, turns at the wall included.
static double along_wall(const Encounter *encounter, size_t joint, Vec2 tangent, const double *rows)
{
    const EncounterJoint *of = &encounter->joints[joint];
    double sum = fabs(tangent.x * rows[0] + tangent.y * rows[1]);
    for (size_t i = ENCOUNTER_ROWS_PLAIN; i < of->row_count; i++) {
        sum += (i == ENCOUNTER_ROW_AXIAL ? 1.0 : fabs(of->hole_radius)) * fabs(rows[i]);
    }
    return sum;
}

double encounter_error_rounding(const Encounter *encounter, size_t joint, double time_s)
{
    const EncounterJoint *of = &encounter->joints[joint];
    if (of->shape != TOUCH_LINE) {
        return ROUNDINGS * fabs(of->radial_clearance);
    }
    return ROUNDINGS * (fabs(encounter->position[of->first_row]) +
                        time_s * fabs(encounter->speed[of->first_row]));
}

static double share_of_joint(const Encounter *encounter, size_t joint, const EncounterPoint *from,
                             double width_s, const double *moved, const double *impulse,
                             const double *moment)
{
    const size_t first = encounter->joints[joint].first_row;
    const size_t own = encounter->joints[joint].row_count;
    const double square = encounter->stiff_phase * encounter->stiff_phase;
    const double rounding = encounter_error_rounding(encounter, joint, from->time_s + width_s);
    const PinHole pose =
        encounter_motion_pose(encounter, joint, from->time_s, from->impulse, from->moment);
    const Vec2 tangent = vec2_perp(pose.normal);
    double speeds[ENCOUNTER_ROWS_MOST];
    double changes[ENCOUNTER_ROWS_MOST];
    double errors[2][ENCOUNTER_ROWS_MOST];
    for (size_t i = 0; i < own; i++) {
        speeds[i] =
            encounter_motion_speed(encounter, first + i, from->time_s, from->impulse, from->moment);
    }
    move_rows(encounter, joint, moved, changes);
    move_rows(encounter, joint, impulse, errors[0]);
    move_rows(encounter, joint, moment, errors[1]);
    const double depth = fabs(pose.penetration) + width_s * fabs(pose.approach_speed);
    const double slid = width_s * (along_wall(encounter, joint, tangent, speeds) +
                                   along_wall(encounter, joint, tangent, changes));
    const double across = square * square * depth + rounding;
    const double along = across + square * square * slid;
    double worst = 0.0;
    for (size_t i = 0; i < 2; i++) {
        const double span = i == 0 ? width_s : 1.0;
        const double astray = fabs(pose.normal.x * errors[i][0] + pose.normal.y * errors[i][1]);
        const double share =
            span * fmax(astray / across, along_wall(encounter, joint, tangent, errors[i]) / along);
        worst = share <= worst ? worst : share; // a NaN must show
    }
    return worst;
}

double encounter_error_share(const Encounter *encounter, const EncounterPoint *from, double width_s,
                             const double *moved, const double *impulse, const double *moment)
{
    double worst = 0.0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (encounter->joints[i].is_touching) {
            const double share =
                share_of_joint(encounter, i, from, width_s, moved, impulse, moment);
            worst = share <= worst ? worst : share;
        }
    }
    return worst;
}
