// Solves for how a tree with loops accelerates in space under forces, at a cost linear in its size.
//
// As in the plane (reference/plane/articulated.c), with matrices of 3 by 3 for numbers. With x the
// motion of a body's reference, w its turning, e from there to its centre, p to the reference of a
// body that hangs on it, [p] w = p x w, and A_c, B_c, J_c what that one has left:
//     A x + B w = f,   B' x + J w = t
//     A = m + sum A_c,   B = -m [e] + sum (B_c - A_c [p])
//     J = I - m [e][e] + sum (J_c + [p] (B_c - A_c [p]) - B_c' [p])
// A hinge leaves the turning about its axis u free: with D = u J u,
//     A - B u (B u)' / D,   B - B u (J u)' / D,   J - J u (J u)' / D.
// Source: Featherstone 1983. Loops: see below.
#include "reference/space/space_articulated.h"

#include "base/zeroed.h"

enum { SPACE_LINK_FREEDOMS = 6 };

// A body, and all that hangs on it. Its reference is its pin, or the centre where it floats.
struct SpaceLink {
    bool is_floating;
    bool has_fronts;    // whether there are fronts at it, and whether one eliminates its freedom
    bool has_own_front; //
    int parent;         // link that it hangs on, or -1
    int body;           //
    int own_end;        // of the tree
    int parent_end;     //
    size_t freedoms;    // that are eliminated: 1 of a hinge, or 6
    size_t first;       // coordinate
    Vec3 centre;        // m, from the reference to the centre of mass
    Vec3 lever;         // m, from the parent's reference to this one
    // what it resists with, by the motion of the reference and by its turning:
    //     force = a motion + b turning,   moment = b' motion + j turning
    Mat3 a;
    Mat3 b;
    Mat3 j;
    // of the elimination: of a hinge its axis, the force and the moment that turning about it
    // takes, over the root of what that takes along itself; of a floating body Cholesky's factor
    Vec3 axis;
    double root; // 1 / sqrt(axis j axis)
    Vec3 force_share;
    Vec3 moment_share;
    double factor[SPACE_LINK_FREEDOMS][SPACE_LINK_FREEDOMS];
    // of a solution
    Vec3 force;                         // N, at the reference
    Vec3 moment;                        // N m, about it
    double gained[SPACE_LINK_FREEDOMS]; // forward through the factor, of the freedoms eliminated
    Vec3 motion;                        // of the reference
    Vec3 turning;
};

// How a row of a loop depends on the motion of a body's reference, and its turning.
typedef struct SpaceFrontRow {
    Vec3 motion;
    Vec3 turning;
} SpaceFrontRow;

// The rows of a front.
struct SpaceFront {
    SpaceFrontRow *rows;
    double *square; // what is left of the loops among one another, row by row
    double *own;    // by row: what it had of the freedoms that are eliminated, through their factor
    double *vector; // of a solution
    double inverse[SPACE_JOINT_ROWS]; // of the rows that are eliminated: 1 / pivot; 0: not active
};

// Through the factor of a floating body: L^-1 b, in place.
static inline void space_link_forward(const SpaceLink *link, double *b)
{
    for (int i = 0; i < SPACE_LINK_FREEDOMS; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= link->factor[i][k] * b[k];
        }
        b[i] *= link->factor[i][i];
    }
}

// Loops in space are eliminated with the bodies that their rows depend on.
//
// As in the plane (reference/plane/articulated.c), with the freedoms of a body through the factor
// of their own block: with P = L L', p the row's part of them and y = L^-1 p,
//     c_i - (h L'^-1) y_i,   S_ik - y_i . y_k,   g_i - y_i . L^-1 f
// Rows that are not active are zero, and their multipliers too.

enum { SPACE_FRONT_ROWS = SPACE_JOINT_ROWS };

static size_t space_front_rows_of(const PlanFront *front)
{
    return SPACE_FRONT_ROWS * front->loop_count;
}

// The first row of a front that is not eliminated in it.
static size_t space_front_left_of(const PlanFront *front)
{
    return front->is_body ? 0 : SPACE_FRONT_ROWS;
}

