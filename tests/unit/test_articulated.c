// Do bodies that are eliminated one after the other move as the whole matrix of their equations
// says?
#include "close.h"

#include "base/dense.h"
#include "base/lcg.h"
#include "reference/articulated_plan.h"
#include "reference/plane/articulated.h"
#include "reference/plane/tree.h"
#include "reference/span.h"

#include <stdlib.h>
#include <string.h>

enum { BODIES = 12, JOINTS = 20, EQUATIONS = 3 * BODIES + 2 * JOINTS };

// A linkage in the making. Bodies lie at random, and joints where they are put.
typedef struct Made {
    Linkage *linkage;
    uint64_t seed;
} Made;

static Made start(void)
{
    Made made = {test_calloc(1, sizeof(Linkage)), 1};
    *made.linkage = linkage_create((LinkageRoom){.bodies = BODIES, .joints = JOINTS});
    return made;
}

static int add_body(Made *made)
{
    Linkage *linkage = made->linkage;
    Body *body = &linkage->bodies[linkage->body_count++];
    body->mass = 2.0 + lcg_draw(&made->seed);
    body->inertia = 0.2 + 0.1 * lcg_draw(&made->seed);
    body->start.position = (Vec2){lcg_draw(&made->seed), lcg_draw(&made->seed)};
    body->start.angle = lcg_draw(&made->seed);
    return (int)linkage->body_count - 1;
}

// The anchor of a body at a point of the world.
static Vec2 anchor_of(const Linkage *linkage, int body, Vec2 point)
{
    if (body == LINKAGE_GROUND) {
        return point;
    }
    const Motion *start = &linkage->bodies[body].start;
    return vec2_rotate(-start->angle, vec2_sub(point, start->position));
}

static void join(Made *made, JointKind kind, int body_a, int body_b)
{
    Linkage *linkage = made->linkage;
    const Vec2 point = {lcg_draw(&made->seed), lcg_draw(&made->seed)};
    const double angle_a = body_a == LINKAGE_GROUND ? 0.0 : linkage->bodies[body_a].start.angle;
    const double angle_b = body_b == LINKAGE_GROUND ? 0.0 : linkage->bodies[body_b].start.angle;
    linkage->joints[linkage->joint_count++] = (Joint){
        .kind = kind,
        .body_a = body_a,
        .body_b = body_b,
        .anchor_a = anchor_of(linkage, body_a, point),
        .anchor_b = anchor_of(linkage, body_b, point),
        .direction = 3.0 * lcg_draw(&made->seed),
        .held_angle = angle_b - angle_a,
    };
}

// A chain of N bodies that hangs on the ground, or on nothing.
static Made chain(int count, bool is_hung)
{
    Made made = start();
    for (int i = 0; i < count; i++) {
        add_body(&made);
        if (i > 0 || is_hung) {
            join(&made, JOINT_REVOLUTE, i - 1, i);
        }
    }
    return made;
}

// Crossed bars, pinned in their middles, each pair to the next at both its ends.
static Made scissor(int pairs)
{
    Made made = start();
    for (int i = 0; i < pairs; i++) {
        const int left = add_body(&made);
        const int right = add_body(&made);
        join(&made, JOINT_REVOLUTE, left, right);
        if (i > 0) {
            join(&made, JOINT_REVOLUTE, left - 2, right);
            join(&made, JOINT_REVOLUTE, right - 2, left);
        }
    }
    return made;
}

// Four-bars in a row on the ground, which share their uprights; or on a body that floats.
static Made row(int count, bool is_floating)
{
    Made made = start();
    const int ground = is_floating ? add_body(&made) : LINKAGE_GROUND;
    int before = add_body(&made);
    join(&made, JOINT_REVOLUTE, ground, before);
    for (int i = 0; i < count; i++) {
        const int coupler = add_body(&made);
        const int upright = add_body(&made);
        join(&made, JOINT_REVOLUTE, ground, upright);
        join(&made, JOINT_REVOLUTE, before, coupler);
        join(&made, JOINT_REVOLUTE, coupler, upright);
        before = upright;
    }
    return made;
}

