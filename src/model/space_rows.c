// Which rows hold a joint in space, and which of them are independent?
#include "model/space_rows.h"

#include "base/zeroed.h"

#include <string.h>

// What is left of a row, of itself, once everything that others hold is taken out: rounding leaves
// 1e-15
static const double INDEPENDENT = 1e-9;

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

// The row over the columns of all bodies that can move, turns measured by a length.
static void spread(const Linkage *linkage, const SpaceRow *row, double length, double *columns)
{
    memset(columns, 0, SPACE_FREEDOMS * linkage->body_count * sizeof *columns);
    for (int side = 0; side < 2; side++) {
        const int body = row->body[side];
        if (body == LINKAGE_GROUND || body == linkage_driven_body(linkage)) {
            continue;
        }
        double *own = columns + SPACE_FREEDOMS * (size_t)body;
        const Vec3 linear = row->linear[side];
        const Vec3 angular = vec3_scale(1.0 / length, row->angular[side]);
        const double entries[SPACE_FREEDOMS] = {linear.x,  linear.y,  linear.z,
                                                angular.x, angular.y, angular.z};
        memcpy(own, entries, sizeof entries);
    }
}

static double product(size_t width, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < width; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Takes out of a row what the directions kept so far have of it, twice for rounding. Returns what
// is left of its length, as a share.
static double reduce(const double *kept, size_t count, size_t width, double *row)
{
    const double before = sqrt(product(width, row, row));
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < count; i++) {
            const double *direction = kept + i * width;
            const double share = product(width, direction, row);
            for (size_t k = 0; k < width && share != 0.0; k++) {
                row[k] -= share * direction[k];
            }
        }
    }
    return before > 0.0 ? sqrt(product(width, row, row)) / before : 0.0;
}

static double mean_reach(const Linkage *linkage)
{
    double sum = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        sum += linkage_reach(linkage, (int)i);
    }
    return sum / (double)linkage->body_count;
}

// Directions that the rows chosen so far hold, at right angles to each other.
typedef struct Basis {
    size_t width; // columns of all bodies
    double *kept;
    size_t count;
    double length; // m, by which turns are measured
} Basis;

static Basis open_basis(const Linkage *linkage)
{
    const size_t width = SPACE_FREEDOMS * linkage->body_count;
    return (Basis){
        .width = width,
        .kept = zeroed((width + 1) * width, sizeof(double)),
        .length = mean_reach(linkage),
    };
}

// What is left of a row, as a share of it, and where the next direction would stand.
static double share_left(const Linkage *linkage, Basis *basis, const SpaceRow *row)
{
    double *next = basis->kept + basis->count * basis->width;
    spread(linkage, row, basis->length, next);
    return reduce(basis->kept, basis->count, basis->width, next);
}

// Takes a row into the basis if it is independent. Returns whether it is.
static bool add_row(const Linkage *linkage, Basis *basis, const SpaceRow *row)
{
    if (basis->count == basis->width || !(share_left(linkage, basis, row) > INDEPENDENT)) {
        return false;
    }
    double *added = basis->kept + basis->count++ * basis->width;
    const double size = sqrt(product(basis->width, added, added));
    for (size_t k = 0; k < basis->width; k++) {
        added[k] /= size;
    }
    return true;
}

size_t space_rows_choose(const Linkage *linkage, const SpaceMotion *motions,
                         const bool is_asked[SPACE_JOINT_MAX], unsigned chosen[SPACE_JOINT_MAX])
{
    Basis basis = open_basis(linkage);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        SpaceRow rows[SPACE_JOINT_ROWS];
        chosen[joint] = 0;
        if (!is_asked[joint]) {
            continue;
        }
        space_rows_of_joint(linkage, motions, joint, rows);
        for (int i = 0; i < SPACE_JOINT_ROWS; i++) {
            chosen[joint] |= add_row(linkage, &basis, &rows[i]) ? 1U << i : 0;
        }
    }
    free(basis.kept);
    return basis.count;
}

size_t space_rows_choose_points(const Linkage *linkage, const SpaceMotion *motions,
                                const bool is_asked[SPACE_JOINT_MAX],
                                unsigned chosen[SPACE_JOINT_MAX])
{
    Basis basis = open_basis(linkage);
    SpaceRow rows[SPACE_JOINT_ROWS];
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        chosen[joint] = 0;
        if (is_asked[joint]) {
            space_rows_of_joint(linkage, motions, joint, rows);
            for (int i = 0; i < SPACE_POINT_ROWS; i++) {
                chosen[joint] |= add_row(linkage, &basis, &rows[i]) ? 1U << i : 0;
            }
        }
    }
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        if (!is_asked[joint]) {
            continue;
        }
        space_rows_of_joint(linkage, motions, joint, rows);
        // of two that hold the same, the one that holds more of it
        int order[2] = {SPACE_POINT_ROWS, SPACE_POINT_ROWS + 1};
        if (basis.count < basis.width && share_left(linkage, &basis, &rows[order[1]]) >
                                             share_left(linkage, &basis, &rows[order[0]])) {
            order[0] = SPACE_POINT_ROWS + 1;
            order[1] = SPACE_POINT_ROWS;
        }
        for (int i = 0; i < 2; i++) {
            chosen[joint] |= add_row(linkage, &basis, &rows[order[i]]) ? 1U << order[i] : 0;
        }
    }
    free(basis.kept);
    return basis.count;
}

size_t space_rows_mobility(const Linkage *linkage, const SpaceMotion *motions, bool ideal_only)
{
    Linkage undriven = *linkage;
    undriven.driver.is_present = false;
    bool is_asked[SPACE_JOINT_MAX];
    unsigned chosen[SPACE_JOINT_MAX];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_asked[i] = !ideal_only || linkage->joints[i].kind == JOINT_REVOLUTE;
    }
    return SPACE_FREEDOMS * linkage->body_count -
           space_rows_choose(&undriven, motions, is_asked, chosen);
}
