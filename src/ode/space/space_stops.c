// Lets flanks and stops press on a hinge in space that ODE steps.
//
// By a row of the angle (world/pressing_row.h) with the torque that the law asks for, by the map
// chosen, as in the plane: staggered, an end acts in that share of the step in which it is
// overlapped (contact/overlap.h).
#include "ode/space/space_stops.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/law_row.h"
#include "contact/overlap.h"
#include "contact/stop_space.h"
#include "ode/space/space_world.h"
#include "world/pressing_row.h"

#include <string.h>

// One end.
struct SpaceStop {
    int joint;
    double sign;  // 1 of the low end, -1 of the high one
    double limit; // rad, where it is
    ForceLaw law;
    dJointID row;
    dJointFeedback feedback;
    Vec3 axis; // of the row, of ODE's first body
    Onset onset;
    ContactPeaks peaks;
    ContactState state; // as in ode/plane/contact_rows.h
    bool falls_back;    // the map is not stable at this step: the row is the textbook's
    double gap;         // rad, where the bodies are
    double depth;       // rad, of the row
    double share;       // 1, of the step in which the end is overlapped
    double closing;     // rad/s, before the step
    double mass;        // kg m^2, effective
    double damping;     // N m s/rad
    double pressing;    // N m, in the step
    double elastic;     // J, stored after it
    double dissipated;  // J, lost in it
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
                        .law = of->law,
                        .state = linkage->joints[of->joint].contacts[stop_space_place(of)]};
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

// Where an end stands, and how it comes nearer.
static void look_at(const SpaceStops *stops, const SpaceMotion *motions, SpaceStop *stop)
{
    const Linkage *linkage = &stops->scenario->linkage;
    const Joint *joint = &linkage->joints[stop->joint];
    // of ODE's first body, which is a where b is the ground
    const double sign = stop->sign * coordinate_sense(joint);
    stop->axis = vec3_scale(sign, space_coordinate_axis(linkage, motions, stop->joint));
    stop->gap = stop->sign * (stops->angles[stop->joint] - stop->limit);
    stop->closing = -stop->sign * space_coordinate_rate(linkage, motions, stop->joint);
}

static void find_contact(SpaceStops *stops, SpaceStop *stop, double step_s)
{
    const bool was_touching = stop->state.is_touching;
    const Overlap overlap = stops->is_staggered
                                ? overlap_find(&stop->law, stop->gap, stop->closing, step_s)
                                : (Overlap){.depth = -stop->gap, .share = 1.0};
    stop->share = overlap.share;
    stop->depth = overlap.depth;
    stop->state.is_touching = overlap.depth > 0.0;
    if (!stop->state.is_touching) {
        stop->state.impact_speed = stop->closing;
    } else if (was_touching) {
        stop->state.age_s += step_s;
        contact_state_follow(&stop->state, stop->closing, stop->law.resting_speed);
    } else {
        stop->state =
            contact_state_begun(stops->is_staggered ? onset_speed(&stop->onset, stop->closing,
                                                                  stop->gap, -stop->gap, step_s)
                                                    : stop->closing);
        contact_peaks_begin(&stop->peaks,
                            force_law_viscous(&stop->law, 0.0) * stop->state.impact_speed,
                            0.5 * step_s - overlap.onset);
    }
    onset_note(&stop->onset, stop->state.is_touching, stop->gap);
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
        stops->stops[i].mass = 1.0 / space_response_block(stops->response, place, place)[0];
    }
}

