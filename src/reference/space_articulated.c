// How does a tree with loops accelerate in space under forces, at a cost linear in its size?
//
// As in the plane (reference/articulated.c), with matrices of 3 by 3 for numbers. With x the motion
// of a body's reference, w its turning, e from there to its centre, p to the reference of a body
// that hangs on it, [p] w = p x w, and A_c, B_c, J_c what that one has left:
//     A x + B w = f,   B' x + J w = t
//     A = m + sum A_c,   B = -m [e] + sum (B_c - A_c [p])
//     J = I - m [e][e] + sum (J_c + [p] (B_c - A_c [p]) - B_c' [p])
// A hinge leaves the turning about its axis u free: with D = u J u,
//     A - B u (B u)' / D,   B - B u (J u)' / D,   J - J u (J u)' / D.
// Source: Featherstone 1983. Loops: reference/space_articulated_fronts.c.
#include "reference/space_articulated.h"

#include "base/zeroed.h"
#include "reference/space_articulated_fronts.h"

static void lay(SpaceArticulated *articulated, size_t loop_count, Layout *layout)
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

static void set_links(SpaceArticulated *articulated)
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

static void make_plan(const SpaceTree *tree, size_t loop_count, const int *loops, Plan *plan,
                      ArticulatedParts *parts)
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
    make_plan(tree, loop_count, loops, &made.plan, &made.parts);
    Layout layout = {NULL, 0};
    layout_take(&layout, 1, sizeof made);
    lay(&made, loop_count, &layout);
    SpaceArticulated *articulated = zeroed(layout.used, 1);
    *articulated = made;
    layout = (Layout){(char *)articulated, 0};
    layout_take(&layout, 1, sizeof made);
    lay(articulated, loop_count, &layout);
    for (size_t i = 0; i < loop_count; i++) {
        articulated->loops[i] = loops[i];
    }
    set_links(articulated);
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
static void start_link(const SpaceArticulated *articulated, const SpaceTreeState *state,
                       size_t number, SpaceLink *link)
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
static void hand_on(const SpaceLink *link, SpaceLink *parent)
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
static void push_inwards(SpaceLink *link, SpaceLink *parent)
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
        start_link(articulated, state, i, &links[i]);
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
            hand_on(link, &links[link->parent]);
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
static inline void solve(SpaceArticulated *articulated, const ArticulatedPart *part,
                         const SpaceTreeState *state, const SpacePush *pushes, const double *sides,
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
        push_inwards(link, link->parent >= 0 ? &links[link->parent] : NULL);
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
    solve(articulated, NULL, state, pushes, sides, rates);
}

void space_articulated_solve_part(SpaceArticulated *articulated, size_t part,
                                  const SpaceTreeState *state, const SpacePush *pushes,
                                  double *rates)
{
    const ArticulatedPart own = articulated_part(&articulated->parts, part);
    solve(articulated, &own, state, pushes, NULL, rates);
}
