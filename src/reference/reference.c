// The reference solver: how a linkage with play moves, integrated to its tolerance.
//
// A linkage whose parts share nothing but the ground is solved part by part, side by side.
#include "reference/peaks.h"

#include "base/layout.h"
#include "base/zeroed.h"
#include "model/components.h"
#include "model/independent.h"
#include "model/solver.h"
#include "reference/stepper.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What the model says of itself.
static void reference_label(const Scenario *scenario, size_t coordinates,
                            char label[TRAJECTORY_LABEL_SIZE])
{
    snprintf(label, TRAJECTORY_LABEL_SIZE, "order 8, tolerance %.3g, %zu coordinate%s",
             scenario->reference.tolerance, coordinates, coordinates == 1 ? "" : "s");
}

// The solver of one mechanism.
//
// The equations of motion in tree coordinates (reference/system.h), integrated by an explicit
// method of order 8 (reference/integrators.h); contact begin and end are events, between which the
// right-hand side is smooth. A step of the integrator is passed on in parts that end where a force
// or a depth has its maximum, so that no peak is missed whatever the step.

typedef struct Mechanism {
    Stepper *stepper; // owned, like the next two
    Peaks peaks;
    SystemState *scratch;
    SystemState *seen;           // at a time that is observed; owned
    const SystemState *recorded; // at the end of the record
    size_t point;                // of the step that comes next
    double since_s; // end of the part of the step that was passed on, from the step's start
    double start_s; // of that part
    double end_s;
    double *y;        // at end_s; owned, like the next two
    double *before;   // at start_s
    double *observed; // at a time that is observed
    double elastic;   // J, stored in the contacts at end_s
    void *memory;     // owned; where the arrays below are
    double *omega;    // by body
    double *alpha;
    double *impulse; // by joint
    double *approach;
    double *onset_s; // when its contact under way began
    JointState *joints;
    SpaceJointState *space_joints;
} Mechanism;

// All arrays, from a layout that counts or has the memory.
static void mechanism_lay(Mechanism *mechanism, const Linkage *linkage, MemoryLayout *layout)
{
    const size_t bodies = linkage->body_count;
    const size_t joints = linkage->joint_count;
    mechanism->omega = layout_take(layout, bodies, sizeof *mechanism->omega);
    mechanism->alpha = layout_take(layout, bodies, sizeof *mechanism->alpha);
    mechanism->impulse = layout_take(layout, joints, sizeof *mechanism->impulse);
    mechanism->approach = layout_take(layout, joints, sizeof *mechanism->approach);
    mechanism->onset_s = layout_take(layout, joints, sizeof *mechanism->onset_s);
    mechanism->joints = layout_take(layout, joints, sizeof *mechanism->joints);
    mechanism->space_joints = layout_take(layout, joints, sizeof *mechanism->space_joints);
}

static Mechanism *mechanism_create(const Linkage *linkage)
{
    Mechanism *mechanism = calloc(1, sizeof *mechanism);
    assert(mechanism != NULL);
    MemoryLayout layout = {NULL, 0};
    mechanism_lay(mechanism, linkage, &layout);
    mechanism->memory = calloc(1, layout.used + 1);
    assert(mechanism->memory != NULL);
    mechanism_lay(mechanism, linkage, &(MemoryLayout){mechanism->memory, 0});
    return mechanism;
}

static bool fail_at(const Mechanism *mechanism, double time_s, Err *err)
{
    char where[LINKAGE_INSTANT_SIZE];
    linkage_describe_instant(&mechanism->stepper->scenario->linkage, time_s, where);
    err_prefix(err, where);
    return false;
}

static void mechanism_close(void *state)
{
    Mechanism *mechanism = state;
    if (mechanism != NULL) {
        stepper_finish(mechanism->stepper);
        peaks_finish(&mechanism->peaks);
        free(mechanism->stepper);
        free(mechanism->scratch);
        free(mechanism->seen);
        free(mechanism->y);
        free(mechanism->before);
        free(mechanism->observed);
        free(mechanism->memory);
        free(mechanism);
    }
}

