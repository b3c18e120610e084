// How does the linkage move in ODE if its contacts are integrated within the step? (The steps
// themselves: ode/impulse_step.c.)
//
// A step is handed on in parts that end where a contact begins, ends, or shows a maximum, so that
// no peak is missed whatever the step.
#include "contact/law.h"
#include "ode/impulse_step.h"
#include "ode/marks.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef struct Impulse {
    ImpulseStep step;
    Marks marks; // of it
    size_t most_rows;

    // the part of the step that is handed on
    double part_start_s;
    double part_end_s;
    EncounterSums sums; // at its end
    double omega[LINKAGE_BODY_MAX];
    double alpha[LINKAGE_BODY_MAX];
    JointState joints[LINKAGE_JOINT_MAX];
    double impulse[LINKAGE_JOINT_MAX];
    double approach[LINKAGE_JOINT_MAX];
    StepRecord record;
} Impulse;

static void impulse_close(void *state)
{
    Impulse *impulse = state;
    if (impulse != NULL) {
        marks_finish(&impulse->marks);
        impulse_step_finish(&impulse->step);
        free(impulse);
    }
}

static bool impulse_open(const Scenario *scenario, void **state, Err *err)
{
    Impulse *impulse = calloc(1, sizeof *impulse);
    assert(impulse != NULL);
    if (impulse_step_init(scenario, &impulse->step, err)) {
        *state = impulse;
        return true;
    }
    impulse_close(impulse);
    return false;
}

static bool check_depths(const Impulse *impulse, Err *err)
{
    const Encounter *encounter = &impulse->step.encounter;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const int joint = encounter->joints[i].joint;
        if (!law_check_depth(&encounter->joints[i].law,
                             &impulse->step.scenario->linkage.joints[joint],
                             -impulse->joints[joint].gap, 1.0, err)) {
            return false;
        }
    }
    return true;
}

// Hands on the part of the step up to its next mark.
static void take_part(Impulse *impulse, const Mark *mark, const EncounterSums *before)
{
    const Encounter *encounter = &impulse->step.encounter;
    Motion motions[LINKAGE_BODY_MAX];
    StepRecord *record = &impulse->record;
    const bool is_peak = impulse->marks.next < impulse->marks.count;
    impulse_step_inside(&impulse->step, mark->node, mark->time_s, is_peak, &impulse->sums, motions,
                        impulse->joints);
    *record = (StepRecord){
        .start_s = impulse->part_start_s,
        .end_s = impulse->part_end_s,
        .joint_s = impulse->part_end_s,
        .omega = impulse->omega,
        .alpha = impulse->alpha,
        .joints = impulse->joints,
        .impulse = impulse->impulse,
        .approach = impulse->approach,
        .dissipated = impulse->sums.dissipated - before->dissipated,
        .friction = impulse->sums.friction - before->friction,
    };
    for (size_t i = 0; i < impulse->step.scenario->linkage.body_count; i++) {
        impulse->omega[i] = motions[i].omega;
        impulse->alpha[i] = motions[i].alpha;
    }
    for (size_t i = 0; i < impulse->step.scenario->linkage.joint_count; i++) {
        impulse->impulse[i] =
            impulse->joints[i].force * (impulse->part_end_s - impulse->part_start_s);
    }
    size_t touching = 0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        const size_t row = joint->first_row;
        impulse->impulse[joint->joint] =
            hypot(impulse->sums.impulse[row] - before->impulse[row],
                  impulse->sums.impulse[row + 1] - before->impulse[row + 1]);
        impulse->approach[joint->joint] = joint->impact_speed;
        if (impulse->joints[joint->joint].is_touching) {
            record->elastic += force_law_energy(&joint->law, -impulse->joints[joint->joint].gap);
            touching++;
        }
    }
    impulse->most_rows = touching > impulse->most_rows ? touching : impulse->most_rows;
}

static bool impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Impulse *impulse = state;
    Marks *marks = &impulse->marks;
    EncounterSums before = impulse->sums;
    if (marks->next == marks->count) {
        if (!impulse_step_take(&impulse->step, err)) {
            return false;
        }
        marks_find(marks, &impulse->step.encounter);
        memset(&before, 0, sizeof before);
        impulse->part_end_s = impulse->step.start_s;
    }
    const Mark *mark = &marks->marks[marks->next++];
    const bool is_last = marks->next == marks->count;
    impulse->part_start_s = impulse->part_end_s;
    impulse->part_end_s = is_last ? impulse->step.end_s : impulse->step.start_s + mark->time_s;
    encounter_at(&impulse->step.encounter, mark->node, mark->time_s, &impulse->sums);
    take_part(impulse, mark, &before);
    impulse->record.drive_work = is_last ? impulse->step.drive_work : 0.0;
    impulse->record.dissipated += is_last ? impulse->step.damped : 0.0;
    return check_depths(impulse, err) ||
           stepping_fail(impulse->step.scenario, impulse->part_end_s, impulse->step.count,
                         impulse->step.width_s, err);
}

static StepRecord impulse_record(const void *state)
{
    const Impulse *impulse = state;
    return impulse->record;
}

static void impulse_observe(const void *state, double time_s, Sample *sample)
{
    const Impulse *impulse = state;
    const Linkage *linkage = &impulse->step.scenario->linkage;
    const double since_s = fmin(fmax(time_s - impulse->step.start_s, 0.0), impulse->step.width_s);
    const size_t node = encounter_node(&impulse->step.encounter, since_s);
    EncounterSums sums;
    encounter_at(&impulse->step.encounter, node, since_s, &sums);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    impulse_step_inside(&impulse->step, node, since_s, true, &sums, sample->bodies, sample->joints);
}

static SolverModel impulse_model(const void *state)
{
    const Impulse *impulse = state;
    SolverModel model = {
        .step_s = impulse->step.scenario->run.step,
        .constraint_rows = impulse->step.world.constraint_rows,
        .contact_rows = impulse->most_rows,
        .steps = impulse->step.count,
        .evaluations = impulse->step.encounter.evaluations,
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
    .model = impulse_model,
    .close = impulse_close,
};
