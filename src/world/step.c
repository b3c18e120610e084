// Steps a world in which coordinates have play.
//
// Plain, from t = n h: sides that overlap get a row of map midpoint, and ODE steps; that is right
// as far as the velocities are those half a step before the positions. Staggered: bodies move by
// h/2 along their velocities; there, at mid-step, sides that overlap get the same row and ODE steps
// the velocities from t to t + h; from mid-step on bodies move by h/2 along the new ones. Positions
// at mid-step are those of a leapfrog; before and after the step positions and velocities belong to
// one time.
//
// The row. The force F >= 0 on a side of sign s pushes the coordinate q by s F and a rotor of
// inertia J under a drive D the other way, so that the rotor's speed after the step is p' = p +
// (h/J) (D - s F). The map's row is of the rate of q - p:
//     s (q' - p') + CFM F = (ERP/h) d    is    s q' + (CFM + h/J) F = (ERP/h) d + s (p + (h/J) D)
// a row of ODE's bodies alone.
#include "world/step.h"
#include "world/coarse.h"
#include "world/fault.h"
#include "world/found.h"
#include "world/friction.h"
#include "world/geoms.h"
#include "world/gyration.h"
#include "world/impulse.h"
#include "world/inside.h"
#include "world/joints.h"
#include "world/opening.h"
#include "world/pin.h"
#include "world/row.h"
#include "world/threads.h"
#include "world/trial.h"
#include "world/work.h"

#include <math.h>
#include <stdlib.h>

static bool is_staggered(const JpWorld *world)
{
    return world->options.stepping != JP_STEPPING_PLAIN;
}

// Time constants of a damper in a step, above which it acts on the speed after the step: on the
// mean of both it would throw back what it stops.
static const double STOPPED = 2.0;

static bool is_stopped(const MapContact *contact, double mobility)
{
    return contact->damping * mobility * contact->step > STOPPED;
}

static const Map *map_for(const MapContact *contact, double mobility)
{
    return map_get(is_stopped(contact, mobility) ? ODE_MAP_CORRECTED : ODE_MAP_MIDPOINT);
}

static JpStatus gather(JpWorld *world, JpError *error)
{
    size_t count = geoms_list(world, NULL);
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        count += 2;
    }
    dBodyID *seeds = malloc((count + 1) * sizeof *seeds);
    bool is_done = seeds != NULL;
    if (is_done) {
        size_t filled = geoms_list(world, seeds);
        for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
            seeds[filled++] = joint->bodies[0];
            seeds[filled++] = joint->bodies[1];
        }
        is_done = bodies_gather(&world->bodies, seeds, count);
    }
    free(seeds);
    return is_done ? JP_OK
                   : refusal(error, JP_ERROR_MEMORY, "there is no memory for the world's bodies");
}

// Fails as the law of a side that touches gives no force.
static JpStatus refuse_depth(const JpJoint *joint, const Side *side, double step, JpError *error)
{
    const double limit = force_law_depth_limit(&side->law);
    const char *unit = play_unit(joint);
    if (side->depth > limit) {
        return refusal(error, JP_ERROR_WORLD,
                       "%s is %g %s beyond its play, and its contact's law holds to %g %s; the "
                       "step of %g s may be too long",
                       play_name(joint).text, side->depth, unit, limit, unit, step);
    }
    return refusal(error, JP_ERROR_WORLD,
                   "%s is %g %s beyond its play, where its contact's law gives no finite force "
                   "above 0; the step of %g s may be too long",
                   play_name(joint).text, side->depth, unit, step);
}

// Whether the law of a side that touches gives a spring and damper there.
static JpStatus check_contact(const JpJoint *joint, const Side *side, double step, JpError *error)
{
    const MapContact contact = side_contact(side, step);
    return map_contact_is_sound(&contact) ? JP_OK : refuse_depth(joint, side, step, error);
}

// Steps to a contact, below which rows have its force wrong by more than some percent.
static const double STEPS_TO_A_CONTACT = 3.0;

enum { DEPTH_DOUBLINGS = 200, DEPTH_HALVINGS = 20 }; // of a depth, to a part in a million

