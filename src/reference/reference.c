// How does the linkage with play really move? (A solver.)
//
// The equations of motion in tree coordinates (reference/dynamics.h), integrated by an explicit
// method of order 8 (reference/dop853.h); contact begin and end are events, between which the
// right-hand side is smooth. A step of the integrator is handed on in parts that end where a force
// or a depth has its maximum, so that no peak is missed whatever the step.
#include "model/solver.h"
#include "reference/loops.h"
#include "reference/peaks.h"
#include "reference/stepper.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Reference {
    Stepper stepper;
    Peaks peaks;
    size_t point;   // of the step that comes next
    double since_s; // end of the part of the step that was handed on, from the step's start
    double start_s; // of that part
    double end_s;
    double y[DOP853_SIZE_MAX];      // at end_s
    double before[DOP853_SIZE_MAX]; // at start_s
    double elastic;                 // J, stored in the contacts at end_s
    double omega[LINKAGE_BODY_MAX];
    double alpha[LINKAGE_BODY_MAX];
    double impulse[LINKAGE_JOINT_MAX];
    double approach[LINKAGE_JOINT_MAX];
    JointState joints[LINKAGE_JOINT_MAX];
} Reference;

static bool fail_at(const Reference *reference, double time_s, Err *err)
{
    char where[LINKAGE_INSTANT_SIZE];
    linkage_describe_instant(&reference->stepper.scenario->linkage, time_s, where);
    err_prefix(err, where);
    return false;
}

static void reference_close(void *state)
{
    Reference *reference = state;
    if (reference != NULL) {
        stepper_finish(&reference->stepper);
        free(reference);
    }
}

// Force, eccentricity and gap of every joint in a state.
static void fill_joints(const Dynamics *dynamics, const DynamicsState *state, JointState *joints)
{
    const Linkage *linkage = &dynamics->scenario->linkage;
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->kind == JOINT_REVOLUTE) {
            const Vec2 a = tree_end_point(tree, &state->tree, 2 * (int)i);
            const Vec2 b = tree_end_point(tree, &state->tree, 2 * (int)i + 1);
            joints[i] = (JointState){
                .eccentricity = vec2_sub(b, a),
                .force_on_b = state->reactions[i],
                .force = sqrt(vec2_dot(state->reactions[i], state->reactions[i])),
                .is_touching = true,
            };
        }
    }
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        const ContactForce *force = &state->contacts[i];
        joints[dynamics->contacts[i].joint] = (JointState){
            .eccentricity = force->pose.eccentricity,
            .gap = force->pose.gap,
            .force_on_b = force->force,
            .force = sqrt(vec2_dot(force->force, force->force)),
            .is_touching = dynamics->contacts[i].mode != CONTACT_APART,
        };
    }
}

// Books one part of a step that ends in a state.
static void fill_record(Reference *reference, const DynamicsState *state)
{
    const Dynamics *dynamics = &reference->stepper.dynamics;
    const Linkage *linkage = &reference->stepper.scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        reference->omega[i] = state->tree.motions[i].omega;
        reference->alpha[i] = state->tree.motions[i].alpha;
    }
    fill_joints(dynamics, state, reference->joints);
    const size_t impulses = dynamics_sum_index(dynamics, DYNAMICS_IMPULSES);
    reference->elastic = 0.0;
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        const DynamicsContact *contact = &dynamics->contacts[i];
        reference->approach[contact->joint] = contact->impact_speed;
        reference->impulse[contact->joint] =
            reference->y[impulses + i] - reference->before[impulses + i];
        if (contact->mode != CONTACT_APART) {
            reference->elastic +=
                force_law_energy(&contact->law, state->contacts[i].pose.penetration);
        }
    }
}

// A part of no length where a contact begins: a viscous damper presses hardest at that instant.
static bool show_onset(Reference *reference, Err *err)
{
    const Stepper *stepper = &reference->stepper;
    DynamicsState state;
    memcpy(reference->y, stepper->integrator.y, stepper->integrator.size * sizeof *reference->y);
    memcpy(reference->before, reference->y, stepper->integrator.size * sizeof *reference->y);
    if (!dynamics_evaluate(&stepper->dynamics, 0.0, reference->y, &state)) {
        return pace_undetermined(err);
    }
    reference->start_s = reference->end_s;
    fill_record(reference, &state);
    return true;
}

