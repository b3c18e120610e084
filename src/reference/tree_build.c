// Which coordinates move a linkage? Found once: bodies hang on known ones by ideal joints, those
// that hang on nothing float, and ideal joints that are left over close loops
// (reference/tree_span.h).
#include "reference/tree.h"

#include "base/layout.h"
#include "reference/tree_span.h"

#include <assert.h>
#include <stdlib.h>

static bool is_driven(const Tree *tree, int body)
{
    return body != LINKAGE_GROUND && body == tree->driven;
}

static void add_node(Tree *tree, int body, int joint, int parent)
{
    TreeNode *node = &tree->nodes[tree->node_count++];
    *node =
        (TreeNode){.body = body, .joint = joint, .parent = parent, .parent_node = -1, .depth = 1};
    tree->coordinate_count += joint >= 0 ? 1 : 3;
    node->column = tree->coordinate_count - 1;
    node->angle_column = (int)node->column;
    if (joint >= 0) {
        const Joint *of = &tree->linkage->joints[joint];
        const bool is_own_b = of->body_b == body;
        node->own_end = 2 * joint + (is_own_b ? 1 : 0);
        node->parent_end = 2 * joint + (is_own_b ? 0 : 1);
        node->is_sliding = of->kind == JOINT_PRISMATIC;
        node->parent_node = parent == LINKAGE_GROUND ? -1 : tree->node_of[parent];
        node->depth = node->parent_node >= 0 ? tree->nodes[node->parent_node].depth + 1 : 1;
        if (node->is_sliding) {
            node->angle_column = parent == LINKAGE_GROUND ? -1 : tree->angle_column[parent];
            tree->is_carried[body] = parent != LINKAGE_GROUND && tree->is_carried[parent];
        }
        tree->is_driven_hung_on = tree->is_driven_hung_on || is_driven(tree, parent);
    }
    tree->angle_column[body] = node->angle_column;
    tree->node_of[body] = (int)tree->node_count - 1;
}

static void set_end(Tree *tree, int end, int body, Vec2 anchor)
{
    tree->end_bodies[end] = body;
    tree->anchors[end] = anchor;
    if (body == LINKAGE_GROUND && end >= tree->normals) {
        tree->base_arms[end] = anchor;
    }
}

// Sets the ends of a pair; with a line on body a whose normal has a direction there, rad.
static void set_pair(Tree *tree, int pair, const Joint *joint, const Touch *ends,
                     TreeMeasure measure)
{
    set_end(tree, 2 * pair, joint->body_a, ends->anchor_a);
    set_end(tree, 2 * pair + 1, joint->body_b, ends->anchor_b);
    tree->measures[pair] = measure;
    tree->offsets[pair] = ends->clearance;
    if (measure != TREE_POINTS) {
        tree->measured[tree->measured_count++] = pair;
    }
    if (measure == TREE_LINE) {
        set_end(tree, tree->normals + pair, joint->body_a,
                vec2_rotate(ends->direction, (Vec2){1.0, 0.0}));
    }
}

// The ends of each body, in the order of the pairs.
static void list_ends(Tree *tree)
{
    const size_t bodies = tree->linkage->body_count;
    const int pairs = (int)tree->pair_count;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < 3 * pairs; i++) {
            const int end = i % 3 < 2 ? 2 * (i / 3) + i % 3 : tree->normals + i / 3;
            const int body = tree->end_bodies[end];
            if (body == LINKAGE_GROUND || (i % 3 == 2 && tree->measures[i / 3] != TREE_LINE)) {
                continue;
            }
            // the first pass counts; after the second each list begins where the one before ends
            if (pass == 1) {
                tree->ends[tree->end_firsts[body]] = end;
            }
            tree->end_firsts[body + (pass == 0 ? 1 : 0)]++;
        }
        for (size_t body = 0; pass == 0 && body < bodies; body++) {
            tree->end_firsts[body + 1] += tree->end_firsts[body];
        }
    }
    for (size_t body = bodies; body > 0; body--) {
        tree->end_firsts[body] = tree->end_firsts[body - 1];
    }
    tree->end_firsts[0] = 0;
}

size_t tree_own_pairs(const Joint *joint, int number, Touch places[TOUCH_CORNERS])
{
    const bool has_own = joint->kind == JOINT_GUIDE || joint->kind == JOINT_PRISMATIC;
    return has_own ? touch_places(joint, number, places) : 0;
}

static void set_pairs(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    Touch places[TOUCH_CORNERS];
    int corner = (int)linkage->joint_count;
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
        set_pair(tree, i, joint, &places[0], measure);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        tree->corners[i] = corner;
        const size_t own = tree_own_pairs(joint, i, places);
        for (size_t k = 0; k < own; k++) {
            set_pair(tree, corner++, joint, &places[k], TREE_LINE);
        }
    }
    list_ends(tree);
}