// The closing speed at which each joint's contact under way began: where a pin presses at both ends
// of its hole, that of the end that came first.
static void fill_approach(Mechanism *mechanism)
{
    const System *system = mechanism->stepper->system;
    double *since_s = mechanism->onset_s;
    for (size_t i = 0; i < system->contact_count; i++) {
        since_s[system->contacts[i].joint] = INFINITY;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const bool is_first = contact->onset_s < since_s[contact->joint];
        if (!contact->is_collar && contact->mode != CONTACT_APART && is_first) {
            since_s[contact->joint] = contact->onset_s;
            mechanism->approach[contact->joint] = contact->impact_speed;
        }
    }
}

// Books one part of a step that ends in a state.
static void fill_record(Mechanism *mechanism, const SystemState *state)
{
    const System *system = mechanism->stepper->system;
    mechanism->recorded = state;
    const double *impulses = mechanism->y + system_sum_index(system, SYSTEM_IMPULSES);
    const double *before = mechanism->before + system_sum_index(system, SYSTEM_IMPULSES);
    system->kind->turning(system, state, mechanism->omega, mechanism->alpha);
    system->kind->joints(system, state, mechanism->joints, mechanism->space_joints);
    mechanism->elastic = 0.0;
    for (size_t i = 0; i < system->contact_count; i++) {
        mechanism->impulse[system->contacts[i].joint] = 0.0;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        if (!contact->is_collar) {
            mechanism->impulse[contact->joint] += impulses[i] - before[i];
        }
        if (contact->mode != CONTACT_APART) {
            mechanism->elastic += force_law_energy(&contact->law, state->contacts[i].depth);
        }
    }
    fill_approach(mechanism);
}

// A part of no length where a contact begins: a viscous damper presses hardest at that instant.
static bool record_onset(Mechanism *mechanism, Err *err)
{
    const Stepper *stepper = mechanism->stepper;
    const System *system = stepper->system;
    memcpy(mechanism->y, stepper->integrator.y, stepper->integrator.size * sizeof *mechanism->y);
    memcpy(mechanism->before, mechanism->y, stepper->integrator.size * sizeof *mechanism->y);
    if (!system->kind->evaluate(system, 0.0, mechanism->y, mechanism->scratch, NULL)) {
        return pace_undetermined(system, err);
    }
    mechanism->start_s = mechanism->end_s;
    mechanism->peaks.has_peaks = false;
    fill_record(mechanism, mechanism->scratch);
    return true;
}

static bool advance(Mechanism *mechanism, Err *err)
{
    Stepper *stepper = mechanism->stepper;
    if (mechanism->point == stepper->points.count) {
        if (!stepper_next(stepper, err)) {
            return false;
        }
        mechanism->point = 0;
        mechanism->since_s = 0.0;
        if (stepper->is_after_onset) {
            return record_onset(mechanism, err);
        }
    }
    Dop853 *integrator = &stepper->integrator;
    const double point_s = events_point_time(integrator, &stepper->points, mechanism->point);
    const System *system = stepper->system;
    const SystemState *state = stepper->points.states[mechanism->point];
    const double end_s = peaks_next(&mechanism->peaks, stepper, mechanism->since_s, point_s, state);
    const bool is_end = end_s == integrator->time + integrator->tried;
    const double *y = is_end ? integrator->next : dop853_dense(integrator, end_s);
    memcpy(mechanism->before, mechanism->y, integrator->size * sizeof *mechanism->y);
    memcpy(mechanism->y, y, integrator->size * sizeof *mechanism->y);
    if (end_s < point_s) {
        system->kind->evaluate(system, end_s, mechanism->y, mechanism->scratch, NULL);
        state = mechanism->scratch;
    } else {
        mechanism->point++;
    }
    mechanism->since_s = end_s;
    mechanism->start_s = mechanism->end_s;
    mechanism->end_s = system->kind->time(system, end_s);
    fill_record(mechanism, state);
    return system_check_depth(system, state, 1.0, err);
}

static bool mechanism_open(const Scenario *scenario, void **state, Err *err)
{
    Mechanism *mechanism = mechanism_create(&scenario->linkage);
    Stepper *stepper = calloc(1, sizeof *stepper);
    assert(stepper != NULL);
    mechanism->stepper = stepper;
    if (!stepper_init(stepper, scenario, err)) {
        mechanism_close(mechanism);
        return false;
    }
    const size_t size = stepper->integrator.size;
    mechanism->y = calloc(size, sizeof *mechanism->y);
    mechanism->before = calloc(size, sizeof *mechanism->before);
    mechanism->observed = calloc(size, sizeof *mechanism->observed);
    assert(mechanism->y != NULL && mechanism->before != NULL && mechanism->observed != NULL);
    mechanism->scratch = system_state_create(stepper->system);
    mechanism->seen = system_state_create(stepper->system);
    mechanism->peaks = peaks_create(stepper->system, mechanism->scratch);
    // the stepper stands at a point; the first call takes its first step
    mechanism->point = stepper->points.count;
    memcpy(mechanism->y, stepper->integrator.y, size * sizeof *mechanism->y);
    *state = mechanism;
    return true;
}

