// Do rows of the ideal joints follow from one another?
//
// Jacobian rows of a ball between bodies a and b, arm r from each centre to the anchor:
//     x: v_x - w_z r_y,   y: v_y + w_z r_x,   z: v_z + w_x r_y - w_y r_x      (b minus a)
// A prismatic joint has two (model/joint_rows.h). Each freedom of each body that can give way is an
// equation of the rows' forces; the rows are independent where no force is left open.
#include "ode/world_rows.h"

#include "base/sparse_rank.h"
#include "base/zeroed.h"
#include "model/joint_nodes.h"
#include "model/joint_rows.h"

enum { BALL_ROWS = 3, BODY_FREEDOMS = 6 };

// rows that differ by less than this share are one row twice: rounding leaves 1e-15
static const double WORLD_INDEPENDENT = 1e-9;

// What the freedoms of one body are in the rows of an ideal joint.
static void fill_freedoms(const Linkage *linkage, const Motion *motions, int joint, int side,
                          double freedoms[BODY_FREEDOMS][BALL_ROWS])
{
    const Joint *of = &linkage->joints[joint];
    const JointEnd end = linkage_end(of, side);
    for (size_t i = 0; i < BODY_FREEDOMS * BALL_ROWS; i++) {
        freedoms[i / BALL_ROWS][i % BALL_ROWS] = 0.0;
    }
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    for (size_t k = 0; k < JOINT_ROWS; k++) {
        freedoms[0][k] = rows.rows[k].x[side];
        freedoms[1][k] = rows.rows[k].y[side];
        freedoms[5][k] = rows.rows[k].turn[side];
    }
    if (of->kind != JOINT_PRISMATIC) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = vec2_rotate(motions[end.body].angle, end.anchor);
        freedoms[2][2] = sign;
        freedoms[3][2] = sign * arm.y;
        freedoms[4][2] = -sign * arm.x;
    }
}

// The rows of a linkage, as nodes of a sparse matrix.
typedef struct Rows {
    const Linkage *linkage;
    const Motion *motions;
    int *joints;        // of a node
    size_t *first_node; // by body, of `nodes`
    size_t *nodes;
    Sparse sparse;
    double *squares; // by row
    double *equation;
} Rows;

static void start_rows(const Linkage *linkage, const Motion *motions, Rows *rows)
{
    size_t count = 0;
    size_t *sizes = zeroed(linkage->joint_count, sizeof *sizes);
    *rows = (Rows){.linkage = linkage, .motions = motions};
    rows->joints = zeroed(linkage->joint_count, sizeof *rows->joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_is_ideal(linkage, i)) {
            const bool slides = linkage->joints[i].kind == JOINT_PRISMATIC;
            sizes[count] = slides ? (size_t)JOINT_ROWS : (size_t)BALL_ROWS;
            rows->joints[count++] = (int)i;
        }
    }
    rows->first_node = zeroed(linkage->body_count + 1, sizeof *rows->first_node);
    rows->nodes = zeroed(2 * count, sizeof *rows->nodes);
    joint_nodes_list(linkage, rows->joints, count, rows->first_node, rows->nodes);
    SparseLink *links;
    const size_t link_count = joint_nodes_link(linkage, rows->joints, count, &links);
    sparse_init(count, sizes, count, link_count, links, &rows->sparse);
    rows->squares = zeroed(rows->sparse.row_count, sizeof *rows->squares);
    rows->equation = zeroed(rows->sparse.row_count, sizeof *rows->equation);
    free(links);
    free(sizes);
}

static void finish_rows(Rows *rows)
{
    free(rows->joints);
    free(rows->first_node);
    free(rows->nodes);
    free(rows->squares);
    free(rows->equation);
    sparse_finish(&rows->sparse);
}

// Takes in the equation of one freedom of a body.
static void add_freedom(Rows *rows, size_t body, size_t freedom)
{
    size_t first = rows->sparse.count;
    for (size_t n = rows->first_node[body]; n < rows->first_node[body + 1]; n++) {
        const size_t node = rows->nodes[n];
        const int joint = rows->joints[node];
        const int side = linkage_end(&rows->linkage->joints[joint], 0).body == (int)body ? 0 : 1;
        const size_t row = rows->sparse.first_row[node];
        double freedoms[BODY_FREEDOMS][BALL_ROWS];
        fill_freedoms(rows->linkage, rows->motions, joint, side, freedoms);
        for (size_t k = 0; k < rows->sparse.first_row[node + 1] - row; k++) {
            const double entry = freedoms[freedom][k];
            rows->equation[row + k] = entry;
            rows->squares[row + k] += entry * entry;
        }
        first = rows->sparse.order[node] < first ? rows->sparse.order[node] : first;
    }
    if (first < rows->sparse.count) {
        sparse_rank_add(&rows->sparse, first, rows->equation);
    }
}

bool world_rows_check(const Scenario *scenario, const Motion *motions, size_t *row_count, Err *err)
{
    Rows rows;
    start_rows(&scenario->linkage, motions, &rows);
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        for (size_t k = 0; k < BODY_FREEDOMS; k++) {
            add_freedom(&rows, i, k);
        }
    }
    const size_t count = rows.sparse.row_count;
    const size_t rank =
        sparse_rank_find(&rows.sparse, rows.squares, WORLD_INDEPENDENT, rows.equation);
    finish_rows(&rows);
    if (rank != count) {
        return err_set(err, ERR_SOLVER,
                       "%zu of the %zu rows of the ideal joints follow from the others; ODE "
                       "cannot solve redundant rows: give one joint of the loop some play",
                       count - rank, count);
    }
    *row_count = count;
    return true;
}
