// How are loops eliminated in space?
//
// As in the plane (reference/articulated_fronts.c), with the freedoms of a body through the factor
// of their own block: with P = L L', p the row's part of them and y = L^-1 p,
//     c_i - (h L'^-1) y_i,   S_ik - y_i . y_k,   g_i - y_i . L^-1 f
// Rows that are not held are zero, and their multipliers too.
#include "reference/space_articulated_fronts.h"

enum { ROWS = SPACE_JOINT_ROWS };

static size_t rows_of(const PlanFront *front)
{
    return ROWS * front->loop_count;
}

// The first row of a front that is not eliminated in it.
static size_t left_of(const PlanFront *front)
{
    return front->is_body ? 0 : ROWS;
}

// The fronts at a node are [first, last).
static size_t first_of(const SpaceArticulated *articulated, int node)
{
    return articulated->plan.fronts_from[node + 1];
}

static size_t last_of(const SpaceArticulated *articulated, int node)
{
    const Plan *plan = &articulated->plan;
    return node < 0 ? plan->front_count : plan->fronts_from[node];
}

// Where a row of a front that comes into another stands there.
static size_t place_of(const Plan *plan, const PlanChild *entry, size_t row)
{
    return plan->places[entry->first_place + row / ROWS] + row % ROWS;
}

static void add_child(const SpaceArticulated *articulated, const PlanFront *front,
                      const PlanChild *entry, SpaceFront *to)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *child = &plan->fronts[entry->front];
    const SpaceFront *from = &articulated->fronts[entry->front];
    const size_t count = rows_of(child);
    const size_t left = left_of(child);
    for (size_t i = left; i < count; i++) {
        const size_t row = place_of(plan, entry, i - left);
        if (front->node >= 0) {
            SpaceFeel moved = from->rows[i];
            if (child->is_body) {
                // from the reference of the child to that of what it hangs on
                const Vec3 lever = articulated->links[child->node].lever;
                moved.turning = vec3_add(moved.turning, vec3_cross(lever, moved.motion));
            }
            to->rows[row].motion = vec3_add(to->rows[row].motion, moved.motion);
            to->rows[row].turning = vec3_add(to->rows[row].turning, moved.turning);
        }
        for (size_t k = left; k < count; k++) {
            to->square[row * rows_of(front) + place_of(plan, entry, k - left)] +=
                from->square[i * count + k];
        }
    }
}

