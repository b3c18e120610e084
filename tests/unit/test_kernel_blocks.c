// Do blocks of an island, each in local steps of its own, do what the island does as a whole?
//
// A row of pins whose neighbours move each other, as those of a chain: W = 2/m on the diagonal,
// -1/m beside it. Each comes to its wall at a time of its own.
#include "single_pin.h"

#include "base/lcg.h"
#include "base/zeroed.h"
#include "kernel/kernel.h"

#include <string.h>

enum { PINS = 60 };

static const double STEP_S = 4e-5;

typedef struct Row {
    Kernel all;
    KernelIslands *islands;
    size_t *first_partner;
    size_t *partners;
    double own[4]; // mobilities, row by row
    double next[4];
    double none[4];
    bool is_cut; // a row cut into pieces of four pins that do not feel each other
} Row;

static const double *block_of(const void *context, size_t place, size_t other)
{
    const Row *row = context;
    if (place == other) {
        return row->own;
    }
    return row->is_cut && place / 4 != other / 4 ? row->none : row->next;
}

static void make_row(Row *row, ForceLaw law, double closing)
{
    uint64_t seed = lcg_stirred(3);
    *row = (Row){.all = kernel_start(0.0)};
    row->first_partner = zeroed(PINS + 1, sizeof *row->first_partner);
    row->partners = zeroed(3 * PINS, sizeof *row->partners);
    size_t count = 0;
    for (size_t i = 0; i < PINS; i++) {
        const KernelContact joint = {
            .law = law,
            .radial_clearance = ONE_IMPACT_CLEARANCE,
            .hole_radius = ONE_IMPACT_CLEARANCE + 5e-3,
            .joint = (int)i,
        };
        kernel_add(&row->all, &joint, KERNEL_ROWS_PLAIN);
        row->first_partner[i] = count;
        for (size_t k = i > 0 ? i - 1 : 0; k <= i + 1 && k < PINS; k++) {
            row->partners[count++] = k;
        }
    }
    row->first_partner[PINS] = count;
    for (size_t i = 0; i < 4; i += 3) {
        row->own[i] = 2.0 / ONE_IMPACT_MASS;
        row->next[i] = -1.0 / ONE_IMPACT_MASS;
    }
    kernel_make_rows(&row->all);
    for (size_t i = 0; i < PINS; i++) {
        const double angle = 6.0 * lcg_draw(&seed);
        const double left_s = 0.5 * STEP_S * (1.0 + lcg_draw(&seed));
        const double speed = closing * (1.0 + 0.5 * lcg_draw(&seed));
        const Vec2 outward = {cos(angle), sin(angle)};
        for (size_t k = 0; k < 2; k++) {
            const double along = k == 0 ? outward.x : outward.y;
            row->all.position[2 * i + k] = along * (ONE_IMPACT_CLEARANCE - speed * left_s);
            row->all.speed[2 * i + k] = along * speed;
        }
    }
}

static void finish_row(Row *row)
{
    kernel_islands_destroy(row->islands);
    kernel_finish(&row->all);
    free(row->first_partner);
    free(row->partners);
}

// Runs a row through a few steps, divided or as a whole; writes what the impulses were, N s, by
// step and row, and returns how many islands or blocks there were in the second step.
static size_t run_row(ForceLaw law, double closing, bool is_divided, bool is_cut, double *impulses,
                      size_t steps)
{
    Row row;
    size_t blocks = 0;
    make_row(&row, law, closing);
    row.is_cut = is_cut;
    const KernelCoupling coupling = {row.first_partner, row.partners, block_of, &row};
    row.islands = kernel_islands_create(&row.all, &coupling);
    row.islands->undivided_most = is_divided ? 0 : SIZE_MAX;
    row.islands->events_most = 0;
    KernelSums sums = kernel_sums(row.all.row_count);
    for (size_t n = 0; n < steps; n++) {
        assert_true(kernel_islands_run(row.islands, STEP_S));
        kernel_islands_look(row.islands, STEP_S, &sums);
        blocks = n == 1 ? row.islands->count : blocks;
        memcpy(impulses + n * row.all.row_count, sums.impulse,
               row.all.row_count * sizeof *impulses);
        // on to the next step, under what all impulses do
        for (size_t i = 0; i < row.all.row_count; i++) {
            double speed = 0.0;
            double moved = 0.0;
            for (size_t k = 0; k < row.all.row_count; k++) {
                const size_t apart = i / 2 > k / 2 ? i / 2 - k / 2 : k / 2 - i / 2;
                if (i % 2 == k % 2 && apart < 2) {
                    const double mobility = block_of(&row, i / 2, k / 2)[3 * (i % 2)];
                    speed += mobility * sums.impulse[k];
                    moved += mobility * sums.moment[k];
                }
            }
            row.all.position[i] += STEP_S * row.all.speed[i] + moved;
            row.all.speed[i] += speed;
        }
    }
    kernel_sums_free(&sums);
    finish_row(&row);
    return blocks;
}