// The fronts at a node are [first, last).
static size_t space_front_first_of(const SpaceArticulated *articulated, int node)
{
    return articulated->plan.fronts_from[node + 1];
}

static size_t space_front_last_of(const SpaceArticulated *articulated, int node)
{
    const Plan *plan = &articulated->plan;
    return node < 0 ? plan->front_count : plan->fronts_from[node];
}

// Where a row of a front that comes into another stands there.
static size_t space_front_place_of(const Plan *plan, const PlanChild *entry, size_t row)
{
    return plan->child_rows[entry->first_child_row + row / SPACE_FRONT_ROWS] +
           row % SPACE_FRONT_ROWS;
}

static void space_front_add_child(const SpaceArticulated *articulated, const PlanFront *front,
                                  const PlanChild *entry, SpaceFront *to)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *child = &plan->fronts[entry->front];
    const SpaceFront *from = &articulated->fronts[entry->front];
    const size_t count = space_front_rows_of(child);
    const size_t left = space_front_left_of(child);
    for (size_t i = left; i < count; i++) {
        const size_t row = space_front_place_of(plan, entry, i - left);
        if (front->node >= 0) {
            SpaceFrontRow moved = from->rows[i];
            if (child->is_body) {
                // from the reference of the child to that of what it hangs on
                const Vec3 lever = articulated->links[child->node].lever;
                moved.turning = vec3_add(moved.turning, vec3_cross(lever, moved.motion));
            }
            to->rows[row].motion = vec3_add(to->rows[row].motion, moved.motion);
            to->rows[row].turning = vec3_add(to->rows[row].turning, moved.turning);
        }
        for (size_t k = left; k < count; k++) {
            to->square[row * space_front_rows_of(front) +
                       space_front_place_of(plan, entry, k - left)] += from->square[i * count + k];
        }
    }
}

// Adds what a loop has at one of its ends.
static void space_front_add_end(const SpaceArticulated *articulated, const PlanFront *front,
                                const PlanEnd *end, const SpaceTreeState *state,
                                const SpaceLoopRow *rows, SpaceFront *to)
{
    const int joint = articulated->loops[end->loop];
    const double sign = end->side == 0 ? -1.0 : 1.0;
    const Vec3 lever =
        vec3_add(articulated->links[front->node].centre, state->arms[2 * joint + end->side]);
    for (size_t k = 0; k < SPACE_FRONT_ROWS; k++) {
        const SpaceLoopRow *row = &rows[SPACE_FRONT_ROWS * end->loop + (int)k];
        SpaceFrontRow *own = &to->rows[end->row + k];
        if (!row->is_active) {
            continue;
        }
        const Vec3 along = vec3_scale(sign, row->direction);
        if (k < SPACE_POINT_ROWS) {
            own->motion = vec3_add(own->motion, along);
            own->turning = vec3_add(own->turning, vec3_cross(lever, along));
        } else {
            own->turning = vec3_add(own->turning, along);
        }
    }
}

// Takes a row of a loop out of what a body resists with.
static void take_from_link(const SpaceFrontRow *row, double inverse, SpaceLink *link)
{
    const Vec3 motion = vec3_scale(-inverse, row->motion);
    const Vec3 turning = vec3_scale(-inverse, row->turning);
    const double by_motion[3] = {row->motion.x, row->motion.y, row->motion.z};
    const double by_turning[3] = {row->turning.x, row->turning.y, row->turning.z};
    for (int i = 0; i < 3; i++) {
        link->a.row[i] = vec3_add(link->a.row[i], vec3_scale(by_motion[i], motion));
        link->b.row[i] = vec3_add(link->b.row[i], vec3_scale(by_motion[i], turning));
        link->j.row[i] = vec3_add(link->j.row[i], vec3_scale(by_turning[i], turning));
    }
}