// Adds what a loop feels at one of its ends.
static void add_end(const SpaceArticulated *articulated, const PlanFront *front, const PlanEnd *end,
                    const SpaceTreeState *state, const SpaceLoopRow *rows, SpaceFront *to)
{
    const int joint = articulated->loops[end->loop];
    const double sign = end->side == 0 ? -1.0 : 1.0;
    const Vec3 lever =
        vec3_add(articulated->links[front->node].centre, state->arms[2 * joint + end->side]);
    for (size_t k = 0; k < ROWS; k++) {
        const SpaceLoopRow *row = &rows[ROWS * end->loop + (int)k];
        SpaceFeel *own = &to->rows[end->row + k];
        if (!row->is_held) {
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
static void take_from_link(const SpaceFeel *row, double inverse, SpaceLink *link)
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
static bool eliminate_row(size_t count, size_t pivot, bool is_held, SpaceFront *at, SpaceLink *link)
{
    const double *own = at->square + pivot * count;
    at->inverse[pivot] = 0.0;
    if (!is_held) {
        return true;
    }
    if (!(fabs(own[pivot]) > 0.0)) {
        return false;
    }
    const double inverse = 1.0 / own[pivot];
    at->inverse[pivot] = inverse;
    const SpaceFeel *row = &at->rows[pivot];
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
    const size_t count = rows_of(front);
    for (size_t k = 0; k < count; k++) {
        at->rows[k] = (SpaceFeel){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    }
    for (size_t k = 0; k < count * count; k++) {
        at->square[k] = 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        add_child(articulated, front, &plan->children[front->first_child + k], at);
    }
    for (size_t k = 0; k < front->end_count; k++) {
        add_end(articulated, front, &plan->ends[front->first_end + k], state, rows, at);
    }
}

bool space_fronts_gather(SpaceArticulated *articulated, int node, const SpaceTreeState *state,
                         const SpaceLoopRow *rows)
{
    const Plan *plan = &articulated->plan;
    SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = first_of(articulated, node); i < last_of(articulated, node); i++) {
        const PlanFront *front = &plan->fronts[i];
        gather_front(articulated, i, state, rows);
        for (size_t pivot = 0; pivot < left_of(front); pivot++) {
            const int loop = plan->loops[front->first_loop];
            const bool is_held = rows[ROWS * loop + (int)pivot].is_held;
            if (!eliminate_row(rows_of(front), pivot, is_held, &articulated->fronts[i], link)) {
                return false;
            }
        }
    }
    return true;
}

// Takes a freedom out of a row; what it had of it is given.
static void take_row(const SpaceLink *link, SpaceFeel *row, double *own)
{
    if (link->is_floating) {
        const double felt[SPACE_LINK_FREEDOMS] = {row->motion.x,  row->motion.y,  row->motion.z,
                                                  row->turning.x, row->turning.y, row->turning.z};
        for (int k = 0; k < SPACE_LINK_FREEDOMS; k++) {
            own[k] = felt[k];
        }
        space_link_forward(link, own);
        return;
    }
    own[0] = link->root * vec3_dot(link->axis, row->turning);
    row->motion = vec3_sub(row->motion, vec3_scale(own[0], link->force_share));
    row->turning = vec3_sub(row->turning, vec3_scale(own[0], link->moment_share));
}

void space_fronts_take_out(SpaceArticulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const SpaceLink *link = &articulated->links[node];
    const SpaceFront *at = &articulated->fronts[number];
    const size_t count = rows_of(&articulated->plan.fronts[number]);
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

static void gather_sides(SpaceArticulated *articulated, size_t i, SpaceLink *link,
                         const double *sides)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const SpaceFront *at = &articulated->fronts[i];
    const size_t count = rows_of(front);
    for (size_t k = 0; k < count; k++) {
        const bool is_own = k < left_of(front) && sides != NULL;
        at->vector[k] = is_own ? sides[ROWS * plan->loops[front->first_loop] + (int)k] : 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        const PlanChild *entry = &plan->children[front->first_child + k];
        const PlanFront *child = &plan->fronts[entry->front];
        const size_t left = left_of(child);
        for (size_t row = left; row < rows_of(child); row++) {
            at->vector[place_of(plan, entry, row - left)] +=
                articulated->fronts[entry->front].vector[row];
        }
    }
    for (size_t pivot = 0; pivot < left_of(front); pivot++) {
        const double solved = at->vector[pivot] * at->inverse[pivot];
        for (size_t k = pivot + 1; k < count && solved != 0.0; k++) {
            at->vector[k] -= at->square[pivot * count + k] * solved;
        }
        if (link != NULL) {
            const SpaceFeel *row = &at->rows[pivot];
            link->force = vec3_sub(link->force, vec3_scale(solved, row->motion));
            link->moment = vec3_sub(link->moment, vec3_scale(solved, row->turning));
        }
    }
}

void space_fronts_gather_sides(SpaceArticulated *articulated, int node, const double *sides)
{
    SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = first_of(articulated, node); i < last_of(articulated, node); i++) {
        gather_sides(articulated, i, link, sides);
    }
}

void space_fronts_gather_ground_sides(SpaceArticulated *articulated, const ArticulatedPart *part,
                                      const double *sides)
{
    if (part == NULL) {
        space_fronts_gather_sides(articulated, -1, sides);
        return;
    }
    for (size_t i = 0; i < part->front_count; i++) {
        gather_sides(articulated, part->fronts[i], NULL, sides);
    }
}

void space_fronts_take_out_sides(SpaceArticulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const SpaceLink *link = &articulated->links[node];
    const SpaceFront *at = &articulated->fronts[number];
    for (size_t i = 0; i < rows_of(&articulated->plan.fronts[number]); i++) {
        for (size_t m = 0; m < link->freedoms; m++) {
            at->vector[i] -= at->own[i * link->freedoms + m] * link->gained[m];
        }
    }
}

void space_fronts_add_multipliers(SpaceArticulated *articulated, int node,
                                  const double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const size_t number = (size_t)plan->front_of[node];
    const PlanFront *front = &plan->fronts[number];
    const SpaceFront *at = &articulated->fronts[number];
    SpaceLink *link = &articulated->links[node];
    for (size_t i = 0; i < rows_of(front); i++) {
        const int loop = plan->loops[front->first_loop + i / ROWS];
        const double multiplier = multipliers[ROWS * loop + (int)(i % ROWS)];
        for (size_t m = 0; m < link->freedoms; m++) {
            link->gained[m] -= at->own[i * link->freedoms + m] * multiplier;
        }
    }
}

static void find_multipliers(const SpaceArticulated *articulated, size_t i, const SpaceLink *link,
                             double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const SpaceFront *at = &articulated->fronts[i];
    const size_t count = rows_of(front);
    const int *loops = plan->loops + front->first_loop;
    for (size_t pivot = left_of(front); pivot-- > 0;) {
        double sum = at->vector[pivot];
        if (link != NULL) {
            sum -= vec3_dot(at->rows[pivot].motion, link->motion) +
                   vec3_dot(at->rows[pivot].turning, link->turning);
        }
        for (size_t k = pivot + 1; k < count; k++) {
            sum -= at->square[pivot * count + k] *
                   multipliers[ROWS * loops[k / ROWS] + (int)(k % ROWS)];
        }
        multipliers[ROWS * loops[0] + (int)pivot] = sum * at->inverse[pivot];
    }
}

void space_fronts_find_multipliers(SpaceArticulated *articulated, int node, double *multipliers)
{
    const SpaceLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = last_of(articulated, node); i-- > first_of(articulated, node);) {
        find_multipliers(articulated, i, link, multipliers);
    }
}

void space_fronts_find_ground_multipliers(SpaceArticulated *articulated,
                                          const ArticulatedPart *part, double *multipliers)
{
    if (part == NULL) {
        space_fronts_find_multipliers(articulated, -1, multipliers);
        return;
    }
    for (size_t i = part->front_count; i-- > 0;) {
        find_multipliers(articulated, part->fronts[i], NULL, multipliers);
    }
}
