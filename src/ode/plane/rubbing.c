// Lets ideal pivots in ODE rub: a row about the axis of each.
//
// T = mu R F is what sliding holds, F the joint's force in the step, extrapolated from those of the
// last two: second order. Of the law T tanh(w / w_s), with its value f and slope c at the step's
// start, the torque is
//     -f - c (w' - w) / 2     the row  J w' + (2/c) t = w  beside a torque -f    (staggered)
//     -f - c (w' - w)         the row  J w' + (1/c) t = w                        (plain)
// a step of Rosenbrock's kind: second order, and stable while the law does not bend within the
// step. Where friction would change the speed by more than w_s / 2 it is a row with a bound
// instead,
//     J w' + (w_s / T) t = 0,  |t| <= T
// Friction that sticks is a row with a bound that holds the bodies against each other,
//     J w' = 0,  |t| <= T g(w)
// without presliding; exact while it sticks and while it slides. A step in which the sliding turns
// round has the friction behind that all through; what it is short of, by the share s of the step
// before it,
//     2 s T g,   s = w / -(gain of the rate in the step before it)
// is given in the next step: second order.
#include "ode/plane/rubbing.h"

#include "base/zeroed.h"
#include "kernel/friction_law.h"
#include "model/joint_friction.h"

#include <math.h>

// 1: of w_s, by which friction may change the speed where its law is linearised
static const double RUBBING_STEEP = 0.5;

// 1: of the speed that friction changes in a step: what a row that holds may slip. Rows of loops
// that hold already would have no solution with none.
static const double RUBBING_SLIP = 1e-8;

// 1: of w_s: a slope below this share of T / w_s is none
static const double RUBBING_SLOPE_LEAST = 1e-9;

void rubbing_make(const Scenario *scenario, dWorldID world, const dBodyID *bodies, Rubbing *rubbing)
{
    const Linkage *linkage = &scenario->linkage;
    *rubbing = (Rubbing){.linkage = linkage, .bodies = bodies};
    rubbing->rows = zeroed(linkage->joint_count, sizeof *rubbing->rows);
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_friction_is(joint) || !joint_pivots(joint->kind)) {
            continue;
        }
        RubbingRow *row = &rubbing->rows[rubbing->count++];
        const double radius = joint_friction_radius(joint);
        *row = (RubbingRow){
            .joint = i,
            .law = joint_friction_whole(&scenario->contact, joint),
            .arm = joint->contact.has_friction ? joint->contact.friction * radius : 0.0,
            .radius = radius,
        };
        int sides[2];
        linkage_turning(linkage, i, &sides[0], &sides[1]);
        for (int side = 0; side < 2; side++) {
            const int body = sides[side];
            const bool is_free = body != LINKAGE_GROUND && !linkage_is_driven(linkage, body);
            row->mobility += is_free ? 1.0 / linkage->bodies[body].inertia : 0.0;
        }
        if (row->mobility > 0.0) {
            row->row = dJointCreateAMotor(world, 0);
            dJointAttach(row->row, bodies[sides[0]],
                         sides[1] == LINKAGE_GROUND ? 0 : bodies[sides[1]]);
            dJointSetAMotorMode(row->row, dAMotorUser);
            dJointSetAMotorNumAxes(row->row, 1);
            dJointSetAMotorAxis(row->row, 0, 0, 0.0, 0.0, 1.0);
        }
    }
    // ODE keeps pointers to these
    for (size_t i = 0; i < rubbing->count; i++) {
        if (rubbing->rows[i].row != NULL) {
            dJointSetFeedback(rubbing->rows[i].row, &rubbing->rows[i].feedback);
        }
    }
}

void rubbing_finish(Rubbing *rubbing)
{
    free(rubbing->rows);
    *rubbing = (Rubbing){.linkage = NULL};
}

void rubbing_carry(Rubbing *rubbing, Carry *carry)
{
    for (size_t i = 0; i < rubbing->count; i++) {
        CARRY(carry, rubbing->rows[i].pressing);
        CARRY(carry, rubbing->rows[i].known);
        CARRY(carry, rubbing->rows[i].gained);
        CARRY(carry, rubbing->rows[i].late);
    }
}

static double rate_of(const Rubbing *rubbing, int joint)
{
    int sides[2];
    double rates[2] = {0.0, 0.0};
    linkage_turning(rubbing->linkage, joint, &sides[0], &sides[1]);
    for (int side = 0; side < 2; side++) {
        if (sides[side] != LINKAGE_GROUND) {
            rates[side] = dBodyGetAngularVel(rubbing->bodies[sides[side]])[2];
        }
    }
    return rates[0] - rates[1];
}

