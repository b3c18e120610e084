// Which coordinates move a linkage in space? Found once, from the same tree over its bodies as in
// the plane (reference/tree_span.h).
#include "base/zeroed.h"
#include "reference/space_tree.h"
#include "reference/tree_span.h"

enum { HINGE_COORDINATES = 1, FLOATING_COORDINATES = 6 };

static bool is_driven(const SpaceTree *tree, int body)
{
    return body != LINKAGE_GROUND && body == tree->driven;
}

static void add_node(SpaceTree *tree, const SpanStep *step)
{
    SpaceNode *node = &tree->nodes[tree->node_count];
    *node = (SpaceNode){
        .body = step->body,
        .joint = step->joint,
        .parent = step->parent,
        .parent_node = -1,
        .depth = 1,
        .first = tree->coordinate_count,
    };
    tree->node_of[step->body] = (int)tree->node_count++;
    tree->coordinate_count += step->joint >= 0 ? HINGE_COORDINATES : FLOATING_COORDINATES;
    tree->has_floating = tree->has_floating || step->joint < 0;
    if (step->joint < 0) {
        return;
    }
    const bool is_own_b = tree->linkage->joints[step->joint].body_b == step->body;
    node->own_end = 2 * step->joint + (is_own_b ? 1 : 0);
    node->parent_end = 2 * step->joint + (is_own_b ? 0 : 1);
    node->parent_node = space_tree_node_of(tree, step->parent);
    node->depth = node->parent_node >= 0 ? tree->nodes[node->parent_node].depth + 1 : 1;
    tree->is_carried[step->body] = step->parent != LINKAGE_GROUND && tree->is_carried[step->parent];
    tree->is_driven_hung_on = tree->is_driven_hung_on || is_driven(tree, step->parent);
}

// The ends of each body, the ground's first.
static void list_ends(SpaceTree *tree)
{
    const int count = 2 * (int)tree->linkage->joint_count;
    size_t *next = zeroed(tree->linkage->body_count + 2, sizeof *next);
    for (int end = 0; end < count; end++) {
        tree->ends[end] = space_end(tree->linkage, (size_t)end / 2, end % 2);
        tree->end_firsts[tree->ends[end].body + 2]++;
    }
    for (size_t i = 0; i <= tree->linkage->body_count; i++) {
        tree->end_firsts[i + 1] += tree->end_firsts[i];
        next[i] = tree->end_firsts[i];
    }
    for (int end = 0; end < count; end++) {
        tree->ends_of[next[tree->ends[end].body + 1]++] = end;
    }
    free(next);
}

// All arrays, from a layout that counts or has the memory.
static void lay(SpaceTree *tree, Layout *layout)
{
    const size_t bodies = tree->linkage->body_count;
    const size_t joints = tree->linkage->joint_count;
    tree->nodes = layout_take(layout, bodies, sizeof *tree->nodes);
    tree->node_of = layout_take(layout, bodies, sizeof *tree->node_of);
    tree->reaches = layout_take(layout, bodies, sizeof *tree->reaches);
    tree->is_carried = layout_take(layout, bodies, sizeof *tree->is_carried);
    tree->ends = layout_take(layout, 2 * joints, sizeof *tree->ends);
    tree->end_firsts = layout_take(layout, bodies + 2, sizeof *tree->end_firsts);
    tree->ends_of = layout_take(layout, 2 * joints, sizeof *tree->ends_of);
    tree->loops = layout_take(layout, joints, sizeof *tree->loops);
    tree->base_angle = layout_take(layout, bodies, sizeof *tree->base_angle);
    tree->start_turn = layout_take(layout, bodies, sizeof *tree->start_turn);
    tree->base_turn = layout_take(layout, bodies + 1, sizeof *tree->base_turn);
    tree->base_position = layout_take(layout, bodies + 1, sizeof *tree->base_position);
    tree->base_inertia = layout_take(layout, bodies, sizeof *tree->base_inertia);
    tree->base_arms = layout_take(layout, 2 * joints, sizeof *tree->base_arms);
    tree->base_axes = layout_take(layout, 2 * joints, sizeof *tree->base_axes);
    tree->base_coordinates = layout_take(layout, joints, sizeof *tree->base_coordinates);
    tree->base_gaps = layout_take(layout, joints, sizeof *tree->base_gaps);
}

static void list_loops(SpaceTree *tree, const bool *is_used)
{
    for (int i = 0; i < (int)tree->linkage->joint_count; i++) {
        const Joint *joint = &tree->linkage->joints[i];
        if (joint->kind == JOINT_REVOLUTE && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on || is_driven(tree, joint->body_a) ||
                                      is_driven(tree, joint->body_b);
        }
    }
}

void space_tree_build(const Linkage *linkage, SpaceTree *tree)
{
    *tree = (SpaceTree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    Layout layout = {NULL, 0};
    lay(tree, &layout);
    tree->memory = zeroed(layout.used, 1);
    lay(tree, &(Layout){tree->memory, 0});
    list_ends(tree);
    linkage_reaches(linkage, tree->reaches);
    if (tree->driven >= 0) {
        tree->node_of[tree->driven] = -1;
        tree->is_carried[tree->driven] = true;
    }
    Span span = span_find(linkage);
    for (size_t i = 0; i < span.count; i++) {
        add_node(tree, &span.steps[i]);
    }
    list_loops(tree, span.is_used);
    span_finish(&span);
}

void space_tree_finish(SpaceTree *tree)
{
    free(tree->memory);
}

void space_tree_state_lay(const SpaceTree *tree, Layout *layout, SpaceTreeState *state)
{
    const size_t joints = tree->linkage->joint_count;
    state->bodies = layout_take(layout, tree->linkage->body_count + 1, sizeof *state->bodies);
    state->arms = layout_take(layout, 2 * joints, sizeof *state->arms);
    state->turning = layout_take(layout, tree->node_count, sizeof *state->turning);
    state->path = layout_take(layout, tree->node_count, sizeof *state->path);
}
