// Keeps closed loops in space closed, and chooses the rows that do.
//
// With a and b the ends of a joint and u their axes the rows hold
//     e_k . (r_b - r_a) = 0,  k = x, y, z        s_k . u_b = 0,  s_k carried by body a, across u_a
// whose second rates are, with t_k = u_b x s_k,
//     e_k . (a_b - a_a)       t_k . (al_b - al_a) + t_k' . (w_b - w_a),
//     t_k' = (w_b x u_b) x s_k + u_b x (w_a x s_k)
#include "reference/space/space_articulated.h"

#include "base/union_find.h"
#include "base/zeroed.h"

#include <math.h>
#include <string.h>

// Groups of loops: those that share coordinates.
//
// A loop moves by the coordinates from its ends up to the body that both hang on. Those that share
// any, directly or by way of others, are a group.

static int space_loop_groups_find_meeting(const SpaceTree *tree, int joint)
{
    int a = space_loop_groups_end(tree, joint, 0);
    int b = space_loop_groups_end(tree, joint, 1);
    while (a != b && a >= 0 && b >= 0) {
        int *deeper = tree->nodes[a].depth >= tree->nodes[b].depth ? &a : &b;
        *deeper = tree->nodes[*deeper].parent_node;
    }
    return a == b ? a : -1;
}

// Joins the nodes of every loop. Writes of each loop one of them, or the number of nodes.
static void join_nodes(const SpaceTree *tree, size_t count, const int *joints, const int *meetings,
                       size_t *roots, size_t *loop_nodes)
{
    union_find_start(roots, tree->node_count);
    for (size_t i = 0; i < count; i++) {
        loop_nodes[i] = tree->node_count;
        for (int side = 0; side < 2; side++) {
            for (int at = space_loop_groups_end(tree, joints[i], side); at != meetings[i];
                 at = tree->nodes[at].parent_node) {
                if (loop_nodes[i] < tree->node_count) {
                    union_find_join(roots, loop_nodes[i], (size_t)at);
                }
                loop_nodes[i] = (size_t)at;
            }
        }
    }
}

// Numbers the coordinates of each group, loop by loop.
static void number_columns(const SpaceTree *tree, const int *joints, SpaceLoopGroups *groups)
{
    bool *is_numbered = zeroed(tree->node_count, sizeof *is_numbered);
    for (size_t group = 0; group < groups->count; group++) {
        for (size_t i = groups->first_loop[group]; i < groups->first_loop[group + 1]; i++) {
            const size_t loop = groups->loops[i];
            for (int side = 0; side < 2; side++) {
                for (int at = space_loop_groups_end(tree, joints[loop], side);
                     at != groups->meetings[loop]; at = tree->nodes[at].parent_node) {
                    if (!is_numbered[at]) {
                        groups->columns[at] = groups->widths[group];
                        groups->widths[group] += space_loop_groups_freedoms(&tree->nodes[at]);
                        is_numbered[at] = true;
                    }
                }
            }
        }
    }
    free(is_numbered);
}

static void space_loop_groups_init(const SpaceTree *tree, size_t count, const int *joints,
                                   SpaceLoopGroups *groups)
{
    *groups = (SpaceLoopGroups){
        .first_loop = zeroed(count + 2, sizeof *groups->first_loop),
        .loops = zeroed(count, sizeof *groups->loops),
        .widths = zeroed(count + 1, sizeof *groups->widths),
        .meetings = zeroed(count, sizeof *groups->meetings),
        .columns = zeroed(tree->node_count, sizeof *groups->columns),
    };
    size_t *roots = zeroed(tree->node_count, sizeof *roots);
    size_t *loop_nodes = zeroed(count, sizeof *loop_nodes);
    size_t *group_of = zeroed(tree->node_count + 1, sizeof *group_of); // by root, and 1 more
    for (size_t i = 0; i < count; i++) {
        groups->meetings[i] = space_loop_groups_find_meeting(tree, joints[i]);
    }
    join_nodes(tree, count, joints, groups->meetings, roots, loop_nodes);
    // a loop that nothing moves is in no group: loop_nodes[i] becomes the group, from 1 on
    for (size_t i = 0; i < count; i++) {
        if (loop_nodes[i] < tree->node_count) {
            size_t *group = &group_of[union_find_root(roots, loop_nodes[i])];
            *group = *group > 0 ? *group : ++groups->count;
            loop_nodes[i] = *group;
            groups->first_loop[*group]++;
        } else {
            loop_nodes[i] = 0;
        }
    }
    size_t *next = zeroed(groups->count + 1, sizeof *next);
    for (size_t group = 0; group < groups->count; group++) {
        groups->first_loop[group + 1] += groups->first_loop[group];
        next[group] = groups->first_loop[group];
    }
    for (size_t i = 0; i < count; i++) {
        if (loop_nodes[i] > 0) {
            groups->loops[next[loop_nodes[i] - 1]++] = i;
        }
    }
    number_columns(tree, joints, groups);
    free(next);
    free(group_of);
    free(loop_nodes);
    free(roots);
}

