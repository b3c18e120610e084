// Makes the rows that hold a joint in space, and chooses those that are independent.
#include "model/space_rows.h"

#include "base/sparse_rank.h"
#include "base/zeroed.h"
#include "model/joint_nodes.h"

#include <string.h>

// What is left of a row, of itself, once everything that others hold is taken out: rounding leaves
// 1e-15
static const double SPACE_INDEPENDENT = 1e-9;

// Joints of a linkage of which those axes are chosen that are the most independent: each is looked
// at again for each that is taken.
enum { BEST_OF = 64 };

// of what is left of two rows: a difference that is none
static const double ROUNDING = 1e-6;

SpaceRow space_row_along(const SpaceMotion *motions, int body_a, Vec3 at_a, int body_b, Vec3 at_b,
                         Vec3 direction)
{
    SpaceRow row = {.body = {body_a, body_b}};
    const Vec3 points[2] = {at_a, at_b};
    for (int side = 0; side < 2; side++) {
        const int body = row.body[side];
        if (body != LINKAGE_GROUND) {
            const Vec3 arm = vec3_sub(points[side], motions[body].position);
            const double sign = side == 0 ? -1.0 : 1.0;
            row.linear[side] = vec3_scale(sign, direction);
            row.angular[side] = vec3_scale(sign, vec3_cross(arm, direction));
        }
    }
    return row;
}

// Two directions at right angles to the joint's axis on body a.
static void sides_of(const Linkage *linkage, const SpaceMotion *motions, size_t joint,
                     Vec3 sides[2])
{
    const SpaceEnd end = space_end(linkage, joint, 0);
    const Vec3 axis = space_direction(motions, end.body, end.axis);
    sides[0] = vec3_normal_to(axis);
    sides[1] = vec3_cross(axis, sides[0]);
}

void space_rows_of_joint(const Linkage *linkage, const SpaceMotion *motions, size_t joint,
                         SpaceRow rows[SPACE_JOINT_ROWS])
{
    static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const SpaceEnd a = space_end(linkage, joint, 0);
    const SpaceEnd b = space_end(linkage, joint, 1);
    const Vec3 at_a = space_point(motions, a.body, a.anchor);
    const Vec3 at_b = space_point(motions, b.body, b.anchor);
    for (int i = 0; i < SPACE_POINT_ROWS; i++) {
        rows[i] = space_row_along(motions, a.body, at_a, b.body, at_b, AXES[i]);
    }
    Vec3 sides[2];
    sides_of(linkage, motions, joint, sides);
    for (int i = 0; i < 2; i++) {
        SpaceRow *row = &rows[SPACE_POINT_ROWS + i];
        *row = (SpaceRow){.body = {a.body, b.body}};
        row->angular[0] = vec3_scale(a.body == LINKAGE_GROUND ? 0.0 : -1.0, sides[i]);
        row->angular[1] = vec3_scale(b.body == LINKAGE_GROUND ? 0.0 : 1.0, sides[i]);
    }
}

void space_rows_opening(const Linkage *linkage, const SpaceMotion *motions, size_t joint,
                        double openings[SPACE_JOINT_ROWS])
{
    const SpaceEnd a = space_end(linkage, joint, 0);
    const SpaceEnd b = space_end(linkage, joint, 1);
    const Vec3 gap =
        vec3_sub(space_point(motions, b.body, b.anchor), space_point(motions, a.body, a.anchor));
    // the turn that takes the axis of a to that of b, as long as it is small
    const Vec3 turn = vec3_cross(space_direction(motions, a.body, a.axis),
                                 space_direction(motions, b.body, b.axis));
    Vec3 sides[2];
    sides_of(linkage, motions, joint, sides);
    openings[0] = gap.x;
    openings[1] = gap.y;
    openings[2] = gap.z;
    openings[3] = vec3_dot(turn, sides[0]);
    openings[4] = vec3_dot(turn, sides[1]);
}

double space_row_speed(const SpaceRow *row, const SpaceMotion *motions)
{
    double sum = 0.0;
    for (int side = 0; side < 2; side++) {
        if (row->body[side] != LINKAGE_GROUND) {
            const SpaceMotion *motion = &motions[row->body[side]];
            sum += vec3_dot(row->linear[side], motion->velocity) +
                   vec3_dot(row->angular[side], motion->omega);
        }
    }
    return sum;
}

static double mean_reach(const Linkage *linkage)
{
    double *reaches = zeroed(linkage->body_count, sizeof *reaches);
    double sum = 0.0;
    linkage_reaches(linkage, reaches);
    for (size_t i = 0; i < linkage->body_count; i++) {
        sum += reaches[i];
    }
    free(reaches);
    return sum / (double)linkage->body_count;
}

