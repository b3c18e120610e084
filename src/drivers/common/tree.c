// Makes a tree of a mechanism, and finds how its bodies move by the coordinates of its joints.
//
// Ideal joints are taken into the tree while they reach a body that is not in it, from the ground
// outwards, so that chains are short; a body that none reaches has three coordinates of its own.
#include "drivers/common/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_in(const bool *is_reached, int body)
{
    return body == DRIVER_GROUND || is_reached[body];
}

static double angle_of(const DriverCase *of, int body)
{
    return body == DRIVER_GROUND ? 0.0 : of->bodies[body].start.angle;
}

static Vec2 place_of(const DriverCase *of, int body)
{
    return body == DRIVER_GROUND ? (Vec2){0.0, 0.0} : of->bodies[body].start.position;
}

// Hangs a body on another by a joint, or on nothing.
static void hang(Tree *tree, int body, int parent, int number)
{
    const DriverCase *of = tree->of;
    TreeBody *hung = &tree->bodies[body];
    *hung = (TreeBody){.kind = TREE_FREE,
                       .parent = parent,
                       .joint = number,
                       .first = tree->coordinates,
                       .count = number < 0 ? 3 : 1,
                       .turn = angle_of(of, body) - angle_of(of, parent)};
    tree->coordinates += hung->count;
    if (number < 0) {
        return;
    }
    const DriverJoint *joint = &of->joints[number];
    const int own = joint->bodies[1] == body ? 1 : 0;
    if (joint->kind == DRIVER_PRISMATIC) {
        hung->kind = TREE_SLIDES;
        const double along = angle_of(of, joint->bodies[0]) + joint->direction;
        hung->axis = vec2_rotate(along - angle_of(of, body), (Vec2){1.0, 0.0});
        hung->offset =
            vec2_rotate(-angle_of(of, parent), vec2_sub(place_of(of, body), place_of(of, parent)));
    } else {
        hung->kind = TREE_TURNS;
        hung->anchor = joint->anchors[own];
        hung->offset = joint->anchors[1 - own];
    }
}

// The next ideal joint of a kind that reaches a new body; -1 where there is none.
static int next_joint(const Tree *tree, const bool *is_reached, bool is_sliding)
{
    const DriverCase *of = tree->of;
    for (size_t i = 0; i < of->joint_count; i++) {
        const DriverJoint *joint = &of->joints[i];
        const bool is_ideal = driver_is_ideal(joint);
        if (is_ideal && (joint->kind == DRIVER_PRISMATIC) == is_sliding &&
            is_in(is_reached, joint->bodies[0]) != is_in(is_reached, joint->bodies[1])) {
            return (int)i;
        }
    }
    return -1;
}

Tree tree_make(const DriverCase *of)
{
    Tree tree = {.of = of,
                 .bodies = calloc(of->body_count + 1, sizeof *tree.bodies),
                 .order = calloc(of->body_count + 1, sizeof *tree.order),
                 .is_left = calloc(of->joint_count + 1, sizeof *tree.is_left),
                 .bends = calloc(of->body_count + 1, sizeof *tree.bends)};
    bool *is_reached = calloc(of->body_count + 1, sizeof *is_reached);
    if (tree.bodies == NULL || tree.order == NULL || tree.is_left == NULL || tree.bends == NULL ||
        is_reached == NULL) {
        driver_fail("there is no memory");
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        tree.is_left[i] = driver_is_ideal(&of->joints[i]);
    }
    for (size_t count = 0; count < of->body_count; count++) {
        int number = next_joint(&tree, is_reached, true);
        number = number < 0 ? next_joint(&tree, is_reached, false) : number;
        int body = 0;
        int parent = DRIVER_GROUND;
        if (number >= 0) {
            const int *bodies = of->joints[number].bodies;
            const int own = is_in(is_reached, bodies[1]) ? 0 : 1;
            body = bodies[own];
            parent = bodies[1 - own];
            tree.is_left[number] = false;
        } else {
            while (is_reached[body]) {
                body++;
            }
        }
        hang(&tree, body, parent, number);
        is_reached[body] = true;
        tree.order[count] = (size_t)body;
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        tree.left_count += tree.is_left[i] ? 1 : 0;
        if (tree.is_left[i] && of->joints[i].kind == DRIVER_PRISMATIC) {
            driver_refuse("the sliding joint '%s' in a loop of others", of->joints[i].name);
        }
    }
    free(is_reached);
    tree.placed = driver_room(of->body_count, sizeof *tree.placed);
    tree.coordinates_placed = driver_room(tree.coordinates, sizeof *tree.coordinates_placed);
    for (size_t i = 0; i < tree.coordinates; i++) {
        tree.coordinates_placed[i] = NAN; // not anywhere yet
    }
    return tree;
}

