// Presents the equations of motion in the plane as those of a linkage in space that never leaves it
// (model/space_flat.h).
//
// The two ends of a pin then have half of what the plane's pin presses with, at the same gap; its
// tilt and its way along the axis are nothing.
#include "base/zeroed.h"
#include "model/space_flat.h"
#include "reference/system.h"

struct SystemFlat {
    SystemKind kind;         // the plane's, but for what people see
    const SystemKind *plane; // as it is
    const Linkage *linkage;  // in space
    Scenario scenario;       // in the plane; owned
};

// Lifts the bodies of a sample.
static void lift_bodies(const System *system, Sample *sample)
{
    const Linkage *linkage = system->flat->linkage;
    space_lift(linkage, sample->bodies, sample->space_bodies);
    for (size_t i = 0; i < linkage->body_count; i++) {
        // in one turn, as space_planar has it
        sample->bodies[i].angle = remainder(sample->bodies[i].angle, 2.0 * M_PI);
    }
}

static void flat_bodies(const System *system, const SystemState *state, Sample *sample)
{
    system->flat->plane->bodies(system, state, sample);
    lift_bodies(system, sample);
}

static bool flat_motions(const System *system, double since_s, const double *y, Sample *sample)
{
    if (!system->flat->plane->motions(system, since_s, y, sample)) {
        return false;
    }
    lift_bodies(system, sample);
    return true;
}

static Vec3 in_plane(Vec2 a)
{
    return (Vec3){a.x, a.y, 0.0};
}

static void flat_joints(const System *system, const SystemState *state, JointState *joints,
                        SpaceJointState *space_joints)
{
    const Linkage *linkage = system->flat->linkage;
    system->flat->plane->joints(system, state, joints, space_joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointState *joint = &joints[i];
        SpaceJointState *to = &space_joints[i];
        *to = (SpaceJointState){
            .force_on_b = in_plane(joint->force_on_b),
            .offset = in_plane(joint->eccentricity),
        };
        for (int end = 0; end < 2 && linkage->joints[i].kind == JOINT_CLEARANCE; end++) {
            to->ends[end] = to->offset;
            to->end_gaps[end] = joint->gap;
            to->end_forces[end] = 0.5 * joint->force;
        }
    }
}

static void flat_destroy(System *system)
{
    SystemFlat *flat = system->flat;
    flat->plane->destroy(system);
    scenario_free(&flat->scenario);
    free(flat);
}

System *flat_system_create(const Scenario *scenario, Err *err)
{
    SystemFlat *flat = zeroed(1, sizeof *flat);
    flat->scenario = space_flat_scenario(scenario);
    flat->linkage = &scenario->linkage;
    System *system = plane_system_create(&flat->scenario, err);
    if (system == NULL) {
        scenario_free(&flat->scenario);
        free(flat);
        return NULL;
    }
    flat->plane = system->kind;
    flat->kind = *system->kind;
    flat->kind.bodies = flat_bodies;
    flat->kind.motions = flat_motions;
    flat->kind.joints = flat_joints;
    flat->kind.destroy = flat_destroy;
    system->flat = flat;
    system->kind = &flat->kind;
    return system;
}
