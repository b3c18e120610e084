// Lets springs, bushings, dampers and a torque act on bodies in ODE.
//
// Springs, at the positions where the step stands, and the torque's mean over the step are forces.
// A damper with coefficient c takes the rate r of its length (or angle) at the step's start and r'
// at its end:
//     f = -c (r + r') / 2     is the row  J v' + (2/c) f = -r,   and -c d beside it where the mean
//                             rate is known to be d beyond that of start and end
//     f = -c r'               is the row  J v' + (1/c) f = 0
// J v' = r', CFM 2/c or 1/c. The first is the trapezoidal rule, second order and symmetric in time,
// and both are stable for any c. ODE's distance joint has the row of a line: its right-hand side is
// ERP / h (wanted distance - distance). An angular motor has that of a turn. The work is h f^2 / c.
//
// The row of a bushing along its axis e is that of a line from its point B on body b to B - l e on
// body a: its rate is e . (v_B - v_a(B)) whatever l is, and its force goes through B.
// Of a soft drive with a limit the row has the whole torque M = S - c (r + r') / 2, with S of the
// stiffness and of what it follows, and with ODE's bound on the force of a motor:
//     J v' + (2/c) M = -r + (2/c) S,   -L <= M <= L
// Without damping M is S within the limit.
#include "ode/plane/applied.h"

#include "base/zeroed.h"
#include "model/loads.h"

#include <string.h>

// m: below it ODE takes any direction for the line
static const double LINE_LEAST = 1e-6;

// m: the least length of the line of a bushing's row; any of the mechanism's own size would do
static const double LINE_BUSHING = 1e-2;

static dBodyID id_of(const Applied *applied, int body)
{
    return body == LINKAGE_GROUND ? 0 : applied->bodies[body];
}

// The distance joint of a spring's damper. Its first body is not the ground.
static void make_line(const Applied *applied, dWorldID world, const Motion *motions,
                      const Spring *spring, AppliedRow *row)
{
    const SpringLine line = forces_line(spring, motions);
    const int first = spring->body_a == LINKAGE_GROUND ? 1 : 0;
    const int bodies[2] = {spring->body_a, spring->body_b};
    row->row = dJointCreateDBall(world, 0);
    dJointAttach(row->row, id_of(applied, bodies[first]), id_of(applied, bodies[1 - first]));
    dJointSetDBallAnchor1(row->row, line.ends[first].x, line.ends[first].y, 0.0);
    dJointSetDBallAnchor2(row->row, line.ends[1 - first].x, line.ends[1 - first].y, 0.0);
    dJointSetFeedback(row->row, &row->feedback);
}

// The row of an angle of one body against another.
static void make_angle(const Applied *applied, dWorldID world, int turned, int against,
                       AppliedRow *row)
{
    row->row = dJointCreateAMotor(world, 0);
    dJointAttach(row->row, id_of(applied, turned), id_of(applied, against));
    dJointSetAMotorMode(row->row, dAMotorUser);
    dJointSetAMotorNumAxes(row->row, 1);
    dJointSetAMotorAxis(row->row, 0, 0, 0.0, 0.0, 1.0);
    dJointSetAMotorParam(row->row, dParamFMax, dInfinity);
    dJointSetFeedback(row->row, &row->feedback);
}

static void make_turn(const Applied *applied, dWorldID world, int joint, AppliedRow *row)
{
    int turned;
    int against;
    linkage_turning(applied->linkage, joint, &turned, &against);
    make_angle(applied, world, turned, against, row);
}

// The body that comes first in a bushing's rows, which is not the ground, and the other one; 1 or
// -1: the rows' force on the first is that on body a or on body b.
static double bushing_bodies(const Bushing *bushing, int *first, int *second)
{
    const bool is_held = bushing->body_a == LINKAGE_GROUND;
    *first = is_held ? bushing->body_b : bushing->body_a;
    *second = is_held ? LINKAGE_GROUND : bushing->body_b;
    return is_held ? -1.0 : 1.0;
}

