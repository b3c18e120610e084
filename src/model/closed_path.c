// Moves a linkage with ideal joints along the positions that it can take.
//
//     Phi(q) = 0 for every joint, q = (x / L, y / L, phi) per body, L the size of the linkage;
//     rows that are lengths are divided by L, those that are angles are not
//     tangent:   J t = 0, |t| = 1                  J = dPhi/dq / L
//     step:      q' = q + s t, then Newton's method on Phi(q') = 0, t . (q' - q) = s
// Both by least squares, (J^T J + t t^T) x = J^T r + c t, so that redundant joints do no harm.
// Where paths cross J^T J + t t^T is singular. The root of its smallest eigenvalue falls there like
// the distance to the crossing: it says how long a step may be that stays on its own path. Source:
// E. L. Allgower, K. Georg, Introduction to Numerical Continuation Methods, SIAM 2003.
#include "model/closed_path.h"

#include "base/dense.h"
#include "model/joint_rows.h"

#include <string.h>

enum { CORRECTION_MAX = 8 }; // Newton doubles the digits: from 1e-3 to rounding takes 3

static const double ROUNDED = 1e-13; // of L: what is left of a joint's opening; rounding is 1e-16
static const double BENT = 0.98;     // least cosine of the angle between two tangents

// steps: of arc length, where an angle of 1 rad has about length 1
static const double STEP_LONGEST = 0.05;
static const double STEP_SHARE = 0.1; // of the distance to the next crossing
// lengths that differ by 1e-8 of themselves keep two paths so far apart; nearer ones are one
static const double STEP_SHORTEST = 1e-4;

static size_t crank_column(const Linkage *linkage)
{
    return 3 * (size_t)linkage_driven_body(linkage) + 2;
}

// The longest distance between two joints of one body.
static double find_size(const Linkage *linkage)
{
    double size = 0.0;
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd end = linkage_end(&linkage->joints[i / 2], i % 2);
        for (size_t k = 0; end.body != LINKAGE_GROUND && k < i; k++) {
            const JointEnd other = linkage_end(&linkage->joints[k / 2], k % 2);
            if (other.body == end.body) {
                size = fmax(size, vec2_length(vec2_sub(other.anchor, end.anchor)));
            }
        }
    }
    return size;
}

// The joints' rows at a position, and what each joint misses; returns the largest of it, in L.
static double evaluate(const ClosedPath *path, const double *at, Jacobian *jacobian,
                       double missing[KINEMATICS_ROW_MAX])
{
    const Linkage *linkage = path->linkage;
    Motion motions[KINEMATICS_BODY_MAX] = {0};
    double largest = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].position = (Vec2){path->size * at[3 * i], path->size * at[3 * i + 1]};
        motions[i].angle = at[3 * i + 2];
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Vec2 opening = kinematics_opening(linkage, motions, (int)i);
        const bool is_angle = joint_rows_is_angle(linkage->joints[i].kind, 1);
        missing[2 * i] = -opening.x / path->size;
        missing[2 * i + 1] = is_angle ? -opening.y : -opening.y / path->size;
        largest = fmax(largest, is_angle ? hypot(missing[2 * i], missing[2 * i + 1])
                                         : vec2_length(opening) / path->size);
    }
    kinematics_jacobian(linkage, motions, NULL, false, jacobian);
    for (size_t row = 0; row < jacobian->rows; row++) {
        const JointKind kind = linkage->joints[row / 2].kind;
        for (size_t column = 2; column < jacobian->columns && !joint_rows_is_angle(kind, row % 2);
             column += 3) {
            jacobian->entries[row * jacobian->columns + column] /= path->size;
        }
    }
    return largest;
}

// Solves (J^T J + t t^T) x = J^T r + c t; without r its first term is zero.
static bool solve(const Jacobian *jacobian, const double *tangent, const double *missing,
                  const double *right, double *x)
{
    double matrix[KINEMATICS_COLUMN_MAX * KINEMATICS_COLUMN_MAX];
    const size_t n = jacobian->columns;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k <= i; k++) {
            double sum = tangent[i] * tangent[k];
            for (size_t row = 0; row < jacobian->rows; row++) {
                sum += jacobian->entries[row * n + i] * jacobian->entries[row * n + k];
            }
            matrix[i * n + k] = matrix[k * n + i] = sum;
        }
        x[i] = right[i];
        for (size_t row = 0; missing != NULL && row < jacobian->rows; row++) {
            x[i] += jacobian->entries[row * n + i] * missing[row];
        }
    }
    return dense_solve(n, matrix, x);
}

static double length_of(const double *x, size_t n)
{
    double square = 0.0;
    for (size_t i = 0; i < n; i++) {
        square += x[i] * x[i];
    }
    return sqrt(square);
}