// Slides on the ground, on one another and on what turns, and a loop that one closes.
static Made slides(void)
{
    Made made = start();
    for (int i = 0; i < 7; i++) {
        add_body(&made);
    }
    join(&made, JOINT_PRISMATIC, LINKAGE_GROUND, 0);
    join(&made, JOINT_PRISMATIC, 0, 1);
    join(&made, JOINT_REVOLUTE, 1, 2);
    join(&made, JOINT_PRISMATIC, 2, 3);
    join(&made, JOINT_REVOLUTE, 3, 4);
    join(&made, JOINT_REVOLUTE, 4, 5);
    join(&made, JOINT_PRISMATIC, 5, 6);
    join(&made, JOINT_PRISMATIC, 1, 6);
    return made;
}

typedef struct Solved {
    Tree tree;
    TreeState *state;
    double *memory;
    double rates[EQUATIONS];
    double whole[EQUATIONS];
} Solved;

// The row of a joint's two numbers by each coordinate, in the whole matrix.
static void put_loop(const Solved *solved, size_t loop, size_t width, double *matrix)
{
    const Tree *tree = &solved->tree;
    const size_t n = tree->coordinate_count;
    const int joint = tree->loops[loop];
    Vec2 by[EQUATIONS];
    memset(by, 0, sizeof by);
    loops_pair_row(tree, solved->state, joint, by);
    for (size_t k = 0; k < n; k++) {
        if (tree->measures[joint] == TREE_LINE) {
            const Vec2 normal = tree_normal(tree, solved->state, joint);
            by[k] = (Vec2){vec2_dot(normal, by[k]), 0.0};
            const Joint *of = &tree->linkage->joints[joint];
            by[k].y += of->body_b >= 0 && tree->angle_column[of->body_b] == (int)k ? 1.0 : 0.0;
            by[k].y -= of->body_a >= 0 && tree->angle_column[of->body_a] == (int)k ? 1.0 : 0.0;
        }
        const size_t x = n + 2 * loop;
        matrix[x * width + k] = matrix[k * width + x] = by[k].x;
        matrix[(x + 1) * width + k] = matrix[k * width + x + 1] = by[k].y;
    }
}

// Solves with the whole matrix: M = sum over bodies of m B^T B + I.
static void solve_whole(Solved *solved, const ArticulatedPush *pushes, const double *sides)
{
    const Tree *tree = &solved->tree;
    const size_t n = tree->coordinate_count;
    const size_t width = n + 2 * tree->loop_count;
    double *matrix = test_calloc(width * width, sizeof *matrix);
    memset(solved->whole, 0, sizeof solved->whole);
    for (int body = 0; body < (int)tree->linkage->body_count; body++) {
        const Body *of = &tree->linkage->bodies[body];
        Vec2 by[EQUATIONS];
        memset(by, 0, sizeof by);
        tree_point_row(tree, solved->state, body, (Vec2){0.0, 0.0}, 1.0, by);
        for (size_t i = 0; i < n; i++) {
            solved->whole[i] += vec2_dot(by[i], pushes[body].force);
            for (size_t k = 0; k < n; k++) {
                matrix[i * width + k] += of->mass * vec2_dot(by[i], by[k]);
            }
        }
        const int angle = tree->angle_column[body];
        if (angle >= 0) {
            matrix[(size_t)angle * (width + 1)] += of->inertia;
            solved->whole[angle] += pushes[body].moment;
        }
    }
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        put_loop(solved, loop, width, matrix);
        solved->whole[n + 2 * loop] = sides[2 * loop];
        solved->whole[n + 2 * loop + 1] = sides[2 * loop + 1];
    }
    assert_true(dense_solve(width, matrix, solved->whole));
    test_free(matrix);
}