// The rows of a bushing's dampers. Those of its axes are placed before every step.
static void make_bushing(const Applied *applied, dWorldID world, const Bushing *bushing,
                         AppliedRow *rows)
{
    int first;
    int second;
    bushing_bodies(bushing, &first, &second);
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        if (!(bushing_damping(bushing, row) > 0.0)) {
            continue;
        }
        if (row == 2) {
            make_angle(applied, world, first, second, &rows[row]);
            continue;
        }
        rows[row].row = dJointCreateDBall(world, 0);
        dJointAttach(rows[row].row, id_of(applied, first), id_of(applied, second));
        dJointSetFeedback(rows[row].row, &rows[row].feedback);
    }
}

// How many rows of dampers in gaps there is room for.
static size_t gap_room(const Linkage *linkage)
{
    return linkage->gap_damper_count > 0 ? GAP_DAMPING_ROWS * linkage->joint_count : 0;
}

// The body that comes first in the rows of a joint, which is not the ground: 0 that of body a.
static int first_side(const Joint *joint)
{
    return joint->body_a == LINKAGE_GROUND ? 1 : 0;
}

// The rows of a joint's damper in its gap. Those of forces are placed before every step.
static void make_gap(const Applied *applied, dWorldID world, const Motion *motions, int number,
                     AppliedRow *rows)
{
    const Joint *joint = &applied->linkage->joints[number];
    const int side = first_side(joint);
    const int first = linkage_end(joint, side).body;
    const int second = linkage_end(joint, 1 - side).body;
    GapDampingRow drags[GAP_DAMPING_ROWS];
    const size_t count = gap_damping_rows(applied->linkage, motions, number, drags);
    for (size_t i = 0; i < count; i++) {
        if (drags[i].is_turn) {
            make_angle(applied, world, first, second, &rows[i]);
            continue;
        }
        rows[i].row = dJointCreateDBall(world, 0);
        dJointAttach(rows[i].row, id_of(applied, first), id_of(applied, second));
        dJointSetFeedback(rows[i].row, &rows[i].feedback);
    }
}

