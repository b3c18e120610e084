// How are sliding bodies and loops eliminated?
//
// A front holds what it eliminates first, then the rest of its body's motion and loops'
// multipliers:
//     H x + C^T mu = f,   C x = g
// with x the motion of the body's reference along two directions and its spin. The directions are
// those of the world, or of the line that it slides along.
//     hinge    (spin; x, y; loops)        floating   (spin, x, y; loops)
//     slide    (along; across, spin; loops)
//     loop     (its two rows; motion; other loops)
// What is left of a front is added to the next one, its motion taken there by
//     x, y of a pin = motion of the parent's reference + lever times its spin.
#include "reference/articulated_fronts.h"

#include "reference/tree_line.h"

#include <math.h>

enum { MOTION = 3, LOOP_ROWS = 2 };

// Where a body's motion is in a front, and along which direction its first part is.
typedef struct Frame {
    size_t along;
    size_t across;
    size_t spin;
    Vec2 direction;
} Frame;

static Frame frame_of(const Articulated *articulated, const PlanFront *front)
{
    const ArticulatedLink *link = &articulated->links[front->node];
    const size_t first = front->motion;
    return link->kind == LINK_SLIDE ? (Frame){first, first + 1, first + 2, link->direction}
                                    : (Frame){first + 1, first + 2, first, {1.0, 0.0}};
}

// How many rows a front eliminates, and where its loops begin that it does not.
static size_t eliminated_of(const Articulated *articulated, const PlanFront *front)
{
    if (!front->is_body) {
        return LOOP_ROWS;
    }
    return articulated->links[front->node].kind == LINK_FLOATING ? MOTION : 1;
}

static size_t loops_of(const PlanFront *front)
{
    return front->motion + (front->node >= 0 ? MOTION : 0);
}

static PlanFront *front_at(const Articulated *articulated, size_t number)
{
    return &articulated->plan.fronts[number];
}

// The fronts at a node are [first, last).
static size_t last_of(const Articulated *articulated, int node)
{
    const Plan *plan = &articulated->plan;
    return node < 0 ? plan->front_count : plan->fronts_from[node];
}

// The velocity along a direction of a point on a lever (turned) from the reference.
static FrontTarget at_lever(const Frame *frame, Vec2 direction, double lever)
{
    return (FrontTarget){
        .count = MOTION,
        .rows = {frame->along, frame->across, frame->spin},
        .shares = {vec2_dot(direction, frame->direction),
                   vec2_dot(direction, vec2_perp(frame->direction)), lever},
    };
}

static FrontTarget one_row(size_t row)
{
    return (FrontTarget){.count = 1, .rows = {row}, .shares = {1.0}};
}

// What a row of the motion that is left of a child becomes in the front.
static FrontTarget motion_target(const Articulated *articulated, const PlanFront *front,
                                 const PlanFront *child, size_t row)
{
    if (front->node < 0) {
        return (FrontTarget){.count = 0}; // what hangs on the ground has no motion left
    }
    if (!child->is_body) {
        return one_row(row - child->motion + front->motion);
    }
    const ArticulatedLink *link = &articulated->links[child->node];
    const Frame frame = frame_of(articulated, front);
    if (link->kind == LINK_HINGE) {
        return row == 1 ? at_lever(&frame, (Vec2){1.0, 0.0}, link->lever.x)
                        : at_lever(&frame, (Vec2){0.0, 1.0}, link->lever.y);
    }
    const Vec2 across = vec2_perp(link->direction);
    return row == 1 ? at_lever(&frame, across, vec2_dot(across, link->lever)) : one_row(frame.spin);
}

// What all rows that are left of a child become in the front.
static void find_targets(Articulated *articulated, const PlanFront *front, const PlanChild *entry)
{
    const PlanFront *child = front_at(articulated, (size_t)entry->front);
    const size_t *places = articulated->plan.places + entry->first_place;
    const size_t loops = loops_of(child);
    for (size_t row = eliminated_of(articulated, child); row < child->width; row++) {
        articulated->targets[row] =
            row < loops ? motion_target(articulated, front, child, row)
                        : one_row(places[(row - loops) / LOOP_ROWS] + (row - loops) % LOOP_ROWS);
    }
}

