// Warns of what in a case is unlikely to be meant, and of keys that change nothing.
//
// A joint at the end of a uniform bar is sqrt(3) = 1.73 radii of gyration, sqrt(inertia / mass),
// from its centre of mass. One that is a hundred times as far has a position or an inertia in
// another unit.
#include "cli/warnings.h"

#include "base/zeroed.h"
#include "casefile/casefile.h"
#include "cli/output.h"
#include "model/joint_rows.h"
#include "model/space_flat.h"
#include "model/space_rows.h"
#include "run/drive_torque.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double FAR = 100.0; // radii of gyration: no body is as slender as that

// Of the distance of a body's joints: a bar has 0.29 of it as its radius of gyration, and one that
// turns on the ground may carry a flywheel.
static const double SLENDER = 2.0;
static const double FLYWHEEL = 20.0;

// Of the pin's diameter, radial: the loosest usual fit of a shaft of 10 mm has 0.2 %.
static const double LOOSE = 0.01 * (1.0 + 1e-9);

enum { BODIES_MOST = 100 };

enum { PIVOT_FREEDOMS = 2 }; // that a pivot in the plane takes

// Of the distance of a body's joints: of a link with a counterweight the centre of mass is within
// once that distance of a joint.
static const double OUTSIDE = 2.0;

// Of two masses: a slip of g for kg is 1000, between bodies that differ by up to three.
static const double UNEQUAL = 300.0;

// A sine over the run, or over a revolution, is found within 1.2 % of its largest by so many.
enum { TORQUE_SAMPLES = 20 };

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
        if (joint_has_hole(joint->kind) && share > LOOSE) {
            output_say("jointplay: warning: the radial clearance of '%s' is %.3g %% of its pin's "
                       "diameter; check hole, pin and radial-clearance\n",
                       joint->name, 100.0 * share);
        }
    }
}

// In space, a mechanism that stays in the plane.
static void say_space(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial && ((space_is_upright(linkage) && !scenario_has_clearance(scenario)) ||
                                space_flat_is(scenario))) {
        output_say("jointplay: warning: nothing can tilt in this case: without space: spatial it "
                   "gives the same numbers in less time\n");
    }
}

// The ways in which bodies can move with play taken as none. In the plane they are counted by rows:
// where a mechanism passes a change point fewer of these are independent for a moment.
static size_t count_freedoms(const Linkage *linkage)
{
    if (!linkage->is_spatial) {
        const size_t columns = 3 * linkage->body_count;
        const size_t rows = joint_rows_total(linkage);
        return columns > rows ? columns - rows : 0;
    }
    SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
    space_start(linkage, motions);
    const size_t freedoms = space_rows_mobility(linkage, motions, false);
    free(motions);
    return freedoms;
}

// How many of these something else holds, at most: springs, bushings, loads, stops, teeth and
// limits.
static size_t count_holds(const Linkage *linkage)
{
    size_t count = linkage->spring_count + linkage->torsion_count + linkage->load_count +
                   BUSHING_ROWS * linkage->bushing_count;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool has_rows = joint_rows_count(joint->kind) > 0;
        count += !has_rows || joint->limits.kind != LIMIT_NONE ? 1 : 0;
    }
    return count;
}

// A joint that was forgotten. A pivot takes two freedoms, so that one pendulum on what is driven
// is none; and a mechanism without a drive may be pendulums of any number.
static void say_freedoms(const Linkage *linkage)
{
    const bool is_driven = linkage->driver.is_present || linkage->torque.table.count > 0 ||
                           linkage->torque.slope > 0.0;
    if (!is_driven || linkage->body_count > BODIES_MOST) {
        return;
    }
    const size_t freedoms = count_freedoms(linkage);
    const size_t drives = 1 + linkage->further_count;
    const size_t holds = count_holds(linkage);
    if (freedoms >= drives + holds + PIVOT_FREEDOMS) {
        output_say("jointplay: warning: the mechanism can move in %zu ways (play not counted), of "
                   "which %zu %s driven and %zu held by springs, loads, stops or teeth; unless "
                   "bodies are to hang loose, a joint is missing\n",
                   freedoms, drives, drives == 1 ? "is" : "are", holds);
    }
}