void applied_make(const Linkage *linkage, dWorldID world, const dBodyID *bodies,
                  const Motion *motions, Applied *applied)
{
    applied->linkage = linkage;
    applied->bodies = bodies;
    applied->is_any = forces_any(linkage);
    applied->angles = zeroed(linkage->body_count, sizeof *applied->angles);
    applied->dampers = zeroed(linkage->spring_count, sizeof *applied->dampers);
    applied->torsions = zeroed(linkage->torsion_count, sizeof *applied->torsions);
    applied->bushings = zeroed(BUSHING_ROWS * linkage->bushing_count, sizeof *applied->bushings);
    applied->poses = zeroed(linkage->bushing_count, sizeof *applied->poses);
    applied->gaps = zeroed(gap_room(linkage), sizeof *applied->gaps);
    applied->drags = zeroed(gap_room(linkage), sizeof *applied->drags);
    applied->lines = zeroed(linkage->spring_count, sizeof *applied->lines);
    applied->motions = zeroed(linkage->body_count, sizeof *applied->motions);
    applied->seen = zeroed(linkage->body_count, sizeof *applied->seen);
    applied->late = zeroed(linkage->body_count, sizeof *applied->late);
    applied->loads = zeroed(linkage->body_count, sizeof *applied->loads);
    applied->pushed = zeroed(linkage->load_count, sizeof *applied->pushed);
    applied->rates = zeroed(linkage->load_count, sizeof *applied->rates);
    for (size_t i = 0; i < linkage->body_count; i++) {
        applied->angles[i] = motions[i].angle;
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (linkage->springs[i].damping > 0.0) {
            make_line(applied, world, motions, &linkage->springs[i], &applied->dampers[i]);
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        if (linkage->torsions[i].damping > 0.0) {
            make_turn(applied, world, linkage->torsions[i].joint, &applied->torsions[i]);
        }
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        make_bushing(applied, world, &linkage->bushings[i], &applied->bushings[BUSHING_ROWS * i]);
    }
    for (size_t i = 0; i < gap_room(linkage) / GAP_DAMPING_ROWS; i++) {
        make_gap(applied, world, motions, (int)i, &applied->gaps[GAP_DAMPING_ROWS * i]);
    }
    if (linkage->torque.slope > 0.0) {
        make_turn(applied, world, linkage->torque.joint, &applied->motor);
    }
}

void applied_finish(Applied *applied)
{
    free(applied->angles);
    free(applied->dampers);
    free(applied->torsions);
    free(applied->bushings);
    free(applied->poses);
    free(applied->gaps);
    free(applied->drags);
    free(applied->lines);
    free(applied->motions);
    free(applied->seen);
    free(applied->late);
    free(applied->loads);
    free(applied->pushed);
    free(applied->rates);
    *applied = (Applied){.linkage = NULL};
}

void applied_carry(Applied *applied, Carry *carry)
{
    const size_t count = applied->linkage->body_count;
    CARRY_ARRAY(carry, applied->angles, count);
    CARRY_ARRAY(carry, applied->motions, count);
    CARRY_ARRAY(carry, applied->loads, count);
    CARRY_ARRAY(carry, applied->lines, applied->linkage->spring_count);
    CARRY_ARRAY(carry, applied->poses, applied->linkage->bushing_count);
    CARRY_ARRAY(carry, applied->drags, gap_room(applied->linkage));
    CARRY_ARRAY(carry, applied->pushed, applied->linkage->load_count);
    CARRY_ARRAY(carry, applied->rates, applied->linkage->load_count);
    CARRY(carry, applied->torque);
    CARRY(carry, applied->turning);
}

// Whether a row has the whole torque of a drive with a limit.
static bool has_limited_row(const Applied *applied)
{
    return applied->motor.row != NULL && applied->linkage->torque.limit > 0.0;
}

// The bodies as the engine holds them, their angles in the turn that they were in last.
static void read_motions(const Applied *applied, Motion *motions)
{
    for (size_t i = 0; i < applied->linkage->body_count; i++) {
        const dReal *position = dBodyGetPosition(applied->bodies[i]);
        const dReal *rotation = dBodyGetRotation(applied->bodies[i]);
        const dReal *velocity = dBodyGetLinearVel(applied->bodies[i]);
        const double angle = atan2(rotation[4], rotation[0]);
        motions[i] = (Motion){
            .position = {position[0], position[1]},
            .angle = angle + 2.0 * M_PI * round((applied->angles[i] - angle) / (2.0 * M_PI)),
            .velocity = {velocity[0], velocity[1]},
            .omega = dBodyGetAngularVel(applied->bodies[i])[2],
        };
    }
}

// The row J v' + f / (share c) = wanted, share 1/2 or 1. Of two ways to write the wanted rate as a
// distance, the one with the smaller rounding.
static void set_line(const AppliedRow *row, const SpringLine *line, double softness, double wanted,
                     double step_s)
{
    if (!(line->distance > LINE_LEAST)) {
        dJointDisable(row->row);
        return;
    }
    const double gain = fmax(1.0, 2.0 * fabs(wanted) / line->distance); // 1/s
    dJointEnable(row->row);
    dJointSetDBallParam(row->row, dParamERP, gain * step_s);
    dJointSetDBallParam(row->row, dParamCFM, softness);
    dJointSetDBallDistance(row->row, line->distance + wanted / gain);
}

// The row of an angle's damper, by its coefficient.
static void set_turn(const Applied *applied, dJointID row, int joint, double softness, bool is_mean)
{
    if (row != NULL) {
        const double rate = forces_turn(applied->linkage, joint, applied->motions).rate;
        dJointSetAMotorParam(row, dParamCFM, softness);
        dJointSetAMotorParam(row, dParamVel, is_mean ? -rate : 0.0);
    }
}

// Puts the row of a line along a direction to a point where it stands: as long as its wanted rate
// needs for little rounding, and one that no direction is lost on. The body at the point is the
// row's first, or its second.
static void set_direction(const AppliedRow *row, Vec2 point, Vec2 along, bool is_first,
                          double softness, double wanted, double step_s)
{
    const double length = fmax(LINE_BUSHING, fabs(wanted));
    const Vec2 far = vec2_sub(point, vec2_scale(length, along));
    const Vec2 first = is_first ? point : far;
    const Vec2 second = is_first ? far : point;
    dJointSetDBallAnchor1(row->row, first.x, first.y, 0.0);
    dJointSetDBallAnchor2(row->row, second.x, second.y, 0.0);
    const SpringLine line = {.distance = length};
    set_line(row, &line, softness, wanted, step_s);
}

static void set_bushings(Applied *applied, double step_s, double share, bool is_mean)
{
    const Linkage *linkage = applied->linkage;
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        const BushingPose *pose = &applied->poses[i];
        for (size_t axis = 0; axis < BUSHING_ROWS; axis++) {
            AppliedRow *row = &applied->bushings[BUSHING_ROWS * i + axis];
            const double softness = 1.0 / (share * bushing_damping(bushing, axis));
            const double wanted = is_mean ? -pose->rate[axis] : 0.0;
            int first;
            int second;
            row->late = 0.0;
            if (row->row != NULL && axis < 2) {
                set_direction(row, pose->point, pose->axes[axis], bushing->body_a == LINKAGE_GROUND,
                              softness, wanted, step_s);
            } else if (row->row != NULL) {
                // the motor's rate is that of its first body
                const double side = bushing_bodies(bushing, &first, &second);
                dJointSetAMotorParam(row->row, dParamCFM, softness);
                dJointSetAMotorParam(row->row, dParamVel, -side * wanted);
            }
        }
    }
}