// Adds to an entry of a symmetric matrix of which only the upper triangle is kept.
static inline void add_at(double *matrix, size_t width, size_t row, size_t column, double value)
{
    matrix[row <= column ? row * width + column : column * width + row] += value;
}

// Adds what an entry of a child, in its upper triangle, becomes in the front.
static void add_entry(const FrontTarget *row, const FrontTarget *column, bool is_diagonal,
                      double value, size_t width, double *matrix)
{
    for (size_t i = 0; i < row->count; i++) {
        for (size_t k = 0; k < column->count; k++) {
            const double part = row->shares[i] * column->shares[k] * value;
            if (is_diagonal && row->rows[i] > column->rows[k]) {
                continue; // the other triangle
            }
            const bool is_twice = !is_diagonal && row->rows[i] == column->rows[k];
            add_at(matrix, width, row->rows[i], column->rows[k], is_twice ? 2.0 * part : part);
        }
    }
}

static void add_child(Articulated *articulated, const PlanFront *front, const PlanChild *entry,
                      double *matrix)
{
    const PlanFront *child = front_at(articulated, (size_t)entry->front);
    const double *from = articulated->matrices[entry->front];
    const FrontTarget *targets = articulated->targets;
    find_targets(articulated, front, entry);
    for (size_t i = eliminated_of(articulated, child); i < child->width; i++) {
        for (size_t k = i; k < child->width; k++) {
            add_entry(&targets[i], &targets[k], i == k, from[i * child->width + k], front->width,
                      matrix);
        }
    }
}

// Adds a row of a loop at one of its ends: how it moves by the body's reference and spin.
static void add_row(const Frame *frame, Vec2 direction, double by_spin, size_t row, size_t width,
                    double *matrix)
{
    add_at(matrix, width, row, frame->along, vec2_dot(direction, frame->direction));
    add_at(matrix, width, row, frame->across, vec2_dot(direction, vec2_perp(frame->direction)));
    add_at(matrix, width, row, frame->spin, by_spin);
}

static void add_end(const Articulated *articulated, const PlanFront *front, const PlanEnd *end,
                    const TreeState *state, double *matrix)
{
    const Tree *tree = articulated->tree;
    const int joint = articulated->loops[end->loop];
    const Frame frame = frame_of(articulated, front);
    const double sign = end->side == 0 ? -1.0 : 1.0;
    const bool is_on_line = tree->measures[joint] == TREE_LINE;
    Vec2 arm = state->arms[2 * joint + end->side];
    if (is_on_line && end->side == 0) {
        // the point of body a under the end on body b
        arm = vec2_add(arm, tree_pair_gap(tree, state, joint));
    }
    const Vec2 lever = vec2_add(articulated->links[front->node].centre, vec2_perp(arm));
    const size_t width = front->width;
    if (is_on_line) {
        const Vec2 normal = vec2_scale(sign, tree_normal(tree, state, joint));
        add_row(&frame, normal, vec2_dot(normal, lever), end->row, width, matrix);
        add_row(&frame, (Vec2){0.0, 0.0}, sign, end->row + 1, width, matrix);
    } else {
        add_row(&frame, (Vec2){sign, 0.0}, sign * lever.x, end->row, width, matrix);
        add_row(&frame, (Vec2){0.0, sign}, sign * lever.y, end->row + 1, width, matrix);
    }
}

