// Lets flanks and stops press on a hinge in space that ODE steps.
//
// By a row of the angle (world/pressing_row.h) with the torque that the law asks for, by the map
// chosen, as in the plane: staggered, an end acts in that share of the step in which it is
// overlapped (contact/overlap.h).
#include "ode/space/space_stops.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/overlap.h"
#include "contact/stop_space.h"
#include "ode/space/space_world.h"
#include "ode/step_contact.h"
#include "world/pressing_row.h"

#include <string.h>

// One end.
struct SpaceStop {
    int joint;
    double sign;  // 1 of the low end, -1 of the high one
    double limit; // rad, where it is
    dJointID row;
    dJointFeedback feedback;
    Vec3 axis; // of the row, of ODE's first body
    StepContact at;
};

bool space_stops_list(SpaceStops *stops, const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    memset(stops, 0, sizeof *stops);
    stops->scenario = scenario;
    StopSpace *listed = stop_space_list(scenario, &stops->count, err);
    if (listed == NULL) {
        return false;
    }
    stops->stops = zeroed(stops->count, sizeof *stops->stops);
    stops->angles = zeroed(linkage->joint_count, sizeof *stops->angles);
    stops->motions = zeroed(linkage->body_count, sizeof *stops->motions);
    for (size_t i = 0; i < stops->count; i++) {
        const StopSpace *of = &listed[i];
        stops->stops[i] =
            (SpaceStop){.joint = of->joint,
                        .sign = of->sign,
                        .limit = of->limit,
                        .at = {.law = of->law,
                               .state = linkage->joints[of->joint].contacts[stop_space_place(of)]}};
        stops->angles[of->joint] = space_coordinate_start(linkage, of->joint);
    }
    free(listed);
    return true;
}

void space_stops_response_places(const SpaceStops *stops, SpaceResponsePlace *places)
{
    for (size_t i = 0; i < stops->count; i++) {
        places[i] = (SpaceResponsePlace){stops->stops[i].joint, 1};
    }
}

void space_stops_init(SpaceStops *stops, World *world, SpaceResponse *response, size_t first_place,
                      bool is_staggered)
{
    stops->world = world;
    stops->response = response;
    stops->first_place = first_place;
    stops->is_staggered = is_staggered;
    if (stops->count > 0 && stops->scenario->contact.model == CONTACT_IMPACT) {
        stops->map = map_get(stops->scenario->ode.map);
    }
    stops->rows = zeroed(space_response_play_rows(response), sizeof *stops->rows);
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        const Joint *joint = &stops->scenario->linkage.joints[stop->joint];
        const dBodyID a = joint->body_a == LINKAGE_GROUND ? NULL : world->bodies[joint->body_a];
        const dBodyID b = joint->body_b == LINKAGE_GROUND ? NULL : world->bodies[joint->body_b];
        stop->row = pressing_row_of_angle(world->id, (dBodyID[]){b, a}, &stop->feedback);
    }
}

void space_stops_finish(SpaceStops *stops)
{
    free(stops->stops);
    free(stops->angles);
    free(stops->rows);
    free(stops->motions);
}

// Where an end stands, how it comes nearer, and whether it touches.
static void find_contact(SpaceStops *stops, const SpaceMotion *motions, SpaceStop *stop,
                         double step_s)
{
    const Linkage *linkage = &stops->scenario->linkage;
    const Joint *joint = &linkage->joints[stop->joint];
    // of ODE's first body, which is a where b is the ground
    const double sign = stop->sign * coordinate_sense(joint);
    stop->axis = vec3_scale(sign, space_coordinate_axis(linkage, motions, stop->joint));
    const double gap = stop->sign * (stops->angles[stop->joint] - stop->limit);
    const double closing = -stop->sign * space_coordinate_rate(linkage, motions, stop->joint);
    const Overlap overlap = stops->is_staggered ? overlap_find(&stop->at.law, gap, closing, step_s)
                                                : (Overlap){.depth = -gap, .share = 1.0};
    const StepFound found = {
        .touches = overlap.depth > 0.0,
        .gap = gap,
        .inside = -gap,
        .depth = overlap.depth,
        .share = overlap.share,
        .closing = closing,
        .onset_s = overlap.onset,
    };
    step_contact_find(&stop->at, &found, (StepKind){step_s, stops->is_staggered});
}