// The distance of a body's centre of mass from the nearest of its joints, m; infinite without any.
static double centre_off(const Linkage *linkage, int body)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd end = linkage_end(&linkage->joints[i / 2], (int)(i % 2));
        if (end.body == body) {
            nearest = fmin(nearest, vec2_length(end.anchor));
        }
    }
    return nearest;
}

// A place of a body in another unit.
static void say_centres(const Linkage *linkage)
{
    for (size_t i = 0; linkage->body_count <= BODIES_MOST && i < linkage->body_count; i++) {
        const double length = body_length(linkage, (int)i);
        const double off = centre_off(linkage, (int)i);
        if (length > 0.0 && isfinite(off) && off > OUTSIDE * length) {
            output_say("jointplay: warning: the centre of mass of '%s' is %.4g m from its nearest "
                       "joint, %.3g times the distance of its joints; check its place (at)\n",
                       linkage->bodies[i].name, off, off / length);
        }
    }
}

// The masses of the bodies that a body is joined to, by joints that hold it, kg; the heaviest is 0
// where it has none.
typedef struct Neighbours {
    double lightest;
    double heaviest;
} Neighbours;

static Neighbours find_neighbours(const Linkage *linkage, int body)
{
    Neighbours found = {INFINITY, 0.0};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const int other = joint->body_a == body   ? joint->body_b
                          : joint->body_b == body ? joint->body_a
                                                  : LINKAGE_GROUND;
        if (other != LINKAGE_GROUND && joint_rows_count(joint->kind) > 0) {
            found.lightest = fmin(found.lightest, linkage->bodies[other].mass);
            found.heaviest = fmax(found.heaviest, linkage->bodies[other].mass);
        }
    }
    return found;
}

// A mass in another unit: of the bodies that differ most from all beside them, the first.
static void say_masses(const Linkage *linkage)
{
    const Body *odd = NULL;
    Neighbours beside = {0.0, 0.0};
    double largest = 0.0;
    for (size_t i = 0; linkage->body_count <= BODIES_MOST && i < linkage->body_count; i++) {
        const Neighbours found = find_neighbours(linkage, (int)i);
        const double mass = linkage->bodies[i].mass;
        const double ratio =
            found.heaviest > 0.0 ? fmax(mass / found.heaviest, found.lightest / mass) : 0.0;
        if (ratio > largest) {
            odd = &linkage->bodies[i];
            beside = found;
            largest = ratio;
        }
    }
    if (odd != NULL && largest >= UNEQUAL) {
        char range[64] = "";
        if (beside.lightest < beside.heaviest) {
            snprintf(range, sizeof range, "%.4g to ", beside.lightest);
        }
        output_say("jointplay: warning: the mass of '%s' is %.4g kg, that of the bodies it is "
                   "joined to %s%.4g kg, a ratio of %.3g; check the units\n",
                   odd->name, odd->mass, range, beside.heaviest, largest);
    }
}

// Upward, as -9.81 m/s^2 is where one number is downward.
static void say_gravity(const Scenario *scenario)
{
    const Vec3 gravity = scenario->gravity;
    if (gravity.y > fmax(fabs(gravity.x), fabs(gravity.z))) {
        output_say(
            "jointplay: warning: gravity is %.4g m/s^2 along +y, which is upward; one number "
            "above 0 is downward\n",
            gravity.y);
    }
}

// The torque of a drive is found at samples alone.
static void say_samples(const Scenario *scenario)
{
    const size_t samples = scenario->run.samples;
    if (samples < TORQUE_SAMPLES && drive_torque_count(&scenario->linkage) > 0) {
        output_say("jointplay: warning: the drive's torque is taken at samples, and run.samples is "
                   "%zu; below %d its largest may be missed\n",
                   samples, TORQUE_SAMPLES);
    }
}

static void say_doubts(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    say_inertias(linkage);
    say_plays(linkage);
    say_space(scenario);
    say_freedoms(linkage);
    say_centres(linkage);
    say_masses(linkage);
    say_gravity(scenario);
    say_samples(scenario);
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
    casefile_unused(scenario, false, &lines);
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