// What the body itself resists with, and those that hang on it without fronts.
static void add_body(const Articulated *articulated, const PlanFront *front, double *matrix)
{
    const ArticulatedLink *link = &articulated->links[front->node];
    const Frame frame = frame_of(articulated, front);
    const Vec2 d = frame.direction;
    const Vec2 n = vec2_perp(d);
    const Vec2 heavy_d = {link->xx * d.x + link->xy * d.y, link->xy * d.x + link->yy * d.y};
    const Vec2 heavy_n = {link->xx * n.x + link->xy * n.y, link->xy * n.x + link->yy * n.y};
    add_at(matrix, front->width, frame.along, frame.along, vec2_dot(d, heavy_d));
    add_at(matrix, front->width, frame.along, frame.across, vec2_dot(n, heavy_d));
    add_at(matrix, front->width, frame.across, frame.across, vec2_dot(n, heavy_n));
    add_at(matrix, front->width, frame.along, frame.spin, vec2_dot(d, link->b));
    add_at(matrix, front->width, frame.across, frame.spin, vec2_dot(n, link->b));
    add_at(matrix, front->width, frame.spin, frame.spin, link->j);
}

// Eliminates the first rows of a symmetric matrix. Their diagonal keeps 1 / pivot.
static bool eliminate(size_t count, size_t width, double *matrix)
{
    for (size_t p = 0; p < count; p++) {
        double *pivot = matrix + p * width;
        if (!(fabs(pivot[p]) > 0.0)) {
            return false;
        }
        pivot[p] = 1.0 / pivot[p];
        for (size_t i = p + 1; i < width; i++) {
            const double share = pivot[i] * pivot[p];
            for (size_t k = i; k < width && share != 0.0; k++) {
                matrix[i * width + k] -= share * pivot[k];
            }
        }
    }
    return true;
}

bool articulated_fronts_factor(Articulated *articulated, int node, const TreeState *state)
{
    const Plan *plan = &articulated->plan;
    for (size_t i = plan->fronts_from[node + 1]; i < last_of(articulated, node); i++) {
        const PlanFront *front = front_at(articulated, i);
        double *matrix = articulated->matrices[i];
        for (size_t k = 0; k < front->width * front->width; k++) {
            matrix[k] = 0.0;
        }
        if (front->is_body) {
            add_body(articulated, front, matrix);
        }
        for (size_t k = 0; k < front->child_count; k++) {
            add_child(articulated, front, &plan->children[front->first_child + k], matrix);
        }
        for (size_t k = 0; k < front->end_count; k++) {
            add_end(articulated, front, &plan->ends[front->first_end + k], state, matrix);
        }
        if (!eliminate(eliminated_of(articulated, front), front->width, matrix)) {
            return false;
        }
    }
    return true;
}

// What a front is given before it eliminates: on its body, of its loop, and by its children.
static void start_vector(Articulated *articulated, const PlanFront *front, const double *sides,
                         double *vector)
{
    const Plan *plan = &articulated->plan;
    for (size_t i = 0; i < front->width; i++) {
        vector[i] = 0.0;
    }
    if (front->is_body) {
        const ArticulatedLink *link = &articulated->links[front->node];
        const Frame frame = frame_of(articulated, front);
        vector[frame.along] = vec2_dot(frame.direction, link->force);
        vector[frame.across] = vec2_dot(vec2_perp(frame.direction), link->force);
        vector[frame.spin] = link->moment;
    } else if (sides != NULL) {
        const double *own = sides + LOOP_ROWS * plan->loops[front->first_loop];
        vector[0] = own[0];
        vector[1] = own[1];
    }
    for (size_t k = 0; k < front->child_count; k++) {
        const PlanChild *entry = &plan->children[front->first_child + k];
        const PlanFront *child = front_at(articulated, (size_t)entry->front);
        const double *from = articulated->vectors[entry->front];
        find_targets(articulated, front, entry);
        for (size_t i = eliminated_of(articulated, child); i < child->width; i++) {
            const FrontTarget *target = &articulated->targets[i];
            for (size_t part = 0; part < target->count; part++) {
                vector[target->rows[part]] += target->shares[part] * from[i];
            }
        }
    }
}