// The inertias that all ends meet that press, kg m^2.
static void find_masses(SpaceStops *stops, const SpaceMotion *motions)
{
    const size_t first = stops->response->first_row[stops->first_place];
    for (size_t i = 0; i < space_response_play_rows(stops->response); i++) {
        stops->rows[i] = (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
    }
    for (size_t i = 0; i < stops->count; i++) {
        stops->rows[first + i] =
            space_coordinate_row(&stops->scenario->linkage, motions, stops->stops[i].joint);
    }
    if (!space_response_place(stops->response, motions, stops->rows)) {
        return;
    }
    for (size_t i = 0; i < stops->count; i++) {
        const size_t place = stops->first_place + i;
        StepContact *at = &stops->stops[i].at;
        at->mass = at->stiff_mass = 1.0 / space_response_block(stops->response, place, place)[0];
    }
}

static void press(SpaceStops *stops, SpaceStop *stop, double step_s)
{
    const Scenario *scenario = stops->scenario;
    ErpCfm soft = {.erp = scenario->ode.push_out,
                   .cfm = map_poisson_cfm(scenario->contact.penalty)};
    if (scenario->contact.model == CONTACT_IMPACT) {
        soft = step_contact_soft(&stop->at, stops->map, step_s);
        stops->fallback_count += stop->at.falls_back ? 1 : 0;
    }
    pressing_row_set_axis(stop->row, stop->axis.x, stop->axis.y, stop->axis.z);
    pressing_row_press(stop->row, soft.cfm, soft.erp / step_s * stop->at.found.depth, step_s);
}

bool space_stops_make(SpaceStops *stops, const SpaceMotion *motions, double step_s,
                      SpaceJoints *joints, double *approach, Err *err)
{
    const Linkage *linkage = &stops->scenario->linkage;
    bool is_any = false;
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        double *angle = &stops->angles[stop->joint];
        *angle = space_coordinate_near(linkage, motions, stop->joint, *angle);
        find_contact(stops, motions, stop, step_s);
        JointState *joint = &joints->plane[stop->joint];
        const bool is_first = i == 0 || stops->stops[i - 1].joint != stop->joint;
        joint->tilt = *angle;
        joint->gap = is_first ? stop->at.found.gap : fmin(joint->gap, stop->at.found.gap);
        joint->is_touching = (!is_first && joint->is_touching) || stop->at.state.is_touching;
        if (is_first || stop->at.state.is_touching) {
            approach[stop->joint] = stop->at.state.impact_speed;
        }
        is_any = is_any || stop->at.state.is_touching;
    }
    if (is_any && stops->map != NULL) {
        find_masses(stops, motions);
    }
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        if (!stop->at.state.is_touching) {
            continue;
        }
        if (!law_check_depth(&stop->at.law, &linkage->joints[stop->joint], stop->at.found.depth,
                             1.0, err)) {
            return false;
        }
        press(stops, stop, step_s);
    }
    return true;
}

static void book_energy(SpaceStops *stops, const SpaceMotion *motions, SpaceStop *stop,
                        double step_s)
{
    const Linkage *linkage = &stops->scenario->linkage;
    const double angle =
        space_coordinate_near(linkage, motions, stop->joint, stops->angles[stop->joint]);
    const StepAfter after = {
        .pressing = stop->at.pressing,
        .depth = -stop->sign * (angle - stop->limit),
        .closing = -stop->sign * space_coordinate_rate(linkage, motions, stop->joint),
    };
    step_contact_book(&stop->at, stops->scenario->contact.model, after,
                      (StepKind){step_s, stops->is_staggered});
}

void space_stops_clear(SpaceStops *stops, double step_s, SpaceJoints *joints)
{
    const Linkage *linkage = &stops->scenario->linkage;
    for (size_t i = 0; stops->count > 0 && i < linkage->body_count; i++) {
        stops->motions[i] = space_world_motion(stops->world, i);
    }
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        JointState *joint = &joints->plane[stop->joint];
        if (i == 0 || stops->stops[i - 1].joint != stop->joint) {
            // what holds the joint beside its angle is not told of it
            joint->force = 0.0;
        }
        stop->at.pressing = stop->at.elastic = stop->at.dissipated = 0.0;
        if (!stop->at.state.is_touching) {
            continue;
        }
        const dReal *torque = stop->feedback.t1;
        stop->at.pressing = vec3_dot(stop->axis, (Vec3){torque[0], torque[1], torque[2]});
        pressing_row_rest(stop->row);
        joint->force += stop->at.pressing;
        joint->moment_on_b +=
            coordinate_sense(&linkage->joints[stop->joint]) * stop->sign * stop->at.pressing;
        contact_peaks_note_step(&stop->at.peaks, stop->at.pressing, fmax(-stop->at.found.gap, 0.0),
                                stop->at.found.share, step_s);
        book_energy(stops, stops->motions, stop, step_s);
    }
}

ContactEnergy space_stops_energy(const SpaceStops *stops)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < stops->count; i++) {
        step_contact_add_energy(&stops->stops[i].at, &sum);
    }
    return sum;
}

void space_stops_peaks(const SpaceStops *stops, JointPeak *peaks)
{
    for (size_t i = 0; i < stops->count; i++) {
        const SpaceStop *stop = &stops->stops[i];
        JointPeak *top = &peaks[stop->joint];
        if (i == 0 || stops->stops[i - 1].joint != stop->joint) {
            *top = (JointPeak){.force = 0.0};
        }
        step_contact_raise(&stop->at, top);
    }
}

void space_stops_states(const SpaceStops *stops, ContactState (*states)[JOINT_PLACES])
{
    for (size_t i = 0; i < stops->count; i++) {
        const SpaceStop *stop = &stops->stops[i];
        states[stop->joint][stop->sign > 0.0 ? 0 : 1] = stop->at.state;
    }
}

void space_stops_carry(SpaceStops *stops, Carry *carry)
{
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        // of all that is in a stop the row alone is another world's
        const dJointID row = stop->row;
        CARRY(carry, *stop);
        stop->row = row;
    }
    CARRY_ARRAY(carry, stops->angles, stops->scenario->linkage.joint_count);
    CARRY(carry, stops->fallback_count);
}
