// Finds the change of a linkage's positions or speeds that its joints and its drive ask for.
//
//     min du' M du  with  J du = r    gives    du = M^-1 J' (J M^-1 J')^-1 r
// Columns are taken over the root of their mass and rows to length one, so that the products have
// ones on their diagonal. Redundant rows would leave nothing of it: a softness keeps them regular,
// and repeated solutions of what is still missing take its effect away.
#include "model/joint_system.h"

#include "base/zeroed.h"
#include "model/joint_rows.h"

#include <math.h>
#include <string.h>

static const double ROW_SOFTNESS = 1e-12; // on the diagonal of ones

// of a row squared: what is left of one beside the others
static const double ROW_INDEPENDENT = 1e-9;

enum { PASSES = 4 }; // each leaves some 1e-6 of what was missing, in a chain of a thousand bodies

// Takes the rows of a joint as the linkage has them.
static void find_entries(const Linkage *linkage, const Motion *motions, int joint,
                         JointBlock *block)
{
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    for (int i = 0; i < JOINT_ROWS; i++) {
        for (int side = 0; side < 2; side++) {
            block->entries[i][side][0] = rows.rows[i].x[side];
            block->entries[i][side][1] = rows.rows[i].y[side];
            block->entries[i][side][2] = rows.rows[i].turn[side];
        }
    }
}

// Measures the columns of a block in roots of masses and brings its rows to length one.
static void scale_block(const JointSystem *system, JointBlock *block)
{
    for (size_t i = 0; i < block->row_count; i++) {
        double square = 0.0;
        for (int k = 0; k < 6; k++) {
            const int body = block->bodies[k / 3];
            double *entry = &block->entries[i][k / 3][k % 3];
            *entry = body == LINKAGE_GROUND ? 0.0 : *entry / system->scales[3 * body + k % 3];
            square += *entry * *entry;
        }
        block->lengths[i] = sqrt(square);
        for (int k = 0; k < 6; k++) {
            block->entries[i][k / 3][k % 3] /= block->lengths[i];
        }
    }
}

static JointBlock *add_joint_block(JointSystem *system, size_t rows, int body_a, int body_b)
{
    JointBlock *block = &system->blocks[system->block_count++];
    block->first_row = system->row_count;
    block->row_count = rows;
    block->bodies[0] = body_a;
    block->bodies[1] = body_b;
    system->row_count += rows;
    return block;
}

static void add_blocks(const Motion *motions, const bool *include, bool with_driver,
                       JointSystem *system)
{
    const Linkage *linkage = system->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_rows_count(joint->kind) > 0 && (include == NULL || include[i])) {
            JointBlock *block = add_joint_block(system, JOINT_ROWS, joint->body_a, joint->body_b);
            find_entries(linkage, motions, (int)i, block);
            scale_block(system, block);
        }
    }
    for (size_t i = 0; with_driver && i < linkage_drive_count(linkage); i++) {
        JointBlock *block =
            add_joint_block(system, 1, LINKAGE_GROUND, linkage_drive_body(linkage, i));
        block->entries[0][1][2] = 1.0;
        scale_block(system, block);
    }
}

// Which blocks touch each body, one after the other: the first of a body, then the next of a side.
typedef struct Touching {
    size_t *first; // by body: one more than twice the block, plus the side; 0: none
    size_t *next;  // by twice the block, plus the side
} Touching;

static Touching find_touching(const JointSystem *system)
{
    Touching touching = {
        .first = zeroed(system->linkage->body_count, sizeof *touching.first),
        .next = zeroed(2 * system->block_count, sizeof *touching.next),
    };
    for (size_t i = 0; i < 2 * system->block_count; i++) {
        const int body = system->blocks[i / 2].bodies[i % 2];
        if (body != LINKAGE_GROUND) {
            touching.next[i] = touching.first[body];
            touching.first[body] = i + 1;
        }
    }
    return touching;
}

// Calls a function for each pair of different sides of blocks that meet at one body.
static void for_pairs(const JointSystem *system, const Touching *touching,
                      void (*take)(size_t a, size_t b, void *context), void *context)
{
    for (size_t body = 0; body < system->linkage->body_count; body++) {
        for (size_t a = touching->first[body]; a != 0; a = touching->next[a - 1]) {
            for (size_t b = touching->next[a - 1]; b != 0; b = touching->next[b - 1]) {
                take(a - 1, b - 1, context);
            }
        }
    }
}

typedef struct Links {
    size_t count;
    SparseLink *links; // NULL: they are counted
} Links;

static void take_link(size_t a, size_t b, void *context)
{
    Links *links = context;
    if (a / 2 != b / 2) {
        if (links->links != NULL) {
            links->links[links->count] = (SparseLink){a / 2, b / 2};
        }
        links->count++;
    }
}

// The product of a row's side with another's at the same body.
static double product(const JointBlock *a, size_t row, size_t side, const JointBlock *b,
                      size_t other_row, size_t other_side)
{
    const double *left = a->entries[row][side];
    const double *right = b->entries[other_row][other_side];
    return left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
}

