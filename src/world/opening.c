// Finds how far ODE's joints are open in a staggered step, and what that moves.
//
// Rows J v' = -(e / h) Phi, e the ERP, hold joints that are open by Phi at mid-step. With c the
// centripetal acceleration of a joint's arms, speeds that belong to the step's end, J' v' = 0 with
// the arms there, need
//     J v' = -(h/2) c,   so   Phi = h^2 c / 2 e
// Joints come to that by themselves, Phi <- (1 - e) Phi + h^2 c / 2 from step to step, and at the
// end of a step are open by (1 - e/2) Phi + h^2 c / 8, 1 - e/4 of what they are at mid-step. Two
// things follow. With X = G Phi the least way of all bodies that opens the joints so far,
// - places are found where the bodies are, which is off by (1 - e/4) X at the step's start. A step
//   at half of the ERP tells X: its speeds differ from those of the whole by -(e / 2 h) X.
// - a first step, with closed joints, would have Phi = h^2 c / 8; one after steps of h0
//   (1 - e/4) h0^2 c / 2 e + h^2 c / 8. The bodies are opened to what is wanted before it.
// Joints that have an ERP of their own (ball, fixed) show nothing of it and stay as they are.
//
// Joints that are closed at the step's start, Phi = h^2 c / 8, and held by an ERP of 4
// (world/closing.c), have speeds that belong to its end. Before steps that close none they are
// opened to h^2 c / 2e, by (4/e - 1) X.
//
// Bodies may come with speeds that joints forbid. ODE corrects these within a step, however short:
//     v' = v + u + h a,   so   u = 2 (v'(h/2) - v) - (v'(h) - v)
// They open joints by (h/2) u until mid-step, which is not to be taken for h^2 c / 8 and
// multiplied.
#include "world/opening.h"

#include "world/coarse.h"
#include "world/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Of what a joint stays open by at mid-step: what it is open by at the ends.
static double share_at_ends(double erp)
{
    return 1.0 - 0.25 * erp;
}

// Makes a step at half of the ERP, beside one whose speeds are given, and tells X.
static JpStatus try_half(JpWorld *world, double step, double erp, const double *speeds,
                         JpError *error)
{
    const JpStatus status = trial_step(world, step, error);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        BodyRecord *record = &world->bodies.records[i];
        bodies_read_speeds(record, record->opening);
        for (int k = 0; k < BODY_NUMBERS; k++) {
            const double by = record->opening[k] - speeds[BODY_NUMBERS * i + k];
            record->opening[k] = erp > 0.0 ? 2.0 * step / erp * by : 0.0;
        }
    }
    bodies_put_back(&world->bodies);
    return status;
}

JpStatus opening_find(JpWorld *world, double step, const double *speeds, JpError *error)
{
    const double erp = dWorldGetERP(world->id);
    dWorldSetERP(world->id, 0.5 * erp);
    const JpStatus status = try_half(world, step, erp, speeds, error);
    dWorldSetERP(world->id, erp);
    return status;
}

double opening_shift(const JpWorld *world, const Direction *direction)
{
    double shift = 0.0;
    for (int i = 0; i < 2; i++) {
        const dBodyID body = direction->bodies[i];
        const BodyRecord *record = body != NULL ? bodies_find(&world->bodies, body) : NULL;
        if (record != NULL) {
            const double moved = direction_of_move(direction, i, record->opening);
            shift += i == 0 ? moved : -moved;
        }
    }
    return share_at_ends(dWorldGetERP(world->id)) * shift;
}

JpStatus opening_open(JpWorld *world, Closing *closing, double step, const double *speeds,
                      JpError *error)
{
    closing_hold(world, closing, 0.5 * CLOSING_ERP);
    const JpStatus status = try_half(world, step, CLOSING_ERP, speeds, error);
    closing_release(world, closing);
    REFUSAL_TRY(status);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        BodyRecord *record = &world->bodies.records[i];
        const double *now = &speeds[BODY_NUMBERS * i];
        bodies_move_kept(record, record->opening, CLOSING_ERP / closing->erp - 1.0);
        record->past.is_closed = false;
        dBodySetLinearVel(record->id, now[0], now[1], now[2]);
        dBodySetAngularVel(record->id, now[3], now[4], now[5]);
        dBodySetForce(record->id, 0, 0, 0);
        dBodySetTorque(record->id, 0, 0, 0);
    }
    bodies_put_back_positions(&world->bodies);
    return JP_OK;
}

// What the joints are open by at mid-step as they come, and as they are to be, over c.
static double open_too_little(const JpWorld *world, double step)
{
    const double erp = dWorldGetERP(world->id);
    const double before = share_at_ends(erp) * world->last_step * world->last_step / (2.0 * erp);
    const double found = before + 0.125 * step * step;
    const double wanted = step * step / (2.0 * erp);
    return wanted / found - 1.0;
}

