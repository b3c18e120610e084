// Takes the state of a run, and makes it the start of another.
//
// Positions, speeds and what the contacts carry (kernel/contact_state.h) are all that the motion
// depends on. Angles that have grown by whole turns lose digits, so they are turned back: with k_i
// the whole turns of body i, everything that counts the angle of body b against body a, limits,
// springs and the angle that a slider holds, moves by -2 pi (k_b - k_a), teeth by the same of their
// pitch circles, and the motion stays what it was.
#include "model/state.h"

#include "base/zeroed.h"
#include "model/coordinate.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// of the angle that a drive has turned by: a whole turn to rounding
static const double TURN_ROUNDING = 1e-14;

// of a load's period: a whole number of them to rounding
static const double PERIOD_ROUNDING = 1e-12;

RunState run_state_create(const Linkage *linkage)
{
    return (RunState){
        .body_count = linkage->body_count,
        .joint_count = linkage->joint_count,
        .sample = sample_create(linkage),
        .contacts = zeroed(linkage->joint_count, sizeof(ContactState[JOINT_PLACES])),
    };
}

void run_state_free(RunState *state)
{
    sample_free(&state->sample);
    free(state->contacts);
    state->contacts = NULL;
    carry_finish(&state->carry);
}

void run_state_take(const Solver *solver, void *of, double end_s, RunState *state)
{
    state->time_s = end_s;
    solver->observe(of, end_s, &state->sample);
    if (solver->contacts != NULL) {
        solver->contacts(of, state->contacts);
    }
    carry_begin(&state->carry, false);
}

void run_state_save(const Solver *solver, void *of, double end_s, RunState *state)
{
    run_state_take(solver, of, end_s, state);
    if (solver->carry == NULL || !solver->carry(of, &state->carry)) {
        carry_begin(&state->carry, false);
    }
}

bool run_state_resume(RunState *state, const Solver *solver, const Scenario *scenario, void **of,
                      Err *err)
{
    if (!solver->open(scenario, of, err)) {
        return false;
    }
    carry_begin(&state->carry, true);
    solver->carry(*of, &state->carry);
    assert(state->carry.used == state->carry.size);
    return true;
}

// The whole turns of a body since its start.
static double whole_turns(const Body *body, const Motion *now)
{
    return round((now->angle - body->start.angle) / (2.0 * M_PI));
}

// What counts the angles of bodies at a joint, when these are turned back.
static void turn_back_joint(const Linkage *linkage, int number, const double *back_rad,
                            Motion *motions)
{
    Joint *joint = &linkage->joints[number];
    const double a = joint->body_a == LINKAGE_GROUND ? 0.0 : back_rad[joint->body_a];
    const double b = joint->body_b == LINKAGE_GROUND ? 0.0 : back_rad[joint->body_b];
    joint->held_angle -= b - a;
    if (linkage_has_teeth_tables(joint)) {
        joint->gear.zero -= (a - b) * joint->gear.radius_b / mesh_distance(&joint->gear);
    }
    if (joint->limits.kind == LIMIT_NONE || joint_has_position(joint->kind)) {
        return;
    }
    const double before = coordinate_position(linkage, motions, number);
    Motion *turned = zeroed(linkage->body_count, sizeof *turned);
    for (size_t i = 0; i < linkage->body_count; i++) {
        turned[i] = motions[i];
        turned[i].angle -= back_rad[i];
    }
    const double by = coordinate_position(linkage, turned, number) - before;
    free(turned);
    if (by != 0.0) {
        joint->limits.middle += by;
        joint->limits.low += by;
        joint->limits.high += by;
    }
}

// By how much the angle of a joint is turned back, rad (linkage_turning).
static double turned_back(const Linkage *linkage, int joint, const double *back_rad)
{
    int turned;
    int against;
    linkage_turning(linkage, joint, &turned, &against);
    return back_rad[turned] - (against == LINKAGE_GROUND ? 0.0 : back_rad[against]);
}

