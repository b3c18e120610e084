// How does the linkage move in ODE if its contacts are integrated within the step? (The steps
// themselves: ode/plane/impulse_step.c.)
//
// A step is handed on in parts (ode/impulse_part.c).
#include "base/zeroed.h"
#include "contact/law.h"
#include "ode/impulse_islands.h"
#include "ode/impulse_parts.h"
#include "ode/plane/impulse_step.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>

typedef struct Impulse {
    ImpulseStep step;
    ImpulsePart part;        // of it, the one that is handed on
    ImpulseIslands *islands; // where the step has them; owned
    Motion *motions;         // by body; owned, as the next two
    JointState *joints;
    double *depths;  // m, by place
    KernelSums sums; // at the time that is asked for
} Impulse;

static void impulse_close(void *state)
{
    Impulse *impulse = state;
    if (impulse != NULL) {
        impulse_part_finish(&impulse->part);
        impulse_islands_destroy(impulse->islands);
        impulse_step_finish(&impulse->step);
        free(impulse->motions);
        free(impulse->joints);
        free(impulse->depths);
        kernel_sums_free(&impulse->sums);
        free(impulse);
    }
}

static ImpulseSpan span_of(const void *context)
{
    const Impulse *impulse = context;
    const ImpulseStep *step = &impulse->step;
    return (ImpulseSpan){step->start_s, step->end_s, step->width_s, step->drive_work, step->damped};
}

static double mean_of(const void *context, size_t joint)
{
    const Impulse *impulse = context;
    return impulse->step.mean[joint].force;
}

// Looks at a scope of the step, and tells how its bodies turn.
static void look_at_impulse(void *context, const ImpulseScope *scope, ImpulseTime at,
                            const KernelSums *sums)
{
    Impulse *impulse = context;
    impulse_step_inside(&impulse->step, scope, at, sums, impulse->motions, impulse->joints,
                        impulse->depths);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        impulse->part.omega[i] = impulse->motions[i].omega;
        impulse->part.alpha[i] = impulse->motions[i].alpha;
    }
}

static ImpulseIslands *open_islands(Impulse *impulse)
{
    const ImpulseStep *step = &impulse->step;
    return impulse_islands_create(&(ImpulseIslandsOf){
        .linkage = &step->scenario->linkage,
        .islands = step->islands,
        .groups = &step->groups,
        .whole = &step->whole,
        .depths = impulse->depths,
        .joints = impulse->joints,
        .context = impulse,
        .span = span_of,
        .inside = look_at_impulse,
        .mean = mean_of,
    });
}

static bool impulse_open(const Scenario *scenario, void **state, Err *err)
{
    Impulse *impulse = calloc(1, sizeof *impulse);
    assert(impulse != NULL);
    if (impulse_step_init(scenario, &impulse->step, err)) {
        const Linkage *linkage = &scenario->linkage;
        const size_t rows = kernel_rows(&impulse->step.kernel);
        impulse_part_init(&impulse->part, linkage, rows);
        impulse->sums = kernel_sums(rows);
        impulse->motions = zeroed(linkage->body_count, sizeof *impulse->motions);
        impulse->joints = zeroed(linkage->joint_count, sizeof *impulse->joints);
        impulse->depths = zeroed(impulse->step.place_count, sizeof *impulse->depths);
        if (impulse->step.islands != NULL) {
            impulse->islands = open_islands(impulse);
        }
        *state = impulse;
        return true;
    }
    impulse_close(impulse);
    return false;
}

static bool check_depths(const Impulse *impulse, Err *err)
{
    const ImpulseStep *step = &impulse->step;
    const ImpulseScope *scope =
        impulse->islands != NULL ? impulse_islands_scope(impulse->islands) : &step->whole;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const Joint *joint = &step->scenario->linkage.joints[step->places[i].joint];
        if (!law_check_depth(&step->places[i].law, joint, impulse->depths[i], 1.0, err)) {
            return false;
        }
    }
    return true;
}

