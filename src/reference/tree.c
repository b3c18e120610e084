// Which coordinates move a linkage, and how do its bodies follow them?
//
// A body i that hangs by its anchor s_i on the anchor s_p of its parent p, arms R s:
//     r_i = r_p + R_p s_p - R_i s_i
//     v_i = v_p + w_p z x R_p s_p - w_i z x R_i s_i
//     a_i = a_p + al_p z x R_p s_p - w_p^2 R_p s_p - al_i z x R_i s_i + w_i^2 R_i s_i
// The terms without second rates are the bias. Angles are absolute, so each body's own is one
// coordinate. Source: Haug 1989, velocity transformations.
#include "reference/tree.h"

#include "reference/tree_slide.h"

#include <string.h>

// What moves the parent moves the child; where in the chain the parent's angle is.
static void start_chain(const Tree *tree, TreeNode *node)
{
    node->parent_angle = -1;
    if (node->joint < 0 || node->parent == LINKAGE_GROUND || node->parent == tree->driven) {
        return;
    }
    const TreeNode *above = &tree->nodes[tree->node_of[node->parent]];
    node->chain_count = above->chain_count;
    memcpy(node->chain, above->chain, sizeof node->chain);
    for (size_t i = 0; i < above->chain_count; i++) {
        if ((int)above->chain[i] == above->angle_column) {
            node->parent_angle = (int)i;
        }
    }
}

static void add_node(Tree *tree, int body, int joint, int parent)
{
    TreeNode *node = &tree->nodes[tree->node_count++];
    const size_t first = tree->coordinate_count;
    *node = (TreeNode){.body = body, .joint = joint, .parent = parent};
    tree->coordinate_count += joint >= 0 ? 1 : 3;
    node->angle_column = (int)tree->coordinate_count - 1;
    if (joint >= 0) {
        const Joint *of = &tree->linkage->joints[joint];
        const bool is_own_b = of->body_b == body;
        node->own_end = 2 * joint + (is_own_b ? 1 : 0);
        node->parent_end = 2 * joint + (is_own_b ? 0 : 1);
        node->is_sliding = of->kind == JOINT_PRISMATIC;
        if (node->is_sliding) {
            node->angle_column = parent == LINKAGE_GROUND ? -1 : tree->angle_column[parent];
            tree->is_carried[body] = parent != LINKAGE_GROUND && tree->is_carried[parent];
        }
        tree->is_driven_hung_on = tree->is_driven_hung_on || parent == tree->driven;
    }
    tree->angle_column[body] = node->angle_column;
    tree->node_of[body] = (int)tree->node_count - 1;
    start_chain(tree, node);
    for (size_t column = first; column < tree->coordinate_count; column++) {
        node->chain[node->chain_count++] = column;
    }
}

// Hangs on every body that an unused ideal joint connects with a known one, until none is left.
static void grow(Tree *tree, bool *is_known, bool *is_used)
{
    const Linkage *linkage = tree->linkage;
    bool has_grown = true;
    while (has_grown) {
        has_grown = false;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const Joint *joint = &linkage->joints[i];
            if (!linkage_kind_is_ideal(joint->kind) || is_used[i]) {
                continue;
            }
            // the ground is known: it stands one before the first body
            const bool a_known = is_known[joint->body_a + 1];
            const bool b_known = is_known[joint->body_b + 1];
            if (a_known == b_known) {
                continue;
            }
            const int child = a_known ? joint->body_b : joint->body_a;
            add_node(tree, child, (int)i, a_known ? joint->body_a : joint->body_b);
            is_known[child + 1] = true;
            is_used[i] = true;
            has_grown = true;
        }
    }
}

static void add_end(Tree *tree, int end, int body, Vec2 anchor)
{
    tree->end_bodies[end] = body;
    tree->anchors[end] = anchor;
    if (body != LINKAGE_GROUND) {
        tree->ends[body][tree->end_counts[body]++] = end;
    } else if (end >= TREE_NORMAL) {
        tree->base_arms[end] = anchor;
    }
}