// A tree at a state away from the start.
static Solved *stand(const Linkage *linkage, uint64_t *seed)
{
    Solved *solved = test_calloc(1, sizeof *solved);
    Tree *tree = &solved->tree;
    tree_build(linkage, tree);
    MemoryLayout layout = {NULL, 0};
    TreeState measured;
    tree_state_lay(tree, &layout, &measured);
    solved->memory = test_calloc(1, layout.used);
    solved->state = test_calloc(1, sizeof *solved->state);
    tree_state_lay(tree, &(MemoryLayout){(char *)solved->memory, 0}, solved->state);
    Motion motions[BODIES];
    linkage_start(linkage, motions);
    double q[EQUATIONS] = {0.0};
    double u[EQUATIONS] = {0.0};
    tree_start(tree, motions, u);
    for (size_t i = 0; i < tree->coordinate_count; i++) {
        q[i] = 0.3 * lcg_draw(seed);
    }
    tree_evaluate(tree, 0.0, q, u, solved->state);
    return solved;
}

static void finish(Solved *solved, Made made)
{
    tree_finish(&solved->tree);
    test_free(solved->state);
    test_free(solved->memory);
    test_free(solved);
    linkage_free(made.linkage);
    test_free(made.linkage);
}

// Solves in both ways; the push is on one body more than the other.
static Solved *solve(const Linkage *linkage, double other)
{
    uint64_t seed = 3;
    Solved *solved = stand(linkage, &seed);
    const Tree *tree = &solved->tree;
    ArticulatedPush pushes[BODIES];
    for (size_t i = 0; i < linkage->body_count; i++) {
        pushes[i] = (ArticulatedPush){{lcg_draw(&seed), lcg_draw(&seed)}, lcg_draw(&seed)};
    }
    double sides[2 * JOINTS];
    for (size_t i = 0; i < 2 * tree->loop_count; i++) {
        sides[i] = lcg_draw(&seed);
    }
    Articulated *articulated = articulated_create(tree, tree->loop_count, tree->loops);
    assert_true(articulated_factor(articulated, solved->state));
    articulated_solve(articulated, pushes, sides, solved->rates);
    // at rest nothing is biased: both at once give the same
    double at_once[EQUATIONS] = {0.0};
    assert_true(articulated_accelerate(articulated, solved->state, pushes, sides, at_once));
    for (size_t i = 0; i < tree->coordinate_count + 2 * tree->loop_count; i++) {
        assert_near(at_once[i], solved->rates[i], 1e-11 * (1.0 + fabs(at_once[i])));
    }
    articulated_destroy(articulated);
    pushes[0].moment += other;
    solve_whole(solved, pushes, sides);
    return solved;
}

// The largest difference of any unknown, over the largest of all.
static double apart(Made made, double other)
{
    Solved *solved = solve(made.linkage, other);
    const size_t count = solved->tree.coordinate_count + 2 * solved->tree.loop_count;
    double largest = 0.0;
    double error = 0.0;
    for (size_t i = 0; i < count; i++) {
        largest = fmax(largest, fabs(solved->whole[i]));
        error = fmax(error, fabs(solved->whole[i] - solved->rates[i]));
    }
    finish(solved, made);
    return error / largest;
}

// Rounding of some hundred operations, times the condition of the matrices.
static const double ROUNDED = 1e-10;

static void chains_move_as_their_whole_matrix_says(void **state)
{
    (void)state;
    for (int count = 1; count <= BODIES; count++) {
        assert_true(apart(chain(count, true), 0.0) < ROUNDED);
        assert_true(apart(chain(count, false), 0.0) < ROUNDED);
    }
}

static void loops_in_a_row_move_as_their_whole_matrix_says(void **state)
{
    (void)state;
    for (int count = 1; count <= 5; count++) {
        assert_true(apart(scissor(count), 0.0) < ROUNDED);
        assert_true(apart(row(count, false), 0.0) < ROUNDED);
        assert_true(apart(row(count, true), 0.0) < ROUNDED);
    }
}

static void slides_move_as_their_whole_matrix_says(void **state)
{
    (void)state;
    assert_true(apart(slides(), 0.0) < ROUNDED);
}