// Eliminates one row of a loop: out of the rows behind it, and out of what the body resists with.
static bool space_front_eliminate_row(size_t count, size_t pivot, bool is_active, SpaceFront *at,
                                      SpaceLink *link)
{
    const double *own = at->square + pivot * count;
    at->inverse[pivot] = 0.0;
    if (!is_active) {
        return true;
    }
    if (!(fabs(own[pivot]) > 0.0)) {
        return false;
    }
    const double inverse = 1.0 / own[pivot];
    at->inverse[pivot] = inverse;
    const SpaceFrontRow *row = &at->rows[pivot];
    for (size_t i = pivot + 1; i < count; i++) {
        const double share = own[i] * inverse;
        at->rows[i].motion = vec3_sub(at->rows[i].motion, vec3_scale(share, row->motion));
        at->rows[i].turning = vec3_sub(at->rows[i].turning, vec3_scale(share, row->turning));
        for (size_t k = pivot + 1; k < count && share != 0.0; k++) {
            at->square[i * count + k] -= share * own[k];
        }
    }
    if (link != NULL) {
        take_from_link(row, inverse, link);
    }
    return true;
}

static void gather_front(SpaceArticulated *articulated, size_t number, const SpaceTreeState *state,
                         const SpaceLoopRow *rows)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[number];
    SpaceFront *at = &articulated->fronts[number];
    const size_t count = space_front_rows_of(front);
    for (size_t k = 0; k < count; k++) {
        at->rows[k] = (SpaceFrontRow){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    }
    for (size_t k = 0; k < count * count; k++) {
        at->square[k] = 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        space_front_add_child(articulated, front, &plan->children[front->first_child + k], at);
    }
    for (size_t k = 0; k < front->end_count; k++) {
        space_front_add_end(articulated, front, &plan->ends[front->first_end + k], state, rows, at);
    }
}

// At a body, or at what no coordinate moves (-1), with what hangs there done: gathers its fronts'
// rows, and eliminates those of loops that come together there. Returns false where one that is
// active has no pivot.
static bool space_fronts_gather(SpaceArticulated *articulated, int node,
                                const SpaceTreeState *state, const SpaceLoopRow *rows)
{
    const Plan *plan = &articulated->plan;
    SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = space_front_first_of(articulated, node);
         i < space_front_last_of(articulated, node); i++) {
        const PlanFront *front = &plan->fronts[i];
        gather_front(articulated, i, state, rows);
        for (size_t pivot = 0; pivot < space_front_left_of(front); pivot++) {
            const int loop = plan->loops[front->first_loop];
            const bool is_active = rows[SPACE_FRONT_ROWS * loop + (int)pivot].is_active;
            if (!space_front_eliminate_row(space_front_rows_of(front), pivot, is_active,
                                           &articulated->fronts[i], link)) {
                return false;
            }
        }
    }
    return true;
}

// Takes a freedom out of a row; what it had of it is given.
static void take_row(const SpaceLink *link, SpaceFrontRow *row, double *own)
{
    if (link->is_floating) {
        const double parts[SPACE_LINK_FREEDOMS] = {row->motion.x,  row->motion.y,  row->motion.z,
                                                   row->turning.x, row->turning.y, row->turning.z};
        for (int k = 0; k < SPACE_LINK_FREEDOMS; k++) {
            own[k] = parts[k];
        }
        space_link_forward(link, own);
        return;
    }
    own[0] = link->root * vec3_dot(link->axis, row->turning);
    row->motion = vec3_sub(row->motion, vec3_scale(own[0], link->force_share));
    row->turning = vec3_sub(row->turning, vec3_scale(own[0], link->moment_share));
}

// Takes the freedoms of a body, which are eliminated, out of its front.
static void space_fronts_take_out(SpaceArticulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const SpaceLink *link = &articulated->links[node];
    const SpaceFront *at = &articulated->fronts[number];
    const size_t count = space_front_rows_of(&articulated->plan.fronts[number]);
    const size_t width = link->freedoms;
    for (size_t i = 0; i < count; i++) {
        double *own = at->own + i * width;
        take_row(link, &at->rows[i], own);
        for (size_t k = 0; k <= i; k++) {
            double sum = 0.0;
            for (size_t m = 0; m < width; m++) {
                sum += own[m] * at->own[k * width + m];
            }
            at->square[i * count + k] -= sum;
            at->square[k * count + i] -= k < i ? sum : 0.0;
        }
    }
}