// How long an undamped impact at the speed of the onset lasts, s: pi times the depth that it
// reaches over its speed on a linear spring, and 2.94 times on Hertz's. At that depth the law has
// taken up the energy v^2 / (2 mobility). It has none beyond its limit, which ends the search, too.
static double impact_duration(const Side *side, double mobility, double step)
{
    const double speed = side->state.impact_speed;
    const double energy = 0.5 * speed * speed / mobility;
    double high = speed * step;
    for (int i = 0; i < DEPTH_DOUBLINGS && force_law_energy(&side->law, high) < energy; i++) {
        high *= 2.0;
    }
    double low = 0.0;
    for (int i = 0; i < DEPTH_HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (force_law_energy(&side->law, middle) < energy) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return speed > 0.0 ? M_PI * high / speed : INFINITY;
}

// Whether fewer steps than that are in the impact of a side, or in half an oscillation at its
// depth.
static bool is_too_short(Side *side, double mobility, double step)
{
    if (side->begins) {
        side->lasts = impact_duration(side, mobility, step);
    }
    const double steps = STEPS_TO_A_CONTACT * step / M_PI;
    return (side->age <= side->lasts && STEPS_TO_A_CONTACT * step > side->lasts) ||
           steps * steps * force_law_tangent(&side->law, side->depth) * mobility > 1.0;
}

// Notes a step that is too long for the contact of a side. With free bodies that is as short as it
// can be; where it is too short, the world's own mobility is found by trial.
static void note_short_contact(const JpJoint *joint, const Place *place, Side *side, double step)
{
    JpWorld *world = joint->world;
    side->tried = side->begins ? 0.0 : side->tried;
    const double mobility = side->tried > 0.0 ? side->tried : play_mobility(joint, place);
    bool is_short = is_too_short(side, mobility, step);
    const double force = side->sign * force_law_elastic(&side->law, side->depth);
    double found = 0.0;
    if (is_short && side->tried == 0.0 && !world->options.is_quick && force != 0.0 &&
        isfinite(force) &&
        trial_mobility(world, &place->along, force, step, &found, NULL) == JP_OK) {
        side->tried = found + 1.0 / joint->rotor.inertia;
        side->lasts = impact_duration(side, side->tried, step);
        is_short = is_too_short(side, side->tried, step);
    }
    if (is_short) {
        coarse_note(world, "a contact of %s or its oscillation lasts less than %g steps of %g s",
                    play_name(joint).text, STEPS_TO_A_CONTACT, step);
    }
}

// The mobility with which a side's map is chosen: of free bodies, which is never below the world's,
// where that is low enough for map midpoint; or, once in a contact, found by trial.
static JpStatus find_mobility(JpJoint *joint, Place *place, Side *side, double step, JpError *error)
{
    JpWorld *world = joint->world;
    REFUSAL_TRY(check_contact(joint, side, step, error));
    note_short_contact(joint, place, side, step);
    const double free = play_mobility(joint, place);
    const MapContact contact = side_contact(side, step);
    const bool is_stable = side_is_stable(side, map_get(ODE_MAP_MIDPOINT), free, step);
    if (side->mobility > 0.0 || (is_stable && !is_stopped(&contact, free))) {
        return JP_OK;
    }
    const double force = side->sign * force_law_elastic(&side->law, side->depth);
    if (force == 0.0 || !isfinite(force)) {
        return JP_OK; // no push to try with
    }
    const JpStatus known = trial_check(world, error);
    if (known == JP_ERROR_WORLD && is_stable) {
        coarse_note(world,
                    "how hard %s is damped in the step of %g s cannot be tried in a world with "
                    "bodies that are not known; add them with jp_world_add_all",
                    play_name(joint).text, step);
        return JP_OK;
    }
    REFUSAL_TRY(known);
    REFUSAL_TRY(trial_mobility(world, &place->along, force, step, &side->mobility, error));
    side->mobility += 1.0 / joint->rotor.inertia;
    return JP_OK;
}

static JpStatus make_row(JpJoint *joint, Place *place, Side *side, double step, JpError *error)
{
    JpWorld *world = joint->world;
    const double mobility = side->mobility > 0.0 ? side->mobility : play_mobility(joint, place);
    const MapContact contact = side_contact(side, step);
    const bool falls_back = !side_is_stable(side, map_get(ODE_MAP_MIDPOINT), mobility, step);
    const ErpCfm row = law_row_soft(map_for(&contact, mobility), falls_back, &contact);
    const Rotor *rotor = &joint->rotor;
    const double yield = isfinite(rotor->inertia) ? step / rotor->inertia : 0.0;
    const double speed =
        row.erp / step * side->depth + side->sign * (rotor->speed + yield * rotor->drive);
    if (!isfinite(speed) || !isfinite(row.cfm)) {
        return refuse_depth(joint, side, step, error);
    }
    row_make(joint, place, side, row.cfm + yield, speed, step);
    world->stats.rows++;
    if (falls_back) {
        world->stats.fallbacks++;
        coarse_note(world,
                    "the oscillation of %s in a contact is too fast for the step of %g s: its row "
                    "presses as the textbook's map has it",
                    play_name(joint).text, step);
    }
    return JP_OK;
}

static void find_places(JpWorld *world)
{
    joints_find(world, world->options.stepping == JP_STEPPING_IMPULSE);
}

// Bodies where forces are evaluated, contacts made, places found.
static void go_there(JpWorld *world, double step)
{
    joints_start(world);
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_staggered(world)) {
            joint->rotor.position += 0.5 * step * joint->rotor.speed;
        }
    }
    if (is_staggered(world)) {
        bodies_drift(&world->bodies, 0.5 * step);
    }
    geoms_touch(world);
    if (world->options.collide != NULL) {
        // what ODE finds wrong there is the caller's
        Fault *fault = fault_suspend();
        world->options.collide(world->id, world->options.collide_data);
        fault_resume(fault);
    }
    find_places(world);
}

