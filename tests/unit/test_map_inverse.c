// Do an ERP and a CFM lead back to the spring and damper they were made from?
#include "close.h"

#include "contact/map.h"

#include <stdlib.h>

// Ranges beyond those that anyone has: of k, c, h and m.
static const double STIFFNESS[2] = {1e-3, 1e15};
static const double DAMPING[2] = {1e-9, 1e12};
static const double STEP[2] = {1e-12, 1.0};
static const double MASS[2] = {1e-9, 1e6};
static const unsigned short SEED[3] = {1956, 7, 12};

static double draw_log(unsigned short *state, const double range[2])
{
    return range[0] * pow(range[1] / range[0], erand48(state));
}

static double relative(double value, double truth)
{
    return truth == 0.0 ? fabs(value) : fabs(value / truth - 1.0);
}

// How far the round trip leaves a contact from itself: the worse of k and c, relative.
static double round_trip(OdeMap kind, const MapContact *contact)
{
    const Map *map = map_get(kind);
    MapContact back = *contact;
    back.stiffness = back.damping = NAN;
    if (!map->invert(map->convert(contact), &back)) {
        return INFINITY;
    }
    return fmax(relative(back.stiffness, contact->stiffness),
                relative(back.damping, contact->damping));
}

// Over a million draws, with h k / c from 1e-27 to 1e33.
static void the_round_trip_keeps_twelve_digits(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    double worst[2] = {0.0, 0.0};
    double plain = 0.0; // of the textbook's, from ERP and CFM alone
    for (int i = 0; i < 1000000; i++) {
        const MapContact contact = {
            .stiffness = draw_log(draws, STIFFNESS),
            .damping = draw_log(draws, DAMPING),
            .step = draw_log(draws, STEP),
        };
        worst[0] = fmax(worst[0], round_trip(ODE_MAP_TEXTBOOK, &contact));
        // a damper below the stand-in is the stand-in: see the edges
        if (contact.damping > 1e-10 * contact.step * contact.stiffness) {
            worst[1] = fmax(worst[1], round_trip(ODE_MAP_CORRECTED, &contact));
        }
        const ErpCfm soft = map_get(ODE_MAP_TEXTBOOK)->convert(&contact);
        plain = fmax(plain, relative((1.0 - soft.erp) / soft.cfm, contact.damping));
    }
    print_message("# round trip: textbook %.1e, corrected %.1e; without 1 - ERP beside it %.1e\n",
                  worst[0], worst[1], plain);
    assert_true(worst[0] <= 1e-12);
    assert_true(worst[1] <= 1e-12);
    // control: ERP as a double alone has lost every digit of some dampers
    assert_true(plain >= 1.0);
}

// ERP as a number of its own, as a user types it: the damper is wrong by half a unit of ERP's last
// place, which is eps/2 (h k + c) / c of it, and the few roundings beside that.
static void a_typed_erp_loses_what_its_last_place_is_worth(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    const Map *map = map_get(ODE_MAP_TEXTBOOK);
    for (int i = 0; i < 100000; i++) {
        const MapContact contact = {
            .stiffness = draw_log(draws, STIFFNESS),
            .damping = draw_log(draws, DAMPING),
            .step = draw_log(draws, STEP),
        };
        const ErpCfm soft = map->convert(&contact);
        MapContact back = contact;
        assert_true(map->invert(map_row(soft.erp, soft.cfm), &back));
        assert_close(back.stiffness, contact.stiffness, 1e-14);
        const double ratio = contact.step * contact.stiffness / contact.damping;
        assert_close(back.damping, contact.damping, 3e-16 * (1.0 + ratio) + 1e-14);
    }
}