static void space_loop_groups_finish(SpaceLoopGroups *groups)
{
    free(groups->first_loop);
    free(groups->loops);
    free(groups->widths);
    free(groups->meetings);
    free(groups->columns);
}

static Vec3 side_of(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop, int which)
{
    const int body = loops->tree->ends[2 * loops->joints[loop]].body;
    return space_tree_direction(state, body, loops->base_sides[loop][which - SPACE_POINT_ROWS]);
}

// Direction of a row of a loop: that of its force on body b, or of its moment (3 and 4).
static Vec3 space_loops_direction(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                                  int which)
{
    static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    if (which < SPACE_POINT_ROWS) {
        return AXES[which];
    }
    return vec3_cross(space_tree_axis(loops->tree, state, 2 * loops->joints[loop] + 1),
                      side_of(loops, state, loop, which));
}

// The choice of rows that hold the joints that close loops, when many follow from others.
//
// They are chosen by Gram-Schmidt, the one that has most left over first. A choice stays until
// another would leave twice as much of its last row: the reactions of joints that hold each
// other up are not determined, and should not jump without need.
//
// A loop moves by the coordinates from its ends up to the body that both hang on. Loops that share
// none choose by themselves; a row is kept over those of its group from the first to the last that
// it has a part in.

// What is left of a row, of itself, once everything that others hold is taken out
static const double CHOICE_INDEPENDENT_SHARE = 1e-7;

// A choice stays while its worst row has this share left of what the fittest choice has
static const double CHOICE_KEPT_SHARE = 0.5;

// A row over some of a group's coordinates, in units of length; zero in the others.
typedef struct Row {
    size_t loop;
    int which;
    bool is_out; // it is taken, or nothing that counts is left of it
    size_t first;
    size_t end;
    double *values;
    double size;
} Row;

static double choice_size_of(const Row *row)
{
    double sum = 0.0;
    for (size_t i = 0; i < row->end - row->first; i++) {
        sum += row->values[i] * row->values[i];
    }
    return sqrt(sum);
}

// Makes a row cover the coordinates of another too.
static void choice_widen(const Row *other, Row *row)
{
    const size_t first = other->first < row->first ? other->first : row->first;
    const size_t end = other->end > row->end ? other->end : row->end;
    if (first == row->first && end == row->end) {
        return;
    }
    double *values = zeroed(end - first, sizeof *values);
    memcpy(values + (row->first - first), row->values, (row->end - row->first) * sizeof *values);
    free(row->values);
    row->values = values;
    row->first = first;
    row->end = end;
}

// Takes out of a row what a unit row has of it, twice for rounding.
static void take_out(const Row *unit, Row *row)
{
    for (int pass = 0; pass < 2; pass++) {
        const size_t first = unit->first > row->first ? unit->first : row->first;
        const size_t end = unit->end < row->end ? unit->end : row->end;
        double share = 0.0;
        for (size_t i = first; i < end; i++) {
            share += unit->values[i - unit->first] * row->values[i - row->first];
        }
        if (share == 0.0) {
            return;
        }
        choice_widen(unit, row);
        for (size_t i = unit->first; i < unit->end; i++) {
            row->values[i - row->first] -= share * unit->values[i - unit->first];
        }
    }
    row->size = choice_size_of(row);
}