static void space_front_gather_sides(SpaceArticulated *articulated, size_t i, SpaceLink *link,
                                     const double *sides)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const SpaceFront *at = &articulated->fronts[i];
    const size_t count = space_front_rows_of(front);
    for (size_t k = 0; k < count; k++) {
        const bool is_own = k < space_front_left_of(front) && sides != NULL;
        at->vector[k] =
            is_own ? sides[SPACE_FRONT_ROWS * plan->loops[front->first_loop] + (int)k] : 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        const PlanChild *entry = &plan->children[front->first_child + k];
        const PlanFront *child = &plan->fronts[entry->front];
        const size_t left = space_front_left_of(child);
        for (size_t row = left; row < space_front_rows_of(child); row++) {
            at->vector[space_front_place_of(plan, entry, row - left)] +=
                articulated->fronts[entry->front].vector[row];
        }
    }
    for (size_t pivot = 0; pivot < space_front_left_of(front); pivot++) {
        const double solved = at->vector[pivot] * at->inverse[pivot];
        for (size_t k = pivot + 1; k < count && solved != 0.0; k++) {
            at->vector[k] -= at->square[pivot * count + k] * solved;
        }
        if (link != NULL) {
            const SpaceFrontRow *row = &at->rows[pivot];
            link->force = vec3_sub(link->force, vec3_scale(solved, row->motion));
            link->moment = vec3_sub(link->moment, vec3_scale(solved, row->turning));
        }
    }
}

// The same of the right sides.
static void space_fronts_gather_sides(SpaceArticulated *articulated, int node, const double *sides)
{
    SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = space_front_first_of(articulated, node);
         i < space_front_last_of(articulated, node); i++) {
        space_front_gather_sides(articulated, i, link, sides);
    }
}

// Those at the ground, of a part or of all (NULL).
static void space_fronts_gather_ground_sides(SpaceArticulated *articulated,
                                             const ArticulatedPart *part, const double *sides)
{
    if (part == NULL) {
        space_fronts_gather_sides(articulated, -1, sides);
        return;
    }
    for (size_t i = 0; i < part->front_count; i++) {
        space_front_gather_sides(articulated, part->fronts[i], NULL, sides);
    }
}

static void space_fronts_take_out_sides(SpaceArticulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const SpaceLink *link = &articulated->links[node];
    const SpaceFront *at = &articulated->fronts[number];
    for (size_t i = 0; i < space_front_rows_of(&articulated->plan.fronts[number]); i++) {
        for (size_t m = 0; m < link->freedoms; m++) {
            at->vector[i] -= at->own[i * link->freedoms + m] * link->gained[m];
        }
    }
}

// On the way outwards: gives a body what multipliers that are known push it with; finds those that
// are eliminated at a body whose motion is known.
static void space_fronts_add_multipliers(SpaceArticulated *articulated, int node,
                                         const double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const size_t number = (size_t)plan->front_of[node];
    const PlanFront *front = &plan->fronts[number];
    const SpaceFront *at = &articulated->fronts[number];
    SpaceLink *link = &articulated->links[node];
    for (size_t i = 0; i < space_front_rows_of(front); i++) {
        const int loop = plan->loops[front->first_loop + i / SPACE_FRONT_ROWS];
        const double multiplier =
            multipliers[SPACE_FRONT_ROWS * loop + (int)(i % SPACE_FRONT_ROWS)];
        for (size_t m = 0; m < link->freedoms; m++) {
            link->gained[m] -= at->own[i * link->freedoms + m] * multiplier;
        }
    }
}

static void space_front_find_multipliers(const SpaceArticulated *articulated, size_t i,
                                         const SpaceLink *link, double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const SpaceFront *at = &articulated->fronts[i];
    const size_t count = space_front_rows_of(front);
    const int *loops = plan->loops + front->first_loop;
    for (size_t pivot = space_front_left_of(front); pivot-- > 0;) {
        double sum = at->vector[pivot];
        if (link != NULL) {
            sum -= vec3_dot(at->rows[pivot].motion, link->motion) +
                   vec3_dot(at->rows[pivot].turning, link->turning);
        }
        for (size_t k = pivot + 1; k < count; k++) {
            sum -= at->square[pivot * count + k] *
                   multipliers[SPACE_FRONT_ROWS * loops[k / SPACE_FRONT_ROWS] +
                               (int)(k % SPACE_FRONT_ROWS)];
        }
        multipliers[SPACE_FRONT_ROWS * loops[0] + (int)pivot] = sum * at->inverse[pivot];
    }
}

