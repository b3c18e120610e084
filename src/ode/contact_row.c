// Do the bodies of a joint touch at a place, how deep, and since which speed?
//
// Depth, normal and point of a pin's contact are the collider's, with whatever is wrong with them.
// Where the pin is (gap, eccentricity) is known exactly from the bodies, and so is the rate of any
// depth. Of all other places everything is.
#include "ode/contact_row.h"

#include "contact/overlap.h"

// Of a place whose bodies say all.
static bool find_exactly(const WorldPair *pair, const TouchPose *pose, const Overlap *overlap,
                         ContactRow *row)
{
    if (!(overlap->depth > 0.0) || !pose->has_normal) {
        return false;
    }
    row->depth = overlap->depth;
    row->normal = pose->normal;
    row->point = pair_point(pair, pose->normal);
    pair_arms(pair, pose, row->arms, &row->lever);
    return true;
}

// Of a pin in its hole, as two circles: the points where its force acts are the circles' own.
static bool find_in_hole(const WorldPair *pair, const TouchPose *pose, ContactRow *row)
{
    if (!(pose->gap < 0.0)) {
        return false;
    }
    row->depth = -pose->gap;
    row->normal = pose->normal;
    row->arms[0] = vec2_scale(-pair->touch.radius_a, pose->normal);
    row->arms[1] = vec2_scale(-pair->touch.radius_b, pose->normal);
    row->point = vec2_add(pair_centre(pair), row->arms[0]);
    return true;
}

// The contact of a pair.
static bool find_collision(const World *world, const WorldPair *pair, const TouchPose *pose,
                           const Overlap *overlap, ContactRow *row)
{
    if (pair->hole == NULL) {
        return pair->touch.shape == TOUCH_HOLE ? find_in_hole(pair, pose, row)
                                               : find_exactly(pair, pose, overlap, row);
    }
    Collision collision;
    if (!world->collider->find(pair->collision, pair->hole, pair->pin, &collision)) {
        return false;
    }
    row->depth = collision.depth;
    row->normal = collision.normal;
    row->arms[0] = collision.arm_hole;
    row->arms[1] = collision.arm_pin;
    row->point = vec2_add(pair_centre(pair), collision.arm_hole);
    return true;
}

// What an end does in the step. Other places do what they do at mid-step: their forces grow gently.
static Overlap end_overlap(const ContactRow *row, const WorldPair *pair, const TouchPose *pose,
                           bool is_staggered, double step_s)
{
    return is_staggered && pair->is_end
               ? overlap_find(&row->law, pose->gap, pose->approach_speed, step_s)
               : (Overlap){.depth = -pose->gap, .share = 1.0};
}

// A contact begins, at a time since the step's start.
static void begin(ContactRow *row, bool is_staggered, const TouchPose *pose, double onset_s,
                  double step_s)
{
    row->state = contact_state_begun(
        is_staggered ? onset_speed(&row->onset, row->closing, pose->gap, row->inside, step_s)
                     : row->closing);
    tops_begin(&row->tops, row->law.viscous * row->state.impact_speed, 0.5 * step_s - onset_s);
}

void contact_row_find(ContactRow *row, const World *world, const WorldPair *pair, bool is_staggered,
                      double step_s, JointState *state)
{
    const bool was_touching = row->state.is_touching;
    const TouchPose pose = pair_pose(pair);
    const Overlap overlap = end_overlap(row, pair, &pose, is_staggered, step_s);
    row->share = overlap.share;
    row->state.is_touching = find_collision(world, pair, &pose, &overlap, row);
    row->inside = pair->hole == NULL ? -pose.gap : row->depth;
    *state = (JointState){
        .eccentricity = pose.offset,
        .gap = pose.gap,
        .is_touching = row->state.is_touching,
    };
    if (!row->state.is_touching) {
        row->state.impact_speed = pose.approach_speed;
    } else {
        // of a polygon's side the circles' penetration and its rate are not the row's
        row->excess = pair->hole == NULL ? 0.0 : row->depth + pose.gap;
        row->closing =
            pair->hole == NULL ? pose.approach_speed : -vec2_dot(row->normal, pose.velocity);
        row->faster = row->closing - pose.approach_speed;
        if (was_touching) {
            row->state.age_s += step_s;
            contact_state_follow(&row->state, row->closing, row->law.resting_speed);
        } else {
            begin(row, is_staggered, &pose, overlap.onset, step_s);
        }
    }
    onset_note(&row->onset, row->state.is_touching, pose.gap);
}