// Adds the ends of a pair; with a line on body a whose normal has a direction there, rad.
static void add_pair(Tree *tree, int pair, const Joint *joint, const Touch *ends,
                     TreeMeasure measure)
{
    add_end(tree, 2 * pair, joint->body_a, ends->anchor_a);
    add_end(tree, 2 * pair + 1, joint->body_b, ends->anchor_b);
    tree->measures[pair] = measure;
    tree->offsets[pair] = ends->clearance;
    if (measure != TREE_POINTS) {
        tree->measured[tree->measured_count++] = pair;
    }
    if (measure == TREE_LINE) {
        add_end(tree, TREE_NORMAL + pair, joint->body_a,
                vec2_rotate(ends->direction, (Vec2){1.0, 0.0}));
    }
}

static void list_pairs(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    Touch places[TOUCH_CORNERS];
    tree->pair_count = linkage->joint_count;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        places[0] = (Touch){
            .anchor_a = joint->anchor_a,
            .anchor_b = joint->anchor_b,
            .direction = joint->direction + 0.5 * M_PI,
        };
        TreeMeasure measure = TREE_POINTS;
        if (joint->kind == JOINT_STOP) {
            touch_places(joint, i, places);
            measure = places[0].shape == TOUCH_LINE ? TREE_LINE : TREE_DISC;
        } else if (joint->kind == JOINT_PRISMATIC || joint->kind == JOINT_GUIDE) {
            measure = TREE_LINE;
        }
        add_pair(tree, i, joint, &places[0], measure);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        tree->corners[i] = (int)tree->pair_count;
        for (size_t k = 0; joint->kind == JOINT_GUIDE && k < touch_places(joint, i, places); k++) {
            add_pair(tree, (int)tree->pair_count++, joint, &places[k], TREE_LINE);
        }
    }
}

void tree_build(const Linkage *linkage, Tree *tree)
{
    *tree = (Tree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    list_pairs(tree);
    bool is_known[LINKAGE_BODY_MAX + 1] = {true};
    bool is_used[LINKAGE_JOINT_MAX] = {false};
    if (tree->driven >= 0) {
        tree->angle_column[tree->driven] = -1;
        tree->node_of[tree->driven] = -1;
        tree->is_carried[tree->driven] = true;
        is_known[tree->driven + 1] = true;
        is_used[linkage->driver.joint] = true;
    }
    grow(tree, is_known, is_used);
    for (int body = 0; body < (int)linkage->body_count; body++) {
        if (!is_known[body + 1]) {
            add_node(tree, body, -1, LINKAGE_GROUND);
            is_known[body + 1] = true;
            grow(tree, is_known, is_used);
        }
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage_kind_is_ideal(linkage->joints[i].kind) && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on ||
                                      linkage->joints[i].body_a == tree->driven ||
                                      linkage->joints[i].body_b == tree->driven;
        }
    }
}

// Turns a body's ends by an angle d since the base: the change of an arm s is
//     sin d perp s - (1 - cos d) s
// by a series while d is small. Up to 0.01 the first terms left out, d^9 / 9! and d^8 / 8!, are
// below 3e-21.
static inline void set_arms(const Tree *tree, int body, double d, TreeState *state)
{
    const double small = 0.01;
    const double e = d * d;
    double s = d * (1.0 - e * (1.0 / 6.0) * (1.0 - e * (1.0 / 20.0) * (1.0 - e * (1.0 / 42.0))));
    double r = 0.5 * e * (1.0 - e * (1.0 / 12.0) * (1.0 - e * (1.0 / 30.0)));
    if (!(fabs(d) <= small)) {
        s = sin(d);
        r = 2.0 * sin(0.5 * d) * sin(0.5 * d);
    }
    for (size_t i = 0; i < tree->end_counts[body]; i++) {
        const int end = tree->ends[body][i];
        const Vec2 arm = tree->base_arms[end];
        state->turned[end] = (Vec2){-s * arm.y - r * arm.x, s * arm.x - r * arm.y};
        state->arms[end] = vec2_add(arm, state->turned[end]);
    }
}