static void the_edges_of_the_round_trip_are_what_they_are_called(void **state)
{
    (void)state;
    MapContact back = {.step = 1e-6};
    const Map *textbook = map_get(ODE_MAP_TEXTBOOK);
    const Map *corrected = map_get(ODE_MAP_CORRECTED);

    // no damper: ERP 1 exactly, and back to no damper exactly
    const MapContact spring = {.stiffness = 3e8, .step = 1e-6};
    assert_near(textbook->convert(&spring).erp, 1.0, 0.0);
    assert_true(textbook->invert(textbook->convert(&spring), &back));
    assert_near(back.damping, 0.0, 0.0);
    assert_close(back.stiffness, 3e8, 1e-15);
    // the corrected map's comes back as the one that stands in for it
    assert_true(corrected->invert(corrected->convert(&spring), &back));
    assert_close(back.damping, corrected->stand_in_share * 300.0, 1e-12);
    assert_close(back.stiffness, 3e8, 1e-12);

    // no spring: ERP 0, and back to no spring exactly
    const MapContact damper = {.damping = 20.0, .step = 1e-6};
    for (int kind = ODE_MAP_TEXTBOOK; kind <= ODE_MAP_CORRECTED; kind++) {
        const Map *map = map_get((OdeMap)kind);
        assert_near(map->convert(&damper).erp, 0.0, 0.0);
        assert_true(map->invert(map->convert(&damper), &back));
        assert_near(back.stiffness, 0.0, 0.0);
        assert_close(back.damping, 20.0, 1e-15);
    }

    // h k / c of 1e12 and more, where ERP rounds to 1 or next to it, and of 1e-12
    static const double RATIOS[] = {1e-300, 1e-16, 1e-12, 1e12, 1e16, 1e150};
    for (size_t i = 0; i < sizeof RATIOS / sizeof *RATIOS; i++) {
        const MapContact edge = {.stiffness = 1.0, .damping = 1.0 / RATIOS[i], .step = 1.0};
        assert_true(round_trip(ODE_MAP_TEXTBOOK, &edge) <= 1e-12);
    }
    const MapContact tight = {.stiffness = 1.0, .damping = 1e-17, .step = 1.0};
    assert_near(textbook->convert(&tight).erp, 1.0, 0.0);

    // what is no spring and damper is said to be none, and leaves the contact as it was
    back = tight;
    assert_false(textbook->invert(map_row(1.5, 1e-6), &back));
    assert_false(textbook->invert(map_row(0.2, 0.0), &back));
    assert_false(textbook->invert(map_row(-0.2, 1e-6), &back));
    assert_near(back.damping, 1e-17, 0.0);
    assert_true(corrected->invert(map_row(1.5, 1e-6), &back));
}

// Of the midpoint map the spring is a difference: what is lost is worth the damper's part in it.
static void the_midpoint_map_comes_back_but_for_cancellation(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    const Map *map = map_get(ODE_MAP_MIDPOINT);
    static const double DEPTH[2] = {1e-12, 1e-2};
    for (int i = 0; i < 100000; i++) {
        MapContact contact = {
            .stiffness = draw_log(draws, STIFFNESS),
            .damping = draw_log(draws, DAMPING),
            .step = draw_log(draws, STEP),
            .depth = draw_log(draws, DEPTH),
            .closing = erand48(draws),
        };
        contact.damping = fmax(contact.damping, 1e-9 * contact.step * contact.stiffness);
        const ErpCfm row = map->convert(&contact);
        const double lost = 0.5 * contact.damping * contact.closing / contact.depth;
        MapContact back = contact;
        if (map->invert(row, &back)) {
            assert_close(back.damping, contact.damping, 1e-14);
            assert_near(back.stiffness, contact.stiffness, 1e-14 * (contact.stiffness + lost));
        } else {
            // nothing is left of the spring
            assert_true(contact.stiffness <= 1e-14 * lost);
        }
    }
}

// Of the exact map the turn in a step is folded back beyond half of one.
static void the_exact_map_comes_back_within_its_limit(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    static const double TURN[2] = {1e-3, 3.0};
    static const double RATIO[2] = {1e-3, 3.0};
    double worst = 0.0;
    for (int i = 0; i < 100000; i++) {
        const double turn = draw_log(draws, TURN);
        const double ratio = draw_log(draws, RATIO);
        MapContact contact = {.mass = draw_log(draws, MASS), .step = draw_log(draws, STEP)};
        const double omega = turn / contact.step;
        contact.stiffness = contact.mass * omega * omega;
        contact.damping = 2.0 * ratio * omega * contact.mass;
        worst = fmax(worst, round_trip(ODE_MAP_EXACT, &contact));
    }
    print_message("# round trip: exact %.1e for omega h from 1e-3 to 3\n", worst);
    assert_true(worst <= 1e-12);
    // control: beyond half a turn a step another spring is found, or none
    const MapContact fast = {.stiffness = 25.0, .damping = 0.1, .step = 1.0, .mass = 1.0};
    assert_true(round_trip(ODE_MAP_EXACT, &fast) > 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_round_trip_keeps_twelve_digits),
        cmocka_unit_test(a_typed_erp_loses_what_its_last_place_is_worth),
        cmocka_unit_test(the_edges_of_the_round_trip_are_what_they_are_called),
        cmocka_unit_test(the_midpoint_map_comes_back_but_for_cancellation),
        cmocka_unit_test(the_exact_map_comes_back_within_its_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