static void take_product(size_t a, size_t b, void *context)
{
    const JointSystem *system = context;
    const JointBlock *one = &system->blocks[a / 2];
    const JointBlock *other = &system->blocks[b / 2];
    bool is_transposed = false;
    double *values =
        a / 2 != b / 2 ? sparse_block(&system->products, a / 2, b / 2, &is_transposed) : NULL;
    for (size_t i = 0; values != NULL && i < one->row_count; i++) {
        for (size_t k = 0; k < other->row_count; k++) {
            values[is_transposed ? k * one->row_count + i : i * other->row_count + k] +=
                product(one, i, a % 2, other, k, b % 2);
        }
    }
}

static void set_own_products(const JointSystem *system)
{
    for (size_t block = 0; block < system->block_count; block++) {
        const JointBlock *own = &system->blocks[block];
        bool is_transposed;
        double *values = sparse_block(&system->products, block, block, &is_transposed);
        for (size_t i = 0; i < own->row_count; i++) {
            for (size_t k = 0; k < own->row_count; k++) {
                values[i * own->row_count + k] = (i == k ? ROW_SOFTNESS : 0.0) +
                                                 product(own, i, 0, own, k, 0) +
                                                 product(own, i, 1, own, k, 1);
            }
        }
    }
}

void joint_system_init(const Linkage *linkage, const Motion *motions, const bool *include,
                       bool with_driver, JointSystem *system)
{
    *system = (JointSystem){
        .linkage = linkage,
        .blocks = zeroed(linkage->joint_count + LINKAGE_DRIVE_MAX, sizeof *system->blocks),
        .scales = zeroed(3 * linkage->body_count, sizeof *system->scales),
    };
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        system->scales[3 * i] = system->scales[3 * i + 1] = sqrt(body->mass);
        system->scales[3 * i + 2] = sqrt(body->inertia);
    }
    add_blocks(motions, include, with_driver, system);
    const Touching touching = find_touching(system);
    Links links = {.count = 0};
    for_pairs(system, &touching, take_link, &links);
    links.links = zeroed(links.count, sizeof *links.links);
    links.count = 0;
    for_pairs(system, &touching, take_link, &links);
    size_t *sizes = zeroed(system->block_count, sizeof *sizes);
    for (size_t i = 0; i < system->block_count; i++) {
        sizes[i] = system->blocks[i].row_count;
    }
    sparse_init(system->block_count, sizes, system->block_count, links.count, links.links,
                &system->products);
    sparse_clear(&system->products);
    set_own_products(system);
    for_pairs(system, &touching, take_product, system);
    const bool is_factored = sparse_factor(&system->products, 0.0);
    assert(is_factored); // the softness is far above rounding
    (void)is_factored;
    free(sizes);
    free(links.links);
    free(touching.first);
    free(touching.next);
}

void joint_system_finish(JointSystem *system)
{
    sparse_finish(&system->products);
    free(system->blocks);
    free(system->scales);
    *system = (JointSystem){.linkage = NULL};
}

size_t joint_system_rank(const JointSystem *system)
{
    size_t rank = 0;
    for (size_t i = 0; i < system->row_count; i++) {
        const double inverse = system->products.diagonals[i];
        rank += 1.0 / (inverse * inverse) > ROW_INDEPENDENT ? 1 : 0;
    }
    return rank;
}

// Adds what multipliers of the rows change, with columns times the root of their mass.
static void add_changes(const JointSystem *system, const double *pull, double *change)
{
    for (size_t block = 0; block < system->block_count; block++) {
        const JointBlock *own = &system->blocks[block];
        for (int k = 0; k < 6; k++) {
            const int body = own->bodies[k / 3];
            for (size_t i = 0; body != LINKAGE_GROUND && i < own->row_count; i++) {
                change[3 * body + k % 3] +=
                    own->entries[i][k / 3][k % 3] * pull[own->first_row + i];
            }
        }
    }
}

// What the rows still miss.
static void find_missing(const JointSystem *system, const double *wanted, const double *change,
                         double *missing)
{
    for (size_t block = 0; block < system->block_count; block++) {
        const JointBlock *own = &system->blocks[block];
        for (size_t i = 0; i < own->row_count; i++) {
            double sum = wanted[own->first_row + i] / own->lengths[i];
            for (int k = 0; k < 6; k++) {
                const int body = own->bodies[k / 3];
                sum -= body != LINKAGE_GROUND
                           ? own->entries[i][k / 3][k % 3] * change[3 * body + k % 3]
                           : 0.0;
            }
            missing[own->first_row + i] = sum;
        }
    }
}

void joint_system_least_change(const JointSystem *system, const double *wanted, double *change)
{
    const size_t columns = 3 * system->linkage->body_count;
    double *missing = zeroed(system->row_count, sizeof *missing);
    memset(change, 0, columns * sizeof *change);
    for (int pass = 0; pass < PASSES; pass++) {
        find_missing(system, wanted, change, missing);
        sparse_solve(&system->products, missing);
        add_changes(system, missing, change);
    }
    for (size_t c = 0; c < columns; c++) {
        change[c] /= system->scales[c];
    }
    free(missing);
}