static void space_fronts_find_multipliers(SpaceArticulated *articulated, int node,
                                          double *multipliers)
{
    const SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = space_front_last_of(articulated, node);
         i-- > space_front_first_of(articulated, node);) {
        space_front_find_multipliers(articulated, i, link, multipliers);
    }
}

// Finds those that are eliminated at the ground, of a part or of all (NULL).
static void space_fronts_find_ground_multipliers(SpaceArticulated *articulated,
                                                 const ArticulatedPart *part, double *multipliers)
{
    if (part == NULL) {
        space_fronts_find_multipliers(articulated, -1, multipliers);
        return;
    }
    for (size_t i = part->front_count; i-- > 0;) {
        space_front_find_multipliers(articulated, part->fronts[i], NULL, multipliers);
    }
}

static void space_articulated_lay(SpaceArticulated *articulated, size_t loop_count,
                                  MemoryLayout *layout)
{
    const Plan *plan = &articulated->plan;
    articulated->links =
        layout_take(layout, articulated->tree->node_count, sizeof *articulated->links);
    articulated->loops = layout_take(layout, loop_count, sizeof *articulated->loops);
    articulated->fronts = layout_take(layout, plan->front_count, sizeof *articulated->fronts);
    for (size_t i = 0; i < plan->front_count; i++) {
        const size_t count = SPACE_JOINT_ROWS * plan->fronts[i].loop_count;
        SpaceFront at = {.rows = layout_take(layout, count, sizeof *at.rows)};
        at.square = layout_take(layout, count * count, sizeof *at.square);
        at.own = layout_take(layout, SPACE_LINK_FREEDOMS * count, sizeof *at.own);
        at.vector = layout_take(layout, count, sizeof *at.vector);
        if (articulated->fronts != NULL) {
            articulated->fronts[i] = at;
        }
    }
}

static void space_articulated_set_links(SpaceArticulated *articulated)
{
    const SpaceTree *tree = articulated->tree;
    const Plan *plan = &articulated->plan;
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        articulated->links[i] = (SpaceLink){
            .is_floating = node->joint < 0,
            .has_fronts = plan->fronts_from[i + 1] < plan->fronts_from[i],
            .has_own_front = plan->front_of[i] >= 0,
            .parent = node->parent_node,
            .body = node->body,
            .own_end = node->own_end,
            .parent_end = node->parent_end,
            .freedoms = node->joint < 0 ? SPACE_LINK_FREEDOMS : 1,
            .first = node->first,
        };
    }
}

static void space_articulated_make_plan(const SpaceTree *tree, size_t loop_count, const int *loops,
                                        Plan *plan, ArticulatedParts *parts)
{
    int *parents = zeroed(tree->node_count, sizeof *parents);
    int(*ends)[2] = zeroed(loop_count, sizeof *ends);
    for (size_t i = 0; i < tree->node_count; i++) {
        parents[i] = tree->nodes[i].parent_node;
    }
    for (size_t i = 0; i < loop_count; i++) {
        for (int side = 0; side < 2; side++) {
            ends[i][side] = space_tree_node_of(tree, tree->ends[2 * loops[i] + side].body);
        }
    }
    const PlanShape shape = {tree->node_count, parents, loop_count, (const int(*)[2])ends,
                             SPACE_JOINT_ROWS};
    articulated_plan_make(&shape, plan);
    articulated_parts_find(&shape, plan, parts);
    free(parents);
    free(ends);
}

