// Presents the equations of motion in the plane as those of a linkage in space that never leaves it
// (model/space_flat.h).
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
    for (size_t i = 0; i < linkage->body_count; i++) {
        sample->space_bodies[i] = space_flat_motion(&linkage->bodies[i], &sample->bodies[i]);
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

static void flat_joints(const System *system, const SystemState *state, JointState *joints,
                        SpaceJointState *space_joints)
{
    const Linkage *linkage = system->flat->linkage;
    system->flat->plane->joints(system, state, joints, space_joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        space_joints[i] = space_flat_joint(&linkage->joints[i], &joints[i]);
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