static bool mechanism_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Mechanism *mechanism = state;
    return advance(mechanism, err) || fail_at(mechanism, mechanism->end_s, err);
}

// A whole step, without a search for peaks.
static bool mechanism_stride(void *state, double stop_s, double *end_s, Err *err)
{
    (void)stop_s;
    Mechanism *mechanism = state;
    Stepper *stepper = mechanism->stepper;
    const System *system = stepper->system;
    const Dop853 *integrator = &stepper->integrator;
    bool is_known = stepper_next(stepper, err);
    for (size_t i = 0; is_known && i < stepper->points.count; i++) {
        is_known = system_check_depth(system, stepper->points.states[i], 1.0, err);
    }
    if (!is_known) {
        return fail_at(mechanism, mechanism->end_s, err);
    }
    mechanism->point = stepper->points.count;
    mechanism->end_s = system->kind->time(system, integrator->time + integrator->tried);
    *end_s = mechanism->end_s;
    return true;
}

static bool mechanism_carry(void *state, Carry *carry)
{
    Mechanism *mechanism = state;
    Stepper *stepper = mechanism->stepper;
    if (!carry->is_back && mechanism->point != stepper->points.count) {
        return false;
    }
    stepper_carry(stepper, carry);
    mechanism->point = stepper->points.count;
    CARRY(carry, mechanism->end_s);
    CARRY_ARRAY(carry, mechanism->y, stepper->integrator.size);
    CARRY_ARRAY(carry, mechanism->approach, stepper->scenario->linkage.joint_count);
    CARRY_ARRAY(carry, mechanism->peaks.peaks, 2 * stepper->system->contact_count);
    return true;
}

static StepRecord mechanism_record(const void *state)
{
    const Mechanism *mechanism = state;
    const System *system = mechanism->stepper->system;
    const size_t sums = system_sum_index(system, 0);
    const bool is_spatial = mechanism->stepper->scenario->linkage.is_spatial;
    const double *now = mechanism->y + sums;
    const double *then = mechanism->before + sums;
    return (StepRecord){
        .start_s = mechanism->start_s,
        .end_s = mechanism->end_s,
        .joint_s = mechanism->end_s,
        .is_smooth = true,
        .omega = mechanism->omega,
        .alpha = mechanism->alpha,
        .joints = mechanism->joints,
        .space_joints = is_spatial ? mechanism->space_joints : NULL,
        .peaks = mechanism->peaks.has_peaks ? mechanism->peaks.batch.peaks : NULL,
        .impulse = mechanism->impulse,
        .approach = mechanism->approach,
        .drive_work = now[SYSTEM_DRIVE_WORK] - then[SYSTEM_DRIVE_WORK],
        .load_work =
            system->has_loads ? now[system_load_sum(system)] - then[system_load_sum(system)] : 0.0,
        .dissipated = now[SYSTEM_DISSIPATED] - then[SYSTEM_DISSIPATED],
        .friction = now[SYSTEM_FRICTION] - then[SYSTEM_FRICTION],
        .elastic = mechanism->elastic,
    };
}

