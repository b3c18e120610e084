// Do ERP and CFM stand for the spring and damper they were made from?
#include "close.h"

#include "contact/map.h"

#include <string.h>

// A contact in which nothing is a round number of anything else.
static const MapContact SOME_CONTACT = {
    .stiffness = 4e8,
    .damping = 500.0,
    .step = 2e-6,
    .mass = 0.15,
    .depth = 3e-7,
    .closing = 0.2,
};

// The force of the map's row, solved for F, which may pull here: v_out = v + h F / m, v separating.
static double row_force(const Map *map, const MapContact *contact)
{
    const ErpCfm row = map->convert(contact);
    return (row.erp / contact->step * contact->depth + contact->closing) /
           (row.cfm + contact->step / contact->mass);
}

// One step of a map on a linear spring and damper: the force is a depth's and a speed's share.
typedef struct OneStep {
    double of_depth; // h^2 / m times the force at depth 1
    double of_speed; // h / m times the force at closing speed 1
} OneStep;

static OneStep one_step(const Map *map, MapContact contact)
{
    contact.depth = 1.0;
    contact.closing = 1.0 / contact.step;
    const double closing = row_force(map, &contact);
    contact.closing = -contact.closing;
    const double opening = row_force(map, &contact);
    const double scale = contact.step * contact.step / contact.mass;
    return (OneStep){0.5 * scale * (closing + opening), 0.5 * scale * (closing - opening)};
}

// Of the matrix that takes depth and closing speed to those of a step later, as ODE steps.
static double determinant(OneStep step)
{
    return 1.0 - step.of_speed;
}

static double trace(OneStep step)
{
    return 2.0 - step.of_depth - step.of_speed;
}

// Unit mass and frequency, for a damping ratio and a step.
static MapContact oscillator(double zeta, double step)
{
    return (MapContact){.stiffness = 1.0, .damping = 2.0 * zeta, .step = step, .mass = 1.0};
}

static void each_map_makes_the_row_the_force_it_says(void **state)
{
    (void)state;
    const MapContact at = SOME_CONTACT;
    for (int kind = ODE_MAP_TEXTBOOK; kind <= ODE_MAP_MIDPOINT; kind++) {
        const double force = row_force(map_get((OdeMap)kind), &at);
        const double after = at.closing - at.step * force / at.mass; // closing speed
        const double said[] = {
            // spring and damper at the end of the step
            at.stiffness * (at.depth + at.step * after) + at.damping * after,
            // the spring at the start, the damper at the end
            at.stiffness * at.depth + at.damping * after,
            // the damper on the mean of both speeds
            at.stiffness * at.depth + at.damping * 0.5 * (at.closing + after),
        };
        for (int other = 0; other < 3; other++) {
            if (other == kind) {
                assert_close(force, said[other], 1e-12);
            } else {
                // control: what another map says is another force
                assert_true(fabs(force / said[other] - 1.0) > 1e-3);
            }
        }
    }
}

// The midpoint's force is linear though its ERP is not: also on the way out, and in next to no
// depth.
static void the_midpoint_map_holds_at_any_depth_and_speed(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_MIDPOINT);
    MapContact at = SOME_CONTACT;
    for (at.depth = 1e-15; at.depth < 1e-4; at.depth *= 100.0) {
        for (at.closing = -1.0; at.closing <= 1.0; at.closing += 0.25) {
            const double force = row_force(map, &at);
            const double after = at.closing - at.step * force / at.mass;
            const double damped = 0.5 * at.damping * (at.closing + after);
            const double size = at.stiffness * at.depth + fabs(damped);
            assert_near(force, at.stiffness * at.depth + damped, 1e-12 * size);
        }
    }
}

static void the_exact_map_turns_and_decays_like_the_continuous_oscillator(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_EXACT);
    assert_true(map->needs_mass);
    static const double ZETAS[] = {0.0, 0.03, 0.5, 0.999, 1.0, 1.001, 3.0};
    static const double STEPS[] = {1e-3, 0.1, 0.5, 1.0, 2.0, 3.0};
    for (size_t i = 0; i < sizeof ZETAS / sizeof *ZETAS; i++) {
        for (size_t k = 0; k < sizeof STEPS / sizeof *STEPS; k++) {
            const double zeta = ZETAS[i];
            const double h = STEPS[k];
            const double turn = h * sqrt(fabs(1.0 - zeta * zeta));
            const double swing = zeta < 1.0 ? cos(turn) : cosh(turn);
            const OneStep step = one_step(map, oscillator(zeta, h));
            // without a damper one of 1e-10 h k stands in, which takes 1e-10 h^2
            const double tolerance = zeta > 0.0 ? 1e-13 : 1.1 * map->stand_in_share * h * h + 1e-13;
            assert_near(determinant(step), exp(-2.0 * zeta * h), tolerance);
            assert_near(trace(step), 2.0 * exp(-zeta * h) * swing, 4.0 * tolerance);
        }
    }
    // controls: another map, and this one with a mass that is wrong by a hundredth
    const OneStep corrected = one_step(map_get(ODE_MAP_CORRECTED), oscillator(0.5, 1.0));
    assert_true(fabs(determinant(corrected) - exp(-1.0)) > 0.1);
    MapContact heavy = oscillator(0.5, 1.0);
    heavy.mass = 1.01;
    assert_true(fabs(determinant(one_step(map, heavy)) - exp(-1.0)) > 1e-3);
}