static BristlePair pair_of(const RubbingRow *row)
{
    return (BristlePair){
        .law = row->law.law, .ratio = row->law.ratio, .speed = row->law.speed / row->radius};
}

static void set_row(RubbingRow *row, double wanted, double softness, double most)
{
    row->has_row = true;
    dJointEnable(row->row);
    dJointSetAMotorParam(row->row, dParamVel, wanted);
    dJointSetAMotorParam(row->row, dParamCFM, softness);
    dJointSetAMotorParam(row->row, dParamFMax, most);
}

static void set_smooth(RubbingRow *row, double step_s, AppliedRule rule)
{
    const double speed = row->law.speed / row->radius;
    if (row->torque * row->mobility * step_s > RUBBING_STEEP * speed) {
        set_row(row, 0.0, speed / row->torque, row->torque);
        return;
    }
    const FrictionHold hold = friction_hold(row->rate, speed);
    const double slope = row->torque * hold.slope;
    row->pushed -= row->torque * hold.held;
    if (slope > RUBBING_SLOPE_LEAST * row->torque / speed) {
        const double share = rule == APPLIED_AT_MEAN ? 0.5 : 1.0;
        set_row(row, row->rate, 1.0 / (share * slope), dInfinity);
    }
}

void rubbing_push(Rubbing *rubbing, double step_s, AppliedRule rule)
{
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        const double next =
            row->known > 1 ? 2.0 * row->pressing[0] - row->pressing[1] : row->pressing[0];
        row->rate = rate_of(rubbing, row->joint);
        row->torque = row->arm > 0.0 ? row->arm * fmax(next, 0.0) : row->law.steady;
        row->pushed = row->late;
        row->late = 0.0;
        row->has_row = false;
        if (row->row == NULL) {
            continue;
        }
        dJointDisable(row->row);
        if (row->torque > 0.0 && row->law.law == BRISTLE_REGULARIZED) {
            set_smooth(row, step_s, rule);
        } else if (row->torque > 0.0) {
            const BristlePair pair = pair_of(row);
            set_row(row, 0.0, RUBBING_SLIP * row->mobility * step_s,
                    row->torque * bristle_left(&pair, row->rate));
        }
        int sides[2];
        linkage_turning(rubbing->linkage, row->joint, &sides[0], &sides[1]);
        for (int side = 0; side < 2 && row->pushed != 0.0; side++) {
            if (sides[side] != LINKAGE_GROUND) {
                dBodyAddTorque(rubbing->bodies[sides[side]], 0.0, 0.0,
                               side == 0 ? row->pushed : -row->pushed);
            }
        }
    }
}

// What a step is owed in which sliding that sticks has turned round.
static void note_turn(RubbingRow *row, double end_rate)
{
    const double gained = end_rate - row->rate;
    const bool has_turned = row->rate * end_rate < 0.0 && row->gained * row->rate < 0.0;
    if (row->law.law == BRISTLE_STICK && row->has_row && has_turned) {
        const double share = fmin(1.0, fabs(row->rate / row->gained));
        row->late = -2.0 * share * copysign(row->torque, row->rate);
    }
    row->gained = gained;
}

double rubbing_book(Rubbing *rubbing, double step_s, BodyLoad *loads, JointState *joints)
{
    double lost = 0.0;
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        const double end_rate = rate_of(rubbing, row->joint);
        const double mean = 0.5 * (row->rate + end_rate);
        double moment = row->pushed + (row->has_row ? row->feedback.t1[2] : 0.0);
        if (row->row == NULL) {
            const BristlePair pair = pair_of(row);
            moment = row->law.law == BRISTLE_REGULARIZED
                         ? -row->torque * friction_hold(mean, pair.speed).held
                         : -row->torque * copysign(bristle_left(&pair, mean), mean);
        }
        forces_add_moment(rubbing->linkage, row->joint, moment, loads);
        row->moment = moment;
        joints[row->joint].moment_on_b = 0.0;
        lost -= step_s * moment * mean;
        note_turn(row, end_rate);
    }
    return lost;
}

void rubbing_note(Rubbing *rubbing, JointState *joints)
{
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        row->pressing[1] = row->pressing[0];
        row->pressing[0] = joints[row->joint].force;
        row->known++;
        int sides[2];
        linkage_turning(rubbing->linkage, row->joint, &sides[0], &sides[1]);
        const bool is_of_b = sides[0] == rubbing->linkage->joints[row->joint].body_b;
        joints[row->joint].moment_on_b = is_of_b ? row->moment : -row->moment;
    }
}
