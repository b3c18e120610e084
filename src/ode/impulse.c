// Steps a linkage in ODE with contacts integrated within the step, in the plane or in space, and
// hands each step on in parts (ode/impulse_part.c, ode/impulse_islands.c).
//
// Mechanisms that share nothing but the ground are stepped side by side (model/independent.h), each
// in a world of its own: a contact of one shortens no step of another, and nothing is solved for
// all of them together. Memory is read into the cache once for all steps up to the time that is
// asked for: a thousand mechanisms do not fit into it.
#include "ode/impulse.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "model/independent.h"
#include "model/loads.h"
#include "ode/stepping.h"

#include <math.h>
#include <stdlib.h>

static size_t *make_numbers(size_t count)
{
    size_t *numbers = zeroed(count, sizeof *numbers);
    for (size_t i = 0; i < count; i++) {
        numbers[i] = i;
    }
    return numbers;
}

ImpulseScope impulse_scope_whole(const Linkage *linkage, size_t place_count)
{
    return (ImpulseScope){
        .is_whole = true,
        .has_drive = linkage->driver.is_present,
        .body_count = linkage->body_count,
        .bodies = make_numbers(linkage->body_count),
        .joint_count = linkage->joint_count,
        .joints = make_numbers(linkage->joint_count),
        .place_count = place_count,
        .part.place_count = place_count,
        .part.places = make_numbers(place_count),
    };
}

void impulse_scope_finish(ImpulseScope *scope)
{
    free(scope->bodies);
    free(scope->joints);
    free(scope->part.groups);
    free(scope->part.places);
    *scope = (ImpulseScope){.body_count = 0};
}

ImpulseTicks impulse_ticks(const Scenario *scenario)
{
    return (ImpulseTicks){.tick_s = scenario->run.step / (double)scenario->ode.gear};
}

void impulse_set_end(const Scenario *scenario, bool is_fine, ImpulseTicks *ticks, KernelStep *step)
{
    const double rounding_s = STEPPING_ROUNDING * ticks->tick_s;
    const Linkage *linkage = &scenario->linkage;
    const double kink_s =
        fmin(linkage_next_kink(linkage, step->start_s), loads_next_jump(linkage, step->start_s));
    ticks->tick += is_fine ? 1 : scenario->ode.gear;
    step->end_s =
        stepping_end(scenario, step->start_s, (double)ticks->tick * ticks->tick_s, ticks->tick_s);
    step->is_kink = kink_s < step->end_s + rounding_s;
    if (step->is_kink) {
        step->end_s = kink_s;
        ticks->tick = (size_t)floor((kink_s + rounding_s) / ticks->tick_s);
    }
}

bool impulse_take_scheme(const Scenario *scenario, KernelStep *step, Err *err)
{
    const KernelStepEnd end = kernel_step_take(step);
    if (end == KERNEL_STEP_TAKEN) {
        return true;
    }
    if (end == KERNEL_STEP_TOO_LONG) {
        err_set(err, ERR_SOLVER,
                "contact sub-stepping exceeded 100000 steps in one step; reduce run.step");
    }
    return stepping_fail(scenario, step->start_s, step->count + 1, step->width_s, err);
}

void impulse_carry_scheme(KernelStep *step, ImpulseTicks *ticks, Carry *carry)
{
    if (step->islands != NULL) {
        kernel_islands_carry(step->islands, carry);
    } else {
        kernel_carry(&step->kernel, carry);
    }
    CARRY(carry, ticks->tick);
    kernel_step_carry(step, carry);
}

KernelPose impulse_scope_pose(const Kernel *kernel, const KernelIslands *islands, size_t place,
                              ImpulseTime at, const KernelSums *sums)
{
    return islands != NULL ? kernel_islands_pose(islands, place, at.since_s, sums)
                           : kernel_pose(kernel, place, at.node, at.since_s, sums);
}

