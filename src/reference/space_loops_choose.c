// Which rows hold the joints that close loops in space, when many follow from others?
//
// They are chosen by Gram-Schmidt, the one that has most left over first. A choice stays until
// another would leave twice as much of its last row: the reactions of joints that hold each
// other up are not determined, and should not jump without need.
//
// A loop moves by the coordinates from its ends up to the body that both hang on. Loops that share
// none choose by themselves; a row is kept over those of its group from the first to the last that
// it has a part in.
#include "reference/space_loops.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

// What is left of a row, of itself, once everything that others hold is taken out
static const double INDEPENDENT = 1e-7;

// A choice stays while its worst row has this share left of what the fittest choice has
static const double FIT = 0.5;

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

static double size_of(const Row *row)
{
    double sum = 0.0;
    for (size_t i = 0; i < row->end - row->first; i++) {
        sum += row->values[i] * row->values[i];
    }
    return sqrt(sum);
}

// Makes a row cover the coordinates of another too.
static void widen(const Row *other, Row *row)
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
        widen(unit, row);
        for (size_t i = unit->first; i < unit->end; i++) {
            row->values[i - row->first] -= share * unit->values[i - unit->first];
        }
    }
    row->size = size_of(row);
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
static void add_node(const Chooser *chooser, int number, Vec3 arm, bool is_point, Vec3 along)
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
static void add_end(const Chooser *chooser, size_t loop, int side, bool is_point, Vec3 along,
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
        add_node(chooser, at, arm, is_point, along);
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
    add_end(chooser, loop, 0, is_point, vec3_scale(-1.0, along), &row);
    add_end(chooser, loop, 1, is_point, along, &row);
    const size_t width = row.end - row.first;
    row.values = zeroed(width, sizeof *row.values);
    memcpy(row.values, chooser->columns + row.first, width * sizeof *row.values);
    memset(chooser->columns + row.first, 0, width * sizeof *row.values);
    row.size = size_of(&row);
    return row;
}

// Makes all rows of the group, or those that are held.
static void make_rows(Chooser *chooser, bool only_held)
{
    const SpaceLoops *loops = chooser->loops;
    const SpaceLoopGroups *groups = &loops->groups;
    chooser->count = 0;
    for (size_t i = groups->first_loop[chooser->group]; i < groups->first_loop[chooser->group + 1];
         i++) {
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            const size_t row = SPACE_JOINT_ROWS * groups->loops[i] + (size_t)which;
            if (!only_held || loops->rows[row].is_held) {
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
        least = count == 0 ? INDEPENDENT * most : least;
        chosen[count++] = best;
        *last = most;
    }
    return count;
}

// Whether the rows that are held still do.
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
    return (count == held && last > FIT * fittest) || fittest_count < held;
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
                loops->rows[SPACE_JOINT_ROWS * groups->loops[i] + k].is_held = false;
            }
        }
        for (size_t i = 0; i < count; i++) {
            loops->rows[chosen[i]].is_held = true;
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
        loops->row_count += loops->rows[i].is_held ? 1 : 0;
    }
}
