// What can be had at a step that cannot be changed?
//
// Every scheme is run once at the step. Constants, one kp and kd or one ERP and CFM for all depths,
// are those that are best for a lone impact (held.h): for the median mass and closing speed of the
// reference's contacts, as `map` has them, and for the hardest impact. What they are worth in the
// whole mechanism is not derived but run.
#include "commands/tune/tune_held.h"

#include "measure/mapping_joint.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

static void apply_scheme(void *owner, size_t number, Scenario *scenario)
{
    const Tune *tune = owner;
    tune_apply(&tune->schemes[number], tune->held_s, scenario);
}

static void take_scheme(void *tune, size_t number, const LadderRun *run)
{
    tune_take_held(tune, number, run);
}

bool tune_held_run(const TuneSearch *search, Err *err)
{
    const TuneRuns runs = {"running all schemes at the step", search->tune->scheme_count,
                           apply_scheme, take_scheme, .owner = search->tune};
    return tune_runs_make(search, &runs, err);
}

static void watch_run(double share, double wall_s, void *context)
{
    (void)share;
    (void)wall_s;
    const TuneSearch *search = context;
    search->wait("measuring the contacts", INFINITY, search->context);
}

static void add_settings(Tune *tune, TuneLinearSource source, const Held *held)
{
    for (size_t i = 0; i < HELD_MAP_COUNT; i++) {
        const HeldSetting *setting = &held->settings[i];
        if (setting->map == ODE_MAP_MIDPOINT) {
            continue; // its row follows the closing speed: no constants
        }
        assert(tune->linear_count < TUNE_LINEAR_MAX);
        tune->linears[tune->linear_count++] = (TuneLinear){
            .source = source,
            .is_row = setting->map == ODE_MAP_CORRECTED,
            .row = setting->row,
            .depth = NAN,
            .stiffness = setting->stiffness,
            .damping = setting->damping,
            .step_s = held->step_s,
        };
    }
}

static void add_impact(const TuneSearch *search, const MappingJoint *joint, double mass,
                       double speed, TuneLinearSource source)
{
    Err ignored = {ERR_NONE, ""}; // a law need not have such an impact
    MappingContact *contact = malloc(sizeof *contact);
    Held *held = malloc(sizeof *held);
    assert(contact != NULL && held != NULL);
    const double closing = fmax(speed, search->scenario->contact.impact_speed_floor);
    if (mass > 0.0 && closing > 0.0 &&
        mapping_contact_make(search->scenario, joint, mass, closing, contact, &ignored)) {
        search->wait("finding constants for the step", INFINITY, search->context);
        held_find(contact, search->tune->held_s, held);
        add_settings(search->tune, source, held);
    }
    free(held);
    free(contact);
}

bool tune_held_constants(const TuneSearch *search, Err *err)
{
    const TuneContact *contact = &search->tune->contact;
    MappingJoint *joints = NULL;
    size_t count = 0;
    const RunWatch watch = {watch_run, (void *)search};
    if (!mapping_joint_measure(search->scenario, watch, &joints, &count, err)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const MappingJoint *joint = &joints[i];
        if (joint->joint == (int)contact->joint) {
            add_impact(search, joint, joint->mass_median, joint->speed_median, TUNE_LINEAR_MEDIAN);
            add_impact(search, joint, contact->mass, contact->speed, TUNE_LINEAR_HARDEST);
        }
    }
    free(joints);
    return true;
}