typedef JpStatus (*SideFunction)(JpJoint *joint, Place *place, Side *side, double step,
                                 JpError *error);

static JpStatus each_touching(JpWorld *world, SideFunction function, double step, JpError *error)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            Place *place = &joint->places[i];
            for (size_t k = 0; k < place_side_count(place); k++) {
                if (place->sides[k].state.is_touching) {
                    REFUSAL_TRY(function(joint, place, &place->sides[k], step, error));
                }
            }
        }
    }
    return JP_OK;
}

// A step in which a place leaves one side and reaches the other has one row for both: it is that of
// the side that is reached, or the place would fly through it.
static void press_one(const JpJoint *joint, Place *place, double step)
{
    Side *low = &place->sides[0];
    Side *high = &place->sides[1];
    if (place_side_count(place) == SIDE_COUNT && low->state.is_touching &&
        high->state.is_touching) {
        Side *left = low->closing > 0.0 ? high : low;
        left->state.is_touching = false;
        coarse_note(joint->world, "%s crosses its play within a step of %g s",
                    play_name(joint).text, step);
    }
}

static void find_sides(JpJoint *joint, double earlier, double step)
{
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        for (size_t k = 0; k < place_side_count(place); k++) {
            const SideMotion motion = place_motion(place, k, earlier, step);
            side_find(&place->sides[k], &motion, step);
        }
        press_one(joint, place, step);
    }
}

static JpStatus check_work(const JpWorld *world, double step, JpError *error)
{
    const double work = work_of_rows(world);
    return work <= world->work_most
               ? JP_OK
               : refusal(error, JP_ERROR_WORK,
                         "the rows of the contacts in the step of %g s take work of %.3g, of at "
                         "most %.3g; jp_world_set_work_limit allows more",
                         step, work, world->work_most);
}

static JpStatus make_rows(JpWorld *world, double step, JpError *error)
{
    const double earlier = is_staggered(world) ? 0.5 * step : 0.0;
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        find_sides(joint, earlier, step);
    }
    REFUSAL_TRY(check_work(world, step, error));
    // trials see the world without our rows
    JpStatus status = each_touching(world, find_mobility, step, error);
    return status == JP_OK ? each_touching(world, make_row, step, error) : status;
}