typedef struct Impulse {
    const ImpulseKind *kind;
    void *own; // of the kind; owned
    ImpulseView view;
    ImpulseSpan span;        // of the last step
    size_t count;            // of steps
    ImpulsePart part;        // of the last step, the one that is handed on
    ImpulseIslands *islands; // where the kernel has them; owned
    KernelSums sums;         // at the time that is asked for
} Impulse;

void impulse_close(void *state)
{
    Impulse *impulse = state;
    if (impulse != NULL) {
        impulse_part_finish(&impulse->part);
        impulse_islands_destroy(impulse->islands);
        kernel_sums_free(&impulse->sums);
        impulse->kind->close(impulse->own);
        free(impulse);
    }
}

bool impulse_open(const ImpulseKind *kind, const Scenario *scenario, void **state, Err *err)
{
    Impulse *impulse = zeroed(1, sizeof *impulse);
    impulse->kind = kind;
    if (!kind->open(scenario, &impulse->own, &impulse->view, err)) {
        impulse_close(impulse);
        return false;
    }
    const size_t rows = kernel_rows(impulse->view.kernel);
    impulse_part_init(&impulse->part, &scenario->linkage, rows);
    impulse->sums = kernel_sums(rows);
    if (impulse->view.islands != NULL) {
        impulse->islands = impulse_islands_create(&impulse->view, kind, impulse->own);
    }
    *state = impulse;
    return true;
}

// Fails where a pin is deeper in its wall than its contact law holds.
static bool check_depths(const Impulse *impulse, Err *err)
{
    const ImpulseView *view = &impulse->view;
    const ImpulseScope *scope =
        impulse->islands != NULL ? impulse_islands_scope(impulse->islands) : view->whole;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const KernelContact *place = &view->kernel->contacts[i];
        const Joint *joint = &view->scenario->linkage.joints[place->joint];
        if (!law_check_depth(&place->law, joint, view->depths[i], 1.0, err)) {
            return false;
        }
    }
    return true;
}

// Hands on the part of the step up to its next mark.
static void take_part(Impulse *impulse)
{
    const ImpulseView *view = &impulse->view;
    const ImpulseSpan *span = &impulse->span;
    ImpulsePart *part = &impulse->part;
    const Mark *mark = impulse_part_next(part, view->kernel, span->start_s, span->end_s);
    const ImpulseTime at = {mark->time_s, mark->node, !part->is_last};
    impulse->kind->look(impulse->own, view->whole, at, &part->sums, part->omega, part->alpha);
    impulse_part_record(part, &view->scenario->linkage, view->joints);
    part->record.space_joints = view->space_joints;
    impulse_part_add_contacts(part, view->kernel, mark, view->depths, view->counts);
    part->record.drive_work = part->is_last ? span->drive_work : 0.0;
    part->record.load_work = part->is_last ? span->load_work : 0.0;
    part->record.dissipated += part->is_last ? span->damped : 0.0;
    part->record.friction += part->is_last ? span->rubbed : 0.0;
}

// Takes the next step and begins to hand it on.
static bool begin_step_of(Impulse *impulse, Err *err)
{
    if (!impulse->kind->take(impulse->own, &impulse->span, err)) {
        return false;
    }
    impulse->count++;
    if (impulse->islands != NULL) {
        impulse_islands_begin(impulse->islands, &impulse->span, &impulse->part);
    } else {
        impulse_part_begin(&impulse->part, impulse->view.kernel, impulse->span.start_s);
    }
    return true;
}

// Whether the last step has been handed on to its end.
static bool needs_step(const Impulse *impulse)
{
    return impulse->islands != NULL ? impulse_islands_need_step(impulse->islands)
                                    : impulse_part_needs_step(&impulse->part);
}