// What the rows of a group are made at.
typedef struct Chooser {
    const SpaceLoops *loops;
    const SpaceTreeState *state;
    size_t group;
    double length;   // m, by which turns of rows are measured: the furthest reach of any body
    double *columns; // room: by coordinate of the group
    size_t count;
    Row *rows;
} Chooser;

// Adds what a node's coordinates have of a row, by the arm to its point.
static void choice_add_node(const Chooser *chooser, int number, Vec3 arm, bool is_point, Vec3 along)
{
    const SpaceTree *tree = chooser->loops->tree;
    const SpaceNode *node = &tree->nodes[number];
    const double unit = (is_point ? 1.0 : chooser->length) / tree->reaches[node->body];
    double *own = chooser->columns + chooser->loops->groups.columns[number];
    const Vec3 moment = is_point ? vec3_cross(arm, along) : along;
    const Vec3 *turning = chooser->state->turning[number];
    if (node->joint >= 0) {
        own[0] += unit * vec3_dot(turning[0], moment);
        return;
    }
    const double linear[3] = {along.x, along.y, along.z};
    for (int k = 0; k < 3; k++) {
        own[k] += is_point ? linear[k] : 0.0;
        own[3 + k] += unit * vec3_dot(turning[k], moment);
    }
}

// Adds what one end of a loop has of a row. Writes the coordinates in between.
static void choice_add_end(const Chooser *chooser, size_t loop, int side, bool is_point, Vec3 along,
                           Row *row)
{
    const SpaceLoops *loops = chooser->loops;
    const SpaceTree *tree = loops->tree;
    const int joint = loops->joints[loop];
    Vec3 arm = chooser->state->arms[2 * joint + side];
    for (int at = space_loop_groups_end(tree, joint, side); at != loops->groups.meetings[loop];
         at = tree->nodes[at].parent_node) {
        const SpaceNode *node = &tree->nodes[at];
        const size_t column = loops->groups.columns[at];
        if (node->joint >= 0) {
            arm = vec3_sub(arm, chooser->state->arms[node->own_end]);
        }
        choice_add_node(chooser, at, arm, is_point, along);
        row->first = column < row->first ? column : row->first;
        row->end = column + space_loop_groups_freedoms(node) > row->end
                       ? column + space_loop_groups_freedoms(node)
                       : row->end;
        if (node->joint >= 0) {
            arm = vec3_add(arm, chooser->state->arms[node->parent_end]);
        }
    }
}

static Row make_row(const Chooser *chooser, size_t loop, int which)
{
    const bool is_point = which < SPACE_POINT_ROWS;
    const Vec3 along = space_loops_direction(chooser->loops, chooser->state, loop, which);
    Row row = {
        .loop = loop, .which = which, .first = chooser->loops->groups.widths[chooser->group]};
    choice_add_end(chooser, loop, 0, is_point, vec3_scale(-1.0, along), &row);
    choice_add_end(chooser, loop, 1, is_point, along, &row);
    const size_t width = row.end - row.first;
    row.values = zeroed(width, sizeof *row.values);
    memcpy(row.values, chooser->columns + row.first, width * sizeof *row.values);
    memset(chooser->columns + row.first, 0, width * sizeof *row.values);
    row.size = choice_size_of(&row);
    return row;
}

// Makes all rows of the group, or those that are active.
static void make_rows(Chooser *chooser, bool only_held)
{
    const SpaceLoops *loops = chooser->loops;
    const SpaceLoopGroups *groups = &loops->groups;
    chooser->count = 0;
    for (size_t i = groups->first_loop[chooser->group]; i < groups->first_loop[chooser->group + 1];
         i++) {
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            const size_t row = SPACE_JOINT_ROWS * groups->loops[i] + (size_t)which;
            if (!only_held || loops->rows[row].is_active) {
                chooser->rows[chooser->count++] = make_row(chooser, groups->loops[i], which);
            }
        }
    }
}

static void free_rows(Chooser *chooser)
{
    for (size_t i = 0; i < chooser->count; i++) {
        free(chooser->rows[i].values);
    }
}