// Takes the forces of a place's rows, and moves its rotor on by them.
static void take_forces(JpJoint *joint, Place *place, double step, double forces[SIDE_COUNT])
{
    forces[0] = forces[1] = 0.0;
    for (size_t i = 0; i < place_side_count(place); i++) {
        if (place->sides[i].state.is_touching) {
            forces[i] = row_take(place);
        }
    }
    Rotor *rotor = &joint->rotor;
    if (isfinite(rotor->inertia)) {
        rotor->speed += step / rotor->inertia * (rotor->drive - forces[0] + forces[1]);
    }
}

static void book(JpJoint *joint, double step)
{
    joint->force = (Vec3){0.0, 0.0, 0.0};
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        double forces[SIDE_COUNT];
        take_forces(joint, place, step, forces);
        const double rate = play_rate(joint, place);
        for (size_t k = 0; k < place_side_count(place); k++) {
            side_book(&place->sides[k], forces[k], place->rate, rate, step);
        }
        if (forces[0] + forces[1] > 0.0 && place->row.motor == NULL) {
            const Vec3 force = row_force(joint, place);
            place->slid += row_slid(place, force, step);
            joint->force = vec3_add(joint->force, force);
        }
    }
    joint->rotor.position += (is_staggered(joint->world) ? 0.5 : 1.0) * step * joint->rotor.speed;
}

// The new velocities, with rows for what touches.
static JpStatus step_with_rows(JpWorld *world, double step, JpError *error)
{
    REFUSAL_TRY(make_rows(world, step, error));
    return trial_step(world, step, error);
}

// The same with contacts integrated within the step; with rows where that cannot be.
static JpStatus step_with_impulses(JpWorld *world, double step, WorldResponse *response,
                                   bool *is_done, JpError *error)
{
    REFUSAL_TRY(world_impulse_step(world, step, response, is_done, error));
    bodies_wake(&world->bodies);
    if (*is_done) {
        return JP_OK;
    }
    bodies_put_back(&world->bodies);
    world->stats.fallbacks++;
    coarse_note(world,
                "the contacts within the step of %g s take more than the limit of work: they "
                "were made with rows",
                step);
    return step_with_rows(world, step, error);
}

static void book_joints(JpWorld *world, double step)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        book(joint, step);
    }
}

static JpStatus move_on(JpWorld *world, double step, WorldResponse *response, bool is_impulse,
                        JpError *error)
{
    if (is_staggered(world)) {
        bodies_drift_kept(&world->bodies, 0.5 * step);
    }
    if (is_impulse) {
        REFUSAL_TRY(impulse_finish(world, step, response, error));
    } else {
        book_joints(world, step);
    }
    if (is_staggered(world)) {
        gyration_finish(&world->bodies, step);
    }
    friction_book(world, step);
    if (is_impulse) {
        inside_judge(response);
    }
    return JP_OK;
}

// Opens ODE's joints as far as they stay open at the step.
static JpStatus settle(JpWorld *world, double step, JpError *error)
{
    REFUSAL_TRY(opening_settle(world, step, error));
    find_places(world);
    return JP_OK;
}

static JpStatus step_bodies(JpWorld *world, double step, WorldResponse *response, JpError *error)
{
    if (is_staggered(world)) {
        gyration_push(&world->bodies, step);
    }
    bodies_keep(&world->bodies);
    const bool has_impulses = world->options.stepping == JP_STEPPING_IMPULSE;
    if (has_impulses) {
        impulse_reach(world);
    }
    if (is_staggered(world) && world->last_step != step) {
        REFUSAL_TRY(settle(world, step, error));
    }
    REFUSAL_TRY(friction_push(world, step, error));
    bool is_impulse = false;
    REFUSAL_TRY(has_impulses ? step_with_impulses(world, step, response, &is_impulse, error)
                             : step_with_rows(world, step, error));
    return move_on(world, step, response, is_impulse, error);
}

static JpStatus check_bodies(const JpWorld *world, double step, bool is_after, JpError *error)
{
    const char *name = NULL;
    if (bodies_are_in_range(&world->bodies, &name)) {
        return JP_OK;
    }
    return is_after ? refusal(error, JP_ERROR_WORLD,
                              "the %s of a body would be too large or no finite number after a "
                              "step of %g s; the world is as before it, take a shorter step",
                              name, step)
                    : refusal(error, JP_ERROR_WORLD,
                              "the %s of a body is too large or no finite number; the steps before "
                              "may have been too long",
                              name);
}