void tree_check_drives(const Tree *tree)
{
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(tree->of, (int)i);
        if (drive != NULL && tree->bodies[i].joint != drive->joint) {
            driver_refuse("a driven body that another joint holds");
        }
    }
}

void tree_start(const Tree *tree, double *rates)
{
    const DriverBody *all = tree->of->bodies;
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const TreeBody *body = &tree->bodies[i];
        const DriverMotion *own = &all[i].start;
        const bool has_parent = body->parent != DRIVER_GROUND;
        const DriverMotion still = {.omega = 0.0};
        const DriverMotion *parent = has_parent ? &all[body->parent].start : &still;
        double *rate = rates + body->first;
        if (body->kind == TREE_FREE) {
            rate[0] = own->velocity.x;
            rate[1] = own->velocity.y;
            rate[2] = own->omega;
        } else if (body->kind == TREE_TURNS) {
            rate[0] = own->omega - parent->omega;
        } else {
            const Vec2 arm = vec2_sub(own->position, parent->position);
            const Vec2 carried = vec2_add(parent->velocity, //
                                          vec2_scale(parent->omega, vec2_perp(arm)));
            rate[0] =
                vec2_dot(vec2_rotate(own->angle, body->axis), vec2_sub(own->velocity, carried));
        }
    }
}

// Puts a body where its coordinates say, its parent being there.
static void place_body(const Tree *tree, size_t number, const double *coordinates)
{
    const TreeBody *body = &tree->bodies[number];
    const DriverMotion *start = &tree->of->bodies[number].start;
    const double *at = coordinates + body->first;
    TreePlaced *own = &tree->placed[number];
    if (body->kind == TREE_FREE) {
        own->position = vec2_add(start->position, (Vec2){at[0], at[1]});
        own->angle = start->angle + at[2];
        return;
    }
    const bool has_parent = body->parent != DRIVER_GROUND;
    const TreePlaced ground = {.angle = 0.0};
    const TreePlaced *parent = has_parent ? &tree->placed[body->parent] : &ground;
    const Vec2 held = vec2_add(parent->position, vec2_rotate(parent->angle, body->offset));
    if (body->kind == TREE_TURNS) {
        own->angle = parent->angle + body->turn + at[0];
        own->arm = vec2_rotate(own->angle, body->anchor);
        own->pivot = vec2_sub(held, parent->position);
        own->position = vec2_sub(held, own->arm);
    } else {
        own->angle = parent->angle + body->turn;
        own->arm = vec2_rotate(own->angle, body->axis);
        own->position = vec2_add(held, vec2_scale(at[0], own->arm));
        own->pivot = vec2_sub(own->position, parent->position);
    }
}

// Lets it move by the rates, its parent moving so.
static void move_body(const Tree *tree, size_t number, const double *rates, DriverMotion *motions)
{
    const TreeBody *body = &tree->bodies[number];
    const TreePlaced *at = &tree->placed[number];
    const double *going = rates + body->first;
    DriverMotion *own = &motions[number];
    own->position = at->position;
    own->angle = at->angle;
    if (body->kind == TREE_FREE) {
        own->velocity = (Vec2){going[0], going[1]};
        own->omega = going[2];
        return;
    }
    const DriverMotion still = {.omega = 0.0};
    const DriverMotion *parent = body->parent != DRIVER_GROUND ? &motions[body->parent] : &still;
    const Vec2 carried =
        vec2_add(parent->velocity, vec2_scale(parent->omega, vec2_perp(at->pivot)));
    if (body->kind == TREE_TURNS) {
        own->omega = parent->omega + going[0];
        own->velocity = vec2_sub(carried, vec2_scale(own->omega, vec2_perp(at->arm)));
    } else {
        own->omega = parent->omega;
        own->velocity = vec2_add(carried, vec2_scale(going[0], at->arm));
    }
}