// Chooses rows, the one with most left first: writes of each how it stands in the list. Returns
// their number, and how much was left of the last.
static size_t choose(Chooser *chooser, size_t *chosen, double *last)
{
    const size_t width = chooser->loops->groups.widths[chooser->group];
    size_t count = 0;
    double least = 0.0;
    while (count < width) {
        size_t best = chooser->count;
        double most = least;
        for (size_t i = 0; i < chooser->count; i++) {
            Row *row = &chooser->rows[i];
            // what is left of it can only become less
            row->is_out = row->is_out || !(row->size > least);
            if (!row->is_out && row->size > most) {
                best = i;
                most = row->size;
            }
        }
        if (best == chooser->count) {
            break;
        }
        Row *unit = &chooser->rows[best];
        unit->is_out = true;
        for (size_t k = 0; k < unit->end - unit->first; k++) {
            unit->values[k] /= most;
        }
        for (size_t i = 0; i < chooser->count; i++) {
            if (!chooser->rows[i].is_out) {
                take_out(unit, &chooser->rows[i]);
            }
        }
        least = count == 0 ? CHOICE_INDEPENDENT_SHARE * most : least;
        chosen[count++] = best;
        *last = most;
    }
    return count;
}

// Whether the rows that are active still do.
static bool is_fit(Chooser *chooser, size_t fittest_count, double fittest)
{
    size_t *chosen = zeroed(chooser->count, sizeof *chosen);
    double last = 0.0;
    make_rows(chooser, true);
    const size_t held = chooser->count;
    const size_t count = choose(chooser, chosen, &last);
    free_rows(chooser);
    free(chosen);
    // at a dead point fewer are independent, for an instant
    return (count == held && last > CHOICE_KEPT_SHARE * fittest) || fittest_count < held;
}

static void choose_group(SpaceLoops *loops, Chooser *chooser, bool is_first)
{
    const SpaceLoopGroups *groups = &loops->groups;
    const size_t group = chooser->group;
    const size_t most =
        SPACE_JOINT_ROWS * (groups->first_loop[group + 1] - groups->first_loop[group]);
    chooser->rows = zeroed(most, sizeof *chooser->rows);
    chooser->columns = zeroed(groups->widths[group], sizeof *chooser->columns);
    size_t *chosen = zeroed(most, sizeof *chosen);
    double fittest = 0.0;
    make_rows(chooser, false);
    const size_t count = choose(chooser, chosen, &fittest);
    for (size_t i = 0; i < count; i++) {
        const Row *row = &chooser->rows[chosen[i]];
        chosen[i] = SPACE_JOINT_ROWS * row->loop + (size_t)row->which;
    }
    free_rows(chooser);
    if (is_first || !is_fit(chooser, count, fittest)) {
        for (size_t i = groups->first_loop[group]; i < groups->first_loop[group + 1]; i++) {
            for (size_t k = 0; k < SPACE_JOINT_ROWS; k++) {
                loops->rows[SPACE_JOINT_ROWS * groups->loops[i] + k].is_active = false;
            }
        }
        for (size_t i = 0; i < count; i++) {
            loops->rows[chosen[i]].is_active = true;
        }
    }
    free(chosen);
    free(chooser->columns);
    free(chooser->rows);
}

static void set_sides(SpaceLoops *loops)
{
    for (size_t i = 0; i < loops->count; i++) {
        const Vec3 axis = loops->tree->base_axes[2 * loops->joints[i]];
        loops->base_sides[i][0] = vec3_normal_to(axis);
        loops->base_sides[i][1] = vec3_cross(axis, loops->base_sides[i][0]);
    }
}

void space_loops_choose(SpaceLoops *loops, const SpaceTreeState *state, bool is_first)
{
    const SpaceTree *tree = loops->tree;
    Chooser chooser = {.loops = loops, .state = state};
    set_sides(loops);
    if (loops->count == 0) {
        return;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        chooser.length = fmax(chooser.length, tree->reaches[tree->nodes[i].body]);
    }
    for (chooser.group = 0; chooser.group < loops->groups.count; chooser.group++) {
        choose_group(loops, &chooser, is_first);
    }
    loops->row_count = 0;
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        loops->row_count += loops->rows[i].is_active ? 1 : 0;
    }
}