static bool advance(Reference *reference, Err *err)
{
    Stepper *stepper = &reference->stepper;
    if (reference->point == stepper->points.count) {
        if (!stepper_next(stepper, err)) {
            return false;
        }
        reference->point = 0;
        reference->since_s = 0.0;
        if (stepper->is_after_onset) {
            return show_onset(reference, err);
        }
    }
    const Dop853 *integrator = &stepper->integrator;
    const double point_s = events_point_time(integrator, &stepper->points, reference->point);
    const DynamicsState *state = &stepper->points.states[reference->point];
    const double end_s = peaks_next(&reference->peaks, stepper, reference->since_s, point_s, state);
    DynamicsState between;
    memcpy(reference->before, reference->y, integrator->size * sizeof *reference->y);
    dop853_dense(integrator, end_s, reference->y);
    if (end_s < point_s) {
        dynamics_evaluate(&stepper->dynamics, end_s, reference->y, &between);
        state = &between;
    } else {
        reference->point++;
    }
    reference->since_s = end_s;
    reference->start_s = reference->end_s;
    reference->end_s = tree_time(&stepper->dynamics.tree, end_s);
    fill_record(reference, state);
    return dynamics_check_depth(&stepper->dynamics, state, 1.0, err);
}

static bool reference_open(const Scenario *scenario, void **state, Err *err)
{
    Reference *reference = calloc(1, sizeof *reference);
    assert(reference != NULL);
    if (!stepper_init(&reference->stepper, scenario, err)) {
        reference_close(reference);
        return false;
    }
    // the stepper stands at a point; the first call takes its first step
    reference->point = reference->stepper.points.count;
    memcpy(reference->y, reference->stepper.integrator.y, sizeof reference->y);
    *state = reference;
    return true;
}

static bool reference_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Reference *reference = state;
    return advance(reference, err) || fail_at(reference, reference->end_s, err);
}

static StepRecord reference_record(const void *state)
{
    const Reference *reference = state;
    const size_t sums = dynamics_sum_index(&reference->stepper.dynamics, 0);
    const double *now = reference->y + sums;
    const double *then = reference->before + sums;
    return (StepRecord){
        .start_s = reference->start_s,
        .end_s = reference->end_s,
        .joint_s = reference->end_s,
        .omega = reference->omega,
        .alpha = reference->alpha,
        .joints = reference->joints,
        .impulse = reference->impulse,
        .approach = reference->approach,
        .drive_work = now[DYNAMICS_DRIVE_WORK] - then[DYNAMICS_DRIVE_WORK],
        .dissipated = now[DYNAMICS_DISSIPATED] - then[DYNAMICS_DISSIPATED],
        .friction = now[DYNAMICS_FRICTION] - then[DYNAMICS_FRICTION],
        .elastic = reference->elastic,
    };
}

static void reference_observe(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    const Linkage *linkage = &reference->stepper.scenario->linkage;
    double y[DOP853_SIZE_MAX];
    DynamicsState at;
    const Tree *tree = &reference->stepper.dynamics.tree;
    const double since_s = (double)(time_s - tree->base_time_s);
    dop853_dense(&reference->stepper.integrator, since_s, y);
    // between its ends a long step keeps loops closed to its tolerance only
    loops_project(tree, since_s, y, y + tree->coordinate_count);
    const bool is_determined = dynamics_evaluate(&reference->stepper.dynamics, since_s, y, &at);
    assert(is_determined);
    (void)is_determined;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    memcpy(sample->bodies, at.tree.motions, linkage->body_count * sizeof *sample->bodies);
    fill_joints(&reference->stepper.dynamics, &at, sample->joints);
}

static SolverModel reference_model(const void *state)
{
    const Reference *reference = state;
    const Dop853 *integrator = &reference->stepper.integrator;
    SolverModel model = {
        .constraint_rows = 2 * reference->stepper.dynamics.tree.loop_count,
        .contact_rows = reference->stepper.dynamics.contact_count,
        .steps = integrator->accepted + integrator->rejected,
        .evaluations = integrator->evaluations,
    };
    snprintf(model.label, sizeof model.label, "order 8, tolerance %.3g, %zu coordinates",
             reference->stepper.scenario->reference.tolerance,
             reference->stepper.dynamics.tree.coordinate_count);
    return model;
}

const Solver REFERENCE_SOLVER = {
    .name = "reference",
    .open = reference_open,
    .step = reference_step,
    .record = reference_record,
    .observe = reference_observe,
    .model = reference_model,
    .close = reference_close,
};
