// Where do the forces and depths of many joints have their maxima?
//
// To look for each by itself evaluates all bodies for each of many, and to end a part of the step
// at each hands on all bodies as often. All are looked at together at a few instants instead, and
// the polynomial through these (base/curve.h) has the maxima: forces are as smooth in a step as the
// motion that the step has followed to its tolerance.
#include "reference/peaks_crowd.h"

#include "base/curve.h"
#include "base/zeroed.h"

PeaksCrowd peaks_crowd_create(const System *system, SystemState *scratch)
{
    const size_t count = system->scenario->linkage.joint_count;
    return (PeaksCrowd){
        .scratch = scratch,
        .tops = zeroed(count, sizeof(JointTop)),
        .joints = zeroed(count, sizeof(JointState)),
        .space_joints = zeroed(count, sizeof(SpaceJointState)),
        .forces = zeroed(CURVE_NODES * count, sizeof(double)),
        .depths = zeroed(CURVE_NODES * count, sizeof(double)),
    };
}

void peaks_crowd_finish(PeaksCrowd *crowd)
{
    free(crowd->tops);
    free(crowd->joints);
    free(crowd->space_joints);
    free(crowd->forces);
    free(crowd->depths);
}

static void note_node(PeaksCrowd *crowd, const System *system, const SystemState *state,
                      size_t node)
{
    system->kind->joints(system, state, crowd->joints, crowd->space_joints);
    for (size_t i = 0; i < system->scenario->linkage.joint_count; i++) {
        crowd->forces[CURVE_NODES * i + node] = crowd->joints[i].force;
        crowd->depths[CURVE_NODES * i + node] = joint_state_depth(&crowd->joints[i]);
    }
}

static JointTop find_top(const PeaksCrowd *crowd, size_t joint, double start_s, double width_s)
{
    double force_share = 0.0;
    double depth_share = 0.0;
    JointTop top = {
        .force = curve_top(crowd->forces + CURVE_NODES * joint, &force_share),
        .depth = curve_top(crowd->depths + CURVE_NODES * joint, &depth_share),
    };
    top.force_s = start_s + force_share * width_s;
    top.depth_s = start_s + depth_share * width_s;
    return top;
}

bool peaks_crowd_find(PeaksCrowd *crowd, Stepper *stepper, double start_s, double end_s,
                      const SystemState *state)
{
    const System *system = stepper->system;
    const Linkage *linkage = &system->scenario->linkage;
    for (size_t node = 0; node + 1 < CURVE_NODES; node++) {
        const double time_s = start_s + curve_node(node) * (end_s - start_s);
        const double *y = dop853_dense(&stepper->integrator, time_s);
        if (!system->kind->evaluate(system, time_s, y, crowd->scratch, NULL)) {
            return false;
        }
        note_node(crowd, system, crowd->scratch, node);
    }
    note_node(crowd, system, state, CURVE_NODES - 1);
    const double since_s = system->kind->time(system, start_s);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        crowd->tops[i] = (JointTop){.force = 0.0};
        if (linkage_has_play(&linkage->joints[i])) {
            crowd->tops[i] = find_top(crowd, i, since_s, end_s - start_s);
        }
    }
    return true;
}
