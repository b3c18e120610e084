// Steps a linkage in ODE: a solver.
//
// Hands on to the way of stepping that the scenario asks for; each is a solver of its own.
#include "model/independent.h"
#include "model/joint_friction.h"
#include "model/solver.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>

typedef struct Ode {
    const Solver *stepping;
    void *state; // of it
} Ode;

#define IN_PLANE_MEMBER(id, word, plane, space, ...) &plane,
#define IN_SPACE_MEMBER(id, word, plane, space, ...) space,

static const Solver *choose(const Scenario *scenario)
{
    static const Solver *const IN_PLANE[] = {OPTIONS_ODE_STEPPING_LIST(IN_PLANE_MEMBER)};
    static const Solver *const IN_SPACE[] = {OPTIONS_ODE_STEPPING_LIST(IN_SPACE_MEMBER)};
    const bool is_spatial = scenario->linkage.is_spatial;
    if (scenario_integrates_contacts(scenario)) {
        const Linkage *linkage = &scenario->linkage;
        const bool has_parts = linkage->body_count > 0 && components_count(linkage) > 1;
        return is_spatial ? (has_parts ? &SPACE_IMPULSE_PARTS : &SPACE_IMPULSE)
                          : (has_parts ? &STEPPING_IMPULSE_PARTS : &STEPPING_IMPULSE);
    }
    return is_spatial ? IN_SPACE[scenario->ode.stepping] : IN_PLANE[scenario->ode.stepping];
}

// Whether the friction of a joint is known where the case is stepped so: in the plane all but
// LuGre's where contacts are integrated within the step, and otherwise regularized friction of
// joints with play, and that of ideal pivots where they have rows.
static bool knows_friction(const Scenario *scenario, const Joint *joint)
{
    const OdeOptions *ode = &scenario->ode;
    const bool is_spatial = scenario->linkage.is_spatial;
    const bool is_ideal = joint_is_ideal(joint->kind);
    if (joint->friction.law == BRISTLE_REGULARIZED && (!is_ideal || !joint_friction_is(joint))) {
        return true;
    }
    if (is_ideal && !joint_friction_is(joint)) {
        return true;
    }
    if (is_spatial || joint->friction.law == BRISTLE_LUGRE) {
        return false;
    }
    return scenario_integrates_contacts(scenario) ||
           (is_ideal && joint_pivots(joint->kind) && ode->solver == ODE_DIRECT &&
            (ode->stepping == ODE_PLAIN || ode->stepping == ODE_STAGGERED));
}

static bool check_friction(const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!knows_friction(scenario, joint)) {
            return err_set(
                err, ERR_CASE,
                "ODE does not know the friction of joint %s: in the plane it has all but "
                "LuGre's with stepping staggered and map impulse; with other maps that "
                "of ideal pivots, with solver direct and stepping plain or staggered, "
                "and no stick of joints with play",
                joint->name);
        }
    }
    return true;
}

static bool ode_open(const Scenario *scenario, void **state, Err *err)
{
    if (!check_friction(scenario, err)) {
        return false;
    }
    // measure/chosen_run.c finds one
    assert(scenario->run.step > 0.0);
    Ode *ode = calloc(1, sizeof *ode);
    assert(ode != NULL);
    ode->stepping = choose(scenario);
    if (ode->stepping == NULL) {
        free(ode);
        return err_set(err, ERR_CASE, "ode.stepping %s is for linkages in the plane; use staggered",
                       OPTIONS_ODE_STEPPINGS[scenario->ode.stepping]);
    }
    if (!ode->stepping->open(scenario, &ode->state, err)) {
        free(ode);
        return false;
    }
    *state = ode;
    return true;
}

static bool ode_step(void *state, double stop_s, Err *err)
{
    Ode *ode = state;
    return ode->stepping->step(ode->state, stop_s, err);
}

static StepRecord ode_record(const void *state)
{
    const Ode *ode = state;
    return ode->stepping->record(ode->state);
}

static void ode_observe(const void *state, double time_s, Sample *sample)
{
    const Ode *ode = state;
    ode->stepping->observe(ode->state, time_s, sample);
}

static void ode_observe_part(const void *state, double time_s, Sample *sample)
{
    const Ode *ode = state;
    ode->stepping->observe_part(ode->state, time_s, sample);
}

static void ode_observe_some(const void *state, double time_s, const SolverSome *some,
                             Sample *sample)
{
    const Ode *ode = state;
    ode->stepping->observe_some(ode->state, time_s, some, sample);
}

static void ode_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Ode *ode = state;
    if (ode->stepping->contacts != NULL) { // of ideal joints alone there are none
        ode->stepping->contacts(ode->state, states);
    }
}

static bool ode_carry(void *state, Carry *carry)
{
    Ode *ode = state;
    return ode->stepping->carry(ode->state, carry);
}

static SolverModel ode_model(const void *state)
{
    const Ode *ode = state;
    return ode->stepping->model(ode->state);
}

static void ode_close(void *state)
{
    Ode *ode = state;
    if (ode != NULL) {
        ode->stepping->close(ode->state);
        free(ode);
    }
}

const Solver ODE_SOLVER = {
    .name = "ode",
    .open = ode_open,
    .step = ode_step,
    .record = ode_record,
    .observe = ode_observe,
    .observe_part = ode_observe_part,
    .observe_some = ode_observe_some,
    .contacts = ode_contacts,
    .carry = ode_carry,
    .model = ode_model,
    .close = ode_close,
};