enum { SPACE_LOOPS_PASSES = 2 };

// rad, or of a body's reach: the lengths and axes of a case have at least five digits
static const double SPACE_LOOPS_TORN_SHARE = 1e-5;

// m: a start is closed to some 1e-12; a pin farther from its own was meant to be elsewhere
static const double SPACE_LOOPS_CLOSED_SHARE = 1e-10;

SpaceLoops *space_loops_create(const SpaceTree *tree, size_t count, const int *joints)
{
    const size_t rows = SPACE_JOINT_ROWS * count;
    SpaceLoops *loops = zeroed(1, sizeof *loops);
    *loops = (SpaceLoops){
        .tree = tree,
        .count = count,
        .joints = zeroed(count, sizeof *loops->joints),
        .base_sides = zeroed(count, sizeof *loops->base_sides),
        .rows = zeroed(rows, sizeof *loops->rows),
        .articulated = space_articulated_create(tree, count, joints),
        .sides = zeroed(rows, sizeof *loops->sides),
        .solved = zeroed(tree->coordinate_count + rows, sizeof *loops->solved),
    };
    for (size_t i = 0; i < count; i++) {
        loops->joints[i] = joints[i];
    }
    space_loop_groups_init(tree, count, joints, &loops->groups);
    return loops;
}

void space_loops_destroy(SpaceLoops *loops)
{
    if (loops == NULL) {
        return;
    }
    space_loop_groups_finish(&loops->groups);
    space_articulated_destroy(loops->articulated);
    free(loops->joints);
    free(loops->base_sides);
    free(loops->rows);
    free(loops->sides);
    free(loops->solved);
    free(loops);
}

void space_loops_turn(SpaceLoops *loops, const SpaceTreeState *state)
{
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        if (loops->rows[i].is_active) {
            loops->rows[i].direction = space_loops_direction(loops, state, i / SPACE_JOINT_ROWS,
                                                             (int)(i % SPACE_JOINT_ROWS));
        }
    }
}

double space_loops_bias(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                        int which)
{
    const SpaceTree *tree = loops->tree;
    const int end = 2 * loops->joints[loop];
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = loops->rows[SPACE_JOINT_ROWS * loop + (size_t)which].direction;
    if (which < SPACE_POINT_ROWS) {
        return vec3_dot(direction, vec3_sub(space_tree_bias(state, b, state->arms[end + 1]),
                                            space_tree_bias(state, a, state->arms[end])));
    }
    const SpaceBodyState *at_a = space_tree_body(state, a);
    const SpaceBodyState *at_b = space_tree_body(state, b);
    const Vec3 side = side_of(loops, state, loop, which);
    const Vec3 axis = space_tree_axis(tree, state, end + 1);
    const Vec3 turning = vec3_add(vec3_cross(vec3_cross(at_b->omega, axis), side),
                                  vec3_cross(axis, vec3_cross(at_a->omega, side)));
    return vec3_dot(direction, vec3_sub(at_b->spin_bias, at_a->spin_bias)) +
           vec3_dot(turning, vec3_sub(at_b->omega, at_a->omega));
}

// How far a row is open, m or rad, or how fast it opens.
static double opening_of(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                         int which, bool is_rate)
{
    const SpaceTree *tree = loops->tree;
    const int joint = loops->joints[loop];
    const int end = 2 * joint;
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = space_loops_direction(loops, state, loop, which);
    const bool is_point = which < SPACE_POINT_ROWS;
    if (is_rate && is_point) {
        return vec3_dot(direction, vec3_sub(space_tree_velocity(state, b, state->arms[end + 1]),
                                            space_tree_velocity(state, a, state->arms[end])));
    }
    if (is_rate) {
        return vec3_dot(direction, vec3_sub(space_tree_body(state, b)->omega,
                                            space_tree_body(state, a)->omega));
    }
    return is_point ? vec3_dot(direction, space_tree_gap(tree, state, joint))
                    : vec3_dot(space_tree_axis(tree, state, end + 1),
                               side_of(loops, state, loop, which));
}

