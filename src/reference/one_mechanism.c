// How does a mechanism with play really move? (A solver.)
//
// The equations of motion in tree coordinates (reference/system.h), integrated by an explicit
// method of order 8 (reference/dop853.h); contact begin and end are events, between which the
// right-hand side is smooth. A step of the integrator is handed on in parts that end where a force
// or a depth has its maximum, so that no peak is missed whatever the step.
#include "base/layout.h"
#include "reference/mechanisms.h"
#include "reference/peaks.h"
#include "reference/stepper.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef struct Reference {
    Stepper *stepper; // owned, like the next two
    Peaks peaks;
    SystemState *scratch;
    size_t point;   // of the step that comes next
    double since_s; // end of the part of the step that was handed on, from the step's start
    double start_s; // of that part
    double end_s;
    double *y;      // at end_s; owned, like the next two
    double *before; // at start_s
    double *seen;   // at a time that is observed
    double elastic; // J, stored in the contacts at end_s
    void *memory;   // owned; where the arrays below are
    double *omega;  // by body
    double *alpha;
    double *impulse; // by joint
    double *approach;
    double *onset_s; // when its contact under way began
    JointState *joints;
    SpaceJointState *space_joints;
} Reference;

// All arrays, from a layout that counts or has the memory.
static void lay(Reference *reference, const Linkage *linkage, Layout *layout)
{
    const size_t bodies = linkage->body_count;
    const size_t joints = linkage->joint_count;
    reference->omega = layout_take(layout, bodies, sizeof *reference->omega);
    reference->alpha = layout_take(layout, bodies, sizeof *reference->alpha);
    reference->impulse = layout_take(layout, joints, sizeof *reference->impulse);
    reference->approach = layout_take(layout, joints, sizeof *reference->approach);
    reference->onset_s = layout_take(layout, joints, sizeof *reference->onset_s);
    reference->joints = layout_take(layout, joints, sizeof *reference->joints);
    reference->space_joints = layout_take(layout, joints, sizeof *reference->space_joints);
}

static Reference *create(const Linkage *linkage)
{
    Reference *reference = calloc(1, sizeof *reference);
    assert(reference != NULL);
    Layout layout = {NULL, 0};
    lay(reference, linkage, &layout);
    reference->memory = calloc(1, layout.used + 1);
    assert(reference->memory != NULL);
    lay(reference, linkage, &(Layout){reference->memory, 0});
    return reference;
}

static bool fail_at(const Reference *reference, double time_s, Err *err)
{
    char where[LINKAGE_INSTANT_SIZE];
    linkage_describe_instant(&reference->stepper->scenario->linkage, time_s, where);
    err_prefix(err, where);
    return false;
}

static void reference_close(void *state)
{
    Reference *reference = state;
    if (reference != NULL) {
        stepper_finish(reference->stepper);
        peaks_finish(&reference->peaks);
        free(reference->stepper);
        free(reference->scratch);
        free(reference->y);
        free(reference->before);
        free(reference->seen);
        free(reference->memory);
        free(reference);
    }
}

// The closing speed at which each joint's contact under way began: where a pin presses at both ends
// of its hole, that of the end that came first.
static void fill_approach(Reference *reference)
{
    const System *system = reference->stepper->system;
    double *since_s = reference->onset_s;
    for (size_t i = 0; i < system->contact_count; i++) {
        since_s[system->contacts[i].joint] = INFINITY;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const bool is_first = contact->onset_s < since_s[contact->joint];
        if (!contact->is_collar && contact->mode != CONTACT_APART && is_first) {
            since_s[contact->joint] = contact->onset_s;
            reference->approach[contact->joint] = contact->impact_speed;
        }
    }
}

// Books one part of a step that ends in a state.
static void fill_record(Reference *reference, const SystemState *state)
{
    const System *system = reference->stepper->system;
    const double *impulses = reference->y + system_sum_index(system, SYSTEM_IMPULSES);
    const double *before = reference->before + system_sum_index(system, SYSTEM_IMPULSES);
    system->kind->turning(system, state, reference->omega, reference->alpha);
    system->kind->joints(system, state, reference->joints, reference->space_joints);
    reference->elastic = 0.0;
    for (size_t i = 0; i < system->contact_count; i++) {
        reference->impulse[system->contacts[i].joint] = 0.0;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        if (!contact->is_collar) {
            reference->impulse[contact->joint] += impulses[i] - before[i];
        }
        if (contact->mode != CONTACT_APART) {
            reference->elastic += force_law_energy(&contact->law, state->contacts[i].depth);
        }
    }
    fill_approach(reference);
}

// A part of no length where a contact begins: a viscous damper presses hardest at that instant.
static bool show_onset(Reference *reference, Err *err)
{
    const Stepper *stepper = reference->stepper;
    const System *system = stepper->system;
    memcpy(reference->y, stepper->integrator.y, stepper->integrator.size * sizeof *reference->y);
    memcpy(reference->before, reference->y, stepper->integrator.size * sizeof *reference->y);
    if (!system->kind->evaluate(system, 0.0, reference->y, reference->scratch, NULL)) {
        return pace_undetermined(err);
    }
    reference->start_s = reference->end_s;
    reference->peaks.has_tops = false;
    fill_record(reference, reference->scratch);
    return true;
}

