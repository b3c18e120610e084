// Finds the friction of joints, with its defaults.
#include "model/joint_friction.h"

// A bearing of a usual hand-held or table-top mechanism: it only says how a speed and a bend at the
// pin count as angles.
const double JOINT_FRICTION_RADIUS = 1e-2;

int joint_friction_first(const Linkage *linkage)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_friction_is(&linkage->joints[i])) {
            return i;
        }
    }
    return -1;
}

JointFriction joint_friction_whole(const ContactOptions *contact, const Joint *joint)
{
    JointFriction whole = joint->friction;
    whole.law = whole.has_law ? whole.law : contact->friction_law;
    whole.speed = whole.speed > 0.0 ? whole.speed : contact->friction_speed;
    whole.ratio = whole.ratio > 0.0 ? whole.ratio : contact->breakaway_ratio;
    whole.presliding = whole.presliding > 0.0 ? whole.presliding : contact->presliding;
    whole.damping = whole.damping > 0.0 ? whole.damping : contact->presliding_damping;
    return whole;
}

double joint_friction_mass(const Linkage *linkage, const Joint *joint)
{
    double inverse = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        if (body != LINKAGE_GROUND && linkage_drive_of_body(linkage, body) < 0) {
            inverse += 1.0 / linkage->bodies[body].mass;
        }
    }
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

BristlePair joint_friction_pair(const ContactOptions *contact, const Joint *joint)
{
    const JointFriction whole = joint_friction_whole(contact, joint);
    const double reach = joint_friction_reach(joint);
    return (BristlePair){.law = whole.law,
                         .ratio = whole.ratio,
                         .limit = whole.presliding / reach,
                         .speed = whole.speed / reach,
                         .zeta = whole.damping};
}

double joint_friction_mobility(const Linkage *linkage, const Joint *joint)
{
    double sum = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        if (body != LINKAGE_GROUND && linkage_drive_of_body(linkage, body) < 0) {
            const Body *of = &linkage->bodies[body];
            sum += 1.0 / (joint_slides(joint->kind) ? of->mass : of->inertia);
        }
    }
    return sum;
}
