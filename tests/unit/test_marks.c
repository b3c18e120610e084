// Are the instants at which a contact shows its greatest force found, and its ends?
#include "single_pin.h"

#include "kernel/marks.h"

static const double DURATION_S = 2e-4;

// The state at a mark.
static KernelPose pose_at(const Kernel *kernel, const Mark *mark)
{
    PinSums sums;
    pin_sums_at(kernel, mark->node, mark->time_s, &sums);
    return pin_pose_at(kernel, 0, mark->node, mark->time_s);
}

static void the_greatest_force_and_depth_are_marked(void **state)
{
    (void)state;
    double worst_node = 0.0;
    for (double asked = 0.3; asked < 1.0; asked += 0.2) {
        const double chi = damping_factor(DAMPING_LANKARANI_NIKRAVESH, asked);
        const Scenario impact =
            one_impact_hertz(ODE_MAP_IMPULSE, DAMPING_LANKARANI_NIKRAVESH, asked);
        const double true_force = one_impact_law_force(&impact);
        const double true_depth =
            damping_depth_max(ONE_IMPACT_HERTZ, 1.5, chi, ONE_IMPACT_MASS, ONE_IMPACT_SPEED);
        Kernel pin = single_pin(single_pin_hertz(chi), LONE_PIN_PHASE);
        Marks marks = {.count = 0};
        assert_true(kernel_run(&pin, DURATION_S));
        marks_find(&marks, &pin);
        double force = 0.0;
        double depth = 0.0;
        for (size_t i = 0; i < marks.count; i++) {
            const KernelPose pose = pose_at(&pin, &marks.marks[i]);
            force = fmax(force, vec2_length(pose.force));
            depth = fmax(depth, pose.pose.penetration);
        }
        // at the places' errors of the square of half a local step, 6e-4, both lose that squared
        assert_close(force, true_force, 1e-5);
        assert_close(depth, true_depth, 1e-5);
        // control: no node need stand where the force is greatest
        double at_nodes = 0.0;
        for (size_t node = 0; node < pin.node_count; node++) {
            const Mark mark = {.time_s = pin.times[node], .node = node};
            at_nodes = fmax(at_nodes, vec2_length(pose_at(&pin, &mark).force));
        }
        worst_node = fmax(worst_node, 1.0 - at_nodes / true_force);
        marks_finish(&marks);
        kernel_finish(&pin);
    }
    assert_true(worst_node > 1e-4);
}

static void marks_come_in_order_and_the_last_is_the_end(void **state)
{
    (void)state;
    Kernel pin = single_pin(single_pin_hertz(0.3), LONE_PIN_PHASE);
    Marks marks = {.count = 0};
    assert_true(kernel_run(&pin, DURATION_S));
    marks_find(&marks, &pin);
    // before and behind the onset, greatest force, greatest depth, before the end, the step's end
    assert_int_equal(marks.count, 6);
    bool was_touching = false;
    size_t changes = 0;
    for (size_t i = 0; i < marks.count; i++) {
        assert_true(i == 0 || marks.marks[i].time_s >= marks.marks[i - 1].time_s);
        const bool is_touching = pose_at(&pin, &marks.marks[i]).is_touching;
        changes += is_touching != was_touching ? 1 : 0;
        was_touching = is_touching;
    }
    assert_int_equal(changes, 2);
    assert_near(marks.marks[marks.count - 1].time_s, DURATION_S, 1e-14 * DURATION_S);
    marks_finish(&marks);
    kernel_finish(&pin);
}

// A contact that begins where the step ends has begun: the next step does not begin it again.
// Binary fractions, so that the flight ends with the step to the last bits, which go up one after
// the other.
static void a_contact_that_begins_at_the_very_end_is_touching_there(void **state)
{
    (void)state;
    size_t at_the_end = 0;
    for (int bits = 0; bits < 16; bits++) {
        Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
        Marks marks = {.count = 0};
        pin.contacts[0].radial_clearance = 0x1p-10;
        pin.position[0] = 0x1p-10 - 0x1p-14;
        assert_true(kernel_run(&pin, 0x1p-13 + bits * 0x1p-63));
        marks_find(&marks, &pin);
        const size_t last = pin.node_count - 1;
        const Mark *end = &marks.marks[marks.count - 1];
        assert_int_equal(pose_at(&pin, end).is_touching, pin.contacts[0].state.is_touching);
        at_the_end += pin.times[last - 1] == pin.times[last] ? 1 : 0;
        marks_finish(&marks);
        kernel_finish(&pin);
    }
    assert_true(at_the_end > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_greatest_force_and_depth_are_marked),
        cmocka_unit_test(marks_come_in_order_and_the_last_is_the_end),
        cmocka_unit_test(a_contact_that_begins_at_the_very_end_is_touching_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
