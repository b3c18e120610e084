// Finds how far a hinge has turned within its play, or a gear against another, in a tree.
#include "base/mesh.h"
#include "model/coordinate.h"
#include "reference/plane/tree.h"

#include <math.h>

void tree_coordinate_parts(const Joint *joint, TreeCoordinatePart parts[TREE_COORDINATE_PARTS])
{
    const Gear *gear = &joint->gear;
    const double sense = coordinate_sense(joint);
    switch (joint_coordinate(joint->kind)) {
    case JOINT_COORDINATE_TEETH: // beside the way round each other
        parts[0] = (TreeCoordinatePart){joint->body_a, -gear->radius_a};
        parts[1] = (TreeCoordinatePart){joint->body_b, -gear->radius_b};
        break;
    case JOINT_COORDINATE_RACK: // beside the way along the pitch line
        parts[0] = (TreeCoordinatePart){joint->body_a, -gear->radius_b};
        parts[1] = (TreeCoordinatePart){joint->body_b, gear->radius_b};
        break;
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        parts[0] = (TreeCoordinatePart){joint->body_a, -sense};
        parts[1] = (TreeCoordinatePart){joint->body_b, sense};
        break;
    }
}

double tree_coordinate_origin(const Joint *joint)
{
    return joint_has_teeth(joint->kind) ? joint->limits.middle
                                        : coordinate_sense(joint) * joint->held_angle;
}

// The way of gears round each other: of the pitch circles, m, as the line of the centres turns.
static double turned_round(const Tree *tree, const TreeState *state, int joint)
{
    const Vec2 before = tree->base_gaps[joint];
    const Vec2 moved = tree_pair_moved(tree, state, joint);
    const double turn = atan2(vec2_cross(before, moved), vec2_dot(before, vec2_add(before, moved)));
    return mesh_distance(&tree->linkage->joints[joint].gear) * turn;
}

static double turning_round(const Tree *tree, const TreeState *state, int joint)
{
    const Vec2 offset = tree_pair_gap(tree, state, joint);
    const Vec2 velocity = tree_pair_velocity(tree, state, joint);
    return mesh_distance(&tree->linkage->joints[joint].gear) * vec2_cross(offset, velocity) /
           vec2_dot(offset, offset);
}

static double second_round(const Tree *tree, const TreeState *state, int joint)
{
    const Vec2 offset = tree_pair_gap(tree, state, joint);
    const Vec2 velocity = tree_pair_velocity(tree, state, joint);
    const double square = vec2_dot(offset, offset);
    const double turning = vec2_cross(offset, velocity) / square;
    const double second = vec2_cross(offset, tree_pair_acceleration(tree, state, joint)) -
                          2.0 * turning * vec2_dot(offset, velocity);
    return mesh_distance(&tree->linkage->joints[joint].gear) * second / square;
}

// The part that the way of the pair's ends has in a coordinate, since the base.
static double way_moved(const Tree *tree, const TreeState *state, int joint)
{
    switch (joint_coordinate(tree->linkage->joints[joint].kind)) {
    case JOINT_COORDINATE_TEETH:
        return turned_round(tree, state, joint);
    case JOINT_COORDINATE_RACK:
        return tree_line_moved(tree, state, joint);
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return 0.0;
}

// The rate of that.
static double way_rate(const Tree *tree, const TreeState *state, int joint)
{
    switch (joint_coordinate(tree->linkage->joints[joint].kind)) {
    case JOINT_COORDINATE_TEETH:
        return turning_round(tree, state, joint);
    case JOINT_COORDINATE_RACK:
        return tree_line_rate(tree, state, joint);
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return 0.0;
}

// And its second rate.
static double way_second(const Tree *tree, const TreeState *state, int joint)
{
    switch (joint_coordinate(tree->linkage->joints[joint].kind)) {
    case JOINT_COORDINATE_TEETH:
        return second_round(tree, state, joint);
    case JOINT_COORDINATE_RACK:
        return tree_line_second(tree, state, joint);
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return 0.0;
}

double tree_coordinate(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].body == LINKAGE_GROUND ? 0.0 : parts[i].share * state->turn[parts[i].body];
    }
    return tree->base_coordinates[joint] + (sum + way_moved(tree, state, joint));
}

double tree_coordinate_rate(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].share * tree_omega(state, parts[i].body);
    }
    return sum + way_rate(tree, state, joint);
}

double tree_coordinate_second(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].share * tree_alpha(state, parts[i].body);
    }
    return sum + way_second(tree, state, joint);
}

void tree_coordinate_sizes(const Tree *tree, const TreeState *state, int joint, double *position,
                           double *speed)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    *position = fabs(tree->base_coordinates[joint]);
    *speed = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        if (parts[i].body != LINKAGE_GROUND) {
            *position += fabs(parts[i].share * state->turn[parts[i].body]);
            *speed += fabs(parts[i].share * tree_omega(state, parts[i].body));
        }
    }
    *position += fabs(way_moved(tree, state, joint));
    *speed += fabs(way_rate(tree, state, joint));
}

// Adds the way of the pair's ends at the base to the turns of the bodies; of gears up to whole
// turns, of which the nearest to the origin counts.
static long double with_way(const Joint *joint, TreePoint gap, TreePoint normal, long double turned)
{
    const long double round = 2.0L * acosl(-1.0L) * mesh_distance(&joint->gear);
    switch (joint_coordinate(joint->kind)) {
    case JOINT_COORDINATE_TEETH:
        return remainderl(turned + (long double)mesh_distance(&joint->gear) * atan2l(gap.y, gap.x),
                          round);
    case JOINT_COORDINATE_RACK:
        return turned + (normal.x * gap.x + normal.y * gap.y);
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return turned;
}

void tree_coordinate_settle(Tree *tree, int joint, TreePoint gap, TreePoint normal)
{
    const Joint *of = &tree->linkage->joints[joint];
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(of, parts);
    long double sum = -(long double)tree_coordinate_origin(of);
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        if (parts[i].body != LINKAGE_GROUND) {
            sum += parts[i].share * tree->base_angle[parts[i].body];
        }
    }
    tree->base_coordinates[joint] = (double)with_way(of, gap, normal, sum);
}