static void set_driven(const Tree *tree, double since_s, TreeState *state)
{
    const DriveState *base = &tree->base_drive;
    Motion *motion = &state->motions[tree->driven];
    const double turned = (base->omega + 0.5 * base->alpha * since_s) * since_s;
    const double omega = base->omega + base->alpha * since_s;
    motion->angle = (double)tree->base_angle[tree->driven] + turned;
    motion->omega = omega;
    motion->alpha = base->alpha;
    state->turn[tree->driven] = turned;
    set_arms(tree, tree->driven, turned, state);
    const int end = 2 * tree->linkage->driver.joint + 1;
    const Vec2 arm = state->arms[end];
    tree_set_centre(tree, tree->driven, vec2_scale(-1.0, state->turned[end]), state);
    motion->velocity = vec2_scale(-omega, vec2_perp(arm));
    motion->acceleration =
        vec2_sub(vec2_scale(omega * omega, arm), vec2_scale(base->alpha, vec2_perp(arm)));
    state->bias[tree->driven] = motion->acceleration;
}

static void set_floating(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                         Vec2 *columns, TreeState *state)
{
    const size_t column = (size_t)node->angle_column;
    Motion *motion = &state->motions[node->body];
    tree_set_centre(tree, node->body, (Vec2){q[column - 2], q[column - 1]}, state);
    motion->velocity = (Vec2){u[column - 2], u[column - 1]};
    state->bias[node->body] = (Vec2){0.0, 0.0};
    columns[0] = (Vec2){1.0, 0.0};
    columns[1] = (Vec2){0.0, 1.0};
    columns[2] = (Vec2){0.0, 0.0};
}

static void set_hanging(const Tree *tree, const TreeNode *node, Vec2 *columns, TreeState *state)
{
    Motion *motion = &state->motions[node->body];
    const Vec2 arm = state->arms[node->own_end];
    const Vec2 lever = vec2_perp(arm);
    const Vec2 parent_moved = tree_end_moved(tree, state, node->parent_end);
    tree_set_centre(tree, node->body, vec2_sub(parent_moved, state->turned[node->own_end]), state);
    motion->velocity = vec2_sub(tree_end_velocity(tree, state, node->parent_end),
                                vec2_scale(motion->omega, lever));
    state->bias[node->body] = vec2_add(tree_end_bias(tree, state, node->parent_end),
                                       vec2_scale(motion->omega * motion->omega, arm));
    const size_t own = node->chain_count - 1;
    tree_copy_chain(tree, node, columns, state);
    if (node->parent_angle >= 0) {
        Vec2 *by_parent = &columns[node->parent_angle];
        *by_parent = vec2_add(*by_parent, vec2_perp(state->arms[node->parent_end]));
    }
    columns[own] = vec2_scale(-1.0, lever);
}

void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state)
{
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        if (node->is_sliding) {
            tree_slide_turn(tree, node, q, u, state);
            set_arms(tree, node->body, state->turn[node->body], state);
            tree_slide_move(tree, node, q, u, state->columns[i], state);
            continue;
        }
        const double turn = q[node->angle_column];
        Motion *motion = &state->motions[node->body];
        state->turn[node->body] = turn;
        motion->angle = (double)tree->base_angle[node->body] + turn;
        motion->omega = u[node->angle_column];
        set_arms(tree, node->body, turn, state);
        if (node->joint < 0) {
            set_floating(tree, node, q, u, state->columns[i], state);
        } else {
            set_hanging(tree, node, state->columns[i], state);
        }
    }
}

void tree_accelerate(const Tree *tree, const double *rates, TreeState *state)
{
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        Vec2 acceleration = state->bias[node->body];
        for (size_t j = 0; j < node->chain_count; j++) {
            acceleration =
                vec2_add(acceleration, vec2_scale(rates[node->chain[j]], state->columns[i][j]));
        }
        state->motions[node->body].acceleration = acceleration;
        state->motions[node->body].alpha =
            node->angle_column >= 0 ? rates[node->angle_column] : tree_alpha(state, node->parent);
    }
}