// Changes x by the least that takes the openings of all rows, or their rates, away.
static void space_loops_move_least(SpaceLoops *loops, const SpaceTreeState *state, bool is_rate,
                                   double *x)
{
    space_loops_turn(loops, state);
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        loops->sides[i] = loops->rows[i].is_active
                              ? -opening_of(loops, state, i / SPACE_JOINT_ROWS,
                                            (int)(i % SPACE_JOINT_ROWS), is_rate)
                              : 0.0;
    }
    if (!space_articulated_factor(loops->articulated, state, loops->rows)) {
        return;
    }
    space_articulated_solve(loops->articulated, state, NULL, loops->sides, loops->solved);
    for (size_t j = 0; j < loops->tree->coordinate_count; j++) {
        x[j] += loops->solved[j];
    }
}

double space_loops_project(SpaceLoops *loops, double since_s, double *q, double *u,
                           SpaceTreeState *scratch)
{
    const SpaceTree *tree = loops->tree;
    if (loops->row_count == 0) {
        return 0.0;
    }
    for (int pass = 0; pass < SPACE_LOOPS_PASSES; pass++) {
        space_tree_evaluate(tree, since_s, q, u, scratch);
        space_loops_move_least(loops, scratch, false, q);
    }
    space_tree_evaluate(tree, since_s, q, u, scratch);
    space_loops_move_least(loops, scratch, true, u);
    double largest = 0.0;
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        if (loops->rows[i].is_active) {
            largest = fmax(largest, fabs(opening_of(loops, scratch, i / SPACE_JOINT_ROWS,
                                                    (int)(i % SPACE_JOINT_ROWS), false)));
        }
    }
    return largest;
}

int space_loops_torn(const SpaceLoops *loops, const SpaceTreeState *state)
{
    const SpaceTree *tree = loops->tree;
    for (size_t i = 0; i < loops->count; i++) {
        const int joint = loops->joints[i];
        const int body = tree->ends[2 * joint + 1].body;
        const double reach =
            tree->reaches[body == LINKAGE_GROUND ? tree->ends[2 * joint].body : body];
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            const double opening = fabs(opening_of(loops, state, i, which, false));
            if (!(opening <= SPACE_LOOPS_TORN_SHARE * (which < SPACE_POINT_ROWS ? reach : 1.0))) {
                return joint;
            }
        }
    }
    return -1;
}

// Closes the loops with the pins of the joints with play at their starts, if only rounding is left
// of the way there, with speeds that are not used.
static void space_loops_bring(SpaceTree *tree, double *q, SpaceTreeState *scratch)
{
    const Linkage *linkage = tree->linkage;
    int *joints = zeroed(linkage->joint_count, sizeof *joints);
    double *rates = zeroed(tree->coordinate_count, sizeof *rates);
    size_t count = tree->loop_count;
    memcpy(joints, tree->loops, count * sizeof *joints);
    bool are_near = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_has_hole(linkage->joints[i].kind)) {
            const Vec2 start = linkage->joints[i].clearance.start;
            joints[count++] = i;
            tree->base_gaps[i] = vec3_sub(tree->base_gaps[i], (Vec3){start.x, start.y, 0.0});
            are_near = are_near && vec3_length(tree->base_gaps[i]) <= SPACE_LOOPS_CLOSED_SHARE;
        }
    }
    if (are_near) {
        SpaceLoops *pinned = space_loops_create(tree, count, joints);
        space_tree_evaluate(tree, 0.0, q, rates, scratch);
        space_loops_choose(pinned, scratch, true);
        space_loops_project(pinned, 0.0, q, rates, scratch);
        space_loops_destroy(pinned);
    }
    free(rates);
    free(joints);
}

void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch)
{
    space_tree_evaluate(tree, 0.0, q, u, scratch);
    space_loops_choose(loops, scratch, true);
    space_loops_project(loops, 0.0, q, u, scratch);
    space_tree_rebase(tree, 0.0, q, u);
    if (tree->linkage->driver.is_present && !space_starts_elsewhere(tree->linkage)) {
        space_loops_bring(tree, q, scratch);
        // where they are not near, the gaps count from the base again
        space_tree_rebase(tree, 0.0, q, u);
    }
}