SpaceArticulated *space_articulated_create(const SpaceTree *tree, size_t loop_count,
                                           const int *loops)
{
    SpaceArticulated made = {.tree = tree};
    space_articulated_make_plan(tree, loop_count, loops, &made.plan, &made.parts);
    MemoryLayout layout = {NULL, 0};
    layout_take(&layout, 1, sizeof made);
    space_articulated_lay(&made, loop_count, &layout);
    SpaceArticulated *articulated = zeroed(layout.used, 1);
    *articulated = made;
    layout = (MemoryLayout){(char *)articulated, 0};
    layout_take(&layout, 1, sizeof made);
    space_articulated_lay(articulated, loop_count, &layout);
    for (size_t i = 0; i < loop_count; i++) {
        articulated->loops[i] = loops[i];
    }
    space_articulated_set_links(articulated);
    return articulated;
}

void space_articulated_destroy(SpaceArticulated *articulated)
{
    if (articulated != NULL) {
        articulated_plan_finish(&articulated->plan);
        articulated_parts_finish(&articulated->parts);
        free(articulated);
    }
}

// a + s u v' of two vectors.
static Mat3 plus_outer(Mat3 a, double scale, Vec3 u, Vec3 v)
{
    a.row[0] = vec3_add(a.row[0], vec3_scale(scale * u.x, v));
    a.row[1] = vec3_add(a.row[1], vec3_scale(scale * u.y, v));
    a.row[2] = vec3_add(a.row[2], vec3_scale(scale * u.z, v));
    return a;
}

// What the body itself resists with.
static void space_articulated_start_link(const SpaceArticulated *articulated,
                                         const SpaceTreeState *state, size_t number,
                                         SpaceLink *link)
{
    const double mass = articulated->tree->linkage->bodies[link->body].mass;
    const Vec3 none = {0.0, 0.0, 0.0};
    link->centre = link->is_floating ? none : vec3_scale(-1.0, state->arms[link->own_end]);
    link->axis = state->turning[number][0];
    const Vec3 e = link->centre;
    link->a = (Mat3){{{mass, 0.0, 0.0}, {0.0, mass, 0.0}, {0.0, 0.0, mass}}};
    link->b = (Mat3){{{0.0, mass * e.z, -mass * e.y},
                      {-mass * e.z, 0.0, mass * e.x},
                      {mass * e.y, -mass * e.x, 0.0}}};
    const double square = mass * vec3_dot(e, e);
    link->j = plus_outer(space_tree_inertia(articulated->tree, state, link->body), -mass, e, e);
    link->j.row[0].x += square;
    link->j.row[1].y += square;
    link->j.row[2].z += square;
    if (link->parent >= 0) {
        // the centre of the parent is known: it stands before what hangs on it
        link->lever =
            vec3_add(articulated->links[link->parent].centre, state->arms[link->parent_end]);
    }
}

static bool eliminate_hinge(SpaceLink *link)
{
    const Vec3 moment = mat3_apply(&link->j, link->axis);
    const double own = vec3_dot(link->axis, moment);
    if (!(own > 0.0)) {
        return false;
    }
    link->root = 1.0 / sqrt(own);
    link->force_share = vec3_scale(link->root, mat3_apply(&link->b, link->axis));
    link->moment_share = vec3_scale(link->root, moment);
    link->a = plus_outer(link->a, -1.0, link->force_share, link->force_share);
    link->b = plus_outer(link->b, -1.0, link->force_share, link->moment_share);
    link->j = plus_outer(link->j, -1.0, link->moment_share, link->moment_share);
    return true;
}

// Cholesky's factor of all six freedoms.
static bool eliminate_floating(SpaceLink *link)
{
    double(*factor)[SPACE_LINK_FREEDOMS] = link->factor;
    for (int i = 0; i < 3; i++) {
        const Vec3 a = link->a.row[i];
        const Vec3 b = link->b.row[i];
        const Vec3 j = link->j.row[i];
        const double first[3] = {a.x, a.y, a.z};
        const double second[3] = {b.x, b.y, b.z};
        const double third[3] = {j.x, j.y, j.z};
        for (int k = 0; k < 3; k++) {
            factor[i][k] = first[k];
            factor[3 + k][i] = second[k];
            factor[3 + i][3 + k] = third[k];
        }
    }
    for (int i = 0; i < SPACE_LINK_FREEDOMS; i++) {
        for (int k = 0; k <= i; k++) {
            double sum = factor[i][k];
            for (int m = 0; m < k; m++) {
                sum -= factor[i][m] * factor[k][m];
            }
            if (k < i) {
                factor[i][k] = sum * factor[k][k];
            } else if (sum > 0.0) {
                factor[i][i] = 1.0 / sqrt(sum);
            } else {
                return false;
            }
        }
    }
    return true;
}