// Puts the row of a force in a gap on its line where it stands, and that of a torque to its rate.
static void set_gap(const Joint *joint, const Motion *motions, const AppliedRow *row,
                    const GapDampingRow *drag, double share, bool is_mean, double step_s)
{
    const int side = first_side(joint);
    const double softness = 1.0 / (share * drag->damping);
    const double wanted = is_mean ? -drag->rate : 0.0;
    if (drag->is_turn) {
        dJointSetAMotorParam(row->row, dParamCFM, softness);
        dJointSetAMotorParam(row->row, dParamVel, drag->row.turn[side] * wanted);
        return;
    }
    // the line goes from body a to body b, so that its length has the row's rate
    const Vec2 along = {drag->row.x[1], drag->row.y[1]};
    set_direction(row, gap_damping_point(drag, motions, 1, joint->body_b), along, side != 0,
                  softness, wanted, step_s);
}

static void set_gaps(Applied *applied, double step_s, double share, bool is_mean)
{
    const Linkage *linkage = applied->linkage;
    for (size_t i = 0; i < gap_room(linkage); i++) {
        AppliedRow *row = &applied->gaps[i];
        row->late = 0.0;
        if (row->row != NULL) {
            set_gap(&linkage->joints[i / GAP_DAMPING_ROWS], applied->motions, row,
                    &applied->drags[i], share, is_mean, step_s);
        }
    }
}

// The row of a soft drive with a limit: what it is without its rate, and the speed that is wanted.
static void set_limited(Applied *applied, double softness, bool is_mean)
{
    const Linkage *linkage = applied->linkage;
    const double rate = forces_drive_rate(linkage, applied->motions);
    applied->wanted = softness * applied->held - (is_mean ? rate : 0.0);
    dJointSetAMotorParam(applied->motor.row, dParamCFM, softness);
    dJointSetAMotorParam(applied->motor.row, dParamVel, applied->wanted);
    dJointSetAMotorParam(applied->motor.row, dParamFMax, linkage->torque.limit);
}