// The tangent at the path's position that is nearest to a direction, and how firm the joints are.
static bool find_tangent(ClosedPath *path, const double *direction)
{
    const size_t n = path->columns;
    Jacobian jacobian;
    double missing[KINEMATICS_ROW_MAX];
    double x[KINEMATICS_COLUMN_MAX];
    evaluate(path, path->at, &jacobian, missing);
    if (!solve(&jacobian, direction, NULL, direction, x)) {
        return false;
    }
    double size = length_of(x, n);
    for (size_t i = 0; i < n; i++) {
        path->tangent[i] = x[i] / size;
    }
    // one step of inverse iteration: from position to position it converges
    if (!solve(&jacobian, path->tangent, NULL, path->weakest, x)) {
        return false;
    }
    size = length_of(x, n);
    path->firmness = 1.0 / sqrt(size);
    path->firmness_most = fmax(path->firmness_most, path->firmness);
    for (size_t i = 0; i < n; i++) {
        path->weakest[i] = x[i] / size;
    }
    return isfinite(size);
}

// Closes the joints by changes across a direction.
static bool correct(ClosedPath *path, const double *direction)
{
    static const double NONE[KINEMATICS_COLUMN_MAX] = {0.0};
    for (int i = 0; i < CORRECTION_MAX; i++) {
        Jacobian jacobian;
        double missing[KINEMATICS_ROW_MAX];
        double x[KINEMATICS_COLUMN_MAX];
        if (evaluate(path, path->at, &jacobian, missing) <= ROUNDED) {
            return true;
        }
        if (!solve(&jacobian, direction, missing, NONE, x)) {
            return false;
        }
        for (size_t k = 0; k < path->columns; k++) {
            path->at[k] += x[k];
        }
    }
    return false;
}

bool closed_path_start(const Linkage *linkage, const Motion *motions, ClosedPath *path)
{
    *path = (ClosedPath){
        .linkage = linkage, .size = find_size(linkage), .columns = 3 * linkage->body_count};
    if (!(path->size > 0.0)) {
        return false;
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        path->at[3 * i] = motions[i].position.x / path->size;
        path->at[3 * i + 1] = motions[i].position.y / path->size;
        path->at[3 * i + 2] = motions[i].angle;
    }
    for (size_t i = 0; i < path->columns; i++) {
        path->weakest[i] = (i % 2 == 0 ? 1.0 : -0.5) / sqrt((double)path->columns);
    }
    double direction[KINEMATICS_COLUMN_MAX] = {0.0};
    direction[crank_column(linkage)] = linkage->driver.speed < 0.0 ? -1.0 : 1.0;
    // twice, so that the inverse iteration is under way
    return correct(path, direction) && find_tangent(path, direction) &&
           find_tangent(path, path->tangent);
}

bool closed_path_step(const ClosedPath *path, double length, ClosedPath *next)
{
    *next = *path;
    for (size_t i = 0; i < path->columns; i++) {
        next->at[i] += length * path->tangent[i];
    }
    if (!correct(next, path->tangent) || !find_tangent(next, path->tangent)) {
        return false;
    }
    double cosine = 0.0;
    for (size_t i = 0; i < path->columns; i++) {
        cosine += path->tangent[i] * next->tangent[i];
    }
    return cosine >= BENT;
}

double closed_path_reach(const ClosedPath *path)
{
    const double distance = path->firmness / path->firmness_most;
    return fmax(STEP_SHORTEST, fmin(STEP_LONGEST, STEP_SHARE * distance));
}

double closed_path_crank(const ClosedPath *path)
{
    return path->at[crank_column(path->linkage)];
}

double closed_path_crank_rate(const ClosedPath *path)
{
    const double rate = path->tangent[crank_column(path->linkage)];
    return path->linkage->driver.speed < 0.0 ? -rate : rate;
}

double closed_path_determinant(const ClosedPath *path, const Group *group)
{
    const size_t n = 3 * group->body_count;
    double matrix[KINEMATICS_COLUMN_MAX * KINEMATICS_COLUMN_MAX];
    double missing[KINEMATICS_ROW_MAX];
    size_t pivots[KINEMATICS_COLUMN_MAX];
    Jacobian jacobian;
    evaluate(path, path->at, &jacobian, missing);
    for (size_t row = 0; row < n; row++) {
        const size_t from = 2 * (size_t)group->joints[row / 2] + row % 2;
        for (size_t column = 0; column < n; column++) {
            const size_t at = 3 * (size_t)group->bodies[column / 3] + column % 3;
            matrix[row * n + column] = jacobian.entries[from * jacobian.columns + at];
        }
    }
    if (!dense_factor(n, matrix, pivots)) {
        return 0.0;
    }
    double product = 1.0;
    for (size_t k = 0; k < n; k++) {
        product *= pivots[k] == k ? matrix[k * n + k] : -matrix[k * n + k];
    }
    return product;
}
