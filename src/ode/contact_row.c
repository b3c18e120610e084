// Does a pin touch its wall, how deep, and since which speed?
//
// Depth, normal and point of a contact are the collider's, with whatever is wrong with them. Where
// the pin is (gap, eccentricity) is known exactly from the bodies, and so is the rate of any depth.
#include "ode/contact_row.h"

#include "ode/contact_friction.h"

PinHole contact_row_pose(const ContactRow *row, const WorldPair *pair, Vec2 *velocity)
{
    const Vec2 hole = geom_position(pair->hole);
    const Vec2 pin = geom_position(pair->pin);
    *velocity = vec2_sub(geom_velocity(pair->pin, pin), geom_velocity(pair->hole, hole));
    return pin_hole_pose(hole, pin, *velocity, row->radial_clearance);
}

// The speed at which a pin that overlaps its wall for the first time came to it, m/s: as found now,
// or, where the steps before show it, its mean over the last step, taken on to the crossing by its
// change from step to step.
static double onset_speed(const ContactRow *row, bool is_staggered, double gap, double step_s)
{
    if (!is_staggered || row->gaps_known == 0) {
        return row->closing;
    }
    const double mean = (row->gaps[0] - gap) / step_s;
    if (row->gaps_known == 1 || !(mean > 0.0)) {
        return mean;
    }
    const double change = mean - (row->gaps[1] - row->gaps[0]) / step_s;
    // the mean stands in the middle of the last step
    return mean + change * (0.5 - row->depth / (mean * step_s));
}

// Keeps the gaps that a pin had while nothing acted on it.
static void note_gap(ContactRow *row, double gap)
{
    row->gaps_known = row->is_touching ? 0 : row->gaps_known + (row->gaps_known < 2 ? 1 : 0);
    row->gaps[1] = row->gaps[0];
    row->gaps[0] = gap;
}

void contact_row_find(ContactRow *row, const World *world, const WorldPair *pair, bool is_staggered,
                      double step_s, JointState *state)
{
    Collision collision;
    Vec2 velocity;
    const bool was_touching = row->is_touching;
    row->is_touching = world->collider->find(pair->collision, pair->hole, pair->pin, &collision);
    const PinHole pose = contact_row_pose(row, pair, &velocity);
    *state = (JointState){
        .eccentricity = pose.eccentricity,
        .gap = pose.gap,
        .is_touching = row->is_touching,
    };
    if (!row->is_touching) {
        row->impact_speed = pose.approach_speed;
    } else {
        row->depth = collision.depth;
        row->excess = collision.depth - pose.penetration;
        row->normal = collision.normal;
        row->arm_hole = collision.arm_hole;
        row->arm_pin = collision.arm_pin;
        row->closing = -vec2_dot(row->normal, velocity);
        row->faster = row->closing - pose.approach_speed;
        if (!was_touching) {
            row->impact_speed = onset_speed(row, is_staggered, pose.gap, step_s);
        }
    }
    note_gap(row, pose.gap);
}