void articulated_fronts_inwards(Articulated *articulated, int node, const double *sides)
{
    const Plan *plan = &articulated->plan;
    for (size_t i = plan->fronts_from[node + 1]; i < last_of(articulated, node); i++) {
        const PlanFront *front = front_at(articulated, i);
        const double *matrix = articulated->matrices[i];
        double *vector = articulated->vectors[i];
        start_vector(articulated, front, sides, vector);
        for (size_t p = 0; p < eliminated_of(articulated, front); p++) {
            const double *row = matrix + p * front->width;
            const double share = row[p] * vector[p];
            for (size_t k = p + 1; k < front->width; k++) {
                vector[k] -= share * row[k];
            }
        }
    }
}

// Writes into a front's vector what is known of its rows that it does not eliminate.
static void know_rest(Articulated *articulated, const PlanFront *front, const double *multipliers,
                      double *vector)
{
    const Plan *plan = &articulated->plan;
    const int node = front->node;
    if (node >= 0) {
        const ArticulatedLink *link = &articulated->links[node];
        const Frame frame = frame_of(articulated, front);
        const int parent = articulated->tree->nodes[node].parent_node;
        const ArticulatedLink *above = parent >= 0 ? &articulated->links[parent] : NULL;
        Vec2 motion = link->motion;
        double spin = link->spin;
        if (front->is_body) {
            motion = articulated_at(link, above);
            spin = above != NULL ? above->spin : 0.0;
        }
        const double known[MOTION] = {vec2_dot(frame.direction, motion),
                                      vec2_dot(vec2_perp(frame.direction), motion), spin};
        const size_t rows[MOTION] = {frame.along, frame.across, frame.spin};
        for (int k = 0; k < MOTION; k++) {
            if (rows[k] >= eliminated_of(articulated, front)) {
                vector[rows[k]] = known[k];
            }
        }
    }
    const size_t loops = loops_of(front);
    const size_t own = front->is_body ? 0 : 1;
    for (size_t k = own; k < front->loop_count; k++) {
        const double *known = multipliers + LOOP_ROWS * plan->loops[front->first_loop + k];
        vector[loops + LOOP_ROWS * (k - own)] = known[0];
        vector[loops + LOOP_ROWS * (k - own) + 1] = known[1];
    }
}

// Takes from a solved front what it has eliminated.
static void take_solved(Articulated *articulated, const PlanFront *front, const double *vector,
                        double *multipliers)
{
    if (!front->is_body) {
        double *own = multipliers + LOOP_ROWS * articulated->plan.loops[front->first_loop];
        own[0] = vector[0];
        own[1] = vector[1];
        return;
    }
    ArticulatedLink *link = &articulated->links[front->node];
    const Frame frame = frame_of(articulated, front);
    const int parent = articulated->tree->nodes[front->node].parent_node;
    const Vec2 taken = articulated_at(link, parent >= 0 ? &articulated->links[parent] : NULL);
    link->slide = vector[frame.along] - vec2_dot(frame.direction, taken);
    link->motion = vec2_add(vec2_scale(vector[frame.along], frame.direction),
                            vec2_scale(vector[frame.across], vec2_perp(frame.direction)));
    link->spin = vector[frame.spin];
}

void articulated_fronts_outwards(Articulated *articulated, int node, double *multipliers)
{
    const Plan *plan = &articulated->plan;
    for (size_t i = last_of(articulated, node); i-- > plan->fronts_from[node + 1];) {
        const PlanFront *front = front_at(articulated, i);
        const double *matrix = articulated->matrices[i];
        double *vector = articulated->vectors[i];
        know_rest(articulated, front, multipliers, vector);
        for (size_t p = eliminated_of(articulated, front); p-- > 0;) {
            const double *row = matrix + p * front->width;
            double sum = vector[p];
            for (size_t k = p + 1; k < front->width; k++) {
                sum -= row[k] * vector[k];
            }
            vector[p] = sum * row[p];
        }
        take_solved(articulated, front, vector, multipliers);
    }
}