// What the rows chosen so far hold of the freedoms of the bodies, which are the nodes.
typedef struct Basis {
    const Linkage *linkage;
    int driven;
    double length; // m, by which turns are measured
    Sparse sparse;
    double *columns; // room: a row over the freedoms of all bodies
    size_t count;
} Basis;

static Basis open_basis(const Linkage *linkage, const bool *is_asked)
{
    const size_t bodies = linkage->body_count;
    Basis basis = {
        .linkage = linkage,
        .driven = linkage_driven_body(linkage),
        .length = mean_reach(linkage),
        .columns = zeroed(SPACE_FREEDOMS * bodies, sizeof *basis.columns),
    };
    size_t *sizes = zeroed(bodies, sizeof *sizes);
    SparseLink *links = zeroed(linkage->joint_count, sizeof *links);
    size_t link_count = 0;
    for (size_t i = 0; i < bodies; i++) {
        sizes[i] = SPACE_FREEDOMS;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const int a = joint_nodes_mover(linkage, (int)i, 0);
        const int b = joint_nodes_mover(linkage, (int)i, 1);
        if (is_asked[i] && a != LINKAGE_GROUND && b != LINKAGE_GROUND) {
            links[link_count++] = (SparseLink){(size_t)a, (size_t)b};
        }
    }
    sparse_init(bodies, sizes, bodies, link_count, links, &basis.sparse);
    sparse_clear(&basis.sparse);
    free(links);
    free(sizes);
    return basis;
}

static size_t close_basis(Basis *basis)
{
    sparse_finish(&basis->sparse);
    free(basis->columns);
    return basis->count;
}

// Writes a row over the columns of the bodies that can move, turns measured by a length. Returns
// its size, and the first of the bodies in the order of elimination.
static double spread(Basis *basis, const SpaceRow *row, size_t *first)
{
    double sum = 0.0;
    *first = basis->sparse.count;
    for (int side = 0; side < 2; side++) {
        const int body = row->body[side];
        if (body == LINKAGE_GROUND || body == basis->driven) {
            continue;
        }
        const size_t order = basis->sparse.order[body];
        const Vec3 linear = row->linear[side];
        const Vec3 angular = vec3_scale(1.0 / basis->length, row->angular[side]);
        const double entries[SPACE_FREEDOMS] = {linear.x,  linear.y,  linear.z,
                                                angular.x, angular.y, angular.z};
        memcpy(basis->columns + SPACE_FREEDOMS * (size_t)body, entries, sizeof entries);
        sum += vec3_dot(linear, linear) + vec3_dot(angular, angular);
        *first = order < *first ? order : *first;
    }
    return sqrt(sum);
}

// What is left of a row, as a share of it.
static double share_left(Basis *basis, const SpaceRow *row)
{
    size_t first;
    const double size = spread(basis, row, &first);
    return size > 0.0 ? sparse_rank_left(&basis->sparse, first, size, basis->columns) : 0.0;
}

// Takes a row into the basis if it is independent. Returns whether it is.
static bool add_row(Basis *basis, const SpaceRow *row)
{
    size_t first;
    const double size = spread(basis, row, &first);
    const bool is_taken = size > 0.0 && sparse_rank_take(&basis->sparse, first, size,
                                                         SPACE_INDEPENDENT, basis->columns);
    basis->count += is_taken ? 1 : 0;
    return is_taken;
}

size_t space_rows_choose(const Linkage *linkage, const SpaceMotion *motions, const bool *is_asked,
                         unsigned *chosen)
{
    Basis basis = open_basis(linkage, is_asked);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        SpaceRow rows[SPACE_JOINT_ROWS];
        chosen[joint] = 0;
        if (!is_asked[joint]) {
            continue;
        }
        space_rows_of_joint(linkage, motions, joint, rows);
        for (int i = 0; i < SPACE_JOINT_ROWS; i++) {
            chosen[joint] |= add_row(&basis, &rows[i]) ? 1U << i : 0;
        }
    }
    return close_basis(&basis);
}

// Takes the points of all joints into the basis.
static void add_points(Basis *basis, const SpaceMotion *motions, const bool *is_asked,
                       unsigned *chosen)
{
    SpaceRow rows[SPACE_JOINT_ROWS];
    for (size_t joint = 0; joint < basis->linkage->joint_count; joint++) {
        chosen[joint] = 0;
        if (is_asked[joint]) {
            space_rows_of_joint(basis->linkage, motions, joint, rows);
            for (int i = 0; i < SPACE_POINT_ROWS; i++) {
                chosen[joint] |= add_row(basis, &rows[i]) ? 1U << i : 0;
            }
        }
    }
}