static void mechanism_observe(const void *state, double time_s, Sample *sample)
{
    const Mechanism *mechanism = state;
    const Linkage *linkage = &mechanism->stepper->scenario->linkage;
    const System *system = mechanism->stepper->system;
    SystemState *at = mechanism->seen;
    const double since_s = system->kind->since(system, time_s);
    // what is added up shows in no sample
    double *y = mechanism->observed;
    dop853_dense_motion(&mechanism->stepper->integrator, since_s, y);
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

// The bodies at the end of the record, whose state is there.
static void mechanism_observe_end(const void *state, Sample *sample)
{
    const Mechanism *mechanism = state;
    const System *system = mechanism->stepper->system;
    sample->time_s = mechanism->end_s;
    system->kind->bodies(system, mechanism->recorded, sample);
}

// In the plane: there a coordinate that turns is the angle of its body, and the impulse of a
// contact is added up from the size of its force.
static void mechanism_sketch(const void *state, double time_s, double *omega, double *alpha,
                             double *force)
{
    const Mechanism *mechanism = state;
    const System *system = mechanism->stepper->system;
    const Linkage *linkage = &mechanism->stepper->scenario->linkage;
    Dop853 *integrator = &mechanism->stepper->integrator;
    for (size_t i = 0; i < linkage->body_count; i++) {
        omega[i] = alpha[i] = NAN;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        force[i] = NAN;
    }
    if ((linkage->is_spatial && system->flat == NULL) || integrator->tried == 0.0) {
        return;
    }
    dop853_fill(integrator);
    const double share =
        (system->kind->since(system, time_s) - integrator->time) / integrator->tried;
    for (size_t i = 0; i < system->coordinate_count; i++) {
        const int body = system->coordinates[i].turning;
        if (body >= 0) {
            const size_t rate = system->coordinate_count + i;
            omega[body] = dop853_sketch(integrator, rate, share, &alpha[body]);
        }
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        force[system->contacts[i].joint] = 0.0;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        double own;
        dop853_sketch(integrator, system_sum_index(system, SYSTEM_IMPULSES + i), share, &own);
        force[system->contacts[i].joint] += own;
    }
}

static void mechanism_glance(const void *state, double time_s, Sample *sample)
{
    const Mechanism *mechanism = state;
    const System *system = mechanism->stepper->system;
    const double since_s = system->kind->since(system, time_s);
    if (system->kind->motions == NULL) {
        mechanism_observe(state, time_s, sample);
        return;
    }
    double *y = mechanism->observed;
    dop853_dense_motion(&mechanism->stepper->integrator, since_s, y);
    if (!system->kind->motions(system, since_s, y, sample)) {
        mechanism_observe(state, time_s, sample);
    }
}

// Events at the end of the last step are those of the next one's start.
static void mechanism_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Mechanism *mechanism = state;
    const Stepper *stepper = mechanism->stepper;
    const System *system = stepper->system;
    const SystemState *end = stepper->points.states[stepper->points.count - 1];
    system_give_contacts(system, mechanism->end_s, states);
    for (size_t i = 0; i < stepper->events.count; i++) {
        const Event *event = &stepper->events.events[i];
        if (event->is_bristle || event->is_drive) {
            continue;
        }
        const Contact *contact = &system->contacts[event->contact];
        ContactState *changed = &states[contact->joint][contact->place];
        if (event->mode == CONTACT_APART) {
            *changed = (ContactState){.is_touching = false};
        } else if (contact->mode == CONTACT_APART) {
            *changed = contact_state_begun(end->contacts[event->contact].closing);
        } else if (event->is_rest) {
            contact_state_rest(changed, contact->law.resting_speed);
        } else {
            changed->is_slack = event->mode == CONTACT_SLACK;
        }
    }
    for (size_t i = 0; i < system->bristle_count; i++) {
        const Bristle *bristle = &system->bristles[i];
        ContactState *changed = &states[bristle->joint][system_bristle_place(system, i)];
        const bool is_there =
            bristle->contact < 0 || (changed->is_touching && changed->age_s > 0.0);
        changed->bend = is_there ? mechanism->y[system_bristle_index(system, i)] : 0.0;
    }
    for (size_t i = 0; system->flat != NULL && i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        if (joint_has_hole(system->scenario->linkage.joints[contact->joint].kind)) {
            // both ends of a pin touch alike
            states[contact->joint][1] = states[contact->joint][0];
        }
    }
}

static SolverModel mechanism_model(const void *state)
{
    const Mechanism *mechanism = state;
    const Dop853 *integrator = &mechanism->stepper->integrator;
    const System *system = mechanism->stepper->system;
    SolverModel model = {
        .constraint_rows = system->kind->rows(system),
        .contact_rows = system->contact_count,
        .steps = integrator->accepted + integrator->rejected,
        .evaluations = integrator->evaluations,
    };
    reference_label(mechanism->stepper->scenario, system->coordinate_count, model.label);
    return model;
}

// How many coordinates the equations of a mechanism have.
static size_t mechanism_coordinates(const void *state)
{
    return ((const Mechanism *)state)->stepper->system->coordinate_count;
}

