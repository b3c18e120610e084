// Where do limited angles and teeth stand?
//
// ODE knows angles in one turn; turns are counted from step to step. The row by which an end of an
// angle presses is world/pressing_row.c's, with body b of the joint first: then its rate is that of
// the coordinate (model/coordinate.h). Teeth and the ends of a slider are contacts
// (ode/contact_rows.c).
#include "ode/ends.h"

#include "base/zeroed.h"
#include "ode/snapshot.h"

static bool has_angles(const Joint *joint)
{
    return joint->limits.kind != LIMIT_NONE && joint->kind != JOINT_PRISMATIC;
}

static void follow(WorldEnds *ends, int body, const Motion *motions)
{
    if (body != LINKAGE_GROUND) {
        ends->is_followed[body] = true;
        ends->motions[body] = motions[body];
    }
}

WorldEnds *ends_make(const Linkage *linkage, const dBodyID *bodies, const Motion *motions)
{
    WorldEnds *ends = zeroed(1, sizeof *ends);
    bool is_any = false;
    ends->linkage = linkage;
    ends->bodies = bodies;
    ends->motions = zeroed(linkage->body_count, sizeof *ends->motions);
    ends->is_followed = zeroed(linkage->body_count, sizeof *ends->is_followed);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (has_angles(joint)) {
            is_any = true;
            follow(ends, joint->body_a, motions);
            follow(ends, joint->body_b, motions);
            follow(ends, joint->kind == JOINT_GEAR ? joint->gear.carrier : LINKAGE_GROUND, motions);
        }
    }
    if (!is_any) {
        ends_free(ends);
        return NULL;
    }
    return ends;
}

void ends_free(WorldEnds *ends)
{
    if (ends != NULL) {
        free(ends->motions);
        free(ends->is_followed);
        free(ends);
    }
}

double ends_count_turns(const WorldEnds *ends, size_t body, double angle)
{
    if (ends == NULL || !ends->is_followed[body]) {
        return angle;
    }
    const double last = ends->motions[body].angle;
    return last + remainder(angle - last, 2.0 * M_PI);
}

static void look_at(WorldEnds *ends, int body)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    const Snapshot now = snapshot_of(ends->bodies[body]);
    ends->motions[body] = (Motion){
        .position = now.position,
        .angle = ends_count_turns(ends, (size_t)body, atan2(now.direction.y, now.direction.x)),
        .velocity = now.velocity,
        .omega = now.omega,
    };
}

const Motion *ends_look(WorldEnds *ends, int joint)
{
    const Joint *of = &ends->linkage->joints[joint];
    look_at(ends, of->body_a);
    look_at(ends, of->body_b);
    if (of->kind == JOINT_GEAR) {
        look_at(ends, of->gear.carrier);
    }
    return ends->motions;
}
