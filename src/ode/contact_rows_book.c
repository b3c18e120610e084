// Which forces came of the rows of contacts in a step, and which energies?
#include "ode/contact_rows.h"

#include "world/pressing_row.h"

#include <string.h>

// Work lost to friction in the step: the force on the pin along the wall, against how far the pin
// slid. Of a staggered world that is the mean of the speeds before and after the step.
static double friction_work(const ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    const ContactRow *row = &rows->rows[number];
    const FrictionRow friction = contact_rows_friction(rows, number);
    const double after = contact_friction_sliding(&friction);
    const double sliding = rows->is_staggered ? 0.5 * (row->sliding + after) : after;
    return -vec2_dot(vec2_perp(row->normal), force) * sliding * step_s;
}

// What a contact lost and stored in the step, by its law: the damper at the speed after the step,
// the spring at the depth after it. Where nothing presses that still overlaps, the damper takes all
// that the spring gives. What the step itself gains or loses beyond that is ODE's error
// and stays in the residual. The velocity-level model has no spring: all its work is lost.
static void book_energy(ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    ContactRow *row = &rows->rows[number];
    row->elastic = 0.0;
    row->dissipated = 0.0;
    row->friction = 0.0;
    if (!row->state.is_touching) {
        return;
    }
    const TouchPose pose = pair_pose(&rows->world->pairs[number]);
    // a polygon's side stays what it is within a step
    const double penetration = row->excess - pose.gap;
    const double speed = pose.approach_speed + row->faster;
    const double pressing =
        rows->world->pairs[number].row != NULL ? row->pressing : vec2_dot(row->normal, force);
    // of a staggered world the step stands in the middle between its two speeds, and its end
    // between two positions
    const double closing = rows->is_staggered ? 0.5 * (row->closing + speed) : speed;
    const double depth = rows->is_staggered ? 0.5 * (row->inside + penetration) : penetration;
    if (rows->scenario->contact.model == CONTACT_POISSON) {
        row->dissipated = pressing * 0.5 * (row->closing + speed) * step_s;
    } else {
        const double damped =
            pressing > 0.0 ? row->damping * closing : -force_law_elastic(&row->law, row->depth);
        row->dissipated = damped * closing * step_s;
        row->elastic = force_law_energy(&row->law, fmax(0.0, depth));
    }
    if (row->law.friction > 0.0) {
        row->friction = friction_work(rows, number, force, step_s);
    }
}

// The force of a row on body b, as ODE has it; none at a turn.
static Vec2 row_force(const ContactRows *rows, size_t number)
{
    const ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    if (!row->state.is_touching || pair->row != NULL) {
        return (Vec2){0.0, 0.0};
    }
    const Vec3 on_a = pressing_row_force(&row->feedback, pair->bodies);
    return (Vec2){-on_a.x, -on_a.y};
}

// Adds what a corner or an end does to what its joint does.
static void add_corner(const ContactRow *row, const WorldPair *pair, const Joint *joint, Vec2 force,
                       JointState *state)
{
    state->force_on_b = vec2_add(state->force_on_b, force);
    state->force += row->pressing;
    state->moment_on_b += vec2_cross(row->lever, force);
    if (pair->row != NULL) {
        state->moment_on_b += coordinate_sense(joint) * pair->touch.sign * row->pressing;
    }
}

// The torque of a row of an angle, which does nothing from then on.
static double take_torque(const ContactRow *row, const WorldPair *pair)
{
    pressing_row_rest(pair->row);
    return pair->touch.sign * row->feedback.t1[2];
}

// Reads what a row of the step did, with its force on body b.
static void read_row(ContactRows *rows, size_t number, Vec2 force, double step_s, JointState *state)
{
    ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    row->pressing = pair->row != NULL ? take_torque(row, pair) : vec2_length(force);
    if (pair->is_corner) {
        const Joint *joint = &rows->scenario->linkage.joints[pair->joint];
        add_corner(row, pair, joint, force, state);
    } else {
        state->force_on_b = force;
        state->force = row->pressing;
    }
    if (pair->is_end) {
        // whose largest values alone are asked for: contact_rows_tops
        tops_note_step(&row->tops, row->pressing, fmax(row->inside, 0.0), row->share, step_s);
    }
}

void contact_rows_clear(ContactRows *rows, double step_s, JointState *states)
{
    bool any = false;
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const WorldPair *pair = &rows->world->pairs[i];
        if (pair->is_end && contact_rows_is_first(rows, i)) {
            // what holds the joint beside its coordinate is not told of it
            states[pair->joint].force = 0.0;
        }
        const Vec2 force = row_force(rows, i);
        if (rows->rows[i].state.is_touching) {
            read_row(rows, i, force, step_s, &states[pair->joint]);
            any = true;
        }
        if (!rows->scenario->run.is_lean) {
            book_energy(rows, i, force, step_s);
        }
    }
    if (any) {
        dJointGroupEmpty(rows->group);
    }
}

void contact_rows_offsets(const ContactRows *rows, int body, Vec2 *offsets)
{
    memset(offsets, 0, rows->scenario->linkage.joint_count * sizeof *offsets);
    world_offsets(rows->world, body, offsets);
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const ContactRow *row = &rows->rows[i];
        const int number = rows->world->pairs[i].joint;
        const Joint *joint = &rows->scenario->linkage.joints[number];
        if (row->state.is_touching) {
            offsets[number] = row->arms[joint->body_a == body ? 0 : 1];
        }
    }
}

ContactEnergy contact_rows_energy(const ContactRows *rows)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        sum.dissipated += rows->rows[i].dissipated;
        sum.friction += rows->rows[i].friction;
        sum.elastic += rows->rows[i].elastic;
    }
    return sum;
}

void contact_rows_tops(const ContactRows *rows, JointTop *tops)
{
    for (size_t i = 0; i < rows->scenario->linkage.joint_count; i++) {
        tops[i] = (JointTop){.force = 0.0};
    }
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const ContactRow *row = &rows->rows[i];
        JointTop *top = &tops[rows->world->pairs[i].joint];
        if (rows->world->pairs[i].is_end && row->state.is_touching) {
            top->force = fmax(top->force, row->tops.force);
            top->depth = fmax(top->depth, row->tops.depth);
        }
    }
}
