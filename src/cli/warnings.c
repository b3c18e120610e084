// What in a case is unlikely to be meant, and which of its keys change nothing?
//
// A joint at the end of a uniform bar is sqrt(3) = 1.73 radii of gyration, sqrt(inertia / mass),
// from its centre of mass. One that is a hundred times as far has a position or an inertia in
// another unit.
#include "cli/warnings.h"

#include "casefile/casefile.h"
#include "cli/output.h"

#include <math.h>
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

static void say_unused(const Scenario *scenario)
{
    Text lines;
    text_init(&lines);
    casefile_unused(scenario, &lines);
    for (const char *line = lines.data; *line != '\0'; line = strchr(line, '\n') + 1) {
        output_say("jointplay: warning: %.*s\n", (int)strcspn(line, "\n"), line);
    }
    text_finish(&lines);
}

void warnings_say(const Scenario *scenario, const CommonOptions *options)
{
    if (!options->is_quiet) {
        say_doubts(scenario);
        say_unused(scenario);
    }
}