static void press(SpaceStops *stops, SpaceStop *stop, double step_s)
{
    const Scenario *scenario = stops->scenario;
    ErpCfm soft = {.erp = scenario->ode.push_out,
                   .cfm = map_poisson_cfm(scenario->contact.penalty)};
    if (scenario->contact.model == CONTACT_IMPACT) {
        const LawRow at = {
            .depth = stop->depth,
            .closing = stop->closing,
            .impact_speed = stop->state.damping_speed,
            .share = stop->share,
            .mass = stop->mass,
        };
        const double slope = force_law_tangent(&stop->law, stop->depth);
        stop->falls_back = !isinf(stops->map->stability_limit) &&
                           !law_row_is_stable(stops->map, slope / stop->mass, step_s);
        stops->fallback_count += stop->falls_back ? 1 : 0;
        const MapContact contact = law_row_contact(&stop->law, &at, step_s);
        soft = law_row_soft(stops->map, stop->falls_back, &contact);
        stop->damping = contact.damping;
    }
    pressing_row_set_axis(stop->row, stop->axis.x, stop->axis.y, stop->axis.z);
    pressing_row_press(stop->row, soft.cfm, soft.erp / step_s * stop->depth, step_s);
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
        look_at(stops, motions, stop);
        find_contact(stops, stop, step_s);
        JointState *joint = &joints->plane[stop->joint];
        const bool is_first = i == 0 || stops->stops[i - 1].joint != stop->joint;
        joint->tilt = *angle;
        joint->gap = is_first ? stop->gap : fmin(joint->gap, stop->gap);
        joint->is_touching = (!is_first && joint->is_touching) || stop->state.is_touching;
        if (is_first || stop->state.is_touching) {
            approach[stop->joint] = stop->state.impact_speed;
        }
        is_any = is_any || stop->state.is_touching;
    }
    if (is_any && stops->map != NULL) {
        find_masses(stops, motions);
    }
    for (size_t i = 0; i < stops->count; i++) {
        SpaceStop *stop = &stops->stops[i];
        if (!stop->state.is_touching) {
            continue;
        }
        if (!law_check_depth(&stop->law, &linkage->joints[stop->joint], stop->depth, 1.0, err)) {
            return false;
        }
        press(stops, stop, step_s);
    }
    return true;
}

// As in ode/plane/contact_rows.c.
static void book_energy(SpaceStops *stops, const SpaceMotion *motions, SpaceStop *stop,
                        double step_s)
{
    const Linkage *linkage = &stops->scenario->linkage;
    const double angle =
        space_coordinate_near(linkage, motions, stop->joint, stops->angles[stop->joint]);
    const double after = -stop->sign * (angle - stop->limit);
    const double speed = -stop->sign * space_coordinate_rate(linkage, motions, stop->joint);
    const double closing = stops->is_staggered ? 0.5 * (stop->closing + speed) : speed;
    const double depth = stops->is_staggered ? 0.5 * (after - stop->gap) : after;
    if (stops->scenario->contact.model == CONTACT_POISSON) {
        stop->dissipated = stop->pressing * 0.5 * (stop->closing + speed) * step_s;
        return;
    }
    const double damped = stop->pressing > 0.0 ? stop->damping * closing
                                               : -force_law_elastic(&stop->law, stop->depth);
    stop->dissipated = damped * closing * step_s;
    stop->elastic = force_law_energy(&stop->law, fmax(0.0, depth));
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
        stop->pressing = stop->elastic = stop->dissipated = 0.0;
        if (!stop->state.is_touching) {
            continue;
        }
        const dReal *torque = stop->feedback.t1;
        stop->pressing = vec3_dot(stop->axis, (Vec3){torque[0], torque[1], torque[2]});
        pressing_row_rest(stop->row);
        joint->force += stop->pressing;
        joint->moment_on_b +=
            coordinate_sense(&linkage->joints[stop->joint]) * stop->sign * stop->pressing;
        contact_peaks_note_step(&stop->peaks, stop->pressing, fmax(-stop->gap, 0.0), stop->share,
                                step_s);
        book_energy(stops, stops->motions, stop, step_s);
    }
}

ContactEnergy space_stops_energy(const SpaceStops *stops)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < stops->count; i++) {
        sum.dissipated += stops->stops[i].dissipated;
        sum.elastic += stops->stops[i].elastic;
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
        if (stop->state.is_touching) {
            top->force = fmax(top->force, stop->peaks.force);
            top->depth = fmax(top->depth, stop->peaks.depth);
        }
    }
}

void space_stops_states(const SpaceStops *stops, ContactState (*states)[JOINT_PLACES])
{
    for (size_t i = 0; i < stops->count; i++) {
        const SpaceStop *stop = &stops->stops[i];
        states[stop->joint][stop->sign > 0.0 ? 0 : 1] = stop->state;
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
