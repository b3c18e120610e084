// How far has a hinge turned, or a gear come round against another, within its play?
#include "reference/tree_coordinate.h"

#include "model/coordinate.h"
#include "reference/tree_line.h"

#include <math.h>

void tree_coordinate_parts(const Joint *joint, TreeCoordinatePart parts[TREE_COORDINATE_PARTS])
{
    const Gear *gear = &joint->gear;
    const bool is_gear = joint->kind == JOINT_GEAR;
    const double sense = coordinate_sense(joint);
    parts[0] = (TreeCoordinatePart){joint->body_a, is_gear ? -gear->radius_a : -sense};
    parts[1] = (TreeCoordinatePart){joint->body_b, is_gear ? -gear->radius_b : sense};
    parts[2] = (TreeCoordinatePart){is_gear ? gear->carrier : LINKAGE_GROUND,
                                    is_gear ? gear->radius_a + gear->radius_b : 0.0};
}

double tree_coordinate_origin(const Joint *joint)
{
    return joint->kind == JOINT_GEAR ? joint->limits.middle
                                     : coordinate_sense(joint) * joint->held_angle;
}

void tree_coordinate_settle(Tree *tree, int joint)
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
    tree->base_coordinates[joint] = (double)sum;
}

double tree_coordinate(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].body == LINKAGE_GROUND ? 0.0 : parts[i].share * state->turn[parts[i].body];
    }
    return tree->base_coordinates[joint] + sum;
}

double tree_coordinate_rate(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].share * tree_omega(state, parts[i].body);
    }
    return sum;
}

double tree_coordinate_second(const Tree *tree, const TreeState *state, int joint)
{
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    tree_coordinate_parts(&tree->linkage->joints[joint], parts);
    double sum = 0.0;
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        sum += parts[i].share * tree_alpha(state, parts[i].body);
    }
    return sum;
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
}
