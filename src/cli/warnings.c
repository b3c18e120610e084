// What in a case is unlikely to be meant, and which settings of the command line change nothing?
//
// A joint at the end of a uniform bar is sqrt(3) = 1.73 radii of gyration, sqrt(inertia / mass),
// from its centre of mass. One that is a hundred times as far has a position or an inertia in
// another unit.
#include "cli/warnings.h"

#include "casefile/casefile.h"
#include "cli/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FAR = 100.0; // radii of gyration: no body is as slender as that

static double radii_off(const Linkage *linkage, int body, Vec2 anchor)
{
    if (body == LINKAGE_GROUND) {
        return INFINITY;
    }
    const Body *held = &linkage->bodies[body];
    return vec2_length(anchor) / sqrt(held->inertia / held->mass);
}

static void say_doubts(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double off_a = radii_off(linkage, joint->body_a, joint->anchor_a);
        const double off_b = radii_off(linkage, joint->body_b, joint->anchor_b);
        if (fmin(off_a, off_b) > FAR) {
            const bool is_a = off_a < off_b;
            output_say(
                "jointplay: warning: joint '%s' is %.4g m from the centre of mass of '%s', "
                "%.3g times its radius of gyration; check the joint's position and the body's "
                "inertia\n",
                joint->name, vec2_length(is_a ? joint->anchor_a : joint->anchor_b),
                linkage->bodies[is_a ? joint->body_a : joint->body_b].name, fmin(off_a, off_b));
        }
    }
}

// Whether a key of the case format is one that the scenario makes no use of.
static bool is_idle(const Scenario *scenario, const char *key)
{
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (strcmp(setting.key, key) == 0) {
            return !setting.applies;
        }
    }
    return false; // a group of keys
}

static void say_idle(const Scenario *scenario, const char *const *overrides, size_t count)
{
    size_t idle = 0;
    for (size_t i = 0; i < count; i++) {
        char key[CASEFILE_KEY_SIZE];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(overrides[i], "="), overrides[i]);
        if (is_idle(scenario, key)) {
            output_say("%s%s", idle++ == 0 ? "without effect: " : ", ", key);
        }
    }
    if (idle > 0) {
        output_say(" (nothing in %s makes use of %s)\n", scenario_path(scenario),
                   idle == 1 ? "it" : "them");
    }
}

void warnings_say(const Scenario *scenario, const CommonOptions *options)
{
    if (!options->is_quiet) {
        say_doubts(scenario);
        say_idle(scenario, options->overrides, options->override_count);
    }
}