// Control: another moment on the first body.
static void another_push_moves_otherwise(void **state)
{
    (void)state;
    assert_true(apart(scissor(4), 1e-3) > 100.0 * ROUNDED);
}

// A parallelogram of bars of one metre on the ground, its base turned by an angle and its uprights
// by another from that.
static Made parallelogram(double base_rad, double upright_rad)
{
    Made made = start();
    const double angle = base_rad + upright_rad;
    const Vec2 base = {cos(base_rad), sin(base_rad)};
    const Vec2 upright = {cos(angle), sin(angle)};
    const Vec2 middles[] = {vec2_scale(0.5, upright), vec2_add(upright, vec2_scale(0.5, base)),
                            vec2_add(base, vec2_scale(0.5, upright))};
    const double angles[] = {angle, base_rad, angle};
    const Vec2 points[] = {{0.0, 0.0}, upright, vec2_add(upright, base), base};
    const int bodies[] = {LINKAGE_GROUND, 0, 1, 2, LINKAGE_GROUND};
    for (int i = 0; i < 3; i++) {
        Body *body = &made.linkage->bodies[add_body(&made)];
        *body = (Body){.mass = 1.0, .inertia = 1.0 / 12.0};
        body->start = (Motion){.position = middles[i], .angle = angles[i]};
    }
    for (int i = 0; i < 4; i++) {
        join(&made, JOINT_REVOLUTE, bodies[i], bodies[i + 1]);
        Joint *joint = &made.linkage->joints[i];
        joint->anchor_a = anchor_of(made.linkage, bodies[i], points[i]);
        joint->anchor_b = anchor_of(made.linkage, bodies[i + 1], points[i]);
    }
    return made;
}

// How far its rows say that it is from its change point, where all bars lie along the base.
static double distance_of(double base_rad, double upright_rad)
{
    Made made = parallelogram(base_rad, upright_rad);
    uint64_t seed = 3;
    Solved *solved = stand(made.linkage, &seed);
    const Tree *tree = &solved->tree;
    const double at_start[EQUATIONS] = {0.0};
    tree_evaluate(tree, 0.0, at_start, at_start, solved->state);
    Articulated *articulated = articulated_create(tree, tree->loop_count, tree->loops);
    assert_true(articulated_factor(articulated, solved->state));
    const double distance = articulated->distance;
    articulated_destroy(articulated);
    finish(solved, made);
    return distance;
}

static void the_distance_from_a_change_point_is_in_proportion_to_it(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        const double base = 0.3 + 0.5 * i;
        const double near = distance_of(base, 1e-4);
        assert_near(distance_of(base, 2e-4) / near, 2.0, 0.02);
        assert_near(distance_of(base, 4e-4) / near, 4.0, 0.08);
        assert_true(near > 1e-5 && near < 1e-3);
        // the control: far from it
        assert_true(distance_of(base, 1.2) > 0.1);
    }
}

// Two rows of four-bars on the ground, a chain that floats and a body alone.
static Made four_parts(void)
{
    Made made = row(2, false);
    const int left = add_body(&made);
    const int coupler = add_body(&made);
    const int right = add_body(&made);
    join(&made, JOINT_REVOLUTE, LINKAGE_GROUND, left);
    join(&made, JOINT_REVOLUTE, LINKAGE_GROUND, right);
    join(&made, JOINT_REVOLUTE, left, coupler);
    join(&made, JOINT_REVOLUTE, coupler, right);
    const int first = add_body(&made);
    join(&made, JOINT_REVOLUTE, first, add_body(&made));
    add_body(&made);
    return made;
}

