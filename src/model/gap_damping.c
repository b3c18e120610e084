// Finds what dampers of joints with play feel.
//
// A pin in its hole: both components of its centre's velocity against the point of body a under it,
// with forces there on both bodies. What has a coordinate with ends: its rate, with the push of
// coordinate_row, of hinges, sliders and racks the same at both ends. Of gears each flank has half
// of the coefficient on its own line of action, s = 1 and -1:
//     forces -(c / 2) g_s' n_s,   together -c cos^2 alpha q' along the pitch circles' tangent
//                                 where the centres keep their distance
// A force with coefficients (x, y, turn) on a body acts on a line that goes through the point at
// -turn perp(x, y) from its centre.
#include "model/gap_damping.h"

static Vec2 velocity_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? (Vec2){0.0, 0.0} : motions[body].velocity;
}

static double rate_of(const Joint *joint, const JointRow *row, const Motion *motions)
{
    double rate = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        const Vec2 velocity = velocity_of(motions, body);
        const double omega = body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
        rate += row->x[side] * velocity.x + row->y[side] * velocity.y + row->turn[side] * omega;
    }
    return rate;
}

// The row of a force along a direction at the pin's centre.
static JointRow row_at_pin(const Motion *motions, const Joint *joint, Vec2 direction)
{
    const Vec2 point = linkage_point(motions, joint->body_b, joint->anchor_b);
    JointRow row;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        const Vec2 centre = body == LINKAGE_GROUND ? (Vec2){0.0, 0.0} : motions[body].position;
        const double sign = side == 0 ? -1.0 : 1.0;
        row.x[side] = sign * direction.x;
        row.y[side] = sign * direction.y;
        row.turn[side] = sign * vec2_cross(vec2_sub(point, centre), direction);
    }
    return row;
}

// How many rows share the coefficient of a joint.
static size_t count_rows(const Joint *joint)
{
    return joint_has_hole(joint->kind) || joint_has_mesh(joint->kind) ? 2 : 1;
}

size_t gap_damping_rows(const Linkage *linkage, const Motion *motions, int number,
                        GapDampingRow rows[GAP_DAMPING_ROWS])
{
    const Joint *joint = &linkage->joints[number];
    if (!(joint->contact.gap_damping > 0.0) || !linkage_has_play(joint)) {
        return 0;
    }
    const bool is_pin = joint_has_hole(joint->kind);
    const size_t count = count_rows(joint);
    const double share = is_pin ? 1.0 : 1.0 / (double)count;
    for (size_t i = 0; i < count; i++) {
        GapDampingRow *row = &rows[i];
        row->damping = share * joint->contact.gap_damping;
        row->is_turn = linkage_is_torsional(joint);
        if (is_pin) {
            row->row = row_at_pin(motions, joint, i == 0 ? (Vec2){1.0, 0.0} : (Vec2){0.0, 1.0});
        } else {
            coordinate_row(linkage, motions, number, i == 0 ? 1.0 : -1.0, &row->row);
        }
        row->rate = rate_of(joint, &row->row, motions);
    }
    return count;
}

Vec2 gap_damping_point(const GapDampingRow *row, const Motion *motions, int side, int body)
{
    const Vec2 direction = {row->row.x[side], row->row.y[side]};
    const Vec2 centre = body == LINKAGE_GROUND ? (Vec2){0.0, 0.0} : motions[body].position;
    return vec2_sub(centre, vec2_scale(row->row.turn[side], vec2_perp(direction)));
}