void tree_motions(const Tree *tree, const double *coordinates, const double *rates,
                  DriverMotion *motions)
{
    const size_t size = tree->coordinates * sizeof *coordinates;
    if (memcmp(tree->coordinates_placed, coordinates, size) != 0) {
        memcpy(tree->coordinates_placed, coordinates, size);
        for (size_t i = 0; i < tree->of->body_count; i++) {
            place_body(tree, tree->order[i], coordinates);
        }
    }
    for (size_t i = 0; i < tree->of->body_count; i++) {
        move_body(tree, tree->order[i], rates, motions);
    }
}

// A direction that turns with a body, which has been put there last where the angle is that.
static Vec2 turned_arm(const Tree *tree, int body, double angle, Vec2 local)
{
    const TreePlaced *at = &tree->placed[body];
    return at->angle == angle ? at->arm : vec2_rotate(angle, local);
}

void tree_push(const Tree *tree, const DriverMotion *motions, int body, Vec2 local, Vec2 force,
               double *pushes)
{
    const bool is_centre = body != DRIVER_GROUND && local.x == 0.0 && local.y == 0.0;
    const Vec2 point = is_centre ? motions[body].position : driver_point(motions, body, local);
    while (body != DRIVER_GROUND) {
        const TreeBody *at = &tree->bodies[body];
        const DriverMotion *own = &motions[body];
        double *push = pushes + at->first;
        if (at->kind == TREE_FREE) {
            push[0] += force.x;
            push[1] += force.y;
            push[2] += vec2_cross(vec2_sub(point, own->position), force);
        } else if (at->kind == TREE_TURNS) {
            const Vec2 arm = turned_arm(tree, body, own->angle, at->anchor);
            const Vec2 pivot = vec2_add(own->position, arm);
            push[0] += vec2_cross(vec2_sub(point, pivot), force);
        } else {
            push[0] += vec2_dot(turned_arm(tree, body, own->angle, at->axis), force);
        }
        body = at->parent;
    }
}

void tree_turn(const Tree *tree, int body, double moment, double *pushes)
{
    while (body != DRIVER_GROUND) {
        const TreeBody *at = &tree->bodies[body];
        if (at->kind != TREE_SLIDES) {
            pushes[at->first + at->count - 1] += moment;
        }
        body = at->parent;
    }
}

void tree_act(const Tree *tree, const DriverMotion *motions, const DriverAction *actions,
              double *pushes)
{
    for (size_t i = 0; i < tree->of->body_count; i++) {
        tree_push(tree, motions, (int)i, (Vec2){0.0, 0.0}, actions[i].force, pushes);
        tree_turn(tree, (int)i, actions[i].moment, pushes);
    }
}

void tree_bends(const Tree *tree, const DriverMotion *motions, const double *rates, Vec2 *bends)
{
    const DriverMotion still = {.omega = 0.0};
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const size_t number = tree->order[i];
        const TreeBody *body = &tree->bodies[number];
        const DriverMotion *own = &motions[number];
        const bool has_parent = body->parent != DRIVER_GROUND;
        const DriverMotion *parent = has_parent ? &motions[body->parent] : &still;
        const Vec2 carried = has_parent ? bends[body->parent] : (Vec2){0.0, 0.0};
        const double spin = parent->omega * parent->omega;
        if (body->kind == TREE_FREE) {
            bends[number] = (Vec2){0.0, 0.0};
        } else if (body->kind == TREE_TURNS) {
            const Vec2 pivot = vec2_rotate(parent->angle, body->offset);
            const Vec2 arm = turned_arm(tree, (int)number, own->angle, body->anchor);
            bends[number] = vec2_add(vec2_sub(carried, vec2_scale(spin, pivot)),
                                     vec2_scale(own->omega * own->omega, arm));
        } else {
            const Vec2 arm = vec2_sub(own->position, parent->position);
            const Vec2 axis = turned_arm(tree, (int)number, own->angle, body->axis);
            bends[number] =
                vec2_add(vec2_sub(carried, vec2_scale(spin, arm)),
                         vec2_scale(2.0 * parent->omega * rates[body->first], vec2_perp(axis)));
        }
    }
}