static JpStatus check_joints_after(const JpWorld *world, double step, JpError *error)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (!play_is_finite(joint)) {
            return refusal(
                error, JP_ERROR_WORLD,
                "%s would have a force, a work or a rotor's speed that is no finite number after "
                "a step of %g s; the world is as before it",
                play_name(joint).text, step);
        }
    }
    return JP_OK;
}

static JpStatus check_pins(const JpWorld *world, PinMoment moment, JpError *error)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (joint->kind == PLAY_PIN) {
            REFUSAL_TRY(pin_check_inside(joint, moment, error));
        }
    }
    return JP_OK;
}

static JpStatus make_step(JpWorld *world, double step, WorldResponse *response, JpError *error)
{
    go_there(world, step);
    REFUSAL_TRY(step_bodies(world, step, response, error));
    REFUSAL_TRY(check_bodies(world, step, true, error));
    REFUSAL_TRY(check_pins(world, PIN_STEPPED, error));
    return check_joints_after(world, step, error);
}

// ODE's solver goes on after such a message with some forces left at 0.
static void note_messages(JpWorld *world, const Fault *fault, double step)
{
    if (fault->message_count > 0) {
        coarse_note(world,
                    "ODE's solver did not find all forces of the step of %g s: \"%.60s\"; joints "
                    "may contradict each other",
                    step, fault->message);
    }
}

// A step that ODE cannot make fails, and no more.
static JpStatus make_step_guarded(JpWorld *world, double step, WorldResponse *response,
                                  JpError *error)
{
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        const JpStatus status = make_step(world, step, response, error);
        fault_end(&fault);
        note_messages(world, &fault, step);
        return status;
    }
    fault_end(&fault);
    threads_renew(world);
    if (fault.is_of_memory) {
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for a step");
    }
    return refusal(error, JP_ERROR_WORLD,
                   "ODE cannot make a step of %g s: \"%.100s\"; the world is as before it, its "
                   "joints may contradict each other or the step be too long",
                   step, fault.text);
}

// Outside of these a double cannot hold what ODE divides by the step or its square.
static const double STEP_LEAST = 1e-30; // s
static const double STEP_MOST = 1e30;

static JpStatus check_step(double step, JpError *error)
{
    REFUSAL_TRY(refusal_of_positive(step, "the step", error));
    return step >= STEP_LEAST && step <= STEP_MOST
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT, "the step is %g; it must be from %g to %g", step,
                         STEP_LEAST, STEP_MOST);
}

static JpStatus check_joints(const JpWorld *world, JpError *error)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        REFUSAL_TRY(play_check_bodies(joint, error));
    }
    return JP_OK;
}

JpStatus jp_world_step(JpWorld *world, double step, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(check_step(step, error));
    REFUSAL_TRY(check_joints(world, error));
    REFUSAL_TRY(gather(world, error));
    REFUSAL_TRY(check_bodies(world, step, false, error));
    REFUSAL_TRY(check_pins(world, PIN_FOUND, error));
    found_keep(world);
    coarse_begin(world);
    WorldResponse response = {0};
    const JpStatus status = make_step_guarded(world, step, &response, error);
    if (status != JP_OK) {
        found_put_back(world, &response);
    }
    world_response_free(&response);
    dJointGroupEmpty(world->rows);
    dJointGroupEmpty(world->contacts);
    if (status != JP_OK) {
        return status;
    }
    world->found.is_kept = true;
    world->stats.steps++;
    world->last_step = step;
    return coarse_end(world, error);
}

JpStatus step_know_bodies(JpWorld *world, JpError *error)
{
    REFUSAL_TRY(check_joints(world, error));
    return gather(world, error);
}

JpStatus jp_world_undo(JpWorld *world, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(check_joints(world, error));
    if (!world->found.is_kept) {
        return refusal(error, JP_ERROR_NONE,
                       "there is no step to take back: the last one failed or was taken back, the "
                       "world was saved or resumed since, or joints or bodies have changed");
    }
    WorldResponse none = {0};
    found_put_back(world, &none);
    world->found.is_kept = false;
    return refusal_none(error);
}