static void turn_back_springs(Linkage *linkage, const double *back_rad)
{
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        linkage->torsions[i].angle -= turned_back(linkage, linkage->torsions[i].joint, back_rad);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        Bushing *bushing = &linkage->bushings[i];
        const double a = bushing->body_a == LINKAGE_GROUND ? 0.0 : back_rad[bushing->body_a];
        const double b = bushing->body_b == LINKAGE_GROUND ? 0.0 : back_rad[bushing->body_b];
        bushing->angle -= b - a;
    }
}

// Returns by how much the joint of a torque is turned back, rad.
static double start_in_plane(const RunState *state, Linkage *linkage)
{
    const size_t count = linkage->body_count;
    double *back_rad = zeroed(count, sizeof *back_rad);
    Motion *motions = state->sample.bodies;
    for (size_t i = 0; i < count; i++) {
        back_rad[i] = 2.0 * M_PI * whole_turns(&linkage->bodies[i], &motions[i]);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        turn_back_joint(linkage, i, back_rad, motions);
    }
    turn_back_springs(linkage, back_rad);
    for (size_t i = 0; i < count; i++) {
        linkage->bodies[i].start = motions[i];
        linkage->bodies[i].start.angle -= back_rad[i];
    }
    const bool has_joint = linkage->joint_count > 0;
    const double back = has_joint ? turned_back(linkage, linkage->torque.joint, back_rad) : 0.0;
    free(back_rad);
    return back;
}

// Where pins and blocks stand in their play, to more digits than the bodies' positions have.
static void start_in_play(const JointState *state, Joint *joint)
{
    joint_rows_set_start(joint, joint_slides(joint->kind)
                                    ? (Vec2){state->eccentricity.y, state->tilt}
                                    : state->eccentricity);
}

// What time and the crank's angle, which begin anew, count more for the loads.
static void shift_loads(Linkage *linkage, double time_s, double turns_rad)
{
    for (size_t i = 0; i < linkage->load_count; i++) {
        Load *load = &linkage->loads[i];
        load->shift += load->over == LOAD_OVER_TIME    ? time_s
                       : load->over == LOAD_OVER_CRANK ? turns_rad
                                                       : 0.0;
        const bool is_wave = wave_exists(&load->table.wave);
        const double period = is_wave ? wave_period(&load->table.wave) : load->table.period;
        if (period > 0.0) {
            // whole periods are none, to the last bit
            const double of_a_period = remainder(load->shift, period);
            const bool is_whole = fabs(of_a_period) <= PERIOD_ROUNDING * period;
            load->shift = is_whole ? 0.0 : of_a_period;
        }
    }
}

// Lets a drive start where it is at a time, within a turn. Returns the whole turns that it has
// made, rad.
static double turn_on(Driver *driver, double time_s)
{
    const double turned = drive_angle(driver, time_s) - driver->start;
    double of_a_turn = remainder(turned, 2.0 * M_PI);
    of_a_turn = fabs(of_a_turn) > TURN_ROUNDING * fabs(turned) ? of_a_turn : 0.0;
    driver->start += of_a_turn;
    return 2.0 * M_PI * round((turned - of_a_turn) / (2.0 * M_PI));
}

void run_state_start(const RunState *state, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    double turns_rad = 0.0;
    if (linkage->driver.is_present) {
        turns_rad = turn_on(&linkage->driver, state->time_s);
    }
    for (size_t i = 0; i < linkage->further_count; i++) {
        turn_on(&linkage->further[i], state->time_s);
    }
    Driver *followed = &linkage->torque.followed;
    if (followed->is_present) {
        const double turned_rad = turn_on(followed, state->time_s);
        followed->start += turned_rad;
    }
    if (linkage->is_spatial) {
        for (size_t i = 0; i < linkage->body_count; i++) {
            space_set_place(&state->sample.space_bodies[i], &linkage->bodies[i]);
        }
    } else {
        const double back_rad = start_in_plane(state, linkage);
        // a soft drive stays as far ahead of the crank as it was
        followed->start -= followed->is_present ? back_rad : 0.0;
        turns_rad += linkage->driver.is_present ? 0.0 : back_rad;
    }
    shift_loads(linkage, state->time_s, turns_rad);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        for (size_t k = 0; k < JOINT_PLACES; k++) {
            joint->contacts[k] = state->contacts[i][k];
        }
        start_in_play(&state->sample.joints[i], joint);
    }
}