// All arrays, from a layout that counts or has the memory.
static void lay(Tree *tree, Layout *layout)
{
    const size_t bodies = tree->linkage->body_count;
    const size_t joints = tree->linkage->joint_count;
    const size_t pairs = tree->pair_count;
    const size_t ends = 3 * pairs;
    tree->nodes = layout_take(layout, bodies, sizeof *tree->nodes);
    tree->angle_column = layout_take(layout, bodies, sizeof *tree->angle_column);
    tree->node_of = layout_take(layout, bodies, sizeof *tree->node_of);
    tree->corners = layout_take(layout, joints, sizeof *tree->corners);
    tree->measured = layout_take(layout, pairs, sizeof *tree->measured);
    tree->measures = layout_take(layout, pairs, sizeof *tree->measures);
    tree->offsets = layout_take(layout, pairs, sizeof *tree->offsets);
    tree->end_bodies = layout_take(layout, ends, sizeof *tree->end_bodies);
    tree->anchors = layout_take(layout, ends, sizeof *tree->anchors);
    tree->end_firsts = layout_take(layout, bodies + 1, sizeof *tree->end_firsts);
    tree->ends = layout_take(layout, ends, sizeof *tree->ends);
    tree->is_carried = layout_take(layout, bodies, sizeof *tree->is_carried);
    tree->loops = layout_take(layout, joints, sizeof *tree->loops);
    tree->base_angle = layout_take(layout, bodies, sizeof *tree->base_angle);
    tree->base_position = layout_take(layout, bodies, sizeof *tree->base_position);
    tree->base_slide = layout_take(layout, bodies, sizeof *tree->base_slide);
    tree->base_motions = layout_take(layout, bodies, sizeof *tree->base_motions);
    tree->long_arms = layout_take(layout, ends, sizeof *tree->long_arms);
    tree->base_arms = layout_take(layout, ends, sizeof *tree->base_arms);
    tree->base_gaps = layout_take(layout, pairs, sizeof *tree->base_gaps);
    tree->base_distances = layout_take(layout, pairs, sizeof *tree->base_distances);
    tree->base_tilts = layout_take(layout, joints, sizeof *tree->base_tilts);
    tree->base_coordinates = layout_take(layout, joints, sizeof *tree->base_coordinates);
}

static void make_room(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    tree->pair_count = linkage->joint_count;
    Touch places[TOUCH_CORNERS];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        tree->pair_count += tree_own_pairs(&linkage->joints[i], (int)i, places);
    }
    tree->normals = 2 * (int)tree->pair_count;
    tree->end_count = 3 * tree->pair_count;
    Layout layout = {NULL, 0};
    lay(tree, &layout);
    tree->memory = calloc(1, layout.used);
    assert(tree->memory != NULL);
    lay(tree, &(Layout){tree->memory, 0});
}

// The joints that the tree has not used, which close loops.
static void list_loops(Tree *tree, const bool *is_used)
{
    const Linkage *linkage = tree->linkage;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage_kind_is_ideal(linkage->joints[i].kind) && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on ||
                                      is_driven(tree, linkage->joints[i].body_a) ||
                                      is_driven(tree, linkage->joints[i].body_b);
        }
    }
}

void tree_build(const Linkage *linkage, Tree *tree)
{
    *tree = (Tree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    make_room(tree);
    set_pairs(tree);
    if (tree->driven >= 0) {
        tree->angle_column[tree->driven] = -1;
        tree->node_of[tree->driven] = -1;
        tree->is_carried[tree->driven] = true;
    }
    Span span = span_find(linkage);
    for (size_t i = 0; i < span.count; i++) {
        add_node(tree, span.steps[i].body, span.steps[i].joint, span.steps[i].parent);
    }
    list_loops(tree, span.is_used);
    span_finish(&span);
}

void tree_finish(Tree *tree)
{
    free(tree->memory);
}

void tree_state_lay(const Tree *tree, Layout *layout, TreeState *state)
{
    const size_t bodies = tree->linkage->body_count;
    state->motions = layout_take(layout, bodies, sizeof *state->motions);
    state->arms = layout_take(layout, tree->end_count, sizeof *state->arms);
    state->turned = layout_take(layout, tree->end_count, sizeof *state->turned);
    state->moved = layout_take(layout, bodies, sizeof *state->moved);
    state->turn = layout_take(layout, bodies, sizeof *state->turn);
    state->bias = layout_take(layout, bodies, sizeof *state->bias);
    state->along = layout_take(layout, tree->node_count, sizeof *state->along);
    state->behind = layout_take(layout, tree->node_count, sizeof *state->behind);
    state->path = layout_take(layout, tree->node_count, sizeof *state->path);
}
