// Settles a mechanism, where it does and its start is still to be found.
#include "run/settle.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "model/bushing.h"
#include "model/perturb.h"
#include "run/pressed.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

bool settle_change_start(Scenario *scenario, double size, unsigned member)
{
    const Linkage *linkage = &scenario->linkage;
    PerturbUnit *units = zeroed(linkage->body_count, sizeof *units);
    const double omega = fabs(linkage->driver.speed);
    for (size_t i = 0; i < linkage->body_count; i++) {
        units[i] = (PerturbUnit){omega * linkage_reach(linkage, (int)i), omega};
    }
    const bool is_changed = perturb_start(scenario, units, size, member);
    free(units);
    return is_changed;
}

// Whether the contact of a joint with play loses energy.
static bool contact_dissipates(const Scenario *scenario, const Joint *joint)
{
    if (!linkage_has_play(joint)) {
        return false;
    }
    const ContactOptions own = law_options(&scenario->contact, joint);
    const double friction = scenario_friction(scenario, joint);
    return friction > 0.0 || law_is_damped(&own);
}

bool settle_dissipates(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const Torque *torque = &linkage->torque;
    bool dissipates =
        (torque->table.count > 0 && torque->slope > 0.0) || linkage->gap_damper_count > 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        dissipates = dissipates || contact_dissipates(scenario, &linkage->joints[i]);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        dissipates = dissipates || linkage->springs[i].damping > 0.0;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        dissipates = dissipates || linkage->torsions[i].damping > 0.0;
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        dissipates = dissipates || bushing_damps(&linkage->bushings[i]);
    }
    return dissipates;
}

void settle_scenario(Scenario *scenario, RunWatch watch)
{
    SettledStart *settled = &scenario->settled;
    if (!scenario_lacks_start(scenario)) {
        return;
    }
    RunOptions *run = &scenario->run;
    if (run->start == START_PRESSED) {
        Err err = {ERR_NONE, ""};
        settled->is_pressed = pressed_start(scenario, &err);
        snprintf(settled->message, sizeof settled->message, "%s", err.text);
    } else if (!settle_dissipates(scenario)) {
        scenario_start_as_written(
            scenario, "nothing in it dissipates energy, so that it never forgets its start");
    } else if (!settle_search(scenario, scenario, run->settle_starts, watch) &&
               !run->is_start_given) {
        scenario_start_as_written(scenario, "it fails before its motion has settled");
    }
}
