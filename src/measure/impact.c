// What does one impact of a lone pin give in ODE, and what was to be expected of it?
//
// Of a block between guides, a stop or the end of a coordinate a disc stands for the pin, and a
// line for the wall; what turns is run with its inertia for a mass and its angles for lengths.
//
// The pin starts so far from the wall that it overlaps it for the first time at a depth that the
// phase chooses: whole steps of flight, and a share of one more. The shares are the middles of
// equal parts, (i + 1/2) / 16. Plain stepping finds the first overlap at (1 - share) of a step's
// way, staggered stepping, half a step aside, at (1/2 - share) or (3/2 - share): over all i these
// are the same sixteen overlaps as those of the prediction.
#include "measure/impact.h"

#include "contact/law.h"
#include "model/coordinate.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// of flight before the wall, where there is room
static const double FLIGHT_STEPS = 10.0;

// of the way from wall to wall that the pin may fly, so that it meets but one of them
static const double FLIGHT_SHARE = 0.75;

// after the contact, so that the last sample stands behind it
static const double STEPS_BEHIND = 2.5;

// of one run: some tens of milliseconds of wall time
static const double STEPS_MOST = 1e5;

// The joint of the lone body: its pin in its hole, or a disc against a line across the x axis that
// touches as far from the origin as the pin would.
static Joint lone_joint(const Joint *from, double play)
{
    Joint joint = {
        .kind = JOINT_CLEARANCE,
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .clearance = from->clearance,
        .contact = from->contact,
    };
    if (from->kind != JOINT_CLEARANCE) {
        const double radius = law_touching_radius(from);
        joint.kind = JOINT_STOP;
        joint.stop.radius_b = isfinite(radius) ? radius : 0.0;
        joint.anchor_a.x = play + joint.stop.radius_b;
        joint.direction = M_PI;
    }
    memcpy(joint.name, from->name, sizeof from->name);
    return joint;
}

// How far the lone body flies from the middle to the wall, m. A stop has no wall on the other side.
static double lone_play(const Joint *from)
{
    if (from->limits.kind != LIMIT_NONE) {
        return coordinate_play(from);
    }
    return from->kind == JOINT_STOP ? INFINITY : linkage_radial_clearance(from);
}

// The scenario's world with nothing in it but the pin; for scenario_free.
static void lone_pin(const Scenario *scenario, int joint, double mass, Scenario *lone)
{
    const Joint *from = &scenario->linkage.joints[joint];
    const double radius = law_touching_radius(from);
    const double size = isfinite(radius) ? radius : 1e-2; // m: it does not turn
    *lone = scenario_around(scenario, linkage_create((LinkageRoom){.bodies = 1, .joints = 1}));
    lone->has_fourbar = false;
    lone->has_slidercrank = false;
    lone->point_count = 0;
    lone->gravity = 0.0;
    lone->linkage.body_count = 1;
    lone->linkage.bodies[0] = (Body){
        .name = "pin",
        .mass = mass,
        .inertia = 0.5 * mass * size * size,
    };
    const double play = lone_play(from);
    lone->linkage.joint_count = 1;
    lone->linkage.joints[0] = lone_joint(from, isfinite(play) ? play : 0.0);
    lone->run.samples = 2;
}

// One run; false where it says nothing of one impact.
static bool run_phase(const Scenario *lone, double speed, MapImpact *impact, char *message)
{
    Trajectory *run = run_scenario(lone, registry_solver(BACKEND_ODE), (RunWatch){0});
    const JointExtremes *joint = &run->joints[0];
    const bool is_single = run->is_complete && joint->impacts == 1;
    if (!run->is_complete) {
        snprintf(message, ERR_TEXT_SIZE, "%s", run->message);
    } else if (!is_single) {
        snprintf(message, ERR_TEXT_SIZE, "the pin had %zu contacts and not one", joint->impacts);
    } else {
        const size_t last = run->sample_count - 1;
        const Spike *spike = &joint->spikes[0];
        *impact = (MapImpact){
            .restitution = -trajectory_motion(run, last, 0)->velocity.x / speed,
            .force_max = spike->force_max,
            .penetration_max = spike->penetration_max,
            .duration = spike->duration_s,
            .fallbacks = run->fallback_rows,
            .is_ended = !trajectory_state(run, last, 0)->is_touching,
        };
    }
    trajectory_destroy(run);
    return is_single;
}

ImpactDelivered impact_deliver(const Scenario *scenario, int joint, double mass, double speed,
                               double contact_s)
{
    ImpactDelivered delivered = {.figures = {.is_ended = true}};
    const double step_s = scenario->run.step;
    const double play = lone_play(&scenario->linkage.joints[joint]);
    const double wall = isfinite(play) ? play : 0.0;                  // m
    const double room = 2.0 * FLIGHT_SHARE * play / (speed * step_s); // steps
    const double whole = fmin(FLIGHT_STEPS, floor(room) - 1.0);
    const double rest_s = contact_s + STEPS_BEHIND * step_s;
    // past the wall and back again, and some steps behind, without the wall on the other side
    if (!(room >= 2.0)) {
        snprintf(delivered.message, sizeof delivered.message,
                 "the pin flies %.3g of its play in one step", 1.5 / room);
        return delivered;
    }
    if (!(rest_s / step_s <= STEPS_MOST)) {
        snprintf(delivered.message, sizeof delivered.message, "it would take more than %.0e steps",
                 STEPS_MOST);
        return delivered;
    }
    Scenario lone;
    lone_pin(scenario, joint, mass, &lone);
    delivered.is_measured = true;
    for (int i = 0; i < MAP_IMPACT_PHASES && delivered.is_measured; i++) {
        const double flight_s = (whole + map_impact_phase(i)) * step_s;
        Motion *start = &lone.linkage.bodies[0].start;
        start->position.x = wall - speed * flight_s;
        start->velocity.x = speed;
        lone.run.duration = flight_s + rest_s;
        MapImpact impact;
        delivered.is_measured = run_phase(&lone, speed, &impact, delivered.message);
        if (delivered.is_measured) {
            impact_add_phase(&delivered.figures, i, &impact);
        }
    }
    scenario_free(&lone);
    return delivered;
}