static void the_stand_in_damper_changes_the_force_by_less_than_a_billionth(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_CORRECTED);
    assert_true(map->stand_in_share > 0.0 && map->stand_in_share < 1e-9);
    MapContact at = SOME_CONTACT;
    at.damping = 0.0;
    for (at.step = 1e-7; at.step < 2e-5; at.step *= 2.0) {
        // from the first step of a contact, moved on by a tenth of a step, to its depth
        for (double share = 0.1; share < 100.0; share *= 3.0) {
            at.depth = share * at.closing * at.step;
            const double force = row_force(map, &at);
            const double out = fabs(-at.closing + at.step * force / at.mass);
            assert_close(force, at.stiffness * at.depth, 1e-9 * fmax(1.0, out / at.closing));
        }
    }
}

// The largest depth or speed within 2000 steps from unit depth, nothing holding the row back.
static double largest_swing(const Map *map, double step)
{
    const OneStep matrix = one_step(map, oscillator(0.0, step));
    double depth = 1.0;
    double move = 0.0; // of a step
    double largest = 0.0;
    for (int i = 0; i < 2000; i++) {
        move -= matrix.of_depth * depth + matrix.of_speed * move;
        depth += move;
        largest = fmax(largest, fmax(fabs(depth), fabs(move)));
    }
    return largest;
}

static void each_map_is_bounded_below_its_limit_and_grows_above_it(void **state)
{
    (void)state;
    static const OdeMap KINDS[] = {ODE_MAP_CORRECTED, ODE_MAP_MIDPOINT};
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        const Map *map = map_get(KINDS[i]);
        assert_near(map->stability_limit, 2.0, 0.0);
        // at omega h = 2 (1 - s) the swing is 1 / sqrt(2 s) and twice that in a step; at
        // 2 (1 + s) it grows by exp(sqrt(8 s)) in each
        assert_true(largest_swing(map, 1.999) < 100.0);
        assert_true(largest_swing(map, 2.001) > 1e20);
    }
    const Map *exact = map_get(ODE_MAP_EXACT);
    assert_near(exact->stability_limit, acos(-1.0), 1e-15);
    assert_true(largest_swing(exact, 3.0) < 100.0);
    assert_true(largest_swing(exact, 3.14) < 1e4);
    assert_true(isinf(map_get(ODE_MAP_TEXTBOOK)->stability_limit));
    assert_true(largest_swing(map_get(ODE_MAP_TEXTBOOK), 100.0) < 100.0);
}

static void bounce_beside_a_cfm_delivers_less(void **state)
{
    (void)state;
    // ODE's own row with a bounce: v_out + CFM F = e v_in, v_out = -v_in + h F / m
    const double m = 0.3;
    const double h = 1e-5;
    const double cfm = 4e-6;
    const double force = (0.8 + 1.0) / (cfm + h / m);
    const double out = -1.0 + h * force / m;
    assert_close(map_bounce_delivered(0.8, cfm, m, h), out, 1e-12);
    assert_near(map_bounce_delivered(0.8, 0.0, m, h), 0.8, 0.0);
    assert_true(map_bounce_delivered(0.0, cfm, m, h) < 0.0);
}

static void a_penalty_is_the_inverse_of_a_cfm(void **state)
{
    (void)state;
    assert_close(map_poisson_cfm(973330.0), 1.0 / 973330.0, 1e-15);
    assert_near(map_poisson_cfm(INFINITY), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_map_makes_the_row_the_force_it_says),
        cmocka_unit_test(the_midpoint_map_holds_at_any_depth_and_speed),
        cmocka_unit_test(the_exact_map_turns_and_decays_like_the_continuous_oscillator),
        cmocka_unit_test(the_stand_in_damper_changes_the_force_by_less_than_a_billionth),
        cmocka_unit_test(each_map_is_bounded_below_its_limit_and_grows_above_it),
        cmocka_unit_test(bounce_beside_a_cfm_delivers_less),
        cmocka_unit_test(a_penalty_is_the_inverse_of_a_cfm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