static void each_part_moves_as_in_the_whole_to_the_last_bit(void **state)
{
    (void)state;
    Made made = four_parts();
    uint64_t seed = 3;
    Solved *solved = stand(made.linkage, &seed);
    const Tree *tree = &solved->tree;
    ArticulatedPush pushes[BODIES];
    for (size_t i = 0; i < BODIES; i++) {
        pushes[i] = (ArticulatedPush){{lcg_draw(&seed), lcg_draw(&seed)}, lcg_draw(&seed)};
    }
    Articulated *articulated = articulated_create(tree, tree->loop_count, tree->loops);
    assert_int_equal(articulated->parts.count, 4);
    assert_true(articulated_factor(articulated, solved->state));
    articulated_solve(articulated, pushes, NULL, solved->whole);
    const size_t count = tree->coordinate_count + 2 * tree->loop_count;
    for (size_t i = 0; i < count; i++) {
        solved->rates[i] = NAN;
    }
    for (size_t i = 0; i < 4; i++) {
        // control: what belongs to other parts is not written
        assert_true(isnan(solved->rates[tree->coordinate_count - 1]));
        articulated_solve_part(articulated, i, pushes, solved->rates);
    }
    for (size_t i = 0; i < count; i++) {
        assert_true(solved->rates[i] == solved->whole[i]);
    }
    articulated_destroy(articulated);
    finish(solved, made);
}

// Bodies and ideal joints between them without a loop, some bodies on the ground, listed in no
// order.
static Made forest(uint64_t seed)
{
    Made made = start();
    made.seed = seed;
    int order[BODIES];
    for (int i = 0; i < BODIES; i++) {
        order[i] = add_body(&made);
        const int at = (int)(0.5 * (1.0 + lcg_draw(&made.seed)) * (i + 1));
        order[i] = order[at < i ? at : i];
        order[at < i ? at : i] = i;
    }
    for (int i = 0; i < BODIES; i++) {
        const int other = (int)(0.5 * (1.0 + lcg_draw(&made.seed)) * (i + 2)) - 2;
        if (other >= LINKAGE_GROUND) {
            join(&made, JOINT_REVOLUTE, other >= 0 ? order[other] : LINKAGE_GROUND, order[i]);
        }
    }
    Joint *joints = made.linkage->joints;
    for (size_t i = made.linkage->joint_count; i-- > 1;) {
        const size_t at = (size_t)(0.5 * (1.0 + lcg_draw(&made.seed)) * (double)(i + 1)) % (i + 1);
        const Joint kept = joints[i];
        joints[i] = joints[at];
        joints[at] = kept;
    }
    return made;
}

// The joint that a pass over all joints uses next; -1: the passes have come to an end.
static int next_of_passes(const Linkage *linkage, const bool *is_known, size_t *at)
{
    for (size_t tried = 0; tried < linkage->joint_count; tried++) {
        const size_t i = (*at + tried) % linkage->joint_count;
        const Joint *joint = &linkage->joints[i];
        if (is_known[joint->body_a + 1] != is_known[joint->body_b + 1]) {
            *at = i + 1;
            return (int)i;
        }
    }
    return -1;
}

static void bodies_are_hung_up_in_passes_over_the_joints(void **state)
{
    (void)state;
    size_t hung = 0;
    for (unsigned seed = 1; seed <= 200; seed++) {
        Made made = forest(lcg_stirred(seed));
        bool is_known[BODIES + 1] = {true};
        Span span = span_find(made.linkage);
        assert_int_equal(span.count, BODIES);
        size_t at = 0;
        for (size_t i = 0; i < span.count; i++) {
            const int joint = next_of_passes(made.linkage, is_known, &at);
            assert_int_equal(span.steps[i].joint, joint);
            at = joint < 0 ? 0 : at; // a body that floats begins anew
            hung += joint >= 0 ? 1 : 0;
            is_known[span.steps[i].body + 1] = true;
        }
        // control: neither all float nor all hang
        assert_true(hung > 0 && hung < (size_t)seed * BODIES);
        span_finish(&span);
        linkage_free(made.linkage);
        test_free(made.linkage);
    }
}

enum { IN_A_ROW = 64 };