enum { STEPS = 4, KEPT_NUMBERS = STEPS * PINS * 2 };

// The largest difference of impulses, relative to the largest one.
static double apart(const double *a, const double *b)
{
    double largest = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < KEPT_NUMBERS; i++) {
        largest = fmax(largest, fabs(a[i] - b[i]));
        size = fmax(size, fabs(a[i]));
    }
    return largest / size;
}

static void check_row(ForceLaw law, double closing, double tolerance)
{
    static double whole[KEPT_NUMBERS];
    static double blocks[KEPT_NUMBERS];
    assert_int_equal(run_row(law, closing, false, false, whole, STEPS), 1);
    assert_true(run_row(law, closing, true, false, blocks, STEPS) > PINS / 8);
    print_message("# blocks and whole are apart by %.2g\n", apart(whole, blocks));
    assert_true(apart(whole, blocks) < tolerance);
    // control: what one block does to the next counts
    run_row(law, closing, false, true, blocks, STEPS);
    assert_true(apart(whole, blocks) > 1e-2);
}

static void blocks_of_bouncing_pins_do_what_the_whole_does(void **state)
{
    (void)state;
    // local steps are allowed an error of 1e-10 each
    check_row(single_pin_hertz(0.0), ONE_IMPACT_SPEED, 1e-8);
    check_row(single_pin_hertz(0.3), ONE_IMPACT_SPEED, 1e-8);
}

static void blocks_of_pins_whose_forces_jump_do_what_the_whole_does(void **state)
{
    (void)state;
    ForceLaw law = force_law_power(1e8, 1.0);
    law.viscous = 2.0 * 0.2 * sqrt(1e8 * ONE_IMPACT_MASS);
    // the force bends to stay at zero inside a local step: of a lower order there
    check_row(law, ONE_IMPACT_SPEED, 1e-5);
}

static void blocks_of_pins_that_stop_at_once_do_what_the_whole_does(void **state)
{
    (void)state;
    // restitution 0.05, integrated by implicit steps of their own tolerance
    check_row(single_pin_hertz(damping_factor(DAMPING_EXACT, 0.05)), ONE_IMPACT_SPEED, 1e-4);
}

// Nothing of the last look at an island is left.
static void forget_look(KernelIsland *island)
{
    for (size_t i = 0; i < 4 * island->kernel.row_count; i++) {
        island->sums.impulse[i] = NAN; // the four are in one array
    }
}

static void a_look_around_a_contact_finds_what_a_look_at_its_island_does(void **state)
{
    (void)state;
    Row row;
    make_row(&row, single_pin_hertz(0.3), ONE_IMPACT_SPEED);
    const KernelCoupling coupling = {row.first_partner, row.partners, block_of, &row};
    row.islands = kernel_islands_create(&row.all, &coupling);
    row.islands->undivided_most = SIZE_MAX;
    KernelSums sums = kernel_sums(row.all.row_count);
    assert_true(kernel_islands_run(row.islands, STEP_S));
    KernelIsland *island = row.islands->islands[0];
    assert_int_equal(island->kernel.contact_count, PINS);
    const double time_s = 0.7 * STEP_S;
    const size_t node = kernel_node(&island->kernel, time_s);
    for (size_t i = 0; i < PINS; i++) {
        kernel_islands_look(row.islands, time_s, &sums);
        const KernelPose whole = kernel_islands_pose(row.islands, i, time_s, &sums);
        forget_look(island);
        kernel_island_look_around(island, i, node, time_s);
        const KernelPose around = kernel_islands_pose(row.islands, i, time_s, &sums);
        assert_true(around.pose.gap == whole.pose.gap);
        assert_true(around.pose.approach_speed == whole.pose.approach_speed);
        assert_true(around.force.x == whole.force.x && around.force.y == whole.force.y);
        // control: of one far away nothing is known then
        const size_t other = (i + PINS / 2) % PINS;
        assert_true(isnan(kernel_islands_pose(row.islands, other, time_s, &sums).pose.gap));
    }
    kernel_sums_free(&sums);
    finish_row(&row);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_of_bouncing_pins_do_what_the_whole_does),
        cmocka_unit_test(blocks_of_pins_whose_forces_jump_do_what_the_whole_does),
        cmocka_unit_test(blocks_of_pins_that_stop_at_once_do_what_the_whole_does),
        cmocka_unit_test(a_look_around_a_contact_finds_what_a_look_at_its_island_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