// Takes the axes of all joints into the basis, joint by joint. Returns whether each was.
static bool add_axes(Basis *basis, const SpaceMotion *motions, const bool *is_asked,
                     unsigned *chosen)
{
    SpaceRow rows[SPACE_JOINT_ROWS];
    bool are_all = true;
    for (size_t joint = 0; joint < basis->linkage->joint_count; joint++) {
        if (!is_asked[joint]) {
            continue;
        }
        space_rows_of_joint(basis->linkage, motions, joint, rows);
        // of two that hold the same, the one that holds more of it
        int order[2] = {SPACE_POINT_ROWS, SPACE_POINT_ROWS + 1};
        if (share_left(basis, &rows[order[1]]) >
            (1.0 + ROUNDING) * share_left(basis, &rows[order[0]])) {
            order[0] = SPACE_POINT_ROWS + 1;
            order[1] = SPACE_POINT_ROWS;
        }
        for (int i = 0; i < 2; i++) {
            const bool is_taken = add_row(basis, &rows[order[i]]);
            chosen[joint] |= is_taken ? 1U << order[i] : 0;
            are_all = are_all && is_taken;
        }
    }
    return are_all;
}

// Takes in of all axes again and again the one of which most is left.
static void add_best_axes(Basis *basis, const SpaceMotion *motions, const bool *is_asked,
                          unsigned *chosen)
{
    SpaceRow rows[SPACE_JOINT_ROWS];
    double best;
    do {
        best = SPACE_INDEPENDENT;
        size_t best_joint = 0;
        int best_part = 0;
        for (size_t joint = 0; joint < basis->linkage->joint_count; joint++) {
            for (int i = SPACE_POINT_ROWS; is_asked[joint] && i < SPACE_JOINT_ROWS; i++) {
                if ((chosen[joint] >> i & 1U) != 0) {
                    continue;
                }
                space_rows_of_joint(basis->linkage, motions, joint, rows);
                const double share = share_left(basis, &rows[i]);
                if (share > (1.0 + ROUNDING) * best) {
                    best = share;
                    best_joint = joint;
                    best_part = i;
                }
            }
        }
        if (best > SPACE_INDEPENDENT) {
            space_rows_of_joint(basis->linkage, motions, best_joint, rows);
            add_row(basis, &rows[best_part]);
            chosen[best_joint] |= 1U << best_part;
        }
    } while (best > SPACE_INDEPENDENT);
}

size_t space_rows_choose_points(const Linkage *linkage, const SpaceMotion *motions,
                                const bool *is_asked, unsigned *chosen)
{
    Basis basis = open_basis(linkage, is_asked);
    add_points(&basis, motions, is_asked, chosen);
    if (add_axes(&basis, motions, is_asked, chosen) || linkage->joint_count > BEST_OF) {
        return close_basis(&basis);
    }
    close_basis(&basis);
    basis = open_basis(linkage, is_asked);
    add_points(&basis, motions, is_asked, chosen);
    add_best_axes(&basis, motions, is_asked, chosen);
    return close_basis(&basis);
}

double space_rows_least_share(const Linkage *linkage, const SpaceMotion *motions,
                              const bool *is_asked, const unsigned *chosen)
{
    Basis basis = open_basis(linkage, is_asked);
    SpaceRow rows[SPACE_JOINT_ROWS];
    unsigned *points = zeroed(linkage->joint_count, sizeof *points);
    double least = 1.0;
    add_points(&basis, motions, is_asked, points);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (int i = SPACE_POINT_ROWS; i < SPACE_JOINT_ROWS; i++) {
            if ((chosen[joint] >> i & 1U) != 0) {
                space_rows_of_joint(linkage, motions, joint, rows);
                least = fmin(least, share_left(&basis, &rows[i]));
                add_row(&basis, &rows[i]);
            }
        }
    }
    free(points);
    close_basis(&basis);
    return least;
}

size_t space_rows_mobility(const Linkage *linkage, const SpaceMotion *motions, bool ideal_only)
{
    Linkage undriven = *linkage;
    undriven.driver.is_present = false;
    bool *is_asked = zeroed(linkage->joint_count, sizeof *is_asked);
    unsigned *chosen = zeroed(linkage->joint_count, sizeof *chosen);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_asked[i] = !ideal_only || joint_is_ideal(linkage->joints[i].kind);
    }
    const size_t rows = space_rows_choose(&undriven, motions, is_asked, chosen);
    free(chosen);
    free(is_asked);
    return SPACE_FREEDOMS * linkage->body_count - rows;
}