// Adds what is left of a body to the one it hangs on.
static void space_articulated_pass_inwards(const SpaceLink *link, SpaceLink *parent)
{
    const Vec3 p = link->lever;
    const Vec3 *b = link->b.row;
    Mat3 moved;
    for (int i = 0; i < 3; i++) {
        moved.row[i] = vec3_sub(b[i], vec3_cross(link->a.row[i], p));
        parent->a.row[i] = vec3_add(parent->a.row[i], link->a.row[i]);
        parent->b.row[i] = vec3_add(parent->b.row[i], moved.row[i]);
        parent->j.row[i] = vec3_add(parent->j.row[i], link->j.row[i]);
    }
    const Vec3 *x = moved.row;
    const Vec3 turned[3] = {
        vec3_sub(vec3_scale(p.y, x[2]), vec3_scale(p.z, x[1])),
        vec3_sub(vec3_scale(p.z, x[0]), vec3_scale(p.x, x[2])),
        vec3_sub(vec3_scale(p.x, x[1]), vec3_scale(p.y, x[0])),
    };
    const Vec3 columns[3] = {
        {b[0].x, b[1].x, b[2].x}, {b[0].y, b[1].y, b[2].y}, {b[0].z, b[1].z, b[2].z}};
    for (int i = 0; i < 3; i++) {
        parent->j.row[i] = vec3_add(parent->j.row[i], turned[i]);
        parent->j.row[i] = vec3_add(parent->j.row[i], vec3_cross(p, columns[i]));
    }
}

// The same of the forces.
static void space_articulated_push_inwards(SpaceLink *link, SpaceLink *parent)
{
    if (link->is_floating) {
        const double forces[SPACE_LINK_FREEDOMS] = {link->force.x,  link->force.y,  link->force.z,
                                                    link->moment.x, link->moment.y, link->moment.z};
        for (int i = 0; i < SPACE_LINK_FREEDOMS; i++) {
            link->gained[i] = forces[i];
        }
        space_link_forward(link, link->gained);
        return;
    }
    const double own = link->root * vec3_dot(link->axis, link->moment);
    link->gained[0] = own;
    if (parent != NULL) {
        const Vec3 force = vec3_sub(link->force, vec3_scale(own, link->force_share));
        const Vec3 moment = vec3_sub(link->moment, vec3_scale(own, link->moment_share));
        parent->force = vec3_add(parent->force, force);
        parent->moment = vec3_add(parent->moment, vec3_add(moment, vec3_cross(link->lever, force)));
    }
}

// A floating body's motion, and its coordinates' rates: of its turn by what they turn it with.
static void move_floating(SpaceLink *link, const Vec3 *turning, double *rates)
{
    double x[SPACE_LINK_FREEDOMS];
    for (int i = SPACE_LINK_FREEDOMS; i-- > 0;) {
        x[i] = link->gained[i];
        for (int k = i + 1; k < SPACE_LINK_FREEDOMS; k++) {
            x[i] -= link->factor[k][i] * x[k];
        }
        x[i] *= link->factor[i][i];
    }
    link->motion = (Vec3){x[0], x[1], x[2]};
    link->turning = (Vec3){x[3], x[4], x[5]};
    const Mat3 columns = {{turning[0], turning[1], turning[2]}};
    const Mat3 inverse = mat3_inverse(&columns);
    const Vec3 turn = mat3_apply_back(&inverse, link->turning);
    const double own[SPACE_LINK_FREEDOMS] = {x[0], x[1], x[2], turn.x, turn.y, turn.z};
    for (int i = 0; i < SPACE_LINK_FREEDOMS; i++) {
        rates[link->first + (size_t)i] = own[i];
    }
}