static void set_rows(Applied *applied, double step_s, AppliedRule rule, int direction)
{
    applied->motor.late = 0.0;
    const Linkage *linkage = applied->linkage;
    const bool is_mean = rule == APPLIED_AT_MEAN;
    const double share = direction * (is_mean ? 0.5 : 1.0);
    for (size_t i = 0; i < linkage->spring_count; i++) {
        applied->dampers[i].late = 0.0;
        if (applied->dampers[i].row != NULL) {
            const SpringLine *line = &applied->lines[i];
            set_line(&applied->dampers[i], line, 1.0 / (share * linkage->springs[i].damping),
                     is_mean ? -line->rate : 0.0, step_s);
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        applied->torsions[i].late = 0.0;
        set_turn(applied, applied->torsions[i].row, spring->joint, 1.0 / (share * spring->damping),
                 is_mean);
    }
    set_bushings(applied, step_s, share, is_mean);
    set_gaps(applied, step_s, share, is_mean);
    if (has_limited_row(applied)) {
        set_limited(applied, 1.0 / (share * linkage->torque.slope), is_mean);
        return;
    }
    set_turn(applied, applied->motor.row, linkage->torque.joint,
             1.0 / (share * linkage->torque.slope), is_mean);
}

static double mean_of(const Applied *applied, const Load *load, const Motion *motions,
                      double from_s, double to_s)
{
    const Linkage *linkage = applied->linkage;
    return applied->is_held && load_jumps(linkage, load)
               ? load_value(linkage, load, motions, applied->held_s, applied->held_s)
               : load_mean(linkage, load, motions, from_s, to_s);
}

// Adds the loads, of which each has its mean over the step.
static void push_loads(Applied *applied, const Motion *motions, double from_s, double to_s)
{
    const Linkage *linkage = applied->linkage;
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        applied->pushed[i] = mean_of(applied, load, motions, from_s, to_s);
        applied->rates[i] = load_rate(linkage, load, motions);
        load_add(linkage, load, applied->pushed[i], motions, applied->loads);
    }
}

// What the rate of the start takes off a torque whose row has all of it.
static double lost_by_rate(const Applied *applied)
{
    return has_limited_row(applied) ? applied->linkage->torque.slope * applied->turning : 0.0;
}

void applied_push_at(Applied *applied, const Motion *motions, double start_s, double step_s,
                     AppliedRule rule, int direction)
{
    const Linkage *linkage = applied->linkage;
    if (!applied->is_any) {
        return;
    }
    const Torque *torque = &linkage->torque;
    const double end_s = start_s + direction * step_s;
    for (size_t i = 0; i < linkage->body_count; i++) {
        applied->motions[i] = motions[i];
        applied->loads[i] = (BodyLoad){{0.0, 0.0}, 0.0};
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        applied->lines[i] = forces_line(&linkage->springs[i], motions);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        applied->poses[i] = bushing_pose(&linkage->bushings[i], motions);
    }
    for (size_t i = 0; i < gap_room(linkage) / GAP_DAMPING_ROWS; i++) {
        gap_damping_rows(linkage, motions, (int)i, &applied->drags[GAP_DAMPING_ROWS * i]);
    }
    const double from_s = fmin(start_s, end_s);
    const double to_s = fmax(start_s, end_s);
    // positions are those of the middle of the step, or of its start
    const double motions_s = rule == APPLIED_AT_MEAN ? 0.5 * (start_s + end_s) : start_s;
    applied->torque = time_table_mean(&torque->table, from_s, to_s) +
                      forces_followed(linkage, motions, motions_s);
    applied->turning = torque->table.count > 0 ? forces_drive_rate(linkage, motions) : 0.0;
    applied->held = applied->torque;
    applied->torque = forces_within_limit(torque, applied->torque - lost_by_rate(applied));
    forces_add_springs(linkage, motions, applied->loads);
    if (!has_limited_row(applied)) {
        forces_add_torque(linkage, motions, applied->torque, applied->loads);
    }
    push_loads(applied, motions, from_s, to_s);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const BodyLoad *load = &applied->loads[i];
        dBodyAddForce(applied->bodies[i], load->force.x, load->force.y, 0.0);
        dBodyAddTorque(applied->bodies[i], 0.0, 0.0, load->moment);
    }
    set_rows(applied, step_s, rule, direction);
    forces_add_dampers(linkage, motions, applied->loads);
    if (has_limited_row(applied)) {
        forces_add_torque(linkage, motions, applied->torque, applied->loads);
    }
}