static bool advance(Reference *reference, Err *err)
{
    Stepper *stepper = reference->stepper;
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
    Dop853 *integrator = &stepper->integrator;
    const double point_s = events_point_time(integrator, &stepper->points, reference->point);
    const System *system = stepper->system;
    const SystemState *state = stepper->points.states[reference->point];
    const double end_s = peaks_next(&reference->peaks, stepper, reference->since_s, point_s, state);
    const bool is_end = end_s == integrator->time + integrator->tried;
    const double *y = is_end ? integrator->next : dop853_dense(integrator, end_s);
    memcpy(reference->before, reference->y, integrator->size * sizeof *reference->y);
    memcpy(reference->y, y, integrator->size * sizeof *reference->y);
    if (end_s < point_s) {
        system->kind->evaluate(system, end_s, reference->y, reference->scratch, NULL);
        state = reference->scratch;
    } else {
        reference->point++;
    }
    reference->since_s = end_s;
    reference->start_s = reference->end_s;
    reference->end_s = system->kind->time(system, end_s);
    fill_record(reference, state);
    return system_check_depth(system, state, 1.0, err);
}

static bool reference_open(const Scenario *scenario, void **state, Err *err)
{
    Reference *reference = create(&scenario->linkage);
    Stepper *stepper = calloc(1, sizeof *stepper);
    assert(stepper != NULL);
    reference->stepper = stepper;
    if (!stepper_init(stepper, scenario, err)) {
        reference_close(reference);
        return false;
    }
    const size_t size = stepper->integrator.size;
    reference->y = calloc(size, sizeof *reference->y);
    reference->before = calloc(size, sizeof *reference->before);
    reference->seen = calloc(size, sizeof *reference->seen);
    assert(reference->y != NULL && reference->before != NULL && reference->seen != NULL);
    reference->scratch = system_state_create(stepper->system);
    reference->peaks = peaks_create(stepper->system, reference->scratch);
    // the stepper stands at a point; the first call takes its first step
    reference->point = stepper->points.count;
    memcpy(reference->y, stepper->integrator.y, size * sizeof *reference->y);
    *state = reference;
    return true;
}

static bool reference_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Reference *reference = state;
    return advance(reference, err) || fail_at(reference, reference->end_s, err);
}

// A whole step, without a look for peaks.
static bool reference_stride(void *state, double stop_s, double *end_s, Err *err)
{
    (void)stop_s;
    Reference *reference = state;
    Stepper *stepper = reference->stepper;
    const System *system = stepper->system;
    const Dop853 *integrator = &stepper->integrator;
    bool is_known = stepper_next(stepper, err);
    for (size_t i = 0; is_known && i < stepper->points.count; i++) {
        is_known = system_check_depth(system, stepper->points.states[i], 1.0, err);
    }
    if (!is_known) {
        return fail_at(reference, reference->end_s, err);
    }
    reference->end_s = system->kind->time(system, integrator->time + integrator->tried);
    *end_s = reference->end_s;
    return true;
}

static StepRecord reference_record(const void *state)
{
    const Reference *reference = state;
    const size_t sums = system_sum_index(reference->stepper->system, 0);
    const bool is_spatial = reference->stepper->scenario->linkage.is_spatial;
    const double *now = reference->y + sums;
    const double *then = reference->before + sums;
    return (StepRecord){
        .start_s = reference->start_s,
        .end_s = reference->end_s,
        .joint_s = reference->end_s,
        .is_smooth = true,
        .omega = reference->omega,
        .alpha = reference->alpha,
        .joints = reference->joints,
        .space_joints = is_spatial ? reference->space_joints : NULL,
        .tops = reference->peaks.has_tops ? reference->peaks.crowd.tops : NULL,
        .impulse = reference->impulse,
        .approach = reference->approach,
        .drive_work = now[SYSTEM_DRIVE_WORK] - then[SYSTEM_DRIVE_WORK],
        .dissipated = now[SYSTEM_DISSIPATED] - then[SYSTEM_DISSIPATED],
        .friction = now[SYSTEM_FRICTION] - then[SYSTEM_FRICTION],
        .elastic = reference->elastic,
    };
}

static void reference_observe(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    const Linkage *linkage = &reference->stepper->scenario->linkage;
    const System *system = reference->stepper->system;
    SystemState *at = reference->scratch;
    const double since_s = system->kind->since(system, time_s);
    double *y = reference->seen;
    dop853_dense_all(&reference->stepper->integrator, since_s, y);
    system->kind->project(system, since_s, y);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    if (!system->kind->evaluate(system, since_s, y, at, NULL)) {
        // at a change point, where the run ends
        for (size_t i = 0; i < linkage->body_count; i++) {
            sample->bodies[i].omega = NAN;
        }
        return;
    }
    system->kind->bodies(system, at, sample);
    system->kind->joints(system, at, sample->joints, sample->space_joints);
}

static void reference_glance(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    const System *system = reference->stepper->system;
    const double since_s = system->kind->since(system, time_s);
    if (system->kind->place == NULL) {
        reference_observe(state, time_s, sample);
        return;
    }
    double *y = reference->seen;
    dop853_dense_motion(&reference->stepper->integrator, since_s, y);
    if (!system->kind->place(system, since_s, y, sample)) {
        reference_observe(state, time_s, sample);
    }
}

static SolverModel reference_model(const void *state)
{
    const Reference *reference = state;
    const Dop853 *integrator = &reference->stepper->integrator;
    const System *system = reference->stepper->system;
    SolverModel model = {
        .constraint_rows = system->kind->rows(system),
        .contact_rows = system->contact_count,
        .steps = integrator->accepted + integrator->rejected,
        .evaluations = integrator->evaluations,
    };
    reference_label(reference->stepper->scenario, system->coordinate_count, model.label);
    return model;
}

size_t reference_coordinates(const void *state)
{
    return ((const Reference *)state)->stepper->system->coordinate_count;
}

const Solver REFERENCE_ONE = {
    .name = "reference",
    .open = reference_open,
    .step = reference_step,
    .stride = reference_stride,
    .record = reference_record,
    .observe = reference_observe,
    .glance = reference_glance,
    .model = reference_model,
    .close = reference_close,
};