// A body's motion, from that of what it hangs on.
static void move_hinge(SpaceLink *link, const SpaceLink *parent, double *rates)
{
    const Vec3 none = {0.0, 0.0, 0.0};
    link->motion = link->turning = none;
    if (parent != NULL) {
        link->turning = parent->turning;
        link->motion = vec3_add(parent->motion, vec3_cross(parent->turning, link->lever));
    }
    const double own = link->root * (link->gained[0] - vec3_dot(link->force_share, link->motion) -
                                     vec3_dot(link->moment_share, link->turning));
    link->turning = vec3_add(link->turning, vec3_scale(own, link->axis));
    rates[link->first] = own;
}

bool space_articulated_factor(SpaceArticulated *articulated, const SpaceTreeState *state,
                              const SpaceLoopRow *rows)
{
    SpaceLink *links = articulated->links;
    for (size_t i = 0; i < articulated->tree->node_count; i++) {
        space_articulated_start_link(articulated, state, i, &links[i]);
    }
    for (size_t i = articulated->tree->node_count; i-- > 0;) {
        SpaceLink *link = &links[i];
        if (link->has_fronts && !space_fronts_gather(articulated, (int)i, state, rows)) {
            return false;
        }
        if (!(link->is_floating ? eliminate_floating(link) : eliminate_hinge(link))) {
            return false;
        }
        if (link->has_own_front) {
            space_fronts_take_out(articulated, (int)i);
        }
        if (link->parent >= 0) {
            space_articulated_pass_inwards(link, &links[link->parent]);
        }
    }
    return space_fronts_gather(articulated, -1, state, rows);
}

static void start_forces(SpaceLink *link, const SpacePush *pushes)
{
    link->force = link->moment = (Vec3){0.0, 0.0, 0.0};
    if (pushes != NULL) {
        const SpacePush *push = &pushes[link->body];
        link->force = push->force;
        link->moment = vec3_add(push->moment, vec3_cross(link->centre, push->force));
    }
}

// Of a part, or of the whole tree (NULL).
static inline void space_articulated_solve_links(SpaceArticulated *articulated,
                                                 const ArticulatedPart *part,
                                                 const SpaceTreeState *state,
                                                 const SpacePush *pushes, const double *sides,
                                                 double *rates)
{
    SpaceLink *links = articulated->links;
    double *multipliers = rates + articulated->tree->coordinate_count;
    const size_t count = articulated_part_count(part, articulated->tree->node_count);
    for (size_t number = 0; number < count; number++) {
        start_forces(&links[articulated_part_node(part, number)], pushes);
    }
    for (size_t number = count; number-- > 0;) {
        const size_t i = articulated_part_node(part, number);
        SpaceLink *link = &links[i];
        if (link->has_fronts) {
            space_fronts_gather_sides(articulated, (int)i, sides);
        }
        space_articulated_push_inwards(link, link->parent >= 0 ? &links[link->parent] : NULL);
        if (link->has_own_front) {
            space_fronts_take_out_sides(articulated, (int)i);
        }
    }
    space_fronts_gather_ground_sides(articulated, part, sides);
    space_fronts_find_ground_multipliers(articulated, part, multipliers);
    for (size_t number = 0; number < count; number++) {
        const size_t i = articulated_part_node(part, number);
        SpaceLink *link = &links[i];
        if (link->has_own_front) {
            space_fronts_add_multipliers(articulated, (int)i, multipliers);
        }
        if (link->is_floating) {
            move_floating(link, state->turning[i], rates);
        } else {
            move_hinge(link, link->parent >= 0 ? &links[link->parent] : NULL, rates);
        }
        if (link->has_fronts) {
            space_fronts_find_multipliers(articulated, (int)i, multipliers);
        }
    }
}

void space_articulated_solve(SpaceArticulated *articulated, const SpaceTreeState *state,
                             const SpacePush *pushes, const double *sides, double *rates)
{
    space_articulated_solve_links(articulated, NULL, state, pushes, sides, rates);
}

void space_articulated_solve_part(SpaceArticulated *articulated, size_t part,
                                  const SpaceTreeState *state, const SpacePush *pushes,
                                  double *rates)
{
    const ArticulatedPart own = articulated_part(&articulated->parts, part);
    space_articulated_solve_links(articulated, &own, state, pushes, NULL, rates);
}