void applied_push_late(Applied *applied, const Motion *beyond)
{
    const Linkage *linkage = applied->linkage;
    memset(applied->late, 0, linkage->body_count * sizeof *applied->late);
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        applied->dampers[i].late = spring->damping * forces_line(spring, beyond).rate;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        applied->torsions[i].late =
            -spring->damping * forces_turn(linkage, spring->joint, beyond).rate;
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const BushingPose pose = bushing_pose(&linkage->bushings[i], beyond);
        for (size_t row = 0; row < BUSHING_ROWS; row++) {
            applied->bushings[BUSHING_ROWS * i + row].late =
                bushing_drag(&linkage->bushings[i], &pose, row);
        }
    }
    for (size_t i = 0; i < gap_room(linkage) / GAP_DAMPING_ROWS; i++) {
        GapDampingRow drags[GAP_DAMPING_ROWS];
        const size_t count = gap_damping_rows(linkage, beyond, (int)i, drags);
        for (size_t k = 0; k < count; k++) {
            applied->gaps[GAP_DAMPING_ROWS * i + k].late = drags[k].damping * drags[k].rate;
        }
    }
    if (has_limited_row(applied)) {
        applied->wanted -= 2.0 * forces_drive_rate(linkage, beyond);
        dJointSetAMotorParam(applied->motor.row, dParamVel, applied->wanted);
    } else if (applied->motor.row != NULL) {
        applied->motor.late = -linkage->torque.slope * forces_drive_rate(linkage, beyond);
    }
    forces_add_dampers(linkage, beyond, applied->late);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const BodyLoad *load = &applied->late[i];
        dBodyAddForce(applied->bodies[i], load->force.x, load->force.y, 0.0);
        dBodyAddTorque(applied->bodies[i], 0.0, 0.0, load->moment);
    }
}

void applied_push(Applied *applied, double start_s, double step_s, AppliedRule rule, int direction)
{
    if (!applied->is_any) {
        return;
    }
    read_motions(applied, applied->seen);
    for (size_t i = 0; i < applied->linkage->body_count; i++) {
        applied->angles[i] = applied->seen[i].angle;
    }
    applied_push_at(applied, applied->seen, start_s, step_s, rule, direction);
}

// Adds what a row of an angle did in the step. Returns the work it took, J, by its coefficient.
static double take_turn(Applied *applied, const AppliedRow *row, int joint, double damping,
                        double step_s)
{
    if (row->row == NULL) {
        return 0.0;
    }
    const double moment = row->feedback.t1[2] + row->late;
    forces_add_moment(applied->linkage, joint, moment, applied->loads);
    return step_s * moment * moment / damping;
}

// Adds what the dampers' rows did in the step. Returns the work they took, J.
static double take_dampers(Applied *applied, double step_s)
{
    const Linkage *linkage = applied->linkage;
    double work = 0.0;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const SpringLine *line = &applied->lines[i];
        if (applied->dampers[i].row != NULL && line->distance > LINE_LEAST) {
            const dReal *force = applied->dampers[i].feedback.f1;
            const double along =
                force[0] * line->direction.x + force[1] * line->direction.y; // on its first body
            const double tension =
                (spring->body_a == LINKAGE_GROUND ? -along : along) + applied->dampers[i].late;
            forces_add_tension(spring, line, applied->motions, tension, applied->loads);
            work += step_s * tension * tension / spring->damping;
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        work += take_turn(applied, &applied->torsions[i], spring->joint, spring->damping, step_s);
    }
    return work;
}

