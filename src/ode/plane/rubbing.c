// Lets ideal pivots in ODE rub: a row about the axis of each, which contact/rub_row.c finds.
#include "ode/plane/rubbing.h"

#include "base/zeroed.h"
#include "kernel/friction_law.h"
#include "model/joint_friction.h"

#include <math.h>

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
        *row = (RubbingRow){
            .joint = i,
            .rub =
                {
                    .pair = joint_friction_pair(&scenario->contact, joint),
                    .steady = joint->friction.steady,
                    .arm = joint_friction_arm(joint),
                    .mobility = joint_friction_mobility(linkage, joint),
                },
        };
        int sides[2];
        linkage_turning(linkage, i, &sides[0], &sides[1]);
        if (row->rub.mobility > 0.0) {
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
        CARRY(carry, rubbing->rows[i].rub.pressing);
        CARRY(carry, rubbing->rows[i].rub.known);
        CARRY(carry, rubbing->rows[i].rub.gained);
        CARRY(carry, rubbing->rows[i].rub.late);
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

static void set_row(RubbingRow *row)
{
    const RubRow *rub = &row->rub;
    dJointEnable(row->row);
    dJointSetAMotorParam(row->row, dParamVel, rub->wanted);
    dJointSetAMotorParam(row->row, dParamCFM, rub->softness);
    dJointSetAMotorParam(row->row, dParamFMax, rub->most);
}

void rubbing_push(Rubbing *rubbing, double step_s, AppliedRule rule)
{
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        RubRow *rub = &row->rub;
        rub_row_begin(rub, rate_of(rubbing, row->joint));
        if (row->row == NULL) {
            continue;
        }
        dJointDisable(row->row);
        rub_row_set(rub, step_s, rule == APPLIED_AT_MEAN);
        if (rub->has_row) {
            set_row(row);
        }
        int sides[2];
        linkage_turning(rubbing->linkage, row->joint, &sides[0], &sides[1]);
        for (int side = 0; side < 2 && rub->pushed != 0.0; side++) {
            if (sides[side] != LINKAGE_GROUND) {
                dBodyAddTorque(rubbing->bodies[sides[side]], 0.0, 0.0,
                               side == 0 ? rub->pushed : -rub->pushed);
            }
        }
    }
}

double rubbing_book(Rubbing *rubbing, double step_s, BodyLoad *loads, JointState *joints)
{
    double lost = 0.0;
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        const double end_rate = rate_of(rubbing, row->joint);
        const RubRow *rub = &row->rub;
        const double mean = 0.5 * (rub->rate + end_rate);
        double moment = rub->pushed + (rub->has_row ? row->feedback.t1[2] : 0.0);
        if (row->row == NULL) {
            moment = rub->pair.law == BRISTLE_REGULARIZED
                         ? -rub->torque * friction_hold(mean, rub->pair.speed).held
                         : -rub->torque * copysign(bristle_left(&rub->pair, mean), mean);
        }
        forces_add_moment(rubbing->linkage, row->joint, moment, loads);
        row->moment = moment;
        joints[row->joint].moment_on_b = 0.0;
        lost -= step_s * moment * mean;
        rub_row_end(&row->rub, end_rate);
    }
    return lost;
}

void rubbing_note(Rubbing *rubbing, JointState *joints)
{
    for (size_t i = 0; i < rubbing->count; i++) {
        RubbingRow *row = &rubbing->rows[i];
        rub_row_note(&row->rub, joints[row->joint].force);
        int sides[2];
        linkage_turning(rubbing->linkage, row->joint, &sides[0], &sides[1]);
        const bool is_of_b = sides[0] == rubbing->linkage->joints[row->joint].body_b;
        joints[row->joint].moment_on_b = is_of_b ? row->moment : -row->moment;
    }
}