// Hands on the part of the step up to its next mark.
static void take_part(Impulse *impulse)
{
    const ImpulseStep *step = &impulse->step;
    ImpulsePart *part = &impulse->part;
    const Mark *mark = impulse_part_next(part, &step->kernel, step->start_s, step->end_s);
    const ImpulseTime at = {mark->time_s, mark->node, !part->is_last};
    look_at_impulse(impulse, &step->whole, at, &part->sums);
    impulse_part_record(part, &step->scenario->linkage, impulse->joints);
    impulse_part_add_contacts(part, &step->kernel, mark, impulse->depths, NULL);
    part->record.drive_work = part->is_last ? step->drive_work : 0.0;
    part->record.dissipated += part->is_last ? step->damped : 0.0;
}

// Takes the next step and begins to hand it on.
static bool begin_step_of(Impulse *impulse, Err *err)
{
    if (!impulse_step_take(&impulse->step, err)) {
        return false;
    }
    if (impulse->islands != NULL) {
        impulse_islands_begin(impulse->islands, &impulse->part);
    } else {
        impulse_part_begin(&impulse->part, &impulse->step.kernel, impulse->step.start_s);
    }
    return true;
}

static bool impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Impulse *impulse = state;
    const ImpulseStep *step = &impulse->step;
    const bool needs_step = impulse->islands != NULL ? impulse_islands_need_step(impulse->islands)
                                                     : impulse_part_needs_step(&impulse->part);
    if (needs_step && !begin_step_of(impulse, err)) {
        return false;
    }
    if (impulse->islands != NULL) {
        impulse_islands_next(impulse->islands, &impulse->part);
    } else {
        take_part(impulse);
    }
    return check_depths(impulse, err) ||
           stepping_fail(step->scenario, impulse->part.end_s, step->count, step->width_s, err);
}

dWorldID impulse_world(const void *state)
{
    const Impulse *impulse = state;
    return impulse->step.world.id;
}

static StepRecord impulse_record(const void *state)
{
    const Impulse *impulse = state;
    return impulse->part.record;
}

static void impulse_observe(const void *state, double time_s, Sample *sample)
{
    const Impulse *impulse = state;
    KernelSums sums = impulse->sums; // which owns the arrays
    const Linkage *linkage = &impulse->step.scenario->linkage;
    const double since_s = fmin(fmax(time_s - impulse->step.start_s, 0.0), impulse->step.width_s);
    ImpulseTime at = {since_s, 0, true};
    if (impulse->islands != NULL) {
        kernel_islands_look(impulse->step.islands, since_s, &sums);
    } else {
        at.node = kernel_node(&impulse->step.kernel, since_s);
        kernel_at(&impulse->step.kernel, at.node, since_s, &sums);
    }
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    impulse_step_inside(&impulse->step, &impulse->step.whole, at, &sums, sample->bodies,
                        sample->joints, impulse->depths);
}

static void impulse_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const ImpulseStep *step = &((const Impulse *)state)->step;
    for (size_t i = 0; i < step->place_count; i++) {
        const Touch *place = &step->places[i];
        states[place->joint][place->place] = step->kernel.contacts[i].state;
    }
}

static SolverModel impulse_model(const void *state)
{
    const Impulse *impulse = state;
    SolverModel model = {
        .step_s = impulse->step.scenario->run.step,
        .constraint_rows = impulse->step.world.constraint_rows,
        .contact_rows = impulse->part.most_rows,
        .steps = impulse->step.count,
        .evaluations = impulse->step.kernel.evaluations,
    };
    stepping_label(impulse->step.scenario, "staggered", "impulse", model.label);
    return model;
}

const Solver STEPPING_IMPULSE = {
    .name = "impulse",
    .open = impulse_open,
    .step = impulse_step,
    .record = impulse_record,
    .observe = impulse_observe,
    .contacts = impulse_contacts,
    .model = impulse_model,
    .close = impulse_close,
};
