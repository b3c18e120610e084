// Warns of what in a case is unlikely to be meant, and of keys that change nothing.
//
// A joint at the end of a uniform bar is sqrt(3) = 1.73 radii of gyration, sqrt(inertia / mass),
// from its centre of mass. One that is a hundred times as far has a position or an inertia in
// another unit.
#include "cli/warnings.h"

#include "casefile/casefile.h"
#include "cli/output.h"
#include "model/space.h"

#include <math.h>
#include <string.h>

static const double FAR = 100.0; // radii of gyration: no body is as slender as that

// Of the distance of a body's joints: a bar has 0.29 of it as its radius of gyration, and one that
// turns on the ground may carry a flywheel.
static const double SLENDER = 2.0;
static const double FLYWHEEL = 20.0;

// Of the pin's diameter, radial: the loosest usual fit of a shaft of 10 mm has 0.2 %.
static const double LOOSE = 0.01 * (1.0 + 1e-9);

enum { BODIES_MOST = 100 };

static double radii_off(const Linkage *linkage, int body, Vec2 anchor)
{
    if (body == LINKAGE_GROUND) {
        return INFINITY;
    }
    const Body *held = &linkage->bodies[body];
    return vec2_length(anchor) / sqrt(held->inertia / held->mass);
}

// The largest distance of two joints of a body, m; 0 where it has fewer than two.
static double body_length(const Linkage *linkage, int body)
{
    double length = 0.0;
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd one = linkage_end(&linkage->joints[i / 2], (int)(i % 2));
        for (size_t k = 0; one.body == body && k < i; k++) {
            const JointEnd other = linkage_end(&linkage->joints[k / 2], (int)(k % 2));
            if (other.body == body) {
                length = fmax(length, vec2_length(vec2_sub(one.anchor, other.anchor)));
            }
        }
    }
    return length;
}

static bool turns_on_ground(const Linkage *linkage, int body)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if ((joint->body_a == LINKAGE_GROUND && joint->body_b == body) ||
            (joint->body_b == LINKAGE_GROUND && joint->body_a == body)) {
            return true;
        }
    }
    return false;
}

// An inertia that belongs to another body, or stands in another unit.
static void say_inertias(const Linkage *linkage)
{
    if (linkage->body_count > BODIES_MOST) {
        return; // the pairs of joints of so many are many
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const double length = body_length(linkage, (int)i);
        const double gyration = sqrt(body->inertia / body->mass);
        const double most = turns_on_ground(linkage, (int)i) ? FLYWHEEL : SLENDER;
        if (length > 0.0 && gyration > most * length) {
            output_say(
                "jointplay: warning: '%s' has a radius of gyration of %.4g m, %.3g times the "
                "distance of its joints; check its inertia and its mass\n",
                body->name, gyration, gyration / length);
        }
    }
}

static void say_plays(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double share = linkage_radial_clearance(joint) / (2.0 * joint->clearance.pin_radius);
        if (joint->kind == JOINT_CLEARANCE && share > LOOSE) {
            output_say("jointplay: warning: the radial clearance of '%s' is %.3g %% of its pin's "
                       "diameter; check hole, pin and radial-clearance\n",
                       joint->name, 100.0 * share);
        }
    }
}

// In space, a mechanism whose axes are all z and whose pins cannot tilt.
static void say_space(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial && space_is_upright(linkage) && !scenario_has_clearance(scenario)) {
        output_say("jointplay: warning: nothing can tilt in this case: without space: spatial it "
                   "gives the same numbers in less time\n");
    }
}

static void say_doubts(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    say_inertias(linkage);
    say_plays(linkage);
    say_space(scenario);
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
