// Does the motion get on, or do steps and events pile up at one instant?
//
// Bounces of a pin follow one another ever faster, down to heights of rounding: some hundred of
// them at the end of 1e-8 s. A contact that is stiff or strongly damped needs steps of a share of
// its own time; of a usual one that is some ten thousand steps a turn. Both end by themselves.
#include "reference/pace.h"

#include "model/forces.h"

#include <math.h>

// of a turn of the drive, or of a run without one
static const double INSTANT = 1e-12;
static const double STEP_LEAST = 5e-8; // twenty million steps a turn: minutes each

enum { EVENTS_MOST = 1000, STEPS_COUNTED = 50000 };

static double turn_of(const System *system)
{
    const Scenario *scenario = system->scenario;
    return drive_is_steady(&scenario->linkage.driver) ? linkage_period(&scenario->linkage)
                                                      : scenario_duration(scenario);
}

static const char *joint_name(const System *system, size_t contact)
{
    return system->scenario->linkage.joints[system->contacts[contact].joint].name;
}

static bool refuse_steps(const Pace *pace, const System *system, double time_s, Err *err)
{
    const double width_s = time_s - pace->since_s;
    for (size_t i = 0; i < system->contact_count; i++) {
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            return err_set(
                err, ERR_SOLVER,
                "%d steps advanced the motion by only %.3g s: the contact of %s is too stiff "
                "or too strongly damped; use a higher restitution, another damping or a "
                "lower stiffness",
                STEPS_COUNTED, width_s, joint_name(system, i));
        }
    }
    return err_set(
        err, ERR_SOLVER, "%d steps advanced the motion by only %.3g s%s", STEPS_COUNTED, width_s,
        forces_any(&system->scenario->linkage) ? ": a spring or a damper is too strong; lower it"
                                               : "");
}

bool pace_keep(Pace *pace, const System *system, const EventList *events, double time_s, Err *err)
{
    const double turn_s = turn_of(system);
    if (time_s - pace->instant_s > INSTANT * turn_s) {
        pace->instant_s = time_s;
        pace->events = 0;
    }
    pace->events += events->count;
    if (pace->events > EVENTS_MOST * system->contact_count) {
        return err_set(err, ERR_SOLVER,
                       "the contact of %s keeps beginning and ending: %zu changes within %.3g s",
                       joint_name(system, events->events[0].contact), pace->events,
                       time_s - pace->instant_s);
    }
    pace->steps++;
    if (pace->steps == STEPS_COUNTED) {
        if (time_s - pace->since_s < STEP_LEAST * STEPS_COUNTED * turn_s) {
            return refuse_steps(pace, system, time_s, err);
        }
        pace->steps = 0;
        pace->since_s = time_s;
    }
    return true;
}

bool pace_astray(Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the energy is not kept where the ideal joints pass a change point, at which "
                   "they do not determine how the motion continues; give one of them play, or a "
                   "looser reference.tolerance");
}

bool pace_torn(const System *system, Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the ideal joint %s cannot be kept closed: the loop that it closes is locked; "
                   "give one of its joints play, or let its lengths and axes fit",
                   system->scenario->linkage.joints[system->torn].name);
}

bool pace_undetermined(Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the accelerations are not determined: the ideal joints stand at a change "
                   "point, or are redundant; give one of them play, or start elsewhere");
}