// Adds what the rows of the bushings' dampers did in the step. Returns the work they took, J.
static double take_bushings(Applied *applied, double step_s)
{
    const Linkage *linkage = applied->linkage;
    double work = 0.0;
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        const BushingPose *pose = &applied->poses[i];
        int first;
        int second;
        const double side = bushing_bodies(bushing, &first, &second);
        for (size_t axis = 0; axis < BUSHING_ROWS; axis++) {
            const AppliedRow *row = &applied->bushings[BUSHING_ROWS * i + axis];
            if (row->row == NULL) {
                continue;
            }
            const dReal *force = row->feedback.f1;
            const double on_first =
                axis < 2 ? force[0] * pose->axes[axis].x + force[1] * pose->axes[axis].y
                         : row->feedback.t1[2];
            const double pull = side * on_first + row->late;
            forces_add_row(bushing, pose, axis, pull, applied->motions, applied->loads);
            work += step_s * pull * pull / bushing_damping(bushing, axis);
        }
    }
    return work;
}

// Adds what the rows of dampers in gaps did in the step. Returns the work they took, J.
static double take_gaps(Applied *applied, double step_s)
{
    const Linkage *linkage = applied->linkage;
    double work = 0.0;
    for (size_t i = 0; i < gap_room(linkage); i++) {
        const AppliedRow *row = &applied->gaps[i];
        const GapDampingRow *drag = &applied->drags[i];
        const Joint *joint = &linkage->joints[i / GAP_DAMPING_ROWS];
        if (row->row == NULL) {
            continue;
        }
        const int side = first_side(joint);
        const dReal *force = row->feedback.f1;
        const double along = drag->is_turn
                                 ? row->feedback.t1[2] * drag->row.turn[side]
                                 : force[0] * drag->row.x[side] + force[1] * drag->row.y[side];
        const double pull = row->late - along;
        forces_add_drag(joint, drag, pull, applied->loads);
        work += step_s * pull * pull / drag->damping;
    }
    return work;
}

AppliedWork applied_book(Applied *applied, double step_s)
{
    const Linkage *linkage = applied->linkage;
    AppliedWork work = {0.0, 0.0, 0.0, 0.0};
    if (!applied->is_any) {
        return work;
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        applied->loads[i] = (BodyLoad){{0.0, 0.0}, 0.0};
    }
    if (has_limited_row(applied)) {
        applied->torque = applied->motor.feedback.t1[2];
    }
    forces_add_springs(linkage, applied->motions, applied->loads);
    forces_add_torque(linkage, applied->motions, applied->torque, applied->loads);
    for (size_t i = 0; i < linkage->load_count; i++) {
        load_add(linkage, &linkage->loads[i], applied->pushed[i], applied->motions, applied->loads);
    }
    work.damping =
        take_dampers(applied, step_s) + take_bushings(applied, step_s) + take_gaps(applied, step_s);
    if (!has_limited_row(applied)) {
        work.slope = -take_turn(applied, &applied->motor, linkage->torque.joint,
                                linkage->torque.slope, step_s);
    }
    if (linkage->torque.table.count > 0 || linkage->load_count > 0) {
        read_motions(applied, applied->seen);
    }
    if (linkage->torque.table.count > 0) {
        const double turning = forces_drive_rate(linkage, applied->seen);
        work.torque = step_s * applied->torque * 0.5 * (applied->turning + turning);
    }
    for (size_t i = 0; i < linkage->load_count; i++) {
        const double rate = load_rate(linkage, &linkage->loads[i], applied->seen);
        work.loads += step_s * applied->pushed[i] * 0.5 * (applied->rates[i] + rate);
    }
    return work;
}

BodyLoad applied_on(const Applied *applied, int body)
{
    return applied->is_any && body != LINKAGE_GROUND ? applied->loads[body]
                                                     : (BodyLoad){{0.0, 0.0}, 0.0};
}