static const Solver MECHANISM_SOLVER = {
    .name = "reference",
    .open = mechanism_open,
    .step = mechanism_step,
    .stride = mechanism_stride,
    .record = mechanism_record,
    .observe = mechanism_observe,
    .observe_end = mechanism_observe_end,
    .sketch = mechanism_sketch,
    .glance = mechanism_glance,
    .contacts = mechanism_contacts,
    .carry = mechanism_carry,
    .model = mechanism_model,
    .close = mechanism_close,
};

// Mechanisms that share nothing but the ground move side by side.
//
// Each by itself (model/independent.h): an event of one ends no step of another.

// of a step
static const double MECHANISMS_ROUNDING_SHARE = 1e-9;

static bool open_each(const Scenario *scenario, void **state, Err *err)
{
    return independent_open(scenario, &MECHANISM_SOLVER, MECHANISMS_ROUNDING_SHARE, state, err);
}

static SolverModel model_of_all(const void *state)
{
    SolverModel model = independent_model(state);
    size_t coordinates = 0;
    for (size_t i = 0; i < independent_count(state); i++) {
        coordinates += mechanism_coordinates(independent_state(state, i));
    }
    reference_label(independent_scenario(state), coordinates, model.label);
    return model;
}

static const Solver MECHANISMS_SOLVER = {
    .name = "reference",
    .open = open_each,
    .stride = independent_stride,
    .sketch = independent_sketch,
    .glance = independent_glance,
    .model = model_of_all,
    INDEPENDENT_FUNCTIONS,
};

typedef struct Reference {
    const Solver *solver;
    void *state; // of it
} Reference;

static bool reference_open(const Scenario *scenario, void **state, Err *err)
{
    Reference *reference = zeroed(1, sizeof *reference);
    const Linkage *linkage = &scenario->linkage;
    const bool is_several = linkage->body_count > 0 && components_count(linkage) > 1;
    reference->solver = is_several ? &MECHANISMS_SOLVER : &MECHANISM_SOLVER;
    if (!reference->solver->open(scenario, &reference->state, err)) {
        free(reference);
        return false;
    }
    *state = reference;
    return true;
}

static bool reference_step(void *state, double stop_s, Err *err)
{
    Reference *reference = state;
    return reference->solver->step(reference->state, stop_s, err);
}

static bool reference_stride(void *state, double stop_s, double *end_s, Err *err)
{
    Reference *reference = state;
    return reference->solver->stride(reference->state, stop_s, end_s, err);
}

static StepRecord reference_record(const void *state)
{
    const Reference *reference = state;
    return reference->solver->record(reference->state);
}

static void reference_observe(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->observe(reference->state, time_s, sample);
}

static void reference_observe_end(const void *state, Sample *sample)
{
    const Reference *reference = state;
    if (reference->solver->observe_end != NULL) {
        reference->solver->observe_end(reference->state, sample);
        return;
    }
    const StepRecord record = reference->solver->record(reference->state);
    solver_look(reference->solver, reference->state, record.end_s, record.part, NULL, sample);
}

static void reference_observe_part(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->observe_part(reference->state, time_s, sample);
}

static void reference_sketch(const void *state, double time_s, double *omega, double *alpha,
                             double *force)
{
    const Reference *reference = state;
    reference->solver->sketch(reference->state, time_s, omega, alpha, force);
}

static void reference_glance(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->glance(reference->state, time_s, sample);
}

static void reference_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Reference *reference = state;
    reference->solver->contacts(reference->state, states);
}

static bool reference_carry(void *state, Carry *carry)
{
    Reference *reference = state;
    return reference->solver->carry(reference->state, carry);
}

static SolverModel reference_model(const void *state)
{
    const Reference *reference = state;
    return reference->solver->model(reference->state);
}

static void reference_close(void *state)
{
    Reference *reference = state;
    if (reference != NULL) {
        reference->solver->close(reference->state);
        free(reference);
    }
}

const Solver REFERENCE_SOLVER = {
    .name = "reference",
    .open = reference_open,
    .step = reference_step,
    .stride = reference_stride,
    .record = reference_record,
    .observe = reference_observe,
    .observe_end = reference_observe_end,
    .observe_part = reference_observe_part,
    .sketch = reference_sketch,
    .glance = reference_glance,
    .contacts = reference_contacts,
    .carry = reference_carry,
    .model = reference_model,
    .close = reference_close,
};