// Four-bars in a row that share their uprights, and crossed bars in a row. A foot is on the ground,
// where a four-bar or the first bar has one.
static Linkage in_a_row(bool is_crossed)
{
    Linkage linkage = linkage_create((LinkageRoom){
        .bodies = 2 * IN_A_ROW + 1, .joints = 3 * IN_A_ROW + 1, .springs = 0, .torsions = 0});
    for (int i = 0; i < IN_A_ROW; i++) {
        const int pairs[3][2] = {
            {is_crossed && i > 0 ? 2 * i - 1 : LINKAGE_GROUND, 2 * i},
            {2 * i, 2 * i + 1},
            {is_crossed ? 2 * i : 2 * i + 1, is_crossed ? 2 * i + 3 : 2 * i + 2},
        };
        for (int k = 0; k < 3; k++) {
            // the last bars have no neighbours
            if (pairs[k][1] <= 2 * IN_A_ROW - (is_crossed ? 1 : 0)) {
                linkage.joints[linkage.joint_count++] =
                    (Joint){.body_a = pairs[k][0], .body_b = pairs[k][1]};
            }
        }
    }
    linkage.body_count = 2 * IN_A_ROW + (is_crossed ? 0 : 1);
    if (!is_crossed) {
        linkage.joints[linkage.joint_count++] =
            (Joint){.body_a = LINKAGE_GROUND, .body_b = 2 * IN_A_ROW};
    }
    for (size_t i = 0; i < linkage.body_count; i++) {
        linkage.bodies[i] = (Body){.mass = 1.0, .inertia = 1.0};
    }
    return linkage;
}

// The most loops that meet in one step of the elimination.
static size_t most_in_a_front(const Linkage *linkage)
{
    Tree tree;
    Plan plan;
    tree_build(linkage, &tree);
    int *parents = test_calloc(tree.node_count + 1, sizeof *parents);
    int(*ends)[2] = test_calloc(tree.loop_count + 1, sizeof *ends);
    for (size_t i = 0; i < tree.node_count; i++) {
        parents[i] = tree.nodes[i].parent_node;
    }
    for (size_t i = 0; i < tree.loop_count; i++) {
        ends[i][0] = tree_node_of(&tree, linkage->joints[tree.loops[i]].body_a);
        ends[i][1] = tree_node_of(&tree, linkage->joints[tree.loops[i]].body_b);
    }
    const PlanShape shape = {tree.node_count, parents, tree.loop_count, (const int(*)[2])ends, 2};
    articulated_plan_make(&shape, &plan);
    test_free(parents);
    test_free(ends);
    size_t most = 0;
    for (size_t i = 0; i < plan.front_count; i++) {
        most = plan.fronts[i].loop_count > most ? plan.fronts[i].loop_count : most;
    }
    articulated_plan_finish(&plan);
    tree_finish(&tree);
    return most;
}

// Exchanges each joint with another of the rest.
static void shuffle(Linkage *linkage, uint64_t *seed)
{
    for (size_t i = linkage->joint_count; i > 1; i--) {
        const size_t k = (size_t)((0.5 + 0.499 * lcg_draw(seed)) * (double)i);
        const Joint joint = linkage->joints[i - 1];
        linkage->joints[i - 1] = linkage->joints[k];
        linkage->joints[k] = joint;
    }
}

static void loops_stay_with_their_neighbours_whatever_the_order_of_the_joints(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (int is_crossed = 0; is_crossed < 2; is_crossed++) {
        Linkage linkage = in_a_row(is_crossed == 1);
        for (int i = 0; i < 8; i++) {
            assert_true(most_in_a_front(&linkage) <= 4);
            shuffle(&linkage, &seed);
        }
        linkage_free(&linkage);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chains_move_as_their_whole_matrix_says),
        cmocka_unit_test(loops_in_a_row_move_as_their_whole_matrix_says),
        cmocka_unit_test(slides_move_as_their_whole_matrix_says),
        cmocka_unit_test(another_push_moves_otherwise),
        cmocka_unit_test(the_distance_from_a_change_point_is_in_proportion_to_it),
        cmocka_unit_test(each_part_moves_as_in_the_whole_to_the_last_bit),
        cmocka_unit_test(bodies_are_hung_up_in_passes_over_the_joints),
        cmocka_unit_test(loops_stay_with_their_neighbours_whatever_the_order_of_the_joints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