bool impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Impulse *impulse = state;
    if (needs_step(impulse) && !begin_step_of(impulse, err)) {
        return false;
    }
    if (impulse->islands != NULL) {
        impulse_islands_next(impulse->islands, &impulse->part);
    } else {
        take_part(impulse);
    }
    return check_depths(impulse, err) || stepping_fail(impulse->view.scenario, impulse->part.end_s,
                                                       impulse->count, impulse->span.width_s, err);
}

StepRecord impulse_record(const void *state)
{
    const Impulse *impulse = state;
    return impulse->part.record;
}

void impulse_observe(const void *state, double time_s, Sample *sample)
{
    const Impulse *impulse = state;
    const ImpulseView *view = &impulse->view;
    KernelSums sums = impulse->sums; // which owns the arrays
    const double since_s = fmin(fmax(time_s - impulse->span.start_s, 0.0), impulse->span.width_s);
    ImpulseTime at = {since_s, 0, true};
    if (view->islands != NULL) {
        kernel_islands_look(view->islands, since_s, &sums);
    } else {
        at.node = kernel_node(view->kernel, since_s);
        kernel_at(view->kernel, at.node, since_s, &sums);
    }
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&view->scenario->linkage, time_s);
    impulse->kind->observe(impulse->own, at, &sums, sample);
}

void impulse_observe_some(const void *state, double time_s, const SolverSome *some, Sample *sample)
{
    const Impulse *impulse = state;
    const double since_s = fmin(fmax(time_s - impulse->span.start_s, 0.0), impulse->span.width_s);
    sample->time_s = time_s;
    if (impulse->islands == NULL ||
        !impulse_islands_observe(impulse->islands, since_s, some, sample)) {
        impulse_observe(state, time_s, sample);
    }
}

void impulse_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Impulse *impulse = state;
    const Kernel *kernel = impulse->view.kernel;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const int place = impulse->kind->place(impulse->own, i);
        const int joint = kernel->contacts[i].joint;
        if (kernel->contacts[i].is_rub) {
            states[joint][place].bend = kernel->contacts[i].state.bend;
            states[joint][place].bristle = kernel->contacts[i].state.bristle;
            continue;
        }
        states[joint][place] = kernel->contacts[i].state;
        if (impulse->view.is_flat &&
            joint_has_hole(impulse->view.scenario->linkage.joints[joint].kind)) {
            states[joint][1] = states[joint][0];
        }
    }
}

bool impulse_carry(void *state, Carry *carry)
{
    Impulse *impulse = state;
    if (!carry->is_back && !needs_step(impulse)) {
        return false;
    }
    impulse->kind->carry(impulse->own, carry);
    CARRY(carry, impulse->count);
    CARRY(carry, impulse->part.most_rows);
    CARRY_ARRAY(carry, impulse->part.approach, impulse->view.scenario->linkage.joint_count);
    return true;
}

SolverModel impulse_model(const void *state)
{
    const Impulse *impulse = state;
    const ImpulseView *view = &impulse->view;
    SolverModel model = {
        .step_s = view->scenario->run.step,
        .constraint_rows = view->constraint_rows,
        .contact_rows = impulse->part.most_rows,
        .steps = impulse->count,
        .evaluations = view->kernel->evaluations,
    };
    stepping_label(view->scenario, "staggered", "impulse", model.label);
    return model;
}

static dWorldID world_of(const void *state)
{
    const Impulse *impulse = state;
    return impulse->view.world;
}

bool impulse_parts_open(const Scenario *scenario, const Solver *solver, void **state, Err *err)
{
    if (!independent_open(scenario, solver, STEPPING_ROUNDING, state, err)) {
        return false;
    }
    // they are stepped one after the other: one working memory will do
    for (size_t i = 1; i < independent_count(*state); i++) {
        const dWorldID own = world_of(independent_state(*state, i));
        dWorldUseSharedWorkingMemory(own, NULL); // its own, yet empty
        dWorldUseSharedWorkingMemory(own, world_of(independent_state(*state, 0)));
    }
    return true;
}