// Joints of bodies that rest stay closed.
static bool is_any_moving(const Bodies *bodies)
{
    for (size_t i = 0; i < bodies->count; i++) {
        const BodyRecord *record = &bodies->records[i];
        for (int k = 0; k < 3; k++) {
            if (record->kept.velocity[k] != 0.0 || record->kept.omega[k] != 0.0) {
                return true;
            }
        }
    }
    return false;
}

// Of the kinetic energy: what ODE's joints may correct at once. With speeds that joints allow it is
// the square of half the angle by which bodies turn in the step, for arms are those of mid-step.
static const double CORRECTED_SHARE = 1e-2;

static double kinetic(dBodyID body, const double *speeds)
{
    dMass mass;
    dVector3 spin;
    dVector3 momentum;
    dBodyGetMass(body, &mass);
    dBodyVectorFromWorld(body, speeds[3], speeds[4], speeds[5], spin);
    dMultiply0_331(momentum, mass.I, spin);
    const double square = speeds[0] * speeds[0] + speeds[1] * speeds[1] + speeds[2] * speeds[2];
    return 0.5 * mass.mass * square + 0.5 * dCalcVectorDot3(spin, momentum);
}

// What gravity alone gives a body in a step: beside that, what a body at rest has is rounding.
static double kinetic_of_fall(const JpWorld *world, dBodyID body, double step)
{
    dVector3 gravity;
    dWorldGetGravity(world->id, gravity);
    double speeds[BODY_NUMBERS] = {0.0};
    for (int k = 0; k < 3; k++) {
        speeds[k] = step * gravity[k];
    }
    return kinetic(body, speeds);
}

// Whether the joints correct more of the speeds than that, from those after a whole step.
static JpStatus find_correction(JpWorld *world, double step, const double *speeds, bool *is_large,
                                JpError *error)
{
    double whole = 0.0;
    double corrected = 0.0;
    const JpStatus status = trial_step(world, 0.5 * step, error);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const BodyRecord *record = &world->bodies.records[i];
        double before[BODY_NUMBERS];
        double by[BODY_NUMBERS];
        memcpy(before, record->kept.velocity, 3 * sizeof *before);
        memcpy(before + 3, record->kept.omega, 3 * sizeof *before);
        bodies_read_speeds(record, by);
        for (int k = 0; k < BODY_NUMBERS; k++) {
            by[k] = 2.0 * by[k] - before[k] - speeds[BODY_NUMBERS * i + k];
        }
        if (!dBodyIsKinematic(record->id)) {
            whole += kinetic(record->id, before) + kinetic_of_fall(world, record->id, step);
            corrected += kinetic(record->id, by);
        }
    }
    bodies_put_back(&world->bodies);
    *is_large = !(corrected <= CORRECTED_SHARE * whole);
    return status;
}

// Finds what the joints are open by, and moves the bodies.
static JpStatus open_joints(JpWorld *world, double step, const double *speeds, JpError *error)
{
    REFUSAL_TRY(opening_find(world, step, speeds, error));
    for (size_t i = 0; i < world->bodies.moving; i++) {
        BodyRecord *record = &world->bodies.records[i];
        if (!record->past.is_closed) {
            bodies_move_kept(record, record->opening, open_too_little(world, step));
        }
    }
    bodies_put_back_positions(&world->bodies);
    return JP_OK;
}

// Opens them where they came closed, to bodies whose speeds they allow.
static JpStatus settle(JpWorld *world, double step, double *speeds, JpError *error)
{
    bool is_large = false;
    REFUSAL_TRY(trial_step(world, step, error));
    for (size_t i = 0; i < world->bodies.moving; i++) {
        bodies_read_speeds(&world->bodies.records[i], &speeds[BODY_NUMBERS * i]);
    }
    bodies_put_back(&world->bodies);
    if (step > world->last_step) {
        REFUSAL_TRY(find_correction(world, step, speeds, &is_large, error));
    }
    if (is_large) {
        coarse_note(world,
                    "ODE's joints are open or forbid the speeds of bodies, and correct that in "
                    "the step of %g s; close them, and give bodies speeds that they allow",
                    step);
        return JP_OK;
    }
    if (world->options.stepping == JP_STEPPING_IMPULSE && world->last_step == 0.0 &&
        world->bodies.reach == world->bodies.count && closing_is_linear(world) &&
        closing_is_possible(world, step)) {
        // contacts within the step want them closed
        for (size_t i = 0; i < world->bodies.reach; i++) {
            world->bodies.records[i].past.is_closed = true;
        }
        return JP_OK;
    }
    return open_joints(world, step, speeds, error);
}

JpStatus opening_settle(JpWorld *world, double step, JpError *error)
{
    const bool can_try = !world->options.is_quick && dWorldGetERP(world->id) > 0.0 &&
                         is_any_moving(&world->bodies) && trial_check(world, NULL) == JP_OK;
    if (!can_try) {
        return JP_OK;
    }
    double *speeds = world->settling =
        malloc((BODY_NUMBERS * world->bodies.moving + 1) * sizeof *speeds);
    if (speeds == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the first step");
    }
    const JpStatus status = settle(world, step, speeds, error);
    free(speeds);
    world->settling = NULL;
    return status;
}
